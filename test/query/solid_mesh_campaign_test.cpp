// SPDX-License-Identifier: BSD-3-Clause
//
// Random bodies and motions with solid meshes, among judges that share nothing with the library: the distance of a ball
// from a hollow box in closed form, and winding numbers by the triangles' solid angles.
// FCL_ARTIC_SOLID_CASES and FCL_ARTIC_SOLID_SEED in the environment ask for more and for others.
#include <cmath>

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/math/motion/interp_motion.h>

#include "../support/random_placing.h"
#include "expect.h"
#include "expect_time.h"
#include "fcl_artic/continuous_collision.h"
#include "solid_meshes.h"

namespace solid_mesh_campaign_test {

using namespace fcl_artic;
using namespace fcl_artic::test;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

/// Runs a campaign of so many cases, or as many as the environment says.
campaign::Tally runCases(std::uint64_t few, void (*look)(campaign::Case& c)) {
  campaign::Campaign bodies;
  bodies.look = [look](campaign::Case& c) { lookByExpectations(look, c); };
  const campaign::Options o = campaign::optionsOfTest("FCL_ARTIC_SOLID", few);
  return runWithoutFaults(bodies, o).total;
}

CertifiedRequest randomRequest(Random& random) {
  CertifiedRequest request;
  request.mode = static_cast<ContactMode>(random.below(3));
  request.method = random.chance(0.2) ? Method::redon2004 : Method::standard;
  request.visibility = random.chance(0.2) ? VisibilityMode::on : VisibilityMode::off;
  request.ignore_initial_contact = request.mode != ContactMode::any && random.chance(0.4);
  if (random.chance(0.2)) request.margin = random.uniform(0, 0.1);
  return request;
}

CertifiedResult ask(const ArticulatedCollisionManager& manager, const VectorXd& q0, const VectorXd& q1,
                    const CertifiedRequest& request, campaign::Case& c) {
  c.query([&] { return manager.writeQuery(JointMotion::linear(manager.tree(), q0, q1), request); });
  return fcl_artic::test::ask(manager, q0, q1, request);
}

/// Three slides along x, y, z and three turns about z, y, x.
std::shared_ptr<KinematicTree> freeTree() {
  auto tree = std::make_shared<KinematicTree>("free");
  tree->addLink("l0");
  const Vector3d axes[6] = {Vector3d::UnitX(), Vector3d::UnitY(), Vector3d::UnitZ(),
                            Vector3d::UnitZ(), Vector3d::UnitY(), Vector3d::UnitX()};
  for (int i = 0; i < 6; ++i) {
    const std::string link = "l" + std::to_string(i + 1);
    tree->addLink(link);
    tree->addJoint(makeJoint("j" + std::to_string(i), i < 3 ? JointType::prismatic : JointType::continuous,
                             "l" + std::to_string(i), link, axes[i]));
  }
  return tree;
}

}  // namespace

