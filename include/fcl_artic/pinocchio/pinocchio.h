// SPDX-License-Identifier: BSD-3-Clause
//
// Component `pinocchio`, header-only: a pinocchio::Model and its pinocchio::GeometryModel as a manager that certifies
// motions.
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <pinocchio/fwd.hpp>  // before boost's variant

#include <pinocchio/multibody/geometry.hpp>
#include <pinocchio/multibody/joint/joint-collection.hpp>
#include <pinocchio/multibody/model.hpp>

#include "fcl_artic/manager.h"
#include "fcl_artic/pinocchio/coal_geometry.h"

namespace fcl_artic {

namespace detail {
class PinocchioReader;
}

/// A pinocchio model with its geometry, as fromPinocchio() makes it: a tree, a manager that is set up, and the way from
/// pinocchio's configurations to the tree's and back.
///
/// A configuration of this library holds, joint by joint in pinocchio's order:
///
/// | pinocchio's joint | its part of q | variables here |
/// | --- | --- | --- |
/// | revolute (RX, RY, RZ, unaligned) | angle | angle, rad |
/// | revolute unbounded (RUBX, RUBY, RUBZ, unaligned) | cos, sin | angle in (-π, π], rad |
/// | prismatic (PX, PY, PZ, unaligned) | length | length, m |
/// | spherical | quaternion x, y, z, w | the same |
/// | free flyer | x, y, z and quaternion x, y, z, w | the same, m |
/// | planar | x, y, cos, sin | x, y (m), angle (rad) |
/// | translation | x, y, z | three prismatic joints, m |
/// | spherical ZYX, universal | angles | as many revolute joints, rad |
/// | composite | those of its joints | those of its joints |
/// | mimic | nothing | nothing: it follows its joint |
///
/// Only vectors with unbounded or planar joints differ from pinocchio's.
class PinocchioRobot {
 public:
  /// The links: "universe", one link for each joint's frame, and one for each geometry that a joint carries, with the
  /// geometry's name. (A geometry that is checked against one on a neighbouring joint is an attached object instead.)
  std::shared_ptr<const KinematicTree> tree;
  /// The manager, set up. Geometries that the universe carries are its obstacles.
  std::shared_ptr<ArticulatedCollisionManager> manager;

  /// Returns a configuration of pinocchio's as one of the tree's: dof() values, rad or m.
  /// @param q  model.nq values. Pairs of cosine and sine count by their direction only.
  /// @throws std::invalid_argument for another number of values, and, naming the joint, for a pair of cosine and sine
  ///   whose length is not 1 within 1e-3, as KinematicTree::requireConfiguration() has it for quaternions.
  Eigen::VectorXd configuration(const Eigen::VectorXd& q) const {
    if (q.size() != nq_) {
      throw std::invalid_argument("q has " + std::to_string(q.size()) +
                                  " entries, pinocchio's model has nq = " + std::to_string(nq_));
    }
    Eigen::VectorXd out(tree->dof());
    for (const Block& block : blocks_) {
      const auto copied = block.kind == Block::values ? block.size : block.kind == Block::plane ? 2 : 0;
      out.segment(block.here, copied) = q.segment(block.there, copied);
      if (block.kind == Block::values) continue;
      const double c = q[block.there + copied], s = q[block.there + copied + 1];
      if (!(std::abs(std::hypot(c, s) - 1) <= 1e-3)) {
        throw std::invalid_argument("joint '" + block.joint + "': the length of its cosine and sine is not 1");
      }
      out[block.here + copied] = std::atan2(s, c);
    }
    return out;
  }

  /// Returns a configuration of the tree's as one of pinocchio's: model.nq values.
  /// @param q  dof() values, rad or m.
  /// @throws std::invalid_argument as KinematicTree::requireConfiguration().
  Eigen::VectorXd toPinocchio(const Eigen::VectorXd& q) const {
    tree->requireConfiguration(q, "q");
    Eigen::VectorXd out(nq_);
    for (const Block& block : blocks_) {
      const auto copied = block.kind == Block::values ? block.size : block.kind == Block::plane ? 2 : 0;
      out.segment(block.there, copied) = q.segment(block.here, copied);
      if (block.kind == Block::values) continue;
      out[block.there + copied] = std::cos(q[block.here + copied]);
      out[block.there + copied + 1] = std::sin(q[block.here + copied]);
    }
    return out;
  }

