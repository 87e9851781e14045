// SPDX-License-Identifier: BSD-3-Clause
#include "certificate/witness.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "certificate/baseline_vectors.h"
#include "certificate/proof_bytes.h"

#include "numerics/baseline_isa.h"

#include "convex/gjk.h"

namespace fcl_artic::certificate {
namespace {

using baseline::Vec3;
using Eigen::Vector3d;
using engine::Piece;
using engine::PieceKind;
using engine::TreeView;

constexpr int kContact = 0x20, kCross = 0, kInside = 2, kNear = 4;
/// Least distance of a witness from failing, in m. The second one is tried if no witness has the first. The error of a
/// verifier's poses grows with the chain, to some 1e-12 m after thirty joints.
constexpr double kSure[] = {1e-9, 1e-11};

/// One of the two pieces.
struct WitnessPiece {
  const Geometry& geometry;
  const TreeView& tree;
  const Piece& piece;
  std::size_t number;  ///< as the world counts pieces
  Pose pose;           ///< in the world

  bool isTriangle() const { return piece.kind == PieceKind::vertices; }
  bool hasVertices() const { return isTriangle() || piece.kind == PieceKind::hull; }
  /// Vertices as the world counts them: a triangle's corners, a hull's points, each once.
  std::vector<Vec3> vertices() const {
    std::vector<Vec3> all;
    for (int i = 0; i < piece.num_vertices; ++i) {
      const Vec3 v = isTriangle() ? Vec3(baseline::VerticesKind::points(tree, piece) + 3 * i)
                                  : baseline::HullKind::vertex(tree, piece, i);
      const bool known = std::any_of(all.begin(), all.end(),
                                     [&](const Vec3& u) { return u[0] == v[0] && u[1] == v[1] && u[2] == v[2]; });
      if (isTriangle() || !known) all.push_back(v);
    }
    return all;
  }
};

/// A point of a piece: of one with vertices by their weights.
struct NamedPoint {
  Vector3d x;  ///< in the geometry's frame
  std::vector<std::pair<std::size_t, std::uint32_t>> weights;
};

void put(const WitnessPiece& side, const NamedPoint& point, ProofBytes& out) {
  out.number(side.number);
  if (!side.hasVertices()) {
    for (int k = 0; k < 3; ++k) out.real(point.x[k]);
    return;
  }
  out.number(point.weights.size());
  for (const auto& [vertex, weight] : point.weights) {
    out.number(vertex);
    out.fixed(weight, 4);
  }
}

/// The combination of support points as a point that can be named.
/// @param points  in the geometry's frame, with weights that sum to 1.
NamedPoint nameCore(const WitnessPiece& side, const std::vector<std::pair<Vec3, double>>& points) {
  NamedPoint named;
  named.x.setZero();
  if (!side.hasVertices()) {
    for (const auto& [p, w] : points) named.x += w * toEigen(p);
    return named;
  }
  const std::vector<Vec3> vertices = side.vertices();
  double sum = 0;
  for (const auto& [p, w] : points) {
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      if (vertices[i][0] != p[0] || vertices[i][1] != p[1] || vertices[i][2] != p[2]) continue;
      const auto weight = static_cast<std::uint32_t>(std::clamp(w, 0.0, 1.0) * 4294967295.0);
      if (weight > 0) named.weights.emplace_back(i, weight);
      named.x += static_cast<double>(weight) * toEigen(p);
      sum += static_cast<double>(weight);
      break;
    }
  }
  if (sum > 0) named.x /= sum;
  return named;
}

/// How far inside the piece x is, about; below 0: outside. Only for pieces that an inequality defines.
double depthIn(const Piece& piece, const Vector3d& x) {
  const double* e = piece.size;
  const Vector3d d = x - Vector3d::Map(piece.center);
  const double across = std::hypot(d[0], d[1]);
  switch (piece.kind) {
    case PieceKind::box:
      return std::min({e[0] - std::abs(d[0]), e[1] - std::abs(d[1]), e[2] - std::abs(d[2])});
    case PieceKind::point:
      return piece.radius - d.norm();
    case PieceKind::segment:
      return piece.radius - Vector3d(d[0], d[1], std::max(0.0, std::abs(d[2]) - e[2])).norm();
    case PieceKind::cylinder:
      return std::min(e[0] - across, e[2] - std::abs(d[2]));
    case PieceKind::cone:
      return std::min(e[2] - std::abs(d[2]), 0.5 * (e[0] * (e[2] - d[2]) / (2 * e[2]) - across));
    case PieceKind::ellipsoid:
      return (1 - Vector3d(d[0] / e[0], d[1] / e[1], d[2] / e[2]).norm()) * std::min({e[0], e[1], e[2]});
    case PieceKind::halfspace:
      return piece.center[0] - Vector3d::Map(e).dot(x);
    case PieceKind::vertices:
    case PieceKind::hull:
    case PieceKind::plane:
      return -1;  // no inequality of its size
  }
  return -1;
}

double volume(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  return a.dot(b.cross(c));
}

/// The edge of one triangle that crosses the other one best. @return how surely it does, a length; below 0: none.
double crossing(const WitnessPiece& a, const WitnessPiece& b, int& edge) {
  const Pose toB = b.pose.inverse() * a.pose;
  const std::vector<Vec3> own = a.vertices(), other = b.vertices();
  double best = -1;
  for (int k = 0; k < 3; ++k) {
    const auto at = [&](int i) -> Vector3d { return toB.R * toEigen(own[static_cast<std::size_t>(i % 3)]) + toB.c; };
    const Vector3d p = at(k), e = at(k + 1) - p;
    Vector3d c[3];
    for (int i = 0; i < 3; ++i) c[i] = toEigen(other[static_cast<std::size_t>(i)]) - p;
    const double area = (c[1] - c[0]).cross(c[2] - c[0]).norm(), length = e.norm();
    if (!(area > 0) || !(length > 0)) continue;
    const double side_p = volume(c[0], c[1], c[2]) / area, side_q = volume(c[0] - e, c[1] - e, c[2] - e) / area;
    double sure = side_p * side_q < 0 ? std::min(std::abs(side_p), std::abs(side_q)) : -1;
    double least = INFINITY, most = -INFINITY;
    for (int i = 0; i < 3; ++i) {
      const double s = volume(e, c[i], c[(i + 1) % 3]) / (length * (c[(i + 1) % 3] - c[i]).norm());
      least = std::min(least, s);
      most = std::max(most, s);
    }
    sure = std::min(sure, least > 0 ? least : most < 0 ? -most : -1);
    if (sure > best) {
      best = sure;
      edge = k;
    }
  }
  return best;
}

/// Four vertices of the hull whose tetrahedron holds x.
std::optional<std::array<std::size_t, 4>> tetrahedron(const WitnessPiece& hull, const Vector3d& x, double sure) {
  const std::vector<Vec3> vertices = hull.vertices();
  struct Shifted {
    const std::vector<Vec3>& vertices;
    Vec3 x;
    void support(const Vec3& n, baseline::DifferencePoint& p) const {
      std::size_t best = 0;
      for (std::size_t i = 1; i < vertices.size(); ++i) {
        if (dot(n, vertices[i]) < dot(n, vertices[best])) best = i;
      }
      p.w = vertices[best] - x;
      p.a = vertices[best];
    }
    void subtract(baseline::DifferencePoint&) const {}
  };
  baseline::GjkResult found;
  baseline::searchNearest(Shifted{vertices, Vec3(x[0], x[1], x[2])}, Vec3(1, 0, 0), {1e-12, 0.0, 100}, found);
  if (!found.overlap || found.simplex.n != 4) return std::nullopt;
  // x must be so far from each face.
  Vector3d w[4];
  for (int i = 0; i < 4; ++i) w[i] = toEigen(found.simplex.v[i].w);
  for (int i = 0; i < 4; ++i) {
    const Vector3d &a = w[(i + 1) % 4], &b = w[(i + 2) % 4], &c = w[(i + 3) % 4];
    if (!(std::abs(volume(a, b, c)) > sure * (b - a).cross(c - a).norm())) return std::nullopt;
  }
  std::array<std::size_t, 4> corners;
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec3& v = found.simplex.v[i].a;
    const auto at = std::find_if(vertices.begin(), vertices.end(),
                                 [&](const Vec3& u) { return u[0] == v[0] && u[1] == v[1] && u[2] == v[2]; });
    corners[i] = static_cast<std::size_t>(at - vertices.begin());
  }
  return corners;
}

