// SPDX-License-Identifier: BSD-3-Clause
//
// The way out of a body that is in another one: the expanding polytope (van den Bergen 2001) about the origin of the
// difference W = B - A. A report: nothing is proven with it.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

namespace fcl_artic {

/// The unit direction n along which B leaves A with the least translation: of all n that are looked at, the one along
/// which min over W of n . w is largest. It is never worse than `given` is.
/// @tparam Lowest  lowest(n): the point of W that is least along n.
template <class Lowest>
class LeastDepth {
 public:
  /// @param given  a unit direction.
  /// @param towards  of two opposite directions that are as good, as those across flat pieces, the one along this.
  LeastDepth(const Lowest& lowest, const Eigen::Vector3d& given, const Eigen::Vector3d& towards)
      : lowest_(lowest), best_(given), towards_(towards) {
    look(given);
    if (begin()) expand();
  }

  const Eigen::Vector3d& direction() const { return best_; }

 private:
  using Vector3d = Eigen::Vector3d;
  // For curved bodies a polytope of so many corners errs in its normals by about 1 / kMaxCorners rad.
  static constexpr int kMaxCorners = 96, kMaxFaces = 4 * kMaxCorners;
  static constexpr double kFlat = 1e-12;   // of W's size: what it is thinner than is rounding
  static constexpr double kFound = 1e-10;  // the same: no corner lies beyond a face by more

  struct Face {
    int corners[3];
    Vector3d normal;  ///< unit, outward
    double distance;  ///< of its plane from the origin; < 0: the origin lies beyond it
  };

  Vector3d look(const Vector3d& n) {
    const Vector3d w = lowest_(n);
    const double gap = n.dot(w), tie = kFlat * w.norm();
    const bool rather = n.dot(towards_) > best_.dot(towards_);
    if (gap > gap_ + tie || (rather && gap > gap_ - tie)) {
      gap_ = gap;
      best_ = n;
    }
    return w;
  }

  /// The first four corners; false where W is flat or thinner, and has been looked at from both sides.
  bool begin() {
    Vector3d tips[6];
    for (int i = 0; i < 6; ++i) tips[i] = look((i & 1 ? -1 : 1) * Vector3d::Unit(i / 2));
    int a = 0, b = 1;
    for (int i = 0; i < 6; ++i) {
      size_ = std::max(size_, tips[i].norm());
      for (int j = i + 1; j < 6; ++j) {
        if ((tips[j] - tips[i]).squaredNorm() > (tips[b] - tips[a]).squaredNorm()) a = i, b = j;
      }
    }
    const Vector3d edge = tips[b] - tips[a];
    if (edge.norm() <= kFlat * size_) return false;
    int c = -1;
    double most = kFlat * size_ * edge.norm();
    for (int i = 0; i < 6; ++i) {
      const double area = edge.cross(tips[i] - tips[a]).norm();
      if (area > most) most = area, c = i;
    }
    const Vector3d across = c < 0 ? edge.unitOrthogonal() : edge.cross(tips[c] - tips[a]).normalized();
    const Vector3d ends[2] = {look(across), look(-across)};
    const double heights[2] = {across.dot(ends[0] - tips[a]), across.dot(ends[1] - tips[a])};
    const int far = std::abs(heights[1]) > std::abs(heights[0]);
    if (c < 0 || std::abs(heights[far]) <= kFlat * size_) return false;
    for (const Vector3d& tip : {tips[a], tips[b], tips[c], ends[far]}) corners_[num_corners_++] = tip;
    middle_ = 0.25 * (corners_[0] + corners_[1] + corners_[2] + corners_[3]);
    add(0, 1, 2), add(0, 1, 3), add(0, 2, 3), add(1, 2, 3);
    return true;
  }

  /// A face whose normal points away from the first corners' middle.
  void add(int a, int b, int c) {
    if (num_faces_ == kMaxFaces) return;
    Face& face = faces_[num_faces_++];
    Vector3d n = (corners_[b] - corners_[a]).cross(corners_[c] - corners_[a]);
    const double area = n.norm();
    const bool inward = n.dot(corners_[a] - middle_) < 0;
    face = {{a, inward ? c : b, inward ? b : c}, n, std::numeric_limits<double>::infinity()};
    if (!(area > kFlat * size_ * size_)) return;  // a sliver: never the nearest
    face.normal = (inward ? -n : n) / area;
    face.distance = face.normal.dot(corners_[a]);
  }

  void expand() {
    while (num_corners_ < kMaxCorners && num_faces_ < kMaxFaces) {
      int nearest = 0;
      for (int f = 1; f < num_faces_; ++f) nearest = faces_[f].distance < faces_[nearest].distance ? f : nearest;
      const Face face = faces_[nearest];
      if (!(face.distance < std::numeric_limits<double>::infinity())) return;
      const Vector3d tip = look(-face.normal);
      if (face.normal.dot(tip) - face.distance <= kFound * size_) return;
      if (!replaceSeen(tip)) return;
    }
  }

  /// Replaces the faces that a new corner sees by those from it to their border.
  bool replaceSeen(const Vector3d& tip) {
    int border[kMaxFaces][2], num_border = 0, kept = 0;
    for (int f = 0; f < num_faces_; ++f) {
      const Face face = faces_[f];
      const bool seen = face.distance < std::numeric_limits<double>::infinity() &&
                        face.normal.dot(tip) - face.distance > 0.1 * kFound * size_;
      if (!seen) {
        faces_[kept++] = face;
        continue;
      }
      for (int k = 0; k < 3; ++k) {
        const int from = face.corners[k], to = face.corners[(k + 1) % 3];
        int same = 0;
        while (same < num_border && !(border[same][0] == to && border[same][1] == from)) ++same;
        if (same < num_border) {
          --num_border;
          border[same][0] = border[num_border][0], border[same][1] = border[num_border][1];
        } else if (num_border < kMaxFaces) {
          border[num_border][0] = from, border[num_border][1] = to;
          ++num_border;
        }
      }
    }
    num_faces_ = kept;
    const int corner = num_corners_++;
    corners_[corner] = tip;
    for (int e = 0; e < num_border; ++e) add(border[e][0], border[e][1], corner);
    return num_border > 0;
  }

  const Lowest& lowest_;
  Vector3d best_, towards_, middle_;
  double gap_ = -std::numeric_limits<double>::infinity(), size_ = 0;
  Vector3d corners_[kMaxCorners];
  Face faces_[kMaxFaces];
  int num_corners_ = 0, num_faces_ = 0;
};

}  // namespace fcl_artic
