// SPDX-License-Identifier: BSD-3-Clause
//
// The pads of doc/NUMERICS.md, section 9, as theorems that Gappa proves of the kernel's own formulas. The kernel runs
// once with numbers that record what is done with them (recorded.h). Each record becomes a script that states a bound
// on its rounding. The bounds come from the kernel's constants. README.md has the list, and what it leaves out.
//
// Symbols: u = 2^-52; x: how far the rotation turns in half an interval, bounded; S: the sum of all sizes; P(x) =
// (1 + 2.5 x)^2. The pad is u (2U + 160) P S.
#include <cstdio>
#include <cstring>
#include <fstream>
#include <functional>
#include <iostream>
#include <map>
#include <sstream>
#include <stdexcept>

#include "kernel.h"
#include "script.h"

namespace {

using fcl_artic::engine::PieceKind;
using kernel::Lanes;
using kernel::Mat3Lanes;
using kernel::RigidLanes;
using kernel::Vec3;
using kernel::Vec3Lanes;
using recording::Arithmetic;
using recording::Operation;
using recording::Real;
using recording::Recorded;
using recording::Statement;
using recording::tape;

/// Room for what norms of computed vectors exceed those of the model's by: U <= 2^32 ulps.
constexpr Real kMore = 1 + 0x1p-20, kMoreOfAll = 1 + 0x1p-17;
const Real kU = fcl_artic::kUlp.value;

// ---- Shares of kCertificateUlps. Shares that Gappa does not prove are set aside as in NUMERICS: the rounding of d
// itself 2, a direction longer than 1 by its own rounding 10.
constexpr Real kSeparationUlps = 95;  // from the quadratics to the comparison
constexpr Real kInverseUlps = 35;     // the inverse motion's quadratic
constexpr Real kSlackUlps = 6;        // margin, radii and remainder added up
constexpr Real kDerivativeUlps = 8;   // derivatives of the placement
constexpr Real kByHandUlps = 12;
constexpr Real kTurningUlps = 65;  // one of the cubic's points; twice that and 4 in the quadratic's middle point
static_assert(kSeparationUlps + kInverseUlps + kSlackUlps + kDerivativeUlps + kByHandUlps <=
              kernel::kCertificateUlps.value);
static_assert(2 * kTurningUlps + 4 + kSlackUlps + kDerivativeUlps + kByHandUlps <= kernel::kCertificateUlps.value);
// ---- Shares of a step: R C, the turn about z, sine and cosine (4 kUlp each, so sqrt(2) 4 in each of two columns).
constexpr Real kProductUlps = 9, kTurnAboutZUlps = 4, kSinesUlps = 8;
static_assert(kProductUlps + kTurnAboutZUlps + kSinesUlps <= kernel::kStepUlps.value);

/// A box of what a theorem is about. A theorem scales by powers of two with S (kLeastLength stands far above where
/// doubles end), so that S in [1, 2] is all.
struct Slice {
  Real x[2], s[2], l[2] = {1, 1};
  Real P() const {  // NOLINT(readability-identifier-naming): the theorems' letter
    return (1 + 2.5 * x[0]) * (1 + 2.5 * x[0]);
  }
};

struct Theorem {
  std::string name, formula, source, pad;
  std::function<void(const Slice&, Statement&)> state;
  std::vector<Slice> slices;
  bool quick = true;     ///< takes few seconds
  bool any_mode = true;  ///< componentwise bounds suffice in the directed modes too
  /// A part of the bound that Gappa has to refuse: it is below what it finds rounding may take.
  Real refused = 0.25;
};

const Recorded& of(const Lanes& x) {
  return x.r[0].x;
}
Recorded& of(Lanes& x) {
  return x.r[0].x;
}
using Nodes = std::vector<int>;
void add(Nodes& nodes, const Recorded& x) {
  nodes.push_back(x.node);
}
void add(Nodes& nodes, const Lanes& x) {
  nodes.push_back(of(x).node);
}
template <class T>
void add(Nodes& nodes, const kernel::Vec3Of<T>& v) {
  for (int i = 0; i < 3; ++i) add(nodes, v[i]);
}
template <class T>
void add(Nodes& nodes, const kernel::Mat3Of<T>& m) {
  for (int i = 0; i < 3; ++i) add(nodes, m[i]);
}
template <class... T>
Nodes nodesOf(const T&... all) {
  Nodes nodes;
  (add(nodes, all), ...);
  return nodes;
}

/// Inputs whose absolute values a vector of this length allows.
Vec3 vector(Statement& s, Real bound) {
  const Recorded x = s.input(bound), y = s.input(bound), z = s.input(bound);
  return {x, y, z};
}
Vec3Lanes vectorLanes(Statement& s, Real bound) {
  const Vec3 v = vector(s, bound);
  return kernel::spread(v);
}
Mat3Lanes matrixLanes(Statement& s, Real bound) {
  const Vec3Lanes x = vectorLanes(s, bound), y = vectorLanes(s, bound), z = vectorLanes(s, bound);
  return {x, y, z};
}
kernel::Mat3 matrix(Statement& s, Real bound) {
  const Vec3 x = vector(s, bound), y = vector(s, bound), z = vector(s, bound);
  return {x, y, z};
}
template <class T>
void known(Statement& s, const kernel::Vec3Of<T>& v, Real bound) {
  for (int i = 0; i < 3; ++i) s.known(of(v[i]), bound);
}

// ---- The separation test.

/// Sizes of a motion's quadratics: bounds on R's coefficients and Bernstein points, on c's, for x and S up to these.
struct Sizes {
  Real R[3], X, c[3], C;
  /// |c0|, |c1| <= length + D_1 d. |c2|: of the turns x^2 / 2, of slides that turn x, of the slides' own accelerations
  /// 1/2 (they are counted in `length`, as d <= 1/2). inverse: of R^T c.
  Sizes(Real x, Real S, bool inverse) : R{1, x, x * x}, X(1 + x + x * x), c{S, (1 + x) * S, (0.5 + x + x * x) * S} {
    if (inverse) {
      c[2] += x * c[1] + x * x * c[0];
      c[1] += x * c[0];
    }
    C = c[0] + c[1] + c[2];
    for (Real* bound : {&X, &C}) *bound *= kMoreOfAll;
  }
};

/// A piece of size up to S, and the numbers that its range is products of.
struct PieceInputs {
  fcl_artic::engine::TreeView tree;
  fcl_artic::engine::Piece piece;
  alignas(64) Recorded points[24];
  Nodes nodes;
  PieceInputs(Statement& s, PieceKind kind, Real S) {
    piece.kind = kind;
    piece.num_vertices = kind == PieceKind::hull ? 8 : 1;
    tree.vertices = tree.hulls = points;
    if (kind == PieceKind::vertices || kind == PieceKind::hull) {
      // One vertex is all: max and min take one, and are no farther off than it is.
      for (int i = 0; i < 24; ++i) points[i] = i < 3 ? s.input(S) : Recorded(0.0);
      if (kind == PieceKind::hull) {
        std::swap(points[1], points[8]);
        std::swap(points[2], points[16]);
        for (int k = 0; k < 3; ++k) std::fill(points + 8 * k + 1, points + 8 * k + 8, points[8 * k]);
      }
      for (const Recorded& p : points) nodes.push_back(p.node);
    } else {
      // |centre| + |half sizes| <= S.
      for (Recorded& c : piece.center) nodes.push_back((c = s.input(0.5 * S)).node);
      for (Recorded& h : piece.size) nodes.push_back((h = s.input(0, 0.5 * S)).node);
    }
  }
};

RigidLanes motion(Statement& s, const Sizes& sizes) {
  RigidLanes m;
  for (int k = 0; k < 3; ++k) {
    m.R[k] = matrixLanes(s, sizes.R[k] * kMore);
    m.c[k] = vectorLanes(s, sizes.c[k]);
  }
  return m;
}
/// The motion as certificates take it; inverse: with the sizes that the inverse motion has.
void prepare(Statement& s, const Slice& slice, bool inverse, kernel::Side& side) {
  const Sizes sizes(slice.x[1], slice.s[1], inverse);
  side.m = motion(s, sizes);
  side.m.makeBernstein();
  for (int k = 0; k < 3; ++k) {
    known(s, side.m.cb[k], sizes.C);
    for (int i = 0; i < 3; ++i) known(s, side.m.Rb[k][i], sizes.X);
  }
  side.m.rem_c = side.m.rem_R = 0.0;
}
/// A seen from B: what goes into a Bernstein point is at most the sum over the orders, and a vector is at most sqrt(3)
/// times its largest component.
void inverse(const Slice& slice, Statement& s) {
  const Sizes direct(slice.x[1], slice.s[1], false), seen(slice.x[1], slice.s[1], true);
  const RigidLanes m = motion(s, direct);
  RigidLanes back;
  kernel::invert(m, back);
  for (int k = 0; k < 3; ++k) {
    for (int l = 0; l < 3; ++l) {
      s.knownDots(nodesOf(m.R[k]), nodesOf(m.c[l]), direct.R[k] * direct.c[l] * kMoreOfAll);
    }
    s.known(of(back.c[k][0]), seen.c[k] * kMoreOfAll);
    s.offBy(of(back.c[k][0]), kInverseUlps / (3 * std::sqrt(3.0)) * kU * slice.P() * slice.s[0]);
  }
}
Nodes bernsteinR(const RigidLanes& m) {
  return nodesOf(m.Rb[0], m.Rb[1], m.Rb[2]);
}
Nodes bernsteinC(const RigidLanes& m) {
  return nodesOf(m.cb[0], m.cb[1], m.cb[2]);
}

/// The largest value of slackOf() that matters: with more, nothing could be separated, as n.c, h_m and h_s are smaller
/// together.
Real mostSlack(const Sizes& sizes, Real S) {
  return 1.01 * (sizes.X * S + sizes.C + S);
}

/// With the sizes of the inverse motion, which are those of the direct one or larger.
void separation(const Slice& slice, Statement& s, PieceKind kind) {
  const Real S = slice.s[1];
  const Sizes sizes(slice.x[1], S, true);
  kernel::Side side;
  prepare(s, slice, true, side);
  PieceInputs still(s, kind, S), moving(s, kind, S);
  side.still = &still.tree;
  side.moving = &moving.tree;
  const Vec3 n = vector(s, kMore);
  side.margin = s.input(0, mostSlack(sizes, S));
  side.pad = 0.0;
  recording::comparisons().clear();
  kernel::certainlySeparated(side, still.piece, moving.piece, n, kernel::kAllLanes);
  const Nodes u = s.knownDots(bernsteinR(side.m), nodesOf(n), sizes.X);
  s.knownDots(bernsteinC(side.m), nodesOf(n), sizes.C);
  s.knownDots(u, moving.nodes, sizes.X * S * kMoreOfAll);
  s.knownDots(nodesOf(n), still.nodes, S * kMoreOfAll);
  for (const int which : {0, kernel::kLanes}) {  // along n, along -n
    const auto& [a, b] = recording::comparisons().at(which);
    s.offBy(a, b, kSeparationUlps * kU * slice.P() * slice.s[0]);
  }
}

void slack(const Slice&, Statement& s) {
  kernel::Side side;
  fcl_artic::engine::Piece still, moving;
  const auto size = [&] { return s.input(0x1p-500, 0x1p100); };
  still.radius = size();
  moving.radius = size();
  moving.reach = size();
  side.m.rem_c = size();
  side.m.rem_R = size();
  side.margin = size();
  side.pad = size();
  s.offByPart(kernel::slackOf(side, still, moving), kSlackUlps * kU);
}

// ---- Along a direction that turns.

/// Point k of the cubic.
void turning(const Slice& slice, Statement& s, PieceKind kind, int k) {
  const Real S = slice.s[1], l = slice.l[1];
  const Sizes sizes(slice.x[1], S, false);
  kernel::Side side;
  prepare(s, slice, false, side);
  PieceInputs still(s, kind, S), moving(s, kind, S);
  side.still = &still.tree;
  side.moving = &moving.tree;
  const kernel::TurningDirection n = {vectorLanes(s, l), vectorLanes(s, l)};
  Lanes G[3];
  side.margin = s.input(0, S);
  side.pad = 0.0;
  kernel::gapBound(side, still.piece, moving.piece, n, G);
  const Nodes ends = nodesOf(n.begin, n.end);
  Nodes weighted;
  int length = 0;
  for (int i = 1; i < static_cast<int>(tape().size()); ++i) {
    const auto& e = tape()[i];
    if (e.operation != Operation::product) continue;
    const auto among = [&](const recording::Operand& o) {
      return o.node != 0 && std::find(ends.begin(), ends.end(), o.node) != ends.end();
    };
    if (among(e.of[0]) && e.of[1].node == 0) weighted.push_back(i);
    if (e.of[0].node != 0 && tape()[e.of[0].node].operation == Operation::root && length == 0) length = i;
  }
  // max(|n_0|, |n_1|) times the slack, which is another theorem's.
  if (length == 0) throw std::logic_error("theorems: gapBound() takes no length of the direction");
  s.cut({1, length}, 0, l * mostSlack(sizes, S));
  for (const int node : weighted) s.known({1, node}, l * kMoreOfAll);
  weighted.insert(weighted.end(), ends.begin(), ends.end());
  const Nodes u = s.knownDots(bernsteinR(side.m), weighted, l * sizes.X);
  s.knownDots(bernsteinC(side.m), weighted, l * sizes.C);
  s.knownDots(u, moving.nodes, l * sizes.X * S * kMoreOfAll);
  s.knownDots(ends, still.nodes, l * S * kMoreOfAll);
  // 3/2 g_1 and 3/2 g_2, the only products with that.
  Nodes inner;
  for (const auto& e : tape()) {
    for (int i = 0; i < 2; ++i) {
      if (e.operation == Operation::product && e.of[i].node == 0 && e.of[i].value == 1.5) {
        inner.push_back(e.of[1 - i].node);
      }
    }
  }
  if (inner.size() < 2 * kernel::kLanes) throw std::logic_error("theorems: gapBound() changed");
  const Recorded point = k == 0 ? of(G[0]) : k == 3 ? of(G[2]) : Recorded(1, inner[(k - 1) * kernel::kLanes]);
  s.offBy(point, kTurningUlps * kU * slice.P() * slice.s[0] * slice.l[0]);
}

// ---- Derivatives of the placement, products, one step.

/// x is a vector of length S, w x at most; bounds are for vectors' components.
void derivatives(const Slice& slice, Statement& s) {
  const Real w = slice.l[1], S = slice.s[1];
  kernel::FrameLanes f;
  f.w = vectorLanes(s, w * kMore);
  f.al = vectorLanes(s, w * w * kMore);
  const Vec3Lanes x = vectorLanes(s, S);
  const kernel::PointLanes turned = kernel::turned(f, x);
  known(s, turned.c[1], w * S * kMoreOfAll);
  known(s, turned.c[2], w * w * S * kMoreOfAll);
  // Over three columns of a rotation (Frobenius) thrice these; P >= 5 x and 6.25 x^2. The sums c + arm: 3/2.
  const Real rest = kDerivativeUlps - 2;
  for (int i = 0; i < 3; ++i) s.offBy(of(turned.c[1][i]), rest * 5 / 3 * kU * slice.l[0] * slice.s[0]);
  for (int i = 0; i < 3; ++i) {
    s.offBy(of(turned.c[2][i]), rest * 6.25 / 3 * kU * slice.l[0] * slice.l[0] * slice.s[0]);
  }
}

void product(const Slice&, Statement& s) {
  const Mat3Lanes R = matrixLanes(s, kMore);
  const kernel::Mat3 C = matrix(s, kMore);
  const Mat3Lanes RC = R * C;
  s.knownDots(nodesOf(R), nodesOf(C), kMoreOfAll);
  s.offBy(of(RC[0][0]), kProductUlps / 3 * kU);  // nine entries
}

void turnAboutZ(const Slice&, Statement& s) {
  const Mat3Lanes axes = matrixLanes(s, kMore);
  kernel::FrameLanes f;
  f.w = f.al = kernel::spread(Vec3(0, 0, 0));
  const Recorded q = s.input(1);
  kernel::turnAboutZ({Lanes(q), Lanes(0.0), Lanes(0.0)}, false, nullptr, axes, f);
  const auto& entry = tape()[of(f.R[0][0]).node];  // x c + y s
  if (entry.operation != Operation::product_plus) throw std::logic_error("theorems: turnAboutZ() changed");
  const auto& ys = tape()[entry.of[2].node];
  const Recorded c = {1, entry.of[1].node}, sine = {1, ys.of[1].node};
  s.cut(c, -kMore, kMore);
  s.cut(sine, -kMore, kMore);
  s.knownDots(nodesOf(axes), nodesOf(c, sine), kMoreOfAll);
  for (int k = 0; k < 2; ++k) {  // six entries
    s.known(of(f.R[0][k]), kMoreOfAll);
    s.offBy(of(f.R[0][k]), kTurnAboutZUlps / std::sqrt(6.0) * kU);
  }
}

// ---- Smaller ones.

/// Subdivided at any z, the coefficients are not above what they are without the reserve.
void prefix(const Slice& slice, Statement& s, int which) {
  Recorded G[3];
  for (int k = 0; k < 3; ++k) {
    G[k] = s.input(slice.s[1]);
    G[k].value = k == 0 ? 0.5 : k == 1 ? -0.4 : 0.6;  // goes down, passes 0, and comes back
  }
  recording::comparisons().clear();
  kernel::positivePrefix(G);
  // g_1 >= 0 does not hold; left >= 0, middle >= 0, right >= 0 follow.
  const auto& compared = recording::comparisons();
  const Recorded left = compared.at(1).first, middle = compared.at(2).first, right = compared.at(3).first;
  const auto& reserve = tape()[tape()[tape()[left.node].of[0].node].of[1].node];  // g_0 = G_0 - reserve
  if (reserve.operation != Operation::product) throw std::logic_error("theorems: positivePrefix() changed");
  const Real part = reserve.of[0].node == 0 ? reserve.of[0].value : reserve.of[1].value;
  const Recorded z = {0.5, tape()[tape()[left.node].of[1].node].of[0].node};
  s.cut(z, 0, 1);
  // Convex combinations of the coefficients.
  for (const Recorded& x : {left, middle, right}) s.known(x, (1 + part) * slice.s[1]);
  // Exactly taken off is part max|G|; that much may be lost again.
  const Recorded x = which == 0 ? left : which == 1 ? middle : right;
  s.offBy(x, part * slice.s[0]);
}

/// The polynomials as evaluated, from what the reduction left; it is off by u, the polynomials by 2^-57.
void sines(const Slice&, Statement& s, bool cosine) {
  Lanes of_sine, of_cosine;
  kernel::sineCosine(Lanes(s.input(1e6)), of_sine, of_cosine);
  int r = 0, sum = 0;
  for (int i = 1; i < static_cast<int>(tape().size()); ++i) {
    const auto& e = tape()[i];
    if (r == 0 && e.operation == Operation::product && e.of[0].node != 0 && e.of[0].node == e.of[1].node) {
      r = e.of[0].node;  // z = r r
    }
    if (r == 0 || sum != 0 || e.operation != Operation::product_plus) continue;
    const bool to_difference = e.of[2].node != 0 && tape()[e.of[2].node].operation == Operation::difference;
    if (cosine ? to_difference : e.of[2].node == r) sum = i;  // (z z) q + (1 - z / 2); (r z) p + r
  }
  if (sum == 0) throw std::logic_error("theorems: sineCosine() changed");
  s.cut({1, r}, -0.785398165, 0.785398165);
  s.offBy({1, sum}, (cosine ? 1.5 : 1.1) * kU);
}

/// For a cone, h + x is above, h - x below: both are no farther off than their parts.
void roundReach(const Slice& slice, Statement& s, PieceKind kind) {
  PieceInputs piece(s, kind, slice.s[1]);
  for (Recorded& h : piece.piece.size) s.cut(h, 0x1p-200, 0x1p100);
  const Vec3 u = {s.input(0x1p-200, 2), s.input(0x1p-200, 2), s.input(0x1p-200, 2)};
  Recorded down, up;
  if (kind == PieceKind::cylinder) kernel::CylinderKind::reach(piece.piece, u, down, up);
  if (kind == PieceKind::ellipsoid) kernel::EllipsoidKind::reach(piece.piece, u, down, up);
  s.offByPart(up, 10 * kU);
}

void length(const Slice&, Statement& s) {
  const Vec3 p = {s.input(0x1p-400, 0x1p100), s.input(0x1p-400, 0x1p100), s.input(0x1p-400, 0x1p100)};
  // As in sweepNode(), sweepLss(), Traversal: at least |p| for sure.
  s.offByPart(kernel::norm(p), 7 * kU);
}

void padItself(const Slice&, Statement& s) {
  const Recorded ulps = s.input(1, 0x1p40), x = s.input(0x1p-500, 0x1p20);
  s.offByPart(kernel::roundingPart(ulps, x), 10 * kU);
}

// ---- The list.

/// @param all  x up to 2^10 instead of 1.
std::vector<Theorem> theorems(bool all) {
  std::vector<Slice> all_x, sizes = {{{0, 0}, {1, 2}}}, sizes_l = {{{0, 0}, {1, 2}, {1, 2}}}, one = {{{0, 0}, {1, 1}}};
  const auto addSlices = [&](Real begin, Real end) {
    for (const Real S : {1.0, 1.5}) all_x.push_back({{begin, end}, {S, S == 1 ? 1.5 : 2}});
  };
  addSlices(0, 0x1p-4);
  addSlices(0x1p-4, 0x1p-2);
  for (Real x = 0x1p-2; x < (all ? 0x1p10 : 1); x *= 2) addSlices(x, 2 * x);
  std::vector<Slice> all_x_l;
  for (const Slice& slice : all_x) {
    for (const Real l : {1.0, 1.5}) {
      all_x_l.push_back(slice);
      all_x_l.back().l[0] = l;
      all_x_l.back().l[1] = l == 1 ? 1.5 : 2;
    }
  }

  std::vector<Theorem> list;
  const std::map<PieceKind, std::string> kinds = {
      {PieceKind::vertices, "vertices"}, {PieceKind::hull, "hull"}, {PieceKind::box, "box"}};
  for (const auto& [kind, name] : kinds) {
    list.push_back({"separation." + name, "makeBernstein, certainlySeparated", "narrowphase/certificate.h",
                    "kSeparationUlps", [kind = kind](const Slice& slice, Statement& s) { separation(slice, s, kind); },
                    all_x, kind == PieceKind::vertices});
  }
  list.push_back({"inverse", "invert", "motion/rigid_lanes.h", "kInverseUlps", inverse, all_x});
  list.push_back({"slack", "slackOf", "narrowphase/certificate.h", "6 of kCertificateUlps", slack, one});
  for (int k = 0; k < 4; ++k) {
    list.push_back({"turning." + std::to_string(k), "gapBound along a TurningDirection", "narrowphase/certificate.h",
                    "kTurningUlps",
                    [k](const Slice& slice, Statement& s) { turning(slice, s, PieceKind::vertices, k); }, all_x_l,
                    false, false});
  }
  list.push_back({"derivatives", "turned", "motion/rigid_lanes.h", "8 of kCertificateUlps", derivatives, sizes_l});
  list.push_back(
      {"product", "Mat3Lanes * Mat3", "numerics/vec3.h", "9 of kStepUlps, kTransformUlps", product, one, true, false});
  list.push_back({"turn_about_z", "turnAboutZ", "motion/factors.h", "4 of kStepUlps", turnAboutZ, one, true, false});
  for (int i = 0; i < 3; ++i) {
    const char* names[] = {"left", "middle", "right"};
    list.push_back({std::string("prefix.") + names[i], "positivePrefix", "narrowphase/certificate.h", "reserve",
                    [i](const Slice& slice, Statement& s) { prefix(slice, s, i); }, sizes, true, false});
  }
  list.push_back({"reach.cylinder", "CylinderKind::reach", "convex/piece_kinds.h", "10 of kCertificateUlps",
                  [](const Slice& slice, Statement& s) { roundReach(slice, s, PieceKind::cylinder); }, one, true, true,
                  0.1});
  list.push_back({"reach.ellipsoid", "EllipsoidKind::reach", "convex/piece_kinds.h", "10 of kCertificateUlps",
                  [](const Slice& slice, Statement& s) { roundReach(slice, s, PieceKind::ellipsoid); }, one, true, true,
                  0.1});
  list.push_back({"norm", "norm(p)", "numerics/vec3.h", "7 of 1 + 8 kUlp", length, one, true, true, 0.1});
  list.push_back({"sine", "sineCosine", "numerics/lanes.h", "1.1 of section 7's 2.1",
                  [](const Slice& slice, Statement& s) { sines(slice, s, false); }, one, true, true, 0.1});
  list.push_back({"cosine", "sineCosine", "numerics/lanes.h", "1.5 of section 7's 2.5",
                  [](const Slice& slice, Statement& s) { sines(slice, s, true); }, one, true, true, 0.1});
  list.push_back({"pad", "roundingPart", "motion/remainder.h", "second order", padItself, one});
  return list;
}

// ---- Gappa.

class Prover {
 public:
  Prover(std::string gappa, std::string folder) : gappa_(std::move(gappa)), folder_(std::move(folder)) {}

