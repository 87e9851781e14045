// SPDX-License-Identifier: BSD-3-Clause
#include "geometry.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "random.h"

namespace campaign {
namespace {

/// Lower bound on the distance of two boxes: the larger of the distances of each from the other's enclosure along its
/// own axes. M_ab: pose of B's frame in A's.
double boxGap(const Geometry::Node& a, const Geometry::Node& b, const Pose& M_ab) {
  const Vec3 d = a.R.transpose() * (M_ab.R * b.centre + (M_ab.p - a.centre));
  const Mat3 R = a.R.transpose() * (M_ab.R * b.R);
  const Mat3 absR = R.cwiseAbs();
  const Vec3 in_a = (d.cwiseAbs() - a.half - absR * b.half).cwiseMax(0);
  const Vec3 in_b = ((R.transpose() * d).cwiseAbs() - b.half - absR.transpose() * a.half).cwiseMax(0);
  return std::sqrt(std::max(in_a.squaredNorm(), in_b.squaredNorm()));
}

struct LeafAnswer {
  double gap, upper;
  bool touching, clear;
  Separation separation;
};

LeafAnswer compareLeaves(const Piece& a, const Piece& b, double margin, double wanted) {
  LeafAnswer r;
  r.separation = separation(a, b, wanted, margin);
  r.gap = r.separation.lower - margin;
  r.upper = r.separation.upper - margin;
  r.touching = r.clear = false;
  if (margin > 0 && r.upper <= -kClearSolids) {
    r.touching = r.clear = true;
  } else if (a.kind == Piece::triangle && b.kind == Piece::triangle) {
    // A gap along a direction is out of doubt beyond the rounding of three products.
    if (margin == 0 && r.gap < 1e-14) {
      r.touching = trianglesTouch(a.corners, b.corners);
      r.clear = r.touching && trianglesClearlyCross(a.corners, b.corners, kClearMeshes);
    }
  } else if (r.upper <= 1e-10) {
    r.touching = r.upper <= 0;
    r.clear = clearlyOverlap(a, b, kClearSolids);
    r.touching |= r.clear;
  }
  if (r.touching) r.gap = std::min(r.gap, 0.0);
  return r;
}

struct Search {
  const Geometry &A, &B;
  const Pose &M_a, &M_b;
  double margin, wanted;
  Proximity best;

  /// Distance from which on a pair of nodes is of no interest any more.
  double bound() const { return best.touching ? 0 : std::max(best.upper, 0.0) * (1 - wanted) + 1e-14; }

