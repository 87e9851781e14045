// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "checks.h"

namespace campaign {

struct Options {
  std::uint64_t queries = 20000;
  std::uint64_t seed = 1;
  int threads = 2;
  std::string family;  ///< only this class; empty: all, in their shares
  std::string scenes;  ///< a file (scene_file.h): asks about its scenes; empty: they are drawn, by seed and family
  fcl_artic::CertifiedRequest how;                            ///< method and its options, stage 2
  std::shared_ptr<const fcl_artic::VisibilityCuller> culler;  ///< who does stage 2; null: the executor cpu
  Corruption corruption = Corruption::none;                   ///< spoils the answers before they are examined
  bool judge = true;                                          ///< false: answers are only asked for, not examined
  bool try_corruptions = false;  ///< besides, spoils a copy of each answer in each way, and counts what is seen
  std::function<void(std::uint64_t done)> progress;  ///< called from any thread
  /// Told each answer as it came, before it is spoilt; called from any thread, in any order.
  std::function<void(std::uint64_t query, const Scene& scene, const fcl_artic::CertifiedResult& result)> answered;
};

/// Counts of one class, or of all.
struct Tally {
  std::uint64_t queries = 0;
  std::uint64_t hits = 0;       ///< sampled contacts
  std::uint64_t doubtful = 0;   ///< contact by the rounded corners alone, at no time a clear one
  std::uint64_t starts = 0;     ///< hits at t = 0
  std::uint64_t ends_free = 0;  ///< hits with both ends of the motion free
  std::uint64_t grazes = 0;     ///< no hit, and a least gap below 1e-3 m
  std::uint64_t answers_contact = 0, certain = 0, uncertain = 0, undecided = 0;
  std::uint64_t uncertain_margin = 0;                               ///< of the uncertain ones, those with a margin
  std::uint64_t beyond_sampling = 0;                                ///< certain contacts that the samples did not find
  std::array<std::uint64_t, kCorruptions> spoilt{}, spoilt_seen{};  ///< by try_corruptions
  std::array<std::uint64_t, kFaults> faults{};                      ///< queries with this fault
  std::vector<float> lead;  ///< sampled contact time - t_lower, of hits that are certain
  double query_us = 0, generate_us = 0, oracle_us = 0;

  std::uint64_t faulty() const;
  double hitShare() const { return queries ? static_cast<double>(hits) / static_cast<double>(queries) : 0; }
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
  std::vector<Failure> failures;  ///< in the order of the queries, at most 1,000
  double elapsed_s = 0;
};

Report run(const Options& options);

/// One query again, in words: the scene, the oracle's findings, the answer, the faults.
/// @return whether it is without fault
bool replay(const std::string& family, std::uint64_t seed, const fcl_artic::CertifiedRequest& how, std::string& words);

std::string toText(const Report& report);

}  // namespace campaign
