// SPDX-License-Identifier: BSD-3-Clause
//
// Random pairs of links with levers of every kind between them. There are turns that carry slides, slides that carry
// turns, followers by whole, broken and large multiples, and several followers of one master. There are joints on both
// sides of a common ancestor, wide and narrow limits and none, and one to three variables, the third one mostly of
// little effect.
#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fcl/narrowphase/collision_object.h>

#include "fcl_artic/kinematic_tree.h"
#include "pairs/random.h"

namespace tables {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// A link of each pair is "a", the other one "b".
struct RandomLinks {
  std::shared_ptr<fcl_artic::KinematicTree> tree = std::make_shared<fcl_artic::KinematicTree>("links");
  std::shared_ptr<fcl::CollisionObjectd> a, b;
  Isometry3d on_a = Isometry3d::Identity(), on_b;
  double margin = 0;  ///< that the two have to keep

  explicit RandomLinks(pairs::Random& random) {
    if (random.chance(0.25)) {
      buildTight(random);
    } else {
      buildAny(random);
    }
    if (random.chance(0.15)) margin = random.logUniform(1e-4, 0.05);
  }

  /// Values at random: within the limits, or up to as far again beyond them, or some turns.
  VectorXd draw(pairs::Random& random) const {
    VectorXd q(tree->dof());
    for (int v = 0; v < tree->dof(); ++v) {
      const fcl_artic::Joint& joint = tree->joint(tree->variableJoint(v));
      const bool limits = hasLimits(joint);
      const double lower = limits ? joint.lower : -7, upper = limits ? joint.upper : 7;
      const double beyond = limits && random.chance(0.5) ? upper - lower : 0;
      q[v] = random.uniform(lower - beyond, upper + beyond);
    }
    return q;
  }

 private:
  struct Step {
    int variable;
    bool own;  ///< its joint is the variable's
    bool slides;
  };

  /// A ball on a slide, and that on a turn, over a plate, along which a cart takes it all. Where the slide is far out
  /// the turn takes the ball at the plate. Rows of cells are so wide that all of this way has to be paid for. Or the
  /// turn follows the slide.
  void buildTight(pairs::Random& random) {
    using fcl_artic::JointType;
    const auto joint = [&](const char* name, JointType type, const std::string& parent, const std::string& child,
                           const Vector3d& axis) {
      fcl_artic::Joint j;
      j.name = name;
      j.type = type;
      j.parent = parent;
      j.child = child;
      j.axis = random.chance(0.7) ? axis : Vector3d(axis + random.vector(0, 0.2));
      return j;
    };
    const auto range = [](fcl_artic::Joint j, double lower, double size) {
      j.lower = lower;
      j.upper = lower + size;
      return j;
    };
    const bool spins = random.chance(0.4);  // the turn follows the slide
    const double slide = random.logUniform(0.004, spins ? 0.03 : 0.0598);
    const double out = random.chance(0.5) ? 0.5 : random.uniform(0, 1);  // part of the slide's range below 0
    const double half = random.uniform(0.2, 1.2);  // of a row, rad; spinning: of the slide's range
    const double limit = random.uniform(30, 99), multiplier = spins ? 2 * half / slide : 192 * half / limit;
    const double size = std::max(out, 1 - out) * slide,
                 paid = 0.5 * slide * (spins ? 1 + multiplier * size : 1) + half * size;
    for (const char* link : {"a", "b", "cart", "cross", "arm", "driver"}) tree->addLink(link);
    fcl_artic::Joint rail = range(joint("rail", JointType::prismatic, "a", "cart", Vector3d::UnitY()), -20, 40);
    fcl_artic::Joint cross =
        range(joint("cross", spins ? JointType::prismatic : JointType::fixed, "cart", "cross", Vector3d::UnitX()),
              -0.05, 0.1);
    cross.origin = Eigen::Translation3d(0, 0, paid * random.uniform(0.8, 1.6) + 0.001) * Isometry3d::Identity();
    fcl_artic::Joint turn = joint("turn", JointType::revolute, "cross", "arm", Vector3d::UnitY());
    fcl_artic::Joint finger =
        range(joint("finger", JointType::prismatic, "arm", "b", Vector3d::UnitX()), -out * slide, slide);
    turn.mimics = true;
    turn.mimic = {spins ? "finger" : "drive", random.chance(0.5) ? multiplier : -multiplier, random.uniform(-3, 3)};
    tree->addJoint(rail);
    tree->addJoint(cross);
    tree->addJoint(finger);
    if (!spins)
      tree->addJoint(range(joint("drive", JointType::revolute, "a", "driver", Vector3d::UnitZ()), -limit, 2 * limit));
    if (spins) tree->addJoint(joint("driver", JointType::fixed, "a", "driver", Vector3d::UnitZ()));
    tree->addJoint(turn);
    a = std::make_shared<fcl::CollisionObjectd>(std::make_shared<fcl::Boxd>(60, 60, 0.1));
    b = std::make_shared<fcl::CollisionObjectd>(std::make_shared<fcl::Sphered>(random.logUniform(1e-4, 2e-3)));
    on_a.translation().z() = -0.05;
    on_b = Isometry3d::Identity();
  }