// A ball on a straight way through a box with a cavity, both boxes around the origin of a frame at random.
void ballAndHollowBox(campaign::Case& c) {
  Random random(c.id.seed);
  const Vector3d outer(random.uniform(0.5, 2), random.uniform(0.5, 2), random.uniform(0.5, 2));
  const bool hollow = random.chance(0.6);
  const Vector3d inner = outer * random.uniform(0.3, 0.8);
  const double radius = random.uniform(0.02, 0.3);
  const Isometry3d M = random.pose(2);
  Soup soup;
  soup.addBox(outer);
  if (hollow) soup.addBox(inner, {0, 0, 0}, true);
  if (random.chance(0.5)) soup.flip();
  // In the box's frame.
  const auto place = [&] {
    const Vector3d x = random.box(1);
    return Vector3d(random.chance(0.3) ? 0.9 * x.cwiseProduct(inner) : 1.4 * x.cwiseProduct(outer));
  };
  const Vector3d from = place(), to = random.chance(0.3) ? Vector3d(from + 0.2 * random.box(1)) : place();
  const CertifiedRequest request = randomRequest(random);
  // The gap, 0 or less where they touch.
  const auto gap = [&](double t) {
    const Vector3d x = from + t * (to - from);
    const Vector3d out = (x.cwiseAbs() - outer).cwiseMax(0);
    double distance = out.norm();
    if (hollow && (x.cwiseAbs() - inner).maxCoeff() < 0) distance = (inner - x.cwiseAbs()).minCoeff();
    return distance - radius - request.margin;
  };

  auto tree = std::make_shared<KinematicTree>("slides");
  for (const char* link : {"base", "x", "y", "z"}) tree->addLink(link);
  tree->addJoint(makeJoint("x", JointType::prismatic, "base", "x", Vector3d::UnitX()));
  tree->addJoint(makeJoint("y", JointType::prismatic, "x", "y", Vector3d::UnitY()));
  tree->addJoint(makeJoint("z", JointType::prismatic, "y", "z", Vector3d::UnitZ()));
  ArticulatedCollisionManager manager(tree);
  const int setting = random.below(4);
  const auto box = object(soup.solid(), M), sphere = ball(radius);
  const Vector3d q0 = M * from, q1 = M * to;
  VectorXd v0 = q0, v1 = q1;
  switch (setting) {
    case 0:  // the ball is a link
      manager.bind("z", sphere.get());
      manager.registerObject(box.get(), "box");
      break;
    case 1:  // the box is the robot's base: links of one another, with a table
      manager.bind("z", sphere.get());
      manager.bind("base", box.get(), M);
      break;
    default:  // the box is the link and goes the other way
      manager.bind("z", box.get(), M);
      manager.registerObject(sphere.get(), "ball");
      v0 = -q0, v1 = -q1;
  }
  manager.setup();
  CertifiedResult r;
  if (setting == 3) {
    const auto slide = [](const Isometry3d& from_pose, const Isometry3d& to_pose) {
      return fcl::InterpMotion<double>(from_pose.linear(), from_pose.translation(), to_pose.linear(),
                                       to_pose.translation(), Vector3d(0, 0, 0));
    };
    const auto still = slide(M, M), way = slide(pose(q0), pose(q1));
    CertifiedPairResult pair;
    c.queryWithoutFile(campaign::kTwoBodies);
    continuousCollide(box->collisionGeometry().get(), &still, sphere->collisionGeometry().get(), &way, request, pair);
    r.status = pair.status;
    r.t_lower = pair.t_lower;
    r.t_upper = pair.t_upper;
    r.certain = pair.certain;
    r.contacts = pair.contacts;
    if (pair.ignored_initial_contact) r.ignored_initial_contacts.emplace_back();
  } else {
    r = ask(manager, v0, v1, request, c);
  }

  const std::string which = "seed " + std::to_string(c.id.seed) + ", setting " + std::to_string(setting) + ", mode " +
                            std::to_string(static_cast<int>(request.mode));
  // From when it is watched: at once, or from a time at which it is well apart for 1/512.
  constexpr int kGrid = 4096;
  const double slack = 1e-7, step = (to - from).norm() / kGrid;
  const bool touches = gap(0) <= -slack, near = std::abs(gap(0)) < slack;
  if (near) return;
  const bool ignored = touches && request.ignore_initial_contact;
  EXPECT_EQ(r.ignored_initial_contacts.size(), ignored ? 1u : 0u) << which;
  int watch = 0;
  if (ignored) {
    const auto apart = [&](int begin) {
      for (int k = begin; k <= begin + kGrid / 512; ++k) {
        if (gap(double(k) / kGrid) <= step + 1e-5) return false;
      }
      return true;
    };
    while (watch < kGrid && !apart(watch)) watch += kGrid / 512;
  }
  int first = watch;
  while (first <= kGrid && gap(double(first) / kGrid) > -slack) ++first;
  const bool judged = watch < kGrid && first <= kGrid;
  const double t = double(first) / kGrid;
  c.tally.count("contained", touches);
  if (judged) {
    ASSERT_EQ(r.status, Status::contact) << which << ": contact at " << t << " is missed";
    ASSERT_LE(r.t_lower, t) << which;
    if (touches && !ignored) {
      EXPECT_TRUE(r.certain && r.t_lower == 0) << which;
      if (request.mode != ContactMode::any) EXPECT_LE(r.t_upper, request.tolerance_time) << which;
    }
    c.tally.count("later", !touches);
    c.tally.count("watched again", ignored);
  }
  if (r.status == Status::contact) {
    if (r.certain) {
      const bool deep = gap(r.t_upper) <= slack;
      EXPECT_TRUE(deep || (r.t_upper > r.t_lower && gap(r.t_lower) <= slack + 2 * step)) << which << ": not there";
    }
    double before = -1;  // it was apart before, if it was ignored
    for (int k = 0; k <= kGrid && double(k) / kGrid <= r.t_lower; ++k)
      before = std::max(before, gap(double(k) / kGrid));
    if (ignored) EXPECT_GT(before, -2 * step - slack) << which << ": it has never left";
  } else {
    EXPECT_EQ(r.status, Status::free) << which;
    c.tally.count("free");
    c.tally.count("from a cavity", hollow && !touches && ((M.inverse() * q0).cwiseAbs() - inner).maxCoeff() < 0);
  }
}

