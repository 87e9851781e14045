// SPDX-License-Identifier: BSD-3-Clause
#include "fcl_artic/ompl/mend.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <sstream>
#include <stdexcept>
#include <utility>
#include <vector>

#include <ompl/base/ScopedState.h>
#include <ompl/geometric/SimpleSetup.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>

#include "fcl_artic/ompl/planning_setup.h"

namespace fcl_artic::planning {
namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;
using Eigen::VectorXd;
using Points = std::vector<VectorXd>;
using Clock = std::chrono::steady_clock;

constexpr double kTwoPi = 6.28318530717958647693;
constexpr double kRoom = 1;      // m, that positions of planar and floating joints have beyond the plan's own
constexpr double kLeast = 0.05;  // s, for a stretch

// A piece that is not free is divided into parts of at most kPart (rad or m, of any joint), but into no more than
// kMaxParts. So a detour begins and ends near the obstacle that it goes around.
constexpr double kPart = 0.1;
constexpr int kMaxParts = 64;
// Parts of the clearance, tried one after the other, and for each its part of the remaining time.
constexpr double kClearances[] = {1, 0.25, 0}, kShares[] = {0.5, 0.5, 1};
// A planner's way is brought back towards the plan at points at most this far (rad or m) from each other.
constexpr double kPull = 0.2;
constexpr int kPulls = 3;

// Small detours, by one or two waypoints off the plan: how far each joint goes at most (rad or m), and how often that
// is tried. They cost some ms if none is found, and keep mended plans near the plan (bench_tables certify).
constexpr double kNudges[] = {0.01, 0.02, 0.05, 0.1, 0.2, 0.4};
constexpr int kTries = 48, kShrinks = 5;

double secondsSince(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

double lengthOf(const Points& points) {
  double length = 0;
  for (std::size_t i = 1; i < points.size(); ++i) length += (points[i] - points[i - 1]).norm();
  return length;
}

/// The point at a share of the way's length.
VectorXd pointAt(const Points& points, double share) {
  double left = share * lengthOf(points);
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double step = (points[i] - points[i - 1]).norm();
    if (left <= step && step > 0) return points[i - 1] + left / step * (points[i] - points[i - 1]);
    left -= step;
  }
  return points.back();
}

/// The largest difference of any variable, and which one that is.
std::pair<double, Eigen::Index> deviationOf(const Points& a, const Points& b) {
  constexpr int kSamples = 200;
  std::pair<double, Eigen::Index> most{0, 0};
  for (int i = 0; i <= kSamples; ++i) {
    const double share = static_cast<double>(i) / kSamples;
    Eigen::Index at = 0;
    const double off = (pointAt(a, share) - pointAt(b, share)).cwiseAbs().maxCoeff(&at);
    if (off > most.first) most = {off, at};
  }
  return most;
}

/// The plan, its joints going straight between its waypoints.
struct Straight {
  Points points;                    ///< unwrapped
  std::vector<double> times;        ///< of these
  std::vector<bool> given;          ///< which of these are the plan's own waypoints
  std::vector<JointMotion> pieces;  ///< one fewer
  std::vector<bool> free;           ///< pieces that are proven free

