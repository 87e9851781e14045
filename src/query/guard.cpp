// SPDX-License-Identifier: BSD-3-Clause
//
// A guard asks one question again and again: is the way on, and the stop after it, free of the newest scene?
//
// The path. The robot keeps to q(s), s the trajectory's own time, whatever its speed ds/dt = f is. So a question is
// about a range of s, not about time. Where obstacles stand still, the answer holds for every way of passing the range.
//
// Time. Objects that move by themselves have moved for as long as it takes until the robot stands, at the most. Each
// question names that time, T, for all of its range (engine::Clock).
//
// The range. Let r be the reaction, P the period, d the braking (1/s^2), f0 the speed until the answer is followed.
//   f >= f0: (r + P) f + f^2 / (2 d),                               T = r + P + f / d
//   f < f0, reached within P: r f0 + (f0^2 - f^2) / (2 d) + (P - (f0 - f) / d) f + f^2 / (2 d),   the same T
// So the slowest speed that can be promised is f0 - d P, or 0. It takes the range r f0 + f0^2 / (2 d) in all, and T = r
// + f0 / d. (If the speed varies, f is its largest value.)
//
// Looking ahead, at full speed. A stop that begins at any time, at full speed, takes 1 / d for a range of 1 / (2 d). So
// it passes each place at most 1 / (2 d) later than full speed does: T(s) = s - s0 + r + 1 / (2 d) holds for all of
// these stops at once. One query with this T finds the first place that is not free. A stop that is to end before it
// begins r + 1 / (2 d) before it.
//
// Braking. Along the path, q' f is the speed and q'' f^2 + q' df/dt the acceleration. The first term the trajectory
// asks for itself, at no more than its own speed. The second is within the deceleration where |df/dt| <= d, with d the
// least of deceleration over |q'|.
#include "fcl_artic/guard.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "model/trajectory_time.h"
#include "motion/part_of_motion.h"
#include "numerics/constants.h"
#include "numerics/require.h"
#include "numerics/shown.h"
#include "query/engine_query.h"
#include "query/guarded_path.h"
#include "query/manager_impl.h"
#include "query/query_context.h"

namespace fcl_artic {
namespace {

/// s: how finely lookAhead() locates the first place that is not free.
constexpr double kWantedTime = 1e-3;

/// Ranges of ask() are divided down to this share of a piece's part. A range that is not proven free by then is
/// refused. Measured: with 1e-6 pairs that graze in the tube spend all of the budget.
constexpr double kFinestShare = 1.0 / 32;

/// A time that is no more than a duration after another one, whatever is rounded. (The difference of two times is exact
/// where they are near each other.)
double noLaterThan(double begin, double duration) {
  double end = begin + duration;
  while (end > begin && end - begin > duration) end = std::nextafter(end, begin);
  return end;
}

/// A range of the trajectory's time, and how long objects may move meanwhile, in s: linear over the range.
struct Range {
  double from, to;
  engine::Clock moving;
};

}  // namespace

struct Guard::Impl {
  Impl(std::shared_ptr<const KinematicTree> of, GuardOptions told) : tree(std::move(of)), options(std::move(told)) {
    request.mode = ContactMode::first;
    request.max_contacts = 0;
    request.margin = options.margin;
    static_cast<Scope&>(request) = options;
    lever.resize(static_cast<std::size_t>(tree->numJoints()));
    weight.resize(tree->dof());
    strays.resize(static_cast<std::size_t>(tree->dof()));
  }

  void begin(const LiveScene::Snapshot& scene, double now, double path_time);
  void measureRobot();
  double payForParts();
  bool isFree(const Range& range, bool any);
  void namePair(BodyRef& body1, BodyRef& body2) const;
  /// The motion until the next answer and the stop after it, at a speed.
  struct Plan {
    double speed, way, reacting, time;
  };
  Plan planAt(double speed) const;
  void settleBraking(std::initializer_list<double> speeds);
  double slowest() const { return std::max(0.0, path_speed - braking * options.period); }
  bool certify(const Plan& plan);
  std::optional<Plan> fastestProven(GuardAnswer& answer);
  bool limitStandsStill() const;
  std::optional<Plan> fastestBefore(double time, const Plan& slowest, const Plan& refused) const;
  double stopOf(const Plan& plan) const;
  double end() const { return path->end(); }

  const std::shared_ptr<const KinematicTree> tree;
  const GuardOptions options;
  std::optional<GuardedPath> path;
  std::optional<double> promised_braking;  ///< 1/s, of the last certified answer about this trajectory

