// SPDX-License-Identifier: BSD-3-Clause
#include "link_pairs.h"

#include <sstream>

#include "enums.h"
#include "robot.h"
#include "text/counted.h"
#include "watch.h"

namespace fcl_artic::python {

LinkPairReport classifyWatched(py::handle only, double margin, std::uint64_t work, std::size_t samples, int threads,
                               py::object progress,
                               const std::function<void(const std::function<void(const ClassifyWith&)>&)>& ask) {
  struct Stopped {};
  LinkPairOptions options;
  AllowedCollisionMatrix pairs;
  if (!only.is_none()) {
    pairs = matrixOfPairs(only, "only");
    options.only = &pairs;
  }
  options.margin = margin;
  options.work = work;
  options.samples = samples;
  options.threads = threads;
  Watch watch(std::move(progress));
  LinkPairReport report;
  ask([&](const ClassifyWith& classify) {
    runWatched(watch, [&](const auto& goOn) {
      options.progress = [&](std::size_t done, std::size_t total) {
        if (!goOn(total == 0 ? 1 : static_cast<double>(done) / static_cast<double>(total))) throw Stopped();
      };
      report = classify(options);
    });
  });
  watch.finish();
  if (watch.stopped()) throw std::runtime_error("progress ended the classification of the pairs of links");
  return report;
}

void bindLinkPairs(py::module_& module) {
  py::class_<Proofs>(module, "LinkPairProofs",
                     "Proofs that pairs of links never touch within the joints' limits, for Robot and World.");

  py::class_<LinkPairFinding>(module, "LinkPairFinding", "What was found of one pair of links.")
      .def_readonly("link1", &LinkPairFinding::link1)
      .def_readonly("link2", &LinkPairFinding::link2)
      .def_property_readonly("kind", [](const LinkPairFinding& f) { return memberOf(f.kind); })
      .def_readonly("neighbours", &LinkPairFinding::neighbours)
      .def_readonly("proven", &LinkPairFinding::proven)
      .def_readonly("tried", &LinkPairFinding::tried)
      .def_readonly("touching", &LinkPairFinding::touching)
      .def_readonly("apart", &LinkPairFinding::apart)
      .def_property_readonly("configuration", [](const LinkPairFinding& f) { return arrayOf(f.configuration); })
      .def_readonly("nearest", &LinkPairFinding::nearest)
      .def("__repr__", [](const LinkPairFinding& f) {
        std::ostringstream out;
        out << f;
        return "<LinkPairFinding: " + out.str() + ">";
      });

  py::class_<LinkPairReport>(module, "LinkPairReport", "What was found of all pairs of links with geometry.")
      .def_property_readonly("pairs",
                             [](const LinkPairReport& r) {
                               py::list pairs;
                               for (const LinkPairFinding& finding : r.pairs) pairs.append(finding);
                               return pairs;
                             })
      .def_property_readonly("proofs", [](const LinkPairReport& r) { return Proofs{r.proofs}; })
      .def_property_readonly("always_touching", [](const LinkPairReport& r) { return pairsOf(r.alwaysTouching()); })
      .def_property_readonly("need_no_check", [](const LinkPairReport& r) { return pairsOf(r.needNoCheck()); })
      .def(
          "count", [](const LinkPairReport& r, py::handle kind) { return r.count(enumOf<LinkPairKind>(kind, "kind")); },
          "Number of pairs of a kind.", py::arg("kind"))
      .def(
          "write_srdf",
          [](const LinkPairReport& r, py::handle path, const std::string& robot_name) {
            const auto file = py::cast<std::string>(py::module_::import("os").attr("fspath")(path));
            try {
              writeSrdf(file, robot_name, r);
            } catch (const std::runtime_error& problem) {
              PyErr_SetString(PyExc_OSError, problem.what());
              throw py::error_already_set();
            }
          },
          "Writes an SRDF file with the pairs that need no check within the joints' limits.", py::arg("path"),
          py::arg("robot_name"))
      .def("__len__", [](const LinkPairReport& r) { return r.pairs.size(); })
      .def("__repr__", [](const LinkPairReport& r) {
        std::string text = "<LinkPairReport: " + text::counted(r.pairs.size(), "pair");
        for (const auto kind :
             {LinkPairKind::never, LinkPairKind::always, LinkPairKind::sometimes, LinkPairKind::unproven}) {
          text += ", " + std::to_string(r.count(kind)) + " " + toString(kind);
        }
        return text + ">";
      });
}

}  // namespace fcl_artic::python