  /// Returns the motion between two of pinocchio's configurations: every variable goes straight, unbounded joints and
  /// the angles of planar ones the shorter way round, quaternions by the shortest rotation (JointMotion::shortest()).
  ///
  /// That is the way of pinocchio::interpolate(), except for free flyers and planar joints, which pinocchio moves along
  /// a screw: here their origin goes straight. It differs too for an unbounded joint within 1e-6 rad of half a turn,
  /// where pinocchio stays at q0; here it turns.
  /// @param q0, q1  model.nq values each.
  /// @throws std::invalid_argument as configuration() and JointMotion::shortest().
  JointMotion motion(const Eigen::VectorXd& q0, const Eigen::VectorXd& q1) const {
    return JointMotion::shortest(*tree, configuration(q0), configuration(q1));
  }

  /// The link that stands for a joint's frame.
  /// @param joint  index in pinocchio's model; 0: the universe.
  /// @throws std::out_of_range for an index that is not there.
  LinkId link(std::size_t joint) const { return links_.at(joint); }

  /// Names of the links and attached objects that are the geometries of a joint, in pinocchio's order: whom an object
  /// that the joint's link carries may touch (ArticulatedCollisionManager::attach()).
  /// @param joint  index in pinocchio's model; 0: the universe.
  /// @throws std::out_of_range for an index that is not there.
  const std::vector<std::string>& geometries(std::size_t joint) const { return geometries_.at(joint); }

 private:
  friend class detail::PinocchioReader;
  struct Block {
    enum Kind { values, turn, plane } kind;  ///< as they are; cosine and sine; x, y, cosine and sine
    int there, here;                         ///< first entry of pinocchio's q and of ours
    int size;                                ///< number of entries, of `values`
    std::string joint;
  };
  std::vector<Block> blocks_;
  std::vector<LinkId> links_;
  std::vector<std::vector<std::string>> geometries_;
  Eigen::Index nq_ = 0;
};

/// Options of fromPinocchio().
struct PinocchioOptions {
  /// Takes bodies that coal sweeps with a ball, other than spheres and capsules, whose radius has it: with a margin of
  /// the radius. It replaces CertifiedRequest::margin for all pairs of such a body, so that more room than the radius
  /// is CertifiedRequest::added_margin. A larger margin of another body's, one of a pair and resetMargins() replace it
  /// in turn. clearance() is that of the bodies without it. False: such a body is refused, so that nobody's margin is
  /// replaced without notice.
  bool swept_radius_as_margin = false;
};

/// @cond
namespace detail {

/// Reads a pinocchio model: see fromPinocchio().
class PinocchioReader {
 public:
  /// Reads the joints.
  PinocchioReader(const pinocchio::Model& model, const pinocchio::GeometryModel& geometries,
                  const PinocchioOptions& options)
      : model_(model), geometries_(geometries), options_(options) {
    for (const pinocchio::GeometryObject& object : geometries.geometryObjects) {
      if (!names_.insert(object.name).second) {
        throw std::invalid_argument("fromPinocchio: two geometries are named '" + object.name + "'");
      }
    }
    tree_ = std::make_shared<KinematicTree>(model.name.empty() ? "robot" : model.name);
    robot_.links_ = {tree_->addLink(unused(model.names[0]))};
    robot_.nq_ = model.nq;
    for (std::size_t j = 1; j < model.joints.size(); ++j) addJoint(j);
  }

  /// Adds the geometries and sets the manager up.
  PinocchioRobot read() {
    robot_.geometries_.resize(robot_.links_.size());
    const std::size_t n = geometries_.geometryObjects.size();
    std::vector<std::set<std::size_t>> checked(n);
    std::vector<bool> attached(n);
    for (const pinocchio::CollisionPair& pair : geometries_.collisionPairs) readPair(pair, checked, attached);
    for (std::size_t g = 0; g < n; ++g) {
      const pinocchio::GeometryObject& object = geometries_.geometryObjects[g];
      if (object.parentJoint >= robot_.links_.size()) {
        throw std::invalid_argument("fromPinocchio: geometry '" + object.name + "' is on joint " +
                                    std::to_string(object.parentJoint) + ", which the model does not have");
      }
      robot_.geometries_[object.parentJoint].push_back(object.name);
      if (object.parentJoint == 0 || attached[g]) continue;
      tree_->addLink(object.name);
      tree_->addJoint(Joint::fixed(unused(object.name), tree_->linkName(robot_.links_[object.parentJoint]), object.name,
                                   pose(object.placement)));
    }
    robot_.tree = tree_;
    robot_.manager = std::make_shared<ArticulatedCollisionManager>(robot_.tree);
    std::vector<double> swept(n);
    for (std::size_t g = 0; g < n; ++g) swept[g] = addGeometry(geometries_.geometryObjects[g], attached[g]);
    AllowedCollisionMatrix allowed;
    for (std::size_t a = 0; a < n; ++a) {
      const std::string& name = geometries_.geometryObjects[a].name;
      if (swept[a] > 0) robot_.manager->setMargin(name, swept[a]);
      for (std::size_t b = a + 1; b < n; ++b) {
        const std::string& other = geometries_.geometryObjects[b].name;
        if (!checked[a].count(b)) allowed.allow(name, other);
        if (swept[a] > 0 && swept[b] > 0) robot_.manager->setMargin(name, other, addUp(swept[a], swept[b]));
      }
    }
    robot_.manager->setAllowedCollisions(std::move(allowed));
    robot_.manager->setup();
    requireChecked(checked);
    return std::move(robot_);
  }