  /// Whether Gappa proves it on the whole slice, in parts if need be.
  bool proves(const Theorem& t, const Arithmetic& arithmetic, Real factor, const Slice& slice, int depth, Real* used) {
    Statement s;
    t.state(slice, s);
    const std::string file = folder_ + "/" + t.name + ".g";
    if (run(s.script(arithmetic, factor, false), file)) {
      if (used) *used = std::max(*used, factor * share(s, arithmetic, file));
      return true;
    }
    if (depth == 0) return false;
    Slice halves[2] = {slice, slice};
    const Real wide_s = slice.s[1] / slice.s[0], wide_l = slice.l[1] / slice.l[0];
    auto part = &Slice::s;
    if (wide_l > wide_s) part = &Slice::l;
    if (std::max(wide_l, wide_s) < 1.1) {
      part = &Slice::x;
      if (slice.x[0] == slice.x[1]) return false;
    }
    const Real middle = 0.5 * ((slice.*part)[0] + (slice.*part)[1]);
    (halves[0].*part)[1] = (halves[1].*part)[0] = middle;
    // The lower end is the harder one: S and l in the bound are the least.
    return proves(t, arithmetic, factor, halves[0], depth - 1, used) &&
           proves(t, arithmetic, factor, halves[1], depth - 1, used);
  }
  int runs() const { return runs_; }