TEST(SolidMeshCampaign, BallAndHollowBox) {
  const campaign::Tally all = runCases(400, ballAndHollowBox);
  EXPECT_GT(all.share("contained"), 0.2);
  EXPECT_GT(all.share("later"), 0.05);
  EXPECT_GT(all.share("free"), 0.1);
  EXPECT_GT(all.share("from a cavity"), 0.01);
  EXPECT_GT(all["watched again"], 0u);
}

namespace {

/// A closed surface around a point of its own, r(direction) at random; n cuts of an octahedron's edges.
void addBlob(Random& random, int n, double size, double rough, const Vector3d& center, bool flip, Soup& soup) {
  const std::size_t begin = soup.triangles.size();
  const double phase[6] = {random.uniform(0, 6), random.uniform(0, 6), random.uniform(0, 6),
                           random.uniform(0, 6), random.uniform(0, 6), random.uniform(0, 6)};
  const auto at = [&](Vector3d d) {
    d.normalize();
    double r = 1;
    for (int k = 0; k < 3; ++k)
      r += rough * 0.3 * std::sin(3 * d[k] + phase[k]) + rough * 0.1 * std::cos(7 * d[k] + phase[3 + k]);
    return Vector3d(center + size * r * d);
  };
  for (int octant = 0; octant < 8; ++octant) {
    const Vector3d s((octant & 1) ? -1 : 1, (octant & 2) ? -1 : 1, (octant & 4) ? -1 : 1);
    const bool mirrored = s.prod() < 0;
    // Exact multiples: shared edges get the very same directions.
    const auto corner = [&](int i, int j) { return at(Vector3d(s[0] * i, s[1] * j, s[2] * (n - i - j))); };
    const auto add = [&](const Vector3d& a, const Vector3d& b, const Vector3d& c) {
      const std::size_t first = soup.vertices.size();
      soup.vertices.insert(soup.vertices.end(), {a, b, c});
      if (mirrored) {
        soup.triangles.emplace_back(first, first + 2, first + 1);
      } else {
        soup.triangles.emplace_back(first, first + 1, first + 2);
      }
    };
    for (int i = 0; i < n; ++i) {
      for (int j = 0; i + j < n; ++j) {
        add(corner(i + 1, j), corner(i, j + 1), corner(i, j));
        if (i + j + 2 <= n) add(corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1));
      }
    }
  }
  if (flip) soup.flip(begin);
}

Soup randomBody(Random& random, double size) {
  Soup soup;
  const int n = 2 + random.below(3);
  const bool flip = random.chance(0.3);
  switch (random.below(5)) {
    case 0:  // a cavity, or one within the other
      addBlob(random, n, size, 0.2, {0, 0, 0}, flip, soup);
      addBlob(random, 2, 0.4 * size, 0.2, {0, 0, 0}, random.chance(0.7) ? !flip : flip, soup);
      break;
    case 1:  // two, apart from each other or through each other
      addBlob(random, n, 0.6 * size, 0.6, size * Vector3d(0.6, 0, 0), flip, soup);
      addBlob(random, n, 0.5 * size, 0.6, size * Vector3d(random.chance(0.5) ? -0.9 : -0.2, 0.1, 0), random.chance(0.5),
              soup);
      break;
    case 2:
      soup.addTube(size, size * random.uniform(0.3, 0.8), size * random.uniform(0.3, 2));
      if (flip) soup.flip();
      break;
    default:
      addBlob(random, n, size, random.uniform(0, 1), {0, 0, 0}, flip, soup);
  }
  return soup;
}

/// Winding number by solid angles (van Oosterom and Strackee, 1983); far from a whole number: on the surface.
long double windingNumber(const Soup& soup, const Vector3d& x) {
  using V = Eigen::Matrix<long double, 3, 1>;
  long double sum = 0;
  for (const fcl::Triangle& t : soup.triangles) {
    V a = (soup.vertices[t[0]] - x).cast<long double>(), b = (soup.vertices[t[1]] - x).cast<long double>(),
      c = (soup.vertices[t[2]] - x).cast<long double>();
    const long double na = a.norm(), nb = b.norm(), nc = c.norm();
    const long double volume = a.dot(b.cross(c));
    sum += 2 * std::atan2(volume, na * nb * nc + a.dot(b) * nc + b.dot(c) * na + c.dot(a) * nb);
  }
  return sum / (4 * 3.14159265358979323846264338327950288L);
}

/// Clearly inside: all around the point, too.
bool inside(const Soup& soup, const Vector3d& x) {
  return std::abs(std::round(windingNumber(soup, x))) > 0 &&
         std::abs(windingNumber(soup, x) - std::round(windingNumber(soup, x))) < 1e-6L;
}

}  // namespace

