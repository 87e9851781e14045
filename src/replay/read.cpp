// SPDX-License-Identifier: BSD-3-Clause
//
// Queries from text: JSON as a record, and a manager and a motion made of the record.
#include <algorithm>
#include <stdexcept>

#include <fcl/narrowphase/collision_object.h>
#include <fcl/narrowphase/continuous_collision_object.h>

#include "fcl/recorded_motion.h"
#include "fcl_artic/query_text.h"
#include "kinematics/exact_motion.h"
#include "kinematics/largest_joint_value.h"
#include "numerics/constants.h"
#include "replay/geometry.h"
#include "replay/record.h"

namespace fcl_artic {
namespace {

using namespace replay;

constexpr int kFormat = 1;
constexpr char kFormatField[] = "fcl_artic_query";

/// A transform that is as good as the text says.
///
/// With u = 2^-52: R is no farther from a proper rotation than |1 - R^T R| / (2 - |1 - R^T R|) (doc/CERTIFICATES.md,
/// "Rotations"), which is computed within 9u, so than ulps u where |1 - R^T R| is at most 2 ulps u - 9u, less what the
/// quotient's second term adds, below u. The translation is exact: a length that holds it will do.
RigidTransform transformOf(const TransformRecord& record, const std::string& at) {
  constexpr double kLeast = kTransformUlps, kMost = 1e6;
  if (!(record.ulps >= kLeast && record.ulps <= kMost)) refuse(at + ".ulps", "is not within [24, 1e6]");
  const Eigen::Matrix3d R = record.pose.linear();
  const double defect = orthonormalityDefect(R).norm();
  const bool rigid = defect <= (2 * record.ulps - 10) * 0x1p-52 && R.determinant() > 0;
  const Eigen::Vector3d t = record.pose.translation();
  if (!rigid || !(t.cwiseAbs().array() <= kFarthest).all()) refuse(at + ".pose", "is no rigid transform");
  const double least = RigidTransform().at(t).length();
  if (!(record.length >= least && std::isfinite(record.length)))
    refuse(at + ".length", "is less than the way to the pose");
  return RigidTransform::product(record.pose, record.ulps, record.length);
}

/// Refuses what the pads of a motion's bounds do not hold for. The coefficients of FCL's motions, whose places are
/// within kFarthest, are less than twice that.
void requireCoefficients(const ElementRecord& element, const std::string& at) {
  const Eigen::MatrixXd& c = element.coefficients;
  if (c.rows() != 3 || c.cols() != kMaxDegree + 1) refuse(at, "are not three rows of six");
  if (!(c.cwiseAbs().array() <= 2 * kFarthest).all()) refuse(at, "are not finite or beyond 2e9");
  if (element.kind != MotionElement::Kind::revolute && element.kind != MotionElement::Kind::turn) return;
  const auto powers = c.rightCols(kMaxDegree).array();
  const Eigen::ArrayXd most = c.col(0).array() + powers.max(0).rowwise().sum();
  const Eigen::ArrayXd least = c.col(0).array() + powers.min(0).rowwise().sum();
  if (!(most <= kLargestJointValue && least >= -kLargestJointValue).all()) refuse(at, "turn by more than 1e5 rad");
}

BodyMotion motionOf(const MovingRecord& record, const std::string& at) {
  BodyMotion motion;
  for (std::size_t i = 0; i < record.elements.size(); ++i) {
    const ElementRecord& given = record.elements[i];
    const std::string here = entry(at + ".elements", i);
    MotionElement& element = motion.elements.emplace_back();
    element.before = transformOf(given.before, here + ".before");
    element.kind = given.kind;
    const std::optional<UnitVector> axis = UnitVector::within3Ulps(given.axis);
    if (!axis) refuse(here + ".axis", "is zero or not finite");
    element.axis = *axis;
    requireCoefficients(given, here + ".coefficients");
    element.coefficients = given.coefficients;
  }
  motion.after = transformOf(record.after, at + ".after");
  return motion;
}

/// Makes the manager of a record.
class Builder {
 public:
  explicit Builder(const QueryRecord& record) : record_(record) {
    for (std::size_t i = 0; i < record.geometries.size(); ++i) {
      geometries_.push_back(geometryOf(record.geometries[i], entry("geometries", i)));
    }
  }

