// SPDX-License-Identifier: BSD-3-Clause
//
// What callers told the manager: the robot, geometry bound to its links, obstacles, allowed pairs and margins. Every
// change is checked here, and one that throws changes nothing. What is made of it for queries is the Setup's.
#pragma once

#include <memory>
#include <string>
#include <unordered_set>
#include <vector>

#include "fcl_artic/manager.h"
#include "query/managed_body.h"
#include "query/margins.h"

namespace fcl_artic {

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

  /// Whether the two can and must not touch.
  bool mayTouch(const ManagedBody& a, const ManagedBody& b) const {
    return !a.empty() && !b.empty() && !allowed.allowed(a.name, b.name);
  }

  // The public manager's functions of the same names tell what they throw.
  void registerObject(fcl::CollisionObjectd* object, const std::string& name);
  void registerObject(fcl::ContinuousCollisionObjectd* object, const std::string& name);
  void registerObjects(const std::vector<fcl::CollisionObjectd*>& objects);
  /// @return whether a link carried it.
  bool unregisterObject(fcl::CollisionObjectd* object);
  void unregisterObject(fcl::ContinuousCollisionObjectd* object);
  void bind(LinkId link, fcl::CollisionObjectd* object, const Eigen::Isometry3d& offset);
  void unbind(fcl::CollisionObjectd* object);
  void attach(LinkId link, fcl::CollisionObjectd* object, const Eigen::Isometry3d& offset,
              const std::vector<std::string>& touch_links);
  void detach(fcl::CollisionObjectd* object);
  void clear();

  /// What reading again has changed.
  struct Changes {
    bool links = false, obstacles = false;
  };
  /// Reads what callers have changed in their own hands, geometry in place too: of all, or of the given ones.
  Changes readAgain();
  Changes readAgain(const std::vector<fcl::CollisionObjectd*>& objects);
  Changes readAgain(fcl::ContinuousCollisionObjectd* object);

  void setMargin(const std::string& body, double margin);
  void setMargin(const std::string& a, const std::string& b, double margin);
  void resetMargins() { margins_.clear(); }
  const NamedMargins& margins() const { return margins_; }

  /// @throws std::invalid_argument beginning with `what` where the robot has no such link.
  LinkId requireLink(const std::string& name, const std::string& what) const;

  /// @throws std::invalid_argument where the tree is another one by now, and has not the links that carry geometry.
  void requireLinks() const;

  AllowedCollisionMatrix allowed;

 private:
  using Bodies = std::vector<ManagedBody>;
  void requireNew(const void* object, const std::string& what) const;
  void requireLink(LinkId link, const std::string& what) const;
  void requireBody(const std::string& name) const;
  std::string obstacleName(const std::string& name) const;
  ManagedBody newBody(fcl::CollisionObjectd* object, const std::string& what) const;
  void addObstacle(Bodies& bodies, ManagedBody body);
  void forget(Bodies& bodies, Bodies::iterator body);
  Changes readAgain(const std::vector<ManagedBody*>& bodies);

  std::shared_ptr<const KinematicTree> tree_;
  Bodies links_, moving_, obstacles_;
  std::unordered_set<const void*> objects_;  ///< of all of these
  std::unordered_set<std::string> obstacle_names_;
  std::size_t named_ = 0;  ///< obstacles that were given a name so far
  NamedMargins margins_;
};

}  // namespace fcl_artic
