// SPDX-License-Identifier: BSD-3-Clause
//
// Answers in Python.
#pragma once

#include "array.h"
#include "enums.h"
#include "fcl_artic/continuous_manager.h"
#include "fcl_artic/pair_result.h"
#include "fcl_artic/result.h"

namespace fcl_artic::python {

/// Work of a query as a dict by the names of QueryStatistics.
py::dict statisticsOf(const QueryStatistics& statistics);

/// Gives a class of results the members that all of them have: verdict and bracket. A result has no truth value: nobody
/// could know whether True were "free" or "contact".
template <class Result, class... Rest>
void bindBracket(py::class_<Result, Rest...>& bound) {
  bound.def_property_readonly("status", [](const Result& r) { return memberOf(r.status); })
      .def_property_readonly("free", [](const Result& r) { return r.status == Status::free; })
      .def_property_readonly("contact", [](const Result& r) { return r.status == Status::contact; })
      .def_property_readonly("undecided", [](const Result& r) { return r.status == Status::undecided; })
      .def_readonly("t_lower", &Result::t_lower)
      .def_readonly("t_upper", &Result::t_upper)
      .def_readonly("certain", &Result::certain)
      .def("__bool__", [](const Result&) -> bool {
        typeError("a result is neither true nor false: ask for result.free, result.contact or result.undecided");
      });
}

void bindResults(py::module_& module);

}  // namespace fcl_artic::python
