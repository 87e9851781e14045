// SPDX-License-Identifier: BSD-3-Clause
#include "world.h"

namespace fcl_artic::python {
namespace {
struct NoPlan {};
}  // namespace

void bindPlans(py::module_& module, py::class_<World>&) {
  py::class_<NoPlan>(module, "Plan",
                     "A plan of a file. This module was built without nlohmann-json or fmt and reads none.");
  module.def("load_plans", [](const py::args&, const py::kwargs&) {
    valueError(
        "this module was built without nlohmann-json or fmt (Debian: nlohmann-json3-dev, libfmt-dev), it reads no "
        "plans");
  });
}

}  // namespace fcl_artic::python