  ArticulatedCollisionManager run() {
    ArticulatedCollisionManager manager(std::make_shared<const KinematicTree>(treeOf(record_.robot)));
    addCarried(manager);
    addObstacles(manager);
    manager.setAllowedCollisions(makeAllowed());
    for (std::size_t i = 0; i < record_.margins.size(); ++i) {
      const MarginRecord& own = record_.margins[i];
      if (own.of.size() != 1 && own.of.size() != 2) refuse(entry("margins", i) + ".of", "are not one or two names");
      own.of.size() == 1 ? manager.setMargin(own.of[0], own.margin)
                         : manager.setMargin(own.of[0], own.of[1], own.margin);
    }
    for (const ToleranceRecord& own : record_.tolerances) setTolerance(own, manager);
    manager.setLinkPairProofs(prove(manager));
    manager.setup();
    return manager;
  }

 private:
  std::shared_ptr<fcl::CollisionGeometryd> geometry(std::size_t number, const std::string& at) const {
    if (number < geometries_.size()) return geometries_[number];
    refuse(at + ".geometry", "is " + std::to_string(number) + ", and there are " + std::to_string(geometries_.size()));
  }

  static void setTolerance(const ToleranceRecord& own, ArticulatedCollisionManager& manager) {
    const JointTolerance of_joint = {own.angle, own.length};
    const PoseTolerance of_pose = {own.length, own.angle, own.pivot};
    switch (own.of) {
      case ToleranceRecord::Of::joints:
        return manager.setJointTolerances(of_joint);
      case ToleranceRecord::Of::joint:
        return manager.setJointTolerance(own.name, of_joint);
      case ToleranceRecord::Of::base:
        return manager.setBaseTolerance(of_pose);
      case ToleranceRecord::Of::object:
        return manager.setObjectTolerance(own.name, of_pose);
      case ToleranceRecord::Of::speed:
        return manager.setObjectSpeed(own.name, {own.speed, own.since});
      case ToleranceRecord::Of::time:
        return manager.setTimeTolerance(own.time);
    }
  }

  void addCarried(ArticulatedCollisionManager& manager) {
    for (std::size_t i = 0; i < record_.carried.size(); ++i) {
      const CarriedRecord& c = record_.carried[i];
      const std::string at = entry("carried", i);
      const auto object = std::make_shared<fcl::CollisionObjectd>(geometry(c.geometry, at));
      if (c.attached.empty()) {
        if (!c.touch_links.empty()) refuse(at + ".touch_links", "are of what is not attached");
        manager.bind(c.link, object, c.offset);
      } else {
        manager.registerObject(object, c.attached);
        manager.attach(c.link, object, c.offset, c.touch_links);
      }
    }
  }

  void addObstacles(ArticulatedCollisionManager& manager) const {
    for (std::size_t i = 0; i < record_.moving.size(); ++i) {
      const MovingRecord& m = record_.moving[i];
      const std::string at = entry("moving", i);
      if (m.name.empty()) refuse(at + ".name", "is empty");
      const auto motion = std::make_shared<RecordedMotion>(motionOf(m, at));
      manager.registerObject(std::make_shared<fcl::ContinuousCollisionObjectd>(geometry(m.geometry, at), motion),
                             m.name);
    }
    for (std::size_t i = 0; i < record_.obstacles.size(); ++i) {
      const ObstacleRecord& o = record_.obstacles[i];
      const std::string at = entry("obstacles", i);
      if (o.name.empty()) refuse(at + ".name", "is empty");
      manager.registerObject(
          std::make_shared<fcl::CollisionObjectd>(geometry(o.geometry, at), fcl::Transform3d(o.pose)), o.name);
    }
  }

