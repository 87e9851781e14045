// SPDX-License-Identifier: BSD-3-Clause
//
// What pairs of links do over all values within their joints' limits. A pair is "never" by proof alone; everything else
// here only saves that proof its work, or shows what hinders it.
#include <cmath>
#include <deque>
#include <limits>
#include <mutex>
#include <stdexcept>
#include <string>

#include "numerics/shown.h"
#include "query/engine_query.h"
#include "query/manager_impl.h"
#include "query/parallel.h"
#include "setup/link_proofs.h"
#include "setup/neighbours.h"
#include "tables/range_proof.h"

namespace fcl_artic {
namespace {

/// Work for a first try, which most pairs that never touch need no more than; and configurations tried after it, which
/// most pairs that touch do in.
constexpr std::uint64_t kFirstWork = 4000;
constexpr std::size_t kFirstSamples = 32;

/// Two links' geometries, each with each.
struct Pair {
  LinkId link1, link2;  ///< link1 < link2
  std::vector<std::size_t> numbers;
};

/// Values of a variable to try: its limits; of an angle without any, a turn. A slide without limits stays at 0.
ValueRange rangeToTry(const KinematicTree& tree, int variable) {
  constexpr double kPi = 3.141592653589793;
  const Joint& joint = tree.joint(tree.variableJoint(variable));
  if (hasLimits(joint) && std::isfinite(joint.upper - joint.lower)) return {joint.lower, joint.upper};
  return tree.isAngle(variable) ? ValueRange{-kPi, kPi} : ValueRange{0, 0};
}

/// Points spread evenly over the unit cube, the same for everybody: multiples of powers of 1/g modulo 1, where g^(n+1)
/// = g + 1 (Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018).
class EvenlySpread {
 public:
  explicit EvenlySpread(std::size_t dimensions) : steps_(dimensions) {
    double g = 1;
    for (int i = 0; i < 60; ++i) g = std::pow(1 + g, 1.0 / (static_cast<double>(dimensions) + 1));
    double power = 1;
    for (double& step : steps_) step = power /= g;
  }
  double operator()(std::size_t point, std::size_t dimension) const {
    const double x = 0.5 + static_cast<double>(point + 1) * steps_[dimension];
    return x - std::floor(x);
  }

 private:
  std::vector<double> steps_;
};

/// Finds out what one pair of links does.
class Classifier {
 public:
  Classifier(const KinematicTree& tree, const engine::Problem& problem, const Pair& pair,
             const LinkPairOptions& options, Workspace& workspace)
      : tree_(tree), options_(options) {
    for (const std::size_t number : pair.numbers) {
      proofs_.emplace_back(tree, problem, problem.link_pairs[number], options.margin, workspace.engine);
    }
    variables_ = proofs_.front().variables();
    std::sort(variables_.begin(), variables_.end());
    for (const int v : variables_) ranges_.push_back(rangeToTry(tree, v));
  }

  /// The variables between the links, in ascending order. (A proof has them in the order of its own path, which begins
  /// at the one link or at the other.)
  const std::vector<int>& variables() const { return variables_; }

  /// @param[out] finding  all but the names.
  void run(LinkPairFinding& finding) {
    finding.nearest = std::numeric_limits<double>::infinity();
    for (const RangeProof& proof : proofs_) {
      if (!proof.bounded()) return;
    }
    if (prove(std::min(kFirstWork, options_.work))) return set(finding, LinkPairKind::never, true);
    const bool rigid = variables().empty();
    const std::size_t samples = rigid ? 1 : options_.samples;
    tryConfigurations(std::min(kFirstSamples, samples), finding);
    if (finding.touching == 0 && !rigid && prove(options_.work)) {
      finding.tried = 0;
      return set(finding, LinkPairKind::never, true);
    }
    tryConfigurations(samples, finding);
    if (finding.touching == 0 && !rigid) comeNearer(finding);
    if (finding.touching == 0 && finding.configuration.size() == 0) return;
    if (finding.touching == 0) return set(finding, LinkPairKind::unproven, false);
    finding.nearest = options_.margin;
    const bool always = apart_ == 0;
    set(finding, always ? LinkPairKind::always : LinkPairKind::sometimes, !always || rigid);
  }

 private:
  std::size_t placeOf(int variable) const {
    return static_cast<std::size_t>(std::lower_bound(variables_.begin(), variables_.end(), variable) -
                                    variables_.begin());
  }

  static void set(LinkPairFinding& finding, LinkPairKind kind, bool proven) {
    finding.kind = kind;
    finding.proven = proven;
  }

