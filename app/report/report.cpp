// SPDX-License-Identifier: BSD-3-Clause
#include "report.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "kinematics/angles.h"
#include "numerics/rotation.h"
#include "request_json.h"
#include "stage2.h"
#include "text/counted.h"
#include "text/one_line.h"

namespace fcl_artic::app {
namespace {

using Json = nlohmann::ordered_json;

/// A body that a link carries has a name other than the link's; no obstacle or attached object has the name of a link.
bool isAttached(const KinematicTree& tree, const BodyRef& body) {
  return body.link >= 0 && body.name != tree.linkName(body.link);
}

const char* kindOf(const KinematicTree& tree, const BodyRef& body) {
  if (isAttached(tree, body)) return "attached object";
  return body.link >= 0 ? "link" : "obstacle";
}

std::string bodyText(const KinematicTree& tree, const BodyRef& body, std::intptr_t primitive) {
  std::string text = fmt::format("{} '{}'", kindOf(tree, body), body.name);
  if (isAttached(tree, body)) text += fmt::format(" on link '{}'", tree.linkName(body.link));
  if (primitive >= 0) text += fmt::format(" (triangle {})", primitive);
  return text;
}

/// Joint values at time t, one "name = value" each.
std::string jointsText(const KinematicTree& tree, const Eigen::VectorXd& q) {
  std::string text;
  for (int v = 0; v < tree.dof(); ++v) {
    const int quaternion = tree.quaternionVariable(tree.variableJoint(v));
    const bool length = !tree.isAngle(v) && (quaternion < 0 || v < quaternion);
    text += v ? ", " : "";
    text += fmt::format("{} = {:.6g}", tree.variableName(v), q[v]);
    if (length) text += " m";
    if (tree.isAngle(v)) text += fmt::format(" rad ({:.2f} deg)", q[v] / kRadiansPerDegree);
  }
  return text;
}

/// A labelled entry of the report, its text broken at blanks so that lines stay within 100 columns.
std::string entry(const std::string& label, const std::string& given) {
  const std::string text = text::oneLine(given);
  constexpr std::size_t kLabel = 10, kColumns = 100;
  std::string out = fmt::format("  {:<{}}", label, kLabel);
  std::size_t column = 2 + kLabel, at = 0;
  while (at < text.size()) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    const std::size_t length = end - at;
    if (column > 2 + kLabel && column + 1 + length > kColumns) {
      out += "\n" + std::string(2 + kLabel, ' ');
      column = 2 + kLabel;
    } else if (column > 2 + kLabel) {
      out += ' ';
      ++column;
    }
    out.append(text, at, length);
    column += length;
    at = end + 1;
  }
  return out + "\n";
}

/// The shortest decimals in which the ends of the bracket still differ.
std::string bracketText(double lower, double upper) {
  return fmt::format("[{:.12g}, {:.12g}]", lower, upper);
}

std::string contactText(const KinematicTree& tree, const CertifiedContact& c) {
  std::string text =
      entry("pair", fmt::format("{} and {}", bodyText(tree, c.body1, c.b1), bodyText(tree, c.body2, c.b2)));
  text += entry("time", fmt::format("t in {}, {}", bracketText(c.t_lower, c.t_upper),
                                    c.certain ? "contact proven" : "contact not proven: nearer than can be decided"));
  text += entry(
      "point", fmt::format("{} m in the world, at t = {:.12g}", placeText(c.point), c.certain ? c.t_upper : c.t_lower));
  if (c.approach_speed != 0) {
    text += entry("witness", fmt::format("nearest at t = {:.12g}: {} and {} m, approaching at {:.6g} m per unit of t",
                                         c.t_lower, placeText(c.nearest1), placeText(c.nearest2), c.approach_speed));
  }
  text += entry("normal", fmt::format("{} from '{}' to '{}', {}", directionText(c.normal), c.body1.name, c.body2.name,
                                      toString(c.feature)));
  return text;
}

std::string clearanceText(const KinematicTree& tree, const Clearance& c) {
  const bool any = std::isfinite(c.upper);
  std::string text = fmt::format("proven: no checked pair comes nearer than {:.6g} m", c.lower);
  if (c.upper == 0) text = "none";
  if (any) {
    text += fmt::format("; {} and {} are within {:.6g} m at t = {:.12g}", bodyText(tree, c.body1, -1),
                        bodyText(tree, c.body2, -1), c.upper, c.time);
  }
  if (!c.ignored_initial_contacts.empty()) text += ", the ignored pairs apart";
  return text + (c.within_tolerance ? "" : " (the search ended early)");
}

std::string toleranceLeftText(const KinematicTree& tree, const ToleranceLeft& left) {
  const std::string pair = fmt::format("{} and {}", bodyText(tree, left.body1, -1), bodyText(tree, left.body2, -1));
  std::string text = fmt::format("tolerances times {:.3g} are still free", left.lower);
  if (left.upper == 0) {
    text =
        fmt::format("none: {} {} at t = {:.6g} without any tolerance", pair,
                    left.certain ? "touch, or are within their margin," : "are nearer than can be decided", left.time);
  } else if (std::isfinite(left.upper)) {
    text += fmt::format("; limited by {} at t = {:.6g}: at {:.3g} times they {}", pair, left.time, left.upper,
                        left.certain ? "may touch, proven" : "can't be proven apart");
  }
  if (!left.ignored_initial_contacts.empty()) text += ", the ignored pairs apart";
  return text + (left.within_accuracy ? "" : " (the search ended early)");
}

std::string statisticsText(const QueryStatistics& s) {
  return fmt::format(
      "{}, {} left by the swept bounds; {}, {}, {}, {}, {}; {:.3f} ms (culling {:.3f}, narrow phase {:.3f}, report "
      "{:.3f})",
      text::counted(s.pairs, "pair"), s.pairs_after_culling, text::counted(s.node_tests, "node test"),
      text::counted(s.leaf_tests, "leaf test"), text::counted(s.certificates, "certificate"),
      text::counted(s.gjk, "witness search", "witness searches"), text::counted(s.contact_proofs, "contact proof"),
      s.total_us * 1e-3, s.culling_us * 1e-3, s.narrowphase_us * 1e-3, s.report_us * 1e-3);
}

template <class Statistics>
void addFields(const Statistics& s, Json& out) {
  Statistics::forEachField([&](const char* name, auto field) { out[name] = s.*field; });
}

Json certificateJson(const Certificate& certificate) {
  if (!certificate) return {{"missing", certificate.missing}};
  return {{"proof_bytes", certificate.proof.size()}};
}

/// Work of the query; of the paper's own method null where another one was asked for.
Json statisticsJson(const Report& r) {
  const QueryStatistics& s = r.result.statistics;
  Json out = {{"pairs", s.pairs}, {"pairs_after_culling", s.pairs_after_culling}};
  addFields<StandardStatistics>(s, out);
  out["report_us"] = s.report_us;
  out["total_us"] = s.total_us;
  out["redon2004"] = nullptr;
  if (r.request.method == Method::redon2004) addFields(s.redon, out["redon2004"] = Json::object());
  return out;
}

Json vectorJson(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

Json valuesJson(const KinematicTree& tree, const Eigen::VectorXd& q) {
  Json out = Json::object();
  for (int v = 0; v < tree.dof(); ++v) out[tree.variableName(v)] = q[v];
  return out;
}

Json bodyJson(const KinematicTree& tree, const BodyRef& body, std::intptr_t primitive) {
  Json out{{"name", body.name}, {"kind", kindOf(tree, body)}};
  if (isAttached(tree, body)) out["link"] = tree.linkName(body.link);
  out["triangle"] = primitive >= 0 ? Json(primitive) : Json();
  return out;
}

/// A bracket that a search has found, with the pair and the time of its upper end.
template <class Found>
Json foundJson(const KinematicTree& tree, const Found& found) {
  const bool any = std::isfinite(found.upper);
  Json ignored = Json::array();
  for (const auto& [a, b] : found.ignored_initial_contacts) ignored.push_back({a.name, b.name});
  return {{"lower", found.lower},
          {"upper", any ? Json(found.upper) : Json()},
          {"t", any ? Json(found.time) : Json()},
          {"body1", any ? bodyJson(tree, found.body1, -1) : Json()},
          {"body2", any ? bodyJson(tree, found.body2, -1) : Json()},
          {"ignored_initial_contacts", ignored}};
}

Json clearanceJson(const KinematicTree& tree, const Clearance& c) {
  Json out = foundJson(tree, c);
  out["within_tolerance"] = c.within_tolerance;
  return out;
}

Json poseJson(const Eigen::Isometry3d& M) {
  const Eigen::Quaterniond rotation(M.linear());
  return {{"position", vectorJson(M.translation())},
          {"quaternion_xyzw", {rotation.x(), rotation.y(), rotation.z(), rotation.w()}}};
}

/// Adds the configuration and the deviations, each null where there is none.
void addWitness(const KinematicTree& tree, const ToleranceWitness& witness, Json& out) {
  out["q_witness"] = witness.q_witness.size() > 0 ? valuesJson(tree, witness.q_witness) : Json();
  const auto add = [&](const char* key, const Eigen::Isometry3d& deviation) {
    out[key] = isIdentity(deviation) ? Json() : poseJson(deviation);
  };
  add("base_deviation", witness.base_deviation);
  add("deviation1", witness.deviation1);
  add("deviation2", witness.deviation2);
}

Json toleranceLeftJson(const KinematicTree& tree, const ToleranceLeft& left) {
  Json out = foundJson(tree, left);
  out["certain"] = left.certain;
  addWitness(tree, left, out);
  out["within_accuracy"] = left.within_accuracy;
  return out;
}

/// "t = 0.5: joint = 1; the base is off by (0.001, 0, 0) m and 0.05 deg".
std::string witnessText(const KinematicTree& tree, const CertifiedContact& c) {
  std::string text = fmt::format("within the tolerances, at t = {:.12g}: {}", c.t_upper, jointsText(tree, c.q_witness));
  const auto add = [&](const std::string& who, const Eigen::Isometry3d& deviation) {
    if (isIdentity(deviation)) return;
    const double angle = Eigen::AngleAxisd(deviation.linear()).angle() / kRadiansPerDegree;
    text += fmt::format("; {} is off by {} m", who, placeText(deviation.translation(), 6));
    if (angle > 0) text += fmt::format(" and {:.6g} deg", angle);
  };
  add("the base", c.base_deviation);
  add(fmt::format("'{}'", c.body1.name), c.deviation1);
  add(fmt::format("'{}'", c.body2.name), c.deviation2);
  return text;
}

Json contactJson(const KinematicTree& tree, const CertifiedContact& c) {
  Json out{{"body1", bodyJson(tree, c.body1, c.b1)},
           {"body2", bodyJson(tree, c.body2, c.b2)},
           {"t_lower", c.t_lower},
           {"t_upper", c.t_upper},
           {"certain", c.certain},
           {"point", vectorJson(c.point)},
           {"normal", vectorJson(c.normal)},
           {"nearest1", vectorJson(c.nearest1)},
           {"nearest2", vectorJson(c.nearest2)},
           {"approach_speed", c.approach_speed},
           {"feature", toString(c.feature)}};
  addWitness(tree, c, out);
  return out;
}

Json neighboursJson(const CertifiedResult& result) {
  Json out = Json::array();
  if (!result.unproven_neighbours) return out;
  for (const auto& [a, b] : *result.unproven_neighbours) out.push_back({a, b});
  return out;
}

Json posesJson(const Report& r) {
  Json out = Json::object();
  std::vector<Eigen::Isometry3d> at_lower;
  r.tree.forwardKinematics(r.configuration(r.result.t_lower), at_lower);
  for (LinkId link = 0; link < r.tree.numLinks(); ++link) {
    out[r.tree.linkName(link)] = poseJson(at_lower[static_cast<std::size_t>(link)]);
  }
  return out;
}

}  // namespace

std::string placeText(const Eigen::Vector3d& place, int digits) {
  // The rounding of sines and cosines, some 1e-16 each, leaves this much of a coordinate that is 0.
  const double noise = 1e-15 * std::max(1.0, place.cwiseAbs().maxCoeff());
  const auto text = [&](double x) { return fmt::format("{:.{}g}", std::abs(x) <= noise ? 0.0 : x, digits); };
  return fmt::format("({}, {}, {})", text(place.x()), text(place.y()), text(place.z()));
}

std::string directionText(const Eigen::Vector3d& direction, int decimals) {
  const double unit = std::pow(10, decimals);
  return placeText((direction * unit).array().round() / unit, decimals);
}

std::string scopeText(const CertifiedRequest& request) {
  std::string text;
  if (!request.check_self) text = "links with links are not checked (--no-self)";
  if (!request.check_scene) text += (text.empty() ? "" : "; ") + std::string("obstacles are not checked (--no-scene)");
  return text;
}

std::string headline(const Report& r) {
  const CertifiedResult& result = r.result;
  switch (result.status) {
    case Status::free: {
      const std::string exceptions = exceptionsOf(result), unproven = exceptions.empty() ? "" : " " + exceptions;
      if (result.nothingChecked()) {
        return fmt::format("NOTHING CHECKED{}: there is no pair of bodies that must not touch.", unproven);
      }
      if (!r.request_known) {
        return fmt::format("FREE{}: proven, no checked pair touches, or comes within the margin that was asked for.",
                           unproven);
      }
      return r.request.margin > 0
                 ? fmt::format(
                       "FREE{}: proven, no checked pair comes within its margin, {:g} m unless it has its own, "
                       "anywhere on the motion.",
                       unproven, r.request.margin)
                 : fmt::format("FREE{}: proven, no checked pair touches anywhere on the motion.", unproven);
    }
    case Status::contact: {
      const std::string what =
          r.request_known && r.request.margin > 0
              ? fmt::format("first approach within the margin, {:g} m unless the pair has its own,", r.request.margin)
              : "first contact";
      if (result.t_upper <= r.begin) {
        return fmt::format("CONTACT: at the start, t = {:g}{}.", r.begin, result.certain ? ", proven" : "");
      }
      if (result.certain && !r.tolerances.empty()) {
        return fmt::format("CONTACT within the tolerances: from t = {:.6g} on, proven by t = {:.6g}.", result.t_lower,
                           result.t_upper);
      }
      // At the start there is no before.
      const bool at_start = result.t_lower <= r.begin;
      return result.certain
                 ? fmt::format("CONTACT: {} at t = {:.6g}, proven{}.", what, result.t_lower,
                               at_start ? "" : "; free before")
                 : fmt::format("CONTACT (not certain): {}t = {:.6g}, a pair is nearer than can be decided{}.",
                               at_start ? "at the start, " : "at ", result.t_lower,
                               at_start ? " within the tolerances" : "; free before, proven");
    }
    case Status::undecided:
      return r.request_known && r.request.work_budget > 0
                 ? fmt::format("UNDECIDED: the work budget of {} tests ran out; proven free only for t < {:.6g}.",
                               r.request.work_budget, result.t_lower)
                 : fmt::format("UNDECIDED: the search was ended; proven free only for t < {:.6g}.", result.t_lower);
  }
  return {};
}

std::string textReport(const Report& r) {
  const CertifiedResult& result = r.result;
  std::string text = text::oneLine(headline(r)) + "\n";
  if (const std::string scope = scopeText(r.request); r.request_known && !scope.empty()) text += entry("scope", scope);
  if (!r.tolerances.empty()) {
    text += entry("tolerance",
                  fmt::format("{}every path within {}", result.isFree() ? "free is " : "asked of ", r.tolerances));
  }
  const bool several = result.contacts.size() > 1;
  for (std::size_t i = 0; i < result.contacts.size(); ++i) {
    if (several) text += fmt::format(" contact {} of {}\n", i + 1, result.contacts.size());
    text += contactText(r.tree, result.contacts[i]);
    if (result.contacts[i].q_witness.size() > 0) text += entry("touch", witnessText(r.tree, result.contacts[i]));
  }
  if (r.clearance) text += entry("clearance", clearanceText(r.tree, *r.clearance));
  if (r.tolerance_left) text += entry("left", toleranceLeftText(r.tree, *r.tolerance_left));
  if (result.status != Status::free) {
    text += entry("joints", fmt::format("at t = {:.12g}: {}", result.t_lower,
                                        jointsText(r.tree, r.configuration(result.t_lower))));
  }
  for (const auto& [a, b] : result.ignored_initial_contacts) {
    text +=
        entry("ignored", fmt::format("'{}' and '{}' touch, or are within their margin, at t = {:g} and may separate",
                                     a.name, b.name, r.begin));
  }
  for (const std::string& note : r.notes) text += entry("note", note);
  if (r.request.visibility != VisibilityMode::off) text += entry("stage 2", visibilityText(result.statistics));
  return text + entry("work", statisticsText(result.statistics));
}

nlohmann::ordered_json jsonReport(const Report& r) {
  const CertifiedResult& result = r.result;
  Json ignored = Json::array(), contacts = Json::array();
  for (const auto& [a, b] : result.ignored_initial_contacts) ignored.push_back({a.name, b.name});
  for (const CertifiedContact& c : result.contacts) contacts.push_back(contactJson(r.tree, c));
  return {{"status", toString(result.status)},
          {"t_lower", result.t_lower},
          {"t_upper", result.t_upper},
          {"certain", result.certain},
          {"nothing_checked", result.nothingChecked()},
          {"t_begin", r.begin},
          {"t_end", r.end},
          {"robot", r.tree.name()},
          {"q_from", valuesJson(r.tree, r.configuration(r.begin))},
          {"q_to", valuesJson(r.tree, r.configuration(r.end))},
          {"q_at_t_lower", valuesJson(r.tree, r.configuration(result.t_lower))},
          {"contacts", contacts},
          {"poses", posesJson(r)},
          {"clearance", r.clearance ? clearanceJson(r.tree, *r.clearance) : Json()},
          {"tolerance_left", r.tolerance_left ? toleranceLeftJson(r.tree, *r.tolerance_left) : Json()},
          {"ignored_initial_contacts", ignored},
          {"never_apart_pairs", result.never_apart_pairs},
          {"unproven_allowed_pairs", result.unproven_allowed_pairs},
          {"unproven_neighbours", neighboursJson(result)},
          {"certificate", result.certificate ? certificateJson(*result.certificate) : Json()},
          {"tolerances", r.tolerances.empty() ? Json() : Json(r.tolerances)},
          {"request", r.request_known ? requestJson(r.request) : Json()},
          {"visibility", visibilityJson(r.request.visibility, result.statistics)},
          {"statistics", statisticsJson(r)},
          {"notes", r.notes}};
}

}  // namespace fcl_artic::app
