// SPDX-License-Identifier: BSD-3-Clause
//
// Elementary equations against closed forms, and against a truth in long double. The truth is an advancement from t = 0
// that moves on by distance / speed, so that it can't pass a contact, down to gaps of 1e-16 m.
#include "narrowphase/elementary.h"

#include <cfenv>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace fcl_artic {
namespace elementary_test {
namespace {

using Real = long double;
using Eigen::Vector3d;
using Point = Eigen::Matrix<Real, 3, 1>;
using Matrix = Eigen::Matrix<Real, 3, 3>;

/// B's motion in A's frame: turns at a constant rate about an axis through the pivot while the pivot slides.
/// x(t) = exp(t rate [axis]) (R0 p + c0) + pivot + t slide
struct Turn {
  Point axis = Point::UnitZ();
  Real rate = 0;
  Matrix R0 = Matrix::Identity();
  Point c0 = Point::Zero(), pivot = Point::Zero(), slide = Point::Zero();

  Matrix spin(Real t) const { return Eigen::AngleAxis<Real>(t * rate, axis).toRotationMatrix(); }
  Point at(Real t, const Vector3d& p) const { return spin(t) * (R0 * p.cast<Real>() + c0) + pivot + t * slide; }
  Real speed(const Vector3d b[3]) const {
    Real radius = 0;
    for (int j = 0; j < 3; ++j) radius = std::max(radius, (R0 * b[j].cast<Real>() + c0).norm());
    return std::abs(rate) * radius + slide.norm();
  }
};

/// Parts that a test may take out of the enclosure, to see that it would notice.
struct Mutant {
  bool drop_remainder = false, drop_pad = false;
  double noise = 0;             ///< added to the coefficients of the position, and to the pad
  int rounding = FE_TONEAREST;  ///< mode during the refinement, its motion included
};

Matrix crossMatrix(const Point& w) {
  Matrix m;
  m << 0, -w[2], w[1], w[2], 0, -w[0], -w[1], w[0], 0;
  return m;
}

MotionAt enclosure(const Turn& turn, const Mutant& mutant = {}) {
  return [=](double tm, double d, ScalarMotion& out) {
    const Matrix W = turn.rate * d * crossMatrix(turn.axis), S = turn.spin(tm), R = S * turn.R0;
    const Point c = S * turn.c0;
    const Matrix Rs[3] = {R, W * R, W * W * R / 2};
    const Point cs[3] = {c + turn.pivot + tm * turn.slide, W * c + d * turn.slide, W * W * c / 2};
    double size = 1;
    for (int order = 0; order < 3; ++order) {
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) out.R[order][3 * i + j] = static_cast<double>(Rs[order](i, j));
        out.c[order][i] = static_cast<double>(cs[order][i]);
        size += std::abs(out.c[order][i]);
      }
    }
    for (int i = 0; i < 3; ++i) out.c[0][i] += mutant.noise / std::sqrt(3.0) * (i == 0 ? 1 : -1);
    // |d^3 R| <= rate^3; the slide adds nothing. Points of B in these tests stay within 4 m.
    const double third = std::pow(static_cast<double>(std::abs(turn.rate)) * d, 3) / 6;
    out.rem_R = mutant.drop_remainder ? 0 : third;
    out.rem_c = mutant.drop_remainder ? 0 : third * static_cast<double>(turn.c0.norm());
    out.pad = mutant.drop_pad ? 0 : 2e-15 * (size + 4) + mutant.noise;
  };
}

/// The same motion told by poses and bounds on speeds alone (fcl_artic::BoundedMotion without derivatives).
MotionAt withoutDerivatives(const Turn& turn) {
  const MotionAt motion = enclosure(turn);
  return [=](double tm, double d, ScalarMotion& out) {
    motion(tm, d, out);
    for (int order = 1; order < 3; ++order) {
      std::fill(out.R[order], out.R[order] + 9, 0);
      std::fill(out.c[order], out.c[order] + 3, 0);
    }
    const double rate = static_cast<double>(std::abs(turn.rate));
    out.rem_R = rate * d;
    out.rem_c = static_cast<double>(turn.slide.norm() + rate * turn.c0.norm()) * d;
  };
}

// ---- Truth in long double.

struct Pair {
  Vector3d a[3], b[3];
  Turn turn;
};

/// Features of a closest pair, and how far it is from the features' own ends (as a part of the edge, or barycentric).
struct Closest {
  Real distance = INFINITY, margin = 0;
  Point on_a, on_b;
  FeatureKind feature = FeatureKind::volume;
  int i = -1, j = -1;
};

/// Closest strictly interior point of a face; false when the closest point of the plane is not inside.
bool projectToFace(const Point& p, const Point v[3], Point& on, Real& margin) {
  const Point n = (v[1] - v[0]).cross(v[2] - v[0]);
  const Real n2 = n.squaredNorm();
  if (!(n2 > 0)) return false;
  margin = INFINITY;
  for (int i = 0; i < 3; ++i) {
    margin = std::min(margin, n.dot((v[(i + 1) % 3] - v[i]).cross(p - v[i])) / n2);
  }
  on = p - n.dot(p - v[0]) / n2 * n;
  return margin > 0;
}

Point clampToEdge(const Point& p, const Point& from, const Point& to) {
  const Real length2 = (to - from).squaredNorm();
  if (!(length2 > 0)) return from;
  const Real s = (p - from).dot(to - from) / length2;
  return from + std::min<Real>(1, std::max<Real>(0, s)) * (to - from);
}

