// SPDX-License-Identifier: BSD-3-Clause
#include "world.h"
#include "../campaign/harness.h"
#include "../support/allow_neighbours.h"

#include <algorithm>
#include <array>
#include <limits>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fcl/math/motion/interp_motion.h>
#include <fcl/math/motion/translation_motion.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

namespace modes {

using namespace fcl_artic;

namespace {

using Mesh = fcl::BVHModel<fcl::OBBRSSd>;

std::shared_ptr<Mesh> meshOf(const std::vector<Vector3d>& v, const std::vector<fcl::Triangle>& t) {
  auto mesh = std::make_shared<Mesh>();
  mesh->beginModel();
  mesh->addSubModel(v, t);
  mesh->endModel();
  return mesh;
}

/// A closed surface: a box with its corners moved about, each side a grid of n x n.
std::shared_ptr<Mesh> lump(Random& random, const Vector3d& half, int n) {
  std::vector<Vector3d> v;
  std::vector<fcl::Triangle> t;
  std::map<std::array<int, 3>, std::size_t> known;
  const double rough = random.chance(0.5) || random.snaps() ? 0 : 0.15;
  const auto vertex = [&](const std::array<int, 3>& at) {
    const auto found = known.find(at);
    if (found != known.end()) return found->second;
    Vector3d x;
    for (std::size_t k = 0; k < 3; ++k) x[static_cast<int>(k)] = half[static_cast<int>(k)] * (2.0 * at[k] / n - 1);
    v.push_back(x + rough * half.minCoeff() * random.vector(1));
    return known[at] = v.size() - 1;
  };
  for (std::size_t side = 0; side < 6; ++side) {
    const std::size_t x = side / 2, y = (x + 1) % 3, z = (x + 2) % 3;
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) {
        std::size_t corner[4];
        for (int c = 0; c < 4; ++c) {
          std::array<int, 3> at;
          at[x] = side % 2 ? n : 0;
          at[y] = i + (c == 1 || c == 2);
          at[z] = j + (c >= 2);
          corner[c] = vertex(at);
        }
        t.emplace_back(corner[0], corner[1], corner[2]);
        t.emplace_back(corner[0], corner[2], corner[3]);
      }
    }
  }
  return meshOf(v, t);
}

/// A few triangles that hang together by nothing.
std::shared_ptr<Mesh> flakes(Random& random, double size) {
  std::vector<Vector3d> v;
  std::vector<fcl::Triangle> t;
  const int n = 1 + random.below(8);
  while (static_cast<int>(t.size()) < n) {
    const Vector3d middle = random.vector(size);
    const Vector3d a = random.vector(0.5 * size), b = random.vector(0.5 * size), c = random.vector(0.5 * size);
    if ((b - a).cross(c - a).norm() < 0.02 * size * size) continue;  // of these FCL says anything
    for (const Vector3d& corner : {a, b, c}) v.push_back(middle + corner);
    t.emplace_back(v.size() - 3, v.size() - 2, v.size() - 1);
  }
  return meshOf(v, t);
}

}  // namespace

Vector3d Random::vector(double size) {
  return {length(-size, size), length(-size, size), length(-size, size)};
}

Isometry3d Random::pose(double size) {
  Isometry3d M = Isometry3d::Identity();
  if (grid_ == 0) {
    Eigen::Vector4d q;
    do q = {in(-1, 1), in(-1, 1), in(-1, 1), in(-1, 1)};
    while (q.norm() > 1 || q.norm() < 0.1);
    M.linear() = Eigen::Quaterniond(q.normalized()).toRotationMatrix();
  }
  M.translation() = vector(size);
  return M;
}

