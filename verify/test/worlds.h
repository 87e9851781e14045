// SPDX-License-Identifier: BSD-3-Clause
// Statements written for tests, a naive prover, and a judge: all in plain doubles, from samples of time. None of it is
// part of the verifier, and nothing in it has to be right for the verifier to be.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "../proof.h"

namespace verify::test {

using Rng = std::mt19937_64;
inline double uniform(Rng& rng, double a, double b) {
  return std::uniform_real_distribution<double>(a, b)(rng);
}

using V = std::array<double, 3>;
inline V operator+(const V& a, const V& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
inline V operator-(const V& a, const V& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline V operator*(double s, const V& a) {
  return {s * a[0], s * a[1], s * a[2]};
}
inline double dot(const V& a, const V& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline double norm(const V& a) {
  return std::sqrt(dot(a, a));
}

struct M {
  std::array<double, 9> R{1, 0, 0, 0, 1, 0, 0, 0, 1};
  V t{0, 0, 0};
};
inline const M kHere;
inline M at(double x, double y, double z) {
  M m;
  m.t = {x, y, z};
  return m;
}
inline V turn(const M& m, const V& x) {
  return {m.R[0] * x[0] + m.R[1] * x[1] + m.R[2] * x[2], m.R[3] * x[0] + m.R[4] * x[1] + m.R[5] * x[2],
          m.R[6] * x[0] + m.R[7] * x[1] + m.R[8] * x[2]};
}
inline V turnBack(const M& m, const V& x) {
  return {m.R[0] * x[0] + m.R[3] * x[1] + m.R[6] * x[2], m.R[1] * x[0] + m.R[4] * x[1] + m.R[7] * x[2],
          m.R[2] * x[0] + m.R[5] * x[1] + m.R[8] * x[2]};
}
inline V operator*(const M& m, const V& x) {
  return turn(m, x) + m.t;
}
inline M operator*(const M& a, const M& b) {
  M c;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      c.R[3 * i + j] = a.R[3 * i] * b.R[j] + a.R[3 * i + 1] * b.R[3 + j] + a.R[3 * i + 2] * b.R[6 + j];
  c.t = a * b.t;
  return c;
}
inline M rotationAbout(V axis, double angle) {
  M m;
  if (norm(axis) == 0) return m;
  axis = (1 / norm(axis)) * axis;
  const double c = std::cos(angle), s = std::sin(angle);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) m.R[3 * i + j] = (1 - c) * axis[i] * axis[j] + (i == j ? c : 0);
  m.R[1] -= s * axis[2], m.R[3] += s * axis[2], m.R[2] += s * axis[1];
  m.R[6] -= s * axis[1], m.R[5] -= s * axis[0], m.R[7] += s * axis[0];
  return m;
}
inline M anyPose(Rng& rng, double size) {
  M m = rotationAbout({uniform(rng, -1, 1), uniform(rng, -1, 1), uniform(rng, -1, 1)}, uniform(rng, -3, 3));
  m.t = {uniform(rng, -size, size), uniform(rng, -size, size), uniform(rng, -size, size)};
  return m;
}

// Text.
inline std::string hex(double x) {
  char text[40];
  std::snprintf(text, sizeof text, "%a", x);
  return text;
}
inline std::string hex(const M& m) {
  std::string s;
  for (const double x : m.R) s += hex(x) + " ";
  return s + hex(m.t[0]) + " " + hex(m.t[1]) + " " + hex(m.t[2]);
}
inline std::string hex(const V& x) {
  return hex(x[0]) + " " + hex(x[1]) + " " + hex(x[2]);
}
/// Vertices that no triangle has are left out.
inline std::string meshText(const std::vector<V>& vertices, const std::vector<std::array<int, 3>>& triangles,
                            bool solid) {
  std::vector<int> number(vertices.size(), -1);
  for (const auto& t : triangles)
    for (const int v : t) number[static_cast<std::size_t>(v)] = 0;
  std::string points, s;
  int count = 0;
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    if (number[v] < 0) continue;
    number[v] = count++;
    points += hex(vertices[v]) + "\n";
  }
  for (const auto& t : triangles)
    for (std::size_t k = 0; k < 3; ++k)
      s += std::to_string(number[static_cast<std::size_t>(t[k])]) + (k < 2 ? " " : "\n");
  return std::string("geometry mesh ") + (solid ? "solid" : "surface") + "\nvertices " + std::to_string(count) + "\n" +
         points + "triangles " + std::to_string(triangles.size()) + "\n" + s;
}
/// A box's surface, its triangles counter-clockwise from outside. @param half  its half sizes.
inline std::string boxMesh(const V& half, bool solid) {
  std::vector<V> v;
  for (int k = 0; k < 8; ++k)
    v.push_back({k & 1 ? half[0] : -half[0], k & 2 ? half[1] : -half[1], k & 4 ? half[2] : -half[2]});
  return meshText(v,
                  {{0, 2, 1},
                   {1, 2, 3},
                   {4, 5, 6},
                   {5, 7, 6},
                   {0, 1, 4},
                   {1, 5, 4},
                   {2, 6, 3},
                   {3, 6, 7},
                   {0, 4, 2},
                   {2, 4, 6},
                   {1, 3, 5},
                   {3, 7, 5}},
                  solid);
}
inline const std::string kHead = "fcl_artic world 1\n";

struct MotionText {
  double margin = 0, added = 0, until = 1;
  std::string scope = "self scene";
  std::string ignored;              // lines, of the first piece
  std::vector<std::string> pieces;  // each: lines "q ..." and "orientation ..."
  std::string write(const World& world) const {
    std::string s = "fcl_artic motion 1\nworld " + hexOf(world.hash) + "\nmargin " + hex(margin) + "\nadded " +
                    hex(added) + "\nscope " + scope + "\nduration " + hex(1) + "\nuntil " + hex(until) + "\n";
    for (std::size_t k = 0; k < pieces.size(); ++k) s += "piece\n" + (k == 0 ? ignored : "") + pieces[k];
    return s;
  }
};

// Proofs.
inline std::string little(std::uint64_t x, int n) {
  std::string s;
  for (int k = 0; k < n; ++k) s += static_cast<char>(x >> (8 * k));
  return s;
}
inline std::string varint(std::uint32_t x) {
  std::string s;
  for (; x > 127; x >>= 7) s += static_cast<char>(128 | (x & 127));
  return s + static_cast<char>(x);
}
inline std::string number(double x) {
  std::uint64_t bits;
  std::memcpy(&bits, &x, sizeof bits);
  return little(bits, 8);
}
inline std::string sep(const V& n, int where = 0) {
  const double scale = 30000 / std::max({std::fabs(n[0]), std::fabs(n[1]), std::fabs(n[2]), 1e-300});
  std::string s(1, static_cast<char>(where));
  for (const double x : n) s += little(static_cast<std::uint64_t>(std::lround(scale * x)), 2);
  return s;
}
inline std::string fine(const V& n, int where = 0) {
  const double scale = 2e9 / std::max({std::fabs(n[0]), std::fabs(n[1]), std::fabs(n[2]), 1e-300});
  std::string s(1, static_cast<char>(3 + where));
  for (const double x : n) s += little(static_cast<std::uint64_t>(std::llround(scale * x)), 4);
  return s;
}
inline std::string node(int kind, const std::string& first, const std::string& second) {
  return std::string(1, static_cast<char>(kind)) + first + second;
}
inline std::string cutNode(int kind, std::uint32_t c, const std::string& first, const std::string& second) {
  return std::string(1, static_cast<char>(kind)) + varint(c) + first + second;
}
inline std::string record(const std::string& motion, const std::string& nodes) {
  const std::string proof = sha256(motion) + nodes;
  return "FAC2" + little(motion.size(), 4) + motion + little(proof.size(), 4) + proof;
}
inline Verdict judge(const World& world, const std::string& bytes, const Options& options = {}) {
  const std::vector<Record> records = splitRecords(bytes);
  return verifyRecord(world, records.at(0), options);
}
inline Verdict judge(const World& world, const std::string& motion, const std::string& nodes) {
  return judge(world, record(motion, nodes));
}

/// Where one world of the tube is off the motion.
struct Errors {
  std::vector<double> of_variable;
  std::map<int, M> of_rotation, of_frame;  // by variable, by frame
  std::vector<M> of_body;                  // in the geometry's coordinates
};

/// The bodies of a motion where they are at a time, in doubles.
class Sampler {
 public:
  /// @param errors  that the bodies have against the motion; null: none.
  Sampler(const World& world, const Motion& motion, const Errors* errors = nullptr)
      : world(world), motion(motion), errors(errors) {}
  double q(std::size_t piece, int v, double t) const {
    const auto& polynomials = motion.pieces[piece].polynomials;
    const auto p = polynomials.find(v);
    double x = 0;
    if (p == polynomials.end()) return x;
    for (std::size_t k = p->second.size(); k-- > 0;) x = x * t + p->second[k];
    return x;
  }
  std::vector<M> frames(std::size_t piece, double t) const {
    std::vector<M> all(1);
    for (std::size_t f = 1; f < world.frames.size(); ++f) {
      const Frame& frame = world.frames[f];
      M m = all[static_cast<std::size_t>(frame.parent)] * stated(frame.numbers);
      if (errors) m = withError(m, errors->of_frame, static_cast<int>(f));
      for (const Element& e : frame.elements) {
        const V axis{e.axis[0], e.axis[1], e.axis[2]};
        if (e.kind == Element::rotate) {
          const V w{q(piece, e.variable, t), q(piece, e.variable + 1, t), q(piece, e.variable + 2, t)};
          m = m * rotationAbout(w, norm(w));
          const auto& orientations = motion.pieces[piece].orientations;
          if (const auto o = orientations.find(e.variable); o != orientations.end()) {
            M r;
            r.R = o->second;
            m = m * r;
          }
          if (errors) m = withError(m, errors->of_rotation, e.variable);
          continue;
        }
        const double error = errors ? errors->of_variable[static_cast<std::size_t>(e.variable)] : 0;
        const double x = e.multiplier * (q(piece, e.variable, t) + error) + e.offset;
        if (e.kind == Element::turn) m = m * rotationAbout(axis, x);
        if (e.kind == Element::slide) m.t = m.t + turn(m, (x / norm(axis)) * axis);
      }
      all.push_back(m);
    }
    return all;
  }
  std::vector<M> bodies(std::size_t piece, double t) const {
    const std::vector<M> f = frames(piece, t);
    std::vector<M> all;
    for (const Body& body : world.bodies) all.push_back(f[static_cast<std::size_t>(body.frame)] * stated(body.numbers));
    for (std::size_t b = 0; errors && b < all.size(); ++b) all[b] = all[b] * errors->of_body[b];
    return all;
  }
  static M stated(const double n[12]) {
    M m;
    std::copy(n, n + 9, m.R.begin());
    m.t = {n[9], n[10], n[11]};
    return m;
  }
  const World& world;
  const Motion& motion;
  const Errors* errors;

 private:
  static M withError(const M& m, const std::map<int, M>& of, int number) {
    const auto error = of.find(number);
    return error == of.end() ? m : m * error->second;
  }
};

/// The farthest point of a geometry's pieces [i, j) along n, in its own coordinates.
inline V farthest(const Geometry& g, std::uint32_t i, std::uint32_t j, const V& n) {
  V best{};
  double most = -1e300;
  const auto take = [&](const V& p) {
    if (dot(p, n) > most) most = dot(p, n), best = p;
  };
  const auto vertex = [&](std::size_t k) { return V{g.vertices[3 * k], g.vertices[3 * k + 1], g.vertices[3 * k + 2]}; };
  const auto corners = [&](const V& c, const V& h) {
    take({c[0] + (n[0] < 0 ? -h[0] : h[0]), c[1] + (n[1] < 0 ? -h[1] : h[1]), c[2] + (n[2] < 0 ? -h[2] : h[2])});
  };
  const auto round = [&](double z, const V& a) {
    const V an{a[0] * n[0], a[1] * n[1], a[2] * n[2]};
    const double l = norm(an);
    V p{0, 0, z};
    if (l > 0)
      for (std::size_t k = 0; k < 3; ++k) p[k] += a[k] * an[k] / l;
    take(p);
  };
  const std::vector<double>& s = g.numbers;
  switch (g.kind) {
    case Geometry::mesh:
      for (std::size_t k = 3 * static_cast<std::size_t>(i); k < 3 * static_cast<std::size_t>(j); ++k)
        take(vertex(g.triangles[k]));
      break;
    case Geometry::hull:
      for (std::size_t k = 0; k < g.vertices.size() / 3; ++k) take(vertex(k));
      break;
    case Geometry::boxes:
      for (std::size_t k = i; k < j; ++k)
        corners({g.cells[6 * k], g.cells[6 * k + 1], g.cells[6 * k + 2]},
                {g.cells[6 * k + 3], g.cells[6 * k + 4], g.cells[6 * k + 5]});
      break;
    case Geometry::box:
      corners({0, 0, 0}, {s[0] / 2, s[1] / 2, s[2] / 2});
      break;
    case Geometry::sphere:
      round(0, {s[0], s[0], s[0]});
      break;
    case Geometry::ellipsoid:
      round(0, {s[0], s[1], s[2]});
      break;
    case Geometry::capsule:
      round(s[1] / 2, {s[0], s[0], s[0]}), round(-s[1] / 2, {s[0], s[0], s[0]});
      break;
    case Geometry::cylinder:
      round(s[1] / 2, {s[0], s[0], 0}), round(-s[1] / 2, {s[0], s[0], 0});
      break;
    case Geometry::cone:
      round(-s[1] / 2, {s[0], s[0], 0}), take({0, 0, s[1] / 2});
      break;
    case Geometry::halfspace:
    case Geometry::plane:
      break;
  }
  return best;
}

/// Gilbert's algorithm: towards the point of least norm of a convex set. The distance from 0 to the set is in
/// [lower, upper]. @param least  the set's least point along a direction.
struct Nearest {
  V x;
  double lower = 0, upper = 0;
};
inline Nearest nearest(V x, const std::function<V(const V&)>& least, int steps) {
  Nearest result;
  for (int k = 0; k < steps; ++k) {
    const V s = least(x), d = s - x;
    const double n = norm(x);
    if (n > 0) result.lower = std::max(result.lower, dot(x, s) / n);
    if (dot(d, d) == 0) break;
    const double f = std::min(1.0, std::max(0.0, -dot(x, d) / dot(d, d)));
    if (f == 0) break;
    x = x + f * d;
  }
  result.x = x;
  result.upper = norm(x);
  return result;
}

/// The distance of two bodies' convex pieces at a time; halfspaces are exact.
inline double upperDistance(const World& world, const std::vector<M>& poses, int a, int b, int steps = 200) {
  const auto geometry = [&](int k) -> const Geometry& {
    return world.geometries[static_cast<std::size_t>(world.bodies[static_cast<std::size_t>(k)].geometry)];
  };
  const M &A = poses[static_cast<std::size_t>(a)], &B = poses[static_cast<std::size_t>(b)];
  if (geometry(a).unbounded()) return upperDistance(world, poses, b, a, steps);
  if (geometry(b).unbounded()) {
    const std::vector<double>& s = geometry(b).numbers;
    const V n = turn(B, {s[0], s[1], s[2]});
    const double d = s[3] + dot(n, B.t);
    const auto gap = [&](const V& m, double e) {
      return (dot(m, A * farthest(geometry(a), 0, geometry(a).pieces(), turnBack(A, -1 * m))) - e) / norm(m);
    };
    const double one = gap(n, d);
    return std::max(0.0, geometry(b).kind == Geometry::plane ? std::max(one, gap(-1 * n, -d)) : one);
  }
  double best = 1e300;
  for (std::uint32_t i = 0; i < geometry(a).pieces(); ++i) {
    for (std::uint32_t j = 0; j < geometry(b).pieces(); ++j) {
      const auto least = [&](const V& n) {
        return A * farthest(geometry(a), i, i + 1, turnBack(A, -1 * n)) -
               B * farthest(geometry(b), j, j + 1, turnBack(B, n));
      };
      best = std::min(best, nearest(least({1, 0.3, 0.2}), least, steps).upper);
    }
  }
  return best;
}

/// A proof by samples: may be wrong, and is then for the verifier to refuse.
class Prover {
 public:
  Prover(const World& world, const Motion& motion, int samples = 9)
      : world_(world), motion_(motion), sampler_(world, motion), samples_(samples) {}
  /// Whether every node that was written is right at its samples.
  bool complete = true;
  int most_time_depth = 6;
  /// By how much a pair's margin grows.
  std::function<double(int, int)> more = [](int, int) { return 0.0; };

  std::string roots() {
    std::string s;
    for (piece_ = 0; piece_ < motion_.pieces.size(); ++piece_) {
      const double end = piece_ + 1 == motion_.pieces.size() ? motion_.until : 1;
      for (std::size_t a = 0; a < world_.bodies.size(); ++a) {
        a_ = static_cast<int>(a);
        partners_ = opponents(world_, motion_, piece_, a_);
        if (partners_.empty()) continue;
        Task task{0, geometry(a_).pieces(), 0, static_cast<std::uint32_t>(partners_.size()), 0, 0, 0, end, 0};
        choose(task);
        s += prove(task);
      }
    }
    return s;
  }

 private:
  struct Task {
    std::uint32_t i, j, p, q, k, l;
    double t0, t1;
    int depth;
    bool outside = false;
  };
  const Geometry& geometry(int body) const {
    return world_.geometries[static_cast<std::size_t>(world_.bodies[static_cast<std::size_t>(body)].geometry)];
  }
  int partner(std::uint32_t k) const { return partners_[k].body; }
  double marginOf(std::uint32_t k) const { return toDouble(partners_[k].margin) + more(a_, partner(k)); }
  void choose(Task& t) const {
    if (t.q - t.p == 1) t.k = 0, t.l = geometry(partner(t.p)).pieces();
  }
  std::string prove(const Task& t) {
    const bool single = t.q - t.p == 1;
    bool unbounded = geometry(a_).unbounded();
    for (std::uint32_t k = t.p; k < t.q; ++k) unbounded = unbounded || geometry(partner(k)).unbounded();
    if (unbounded && !single) return halves(t);
    if (unbounded) {
      bool front = true, back = geometry(a_).kind == Geometry::plane || geometry(partner(t.p)).kind == Geometry::plane;
      const int wall = geometry(a_).unbounded() ? a_ : partner(t.p), other = wall == a_ ? partner(t.p) : a_;
      for (int m = 0; m < samples_; ++m) {
        const double time = t.t0 + (t.t1 - t.t0) * m / (samples_ - 1);
        if (time < toDouble(partners_[t.p].from)) continue;
        const std::vector<M> poses = sampler_.bodies(piece_, time);
        const M &W = poses[static_cast<std::size_t>(wall)], &O = poses[static_cast<std::size_t>(other)];
        const std::vector<double>& s = geometry(wall).numbers;
        const V n = turn(W, {s[0], s[1], s[2]});
        const auto lowest = [&](const V& m_) {
          return dot(m_, O * farthest(geometry(other), 0, geometry(other).pieces(), turnBack(O, -1 * m_)) - W.t);
        };
        const double margin = marginOf(t.p) * norm(n);
        front = front && lowest(n) > s[3] + margin;
        back = back && lowest(-1 * n) > -s[3] + margin;
      }
      if (!front && !back) complete = false;
      return std::string(1, static_cast<char>(back && !front ? 0x0a : 0x09));
    }
    V best{1, 0, 0};
    int where = 0;
    for (int w = 0; w < 3; ++w) {
      V n;
      if (apart(t, w, n)) return partners_.size() % 2 ? sep(n, w) : fine(n, w);
      if (w == 0) best = n;
    }
    if (!single) return halves(t);
    if (t.depth < most_time_depth) {
      Task a = t, b = t;
      a.t1 = b.t0 = (t.t0 + t.t1) / 2;
      ++a.depth, ++b.depth;
      const std::string first = prove(a);
      return node(kTime, first, prove(b));
    }
    if (t.j - t.i > 1) {
      Task a = t, b = t;
      a.j = b.i = t.i + (t.j - t.i) / 2;
      const std::string first = prove(a);
      return cutNode(kOwn, a.j - a.i, first, prove(b));
    }
    if (t.l - t.k > 1) {
      Task a = t, b = t;
      a.l = b.k = t.k + (t.l - t.k) / 2;
      const std::string first = prove(a);
      return cutNode(kOther, a.l - a.k, first, prove(b));
    }
    complete = false;
    return sep(best, where);
  }
  std::string halves(const Task& t) {
    Task a = t, b = t;
    a.q = b.p = t.p + (t.q - t.p) / 2;
    choose(a), choose(b);
    const std::string first = prove(a);
    return cutNode(kPartners, a.q - a.p, first, prove(b));
  }
  /// A direction in a frame along which all samples of the task are apart.
  bool apart(const Task& t, int where, V& n) {
    std::vector<std::vector<M>> poses;  // relative to the frame
    std::vector<double> times;
    for (int m = 0; m < samples_; ++m) {
      const double time = t.t0 + (t.t1 - t.t0) * m / (samples_ - 1);
      const std::vector<M> frames = sampler_.frames(piece_, time);
      const int f = where == 0 ? 0 : world_.bodies[static_cast<std::size_t>(where == 1 ? a_ : partner(t.p))].frame;
      const M& F = frames[static_cast<std::size_t>(f)];
      M inverse;
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) inverse.R[3 * i + j] = F.R[3 * j + i];
      inverse.t = -1 * turnBack(F, F.t);
      std::vector<M> bodies = sampler_.bodies(piece_, time);
      for (M& b : bodies) b = inverse * b;
      poses.push_back(bodies);
      times.push_back(time);
    }
    const bool single = t.q - t.p == 1;
    double margin = 0;
    for (std::uint32_t k = t.p; k < t.q; ++k) margin = std::max(margin, marginOf(k));
    const auto least = [&](const V& d) {
      V best{};
      double value = 1e300;
      for (std::size_t m = 0; m < poses.size(); ++m) {
        const M& A = poses[m][static_cast<std::size_t>(a_)];
        const V x = A * farthest(geometry(a_), t.i, t.j, turnBack(A, -1 * d));
        for (std::uint32_t k = t.p; k < t.q; ++k) {
          if (times[m] < toDouble(partners_[k].from)) continue;
          const M& B = poses[m][static_cast<std::size_t>(partner(k))];
          const Geometry& g = geometry(partner(k));
          const V y = B * farthest(g, single ? t.k : 0, single ? t.l : g.pieces(), turnBack(B, d));
          if (dot(d, x - y) < value) value = dot(d, x - y), best = x - y;
        }
      }
      return value == 1e300 ? 1e6 * d : best;
    };
    const Nearest result = nearest(least({0.3, 0.5, 1}), least, 60);
    n = result.x;
    const double length = norm(n);
    // 1 % and 1e-6 m for what lies between samples and for n's rounding
    return length > 0 && dot(n, least(n)) / length > margin * 1.0001 + 0.01 * length + 1e-6;
  }

  const World& world_;
  const Motion& motion_;
  const Sampler sampler_;
  const int samples_;
  std::size_t piece_ = 0;
  int a_ = 0;
  std::vector<Opponent> partners_;
};

}  // namespace verify::test
