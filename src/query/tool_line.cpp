// SPDX-License-Identifier: BSD-3-Clause
//
// Finds how far a tool leaves its path, by bisection of the time, for the distance and for the angle together.
//
// A path is the way of a pose over its part s in [0, 1]. The origin p(s) goes straight, or about an axis by the angle
// phi, at the constant speed L. On an arc the axes turn with the origin. They also turn by w, the shortest rotation
// that is then left at the end, seen from there. k is the curvature, 0 or 1 / r. A pose of the tool has three numbers:
// the part s of the path's nearest point, its distance d from p(s), and the angle between its axes and the axes at
// p(s).
//
// Between two times a and b of a piece, h = b - a, with D1, D2 and W the bounds of boundPath() on speed, acceleration
// and angular speed:
//   - The origin stays within D2 h^2 / 8 of the chord between its places at a and b, point by point. A second chord
//     goes from p(s_a) to p(s_b). By the triangle inequality, points at the same part of the two chords are at most
//     max(d_a, d_b) apart. The path between p(s_a) and p(s_b) is nowhere farther from the second chord than the arc's
//     height, (1 - cos(phi (s_a - s_b) / 2)) / k <= L^2 k (s_a - s_b)^2 / 8. Besides, a distance changes by at most D1
//     per unit of t.
//   - A point that is nearer to the path than the path's reach has one nearest point on it. The reach of an arc is r,
//     the distance of its axis. If the arc is more than half a circle, its reach is r sin(phi / 2), half of the
//     distance between its ends. A point in the gap that is as far from one end as from the other is at least that far
//     from them. The origin is at least r - d from the axis, so
//     |s'| <= D1 / (L (1 - k d)). Elsewhere s may jump, by 1 at most. The wanted orientation turns by at most (phi +
//     |w|) |s'|, and the tool's by W. The angle between them changes by at most the sum. Bounded from a and from b, the
//     angle is at most the mean of both bounds. The change of s is a concave function of time, so its value at h / 2
//     bounds it.
//
// Rounding: a place is off by e = ulps 2^-52 terms, and a place of the path, and sums, by as much of theirs. A rotation
// matrix is off by ulps 2^-52 (Frobenius). Rotations A and B have |A - B| = 2 sqrt(2) sin(angle / 2) (Frobenius). So up
// to sin(angle / 2) = 0.95 an angle is off by at most 2.3 times the sum of the errors of A and B. A larger angle counts
// as pi. w is rounded: the orientation to which it leads is `end_gap` from the last one. Two turns of less than 2.6 rad
// are on the way at most 1.4 times as far from each other as at the end. So no orientation on the way is off by more
// than twice that.
//
// The path of the code begins where the computed origin does, and passes within eps of where the true tool begins and
// ends, and of the via point. Let these three points go straight to the true ones, in a unit of time, and the path with
// them. A distance from the path changes as fast as the nearest point goes across it, or no faster than an end goes.
// A line goes across itself by eps at most. The points of a circle, t their angle, go across it, in its plane and out
// of it, by trigonometric polynomials of degree 1. So they are those of the three points i, each times sin((t - t_j) /
// 2) sin((t - t_k) / 2) / (sin((t_i - t_j) / 2) sin((t_i - t_k) / 2)), a quotient of products of chords. With D = min(2
// r, L), which no chord exceeds, and Q the sum of 1 / (a b) over the pairs of the triangle's sides, a distance changes
// by D^2 Q eps at most. The centre c and the normal n, in the plane, go as
//   (p_i - p_0) c' = (p_i - c) p_i' - (p_0 - c) p_0', which is 2 r eps at most, and (p_i - p_0) n' = n (p_0' - p_i').
// The matrix of two sides a and b has an inverse of (a^2 + b^2)^(1/2) / |a x b| at most, and |a x b| is the product of
// all sides over 2 r. So |c'| <= K eps and |n'| <= K eps / r, K = 8 r^2 Q. A point x at rho from the axis and z out of
// the plane turns about the axis by (|x'| + |c'| + |z n'|) / rho. So phi changes by 2 (1 + K) eps / r, and s by
//   ((1 + 2 K) eps / (r - d) + (1 + K) eps / r) / phi <= (2 + 3 K) eps / (L (1 - k d)).
// On a line, s is (x - p_0) (p_1 - p_0) / L^2, and changes by (4 + 2 d / L) eps / L. Sides, r, L and d here are those
// at the time. As eps is below a thousandth of all sides, and (1 + K) eps of r and L, and d below 0.9 of the reach, 5 %
// are room enough for that.
#include "fcl_artic/tool_line.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <stdexcept>
#include <string>
#include <vector>