  // The question at hand, as begin() sets it.
  const ArticulatedCollisionManager* manager = nullptr;
  double age = 0, path_time = 0, path_speed = 0, braking = 0;
  std::vector<double> lever;   ///< m, by joint: no point that it moves is farther from its origin
  Eigen::VectorXd weight;      ///< m per unit of a variable: how far that moves a point, at most
  std::vector<double> strays;  ///< rad or m, by variable
  double reach = 0;            ///< m: no point of the robot is farther from the base
  std::uint64_t tests = 0;
  GuardReason reason = GuardReason::none;
  double free_until = 0, found_at = 0;  ///< of the last isFree() that was not

  CertifiedRequest request;
  CertifiedResult result;
  std::optional<engine::LeafContact> limit;
};

/// No point of a body is farther from the origin of a joint below which it is than the lengths on the way add up to.
/// Slides may stray.
void Guard::Impl::measureRobot() {
  std::fill(lever.begin(), lever.end(), 0);
  reach = 0;
  const std::vector<JointTolerance>& of_joint = manager->impl_->setup.jointTolerances();
  for (const ManagedBody& body : manager->impl_->registry.links()) {
    if (body.empty()) continue;
    double length = body.offset.isometry().translation().norm() + body.shape->view().extent;
    for (LinkId link = body.link; tree->parentJoint(link) >= 0; link = tree->parentLink(link)) {
      const JointId j = tree->parentJoint(link);
      const Joint& joint = tree->joint(j);
      lever[static_cast<std::size_t>(j)] = std::max(lever[static_cast<std::size_t>(j)], length);
      length += joint.origin.translation().norm();
      if (joint.type == JointType::fixed || joint.type == JointType::revolute || joint.type == JointType::continuous ||
          joint.type == JointType::spherical)
        continue;
      const double multiple = joint.mimics ? std::abs(joint.mimic.multiplier) : 1;
      length += multiple * path->largest().segment(tree->jointVariable(j), tree->numVariables(j)).sum();
      if (joint.mimics) length += std::abs(joint.mimic.offset);
      if (!of_joint.empty()) length += of_joint[static_cast<std::size_t>(j)].length;
    }
    reach = std::max(reach, kUp * length);
  }
  weight.setZero();
  for (JointId j = 0; j < tree->numJoints(); ++j) {
    const Joint& joint = tree->joint(j);
    const int count = tree->numVariables(j);
    if (count == 0) continue;
    const bool turns = joint.type != JointType::prismatic;
    const bool slides = joint.type == JointType::prismatic || count > 1;
    const double multiple = joint.mimics ? std::abs(joint.mimic.multiplier) : 1;
    const double way = (turns ? lever[static_cast<std::size_t>(j)] : 0) + (slides ? 1 : 0);
    for (int i = 0; i < count; ++i) weight[tree->jointVariable(j) + i] += kUp * multiple * way;
  }
}

/// A part's variables are not quite those of its piece. They count as if they strayed by that (NUMERICS, "Tubes"). Each
/// brings two bodies nearer by no more than the lever times the angle. Tables and proofs of ranges are asked about all
/// values between.
double Guard::Impl::payForParts() {
  const VariableStrays of_robot = manager->impl_->setup.variableStrays(1);
  const Eigen::VectorXd& error = path->partError();
  for (Eigen::Index v = 0; v < error.size(); ++v) {
    strays[static_cast<std::size_t>(v)] = kUp * (of_robot.of(static_cast<int>(v)) + error[v]);
  }
  return kUp * weight.dot(error);
}

void Guard::Impl::begin(const LiveScene::Snapshot& scene, double now, double at) {
  if (!path) throw std::logic_error("Guard: call follow() before asking");
  requireFinite(now, "Guard: now");
  requireFinite(at, "Guard: path_time");
  manager = &scene.manager;
  const Registry& registry = manager->impl_->registry;
  manager->impl_->requireReady();
  if (!tree->content().sameAs(registry.tree()->content())) {
    throw std::invalid_argument("Guard: the scene is of robot '" + registry.tree()->name() + "', the guard of '" +
                                tree->name() + "', with other links or joints: make both of one tree");
  }
  path->trajectory().requireOf(*registry.tree());
  if (!registry.moving().empty()) {
    throw std::invalid_argument("Guard: obstacle '" + registry.moving().front().name +
                                "' has a motion of its own, which stops for nobody: register where it is seen, and "
                                "setObjectSpeed()");
  }
  age = now - scene.seen_at;
  path_time = std::min(std::max(at, path->begin()), end());
  tests = 0;
  measureRobot();
  request.added_margin = options.added_margin + payForParts();
  reason = age >= 0 && age <= options.most_age ? GuardReason::none : GuardReason::old_scene;
}

/// Whether the robot may pass the range. (It allocates only what the first questions do.)
/// @param any  any contact ends the search; else the first one is found, and free_until is close to it.
bool Guard::Impl::isFree(const Range& range, bool any) {
  request.mode = any ? ContactMode::any : ContactMode::first;
  const std::vector<double>& times = path->trajectory().times();
  const double length = range.to - range.from;
  const auto movingAt = [&](double s) {
    const double u = length > 0 ? std::min(1.0, std::max(0.0, (s - range.from) / length)) : 1;
    return kUp * (range.moving.begin + u * (range.moving.end - range.moving.begin));
  };
  free_until = range.to;
  if (!(range.to > range.from)) return true;  // nothing moves
  for (std::size_t k = path->pieceAt(range.from); k + 1 < times.size() && times[k] < range.to; ++k) {
    const double duration = times[k + 1] - times[k];
    // Outward: a little more is asked than needed.
    const auto partAt = [&](double s, double slack) {
      return std::min(1.0, std::max(0.0, (s - times[k]) / duration + slack));
    };
    const double slack = 0x1p-50 * (1 + (std::abs(times[k]) + std::abs(times[k + 1])) / duration);
    const TimePart part = {range.from <= times[k] ? 0 : partAt(range.from, -slack),
                           range.to >= times[k + 1] ? 1 : partAt(range.to, slack)};
    if (part.begin >= part.end) continue;
    if (options.work_budget) {
      if (tests >= options.work_budget) {
        reason = GuardReason::budget;
        free_until = found_at = std::max(range.from, times[k]);
        return false;
      }
      request.work_budget = options.work_budget - tests;
    }
    const PieceTime clock(times[k], times[k + 1]);
    request.tolerance_time = any ? kFinestShare : std::min(1.0, kWantedTime / (duration * part.width()));
    ArticulatedCollisionManager::QueryContext context;
    context.clock = {movingAt(clock.lower(part.begin)), movingAt(clock.upper(part.end))};
    context.limit = &limit;
    context.variable_strays = strays.data();
    manager->collideMotion(path->partOf(k, part), request, context, result);
    tests += countedWork(result.statistics);
    if (result.isFree()) continue;
    reason = result.status == Status::undecided ? GuardReason::budget : GuardReason::near;
    // (Rounded down: the time within the part, then within the piece.)
    const double u = part.begin + result.t_lower * part.width();
    free_until = std::max(range.from, clock.lower(u - 0x1p-50));
    found_at = limit ? clock.lower(part.at(limit->t)) : free_until;
    return false;
  }
  return true;
}

void Guard::Impl::namePair(BodyRef& body1, BodyRef& body2) const {
  const Registry& registry = manager->impl_->registry;
  const auto name = [&](std::int32_t number, BodyRef& body) {
    const ManagedBody& of = registry.body(number);
    body.link = of.link;
    body.object = of.object;
    body.moving = of.moving;
    body.name = of.name;
  };
  if (reason == GuardReason::near && limit) {
    const bool link_first = registry.body(limit->body_a).link >= 0;
    name(link_first ? limit->body_a : limit->body_b, body1);
    name(link_first ? limit->body_b : limit->body_a, body2);
    return;
  }
  for (BodyRef* body : {&body1, &body2}) {
    body->link = -1;
    body->object = nullptr;
    body->moving = nullptr;
    body->name.clear();
  }
}

Guard::Impl::Plan Guard::Impl::planAt(double f) const {
  const double f0 = path_speed, P = options.period, r = options.reaction, d = braking;
  const double stop = d < kInfinity ? f / d : 0, way_of_stop = d < kInfinity ? f * f / (2 * d) : 0;
  if (f >= f0) return {f, kUp * ((r + P) * f + way_of_stop), kUp * (r + P) * f, kUp * (r + P + stop)};
  const double slowing = (f0 - f) / d;
  if (slowing >= P || f == 0) {  // braking all the time, until the robot stands
    return {f, kUp * (r * f0 + f0 * f0 / (2 * d)), kUp * r * f0, kUp * (r + f0 / d)};
  }
  const double until_slow = (f0 * f0 - f * f) / (2 * d);
  return {f, kUp * (r * f0 + until_slow + (P - slowing) * f + way_of_stop), kUp * (r * f0 + P * f0),
          kUp * (r + P + stop)};
}

/// The range depends on the braking, and the braking on the range: pieces are taken in until both agree.
void Guard::Impl::settleBraking(std::initializer_list<double> speeds) {
  braking = kInfinity;
  for (double to = path_time;;) {
    braking = path->brakingOver(path_time, to);
    double needed = to;
    for (const double speed : speeds) needed = std::max(needed, stopOf(planAt(speed)));
    if (needed <= to) return;
    to = needed;
  }
}

/// The trajectory's time beyond which the robot does not come. If it moves at all, that is later than it is now: its
/// way may be shorter than the last bit of a time.
double Guard::Impl::stopOf(const Plan& plan) const {
  const bool moves = path_speed > 0 || plan.speed > 0;
  return moves ? std::min(end(), std::nextafter(path_time + plan.way, kInfinity)) : path_time;
}

bool Guard::Impl::certify(const Plan& plan) {
  const double moving = age + plan.time;
  return isFree({path_time, stopOf(plan), {moving, moving}}, true);
}

/// Whether the pair that limits the speed is no nearer for going faster. Nothing is proven of it.
bool Guard::Impl::limitStandsStill() const {
  if (reason != GuardReason::near || !limit) return false;
  const engine::Body* const bodies = manager->impl_->setup.problem().bodies;
  return !(bodies[limit->body_a].speed > 0) && !(bodies[limit->body_b].speed > 0);
}

/// The fastest plan that ends before a time until which a faster one was found free; none: not even the slowest does.
/// Until that time the question was the same: objects had as long to move, or longer.
std::optional<Guard::Impl::Plan> Guard::Impl::fastestBefore(double time, const Plan& slowest,
                                                            const Plan& refused) const {
  std::optional<Plan> best;
  const auto take = [&](const Plan& plan) {
    const bool ends_before = stopOf(plan) < time && plan.time <= refused.time;
    if (ends_before) best = plan;
    return ends_before;
  };
  if (!take(slowest)) return best;
  double low = slowest.speed, high = refused.speed;
  constexpr int kHalvings = 20;  // a millionth of the speed
  for (int i = 0; i < kHalvings; ++i) {
    const double between = 0.5 * (low + high);
    (take(planAt(between)) ? low : high) = between;
  }
  return best;
}

/// The fastest plan that is proven free; none: not even the slowest is. `reason` then says why it is no faster, and so
/// do the answer's bodies.
std::optional<Guard::Impl::Plan> Guard::Impl::fastestProven(GuardAnswer& answer) {
  const auto isProven = [&](const Plan& plan) {
    const GuardReason before = std::exchange(reason, GuardReason::none);
    if (certify(plan)) {
      reason = before;
      return true;
    }
    namePair(answer.body1, answer.body2);
    answer.near_at = found_at;
    return false;
  };
  const Plan full = planAt(1), slowest = planAt(this->slowest());
  if (isProven(full)) return full;
  std::optional<Plan> proven;
  double high = 1;  // nothing faster is worth a try
  const auto learnFrom = [&](const Plan& refused, const Plan& from) {
    high = refused.speed;
    if (const auto sooner = fastestBefore(free_until, from, refused)) proven = sooner;
    if (!limitStandsStill()) return;
    const auto before = fastestBefore(found_at, from, refused);
    high = before ? before->speed : from.speed;
  };
  if (options.tries > 0) learnFrom(full, slowest);
  if (!proven && reason == GuardReason::near && isProven(slowest)) proven = slowest;
  const double finest = std::ldexp(1.0, -options.tries);
  for (int i = 0; proven && i < options.tries && high - proven->speed > finest; ++i) {
    const Plan between = planAt(0.5 * (proven->speed + high));
    if (isProven(between)) {
      proven = between;
    } else if (reason == GuardReason::near) {
      learnFrom(between, *proven);
    } else {
      break;
    }
  }
  return proven;
}

Guard::Guard(std::shared_ptr<const KinematicTree> tree, GuardOptions options) {
  if (!tree) throw std::invalid_argument("Guard: the kinematic tree is null");
  if (options.deceleration.size() != tree->dof()) {
    throw std::invalid_argument("GuardOptions: deceleration has " + std::to_string(options.deceleration.size()) +
                                " entries, robot '" + tree->name() + "' has " + std::to_string(tree->dof()) +
                                " joint variables");
  }
  for (Eigen::Index v = 0; v < options.deceleration.size(); ++v) {
    requirePositive(options.deceleration[v], "GuardOptions: a deceleration");
  }
  requirePositive(options.period, "GuardOptions: period");
  requireNotNegative(options.reaction, "GuardOptions: reaction");
  requireNotNegative(options.most_age, "GuardOptions: most_age");
  requireNotNegative(options.margin, "GuardOptions: margin");
  requireNotNegative(options.added_margin, "GuardOptions: added_margin");
  if (options.tries < 0 || options.tries > 30) {
    throw std::invalid_argument("GuardOptions: tries is " + std::to_string(options.tries) + ", not in [0, 30]");
  }
  impl_ = std::make_unique<Impl>(std::move(tree), std::move(options));
}

Guard::~Guard() = default;
Guard::Guard(Guard&&) noexcept = default;
Guard& Guard::operator=(Guard&&) noexcept = default;

void Guard::follow(const JointTrajectory& trajectory) {
  trajectory.requireOf(*impl_->tree);
  impl_->path.emplace(trajectory, *impl_->tree, impl_->options.deceleration);
  impl_->promised_braking.reset();
}

void Guard::ask(const LiveScene::Snapshot& scene, double now, double path_time, double path_speed,
                GuardAnswer& answer) {
  answer.speed = 0;  // an error claims nothing
  answer.certified = false;
  if (!(path_speed >= 0 && path_speed <= 1)) {
    throw std::invalid_argument("Guard: path_speed is " + shown(path_speed) + ", not in [0, 1]");
  }
  Impl& guard = *impl_;
  guard.begin(scene, now, path_time);
  guard.path_speed = path_speed;
  guard.settleBraking({1, path_speed});
  answer.valid_until = noLaterThan(now, guard.options.reaction + guard.options.period);
  answer.near_at = guard.end();
  const std::optional<Impl::Plan> proven =
      guard.reason == GuardReason::none ? guard.fastestProven(answer) : std::nullopt;
  const GuardReason why = guard.reason;
  answer.certified = proven.has_value();
  // Else the robot stops on what an earlier answer has proven, and as that one said.
  if (!proven && guard.promised_braking) guard.braking = *guard.promised_braking;
  const Impl::Plan chosen = proven ? *proven : guard.planAt(0);
  answer.speed = chosen.speed;
  answer.reason = answer.speed == 1 && answer.certified ? GuardReason::none : why;
  guard.reason = answer.reason;
  if (answer.reason != GuardReason::near) guard.namePair(answer.body1, answer.body2);
  answer.braking = guard.braking;
  if (answer.certified) guard.promised_braking = guard.braking;
  answer.stop_time = chosen.time;
  answer.stop_at = guard.stopOf(chosen);
  answer.tests = guard.tests;

  const engine::Problem problem = guard.manager->impl_->setup.problem();
  const double reacting = guard.options.reaction + guard.options.period;
  const double fastest = guard.path->fastestOver(guard.path_time, answer.stop_at, guard.weight);
  Separation& s = answer.separation;
  s.human_reacting = kUp * problem.largest.speed * (std::max(0.0, guard.age) + reacting);
  s.human_stopping = kUp * problem.largest.speed * std::max(0.0, chosen.time - reacting);
  s.robot_reacting = fastest * chosen.reacting;
  s.robot_stopping = fastest * std::max(0.0, chosen.way - chosen.reacting);
  s.object = problem.largest.stray;
  s.robot = problem.base.length + problem.base.angle * (guard.reach + Eigen::Vector3d::Map(problem.base.pivot).norm());
  const std::vector<JointTolerance>& of_joint = guard.manager->impl_->setup.jointTolerances();
  for (std::size_t j = 0; j < of_joint.size(); ++j) {
    s.robot += kUp * (of_joint[j].angle * guard.lever[j] + of_joint[j].length);
  }
}

void Guard::lookAhead(const LiveScene::Snapshot& scene, double now, double path_time, AheadAnswer& answer) {
  answer.all_free = false;  // an error claims nothing
  answer.free_until = answer.run_until = -kInfinity;
  Impl& guard = *impl_;
  guard.begin(scene, now, path_time);
  const double from = guard.path_time, to = guard.end();
  guard.braking = answer.braking = guard.path->brakingOver(from, to);
  const double later = kUp * (guard.options.reaction + (guard.braking < kInfinity ? 0.5 / guard.braking : 0));
  answer.all_free = guard.reason == GuardReason::none &&
                    guard.isFree({from, to, {guard.age + later, guard.age + (to - from) + later}}, false);
  answer.reason = guard.reason;
  guard.namePair(answer.body1, answer.body2);
  answer.free_until = answer.all_free ? to : guard.reason == GuardReason::old_scene ? from : guard.free_until;
  answer.run_until = answer.all_free ? to : answer.free_until - kUp * later - 0x1p-50 * std::abs(answer.free_until);
  answer.tests = guard.tests;
}

}  // namespace fcl_artic
