// SPDX-License-Identifier: BSD-3-Clause
//
// Large bodies that links carry: pairs that are allowed beside touch_links, and what callers change in place. The judge
// has kinematics of its own and asks fcl::collide() at many poses of each motion. (Of boxes and triangles it asks the
// 13 axes: FCL missed 9 of some 40,000 contacts, also where a smaller box touches.) FCL_ARTIC_CARRIED_CASES and
// FCL_ARTIC_CARRIED_SEED in the environment ask for more and for others.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision.h>

#include "../support/random_placing.h"
#include "arms.h"
#include "expect.h"
#include "fcl_artic/point_cloud.h"
#include "meshes.h"
#include "own_kinematics.h"

namespace carried_bodies_test {

using namespace fcl_artic;
using namespace fcl_artic::test;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

using Geometry = std::shared_ptr<fcl::CollisionGeometryd>;

/// The judge's shapes are so much smaller where it looks for missed contacts.
constexpr double kAside = 1e-4;
/// Where it looks for false contacts they are larger: FCL's GJK misses capsules on triangles now and then.
constexpr double kLarger[] = {kAside, 2 * kAside, 4 * kAside};
constexpr int kPoses = 32;

Geometry shapeOf(int kind, double size, double more) {
  if (kind == 0) return std::make_shared<fcl::Sphered>(size + more);
  if (kind == 1) return std::make_shared<fcl::Capsuled>(0.5 * size + more, 3 * size);
  const Vector3d sides = size * Vector3d(2, 1, 1.4) + Vector3d::Constant(2 * more);
  return std::make_shared<fcl::Boxd>(sides);
}

/// Whether no axis separates the two.
/// @param x  the triangle's corners, in the box's frame.
bool boxTouches(const Vector3d& half, const Vector3d (&x)[3]) {
  const auto isApart = [&](const Vector3d& axis) {
    const auto [least, most] = std::minmax({axis.dot(x[0]), axis.dot(x[1]), axis.dot(x[2])});
    const double reach = half.dot(axis.cwiseAbs());
    return least > reach || most < -reach;
  };
  for (int k = 0; k < 3; ++k) {
    if (isApart(Vector3d::Unit(k))) return false;
  }
  if (isApart((x[1] - x[0]).cross(x[2] - x[0]))) return false;
  for (int k = 0; k < 9; ++k) {
    if (isApart(Vector3d::Unit(k % 3).cross(x[k / 3] - x[(k / 3 + 1) % 3]))) return false;
  }
  return true;
}

/// A link's geometry or an obstacle.
struct Other {
  std::string name;
  int link = -1;  ///< -1: obstacle
  Isometry3d place = Isometry3d::Identity();
  Geometry smaller;
  std::vector<Geometry> larger;
};

/// The large body: what the manager has of it, and what it is to have read.
struct Large {
  std::shared_ptr<Mesh> mesh;  ///< that the manager has; null: a cloud
  std::vector<Vector3d> points;
  std::vector<fcl::Triangle> triangles;
  double radius = 0;  ///< of a cloud's points
  std::shared_ptr<fcl::CollisionObjectd> object;
  int carrier = -1;                                            ///< -1: an obstacle
  Isometry3d place = Isometry3d::Identity();                   ///< in the carrier, or in the world
  std::set<int> touch;                                         ///< links
  std::set<std::string> allowed, disallowed;                   ///< with others
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> pieces;  ///< the judge's: the mesh, or balls at `middles`
  std::vector<Vector3d> middles;

  void makePieces() {
    pieces.clear();
    middles.assign(mesh ? 1 : points.size(), Vector3d::Zero());
    if (mesh) {
      pieces.push_back(std::make_unique<fcl::CollisionObjectd>(meshOf(points, triangles)));
      return;
    }
    middles = points;
    for (std::size_t i = 0; i < points.size(); ++i)
      pieces.push_back(std::make_unique<fcl::CollisionObjectd>(std::make_shared<fcl::Sphered>(radius)));
  }
};

struct World {
  std::shared_ptr<KinematicTree> tree = std::make_shared<KinematicTree>("robot");
  std::vector<Joint> joints;
  std::vector<int> parents;
  std::vector<Other> others;
  Large large;
  std::unique_ptr<ArticulatedCollisionManager> manager;

