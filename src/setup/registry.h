// SPDX-License-Identifier: BSD-3-Clause
//
// All that callers gave the manager: the robot, geometry bound to its links, obstacles, allowed pairs and margins.
// Every change is checked here, and one that throws changes nothing. The Setup has what is made of it for queries.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <unordered_set>
#include <vector>

#include "fcl_artic/manager.h"
#include "setup/managed_body.h"
#include "setup/margins.h"
#include "setup/tube.h"

namespace fcl_artic {

struct NeighbourFindings;

/// Why two geometries on two links are not checked.
enum class Excuse : std::uint8_t {
  none,        ///< they are
  allowed,     ///< somebody said that they may touch
  touch_link,  ///< the one is carried, and may touch the other
  still,       ///< no motion moves the one against the other (standStill())
  neighbours   ///< by the rule for neighbours (ArticulatedCollisionManager::setAllowedCollisions())
};

class Registry {
 public:
  /// @throws std::invalid_argument when tree is null.
  explicit Registry(std::shared_ptr<const KinematicTree> tree);

  const std::shared_ptr<const KinematicTree>& tree() const { return tree_; }
  /// In the order in which the engine's bodies follow each other: links, moving obstacles, the others.
  const std::vector<ManagedBody>& links() const { return links_; }  ///< attached objects included
  const std::vector<ManagedBody>& moving() const { return moving_; }
  const std::vector<ManagedBody>& obstacles() const { return obstacles_; }
  const ManagedBody& body(std::int32_t number) const;
  /// f(a, b) for any two of links() on different links, a's number the lower one: numbers in order. (Geometries of one
  /// link mostly lie together, and are passed over together: of many on one link the pairs would be their square.)
  template <class F>
  void forEachTwoLinks(const F& f) const {
    const std::size_t count = links_.size();
    std::vector<std::size_t> next(count + 1, count);  // the first one after k that is on another link than k
    for (std::size_t k = count; k-- > 0;) next[k] = sameLink(k, k + 1) ? next[k + 1] : k + 1;
    for (std::size_t a = 0; a < count; ++a) {
      for (std::size_t b = next[a]; b < count; ++b) {
        while (b < count && sameLink(a, b)) b = next[b];
        if (b < count) f(a, b);
      }
    }
  }
  /// Links that have geometry of their own, not only attached.
  std::set<LinkId> linksWithGeometry() const;
  bool hasObstacle(const std::string& name) const { return obstacle_names_.count(name) != 0; }

  /// Whether no joint lies between the two, links or what they carry, or one of these and an obstacle that stands
  /// still; and nobody has asked for the pair (disallow()).
  bool standStill(const ManagedBody& a, const ManagedBody& b) const;
  /// The excuse of two bodies that two links carry, neither of them empty.
  Excuse excuseOf(const ManagedBody& a, const ManagedBody& b) const;
  /// Whether two links are neighbours by the tree and the links that have geometry, with a joint between them, of
  /// which nobody says that they are to be checked.
  /// @param with_geometry  linksWithGeometry()
  bool areOpenNeighbours(const std::set<LinkId>& with_geometry, LinkId a, LinkId b) const;
  /// The findings of neighbours for the links as they are now; null: nobody looked.
  const NeighbourFindings* neighbours() const { return neighbours_.get(); }
  void setNeighbours(std::shared_ptr<const NeighbourFindings> findings) { neighbours_ = std::move(findings); }

  /// Whether the two can and must not touch.
  bool mayTouch(const ManagedBody& a, const ManagedBody& b) const {
    return !a.empty() && !b.empty() && !allowed_.allowed(a.name, b.name);
  }

  // The public manager's functions of the same names say what they throw.
  void registerObject(const ObjectRef<fcl::CollisionObjectd>& object, const std::string& name);
  void registerObject(const ObjectRef<fcl::ContinuousCollisionObjectd>& object, const std::string& name);
  void registerObjects(const std::vector<fcl::CollisionObjectd*>& objects);
  void replaceObstacles(const std::vector<std::shared_ptr<const fcl::CollisionObjectd>>& objects,
                        const std::vector<std::string>& names);
  void replaceObject(const std::string& name, const ObjectRef<fcl::CollisionObjectd>& object);
  /// A copy with the robot only. Allowed pairs and margins of obstacles' names stay behind.
  Registry withoutObstacles() const;
  /// @return whether a link carried it.
  bool unregisterObject(const fcl::CollisionObjectd* object);
  void unregisterObject(const fcl::ContinuousCollisionObjectd* object);
  void bind(const LinkRef& link, const ObjectRef<fcl::CollisionObjectd>& object, const Eigen::Isometry3d& offset);
  void unbind(const fcl::CollisionObjectd* object);
  void attach(const LinkRef& link, const fcl::CollisionObjectd* object, const Eigen::Isometry3d& offset,
              const std::vector<std::string>& touch_links);
  void detach(const fcl::CollisionObjectd* object);
  void clear();