  void visit(int i, int j) {
    const LeafAnswer leaf = compareLeaves(A.piece(i, M_a), B.piece(j, M_b), margin, 0.5 * wanted);
    const bool better =
        leaf.clear || (leaf.touching && !best.touching) || (leaf.touching == best.touching && leaf.upper < best.upper);
    best.gap = std::min(best.gap, leaf.gap);
    if (!better) return;
    best.upper = leaf.upper;
    best.touching = leaf.touching;
    best.clear = leaf.clear;
    best.piece_a = i, best.piece_b = j;
    best.a = leaf.separation.a, best.b = leaf.separation.b, best.direction = leaf.separation.direction;
  }
};

Pose toPose(const Vec3& p) {
  return {Mat3::Identity(), p};
}

}  // namespace

Mat3 rotationAbout(const Vec3& axis, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  Mat3 K;
  K << 0, -axis.z(), axis.y(), axis.z(), 0, -axis.x(), -axis.y(), axis.x(), 0;
  return c * Mat3::Identity() + s * K + (1 - c) * axis * axis.transpose();
}

Mat3 Random::rotation() {
  const Vec3 first = direction(), second = direction();
  const double by = uniform(-M_PI, M_PI), then_by = uniform(-M_PI, M_PI);
  return rotationAbout(second, then_by) * rotationAbout(first, by);
}

GeometryPtr Geometry::mesh(std::string name, std::vector<Vec3> vertices, std::vector<std::array<int, 3>> triangles,
                           BV bv) {
  auto g = std::shared_ptr<Geometry>(new Geometry);
  g->name_ = std::move(name);
  g->vertices_ = std::move(vertices);
  g->triangles_ = std::move(triangles);
  g->volume_ = bv;
  g->fcl_ = makeFclMesh(g->vertices_, g->triangles_, bv);
  g->buildTree();
  return g;
}

GeometryPtr Geometry::box(const Vec3& sides) {
  auto g = std::shared_ptr<Geometry>(new Geometry);
  g->name_ = "box";
  g->kind_ = Piece::box;
  g->half_ = sides / 2;
  g->fcl_ = makeFclShape(g->kind_, g->half_);
  g->buildTree();
  return g;
}

GeometryPtr Geometry::cylinder(double radius, double length) {
  auto g = std::shared_ptr<Geometry>(new Geometry);
  g->name_ = "cylinder";
  g->kind_ = Piece::cylinder;
  g->half_ = Vec3(radius, radius, length / 2);
  g->fcl_ = makeFclShape(g->kind_, g->half_);
  g->buildTree();
  return g;
}

GeometryPtr Geometry::sphere(double radius) {
  auto g = std::shared_ptr<Geometry>(new Geometry);
  g->name_ = "sphere";
  g->kind_ = Piece::sphere;
  g->half_ = Vec3::Constant(radius);
  g->fcl_ = makeFclShape(g->kind_, g->half_);
  g->buildTree();
  return g;
}

Piece Geometry::piece(int index, const Pose& M) const {
  Piece p;
  p.kind = kind_;
  if (isMesh()) {
    const auto& t = triangles_[static_cast<std::size_t>(index)];
    for (int k = 0; k < 3; ++k) p.corners[k] = M * vertices_[static_cast<std::size_t>(t[k])];
  } else {
    p.R = M.R;
    p.centre = M.p;
    p.half = half_;
  }
  return p;
}

Vec3 Geometry::surfacePoint(double u, double v, double w) const {
  switch (kind_) {
    case Piece::triangle: {
      const auto& t = triangles_[static_cast<std::size_t>(u * static_cast<double>(triangles_.size()))];
      if (v + w > 1) v = 1 - v, w = 1 - w;
      const Vec3 &a = vertices_[static_cast<std::size_t>(t[0])], &b = vertices_[static_cast<std::size_t>(t[1])],
                 &c = vertices_[static_cast<std::size_t>(t[2])];
      return a + v * (b - a) + w * (c - a);
    }
    case Piece::box: {
      Vec3 x((2 * v - 1) * half_.x(), (2 * w - 1) * half_.y(), (2 * std::fmod(7 * u, 1.0) - 1) * half_.z());
      const int k = static_cast<int>(6 * u);
      x[k / 2] = k % 2 ? half_[k / 2] : -half_[k / 2];
      return x;
    }
    case Piece::cylinder: {
      const bool side = u < 0.7;
      const double r = side ? half_.x() : half_.x() * std::sqrt(w);
      const double z = side ? (2 * w - 1) * half_.z() : (u < 0.85 ? half_.z() : -half_.z());
      return {r * std::cos(2 * M_PI * v), r * std::sin(2 * M_PI * v), z};
    }
    case Piece::sphere:
      break;
  }
  const double z = 2 * v - 1, r = std::sqrt(std::max(0.0, 1 - z * z));
  return half_.x() * Vec3(r * std::cos(2 * M_PI * w), r * std::sin(2 * M_PI * w), z);
}

void Geometry::buildTree() {
  if (!isMesh()) {
    radius_ = kind_ == Piece::sphere ? half_.x()
              : kind_ == Piece::box  ? half_.norm()
                                     : std::hypot(half_.x(), half_.z());
    nodes_.push_back({Mat3::Identity(), Vec3::Zero(), half_ * (1 + 1e-15), -1, 0, half_.norm()});
    return;
  }
  Vec3 low = Vec3::Constant(kInfinity), high = -low;
  for (const Vec3& v : vertices_) low = low.cwiseMin(v), high = high.cwiseMax(v);
  centre_ = (low + high) / 2;
  for (const Vec3& v : vertices_) radius_ = std::max(radius_, (v - centre_).norm());
  radius_ *= 1 + 1e-14;
  std::vector<int> order(triangles_.size());
  std::iota(order.begin(), order.end(), 0);
  nodes_.reserve(2 * order.size());
  nodes_.emplace_back();
  split(0, order, 0, static_cast<int>(order.size()));
}

void Geometry::split(int node, std::vector<int>& order, int begin, int end) {
  const auto corner = [&](int t, int k) -> const Vec3& {
    return vertices_[static_cast<std::size_t>(triangles_[static_cast<std::size_t>(t)][k])];
  };
  const auto forCorners = [&](const auto& f) {
    for (int i = begin; i < end; ++i)
      for (int k = 0; k < 3; ++k) f(corner(order[static_cast<std::size_t>(i)], k));
  };
  Vec3 mean = Vec3::Zero();
  forCorners([&](const Vec3& v) { mean += v / (3 * (end - begin)); });
  Mat3 spread = Mat3::Zero();
  forCorners([&](const Vec3& v) { spread += (v - mean) * (v - mean).transpose(); });
  const Mat3 R = Eigen::SelfAdjointEigenSolver<Mat3>(spread).eigenvectors();
  Vec3 low = Vec3::Constant(kInfinity), high = -low;
  forCorners([&](const Vec3& v) {
    const Vec3 x = R.transpose() * v;
    low = low.cwiseMin(x), high = high.cwiseMax(x);
  });
  // Grown by some ulp, so that no rounding here or in boxGap() loses a corner.
  const Vec3 half = (high - low) / 2 + Vec3::Constant(1e-14 * (1 + low.norm() + high.norm()));
  nodes_[static_cast<std::size_t>(node)] = {
      R, R * ((low + high) / 2), half, -1, order[static_cast<std::size_t>(begin)], half.norm()};
  if (end - begin == 1) return;
  int longest;
  half.maxCoeff(&longest);
  const Vec3 axis = R.col(longest);
  const int middle = (begin + end) / 2;
  std::nth_element(order.begin() + begin, order.begin() + middle, order.begin() + end, [&](int s, int t) {
    return axis.dot(corner(s, 0) + corner(s, 1) + corner(s, 2)) < axis.dot(corner(t, 0) + corner(t, 1) + corner(t, 2));
  });
  const int left = static_cast<int>(nodes_.size());
  nodes_[static_cast<std::size_t>(node)].left = left;
  nodes_.emplace_back();
  nodes_.emplace_back();
  split(left, order, begin, middle);
  split(left + 1, order, middle, end);
}

Proximity proximity(const Geometry& A, const Pose& M_a, const Geometry& B, const Pose& M_b, double margin,
                    double wanted, const Proximity& hint) {
  // Far apart, the balls tell enough.
  const Vec3 between = M_b * B.centre() - M_a * A.centre();
  const double balls = between.norm() - A.radius() - B.radius() - margin;
  if (wanted > 0.01 && balls > 0.5 * (A.radius() + B.radius())) {
    Proximity far = hint;
    far.gap = balls;
    far.upper = between.norm() + A.radius() + B.radius() - margin;
    far.touching = far.clear = false;
    return far;
  }

  Search search{A, B, M_a, M_b, margin, wanted, {}};
  search.best.gap = search.best.upper = kInfinity;
  search.visit(std::min(hint.piece_a, A.numPieces() - 1), std::min(hint.piece_b, B.numPieces() - 1));
  const Pose M_ab = M_a.inverse() * M_b;

  struct Entry {
    int a, b;
    double gap;
  };
  std::array<Entry, 256> stack;
  int top = 0;
  const auto gapOf = [&](int a, int b) {
    return boxGap(A.nodes()[static_cast<std::size_t>(a)], B.nodes()[static_cast<std::size_t>(b)], M_ab) - margin;
  };
  stack[top++] = {0, 0, gapOf(0, 0)};
  double pruned = kInfinity;  // least gap of what was left out
  while (top > 0 && !search.best.clear) {
    const Entry e = stack[--top];
    if (e.gap > search.bound()) {
      pruned = std::min(pruned, e.gap);
      continue;
    }
    const Geometry::Node &a = A.nodes()[static_cast<std::size_t>(e.a)], &b = B.nodes()[static_cast<std::size_t>(e.b)];
    if (a.left < 0 && b.left < 0) {
      search.visit(a.piece, b.piece);
      continue;
    }
    const bool split_a = b.left < 0 || (a.left >= 0 && a.size >= b.size);
    Entry x = split_a ? Entry{a.left, e.b, 0} : Entry{e.a, b.left, 0};
    Entry y = split_a ? Entry{a.left + 1, e.b, 0} : Entry{e.a, b.left + 1, 0};
    x.gap = gapOf(x.a, x.b);
    y.gap = gapOf(y.a, y.b);
    if (x.gap < y.gap) std::swap(x, y);  // the nearer one is looked at first
    stack[top++] = x;
    stack[top++] = y;
  }
  search.best.gap = std::min(search.best.gap, pruned);
  return search.best;
}

double distanceTo(const Geometry& g, int piece, const Pose& M, const Vec3& x) {
  Piece point;
  point.kind = Piece::sphere;
  point.centre = x;
  return std::max(0.0, separation(g.piece(piece, M), point, 1e-9).upper);
}

double distanceTo(const Geometry& g, const Pose& M, const Vec3& x) {
  static const GeometryPtr point = Geometry::sphere(0);
  return std::max(0.0, proximity(g, M, *point, toPose(x), 0, 1e-6, {}).upper);
}

}  // namespace campaign
