// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fcl_artic/request.h"
#include "fcl_artic/result.h"

namespace fcl_artic {
namespace redon {

using Options = RedonOptions;
using Counts = RedonStatistics;

/// The work that a work budget counts.
inline std::uint64_t workOf(const Counts& counts) {
  return counts.box_tests + counts.leaf_pairs + counts.equations + counts.evaluations;
}

}  // namespace redon
}  // namespace fcl_artic
