// SPDX-License-Identifier: BSD-3-Clause
//
// Large obstacles, into which stage 1 goes, against the same scene cut into obstacles of one piece each, against the
// same motion seen from a limb, to which the large body is carried, and against FCL at single poses.
// FCL_ARTIC_LARGE_CASES and FCL_ARTIC_LARGE_SEED in the environment ask for more and for others.
#include <algorithm>
#include <cmath>
#include <map>

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/octree/octree.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/geometry/shape/triangle_p.h>
#include <fcl/narrowphase/collision.h>

#include "../support/random_placing.h"
#include "arms.h"
#include "expect.h"
#include "fcl_artic/point_cloud.h"
#include "own_kinematics.h"
#include "solid_meshes.h"

namespace large_bodies_test {

using namespace fcl_artic;
using namespace fcl_artic::test;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

using Geometry = std::shared_ptr<fcl::CollisionGeometryd>;

/// FCL's shapes are made this much smaller, in units: what it takes for contact is contact then.
constexpr double kShrink = 1e-4;

/// How the unit's shapes are placed: made `size` times as large, and put `away` from their own frame's origin.
struct Measure {
  double size;
  Vector3d away;  ///< in units
  Vector3d of(const Vector3d& x) const { return size * (x + away); }
};

/// A large body in units, of a radius of about 1, and all that is made of it.
struct Large {
  enum Kind { terrain, blob, soup, tube, cloud, cells, kinds } kind = terrain;
  bool solid = false;
  Soup mesh;                                                 ///< of all kinds but the last two
  std::vector<Vector3d> points;                              ///< of a cloud; middles of cells
  std::vector<double> radii;                                 ///< of a cloud
  double cell = 0;                                           ///< width
  Geometry whole;                                            ///< measured
  std::vector<Geometry> pieces;                              ///< measured
  std::vector<Isometry3d> places;                            ///< of the pieces, in the body's frame
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> unit;  ///< for FCL
  fcl::DynamicAABBTreeCollisionManagerd fcl;

  bool isMesh() const { return kind < cloud; }
};

void drawTriangles(Random& random, int count, Large& body) {
  Soup& mesh = body.mesh;
  const int n = std::max(6, static_cast<int>(std::sqrt(count / 2.0)));
  const double phase = random.uniform(0, 6), wave = random.uniform(1, 6), height = random.uniform(0, 0.4);
  const auto add = [&](const Vector3d& a, const Vector3d& b, const Vector3d& c) {
    const std::size_t first = mesh.vertices.size();
    mesh.vertices.insert(mesh.vertices.end(), {a, b, c});
    mesh.triangles.emplace_back(first, first + 1, first + 2);
  };
  if (body.kind == Large::terrain) {  // open
    const auto at = [&](int i, int j) {
      const double x = 2.0 * i / n - 1, y = 2.0 * j / n - 1;
      return Vector3d(x, y, height * std::sin(wave * x + phase) * std::cos(wave * y));
    };
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) {
        add(at(i, j), at(i + 1, j), at(i + 1, j + 1));
        add(at(i, j), at(i + 1, j + 1), at(i, j + 1));
      }
    }
  } else if (body.kind == Large::blob) {  // closed, of six sides of a cube
    const auto at = [&](int side, int i, int j) {
      const int k = side / 2;
      Vector3d d;
      d[k] = side % 2 ? n : -n;
      d[(k + 1) % 3] = side % 2 ? 2 * i - n : 2 * j - n;
      d[(k + 2) % 3] = side % 2 ? 2 * j - n : 2 * i - n;
      d.normalize();
      return Vector3d((1 + 0.5 * height * std::sin(wave * d[0] + phase) * std::cos(wave * d[2])) * d);
    };
    const int cuts = n;
    for (int side = 0; side < 6; ++side) {
      for (int i = 0; i < cuts; i += 1) {
        for (int j = 0; j < cuts; j += 1) {
          add(at(side, i, j), at(side, i + 1, j), at(side, i + 1, j + 1));
          add(at(side, i, j), at(side, i + 1, j + 1), at(side, i, j + 1));
        }
      }
    }
  } else if (body.kind == Large::soup) {  // triangles of all sizes, slivers and worse among them
    for (int i = 0; i < count; ++i) {
      const Vector3d a = random.box(1);
      const double size = random.logUniform(0.005, random.oneIn(20) ? 1 : 0.15);
      const Vector3d b = a + size * random.direction();
      Vector3d c = a + size * random.direction();
      if (random.oneIn(5)) c = a + random.unit() * (b - a) + random.logUniform(1e-9, 1e-2) * random.direction();
      if (random.oneIn(20)) c = random.oneIn(2) ? b : Vector3d(0.5 * (a + b));
      if (random.oneIn(60)) c = a;
      add(a, b, c);
    }
  } else {  // slivers side by side, as long as the tube
    const int sides = count / 2;
    const double radius = random.uniform(0.2, 0.8);
    const auto at = [&](int i, double z) {
      const double turn = 6.283185307179586 * (i % sides) / sides;
      return Vector3d(radius * std::cos(turn), radius * std::sin(turn), z);
    };
    for (int i = 0; i < sides; ++i) {
      add(at(i, -1), at(i + 1, -1), at(i + 1, 1));
      add(at(i, -1), at(i + 1, 1), at(i, 1));
    }
  }
}