  void buildAny(pairs::Random& random) {
    bare_ = random.chance(0.5);
    const int variables = random.chance(0.1) ? 1 : random.chance(0.4) ? 2 : 3;
    const int small = variables == 3 ? random.below(3) : -1;
    std::vector<Step> steps;
    for (int v = 0; v < variables; ++v) steps.push_back({v, true, random.chance(0.4)});
    if (small >= 0) steps[static_cast<std::size_t>(small)].slides = random.chance(0.85);
    const int more = (variables == 1 ? 1 : 0) + (random.chance(0.6) ? 0 : 1 + random.below(2));
    for (int i = 0; i < more; ++i) steps.push_back({random.below(variables), false, random.chance(0.4)});
    for (std::size_t i = steps.size(); i-- > 1;) {
      std::swap(steps[i], steps[static_cast<std::size_t>(random.below(static_cast<int>(i) + 1))]);
    }
    const std::size_t up =
        random.chance(0.3) ? static_cast<std::size_t>(random.below(static_cast<int>(steps.size()))) : 0;

    for (const char* link : {"base", "a", "b"}) tree->addLink(link);
    // A variable's joint is on the way, or beside it and followed from there.
    std::vector<bool> beside;
    for (int v = 0; v < variables; ++v) {
      const bool follows = random.chance(0.5);
      beside.push_back(follows);
      const auto own =
          std::find_if(steps.begin(), steps.end(), [&](const Step& s) { return s.variable == v && s.own; });
      own->own = !follows;
      fcl_artic::Joint joint = range(random, own->slides, v == small, follows);
      joint.name = "variable" + std::to_string(v);
      if (follows) {
        joint.parent = "base";
        joint.child = "driver" + std::to_string(v);
        tree->addLink(joint.child);
        tree->addJoint(joint);
      }
      joints_.push_back(joint);
    }
    std::vector<fcl_artic::Joint> followers;
    const auto build = [&](std::size_t begin, std::size_t end, const std::string& last) {
      std::string parent = "base";
      for (std::size_t i = begin; i <= end; ++i) {
        fcl_artic::Joint joint;
        joint.type = fcl_artic::JointType::fixed;
        if (i < end) joint = make(random, steps[i], i, steps[i].variable == small, followers);
        joint.name = i < end ? joint.name : "to " + last;
        joint.origin = pose(random, (i == begin && random.chance(0.5)) || (bare_ && i > begin) ? 0 : 0.3);
        joint.parent = parent;
        joint.child = parent = i < end ? "link" + std::to_string(i) : last;
        if (i < end) tree->addLink(joint.child);
        (joint.mimics ? followers : joints_).push_back(joint);
        if (!joint.mimics) tree->addJoint(joint);
      }
    };
    build(0, up, "a");
    build(up, steps.size(), "b");
    for (const fcl_artic::Joint& joint : followers) tree->addJoint(joint);

    b = object(random, random.logUniform(0.0005, bare_ ? 0.005 : 0.15));
    on_b = pose(random, bare_ || random.chance(0.5) ? 0 : 0.2);
    const VectorXd q = draw(random);
    const Isometry3d at = tree->linkPose(tree->linkId("a"), q).inverse() * tree->linkPose(tree->linkId("b"), q) * on_b;
    // A body with a face reaches with it to about where the other link's middle gets.
    const double x = random.logUniform(0.1, bare_ ? 30 : 3), y = random.logUniform(0.1, bare_ ? 30 : 3),
                 z = random.logUniform(0.005, 0.3);
    const int shape = bare_ && random.chance(0.8) ? 1 : random.below(3);
    on_a.linear() = bare_ && random.chance(0.5) ? square(random) : random.rotation();
    if (shape == 0) a = object(random, random.logUniform(0.05, 0.6));
    if (shape == 1) a = std::make_shared<fcl::CollisionObjectd>(std::make_shared<fcl::Boxd>(x, y, z));
    if (shape == 2) a = std::make_shared<fcl::CollisionObjectd>(std::make_shared<fcl::Cylinderd>(x, z));
    const double off = 0.5 * z - random.logUniform(0.001, 0.1) + random.logUniform(0.001, 0.1);
    on_a.translation() = at.translation() - on_a.linear() * Vector3d(0, 0, off);
  }

