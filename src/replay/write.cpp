// SPDX-License-Identifier: BSD-3-Clause
//
// Queries to text: the manager's input, as it was read, as a record; and the record as JSON.
#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>

#include "fcl/fcl_geometry.h"
#include "fcl_artic/instruction_set.h"
#include "fcl_artic/manager.h"
#include "query/manager_impl.h"
#include "replay/geometry.h"
#include "replay/record.h"

namespace fcl_artic {
namespace {

using namespace replay;

TransformRecord recordOf(const RigidTransform& M) {
  return {M.isometry(), M.ulps(), M.length()};
}

MotionRecord recordOf(const JointMotion& motion) {
  const Eigen::VectorXd& references = motion.references();
  return {motion.coefficients(), {references.data(), references.data() + references.size()}};
}

/// Makes the record of what a registry holds.
class Recorder {
 public:
  explicit Recorder(const Registry& registry) : registry_(registry), tree_(*registry.tree()) {}

  QueryRecord run() {
    record_.library = FCL_ARTIC_VERSION;
    record_.instruction_set = instructionSet();
    record_.robot.name = tree_.name();
    for (LinkId link = 0; link < tree_.numLinks(); ++link) record_.robot.links.push_back(tree_.linkName(link));
    for (JointId j = 0; j < tree_.numJoints(); ++j) record_.robot.joints.push_back(tree_.joint(j));
    requireSameTree();
    for (const ManagedBody& body : registry_.links()) addCarried(body);
    for (const ManagedBody& body : registry_.moving()) addMoving(body);
    for (const ManagedBody& body : registry_.obstacles()) {
      record_.obstacles.push_back({body.name, numberOf(body), body.transform});
    }
    for (const auto& [a, b] : registry_.allowed().pairs()) record_.pairs.allowed.push_back({a, b});
    for (const auto& [a, b] : registry_.allowed().disallowedPairs()) record_.pairs.disallowed.push_back({a, b});
    record_.pairs.complete = registry_.allowed().complete();
    addMargins();
    addTolerances();
    addProofs();
    return std::move(record_);
  }

 private:
  std::string nameOf(const ManagedBody& body) const {
    return body.isObstacle() ? "obstacle '" + body.name + "'" : "geometry of link '" + body.name + "'";
  }

  /// A rotation that was made orthonormal, and an axis that was given the length 1, are taken as they are when they are
  /// given again. In another rounding mode they may be rounded once more, and answers may differ then.
  static void requireExact(bool exact, const std::string& what) {
    if (exact) return;
    throw std::invalid_argument(
        "writeQuery: the rotation or axis of " + what +
        " would be rounded once more when it is read; set the rounding mode that it was made in");
  }
  void requireSameTree() const {
    const KinematicTree again = treeOf(record_.robot);
    for (JointId j = 0; j < tree_.numJoints(); ++j) {
      const Joint &joint = tree_.joint(j), &read = again.joint(j);
      requireExact(read.origin.matrix() == joint.origin.matrix() && read.axis == joint.axis,
                   "joint '" + joint.name + "'");
    }
  }

  /// The number of a body's geometry, which several bodies may have.
  std::size_t numberOf(const ManagedBody& body) {
    // (Nobody knows whether a motion is as read.)
    const bool same = body.moving
                          ? body.moving->collisionGeometry() == body.geometry && body.content->sameAs(*body.geometry)
                          : body.isAsRead();
    if (!same) {
      throw std::invalid_argument("writeQuery: " + nameOf(body) + " has changed since setup(); call update()");
    }
    const auto [it, is_new] = numbers_.try_emplace(body.geometry.get(), record_.geometries.size());
    if (is_new) record_.geometries.push_back(geometryRecord(*body.geometry));
    return it->second;
  }

  void addCarried(const ManagedBody& body) {
    CarriedRecord carried;
    carried.link = tree_.linkName(body.link);
    carried.geometry = numberOf(body);
    carried.offset = body.offset.isometry();
    requireExact(requireRigid(carried.offset, nameOf(body)).matrix() == carried.offset.matrix(), nameOf(body));
    if (body.attached) carried.attached = body.name;
    for (const LinkId link : body.touch_links) carried.touch_links.push_back(tree_.linkName(link));
    record_.carried.push_back(std::move(carried));
  }

  void addMoving(const ManagedBody& body) {
    MovingRecord moving;
    moving.name = body.name;
    moving.geometry = numberOf(body);
    for (const MotionElement& element : body.motion.elements) {
      if (element.kind == MotionElement::Kind::bounded) {
        throw std::invalid_argument("writeQuery: " + nameOf(body) +
                                    " moves as its BoundedMotion says, and only that knows how");
      }
      const std::optional<UnitVector> read = UnitVector::within3Ulps(element.axis);
      requireExact(read && read->vector() == element.axis.vector(), nameOf(body));
      moving.elements.push_back(
          {recordOf(element.before), element.kind, element.axis.vector(), Eigen::MatrixXd(element.coefficients)});
    }
    moving.after = recordOf(body.motion.after);
    record_.moving.push_back(std::move(moving));
  }

