// SPDX-License-Identifier: BSD-3-Clause
//
// The module _fcl_artic_bench: the questions of overhead.py, asked from C++ of the same world. All in the library's own
// way: motions are made of rows, one request, results whose memory is used again.
#include <chrono>

#include "../src/world.h"

namespace fcl_artic::python {
namespace {

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

double checkEach(const World& world, py::handle q0, py::handle q1) {
  const Matrix a = matrixOf(q0, "q0"), b = matrixOf(q1, "q1");
  return world.manager().ask([&](const ArticulatedCollisionManager& manager) {
    std::vector<std::pair<Eigen::VectorXd, Eigen::VectorXd>> pairs;
    for (Eigen::Index i = 0; i < a.rows().rows(); ++i) {
      pairs.emplace_back(a.rows().row(i).transpose(), b.rows().row(i).transpose());
    }
    std::size_t free = 0;
    const auto begin = Clock::now();
    for (const auto& [from, to] : pairs) free += manager.continuousCollide(from, to).isFree();
    const double elapsed = secondsSince(begin);
    return free == pairs.size() ? elapsed : std::numeric_limits<double>::quiet_NaN();
  });
}

double checkMany(const World& world, py::handle q0, py::handle q1, int threads) {
  const Matrix a = matrixOf(q0, "q0"), b = matrixOf(q1, "q1");
  return world.manager().ask([&](const ArticulatedCollisionManager& manager) {
    const auto begin = Clock::now();
    std::vector<JointMotion> motions;
    motions.reserve(static_cast<std::size_t>(a.rows().rows()));
    for (Eigen::Index i = 0; i < a.rows().rows(); ++i) {
      motions.push_back(JointMotion::linear(*world.tree(), a.rows().row(i).transpose(), b.rows().row(i).transpose()));
    }
    std::vector<CertifiedResult> results;
    manager.continuousCollide(motions, {}, results, threads);
    return secondsSince(begin);
  });
}

}  // namespace
}  // namespace fcl_artic::python

PYBIND11_MODULE(_fcl_artic_bench, module) {
  using namespace fcl_artic::python;
  py::module_::import("fcl_artic");  // World
  module.def("check_each", &checkEach);
  module.def("check_many", &checkMany);
}
