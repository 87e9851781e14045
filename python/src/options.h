// SPDX-License-Identifier: BSD-3-Clause
//
// Keyword arguments. One table says which options a request has; queries, Request and its properties go by it.
#pragma once

#include <functional>
#include <vector>

#include "errors.h"
#include "fcl_artic/clearance.h"
#include "fcl_artic/request.h"
#include "fcl_artic/tolerance_left.h"

namespace fcl_artic::python {

/// A request as Python has it. Progress is kept beside the library's request: it is called through a Watch.
struct Request {
  CertifiedRequest request;
  py::object progress = py::none();
  bool most_contacts_chosen = false;  ///< Whether max_contacts was given; else it follows the mode.

  // For Python's garbage collector.
  int visit(visitproc visit, void* arg) const {
    Py_VISIT(progress.ptr());
    return 0;
  }
  void clear() { progress = py::none(); }
};

/// The request that keyword arguments describe: `request`, if given, and the options that stand beside it.
/// @throws py::type_error for an option that is not known, with the name that is meant; py::value_error for a value.
Request readRequest(const py::kwargs& options);
/// Sets what keyword arguments name. @throws as readRequest().
void applyOptions(Request& request, const py::kwargs& options);

/// The request for a clearance.
ClearanceRequest readClearanceRequest(const py::kwargs& options, py::object& progress);
/// The request for the tolerance left.
ToleranceLeftRequest readToleranceLeftRequest(const py::kwargs& options, py::object& progress);
/// The request as an expression, without options that have their default.
std::string text(const Request& request);

void bindRequest(py::module_& module);

/// Reads a truth value, which must be one: a slip such as "no" or None must not switch a check off or on.
bool flagOf(py::handle value, const char* what);
/// Reads a whole number of at least 0.
std::uint64_t countOf(py::handle value, const char* what);

/// An option of a request or of other keyword arguments: how it is read, and how it is shown as a property.
template <class T>
struct Option {
  const char* name;
  std::function<void(T&, py::handle)> set;
  std::function<py::object(const T&)> get;  ///< empty: it is no property
  const char* help = "";                    ///< the property's docstring, where docstrings.cpp has none
};

/// Throws the TypeError for a keyword that no function of this name takes.
[[noreturn]] void refuseKeyword(const std::string& name, const std::vector<std::string>& known);

/// Sets all options that keyword arguments name.
template <class T>
void setAll(T& out, const std::vector<Option<T>>& options, const py::kwargs& given) {
  for (const auto& [key, value] : given) {
    const std::string name = py::str(key);
    bool found = false;
    for (const Option<T>& option : options) {
      if (name != option.name) continue;
      option.set(out, value);
      found = true;
      break;
    }
    if (found) continue;
    std::vector<std::string> known;
    for (const Option<T>& option : options) known.emplace_back(option.name);
    refuseKeyword(name, known);
  }
}

}  // namespace fcl_artic::python