  /// The number of the plan's waypoint at or before a point.
  std::size_t waypoint(std::size_t point) const {
    return static_cast<std::size_t>(
               std::count(given.begin(), given.begin() + static_cast<std::ptrdiff_t>(point) + 1, true)) -
           1;
  }
};

/// @param way  the straight way through the given points.
/// @param isFree  whether a piece is free: other pieces are divided.
template <class IsFree>
Straight straightOf(const KinematicTree& tree, const Waypoints& given, const JointTrajectory& way,
                    const IsFree& isFree) {
  Straight out;
  const auto add = [&](VectorXd q, double t, bool given) {
    out.points.push_back(std::move(q));
    out.times.push_back(t);
    out.given.push_back(given);
  };
  add(way.piece(0).configuration(0), given.times[0], true);
  for (std::size_t k = 0; k < way.numPieces(); ++k) {
    const JointMotion& piece = way.piece(k);
    // The next piece begins with the plan's own numbers. At the goal they are the plan's but for whole turns.
    VectorXd end = k + 1 < way.numPieces() ? way.piece(k + 1).configuration(0) : piece.configuration(1);
    if (k + 1 == way.numPieces()) {
      const VectorXd& goal = given.positions.back();
      end = ((end - goal).array().abs() < 1).select(goal, end);
    }
    const bool free = isFree(piece);
    const double step = (end - out.points.back()).lpNorm<Eigen::Infinity>();
    const int parts = free ? 1 : std::clamp(static_cast<int>(std::ceil(step / kPart)), 1, kMaxParts);
    for (int i = 1; i < parts; ++i) {
      const double share = static_cast<double>(i) / parts;
      const VectorXd q = piece.configuration(share);
      out.pieces.push_back(JointMotion::linear(tree, out.points.back(), q));
      add(q, given.times[k] + share * (given.times[k + 1] - given.times[k]), false);
    }
    out.pieces.push_back(parts == 1 ? piece : JointMotion::linear(tree, out.points.back(), end));
    out.free.resize(out.pieces.size(), free);
    add(end, given.times[k + 1], true);
  }
  return out;
}

/// A stretch of the plan and what replaces it.
struct Detour {
  std::size_t begin, end;  ///< waypoints
  Points points;           ///< from the one to the other
};

/// One of the runs, each with less clearance than the one before.
struct Attempt {
  double clearance, seconds;  ///< m, that detours keep; that it may take
};

class Mender {
 public:
  Mender(const std::shared_ptr<const ArticulatedCollisionManager>& manager, const Waypoints& given,
         const JointTrajectory& way, const std::vector<int>& variables, const MendOptions& options,
         const Attempt& attempt)
      : tree_(manager->tree()), options_(options), seconds_(attempt.seconds), variables_(variables), manager_(manager) {
    SetupOptions setup;
    std::size_t values = 0;
    for (const int v : variables_) {
      const JointId j = tree_.variableJoint(v);
      const std::string& joint = tree_.joint(j).name;
      if (std::find(joints_.begin(), joints_.end(), joint) != joints_.end()) continue;
      joints_.push_back(joint);
      values += static_cast<std::size_t>(tree_.numVariables(j));
    }
    if (values != variables_.size()) throw std::runtime_error("the plan moves only some of the values of a joint");
    for (int v = 0; v < tree_.dof(); ++v) {
      if (std::find(variables_.begin(), variables_.end(), v) == variables_.end()) {
        setup.fixed[tree_.variableName(v)] = given.positions[0][v];
      }
    }
    setup.request.margin = options.request.margin;
    setup.request.added_margin = options.request.added_margin;
    setup.request.check_self = options.request.check_self;
    setup.request.check_scene = options.request.check_scene;
    setup.request.work_budget = options.request.work_budget;
    given_request_ = setup.request;
    way_ = straightOf(tree_, given, way, [&](const JointMotion& piece) { return isFreeAsGiven(piece); });
    addBounds(setup);
    setup.request.margin += attempt.clearance;
    request_ = setup.request;
    setup_ = setUpPlanning(manager, joints_, setup);
  }

  Mended run() {
    const Clock::time_point begin = Clock::now();
    const std::size_t last = way_.points.size() - 1;
    if (!valid(0)) throw std::runtime_error("its start touches something: no detour begins there");
    if (!valid(last)) throw std::runtime_error("its goal touches something: no detour ends there");
    for (std::size_t k = 0; k < last;) {
      if (way_.free[k] || isFreeAsGiven(way_.pieces[k])) {
        ++k;
        continue;
      }
      k = replace(k, begin);
    }
    return assemble();
  }

