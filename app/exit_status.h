// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace fcl_artic::app {

// Exit statuses of the program.
constexpr int kExitFree = 0;       ///< proven free; also success of the other verbs
constexpr int kExitContact = 1;    ///< a contact, proven or not
constexpr int kExitError = 2;      ///< wrong input or usage
constexpr int kExitUndecided = 3;  ///< the work budget ran out

}  // namespace fcl_artic::app
