// SPDX-License-Identifier: BSD-3-Clause
//
// How far a tool leaves its line: best-first bisection of the time, for the distance and for the angle.
//
// Between two times a and b of a piece, h = b - a, with D1, D2 and W the bounds of boundPath() on speed, acceleration
// and angular speed:
//   - The origin stays within D2 h^2 / 8 of the chord between its places at a and b, point by point. The distance from
//   a
//     segment is convex along the chord, so largest at one of its ends. It also changes by no more than D1 per unit of
//     t.
//   - The nearest point's part s of the segment, of length L, moves no faster than the origin: |s'| <= D1 / L. The
//     orientation that is wanted there turns by no more than |w| D1 / L, w the turn from the first to the last
//     orientation, and the tool's by W. So the angle between them changes by no more than W + |w| D1 / L.
// Rounding: a place is off by e = ulps 2^-52 terms, the ends of the segment too, and the distance's own arithmetic by
// 64 2^-52 terms. s is off by (2e + 2e |p - p0| / L) / L at most, twice that is taken. A rotation matrix is off by ulps
// 2^-52 (Frobenius). |A - B| = 2 sqrt(2) sin(angle / 2) of rotations A and B (Frobenius), so up to sin(angle / 2) =
// 0.95 an angle is off by 2.3 times what A and B are off by together; beyond, it counts as pi. w is rounded: where
// exp(w) leads is `end_gap` from the last orientation, so, as turns of less than pi part no faster than their ends, no
// orientation on the way is off by more than twice that.
#include "fcl_artic/tool_line.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <stdexcept>
#include <string>
#include <vector>

#include "motion/link_motion.h"
#include "numerics/arc_tangent.h"
#include "numerics/constants.h"
#include "numerics/shown.h"

namespace fcl_artic {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kPiUpper = 3.1415926535897936;
constexpr double kToolDefect = 1e-9;    ///< as of other poses that callers give
constexpr double kShortest = 1e-6;      ///< of a line, m
constexpr double kSteep = 0.95;         ///< sine of half of the largest angle (2.5 rad) told from pi
constexpr double kAngleFactor = 2.3;    ///< 2 / sqrt(1 - kSteep^2) / (2 sqrt(2)), rounded up
constexpr double kSlack = 1 + 0x1p-40;  ///< for the rounding of sums and products of bounds
constexpr double kFinest = 0x1p-40;     ///< intervals of time are not divided below this

double sineOfHalf(const Matrix3d& A, const Matrix3d& B) {
  return (A - B).norm() * 0.35355339059327379;  // 1 / (2 sqrt(2))
}
double angleOf(double sine_of_half) {
  const double s = std::min(sine_of_half, kSteep);
  return 2 * arcTangent(s / std::sqrt(1 - s * s));
}

/// One piece of the tool's motion.
struct Way {
  BodyMotion motion;
  PathBounds bounds;
  double begin, end;  ///< in the trajectory's time

  double time(double t) const { return t < 1 ? begin + t * (end - begin) : end; }
};

struct Sample {
  double distance = 0;  ///< as computed
  double angle_upper = kPiUpper, angle_lower = 0;

  bool tellsNoAngle() const { return angle_upper >= kPiUpper; }
};

/// The straight line between two poses.
class Line {
 public:
  explicit Line(const std::vector<Way>& ways) {
    const BodyMotion& first = ways.front().motion;
    const Isometry3d begin = first.pose(0), end = ways.back().motion.pose(1);
    double ulps = 0, terms = 0;
    for (const Way& way : ways) {
      ulps = std::max(ulps, way.bounds.ulps);
      terms = std::max(terms, way.bounds.terms);
    }
    const double place_error = (ulps + 64) * kUlp * terms;
    pad_ = 2 * place_error * kSlack;
    begin_ = begin.translation();
    along_ = end.translation() - begin_;
    length_ = along_.norm();
    if (!(length_ >= kShortest)) {
      throw std::invalid_argument("toolDeviation: the tool ends " + shown(length_) +
                                  " m from where it begins: a line has to be 1e-6 m long at least");
    }
    const Matrix3d turn = begin.linear().transpose() * end.linear();
    const double sine = sineOfHalf(begin.linear(), end.linear());
    far_apart_ = !(sine < kSteep);
    if (far_apart_) return;
    const Vector3d across(turn(2, 1) - turn(1, 2), turn(0, 2) - turn(2, 0), turn(1, 0) - turn(0, 1));
    if (const double size = across.norm(); size > 0) turn_ = across * (angleOf(sine) / size);
    MotionElement& element = wanted_.elements.emplace_back();
    element.kind = MotionElement::Kind::turn;
    element.before = first.poseWithError(0).at(Vector3d::Zero());
    element.coefficients.col(1) = turn_;
    const double rotation_error = (ulps + boundPath(wanted_, 0).ulps) * kUlp;
    const double end_gap =
        angleOf(sineOfHalf(wanted_.pose(1).linear(), end.linear())) + kAngleFactor * rotation_error + 0x1p-48;
    angle_pad_ = (kAngleFactor * rotation_error + 2 * end_gap + 0x1p-48) * kSlack;
    fraction_error_ = 4 * place_error / length_ * kSlack;
  }

