// SPDX-License-Identifier: BSD-3-Clause
#include "tables/range_proof.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "geometry/shape_tree.h"
#include "kinematics/angles.h"
#include "numerics/assertion.h"
#include "numerics/constants.h"
#include "numerics/sine_cosine.h"
#include "tables/bring_together.h"
#include "tables/value_range.h"

namespace fcl_artic {
namespace {

/// Work of a look at the witnesses (mustFail()), in tests of nodes and leaves.
constexpr std::uint64_t kGlanceWork = 15;
/// Tests of nodes and leaves for one box; what needs more is cut in two, each of which may take twice as many. Measured
/// on the Panda: 120 take 1.5 times as long, 3000 as long.
constexpr std::uint64_t kWorkOfBox = 600;
/// What the margin pays for a box that is not cut any further, m: links that come as near are not proven apart.
constexpr double kFinest = 2e-5;
/// A proof is given up when, at its pace so far, it would take more than this many times the work allowed.
constexpr double kMostHope = 8;
/// The way of the variable that the engine moves, as compared with ways that the margin pays for: where it is longer
/// by more than this, it is halved first. Measured on the Panda: 0.3 takes 1.4 times as long, 1 and 2 take 1.2 times as
/// long.
constexpr double kMovedWeight = 0.6;

using RowMajor = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;
using Points = Eigen::Matrix<double, 3, 10>;

}  // namespace

double ValueRange::half() const {
  return std::max(upper - middle(), middle() - lower) * (1 + 4 * kUlp);
}

ValueRange wholeRange(const KinematicTree& tree, int variable) {
  constexpr double kAll = std::numeric_limits<double>::infinity();
  const Joint& joint = tree.joint(tree.variableJoint(variable));
  if (KinematicTree::numVariables(joint.type) != 1) return {kAll, -kAll};
  if (hasLimits(joint)) {
    const double beyond = kBeyondLimits * (joint.upper - joint.lower);
    return {joint.lower - beyond, joint.upper + beyond};
  }
  if (!tree.isAngle(variable)) return {kAll, -kAll};
  return {-kAll, kAll};
}

RangeProof::RangeProof(const KinematicTree& tree, const engine::Problem& problem, const engine::LinkPair& pair,
                       double margin, engine::EngineWorkspace& workspace, const Cut& cut)
    : workspace_(workspace),
      pair_(pair),
      margin_(margin),
      of_a_(outlineOf(problem.bodies[pair.a])),
      of_b_(outlineOf(problem.bodies[pair.b])) {
  const engine::SweepView& sweep = problem.sweeps[pair.sweep];
  for (int s = pair.step_b; s >= 0; s = sweep.steps[s].parent) path_.push_back(sweep.steps[s]);
  std::reverse(path_.begin(), path_.end());
  const engine::Body &a = problem.bodies[pair.a], &b = problem.bodies[pair.b];
  double length = pair.inverse_a.length + pair.placement_b.length + 4 * (a.tree->extent + b.tree->extent);
  double ulps = pair.inverse_a.ulps + pair.placement_b.ulps + 128;
  for (std::size_t i = 0; i < path_.size(); ++i) {
    engine::SweepStep& step = path_[i];
    step.parent = static_cast<std::int32_t>(i) - 1;
    if (step.kind != engine::StepKind::revolute && step.kind != engine::StepKind::prismatic) {
      bounded_ = false;
      return;
    }
    const auto known = std::find(variables_.begin(), variables_.end(), step.variable);
    const auto number = static_cast<std::size_t>(known - variables_.begin());
    if (known == variables_.end()) {
      variables_.push_back(step.variable);
      steps_of_.push_back(0);
      whole_.push_back(wholeRange(tree, step.variable));
    }
    ++steps_of_[number];
    ValueRange& range = whole_[number];
    // Poses have the period 2 pi in a variable that drives nothing but turns by whole multiples: one turn is all.
    const bool whole_turns = step.kind == engine::StepKind::revolute && step.multiplier == std::round(step.multiplier);
    if (std::isinf(range.lower) && !whole_turns) range = {1, -1};
    step.variable = static_cast<std::int32_t>(number);
  }
  for (ValueRange& range : whole_) {
    if (std::isinf(range.lower) && range.lower < 0) range = {-0.5 * kTwoPi - 1e-9, 0.5 * kTwoPi + 1e-9};
    bounded_ =
        bounded_ && range.lower <= range.upper && std::max(std::abs(range.lower), std::abs(range.upper)) <= kMostValue;
  }
  if (!bounded_) return;
  for (const engine::SweepStep& step : path_) {
    const double most = mostOf(step);
    bounded_ = bounded_ && most <= kMostValue;
    length += step.length + (step.kind == engine::StepKind::prismatic ? most : 0);
    ulps += step.ulps + 64 + 4 * most;
  }
  // Every product of the path is off by less than 64 ulp of the lengths so far, an angle by 4 ulp of its terms.
  pad_ = kUlp * ulps * length;

  pair_.sweep = 0;
  problem_.bodies = problem.bodies;
  problem_.num_bodies = problem.num_bodies;
  problem_.sweeps = &sweep_;
  problem_.num_sweeps = 1;
  problem_.link_pairs = &pair_;
  problem_.num_link_pairs = 1;
  problem_.contained = problem.contained;
  of_a_.points =
      RowMajor(pair_.inverse_a.R).transpose() * (of_a_.points.colwise() - Eigen::Vector3d::Map(pair_.inverse_a.t));
  of_b_.points = (RowMajor(pair_.placement_b.R) * of_b_.points).colwise() + Eigen::Vector3d::Map(pair_.placement_b.t);
  if (cut.of_a + cut.of_b > 0) standIn(cut);
  sweep_.steps = path_.data();
  sweep_.num_steps = static_cast<std::int32_t>(path_.size());
  pair_.step_b = sweep_.num_steps - 1;
  middle_.resize(path_.size());
  way_of_a_.resize(path_.size());
  way_of_b_.resize(path_.size());
  coefficients_.resize(2 * std::max<std::size_t>(1, variables_.size()));
  query_.coefficients = coefficients_.data();
  query_.num_variables = static_cast<std::int32_t>(std::max<std::size_t>(1, variables_.size()));
  query_.check_scene = false;
  query_.describe_contacts = false;
  query_.any = true;
}

/// The value of a step's own motion is at most this, over the whole range; up to rounding.
double RangeProof::mostOf(const engine::SweepStep& step) const {
  const ValueRange& range = whole_[static_cast<std::size_t>(step.variable)];
  return std::abs(step.multiplier) * std::max(std::abs(range.lower), std::abs(range.upper)) + std::abs(step.offset);
}

std::vector<RangeProof::Cut> RangeProof::cuts() const {
  std::vector<Cut> cuts;
  // (A body within the ball may lie in what a solid encloses, and the ball's middle outside.)
  if (!bounded_ || problem_.bodies[pair_.a].space || problem_.bodies[pair_.b].space) return cuts;
  const std::size_t n = path_.size();
  // Turns about axes that meet have the same ball: all of them are cut off, or none.
  const auto sameBall = [&](std::size_t step, std::size_t turn) {
    return Eigen::Vector3d::Map(path_[step].p).isZero(0) && path_[turn].kind == engine::StepKind::revolute;
  };
  std::vector<std::pair<std::size_t, Cut>> found;
  for (std::size_t of_a = 0; of_a <= n; ++of_a) {
    if (of_a > 0 && of_a < n && sameBall(of_a, of_a)) continue;
    for (std::size_t of_b = 0; of_a + of_b <= n; ++of_b) {
      if (of_b > 0 && of_a + of_b < n && sameBall(n - of_b, n - of_b - 1)) continue;
      std::vector<int> left;
      for (std::size_t i = of_a; i < n - of_b; ++i) left.push_back(path_[i].variable);
      std::sort(left.begin(), left.end());
      left.erase(std::unique(left.begin(), left.end()), left.end());
      if (left.size() < variables_.size()) found.push_back({left.size(), {of_a, of_b}});
    }
  }
  std::stable_sort(found.begin(), found.end(), [](const auto& x, const auto& y) { return x.first < y.first; });
  for (const auto& [variables, cut] : found) cuts.push_back(cut);
  return cuts;
}

/// Lemma 10: the bodies become points, the balls' middles, and the margin pays for the radii.
void RangeProof::standIn(const Cut& cut) {
  static const std::shared_ptr<const ShapeTree> kPoint = ShapeTree::fromHull({Eigen::Vector3d::Zero()});
  const std::size_t n = path_.size();
  FCL_ARTIC_ASSERT(cut.of_a + cut.of_b <= n);
  FCL_ARTIC_ASSERT(!problem_.bodies[pair_.a].space && !problem_.bodies[pair_.b].space);
  const auto slide = [&](std::size_t i) { return path_[i].kind == engine::StepKind::prismatic ? mostOf(path_[i]) : 0; };
  const auto offset = [&](std::size_t i) { return Eigen::Vector3d::Map(path_[i].p).norm(); };
  bodies_[0] = problem_.bodies[pair_.a];
  bodies_[1] = problem_.bodies[pair_.b];
  pair_.a = 0;
  pair_.b = 1;
  problem_.bodies = bodies_;
  problem_.num_bodies = 2;
  double radii = 0;
  if (cut.of_a > 0) {
    // From the first step on: how far A reaches from each step's origin, seen from after its motion.
    Outline a = of_a_;
    a.points = RowMajor(path_[0].C).transpose() * (a.points.colwise() - Eigen::Vector3d::Map(path_[0].p));
    double reach = farthestFromOrigin(a) + slide(0);
    for (std::size_t i = 1; i < cut.of_a; ++i) reach += offset(i) + slide(i);
    radii += reach + pad_;
    bodies_[0] = engine::Body();
    bodies_[0].tree = &kPoint->view();
    pair_.inverse_a = engine::Placement();
    of_a_.points.setZero();
    of_a_.radius = 0;
  }
  if (cut.of_b > 0) {
    // From the last step on: how far B reaches from each step's origin, seen from before its motion.
    const std::size_t first = n - cut.of_b;
    double reach = farthestFromOrigin(of_b_) + slide(n - 1);
    for (std::size_t i = n - 1; i > first; --i) reach += offset(i) + slide(i - 1);
    radii += reach + pad_;
    bodies_[1] = engine::Body();
    bodies_[1].tree = &kPoint->view();
    engine::Placement& middle = bodies_[1].placement;
    middle.length = path_[first].length;
    middle.ulps = path_[first].ulps;
    middle.identity = false;
    std::copy_n(path_[first].p, 3, middle.t);
    std::copy_n(path_[first].p, 3, bodies_[1].lss);
    std::copy_n(path_[first].p, 3, bodies_[1].lss + 3);
    pair_.placement_b = middle;
    of_b_.points.colwise() = Eigen::Vector3d::Map(middle.t);
    of_b_.radius = 0;
  }
  balls_ = radii * (1 + 1e-9);
  path_.erase(path_.end() - static_cast<std::ptrdiff_t>(cut.of_b), path_.end());
  path_.erase(path_.begin(), path_.begin() + static_cast<std::ptrdiff_t>(cut.of_a));
  // The variables that are left.
  const std::vector<int> all = std::exchange(variables_, {});
  const Box ranges = std::exchange(whole_, {});
  steps_of_.clear();
  for (std::size_t i = 0; i < path_.size(); ++i) {
    path_[i].parent = static_cast<std::int32_t>(i) - 1;
    const auto old = static_cast<std::size_t>(path_[i].variable);
    const auto known = std::find(variables_.begin(), variables_.end(), all[old]);
    const auto number = static_cast<std::size_t>(known - variables_.begin());
    if (known == variables_.end()) {
      variables_.push_back(all[old]);
      whole_.push_back(ranges[old]);
      steps_of_.push_back(0);
    }
    ++steps_of_[number];
    path_[i].variable = static_cast<std::int32_t>(number);
  }
}

RangeProof::Outline RangeProof::outlineOf(const engine::Body& body) {
  Outline outline;
  const engine::Node& root = body.tree->nodes[0];
  for (int corner = 0; corner < 8; ++corner) {
    for (int k = 0; k < 3; ++k) {
      outline.points(k, corner) = static_cast<double>(corner >> k & 1 ? root.hi[k] : root.lo[k]);
    }
  }
  // The line swept sphere is in the frame of the body's step in the world.
  const RowMajor R(body.placement.R, 3, 3);
  for (int end = 0; end < 2; ++end) {
    outline.points.col(8 + end) =
        R.transpose() * (Eigen::Vector3d::Map(body.lss + 3 * end) - Eigen::Vector3d::Map(body.placement.t));
  }
  outline.radius = body.lss[6] + kUlp * (body.placement.ulps + 64) * (body.placement.length + 4 * body.tree->extent);
  return outline;
}

/// Upper bound of a body's distance from the z axis of the frame that its outline is given in, without rounding.
double RangeProof::farthestFromAxis(const Outline& outline) {
  const auto squared = outline.points.topRows<2>().colwise().squaredNorm().eval();
  return std::min(std::sqrt(squared.head<8>().maxCoeff()), std::sqrt(squared.tail<2>().maxCoeff()) + outline.radius);
}

/// The same of its distance from that frame's origin.
double RangeProof::farthestFromOrigin(const Outline& outline) {
  const auto squared = outline.points.colwise().squaredNorm().eval();
  return std::min(std::sqrt(squared.head<8>().maxCoeff()), std::sqrt(squared.tail<2>().maxCoeff()) + outline.radius);
}

void RangeProof::Joint::set(const engine::SweepStep& step, double variable) {
  const double value = step.multiplier * variable + step.offset;
  if (step.kind == engine::StepKind::prismatic) {
    slide = value;
    return;
  }
  Pair sines, cosines;
  sineCosine(pairOf(value), sines, cosines);
  sine = pairLow(sines);
  cosine = pairLow(cosines);
}

template <class Points>
void RangeProof::Joint::apply(Points& points) const {
  const auto x = points.row(0).eval();
  points.row(0) = cosine * x - sine * points.row(1);
  points.row(1) = sine * x + cosine * points.row(1);
  if (Points::ColsAtCompileTime == 4) {
    points(2, 3) += slide;  // a frame: its axes have no place
  } else {
    points.row(2).array() += slide;
  }
}

void RangeProof::measureWays(const Box& box) {
  const std::size_t n = path_.size();
  for (std::size_t i = 0; i < n; ++i) {
    middle_[i].set(path_[i], box[static_cast<std::size_t>(path_[i].variable)].middle());
  }
  const auto wayOf = [&](const engine::SweepStep& step, const Outline& outline) {
    const double half = std::abs(step.multiplier) * box[static_cast<std::size_t>(step.variable)].half();
    // A chord: no longer than the arc, nor than two radii.
    return step.kind == engine::StepKind::prismatic ? half : (farthestFromAxis(outline) + pad_) * std::min(half, 2.0);
  };
  Outline a = of_a_, b = of_b_;
  for (std::size_t i = 0; i < n; ++i) {
    a.points = RowMajor(path_[i].C).transpose() * (a.points.colwise() - Eigen::Vector3d::Map(path_[i].p));
    way_of_a_[i] = wayOf(path_[i], a);
    middle_[i].inverse().apply(a.points);
  }
  for (std::size_t i = n; i-- > 0;) {
    way_of_b_[i] = wayOf(path_[i], b);
    middle_[i].apply(b.points);
    b.points = (RowMajor(path_[i].C) * b.points).colwise() + Eigen::Vector3d::Map(path_[i].p);
  }
}

void RangeProof::solve() {
  workspace_.solve(problem_, query_, answer_);
  work_ += kQueryWork + answer_.statistics.node_tests + answer_.statistics.leaf_tests;
}

RangeProof::Contact RangeProof::at(const std::vector<double>& values, double margin) {
  FCL_ARTIC_ASSERT(bounded_ && values.size() == variables_.size());
  std::fill(coefficients_.begin(), coefficients_.end(), 0);
  std::copy(values.begin(), values.end(), coefficients_.begin());
  query_.margins = engine::Margins(margin + balls_);
  query_.work_budget = 0;
  solve();
  if (answer_.isFree()) return Contact::none;
  return answer_.certain ? Contact::touch : Contact::unknown;
}

/// The nearest points of the contact found last, of the bodies grown by the margin.
bool RangeProof::findWitness(Witness& witness) {
  if (answer_.num_contacts == 0) return false;
  engine::LeafContact contact = answer_.contacts[0];
  if (contact.piece_a < 0 || contact.piece_b < 0) return false;
  engine::Query query = query_;
  query.any = false;
  contact.t_lower = contact.t;
  workspace_.addWitness(problem_, query, contact);
  // The points in the base frame and in the last step's.
  witness.a = RowMajor(pair_.inverse_a.R).transpose() *
              (Eigen::Vector3d::Map(contact.nearest_a) - Eigen::Vector3d::Map(pair_.inverse_a.t));
  witness.b = RowMajor(pair_.inverse_a.R).transpose() *
              (Eigen::Vector3d::Map(contact.nearest_b) - Eigen::Vector3d::Map(pair_.inverse_a.t));
  witness.distance = (witness.a - witness.b).norm() - balls_;
  witness.normal = (witness.a - witness.b).normalized();
  for (const engine::SweepStep& step : path_) {
    const auto v = static_cast<std::size_t>(step.variable);
    Joint joint;
    joint.set(step, valueAt(v, contact.t_nearest));
    witness.b = RowMajor(step.C).transpose() * (witness.b - Eigen::Vector3d::Map(step.p));
    joint.inverse().apply(witness.b);
  }
  return true;
}

/// Keeps them.
void RangeProof::addWitness() {
  Witness witness;
  if (!findWitness(witness)) return;
  if (witnesses_.size() < kMostWitnesses) {
    witnesses_.push_back(witness);
  } else {
    witnesses_[next_witness_++ % kMostWitnesses] = witness;
  }
}

double RangeProof::comeNearer(const std::vector<ValueRange>& within, double margin, std::vector<double>& values) {
  constexpr double kLeast = 1e-7;
  constexpr int kRounds = 12, kSweeps = 12;
  constexpr double kDepth = 0.002;  // points that only meet are not certainly in contact
  constexpr double kWorthwhile = 0.98;
  // First the middles of both, then the points that are nearest.
  const auto a = of_a_.points.leftCols<8>(), b = of_b_.points.leftCols<8>();
  Witness witness{a.rowwise().mean(), b.rowwise().mean(), Eigen::Vector3d::Zero(), 0};
  double least = std::numeric_limits<double>::infinity();
  std::vector<double> here = values;
  for (int round = 0; round < kRounds; ++round) {
    const Eigen::Vector3d goal = witness.a + kDepth * witness.normal;
    const double aimed = bringTogether(path_, within, goal, witness.b, kSweeps, here);
    if (at(here, margin) == Contact::touch) {
      values = here;
      return margin;
    }
    // What is known of the distance, and what the nearest points of two pieces say of it.
    double known = least, seen = std::numeric_limits<double>::infinity();
    double next = round > 0 ? least : aimed + 2 * (a.colwise().norm().maxCoeff() + b.colwise().norm().maxCoeff());
    while (next > kLeast && at(here, margin + next) == Contact::touch) {
      known = next;
      if (findWitness(witness) && witness.distance > margin) seen = witness.distance - margin;
      next = 0.9 * std::min(next, seen);
    }
    const double little_more = 1.001 * seen + kLeast;
    if (little_more < known && at(here, margin + little_more) == Contact::touch) known = little_more;
    if (!(known < least)) break;
    const bool worthwhile = known < kWorthwhile * least;
    least = known;
    values = here;
    if (!worthwhile) break;
  }
  return margin + least;
}

/// Whether points of both bodies are known that come as near as the margin where the box is to be proven.
/// @param moved  step that moves; the others stand in the middle.
bool RangeProof::mustFail(const Box& box, std::size_t moved, double margin) const {
  // Seen from the moved step's frame, before it turns or slides and after.
  const std::size_t n = path_.size(), before = std::min(moved, n - 1);
  Joint parts[5];
  int num_parts = 1;
  parts[0] = middle_[before];
  if (moved < n) {
    const ValueRange& range = box[static_cast<std::size_t>(path_[moved].variable)];
    for (const double part : {0.0, 1.0, 0.25, 0.75}) {
      parts[num_parts++].set(path_[moved], range.lower + part * (range.upper - range.lower));
    }
  }
  // Where the base frame's and the last step's axes and origins are: columns of a frame.
  using Frame = Eigen::Matrix<double, 3, 4>;
  Frame base = Frame::Identity(), last = Frame::Identity();
  for (std::size_t i = 0; i <= before; ++i) {
    if (i > 0) middle_[i - 1].inverse().apply(base);
    base.col(3) -= Eigen::Vector3d::Map(path_[i].p);
    base = (RowMajor(path_[i].C).transpose() * base).eval();
  }
  for (std::size_t i = n - 1; i > before; --i) {
    middle_[i].apply(last);
    last = (RowMajor(path_[i].C) * last).eval();
    last.col(3) += Eigen::Vector3d::Map(path_[i].p);
  }
  for (const Witness& witness : witnesses_) {
    const Eigen::Vector3d a = base.leftCols<3>() * witness.a + base.col(3);
    const Eigen::Vector3d b = last.leftCols<3>() * witness.b + last.col(3);
    for (int k = 0; k < num_parts; ++k) {
      Eigen::Vector3d turned = b;
      parts[k].apply(turned);
      if ((turned - a).squaredNorm() <= margin * margin) return true;
    }
  }
  return false;
}

/// Lemma 12: the engine moves one step over its whole range while the others stand in the middle of theirs; the margin
/// pays for A's ways by the steps before it and for B's by the steps after it.
RangeProof::Tried RangeProof::tryBox(const Box& box, std::uint64_t work) {
  measureWays(box);
  const std::size_t n = path_.size();
  double after = 0;
  for (std::size_t i = 0; i < n; ++i) after += way_of_b_[i];
  // Without a step that moves alone, the steps before the cut pay by A's ways and the others by B's.
  double before = 0, least = after;
  std::size_t moved = n, cut = 0;
  for (std::size_t i = 0; i < n; ++i) {
    after -= way_of_b_[i];
    const bool alone = steps_of_[static_cast<std::size_t>(path_[i].variable)] == 1;
    if (alone && before + after < least) {
      least = before + after;
      moved = cut = i;
    }
    before += way_of_a_[i];
    if (before + after < least) {
      least = before + after;
      moved = n;
      cut = i + 1;
    }
  }
  // (The sums of differences above only choose.)
  double margin = 0;
  std::vector<double> paid(variables_.size(), 0);
  for (std::size_t i = 0; i < n; ++i) {
    const auto v = static_cast<std::size_t>(path_[i].variable);
    const double way = i < cut ? way_of_a_[i] : way_of_b_[i];
    if (i == moved) {
      paid[v] = kMovedWeight * std::min(way_of_a_[i], way_of_b_[i]);
    } else {
      margin += way;
      paid[v] += way;
    }
  }
  std::fill(coefficients_.begin(), coefficients_.end(), 0);
  for (std::size_t v = 0; v < box.size(); ++v) coefficients_[v] = box[v].middle();
  if (moved < n) {
    const auto v = static_cast<std::size_t>(path_[moved].variable);
    const double slack = 64 * kUlp * std::max(std::abs(box[v].lower), std::abs(box[v].upper));
    coefficients_[v] = box[v].lower - slack;
    coefficients_[box.size() + v] = box[v].upper + slack - coefficients_[v];
  }
  const double whole_margin = margin_ + balls_ + margin * (1 + 1e-9);
  Tried tried;
  if (path_.empty() || !mustFail(box, moved, whole_margin)) {
    query_.margins = engine::Margins(whole_margin);
    query_.work_budget = work;
    solve();
    tried.apart = answer_.isFree();
    if (!tried.apart) {
      addWitness();
      const double t = answer_.num_contacts > 0 ? answer_.contacts[0].t : answer_.t_lower;
      for (std::size_t v = 0; v < box.size(); ++v) tried.where.push_back(valueAt(v, t));
    }
    tried.out_of_work = answer_.status == Status::undecided;
  } else {
    work_ += kGlanceWork;
  }
  if (tried.apart || box.empty()) {
    tried.give_up = !tried.apart;
    return tried;
  }
  tried.split = static_cast<std::size_t>(std::max_element(paid.begin(), paid.end()) - paid.begin());
  if (margin < kFinest) {
    // A finer margin would not help. Less of a motion might, where it is work that ran out.
    tried.give_up = moved == n || !tried.out_of_work;
    if (!tried.give_up) tried.split = static_cast<std::size_t>(path_[moved].variable);
  }
  return tried;
}

RangeProof::Finding RangeProof::prove(std::uint64_t work) {
  Finding finding;
  if (!bounded_) return finding;
  work_ = 0;
  struct Open {
    Box box;
    double share;  ///< of all values
    std::uint64_t work = kWorkOfBox;
  };
  std::vector<Open> open;
  open.push_back({whole_, 1});
  double proven = 0;
  while (!open.empty()) {
    Open next = std::move(open.back());
    open.pop_back();
    const Tried tried = tryBox(next.box, next.work);
    if (tried.apart) {
      proven += next.share;
      continue;
    }
    // A 64th of the work shows whether all of it can do. (Measured on 5 robots: a 16th proves 1 % more pairs in twice
    // the time, a 256th 4 % fewer in as much.)
    const bool hopeless = work_ > work || (work_ > work / 64 &&
                                           proven * kMostHope * static_cast<double>(work) < static_cast<double>(work_));
    const ValueRange range = tried.give_up ? ValueRange() : next.box[tried.split];
    const double middle = range.middle();
    if (tried.give_up || hopeless || !(range.lower < middle && middle < range.upper)) {
      finding.values = tried.where;
      if (tried.where.empty()) {
        for (const ValueRange& r : next.box) finding.values.push_back(r.middle());
      }
      finding.work = work_;
      return finding;
    }
    // Surfaces that are near each other all along take many tests, however short the way.
    if (tried.out_of_work) next.work *= 2;
    Open other{next.box, next.share *= 0.5, next.work};
    other.box[tried.split].lower = next.box[tried.split].upper = middle;
    open.push_back(std::move(other));
    open.push_back(std::move(next));
  }
  finding.apart = true;
  finding.work = work_;
  return finding;
}

}  // namespace fcl_artic
