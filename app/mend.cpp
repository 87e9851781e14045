// SPDX-License-Identifier: BSD-3-Clause
#include "mend.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>
#include <ompl/base/ScopedState.h>
#include <ompl/geometric/SimpleSetup.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>

#include "elapsed.h"
#include "fcl_artic/ompl/planning_setup.h"
#include "plans/variables.h"

namespace fcl_artic::app {
namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;
using Eigen::VectorXd;
using Points = std::vector<VectorXd>;

constexpr double kTwoPi = 6.28318530717958647693;
constexpr double kRoom = 1;      // m, that positions of planar and floating joints have beyond the plan's own
constexpr double kLeast = 0.05;  // s, for a stretch

// Small detours, by one waypoint or two off the plan: how far each joint goes at most, rad or m, and how often it is
// tried. They cost some ms where none is found, and keep what they mend near the plan (bench certify).
constexpr double kNudges[] = {0.01, 0.02, 0.05, 0.1, 0.2, 0.4};
constexpr int kTries = 48, kShrinks = 5;

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

double deviationOf(const Points& a, const Points& b) {
  constexpr int kSamples = 200;
  double most = 0;
  for (int i = 0; i <= kSamples; ++i) {
    const double share = static_cast<double>(i) / kSamples;
    most = std::max(most, (pointAt(a, share) - pointAt(b, share)).lpNorm<Eigen::Infinity>());
  }
  return most;
}

/// Where the plan's joints go straight between its waypoints.
struct Straight {
  Points points;                    ///< unwrapped
  std::vector<JointMotion> pieces;  ///< one fewer
};

Straight straightOf(const KinematicTree& tree, const plans::PlanMotion& motion, plans::Turns turns) {
  const auto unwrap = turns == plans::Turns::shortest ? JointTrajectory::Unwrap::yes : JointTrajectory::Unwrap::no;
  const JointTrajectory way = JointTrajectory::linear(tree, motion.times, motion.waypoints, unwrap);
  Straight out;
  out.points.push_back(way.piece(0).configuration(0));
  for (std::size_t k = 0; k < way.numPieces(); ++k) {
    out.pieces.push_back(way.piece(k));
    // As the next piece begins: there are the plan's own numbers.
    out.points.push_back(k + 1 < way.numPieces() ? way.piece(k + 1).configuration(0) : way.piece(k).configuration(1));
  }
  return out;
}

/// A stretch of the plan and what replaces it.
struct Detour {
  std::size_t begin, end;  ///< waypoints
  Points points;           ///< from the one to the other
};

class Mender {
 public:
  Mender(const std::shared_ptr<const ArticulatedCollisionManager>& manager, const plans::PlanMotion& motion,
         plans::Turns turns, const MendOptions& options)
      : tree_(manager->tree()), options_(options), way_(straightOf(tree_, motion, turns)) {
    planning::SetupOptions setup;
    for (const std::string& name : motion.joints) {
      const int v = plans::variableOf(tree_, name, "the plan");
      variables_.push_back(v);
      const std::string& joint = tree_.joint(tree_.variableJoint(v)).name;
      if (joints_.empty() || std::find(joints_.begin(), joints_.end(), joint) == joints_.end())
        joints_.push_back(joint);
    }
    std::size_t values = 0;
    for (const std::string& joint : joints_) {
      values += static_cast<std::size_t>(tree_.numVariables(tree_.jointId(joint)));
    }
    if (values != variables_.size()) throw std::runtime_error("the plan moves only some of the values of a joint");
    setup.fixed = motion.rest;
    addBounds(setup);
    setup.request.margin = options.request.margin;
    setup.request.check_self = options.request.check_self;
    setup.request.check_scene = options.request.check_scene;
    setup.request.work_budget = options.request.work_budget;
    setup_ = planning::setUpPlanning(manager, joints_, setup);
    request_ = setup.request;
    manager_ = manager;
  }

  Mended run(const plans::PlanMotion& motion) {
    const Clock::time_point begin = Clock::now();
    const std::size_t last = way_.points.size() - 1;
    if (!valid(0))
      throw std::runtime_error("its start touches something, or is beyond its limits: no detour begins there");
    if (!valid(last))
      throw std::runtime_error("its goal touches something, or is beyond its limits: no detour ends there");
    for (std::size_t k = 0; k < last;) {
      if (manager_->isFree(way_.pieces[k], request_)) {
        ++k;
        continue;
      }
      k = replace(k, begin);
    }
    Mended out = assemble(motion);
    out.ms = 1e3 * secondsSince(begin);
    return out;
  }

