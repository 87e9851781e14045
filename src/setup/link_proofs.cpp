// SPDX-License-Identifier: BSD-3-Clause
#include "setup/link_proofs.h"

#include <algorithm>
#include <limits>
#include <set>
#include <string>

#include "motion/half_angles.h"
#include "numerics/arc_tangent.h"
#include "setup/neighbour_findings.h"

namespace fcl_artic {
namespace {

/// Whether a variable keeps within a range over a whole motion, wherever it strays. (Each power of t is within [0, 1];
/// 64 ulp of the coefficients' sizes are more than the rounding of their sums.)
bool keepsWithin(const JointMotion& motion, int v, double stray, const ValueRange& range) {
  const Eigen::MatrixXd& variables = motion.variables();
  double least = variables(v, 0), most = least, size = std::abs(least);
  for (Eigen::Index k = 1; k < variables.cols(); ++k) {
    const double c = variables(v, k);
    least += std::min(c, 0.0);
    most += std::max(c, 0.0);
    size += std::abs(c);
  }
  const double slack = 64 * 0x1p-52 * size;
  least -= slack;
  most += slack;
  const engine::HalfAngles half_angles = halfAnglesOf(motion);
  if (half_angles.has(v)) turnIntoAngles(half_angles.reference[v], least, most);
  if (stray > 0) {
    stray += 4 * 0x1p-52 * (stray + std::max(std::abs(least), std::abs(most)));  // rounding of the sums
    least -= stray;
    most += stray;
  }
  return least >= range.lower && most <= range.upper;
}

}  // namespace

void LinkPairProofs::add(Proof proof) {
  const std::pair<LinkId, LinkId> links(proof.made.link_a, proof.made.link_b);
  proofs_.emplace(links, std::move(proof));
}

const LinkPairProofs::Proof* LinkPairProofs::find(const PairMaking& made, double margin) const {
  const auto [begin, end] = proofs_.equal_range({made.link_a, made.link_b});
  const auto found = std::find_if(
      begin, end, [&](const auto& entry) { return entry.second.margin >= margin && entry.second.made.sameAs(made); });
  return found == end ? nullptr : &found->second;
}

void ProvenPairs::buildSelf(const Registry& registry, const engine::Problem& problem, const PairMargins& margins,
                            std::size_t num_self_pairs) {
  checked_.clear();
  allowed_.clear();
  is_proven_.assign(num_self_pairs, false);
  ranges_.clear();
  allowed_self_ = 0;
  const KinematicTree& tree = *registry.tree();
  for (int v = 0; v < tree.dof(); ++v) ranges_.push_back(wholeRange(tree, v));
  const NeighbourFindings* const neighbours = registry.neighbours();
  const LinkPairProofs* const all_proofs[] = {registry.proofs().get(), neighbours ? &neighbours->proofs : nullptr};
  // A proof is of two links, the one with the lower number first.
  const auto find = [&](const ManagedBody& a, const ManagedBody& b, double margin) {
    const LinkPairProofs::Proof* proof = nullptr;
    if (a.attached || b.attached) return proof;
    const auto [lower, higher] = std::minmax(a.link, b.link);
    for (const LinkPairProofs* proofs : all_proofs) {
      if (!proof && proofs && proofs->has(lower, higher)) proof = proofs->find(PairMaking::inOrder(tree, a, b), margin);
    }
    return proof;
  };
  for (std::size_t i = 0; i < num_self_pairs; ++i) {
    const engine::LinkPair& pair = problem.link_pairs[i];
    if (const auto* proof = find(registry.body(pair.a), registry.body(pair.b), margins.ofLinkPair(i))) {
      checked_.push_back({i, proof->margin, proof->variables});
      is_proven_[i] = true;
    }
  }

  // Allowed pairs count by their names: a link may have several geometries.
  const NamedMargins named_margins = registry.margins();
  std::set<std::pair<std::string, std::string>> undecided;
  std::map<std::pair<std::string, std::string>, std::vector<const LinkPairProofs::Proof*>> excused;
  const std::vector<ManagedBody>& links = registry.links();
  registry.forEachTwoLinks([&](std::size_t i, std::size_t j) {
    const ManagedBody &a = links[i], &b = links[j];
    if (a.empty() || b.empty()) return;
    const Excuse excuse = registry.excuseOf(a, b);
    if (excuse == Excuse::none || excuse == Excuse::still) return;  // notes() names the latter
    if (excuse != Excuse::touch_link && !a.attached && !b.attached && neighbours) {
      const NeighbourFindings::Pair* const pair = neighbours->find(a.link, b.link);
      const bool overlaps = pair && pair->finding.touchThroughout();
      if (excuse == Excuse::neighbours) {
        if (!overlaps) undecided.emplace(pair->finding.link1, pair->finding.link2);
        return;  // notes() names it
      }
      // An allowed pair that overlaps in the joint counts if parts of it are apart: a contact of these may be hidden.
      if (overlaps && pair->apart.empty()) return;
    }
    excused[std::minmax(a.name, b.name)].push_back(find(a, b, 0));
  });
  for (const auto& [names, found] : excused) {
    for (const LinkPairProofs::Proof* proof : found) {
      if (proof) {
        const double own = named_margins.of(names.first, names.second);
        allowed_.push_back({allowed_self_, proof->margin, proof->variables, own});
      }
    }
    // A pair is proven apart if all of its geometries are.
    if (std::count(found.begin(), found.end(), nullptr) > 0) {
      while (!allowed_.empty() && allowed_.back().number == allowed_self_) allowed_.pop_back();
    }
    ++allowed_self_;
  }
  undecided_ = undecided.empty() ? nullptr : std::make_shared<const Names>(undecided.begin(), undecided.end());
  summarize();
}

void ProvenPairs::summarize() {
  std::set<int> used;
  for (const auto* pairs : {&checked_, &allowed_}) {
    for (const Pair& pair : *pairs) used.insert(pair.variables.begin(), pair.variables.end());
  }
  used_.assign(used.begin(), used.end());
  std::set<std::size_t> names;
  bool own = false;
  least_allowed_margin_ = std::numeric_limits<double>::infinity();
  for (const Pair& pair : allowed_) {
    names.insert(pair.number);
    least_allowed_margin_ = std::min(least_allowed_margin_, pair.margin);
    own = own || pair.own >= 0;
  }
  if (own) least_allowed_margin_ = -1;
  proven_names_ = names.size();
}

void ProvenPairs::buildScene(const Registry& registry) {
  allowed_scene_ = 0;
  const auto& allowed = registry.allowed().pairs();
  if (allowed.empty()) return;
  std::set<std::string> links, obstacles;
  for (const ManagedBody& link : registry.links()) links.insert(link.name);
  const auto isObstacle = [&](const std::string& name) { return !links.count(name) && registry.hasObstacle(name); };
  allowed_scene_ = static_cast<std::size_t>(std::count_if(allowed.begin(), allowed.end(), [&](const auto& names) {
    return (links.count(names.first) && isObstacle(names.second)) ||
           (links.count(names.second) && isObstacle(names.first));
  }));
}

bool ProvenPairs::within(const std::vector<int>& variables, const JointMotion& motion,
                         const VariableStrays& strays) const {
  return std::all_of(variables.begin(), variables.end(),
                     [&](int v) { return keepsWithin(motion, v, strays.of(v), ranges_[static_cast<std::size_t>(v)]); });
}

void ProvenPairs::addFreeParts(const engine::Problem& problem, const JointMotion& motion, const VariableStrays& strays,
                               const engine::Margins& margins, std::vector<std::uint8_t>& parts) const {
  constexpr std::uint8_t kAll = 0xff;
  const bool all_within = within(used_, motion, strays);  // so it mostly is, and no pair has to be looked at by itself
  for (const Pair& pair : checked_) {
    if (margins.of(problem.linkPair(static_cast<std::int32_t>(pair.number))) > pair.margin) continue;
    if (all_within || within(pair.variables, motion, strays)) parts[pair.number] = kAll;
  }
}

std::size_t ProvenPairs::unprovenAllowed(const JointMotion* const* motions, std::size_t num_motions,
                                         const VariableStrays& strays, const engine::Margins& margins, bool self,
                                         bool scene) const {
  std::size_t unproven = scene ? allowed_scene_ : 0;
  if (!self) return unproven;
  unproven += allowed_self_ + (undecided_ ? undecided_->size() : 0);
  const auto allWithin = [&](const std::vector<int>& variables) {
    return std::all_of(motions, motions + num_motions,
                       [&](const JointMotion* motion) { return within(variables, *motion, strays); });
  };
  if (allowed_.empty()) return unproven;
  const bool all_within = allWithin(used_);  // so it mostly is, and no pair has to be looked at by itself
  if (all_within && margins.ofOwn(-1) <= least_allowed_margin_) return unproven - proven_names_;
  for (std::size_t i = 0; i < allowed_.size();) {
    // Entries of one pair of names lie together.
    const std::size_t number = allowed_[i].number;
    bool all = true;
    for (; i < allowed_.size() && allowed_[i].number == number; ++i) {
      all = all && margins.ofOwn(allowed_[i].own) <= allowed_[i].margin &&
            (all_within || allWithin(allowed_[i].variables));
    }
    unproven -= all;
  }
  return unproven;
}

}  // namespace fcl_artic