  std::vector<Isometry3d> poses(const VectorXd& q) const { return linkPoses(joints, parents, q); }
  /// Whether queries check the large body and this one.
  bool isChecked(const Other& other) const {
    if (large.allowed.count(other.name)) return false;
    if (other.link == large.carrier) return false;             // one link's, or two obstacles
    const bool still = other.link <= 0 && large.carrier <= 0;  // all joints move
    if (still) return large.disallowed.count(other.name) > 0;
    return large.carrier < 0 || other.link < 0 || !large.touch.count(other.link);
  }
  bool touches(const Other& other, const Geometry& geometry, const VectorXd& q) {
    const auto links = poses(q);
    const auto of = [&](int link) { return link < 0 ? Isometry3d::Identity() : links[static_cast<std::size_t>(link)]; };
    fcl::CollisionObjectd body(geometry, of(other.link) * other.place);
    body.computeAABB();
    const Isometry3d M = of(large.carrier) * large.place;
    const auto* const box = dynamic_cast<const fcl::Boxd*>(geometry.get());
    if (box && large.mesh) {
      const Isometry3d to_box = body.getTransform().inverse() * M;
      return std::any_of(large.triangles.begin(), large.triangles.end(), [&](const fcl::Triangle& t) {
        return boxTouches(box->side / 2,
                          {to_box * large.points[t[0]], to_box * large.points[t[1]], to_box * large.points[t[2]]});
      });
    }
    for (std::size_t i = 0; i < large.pieces.size(); ++i) {
      large.pieces[i]->setTransform(M * Eigen::Translation3d(large.middles[i]));
      large.pieces[i]->computeAABB();
      if (!large.pieces[i]->getAABB().overlap(body.getAABB())) continue;
      fcl::CollisionRequestd request;
      request.gjk_solver_type = fcl::GST_INDEP;
      fcl::CollisionResultd result;
      if (fcl::collide(large.pieces[i].get(), &body, request, result) > 0) return true;
    }
    return false;
  }
};

void drawPoints(Random& random, World& w) {
  Large& large = w.large;
  if (random.oneIn(4)) {
    large.radius = random.uniform(0.01, 0.03);
    for (int i = 64 + random.below(150); i > 0; --i) large.points.push_back(random.box(0.35));
    return;
  }
  const int n = 6 + random.below(8);  // 72 triangles and more
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= n; ++j) {
      const double x = 2.0 * i / n - 1, y = 2.0 * j / n - 1;
      large.points.emplace_back(0.4 * x, 0.4 * y, 0.1 * std::sin(4 * x) * std::cos(3 * y));
      const auto at = static_cast<std::size_t>(i * (n + 1) + j), up = at + static_cast<std::size_t>(n) + 1;
      if (i == n || j == n) continue;
      large.triangles.emplace_back(at, up, up + 1);
      large.triangles.emplace_back(at, up + 1, at + 1);
    }
  }
  large.mesh = meshOf(large.points, large.triangles);
}

/// Links with a shape each, obstacles, and the large body, which nothing else is checked against.
void drawWorld(Random& random, World& w) {
  w.tree->addLink("l0");
  const int joints = 2 + random.below(3);
  for (int i = 0; i < joints; ++i) {
    const int parent = random.chance(0.7) ? i : random.below(i + 1);
    const std::string link = "l" + std::to_string(i + 1);
    w.tree->addLink(link);
    const bool slides = random.oneIn(4);
    w.joints.push_back(makeJoint("j" + std::to_string(i), slides ? JointType::prismatic : JointType::continuous,
                                 "l" + std::to_string(parent), link, random.direction(), random.pose(0.4)));
    w.joints.back().axis.normalize();
    w.tree->addJoint(w.joints.back());
    w.parents.push_back(parent);
  }
  w.manager = std::make_unique<ArticulatedCollisionManager>(w.tree);
  for (int i = -4; i <= joints; ++i) {
    Other other;
    other.link = std::max(i, -1);
    other.name = i < 0 ? "o" + std::to_string(-i) : "l" + std::to_string(i);
    other.place = random.pose(i < 0 ? 1 : 0.1);
    const int kind = random.below(3);
    const double size = random.logUniform(0.03, 0.12);
    other.smaller = shapeOf(kind, size, -kAside);
    for (const double more : kLarger) other.larger.push_back(shapeOf(kind, size, more));
    if (i < 0) {
      w.manager->registerObject(object(shapeOf(kind, size, 0), other.place), other.name);
    } else {
      w.manager->bind(other.name, object(shapeOf(kind, size, 0)), other.place);
    }
    w.others.push_back(other);
  }
  for (std::size_t i = 0; i < w.others.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) w.manager->allow(w.others[i].name, w.others[k].name);
  }
  drawPoints(random, w);
  w.large.place = random.pose(0.8);
  w.large.object = object(
      w.large.mesh ? Geometry(w.large.mesh) : Geometry(std::make_shared<PointCloud>(w.large.points, w.large.radius)),
      w.large.place);
  w.large.makePieces();
  w.manager->registerObject(w.large.object, "large");
}