 private:
  void addBounds(SetupOptions& setup) const {
    setup.position_lower.setConstant(std::numeric_limits<double>::infinity());
    setup.position_upper = -setup.position_lower;
    for (const std::string& name : joints_) {
      const JointId j = tree_.jointId(name);
      const int places = tree_.joint(j).type == JointType::planar     ? 2
                         : tree_.joint(j).type == JointType::floating ? 3
                                                                      : 0;
      for (int i = 0; i < places; ++i) {
        for (const VectorXd& q : way_.points) {
          const double x = q[tree_.jointVariable(j) + i];
          setup.position_lower[i] = std::min(setup.position_lower[i], x - kRoom);
          setup.position_upper[i] = std::max(setup.position_upper[i], x + kRoom);
        }
      }
    }
  }

  ob::ScopedState<> stateOf(const VectorXd& q) const {
    std::vector<double> values;
    for (const std::string& joint : joints_) {
      const JointId j = tree_.jointId(joint);
      for (int i = 0; i < tree_.numVariables(j); ++i) values.push_back(q[tree_.jointVariable(j) + i]);
    }
    ob::ScopedState<> state(setup_.space);
    setup_.setState(state.get(), values);
    return state;
  }

  /// Continuous joints are brought within half a turn of the configuration before.
  VectorXd configurationOf(const ob::State* state, const VectorXd& before) const {
    VectorXd q = before;
    const std::vector<double> values = setup_.values(state);
    std::size_t next = 0;
    for (const std::string& joint : joints_) {
      const JointId j = tree_.jointId(joint);
      for (int i = 0; i < tree_.numVariables(j); ++i) q[tree_.jointVariable(j) + i] = values[next++];
    }
    unwrap(q, before);
    return q;
  }

  void unwrap(VectorXd& q, const VectorXd& before) const {
    for (const int v : variables_) {
      const Joint& joint = tree_.joint(tree_.variableJoint(v));
      const bool forever = joint.type == JointType::continuous || (joint.type == JointType::planar && tree_.isAngle(v));
      if (forever) q[v] += kTwoPi * std::nearbyint((before[v] - q[v]) / kTwoPi);
    }
  }

  /// (The plan's own points have been judged: a sensor's may be a little beyond the limits.)
  bool valid(std::size_t k) const {
    CertifiedRequest any = request_;
    any.max_contacts = 0;
    return manager_->collide(way_.points[k], any).isFree();
  }

  /// Finds a way around the obstacles that the piece from waypoint k on touches.
  /// @return the waypoint where it ends.
  std::size_t replace(std::size_t k, Clock::time_point begin) {
    const std::size_t last = way_.points.size() - 1;
    for (std::size_t wider = 0;; wider = 2 * wider + 1) {
      std::size_t a = k - std::min(k, wider), b = std::min(last, k + 1 + wider);
      while (a > 0 && !valid(a)) --a;
      while (b < last && !valid(b)) ++b;
      std::size_t first = detours_.size();  // of those that this one holds
      while (first > 0 && a < detours_[first - 1].end) a = std::min(a, detours_[--first].begin);
      const bool whole = a == 0 && b == last;
      const double left = seconds_ - secondsSince(begin);
      if (left < kLeast) break;
      std::optional<Points> points = wider == 0 ? nudge(k, a, b) : std::nullopt;
      if (!points) {
        points = plan(way_.points[a], way_.points[b], whole ? left : left / 4);
        if (points) pullBack(stretch(a, b), *points);
      }
      if (points) {
        detours_.resize(first);
        detours_.push_back({a, b, std::move(*points)});
        return b;
      }
      if (whole) break;
    }
    std::ostringstream why;
    why << "no way around what it touches after waypoint " << way_.waypoint(k) << " was found in " << options_.seconds
        << " s";
    throw std::runtime_error(why.str());
  }

