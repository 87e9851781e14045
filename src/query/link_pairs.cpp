// SPDX-License-Identifier: BSD-3-Clause
//
// Finds how pairs of links touch over all values within their joints' limits: never, sometimes or always. A pair is
// "never" by proof alone; everything else here only saves that proof its work, or shows what hinders it. Neighbours are
// looked at so before each set-up of the robot, with less work.
#include <cmath>
#include <deque>
#include <functional>
#include <limits>
#include <map>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>

#include "kinematics/angles.h"
#include "numerics/shown.h"
#include "query/engine_query.h"
#include "query/manager_impl.h"
#include "setup/link_proofs.h"
#include "setup/neighbours.h"
#include "tables/range_proof.h"
#include "threads/parallel.h"

namespace fcl_artic {
namespace {

/// Work for a first try. It is enough for a third of the pairs that never touch.
constexpr std::uint64_t kFirstWork = 4000;
/// Numbers of searches for a contact, before the proof and after a proof that failed, each from another configuration.
/// One more search begins where the first try failed. Measured on TALOS: 1,000 samples find contacts of 482 pairs. The
/// search from where the first try failed brings them to 873, two more to 879, eight more to 884.
constexpr std::size_t kSearches = 2, kMoreSearches = 8;
/// Each proof of a pair with balls may take half as much work as the proof without, all of them together as much.
/// Measured on TALOS: with an eighth for each, 9 of 335 pairs stay unproven; with all of the work for each, no more
/// pairs are proven, in 1.1 times the time.
constexpr std::uint64_t kPartPerCut = 2;

/// Number of configurations tried for two neighbours, and work per pair of their geometries. This takes a millisecond
/// or two if the links touch throughout, and some ten if a proof fails (test/data/robots_test.cpp measures the set-up
/// of public robots).
constexpr std::size_t kSamplesOfNeighbours = 32;
constexpr std::uint64_t kWorkOfNeighbours = 50000;

/// Two links' geometries, each with each.
struct Pair {
  LinkId link1, link2;  ///< link1 < link2
  std::vector<std::size_t> numbers;
};

/// The range of a variable to try: its limits, or a whole turn for an angle without any. A slide without limits stays
/// at 0.
ValueRange rangeToTry(const KinematicTree& tree, int variable) {
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
             const LinkPairOptions& options, QueryWorkspace& workspace)
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

  /// Finds only whether the links touch nowhere, somewhere, or throughout. Touching configurations are looked for
  /// first: most neighbours touch throughout.
  /// @param[out] finding  all but the names.
  void runShort(LinkPairFinding& finding) {
    finding.nearest = std::numeric_limits<double>::infinity();
    if (!bounded()) return;
    const bool rigid = variables().empty();
    for (std::size_t samples = 1; samples <= (rigid ? 1 : options_.samples); samples *= 2) {
      tryConfigurations(samples, finding);
      if (finding.touching > 0 && finding.apart > 0) return setTouching(finding);
    }
    if (finding.touching > 0) return setTouching(finding);
    if (finding.apart == finding.tried && prove(options_.work, false)) return setNever(finding);
    if (!rigid) search(0, kSearches, finding);
    if (finding.touching == 0) return set(finding, LinkPairKind::unproven, false);
    setTouching(finding);
  }

  /// For links that touch at all configurations that runShort() tries: says for each pair of their geometries whether
  /// it is apart at one of these. A housing that overlaps in the joint excuses no other part of the two links.
  /// @return empty: none, or no joint moves them.
  std::vector<bool> apartSomewhere() {
    std::vector<bool> apart(proofs_.size());
    if (variables().empty() || proofs_.size() == 1) return {};
    for (std::size_t i = 0; i < proofs_.size(); ++i) {
      for (std::size_t sample = 0; sample < options_.samples && !apart[i]; ++sample) {
        const std::vector<double> values = ofProof(proofs_[i], valuesToTry(sample));
        apart[i] = proofs_[i].at(values, options_.margin) == RangeProof::Contact::none;
      }
    }
    if (std::none_of(apart.begin(), apart.end(), [](bool one) { return one; })) return {};
    return apart;
  }

