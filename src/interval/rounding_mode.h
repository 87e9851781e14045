// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace fcl_artic {

/// Stands for the processor's rounding mode where the compiler orders operations. Never read or written in fact.
__attribute__((visibility("hidden"))) inline char rounding_mode = 0;

}  // namespace fcl_artic
