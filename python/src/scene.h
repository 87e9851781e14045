// SPDX-License-Identifier: BSD-3-Clause
//
// Scenes in Python.
#pragma once

#include "fcl_artic/urdf/urdf.h"
#include "geometry.h"

namespace fcl_artic::python {

void bindScene(py::module_& module);

}  // namespace fcl_artic::python
