// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace fcl_artic {
namespace engine {

/// Adds every field in the list of S (fcl_artic/statistics.h) to the same field of sum.
template <class S>
void addFields(const S& s, S& sum) {
  S::forEachField([&](const char*, auto field) { sum.*field += s.*field; });
}

}  // namespace engine
}  // namespace fcl_artic