  AllowedCollisionMatrix makeAllowed() const {
    AllowedCollisionMatrix matrix;
    for (const auto& [a, b] : record_.pairs.allowed) matrix.allow(a, b);
    for (const auto& [a, b] : record_.pairs.disallowed) matrix.disallow(a, b);
    matrix.setComplete(record_.pairs.complete);
    return matrix;
  }

  /// Proves again what the text calls proven: nobody need believe it.
  std::shared_ptr<const LinkPairProofs> prove(const ArticulatedCollisionManager& manager) const {
    if (record_.proofs.empty()) return nullptr;
    AllowedCollisionMatrix pairs;
    LinkPairOptions options;
    options.only = &pairs;
    options.margin = record_.proofs[0].margin;
    options.work *= 10;  // at most: whoever wrote the text may have asked for more than usual
    options.samples = 1;
    for (const ProofRecord& proof : record_.proofs) {
      if (proof.margin != options.margin) refuse("proofs", "are of several margins");
      pairs.allow(proof.of[0], proof.of[1]);
    }
    const LinkPairReport report = manager.classifyLinkPairs(options);
    for (std::size_t i = 0; i < record_.proofs.size(); ++i) {
      const Names& names = record_.proofs[i].of;
      const bool proven = std::any_of(report.pairs.begin(), report.pairs.end(), [&](const LinkPairFinding& pair) {
        return pair.kind == LinkPairKind::never &&
               std::minmax(pair.link1, pair.link2) == std::minmax(names[0], names[1]);
      });
      if (!proven)
        refuse(entry("proofs", i), "is of '" + names[0] + "' and '" + names[1] + "', which are not proven apart");
    }
    return report.proofs;
  }

  const QueryRecord& record_;
  std::vector<std::shared_ptr<fcl::CollisionGeometryd>> geometries_;
};

/// (A robot without variables has no rows, in which columns would show.)
JointMotion motionOf(const KinematicTree& tree, const MotionRecord& record) {
  const bool none = tree.dof() == 0 && record.coefficients.rows() == 0;
  return ExactMotion::motion(
      tree, none ? Eigen::MatrixXd(0, 1) : record.coefficients,
      Eigen::VectorXd::Map(record.references.data(), static_cast<Eigen::Index>(record.references.size())));
}

}  // namespace

RecordedQuery readQuery(std::string_view text) {
  QueryRecord record;
  {
    Json json;
    try {
      json = text::parseJson(text);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(std::string("query: ") + error.what());
    }
    // Another format may have other fields.
    if (!json.is_object() || !json.contains(kFormatField))
      refuse("", std::string("is no query: it lacks '") + kFormatField + "'");
    replay::read(json[kFormatField], kFormatField, record.format);
    if (record.format != kFormat)
      refuse(kFormatField, "is " + std::to_string(record.format) + ", and this library reads 1");
    replay::read(json, "", record);
  }
  RecordedQuery query{record.library, record.instruction_set, Builder(record).run(), {}, {}, record.request};
  const KinematicTree& tree = query.manager.tree();
  std::vector<JointMotion> pieces;
  for (const MotionRecord& piece : record.motion.pieces) pieces.push_back(motionOf(tree, piece));
  if (!record.motion.times.empty()) {
    query.trajectory = ExactMotion::trajectory(tree, record.motion.times, std::move(pieces));
  } else if (pieces.size() == 1) {
    query.motion = std::move(pieces[0]);
  } else {
    refuse("motion.pieces", "are " + std::to_string(pieces.size()) + ", without times");
  }
  return query;
}

CertifiedResult RecordedQuery::ask() const {
  if (trajectory) return manager.continuousCollide(*trajectory, request);
  return manager.continuousCollide(motion.value(), request);
}

}  // namespace fcl_artic
