// SPDX-License-Identifier: BSD-3-Clause
#include "constructed.h"

#include <cmath>
#include <stdexcept>

#include <Eigen/Geometry>

#include "generator.h"
#include "oracle.h"

namespace campaign {
namespace {

/// A geometry, one of its surface points and a direction in which nothing of it is beyond that point.
struct Feature {
  GeometryPtr geometry;
  Vec3 point, outward;  ///< in the geometry's frame
};

GeometryPtr block(const Vec3& sides, Random& random) {
  return random.chance(0.5) ? Geometry::box(sides) : boxMesh(sides, random.between(1, 4), 0, random);
}

Feature featureOf(const std::string& name, Random& random) {
  const Vec3 sides = random.inBox(0.1, 0.4);
  const double radius = random.uniform(0.03, 0.15), length = random.uniform(0.1, 0.4);
  const Vec3 h = sides / 2;
  const double z = random.uniform(-0.6, 0.6);
  // `block` is a solid or a mesh, `mesh` and `solid` one of them.
  if (name == "vertex") {
    const Vec3 d = random.inBox(0.4, 1);
    return {block(sides, random), h, d.normalized()};
  }
  if (name == "box corner") return {Geometry::box(sides), h, Vec3::Ones().normalized()};
  if (name == "edge") {
    const double a = random.uniform(0.3, 1.2);
    return {block(sides, random), Vec3(h.x(), h.y(), z * h.z()), Vec3(std::cos(a), std::sin(a), 0)};
  }
  if (name == "face" || name == "mesh face") {
    const double x = random.uniform(-0.8, 0.8), y = random.uniform(-0.8, 0.8);
    return {name == "face" ? block(sides, random) : boxMesh(sides, random.between(1, 4), 0, random),
            Vec3(x * h.x(), y * h.y(), h.z()), Vec3::UnitZ()};
  }
  if (name == "sphere") return {Geometry::sphere(radius), Vec3(0, 0, radius), Vec3::UnitZ()};
  if (name == "cylinder rim") {
    const double a = random.uniform(0.2, 1.3);
    return {Geometry::cylinder(radius, length), Vec3(radius, 0, length / 2), Vec3(std::cos(a), 0, std::sin(a))};
  }
  if (name == "cylinder side")
    return {Geometry::cylinder(radius, length), Vec3(radius, 0, z * length / 2), Vec3::UnitX()};
  throw std::invalid_argument("no feature '" + name + "'");
}

/// Turns u to v, then about v by `spin`.
Mat3 turning(const Vec3& u, const Vec3& v, double spin) {
  return rotationAbout(v, spin) * Eigen::Quaterniond::FromTwoVectors(u, v).toRotationMatrix();
}

Pose posed(const Feature& f, const Vec3& point, const Vec3& outward, double spin) {
  const Mat3 R = turning(f.outward, outward, spin);
  return {R, point - R * f.point};
}

void addJoint(Scene& s, JointKind kind, const Pose& origin, const Vec3& axis, double at_contact, double dq, double t) {
  Link l;
  l.parent = static_cast<int>(s.links.size()) - 1;
  l.joint = kind;
  l.origin = origin;
  l.axis = axis;
  s.links.push_back(l);
  s.q0.push_back(at_contact - t * dq);
  s.q1.push_back(at_contact - t * dq + dq);
}

void reverse(Scene& s, double t) {
  for (std::size_t v = 0; v < s.q0.size(); ++v) {
    const double dq = s.q1[v] - s.q0[v], q = s.q0[v] + t * dq;
    s.q0[v] = q + t * dq;
    s.q1[v] = q + t * dq - dq;
  }
}

/// Speed along n, at t, of the point of body 0 that is at x then.
double speedAt(const Scene& s, double t, const Vec3& x, const Vec3& n) {
  const Kinematics k(s);
  constexpr double h = 1e-6;
  const Vec3 local = k.bodyPose(0, t).inverse() * x;
  return n.dot(k.bodyPose(0, t + h) * local - k.bodyPose(0, t - h) * local) / (2 * h);
}

struct Kind {
  const char *name, *first, *second;
};
constexpr Kind kKinds[] = {
    {"vertex on face", "vertex", "face"},
    {"face on vertex", "face", "vertex"},
    {"edge on edge", "edge", "edge"},
    {"box corner on mesh face", "box corner", "mesh face"},
    {"sphere on triangle", "sphere", "mesh face"},
    {"face on sphere", "face", "sphere"},
    {"sphere on sphere", "sphere", "sphere"},
    {"cylinder rim on face", "cylinder rim", "face"},
    {"cylinder side on sphere", "cylinder side", "sphere"},
    {"cylinder side on edge", "cylinder side", "edge"},
    {"face on face", "face", "face"},
};

bool tryConstruct(const Kind& kind, const std::string& chain, Random& random, Constructed& c) {
  c = {};
  c.region = std::string(kind.first) == "face" && std::string(kind.second) == "face";
  const auto isCurved = [](const std::string& f) { return f == "sphere" || f.rfind("cylinder", 0) == 0; };
  c.curved = isCurved(kind.first) || isCurved(kind.second);
  const Feature first = featureOf(kind.first, random), second = featureOf(kind.second, random);
  c.normal = random.direction();
  c.point = random.vector(0, 0.8);
  c.time = random.uniform(0.2, 0.9);
  const Pose pose = posed(first, c.point, c.normal, random.uniform(-M_PI, M_PI));
  Pose other = posed(second, c.point, -c.normal, random.uniform(-M_PI, M_PI));
  if (std::string(kind.second) == "edge") {
    // Both have their edge, or axis, along local z: let the two cross at 30 to 150 degrees.
    const Vec3 u = pose.R.col(2), v = other.R.col(2);
    const double angle = std::atan2(c.normal.dot(u.cross(v)), u.dot(v));
    const Mat3 turn = rotationAbout(c.normal, random.uniform(M_PI / 6, 5 * M_PI / 6) - angle);
    other.R = turn * other.R;
    other.p = c.point - other.R * second.point;
  }

  Scene& s = c.scene;
  s.family = std::string(kind.name) + ", " + chain;
  s.links.emplace_back();
  const auto anyOrigin = [&] { return Pose{random.rotation(), random.vector(0, 0.4)}; };
  const auto slide = [&](const Vec3& axis) {
    const Pose origin = anyOrigin();
    const double start = random.uniform(-0.3, 0.3), sign = random.sign(), step = random.uniform(0.2, 1);
    addJoint(s, JointKind::prismatic, origin, axis, start, sign * step, c.time);
  };
  const auto turnAt = [&](const Pose& origin, const Vec3& axis) {
    const JointKind kind = random.chance(0.5) ? JointKind::revolute : JointKind::continuous;
    const double start = random.uniform(-2, 2), sign = random.sign(), step = random.logUniform(0.3, 4);
    addJoint(s, kind, origin, axis, start, sign * step, c.time);
  };
  const auto turn = [&] {
    const Pose origin = anyOrigin();
    turnAt(origin, random.direction());
  };
  if (chain == "prismatic") {
    for (int j = random.between(1, 2); j > 0; --j) slide(random.direction());
  } else if (c.region) {
    // A face stays parallel to the other one only while it turns about their normal.
    if (chain == "revolute") return false;
    slide(random.direction());
    const Pose origin = anyOrigin();
    turnAt(origin, (Kinematics(s).linkPose(1, 0).R * origin.R).transpose() * c.normal);
  } else if (chain == "revolute") {
    for (int j = random.between(1, 2); j > 0; --j) turn();
  } else {
    slide(random.direction());
    turn();
    if (random.chance(0.5)) slide(random.direction());
  }
  const int last = static_cast<int>(s.links.size()) - 1;
  s.bodies.push_back({first.geometry, last, Kinematics(s).linkPose(last, c.time).inverse() * pose});
  s.bodies.push_back({second.geometry, -1, other});
  c.normal_speed = speedAt(s, c.time, c.point, c.normal);
  if (c.normal_speed < 0) {
    reverse(s, c.time);
    c.normal_speed = speedAt(s, c.time, c.point, c.normal);
  }
  if (c.normal_speed < 0.1) return false;
  const PairTruth before = Oracle(s).firstContact(0, 1, c.time - 1e-7);
  return !before.hit && !before.doubtful && before.gap > 0.2 * c.normal_speed * 1e-7;
}

}  // namespace

const std::vector<std::string>& contactKinds() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> n;
    for (const Kind& k : kKinds) n.push_back(k.name);
    return n;
  }();
  return names;
}

const std::vector<std::string>& chainKinds() {
  static const std::vector<std::string> names = {"revolute", "prismatic", "mixed"};
  return names;
}

Constructed constructContact(const std::string& contact, const std::string& chain, std::uint64_t seed) {
  Random random(seed);
  for (const Kind& kind : kKinds) {
    if (contact != kind.name) continue;
    for (int attempt = 0; attempt < 400; ++attempt) {
      Constructed c;
      if (!tryConstruct(kind, chain, random, c)) continue;
      c.scene.seed = seed;
      return c;
    }
  }
  throw std::runtime_error("no contact '" + contact + "' under a " + chain + " chain");
}

}  // namespace campaign