  /// Whether a joint has a quaternion, which goes no straight way in its values.
  bool hasRotations() const {
    return std::any_of(joints_.begin(), joints_.end(),
                       [&](const std::string& joint) { return tree_.quaternionVariable(tree_.jointId(joint)) >= 0; });
  }

  bool isFreeAsGiven(const JointMotion& piece) const { return manager_->isFree(piece, given_request_); }

  Points stretch(std::size_t a, std::size_t b) const {
    return {way_.points.begin() + static_cast<std::ptrdiff_t>(a),
            way_.points.begin() + static_cast<std::ptrdiff_t>(b) + 1};
  }

  /// Brings inner points of a way nearer to the stretch that it replaces, as far as all stays free.
  void pullBack(const Points& before, Points& points) const {
    if (hasRotations() || points.back() != before.back()) return;  // the latter by whole turns
    Points fine{points.front()};
    for (std::size_t i = 1; i < points.size(); ++i) {
      const VectorXd step = points[i] - points[i - 1];
      const int parts = std::clamp(static_cast<int>(std::ceil(step.lpNorm<Eigen::Infinity>() / kPull)), 1, kMaxParts);
      for (int k = 1; k < parts; ++k) fine.push_back(points[i - 1] + static_cast<double>(k) / parts * step);
      fine.push_back(points[i]);
    }
    if (!certainlyFree(fine)) return;  // by a rounding
    for (int pass = 0; pass < kPulls; ++pass) {
      const double length = lengthOf(fine);
      double at = 0;
      for (std::size_t i = 1; i + 1 < fine.size(); ++i) {
        at += (fine[i] - fine[i - 1]).norm();
        const VectorXd target = pointAt(before, std::min(1.0, at / length));
        for (const double part : {1.0, 0.5, 0.25}) {
          const VectorXd nearer = fine[i] + part * (target - fine[i]);
          if (!certainlyFree(Points{fine[i - 1], nearer, fine[i + 1]})) continue;
          fine[i] = nearer;
          break;
        }
      }
    }
    points = std::move(fine);
  }

  bool certainlyFree(const VectorXd& from, const VectorXd& to) const {
    return manager_->isFree(JointMotion::linear(tree_, from, to), request_);
  }

  bool certainlyFree(const Points& points) const {
    for (std::size_t i = 1; i + 1 < points.size(); ++i) {  // both ends are the plan's own
      if (!setup_.space->satisfiesBounds(stateOf(points[i]).get())) return false;
    }
    for (std::size_t i = 1; i < points.size(); ++i) {
      if (!certainlyFree(points[i - 1], points[i])) return false;
    }
    return true;
  }

  /// Share of the stretch's length at which something is met first, from its begin or from its end.
  double meets(const Points& points, bool from_end) const {
    CertifiedRequest request = request_;
    request.mode = ContactMode::first;
    CertifiedResult result;
    const double length = lengthOf(points);
    double before = 0;
    for (std::size_t i = 1; i < points.size(); ++i) {
      const std::size_t at = from_end ? points.size() - i : i - 1, next = from_end ? at - 1 : at + 1;
      const double step = (points[next] - points[at]).norm();
      manager_->continuousCollide(JointMotion::linear(tree_, points[at], points[next]), request, result);
      if (!result.isFree()) {
        const double share = length > 0 ? (before + result.t_lower * step) / length : 0;
        return from_end ? 1 - share : share;
      }
      before += step;
    }
    return 0.5;
  }

