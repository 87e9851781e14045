// SPDX-License-Identifier: BSD-3-Clause
#include "cases.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "fcl/fcl_geometry.h"

namespace fcl_artic {
namespace numerics_test {

using engine::PieceKind;

int scaled(int checks) {
  const char* asked = std::getenv("FCL_ARTIC_NUMERICS_SCALE");
  return std::max(1, static_cast<int>(checks * (asked ? std::atof(asked) : 1.0)));
}

std::uint64_t seedOf(const std::string& test) {
  const char* asked = std::getenv("FCL_ARTIC_NUMERICS_SEED");
  std::uint64_t seed = asked ? std::strtoull(asked, nullptr, 10) : 1;
  std::printf("FCL_ARTIC_NUMERICS_SEED=%llu\n", static_cast<unsigned long long>(seed));
  for (const char c : test) seed = (seed ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  return seed;
}

double Random::size(double lo, double hi) {
  return lo * std::pow(hi / lo, unit());
}

Eigen::Vector3d Random::direction() {
  for (;;) {
    const Eigen::Vector3d v(in(-1, 1), in(-1, 1), in(-1, 1));
    if (v.norm() > 0.1 && v.norm() < 1) return v.normalized();
  }
}

Eigen::Matrix3d Random::rotation() {
  if (chance(0.2)) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(in(-3.2, 3.2), direction()).toRotationMatrix();
}

namespace {

Eigen::Isometry3d isometry(const Eigen::Matrix3d& R, const Eigen::Vector3d& t) {
  Eigen::Isometry3d M = Eigen::Isometry3d::Identity();
  M.linear() = R;
  M.translation() = t;
  return requireRigid(M, "a random transform");
}

}  // namespace

void PairCase::makeTree(Random& random) {
  const double scale = random.size(0.01, 10);
  const int n = 1 + random.below(9);
  tree.addLink("link0");
  std::string master;
  double cancel = 0;  // a fixed joint far out, that the next one takes back
  for (int i = 1; i <= n; ++i) {
    const std::string name = "link" + std::to_string(i);
    Joint joint;
    joint.name = "joint" + std::to_string(i);
    joint.parent = "link" + std::to_string(cancel != 0 || random.chance(0.75) ? i - 1 : random.below(i));
    joint.child = name;
    const int kind = random.below(10);
    joint.type = kind < 5 ? JointType::revolute : kind < 8 ? JointType::prismatic : JointType::fixed;
    joint.axis = random.chance(0.4) ? Eigen::Vector3d(Eigen::Vector3d::Unit(random.below(3))) : random.direction();
    joint.origin = isometry(random.rotation(), scale * random.unit() * random.direction());
    if (cancel != 0) {
      joint.origin.translation() += Eigen::Vector3d(-cancel, 0, 0);
      cancel = 0;
    } else if (random.chance(0.1)) {
      cancel = random.size(1, 1e3);
      joint.type = JointType::fixed;
      joint.origin.linear().setIdentity();
      joint.origin.translation() += Eigen::Vector3d(cancel, 0, 0);
    }
    if (joint.type != JointType::fixed && !master.empty() && random.chance(0.25)) {
      joint.mimics = true;
      joint.mimic.master = master;
      joint.mimic.multiplier = random.in(-3, 3);
      joint.mimic.offset = random.chance(0.5) ? 0 : random.in(-2, 2);
    }
    tree.addLink(name);
    const JointId id = tree.addJoint(joint);
    if (joint.type != JointType::fixed && !joint.mimics && master.empty()) master = tree.joint(id).name;
  }
}

PairCase::PairCase(Random& random, int rounding) {
  makeTree(random);
  const double rate = random.chance(0.1) ? random.size(3, 60) : random.size(1e-3, 3);
  for (int v = 0; v < tree.dof(); ++v) {
    const bool slides = tree.joint(tree.variableJoint(v)).type == JointType::prismatic;
    q0.push_back(random.chance(0.05) ? random.in(-1e4, 1e4) : random.in(-3.2, 3.2) * (slides ? 0.3 : 1));
    dq.push_back(random.chance(0.15) ? 0 : random.in(-rate, rate));
  }
  link_b = random.below(tree.numLinks());
  if (random.chance(0.5)) {
    do {
      link_a = random.below(tree.numLinks());
    } while (link_a == link_b);
  }
  const double far = random.chance(0.2) ? random.size(10, 1e3) : 1;
  offset_a = isometry(random.rotation(), far * random.size(0.01, 2) * random.direction());
  offset_b = isometry(random.rotation(), random.size(0.01, 2) * random.direction());
  if (random.chance(0.2)) offset_b.setIdentity();
  extent_a = random.size(0.01, 3);
  extent_b = random.size(0.01, 3);

  const int level = random.below(31);
  const double width = std::ldexp(1.0, -level);
  const double start = std::floor(random.unit() * std::ldexp(1.0, level)) * width * (1 - 7 * width > 0 ? 1 : 0);
  for (int i = 0; i < 8; ++i) in.tm[i] = std::fmod(start + i * width, 1.0) + 0.5 * width;
  in.d = 0.5 * width;

  const ScopedRounding scope(rounding);
  sweep = std::make_unique<FrameSweep>(link_a < 0 ? FrameSweep::fromWorld(tree) : FrameSweep::fromLink(tree, link_a));
  carrier = sweep->carrier(link_b);
  in.sweep = sweep->view();
  in.step_b = carrier.step;
  in.placement_b = makePlacement(carrier, stored(offset_b));
  in.inverse_a = makePlacement(stored(offset_a).inverse());
  in.extents = extent_a + extent_b;
  coefficients = q0;
  coefficients.insert(coefficients.end(), dq.begin(), dq.end());
  in.query.coefficients = coefficients.data();
  in.query.num_variables = static_cast<std::int32_t>(q0.size());
}

std::vector<double> randomTangent(Random& random, int degree, double t) {
  std::vector<double> s(static_cast<std::size_t>(degree) + 1, 0.0);
  const int kind = random.below(6);
  const double size = kind == 0 ? random.size(1e-6, 1) : kind == 1 ? random.size(10, 3e4) : random.size(0.1, 30);
  for (int k = 1; k <= degree; ++k) s[static_cast<std::size_t>(k)] = size * random.in(-1, 1) / k;
  if (random.chance(0.1)) std::fill(s.begin() + 1, s.end(), 0.0);
  double way = 0, power = 1;
  for (std::size_t k = 1; k < s.size(); ++k) way += s[k] * (power *= t);
  switch (kind) {
    case 2:
      s[0] = -way;  // 0 at t
      break;
    case 3:
      s[0] = (random.chance(0.5) ? 1 : std::sqrt(1.0 / 3)) * (random.chance(0.5) ? 1 : -1) - way;
      break;
    default:
      s[0] = random.in(-1, 1) * size;
  }
  return s;
}

void PairCase::goByHalfAngles(Random& random) {
  const std::size_t n = q0.size();
  const int degree = random.chance(0.6) ? 2 : 3 + random.below(3);
  half_angles.assign(n, 0);
  references.assign(n, 0);
  coefficients.resize(n * (static_cast<std::size_t>(degree) + 1), 0.0);
  for (std::size_t v = 0; v < n; ++v) {
    if (!tree.isAngle(static_cast<int>(v))) continue;
    half_angles[v] = 1;
    references[v] = random.chance(0.5) ? 0 : random.in(-3, 3);
    const std::vector<double> s = randomTangent(random, random.chance(0.6) ? 1 : degree, in.tm[random.below(8)]);
    for (std::size_t k = 0; k <= static_cast<std::size_t>(degree); ++k) {
      coefficients[k * n + v] = k < s.size() ? s[k] : 0;
    }
  }
  in.query.coefficients = coefficients.data();
  in.query.degree = degree;
  in.query.half_angles = {half_angles.data(), references.data(), static_cast<std::int32_t>(n)};
}

Real PairCase::variable(std::size_t v, const Real& t) const {
  if (half_angles.empty() || !half_angles[v]) return Real(q0[v]) + t * Real(dq[v]);
  const std::size_t n = q0.size();
  Real s;
  for (int k = in.query.degree; k >= 0; --k) s = s * t + Real(coefficients[static_cast<std::size_t>(k) * n + v]);
  return Real(references[v]) + Real(2.0) * atan(s);
}

RealRigid PairCase::pose(LinkId link, const Real& t) const {
  RealRigid M;  // of the link in its ancestors' frames, further and further up
  for (; tree.parentJoint(link) >= 0; link = tree.parentLink(link)) {
    const JointId id = tree.parentJoint(link);
    const Joint& joint = tree.joint(id);
    RealRigid own = properly(joint.origin);
    if (joint.type != JointType::fixed) {
      const auto v = static_cast<std::size_t>(tree.jointVariable(id));
      Real q = variable(v, t);
      if (joint.mimics) q = Real(joint.mimic.multiplier) * q + Real(joint.mimic.offset);
      const Real3 axis = unit(exactly(joint.axis));
      RealRigid move;
      if (joint.type == JointType::prismatic) {
        move.t = q * axis;
      } else {
        move = rotation(axis, q);
      }
      own = own * move;
    }
    M = own * M;
  }
  return M;
}

RealRigid PairCase::relative(const Real& t) const {
  const RealRigid A = properly(offset_a), M_0a = link_a < 0 ? A : pose(link_a, t) * A;
  return M_0a.inverse() * (pose(link_b, t) * properly(offset_b));
}

RealRigid properly(const Eigen::Isometry3d& M) {
  RealRigid o;
  o.R[0] = unit(exactly(M.linear().col(0)));
  o.R[2] = unit(cross(o.R[0], exactly(M.linear().col(1))));
  o.R[1] = cross(o.R[2], o.R[0]);
  o.t = exactly(M.translation());
  return o;
}

Real3 exactly(const Eigen::Vector3d& p) {
  return {p[0], p[1], p[2]};
}

Eigen::Vector3d pointWithin(Random& random, double extent) {
  return extent * (random.chance(0.5) ? 1 - 1e-14 : random.unit()) * random.direction();
}

Real3 quadraticAt(const PairOutput& m, int side, int lane, const Eigen::Vector3d& p, double tau) {
  Real3 x;
  for (std::size_t i = 0; i < 3; ++i) {
    Real power = 1.0;
    for (int order = 0; order < 3; ++order) {
      Real sum = m.c[side][order][i][lane];
      for (std::size_t j = 0; j < 3; ++j) sum += Real(m.R[side][order][3 * i + j][lane]) * Real(p[static_cast<int>(j)]);
      x[i] += power * sum;
      power *= Real(tau);
    }
  }
  return x;
}

OwnedPiece::OwnedPiece(Random& random, PieceKind kind, double size, bool centered) {
  piece.kind = kind;
  if (kind == PieceKind::vertices || kind == PieceKind::hull) {
    piece.num_vertices = random.chance(0.5) ? 3 : 4 + random.below(8);
    if (kind == PieceKind::hull) piece.num_vertices = 8 * (1 + random.below(8));
    for (int i = 0; i < piece.num_vertices; ++i) {
      const Eigen::Vector3d p = size * random.in(0.3, 1) * random.direction();
      vertices.insert(vertices.end(), p.data(), p.data() + 3);
      piece.reach = std::max(piece.reach, p.norm() * (1 + 1e-15));
    }
    if (kind == PieceKind::hull) {
      const std::size_t n = static_cast<std::size_t>(piece.num_vertices);
      hull.reset(static_cast<double*>(std::aligned_alloc(64, 3 * n * sizeof(double))), std::free);
      for (std::size_t i = 0; i < 3 * n; ++i) hull.get()[i % 3 * n + i / 3] = vertices[i];
      piece.radius = size * random.size(0.001, 0.1);
    }
    return;
  }
  if (!centered && random.chance(0.3)) {
    const Eigen::Vector3d m = random.unit() * size * random.direction();
    for (int k = 0; k < 3; ++k) piece.center[k] = m[k];
  }
  double half[3] = {0, 0, 0};
  const auto part = [&] { return size * random.size(0.05, 0.6); };
  switch (kind) {
    case PieceKind::point:
      piece.radius = part();
      break;
    case PieceKind::segment:
      half[2] = piece.size[2] = part();
      piece.radius = part();
      break;
    case PieceKind::box:
    case PieceKind::ellipsoid:
      for (int k = 0; k < 3; ++k) half[k] = piece.size[k] = part();
      break;
    default:
      half[0] = half[1] = piece.size[0] = part();
      half[2] = piece.size[2] = part();
  }
  double far = 0;
  for (int k = 0; k < 3; ++k) far += (std::abs(piece.center[k]) + half[k]) * (std::abs(piece.center[k]) + half[k]);
  piece.reach = std::sqrt(far) * (1 + 1e-15);
}

engine::TreeView OwnedPiece::view() const {
  engine::TreeView v;
  v.pieces = &piece;
  v.vertices = vertices.data();
  v.hulls = hull.get();
  v.num_pieces = 1;
  v.extent = extent();
  return v;
}

Real OwnedPiece::support(const Real3& u) const {
  if (piece.kind == PieceKind::vertices || piece.kind == PieceKind::hull) {
    Real best;
    for (std::size_t i = 0; i < vertices.size(); i += 3) {
      const Real x = dot(Real3{vertices[i], vertices[i + 1], vertices[i + 2]}, u);
      best = i ? max(best, x) : x;
    }
    return best;
  }
  const Real m = dot(Real3{piece.center[0], piece.center[1], piece.center[2]}, u);
  const Real a = piece.size[0], b = piece.size[1], c = piece.size[2];
  const Real across = a * sqrt(u[0] * u[0] + u[1] * u[1]);
  switch (piece.kind) {
    case PieceKind::segment:
      return m + c * abs(u[2]);
    case PieceKind::box:
      return m + a * abs(u[0]) + b * abs(u[1]) + c * abs(u[2]);
    case PieceKind::cylinder:
      return m + across + c * abs(u[2]);
    case PieceKind::cone:
      return m + max(c * u[2], across - c * u[2]);
    case PieceKind::ellipsoid:
      return m + norm(Real3{a * u[0], b * u[1], c * u[2]});
    default:
      return m;
  }
}

Real gapAlong(const OwnedPiece& a, const OwnedPiece& b, const RealRigid& M_ab, const Real3& n) {
  const Real3 back = Real(-1.0) * M_ab.turnBack(n);
  return dot(n, M_ab.t) - b.support(back) - a.support(n) - Real(a.piece.radius) - Real(b.piece.radius);
}

}  // namespace numerics_test
}  // namespace fcl_artic