void drawLarge(Random& random, const Measure& measure, Large& body) {
  body.kind = static_cast<Large::Kind>(random.below(Large::kinds));
  const int count = static_cast<int>(random.logUniform(64, random.oneIn(8) ? 3000 : 600));
  Soup real;
  if (body.isMesh()) {
    drawTriangles(random, body.kind == Large::blob ? count / 3 : count, body);
    body.solid = body.kind == Large::blob && random.oneIn(2);
    real = body.mesh;
    for (Vector3d& v : real.vertices) v = measure.of(v);
    body.whole = body.solid ? Geometry(real.solid()) : Geometry(real.surface());
    for (const fcl::Triangle& t : real.triangles) {
      body.pieces.push_back(
          std::make_shared<fcl::TrianglePd>(real.vertices[t[0]], real.vertices[t[1]], real.vertices[t[2]]));
      body.places.push_back(Isometry3d::Identity());
    }
    Soup proper = body.mesh;  // FCL knows no triangles without area
    proper.triangles.clear();
    for (const fcl::Triangle& t : body.mesh.triangles) {
      const Vector3d &a = proper.vertices[t[0]], &b = proper.vertices[t[1]], &c = proper.vertices[t[2]];
      if ((b - a).cross(c - a).norm() > 1e-3 * (b - a).norm() * (c - a).norm()) proper.triangles.push_back(t);
    }
    body.unit.push_back(std::make_unique<fcl::CollisionObjectd>(proper.surface()));
  } else if (body.kind == Large::cloud) {
    const bool same = random.oneIn(2);
    const double radius = random.logUniform(0.002, 0.05), flat = random.oneIn(2) ? 0.1 : 1;
    std::vector<Vector3d> points;
    std::vector<double> radii;
    for (int i = 0; i < count; ++i) {
      const Vector3d x = random.box(1);
      body.points.push_back({x[0], x[1], flat * x[2]});
      body.radii.push_back(same ? radius : radius * random.uniform(0.1, 1.5));
      points.push_back(measure.of(body.points.back()));
      radii.push_back(measure.size * body.radii.back());
      body.pieces.push_back(std::make_shared<fcl::Sphered>(radii.back()));
      body.places.push_back(pose(points.back()));
      body.unit.push_back(std::make_unique<fcl::CollisionObjectd>(std::make_shared<fcl::Sphered>(body.radii.back()),
                                                                  pose(body.points.back())));
    }
    body.whole = std::make_shared<PointCloud>(points, radii);
  } else {
    body.cell = random.oneIn(2) ? 0.0625 : 0.125;
    const double width = measure.size * body.cell;
    const auto tree = std::make_shared<octomap::OcTree>(width);
    const int reach = static_cast<int>(1 / body.cell);
    const Vector3d first = measure.away / body.cell;  // whole numbers
    std::map<std::array<int, 3>, bool> taken;
    for (int i = 0; i < count; ++i) {
      const std::array<int, 3> at = {random.below(2 * reach) - reach, random.below(2 * reach) - reach,
                                     random.below(2 * reach) - reach};
      if (!taken.emplace(at, true).second) continue;
      const Vector3d middle(at[0] + 0.5, at[1] + 0.5, at[2] + 0.5), there = width * (middle + first);
      const octomap::OcTreeKey key(static_cast<octomap::key_type>(32768 + at[0] + std::lround(first[0])),
                                   static_cast<octomap::key_type>(32768 + at[1] + std::lround(first[1])),
                                   static_cast<octomap::key_type>(32768 + at[2] + std::lround(first[2])));
      tree->setNodeValue(key, octomap::logodds(0.95), true);
      body.pieces.push_back(std::make_shared<fcl::Boxd>(width, width, width));
      body.places.push_back(pose(there));
      body.unit.push_back(std::make_unique<fcl::CollisionObjectd>(
          std::make_shared<fcl::Boxd>(body.cell, body.cell, body.cell), pose(body.cell * middle)));
    }
    tree->updateInnerOccupancy();
    body.whole = std::make_shared<fcl::OcTreed>(tree);
  }
  for (const auto& object : body.unit) body.fcl.registerObject(object.get());
  body.fcl.setup();
}

/// A link's geometry: `measured`, and in units without its outermost kShrink, for FCL.
struct Limb {
  LinkId link = 0;
  std::string name;
  Isometry3d offset = Isometry3d::Identity();  ///< measured
  Geometry measured, unit;
  std::unique_ptr<fcl::CollisionObjectd> object;
  double margin = 0;  ///< of its pair with the large body, in all
  bool allowed = false;
};

Geometry limbOf(int kind, double size, const Vector3d& sides, double less, double scale) {
  const double radius = size - less;
  switch (kind) {
    case 0:
      return std::make_shared<fcl::Sphered>(scale * radius);
    case 1:
      return std::make_shared<fcl::Capsuled>(scale * 0.5 * radius, scale * 2 * size * sides[0]);
    case 2: {
      const Vector3d side = 2 * scale * (size * sides - Vector3d::Constant(less));
      return std::make_shared<fcl::Boxd>(side);
    }
    case 3:
      return boxMesh(scale * (size * sides - Vector3d::Constant(less)));
    default:
      return fineBoxMesh(scale * (size * sides - Vector3d::Constant(less)), 5);
  }
}