#include "kinematics/angles.h"
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
constexpr double kShortest = 1e-6;      ///< of a path, and of a triangle of an arc's points, m
constexpr double kFlattestArc = 1e3;    ///< radius over the longest side of that triangle
constexpr double kSteep = 0.95;         ///< sine of half of the largest angle (2.5 rad) that does not count as pi
constexpr double kAngleFactor = 2.3;    ///< 2 / sqrt(1 - kSteep^2) / (2 sqrt(2)), rounded up
constexpr double kSlack = 1 + 0x1p-40;  ///< for the rounding of sums and products of bounds
constexpr double kFinest = 0x1p-40;     ///< intervals of time are not divided below this
constexpr double kNear = 0.9;           ///< part of a path's reach where the nearest point is looked at
constexpr double kRoom = 1.05;          ///< for paths that are a little off
constexpr double kOffMost = 1e-3;       ///< eps over the triangle's sides, (1 + K) eps over r and L

double sineOfHalf(const Matrix3d& A, const Matrix3d& B) {
  return (A - B).norm() * 0.35355339059327379;  // 1 / (2 sqrt(2))
}
double angleOf(double sine_of_half) {
  const double s = std::min(sine_of_half, kSteep);
  return 2 * arcTangent(s / std::sqrt(1 - s * s));
}

/// One piece of the tool's motion.
struct ToolPiece {
  BodyMotion motion;
  PathBounds bounds;
  double begin, end;  ///< in the trajectory's time

  double time(double t) const { return t < 1 ? begin + t * (end - begin) : end; }
};

struct Sample {
  double part = 0;      ///< of the path, of the point that is nearest
  double distance = 0;  ///< as computed
  double angle_upper = kPiUpper, angle_lower = 0;
  bool blind = true;  ///< nothing is known of the angle
};

/// The angle from the first to the second of two perpendicular coordinates, in [0, 2 pi).
double fullAngle(double x, double y) {
  const double size = std::sqrt(x * x + y * y);
  if (!(size > 0)) return 0;
  double angle = 2 * arcTangent(std::abs(y) / (size + std::abs(x)));
  if (x < 0) angle = kPi - angle;
  return y < 0 ? 2 * kPi - angle : angle;
}

/// A circle through three points.
struct Circle {
  Vector3d center;
  UnitVector normal;  ///< the points follow each other to the left about it
};
Circle circleThrough(const Vector3d& p0, const Vector3d& via, const Vector3d& p1) {
  const auto requireApart = [&](const char* end, const Vector3d& p) {
    if ((via - p).norm() >= kShortest) return;
    throw std::invalid_argument("toolDeviation: request.via is " + shown((via - p).norm()) + " m from the tool's " +
                                end + ": an arc needs three points, 1e-6 m apart at least");
  };
  requireApart("begin", p0);
  requireApart("end", p1);
  const Vector3d a = p1 - p0, b = via - p0, across = b.cross(a);
  const std::optional<UnitVector> normal = UnitVector::within3Ulps(across);
  const Vector3d to_center = (b.squaredNorm() * a - a.squaredNorm() * b).cross(across) / (2 * across.squaredNorm());
  const double longest = std::max({a.norm(), b.norm(), (p1 - via).norm()});
  if (normal && to_center.norm() <= kFlattestArc * longest) return {p0 + to_center, *normal};
  throw std::invalid_argument(
      "toolDeviation: request.via is nearly on a straight line with the tool's begin and end: no arc bends so little "
      "(a radius above 1000 times their largest distance); without via the path is the straight line");
}

