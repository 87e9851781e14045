// SPDX-License-Identifier: BSD-3-Clause
//
// The tube around a motion (doc/NUMERICS.md, "Tubes"). Joints, poses and the base may be off by their tolerances. Here
// are upper bounds of how much nearer two bodies may be than the motion says.
#pragma once

#include "narrowphase/solver/swept_box.h"
#include "narrowphase/solver/swept_frames.h"
#include "narrowphase/solver/swept_lss.h"
#include "narrowphase/tube.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

class Strays : PartOfSolver {
 public:
  Strays(Task& task, SweptFrames& frames) : PartOfSolver(task), frames_(frames) {}

  /// Whether anything strays in the query at hand.
  bool any() const { return problem().strays; }
  /// Bounds what a pair's two bodies stray against each other. The tube is valid until the next one is asked for.
  void between(PairId pair, double pose_error, Tube& tube);
  /// To be called before inWorld(), when the batch is set.
  void begin();
  /// Bounds what a link strays against the world, over the batch.
  /// @param swept  its line swept sphere over the batch.
  double inWorld(const Body& link, const SweptLss& swept);
  /// Bounds what two links stray against each other, whatever the motion.
  /// @param in_world  inWorld() of both, summed.
  double ofLinks(int link_pair, double in_world) const {
    if (!any()) return 0;
    // Set-up knows it for factor 1. A chord min(k d, 2) is at most max(k, 1) times min(d, 2).
    return min(max(factor(), 1.0) * problem().link_pairs[link_pair].stray, in_world);
  }
  /// How far an obstacle strays by itself, over [0, 1].
  double ofObstacle(int body_number) const { return any() ? ofBody(body(body_number), 1) : 0; }
  /// No obstacle's is larger.
  double largest() const {
    if (!any()) return 0;
    return factor() * problem().largest.stray + wayOf(problem().largest.speed, problem().largest.earliest_since, 1) +
           lagOf(problem().largest.lag);
  }

 private:
  /// Times which all tolerances count: lengths and angles are multiplied where they are used, before chords are made.
  double factor() const { return query().tube.factor; }
  /// A segment grown by a ball: it holds a body.
  struct Outline {
    Vec3 end[2];
    double radius;
    double reach;  ///< the larger distance of an end from the frame's origin
  };
  static Outline outlineOf(const Body& body, const Mat3& R, const Vec3& t);
  static Outline outlineOf(const Body& body, const Placement& P) { return outlineOf(body, Mat3(P.R), Vec3(P.t)); }
  /// Upper bounds of a body's largest distance from a step's axis or centre.
  struct Distance {
    Lanes middle, over;
  };
  struct EndsInBase {
    Vec3Lanes end[2];
  };
  Distance distance(const engine::SweepStep& step, const FrameLanes& frame, const EndsInBase& ends, double radius,
                    double speed, double error) const;
  /// How far a step moves a point: if it turns, times the point's distance from its axis; else m.
  double strayOf(const engine::SweepStep& step) const;
  struct Chain {
    int sweep, step_b;
    const Outline* a;  ///< in the base frame; null: only B is moved
    const Outline& b;  ///< in the frame of step_b
    double error;      ///< of points of the frames
  };
  /// Sums over the steps of a chain, all of which move A or all B.
  struct Sums {
    Lanes middle, over;
  };
  Sums ofSteps(const Chain& chain);
  /// All that has no direction: a length, and the angle by which it turns all steps.
  struct Undirected {
    double length, angle;
  };
  void direct(const Chain& chain, const Placement& inverse_a, const Undirected& others, Tube& tube);
  double ofBase(const Body& link);
  /// How far something comes by itself until t.
  double wayOf(double speed, double since, double t) const;
  /// How far something is by being early or late. (`times` is infinite for the shortest trajectories.)
  double lagOf(double lag) const { return lag > 0 ? query().tube.times * lag : 0; }
  /// How far a body strays by itself until t: its pose's tolerance, its own way, and its motion's being early or late.
  double ofBody(const Body& body, double t) const {
    return factor() * body.stray + wayOf(body.speed, body.since, t) + lagOf(body.lag);
  }
  /// Sums over the steps up to one, of the world's sweep.
  struct Form {
    bool made = false;
    int count = 0;      ///< of steps
    Vec3Lanes q[3], b;  ///< of |x - o|^2 across the axes, times what the steps stray
    Lanes c;
    double strays = 0, slides = 0;  ///< of turns; of slides, m
    double rates = 0, lengths = 0, levers = 0, slide_rates = 0;
  };
  const Form& formOf(int step);

