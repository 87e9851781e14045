// SPDX-License-Identifier: BSD-3-Clause
#include "tables/range_proof.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "numerics/assertion.h"
#include "numerics/constants.h"
#include "numerics/sine_cosine.h"
#include "tables/bring_together.h"

namespace fcl_artic {
namespace {

// No proof rests on these values: they decide how much is tried, in which order, and when a proof is given up.

/// The work that comparing a box with the witnesses counts for, in tests of nodes and leaves: an estimate of its time.
/// With a larger one a proof is given up sooner.
constexpr std::uint64_t kWitnessWork = 15;
/// The work that the first box may take, in tests of nodes and leaves. A box that takes more is cut in two, and each
/// half may take twice as many. Larger: hopeless boxes are left later. Smaller: boxes are cut that would have been
/// proven whole. Measured on the Panda, the whole proof: with 120 it takes 1.5 times as long, with 3000 as long as
/// with 600.
constexpr std::uint64_t kBoxWork = 600;
/// The smallest margin, m, that pays for a box's variables. A box for which less would do is not cut any further, so
/// that links that come as near to each other are not proven apart. Larger: more pairs stay unproven. Smaller: such
/// pairs take longer until they are given up. It is far above all rounding.
constexpr double kFinestMargin = 2e-5;
/// A proof is given up if, at its pace so far, it would take this many times the work that is allowed. Larger: more
/// time for proofs that fail. Smaller: proofs are given up whose later boxes are easier than their first ones.
constexpr double kMaxPace = 8;
/// The part of this work after which the pace is first looked at. Measured on 5 robots: with 1/16 1 % more pairs are
/// proven in twice the time, with 1/256 4 % fewer in as much time.
constexpr std::uint64_t kPaceAfter = 64;
/// The weight of the displacement by the variable that the engine moves, against those that the margin pays for: the
/// variable with the largest weighted displacement is halved. Larger: motions are shortened sooner; smaller: margins.
/// Measured on the Panda: with 0.3 a proof takes 1.4 times as long, with 1 and 2 1.2 times as long.
constexpr double kMovedWeight = 0.6;

using RowMajor = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;

}  // namespace

RangeProof::RangeProof(const KinematicTree& tree, const engine::Problem& problem, const engine::LinkPair& pair,
                       double margin, engine::EngineWorkspace& workspace, const Cut& cut)
    : workspace_(workspace), chain_(tree, problem, pair, cut), margin_(margin) {
  if (!bounded()) return;
  middle_poses_.resize(chain_.path().size());
  displacement_a_.resize(chain_.path().size());
  displacement_b_.resize(chain_.path().size());
  coefficients_.resize(2 * std::max<std::size_t>(1, variables().size()));
  query_.coefficients = coefficients_.data();
  query_.num_variables = static_cast<std::int32_t>(std::max<std::size_t>(1, variables().size()));
  query_.check_scene = false;
  query_.describe_contacts = false;
  query_.any = true;
}

void RangeProof::StepPose::set(const engine::SweepStep& step, double variable) {
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
void RangeProof::StepPose::apply(Points& points) const {
  const auto x = points.row(0).eval();
  points.row(0) = cosine * x - sine * points.row(1);
  points.row(1) = sine * x + cosine * points.row(1);
  if (Points::ColsAtCompileTime == 4) {
    points(2, 3) += slide;  // a frame: its axes have no place
  } else {
    points.row(2).array() += slide;
  }
}

void RangeProof::boundDisplacements(const Box& box) {
  const std::vector<engine::SweepStep>& path = chain_.path();
  const std::size_t n = path.size();
  for (std::size_t i = 0; i < n; ++i) {
    middle_poses_[i].set(path[i], box[static_cast<std::size_t>(path[i].variable)].middle());
  }
  const auto displacementBy = [&](const engine::SweepStep& step, const LinkChain::Outline& outline) {
    const double half = std::abs(step.multiplier) * box[static_cast<std::size_t>(step.variable)].half();
    // A chord: no longer than the arc, nor than two radii.
    return step.kind == engine::StepKind::prismatic ? half
                                                    : (outline.farthestFromAxis() + chain_.pad()) * std::min(half, 2.0);
  };
  LinkChain::Outline a = chain_.outlineA(), b = chain_.outlineB();
  for (std::size_t i = 0; i < n; ++i) {
    a.points = RowMajor(path[i].C).transpose() * (a.points.colwise() - Eigen::Vector3d::Map(path[i].p));
    displacement_a_[i] = displacementBy(path[i], a);
    middle_poses_[i].inverse().apply(a.points);
  }
  for (std::size_t i = n; i-- > 0;) {
    displacement_b_[i] = displacementBy(path[i], b);
    middle_poses_[i].apply(b.points);
    b.points = (RowMajor(path[i].C) * b.points).colwise() + Eigen::Vector3d::Map(path[i].p);
  }
}

void RangeProof::solve() {
  workspace_.solve(chain_.problem(), query_, answer_);
  work_ += kQueryWork + answer_.statistics.node_tests + answer_.statistics.leaf_tests;
}

RangeProof::Contact RangeProof::at(const std::vector<double>& values, double margin) {
  FCL_ARTIC_ASSERT(bounded() && values.size() == variables().size());
  std::fill(coefficients_.begin(), coefficients_.end(), 0);
  std::copy(values.begin(), values.end(), coefficients_.begin());
  query_.margins = engine::Margins(margin + chain_.ballRadii());
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
  workspace_.addWitness(chain_.problem(), query, contact);
  // The points in the base frame and in the last step's.
  witness.a = RowMajor(chain_.pair().inverse_a.R).transpose() *
              (Eigen::Vector3d::Map(contact.nearest_a) - Eigen::Vector3d::Map(chain_.pair().inverse_a.t));
  witness.b = RowMajor(chain_.pair().inverse_a.R).transpose() *
              (Eigen::Vector3d::Map(contact.nearest_b) - Eigen::Vector3d::Map(chain_.pair().inverse_a.t));
  witness.distance = (witness.a - witness.b).norm() - chain_.ballRadii();
  witness.normal = (witness.a - witness.b).normalized();
  for (const engine::SweepStep& step : chain_.path()) {
    const auto v = static_cast<std::size_t>(step.variable);
    StepPose joint;
    joint.set(step, valueAt(v, contact.t_nearest));
    witness.b = RowMajor(step.C).transpose() * (witness.b - Eigen::Vector3d::Map(step.p));
    joint.inverse().apply(witness.b);
  }
  return true;
}

/// Keeps the witness of the contact found last; the oldest one makes room.
void RangeProof::addWitness() {
  Witness witness;
  if (!findWitness(witness)) return;
  if (witnesses_.size() < kMaxWitnesses) {
    witnesses_.push_back(witness);
  } else {
    witnesses_[next_witness_++ % kMaxWitnesses] = witness;
  }
}

double RangeProof::comeNearer(const std::vector<ValueRange>& within, double margin, std::vector<double>& values) {
  constexpr double kLeast = 1e-7;            // m: no smaller distances are told apart
  constexpr int kRounds = 12, kSweeps = 12;  // at most: of this loop, and of bringTogether()
  constexpr double kDepth = 0.002;           // m: points that only meet are not certainly in contact
  constexpr double kWorthwhile = 0.98;       // a round that leaves more of the distance is the last one
  // First the middles of both, then the points that are nearest.
  const auto a = chain_.outlineA().points.leftCols<8>(), b = chain_.outlineB().points.leftCols<8>();
  Witness witness{a.rowwise().mean(), b.rowwise().mean(), Eigen::Vector3d::Zero(), 0};
  double least = std::numeric_limits<double>::infinity();
  std::vector<double> here = values;
  for (int round = 0; round < kRounds; ++round) {
    const Eigen::Vector3d goal = witness.a + kDepth * witness.normal;
    const double aimed = bringTogether(chain_.path(), within, goal, witness.b, kSweeps, here);
    if (at(here, margin) == Contact::touch) {
      values = here;
      return margin;
    }
    // The upper bound that is proven, and the distance of the nearest points of two pieces.
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

/// Whether a witness shows that the box can't be proven: its points come as near as the margin, as far as rounding lets
/// one see. So no query is made in vain.
/// @param moved  step that moves; the others stand in the middle.
bool RangeProof::likelyFails(const Box& box, std::size_t moved, double margin) const {
  const std::vector<engine::SweepStep>& path = chain_.path();
  // Seen from the moved step's frame, before it turns or slides and after.
  const std::size_t n = path.size(), before = std::min(moved, n - 1);
  StepPose parts[5];
  int num_parts = 1;
  parts[0] = middle_poses_[before];
  if (moved < n) {
    const ValueRange& range = box[static_cast<std::size_t>(path[moved].variable)];
    for (const double part : {0.0, 1.0, 0.25, 0.75}) {
      parts[num_parts++].set(path[moved], range.lower + part * (range.upper - range.lower));
    }
  }
  // Where the base frame's and the last step's axes and origins are: columns of a frame.
  using Frame = Eigen::Matrix<double, 3, 4>;
  Frame base = Frame::Identity(), last = Frame::Identity();
  for (std::size_t i = 0; i <= before; ++i) {
    if (i > 0) middle_poses_[i - 1].inverse().apply(base);
    base.col(3) -= Eigen::Vector3d::Map(path[i].p);
    base = (RowMajor(path[i].C).transpose() * base).eval();
  }
  for (std::size_t i = n - 1; i > before; --i) {
    middle_poses_[i].apply(last);
    last = (RowMajor(path[i].C) * last).eval();
    last.col(3) += Eigen::Vector3d::Map(path[i].p);
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

/// Lemma 12: the engine moves one step over its whole range while the others stand in the middle of theirs. The margin
/// pays for A's displacements by the steps before it and for B's by the steps after it.
RangeProof::BoxResult RangeProof::tryBox(const Box& box, std::uint64_t work) {
  const std::vector<engine::SweepStep>& path = chain_.path();
  boundDisplacements(box);
  const std::size_t n = path.size();
  double after = 0;
  for (std::size_t i = 0; i < n; ++i) after += displacement_b_[i];
  // Without a step that moves alone, A's displacements by the steps before the cut are paid for, and B's by the others.
  double before = 0, least = after;
  std::size_t moved = n, cut = 0;
  for (std::size_t i = 0; i < n; ++i) {
    after -= displacement_b_[i];
    const bool alone = chain_.drivesOneStep(path[i]);
    if (alone && before + after < least) {
      least = before + after;
      moved = cut = i;
    }
    before += displacement_a_[i];
    if (before + after < least) {
      least = before + after;
      moved = n;
      cut = i + 1;
    }
  }
  // (The sums of differences above only choose.)
  double margin = 0;
  std::vector<double> paid(variables().size(), 0);
  for (std::size_t i = 0; i < n; ++i) {
    const auto v = static_cast<std::size_t>(path[i].variable);
    const double displacement = i < cut ? displacement_a_[i] : displacement_b_[i];
    if (i == moved) {
      paid[v] = kMovedWeight * std::min(displacement_a_[i], displacement_b_[i]);
    } else {
      margin += displacement;
      paid[v] += displacement;
    }
  }
  std::fill(coefficients_.begin(), coefficients_.end(), 0);
  for (std::size_t v = 0; v < box.size(); ++v) coefficients_[v] = box[v].middle();
  if (moved < n) {
    const auto v = static_cast<std::size_t>(path[moved].variable);
    const double slack = 64 * kUlp * std::max(std::abs(box[v].lower), std::abs(box[v].upper));
    coefficients_[v] = box[v].lower - slack;
    coefficients_[box.size() + v] = box[v].upper + slack - coefficients_[v];
  }
  const double whole_margin = margin_ + chain_.ballRadii() + margin * (1 + 1e-9);
  BoxResult tried;
  if (path.empty() || !likelyFails(box, moved, whole_margin)) {
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
    work_ += kWitnessWork;
  }
  if (tried.apart || box.empty()) {
    tried.give_up = !tried.apart;
    return tried;
  }
  tried.split = static_cast<std::size_t>(std::max_element(paid.begin(), paid.end()) - paid.begin());
  if (margin < kFinestMargin) {
    // A finer margin would not help. Less of a motion might, where it is work that ran out.
    tried.give_up = moved == n || !tried.out_of_work;
    if (!tried.give_up) tried.split = static_cast<std::size_t>(path[moved].variable);
  }
  return tried;
}

RangeProof::Result RangeProof::prove(std::uint64_t work) {
  Result result;
  if (!bounded()) return result;
  work_ = 0;
  struct OpenBox {
    Box box;
    double share;  ///< of all values
    std::uint64_t work = kBoxWork;
  };
  std::vector<OpenBox> open;
  open.push_back({chain_.ranges(), 1});
  double proven = 0;
  while (!open.empty()) {
    OpenBox next = std::move(open.back());
    open.pop_back();
    const BoxResult tried = tryBox(next.box, next.work);
    if (tried.apart) {
      proven += next.share;
      continue;
    }
    const bool hopeless = work_ > work || (work_ > work / kPaceAfter &&
                                           proven * kMaxPace * static_cast<double>(work) < static_cast<double>(work_));
    const ValueRange range = tried.give_up ? ValueRange() : next.box[tried.split];
    const double middle = range.middle();
    if (tried.give_up || hopeless || !(range.lower < middle && middle < range.upper)) {
      result.values = tried.where;
      if (tried.where.empty()) {
        for (const ValueRange& r : next.box) result.values.push_back(r.middle());
      }
      result.work = work_;
      return result;
    }
    // Surfaces that are near each other all along take many tests, however small the box.
    if (tried.out_of_work) next.work *= 2;
    OpenBox other{next.box, next.share *= 0.5, next.work};
    other.box[tried.split].lower = next.box[tried.split].upper = middle;
    open.push_back(std::move(other));
    open.push_back(std::move(next));
  }
  result.apart = true;
  result.work = work_;
  return result;
}

}  // namespace fcl_artic