  bool prove(std::uint64_t work) {
    for (RangeProof& proof : proofs_) {
      const RangeProof::Finding found = proof.prove(work);
      if (found.apart) continue;
      failed_at_.resize(found.values.size());
      for (std::size_t i = 0; i < found.values.size(); ++i) failed_at_[placeOf(proof.variables()[i])] = found.values[i];
      return false;
    }
    return true;
  }

  RangeProof::Contact at(const std::vector<double>& values, double margin) {
    RangeProof::Contact most = RangeProof::Contact::none;
    std::vector<double> own(values.size());
    for (RangeProof& proof : proofs_) {
      for (std::size_t i = 0; i < own.size(); ++i) own[i] = values[placeOf(proof.variables()[i])];
      const RangeProof::Contact contact = proof.at(own, margin);
      if (contact == RangeProof::Contact::touch) return contact;
      if (contact == RangeProof::Contact::unknown) most = contact;
    }
    return most;
  }

  /// Tries configurations until so many have been tried.
  void tryConfigurations(std::size_t samples, LinkPairFinding& finding) {
    const EvenlySpread spread(variables().size());
    std::vector<double> values(variables().size());
    for (; finding.tried < samples; ++finding.tried) {
      for (std::size_t i = 0; i < values.size(); ++i) {
        const ValueRange& range = ranges_[i];
        // The first one is the robot at rest: all joints at 0, or as near as their limits let them.
        const double value =
            finding.tried == 0 ? 0 : range.lower + spread(finding.tried, i) * (range.upper - range.lower);
        values[i] = std::clamp(value, range.lower, range.upper);
      }
      const RangeProof::Contact contact = at(values, options_.margin);
      apart_ += contact == RangeProof::Contact::none;
      if (contact != RangeProof::Contact::touch) continue;
      if (finding.touching++ == 0) finding.configuration = configuration(values);
    }
  }

  /// Goes from where the proof failed to where the links are nearer, as long as that gets on, and so perhaps to where
  /// they touch.
  void comeNearer(LinkPairFinding& finding) {
    if (failed_at_.size() != variables().size()) return;
    std::vector<double> best = failed_at_, step(best.size());
    for (std::size_t i = 0; i < step.size(); ++i) {
      const ValueRange& range = ranges_[i];
      best[i] = std::clamp(best[i], range.lower, range.upper);
      step[i] = 0.05 * (range.upper - range.lower);
    }
    constexpr double kFarthest = 1e9;  // beyond all coordinates
    double distance = 0.1;             // an upper bound of the links' distance there
    while (at(best, options_.margin + distance) != RangeProof::Contact::touch) {
      if ((distance *= 2) > kFarthest) return;
    }
    const auto nearer = [&](const std::vector<double>& values) {
      if (at(values, options_.margin + 0.9 * distance) != RangeProof::Contact::touch) return false;
      while (distance > 1e-7 && at(values, options_.margin + 0.9 * distance) == RangeProof::Contact::touch) {
        distance *= 0.9;
      }
      best = values;
      return true;
    };
    nearer(best);
    for (int round = 0; round < 16; ++round) {
      bool moved = false;
      for (std::size_t i = 0; i < best.size(); ++i) {
        const ValueRange& range = ranges_[i];
        for (const double way : {step[i], -step[i]}) {
          std::vector<double> values = best;
          values[i] = std::clamp(values[i] + way, range.lower, range.upper);
          if (nearer(values)) {
            moved = true;
            break;
          }
        }
      }
      if (at(best, options_.margin) == RangeProof::Contact::touch) {
        ++finding.tried;
        ++finding.touching;
        break;
      }
      if (moved) continue;
      for (double& way : step) way *= 0.4;
    }
    finding.configuration = configuration(best);
    finding.nearest = options_.margin + (finding.touching > 0 ? 0 : distance);
  }

  Eigen::VectorXd configuration(const std::vector<double>& values) const {
    Eigen::VectorXd q = tree_.neutralConfiguration();
    for (int v = 0; v < tree_.dof(); ++v) {
      const Joint& joint = tree_.joint(tree_.variableJoint(v));
      if (hasLimits(joint)) q[v] = std::clamp(q[v], joint.lower, joint.upper);
    }
    for (std::size_t i = 0; i < values.size(); ++i) q[variables()[i]] = values[i];
    return q;
  }