  /// @param[out] finding  all but the names.
  void run(LinkPairFinding& finding) {
    finding.nearest = std::numeric_limits<double>::infinity();
    if (!bounded()) return;
    if (prove(std::min(kFirstWork, options_.work), false)) return set(finding, LinkPairKind::never, true);
    // Contacts are looked for first: they are found in less time than proofs fail.
    const bool rigid = variables().empty();
    tryConfigurations(rigid ? 1 : options_.samples, finding);
    if (finding.touching == 0 && !rigid) {
      search(0, kSearches, finding);
      if (finding.touching == 0 && prove(options_.work, true)) return setNever(finding);
      if (finding.touching == 0) search(kSearches, kSearches + kMoreSearches, finding);
    }
    if (finding.touching == 0 && finding.configuration.size() == 0) return;
    if (finding.touching == 0) return set(finding, LinkPairKind::unproven, false);
    setTouching(finding);
  }

 private:
  std::size_t placeOf(int variable) const {
    return static_cast<std::size_t>(std::lower_bound(variables_.begin(), variables_.end(), variable) -
                                    variables_.begin());
  }

  bool bounded() const {
    return std::all_of(proofs_.begin(), proofs_.end(), [](const RangeProof& proof) { return proof.bounded(); });
  }

  static void set(LinkPairFinding& finding, LinkPairKind kind, bool proven) {
    finding.kind = kind;
    finding.proven = proven;
  }
  /// For links that touch in some configuration, or in all that were tried.
  void setTouching(LinkPairFinding& finding) const {
    finding.nearest = options_.margin;
    const bool always = finding.apart == 0;
    set(finding, always ? LinkPairKind::always : LinkPairKind::sometimes, !always || variables().empty());
  }
  /// The pair is proven apart: earlier tries are forgotten.
  static void setNever(LinkPairFinding& finding) {
    finding.tried = finding.apart = 0;
    finding.configuration.resize(0);
    finding.nearest = std::numeric_limits<double>::infinity();
    set(finding, LinkPairKind::never, true);
  }

  /// @param balls  whether to try them first.
  bool prove(std::uint64_t work, bool balls) {
    for (std::size_t i = 0; i < proofs_.size(); ++i) {
      if (proven_[i] || (balls && proveWithBalls(i, work))) continue;
      const RangeProof::Result found = proofs_[i].prove(work);
      if (!found.apart) {
        failed_at_ = inOrder(proofs_[i], found.values);
        return false;
      }
      proven_[i] = true;
    }
    return true;
  }