 private:
  /// One joint of this library, of the one or several that a joint of pinocchio is.
  struct Step {
    JointType type;
    Eigen::Vector3d axis;
    Eigen::Isometry3d origin = Eigen::Isometry3d::Identity();
    PinocchioRobot::Block::Kind kind;
    int there, size;
  };
  using Steps = std::vector<Step>;

  static Eigen::Isometry3d pose(const pinocchio::SE3& M) {
    Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
    out.linear() = M.rotation();
    out.translation() = M.translation();
    return out;
  }

  /// Collects the steps of a joint; `known` becomes false for one that this library has not.
  struct Visitor : boost::static_visitor<void> {
    using Block = PinocchioRobot::Block;
    Steps steps;
    bool known = true;

    void add(JointType type, const Eigen::Vector3d& axis, Block::Kind kind, int there, int size) {
      steps.push_back({type, axis, Eigen::Isometry3d::Identity(), kind, there, size});
    }
    template <int O, int k>
    void operator()(const pinocchio::JointModelRevoluteTpl<double, O, k>& joint) {
      add(JointType::revolute, Eigen::Vector3d::Unit(k), Block::values, joint.idx_q(), 1);
    }
    template <int O>
    void operator()(const pinocchio::JointModelRevoluteUnalignedTpl<double, O>& joint) {
      add(JointType::revolute, joint.axis, Block::values, joint.idx_q(), 1);
    }
    template <int O, int k>
    void operator()(const pinocchio::JointModelRevoluteUnboundedTpl<double, O, k>& joint) {
      add(JointType::continuous, Eigen::Vector3d::Unit(k), Block::turn, joint.idx_q(), 1);
    }
    template <int O>
    void operator()(const pinocchio::JointModelRevoluteUnboundedUnalignedTpl<double, O>& joint) {
      add(JointType::continuous, joint.axis, Block::turn, joint.idx_q(), 1);
    }
    template <int O, int k>
    void operator()(const pinocchio::JointModelPrismaticTpl<double, O, k>& joint) {
      add(JointType::prismatic, Eigen::Vector3d::Unit(k), Block::values, joint.idx_q(), 1);
    }
    template <int O>
    void operator()(const pinocchio::JointModelPrismaticUnalignedTpl<double, O>& joint) {
      add(JointType::prismatic, joint.axis, Block::values, joint.idx_q(), 1);
    }
    template <int O>
    void operator()(const pinocchio::JointModelSphericalTpl<double, O>& joint) {
      add(JointType::spherical, Eigen::Vector3d::UnitX(), Block::values, joint.idx_q(), 4);
    }
    template <int O>
    void operator()(const pinocchio::JointModelFreeFlyerTpl<double, O>& joint) {
      add(JointType::floating, Eigen::Vector3d::UnitX(), Block::values, joint.idx_q(), 7);
    }
    template <int O>
    void operator()(const pinocchio::JointModelPlanarTpl<double, O>& joint) {
      add(JointType::planar, Eigen::Vector3d::UnitZ(), Block::plane, joint.idx_q(), 3);
    }
    template <int O>
    void operator()(const pinocchio::JointModelTranslationTpl<double, O>& joint) {
      for (int k = 0; k < 3; ++k)
        add(JointType::prismatic, Eigen::Vector3d::Unit(k), Block::values, joint.idx_q() + k, 1);
    }
    template <int O>
    void operator()(const pinocchio::JointModelSphericalZYXTpl<double, O>& joint) {
      for (int k = 0; k < 3; ++k) {
        add(JointType::revolute, Eigen::Vector3d::Unit(2 - k), Block::values, joint.idx_q() + k, 1);
      }
    }
    template <int O>
    void operator()(const pinocchio::JointModelUniversalTpl<double, O>& joint) {
      add(JointType::revolute, joint.axis1, Block::values, joint.idx_q(), 1);
      add(JointType::revolute, joint.axis2, Block::values, joint.idx_q() + 1, 1);
    }
    void operator()(const pinocchio::JointModelComposite& joint) {
      for (std::size_t k = 0; k < joint.joints.size(); ++k) {
        const std::size_t first = steps.size();
        boost::apply_visitor(*this, joint.joints[k].toVariant());
        if (first < steps.size()) steps[first].origin = pose(joint.jointPlacements[k]) * steps[first].origin;
      }
    }
    template <class Other>
    void operator()(const Other&) {
      known = false;
    }
  };