  const KinematicTree& tree_;
  const LinkPairOptions& options_;
  std::deque<RangeProof> proofs_;  ///< of the links' geometries, each with each
  std::vector<int> variables_;
  std::vector<ValueRange> ranges_;  ///< to try
  std::vector<double> failed_at_;   ///< where the last proof that failed did
  std::size_t apart_ = 0;           ///< configurations tried in which they certainly are
};

/// Pairs of links with geometry, neighbours without numbers.
std::vector<Pair> pairsOf(const Registry& registry, const engine::Problem& problem) {
  std::set<LinkId> links;
  for (const ManagedBody& body : registry.links()) {
    if (!body.attached && !body.empty()) links.insert(body.link);
  }
  std::map<std::pair<LinkId, LinkId>, Pair> pairs;
  for (const LinkId a : links) {
    for (const LinkId b : links) {
      if (a < b) pairs[{a, b}] = {a, b, {}};
    }
  }
  for (std::int32_t i = 0; i < problem.num_link_pairs; ++i) {
    const engine::LinkPair& pair = problem.link_pairs[i];
    const LinkId a = registry.body(pair.a).link, b = registry.body(pair.b).link;
    pairs.at(std::minmax(a, b)).numbers.push_back(static_cast<std::size_t>(i));
  }
  std::vector<Pair> all;
  for (auto& [links_of_pair, pair] : pairs) all.push_back(std::move(pair));
  return all;
}

}  // namespace

LinkPairReport ArticulatedCollisionManager::classifyLinkPairs(const LinkPairOptions& options) const {
  const Registry& registry = impl_->registry;
  const KinematicTree& tree = *registry.tree();
  if (!(options.margin >= 0 && std::isfinite(options.margin))) {
    throw std::invalid_argument("classifyLinkPairs: the margin is " + shown(options.margin) +
                                ", must be finite and at least 0");
  }
  if (options.samples < 1) throw std::invalid_argument("classifyLinkPairs: samples is 0, must be positive");
  if (options.threads < 0) {
    throw std::invalid_argument("classifyLinkPairs: the number of threads is " + std::to_string(options.threads));
  }
  Setup setup;
  setup.buildEveryPair(registry);
  const engine::Problem problem = setup.problem();
  std::vector<Pair> pairs = pairsOf(registry, problem);
  if (options.only) {
    pairs.erase(std::remove_if(pairs.begin(), pairs.end(),
                               [&](const Pair& pair) {
                                 return !options.only->allowed(tree.linkName(pair.link1), tree.linkName(pair.link2));
                               }),
                pairs.end());
  }

  LinkPairReport report;
  report.pairs.resize(pairs.size());
  std::vector<std::vector<int>> variables(pairs.size());
  std::mutex mutex;
  std::size_t done = 0;
  parallelFor(pairs.size(), options.threads, [&](std::size_t i) {
    LinkPairFinding& finding = report.pairs[i];
    finding.link1 = tree.linkName(pairs[i].link1);
    finding.link2 = tree.linkName(pairs[i].link2);
    if (pairs[i].numbers.empty()) {
      finding.kind = LinkPairKind::neighbours;
      finding.proven = true;
    } else {
      const WorkspaceLoan workspace;
      Classifier classifier(tree, problem, pairs[i], options, *workspace);
      classifier.run(finding);
      variables[i] = classifier.variables();
    }
    if (!options.progress) return;
    const std::lock_guard<std::mutex> lock(mutex);
    options.progress(++done, pairs.size());
  });

  const auto proofs = std::make_shared<LinkPairProofs>();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (report.pairs[i].kind != LinkPairKind::never) continue;
    for (const std::size_t number : pairs[i].numbers) {
      const engine::LinkPair& pair = problem.link_pairs[number];
      const ManagedBody *a = &registry.body(pair.a), *b = &registry.body(pair.b);
      if (a->link > b->link) std::swap(a, b);
      proofs->add({PairMaking(tree, *a, *b), options.margin, variables[i]});
    }
  }
  report.proofs = proofs;
  return report;
}

AllowedCollisionMatrix LinkPairReport::alwaysTouching() const {
  AllowedCollisionMatrix matrix;
  for (const LinkPairFinding& pair : pairs) {
    if (pair.kind == LinkPairKind::always) matrix.allow(pair.link1, pair.link2);
  }
  return matrix;
}

AllowedCollisionMatrix LinkPairReport::needNoCheck() const {
  AllowedCollisionMatrix matrix = alwaysTouching();
  for (const LinkPairFinding& pair : pairs) {
    if (pair.kind == LinkPairKind::never || pair.kind == LinkPairKind::neighbours) matrix.allow(pair.link1, pair.link2);
  }
  return matrix;
}

std::size_t LinkPairReport::count(LinkPairKind kind) const {
  return static_cast<std::size_t>(
      std::count_if(pairs.begin(), pairs.end(), [&](const LinkPairFinding& pair) { return pair.kind == kind; }));
}

}  // namespace fcl_artic
