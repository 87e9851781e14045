// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <iosfwd>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "fcl_artic/export.h"

namespace fcl_artic {

/// Pairs of names (of links, obstacles, attached objects) that may touch and are therefore not checked. The order of
/// two names does not matter. Names are taken as they are; ArticulatedCollisionManager::setAllowedCollisions() checks
/// them.
class FCL_ARTIC_EXPORT AllowedCollisionMatrix {
 public:
  /// Adds the pair.
  void allow(const std::string& a, const std::string& b) { pairs_.insert(key(a, b)); }
  /// Removes the pair, if it is there.
  void disallow(const std::string& a, const std::string& b) { pairs_.erase(key(a, b)); }
  /// Whether the pair is in the matrix.
  bool allowed(const std::string& a, const std::string& b) const { return pairs_.count(key(a, b)) != 0; }
  /// All pairs, the alphabetically smaller name first in each.
  const std::set<std::pair<std::string, std::string>>& pairs() const { return pairs_; }

 private:
  static std::pair<std::string, std::string> key(const std::string& a, const std::string& b) {
    return a < b ? std::make_pair(a, b) : std::make_pair(b, a);
  }
  std::set<std::pair<std::string, std::string>> pairs_;
};

/// What two links do over all values of their joints, as ArticulatedCollisionManager::classifyLinkPairs() finds it.
enum class LinkPairKind {
  neighbours,  ///< Never checked: ArticulatedCollisionManager::setAllowedCollisions() says which links these are.
  never,       ///< Proven apart for all values within the joints' limits.
  always,      ///< In contact in every configuration that was tried.
  sometimes,   ///< In contact in some configurations and not in others.
  unproven     ///< In contact in no configuration that was tried, and yet not proven apart.
};

/// What was found of one pair of links.
struct LinkPairFinding {
  /// Names of the two links.
  std::string link1, link2;
  /// What the two do.
  LinkPairKind kind = LinkPairKind::unproven;
  /// Whether the kind is proven for all configurations within the joints' limits: so for `never`, `sometimes` and
  /// `neighbours`, and for `always` if no joint moves the two links apart.
  bool proven = false;
  /// `tried`: number of configurations tried, which are all joints at 0 and others spread evenly over the joints'
  /// limits; 0 where there is a proof. If none of them is in contact and a search then finds one that is, it counts as
  /// well. `touching`: number of those in which the links are in contact for certain.
  std::size_t tried = 0, touching = 0;
  /// Joint values, rad or m: `always` and `sometimes`: a configuration in contact for certain; `unproven`: where the
  /// links come near each other, if that is known; else empty.
  Eigen::VectorXd configuration;
  /// Upper bound of the smallest distance over the joints' limits, m, if known; else infinite.
  double nearest = 0;
};

/// How classifyLinkPairs() works.
struct LinkPairOptions {
  /// Distance that links must keep to count as apart, m, finite, at least 0. Proofs serve queries with this margin or a
  /// smaller one.
  double margin = 0;
  /// Work at most per pair of geometries, and once more where balls stand for links, in tests of nodes and leaves (a
  /// million takes 0.05 to 0.5 s). A pair that needs more stays `unproven` and is checked.
  std::uint64_t work = 1000000;
  /// Number of configurations tried per pair that is not proven apart. More find contacts that are rarer.
  std::size_t samples = 1000;
  /// Only these pairs are looked at; null: all.
  const AllowedCollisionMatrix* only = nullptr;
  /// Maximum number of threads; 0: as many as the machine runs at once. The answer does not depend on it.
  int threads = 0;
  /// Called now and then, by one thread at a time, with the number of pairs done and of all pairs.
  std::function<void(std::size_t done, std::size_t total)> progress;
};

/// Proofs that pairs of links are apart for all values within their joints' limits, with what they were made for: the
/// tree, the links' geometry and where it is bound. Constant, and shared by managers
/// (ArticulatedCollisionManager::setLinkPairProofs()).
class LinkPairProofs;

/// What classifyLinkPairs() found of all pairs of links with geometry. It depends on the robot and the options alone:
/// no random number is in it.
struct FCL_ARTIC_EXPORT LinkPairReport {
  std::vector<LinkPairFinding> pairs;            ///< By the links' order in the tree.
  std::shared_ptr<const LinkPairProofs> proofs;  ///< Of the pairs that never touch.

  /// The pairs that always touch, which must be allowed for any motion to be free.
  AllowedCollisionMatrix alwaysTouching() const;
  /// All pairs that need no check within the joints' limits: neighbours and those that never or always touch. For
  /// programs that know pairs only and no proofs.
  AllowedCollisionMatrix needNoCheck() const;
  /// Number of pairs of a kind.
  std::size_t count(LinkPairKind kind) const;
};

/// Returns "neighbours", "never", "always", "sometimes" or "unproven".
FCL_ARTIC_EXPORT const char* toString(LinkPairKind kind);
/// Prints toString(kind).
FCL_ARTIC_EXPORT std::ostream& operator<<(std::ostream& out, LinkPairKind kind);
/// Prints on one line, without a line end, which links and what is known of them: "hand and link5: sometimes, 31 of
/// 1000 configurations tried".
FCL_ARTIC_EXPORT std::ostream& operator<<(std::ostream& out, const LinkPairFinding& finding);

}  // namespace fcl_artic