struct World {
  double size = 1;
  std::shared_ptr<KinematicTree> tree = std::make_shared<KinematicTree>("robot");
  std::vector<Joint> joints;
  std::vector<int> parents;
  std::vector<std::unique_ptr<Limb>> limbs;
  Large large;
  Measure measure;
  Isometry3d place = Isometry3d::Identity();  ///< of the large body
  std::unique_ptr<ArticulatedCollisionManager> whole, cut;
  std::vector<std::shared_ptr<fcl::CollisionObjectd>> pieces;

  /// Poses of all links.
  std::vector<Isometry3d> poses(const VectorXd& q) const { return linkPoses(joints, parents, q); }
  /// The limb's pose as seen from the large body, in units.
  Isometry3d unitPose(const Limb& limb, const std::vector<Isometry3d>& links) const {
    Isometry3d X = place.inverse() * links[static_cast<std::size_t>(limb.link)] * limb.offset;
    X.translation() = X.translation() / size - measure.away;
    return X;
  }
};

void drawRobot(Random& random, World& w) {
  w.tree->addLink("l0");
  const int joints = 1 + random.below(5);
  const bool near = random.oneIn(3);
  for (int i = 0; i < joints; ++i) {
    const int parent = random.chance(0.7) ? i : random.below(i + 1);
    const std::string link = "l" + std::to_string(i + 1);
    w.tree->addLink(link);
    Isometry3d origin = random.pose(0.3);
    if (parent == 0) {  // it stands near the body, wherever that is
      const Vector3d at = w.large.kind == Large::terrain && !near
                              ? Vector3d(random.uniform(-0.8, 0.8), random.uniform(-0.8, 0.8), random.uniform(0.2, 0.9))
                              : Vector3d(random.uniform(near ? 0.2 : 0.7, near ? 1 : 1.8) * random.direction());
      origin.translation() = w.place * w.measure.of(at);
    } else {
      origin.translation() *= w.size;
    }
    const bool slides = random.oneIn(4);
    w.joints.push_back(makeJoint("j" + std::to_string(i), slides ? JointType::prismatic : JointType::continuous,
                                 "l" + std::to_string(parent), link, random.direction(), origin));
    w.joints.back().axis.normalize();
    w.tree->addJoint(w.joints.back());
    w.parents.push_back(parent);
    if (i + 1 < joints && random.oneIn(4)) continue;
    for (int n = random.oneIn(6) ? 2 : 1; n > 0; --n) {
      auto limb = std::make_unique<Limb>();
      limb->link = i + 1;
      limb->name = link;
      limb->offset = random.pose(0.1);
      limb->offset.translation() *= w.size;
      const int kind = random.below(5);
      const double size = random.logUniform(0.02, 0.15);
      const double x = random.uniform(0.1, 1), y = random.uniform(0.1, 1), z = random.uniform(0.1, 1);
      limb->measured = limbOf(kind, size, {x, y, z}, 0, w.size);
      limb->unit = limbOf(kind, size, {x, y, z}, kShrink, 1);
      w.limbs.push_back(std::move(limb));
    }
  }
}

std::string nameOf(std::size_t piece) {
  return "p" + std::to_string(piece);
}

/// Both scenes, with the same margins and allowed pairs. (A link's are those of all of its geometry.)
void setUp(Random& random, const CertifiedRequest& request, World& w) {
  w.whole = std::make_unique<ArticulatedCollisionManager>(w.tree);
  w.cut = std::make_unique<ArticulatedCollisionManager>(w.tree);
  for (const auto& limb : w.limbs) {
    limb->object = std::make_unique<fcl::CollisionObjectd>(limb->measured);
    w.whole->bind(limb->name, limb->object.get(), limb->offset);
    w.cut->bind(limb->name, limb->object.get(), limb->offset);
  }
  w.whole->registerObject(object(w.large.whole, w.place), "large");
  for (std::size_t i = 0; i < w.large.pieces.size(); ++i) {
    w.pieces.push_back(object(w.large.pieces[i], w.place * w.large.places[i]));
    w.cut->registerObject(w.pieces.back(), nameOf(i));
  }
  double usual = request.margin;
  if (random.oneIn(6)) {  // a margin of the body's
    usual = std::max(usual, w.size * random.logUniform(1e-3, 0.1));
    w.whole->setMargin("large", usual);
    for (std::size_t i = 0; i < w.pieces.size(); ++i) w.cut->setMargin(nameOf(i), usual);
  }
  std::map<std::string, std::pair<double, bool>> of_links;
  for (const auto& limb : w.limbs) {
    if (!of_links.count(limb->name)) {
      double margin = usual;
      const bool allowed = w.limbs.size() > 1 && random.oneIn(10);
      if (random.oneIn(5)) {  // of the pair's own
        margin = random.oneIn(3) ? 0 : w.size * random.logUniform(1e-3, 0.1);
        w.whole->setMargin(limb->name, "large", margin);
        for (std::size_t i = 0; i < w.pieces.size(); ++i) w.cut->setMargin(limb->name, nameOf(i), margin);
      }
      if (allowed) {
        w.whole->allow(limb->name, "large");
        for (std::size_t i = 0; i < w.pieces.size(); ++i) w.cut->allow(limb->name, nameOf(i));
      }
      of_links[limb->name] = {margin + request.added_margin, allowed};
    }
    std::tie(limb->margin, limb->allowed) = of_links[limb->name];
  }
  w.whole->setup();
  w.cut->setup();
}

/// A motion or a trajectory, with the configurations that it passes.
struct Way {
  std::shared_ptr<JointMotion> motion;
  std::shared_ptr<JointTrajectory> trajectory;
  bool half_angles = false;
  double end = 1;
  std::vector<VectorXd> corners;