// Closed meshes of all kinds in each other, in free motion.
void windingNumbers(campaign::Case& c) {
  Random random(c.id.seed + 7);
  const auto tree = freeTree();
  const Soup a = randomBody(random, 1),
             b = randomBody(random, random.chance(0.5) ? random.uniform(0.03, 0.3) : random.uniform(0.3, 2));
  const bool a_solid = random.chance(0.7), b_solid = !a_solid || random.chance(0.5);
  const auto mesh_a = a_solid ? std::shared_ptr<fcl::CollisionGeometryd>(a.solid()) : a.surface();
  const auto mesh_b = b_solid ? std::shared_ptr<fcl::CollisionGeometryd>(b.solid()) : b.surface();
  const Isometry3d M = random.pose(1);
  const auto obstacle = object(mesh_a, M), link = object(mesh_b);
  ArticulatedCollisionManager manager(tree);
  manager.bind("l6", link.get());
  const bool self = random.chance(0.3);
  if (self) {
    manager.bind("l0", obstacle.get(), M);
  } else {
    manager.registerObject(obstacle.get(), "obstacle");
  }
  manager.setup();
  VectorXd q0(6), q1(6);
  const double way = random.chance(0.5) ? 0.1 : 1.5;
  const Vector3d begin = M * random.box(0.9);
  for (int k = 0; k < 6; ++k) {
    q0[k] = k < 3 ? begin[k] : random.uniform(-3, 3);
    q1[k] = q0[k] + random.uniform(-way, way);
  }
  CertifiedRequest request = randomRequest(random);
  request.margin = 0;
  const CertifiedResult r = ask(manager, q0, q1, request, c);
  const std::string which = "seed " + std::to_string(c.id.seed);
  // A vertex of the one clearly inside the other.
  const auto holds = [&](double t) {
    std::vector<Isometry3d> M_0;
    tree->forwardKinematics(q0 + t * (q1 - q0), M_0);
    const Isometry3d M_ab = M.inverse() * M_0.back();
    for (std::size_t k = 0; a_solid && k < b.vertices.size(); k += 1 + b.vertices.size() / 9) {
      if (inside(a, M_ab * b.vertices[k])) return true;
    }
    for (std::size_t k = 0; b_solid && k < a.vertices.size(); k += 1 + a.vertices.size() / 9) {
      if (inside(b, M_ab.inverse() * a.vertices[k])) return true;
    }
    return false;
  };
  const bool at_first = holds(0);
  const bool ignored = r.ignored_initial_contacts.size() == 1;
  c.tally.count("contained", at_first);
  if (at_first && request.ignore_initial_contact) EXPECT_TRUE(ignored) << which;
  if (at_first && !request.ignore_initial_contact) {
    ASSERT_EQ(r.status, Status::contact) << which;
    ASSERT_EQ(r.t_lower, 0) << which;
    EXPECT_TRUE(r.certain) << which;
  }
  if (!ignored) {
    for (int k = 1; k <= 16; ++k) {
      const double t = k / 16.0;
      if (r.isFree() || t < r.t_lower) {
        const bool held = holds(t);
        ASSERT_FALSE(held) << which << ": one holds the other at " << t << ", free before " << r.t_lower;
      } else if (!at_first && holds(t)) {
        c.tally.count("entered");
        break;
      }
    }
    c.tally.count("free", r.isFree());
  } else if (r.status == Status::contact) {
    bool apart = false;
    for (int k = 0; k <= 64 && !apart && r.t_lower > 0; ++k) apart = !holds(r.t_lower * k / 64);
    EXPECT_TRUE(apart) << which << ": it has never left";
  }
  for (const CertifiedContact& contact : r.contacts) {
    if (contact.feature != FeatureKind::volume || contact.b1 >= 0 || contact.b2 >= 0 || contact.t_upper != 0) continue;
    c.tally.count("volumes");
    std::vector<Isometry3d> M_0;
    tree->forwardKinematics(q0, M_0);
    const Vector3d in_a = M.inverse() * contact.point, in_b = M_0.back().inverse() * contact.point;
    const bool by_a = a_solid && inside(a, in_a), by_b = b_solid && inside(b, in_b);
    EXPECT_TRUE(by_a || by_b) << which << ": the contact's point is within neither";
  }
}

TEST(SolidMeshCampaign, WindingNumbersOfRandomBodies) {
  const campaign::Tally all = runCases(60, windingNumbers);
  EXPECT_GT(all.share("contained"), 0.2);
  EXPECT_GT(all.share("free"), 1.0 / 30);
  EXPECT_GT(all.share("volumes"), 0.05);
}

}  // namespace solid_mesh_campaign_test