/// Closest points of two triangles that do not cross each other: between vertices and faces, or edges and edges.
Closest closest(const Point a[3], const Point x[3]) {
  Closest best;
  const auto offer = [&](const Point& p, const Point& q, Real margin, FeatureKind feature, int i, int j) {
    const Real distance = (q - p).norm();
    if (distance < best.distance) best = {distance, margin, p, q, feature, i, j};
  };
  for (int i = 0; i < 3; ++i) {
    Point on;
    Real margin;
    if (projectToFace(a[i], x, on, margin)) offer(a[i], on, margin, FeatureKind::vertexFace, i, -1);
    if (projectToFace(x[i], a, on, margin)) offer(on, x[i], margin, FeatureKind::faceVertex, -1, i);
    for (int j = 0; j < 3; ++j) {
      const Point &p = a[i], &p1 = a[(i + 1) % 3], &q = x[j], &q1 = x[(j + 1) % 3];
      // Ends count as vertices on edges, margin 0.
      offer(p, clampToEdge(p, q, q1), 0, FeatureKind::vertexEdge, i, j);
      offer(clampToEdge(q, p, p1), q, 0, FeatureKind::edgeVertex, i, j);
      const Point e = p1 - p, f = q1 - q, w = q - p, m = e.cross(f);
      const Real m2 = m.squaredNorm();
      if (!(m2 > 0)) continue;
      const Real u = m.dot(w.cross(f)) / m2, v = m.dot(w.cross(e)) / m2;
      const Real inside = std::min(std::min(u, 1 - u), std::min(v, 1 - v));
      if (inside > 0) offer(p + u * e, q + v * f, inside, FeatureKind::edgeEdge, i, j);
    }
  }
  return best;
}

Closest closestAt(const Pair& pair, Real t) {
  Point a[3], x[3];
  for (int k = 0; k < 3; ++k) {
    a[k] = pair.a[k].cast<Real>();
    x[k] = pair.turn.at(t, pair.b[k]);
  }
  return closest(a, x);
}

/// An edge of one triangle pierces the other: signs of tetrahedra only.
bool crossing(const Pair& pair, Real t) {
  Point v[2][3];
  for (int k = 0; k < 3; ++k) {
    v[0][k] = pair.a[k].cast<Real>();
    v[1][k] = pair.turn.at(t, pair.b[k]);
  }
  const auto det = [](const Point& p, const Point& q, const Point& r, const Point& s) {
    return (q - p).dot((r - p).cross(s - p));
  };
  for (int side = 0; side < 2; ++side) {
    const Point *face = v[side], *other = v[1 - side];
    for (int k = 0; k < 3; ++k) {
      const Point &p = other[k], &q = other[(k + 1) % 3];
      if (!(det(face[0], face[1], face[2], p) * det(face[0], face[1], face[2], q) < 0)) continue;
      const Real s0 = det(p, q, face[0], face[1]), s1 = det(p, q, face[1], face[2]), s2 = det(p, q, face[2], face[0]);
      if ((s0 > 0 && s1 > 0 && s2 > 0) || (s0 < 0 && s1 < 0 && s2 < 0)) return true;
    }
  }
  return false;
}

struct Truth {
  enum { contact, free, unclear } kind = unclear;
  Real t = 0;  ///< free on [0, t); with contact, the gap there is below 1e-16 m
  Real least_gap = INFINITY;
  Closest at;
};

Truth advance(const Pair& pair) {
  Truth truth;
  const Real speed = pair.turn.speed(pair.b);
  for (int step = 0; step < 4000; ++step) {
    truth.at = closestAt(pair, truth.t);
    truth.least_gap = std::min(truth.least_gap, truth.at.distance);
    if (truth.at.distance < 1e-16L) {
      truth.kind = Truth::contact;
      return truth;
    }
    truth.t += truth.at.distance / speed;
    if (truth.t > 1) {
      truth.kind = Truth::free;
      return truth;
    }
  }
  return truth;
}

// ---- Random pairs.

class Source {
 public:
  explicit Source(unsigned seed) : engine_(seed) {}
  double uniform(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(engine_); }
  Vector3d vector(double size) { return {uniform(-size, size), uniform(-size, size), uniform(-size, size)}; }
  Vector3d unit() {
    Vector3d v;
    do v = vector(1);
    while (v.norm() < 0.1 || v.norm() > 1);
    return v.normalized();
  }
  int pick(int n) { return std::uniform_int_distribution<int>(0, n - 1)(engine_); }

 private:
  std::mt19937 engine_;
};

/// Two triangles of about 1 m, 1 to 2 m apart; B turns by up to 2 rad and slides towards A.
Pair randomPair(Source& source) {
  Pair pair;
  for (int k = 0; k < 3; ++k) {
    pair.a[k] = source.vector(1);
    pair.b[k] = source.vector(1);
  }
  Turn& turn = pair.turn;
  turn.axis = source.unit().cast<Real>().normalized();
  turn.rate = source.uniform(-2, 2);
  turn.R0 = Eigen::AngleAxis<Real>(source.uniform(-3, 3), source.unit().cast<Real>().normalized()).toRotationMatrix();
  const Vector3d away = source.unit();
  turn.pivot = (source.uniform(1, 2) * away).cast<Real>() + source.vector(0.3).cast<Real>();
  turn.c0 = source.vector(0.5).cast<Real>();
  turn.slide = (-source.uniform(0.5, 3) * away).cast<Real>();
  return pair;
}

