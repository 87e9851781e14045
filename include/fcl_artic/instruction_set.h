// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fcl_artic/export.h"

namespace fcl_artic {

/// Names the instructions that queries are answered with: the widest for which the library has an engine and which
/// this processor runs. They are "avx512", "avx2" or "sse2" on x86-64, "neon" on 64-bit ARM, else "portable". The
/// environment variable FCL_ARTIC_ISA asks for another of the library's engines, before the first query.
FCL_ARTIC_EXPORT const char* instructionSet();

}  // namespace fcl_artic
