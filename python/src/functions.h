// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

namespace fcl_artic::python {

namespace py = pybind11;

/// Gives all functions of the module, those of its classes and properties too, their common behaviour. Each call is a
/// Call. Their docstrings begin with their signatures in the stub (signatures.py), and the TypeError for arguments that
/// a function does not take ends with it. To be called once all are there.
void completeFunctions(const py::module_& module);

}  // namespace fcl_artic::python
