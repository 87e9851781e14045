// SPDX-License-Identifier: BSD-3-Clause
//
// Random URDF trees, read by loadUrdf() and asked by the manager, against dense sampling with FCL's static test.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "fcl_artic/result.h"

namespace urdf_trees {

struct Options {
  int trees = 10000;
  int first = 0;  ///< number of the first tree: one tree is run again by its number
  std::uint64_t seed = 1;
  int threads = 1;
  /// Takes the geometry of the link that touches first out of a second manager, whose answer is judged by the whole
  /// tree: to see that the judge would notice.
  bool spoil = false;
  /// Gets the answer for the first contact of each tree, with its certificate; may be empty. Called by all threads.
  std::function<void(int tree, const fcl_artic::CertifiedResult&)> certificates;
};

struct Report {
  long trees = 0, links = 0, joints = 0, mimics = 0, meshes = 0;
  long chains = 0;                        ///< mimics of mimics, anywhere in the file
  long of_kind[6] = {};                   ///< joints: revolute, continuous, prismatic, fixed, planar, floating
  long hits = 0, at_start = 0, free = 0;  ///< answers
  long uncertain = 0;                     ///< contacts that are not proven
  long pairs = 0, samples = 0;            ///< watched pairs of shapes; poses looked at
  long left_out = 0;                      ///< pairs of neighbours, by the rule
  long missed = 0;                        ///< said to be free where a sample touches
  long untrue = 0;                        ///< said to touch where nothing does
  long differing = 0;                     ///< the verdict of mode `any` contradicts that of mode `first`
  long spoilt = 0, spoilt_seen = 0;       ///< with Options::spoil
  std::vector<std::string> faults;        ///< a line each, the first few

  void add(const Report& other);
};

Report run(const Options& options);
std::string toText(const Report& report);

}  // namespace urdf_trees