void attach(Random& random, World& w) {
  w.large.carrier = random.below(static_cast<int>(w.joints.size()) + 1);
  w.large.place = random.pose(0.3);
  w.large.touch.clear();
  std::vector<std::string> names;
  for (int link = 0; link <= static_cast<int>(w.joints.size()); ++link) {
    if (!random.oneIn(3)) continue;
    w.large.touch.insert(link);
    names.push_back("l" + std::to_string(link));
  }
  w.manager->attach(w.large.carrier, w.large.object, w.large.place, names);
}

void setUp(Random& random, World& w) {
  const int way = random.below(3);
  if (way == 0) w.manager->setup();
  if (way == 1) w.manager->update();
  if (way == 2) w.manager->update(w.large.object);
}

/// @return what was changed.
const char* change(Random& random, World& w) {
  Large& large = w.large;
  switch (random.below(5)) {
    case 0: {  // looked at as long as nobody carries it
      const Isometry3d place = random.pose(0.8);
      large.object->setTransform(place);
      if (large.carrier < 0) large.place = place;
      setUp(random, w);
      return large.carrier < 0 ? "an obstacle's transform" : "a carried body's transform";
    }
    case 1: {
      if (!large.mesh) break;  // clouds cannot be changed
      const double x = random.uniform(0.3, 1.6), y = random.uniform(0.3, 1.6), z = random.uniform(0.5, 3);
      for (std::size_t i = 0; i < large.points.size(); ++i) {
        large.points[i] = large.points[i].cwiseProduct(Vector3d(x, y, z)) + 0.02 * random.box(1);
        large.mesh->vertices[i] = large.points[i];
      }
      large.makePieces();
      setUp(random, w);
      return large.carrier < 0 ? "an obstacle's geometry" : "a carried body's geometry";
    }
    case 2:
      if (large.carrier < 0) {
        attach(random, w);
      } else {
        large.carrier = -1;
        large.place = random.pose(0.8);
        large.object->setTransform(large.place);
        w.manager->detach(large.object);
      }
      setUp(random, w);
      return large.carrier < 0 ? "put down" : "taken up";
    default: {
      const std::string name = random.of(w.others).name;
      if (random.chance(0.6)) {
        w.manager->allow(name, "large");
        large.allowed.insert(name);
        large.disallowed.erase(name);
      } else {
        w.manager->disallow("large", name);
        large.allowed.erase(name);
        large.disallowed.insert(name);
      }
      setUp(random, w);
      return "allowed pairs";
    }
  }
  return "nothing";
}

/// Ends of a motion.
std::pair<VectorXd, VectorXd> drawMotion(Random& random, const World& w) {
  const auto n = static_cast<Eigen::Index>(w.joints.size());
  VectorXd q0(n), q1(n);
  const double most = random.logUniform(0.1, 3);
  for (Eigen::Index i = 0; i < n; ++i) {
    const bool slides = w.joints[static_cast<std::size_t>(i)].type == JointType::prismatic;
    q0[i] = random.uniform(-1, 1) * (slides ? 0.3 : 2.5);
    q1[i] = q0[i] + most * random.uniform(-1, 1) * (slides ? 0.3 : 1);
  }
  return {q0, q1};
}

/// One motion, asked and judged.
void look(campaign::Case& c, Random& random, World& w, const char* changed) {
  const auto ends = drawMotion(random, w);
  const VectorXd &q0 = ends.first, &q1 = ends.second;
  CertifiedRequest request;
  request.mode = static_cast<ContactMode>(random.below(3));
  request.max_contacts = 1000;
  request.visibility = random.oneIn(3) ? VisibilityMode::on : VisibilityMode::off;
  const CertifiedResult r = w.manager->continuousCollide(q0, q1, request);
  const auto fault = [&](const char* kind, const std::string& name, double t) {
    c.fault(kind, campaign::format("%s, large and %s at %.9g: %s [%.9g, %.9g], mode %d", changed, name.c_str(), t,
                                   toString(r.status), r.t_lower, r.t_upper, static_cast<int>(request.mode)));
  };
  if (r.status == Status::undecided) return fault("undecided", "", 0);
  std::map<std::string, const CertifiedContact*> contacts;
  for (const CertifiedContact& contact : r.contacts)
    contacts[contact.body1.name == "large" ? contact.body2.name : contact.body1.name] = &contact;
  bool left_out = false, met = false;
  for (const Other& other : w.others) {
    const auto found = contacts.find(other.name);
    const CertifiedContact* const contact = found == contacts.end() ? nullptr : found->second;
    const bool checked = w.isChecked(other);
    if (!checked && contact) fault("a pair that is left out", other.name, contact->t_lower);
    const auto touches = [&](const Geometry& geometry) {
      return w.touches(other, geometry, q0 + contact->t_upper * (q1 - q0));
    };
    if (contact && contact->certain && std::none_of(other.larger.begin(), other.larger.end(), touches))
      fault("no contact", other.name, contact->t_upper);
    for (int k = 0; k <= kPoses; ++k) {
      const double t = static_cast<double>(k) / kPoses;
      if (!w.touches(other, other.smaller, q0 + t * (q1 - q0))) continue;
      left_out = left_out || (!checked && other.link != w.large.carrier);
      met = met || checked;
      if (checked && t < r.t_lower) fault("missed", other.name, t);
      if (checked && request.mode == ContactMode::firstOfEveryPair &&
          (!contact || contact->t_lower > t + 2 * request.tolerance_time))
        fault("missed pair", other.name, t);
      break;
    }
  }
  const std::string how = w.large.carrier < 0 ? "an obstacle" : "carried";
  c.tally.count(changed);
  c.tally.count(how + ", free", r.isFree());
  c.tally.count(how + ", contact", r.status == Status::contact);
  c.tally.count(how + ", later contact", r.status == Status::contact && r.t_lower > 0);
  c.tally.count(how + ", free but for a pair that is left out", r.isFree() && left_out);
  c.tally.count(how + ", contact that FCL sees", met);
  c.tally.count("left by stage 1", r.statistics.pairs_after_culling > 0);
}

