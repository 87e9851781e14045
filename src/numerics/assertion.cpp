// SPDX-License-Identifier: BSD-3-Clause
#include "numerics/assertion.h"

#include <cstdio>
#include <cstdlib>

namespace fcl_artic {

void assertionFailed(const char* condition, const char* file, int line) noexcept {
  std::fprintf(stderr, "fcl_artic: %s:%d: a mistake of the library: not so: %s\n", file, line, condition);
  std::abort();
}

}  // namespace fcl_artic
