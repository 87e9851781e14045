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
#include "setup/link_proofs.h"
#include "setup/neighbours.h"
#include "tables/range_proof.h"
#include "threads/parallel.h"

namespace fcl_artic {
namespace {

/// Work for a first try, which a third of the pairs that never touch need no more than.
constexpr std::uint64_t kFirstWork = 4000;
/// Searches for a contact before the proof, besides one from where the first try failed, and after a proof that failed;
/// each from another configuration. Measured on TALOS: 1,000 samples find contacts of 482 pairs, the search from where
/// the first try failed brings them to 873, two more to 879, eight more to 884.
constexpr std::size_t kSearches = 2, kMoreSearches = 8;
/// All proofs of one pair with balls may take as much work as the one without, each of them half of that. Measured on
/// TALOS: an eighth each leaves 9 of 335 pairs unproven, all of the work for each proves no more in 1.1 times as long.
constexpr std::uint64_t kPartPerCut = 2;

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
      : tree_(tree), problem_(problem), pair_(pair), options_(options), workspace_(workspace) {
    for (const std::size_t number : pair.numbers) {
      proofs_.emplace_back(tree, problem, problem.link_pairs[number], options.margin, workspace.engine);
    }
    proven_.resize(proofs_.size());
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
    if (prove(std::min(kFirstWork, options_.work), false)) return set(finding, LinkPairKind::never, true);
    // Contacts are looked for first: they are found in less time than proofs fail.
    const bool rigid = variables().empty();
    tryConfigurations(rigid ? 1 : options_.samples, finding);
    if (finding.touching == 0 && !rigid) {
      search(0, kSearches, finding);
      if (finding.touching == 0 && prove(options_.work, true)) {
        finding.tried = 0;
        finding.configuration.resize(0);
        finding.nearest = std::numeric_limits<double>::infinity();
        return set(finding, LinkPairKind::never, true);
      }
      if (finding.touching == 0) search(kSearches, kSearches + kMoreSearches, finding);
    }
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

  /// @param balls  whether to try them first.
  bool prove(std::uint64_t work, bool balls) {
    for (std::size_t i = 0; i < proofs_.size(); ++i) {
      if (proven_[i] || (balls && proveWithBalls(i, work))) continue;
      const RangeProof::Finding found = proofs_[i].prove(work);
      if (!found.apart) {
        failed_at_ = inOrder(proofs_[i], found.values);
        return false;
      }
      proven_[i] = true;
    }
    return true;
  }

  /// Two geometries, with balls in the place of the links and the joints next to them (doc/NUMERICS.md, Lemma 10).
  bool proveWithBalls(std::size_t number, std::uint64_t work) {
    std::uint64_t left = work;
    for (const RangeProof::Cut& cut : proofs_[number].cuts()) {
      RangeProof proof(tree_, problem_, problem_.link_pairs[pair_.numbers[number]], options_.margin, workspace_.engine,
                       cut);
      if (touches(proof)) continue;
      const RangeProof::Finding found = proof.prove(std::min(left, work / kPartPerCut));
      if (found.apart) return proven_[number] = true;
      left -= std::min(left, found.work);
      if (left == 0) break;
    }
    return false;
  }

  /// Whether a short search finds that the bodies of a proof touch.
  bool touches(RangeProof& proof) const {
    std::vector<ValueRange> within;
    for (const int v : proof.variables()) within.push_back(ranges_[placeOf(v)]);
    for (std::size_t start = 0; start < kSearches; ++start) {
      std::vector<double> values = spread(within, start);
      if (proof.comeNearer(within, options_.margin, values) <= options_.margin) return true;
    }
    return false;
  }

  /// Values of a proof's variables, in the order of variables().
  std::vector<double> inOrder(const RangeProof& proof, const std::vector<double>& values) const {
    std::vector<double> sorted(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) sorted[placeOf(proof.variables()[i])] = values[i];
    return sorted;
  }
  /// And back.
  template <class T>
  std::vector<T> ofProof(const RangeProof& proof, const std::vector<T>& sorted) const {
    std::vector<T> values;
    for (const int v : proof.variables()) values.push_back(sorted[placeOf(v)]);
    return values;
  }

  RangeProof::Contact at(const std::vector<double>& values, double margin) {
    RangeProof::Contact most = RangeProof::Contact::none;
    for (RangeProof& proof : proofs_) {
      const RangeProof::Contact contact = proof.at(ofProof(proof, values), margin);
      if (contact == RangeProof::Contact::touch) return contact;
      if (contact == RangeProof::Contact::unknown) most = contact;
    }
    return most;
  }

  /// One of a row of values spread evenly over ranges.
  static std::vector<double> spread(const std::vector<ValueRange>& ranges, std::size_t number) {
    const EvenlySpread place(ranges.size());
    std::vector<double> values(ranges.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
      const ValueRange& range = ranges[i];
      values[i] = std::clamp(range.lower + place(number, i) * (range.upper - range.lower), range.lower, range.upper);
    }
    return values;
  }

  /// Tries configurations.
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

  /// Looks for a contact from where the proof failed, then from some of the configurations that are spread evenly.
  void search(std::size_t first, std::size_t end, LinkPairFinding& finding) {
    if (failed_at_.size() == variables().size()) comeNearer(failed_at_, finding);
    for (std::size_t i = first; i < end && finding.touching == 0; ++i) comeNearer(spread(ranges_, i), finding);
  }

  /// Goes from a configuration to where the links are nearer, and so perhaps to where they touch.
  void comeNearer(std::vector<double> from, LinkPairFinding& finding) {
    for (std::size_t i = 0; i < from.size(); ++i) from[i] = std::clamp(from[i], ranges_[i].lower, ranges_[i].upper);
    for (RangeProof& proof : proofs_) {
      std::vector<double> values = ofProof(proof, from);
      const double distance = proof.comeNearer(ofProof(proof, ranges_), options_.margin, values);
      if (!(distance < finding.nearest)) continue;
      finding.nearest = distance;
      finding.configuration = configuration(inOrder(proof, values));
      if (distance > options_.margin) continue;
      ++finding.tried;
      ++finding.touching;
      return;
    }
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
  const engine::Problem& problem_;
  const Pair& pair_;
  const LinkPairOptions& options_;
  Workspace& workspace_;
  std::deque<RangeProof> proofs_;  ///< of the links' geometries, each with each
  std::vector<bool> proven_;       ///< which of them are
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
