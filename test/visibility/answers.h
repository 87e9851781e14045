// SPDX-License-Identifier: BSD-3-Clause
//
// Answers with stage 2 beside those without it.
#pragma once

#include <algorithm>

#include "fcl_artic/result.h"

namespace fcl_artic {
namespace test {

inline bool sameContact(const CertifiedContact& a, const CertifiedContact& b) {
  return a.body1.name == b.body1.name && a.body2.name == b.body2.name && a.b1 == b.b1 && a.b2 == b.b2 &&
         a.feature == b.feature && a.point == b.point && a.normal == b.normal && a.t_lower == b.t_lower &&
         a.t_upper == b.t_upper && a.certain == b.certain;
}

inline bool sameBits(const CertifiedResult& a, const CertifiedResult& b) {
  return a.status == b.status && a.t_lower == b.t_lower && a.t_upper == b.t_upper && a.certain == b.certain &&
         a.contacts.size() == b.contacts.size() &&
         std::equal(a.contacts.begin(), a.contacts.end(), b.contacts.begin(), sameContact) &&
         a.ignored_initial_contacts.size() == b.ignored_initial_contacts.size() &&
         a.unproven_allowed_pairs == b.unproven_allowed_pairs;
}

/// Verdicts are the same, and both brackets may hold the same time.
inline bool agree(const CertifiedResult& a, const CertifiedResult& b) {
  if (a.status != b.status) return false;
  if (a.status != Status::contact) return true;
  return a.t_lower <= (b.certain ? b.t_upper : 1) && b.t_lower <= (a.certain ? a.t_upper : 1);
}

}  // namespace test
}  // namespace fcl_artic