Shape randomShape(Random& random, double size) {
  const double a = size * random.in(0.2, 1), b = size * random.in(0.2, 1), c = size * random.in(0.2, 1),
               e = 2 * kAround;
  switch (random.below(7)) {
    case 0:
      return {std::make_shared<fcl::Sphered>(a), std::make_shared<fcl::Sphered>(a - kAround)};
    case 1:
      return {std::make_shared<fcl::Boxd>(2 * a, 2 * b, 2 * c),
              std::make_shared<fcl::Boxd>(2 * a - e, 2 * b - e, 2 * c - e)};
    case 2:
      return {std::make_shared<fcl::Capsuled>(0.5 * a, b), std::make_shared<fcl::Capsuled>(0.5 * a - kAround, b)};
    case 3:
      return {std::make_shared<fcl::Cylinderd>(0.5 * a, b), std::make_shared<fcl::Cylinderd>(0.5 * a - kAround, b - e)};
    case 4: {
      const auto mesh = flakes(random, size);
      return {mesh, mesh};
    }
    default: {  // of a surface nothing is smaller
      const auto mesh = lump(random, {a, b, c}, 1 + random.below(4));
      return {mesh, mesh};
    }
  }
}

namespace {

/// A motion of FCL's.
std::shared_ptr<fcl::MotionBased> randomMotion(Random& random, const Isometry3d& from, const Isometry3d& to) {
  if (random.chance(0.5)) {
    Isometry3d end = from;
    end.translation() = to.translation();
    return std::make_shared<fcl::TranslationMotiond>(from, end);
  }
  return std::make_shared<fcl::InterpMotion<double>>(from.linear(), from.translation(), to.linear(), to.translation(),
                                                     random.vector(0.2));
}

}  // namespace

World::World(Random& random) {
  random.snap(random.chance(0.2) ? 0.1 : 0);
  if (random.chance(0.25)) {
    addPair(random);
  } else {
    addRobot(random);
    addObstacles(random);
    choosePairs(random);
    chooseMotion(random);
  }
  random.snap(0);
}

void World::addPair(Random& random) {
  for (const char* name : {"a", "b"}) {
    Body body;
    body.kind = Body::Kind::moving;
    body.name = name;
    body.shape = randomShape(random, 0.4);
    body.moving_object = std::make_shared<fcl::ContinuousCollisionObjectd>(
        body.shape.exact, randomMotion(random, random.pose(0.5), random.pose(0.5)));
    bodies_.push_back(body);
  }
  pairs_.push_back({0, 1, true, -1, pairOf("a", "b")});
}

void World::addRobot(Random& random) {
  tree_ = std::make_shared<KinematicTree>("robot");
  const int links = 1 + random.below(4);
  tree_->addLink("l0");
  for (int i = 1; i <= links; ++i) {
    Joint joint;
    joint.name = "j" + std::to_string(i);
    joint.child = "l" + std::to_string(i);
    joint.parent = "l" + std::to_string(random.chance(0.8) ? i - 1 : random.below(i));
    joint.type = random.chance(random.snaps() ? 0.2 : 0.7) ? JointType::revolute : JointType::prismatic;
    joint.axis = random.snaps() ? Vector3d(Vector3d::Unit(random.below(3))) : random.vector(1) + Vector3d(0, 0, 1.2);
    joint.origin = random.pose(0.5);
    joint.lower = -10;
    joint.upper = 10;
    tree_->addLink(joint.child);
    tree_->addJoint(joint);
  }
  manager_ = std::make_unique<ArticulatedCollisionManager>(tree_);
  for (int i = 0; i <= links; ++i) {
    Body body;
    body.name = "l" + std::to_string(i);
    body.link = i;
    body.shape = randomShape(random, 0.3);
    body.offset = random.pose(0.2);
    body.object = std::make_shared<fcl::CollisionObjectd>(body.shape.exact);
    manager_->bind(body.link, body.object.get(), body.offset);
    bodies_.push_back(body);
  }
}

