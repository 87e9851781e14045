// SPDX-License-Identifier: BSD-3-Clause
//
// Python's lock. When the interpreter ends, it takes threads that are not waited for (daemon threads) away where they
// want the lock, by unwinding their frames. In C++ that ends the whole process, as destructors take locks: such a
// thread sleeps here instead until the process is gone. So nothing in this module takes the lock in another way.
#pragma once

#include <cxxabi.h>
#include <unistd.h>

#include "errors.h"

namespace fcl_artic::python {

/// Takes the lock; never returns to a thread that the interpreter takes away.
template <class Take>
auto takeOrSleep(const Take& take) {
  try {
    return take();
  } catch (const abi::__forced_unwind&) {
    for (;;) ::pause();
  }
}

/// Lets go of the lock in its scope.
class GilReleased {
 public:
  GilReleased() : state_(PyEval_SaveThread()) {}
  ~GilReleased() {
    takeOrSleep([&] { PyEval_RestoreThread(state_); });
  }
  GilReleased(const GilReleased&) = delete;
  GilReleased& operator=(const GilReleased&) = delete;

 private:
  PyThreadState* const state_;
};

/// Holds the lock in its scope, in any thread, whether it holds it already or not.
class GilHeld {
 public:
  GilHeld() : state_(takeOrSleep([] { return PyGILState_Ensure(); })) {}
  ~GilHeld() { PyGILState_Release(state_); }
  GilHeld(const GilHeld&) = delete;
  GilHeld& operator=(const GilHeld&) = delete;

 private:
  const PyGILState_STATE state_;
};

inline bool interpreterEnds() {
#if PY_VERSION_HEX >= 0x030D0000
  return Py_IsFinalizing() != 0;
#else
  return _Py_IsFinalizing() != 0;
#endif
}

}  // namespace fcl_artic::python