 private:
  bool run(const std::string& script, const std::string& file) {
    std::ofstream(file) << script;
    ++runs_;
    return std::system((gappa_ + " -Eno-auto-dichotomy '" + file + "' > '" + file + ".log' 2>&1").c_str()) == 0;
  }
  /// The part of the bound that rounding takes at most, as Gappa finds it.
  Real share(const Statement& s, const Arithmetic& arithmetic, const std::string& file) {
    const std::string ask = file + ".ask";
    if (!run(s.script(arithmetic, 1, true), ask)) throw std::runtime_error("theorems: Gappa has no answer: " + ask);
    std::ifstream in(ask + ".log");
    std::vector<Real> found;
    for (std::string line; std::getline(in, line);) {
      const std::size_t at = line.rfind('{'), comma = line.rfind("2^(");
      if (line.find(" in [") == std::string::npos) continue;
      if (at == std::string::npos) {
        found.push_back(0);
      } else {
        found.push_back(comma == std::string::npos ? std::strtod(line.c_str() + at + 1, nullptr)
                                                   : std::exp2(std::strtod(line.c_str() + comma + 3, nullptr)));
      }
    }
    const std::vector<Real> bounds = s.bounds();
    if (found.size() != bounds.size()) throw std::runtime_error("theorems: Gappa answers something else: " + ask);
    // Gappa may answer in another order: all bounds but those of derivatives() are alike.
    Real most = 0;
    for (std::size_t i = 0; i < bounds.size(); ++i) most = std::max(most, bounds[i] > 0 ? found[i] / bounds[i] : 0);
    return most;
  }

