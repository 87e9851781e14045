// SPDX-License-Identifier: BSD-3-Clause
#include "motion/frame_sweep.h"

#include <algorithm>
#include <cmath>

#include "kinematics/joint_factors.h"
#include "numerics/rotation.h"

namespace fcl_artic {
namespace {

engine::StepKind stepKind(JointFactor::Kind kind) {
  switch (kind) {
    case JointFactor::Kind::revolute:
      return engine::StepKind::revolute;
    case JointFactor::Kind::prismatic:
      return engine::StepKind::prismatic;
    case JointFactor::Kind::slide:
      return engine::StepKind::slide;
    case JointFactor::Kind::turn:
      return engine::StepKind::turn;
  }
  return engine::StepKind::revolute;
}

/// Goes to a step's frame. Q turns the step's axis to the frame's z.
void standBehind(Carrier& carrier, int step, const Rotation& Q) {
  carrier.step = step;
  carrier.offset.linear() = Q.matrix().transpose();
  carrier.offset.translation().setZero();
  carrier.length = 0;
  carrier.ulps = Rotation::kUlps;
}

}  // namespace

namespace {

engine::Placement placementOf(const Eigen::Isometry3d& M, double length, double ulps) {
  engine::Placement p;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) p.R[3 * i + j] = M.linear()(i, j);
    p.t[i] = M.translation()[i];
  }
  p.length = length;
  p.ulps = ulps;
  p.identity = isIdentity(M);
  return p;
}

}  // namespace

engine::Placement makePlacement(const RigidTransform& M) {
  return placementOf(M, M.length(), M.ulps());
}

engine::Placement makePlacement(const Carrier& carrier, const RigidTransform& offset) {
  return placementOf(carrier.offset * offset, carrier.length + offset.length(), carrier.ulps + offset.ulps());
}

engine::Placement makeInversePlacement(const Carrier& carrier, const RigidTransform& offset) {
  // Twice the error, as in RigidTransform::inverse().
  return placementOf((carrier.offset * offset).inverse(), carrier.length + offset.length(),
                     2 * (carrier.ulps + offset.ulps()));
}

FrameSweep FrameSweep::fromWorld(const KinematicTree& tree) {
  FrameSweep sweep(tree, -1);
  // As carrier() goes, each joint once: a parent comes before its children.
  std::vector<Carrier> carriers(static_cast<std::size_t>(tree.numLinks()));
  for (const LinkId link : tree.topologicalOrder()) {
    const LinkId parent = tree.parentLink(link);
    if (parent < 0) continue;
    carriers[static_cast<std::size_t>(link)] =
        sweep.cross(carriers[static_cast<std::size_t>(parent)], tree.parentJoint(link), true);
  }
  return sweep;
}

FrameSweep FrameSweep::fromLink(const KinematicTree& tree, LinkId base) {
  return FrameSweep(tree, base);
}

Carrier FrameSweep::carrier(LinkId link) {
  // Up from the base to the common ancestor, then down to the link.
  std::vector<LinkId> up_from_link{link};
  while (tree_->parentLink(up_from_link.back()) >= 0) up_from_link.push_back(tree_->parentLink(up_from_link.back()));
  Carrier at = world_;
  LinkId here = base_;
  if (base_ < 0) {
    here = up_from_link.back();  // roots stand at identity in the world
  } else {
    while (std::find(up_from_link.begin(), up_from_link.end(), here) == up_from_link.end()) {
      const JointId joint = tree_->parentJoint(here);
      if (joint < 0) {  // another tree of the forest: all roots stand at identity in the world
        here = up_from_link.back();
        break;
      }
      at = cross(at, joint, false);
      here = tree_->parentLink(here);
    }
  }
  auto it = std::find(up_from_link.begin(), up_from_link.end(), here);
  while (it != up_from_link.begin()) {
    --it;
    at = cross(at, tree_->parentJoint(*it), true);
  }
  return at;
}

namespace {

/// Multiplies a constant transform in. The sizes of translations are summed: where translations cancel, their rounding
/// does not.
void moveBy(Carrier& carrier, const RigidTransform& constant, bool down) {
  if (isIdentity(constant)) {  // a product may come out so
    carrier.ulps += constant.ulps();
    carrier.length += constant.length();
    return;
  }
  const RigidTransform factor = down ? constant : constant.inverse();
  carrier.offset = carrier.offset * factor;
  carrier.ulps += factor.ulps();
  carrier.length += constant.length();
}

}  // namespace

