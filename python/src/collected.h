// SPDX-License-Identifier: BSD-3-Clause
//
// Classes whose objects hold Python's, for its garbage collector: through a callable they may hold themselves. Only
// what an object alone holds may be visited: an object that is shared in C++ counts as one holder.
#pragma once

#include "errors.h"

namespace fcl_artic::python {

/// The C++ object of a Python one; null while there is none yet, or no longer.
template <class T>
T* insideOf(PyObject* self) {
  const auto inside = reinterpret_cast<py::detail::instance*>(self)->get_value_and_holder();
  return inside.holder_constructed() ? static_cast<T*>(inside.value_ptr()) : nullptr;
}

/// For py::class_<T>. T has `int visit(visitproc, void*) const`, which visits what it holds, and, where `Clears`,
/// `void clear()`, which lets go of it. A class that is not changed once it is made needs no clear(): each cycle goes
/// through something that is.
template <class T, bool Clears = false>
py::custom_type_setup collected() {
  return py::custom_type_setup([](PyHeapTypeObject* heap) {
    PyTypeObject& type = heap->ht_type;
    type.tp_flags |= Py_TPFLAGS_HAVE_GC;
    type.tp_traverse = [](PyObject* self, visitproc visit, void* arg) {
      Py_VISIT(Py_TYPE(self));
      const T* const inside = insideOf<T>(self);
      return inside ? inside->visit(visit, arg) : 0;
    };
    if constexpr (Clears) {
      type.tp_clear = [](PyObject* self) {
        if (T* const inside = insideOf<T>(self)) inside->clear();
        return 0;
      };
    }
  });
}

}  // namespace fcl_artic::python