  CertifiedResult ask(const ArticulatedCollisionManager& manager, const CertifiedRequest& request) const {
    CertifiedResult result;
    if (trajectory) {
      manager.continuousCollide(*trajectory, request, result);
    } else {
      manager.continuousCollide(*motion, request, result);
    }
    return result;
  }
  /// Sets the motion or the trajectory.
  void goThrough(const KinematicTree& tree, const std::vector<VectorXd>& configurations) {
    corners = configurations;
    const std::size_t pieces = corners.size() - 1;
    trajectory.reset();
    motion.reset();
    if (pieces > 1) {
      std::vector<double> times;
      for (std::size_t k = 0; k <= pieces; ++k) times.push_back(static_cast<double>(k));
      end = times.back();
      trajectory =
          std::make_shared<JointTrajectory>(half_angles ? JointTrajectory::tangentHalfAngle(tree, times, corners)
                                                        : JointTrajectory::linear(tree, times, corners));
    } else {
      motion = std::make_shared<JointMotion>(half_angles ? JointMotion::tangentHalfAngle(tree, corners[0], corners[1])
                                                         : JointMotion::linear(tree, corners[0], corners[1]));
    }
  }
  /// @param t  in [0, 1].
  VectorXd at(double t, const std::vector<Joint>& joints) const {
    const std::size_t pieces = corners.size() - 1,
                      k = std::min(pieces - 1, static_cast<std::size_t>(t * double(pieces)));
    const double s = t * double(pieces) - double(k);
    VectorXd q = corners[k] + s * (corners[k + 1] - corners[k]);
    for (std::size_t i = 0; half_angles && i < joints.size(); ++i) {
      const auto j = static_cast<Eigen::Index>(i);
      if (joints[i].type == JointType::prismatic) continue;
      const double a = std::tan(corners[k][j] / 2), b = std::tan(corners[k + 1][j] / 2);
      q[j] = 2 * std::atan(a + s * (b - a));
    }
    return q;
  }
};

Way drawWay(Random& random, const World& w) {
  Way way;
  const auto n = static_cast<Eigen::Index>(w.joints.size());
  const double most = random.oneIn(8) ? random.logUniform(3, 60) : random.logUniform(0.1, 3);  // rad
  way.half_angles = most < 3 && random.oneIn(3);
  const int pieces = random.oneIn(4) ? 2 + random.below(3) : 1;
  for (int k = 0; k <= pieces; ++k) {
    VectorXd q(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const bool slides = w.joints[static_cast<std::size_t>(i)].type == JointType::prismatic;
      if (k == 0) {
        q[i] = slides ? w.size * random.uniform(-0.3, 0.3) : random.uniform(-2.5, 2.5);
      } else {
        const double step = random.uniform(-1, 1) * (slides ? w.size * std::min(0.5 * most, 1.0) : most);
        q[i] = way.corners.back()[i] + step;
        if (way.half_angles && !slides) q[i] = std::max(-2.9, std::min(q[i], 2.9));
      }
    }
    way.corners.push_back(q);
  }
  const std::vector<VectorXd> corners = way.corners;
  way.goThrough(*w.tree, corners);
  return way;
}

/// What is known of one link and the body, or all of its pieces together.
struct Known {
  int contacts = 0;
  bool certain = false;
  double lower = 1e300, upper = 1e300;  ///< free before; contact proven by then
};
using KnownOf = std::map<std::string, Known>;  ///< by link

/// Of contacts between limbs and obstacles.
KnownOf knownOf(const CertifiedResult& r) {
  KnownOf all;
  for (const CertifiedContact& contact : r.contacts) {
    if (contact.body1.link >= 0 && contact.body2.link >= 0) continue;
    Known& known = all[contact.body1.link >= 0 ? contact.body1.name : contact.body2.name];
    ++known.contacts;
    known.lower = std::min(known.lower, contact.t_lower);
    if (contact.certain) {
      known.certain = true;
      known.upper = std::min(known.upper, contact.t_upper);
    }
  }
  return all;
}

