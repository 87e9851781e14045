// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pairs/judge.h"

namespace pair_campaign {

/// Measures two meshes with the exact predicates of the campaign for articulated scenes: a clear contact is an edge
/// that crosses a triangle, whatever the rounding of the poses. For other pairs empty: the judge measures by itself.
pairs::Judge::Look exactLook(const pairs::PairQuery& query);

}  // namespace pair_campaign
