// SPDX-License-Identifier: BSD-3-Clause
//
// The library's enumerations as Python's (fcl_artic/_enums.py). A member, or its value as text, is taken.
#pragma once

#include <pybind11/pybind11.h>

#include <string>

#include "errors.h"
#include "fcl_artic/guard.h"
#include "fcl_artic/kinematic_tree.h"
#include "fcl_artic/link_pairs.h"
#include "fcl_artic/request.h"
#include "fcl_artic/result.h"
#include "fcl_artic/visibility.h"

namespace fcl_artic::python {

/// Who culls by visibility.
enum class VisibilityExecutor { cpu, osmesa, egl };

/// Name of the Python class of an enumeration.
template <class E>
const char* enumName();
// clang-format off
template <> inline const char* enumName<Status>() { return "Status"; }
template <> inline const char* enumName<ContactMode>() { return "ContactMode"; }
template <> inline const char* enumName<VisibilityMode>() { return "VisibilityMode"; }
template <> inline const char* enumName<VisibilityExecutor>() { return "VisibilityExecutor"; }
template <> inline const char* enumName<Method>() { return "Method"; }
template <> inline const char* enumName<MotionEnclosure>() { return "MotionEnclosure"; }
template <> inline const char* enumName<FeatureKind>() { return "FeatureKind"; }
template <> inline const char* enumName<GuardReason>() { return "GuardReason"; }
template <> inline const char* enumName<JointType>() { return "JointType"; }
template <> inline const char* enumName<LinkPairKind>() { return "LinkPairKind"; }
// clang-format on

/// The members of a Python class of enumeration, in the order of the C++ values, which are 0, 1, ...
py::list enumMembers(const char* name);
/// The C++ value of a member or its text. @throws py::value_error naming `what` and the texts.
int enumValue(const py::list& members, py::handle value, const char* what);

template <class E>
const py::list& membersOf() {
  static const py::list& members = *new py::list(enumMembers(enumName<E>()));  // outlives the interpreter's end
  return members;
}

/// @param what  names the argument in errors.
template <class E>
E enumOf(py::handle value, const char* what) {
  return static_cast<E>(enumValue(membersOf<E>(), value, what));
}

template <class E>
py::object memberOf(E value) {
  return membersOf<E>()[static_cast<std::size_t>(value)];
}

}  // namespace fcl_artic::python