  /// Tries ways from waypoint a to b that leave the plan by a little, around the obstacles on it.
  std::optional<Points> nudge(std::size_t k, std::size_t a, std::size_t b) {
    if (hasRotations()) return std::nullopt;
    const Points before = stretch(a, b);
    const double begin = meets(before, false), end = std::max(begin, meets(before, true));
    const VectorXd shares[3] = {pointAt(before, begin), pointAt(before, (begin + end) / 2), pointAt(before, end)};
    std::mt19937 random(static_cast<unsigned>(k));  // the same answer each time
    std::uniform_real_distribution<double> unit(-1, 1);
    for (const double most : kNudges) {
      for (int i = 0; i < kTries; ++i) {
        VectorXd offset = VectorXd::Zero(tree_.dof());
        for (const int v : variables_) offset[v] = most * unit(random);
        for (const bool two : {false, true}) {
          const auto around = [&](double part) {
            const VectorXd by = part * offset;
            Points points{before.front()};
            if (two) {
              points.emplace_back(shares[0] + by);
              points.emplace_back(shares[2] + by);
            } else {
              points.emplace_back(shares[1] + by);
            }
            points.push_back(before.back());
            return points;
          };
          if (!certainlyFree(around(1))) continue;
          double good = 1, bad = 0;  // parts of the offset
          for (int halving = 0; halving < kShrinks; ++halving) {
            const double middle = (good + bad) / 2;
            (certainlyFree(around(middle)) ? good : bad) = middle;
          }
          return around(good);
        }
      }
    }
    return std::nullopt;
  }

  std::optional<Points> plan(const VectorXd& from, const VectorXd& to, double limit) const {
    og::SimpleSetup simple(setup_.si);
    ob::ScopedState<> start = stateOf(from), goal = stateOf(to);
    for (ob::ScopedState<>* end : {&start, &goal}) setup_.space->enforceBounds(end->get());
    simple.setStartAndGoalStates(start, goal);
    simple.setPlanner(std::make_shared<og::RRTConnect>(setup_.si));
    if (simple.solve(limit) != ob::PlannerStatus::EXACT_SOLUTION) return std::nullopt;
    simple.simplifySolution(limit);
    Points points{from};
    const og::PathGeometric& path = simple.getSolutionPath();
    for (std::size_t i = 1; i + 1 < path.getStateCount(); ++i) {
      points.push_back(configurationOf(path.getState(static_cast<unsigned>(i)), points.back()));
    }
    VectorXd end = to;  // its own numbers, but for whole turns
    unwrap(end, points.back());
    points.push_back(end);
    return points;
  }

  Mended assemble() const {
    Mended out;
    out.detours = detours_.size();
    Points& points = out.waypoints.positions;
    std::vector<double>& times = out.waypoints.times;
    points = {way_.points[0]};
    times = {way_.times[0]};
    const auto add = [&](const VectorXd& q, double duration) {
      points.push_back(q);
      times.push_back(times.back() + duration);
    };
    VectorXd turned = VectorXd::Zero(tree_.dof());  // whole turns, by the detours so far
    std::size_t k = 0;
    // Points that were put between waypoints are no waypoints, unless a detour begins or ends there.
    const auto follow = [&](std::size_t end) {
      for (double since = 0; k < end;) {
        since += way_.times[k + 1] - way_.times[k];
        ++k;
        if (!way_.given[k] && k != end) continue;
        add(way_.points[k] + turned, since);
        since = 0;
      }
    };
    for (const Detour& detour : detours_) {
      follow(detour.begin);
      const Points before = stretch(detour.begin, detour.end);
      const double length = lengthOf(detour.points), old = lengthOf(before);
      const double duration =
          (way_.times[detour.end] - way_.times[detour.begin]) * (old > 0 ? std::max(1.0, length / old) : 1);
      const auto [off, variable] = deviationOf(before, detour.points);
      if (off > out.deviation) {
        out.deviation = off;
        out.deviation_joint = tree_.variableName(static_cast<int>(variable));
        out.deviation_is_angle = tree_.isAngle(static_cast<int>(variable));
      }
      for (std::size_t i = 1; i < detour.points.size(); ++i) {
        const double step = (detour.points[i] - detour.points[i - 1]).norm();
        if (step > 0) add(detour.points[i] + turned, duration * step / length);
      }
      turned += detour.points.back() - way_.points[detour.end];
      k = detour.end;
    }
    follow(way_.points.size() - 1);
    out.added_time = times.back() - times.front() - (way_.times.back() - way_.times.front());
    const double old = lengthOf(way_.points);
    out.length_ratio = old > 0 ? lengthOf(points) / old : 1;
    return out;
  }