/// The path that the tool has to follow.
class ToolPath {
 public:
  /// @throws std::invalid_argument
  ToolPath(const std::vector<ToolPiece>& ways, const std::optional<Vector3d>& via) {
    const BodyMotion& first = ways.front().motion;
    const Isometry3d begin = first.pose(0), end = ways.back().motion.pose(1);
    double ulps = 0, terms = 0;
    for (const ToolPiece& piece : ways) {
      ulps = std::max(ulps, piece.bounds.ulps);
      terms = std::max(terms, piece.bounds.terms);
    }
    begin_ = begin.translation();
    const double direct = (end.translation() - begin_).norm();
    if (!(direct >= kShortest)) {
      throw std::invalid_argument("toolDeviation: the tool ends " + shown(direct) +
                                  " m from where it begins: a path has to go 1e-6 m away at least");
    }
    const RigidTransform oriented = first.poseWithError(0).at(Vector3d::Zero());
    if (via) {
      goAbout(circleThrough(begin_, *via, end.translation()), end.translation(), oriented);
    } else {
      goStraight(end.translation(), oriented);
    }
    const PathBounds own = boundPath(wanted_, 0);
    const double place_error = (ulps + 64) * kUlp * terms, own_error = (own.ulps + 64) * kUlp * (own.terms + terms);
    const auto gapAt = [&](double part, const Vector3d& p) { return (wanted_.pose(part).translation() - p).norm(); };
    const double off =
        (place_error + 2 * own_error + std::max(gapAt(1, end.translation()), via ? gapAt(partOf(*via), *via) : 0)) *
        kSlack;
    double spread = 1, condition = 0, least = length_, side = direct;  // D^2 Q, K
    if (via) {
      const double a = direct, b = (*via - begin_).norm(), c = (end.translation() - *via).norm();
      const double q = 1 / (a * b) + 1 / (b * c) + 1 / (a * c), across = std::min(2 / curvature_, length_);
      spread = kRoom * across * across * q;
      condition = 8 * q / (curvature_ * curvature_);
      least = std::min(length_, 1 / curvature_);
      side = std::min({a, b, c});
    }
    if (!((1 + condition) * off <= kOffMost * least && off <= kOffMost * side)) {
      throw std::invalid_argument("toolDeviation: the path's points are known to " + shown(off) +
                                  " m, which is too little for a path so small: they have to be farther apart, or "
                                  "nearer to the world's origin");
    }
    pad_ = (place_error + own_error + spread * off) * kSlack;
    part_error_ = kRoom * (4 + 3 * condition) * off / length_;
    setTurn(end, ulps, kRoom * curvature_ * (2 + 4 * condition) * off);
  }

  double length() const { return length_; }
  /// Bound on the error of a computed distance.
  double pad() const { return pad_; }
  /// Bound on the height of the arc over its chord between two parts of the path.
  double bowBetween(double a, double b) const { return length_ * length_ * curvature_ * (a - b) * (a - b) / 8 * kRoom; }
  /// Bound on the rotation that is wanted while the origin goes by `gone`, nowhere farther than that from the path.
  double turnAlong(double gone, double distance) const {
    if (!(distance < kNear * reach_)) return turned_;
    return std::min(kRoom * gone / (length_ * (1 - curvature_ * distance)), 1.0) * turned_;
  }

  Sample sampleAt(const Isometry3d& M) const {
    Sample sample;
    sample.part = partOf(M.translation());
    const Isometry3d wanted = wanted_.pose(sample.part);
    sample.distance = (M.translation() - wanted.translation()).norm();
    const double sine = sineOfHalf(wanted.linear(), M.linear());
    sample.blind = far_apart_ || !(sine < kSteep);
    if (far_apart_) return sample;
    const double distance = sample.distance + pad_, angle = angleOf(sine);
    const double pad = angle_pad_ + turnAlong(part_error_ * (length_ + distance), distance);
    if (!sample.blind) sample.angle_upper = std::min(angle + pad, kPiUpper);
    sample.angle_lower = std::max(angle - pad, 0.0);
    return sample;
  }