/// Weights of the origin in the tetrahedron of a simplex that holds it.
void weigh(baseline::Simplex& s) {
  if (s.n != 4) return;
  const auto w = [&](int i) { return toEigen(s.v[i].w); };
  const double all = volume(w(1) - w(0), w(2) - w(0), w(3) - w(0));
  if (all == 0) return;
  s.weight[0] = volume(w(1), w(2), w(3)) / all;
  s.weight[1] = -volume(w(0), w(2), w(3)) / all;
  s.weight[2] = volume(w(0), w(1), w(3)) / all;
  s.weight[3] = -volume(w(0), w(1), w(2)) / all;
  double sum = 0;
  for (double& weight : s.weight) sum += weight = std::max(weight, 0.0);  // rounding may make it negative
  for (double& weight : s.weight) weight /= sum;
}

/// Nearest points of the two cores, or common points, each in its geometry's frame.
struct CorePoints {
  NamedPoint a, b;
  double distance;
};
CorePoints nearestPoints(const WitnessPiece& a, const WitnessPiece& b) {
  const Pose b_in_a = a.pose.inverse() * b.pose;
  baseline::DifferenceBody body{&a.tree, &a.piece, &b.tree, &b.piece, {}};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) body.pose.R[i][j] = b_in_a.R(i, j);
    body.pose.c[i] = b_in_a.c[i];
  }
  baseline::GjkResult found;
  const Vector3d guess = b_in_a.c.norm() > 1e-9 ? b_in_a.c : Vector3d(1, 0, 0);
  baseline::gjk(body, Vec3(guess[0], guess[1], guess[2]), {1e-9, 0.0, 100}, found);
  baseline::Simplex& s = found.simplex;
  weigh(s);
  std::vector<std::pair<Vec3, double>> points_a, points_b;
  for (int i = 0; i < s.n; ++i) {
    points_a.emplace_back(s.v[i].a, s.weight[i]);
    points_b.emplace_back(s.v[i].b, s.weight[i]);
  }
  CorePoints points{nameCore(a, points_a), nameCore(b, points_b), 0};
  points.distance = ((a.pose.R * points.a.x + a.pose.c) - (b.pose.R * points.b.x + b.pose.c)).norm();
  return points;
}

