// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include "arms.h"

namespace fcl_artic {
namespace test {

/// Contact that is proven, around this time.
inline testing::AssertionResult touchesAt(const CertifiedResult& r, double t, double tolerance = 1e-6) {
  if (r.status != Status::contact)
    return testing::AssertionFailure() << "no contact: status " << static_cast<int>(r.status);
  if (!r.certain) return testing::AssertionFailure() << "not certain, from " << r.t_lower;
  if (r.t_lower > t + kRounding || r.t_upper < t - kRounding || r.t_upper - r.t_lower > tolerance) {
    return testing::AssertionFailure() << "[" << r.t_lower << ", " << r.t_upper << "] instead of " << t;
  }
  return testing::AssertionSuccess();
}

}  // namespace test
}  // namespace fcl_artic