 private:
  void addBounds(planning::SetupOptions& setup) const {
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

  bool valid(std::size_t k) const {
    const ob::ScopedState<> state = stateOf(way_.points[k]);
    return setup_.si->isValid(state.get());
  }

  /// Finds a way around what the piece from waypoint k on touches.
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
      const double left = options_.seconds - secondsSince(begin);
      if (left < kLeast) break;
      std::optional<Points> points = wider == 0 ? nudge(k, a, b) : std::nullopt;
      if (!points) points = plan(way_.points[a], way_.points[b], whole ? left : left / 4);
      if (points) {
        detours_.resize(first);
        detours_.push_back({a, b, std::move(*points)});
        return b;
      }
      if (whole) break;
    }
    throw std::runtime_error(
        fmt::format("no way around what it touches after waypoint {} was found in {:g} s", k, options_.seconds));
  }

  bool free(const VectorXd& from, const VectorXd& to) const {
    return manager_->isFree(JointMotion::linear(tree_, from, to), request_);
  }

  bool free(const Points& points) const {
    for (const VectorXd& q : points) {
      if (!setup_.space->satisfiesBounds(stateOf(q).get())) return false;
    }
    for (std::size_t i = 1; i < points.size(); ++i) {
      if (!free(points[i - 1], points[i])) return false;
    }
    return true;
  }

  /// Where on the stretch, as a share of its length, something is met first from its begin, or from its end.
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

  /// Tries ways from waypoint a to b that leave the plan by a little, around what is met on them.
  std::optional<Points> nudge(std::size_t k, std::size_t a, std::size_t b) {
    for (const std::string& joint : joints_) {
      if (tree_.quaternionVariable(tree_.jointId(joint)) >= 0) return std::nullopt;
    }
    const Points before(way_.points.begin() + static_cast<std::ptrdiff_t>(a),
                        way_.points.begin() + static_cast<std::ptrdiff_t>(b) + 1);
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
          if (!free(around(1))) continue;
          double good = 1, bad = 0;  // parts of the offset
          for (int halving = 0; halving < kShrinks; ++halving) {
            const double middle = (good + bad) / 2;
            (free(around(middle)) ? good : bad) = middle;
          }
          return around(good);
        }
      }
    }
    return std::nullopt;
  }

  std::optional<Points> plan(const VectorXd& from, const VectorXd& to, double limit) const {
    og::SimpleSetup simple(setup_.si);
    const ob::ScopedState<> start = stateOf(from), goal = stateOf(to);
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

  Mended assemble(const plans::PlanMotion& motion) const {
    Mended out;
    out.detours = detours_.size();
    Points points{way_.points[0]};
    std::vector<double> times{motion.times[0]};
    const auto add = [&](const VectorXd& q, double duration) {
      points.push_back(q);
      times.push_back(times.back() + duration);
    };
    VectorXd turned = VectorXd::Zero(tree_.dof());  // whole turns, by the detours so far
    std::size_t k = 0;
    for (const Detour& detour : detours_) {
      for (; k < detour.begin; ++k) add(way_.points[k + 1] + turned, motion.times[k + 1] - motion.times[k]);
      const auto begin = way_.points.begin() + static_cast<std::ptrdiff_t>(detour.begin),
                 end = way_.points.begin() + static_cast<std::ptrdiff_t>(detour.end);
      const Points before(begin, end + 1);
      const double length = lengthOf(detour.points), old = lengthOf(before);
      const double duration =
          (motion.times[detour.end] - motion.times[detour.begin]) * (old > 0 ? std::max(1.0, length / old) : 1);
      out.deviation = std::max(out.deviation, deviationOf(before, detour.points));
      for (std::size_t i = 1; i < detour.points.size(); ++i) {
        const double step = (detour.points[i] - detour.points[i - 1]).norm();
        if (step > 0) add(detour.points[i] + turned, duration * step / length);
      }
      turned += detour.points.back() - way_.points[detour.end];
      k = detour.end;
    }
    for (; k + 1 < way_.points.size(); ++k) add(way_.points[k + 1] + turned, motion.times[k + 1] - motion.times[k]);
    const double old = lengthOf(way_.points);
    out.length_ratio = old > 0 ? lengthOf(points) / old : 1;
    out.plan.joints = motion.joints;
    if (motion.timed) out.plan.times = times;
    for (const VectorXd& q : points) {
      std::vector<double>& row = out.plan.positions.emplace_back();
      for (const int v : variables_) row.push_back(q[v]);
    }
    out.plan.state = motion.rest;
    return out;
  }

  const KinematicTree& tree_;
  const MendOptions& options_;
  Straight way_;
  std::vector<int> variables_;       ///< of the plan's columns
  std::vector<std::string> joints_;  ///< that these belong to
  planning::PlanningSetup setup_;
  CertifiedRequest request_;
  std::shared_ptr<const ArticulatedCollisionManager> manager_;
  std::vector<Detour> detours_;  ///< in their order, none within another
};

}  // namespace

void requireMending() {}

Mended mend(const std::shared_ptr<const ArticulatedCollisionManager>& manager, const plans::PlanMotion& motion,
            plans::Turns turns, const MendOptions& options) {
  ompl::msg::noOutputHandler();
  try {
    return Mender(manager, motion, turns, options).run(motion);
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(error.what());
  }
}

}  // namespace fcl_artic::app
