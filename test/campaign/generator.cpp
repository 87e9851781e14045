// SPDX-License-Identifier: BSD-3-Clause
#include "generator.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>

#include "oracle.h"

namespace campaign {
namespace {

constexpr double kDegree = M_PI / 180;

using Triangles = std::vector<std::array<int, 3>>;

Geometry::BV anyBV(Random& random) {
  return static_cast<Geometry::BV>(random.below(4));
}

/// A closed surface over a grid of (rows + 1) x columns points, f(row in [0, 1], angle); poles collapse to one point.
template <typename F>
GeometryPtr revolved(const std::string& name, int rows, int columns, bool closed_rows, F f, Random& random) {
  std::vector<Vec3> v;
  Triangles t;
  const auto point = [&](int r, int c) { return f(static_cast<double>(r) / rows, 2 * M_PI * c / columns); };
  if (closed_rows) {  // a torus
    for (int r = 0; r < rows; ++r)
      for (int c = 0; c < columns; ++c) v.push_back(point(r, c));
    const auto id = [&](int r, int c) { return (r % rows) * columns + c % columns; };
    for (int r = 0; r < rows; ++r)
      for (int c = 0; c < columns; ++c) {
        t.push_back({id(r, c), id(r, c + 1), id(r + 1, c + 1)});
        t.push_back({id(r, c), id(r + 1, c + 1), id(r + 1, c)});
      }
  } else {
    v.push_back(point(0, 0));
    for (int r = 1; r < rows; ++r)
      for (int c = 0; c < columns; ++c) v.push_back(point(r, c));
    v.push_back(point(rows, 0));
    const int last = static_cast<int>(v.size()) - 1;
    const auto id = [&](int r, int c) { return 1 + (r - 1) * columns + c % columns; };
    for (int c = 0; c < columns; ++c) {
      t.push_back({0, id(1, c), id(1, c + 1)});
      t.push_back({last, id(rows - 1, c + 1), id(rows - 1, c)});
    }
    for (int r = 1; r + 1 < rows; ++r)
      for (int c = 0; c < columns; ++c) {
        t.push_back({id(r, c), id(r + 1, c), id(r + 1, c + 1)});
        t.push_back({id(r, c), id(r + 1, c + 1), id(r, c + 1)});
      }
  }
  const std::string full_name = name + std::to_string(t.size());
  return Geometry::mesh(full_name, std::move(v), std::move(t), anyBV(random));
}

GeometryPtr starMesh(int rows, int columns, double size, double bumps, Random& random) {
  std::array<Vec3, 4> wave;
  for (Vec3& w : wave) w = random.vector(1, 6);
  const Vec3 stretch = random.inBox(0.4, 1);
  return revolved(
      "star", rows, columns, false,
      [&](double s, double a) {
        const Vec3 d(std::sin(M_PI * s) * std::cos(a), std::sin(M_PI * s) * std::sin(a), std::cos(M_PI * s));
        double r = 1;
        for (const Vec3& w : wave) r += bumps * std::sin(w.dot(d));
        return Vec3(size / 2 * r * d.cwiseProduct(stretch));
      },
      random);
}

GeometryPtr torusMesh(int rows, int columns, double size, Random& random) {
  const double thick = random.uniform(0.2, 0.45);
  return revolved(
      "torus", rows, columns, true,
      [&](double s, double a) {
        const double r = size / 2 * (1 - thick / 2 + thick / 2 * std::cos(2 * M_PI * s));
        return Vec3(r * std::cos(a), r * std::sin(a), size / 2 * thick / 2 * std::sin(2 * M_PI * s));
      },
      random);
}

/// Loose triangles, slivers among them.
GeometryPtr soupMesh(int n, double size, Random& random) {
  std::vector<Vec3> v;
  Triangles t;
  for (int i = 0; i < n; ++i) {
    const Vec3 c = random.vector(0, size / 2);
    const Vec3 u = random.direction(), w = random.direction().cross(u).normalized();
    const double a = size * random.uniform(0.05, 0.4), b = a * random.logUniform(0.02, 1);
    v.insert(v.end(), {c, c + a * u, c + random.unit() * a * u + b * w});
    t.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return Geometry::mesh("soup" + std::to_string(n), std::move(v), std::move(t), anyBV(random));
}

GeometryPtr anyShape(Random& random, double low, double high) {
  const auto size = [&] { return random.uniform(low, high); };
  switch (random.below(3)) {
    case 0: {
      const double x = size(), y = size(), z = size();
      return Geometry::box({x, y, z});
    }
    case 1: {
      const double r = size() / 2, l = size();
      return Geometry::cylinder(r, l);
    }
    default:
      return Geometry::sphere(size() / 2);
  }
}

/// Step of the motion: 0.1 to 350 degrees.
double anyAngle(Random& random) {
  return kDegree * (random.chance(0.5) ? random.logUniform(0.1, 350) : random.uniform(5, 350));
}

void requestOf(Scene& s, Random& random) {
  if (random.chance(0.2)) s.tolerance_time = random.logUniform(1e-9, 1e-3);
  if (random.chance(0.2)) s.tolerance_distance = random.logUniform(1e-8, 1e-3);
  if (random.chance(0.08)) s.margin = random.logUniform(1e-4, 0.05);
  if (random.chance(0.15)) s.every_pair = true;
  if (random.chance(0.3)) s.max_contacts = 4;
}

Pose anyPose(Random& random, const Vec3& p) {
  return {random.rotation(), p};
}

/// Mostly free joint axes, some along a coordinate axis, as robots have them.
Vec3 anyAxis(Random& random) {
  if (random.chance(0.5)) return random.direction();
  Vec3 a = Vec3::Zero();
  a[random.below(3)] = random.sign();
  return a;
}

void setVariables(Scene& s, double angle, Random& random) {
  for (const Link& l : s.links) {
    if (!l.hasVariable()) continue;
    const bool slide = l.joint == JointKind::prismatic;
    const double start = slide ? random.uniform(-0.2, 0.2) : random.uniform(-M_PI, M_PI);
    const double step = (slide ? angle / (2 * M_PI) * 0.8 : angle) * random.uniform(-1, 1);
    s.q0.push_back(start);
    s.q1.push_back(start + step);
  }
}

/// One body that moves by one to three joints, before one obstacle (body 1, not placed yet).
Scene rigidScene(const std::string& bodies, Random& random) {
  Scene s;
  const auto mesh = [&] { return MeshLibrary::instance().any(random); };
  const auto shape = [&] { return anyShape(random, 0.08, 0.6); };
  GeometryPtr a, b;
  if (bodies == "mesh_mesh") a = mesh(), b = mesh();
  if (bodies == "shape_shape") a = shape(), b = shape();
  if (bodies == "mesh_shape") {
    a = mesh(), b = shape();
    if (random.chance(0.5)) std::swap(a, b);
  }
  s.links.emplace_back();
  const int joints = random.between(1, 3);
  for (int j = 0; j < joints; ++j) {
    Link l;
    l.parent = j;
    l.joint = random.chance(0.4)   ? JointKind::prismatic
              : random.chance(0.5) ? JointKind::revolute
                                   : JointKind::continuous;
    l.axis = anyAxis(random);
    l.origin = anyPose(random, random.vector(0, 0.5));
    s.links.push_back(l);
  }
  setVariables(s, anyAngle(random), random);
  if (joints == 1) s.q1[0] += random.sign() * 0.3 * std::abs(s.q1[0] - s.q0[0]);
  s.bodies.push_back({a, joints, anyPose(random, random.vector(0, 0.4))});
  s.bodies.push_back({b, -1, anyPose(random, Vec3::Zero())});
  return s;
}

/// An arm or a tree with geometry on most links.
Scene armScene(bool tree, Random& random) {
  Scene s;
  const int joints = random.between(1, 9);
  const int roots = tree && random.chance(0.2) ? 2 : 1;
  std::vector<double> length;
  for (int r = 0; r < roots; ++r) s.links.emplace_back(), length.push_back(0.2);
  for (int j = 0; j < joints; ++j) {
    Link l;
    const int count = static_cast<int>(s.links.size());
    l.parent = tree && random.chance(0.4) ? random.below(count) : (j == 0 ? 0 : count - 1);
    const double kind = random.unit();
    l.joint = kind < 0.5    ? JointKind::revolute
              : kind < 0.7  ? JointKind::continuous
              : kind < 0.87 ? JointKind::prismatic
                            : JointKind::fixed;
    l.axis = anyAxis(random);
    const bool any_turn = random.chance(0.5);
    const int turn_axis = random.below(3), quarters = random.between(0, 3);
    const Mat3 turn = any_turn ? random.rotation() : rotationAbout(Vec3::Unit(turn_axis), M_PI / 2 * quarters);
    l.origin = {turn, Vec3(0, 0, length[static_cast<std::size_t>(l.parent)]) + 0.02 * random.direction()};
    // A second root stands aside.
    if (l.parent < roots) l.origin.p += Vec3(0.5 * l.parent, 0, 0);
    std::vector<int> masters;
    for (int m = roots; m < count; ++m)
      if (s.links[static_cast<std::size_t>(m)].hasVariable()) masters.push_back(m);
    if (l.joint != JointKind::fixed && !masters.empty() && random.chance(0.12)) {
      l.master = masters[static_cast<std::size_t>(random.below(static_cast<int>(masters.size())))];
      l.multiplier = random.uniform(-1.5, 1.5);
      l.offset = random.uniform(-0.5, 0.5);
      if (l.joint == JointKind::prismatic) l.multiplier *= 0.1, l.offset *= 0.1;
    }
    s.links.push_back(l);
    length.push_back(random.uniform(0.12, 0.4));
  }
  const bool mimicking = std::any_of(s.links.begin(), s.links.end(), [](const Link& l) { return l.master >= 0; });
  s.shortest = !mimicking && random.chance(0.15);
  setVariables(s, anyAngle(random), random);
  for (int i = 0; i < static_cast<int>(s.links.size()); ++i) {
    if (i < roots ? random.chance(0.6) : random.chance(0.12)) continue;
    const double l = length[static_cast<std::size_t>(i)];
    Pose offset{Mat3::Identity(), Vec3(0, 0, l / 2)};
    GeometryPtr g;
    switch (random.below(5)) {
      case 0:
        g = Geometry::box({random.uniform(0.03, 0.1), random.uniform(0.03, 0.1), l});
        break;
      case 1:
        g = Geometry::cylinder(random.uniform(0.02, 0.06), l);
        break;
      case 2:
        g = Geometry::sphere(random.uniform(0.04, 0.1));
        break;
      case 3:
        g = MeshLibrary::instance().bar(random, l);
        break;
      default:
        g = MeshLibrary::instance().bar(random, l);
        offset.R = random.rotation();
    }
    s.bodies.push_back({g, i, offset});
    if (random.chance(0.1)) s.bodies.push_back({Geometry::sphere(0.06), i, {Mat3::Identity(), Vec3(0.05, 0, l)}});
  }
  if (s.bodies.empty()) s.bodies.push_back({Geometry::box({0.1, 0.1, 0.3}), static_cast<int>(s.links.size()) - 1, {}});
  return s;
}

int firstObstacle(const Scene& s) {
  int i = 0;
  while (s.bodies[static_cast<std::size_t>(i)].link >= 0) ++i;
  return i;
}

/// Puts the obstacle so that at time t it is about `gap` from a point of the body's surface (negative: it overlaps).
void placeBeside(Scene& s, int obstacle, int body, double t, double gap, Random& random) {
  const Kinematics k(s);
  const Body& moving = s.bodies[static_cast<std::size_t>(body)];
  Body& o = s.bodies[static_cast<std::size_t>(obstacle)];
  const Pose M = k.bodyPose(body, t);
  const Vec3 x = M * random.pointOf(*moving.geometry);
  const Vec3 own = o.pose.R * random.pointOf(*o.geometry);
  Vec3 outward = x - M * moving.geometry->centre();
  outward = outward.norm() > 1e-6 ? Vec3(outward.normalized()) : random.direction();
  o.pose.p = x + gap * outward - own;
}

/// Least gap of the scene over the motion; pairs of links only where `self`.
PairTruth nearestApproach(const Scene& s, bool self) {
  const Oracle oracle(s);
  PairTruth best;
  best.gap = std::numeric_limits<double>::infinity();
  for (const auto& [a, b] : oracle.kinematics().pairs()) {
    if (!self && s.bodies[static_cast<std::size_t>(b)].link >= 0) continue;
    const PairTruth p = oracle.leastGap(a, b, best.gap);
    if (p.hit || p.gap < best.gap) best = p;
    if (best.hit) break;
  }
  return best;
}

/// Moves the obstacle straight towards the centre of the body as it is at time t, from outside, until they are `gap`
/// apart (negative: that deep along the normal). False when it passes by, or the gap is not reached.
bool makeTouch(Scene& s, int obstacle, int body, double t, double gap, Random& random) {
  const Oracle oracle(s);
  const Body& moving = s.bodies[static_cast<std::size_t>(body)];
  Body& o = s.bodies[static_cast<std::size_t>(obstacle)];
  const Pose M = oracle.kinematics().bodyPose(body, t);
  const Vec3 aim = M * random.pointOf(*moving.geometry);
  const Vec3 towards = -random.direction();
  o.pose.p =
      aim - (moving.geometry->radius() + o.geometry->radius() + 0.1) * 2 * towards - o.pose.R * o.geometry->centre();
  Proximity p;
  for (int i = 0; i < 40; ++i) {
    p = oracle.at(body, obstacle, t, 1e-3, p);
    if (p.touching || p.gap > 3) return false;
    if (p.gap < std::abs(gap) + 1e-4) break;
    o.pose.p += (p.gap - std::abs(gap)) * towards;
  }
  if (p.direction.isZero() || p.gap > std::abs(gap) + 1e-3) return false;
  o.pose.p -= (p.gap - gap) * p.direction;
  return true;
}

/// Moves the obstacle along the normal of the nearest approach until the least gap is `target` (below 0: that deep at
/// what was the nearest approach). Where that is at the start, the motion is turned round.
void makeGraze(Scene& s, int obstacle, double target) {
  constexpr double kWindow = 0.01;  // in t: there the minimum is followed while the obstacle moves
  const double wanted = std::abs(target);
  const auto reached = [&](const PairTruth& p) { return std::abs(p.gap - wanted) <= 0.2 * wanted + 1e-11; };
  Body& o = s.bodies[static_cast<std::size_t>(obstacle)];
  PairTruth p;
  for (int round = 0, measured = 0; round < 12 && measured < 4; ++round) {
    p = nearestApproach(s, false);
    if (p.b != obstacle) return;
    if (p.hit || p.gap <= 0) {
      // Too near: back, along the line of centres.
      const Pose M = Kinematics(s).bodyPose(p.a, p.time);
      const Vec3 away = o.pose * o.geometry->centre() - M * s.bodies[static_cast<std::size_t>(p.a)].geometry->centre();
      o.pose.p += 0.03 * (1 + round) * (away.norm() > 1e-9 ? Vec3(away.normalized()) : Vec3::UnitX());
      continue;
    }
    ++measured;
    if (reached(p)) break;
    for (int local = 0; local < 8 && !p.direction.isZero() && !reached(p); ++local) {
      o.pose.p -= (p.gap - wanted) * p.direction;
      const double t = p.gap_time;
      p = Oracle(s).leastGap(p.a, p.b, std::numeric_limits<double>::infinity(), std::max(0.0, t - kWindow),
                             std::min(1.0, t + kWindow));
      if (p.hit || p.gap <= 0) break;
    }
    if (measured >= 2 && reached(p)) break;
  }
  if (p.hit || p.direction.isZero()) return;
  if (target < 0) o.pose.p -= (p.gap + wanted) * p.direction;
  if (p.gap_time < 1e-6 && !s.shortest) std::swap(s.q0, s.q1);
}

bool freeAt(const Scene& s, double t) {
  const Oracle oracle(s);
  for (const auto& [a, b] : oracle.kinematics().pairs()) {
    const Proximity p = oracle.at(a, b, t, 0.5);
    if (p.touching || p.gap <= 0) return false;
  }
  return true;
}

/// Pairs that touch at t = 0 may touch (links), or lose their obstacle's place to one far away.
void clearStart(Scene& s) {
  const Oracle oracle(s);
  for (const auto& [a, b] : oracle.kinematics().pairs()) {
    const Proximity p = oracle.at(a, b, 0, 0.5);
    if (!p.touching && p.gap > 0) continue;
    if (s.bodies[static_cast<std::size_t>(b)].link >= 0)
      s.allow(a, b);
    else
      s.bodies[static_cast<std::size_t>(b)].pose.p += Vec3(0, 0, -5);
  }
}

/// Takes away what touches on the way: allowed pairs of links, obstacles moved away. At most a few rounds.
void clearWay(Scene& s) {
  for (int round = 0; round < 6; ++round) {
    const Truth t = Oracle(s).judge(true);
    bool any = false;
    for (const PairTruth& p : t.pairs) {
      if (!p.hit && !p.doubtful) continue;
      any = true;
      if (s.bodies[static_cast<std::size_t>(p.b)].link >= 0)
        s.allow(p.a, p.b);
      else
        s.bodies[static_cast<std::size_t>(p.b)].pose.p += Vec3(0, 0, -5);
    }
    if (!any) return;
  }
}

double grazeOf(Random& random) {
  const double sign = random.sign();
  return sign * random.logUniform(1e-8, 1e-3);
}

/// A hit on the way of one of the first `movers` bodies, with both ends free where that can be had, else the start.
void makeBetween(Scene& s, int obstacle, int movers, Random& random) {
  for (int attempt = 0; attempt < 16; ++attempt) {
    const int body = random.below(movers);
    const double t = random.uniform(0.1, 0.9);
    const double way = 0.1 * Kinematics(s).relativeSpeed(body, obstacle);
    if (way < 1e-9) continue;  // stands still
    if (!makeTouch(s, obstacle, body, t, -std::min(0.02, way * random.unit()), random)) continue;
    if (freeAt(s, 0) && (attempt > 9 || freeAt(s, 1))) return;
  }
}

void placeRigid(Scene& s, const std::string& placing, Random& random) {
  if (placing == "graze") {
    for (int attempt = 0; attempt < 4 && !makeTouch(s, 1, 0, random.uniform(0.1, 0.9), 0.03, random);) ++attempt;
    makeGraze(s, 1, grazeOf(random));
    return;
  }
  if (placing == "between") {
    makeBetween(s, 1, 1, random);
    return;
  }
  for (int attempt = 0; attempt < 8; ++attempt) {
    const double t = random.unit(), gap = random.uniform(-0.05, 0.3);
    placeBeside(s, 1, 0, t, gap, random);
    if (random.chance(0.04) || freeAt(s, 0)) return;
  }
}

void placeArm(Scene& s, const std::string& placing, Random& random) {
  const int links = static_cast<int>(s.bodies.size());
  const int obstacles = random.between(1, 5);
  for (int o = 0; o < obstacles; ++o) {
    s.bodies.push_back({random.chance(0.5) ? MeshLibrary::instance().any(random) : anyShape(random, 0.1, 0.5), -1,
                        anyPose(random, Vec3::Zero())});
    const int link = random.below(links);
    const double t = random.unit(), gap = random.uniform(-0.01, 0.4);
    placeBeside(s, links + o, link, t, gap, random);
  }
  if (random.chance(0.05)) s.check_self = false;
  if (!random.chance(0.03)) clearStart(s);
  if (placing == "random") {
    if (random.chance(0.45)) clearWay(s);
    return;
  }
  clearWay(s);
  const int o = firstObstacle(s) + random.below(obstacles);
  if (placing == "graze") {
    const int mover = random.below(links);
    for (int attempt = 0; attempt < 4 && !makeTouch(s, o, mover, random.uniform(0.1, 0.9), 0.03, random);) ++attempt;
    // All other obstacles step aside for the search, and come back.
    std::vector<Pose> poses;
    for (Body& b : s.bodies) {
      poses.push_back(b.pose);
      if (b.link < 0 && &b != &s.bodies[static_cast<std::size_t>(o)]) b.pose.p = Vec3(0, 0, -20);
    }
    makeGraze(s, o, grazeOf(random));
    for (int i = firstObstacle(s); i < static_cast<int>(s.bodies.size()); ++i)
      if (i != o) s.bodies[static_cast<std::size_t>(i)].pose = poses[static_cast<std::size_t>(i)];
    return;
  }
  makeBetween(s, o, links, random);
}

}  // namespace

GeometryPtr boxMesh(const Vec3& sides, int n, double noise, Random& random) {
  std::map<std::array<int, 3>, int> ids;
  std::vector<Vec3> v;
  Triangles t;
  const auto id = [&](const std::array<int, 3>& k) {
    const auto [at, fresh] = ids.emplace(k, static_cast<int>(v.size()));
    if (fresh) {
      const Vec3 x(k[0], k[1], k[2]);
      v.push_back((x / n - Vec3::Constant(0.5)).cwiseProduct(sides) + random.vector(0, noise));
    }
    return at->second;
  };
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {0, n})
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          const auto corner = [&](int di, int dj) {
            std::array<int, 3> k;
            k[axis] = side, k[(axis + 1) % 3] = i + di, k[(axis + 2) % 3] = j + dj;
            return id(k);
          };
          t.push_back({corner(0, 0), corner(1, 0), corner(1, 1)});
          t.push_back({corner(0, 0), corner(1, 1), corner(0, 1)});
        }
  const std::string full_name = "boxmesh" + std::to_string(t.size());
  return Geometry::mesh(full_name, std::move(v), std::move(t), anyBV(random));
}