  SweptFrames& frames_;
  Buffer<Sums> sums_b_;       ///< of the steps from B on, if these move B
  Sums all_a_, all_b_;        ///< if all steps move the one
  Buffer<std::int32_t> way_;  ///< the steps, B's first
  Buffer<TubeAxis> axes_;
  Buffer<Form> forms_;  ///< by step of the world's sweep
};

inline double Strays::strayOf(const engine::SweepStep& step) const {
  // The chord of an angle is no longer than the angle, and no longer than 2.
  const double stray = factor() * step.stray;
  return turns(step.kind) ? min(stray, 2.0) : stray;
}

/// Rounding of the clock and of a product (NUMERICS, "Tubes").
inline double Strays::wayOf(double speed, double since, double t) const {
  if (!(speed > 0)) return 0;
  const engine::Clock& clock = query().tube.clock;
  const double sizes = (clock.begin < 0 ? -clock.begin : clock.begin) + (clock.end < 0 ? -clock.end : clock.end);
  const double now = t >= 1 ? clock.end : clock.begin + t * (clock.end - clock.begin);
  return speed * max(0.0, now - since + 4 * kUlp * (sizes + (since < 0 ? -since : since))) * (1 + 2 * kUlp);
}

/// @param R, t  of the body's tree in the frame that the outline is wanted in.
inline Strays::Outline Strays::outlineOf(const Body& body, const Mat3& R, const Vec3& t) {
  Outline outline;
  if (body.tree_lss) {
    for (int i = 0; i < 2; ++i) outline.end[i] = Vec3(body.tree_lss + 3 * i);
    outline.radius = body.tree_lss[6];
  } else {
    const Node& root = body.tree->nodes[0];
    outline.end[0] = outline.end[1] = middleOf(root);
    outline.radius = root.radius * (1 + 0x1p-22);  // a float
  }
  outline.reach = 0;
  for (Vec3& end : outline.end) {
    end = R * end + t;
    outline.reach = max(outline.reach, norm(end) * (1 + 8 * kUlp));
  }
  return outline;
}

/// In the middle of a lane the axis is where the frame has it. Half a lane later the distance is another one by no more
/// than `speed` times half the lane.
/// @param speed  of the ends as seen from the step's frame, and more where the step's own factor cannot change the
/// distance.
/// @param error  of points of the frames.
inline Strays::Distance Strays::distance(const engine::SweepStep& step, const FrameLanes& frame, const EndsInBase& ends,
                                         double radius, double speed, double error) const {
  Lanes square(0.0);
  const Vec3Lanes axis = frame.R.column(2);
  for (const Vec3Lanes& end : ends.end) {
    const Vec3Lanes arm = end - frame.o;
    const Vec3Lanes across = step.kind == engine::StepKind::revolute ? cross(arm, axis) : arm;
    square = max(square, dot(across, across));
  }
  // Two points, the axis, and the product of both (NUMERICS, "Tubes").
  const Lanes middle = sqrt(square) + Lanes(radius + 4 * error);
  return {middle, middle + Lanes(speed * frames_.batch().d)};
}

