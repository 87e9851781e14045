// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>
#include <string>

namespace fcl_artic::plans {

[[noreturn]] inline void refuse(const std::string& what) {
  throw std::invalid_argument(what);
}

}  // namespace fcl_artic::plans