 private:
  void goStraight(const Vector3d& end, const RigidTransform& oriented) {
    MotionElement& slide = wanted_.elements.emplace_back();
    slide.kind = MotionElement::Kind::slide;
    slide.before = RigidTransform(Rotation(), begin_);
    axis_ = end - begin_;
    slide.coefficients.col(1) = axis_;
    length_ = axis_.norm();
    addTurn(oriented);
  }
  void goAbout(const Circle& circle, const Vector3d& end, const RigidTransform& oriented) {
    center_ = circle.center;
    axis_ = circle.normal;
    const double radius = (begin_ - center_).norm();
    angle_ = anglePast(end);
    curvature_ = 1 / radius;
    length_ = radius * angle_;
    reach_ = angle_ > kPi ? 0.5 * (end - begin_).norm() : radius;
    MotionElement& turn = wanted_.elements.emplace_back();
    turn.kind = MotionElement::Kind::revolute;
    turn.before = RigidTransform(Rotation(), center_);
    turn.axis = circle.normal;
    turn.coefficients(0, 1) = angle_;
    addTurn(oriented.at(begin_ - center_));
  }
  void addTurn(const RigidTransform& before) {
    MotionElement& turn = wanted_.elements.emplace_back();
    turn.kind = MotionElement::Kind::turn;
    turn.before = before;
  }
  /// Sets the rotation that is left at the end.
  /// @param ulps  of a pose of the tool.
  /// @param swing  error of the frame that goes along the path, rad.
  void setTurn(const Isometry3d& end, double ulps, double swing) {
    const Matrix3d carried = wanted_.pose(1).linear();
    const double sine = sineOfHalf(carried, end.linear());
    far_apart_ = !(sine < kSteep);
    turned_ = angle_;
    if (far_apart_) return;
    const Matrix3d left = carried.transpose() * end.linear();
    const Vector3d across(left(2, 1) - left(1, 2), left(0, 2) - left(2, 0), left(1, 0) - left(0, 1));
    Vector3d turn = Vector3d::Zero();
    if (const double size = across.norm(); size > 0) turn = across * (angleOf(sine) / size);
    wanted_.elements[1].coefficients.col(1) = turn;
    turned_ = (angle_ + turn.norm()) * kSlack;
    const double of_rotations = kAngleFactor * (ulps + boundPath(wanted_, 0).ulps) * kUlp;
    const double end_gap = angleOf(sineOfHalf(wanted_.pose(1).linear(), end.linear())) + of_rotations + swing + 0x1p-48;
    angle_pad_ = (of_rotations + 2 * end_gap + swing + 0x1p-48) * kSlack;
  }

  /// The angle from the arc's begin to x about the arc's axis, in [0, 2 pi).
  double anglePast(const Vector3d& x) const {
    const Vector3d from = begin_ - center_, to = x - center_;
    return fullAngle(from.dot(to), axis_.dot(from.cross(to)));
  }
  /// The part of the path that has been gone at the point nearest to x.
  double partOf(const Vector3d& x) const {
    if (curvature_ == 0) return std::min(std::max((x - begin_).dot(axis_) / axis_.squaredNorm(), 0.0), 1.0);
    const double angle = anglePast(x);
    if (angle <= angle_) return angle / angle_;
    return angle - angle_ < 2 * kPi - angle ? 1 : 0;
  }

  BodyMotion wanted_;                  ///< the pose that is wanted at the part s of the path
  Vector3d begin_;                     ///< where it begins
  Vector3d axis_;                      ///< of an arc; of a line all of the way
  Vector3d center_;                    ///< of an arc
  double angle_ = 0, curvature_ = 0;   ///< of an arc
  double reach_ = kInfinity, length_;  ///< m
  double pad_, angle_pad_ = 0;
  double part_error_;  ///< of a part of the path, at the path
  double turned_;      ///< the orientation that is wanted, all along the path
  bool far_apart_;     ///< the orientations at the ends: nothing is said of angles
};

/// Part of a piece.
struct Stretch {
  const ToolPiece* piece;
  double begin, end;
  Sample at_begin, at_end;
};

/// Brackets the largest value over all time: samples give lower bounds, stretches of time upper ones. A search has one
/// of these for the distance and one for the angle.
class Largest {
 public:
  double lower = 0, upper = 0, time = 0;
  bool narrow = false;
  bool done = false;  ///< nothing is to be gained from more samples

  explicit Largest(double tolerance) : tolerance_(tolerance) {}
  void see(double value, double t) {
    if (seen_ && !(value > lower)) return;
    seen_ = true;
    lower = value;
    time = t;
  }
  /// Says that no sample can raise the lower bound.
  void giveUp() { blind_ = true; }
  /// @param bound  over stretch number `stretch`.
  /// @param of_time  the part of the bound that narrower stretches lessen: the rest is rounding.
  void add(double bound, double of_time, std::size_t stretch, double end) {
    open_.push({bound, of_time, stretch, end});
  }
  void update(const std::vector<Stretch>& stretches) {
    while (stretches[open_.top().stretch].end != open_.top().end) open_.pop();  // divided
    const StretchBound& top = open_.top();
    upper = top.bound;
    const double gap = upper - lower;
    narrow = gap <= tolerance_;
    const Stretch& widest = stretches[top.stretch];
    done = narrow || blind_ || top.of_time <= gap / 4 || widest.end - widest.begin < kFinest;
  }
  std::size_t widest() const { return open_.top().stretch; }