  std::string gappa_, folder_;
  int runs_ = 0;
};

}  // namespace

/// Arguments: Gappa's program; a folder for the scripts; `quick`, `all` or `used`; a part of the names. With `all`
/// every theorem is proven, rounding to nearest, up, down and to zero. With `used` all are proven to nearest, and the
/// part of each bound that Gappa finds to be used is printed.
int main(int argc, char** argv) {
  if (argc < 4) {
    std::cerr << "usage: pads_theorems GAPPA FOLDER quick|all|used [NAME]\n";
    return 2;
  }
  const std::string what = argv[3], only = argc > 4 ? argv[4] : "";
  Prover prover(argv[1], argv[2]);
  std::vector<Arithmetic> ways = {{"ne", false}, {"ne", true}};
  if (what == "all") {
    for (const char* mode : {"up", "dn", "zr"}) ways.insert(ways.end(), {{mode, false}, {mode, true}});
  }
  if (what == "quick") ways.pop_back();
  int wrong = 0;
  for (const Theorem& t : theorems(what == "all")) {
    if (t.name.find(only) == std::string::npos || (what == "quick" && !t.quick)) continue;
    for (const Arithmetic& way : ways) {
      const bool nearest = std::strcmp(way.mode, "ne") == 0;
      if (!nearest && !t.any_mode) continue;
      const int before = prover.runs();
      Real share = 0;
      bool proven = true;
      for (const Slice& slice : t.slices) {
        proven = proven && prover.proves(t, way, 1, slice, 8, what == "used" ? &share : nullptr);
      }
      // It can fail: of what is too little nothing is proven.
      const bool refuses = !nearest || !prover.proves(t, way, t.refused, t.slices[0], 0, nullptr);
      std::printf("%-9s %-28s %s%s  %3d scripts", proven ? "proven" : "NOT PROVEN", t.name.c_str(), way.mode,
                  way.fused ? ", fused" : "       ", prover.runs() - before);
      if (what == "used") std::printf("  uses %.2f of the bound", share);
      std::printf("%s\n", refuses ? "" : "  NOT REFUSED with too small a bound");
      std::fflush(stdout);
      wrong += proven && refuses ? 0 : 1;
    }
  }
  std::printf("%s\n", wrong == 0 ? "all proven" : "not all proven");
  return wrong == 0 ? 0 : 1;
}
