// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

#include "plans/plan.h"

namespace fcl_artic::plans {

/// A path as OMPL prints it: by PathGeometric::printAsMatrix(), a line of numbers for each state, or by print(), with
/// names of the kinds of states and brackets. Its joints have no names.
/// @throws std::invalid_argument naming the line, for what is neither.
Plan parseOmplPath(std::string_view content);

}  // namespace fcl_artic::plans