  Isometry3d pose(pairs::Random& random, double most) const {
    Isometry3d M = Isometry3d::Identity();
    if (most > 0) M.translation() = random.vector(0, most);
    if (random.chance(bare_ ? 0.2 : 0.7)) M.linear() = random.rotation();
    return M;
  }
  static Eigen::Matrix3d square(pairs::Random& random) {
    const int k = random.below(3);
    return Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), Vector3d::Unit(k)).toRotationMatrix();
  }
  Vector3d axis(pairs::Random& random) const {
    return random.chance(bare_ ? 0.8 : 0.4) ? Vector3d(Vector3d::Unit(random.below(3))) : random.direction();
  }

  fcl_artic::Joint range(pairs::Random& random, bool slides, bool small, bool follows) const {
    using fcl_artic::JointType;
    fcl_artic::Joint joint;
    joint.type = slides ? JointType::prismatic : JointType::revolute;
    joint.axis = axis(random);
    double size = small    ? random.logUniform(0.001, 0.059)
                  : slides ? random.logUniform(0.03, bare_ ? 40 : 2)
                           : random.uniform(0.5, 8);
    if (!small && !slides && follows && random.chance(0.4)) size = random.logUniform(8, 190);
    joint.lower = size * random.uniform(-1, 0) * (random.chance(0.3) ? 2 : 1);
    if (random.chance(0.4)) joint.lower = -0.5 * size;
    joint.upper = joint.lower + size;
    if (std::max(std::abs(joint.lower), std::abs(joint.upper)) > 99) joint.lower = -99, joint.upper = 99;
    if (!slides && !small && random.chance(0.3)) joint.type = JointType::continuous;
    return joint;
  }

  fcl_artic::Joint make(pairs::Random& random, const Step& step, std::size_t number, bool small,
                        const std::vector<fcl_artic::Joint>&) const {
    using fcl_artic::JointType;
    const fcl_artic::Joint& master = joints_[static_cast<std::size_t>(step.variable)];
    if (step.own) return master;
    fcl_artic::Joint joint;
    joint.name = "follower" + std::to_string(number);
    joint.type = step.slides ? JointType::prismatic : JointType::revolute;
    joint.axis = axis(random);
    joint.mimics = true;
    double multiplier = random.uniform(0.2, 2);
    if (random.chance(0.3)) multiplier = 1 + random.below(3);
    if (random.chance(small ? 0.4 : 0.15)) multiplier = random.logUniform(2, 99);
    if (step.slides) {  // along a way of no more than a metre or two
      const double most = hasLimits(master) ? std::max(std::abs(master.lower), std::abs(master.upper)) : 3;
      if (!small) multiplier = std::min(multiplier, random.logUniform(0.05, 2) / most);
      if (small) multiplier = std::min(multiplier, 0.06 / most);
    }
    joint.mimic = {master.name, random.chance(0.5) ? multiplier : -multiplier,
                   random.chance(0.5) ? 0 : random.uniform(-0.5, 0.5) * (step.slides ? 0.3 : 6)};
    return joint;
  }

  static std::shared_ptr<fcl::CollisionObjectd> object(pairs::Random& random, double size) {
    std::shared_ptr<fcl::CollisionGeometryd> geometry;
    const auto side = [&] { return size * random.uniform(0.1, 1); };
    switch (random.below(5)) {
      case 0:
        geometry = std::make_shared<fcl::Sphered>(side());
        break;
      case 1:
        geometry = std::make_shared<fcl::Capsuled>(0.3 * side(), side());
        break;
      case 2:
        geometry = std::make_shared<fcl::Cylinderd>(side(), 0.3 * side());
        break;
      case 3: {
        const double x = side(), y = side(), z = side();
        geometry = std::make_shared<fcl::Boxd>(x, y, z);
        break;
      }
      default: {
        const auto mesh = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
        std::vector<Vector3d> vertices;
        for (const Vector3d& v : {Vector3d(1, 1, 1), Vector3d(1, -1, -1), Vector3d(-1, 1, -1), Vector3d(-1, -1, 1)}) {
          const double x = side(), y = side(), z = side();
          vertices.push_back(v.cwiseProduct(Vector3d(x, y, z)));
        }
        mesh->beginModel();
        mesh->addSubModel(vertices, {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}});
        mesh->endModel();
        geometry = mesh;
      }
    }
    return std::make_shared<fcl::CollisionObjectd>(geometry);
  }

  /// Nothing but joints between the links, one right after the other, most of them square, a small b and a plate: the
  /// ways that are paid for are gone.
  bool bare_ = false;
  std::vector<fcl_artic::Joint> joints_;  ///< of the variables first
};

}  // namespace tables