  const KinematicTree& tree_;
  const MendOptions& options_;
  const double seconds_;
  const std::vector<int> variables_;
  Straight way_;
  std::vector<std::string> joints_;  ///< that these belong to
  PlanningSetup setup_;
  CertifiedRequest given_request_, request_;  ///< by which the plan is looked at, and detours
  std::shared_ptr<const ArticulatedCollisionManager> manager_;
  std::vector<Detour> detours_;  ///< in their order, none within another
};

void requireOptions(const MendOptions& options) {
  std::ostringstream why;
  if (!(options.seconds > 0 && std::isfinite(options.seconds))) {
    why << "mend: options.seconds is " << options.seconds << ", not a number above 0";
  } else if (!(options.clearance >= 0 && std::isfinite(options.clearance))) {
    why << "mend: options.clearance is " << options.clearance << ", not a number of at least 0 (m)";
  }
  if (!why.str().empty()) throw std::invalid_argument(why.str());
}

/// Detours move the variables, and no others: those stay where the first waypoint has them.
/// @param positions  each of the tree.
void requireVariables(const KinematicTree& tree, const Points& positions, const std::vector<int>& variables) {
  const auto refuse = [](const std::string& why) { throw std::invalid_argument("mend: " + why); };
  if (variables.empty()) refuse("`variables` is empty: no joint may move");
  std::vector<bool> may_move(static_cast<std::size_t>(tree.dof()));
  for (const int v : variables) {
    if (v < 0 || v >= tree.dof()) {
      refuse("`variables` holds " + std::to_string(v) + "; robot '" + tree.name() + "' has variables 0 to " +
             std::to_string(tree.dof() - 1));
    }
    if (may_move[static_cast<std::size_t>(v)]) {
      refuse("`variables` holds " + std::to_string(v) + " ('" + tree.variableName(v) + "') twice");
    }
    may_move[static_cast<std::size_t>(v)] = true;
  }
  for (int v = 0; v < tree.dof(); ++v) {
    for (std::size_t k = 1; !may_move[static_cast<std::size_t>(v)] && k < positions.size(); ++k) {
      if (positions[k][v] == positions[0][v]) continue;
      refuse("'" + tree.variableName(v) + "' (" + std::to_string(v) + ") is not in `variables`, and waypoint " +
             std::to_string(k) + " has it elsewhere than waypoint 0: add it");
    }
  }
}

}  // namespace

Mended mend(const std::shared_ptr<const ArticulatedCollisionManager>& manager, const Waypoints& given,
            const std::vector<int>& variables, JointTrajectory::Unwrap unwrap, const MendOptions& options) {
  if (!manager) throw std::invalid_argument("mend: the manager is null");
  requireOptions(options);
  const KinematicTree& tree = manager->tree();
  const JointTrajectory way = JointTrajectory::linear(tree, given.times, given.positions, unwrap);
  requireVariables(tree, given.positions, variables);
  const Clock::time_point begin = Clock::now();
  for (std::size_t i = 0;; ++i) {
    const bool last = kClearances[i] == 0;
    if (!last && options.clearance == 0) continue;
    try {
      const double kept = kClearances[i] * options.clearance;
      const double seconds = kShares[i] * (options.seconds - secondsSince(begin));
      Mended out = Mender(manager, given, way, variables, options, {kept, seconds}).run();
      out.kept = kept;
      out.ms = 1e3 * secondsSince(begin);
      return out;
    } catch (const std::invalid_argument& error) {  // nothing that depends on the clearance
      throw std::runtime_error(error.what());
    } catch (const std::runtime_error&) {
      if (last) throw;
    }
  }
}

}  // namespace fcl_artic::planning
