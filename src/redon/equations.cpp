// SPDX-License-Identifier: BSD-3-Clause
#include "redon/equations.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace fcl_artic {
namespace redon {
namespace {

using Eigen::Vector3d;

IntervalVec3 at(const double* p) {
  return IntervalVec3(p);
}
Vector3d middleOf(const IntervalVec3& v) {
  return {v[0].middle(), v[1].middle(), v[2].middle()};
}

/// Takes the part along u out of v.
void removeAlong(const Vector3d& u, Vector3d& v) {
  const double length2 = u.squaredNorm();
  if (length2 > 0) v -= v.dot(u) / length2 * u;
}

/// Closest points of two features, and the features' own directions there. They only say where to look: every claim is
/// checked in interval arithmetic.
struct Nearest {
  Vector3d a, x, e = Vector3d::Zero(), f = Vector3d::Zero();

  double distance() const { return (x - a).norm(); }
  /// From A to B. The difference of near points has lost digits. It is at right angles to the features, and this
  /// restores them.
  Vector3d direction() const {
    Vector3d n = x - a, g = f;
    removeAlong(e, n);
    removeAlong(e, g);
    removeAlong(g, n);
    return n;
  }
};

/// The foot of a point on an edge. @param[out] along  whether the foot lies between the ends.
Vector3d footOnEdge(const Vector3d& p, const Vector3d& from, const Vector3d& to, bool& along) {
  const Vector3d e = to - from;
  const double length2 = e.squaredNorm(), s = length2 > 0 ? e.dot(p - from) / length2 : 0;
  along = s > 0 && s < 1;
  return s > 0 ? (s < 1 ? Vector3d(from + s * e) : to) : from;
}

Nearest nearestOfFace(const Vector3d& p, const Vector3d* v) {
  const Vector3d n = (v[1] - v[0]).cross(v[2] - v[1]);
  const double n2 = n.squaredNorm();
  bool inside = n2 > 0;
  Nearest best{v[0], p};
  double least = (p - v[0]).squaredNorm();
  for (int i = 0; i < 3; ++i) {
    const Vector3d &from = v[i], &to = v[(i + 1) % 3];
    bool along;
    const Vector3d foot = footOnEdge(p, from, to, along);
    if ((p - foot).squaredNorm() < least) {
      least = (p - foot).squaredNorm();
      best.a = foot;
      best.e = along ? Vector3d(to - from) : Vector3d(Vector3d::Zero());
    }
    inside = inside && n.cross(to - from).dot(p - from) >= 0;
  }
  if (!inside) return best;
  return {p - n.dot(p - v[0]) / n2 * n, p, v[1] - v[0], v[2] - v[1]};
}

Nearest nearestOfEdges(const Vector3d& p, const Vector3d& p1, const Vector3d& q, const Vector3d& q1) {
  Nearest best{p, q};
  const auto offer = [&](const Vector3d& a, const Vector3d& x, const Vector3d& e, const Vector3d& f) {
    if ((x - a).squaredNorm() <= (best.x - best.a).squaredNorm()) best = {a, x, e, f};
  };
  const Vector3d none = Vector3d::Zero();
  bool along;
  for (const Vector3d* end : {&p, &p1}) {
    const Vector3d foot = footOnEdge(*end, q, q1, along);
    offer(*end, foot, along ? Vector3d(q1 - q) : none, none);
  }
  for (const Vector3d* end : {&q, &q1}) {
    const Vector3d foot = footOnEdge(*end, p, p1, along);
    offer(foot, *end, along ? Vector3d(p1 - p) : none, none);
  }
  const Vector3d d = p1 - p, e = q1 - q, m = d.cross(e);
  const double m2 = m.squaredNorm();
  if (m2 > 0) {
    const double s = (q - p).cross(e).dot(m) / m2, t = (q - p).cross(d).dot(m) / m2;
    if (s >= 0 && s <= 1 && t >= 0 && t <= 1) offer(p + s * d, q + t * e, d, e);
  }
  return best;
}

Nearest nearestInMiddle(const Equation& q, const Element* elements) {
  Vector3d v[6];
  for (int i = 0; i < 6; ++i) {
    if (q.element[i] >= 0) v[i] = middleOf(elements[q.element[i]].middle);
  }
  if (q.kind == EquationKind::edgeEdge) return nearestOfEdges(v[1], v[2], v[4], v[5]);
  if (q.kind == EquationKind::faceVertex) return nearestOfFace(v[4], v + 1);
  Nearest n = nearestOfFace(v[0], v + 2);
  std::swap(n.a, n.x);
  return n;
}

/// Vertices of A and of B in an equation.
struct Vertices {
  const Element *a[3], *b[3];
  int num_a, num_b;
};
Vertices verticesOf(const Equation& q, const Element* e) {
  const auto at = [&](int i) { return e + q.element[i]; };
  switch (q.kind) {
    case EquationKind::faceVertex:
      return {{at(1), at(2), at(3)}, {at(4)}, 3, 1};
    case EquationKind::vertexFace:
      return {{at(0)}, {at(2), at(3), at(4)}, 1, 3};
    default:
      return {{at(1), at(2)}, {at(4), at(5)}, 2, 2};
  }
}

/// n_face . (x - foot): the three vertices of a face, and the vertex.
bool inside(const IntervalVec3& normal, const IntervalVec3* face, const IntervalVec3& x) {
  for (int i = 0; i < 3; ++i) {
    if (!dot(cross(normal, face[(i + 1) % 3] - face[i]), x - face[i]).certainlyPositive()) return false;
  }
  return true;
}

enum Feature { vertex, edge, face };

/// The vector of a feature in its body's frame: a vertex's place, along an edge, or a face's normal.
IntervalVec3 vectorOf(const ObbTree& tree, Feature kind, int number) {
  if (kind == vertex) return at(tree.vertex(number));
  if (kind == edge) {
    const ObbEdge& d = tree.edges()[static_cast<std::size_t>(number)];
    return at(tree.vertex(d.to)) - at(tree.vertex(d.from));
  }
  const ObbTriangle& t = tree.triangles()[static_cast<std::size_t>(number)];
  const IntervalVec3 v[3] = {at(tree.vertex(t.vertex[0])), at(tree.vertex(t.vertex[1])), at(tree.vertex(t.vertex[2]))};
  return cross(v[1] - v[0], v[2] - v[1]);
}

}  // namespace

void EquationSet::clear() {
  equations_.clear();
  elements_.clear();
}

void EquationSet::add(const std::vector<BodyPair>& pairs, const LeafPair* leaf, const LeafPair* end) {
  while (leaf < end) {
    const std::int32_t number = leaf->pair;
    const BodyPair& pair = pairs[static_cast<std::size_t>(number)];
    const ObbTree* trees[2] = {pair.a, pair.b};
    struct Used {
      int body, kind, feature;
    };
    std::vector<Used> used;
    for (int body = 0; body < 2; ++body) {
      const std::size_t sizes[3] = {static_cast<std::size_t>(trees[body]->numVertices()), trees[body]->edges().size(),
                                    trees[body]->triangles().size()};
      for (int kind = 0; kind < 3; ++kind) {
        std::vector<std::int32_t>& numbers = numbers_[body][kind];
        if (numbers.size() < sizes[kind]) numbers.resize(sizes[kind], -1);
      }
    }
    const auto element = [&](int body, Feature kind, int feature) {
      std::int32_t& n = numbers_[body][kind][static_cast<std::size_t>(feature)];
      if (n >= 0) return n;
      n = static_cast<std::int32_t>(elements_.size());
      used.push_back({body, kind, feature});
      elements_.emplace_back();
      Element& e = elements_.back();
      e.pair = number;
      e.moves = body == 1;
      e.direction = kind != vertex;
      e.own = vectorOf(*trees[body], kind, feature);
      e.over = e.middle = e.own;
      e.rate = IntervalVec3(Interval(0.0), Interval(0.0), Interval(0.0));
      return n;
    };
    for (; leaf < end && leaf->pair == number; ++leaf) {
      const ObbTriangle& x = trees[0]->triangles()[static_cast<std::size_t>(leaf->a)];
      const ObbTriangle& y = trees[1]->triangles()[static_cast<std::size_t>(leaf->b)];
      Equation q;
      q.pair = number;
      q.triangle_a = leaf->a;
      q.triangle_b = leaf->b;
      q.from = leaf->from;
      for (int k = 0; k < 3; ++k) {
        if (y.owns_vertex >> k & 1) {
          q.kind = EquationKind::faceVertex;
          const std::int32_t all[6] = {element(0, face, leaf->a),       element(0, vertex, x.vertex[0]),
                                       element(0, vertex, x.vertex[1]), element(0, vertex, x.vertex[2]),
                                       element(1, vertex, y.vertex[k]), -1};
          std::copy(all, all + 6, q.element);
          equations_.push_back(q);
        }
        if (x.owns_vertex >> k & 1) {
          q.kind = EquationKind::vertexFace;
          const std::int32_t all[6] = {element(0, vertex, x.vertex[k]), element(1, face, leaf->b),
                                       element(1, vertex, y.vertex[0]), element(1, vertex, y.vertex[1]),
                                       element(1, vertex, y.vertex[2]), -1};
          std::copy(all, all + 6, q.element);
          equations_.push_back(q);
        }
        if (!(x.owns_edge >> k & 1)) continue;
        for (int j = 0; j < 3; ++j) {
          if (!(y.owns_edge >> j & 1)) continue;
          q.kind = EquationKind::edgeEdge;
          const ObbEdge& d = trees[0]->edges()[static_cast<std::size_t>(x.edge[k])];
          const ObbEdge& e = trees[1]->edges()[static_cast<std::size_t>(y.edge[j])];
          const std::int32_t all[6] = {element(0, edge, x.edge[k]), element(0, vertex, d.from),
                                       element(0, vertex, d.to),    element(1, edge, y.edge[j]),
                                       element(1, vertex, e.from),  element(1, vertex, e.to)};
          std::copy(all, all + 6, q.element);
          equations_.push_back(q);
        }
      }
    }
    for (const Used& u : used) numbers_[u.body][u.kind][static_cast<std::size_t>(u.feature)] = -1;
  }
}

void bound(Element& e, const PairBounds& motion) {
  if (e.direction) {
    e.over = motion.over.R * e.own;
    e.middle = motion.middle.R * e.own;
    e.rate = motion.rate.R * e.own;
  } else {
    e.over = motion.over * e.own;
    e.middle = motion.middle * e.own;
    e.rate = motion.rate * e.own;
  }
}

Interval value(const Equation& q, const Element* e, Bounds when) {
  const auto v = [&](int i) -> const IntervalVec3& { return e[q.element[i]].*when; };
  switch (q.kind) {
    case EquationKind::faceVertex:
      return dot(v(0), v(4) - v(1));
    case EquationKind::vertexFace:
      return dot(v(1), v(0) - v(2));
    default:
      return dot(v(4) - v(1), cross(v(0), v(3)));
  }
}

Interval derivativeOver(const Equation& q, const Element* e) {
  const auto v = [&](int i) -> const IntervalVec3& { return e[q.element[i]].over; };
  const auto w = [&](int i) -> const IntervalVec3& { return e[q.element[i]].rate; };
  switch (q.kind) {
    case EquationKind::faceVertex:
      return dot(v(0), w(4));
    case EquationKind::vertexFace:
      return dot(w(1), v(0) - v(2)) - dot(v(1), w(2));
    default:
      return dot(w(4), cross(v(0), v(3))) + dot(v(4) - v(1), cross(v(0), w(3)));
  }
}

/// For each vertex x of B: n . x over T. It is taken as it is, or by the mean value theorem, n . x(m) + h (n . x'),
/// whichever is tighter. All vertices have the same n, to the last bit.
bool certainlyApart(const Equation& q, const Element* elements, Interval h, double& gap) {
  const Nearest nearest = nearestInMiddle(q, elements);
  gap = nearest.distance();
  Vector3d n = nearest.direction();
  const double size = n.norm();
  if (!(size > 0) || !std::isfinite(size)) return false;
  n /= size;
  const Vertices v = verticesOf(q, elements);
  double highest_a = -1e300, lowest_b = 1e300;
  const auto along = [&](const IntervalVec3& x) { return (x[0] * n[0] + x[1] * n[1]) + x[2] * n[2]; };
  for (int i = 0; i < v.num_a; ++i) highest_a = std::max(highest_a, along(v.a[i]->own).upper());
  for (int i = 0; i < v.num_b; ++i) {
    const Interval range = intersection(along(v.b[i]->over), along(v.b[i]->middle) + along(v.b[i]->rate) * h);
    lowest_b = std::min(lowest_b, range.lower());
  }
  return lowest_b > highest_a;
}

bool certainlyInside(const Equation& q, const Element* e) {
  const auto v = [&](int i) -> const IntervalVec3& { return e[q.element[i]].over; };
  if (q.kind == EquationKind::faceVertex) {
    const IntervalVec3 face[3] = {v(1), v(2), v(3)};
    return inside(v(0), face, v(4));
  }
  if (q.kind == EquationKind::vertexFace) {
    const IntervalVec3 face[3] = {v(2), v(3), v(4)};
    return inside(v(1), face, v(0));
  }
  // A point a + u e_a = x + w e_x of both lines has u m.m = U and w m.m = W, m = e_a x e_x.
  const IntervalVec3 m = cross(v(0), v(3)), d = v(4) - v(1);
  const Interval m2 = (square(m[0]) + square(m[1])) + square(m[2]), U = dot(m, cross(d, v(3))),
                 W = dot(m, cross(d, v(0)));
  return U.certainlyPositive() && W.certainlyPositive() && (m2 - U).certainlyPositive() && (m2 - W).certainlyPositive();
}

void describe(const Equation& q, const Element* e, double before, double* point, double* normal) {
  const auto v = [&](int i) { return middleOf(e[q.element[i]].middle); };
  const Nearest nearest = nearestInMiddle(q, e);
  Vector3d n;
  switch (q.kind) {
    case EquationKind::faceVertex:
      n = v(0);
      break;
    case EquationKind::vertexFace:
      n = -v(1);
      break;
    default:
      n = v(0).cross(v(3));
      break;
  }
  if (before < 0) n = -n;
  if (!(n.norm() > 0)) n = nearest.direction();
  if (!(n.norm() > 0)) n = Vector3d::UnitZ();
  n.normalize();
  Vector3d::Map(point) = 0.5 * (nearest.a + nearest.x);
  Vector3d::Map(normal) = n;
}

}  // namespace redon
}  // namespace fcl_artic