/// Fix a frame between two steps of the chain. The steps on B's side of it move B as seen from there, and those on A's
/// side move A. No step moves its body by more than its chord times the body's distance from its axis. That distance is
/// the one that the motion has: the steps next to the frame are changed first, while those farther out are still where
/// the motion has them. The least sum over all such frames counts, in each lane.
inline Strays::Sums Strays::ofSteps(const Chain& chain) {
  const engine::SweepView& view = problem().sweeps[chain.sweep];
  const Outline& b = chain.b;
  const Outline* const a = chain.a;
  way_.clear();
  sums_b_.clear();
  all_a_ = all_b_ = {Lanes(0.0), Lanes(0.0)};
  if (chain.step_b < 0 || !view.strays) return all_b_;
  const FrameLanes& carrier = frames_.of(chain.sweep, chain.step_b);  // and with it all steps on the way
  const StepBounds& last = frames_.bounds(chain.sweep, chain.step_b);
  EndsInBase ends_a, ends_b;
  for (int i = 0; i < 2; ++i) ends_b.end[i] = carrier.o + carrier.R * b.end[i];
  for (int i = 0; a && i < 2; ++i) ends_a.end[i] = spread(a->end[i]);
  // Rounding of differences of sums over the chain.
  const double slack = 8 * view.num_steps * kUlp;
  const auto add = [&](const engine::SweepStep& step, const Distance& far, Sums& sums) {
    const Lanes s(strayOf(step));
    sums.middle = mulAdd(far.middle, s, sums.middle);
    sums.over = mulAdd(far.over, s, sums.over);
  };
  const Distance one = {Lanes(1.0), Lanes(1.0)};
  for (int i = chain.step_b; i >= 0; i = view.steps[i].parent) {
    const engine::SweepStep& step = view.steps[i];
    if (!(step.stray > 0)) continue;
    const StepBounds& here = frames_.bounds(chain.sweep, i);
    const double rate = last.rates.a * (1 + slack) - here.rates.a;
    const double lever = last.length * (1 + slack) - here.length + b.reach;
    const double speed = rate * lever + (last.slide_rate * (1 + slack) - here.slide_rate);
    add(step, turns(step.kind) ? distance(step, frames_.of(chain.sweep, i), ends_b, b.radius, speed, chain.error) : one,
        all_b_);
    way_.push(i);
    sums_b_.push(all_b_);
  }
  Sums least = all_b_;
  for (int k = a ? way_.size() - 1 : -1; k >= 0; --k) {
    const engine::SweepStep& step = view.steps[way_[k]];
    static const StepBounds kBase = {};
    const StepBounds& before = step.parent >= 0 ? frames_.bounds(chain.sweep, step.parent) : kBase;
    const StepBounds& here = frames_.bounds(chain.sweep, way_[k]);
    const double speed = before.rates.a * (here.length + a->reach) + here.slide_rate;
    add(step,
        turns(step.kind) ? distance(step, frames_.of(chain.sweep, way_[k]), ends_a, a->radius, speed, chain.error)
                         : one,
        all_a_);
    const Sums beyond = k ? sums_b_[k - 1] : Sums{Lanes(0.0), Lanes(0.0)};
    least.middle = min(least.middle, beyond.middle + all_a_.middle);
    least.over = min(least.over, beyond.over + all_a_.over);
  }
  const Lanes room(1 + 8 * (way_.size() + 4) * kUlp);
  const auto leaveRoom = [&](Sums& sums) {
    sums.middle = sums.middle * room;
    sums.over = sums.over * room;
  };
  leaveRoom(all_a_);
  leaveRoom(all_b_);
  leaveRoom(least);
  return least;
}

