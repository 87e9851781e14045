// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "fcl_artic/continuous_collision.h"
#include "pairs/random_pairs.h"

namespace pair_campaign {

/// What can be wrong with an answer. Each is counted by itself and has to be 0.
enum class Fault {
  missed,         ///< a sampled contact, and the answer is 'free'
  late,           ///< t_lower after the first sampled contact
  false_contact,  ///< not certain, and the gap at t_lower is above the distance tolerance
  unproven,       ///< `certain`, and no contact at t_upper
  wide,           ///< `certain`, and the bracket wider than both tolerances
  undecided,      ///< without a work budget
  fields,   ///< bracket out of order or out of [0, 1], contact of other geometries, ids out of range, an exception
  point,    ///< contact point away from one of the named pieces
  normal,   ///< not unit, or the named pieces are not on their sides of it
  witness,  ///< nearest points away from the named pieces, or farther apart than these
  poses,    ///< poses at the ends of the bracket differ from the motions'
  swapped,  ///< with the objects swapped another answer
  drop_in,  ///< the answer through FCL's own signature is missed, late, early beyond toc_err, or incomplete
  count
};
constexpr int kFaults = static_cast<int>(Fault::count);
const char* faultName(Fault fault);

/// A class of queries. Mesh pairs and shape pairs by InterpMotion are the bulk; the others share the rest.
struct Family {
  std::string name;
  pairs::Bodies bodies;
  std::string motion;  ///< interp, translation, screw, spline or bounded
  int share;           ///< of kShares
};
constexpr int kShares = 80;
const std::vector<Family>& families();

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

struct Finding {
  Fault fault;
  std::string text;
};
std::vector<Finding> examine(const pairs::PairQuery& query, const pairs::Judge& judge, const pairs::Truth& truth,
                             const Answer& answer);

/// Ways to spoil an answer, to show that the campaign sees it.
enum class Corruption {
  late,
  drop,
  invent,
  widen,
  point,
  normal,
  witness,
  poses,
  certain,
  ids,
  swapped,
  drop_in,
  count
};
constexpr int kCorruptions = static_cast<int>(Corruption::count);
const char* corruptionName(Corruption corruption);
/// Spoils the answer where the corruption applies; returns whether it did.
bool corrupt(Corruption corruption, const pairs::PairQuery& query, Answer& answer);

struct Options {
  std::uint64_t queries = 8000;  ///< 2,000 mesh pairs and 4,000 shape pairs among them
  std::uint64_t seed = 1;
  int threads = 1;
  std::string family;            ///< only this class; empty: all, in their shares
  bool try_corruptions = false;  ///< besides, spoils a copy of each answer in each way, and counts what is seen
};

/// Counts of one class, or of all.
struct Tally {
  std::uint64_t queries = 0;
  std::uint64_t hits = 0;     ///< sampled contacts
  std::uint64_t starts = 0;   ///< of these at t = 0
  std::uint64_t between = 0;  ///< of these with both ends free
  std::uint64_t grazes = 0;   ///< no hit, and a least gap of at most 1e-3 m
  std::uint64_t certain = 0, uncertain = 0;
  std::uint64_t beyond_sampling = 0;  ///< certain contacts that the samples did not find
  std::array<std::uint64_t, kFaults> faults{};
  std::array<std::uint64_t, kCorruptions> spoilt{}, spoilt_seen{};
  std::vector<float> free_us, hit_us, lead;  ///< lead: sampled contact - t_lower, of certain hits

  std::uint64_t faulty() const;
  void add(const Tally& other);
};

struct Failure {
  std::string family;
  std::uint64_t seed;
  std::vector<Finding> findings;
};

struct Report {
  std::map<std::string, Tally> families;
  Tally total;
  std::vector<Failure> failures;  ///< in the order of the queries
  double elapsed_s = 0;
};

/// @throws std::invalid_argument for an unknown class.
Report run(const Options& options);
std::string toText(const Report& report);
/// One query again, in words. @return whether it is without fault.
bool replay(const std::string& family, std::uint64_t seed, std::string& words);

}  // namespace pair_campaign