/// About the piece's inradius; if it is known, not more than half of it.
double inradius(const WitnessPiece& side) {
  double least = side.piece.radius > 0 ? side.piece.radius : INFINITY;
  for (const double size : side.piece.size) {
    if (size > 0) least = std::min(least, size);
  }
  return std::isfinite(least) ? 0.5 * least : 0.01;
}

/// The core's point, or the one of the rounded piece that is nearest to `towards` (geometry's frame). A little inside.
NamedPoint rounded(const WitnessPiece& side, NamedPoint core, const Vector3d& towards) {
  if (side.hasVertices()) return core;
  const Vector3d d = towards - core.x;
  if (side.piece.radius > 0 && d.norm() > 0) core.x += d * std::min(1.0, side.piece.radius / d.norm());
  // The verifier rounds the point's numbers to 2^-64 m. Next to a cone's tip the sides of the inequality are small
  // squares, so this rounding matters much sooner.
  const double inwards = std::min(0.1, (side.piece.kind == PieceKind::cone ? 1e-7 : 1e-13) + 1e-18 / inradius(side));
  const Vector3d centre = Vector3d::Map(side.piece.center);
  core.x = centre + (core.x - centre) * (1 - inwards);
  return core;
}

/// One piece and another piece, the latter made a little smaller, both with their rounding radii. A common point of the
/// two is well within the other piece as it is.
struct Shrunk {
  const WitnessPiece &own, &other;
  Pose other_in_own;
  Vector3d centre;  ///< inside of the other piece, in its frame
  double smaller;   ///< part of its size

  Vector3d farthest(const WitnessPiece& side, const Vector3d& u) const {
    const Vec3 core = baseline::supportPoint(side.tree, side.piece, Vec3(u[0], u[1], u[2]));
    return toEigen(core) + u * (side.piece.radius / u.norm());
  }
  void support(const Vec3& n, baseline::DifferencePoint& p) const {
    const Vector3d u = toEigen(n), a = farthest(own, u);
    const Vector3d b = centre + smaller * (farthest(other, other_in_own.R.transpose() * -u) - centre);
    const Vector3d w = other_in_own.R * b + other_in_own.c - a;
    for (int k = 0; k < 3; ++k) {
      p.a[k] = a[k];
      p.b[k] = b[k];
      p.w[k] = w[k];
    }
  }
  void subtract(baseline::DifferencePoint&) const {}
};

/// A point of one piece that is well within the other; none if they don't overlap enough.
std::optional<NamedPoint> pointInside(const WitnessPiece& own, const WitnessPiece& other, double sure) {
  Vector3d centre = Vector3d::Map(other.piece.center);
  if (other.hasVertices()) {
    const std::vector<Vec3> vertices = other.vertices();
    centre.setZero();
    for (const Vec3& v : vertices) centre += toEigen(v) / static_cast<double>(vertices.size());
  }
  // A cone's inequality is squared: a point that near to its tip is lost in the verifier's last digits, 2^-64.
  const double less = (other.piece.kind == PieceKind::cone ? 1e-6 : 10 * sure / std::max(sure, inradius(other)));
  const Shrunk body{own, other, own.pose.inverse() * other.pose, centre, 1 - std::min(0.5, less)};
  baseline::GjkResult found;
  baseline::searchNearest(body, Vec3(1, 0, 0), {1e-12, 0.0, 100}, found);
  if (!found.overlap || found.simplex.n != 4) return std::nullopt;
  weigh(found.simplex);
  std::vector<std::pair<Vec3, double>> points;
  points.reserve(4);
  for (int i = 0; i < 4; ++i) points.emplace_back(found.simplex.v[i].a, found.simplex.weight[i]);
  return nameCore(own, points);
}