 private:
  struct StretchBound {
    double bound, of_time;
    std::size_t stretch;
    double end;
    bool operator<(const StretchBound& other) const { return bound < other.bound; }
  };
  std::priority_queue<StretchBound> open_;
  const double tolerance_;
  bool seen_ = false, blind_ = false;
};

class ToolSearch {
 public:
  Largest distance, angle;

  ToolSearch(const std::vector<ToolPiece>& ways, const ToolPath& path, const ToolLineRequest& request)
      : distance(request.tolerance_distance), angle(request.tolerance_angle), path_(path) {
    for (const ToolPiece& piece : ways) {
      stretches_.push_back({&piece, 0, 1, sampleAt(piece, 0), sampleAt(piece, 1)});
      bound(stretches_.size() - 1);
    }
    bool last_distance = false;
    while (true) {
      distance.update(stretches_);
      angle.update(stretches_);
      const bool spent = request.work_budget > 0 && looked_ >= request.work_budget;
      if (spent || (distance.done && angle.done)) return;
      last_distance = angle.done || (!distance.done && !last_distance);  // in turns
      divide(last_distance ? distance.widest() : angle.widest());
    }
  }

 private:
  Sample sampleAt(const ToolPiece& piece, double t) {
    const Sample sample = path_.sampleAt(piece.motion.pose(t));
    ++looked_;
    distance.see(std::max(sample.distance - path_.pad(), 0.0), piece.time(t));
    angle.see(sample.angle_lower, piece.time(t));
    if (sample.blind) angle.giveUp();
    return sample;
  }
  void bound(std::size_t number) {
    const auto& [piece, begin, end, a, b] = stretches_[number];
    const double h = end - begin, gone = piece->bounds.speed * h, most = std::max(a.distance, b.distance);
    const double by_chord = most + piece->bounds.acceleration * h * h / 8 + path_.bowBetween(a.part, b.part);
    const double by_speed = 0.5 * (a.distance + b.distance + gone);
    const double distance_bound = (std::min(by_chord, by_speed) + path_.pad()) * kSlack;
    distance.add(distance_bound, distance_bound - (most + path_.pad()), number, end);
    const double turned = 0.5 * piece->bounds.angular_speed * h + path_.turnAlong(0.5 * gone, distance_bound);
    const double angle_bound = std::min((0.5 * (a.angle_upper + b.angle_upper) + turned) * kSlack, kPiUpper);
    angle.add(angle_bound, angle_bound - std::max(a.angle_upper, b.angle_upper), number, end);
  }
  void divide(std::size_t number) {
    Stretch left = stretches_[number], right = left;
    left.end = right.begin = 0.5 * (left.begin + left.end);
    left.at_end = right.at_begin = sampleAt(*left.piece, left.end);
    stretches_[number] = left;
    stretches_.push_back(right);
    bound(number);
    bound(stretches_.size() - 1);
  }

  const ToolPath& path_;
  std::vector<Stretch> stretches_;
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

ToolDeviation find(std::vector<ToolPiece> ways, const ToolLineRequest& request) {
  for (ToolPiece& piece : ways) piece.bounds = boundPath(piece.motion, piece.motion.after.length());
  const ToolPath path(ways, request.via);
  const ToolSearch found(ways, path, request);
  ToolDeviation out;
  out.distance_lower = found.distance.lower;
  out.distance_upper = found.distance.upper;
  out.distance_time = found.distance.time;
  out.angle_lower = found.angle.lower;
  out.angle_upper = found.angle.upper;
  out.angle_time = found.angle.time;
  out.length = path.length();
  out.within_tolerance = found.distance.narrow && found.angle.narrow;
  return out;
}

/// Makes the tool's motions, one after the other.
class WayMaker {
 public:
  WayMaker(const KinematicTree& tree, const LinkRef& link, const ToolLineRequest& request)
      : tree_(tree),
        link_(requireLink(tree, link)),
        tool_(requireRigid(request.tool, kToolDefect, [] { return std::string("request.tool"); })) {
    requirePositive(request.tolerance_distance, "tolerance_distance");
    requirePositive(request.tolerance_angle, "tolerance_angle");
    if (request.via && !(request.via->cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <= kFarthest)) {
      throw std::invalid_argument("request.via is not finite, or beyond 1e9 m");
    }
  }
  void add(const JointMotion& motion, double begin, double end) {
    motion.requirePolynomial("toolDeviation()");
    ways.push_back({linkMotion(tree_, motion, link_, tool_), {}, begin, end});
  }
  std::vector<ToolPiece> ways;

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