  /// Proves two geometries apart, with balls in place of the links and the joints next to them (doc/NUMERICS.md, Lemma
  /// 10).
  bool proveWithBalls(std::size_t number, std::uint64_t work) {
    std::uint64_t left = work;
    for (const RangeProof::Cut& cut : proofs_[number].cuts()) {
      RangeProof proof(tree_, problem_, problem_.link_pairs[pair_.numbers[number]], options_.margin, workspace_.engine,
                       cut);
      if (touches(proof)) continue;
      const RangeProof::Result found = proof.prove(std::min(left, work / kPartPerCut));
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

  /// Number `number` of a sequence of values that is spread evenly over ranges.
  static std::vector<double> spread(const std::vector<ValueRange>& ranges, std::size_t number) {
    const EvenlySpread place(ranges.size());
    std::vector<double> values(ranges.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
      const ValueRange& range = ranges[i];
      values[i] = std::clamp(range.lower + place(number, i) * (range.upper - range.lower), range.lower, range.upper);
    }
    return values;
  }

  /// The configuration number `sample` that is tried. The first is the robot at rest: all joints at 0, or as near as
  /// their limits let them.
  std::vector<double> valuesToTry(std::size_t sample) const {
    if (sample > 0) return spread(ranges_, sample);
    std::vector<double> values;
    for (const ValueRange& range : ranges_) values.push_back(std::clamp(0.0, range.lower, range.upper));
    return values;
  }

  /// Tries configurations, until `samples` are tried.
  void tryConfigurations(std::size_t samples, LinkPairFinding& finding) {
    for (; finding.tried < samples; ++finding.tried) {
      const std::vector<double> values = valuesToTry(finding.tried);
      const RangeProof::Contact contact = at(values, options_.margin);
      finding.apart += contact == RangeProof::Contact::none;
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
  QueryWorkspace& workspace_;
  std::deque<RangeProof> proofs_;  ///< of the links' geometries, each with each
  std::vector<bool> proven_;       ///< which of them are
  std::vector<int> variables_;
  std::vector<ValueRange> ranges_;  ///< to try
  std::vector<double> failed_at_;   ///< where the last proof that failed did
};

/// The problem's pairs, by links.
std::vector<Pair> pairsOf(const Registry& registry, const engine::Problem& problem) {
  std::map<std::pair<LinkId, LinkId>, Pair> pairs;
  for (std::int32_t i = 0; i < problem.num_link_pairs; ++i) {
    const engine::LinkPair& pair = problem.link_pairs[i];
    const LinkId a = registry.body(pair.a).link, b = registry.body(pair.b).link;
    const auto [first, second] = std::minmax(a, b);
    Pair& of_links = pairs.try_emplace({first, second}, Pair{first, second, {}}).first->second;
    of_links.numbers.push_back(static_cast<std::size_t>(i));
  }
  std::vector<Pair> all;
  for (auto& [links_of_pair, pair] : pairs) all.push_back(std::move(pair));
  return all;
}

/// The shapes and joints for which proofs and findings of a pair of geometries hold.
PairMaking makingOf(const Registry& registry, const engine::LinkPair& pair) {
  return PairMaking::inOrder(*registry.tree(), registry.body(pair.a), registry.body(pair.b));
}

/// Classifies pairs over threads.
/// @param seek  f(i, classifier, finding) for the i-th pair; the names are there already.
/// @param[out] findings  of each pair.
/// @param[out] proofs  of those that never touch.
/// @param done  called after each, by one thread at a time.
template <class Seek, class Done>
void classifyPairs(const Registry& registry, const engine::Problem& problem, const std::vector<Pair>& pairs,
                   const LinkPairOptions& options, const Seek& seek, const Done& done,
                   std::vector<LinkPairFinding>& findings, LinkPairProofs& proofs) {
  const KinematicTree& tree = *registry.tree();
  const std::set<LinkId> with_geometry = registry.linksWithGeometry();
  findings.assign(pairs.size(), LinkPairFinding());
  std::vector<std::vector<int>> variables(pairs.size());
  std::mutex mutex;
  parallelFor(pairs.size(), options.threads, [&](std::size_t i) {
    LinkPairFinding& finding = findings[i];
    finding.link1 = tree.linkName(pairs[i].link1);
    finding.link2 = tree.linkName(pairs[i].link2);
    finding.neighbours = areNeighbours(tree, with_geometry, pairs[i].link1, pairs[i].link2);
    const WorkspaceLoan workspace;
    Classifier classifier(tree, problem, pairs[i], options, *workspace);
    seek(i, classifier, finding);
    variables[i] = classifier.variables();
    const std::lock_guard<std::mutex> lock(mutex);
    done();
  });
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (findings[i].kind != LinkPairKind::never) continue;
    for (const std::size_t number : pairs[i].numbers)
      proofs.add({makingOf(registry, problem.link_pairs[number]), options.margin, variables[i]});
  }
}

}  // namespace

std::shared_ptr<const NeighbourFindings> lookAtNeighbours(const Registry& registry) {
  const std::set<LinkId> with_geometry = registry.linksWithGeometry();
  const auto asked = [&](const ManagedBody& a, const ManagedBody& b) {
    return registry.areOpenNeighbours(with_geometry, a.link, b.link);
  };
  Setup setup;
  setup.buildPairs(registry, asked);
  const engine::Problem problem = setup.problem();
  const NeighbourFindings* const before = registry.neighbours();
  auto found = std::make_shared<NeighbourFindings>();
  std::vector<Pair> open;
  std::vector<std::vector<PairMaking>> made_of_open;
  for (Pair& pair : pairsOf(registry, problem)) {
    const NeighbourFindings::Links links(pair.link1, pair.link2);
    std::vector<PairMaking> made;
    for (const std::size_t number : pair.numbers) made.push_back(makingOf(registry, problem.link_pairs[number]));
    const auto old = before ? before->pairs.find(links) : decltype(before->pairs.end()){};
    if (before && old != before->pairs.end() &&
        std::equal(made.begin(), made.end(), old->second.made.begin(), old->second.made.end(),
                   std::mem_fn(&PairMaking::sameAs))) {
      found->pairs.emplace(*old);
      for (const PairMaking& of : made) {
        if (const LinkPairProofs::Proof* proof = before->proofs.find(of, 0)) found->proofs.add(*proof);
      }
    } else {
      open.push_back(std::move(pair));
      made_of_open.push_back(std::move(made));
    }
  }
  LinkPairOptions options;
  options.samples = kSamplesOfNeighbours;
  options.work = kWorkOfNeighbours;
  std::vector<LinkPairFinding> findings;
  std::vector<std::vector<bool>> apart(open.size());
  classifyPairs(
      registry, problem, open, options,
      [&](std::size_t i, Classifier& classifier, LinkPairFinding& finding) {
        classifier.runShort(finding);
        if (finding.touchThroughout()) apart[i] = classifier.apartSomewhere();
      },
      [] {}, findings, found->proofs);
  for (std::size_t i = 0; i < open.size(); ++i) {
    const NeighbourFindings::Links links(open[i].link1, open[i].link2);
    found->pairs.emplace(
        links, NeighbourFindings::Pair{std::move(findings[i]), std::move(made_of_open[i]), std::move(apart[i])});
  }
  return found;
}

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
  setup.buildPairs(registry, [](const ManagedBody&, const ManagedBody&) { return true; });
  const engine::Problem problem = setup.problem();
  std::vector<Pair> pairs;
  for (Pair& pair : pairsOf(registry, problem)) {
    const bool asked = !options.only || options.only->allowed(tree.linkName(pair.link1), tree.linkName(pair.link2));
    if (asked) pairs.push_back(std::move(pair));
  }

  LinkPairReport report;
  const auto proofs = std::make_shared<LinkPairProofs>();
  std::size_t done = 0;
  classifyPairs(
      registry, problem, pairs, options,
      [](std::size_t, Classifier& classifier, LinkPairFinding& finding) { classifier.run(finding); },
      [&] {
        if (options.progress) options.progress(++done, pairs.size());
      },
      report.pairs, *proofs);
  report.proofs = proofs;
  return report;
}

AllowedCollisionMatrix LinkPairReport::alwaysTouching() const {
  AllowedCollisionMatrix matrix;
  for (const LinkPairFinding& pair : pairs) {
    if (pair.kind == LinkPairKind::always && !pair.neighbours) matrix.allow(pair.link1, pair.link2);
  }
  return matrix;
}

AllowedCollisionMatrix LinkPairReport::needNoCheck() const {
  AllowedCollisionMatrix matrix = alwaysTouching();
  for (const LinkPairFinding& pair : pairs) {
    if (pair.kind == LinkPairKind::never || (pair.neighbours && pair.leftOut())) matrix.allow(pair.link1, pair.link2);
  }
  return matrix;
}

std::size_t LinkPairReport::count(LinkPairKind kind) const {
  return static_cast<std::size_t>(
      std::count_if(pairs.begin(), pairs.end(), [&](const LinkPairFinding& pair) { return pair.kind == kind; }));
}

}  // namespace fcl_artic
