// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace fcl_artic {
namespace engine {

/// Adds up work, of engine::Statistics or of what has members of the same names: all but the counts of pairs.
template <class From, class To>
void addWork(const From& s, To& sum) {
  sum.batches += s.batches;
  sum.motion_evaluations += s.motion_evaluations;
  sum.node_tests += s.node_tests;
  sum.leaf_tests += s.leaf_tests;
  sum.certificates += s.certificates;
  sum.gjk += s.gjk;
  sum.contact_proofs += s.contact_proofs;
  sum.culling_us += s.culling_us;
  sum.narrowphase_us += s.narrowphase_us;
}

}  // namespace engine
}  // namespace fcl_artic
