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

/// Pairs of names (of links, obstacles, attached objects) that may touch and are therefore not checked; and what is
/// said of neighbours. If nothing is said of neighbours, a manager decides by a rule
/// (ArticulatedCollisionManager::setAllowedCollisions()). The order of two names does not matter. Names are taken as
/// they are; ArticulatedCollisionManager::setAllowedCollisions() checks them.
class FCL_ARTIC_EXPORT AllowedCollisionMatrix {
 public:
  /// Pairs of names, the alphabetically smaller one first in each.
  using Pairs = std::set<std::pair<std::string, std::string>>;

  /// Adds the pair.
  void allow(const std::string& a, const std::string& b) {
    pairs_.insert(key(a, b));
    disallowed_.erase(key(a, b));
  }
  /// Removes the pair, if it is there, and has it checked even if the two are neighbours or stand still against each
  /// other.
  void disallow(const std::string& a, const std::string& b) {
    pairs_.erase(key(a, b));
    disallowed_.insert(key(a, b));
  }
  /// Whether the pair may touch.
  bool allowed(const std::string& a, const std::string& b) const { return pairs_.count(key(a, b)) != 0; }
  /// Whether the pair is to be checked even if the two are neighbours: it was disallowed, or the matrix is complete.
  bool mustBeChecked(const std::string& a, const std::string& b) const {
    return disallowed_.count(key(a, b)) != 0 || (complete_ && !allowed(a, b));
  }
  /// All pairs that may touch.
  const Pairs& pairs() const { return pairs_; }
  /// The pairs that were disallowed.
  const Pairs& disallowedPairs() const { return disallowed_; }

  /// Says whether the pairs are all that may touch, neighbours included: then the manager's rule for neighbours decides
  /// nothing. (At first it is not so; of what loadSrdf() reads it is.)
  void setComplete(bool complete = true) { complete_ = complete; }
  /// Whether the pairs are all that may touch.
  bool complete() const { return complete_; }

 private:
  static std::pair<std::string, std::string> key(const std::string& a, const std::string& b) {
    return a < b ? std::make_pair(a, b) : std::make_pair(b, a);
  }
  Pairs pairs_, disallowed_;
  bool complete_ = false;
};

/// The behaviour of two links over all values of their joints, as ArticulatedCollisionManager::classifyLinkPairs()
/// finds it.
enum class LinkPairKind {
  never,      ///< Proven apart for all values within the joints' limits.
  always,     ///< In contact in every configuration that was tried.
  sometimes,  ///< In contact in some configurations and not in others.
  unproven    ///< In contact in no configuration that was tried, and yet not proven apart.
};

/// The finding of one pair of links.
struct LinkPairFinding {
  /// Names of the two links.
  std::string link1, link2;
  /// The behaviour of the two links.
  LinkPairKind kind = LinkPairKind::unproven;
  /// Whether the two are neighbours: ArticulatedCollisionManager::setAllowedCollisions() says which links these are.
  bool neighbours = false;
  /// Whether the kind is proven for all configurations within the joints' limits: so for `never` and `sometimes`, and
  /// for `always` if no joint moves the two links apart.
  bool proven = false;
  /// `tried`: number of configurations tried, which are all joints at 0 and others spread evenly over the joints'
  /// limits; 0 where there is a proof. If none of them is in contact and a search then finds one that is, it counts as
  /// well. `touching`: number of those in which the links are in contact for certain; `apart`: in which they certainly
  /// are not. In the others they are too near to decide.
  std::size_t tried = 0, touching = 0, apart = 0;
  /// Joint values, rad or m: `always` and `sometimes`: a configuration in contact for certain; `unproven`: where the
  /// links come near each other, if that is known; else empty.
  Eigen::VectorXd configuration;
  /// Upper bound of the smallest distance over the joints' limits, m, if known; else infinite.
  double nearest = 0;

  /// Whether the links touch, or are too near to decide, in every configuration that was tried: as housings that
  /// overlap in the joint between them.
  bool touchThroughout() const { return kind != LinkPairKind::never && tried > 0 && apart == 0; }
  /// Whether no configuration is known in which they touch, and some in which that can't be decided, or none that could
  /// be tried.
  bool undecided() const {
    return kind == LinkPairKind::unproven && !touchThroughout() && (tried == 0 || apart < tried);
  }
  /// Whether a manager's rule leaves the two out, if they are neighbours of which nobody says anything
  /// (ArticulatedCollisionManager::setAllowedCollisions()).
  bool leftOut() const { return touchThroughout() || undecided(); }
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

/// The findings of classifyLinkPairs() of all pairs of links with geometry. It depends on the robot and the options
/// alone: no random number is in it.
struct FCL_ARTIC_EXPORT LinkPairReport {
  std::vector<LinkPairFinding> pairs;            ///< By the links' order in the tree.
  std::shared_ptr<const LinkPairProofs> proofs;  ///< Proofs of the pairs that never touch.

  /// The pairs that always touch, which must be allowed for any motion to be free. Neighbours are not among them, of
  /// which a manager finds that out by itself (ArticulatedCollisionManager::setAllowedCollisions()).
  AllowedCollisionMatrix alwaysTouching() const;
  /// All pairs that need no check within the joints' limits: those that never or always touch, and neighbours that a
  /// manager would leave out by itself. For programs that know pairs only and no proofs.
  AllowedCollisionMatrix needNoCheck() const;
  /// Number of pairs of a kind.
  std::size_t count(LinkPairKind kind) const;
};

/// Returns "never", "always", "sometimes" or "unproven".
FCL_ARTIC_EXPORT const char* toString(LinkPairKind kind);
/// Prints toString(kind).
FCL_ARTIC_EXPORT std::ostream& operator<<(std::ostream& out, LinkPairKind kind);
/// Prints on one line, without a line end, which links and what is known of them: "hand and link5: sometimes, 31 of
/// 1000 configurations tried".
FCL_ARTIC_EXPORT std::ostream& operator<<(std::ostream& out, const LinkPairFinding& finding);

}  // namespace fcl_artic
