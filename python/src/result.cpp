// SPDX-License-Identifier: BSD-3-Clause
#include "result.h"

#include <pybind11/stl.h>

#include <cmath>
#include <sstream>

#include "fcl_artic/clearance.h"
#include "fcl_artic/tolerance_left.h"
#include "guard_files.h"

namespace fcl_artic::python {
namespace {

using Eigen::Vector3d;

template <class Printed>
std::string printed(const Printed& value) {
  std::ostringstream out;
  out << value;
  return out.str();
}

template <class Work>
py::dict fieldsOf(const Work& work) {
  py::dict fields;
  Work::forEachField([&](const char* name, auto member) { fields[name] = work.*member; });
  return fields;
}

/// Reads back the fields that fieldsOf() has written; a field that is not there stays 0.
template <class Work>
void readFields(const py::dict& fields, Work& work) {
  Work::forEachField([&](const char* name, auto member) {
    if (fields.contains(name)) work.*member = py::cast<std::decay_t<decltype(work.*member)>>(fields[name]);
  });
}

QueryStatistics statisticsOfDict(const py::dict& d) {
  QueryStatistics s;
  readFields(d, static_cast<StandardStatistics&>(s));
  readFields(d["visibility"], s.visibility);
  readFields(d["redon"], s.redon);
  s.pairs = py::cast<std::uint64_t>(d["pairs"]);
  s.pairs_after_culling = py::cast<std::uint64_t>(d["pairs_after_culling"]);
  s.visibility_executor = py::cast<std::string>(d["visibility_executor"]);
  s.visibility_fallback = py::cast<std::string>(d["visibility_fallback"]);
  s.report_us = py::cast<double>(d["report_us"]);
  s.total_us = py::cast<double>(d["total_us"]);
  return s;
}

/// A triangle's index or a cell's id; None where there is none.
py::object pieceOf(std::intptr_t piece) {
  return piece < 0 ? py::object(py::none()) : py::int_(piece);
}

// Pickled results hold all but the caller's own objects, which Python does not see.

py::tuple state(const BodyRef& body) {
  return py::make_tuple(body.link, body.name, body.moving != nullptr);
}

BodyRef bodyOfState(const py::tuple& s) {
  BodyRef body;
  body.link = py::cast<LinkId>(s[0]);
  body.name = py::cast<std::string>(s[1]);
  return body;
}

py::tuple witnessState(const ToleranceWitness& w) {
  return py::make_tuple(arrayOf(w.q_witness), arrayOf(w.base_deviation), arrayOf(w.deviation1), arrayOf(w.deviation2));
}

void readWitness(const py::tuple& s, ToleranceWitness& w) {
  w.q_witness = vectorOf(s[0], "q_witness");
  w.base_deviation = poseOf(s[1], "base_deviation");
  w.deviation1 = poseOf(s[2], "deviation1");
  w.deviation2 = poseOf(s[3], "deviation2");
}

py::tuple state(const CertifiedContact& c) {
  return py::make_tuple(state(c.body1), state(c.body2), c.b1, c.b2, memberOf(c.feature), array3(c.point),
                        array3(c.normal), array3(c.nearest1), array3(c.nearest2), c.approach_speed, c.t_lower,
                        c.t_upper, c.certain, witnessState(c));
}

Vector3d plainVector(const py::object& value) {
  return vectorOf(value, "vector").head<3>();
}

CertifiedContact contactOfState(const py::tuple& s) {
  CertifiedContact c;
  c.body1 = bodyOfState(s[0]);
  c.body2 = bodyOfState(s[1]);
  c.b1 = py::cast<std::intptr_t>(s[2]);
  c.b2 = py::cast<std::intptr_t>(s[3]);
  c.feature = enumOf<FeatureKind>(py::object(s[4]), "feature");
  c.point = plainVector(s[5]);
  c.normal = plainVector(s[6]);
  c.nearest1 = plainVector(s[7]);
  c.nearest2 = plainVector(s[8]);
  c.approach_speed = py::cast<double>(s[9]);
  c.t_lower = py::cast<double>(s[10]);
  c.t_upper = py::cast<double>(s[11]);
  c.certain = py::cast<bool>(s[12]);
  readWitness(s[13], c);
  return c;
}

py::object state(const std::shared_ptr<const Certificate>& certificate) {
  if (!certificate) return py::none();
  const Certificate& c = *certificate;
  return py::make_tuple(c.world ? py::object(py::bytes(*c.world)) : py::object(py::none()), py::bytes(c.motion),
                        py::bytes(c.proof), c.missing);
}

std::shared_ptr<const Certificate> certificateOfState(const py::object& value) {
  if (value.is_none()) return nullptr;
  const py::tuple s = value;
  auto c = std::make_shared<Certificate>();
  if (!py::object(s[0]).is_none()) c->world = std::make_shared<const std::string>(py::cast<std::string>(s[0]));
  c->motion = py::cast<std::string>(s[1]);
  c->proof = py::cast<std::string>(s[2]);
  c->missing = py::cast<std::string>(s[3]);
  return c;
}

py::tuple state(const Bracket& b) {
  return py::make_tuple(static_cast<int>(b.status), b.t_lower, b.t_upper, b.certain);
}

void readBracket(const py::tuple& s, Bracket& b) {
  const int status = py::cast<int>(s[0]);
  if (status < 0 || status > static_cast<int>(Status::undecided)) valueError("the pickled result has no such status");
  b.status = static_cast<Status>(status);
  b.t_lower = py::cast<double>(s[1]);
  b.t_upper = py::cast<double>(s[2]);
  b.certain = py::cast<bool>(s[3]);
}

py::list state(const std::vector<CertifiedContact>& contacts) {
  py::list states;
  for (const CertifiedContact& c : contacts) states.append(state(c));
  return states;
}

std::vector<CertifiedContact> contactsOfState(const py::list& states) {
  std::vector<CertifiedContact> contacts;
  for (const py::handle s : states) contacts.push_back(contactOfState(py::reinterpret_borrow<py::tuple>(s)));
  return contacts;
}

std::vector<Eigen::Isometry3d> posesOf(const py::handle value) {
  std::vector<Eigen::Isometry3d> poses;
  for (const py::handle pose : value) poses.push_back(poseOf(pose, "pose"));
  return poses;
}

using Pairs = std::vector<std::pair<BodyRef, BodyRef>>;

py::list state(const Pairs& pairs) {
  py::list all;
  for (const auto& [a, b] : pairs) all.append(py::make_tuple(state(a), state(b)));
  return all;
}

Pairs pairsOfState(const py::handle value) {
  Pairs pairs;
  for (const py::handle pair : py::list(py::reinterpret_borrow<py::object>(value))) {
    const auto both = py::reinterpret_borrow<py::tuple>(pair);
    pairs.emplace_back(bodyOfState(both[0]), bodyOfState(both[1]));
  }
  return pairs;
}

py::list namesOf(const Pairs& pairs) {
  py::list names;
  for (const auto& [a, b] : pairs) names.append(py::make_tuple(a.name, b.name));
  return names;
}

std::vector<std::pair<std::string, std::string>> neighboursOf(const CertifiedResult& r) {
  return r.unproven_neighbours ? *r.unproven_neighbours : std::vector<std::pair<std::string, std::string>>();
}

py::tuple resultState(const CertifiedResult& r) {
  return py::make_tuple(state(static_cast<const Bracket&>(r)), state(r.contacts), arrayOf(r.M_0_at_lower),
                        state(r.ignored_initial_contacts), r.unproven_allowed_pairs, state(r.certificate),
                        statisticsOf(r.statistics), r.never_apart_pairs, neighboursOf(r));
}

CertifiedResult resultOfState(const py::tuple& s) {
  CertifiedResult r;
  readBracket(s[0], r);
  r.contacts = contactsOfState(s[1]);
  r.M_0_at_lower = posesOf(s[2]);
  r.ignored_initial_contacts = pairsOfState(s[3]);
  r.unproven_allowed_pairs = py::cast<std::size_t>(s[4]);
  r.certificate = certificateOfState(s[5]);
  r.statistics = statisticsOfDict(s[6]);
  r.never_apart_pairs = py::cast<std::size_t>(s[7]);
  auto neighbours = py::cast<std::vector<std::pair<std::string, std::string>>>(s[8]);
  if (!neighbours.empty()) r.unproven_neighbours = std::make_shared<const decltype(neighbours)>(std::move(neighbours));
  return r;
}

py::tuple pairResultState(const CertifiedPairResult& r) {
  return py::make_tuple(state(static_cast<const Bracket&>(r)), state(r.contacts),
                        py::make_tuple(arrayOf(r.tf1_at_lower), arrayOf(r.tf2_at_lower), arrayOf(r.tf1_at_upper),
                                       arrayOf(r.tf2_at_upper)),
                        r.ignored_initial_contact, state(r.certificate), statisticsOf(r.statistics), r.never_apart);
}

CertifiedPairResult pairResultOfState(const py::tuple& s) {
  CertifiedPairResult r;
  readBracket(s[0], r);
  r.contacts = contactsOfState(s[1]);
  const std::vector<Eigen::Isometry3d> poses = posesOf(s[2]);
  r.tf1_at_lower = poses.at(0);
  r.tf2_at_lower = poses.at(1);
  r.tf1_at_upper = poses.at(2);
  r.tf2_at_upper = poses.at(3);
  r.ignored_initial_contact = py::cast<bool>(s[3]);
  r.never_apart = py::cast<bool>(s[6]);
  r.certificate = certificateOfState(s[4]);
  r.statistics = statisticsOfDict(s[5]);
  return r;
}

/// Members of all results that have contacts.
template <class Result>
void bindContacts(py::class_<Result>& bound) {
  bound
      .def_property_readonly("contacts",
                             [](const Result& r) {
                               py::list contacts;
                               for (const CertifiedContact& c : r.contacts) contacts.append(c);
                               return contacts;
                             })
      .def_property_readonly(
          "first",
          [](const Result& r) { return r.contacts.empty() ? py::object(py::none()) : py::cast(r.contacts.front()); })
      .def_property_readonly(
          "certificate",
          [](const Result& r) { return r.certificate ? py::cast(*r.certificate) : py::object(py::none()); })
      .def_property_readonly("statistics", [](const Result& r) { return statisticsOf(r.statistics); });
}

/// q_witness and the deviations beside it, each None where there is no witness.
template <class Witness>
void bindWitness(py::class_<Witness>& type) {
  const auto bind = [&](const char* name, auto member) {
    type.def_property_readonly(name, [member](const Witness& w) {
      return w.q_witness.size() > 0 ? py::object(arrayOf(w.*member)) : py::object(py::none());
    });
  };
  bind("q_witness", &ToleranceWitness::q_witness);
  bind("base_deviation", &ToleranceWitness::base_deviation);
  bind("deviation1", &ToleranceWitness::deviation1);
  bind("deviation2", &ToleranceWitness::deviation2);
}

/// ": A and B" of what a search has found; empty: it has no pair.
template <class Found>
std::string pairText(const Found& found) {
  return std::isfinite(found.upper) ? ": " + found.body1.name + " and " + found.body2.name : "";
}

/// Properties of all searches' answers.
template <class Found>
void bindFound(py::class_<Found>& bound) {
  bound.def_readonly("lower", &Found::lower)
      .def_readonly("upper", &Found::upper)
      .def_readonly("time", &Found::time)
      .def_property_readonly("pair",
                             [](const Found& found) -> py::object {
                               if (!std::isfinite(found.upper)) return py::none();
                               return py::make_tuple(found.body1.name, found.body2.name);
                             })
      .def_readonly("body1", &Found::body1)
      .def_readonly("body2", &Found::body2)
      .def_property_readonly("ignored_initial_contacts",
                             [](const Found& found) { return namesOf(found.ignored_initial_contacts); })
      .def_property_readonly("statistics", [](const Found& found) { return statisticsOf(found.statistics); });
}

void bindCertificate(py::module_& module) {
  py::class_<Certificate>(module, "Certificate", "The proof of an answer, which fcl_artic_verify proves again.")
      .def_property_readonly(
          "world",
          [](const Certificate& c) { return c.world ? py::object(py::str(*c.world)) : py::object(py::none()); })
      .def_readonly("motion", &Certificate::motion)
      .def_property_readonly("proof", [](const Certificate& c) { return py::bytes(c.proof); })
      .def_readonly("missing", &Certificate::missing)
      .def(
          "record", [](const Certificate& c) { return py::bytes(c.record()); },
          "Motion and proof as one record of a certificate file.")
      .def(
          "save",
          [](const Certificate& c, py::handle path) {
            if (!c) valueError("there is no proof: " + c.missing);
            const auto file = py::cast<std::string>(py::module_::import("os").attr("fspath")(path));
            const std::string record = c.record();  // names the world's hash
            writeFiles({{file + ".world", *c.world}, {file, record}});
          },
          "Writes the proof, and what stands and moves beside it, PATH.world, for `fcl_artic_verify PATH.world PATH`.",
          py::arg("path"))
      .def("__bool__", [](const Certificate& c) { return static_cast<bool>(c); })
      .def("__repr__",
           [](const Certificate& c) {
             return c ? "<Certificate: " + std::to_string(c.proof.size()) + " bytes>"
                      : "<Certificate: none, " + c.missing + ">";
           })
      .def(
          py::pickle([](const Certificate& c) { return py::make_tuple(state(std::make_shared<const Certificate>(c))); },
                     [](const py::tuple& s) { return Certificate(*certificateOfState(s[0])); }));
}

}  // namespace

py::dict statisticsOf(const QueryStatistics& s) {
  py::dict d = fieldsOf(static_cast<const StandardStatistics&>(s));
  d["pairs"] = s.pairs;
  d["pairs_after_culling"] = s.pairs_after_culling;
  d["visibility"] = fieldsOf(s.visibility);
  d["visibility_executor"] = s.visibility_executor;
  d["visibility_fallback"] = s.visibility_fallback;
  d["redon"] = fieldsOf(s.redon);
  d["report_us"] = s.report_us;
  d["total_us"] = s.total_us;
  return d;
}

void bindResults(py::module_& module) {
  bindCertificate(module);

  py::class_<BodyRef>(module, "Body", "A body of an answer: a link, what a link carries, or an obstacle.")
      .def_readonly("name", &BodyRef::name)
      .def_property_readonly(
          "link", [](const BodyRef& b) { return b.link < 0 ? py::object(py::none()) : py::object(py::int_(b.link)); })
      .def("__str__", [](const BodyRef& b) { return b.name; })
      .def("__repr__", [](const BodyRef& b) { return py::str("<Body {!r}>").format(b.name); })
      .def(py::pickle([](const BodyRef& b) { return state(b); }, &bodyOfState));

  py::class_<CertifiedContact> contact(module, "Contact", "One contact; the normal points from body 1 to body 2.");
  bindWitness(contact);
  contact.def_readonly("body1", &CertifiedContact::body1)
      .def_readonly("body2", &CertifiedContact::body2)
      .def_property_readonly("pair",
                             [](const CertifiedContact& c) { return py::make_tuple(c.body1.name, c.body2.name); })
      .def_property_readonly("piece1", [](const CertifiedContact& c) { return pieceOf(c.b1); })
      .def_property_readonly("piece2", [](const CertifiedContact& c) { return pieceOf(c.b2); })
      .def_property_readonly("feature", [](const CertifiedContact& c) { return memberOf(c.feature); })
      .def_property_readonly("point", [](const CertifiedContact& c) { return array3(c.point); })
      .def_property_readonly("normal", [](const CertifiedContact& c) { return array3(c.normal); })
      .def_property_readonly("nearest1", [](const CertifiedContact& c) { return array3(c.nearest1); })
      .def_property_readonly("nearest2", [](const CertifiedContact& c) { return array3(c.nearest2); })
      .def_readonly("approach_speed", &CertifiedContact::approach_speed)
      .def_readonly("t_lower", &CertifiedContact::t_lower)
      .def_readonly("t_upper", &CertifiedContact::t_upper)
      .def_readonly("certain", &CertifiedContact::certain)
      .def("__repr__", [](const CertifiedContact& c) { return "<Contact: " + printed(c) + ">"; })
      .def(py::pickle([](const CertifiedContact& c) { return state(c); }, &contactOfState));

  py::class_<CertifiedResult> result(module, "Result", "The answer of a world: verdict, bracket, contacts, work.");
  bindBracket(result);
  bindContacts(result);
  result
      .def_property_readonly("pair",
                             [](const CertifiedResult& r) -> py::object {
                               if (r.contacts.empty()) return py::none();
                               return py::make_tuple(r.contacts.front().body1.name, r.contacts.front().body2.name);
                             })
      .def_property_readonly("link_poses", [](const CertifiedResult& r) { return arrayOf(r.M_0_at_lower); })
      .def_property_readonly("ignored_initial_contacts",
                             [](const CertifiedResult& r) { return namesOf(r.ignored_initial_contacts); })
      .def_readonly("never_apart_pairs", &CertifiedResult::never_apart_pairs)
      .def_readonly("unproven_allowed_pairs", &CertifiedResult::unproven_allowed_pairs)
      .def_property_readonly("unproven_neighbours", &neighboursOf)
      .def_property_readonly("nothing_checked", &CertifiedResult::nothingChecked)
      .def("__str__", [](const CertifiedResult& r) { return printed(r); })
      .def("__repr__",
           [](const CertifiedResult& r) {
             std::string text = "<Result: " + printed(r);
             if (const CertifiedContact* c = r.first()) text += ": " + c->body1.name + " and " + c->body2.name;
             return text + ">";
           })
      .def(py::pickle(&resultState, &resultOfState));

  py::class_<CertifiedPairResult> pair(module, "PairResult", "The answer for two moving bodies.");
  bindBracket(pair);
  bindContacts(pair);
  pair.def_property_readonly("pose1_at_lower", [](const CertifiedPairResult& r) { return arrayOf(r.tf1_at_lower); })
      .def_property_readonly("pose2_at_lower", [](const CertifiedPairResult& r) { return arrayOf(r.tf2_at_lower); })
      .def_property_readonly("pose1_at_upper", [](const CertifiedPairResult& r) { return arrayOf(r.tf1_at_upper); })
      .def_property_readonly("pose2_at_upper", [](const CertifiedPairResult& r) { return arrayOf(r.tf2_at_upper); })
      .def_readonly("ignored_initial_contact", &CertifiedPairResult::ignored_initial_contact)
      .def_readonly("never_apart", &CertifiedPairResult::never_apart)
      .def("__str__", [](const CertifiedPairResult& r) { return printed(r); })
      .def("__repr__", [](const CertifiedPairResult& r) { return "<PairResult: " + printed(r) + ">"; })
      .def(py::pickle(&pairResultState, &pairResultOfState));

  py::class_<Clearance> clearance(module, "Clearance",
                                  "The smallest distance over a whole motion: lower <= distance <= upper.");
  bindFound(clearance);
  clearance.def_readonly("within_tolerance", &Clearance::within_tolerance)
      .def("__repr__",
           [](const Clearance& c) {
             return py::str("<Clearance: from {:.6g} to {:.6g} m, t = {:.6g}{}>")
                 .format(c.lower, c.upper, c.time, pairText(c));
           })
      .def(py::pickle(
          [](const Clearance& c) {
            return py::make_tuple(c.lower, c.upper, c.time, state(c.body1), state(c.body2), c.within_tolerance,
                                  statisticsOf(c.statistics), state(c.ignored_initial_contacts));
          },
          [](const py::tuple& s) {
            Clearance c;
            c.lower = py::cast<double>(s[0]);
            c.upper = py::cast<double>(s[1]);
            c.time = py::cast<double>(s[2]);
            c.body1 = bodyOfState(s[3]);
            c.body2 = bodyOfState(s[4]);
            c.within_tolerance = py::cast<bool>(s[5]);
            c.statistics = statisticsOfDict(s[6]);
            c.ignored_initial_contacts = pairsOfState(s[7]);
            return c;
          }));

  py::class_<ToleranceLeft> left(module, "ToleranceLeft",
                                 "How many times all tolerances may be as large: lower is free, upper is not proven.");
  bindFound(left);
  bindWitness(left);
  left.def_readonly("certain", &ToleranceLeft::certain)
      .def_readonly("within_accuracy", &ToleranceLeft::within_accuracy)
      .def("__repr__",
           [](const ToleranceLeft& l) {
             return py::str("<ToleranceLeft: from {:.6g} to {:.6g} times, t = {:.6g}{}>")
                 .format(l.lower, l.upper, l.time, pairText(l));
           })
      .def(py::pickle(
          [](const ToleranceLeft& l) {
            return py::make_tuple(l.lower, l.upper, l.time, state(l.body1), state(l.body2), l.certain, witnessState(l),
                                  l.within_accuracy, statisticsOf(l.statistics), state(l.ignored_initial_contacts));
          },
          [](const py::tuple& s) {
            ToleranceLeft l;
            l.lower = py::cast<double>(s[0]);
            l.upper = py::cast<double>(s[1]);
            l.time = py::cast<double>(s[2]);
            l.body1 = bodyOfState(s[3]);
            l.body2 = bodyOfState(s[4]);
            l.certain = py::cast<bool>(s[5]);
            readWitness(s[6], l);
            l.within_accuracy = py::cast<bool>(s[7]);
            l.statistics = statisticsOfDict(s[8]);
            l.ignored_initial_contacts = pairsOfState(s[9]);
            return l;
          }));
}

}  // namespace fcl_artic::python