engine::SweepStep& FrameSweep::append(Carrier& at, const UnitVector& axis) {
  const bool split = at.step >= 0 && steps_[static_cast<std::size_t>(at.step)].kind == engine::StepKind::revolute;
  steps_.emplace_back();
  engine::SweepStep& step = steps_.back();
  const Rotation Q = Rotation::withZ(axis);
  using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  Eigen::Map<RowMajor>(step.C, 3, 3) = at.offset.linear() * Q.matrix();
  Eigen::Vector3d::Map(step.p) = at.offset.translation();
  step.parent = at.step;
  step.length = at.length;
  step.ulps = at.ulps + kTransformUlps;
  const double error = 0x1p-52 * step.ulps * step.length;
  step.axial = split ? std::abs(step.p[2]) + error : 0;
  step.perp = split ? Eigen::Vector2d::Map(step.p).norm() * (1 + 1e-15) + error : step.length;
  standBehind(at, static_cast<int>(steps_.size()) - 1, Q);
  return step;
}

Carrier FrameSweep::cross(const Carrier& from, JointId id, bool down) {
  const Joint& joint = tree_->joint(id);
  Carrier to = from;
  if (down) moveBy(to, originOf(joint), down);
  const std::vector<JointFactor> factors = factorsOf(joint);
  for (std::size_t i = 0; i < factors.size(); ++i) {
    const std::size_t f = down ? i : factors.size() - 1 - i;
    const JointFactor& factor = factors[f];
    const int parent = to.step;
    // A step comes after its parent; in a chain, it is the next one.
    const auto known = std::find_if(origin_.begin() + (parent + 1), origin_.end(), [&](const Origin& o) {
      return o.parent == parent && o.joint == id && o.factor == f && o.down == down;
    });
    if (known != origin_.end()) {
      standBehind(to, static_cast<int>(known - origin_.begin()), Rotation::withZ(factor.axis));
    } else {
      const double sign = down ? 1 : -1;
      engine::SweepStep& step = append(to, factor.axis);
      step.kind = stepKind(factor.kind);
      step.variable = tree_->jointVariable(id) + factor.variable;
      step.multiplier = sign * (joint.mimics ? joint.mimic.multiplier : 1);
      step.offset = sign * (joint.mimics ? joint.mimic.offset : 0);
      step.inverse = !down;
      if (step.kind == engine::StepKind::turn) step.orientation = quaternionNumber(*tree_, id);
      origin_.push_back({parent, id, f, down});
    }
  }
  if (!down) moveBy(to, originOf(joint), down);
  return to;
}

Carrier FrameSweep::cross(const Carrier& from, const MotionElement& element, int variable,
                          const engine::BoundedSource* source, bool down, int orientation) {
  using Kind = MotionElement::Kind;
  Carrier to = from;
  if (down) moveBy(to, element.before, down);
  const bool has_axis = element.kind == Kind::revolute || element.kind == Kind::prismatic;
  engine::SweepStep& step = append(to, has_axis ? element.axis : UnitVector());
  step.kind = element.kind == Kind::revolute    ? engine::StepKind::revolute
              : element.kind == Kind::prismatic ? engine::StepKind::prismatic
              : element.kind == Kind::slide     ? engine::StepKind::slide
              : element.kind == Kind::turn      ? engine::StepKind::turn
                                                : engine::StepKind::bounded;
  step.variable = variable;
  step.multiplier = down ? 1 : -1;
  step.source = source;
  step.inverse = !down;
  step.orientation = orientation;
  origin_.push_back({from.step, -1, 0, down});
  if (!down) moveBy(to, element.before, down);
  return to;
}

void FrameSweep::allowError(double angle, double length) {
  // The engine takes a step's origin to be off by 2^-52 ulps * length.
  steps_.back().ulps += angle;
  steps_.back().length += length;
}

void FrameSweep::setStrays(const std::vector<JointTolerance>& of_joint) {
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    engine::SweepStep& step = steps_[i];
    const Origin& from = origin_[i];
    step.stray = 0;
    if (from.joint < 0 || of_joint.empty()) continue;
    const JointTolerance& tolerance = of_joint[static_cast<std::size_t>(from.joint)];
    // A planar joint slides by two factors, and its length is that of both together: either of them may have all of it.
    // (Bounds along a direction take a slide's own one, so the first factor could not stand for the second.)
    step.stray = engine::turns(step.kind) ? tolerance.angle : tolerance.length;
  }
}

void FrameSweep::enterTree(const KinematicTree& tree, const Carrier& world) {
  tree_ = &tree;
  base_ = -1;
  world_ = world;
}

engine::SweepView FrameSweep::view() const {
  engine::SweepView view;
  view.steps = steps_.data();
  view.num_steps = static_cast<std::int32_t>(steps_.size());
  for (const engine::SweepStep& step : steps_) {
    view.local_bounds = view.local_bounds || step.source;
    view.strays = view.strays || step.stray > 0;
    view.first_order = view.first_order || (step.source && !step.source->derivatives);
  }
  return view;
}

void FrameSweep::clear() {
  steps_.clear();
  origin_.clear();
  world_ = Carrier();
}

}  // namespace fcl_artic