/// @param sure  m, how far it is from failing.
std::string witnessAt(const WitnessPiece& a, const WitnessPiece& b, double margin, double sure) {
  std::string text;
  ProofBytes out(text);
  if (margin <= 0 && a.isTriangle() && b.isTriangle()) {
    int edge = 0, other_edge = 0;
    const double own = crossing(a, b, edge), other = crossing(b, a, other_edge);
    if (!(std::max(own, other) > sure)) return {};
    const bool swap = other > own;
    out.byte(kCross + swap);
    out.number(swap ? b.number : a.number);
    out.number(static_cast<std::size_t>(swap ? other_edge : edge));
    out.number(swap ? a.number : b.number);
    return text;
  }
  const bool unbounded = baseline::unbounded(a.piece) || baseline::unbounded(b.piece);
  if (unbounded && (margin > 0 || baseline::unbounded(a.piece) == baseline::unbounded(b.piece))) return {};
  const CorePoints points = nearestPoints(a, b);
  const auto seenFrom = [](const WitnessPiece& from, const WitnessPiece& of, const NamedPoint& p) {
    return Vector3d(from.pose.R.transpose() * (of.pose.R * p.x + of.pose.c - from.pose.c));
  };
  if (margin > 0) {
    const NamedPoint x = rounded(a, points.a, seenFrom(a, b, points.b)), y = rounded(b, points.b, seenFrom(b, a, x));
    const double distance = ((a.pose.R * x.x + a.pose.c) - (b.pose.R * y.x + b.pose.c)).norm();
    if (!(distance < margin - sure)) return {};
    out.byte(kNear);
    put(a, x, out);
    put(b, y, out);
    return text;
  }
  for (const bool swap : {false, true}) {
    const WitnessPiece &own = swap ? b : a, &other = swap ? a : b;
    if (other.isTriangle() || other.piece.kind == PieceKind::plane || baseline::unbounded(own.piece)) continue;
    NamedPoint x;
    if (baseline::unbounded(other.piece)) {
      x = rounded(own, swap ? points.b : points.a, seenFrom(own, other, swap ? points.a : points.b));
    } else {
      const std::optional<NamedPoint> within = pointInside(own, other, sure);
      if (!within) continue;
      x = rounded(own, *within, within->x);
    }
    const Vector3d there = seenFrom(other, own, x);
    std::string bytes;
    ProofBytes to(bytes);
    to.byte(kInside + swap);
    put(own, x, to);
    to.number(other.number);
    if (other.piece.kind == PieceKind::hull) {
      const auto corners = tetrahedron(other, there, sure);
      if (!corners) continue;
      for (const std::size_t corner : *corners) to.number(corner);
      return bytes;
    }
    if (depthIn(other.piece, there) > sure) return bytes;
  }
  return {};
}

}  // namespace

std::string findWitness(MovingWorld& world, const Meeting& meeting) {
  const auto side = [&](int body, std::int32_t leaf, double t) -> WitnessPiece {
    const Geometry& geometry = world.geometry(body);
    const TreeView& tree = geometry.shape->view();
    const auto at = std::find(geometry.order.begin(), geometry.order.end(), leaf);
    return {geometry, tree, tree.pieces[leaf], static_cast<std::size_t>(at - geometry.order.begin()),
            world.pose(body, 0, t)};
  };
  if (meeting.leaf_a < 0 || meeting.leaf_b < 0) return {};
  // A little later they are deeper in each other.
  for (const double sure : kSure) {
    for (const double later : {0.0, 1.0, 10.0, 100.0, 1000.0}) {
      const double t = std::min(1.0, meeting.t_upper + later * meeting.tolerance);
      const std::string witness = witnessAt(side(meeting.a, meeting.leaf_a, t), side(meeting.b, meeting.leaf_b, t),
                                            world.margin(meeting.a, meeting.b), sure);
      if (witness.empty()) continue;
      std::string text;
      ProofBytes out(text);
      out.byte(kContact);
      out.number(static_cast<std::size_t>(meeting.piece));
      out.number(static_cast<std::size_t>(meeting.a));
      out.number(static_cast<std::size_t>(meeting.b));
      out.real(t);
      return text + witness;
    }
  }
  return {};
}

}  // namespace fcl_artic::certificate
