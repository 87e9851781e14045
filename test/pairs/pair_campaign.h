// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "fcl_artic/continuous_collision.h"
#include "harness.h"
#include "pairs/random_pairs.h"

namespace pair_campaign {

/// A class of queries. Mesh pairs and shape pairs by InterpMotion are the bulk; the others share the rest.
struct Family {
  std::string name;
  pairs::Bodies bodies;
  std::string motion;  ///< interp, translation, screw, spline or bounded
  int share;           ///< of kShares
};
constexpr int kShares = 80;
const std::vector<Family>& families();
/// @throws std::invalid_argument for an unknown one.
const Family& familyOf(const std::string& name);

/// Query of one class: half of them with both bodies moving, a quarter near-grazing; meshes with any bounding volumes.
pairs::PairQuery makeQuery(const Family& family, std::uint64_t seed);

/// All that the library says to one query.
struct Answer {
  fcl_artic::CertifiedRequest request;
  fcl_artic::CertifiedPairResult result, swapped;
  double drop_in_time = 0;  ///< returned
  fcl::ContinuousCollisionResultd drop_in;
  double elapsed_us = 0;  ///< of the first query alone
};
Answer ask(const pairs::PairQuery& query);

/// Compares an answer with the sampled truth and with itself. Faults are
///   missed      a sampled contact, and the answer is 'free'
///   late        t_lower after the first sampled contact
///   false       not certain, and the gap at t_lower is above the distance tolerance
///   unproven    `certain`, and no contact at t_upper
///   wide        `certain`, and the bracket wider than both tolerances
///   undecided   without a work budget
///   fields      bracket out of order or out of [0, 1], contact of other geometries, ids out of range
///   point       contact point away from one of the named pieces
///   normal      not unit, or the named pieces are not on their sides of it
///   witness     nearest points away from the named pieces, or farther apart than these
///   poses       poses at the ends of the bracket differ from the motions'
///   swapped     with the objects swapped another answer
///   drop-in     the answer through FCL's own signature is missed, late, early beyond toc_err, or incomplete
std::vector<campaign::Finding> examine(const pairs::PairQuery& query, const pairs::Judge& judge,
                                       const pairs::Truth& truth, const Answer& answer);

/// Faults put into such answers on purpose.
const std::vector<campaign::Mutant<pairs::PairQuery, Answer>>& mutants();

/// A quarter of the queries are of mesh pairs, half of them of shape pairs.
campaign::Campaign campaignOfPairs();

}  // namespace pair_campaign
