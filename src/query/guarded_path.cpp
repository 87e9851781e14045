// SPDX-License-Identifier: BSD-3-Clause
#include "query/guarded_path.h"

#include <algorithm>
#include <cmath>

#include "kinematics/exact_motion.h"

namespace fcl_artic {
namespace {

/// Bounds how far a polynomial's derivative goes on [at - w, at + w]: by its Taylor series at the middle.
double largestSlope(const Eigen::MatrixXd& c, Eigen::Index row, double at, double w) {
  double sum = 0, factorial = 1, power = 1;
  for (Eigen::Index k = 1; k < c.cols(); ++k) {  // the k-th derivative at the middle, over (k - 1)!, times w^(k - 1)
    double derivative = 0;
    for (Eigen::Index j = c.cols() - 1; j >= k; --j) {
      double falling = 1;
      for (Eigen::Index i = 0; i < k; ++i) falling *= static_cast<double>(j - i);
      derivative = derivative * at + falling * c(row, j);
    }
    sum += std::abs(derivative) * power / factorial;
    power *= w;
    factorial *= static_cast<double>(k);
  }
  return sum;
}

}  // namespace

GuardedPath::GuardedPath(const JointTrajectory& trajectory, const KinematicTree& tree,
                         const Eigen::VectorXd& deceleration)
    : trajectory_(trajectory), bins_(kBins * trajectory.numPieces()) {
  const Eigen::Index dof = trajectory.size();
  rates_.setZero(dof, static_cast<Eigen::Index>(bins_.size()));
  part_error_.setZero(dof);
  largest_.setZero(dof);
  for (std::size_t k = 0; k < trajectory.numPieces(); ++k) measurePiece(k);
  // A joint with a quaternion turns as fast as its rotation vector changes, or slower, but perhaps about another axis.
  for (const JointId j : tree.quaternionJoints()) {
    auto turns = rates_.middleRows(tree.quaternionVariable(j), 3);
    for (Eigen::Index b = 0; b < turns.cols(); ++b) turns.col(b).setConstant(kUp * turns.col(b).norm());
  }
  for (Eigen::Index b = 0; b < rates_.cols(); ++b) {
    double& braking = bins_[static_cast<std::size_t>(b)].braking;
    for (Eigen::Index v = 0; v < dof; ++v) {
      if (rates_(v, b) > 0) braking = std::min(braking, deceleration[v] / rates_(v, b));
    }
  }
}

/// Bounds how fast and how far a piece goes, bin by bin. An angle by the tangent of its half changes by at most twice
/// as much as the tangent.
void GuardedPath::measurePiece(std::size_t k) {
  const JointMotion& piece = trajectory_.piece(k);
  const double begin = trajectory_.times()[k], duration = trajectory_.times()[k + 1] - begin;
  const Eigen::MatrixXd& c = piece.variables();
  auto& part = parts_.at(static_cast<std::size_t>(c.cols()));
  if (!part) part = piece;
  for (Eigen::Index v = 0; v < c.rows(); ++v) {
    const bool half_angle = !piece.isPolynomial() && piece.halfAngles()[static_cast<std::size_t>(v)];
    const double factor = half_angle ? 2 : 1, sum = c.row(v).cwiseAbs().sum();
    // As PartError has it: for polynomials up to the fifth degree 24 ulps of the sum, and once more for all else.
    part_error_[v] = std::max(part_error_[v], 2 * factor * 24 * 0x1p-52 * sum);
    largest_[v] = std::max(largest_[v], kUp * (half_angle ? 4 + std::abs(piece.references()[v]) : sum));
    for (std::size_t i = 0; i < kBins; ++i) {
      constexpr double kWidth = 1.0 / kBins;
      const auto b = static_cast<Eigen::Index>(kBins * k + i);
      const double slope = largestSlope(c, v, (static_cast<double>(i) + 0.5) * kWidth, 0.5 * kWidth + 0x1p-40);
      // (A variable that stands still has no terms that could be rounded.)
      if (slope > 0) rates_(v, b) = factor * (slope * kUp + 0x1p-45 * sum) / duration * kUp;
      bins_[static_cast<std::size_t>(b)].begin = begin + duration * static_cast<double>(i) * kWidth;
    }
  }
}

std::size_t GuardedPath::pieceAt(double time) const {
  const std::vector<double>& times = trajectory_.times();
  const auto after = std::upper_bound(times.begin() + 1, times.end() - 1, time);
  return static_cast<std::size_t>(after - times.begin()) - 1;
}

/// No bin before it has a part of what is at a time or later. Begins are rounded, by less than the last bit of a time:
/// bins that are shorter than that begin at the same time. So a time's bin is, of all that begin before it, the last
/// one or the one before that.
std::size_t GuardedPath::binAt(double time) const {
  const auto first =
      std::lower_bound(bins_.begin(), bins_.end(), time, [](const Bin& bin, double t) { return bin.begin < t; });
  const auto bin = static_cast<std::size_t>(first - bins_.begin());
  return bin > 2 ? bin - 2 : 0;
}

/// f(b) for all bins of a range, and for one more at either end.
template <class F>
void GuardedPath::forEachBin(double from, double to, const F& f) const {
  bool last = false;
  for (std::size_t b = binAt(from); b < bins_.size() && !last; ++b) {
    f(b);
    last = bins_[b].begin > to;
  }
}

double GuardedPath::brakingOver(double from, double to) const {
  double least = std::numeric_limits<double>::infinity();
  forEachBin(from, to, [&](std::size_t b) { least = std::min(least, bins_[b].braking); });
  return least;
}

double GuardedPath::fastestOver(double from, double to, const Eigen::VectorXd& weight) const {
  double most = 0;
  forEachBin(from, to,
             [&](std::size_t b) { most = std::max(most, kUp * weight.dot(rates_.col(static_cast<Eigen::Index>(b)))); });
  return most;
}

const JointMotion& GuardedPath::partOf(std::size_t piece, const TimePart& part) {
  const JointMotion& whole = trajectory_.piece(piece);
  if (part.whole()) return whole;
  JointMotion& own = *parts_[static_cast<std::size_t>(whole.variables().cols())];
  own = whole;
  takePart(part, ExactMotion::variables(own));
  return own;
}

}  // namespace fcl_artic