  double length() const { return length_; }
  double turned() const { return turn_.norm() * kSlack; }
  /// What a computed distance may be off by.
  double pad() const { return pad_; }

  Sample sampleAt(const Isometry3d& M) const {
    const Vector3d from_begin = M.translation() - begin_;
    const double s = std::min(std::max(from_begin.dot(along_) / (length_ * length_), 0.0), 1.0);
    Sample sample;
    sample.distance = (from_begin - s * along_).norm();
    if (far_apart_) return sample;
    const double sine = sineOfHalf(wanted_.pose(s).linear(), M.linear());
    const double angle = angleOf(sine);
    const double pad = angle_pad_ + turned() * fraction_error_ * (1 + from_begin.norm() / length_) * kSlack;
    sample.angle_upper = sine < kSteep ? std::min(angle + pad, kPiUpper) : kPiUpper;
    sample.angle_lower = std::max(angle - pad, 0.0);
    return sample;
  }

 private:
  Vector3d begin_, along_, turn_ = Vector3d::Zero();
  BodyMotion wanted_;  ///< the orientation at the part s of the way
  double length_, pad_, angle_pad_ = 0, fraction_error_ = 0;
  bool far_apart_ = false;  ///< the orientations at the ends: nothing is said of angles
};

struct Bracketed {
  double lower = 0, upper = 0, time = 0;
  bool narrow = false;
};

class Search {
 public:
  Search(const std::vector<Way>& ways, const Line& line, std::uint64_t budget)
      : ways_(ways), line_(line), budget_(budget) {}

  /// @param lowerOf  of a sample.
  /// @param upperBetween  bound between two samples of a way.
  /// @param ends  whether nothing is to be gained after a sample.
  template <class LowerOf, class UpperBetween, class Ends>
  Bracketed largest(double tolerance, const LowerOf& lowerOf, const UpperBetween& upperBetween, const Ends& ends) {
    Bracketed found;
    std::priority_queue<Interval> open;
    bool ended = false;
    const auto look = [&](const Way& way, double t) {
      const Sample sample = line_.sampleAt(way.motion.pose(t));
      ++looked_;
      ended = ended || ends(sample);
      if (const double lower = lowerOf(sample); lower > found.lower || looked_ == 1) {
        found.lower = lower;
        found.time = way.time(t);
      }
      return sample;
    };
    const auto add = [&](const Way& way, double a, double b, const Sample& at_a, const Sample& at_b) {
      open.push({upperBetween(way, b - a, at_a, at_b), &way, a, b, at_a, at_b});
    };
    found.time = ways_.front().begin;
    for (const Way& way : ways_) add(way, 0, 1, look(way, 0), look(way, 1));
    while (true) {
      const Interval top = open.top();
      found.upper = top.upper;
      const double gap = top.upper - found.lower;
      found.narrow = gap <= tolerance;
      // Where rounding is most of the gap, narrower intervals don't close it.
      const double of_time = top.upper - upperBetween(*top.way, 0, top.at_begin, top.at_end);
      const bool spent = budget_ > 0 && looked_ >= budget_;
      if (found.narrow || ended || spent || of_time <= gap / 4 || top.end - top.begin < kFinest) return found;
      open.pop();
      const double middle = 0.5 * (top.begin + top.end);
      const Sample at_middle = look(*top.way, middle);
      add(*top.way, top.begin, middle, top.at_begin, at_middle);
      add(*top.way, middle, top.end, at_middle, top.at_end);
    }
  }