  Steps stepsOf(const pinocchio::JointModel& joint, const std::string& name) const {
    Visitor visitor;
    boost::apply_visitor(visitor, joint.toVariant());
    if (!visitor.known || visitor.steps.empty()) {
      throw std::invalid_argument("fromPinocchio: joint '" + name + "' is a " + joint.shortname() +
                                  ", or has one within it, which fcl_artic has no joint for");
    }
    // pinocchio takes axes as they are: it would slide so many times as far along a longer one, where this library goes
    // by the direction alone.
    for (const Step& step : visitor.steps) {
      if (std::abs(step.axis.norm() - 1) <= 1e-9) continue;
      throw std::invalid_argument("fromPinocchio: joint '" + name + "' has an axis that is not of length 1");
    }
    return visitor.steps;
  }

  /// The name, with as many "_" appended as make it one that neither a geometry nor a link or joint has.
  std::string unused(std::string name) {
    while (!names_.insert(name).second) name += '_';
    return name;
  }

  void addJoint(std::size_t j) {
    const pinocchio::JointModel& model = model_.joints[j];
    const std::string& name = model_.names[j];
    const auto* mimic = boost::get<pinocchio::JointModelMimic>(&model.toVariant());
    const Steps steps = stepsOf(mimic ? mimic->jmodel() : model, name);
    std::string parent = tree_->linkName(robot_.links_[model_.parents[j]]);
    Eigen::Isometry3d origin = pose(model_.jointPlacements[j]);
    for (std::size_t k = 0; k < steps.size(); ++k) {
      const Step& step = steps[k];
      Joint joint;
      joint.type = step.type;
      joint.name = unused(steps.size() == 1 ? name : name + "/" + std::to_string(k));
      joint.parent = parent;
      joint.child = parent = joint.name;
      joint.origin = origin * step.origin;
      joint.axis = step.axis;
      origin.setIdentity();
      const int here = tree_->dof();
      if (mimic) {
        follow(*mimic, steps, name, joint);
      } else {
        readLimits(step, joint);
        masters_[step.there] = joint.name;
        robot_.blocks_.push_back({step.kind, step.there, here, step.size, name});
      }
      tree_->addLink(joint.child);
      tree_->addJoint(joint);
    }
    robot_.links_.push_back(tree_->linkId(parent));
  }

  void follow(const pinocchio::JointModelMimic& mimic, const Steps& steps, const std::string& name,
              Joint& joint) const {
    const auto master = masters_.find(mimic.idx_q());
    const bool one = steps.size() == 1 && (joint.type == JointType::revolute || joint.type == JointType::continuous ||
                                           joint.type == JointType::prismatic);
    if (!one || master == masters_.end()) {
      throw std::invalid_argument("fromPinocchio: joint '" + name +
                                  "' mimics a joint of more than one variable, or is one itself");
    }
    joint.mimics = true;
    joint.mimic = {master->second, mimic.scaling(), mimic.offset()};
  }

  void readLimits(const Step& step, Joint& joint) const {
    if (joint.type != JointType::revolute && joint.type != JointType::prismatic) return;
    const double lower = model_.lowerPositionLimit[step.there], upper = model_.upperPositionLimit[step.there];
    // pinocchio has the largest double for none; no motion goes farther than 1e5.
    if (!(lower <= upper) || !(lower >= -1e5) || !(upper <= 1e5)) return;
    joint.lower = lower;
    joint.upper = upper;
  }