MeshLibrary::MeshLibrary() {
  Random random(0x6d657368);
  const auto size = [&] { return random.uniform(0.15, 0.6); };
  for (int i = 0; i < 6; ++i) {
    const double x = size(), flat = random.logUniform(0.1, 1), y = flat * size(), z = size();
    meshes_.push_back(boxMesh({x, y, z}, 1, i % 2 ? 0.03 : 0, random));
  }
  for (int i = 0; i < 4; ++i) {
    const double x = size(), y = 0.02 + 0.5 * size();
    meshes_.push_back(boxMesh({x, y, x}, random.between(3, 10), 0.004, random));
  }
  for (const auto& [rows, columns] : {std::pair{3, 4}, {4, 6}, {6, 9}, {8, 12}, {12, 20}, {20, 30}, {26, 40}})
    for (int i = 0; i < 2; ++i) meshes_.push_back(starMesh(rows, columns, size(), i ? 0.12 : 0.02, random));
  for (const auto& [rows, columns] : {std::pair{4, 9}, {8, 20}, {20, 50}})
    meshes_.push_back(torusMesh(rows, columns, size(), random));
  for (const int n : {12, 40, 150}) meshes_.push_back(soupMesh(n, size(), random));
  for (int i = 0; i < 8; ++i) {
    const double length = 0.12 + 0.04 * i;
    const double x = random.uniform(0.03, 0.1), y = random.uniform(0.03, 0.1);
    const Vec3 sides(x, y, length);
    bars_.push_back(boxMesh(sides, 1 + i % 4, i % 2 ? 0.003 : 0, random));
    const double thick = random.uniform(0.04, 0.1), waist = random.uniform(0.2, 0.8);
    const int rows = random.between(4, 12), columns = random.between(5, 16);
    bars_.push_back(revolved(
        "bar", rows, columns, false,
        [&](double s, double a) {
          const double r =
              thick / 2 * std::sqrt(std::max(0.0, 4 * s * (1 - s))) * (1 - waist * (1 - std::cos(2 * M_PI * s)) / 4);
          return Vec3(r * std::cos(a), r * std::sin(a), length * (s - 0.5));
        },
        random));
  }
}