void lookAtCase(campaign::Case& c) {
  Random random(c.id.seed);
  World w;
  drawWorld(random, w);
  attach(random, w);
  for (const Other& other : w.others) {
    if (!random.oneIn(4)) continue;
    w.manager->allow("large", other.name);
    w.large.allowed.insert(other.name);
  }
  w.manager->setup();
  const char* changed = "at first";
  for (int round = 0; round < 5; ++round) {
    for (int motion = 0; motion < 2; ++motion) look(c, random, w, changed);
    changed = change(random, w);
  }
}

/// Any contacts of a mesh in the hand: at the time that the answer gives, what it says touches does.
void lookAtAnyContacts(campaign::Case& c) {
  Random random(c.id.seed);
  World w;
  drawWorld(random, w);
  if (!w.large.mesh) return;
  attach(random, w);
  w.manager->setup();
  CertifiedRequest request;
  request.mode = ContactMode::any;
  for (int motion = 0; motion < 100; ++motion) {
    const auto [q0, q1] = drawMotion(random, w);
    const CertifiedResult r = w.manager->continuousCollide(q0, q1, request);
    if (r.status != Status::contact || !r.contacts[0].certain) continue;
    const CertifiedContact& contact = r.contacts[0];
    const std::string name = contact.body1.name == "large" ? contact.body2.name : contact.body1.name;
    const Other& other =
        *std::find_if(w.others.begin(), w.others.end(), [&](const Other& o) { return o.name == name; });
    const auto touches = [&, q = VectorXd(q0 + contact.t_upper * (q1 - q0))](const Geometry& geometry) {
      return w.touches(other, geometry, q);
    };
    c.tally.count("contacts");
    c.tally.count("with obstacles", other.link < 0);
    c.tally.count("at the end", contact.t_upper == 1);
    if (std::none_of(other.larger.begin(), other.larger.end(), touches))
      c.fault("no contact", campaign::format("%s at %.9g", name.c_str(), contact.t_upper));
  }
}

}  // namespace

TEST(CarriedBodies, AnyContactsOfMeshesTouch) {
  campaign::Campaign bodies;
  bodies.look = lookAtAnyContacts;
  const campaign::Options o = campaign::optionsOfTest("FCL_ARTIC_CARRIED", 300);
  const campaign::Tally all = runWithoutFaults(bodies, o).total;
  EXPECT_GT(all.share("with obstacles"), 5);  // of 100 motions
  EXPECT_GT(all["at the end"], 50u);
}

TEST(CarriedBodies, AllowedPairsAndChangesInPlace) {
  campaign::Campaign bodies;
  bodies.look = lookAtCase;
  const campaign::Options o = campaign::optionsOfTest("FCL_ARTIC_CARRIED", 100);
  const campaign::Tally all = runWithoutFaults(bodies, o).total;
  EXPECT_GT(all.share("carried, free"), 0.5);  // of ten motions
  EXPECT_GT(all.share("carried, later contact"), 0.3);
  EXPECT_GT(all.share("carried, contact that FCL sees"), 0.5);
  EXPECT_GT(all.share("carried, free but for a pair that is left out"), 0.2);
  for (const char* changed : {"a carried body's transform", "a carried body's geometry", "an obstacle's transform",
                              "an obstacle's geometry", "put down", "taken up", "allowed pairs"})
    EXPECT_GT(all[changed], 10u) << changed;
}

}  // namespace carried_bodies_test
