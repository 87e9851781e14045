// SPDX-License-Identifier: BSD-3-Clause
#include "functions.h"

#include <cstdlib>
#include <cstring>
#include <string>
#include <unordered_map>

#include "turns.h"

namespace fcl_artic::python {
namespace {

/// The stub's signatures, a line for each way to call a function; `{argument}` stands for its default value, which the
/// binding knows.
constexpr struct {
  const char* name;  ///< World.check, box
  const char* lines;
} kStub[] = {
#include "signatures.inc"
};

/// The function of pybind11 that runs any of its functions, which it knows by the first argument.
using CallFunction = PyObject* (*)(PyObject*, PyObject*, PyObject*);
CallFunction pybind_run = nullptr;

struct Function {
  std::string name, lines;  ///< of the stub; no lines: it is none of the stub's
};
/// The functions, by the object by which pybind_run() knows each. Never destroyed: Python calls functions until the
/// process ends.
std::unordered_map<PyObject*, Function>& functions() {
  static auto* const all = new std::unordered_map<PyObject*, Function>;
  return *all;
}

/// Replaces pybind11's message about arguments that a function does not take: it has names of types in C++.
void explain(const Function& of) {
  py::error_already_set error;
  const std::string text = py::str(error.value()), invoked = "\nInvoked with: ";
  const std::size_t begin = text.find(invoked);
  std::string given;
  if (text.find("(): incompatible ") < begin && begin != std::string::npos) {
    given = text.substr(begin + invoked.size());
    given = ": " + given.substr(0, given.find("\n\nDid you forget to `#include"));
  } else if (text.rfind("Unable to cast Python instance", 0) != 0) {
    return error.restore();
  }
  std::string message = of.name + ": wrong arguments" + given + (of.lines.empty() ? "" : "\nIt takes:");
  for (std::size_t at = of.lines.empty() ? std::string::npos : 0; at != std::string::npos;) {
    const std::size_t end = of.lines.find('\n', at);
    message += "\n    " + of.lines.substr(at, end - at);
    at = end == std::string::npos ? end : end + 1;
  }
  PyErr_SetString(PyExc_TypeError, message.c_str());
}

PyObject* run(PyObject* self, PyObject* arguments, PyObject* options) {
  const Call call;
  PyObject* const result = pybind_run(self, arguments, options);
  if (!result && (PyErr_ExceptionMatches(PyExc_TypeError) || PyErr_ExceptionMatches(PyExc_RuntimeError))) {
    if (const auto known = functions().find(self); known != functions().end()) explain(known->second);
  }
  return result;
}

PyCFunction asMethod(CallFunction function) {
  return reinterpret_cast<PyCFunction>(reinterpret_cast<void (*)()>(function));
}

/// The function that pybind11 has made, without its binding to a class; null for anything else.
PyCFunctionObject* functionIn(py::handle value) {
  PyObject* function = value.ptr();
  if (Py_TYPE(function) == &PyStaticMethod_Type) function = value.attr("__func__").ptr();  // which it holds
  if (PyInstanceMethod_Check(function)) function = PyInstanceMethod_GET_FUNCTION(function);
  if (!PyCFunction_Check(function)) return nullptr;
  auto* const out = reinterpret_cast<PyCFunctionObject*>(function);
  return out->m_ml->ml_meth == asMethod(pybind_run) ? out : nullptr;
}

/// The value in pybind11's signature that an argument has if it is left out; "...", if none stands there.
std::string defaultOf(const std::string& argument, const std::string& signature) {
  std::size_t at = signature.find("(" + argument + ": ");
  if (at == std::string::npos) at = signature.find(" " + argument + ": ");
  std::size_t value = std::string::npos;
  int depth = 0;  // of brackets within the argument
  for (std::size_t i = at == std::string::npos ? signature.size() : at + 1; i < signature.size(); ++i) {
    const char c = signature[i];
    if (depth == 0 && (c == ',' || c == ')')) return value <= i ? signature.substr(value, i - value) : "...";
    if (std::strchr("([{", c)) ++depth;
    if (std::strchr(")]}", c)) --depth;
    if (signature.compare(i, 3, " = ") == 0 && value > i) value = i + 3;
  }
  return "...";
}

/// The stub's lines for a function, with the values that pybind11's signature has; empty: it is none of the stub's.
std::string linesOf(const std::string& name, const std::string& signature) {
  for (const auto& known : kStub) {
    if (name != known.name) continue;
    std::string lines = known.lines;
    for (std::size_t open = lines.find('{'); open != std::string::npos; open = lines.find('{', open)) {
      const std::size_t close = lines.find('}', open);
      const std::string value = defaultOf(lines.substr(open + 1, close - open - 1), signature);
      lines.replace(open, close + 1 - open, value);
      open += value.size();
    }
    return lines;
  }
  return {};
}

/// @param in_stub  whether the stub has lines of this name, if any, for it.
void complete(py::handle value, const std::string& name, bool in_stub = true) {
  PyCFunctionObject* const function = functionIn(value);
  if (!function) return;
  PyMethodDef& definition = *function->m_ml;
  definition.ml_meth = asMethod(run);
  // pybind11's signature, an empty line, and the text.
  const std::string before = definition.ml_doc ? definition.ml_doc : "";
  const std::size_t end = before.find("\n\n");
  const std::string text = end == std::string::npos ? "" : before.substr(end + 2);
  const std::string lines = in_stub ? linesOf(name, before.substr(0, end)) : "";
  functions()[function->m_self] = {name.substr(0, name.find(".__init__")), lines};
  std::free(const_cast<char*>(definition.ml_doc));  // it is strdup()'s, and pybind11 frees it so
  definition.ml_doc = ::strdup((lines + (lines.empty() || text.empty() ? "" : "\n\n") + text).c_str());
}

void completeAll(py::handle owner, const std::string& prefix) {
  for (const auto& [key, value] : py::dict(owner.attr("__dict__"))) {
    const std::string name = prefix + std::string(py::str(key));
    if (PyType_Check(value.ptr())) {
      completeAll(value, name + ".");
    } else if (PyObject_TypeCheck(value.ptr(), &PyProperty_Type)) {
      complete(value.attr("fget"), name, false);
      complete(value.attr("fset"), name);
    } else {
      complete(value, name);
    }
  }
}

}  // namespace

void completeFunctions(const py::module_& module) {
  const py::cpp_function any([] {});
  pybind_run = reinterpret_cast<CallFunction>(
      reinterpret_cast<void (*)()>(reinterpret_cast<PyCFunctionObject*>(any.ptr())->m_ml->ml_meth));
  completeAll(module, "");
}

}  // namespace fcl_artic::python