  /// Leaves out the margins of neighbours, which a reader's setup() finds again.
  void addMargins() {
    const NamedMargins all = registry_.margins(), found = registry_.marginsOfNeighbours();
    std::set<std::string> names(record_.robot.links.begin(), record_.robot.links.end());
    for (const auto* bodies : {&registry_.links(), &registry_.moving(), &registry_.obstacles()}) {
      for (const ManagedBody& body : *bodies) names.insert(body.name);
    }
    for (const std::string& name : names) {
      if (const double margin = all.ofBody(name); margin >= 0) record_.margins.push_back({{name}, margin});
    }
    for (const auto& [pair, margin] : all.ofPairs()) {
      const auto same = found.ofPairs().find(pair);
      if (same != found.ofPairs().end() && same->second == margin) continue;
      record_.margins.push_back({{pair.first, pair.second}, margin});
    }
  }

  void addTolerances() {
    using Of = ToleranceRecord::Of;
    const NamedTolerances& tolerances = registry_.tolerances();
    const JointTolerance& all = tolerances.ofAllJoints();
    const PoseTolerance& base = tolerances.base();
    const auto add = [&](Of of, const std::string& name, const auto& tolerance, const Eigen::Vector3d& pivot) {
      record_.tolerances.push_back({of, name, tolerance.angle, tolerance.length, 0, 0, 0, pivot});
    };
    if (all.any()) add(Of::joints, {}, all, Eigen::Vector3d::Zero());
    for (const auto& [name, own] : tolerances.ofJoints()) add(Of::joint, name, own, Eigen::Vector3d::Zero());
    if (base.any()) add(Of::base, {}, base, base.pivot);
    for (const auto& [name, own] : tolerances.ofObjects()) add(Of::object, name, own, own.pivot);
    for (const auto& [name, own] : tolerances.speeds()) {
      record_.tolerances.push_back({Of::speed, name, 0, 0, own.speed, own.since, 0, Eigen::Vector3d::Zero()});
    }
    if (tolerances.ofTime() > 0) {
      record_.tolerances.push_back({Of::time, {}, 0, 0, 0, 0, tolerances.ofTime(), Eigen::Vector3d::Zero()});
    }
  }

  /// Proofs of two links hold for all of their geometries, which a reader proves again.
  void addProofs() {
    if (!registry_.proofs()) return;
    const std::vector<ManagedBody>& links = registry_.links();
    std::map<std::pair<LinkId, LinkId>, std::vector<const LinkPairProofs::Proof*>> proofs;
    registry_.forEachTwoLinks([&](std::size_t a, std::size_t b) {
      if (links[a].attached || links[b].attached) return;
      proofs[std::minmax(links[a].link, links[b].link)].push_back(
          registry_.proofs()->find(PairMaking::inOrder(tree_, links[a], links[b]), 0));
    });
    for (const auto& [pair, found] : proofs) {
      const auto missing = std::count(found.begin(), found.end(), nullptr);
      const Names names = {tree_.linkName(pair.first), tree_.linkName(pair.second)};
      if (missing == 0) record_.proofs.push_back({names, found[0]->margin});
      if (missing == 0 || missing == static_cast<std::ptrdiff_t>(found.size())) continue;
      throw std::invalid_argument("writeQuery: only some geometries of '" + names[0] + "' and '" + names[1] +
                                  "' are proven apart; call classifyLinkPairs() and setLinkPairProofs() again");
    }
  }

  const Registry& registry_;
  const KinematicTree& tree_;
  QueryRecord record_;
  std::map<const void*, std::size_t> numbers_;
};

/// JSON with a line for each entry of the longer lists, so that people and their tools find their way.
std::string textOf(const Json& json, int depth) {
  constexpr int kLinesDown = 2;
  const bool in_lines =
      depth < kLinesDown && json.is_structured() && !json.empty() && (json.is_object() || json.front().is_structured());
  if (!in_lines) return json.dump();
  const std::string indent(static_cast<std::size_t>(depth + 1), ' ');
  std::string text = json.is_object() ? "{" : "[";
  for (auto it = json.begin(); it != json.end(); ++it) {
    text += (it == json.begin() ? "\n" : ",\n") + indent;
    if (json.is_object()) text += Json(it.key()).dump() + ": ";
    text += textOf(*it, depth + 1);
  }
  return text + "\n" + indent.substr(1) + (json.is_object() ? "}" : "]");
}

std::string textOf(const QueryRecord& record) {
  try {
    return textOf(replay::written(record), 0) + "\n";
  } catch (const Json::type_error&) {
    throw std::invalid_argument("writeQuery: a name is no text in UTF-8");
  }
}

}  // namespace

std::string ArticulatedCollisionManager::writeQuery(const JointMotion& motion, const CertifiedRequest& request) const {
  impl_->requireReady();
  motion.requireOf(tree());
  QueryRecord record = Recorder(impl_->registry).run();
  record.motion.pieces.push_back(recordOf(motion));
  record.request = request;
  return textOf(record);
}

std::string ArticulatedCollisionManager::writeQuery(const JointTrajectory& trajectory,
                                                    const CertifiedRequest& request) const {
  impl_->requireReady();
  trajectory.requireOf(tree());
  QueryRecord record = Recorder(impl_->registry).run();
  record.motion.times = trajectory.times();
  for (std::size_t k = 0; k < trajectory.numPieces(); ++k)
    record.motion.pieces.push_back(recordOf(trajectory.piece(k)));
  record.request = request;
  return textOf(record);
}

}  // namespace fcl_artic