  /// Notes a pair that is checked. Links that one joint moves are neighbours, which a manager does not check against
  /// each other; it does check an attached object against its carrier's neighbours.
  void readPair(const pinocchio::CollisionPair& pair, std::vector<std::set<std::size_t>>& checked,
                std::vector<bool>& attached) const {
    const std::size_t n = geometries_.geometryObjects.size();
    if (pair.first >= n || pair.second >= n) {
      throw std::invalid_argument("fromPinocchio: a collision pair names geometry " +
                                  std::to_string(std::max(pair.first, pair.second)) + " of " + std::to_string(n));
    }
    const auto& a = geometries_.geometryObjects[pair.first];
    const auto& b = geometries_.geometryObjects[pair.second];
    if (a.disableCollision || b.disableCollision) return;
    checked[std::min(pair.first, pair.second)].insert(std::max(pair.first, pair.second));
    if (a.parentJoint == 0 || b.parentJoint == 0 || a.parentJoint == b.parentJoint) return;
    const std::size_t child = a.parentJoint > b.parentJoint ? pair.first : pair.second;
    const std::size_t parent = child == pair.first ? pair.second : pair.first;
    if (attached[child] || attached[parent]) return;
    // At most one joint between them, or siblings: those on two joints of one parent have two, and are no neighbours.
    attached[child] = model_.parents.at(geometries_.geometryObjects[child].parentJoint) ==
                      geometries_.geometryObjects[parent].parentJoint;
  }

  /// @return the swept radius that a margin stands for, m.
  double addGeometry(const pinocchio::GeometryObject& object, bool attached) {
    CoalGeometry geometry;
    try {
      if (!object.geometry) throw std::invalid_argument("it has no geometry");
      geometry = fromCoal(*object.geometry);
      if (geometry.swept_radius > 0 && !options_.swept_radius_as_margin) {
        throw std::invalid_argument(
            "it is swept with a ball of radius " + std::to_string(geometry.swept_radius) +
            " m, for which only a margin stands, in place of a request's (PinocchioOptions::swept_radius_as_margin)");
      }
      const Eigen::Isometry3d placement = pose(object.placement);
      if (object.parentJoint == 0 || attached) {
        auto body = std::make_shared<fcl::CollisionObjectd>(geometry.geometry, placement);
        robot_.manager->registerObject(body, object.name);
        if (attached) robot_.manager->attach(robot_.links_[object.parentJoint], body, placement);
      } else {
        robot_.manager->bind(object.name, std::make_shared<fcl::CollisionObjectd>(geometry.geometry));
      }
    } catch (const std::invalid_argument& e) {
      throw std::invalid_argument("fromPinocchio: geometry '" + object.name + "': " + e.what());
    }
    return geometry.swept_radius;
  }

  /// Every pair of the geometry model's that a joint moves is checked, or nothing is returned at all.
  void requireChecked(const std::vector<std::set<std::size_t>>& checked) const {
    std::set<std::pair<std::string, std::string>> pairs;
    for (const auto& [a, b] : robot_.manager->checkedLinkPairs()) pairs.insert(std::minmax(a, b));
    for (std::size_t a = 0; a < checked.size(); ++a) {
      for (const std::size_t b : checked[a]) {
        const auto& x = geometries_.geometryObjects[a];
        const auto& y = geometries_.geometryObjects[b];
        if (x.parentJoint == y.parentJoint || x.parentJoint == 0 || y.parentJoint == 0) continue;
        if (pairs.count(std::minmax(x.name, y.name))) continue;
        throw std::logic_error("fromPinocchio: collision pair '" + x.name + "', '" + y.name + "' is not checked");
      }
    }
  }

  const pinocchio::Model& model_;
  const pinocchio::GeometryModel& geometries_;
  const PinocchioOptions& options_;
  std::shared_ptr<KinematicTree> tree_;
  PinocchioRobot robot_;
  std::set<std::string> names_;
  std::map<int, std::string> masters_;  ///< by the index of their variable in pinocchio's q
};

}  // namespace detail
/// @endcond

/// Makes a manager of a pinocchio model and its collision geometry: joints, geometries (fromCoal()) and collision
/// pairs. Pairs of geometries that are listed are checked, neighbours too, and all others allowed. Pairs of a geometry
/// whose `disableCollision` is set are allowed as well. Two geometries on one joint never move against each other.
/// So no motion has them touch: ArticulatedCollisionManager::notes() names those that do. (Two on the universe are
/// obstacles: of these it says nothing.) Both models are copied.
///
/// Objects that are registered or attached afterwards are checked against all geometries. A body that coal sweeps with
/// a ball is refused where a margin would have to stand for that (PinocchioOptions::swept_radius_as_margin takes it).
/// @throws std::invalid_argument
///   - naming the joint, for a kind that this library has not (helical ones), an axis that is not of length 1 within
///     1e-9, and mimic joints of more than one variable;
///   - naming the geometry, for one that fromCoal() or the manager refuses, such as a Halfspace or Plane that a joint
///     moves.
inline PinocchioRobot fromPinocchio(const pinocchio::Model& model, const pinocchio::GeometryModel& geometries,
                                    const PinocchioOptions& options = {}) {
  return detail::PinocchioReader(model, geometries, options).read();
}

}  // namespace fcl_artic
