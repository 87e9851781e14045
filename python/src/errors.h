// SPDX-License-Identifier: BSD-3-Clause
//
// Errors as Python has them. The library's std::invalid_argument arrives as ValueError. An error that a file is to
// blame for arrives as FileNotFoundError or ValueError (guardFiles()).
#pragma once

#include <pybind11/pybind11.h>

#include <filesystem>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace fcl_artic::python {

namespace py = pybind11;

/// A text of the library's for Python. It may hold bytes of files: those that are no UTF-8 become \\xHH.
inline py::str textOf(const std::string& text) {
  return py::reinterpret_steal<py::str>(
      PyUnicode_DecodeUTF8(text.data(), static_cast<Py_ssize_t>(text.size()), "backslashreplace"));
}
inline py::list textsOf(const std::vector<std::string>& texts) {
  py::list out;
  for (const std::string& text : texts) out.append(textOf(text));
  return out;
}

[[noreturn]] inline void typeError(const std::string& message) {
  throw py::type_error(message);
}

[[noreturn]] inline void valueError(const std::string& message) {
  PyErr_SetObject(PyExc_ValueError, textOf(message).ptr());
  throw py::error_already_set();
}

/// Raises FileNotFoundError as open() does: with errno, message and file name.
[[noreturn]] inline void fileNotFound(const std::string& message, const std::string& path) {
  PyErr_SetObject(PyExc_FileNotFoundError, py::make_tuple(ENOENT, textOf(message), path).ptr());
  throw py::error_already_set();
}

/// Raises a UserWarning for each note that no object keeps.
inline void warn(const std::vector<std::string>& notes) {
  for (const std::string& note : notes) {
    if (PyErr_WarnFormat(PyExc_UserWarning, 1, "%U", textOf(note).ptr()) != 0) throw py::error_already_set();
  }
}

/// Name of a value's type, for messages.
inline std::string typeName(py::handle value) {
  return Py_TYPE(value.ptr())->tp_name;
}

/// The value as what it must be.
/// @param what, type  the argument's name and its class, for the message.
/// @param cure  which function gives one.
template <class T>
const T& required(py::handle value, const char* what, const char* type, const char* cure) {
  if (py::isinstance<T>(value)) return py::cast<const T&>(value);
  typeError(std::string(what) + " is no " + type + " but " + typeName(value) + "; " + cure);
}

/// Looks up a name of the library's, for which it throws std::out_of_range: a ValueError here, since no index is wrong.
template <class Look>
auto named(Look&& look) -> decltype(look()) {
  try {
    return look();
  } catch (const std::out_of_range& problem) {
    valueError(problem.what());
  }
}

}  // namespace fcl_artic::python