/// Why an answer is wrong; empty when it is right.
std::string faultOf(const Pair& pair, const Truth& truth, bool found, const RefinedContact& r, double given_upper) {
  if (truth.kind == Truth::free) return r.certain ? "certain on a free pair" : "";
  if (!found) return "contact lost";
  if (static_cast<Real>(r.t_lower) > truth.t) return "t_lower after the contact";
  if (static_cast<Real>(r.t_upper) < truth.t) return "t_upper before the contact";
  if (r.t_upper > given_upper) return "t_upper after the one given";
  if (!r.certain) return r.t_upper == given_upper ? "" : "t_upper changed without proof";
  return crossing(pair, r.t_upper) ? "" : "no contact at a certain t_upper";
}

struct Campaign {
  int wrong = 0, contacts = 0, certain = 0, free = 0, free_found = 0, named = 0, misnamed = 0, unclear = 0;
  double widest = 0;
  std::vector<std::string> faults;
};

/// @param narrow  windows of 1e-8 to 0.1 about the contact instead of [0, 1]
Campaign runCampaign(unsigned seed, int count, const Mutant& mutant, bool narrow, Pair (*make)(Source&)) {
  Campaign c;
  Source source(seed);
  for (int n = 0; n < count; ++n) {
    const Pair pair = make(source);
    const double before = std::pow(10, -source.uniform(1, 8)), after = std::pow(10, -source.uniform(1, 8));
    if (closestAt(pair, 0).distance < 1e-3L || crossing(pair, 0)) continue;
    const Truth truth = advance(pair);
    // A gap that gets below 1e-9 m without contact is neither.
    if (truth.kind == Truth::unclear || (truth.kind == Truth::free && truth.least_gap < 1e-9L)) {
      ++c.unclear;
      continue;
    }
    double lower = 0, upper = 1;
    if (narrow && truth.kind == Truth::contact) {
      lower = std::max(0.0, static_cast<double>(truth.t) - before);
      upper = std::min(1.0, static_cast<double>(truth.t) + after);
    }
    RefinedContact r;
    const MotionAt motion = enclosure(pair.turn, mutant);
    std::fesetround(mutant.rounding);
    const bool found = refineTriangleContact(pair.a, pair.b, motion, {lower, upper}, r);
    std::fesetround(FE_TONEAREST);
    const std::string fault = faultOf(pair, truth, found, r, upper);
    if (!fault.empty()) {
      ++c.wrong;
      c.faults.push_back("pair " + std::to_string(n) + ": " + fault);
    }
    if (truth.kind == Truth::free) {
      ++c.free;
      c.free_found += found;
      continue;
    }
    ++c.contacts;
    c.certain += r.certain;
    if (r.certain) c.widest = std::max(c.widest, r.t_upper - r.t_lower);
    if (truth.at.margin < 1e-6L) continue;  // a tie, or near one
    ++c.named;
    const int i = truth.at.i, j = truth.at.j;
    bool right = found && r.feature == truth.at.feature && r.feature_a == i && r.feature_b == j;
    // The contact moves by up to `speed` times the window; the rest is rounding over the angle at which features cross.
    const double away =
        static_cast<double>(pair.turn.speed(pair.b)) * (r.certain ? r.t_upper - r.t_lower : 1e-9) + 1e-9;
    right = right && (r.point - truth.at.on_a.cast<double>()).norm() < 10 * away;
    const Closest earlier = closestAt(pair, std::max<Real>(0, truth.t - 1e-6L));
    const Vector3d way = (earlier.on_b - earlier.on_a).cast<double>().normalized();
    right = right && r.normal.dot(way) > 0.999 && std::abs(r.normal.norm() - 1) < 1e-12;
    if (!right) {
      ++c.misnamed;
      c.faults.push_back("pair " + std::to_string(n) + ": features");
    }
  }
  return c;
}

void expectRight(const Campaign& c) {
  EXPECT_EQ(c.wrong, 0);
  EXPECT_EQ(c.misnamed, 0);
  for (std::size_t k = 0; k < std::min<std::size_t>(c.faults.size(), 10); ++k) ADD_FAILURE() << c.faults[k];
}

void report(const Campaign& c) {
  std::printf(
      "contacts %d, certain %d, widest certain %.3g; named %d, misnamed %d; free %d, not proven free %d; "
      "unclear %d; wrong %d\n",
      c.contacts, c.certain, c.widest, c.named, c.misnamed, c.free, c.free_found, c.unclear, c.wrong);
}

TEST(ElementaryTest, RandomPairsOverTheWholeMotion) {
  const Campaign c = runCampaign(1, 12000, {}, false, randomPair);
  report(c);
  expectRight(c);
  EXPECT_GT(c.contacts, 3000);
  EXPECT_GT(c.free, 3000);
  EXPECT_GT(c.certain, 0.99 * c.contacts);
  EXPECT_GT(c.named, 0.99 * c.contacts);
  EXPECT_EQ(c.free_found, 0);
  EXPECT_LT(c.unclear, 20);
}

TEST(ElementaryTest, RandomPairsInNarrowWindows) {
  const Campaign c = runCampaign(2, 12000, {}, true, randomPair);
  report(c);
  expectRight(c);
  EXPECT_GT(c.certain, 0.99 * c.contacts);
}

TEST(ElementaryTest, PadCoversWrongCoefficients) {
  Mutant noisy;
  noisy.noise = 1e-7;
  const Campaign c = runCampaign(3, 2000, noisy, true, randomPair);
  report(c);
  EXPECT_EQ(c.wrong, 0);
  EXPECT_GT(c.contacts, 500);
}