void World::addObstacles(Random& random) {
  const int still = random.below(5), moving = random.chance(0.4) ? 1 + random.below(2) : 0;
  for (int i = 0; i < still + moving; ++i) {
    Body body;
    body.name = "o" + std::to_string(i);
    body.shape = randomShape(random, 0.4);
    body.offset = random.pose(1);
    body.kind = i < still ? Body::Kind::still : Body::Kind::moving;
    if (i < still) {
      body.object = std::make_shared<fcl::CollisionObjectd>(body.shape.exact, body.offset);
      manager_->registerObject(body.object.get(), body.name);
      if (i == 0 && random.chance(0.25)) {
        body.kind = Body::Kind::attached;
        body.link = tree_->numLinks() - 1;
        body.offset = random.pose(0.4);
        manager_->attach(body.link, body.object.get(), body.offset);
      }
    } else {
      body.moving_object = std::make_shared<fcl::ContinuousCollisionObjectd>(
          body.shape.exact, randomMotion(random, body.offset, random.pose(1)));
      manager_->registerObject(body.moving_object.get(), body.name);
    }
    bodies_.push_back(body);
  }
}

/// Which pairs are checked, as manager.h says it: every link has geometry here, and every joint moves.
void World::choosePairs(Random& random) {
  const auto carried = [](const Body& body) {
    return body.kind == Body::Kind::link || body.kind == Body::Kind::attached;
  };
  const auto isStill = [](const Body& body) { return body.kind == Body::Kind::still || body.link == 0; };  // l0: a root
  const bool own = random.chance(0.4);
  AllowedCollisionMatrix allowed;
  if (own) {
    for (Body& body : bodies_) {
      if (!random.chance(0.3)) continue;
      body.margin = random.chance(0.3) ? 0 : random.in(0, 0.1);
      manager_->setMargin(body.name, body.margin);
    }
  }
  const double allow = random.chance(0.3) ? 0.6 : 0.15;
  for (std::size_t j = 0; j < bodies_.size(); ++j) {
    for (std::size_t i = 0; i < j; ++i) {
      const Body &a = bodies_[i], &b = bodies_[j];
      if (!carried(a) && !carried(b)) continue;
      if (isStill(a) && isStill(b)) continue;
      if (carried(a) && carried(b)) {
        if (a.link == b.link) continue;
        const bool links = a.kind == Body::Kind::link && b.kind == Body::Kind::link;
        if (links && (tree_->parentLink(a.link) == b.link || tree_->parentLink(b.link) == a.link)) continue;
      }
      if (random.chance(allow)) {
        allowed.allow(a.name, b.name);
        continue;
      }
      double margin = std::max(a.margin, b.margin);
      if (own && random.chance(0.2)) {
        margin = random.chance(0.4) ? 0 : random.in(0, 0.1);
        manager_->setMargin(a.name, b.name, margin);
      }
      pairs_.push_back({i, j, !(carried(a) && carried(b)), margin, pairOf(a.name, b.name)});
    }
  }
  manager_->setAllowedCollisions(allowed);
  fcl_artic::test::setUpWithoutNeighbours(*manager_);
}

void World::chooseMotion(Random& random) {
  const int n = static_cast<int>(tree_->dof());
  const double far = random.chance(0.5) ? 2 : 0.3;
  const auto configuration = [&] {
    VectorXd q(n);
    for (int i = 0; i < n; ++i) q[i] = random.length(-far, far);
    return q;
  };
  const int kind = random.below(10);
  if (kind < 6) {
    motion_ = std::make_unique<JointMotion>(JointMotion::linear(*tree_, configuration(), configuration()));
  } else if (kind < 8) {  // there and back, or nearly
    Eigen::MatrixXd x(n, 3);
    x.col(0) = configuration();
    x.col(1) = 2 * configuration();
    x.col(2) = -x.col(1) * random.in(0.5, 1.5);
    motion_ = std::make_unique<JointMotion>(JointMotion::polynomial(*tree_, x));
  } else {
    std::vector<double> times{random.chance(0.5) ? 0 : random.in(-5, 5)};
    std::vector<VectorXd> q{configuration()};
    const int pieces = 1 + random.below(3);
    for (int k = 0; k < pieces; ++k) {
      times.push_back(times.back() + random.in(0.2, 3));
      q.push_back(random.chance(0.2) ? q.back() : configuration());
    }
    trajectory_ = std::make_unique<JointTrajectory>(JointTrajectory::linear(*tree_, times, q));
  }
}

