// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "writers.h"

namespace fcl_artic::test {

/// The content with parts of its structure removed, doubled, moved or replaced: lines, words, elements, values.
std::string changedFile(const std::string& name, const std::string& content, Random& random);

}  // namespace fcl_artic::test
