// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

namespace fcl_artic::python {

namespace py = pybind11;

/// Gives properties their docstrings; to be called once all classes are there.
/// @throws py::error_already_set for a property that is not there.
void documentProperties(const py::module_& module);

}  // namespace fcl_artic::python