TEST(ElementaryTest, AnyRoundingMode) {
  for (const int mode : {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
    Mutant rounded;
    rounded.rounding = mode;
    const Campaign c = runCampaign(6, 1000, rounded, true, randomPair);
    expectRight(c);
    EXPECT_GT(c.certain, 300);
  }
}

// The campaign is worth something only if it sees an enclosure that is none.
TEST(ElementaryTest, CampaignCatchesADroppedRemainder) {
  Mutant mutant;
  mutant.drop_remainder = true;
  EXPECT_GT(runCampaign(4, 1500, mutant, false, randomPair).wrong, 20);
}

TEST(ElementaryTest, CampaignCatchesADroppedPad) {
  Mutant mutant;
  mutant.drop_pad = true;
  mutant.noise = 1e-7;
  EXPECT_GT(runCampaign(5, 500, mutant, true, randomPair).wrong, 20);
}

// ---- Closed forms.

RefinedContact refine(const Pair& pair, double lower = 0, double upper = 1) {
  RefinedContact r;
  EXPECT_TRUE(refineTriangleContact(pair.a, pair.b, enclosure(pair.turn), {lower, upper}, r));
  return r;
}

void expectWindow(const RefinedContact& r, Real t, double width) {
  EXPECT_LE(static_cast<Real>(r.t_lower), t);
  EXPECT_GE(static_cast<Real>(r.t_upper), t);
  EXPECT_LT(r.t_upper - r.t_lower, width);
}

void expectNear(const Vector3d& v, const Vector3d& w, double tolerance) {
  EXPECT_LT((v - w).norm(), tolerance) << v.transpose() << " vs " << w.transpose();
}

const Vector3d kGround[3] = {{-4, -4, 0}, {4, -4, 0}, {0, 4, 0}};

Pair over(const Vector3d ground[3], const Vector3d& b0, const Vector3d& b1, const Vector3d& b2) {
  return {{ground[0], ground[1], ground[2]}, {b0, b1, b2}, {}};
}

// The vertex starts 1 m above the ground and falls at 3 m per unit of t.
TEST(ElementaryTest, FallingVertexOnFace) {
  Pair pair = over(kGround, {0.5, 0.25, 1}, {1, 0, 2}, {0, 1, 2});
  pair.turn.slide = {0.75, 0, -3};
  RefinedContact r = refine(pair);
  EXPECT_TRUE(r.certain);
  expectWindow(r, 1 / Real(3), 1e-12);
  EXPECT_EQ(r.feature, FeatureKind::faceVertex);
  EXPECT_EQ(r.feature_a, -1);
  EXPECT_EQ(r.feature_b, 0);
  expectNear(r.point, {0.75, 0.25, 0}, 1e-11);
  expectNear(r.normal, {0, 0, 1}, 1e-14);

  // The same seen from the other side: the ground rises to the vertex.
  std::swap(pair.a, pair.b);
  pair.turn.slide = -pair.turn.slide;
  r = refine(pair);
  EXPECT_TRUE(r.certain);
  expectWindow(r, 1 / Real(3), 1e-12);
  EXPECT_EQ(r.feature, FeatureKind::vertexFace);
  EXPECT_EQ(r.feature_a, 0);
  EXPECT_EQ(r.feature_b, -1);
  expectNear(r.normal, {0, 0, -1}, 1e-12);
}

// A's edge 1 lies along x. B's edge 0 is parallel to y, at (x, z) = (cos phi, sin phi) / 2 with phi = 1 - 2 t.
TEST(ElementaryTest, CrossingEdgesUnderRotation) {
  Pair pair = over(kGround, {0.5, -1, 0}, {0.5, 1, 0}, {0.5, 0, 1});
  pair.a[0] = {0, 0, -2};
  pair.a[1] = {-2, 0, 0};
  pair.a[2] = {2, 0, 0};
  pair.turn.axis = Point::UnitY();  // a positive turn about y moves +x towards -z
  pair.turn.R0 = Eigen::AngleAxis<Real>(-1, Point::UnitY()).toRotationMatrix();
  pair.turn.rate = 2;
  const RefinedContact r = refine(pair);
  EXPECT_TRUE(r.certain);
  expectWindow(r, 0.5, 1e-12);
  EXPECT_EQ(r.feature, FeatureKind::edgeEdge);
  EXPECT_EQ(r.feature_a, 1);
  EXPECT_EQ(r.feature_b, 0);
  expectNear(r.point, {0.5, 0, 0}, 1e-11);
  expectNear(r.normal, {0, 0, 1}, 1e-11);
}

// A plate hinged on the y axis falls at 1.5 rad per unit of t; its corner next to the hinge, 1 m away, meets a table at
// z = 1/4 when cos(1.5 t) = 1/4.
TEST(ElementaryTest, HingedPlateOnTable) {
  Pair pair = over(kGround, {0, 0, 1}, {0, -0.3, 1.5}, {0, 0.3, 1.5});
  for (Vector3d& v : pair.a) v[2] = 0.25;
  pair.turn.axis = Point::UnitY();
  pair.turn.rate = 1.5;
  const RefinedContact r = refine(pair);
  EXPECT_TRUE(r.certain);
  expectWindow(r, std::acos(Real(0.25)) / 1.5L, 1e-12);
  EXPECT_EQ(r.feature, FeatureKind::faceVertex);
  EXPECT_EQ(r.feature_b, 0);
  expectNear(r.point, {std::sqrt(1 - 0.0625), 0, 0.25}, 1e-11);
  expectNear(r.normal, {0, 0, 1}, 1e-14);
}

// ---- Ties.

struct Tie {
  const char* name;
  Vector3d b[3];
  FeatureKind feature;
  int i, j;
  Vector3d point, normal;
  double extent;  ///< of the contact set, about the point
};

// B falls 1 m, at 2 m per unit of t, onto A = kGround: contact at t = 1/2. A normal of 0 is not unique.
TEST(ElementaryTest, DegenerateContactsAreNamed) {
  const Tie ties[] = {
      {"vertex on vertex",
       {{-4, -4, 1}, {-5, -4, 2}, {-4, -5, 2}},
       FeatureKind::vertexVertex,
       0,
       0,
       {-4, -4, 0},
       {0, 0, 0},
       0},
      {"vertex on edge", {{1, -4, 1}, {0, -5, 2}, {2, -5, 3}}, FeatureKind::edgeVertex, 0, 0, {1, -4, 0}, {0, 0, 1}, 0},
      {"parallel edges",
       {{-1, -4, 1}, {6, -4, 1}, {0, -5, 2}},
       FeatureKind::edgeEdge,
       0,
       0,
       {1.5, -4, 0},
       {0, 0, 1},
       2.5},
      {"edge on face", {{-1, -1, 1}, {1, -1, 1}, {0, 0, 2}}, FeatureKind::faceEdge, -1, 0, {0, -1, 0}, {0, 0, 1}, 1},
      {"long edge over face",
       {{0, 0, 2}, {-9, -1, 1}, {9, -1, 1}},
       FeatureKind::faceEdge,
       -1,
       1,
       {0, -1, 0},
       {0, 0, 1},
       2.5},
      {"edge over vertex",
       {{-5, -3, 1}, {-3, -5, 1}, {-5, -5, 2}},
       FeatureKind::vertexEdge,
       0,
       0,
       {-4, -4, 0},
       {0, 0, 1},
       0},
      {"edge beside vertex",
       {{-5, -3.5, 1}, {-3.5, -5, 1}, {-5, -5, 2}},
       FeatureKind::volume,
       -1,
       -1,
       {0, 0, 0},
       {0, 0, 0},
       0},
      {"face on face",
       {{-1, -1, 1}, {1, -1, 1}, {0, 1, 1}},
       FeatureKind::faceFace,
       -1,
       -1,
       {0, -1 / 3.0, 0},
       {0, 0, 1},
       1.4},
  };
  for (const Tie& tie : ties) {
    SCOPED_TRACE(tie.name);
    Pair pair = over(kGround, tie.b[0], tie.b[1], tie.b[2]);
    pair.turn.slide = {0, 0, -2};
    RefinedContact r;
    if (tie.feature == FeatureKind::volume) {  // no contact at all
      EXPECT_FALSE(refineTriangleContact(pair.a, pair.b, enclosure(pair.turn), {0, 1}, r));
      EXPECT_EQ(r.feature, FeatureKind::volume);
      continue;
    }
    r = refine(pair);
    expectWindow(r, 0.5, 1.01);
    EXPECT_GT(r.t_lower, 0.5 - 1e-12);
    EXPECT_EQ(static_cast<int>(r.feature), static_cast<int>(tie.feature));
    EXPECT_EQ(r.feature_a, tie.i);
    EXPECT_EQ(r.feature_b, tie.j);
    // A contact set larger than a point is reported by some point of it.
    EXPECT_LE((r.point - tie.point).norm(), tie.extent + 1e-11);
    EXPECT_NEAR(r.point[2], 0, 1e-11);
    if (tie.normal.norm() > 0) expectNear(r.normal, tie.normal, 1e-9);
    EXPECT_NEAR(r.normal.norm(), 1, 1e-12);
    // Without derivatives the remainder is all of the way: it decides when an interval is narrow.
    RefinedContact first_order;
    ASSERT_TRUE(
        refineTriangleContact(pair.a, pair.b, withoutDerivatives(pair.turn), {0.5 - 4e-7, 0.5 + 4e-7}, first_order));
    EXPECT_EQ(static_cast<int>(first_order.feature), static_cast<int>(tie.feature));
    EXPECT_GT(first_order.t_lower, 0.5 - 1e-12);
    if (tie.normal.norm() > 0) expectNear(first_order.normal, tie.normal, 1e-9);
    // The same with the bodies exchanged.
    std::swap(pair.a, pair.b);
    pair.turn.slide = {0, 0, 2};
    RefinedContact q = refine(pair);
    EXPECT_EQ(q.feature_a, tie.j);
    EXPECT_EQ(q.feature_b, tie.i);
    if (tie.normal.norm() > 0) expectNear(q.normal, -tie.normal, 1e-9);
  }
}

// A's corner stands in B's plane, which turns about it: no crossing is proven. The face's normal is that of the time at
// which the contact is, t_upper where it is proven otherwise.
TEST(ElementaryTest, NormalIsOfTheTimeOfThePoint) {
  const Pair pair = {{{0, 0, 0}, {1, 0, -3}, {-1, 1, -3}}, {{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}}, {Point::UnitX(), 0.5}};
  for (const bool proven : {false, true}) {
    RefinedContact r;
    ASSERT_TRUE(refineTriangleContact(pair.a, pair.b, enclosure(pair.turn), {0, 1, proven}, r));
    EXPECT_FALSE(r.certain);
    EXPECT_EQ(r.feature, FeatureKind::vertexFace);
    const double angle = proven ? 0.5 : 0;
    expectNear(r.normal, {0, -std::sin(angle), std::cos(angle)}, 1e-9);
  }
}

// Both in z = 0 at all times: every s vanishes identically. B's corner slides into A's lower edge at y = -4.
TEST(ElementaryTest, CoplanarSliding) {
  Pair pair = over(kGround, {1, -5, 0}, {2, -6, 0}, {0, -6, 0});
  pair.turn.slide = {0.5, 2, 0};
  RefinedContact r = refine(pair);
  expectWindow(r, 0.5, 1.01);
  EXPECT_GT(r.t_lower, 0.5 - 1e-12);
  EXPECT_FALSE(r.certain);
  EXPECT_EQ(r.t_upper, 1);
  EXPECT_EQ(r.feature, FeatureKind::edgeVertex);
  EXPECT_EQ(r.feature_a, 0);
  EXPECT_EQ(r.feature_b, 0);
  expectNear(r.point, {1.25, -4, 0}, 1e-11);
  expectNear(r.normal, {0, -1, 0}, 1e-9);

  pair.turn.slide = {-12, 0, 0};  // along the edge, 1 m beside it
  EXPECT_FALSE(refineTriangleContact(pair.a, pair.b, enclosure(pair.turn), {0, 1}, r));
  EXPECT_EQ(r.t_lower, 0);
  EXPECT_EQ(r.t_upper, 1);
}

// The same in planes that are tilted, so that nothing is exact, and by a corner at some place of an edge: t_lower comes
// as near to the contact as rounding allows, not only to the root of it.
TEST(ElementaryTest, TiltedCoplanarSliding) {
  Source source(11);
  for (int n = 0; n < 300; ++n) {
    SCOPED_TRACE(n);
    const double h = source.uniform(0.3, 1.5), x = source.uniform(-2, 2);
    Pair pair = over(kGround, {x, -4 - h, 0}, {x + 1, -6, 0}, {x - 1, -6, 0});
    const Matrix tilt = Eigen::AngleAxis<Real>(source.uniform(-3, 3), source.unit().cast<Real>()).toRotationMatrix();
    for (Vector3d* v : {&pair.a[0], &pair.a[1], &pair.a[2], &pair.b[0], &pair.b[1], &pair.b[2]}) {
      *v = (tilt * v->cast<Real>()).cast<double>();
    }
    pair.turn.slide = tilt * Point(source.uniform(-1, 1), 2, 0);
    const RefinedContact r = refine(pair);
    EXPECT_FALSE(r.certain);
    EXPECT_LT(r.t_lower, h / 2 + 1e-14);
    EXPECT_GT(r.t_lower, h / 2 - 1e-12);
    EXPECT_EQ(r.feature, FeatureKind::edgeVertex);
    EXPECT_EQ(r.feature_a, 0);
    EXPECT_EQ(r.feature_b, 0);
    expectNear(r.normal, (tilt * Point(0, -1, 0)).cast<double>(), 1e-8);
  }
}

// A vertex on a circle about the y axis reaches down to z = 0 at t = 1/2 and rises again: a root without change of
// sign.
TEST(ElementaryTest, GrazingIsNotCertain) {
  Pair pair = over(kGround, {0, 0, -1}, {-0.2, -0.1, -0.5}, {0.2, 0.1, -0.5});
  pair.turn.axis = Point::UnitY();
  pair.turn.rate = 1;
  pair.turn.R0 = Eigen::AngleAxis<Real>(-0.5L, Point::UnitY()).toRotationMatrix();
  pair.turn.pivot = {0, 0, 1};
  RefinedContact r = refine(pair);
  EXPECT_FALSE(r.certain);
  EXPECT_LE(r.t_lower, 0.5);
  EXPECT_GT(r.t_lower, 0.5 - 1e-6);  // sqrt(2 * floor / acceleration)
  EXPECT_EQ(r.t_upper, 1);
  EXPECT_EQ(r.feature, FeatureKind::faceVertex);
  EXPECT_EQ(r.feature_b, 0);

  pair.turn.pivot[2] += 1e-9L;
  EXPECT_FALSE(refineTriangleContact(pair.a, pair.b, enclosure(pair.turn), {0, 1}, r));
}

// A vertex passes each of the ground's edges, and an edge each end of another, by less than the floor. There is no
// contact, but that can't be decided, so there is no certain one.
TEST(ElementaryTest, MissBelowTheFloorIsNotCertain) {
  constexpr double kMiss = 0x1p-48;
  for (int turn = 0; turn < 3; ++turn) {
    SCOPED_TRACE(turn);
    const Vector3d ground[3] = {kGround[turn], kGround[(turn + 1) % 3], kGround[(turn + 2) % 3]};
    Pair pair = over(ground, {1, -4 - kMiss, 1}, {0, -5, 2}, {2, -5, 3});
    pair.turn.slide = {0, 0, -2};
    EXPECT_FALSE(refine(pair).certain);
    std::swap(pair.a, pair.b);
    pair.turn.slide = {0, 0, 2};
    EXPECT_FALSE(refine(pair).certain);
  }
  // A's edge 0 is from (-4, -4, 0) to (4, -4, 0) and the rest of A lies below; B's is along y, the rest above.
  for (int end = 0; end < 4; ++end) {
    SCOPED_TRACE(end);
    const double x = end == 0 ? -4 - kMiss : end == 1 ? 4 + kMiss : 1;
    const double y0 = end == 2 ? -4 + kMiss : -5, y1 = end == 3 ? -4 - kMiss : -3;
    Pair pair = over(kGround, {x, y0, 1}, {x, y1, 1}, {x, 0.5 * (y0 + y1), 3});
    pair.a[2] = {0, -4, -3};
    pair.turn.slide = {0, 0, -2};
    const RefinedContact r = refine(pair);
    EXPECT_FALSE(r.certain);
    EXPECT_EQ(r.t_upper, 1);
  }
}

// A sliver lies on a table along its whole length: its two long edges pass the same points, but the corner that they
// share is elsewhere.
TEST(ElementaryTest, ASliversFarCornerIsNotNamed) {
  int named = 0;
  for (const double width : {1e-12, 1e-10, 1e-8}) {
    for (const double at : {-0.9, -0.3, 0.2, 0.7}) {
      // B's edge crosses A's long edges, which lie along x, at x = `at`.
      Pair pair;
      pair.a[0] = {-1, 0, 0};
      pair.a[1] = {1, 0, 0};
      pair.a[2] = {1, width, 0};
      pair.b[0] = {at - 0.01, -0.5, 1};
      pair.b[1] = {at + 0.01, 0.5, 1};
      pair.b[2] = {at, 0, 2};
      pair.turn.slide = {0, 0, -2};
      const RefinedContact r = refine(pair);
      expectNear(r.point, {at, 0, 0}, 1e-6);
      if (r.feature != FeatureKind::vertexVertex && r.feature != FeatureKind::vertexEdge &&
          r.feature != FeatureKind::vertexFace)
        continue;
      ++named;
      EXPECT_LT((pair.a[r.feature_a] - r.point).norm(), 1e-3) << width << " " << at;
    }
  }
  EXPECT_EQ(named, 0);
}

// Triangles that slide along each other in one plane were apart along it before: what parts them where they touch is
// the plane's own direction, or an edge's.
TEST(ElementaryTest, TheNormalOfASlidingContactParts) {
  // A's plane is y = -1/2, and so low is B's corner that comes to A's edge at t = 3/5, all else of B being higher.
  const Vector3d still[3] = {{0, -0.5, 0.5}, {0.25, -0.5, -0.25}, {0.25, -0.5, 0.75}};
  Pair pair = over(still, {2.5, 0.5, 0.25}, {2.5, -0.5, 0}, {2, 0.25, 0.5});
  pair.turn.slide = {-3.75, 0, 0};
  const RefinedContact r = refine(pair);
  double most = -INFINITY, least = INFINITY;
  for (int i = 0; i < 3; ++i) {
    most = std::max(most, r.normal.dot(pair.a[i]));
    const Point x = pair.turn.at(r.t_lower, pair.b[i]);
    least = std::min(least, r.normal.dot(x.cast<double>()));
  }
  EXPECT_GT(least - most, -1e-9) << r.normal.transpose();
}

// However little of the window given lies after the contact.
TEST(ElementaryTest, NeverWidensTheWindow) {
  Pair pair = over(kGround, {0.5, 0.25, 1}, {1, 0, 2}, {0, 1, 2});
  pair.turn.slide = {0.75, 0, -3};
  int certain = 0;
  for (int k = 0; k < 40; ++k) {
    const double upper = 1 / 3.0 + std::ldexp(1, k - 53);
    const RefinedContact r = refine(pair, 0.25, upper);
    EXPECT_LE(r.t_upper, upper);
    EXPECT_GE(r.t_lower, 0.25);
    expectWindow(r, 1 / Real(3), 0.1);
    certain += r.certain;
  }
  EXPECT_GT(certain, 20);
  EXPECT_LT(certain, 40);
}

// ---- Near-parallel edges: B's edge 0 crosses over A's edge 1 at an angle alpha, height 1/4, and comes down at 1/2 per
// unit of t while it turns by up to 1e-3 about an axis near its own direction.

Pair nearParallel(Source& source, double alpha, double aside) {
  const double h = source.uniform(0.3, 0.7);
  Pair pair;
  pair.a[0] = {0, source.uniform(-0.2, 0.2), -1};
  pair.a[1] = {-1, 0, 0};
  pair.a[2] = {1, 0, 0};
  // The edges cross at (x, 0) as seen along z.
  const double x = source.uniform(-0.5, 0.5), l = source.uniform(0.8, 1.2), k = source.uniform(0.8, 1.2);
  pair.b[0] = {x - l * std::cos(alpha), aside - l * std::sin(alpha), 0};
  pair.b[1] = {x + k * std::cos(alpha), aside + k * std::sin(alpha), 0};
  pair.b[2] = {0, source.uniform(-0.2, 0.2), 1};
  pair.turn.pivot = {0, 0, h / 2};
  pair.turn.slide = {source.uniform(-0.2, 0.2), 0, -0.5};
  return pair;
}

// No turn: contact at t = h exactly, whatever the angle.
TEST(ElementaryTest, NearParallelEdges) {
  Source source(7);
  int certain = 0;
  for (int exponent = 2; exponent <= 8; ++exponent) {
    for (int n = 0; n < 100; ++n) {
      SCOPED_TRACE("angle 1e-" + std::to_string(exponent) + ", case " + std::to_string(n));
      const Pair pair = nearParallel(source, std::pow(10.0, -exponent), 0);
      const RefinedContact r = refine(pair);
      expectWindow(r, 2 * pair.turn.pivot[2], 1.01);
      EXPECT_GT(static_cast<Real>(r.t_lower), 2 * pair.turn.pivot[2] - 1e-12);
      EXPECT_EQ(r.feature, FeatureKind::edgeEdge);
      EXPECT_EQ(r.feature_a, 1);
      EXPECT_EQ(r.feature_b, 0);
      expectNear(r.normal, {0, 0, 1}, 1e-7);
      certain += r.certain;
    }
  }
  EXPECT_GT(certain, 300);
}

TEST(ElementaryTest, NearParallelEdgesThatTurn) {
  const auto make = [](Source& source) {
    Pair pair = nearParallel(source, std::pow(10.0, -source.uniform(2, 8)), source.uniform(-1e-3, 1e-3));
    pair.turn.axis = source.unit().cast<Real>().normalized();
    pair.turn.rate = source.pick(2) ? 0.5L : 1e-3L;
    return pair;
  };
  const Campaign c = runCampaign(8, 700, {}, false, make);
  report(c);
  expectRight(c);
  EXPECT_GT(c.contacts, 300);
  EXPECT_GT(c.certain, 0.9 * c.contacts);
}

// B passes beside A's edge (lateral) or turns back above it (normal): free, however small the miss.
TEST(ElementaryTest, NearParallelMissesAreFree) {
  Source source(9);
  for (int n = 0; n < 200; ++n) {
    SCOPED_TRACE(n);
    const double miss = std::pow(10.0, -source.uniform(2, 8));
    // Lateral: both triangles upright, parallel, B `miss` beside A.
    Pair lateral = nearParallel(source, 0, miss);
    for (Vector3d* v : {&lateral.a[0], &lateral.b[2]}) (*v)[1] = 0;
    lateral.b[2][1] = miss;
    lateral.turn.slide[1] = 0;
    RefinedContact r;
    EXPECT_FALSE(refineTriangleContact(lateral.a, lateral.b, enclosure(lateral.turn), {0, 1}, r));
    EXPECT_FALSE(r.certain);
    // Normal: the edge comes down on a circle of radius 1 about an axis along x, to `miss` above A's edge, and rises.
    Pair normal = nearParallel(source, miss, 0);
    normal.turn.axis = Point::UnitX();
    normal.turn.rate = 1;
    normal.turn.slide.setZero();
    normal.turn.R0 = Eigen::AngleAxis<Real>(-0.5L, Point::UnitX()).toRotationMatrix();
    for (int j = 0; j < 2; ++j) normal.b[j][2] = -std::sqrt(1 - normal.b[j][1] * normal.b[j][1]);
    normal.b[2] = {0, 0.1, -0.5};
    normal.turn.pivot = {0, 0, 1 + static_cast<Real>(miss)};
    EXPECT_FALSE(refineTriangleContact(normal.a, normal.b, enclosure(normal.turn), {0, 1}, r));
    EXPECT_FALSE(r.certain);
  }
}

// ---- Degenerate triangles.

TEST(ElementaryTest, NeedlesAndPointsGiveFiniteAnswers) {
  Source source(10);
  int found = 0, contacts = 0;
  for (int n = 0; n < 1500; ++n) {
    SCOPED_TRACE(n);
    Pair pair = randomPair(source);
    const auto flatten = [&](Vector3d v[3]) {
      switch (source.pick(4)) {
        case 0:
          v[2] = v[1];
          break;  // zero-length edge
        case 1:
          v[2] = 0.25 * v[0] + 0.75 * v[1];
          break;  // needle
        case 2:
          v[1] = v[2] = v[0];
          break;  // point
        default:
          break;
      }
    };
    flatten(pair.a);
    flatten(pair.b);
    // Aim: a point of A is put where a point of B will be, so that even segments meet.
    const Vector3d b = pair.b[0] + source.uniform(0, 1) * (pair.b[1] - pair.b[0]);
    const double t = source.uniform(0.2, 0.9);
    const Vector3d shift =
        pair.turn.at(t, b).cast<double>() - (pair.a[0] + source.uniform(0, 1) * (pair.a[1] - pair.a[0]));
    for (Vector3d& v : pair.a) v += shift;
    if (closestAt(pair, 0).distance < 1e-3L || crossing(pair, 0)) continue;
    const Truth truth = advance(pair);
    RefinedContact r;
    const bool hit = refineTriangleContact(pair.a, pair.b, enclosure(pair.turn), {0, 1}, r);
    found += hit;
    EXPECT_TRUE(r.point.allFinite());
    EXPECT_NEAR(r.normal.norm(), 1, 1e-12);
    if (truth.kind != Truth::contact) continue;
    ++contacts;
    ASSERT_TRUE(hit);
    EXPECT_LE(static_cast<Real>(r.t_lower), truth.t);
    EXPECT_GE(static_cast<Real>(r.t_upper), truth.t);
  }
  EXPECT_GT(found, 700);
  EXPECT_GT(contacts, 300);
}

TEST(ElementaryTest, WindowsWithoutWidthAndInputsThatAreNotNumbers) {
  Pair pair = over(kGround, {0.5, 0.25, 0}, {1, 0, 1}, {0, 1, 1});
  pair.turn.slide = {0, 0, -1};
  RefinedContact r = refine(pair, 0, 0);  // touches at t = 0
  EXPECT_EQ(r.t_lower, 0);
  EXPECT_EQ(r.t_upper, 0);
  EXPECT_FALSE(r.certain);
  EXPECT_EQ(r.feature, FeatureKind::faceVertex);
  EXPECT_EQ(r.feature_b, 0);
  EXPECT_NEAR(std::abs(r.normal[2]), 1, 1e-12);

  pair.b[0][0] = std::numeric_limits<double>::quiet_NaN();
  refineTriangleContact(pair.a, pair.b, enclosure(pair.turn), {0, 1}, r);
  EXPECT_FALSE(r.certain);
  EXPECT_EQ(r.t_lower, 0);
  EXPECT_EQ(r.t_upper, 1);
}

}  // namespace
}  // namespace elementary_test
}  // namespace fcl_artic