const MeshLibrary& MeshLibrary::instance() {
  // One for each thread: making an fcl::CollisionObject writes to its geometry.
  static thread_local const MeshLibrary library;
  return library;
}

const GeometryPtr& MeshLibrary::any(Random& random) const {
  return meshes_[static_cast<std::size_t>(random.below(static_cast<int>(meshes_.size())))];
}

const GeometryPtr& MeshLibrary::bar(Random& random, double length) const {
  const int i = std::clamp(static_cast<int>(std::lround((length - 0.12) / 0.04)), 0, 7);
  return bars_[static_cast<std::size_t>(2 * i + random.below(2))];
}

const std::vector<std::string>& families() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> n;
    for (const char* bodies : {"mesh_mesh", "mesh_shape", "shape_shape", "chain", "tree"})
      for (const char* placing : {"random", "between", "graze"}) n.push_back(std::string(bodies) + "/" + placing);
    return n;
  }();
  return names;
}

const std::string& familyOf(std::uint64_t campaign_seed, std::uint64_t index) {
  Random random(Random::mix(campaign_seed ^ 0xfa111e5, index));
  static constexpr double kBodies[] = {0.22, 0.2, 0.18, 0.22, 0.18}, kPlacing[] = {0.35, 0.25, 0.4};
  const auto pick = [&](const double* shares, int n) {
    double u = random.unit();
    int i = 0;
    while (i + 1 < n && u >= shares[i]) u -= shares[i++];
    return i;
  };
  const int bodies = pick(kBodies, 5);
  return families()[static_cast<std::size_t>(3 * bodies + pick(kPlacing, 3))];
}

Scene makeScene(const std::string& family, std::uint64_t seed) {
  if (std::find(families().begin(), families().end(), family) == families().end())
    throw std::invalid_argument("no class '" + family + "' in the campaign");
  const std::string bodies = family.substr(0, family.find('/')), placing = family.substr(family.find('/') + 1);
  Random random(seed);
  const bool arm = bodies == "chain" || bodies == "tree";
  Scene s = arm ? armScene(bodies == "tree", random) : rigidScene(bodies, random);
  s.family = family;
  s.seed = seed;
  requestOf(s, random);
  if (arm)
    placeArm(s, placing, random);
  else
    placeRigid(s, placing, random);
  return s;
}

}  // namespace campaign