std::vector<std::string> ignoredBy(const CertifiedResult& r) {
  std::vector<std::string> all;
  for (const auto& [a, b] : r.ignored_initial_contacts) {
    if (a.link >= 0 && b.link >= 0) continue;
    all.push_back(a.link >= 0 ? a.name : b.name);
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

/// How often the surface winds around a point (van Oosterom and Strackee, 1983); far from a whole number: on it.
double windingNumber(const Soup& soup, const Vector3d& x) {
  double sum = 0;
  for (const fcl::Triangle& t : soup.triangles) {
    const Vector3d a = soup.vertices[t[0]] - x, b = soup.vertices[t[1]] - x, c = soup.vertices[t[2]] - x;
    const double na = a.norm(), nb = b.norm(), nc = c.norm();
    sum += 2 * std::atan2(a.dot(b.cross(c)), na * nb * nc + a.dot(b) * nc + b.dot(c) * na + c.dot(a) * nb);
  }
  return sum / (4 * 3.14159265358979323846);
}

/// The same motion seen from a limb: it stands still, as an obstacle or bound to the root, and the joints between it
/// and the world, the other way round, carry the large body.
CertifiedResult askCarried(Random& random, const World& w, const Way& way, const Limb& limb, CertifiedRequest request) {
  std::vector<std::size_t> order;  // joints from the limb's to the world's
  for (int link = limb.link; link > 0; link = w.parents[static_cast<std::size_t>(link - 1)]) {
    order.push_back(static_cast<std::size_t>(link - 1));
  }
  const auto tree = std::make_shared<KinematicTree>("carrier");
  tree->addLink("c0");
  Isometry3d before = Isometry3d::Identity();  // what lies between the joint before and this one
  for (std::size_t k = 0; k < order.size(); ++k) {
    const Joint& joint = w.joints[order[k]];
    const std::string name = std::to_string(k + 1);
    tree->addLink("c" + name);
    tree->addJoint(makeJoint("j" + name, joint.type, "c" + std::to_string(k), "c" + name, -joint.axis, before));
    before = joint.origin.inverse();
  }
  ArticulatedCollisionManager manager(tree);
  const bool bound = random.oneIn(2);
  const auto still = object(limb.measured, bound ? Isometry3d::Identity() : limb.offset);
  if (bound) {
    manager.bind("c0", still, limb.offset);
  } else {
    manager.registerObject(still, "limb");
  }
  const auto large = object(w.large.whole);
  manager.registerObject(large, "large");
  manager.attach("c" + std::to_string(order.size()), large, before * w.place);
  manager.setup();
  std::vector<VectorXd> corners;
  for (const VectorXd& corner : way.corners) {
    VectorXd& q = corners.emplace_back(static_cast<Eigen::Index>(order.size()));
    for (std::size_t k = 0; k < order.size(); ++k) {
      q[static_cast<Eigen::Index>(k)] = corner[static_cast<Eigen::Index>(order[k])];
    }
  }
  Way reversed = way;
  reversed.goThrough(*tree, corners);
  request.margin = limb.margin;
  request.added_margin = 0;
  request.check_self = true;
  return reversed.ask(manager, request);
}

std::string text(const CertifiedResult& r) {
  return campaign::format("%s%s [%.9g, %.9g]", toString(r.status), r.certain ? "" : "?", r.t_lower, r.t_upper);
}

class Judge {
 public:
  Judge(campaign::Case& c, const World& w, const Way& way, const CertifiedRequest& request)
      : case_(c),
        random_(c.id.seed + 1),
        world_(w),
        way_(way),
        request_(request),
        slack_(w.large.isMesh() ? 1e-9 : 1e-6) {}

  void look() {
    CertifiedRequest request = request_;
    const CertifiedResult a = way_.ask(*world_.whole, request), b = way_.ask(*world_.cut, request);
    count(a);
    searchesNoMore(a);
    if (a.status == Status::undecided || b.status == Status::undecided) fault("undecided", text(a) + ", " + text(b));
    inside_ = startsInside();
    case_.tally.count("inside a solid", inside_);
    if (inside_ && !request.ignore_initial_contact) {
      if (a.status != Status::contact || !a.certain || a.t_lower > 0) fault("inside", text(a));
      return;
    }
    const auto ignored = ignoredBy(a), ignored_of_cut = ignoredBy(b);
    case_.tally.count("initial contact ignored", !ignored.empty());
    request.visibility = VisibilityMode::off;
    request.mode = ContactMode::firstOfEveryPair;
    const CertifiedResult all = request_.mode == ContactMode::firstOfEveryPair ? a : way_.ask(*world_.whole, request),
                          all_of_cut =
                              request_.mode == ContactMode::firstOfEveryPair ? b : way_.ask(*world_.cut, request);
    compareEvery(all, all_of_cut);
    carried(all);
    if (world_.limbs.size() == 1 && ignored.empty() && !request.check_self) {
      request.mode = ContactMode::first;
      const CertifiedResult first = way_.ask(*world_.whole, request);
      const auto work = [](const CertifiedResult& r) {
        return r.statistics.leaf_tests + r.statistics.node_tests + r.statistics.certificates + r.statistics.gjk;
      };
      compare("first and every pair's", first, all);
      case_.tally.count("work for the only pair", work(all));
      case_.tally.count("work for the first pair", work(first));
    }
    if (ignored.empty() && ignored_of_cut.empty()) {
      compare("whole and cut", a, b);
      compare("whole and every pair's", a, all);
      compare("whole and every pair's of the cut", a, all_of_cut);
      compare("cut and every pair's", b, all);
    } else if (!inside_) {
      const bool resting = ignored != ignored_of_cut;  // it barely touches, or barely not
      if (resting) case_.tally.count("ignored by one only");
      if (resting && request_.margin == 0 && world_.large.isMesh()) fault("ignored pairs", "");
      watchedAgain(all);
    }
    if (a.isFree()) sample(a);
  }

 private:
  void fault(const std::string& kind, const std::string& words) {
    case_.fault(kind, campaign::format("seed %llu, mode %d, kind %d, visibility %d, ignore %d, %zu pieces: ",
                                       static_cast<unsigned long long>(case_.id.seed), static_cast<int>(request_.mode),
                                       static_cast<int>(world_.large.kind), static_cast<int>(request_.visibility),
                                       request_.ignore_initial_contact, world_.pieces.size()) +
                          words);
  }
  void count(const CertifiedResult& a) {
    static const char* const kModes[] = {"mode first", "mode any", "mode firstOfEveryPair"};
    static const char* const kKinds[] = {"terrain", "blob", "soup", "tube", "cloud", "cells"};
    campaign::Tally& tally = case_.tally;
    tally.count(kModes[static_cast<int>(request_.mode)]);
    tally.count(kKinds[world_.large.kind]);
    tally.count("free", a.isFree());
    tally.count("contact", a.status == Status::contact);
    tally.count("contact at once", a.status == Status::contact && a.t_lower == 0 && a.certain);
    tally.count("later contact", a.status == Status::contact && a.t_lower > 0);
    tally.count("not certain", a.status == Status::contact && !a.certain);
    tally.count("trajectories", way_.trajectory != nullptr);
    tally.count("half angles", way_.half_angles);
    tally.count("culled by stage 2", a.statistics.visibility.culled > 0);
    tally.count("left by stage 1", a.statistics.pairs_after_culling > 0);
    tally.count("free, left by stage 1", a.isFree() && a.statistics.pairs_after_culling > 0);
  }
  /// Where stage 2 has proven all pairs free, nothing is left to do. (ContactMode::any tries poses before it. A query
  /// that is free but for an ignored pair is solved again without it, which `repeated` says.)
  void searchesNoMore(const CertifiedResult& a) {
    const QueryStatistics& s = a.statistics;
    if (request_.mode == ContactMode::any || !a.isFree() || s.visibility.repeated || s.visibility.culled == 0 ||
        s.visibility.culled < s.pairs_after_culling)
      return;
    case_.tally.count("all culled by stage 2");
    if (s.gjk + s.certificates + s.leaf_tests > 0) fault("searched though all is free", text(a));
  }
  bool startsInside() const {
    if (!world_.large.solid) return false;
    const auto links = world_.poses(way_.corners[0]);
    for (const auto& limb : world_.limbs) {
      if (limb->allowed) continue;
      const double winds = windingNumber(world_.large.mesh, world_.unitPose(*limb, links).translation());
      if (std::abs(winds) > 0.5) return true;
    }
    return false;
  }
  /// Two answers to the same question.
  void compare(const char* which, const CertifiedResult& a, const CertifiedResult& b) {
    const std::string words = std::string(which) + ": " + text(a) + ", " + text(b);
    if ((a.isFree() && b.status == Status::contact && b.certain) ||
        (b.isFree() && a.status == Status::contact && a.certain))
      return fault("verdicts", words);
    if (a.status != b.status) case_.tally.count("free or not certain");
    if (a.status != Status::contact || b.status != Status::contact) return;
    if ((b.certain && a.t_lower > b.t_upper + slack_) || (a.certain && b.t_lower > a.t_upper + slack_))
      fault("brackets", words);
  }
  /// Pair by pair, for limbs whose contact at the begin is not ignored.
  void compareEvery(const CertifiedResult& a, const CertifiedResult& b) {
    const KnownOf of_a = knownOf(a), of_b = knownOf(b);
    auto ignored = ignoredBy(a);
    for (const std::string& link : ignoredBy(b)) ignored.push_back(link);
    for (const auto& limb : world_.limbs) {
      const auto x = of_a.find(limb->name), y = of_b.find(limb->name);
      const Known in_a = x == of_a.end() ? Known() : x->second, in_b = y == of_b.end() ? Known() : y->second;
      if (in_a.contacts > 1) fault("pairs twice", std::to_string(in_a.contacts));
      if (std::count(ignored.begin(), ignored.end(), limb->name)) continue;
      const std::string words =
          campaign::format("%s: %d [%.9g, %.9g], %d [%.9g, %.9g]", limb->name.c_str(), in_a.contacts, in_a.lower,
                           in_a.upper, in_b.contacts, in_b.lower, in_b.upper);
      if (limb->allowed && (in_a.contacts || in_b.contacts)) fault("allowed pairs", words);
      if (inside_) continue;
      if ((in_a.certain && !in_b.contacts) || (in_b.certain && !in_a.contacts))
        fault("verdicts of pairs", words + " of " + text(a) + ", " + text(b));
      const double late = 2 * request_.tolerance_time + slack_;  // other pieces may touch earlier, within the tolerance
      if (in_a.contacts && in_b.certain && in_a.lower > in_b.upper + late) fault("brackets of pairs", words);
      if (in_b.contacts && in_a.certain && in_b.lower > in_a.upper + late) fault("brackets of pairs", words);
      if (in_a.contacts) case_.tally.count("pairs in contact");
    }
    bool deep = false;
    for (const auto& [link, known] : of_b) deep = deep || known.contacts > 20;
    case_.tally.count("deep", deep);  // more than 20 pieces touch the link
    namesPieces(a, b);
  }
  /// One limb and the body, as seen from the limb.
  void carried(const CertifiedResult& all) {
    const Limb& limb = *world_.limbs[static_cast<std::size_t>(random_.below(static_cast<int>(world_.limbs.size())))];
    const auto is = [&](const auto& other) { return other->name == limb.name; };
    if (limb.allowed || inside_ || request_.ignore_initial_contact) return;
    if (std::count_if(world_.limbs.begin(), world_.limbs.end(), is) > 1) return;
    CertifiedRequest request = request_;
    const CertifiedResult seen = askCarried(random_, world_, way_, limb, request);
    const KnownOf of_all = knownOf(all);
    const auto found = of_all.find(limb.name);
    const Known known = found == of_all.end() ? Known() : found->second;
    const std::string words = campaign::format("%s: %d [%.9g, %.9g], carried %s", limb.name.c_str(), known.contacts,
                                               known.lower, known.upper, text(seen).c_str());
    if (seen.status == Status::undecided) return fault("carried: undecided", words);
    case_.tally.count("carried");
    case_.tally.count("carried, free, left by stage 1", seen.isFree() && seen.statistics.pairs_after_culling > 0);
    case_.tally.count("carried, contact", seen.status == Status::contact);
    if ((seen.isFree() && known.certain) || (seen.certain && !known.contacts)) fault("carried: verdicts", words);
    const double late = 2 * request_.tolerance_time + slack_;
    const bool any = request.mode == ContactMode::any;
    if (seen.status == Status::contact && known.certain && !any && seen.t_lower > known.upper + late)
      fault("carried: brackets", words);
    if (seen.certain && known.contacts && known.lower > seen.t_upper + late) fault("carried: brackets", words);
  }
  /// The piece that a proven contact names touches by then.
  void namesPieces(const CertifiedResult& a, const CertifiedResult& b) {
    if (world_.large.kind == Large::cells || request_.ignore_initial_contact) return;
    for (const CertifiedContact& contact : a.contacts) {
      if (contact.body1.link >= 0 && contact.body2.link >= 0) continue;
      const bool first = contact.body1.link >= 0;
      const std::intptr_t piece = first ? contact.b2 : contact.b1;
      if (!contact.certain || piece < 0) continue;
      const auto* limb = first ? contact.body1.object : contact.body2.object;
      const auto* object = world_.pieces[static_cast<std::size_t>(piece)].get();
      bool found = false;
      for (const CertifiedContact& other : b.contacts) {
        const bool same = (other.body1.object == limb && other.body2.object == object) ||
                          (other.body2.object == limb && other.body1.object == object);
        found = found || (same && other.t_lower <= contact.t_upper + slack_);
      }
      case_.tally.count("pieces named");
      if (!found) fault("names of pieces", std::to_string(piece));
    }
  }
  /// A limb whose contact at the begin is ignored leaves the body for a sixteenth of the motion, and comes back.
  void watchedAgain(const CertifiedResult& a) {
    if (!way_.motion || way_.half_angles || world_.large.solid) return;
    const KnownOf of_a = knownOf(a);
    CertifiedRequest request = request_;
    request.mode = ContactMode::firstOfEveryPair;
    request.ignore_initial_contact = false;
    request.visibility = VisibilityMode::off;
    std::map<std::string, bool> apart;
    for (int k = 0; k < 16; ++k) {
      const VectorXd from = way_.at(k / 16.0, world_.joints), to = way_.at((k + 1) / 16.0, world_.joints);
      CertifiedResult part;
      world_.cut->continuousCollide(JointMotion::linear(*world_.tree, from, to), request, part);
      const KnownOf known = knownOf(part);
      for (const std::string& link : ignoredBy(a)) {
        const auto is = [&](const auto& limb) { return limb->name == link; };
        if (std::count_if(world_.limbs.begin(), world_.limbs.end(), is) > 1) continue;  // each by itself
        const auto found = known.find(link);
        if (found == known.end()) {
          apart[link] = true;
        } else if (found->second.certain && apart[link]) {
          case_.tally.count("watched again");
          const auto x = of_a.find(link);
          const double t = (k + found->second.upper) / 16;
          if (x == of_a.end() || x->second.lower > t + 2 * request_.tolerance_time + slack_)
            fault("watched again", campaign::format("contact at %.9g", t));
          return;
        }
      }
    }
  }
  /// FCL at poses of a motion that is free.
  void sample(const CertifiedResult& a) {
    const auto ignored = ignoredBy(a);
    constexpr int kPoses = 64;
    for (const auto& limb : world_.limbs) {
      if (limb->allowed || std::count(ignored.begin(), ignored.end(), limb->name)) continue;
      fcl::CollisionObjectd link(grown(*limb, std::max(0.0, limb->margin / world_.size - kShrink)));
      for (int k = 0; k <= kPoses; ++k) {
        const double t = double(k) / kPoses;
        link.setTransform(world_.unitPose(*limb, world_.poses(way_.at(t, world_.joints))));
        link.computeAABB();
        bool touches = false;
        const_cast<fcl::DynamicAABBTreeCollisionManagerd&>(world_.large.fcl).collide(&link, &touches, touch);
        case_.tally.count("poses tested");
        if (touches)
          return fault("FCL finds contact",
                       campaign::format("%s at %.9g, margin %g", limb->name.c_str(), t, limb->margin));
      }
    }
  }
  /// A ball or a capsule takes the margin as part of it. (FCL knows no margins: other shapes stay as they are.)
  static Geometry grown(const Limb& limb, double margin) {
    if (const auto* ball = dynamic_cast<const fcl::Sphered*>(limb.unit.get()))
      return std::make_shared<fcl::Sphered>(ball->radius + margin);
    if (const auto* capsule = dynamic_cast<const fcl::Capsuled*>(limb.unit.get()))
      return std::make_shared<fcl::Capsuled>(capsule->radius + margin, capsule->lz);
    return limb.unit;
  }
  static bool touch(fcl::CollisionObjectd* a, fcl::CollisionObjectd* b, void* touches) {
    fcl::CollisionRequestd request;
    request.gjk_solver_type = fcl::GST_INDEP;
    fcl::CollisionResultd result;
    return *static_cast<bool*>(touches) = fcl::collide(a, b, request, result) > 0;
  }

  campaign::Case& case_;
  Random random_;
  const World& world_;
  const Way& way_;
  CertifiedRequest request_;
  double slack_;  ///< of times, for what FCL's shapes round
  bool inside_ = false;
};

void wholeAndCut(campaign::Case& c) {
  Random random(c.id.seed);
  World w;
  const int which = random.below(6);
  w.size = which == 0 ? 1e-3 : which == 1 ? 100 : 1;
  w.measure.size = w.size;
  w.measure.away = Vector3d::Zero();
  if (random.oneIn(4)) {  // far from its own frame's origin
    for (int k = 0; k < 3; ++k) w.measure.away[k] = random.below(200) - 100;
  }
  if (!random.oneIn(4)) w.place = random.pose(w.size * random.logUniform(0.1, 1000));
  drawLarge(random, w.measure, w.large);
  drawRobot(random, w);
  CertifiedRequest request;
  request.mode = static_cast<ContactMode>(random.below(3));
  request.max_contacts = 1000000;
  request.check_self = random.oneIn(4);
  request.visibility = random.oneIn(2) ? VisibilityMode::on : VisibilityMode::off;
  request.ignore_initial_contact = random.oneIn(4);
  request.tolerance_distance = 1e-6 * std::min(1.0, w.size);
  if (random.oneIn(4)) request.margin = w.size * random.logUniform(1e-4, 0.1);
  if (random.oneIn(6)) request.added_margin = w.size * random.logUniform(1e-4, 0.05);
  setUp(random, request, w);
  for (int n = 0; n < 4; ++n) {
    const Way way = drawWay(random, w);
    Judge(c, w, way, request).look();
    request.mode = static_cast<ContactMode>((static_cast<int>(request.mode) + 1) % 3);
  }
}

}  // namespace

TEST(LargeBodies, AreTheirPieces) {
  campaign::Campaign bodies;
  bodies.look = wholeAndCut;
  const campaign::Options o = campaign::optionsOfTest("FCL_ARTIC_LARGE", 80);
  const campaign::Tally all = runWithoutFaults(bodies, o).total;
  EXPECT_GT(all.share("free"), 0.5);  // of four motions
  EXPECT_GT(all.share("later contact"), 0.3);
  EXPECT_GT(all.share("contact at once"), 0.1);
  EXPECT_GT(all["deep"], 0u);
  EXPECT_GT(all["inside a solid"], 0u);
  EXPECT_GT(all["initial contact ignored"], 0u);
  EXPECT_GT(all["free, left by stage 1"], 0u);
  EXPECT_GT(all["all culled by stage 2"], 0u);
  EXPECT_GT(all["carried, free, left by stage 1"], 0u);
  EXPECT_GT(all["carried, contact"], 0u);
}

/// A ball goes up to a slope: what stage 1 leaves of the slope is searched together, as one pair.
TEST(LargeBodies, AreSearchedOnceForEveryPair) {
  Random random(1);
  Large slope;
  slope.kind = Large::terrain;
  drawTriangles(random, 3000, slope);
  for (Vector3d& v : slope.mesh.vertices) v[2] = 0.1 * v[0] + 0.02 * std::sin(20 * v[0]) * std::sin(20 * v[1]);
  Cart cart(std::make_shared<fcl::Sphered>(0.05));
  cart.manager->registerObject(object(slope.mesh.surface()), "slope");
  cart.manager->setup();
  std::uint64_t work[2];
  CertifiedResult r[2];
  for (const int i : {0, 1}) {
    CertifiedRequest request;
    request.mode = i ? ContactMode::firstOfEveryPair : ContactMode::first;
    request.max_contacts = 100;
    r[i] = cart.run(-0.9, 0.9, request);
    ASSERT_TRUE(r[i].certain);
    ASSERT_EQ(r[i].contacts.size(), 1u);
    const QueryStatistics& s = r[i].statistics;
    work[i] = s.node_tests + s.leaf_tests + s.certificates + s.gjk;
  }
  EXPECT_NEAR(r[0].t_lower, r[1].t_lower, 1e-6);
  EXPECT_GT(r[0].t_lower, 0.1);
  EXPECT_LT(work[1], 2 * work[0]) << work[0];
}

/// Work in stage 1 counts: a budget ends a query that stage 1 alone would decide.
TEST(LargeBodies, BudgetEndsStageOne) {
  Random random(2);
  Large slope;
  slope.kind = Large::terrain;
  drawTriangles(random, 3000, slope);
  for (Vector3d& v : slope.mesh.vertices) v[2] = 0.1 * v[0];
  Cart cart(std::make_shared<fcl::Sphered>(0.05));
  cart.manager->registerObject(object(slope.mesh.surface()), "slope");
  cart.manager->setup();
  CertifiedRequest request;
  const CertifiedResult free = cart.run(-0.9, -0.8, request);
  ASSERT_TRUE(free.isFree());
  ASSERT_EQ(free.statistics.pairs_after_culling, 0u);
  ASSERT_GT(free.statistics.node_tests, 1u);
  request.work_budget = free.statistics.node_tests;
  EXPECT_TRUE(cart.run(-0.9, -0.8, request).isFree());
  request.work_budget = 1;
  const CertifiedResult ended = cart.run(-0.9, -0.8, request);
  EXPECT_EQ(ended.status, Status::undecided);
  EXPECT_EQ(ended.t_lower, 0);
  EXPECT_LT(ended.statistics.node_tests, free.statistics.node_tests);
}

}  // namespace large_bodies_test
