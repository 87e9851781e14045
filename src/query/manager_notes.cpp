// SPDX-License-Identifier: BSD-3-Clause
//
// The manager's notes on pairs that no query checks: neighbours that touch throughout, and bodies that stand still
// against each other.
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "query/manager_impl.h"
#include "query/pair_query.h"
#include "setup/neighbours.h"

namespace fcl_artic {

std::vector<LinkPairFinding> ArticulatedCollisionManager::neighbours() const {
  impl_->requireReady();
  std::vector<LinkPairFinding> open;
  for (const auto& [links, pair] : impl_->registry.neighbours()->pairs) {
    if (!impl_->registry.allowed().allowed(pair.finding.link1, pair.finding.link2)) open.push_back(pair.finding);
  }
  return open;
}

namespace {

/// Names of pairs that stand still against each other (Registry::standStill()) and touch, or can't be proven apart.
std::set<std::pair<std::string, std::string>> touchingStill(const Registry& registry) {
  const KinematicTree& tree = *registry.tree();
  FrameSweep sweep = FrameSweep::fromWorld(tree);
  struct Placed {
    const ManagedBody* body;
    BodyMotion motion;  ///< where it stands, seen from what carries it
    Eigen::Vector3d lower, upper;
  };
  std::map<LinkId, std::vector<Placed>> by_carrier;  // -1: the world
  const auto add = [&](const ManagedBody& body) {
    if (body.empty()) return;
    Placed placed{&body, {}, {}, {}};
    placed.motion.after = body.offset;
    if (body.link >= 0) {
      const Carrier at = sweep.carrier(body.link);
      placed.motion.after = RigidTransform::product(at.offset * body.offset, at.ulps + body.offset.ulps(),
                                                    at.length + body.offset.length());
    }
    body.worldBox(placed.motion.after, makePlacement(placed.motion.after), placed.lower.data(), placed.upper.data());
    by_carrier[carrierOf(tree, body.link)].push_back(std::move(placed));
  };
  for (const ManagedBody& link : registry.links()) add(link);
  for (const ManagedBody& obstacle : registry.obstacles()) add(obstacle);
  std::set<std::pair<std::string, std::string>> touching;
  CertifiedPairRequest request;
  request.max_contacts = 0;
  CertifiedPairResult result;
  const auto noteTouching = [&](const Placed& a, const Placed& b) {
    const bool said = b.body->link < 0 ? !registry.mayTouch(*a.body, *b.body)
                                       : registry.allowed().allowed(a.body->name, b.body->name) ||
                                             a.body->mayTouchLink(*b.body) || b.body->mayTouchLink(*a.body);
    if (said || !registry.standStill(*a.body, *b.body) ||
        ((a.lower.array() > b.upper.array()) || (b.lower.array() > a.upper.array())).any())
      return;
    solvePair({*a.body->shape, a.motion}, {*b.body->shape, b.motion}, request, result);
    if (!result.isFree()) touching.insert(std::minmax(a.body->name, b.body->name));
  };
  for (const auto& [carrier, bodies] : by_carrier) {
    for (std::size_t i = 0; i < bodies.size() && bodies[i].body->link >= 0; ++i) {  // links first
      for (std::size_t j = i + 1; j < bodies.size(); ++j) {
        if (bodies[i].body->link != bodies[j].body->link) noteTouching(bodies[i], bodies[j]);
      }
    }
  }
  return touching;
}

}  // namespace

std::vector<std::string> ArticulatedCollisionManager::notes() const {
  impl_->requireReady();
  std::string throughout, undecided;
  for (const auto& [links, pair] : impl_->registry.neighbours()->pairs) {
    const LinkPairFinding& found = pair.finding;
    if (impl_->registry.allowed().allowed(found.link1, found.link2)) continue;
    const std::string names = "'" + found.link1 + "' and '" + found.link2 + "'" +
                              (pair.apart.empty() ? "" : " (but for their parts that are apart at one of these)");
    if (found.touchThroughout()) throughout += (throughout.empty() ? "" : ", ") + names;
    if (found.undecided()) undecided += (undecided.empty() ? "" : ", ") + names;
  }
  std::vector<std::string> notes;
  std::string still;
  for (const auto& [a, b] : touchingStill(impl_->registry)) {
    still += (still.empty() ? "'" : ", '") + a + "' and '" + b + "'";
  }
  if (!still.empty()) {
    notes.push_back("touch, and stand still against each other, whatever the joints do; not checked, as no motion " +
                    ("changes it (disallow(), --disallow have a pair checked): " + still));
  }
  const auto note = [&](const std::string& said, const std::string& of) {
    if (!of.empty()) notes.push_back("neighbours " + said + ": " + of);
  };
  note("that touch at all tried values of the joint between them, as housings that overlap in it, are not checked",
       throughout);
  note("of which it can't be decided whether they touch are not checked, and each answer counts them", undecided);
  return notes;
}

}  // namespace fcl_artic