/// The shares of the chain's steps by direction (after ofSteps()). A turn by at most d about u moves a point at r from
/// the axis along a unit n by at most d |n.(u x r)| + (d^2 / 2) |r|. If other steps have turned its frame by at most D
/// in all, D d |r| is added. So all that is no first order is less than the sum of all angles times the sum of all d
/// |r|.
inline void Strays::direct(const Chain& chain, const Placement& inverse_a, const Undirected& others, Tube& tube) {
  axes_.clear();
  if (!way_.size()) return;
  const engine::SweepView& view = problem().sweeps[chain.sweep];
  const StepBounds& last = frames_.bounds(chain.sweep, chain.step_b);
  const Mat3 R(inverse_a.R);
  const Vec3 t(inverse_a.t);
  double angles = others.angle, strays = 0, slides = 0;
  for (int k = 0; k < way_.size(); ++k) {
    const engine::SweepStep& step = view.steps[way_[k]];
    const double s = factor() * step.stray;
    const FrameLanes& frame = frames_.of(chain.sweep, way_[k]);
    TubeAxis& axis = axes_.grow();
    axis.stray = s;
    axis.slides = !turns(step.kind);
    axis.origin = R * frame.o + spread(t);
    axis.axis = R * frame.R.column(2);
    (axis.slides ? slides : strays) += s;
    angles += axis.slides ? 0 : s;
    if (step.kind == engine::StepKind::revolute || step.kind == engine::StepKind::prismatic) continue;
    // A rotation about any axis, or a slide along any: without direction.
    return axes_.clear();
  }
  // Half a lane later the share is another one by the speeds of all that it is made of, n among them.
  // (Any point of a piece may be the one that counts, so the outlines' radii count, too.)
  const double reach_b = chain.b.reach + chain.b.radius;
  const double reach = chain.a ? max(chain.a->reach + chain.a->radius, reach_b) : reach_b;
  const double lever = last.length + reach, rate = last.rates.a;
  const double later =
      frames_.batch().d * (strays * (2 * rate * lever + 2 * last.D1 + rate * reach) + slides * 2 * rate);
  const double rounding = 8 * chain.error * (strays + slides);
  for (int s = 0; s < 2; ++s) {
    if (!s && !chain.a) continue;
    const Sums& all = s ? all_b_ : all_a_;
    const double room = 1 + 8 * (way_.size() + 8) * kUlp;
    tube.rest_middle[s] = (others.length + angles * maxLane(all.middle) + rounding) * room;
    tube.rest[s] = (others.length + angles * maxLane(all.over) + later + rounding) * room;
  }
  tube.axes = axes_.data();
  tube.count = axes_.size();
}

/// How far the robot's base strays: against the world all of the robot moves with it.
inline double Strays::ofBase(const Body& link) {
  const engine::BaseStray& base = problem().base;
  if (!base.any()) return 0;
  double stray = factor() * base.length;
  if (base.angle > 0) {
    const Outline outline = outlineOf(link, link.placement);
    const Vec3Lanes pivot = spread(Vec3(base.pivot));
    double sizes = outline.reach + outline.radius + norm(Vec3(base.pivot)), way = 0, ulps = link.placement.ulps;
    Lanes square(0.0);
    for (const Vec3& end : outline.end) {
      Vec3Lanes arm = spread(end) - pivot;
      if (link.step >= 0) {
        const FrameLanes& frame = frames_.of(0, link.step);
        arm = frame.o + frame.R * end - pivot;
      }
      square = max(square, dot(arm, arm));
    }
    if (link.step >= 0) {
      const StepBounds& bounds = frames_.bounds(0, link.step);
      way = (bounds.D1 + bounds.rates.a * outline.reach) * frames_.batch().d;
      sizes += bounds.length;
      ulps += bounds.ulps;
    }
    const double far = maxLane(sqrt(square)) + outline.radius + way + kUlp * (ulps + kPoseUlps) * sizes;
    stray += min(factor() * base.angle, 2.0) * far;
  }
  return stray * (1 + 16 * kUlp);
}

inline void Strays::between(PairId pair, double pose_error, Tube& tube) {
  tube = Tube();
  if (!any()) return;
  const PairParts parts = problem().parts(pair);
  const Body &A = body(parts.a), &B = body(parts.b);
  // A in the base frame.
  const Mat3 R = transposed(Mat3(parts.inverse_a->R));
  const Vec3 t = -(R * Vec3(parts.inverse_a->t));
  const Outline a = outlineOf(A, R, t), b = outlineOf(B, *parts.placement_b);
  const bool links = A.mover >= 0 && task_.isLink(A.mover);
  // The base comes before all joints of the chain. Where it strays, it moves B: so do all joints then. An obstacle that
  // is larger than the link is not worth the work: nearly always the steps move the link by less.
  const bool base = !links && problem().base.any();
  const bool both = !base && (!problem().isScenePair(pair) || a.radius < b.radius);
  const Chain chain = {parts.sweep, parts.step_b, both ? &a : nullptr, b, pose_error};
  const Sums least = ofSteps(chain);
  const double until = frames_.batch().finish();
  const double poses = (ofBody(A, until) + ofBody(B, until) + (base ? ofBase(B) : 0)) * (1 + 8 * kUlp);
  tube.middle = least.middle + Lanes(poses);
  tube.over = (maxLane(least.over) + poses) * (1 + 2 * kUlp);
  direct(chain, *parts.inverse_a, {poses, base ? factor() * problem().base.angle : 0}, tube);
}