std::vector<Isometry3d> World::poses(double t) const {
  std::vector<Isometry3d> links, poses;
  if (tree_) tree_->forwardKinematics(trajectory_ ? trajectory_->configuration(t) : motion_->configuration(t), links);
  const double part = (t - begin()) / (end() - begin());
  for (const Body& body : bodies_) {
    if (body.kind == Body::Kind::still) {
      poses.push_back(body.offset);
    } else if (body.kind == Body::Kind::moving) {
      const fcl::MotionBased& motion = *body.moving_object->getMotion();
      motion.integrate(part);
      Isometry3d M;
      motion.getCurrentTransform(M);
      poses.push_back(M);
    } else {
      poses.push_back(links[static_cast<std::size_t>(body.link)] * body.offset);
    }
  }
  return poses;
}

double World::distance(const Watched& pair, const std::vector<Isometry3d>& poses) const {
  fcl::CollisionRequestd collision;
  fcl::CollisionResultd hit;
  const auto &a = bodies_[pair.a].shape.exact, &b = bodies_[pair.b].shape.exact;
  if (fcl::collide(a.get(), poses[pair.a], b.get(), poses[pair.b], collision, hit) > 0) return 0;
  // FCL's search ends too early now and then, centimetres too far: not in the other order, or a nanometre away.
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 8; ++i) {
    Isometry3d other = poses[pair.b];
    const int shifts = i / 2;
    other.translation() += shifts * 1e-9 * Vector3d(1, -2, 3);
    fcl::DistanceRequestd request;
    fcl::DistanceResultd result;
    const double found = i % 2 ? fcl::distance(b.get(), other, a.get(), poses[pair.a], request, result)
                               : fcl::distance(a.get(), poses[pair.a], b.get(), other, request, result);
    least = std::min(least, std::max(0.0, found));
  }
  return least;
}

bool World::touches(const Watched& pair, const std::vector<Isometry3d>& poses, double margin) const {
  fcl::CollisionRequestd collision;
  fcl::CollisionResultd hit;
  const Shape &a = bodies_[pair.a].shape, &b = bodies_[pair.b].shape;
  if (fcl::collide(a.smaller.get(), poses[pair.a], b.smaller.get(), poses[pair.b], collision, hit) > 0) return true;
  if (margin <= kAround) return false;
  fcl::DistanceRequestd request;
  fcl::DistanceResultd result;
  return fcl::distance(a.exact.get(), poses[pair.a], b.exact.get(), poses[pair.b], request, result) < margin - kAround;
}

void World::ask(const CertifiedRequest& request, CertifiedResult& result) const {
  if (!tree_) {
    CertifiedPairResult pair;
    continuousCollide(bodies_[0].shape.exact.get(), bodies_[0].moving_object->getMotion(), bodies_[1].shape.exact.get(),
                      bodies_[1].moving_object->getMotion(), request, pair);
    result.status = pair.status;
    result.t_lower = pair.t_lower;
    result.t_upper = pair.t_upper;
    result.certain = pair.certain;
    result.contacts = pair.contacts;
    result.certificate = pair.certificate;
    for (CertifiedContact& contact : result.contacts) {
      contact.body1.name = "a";
      contact.body2.name = "b";
    }
    result.ignored_initial_contacts.clear();
    if (pair.ignored_initial_contact) {
      result.ignored_initial_contacts.emplace_back();
      result.ignored_initial_contacts[0].first.name = "a";
      result.ignored_initial_contacts[0].second.name = "b";
    }
  } else if (trajectory_) {
    manager_->continuousCollide(*trajectory_, request, result);
  } else {
    manager_->continuousCollide(*motion_, request, result);
  }
}

std::string World::writeQuery(const CertifiedRequest& request) const {
  if (!tree_) throw std::invalid_argument(campaign::kTwoBodies);
  return trajectory_ ? manager_->writeQuery(*trajectory_, request) : manager_->writeQuery(*motion_, request);
}

}  // namespace modes