 private:
  struct Interval {
    double upper;
    const Way* way;
    double begin, end;
    Sample at_begin, at_end;
    bool operator<(const Interval& other) const { return upper < other.upper; }
  };

  const std::vector<Way>& ways_;
  const Line& line_;
  const std::uint64_t budget_;
  std::uint64_t looked_ = 0;
};

void requirePositive(double value, const char* name) {
  if (std::isfinite(value) && value > 0) return;
  throw std::invalid_argument(std::string("request.") + name + " is " + shown(value) + ", not a positive number");
}

LinkId requireLink(const KinematicTree& tree, const LinkRef& link) {
  if (link.byName()) return tree.linkId(link.name());
  if (link.id() >= 0 && link.id() < tree.numLinks()) return link.id();
  throw std::out_of_range("toolDeviation: robot '" + tree.name() + "' has no link " + std::to_string(link.id()));
}

ToolDeviation find(std::vector<Way> ways, const ToolLineRequest& request) {
  for (Way& way : ways) way.bounds = boundPath(way.motion, way.motion.after.length());
  const Line line(ways);
  Search distances(ways, line, request.work_budget), angles(ways, line, request.work_budget);
  const Bracketed distance = distances.largest(
      request.tolerance_distance, [&](const Sample& s) { return std::max(s.distance - line.pad(), 0.0); },
      [&](const Way& way, double h, const Sample& a, const Sample& b) {
        const double by_chord = std::max(a.distance, b.distance) + way.bounds.acceleration * h * h / 8;
        const double by_speed = 0.5 * (a.distance + b.distance + way.bounds.speed * h);
        return (std::min(by_chord, by_speed) + line.pad()) * kSlack;
      },
      [](const Sample&) { return false; });
  const Bracketed angle = angles.largest(
      request.tolerance_angle, [](const Sample& s) { return s.angle_lower; },
      [&](const Way& way, double h, const Sample& a, const Sample& b) {
        const double rate = way.bounds.angular_speed + line.turned() * way.bounds.speed / line.length();
        return std::min(0.5 * (a.angle_upper + b.angle_upper + rate * h) * kSlack, kPiUpper);
      },
      [](const Sample& s) { return s.tellsNoAngle(); });
  ToolDeviation out;
  out.distance_lower = distance.lower;
  out.distance_upper = distance.upper;
  out.distance_time = distance.time;
  out.angle_lower = angle.lower;
  out.angle_upper = angle.upper;
  out.angle_time = angle.time;
  out.length = line.length();
  out.within_tolerance = distance.narrow && angle.narrow;
  return out;
}

/// Adds motions of the tool, one after the other.
class WayMaker {
 public:
  WayMaker(const KinematicTree& tree, const LinkRef& link, const ToolLineRequest& request)
      : tree_(tree),
        link_(requireLink(tree, link)),
        tool_(requireRigid(request.tool, kToolDefect, [] { return std::string("request.tool"); })) {
    requirePositive(request.tolerance_distance, "tolerance_distance");
    requirePositive(request.tolerance_angle, "tolerance_angle");
  }
  void add(const JointMotion& motion, double begin, double end) {
    motion.requirePolynomial("toolDeviation()");
    ways.push_back({linkMotion(tree_, motion, link_, tool_), {}, begin, end});
  }
  std::vector<Way> ways;

 private:
  const KinematicTree& tree_;
  const LinkId link_;
  const RigidTransform tool_;
};

}  // namespace

ToolDeviation toolDeviation(const KinematicTree& tree, const JointMotion& motion, const LinkRef& link,
                            const ToolLineRequest& request) {
  motion.requireOf(tree, "toolDeviation: the motion");
  WayMaker maker(tree, link, request);
  maker.add(motion, 0, 1);
  return find(std::move(maker.ways), request);
}

ToolDeviation toolDeviation(const KinematicTree& tree, const JointTrajectory& trajectory, const LinkRef& link,
                            const ToolLineRequest& request) {
  trajectory.requireOf(tree);
  WayMaker maker(tree, link, request);
  for (std::size_t k = 0; k < trajectory.numPieces(); ++k) {
    maker.add(trajectory.piece(k), trajectory.times()[k], trajectory.times()[k + 1]);
  }
  return find(std::move(maker.ways), request);
}

}  // namespace fcl_artic