inline void Strays::begin() {
  forms_.resize(any() ? problem().sweeps[0].num_steps : 0);
  for (int i = 0; i < forms_.size(); ++i) forms_[i].made = false;
}

/// The sums of the steps up to one, made of those up to its parent.
inline const Strays::Form& Strays::formOf(int step) {
  way_.clear();
  for (int i = step; i >= 0 && !forms_[i].made; i = problem().sweeps[0].steps[i].parent) way_.push(i);
  for (int k = way_.size() - 1; k >= 0; --k) {
    const engine::SweepStep& own = problem().sweeps[0].steps[way_[k]];
    Form& form = forms_[way_[k]];
    if (own.parent >= 0) {
      form = forms_[own.parent];
    } else {
      form = Form();
      form.q[0] = form.q[1] = form.q[2] = form.b = spread(Vec3(0, 0, 0));
      form.c = Lanes(0.0);
    }
    form.made = true;
    ++form.count;
    if (!(own.stray > 0)) continue;
    const double s = strayOf(own);
    if (!turns(own.kind)) {
      form.slides += s;
      continue;
    }
    const FrameLanes& frame = frames_.of(0, way_[k]);
    const StepBounds& bounds = frames_.bounds(0, way_[k]);
    const Vec3Lanes z = own.kind == engine::StepKind::revolute ? frame.R.column(2) : spread(Vec3(0, 0, 0));
    // |x - o|^2 less the part along the axis.
    const Vec3Lanes across = frame.o - z * dot(z, frame.o);
    for (int i = 0; i < 3; ++i) {
      const Vec3Lanes unit = spread(Vec3(i == 0, i == 1, i == 2));
      form.q[i] = mulAdd(unit - z * z[i], Lanes(s), form.q[i]);
    }
    form.b = mulAdd(across, Lanes(s), form.b);
    form.c = mulAdd(dot(across, frame.o), Lanes(s), form.c);
    form.strays += s;
    form.rates += s * bounds.rates.a;
    form.lengths += s * bounds.length;
    form.levers += s * bounds.rates.a * bounds.length;
    form.slide_rates += s * bounds.slide_rate;
  }
  return forms_[step];
}

/// By Cauchy and Schwarz, the sum of all s_i r_i, with the distances r_i of a point from the axes, is at most the root
/// of (sum of s_i) (sum of s_i r_i^2). The latter is a quadratic form of the point, which the steps add up to: so it
/// costs each link the same, however long its chain is.
inline double Strays::inWorld(const Body& link, const SweptLss& swept) {
  if (!any()) return 0;
  double of_steps = 0;
  if (link.step >= 0 && problem().sweeps[0].strays) {
    const StepBounds& last = frames_.bounds(0, link.step);
    const Form& form = formOf(link.step);
    Lanes square(0.0);
    for (const PointLanes& end : swept.end) {
      const Vec3Lanes& x = end.c[0];  // in the middle of a lane
      const Vec3Lanes qx(dot(form.q[0], x), dot(form.q[1], x), dot(form.q[2], x));
      square = max(square, dot(x, qx - form.b * Lanes(2.0)) + form.c);
    }
    const double radius = link.lss[6], lever = last.length + swept.reach, sizes = lever + radius;
    // Rounding of the form: its terms are at most strays * sizes^2 each, made of frames of these errors.
    const double ulps = last.ulps + kPoseUlps + 64 * form.count;
    const double error = 16 * kUlp * ulps * form.strays * sizes * sizes + kLeastLength;
    const double root = sqrt(form.strays * (maxLane(square) + error));
    // As distance() has it, summed over the steps; the last term is the rounding of these differences.
    const double speeds = form.strays * (last.rates.a * lever + last.slide_rate) - lever * form.rates -
                          last.rates.a * form.lengths + form.levers - form.slide_rates;
    const double rounding = 64 * form.count * kUlp * form.strays * (last.rates.a * lever + last.slide_rate);
    of_steps = root + form.strays * radius + form.slides + frames_.batch().d * (speeds + rounding);
  }
  return (of_steps + ofBody(link, frames_.batch().finish()) + ofBase(link)) * (1 + 32 * kUlp);
}

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
