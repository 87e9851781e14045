// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fcl_artic/result.h"

namespace fcl_artic::app {

// Exit statuses of the program.
constexpr int kExitFree = 0;       ///< proven free; also success of the other verbs
constexpr int kExitContact = 1;    ///< a contact, proven or not
constexpr int kExitError = 2;      ///< wrong input or usage
constexpr int kExitUndecided = 3;  ///< the work budget ran out, or there was nothing to check

inline int exitStatus(const CertifiedResult& result) {
  switch (result.status) {
    case Status::free:
      return result.nothingChecked() ? kExitUndecided : kExitFree;
    case Status::contact:
      return kExitContact;
    case Status::undecided:
      return kExitUndecided;
  }
  return kExitError;
}

/// The status for several answers: an error before a contact before undecided before free.
inline int worseExit(int a, int b) {
  for (const int status : {kExitError, kExitContact, kExitUndecided}) {
    if (a == status || b == status) return status;
  }
  return kExitFree;
}

}  // namespace fcl_artic::app