  /// The things that reading again has changed.
  struct Changes {
    bool links = false, obstacles = false;
  };
  /// Reads what callers have changed in their own hands, geometry in place too: of all, or of the given ones.
  /// @throws std::invalid_argument where the tree is another one by now, and has not the links that carry geometry;
  ///   what reading throws. Nothing is changed then.
  Changes readAgain();
  Changes readAgain(const std::vector<const fcl::CollisionObjectd*>& objects);
  Changes readAgain(const fcl::ContinuousCollisionObjectd* object);

  void setMargin(const std::string& body, double margin);
  void setMargin(const std::string& a, const std::string& b, double margin);
  void resetMargins() { margins_.clear(); }
  /// The margins that were set, and those of neighbours that the rule has checked for touching.
  NamedMargins margins() const;
  /// The latter alone.
  NamedMargins marginsOfNeighbours() const;

  // The public manager's functions of the same names say what they throw.
  void setJointTolerances(const JointTolerance& all) { tolerances_.setAllJoints(all); }
  void setJointTolerance(const std::string& joint, const JointTolerance& tolerance);
  void setBaseTolerance(const PoseTolerance& tolerance) { tolerances_.setBase(tolerance); }
  void setObjectTolerance(const std::string& name, const PoseTolerance& tolerance) {
    requireObject(name, "setObjectTolerance");
    tolerances_.setObject(name, tolerance);
  }
  void setTimeTolerance(double time) { tolerances_.setTime(time); }
  void setObjectSpeed(const std::string& name, const ObjectSpeed& speed) {
    requireObject(name, "setObjectSpeed");
    tolerances_.setSpeed(name, speed);
  }
  void resetTolerances() { tolerances_.clear(); }
  const NamedTolerances& tolerances() const { return tolerances_; }

  /// @throws std::invalid_argument beginning with `what` where the robot has no such link.
  LinkId requireLink(const LinkRef& link, const std::string& what) const;

  /// @throws std::invalid_argument naming what is no link, obstacle or attached object; nothing is changed then.
  void setAllowed(AllowedCollisionMatrix matrix);
  void allow(const std::string& a, const std::string& b);
  void disallow(const std::string& a, const std::string& b);
  const AllowedCollisionMatrix& allowed() const { return allowed_; }
  void setProofs(std::shared_ptr<const LinkPairProofs> proofs) { proofs_ = std::move(proofs); }
  const std::shared_ptr<const LinkPairProofs>& proofs() const { return proofs_; }

 private:
  using Bodies = std::vector<ManagedBody>;
  bool sameLink(std::size_t a, std::size_t b) const {
    return a < links_.size() && b < links_.size() && links_[a].link == links_[b].link;
  }
  void requireNew(const void* object, const std::string& what) const;
  void requireLinks() const;
  void requireBody(const std::string& name, const std::string& what) const;
  void requireObject(const std::string& name, const std::string& what) const;
  std::string obstacleName(const std::string& name) const;
  ManagedBody newBody(const fcl::CollisionObjectd* object, const std::string& what) const;
  void addObstacle(Bodies& bodies, ManagedBody body);
  void forget(Bodies& bodies, Bodies::iterator body);
  /// Forgets margins and allowed pairs of other names. (An obstacle's margins and allowed pairs go with it: the next
  /// one of its name is another object.)
  void keepNames(const std::function<bool(const std::string& body)>& isKept);
  Changes readAgain(const std::vector<ManagedBody*>& bodies);

  std::shared_ptr<const KinematicTree> tree_;
  AllowedCollisionMatrix allowed_;
  std::shared_ptr<const LinkPairProofs> proofs_;  ///< null: none
  std::shared_ptr<const NeighbourFindings> neighbours_;
  Bodies links_, moving_, obstacles_;
  std::unordered_set<const void*> objects_;  ///< of all of these
  std::unordered_set<std::string> obstacle_names_;
  std::size_t named_ = 0;  ///< obstacles that were given a name so far
  NamedMargins margins_;
  NamedTolerances tolerances_;
};

}  // namespace fcl_artic
