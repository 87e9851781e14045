// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "fcl_artic/clearance.h"
#include "fcl_artic/joint_motion.h"
#include "fcl_artic/request.h"
#include "fcl_artic/result.h"
#include "fcl_artic/trajectory.h"
#include "fcl_artic/visibility.h"

namespace fcl_artic {

/// Pairs of names (links, obstacles, attached objects) that may touch: they are not checked.
class FCL_ARTIC_EXPORT AllowedCollisionMatrix {
 public:
  void allow(const std::string& a, const std::string& b) { pairs_.insert(key(a, b)); }
  void disallow(const std::string& a, const std::string& b) { pairs_.erase(key(a, b)); }
  bool allowed(const std::string& a, const std::string& b) const { return pairs_.count(key(a, b)) != 0; }
  const std::set<std::pair<std::string, std::string>>& pairs() const { return pairs_; }

 private:
  static std::pair<std::string, std::string> key(const std::string& a, const std::string& b) {
    return a < b ? std::make_pair(a, b) : std::make_pair(b, a);
  }
  std::set<std::pair<std::string, std::string>> pairs_;
};

/// Certified continuous collision detection of a forest of links against obstacles and against itself, in FCL's
/// manager idiom. Objects and geometries stay the caller's and are never written to. Their geometry is read when they
/// are registered or bound, and by setup() and update() wherever it is not what was read before, also where it was
/// changed in place: a shape's sizes, a mesh's vertices, an OcTree's cells or threshold. Queries go by what was read.
///
/// After setup() all const members may be called from many threads at once.
class FCL_ARTIC_EXPORT ArticulatedCollisionManager {
 public:
  /// @throws std::invalid_argument when tree is null.
  explicit ArticulatedCollisionManager(std::shared_ptr<const KinematicTree> tree);
  ~ArticulatedCollisionManager();
  ArticulatedCollisionManager(ArticulatedCollisionManager&&) noexcept;
  ArticulatedCollisionManager& operator=(ArticulatedCollisionManager&&) noexcept;

  const KinematicTree& tree() const;
  std::shared_ptr<const KinematicTree> sharedTree() const;

  /// Adds an obstacle that stands still at its own transform. An empty name becomes "obstacle<N>".
  /// @throws std::invalid_argument: null, registered or bound already, a name that another obstacle or a link has,
  ///   geometry that is unsupported, empty, degenerate (no triangle) or not finite.
  void registerObject(const fcl::CollisionObjectd* object, const std::string& name = {});
  /// The same, and the manager keeps the object alive as long as it is registered.
  void registerObject(std::shared_ptr<const fcl::CollisionObjectd> object, const std::string& name = {});
  /// Adds obstacles named "obstacle<N>", all or none of them.
  /// @throws std::invalid_argument as registerObject().
  void registerObjects(const std::vector<fcl::CollisionObjectd*>& objects);
  /// @throws std::invalid_argument when it is not registered.
  void unregisterObject(const fcl::CollisionObjectd* object);

  /// Adds an obstacle that moves: its motion's time is the query's, t in [0, 1], whatever the robot does. Links are
  /// checked against it as against any obstacle (CertifiedRequest::check_scene); obstacles are not checked against each
  /// other. The geometry may be unbounded. Object, geometry and motion must outlive the manager's use of them; the
  /// motion is read by registerObject(), setup() and update(); a BoundedMotion is asked in queries too.
  /// @throws std::invalid_argument as above, and for a motion that fcl_artic::continuousCollide refuses.
  void registerObject(const fcl::ContinuousCollisionObjectd* object, const std::string& name = {});
  void unregisterObject(const fcl::ContinuousCollisionObjectd* object);

  /// Fixes a geometry to a link; the object's own transform is not used.
  /// @param offset  geometry frame in the link's frame.
  /// @throws std::invalid_argument as registerObject(), and for an unknown link or an offset that is not rigid.
  void bind(LinkId link, const fcl::CollisionObjectd* object,
            const Eigen::Isometry3d& offset = Eigen::Isometry3d::Identity());
  void bind(const std::string& link, const fcl::CollisionObjectd* object,
            const Eigen::Isometry3d& offset = Eigen::Isometry3d::Identity());
  /// The same, and the manager keeps the object alive as long as it is bound.
  void bind(LinkId link, std::shared_ptr<const fcl::CollisionObjectd> object,
            const Eigen::Isometry3d& offset = Eigen::Isometry3d::Identity());
  void bind(const std::string& link, std::shared_ptr<const fcl::CollisionObjectd> object,
            const Eigen::Isometry3d& offset = Eigen::Isometry3d::Identity());
  /// Takes the geometry off its link.
  /// @throws std::invalid_argument when it is bound to no link, or attached (detach() it).
  void unbind(const fcl::CollisionObjectd* object);

  /// Takes a registered obstacle up, as a gripper does: from the next setup() on the link carries it. It keeps its
  /// name, and with it what is allowed of it; all other links but `touch_links` are checked against it, neighbours too,
  /// and so is the rest of the scene. It is no obstacle meanwhile: getObjects() and size() leave it out, boundObjects()
  /// has it.
  /// @param offset  geometry frame in the link's frame; the object's own transform is not used.
  /// @param touch_links  links that it may touch; the link that carries it always may.
  /// @throws std::invalid_argument: not an obstacle that stands still, unbounded, an unknown link, an offset that is
  ///   not rigid.
  void attach(LinkId link, const fcl::CollisionObjectd* object, const Eigen::Isometry3d& offset,
              const std::vector<std::string>& touch_links = {});
  void attach(const std::string& link, const fcl::CollisionObjectd* object, const Eigen::Isometry3d& offset,
              const std::vector<std::string>& touch_links = {});
  /// Puts it down: an obstacle again, where the object's own transform says. (unregisterObject() removes it, attached
  /// or not.)
  /// @throws std::invalid_argument when it is not attached, or for its transform.
  void detach(const fcl::CollisionObjectd* object);

  /// Pairs that may touch, by link and obstacle name. Neighbours may always touch: links with one moving joint at most
  /// between them, and no other link with geometry; but what a planar or floating joint moves about in the world is no
  /// neighbour of what stands still. (Others that are rigidly attached are checked: allow them where they touch by
  /// construction.)
  /// @throws std::invalid_argument naming what is no link, obstacle or attached object; nothing is changed then.
  void setAllowedCollisions(AllowedCollisionMatrix matrix);
  /// The pair may touch from now on, beside those of setAllowedCollisions().
  /// @throws std::invalid_argument naming what is no link, obstacle or attached object.
  void allow(const std::string& a, const std::string& b);
  /// The pair is checked again (neighbours still are not).
  /// @throws std::invalid_argument as allow().
  void disallow(const std::string& a, const std::string& b);
  const AllowedCollisionMatrix& allowedCollisions() const;

  /// A margin of the body's own, in m, in place of CertifiedRequest::margin, for all pairs that it belongs to
  /// (CertifiedRequest::added_margin is added to it too). Of two bodies that both have one the larger counts.
  /// @param body  a link (all of its geometry), an obstacle or an attached object, by name. The margin belongs to the
  ///   name: it waits for an obstacle that is unregistered to come back.
  /// @throws std::invalid_argument: no such name, margin negative or not finite.
  void setMargin(const std::string& body, double margin);
  /// The same for one pair, whatever the margins of its bodies and of the request: 0 where a gripper has to get near.
  void setMargin(const std::string& a, const std::string& b, double margin);
  /// Forgets all margins of bodies and pairs.
  void resetMargins();

  /// Who does stage 2 (CertifiedRequest::visibility) from now on; null: the executor cpu again, as at first. What
  /// `automatic` has measured is forgotten.
  void setVisibility(std::shared_ptr<const VisibilityCuller> culler);

  /// Makes all changes effective; needed before the first query and after register, bind, allow or setMargin. Reads all
  /// that callers may have changed of their objects: the geometry that links carry and that of obstacles, transforms
  /// and motions of obstacles. What is the same, byte for byte, stays as it is, with all that was made of it; finding
  /// that out takes as long as comparing all vertices and triangles and walking through OcTrees does: 17 us for 9
  /// meshes of 1,800 triangles, 2 ms for one of 500,000. With large maps in the scene update(object) is cheaper.
  /// @throws std::invalid_argument as registerObject() and bind(), for what an object or the tree has become. Nothing
  ///   that was read is changed then; what was set up stays in use.
  void setup();
  /// The same as setup().
  void update();
  /// Reads these objects only, obstacles or what links carry, and makes all changes effective.
  /// @throws std::invalid_argument also for an object that is not there.
  void update(const fcl::CollisionObjectd* object);
  void update(const std::vector<fcl::CollisionObjectd*>& objects);
  void update(const fcl::ContinuousCollisionObjectd* object);
  /// Removes all obstacles and all bindings.
  void clear();

  /// The obstacles that stand still.
  void getObjects(std::vector<const fcl::CollisionObjectd*>& objects) const;
  /// Those that move.
  void getObjects(std::vector<const fcl::ContinuousCollisionObjectd*>& objects) const;
  /// Geometry that links carry, attached objects included.
  std::vector<std::pair<LinkId, const fcl::CollisionObjectd*>> boundObjects() const;
  /// Pose of a bound geometry's frame in its link's frame.
  Eigen::Isometry3d boundOffset(const fcl::CollisionObjectd* object) const;
  /// Number of obstacles, moving ones included.
  std::size_t size() const;
  bool empty() const { return size() == 0; }

  /// First contact of the motion, or the proof that there is none (doc/PROMISE.md).
  ///
  /// A query that throws, whatever it is, claims nothing: its result is reset, to `undecided` with t_lower at the
  /// beginning of the motion and no contacts. (So is it while the query runs, for callbacks that look.)
  /// @throws std::invalid_argument when the motion is not one of this tree's joint variables (JointMotion::isOf()), for
  ///   a tolerance that is not a positive number (0 is none), and a margin that is negative or not finite.
  /// @throws std::logic_error when changes were made after the last setup() or update(), of the tree too.
  void continuousCollide(const JointMotion& motion, const CertifiedRequest& request, CertifiedResult& result) const;
  /// The same, answer returned. (In a loop the form with `result` is a little faster: it uses its memory again.)
  [[nodiscard]] CertifiedResult continuousCollide(const JointMotion& motion,
                                                  const CertifiedRequest& request = {}) const;
  /// The first contact on the straight way from q0 to q1 in joint space (JointMotion::linear), or the proof that there
  /// is none.
  /// @param q0, q1  tree().dof() joint values each, rad or m.
  /// @throws as above, and as JointMotion::linear().
  [[nodiscard]] CertifiedResult continuousCollide(const Eigen::VectorXd& q0, const Eigen::VectorXd& q1,
                                                  const CertifiedRequest& request = {}) const;
  /// Whether the straight way from q0 to q1 is proven free: the fastest question (ContactMode::any in place of the
  /// request's mode). False also where contact can't be told from none, and when the work budget ran out.
  /// @throws as continuousCollide().
  [[nodiscard]] bool isFree(const Eigen::VectorXd& q0, const Eigen::VectorXd& q1,
                            const CertifiedRequest& request = {}) const;
  /// The same of any motion.
  [[nodiscard]] bool isFree(const JointMotion& motion, const CertifiedRequest& request = {}) const;

  /// First contacts of many motions, over threads: result i is the answer to motion i, bit for bit the one that it gets
  /// by itself (but for measured times). The request's `progress` is not called.
  /// @param[out] results  resized; what is in them is used as memory.
  /// @param threads  at most so many; 0: as many as the machine runs at once.
  /// @throws as above, naming the motion that is not of this tree; all results are reset then.
  void continuousCollide(const std::vector<JointMotion>& motions, const CertifiedRequest& request,
                         std::vector<CertifiedResult>& results, int threads = 0) const;

  /// First contact of a whole trajectory, or the proof that there is none, in its time: t_lower, t_upper, those of the
  /// contacts, tolerance_time and progress are in the unit of its times, and free means all of it. Both ends are
  /// rounded outward: by that t_upper - t_lower may exceed tolerance_time by 4 ulp of the times and 8 of a piece's
  /// duration (1e-6 s at 1.7e9 s, where doubles are 2.4e-7 s apart). With ignore_initial_contact pairs that touch at
  /// its beginning may separate; they are watched from the moment they have (in steps of 1/512 of a piece at most) and
  /// not ignored again. A pair that separates for less time than that may be taken as never apart. The motions of
  /// obstacles that move take as long as the trajectory. With ContactMode::firstOfEveryPair a budget that ends after a
  /// contact leaves the answer undecided, with the contacts so far.
  /// @throws as for a motion.
  void continuousCollide(const JointTrajectory& trajectory, const CertifiedRequest& request,
                         CertifiedResult& result) const;
  /// The same, answer returned.
  [[nodiscard]] CertifiedResult continuousCollide(const JointTrajectory& trajectory,
                                                  const CertifiedRequest& request = {}) const;

  /// What touches at one configuration that stands still: t_lower is 0 then, else the answer is free.
  /// @param q  tree().dof() joint values, rad or m.
  /// @throws as continuousCollide().
  void collide(const Eigen::VectorXd& q, const CertifiedRequest& request, CertifiedResult& result) const;
  /// The same, answer returned.
  [[nodiscard]] CertifiedResult collide(const Eigen::VectorXd& q, const CertifiedRequest& request = {}) const;

  /// The smallest distance of any checked pair over the whole motion, proven from below and from above, with the pair
  /// and the time at which it is nearly reached. It is the distance of the bodies themselves, whatever margins are set.
  /// (Pairs that are near by construction cap it; take them out by allowing them, or ask without check_self.)
  /// @throws std::invalid_argument as continuousCollide(), and for tolerances or `most` out of range.
  /// @throws std::logic_error as continuousCollide().
  [[nodiscard]] Clearance clearance(const JointMotion& motion, const ClearanceRequest& request = {}) const;
  [[nodiscard]] Clearance clearance(const JointTrajectory& trajectory, const ClearanceRequest& request = {}) const;

 private:
  struct Impl;
  struct Aspects;
  void collideMotion(const JointMotion& motion, const CertifiedRequest& request, CertifiedResult& result) const;
  void collideMotion(const JointMotion& motion, const CertifiedRequest& request, const Aspects& aspects,
                     CertifiedResult& result) const;
  void collideTrajectory(const JointTrajectory& trajectory, const CertifiedRequest& request, bool own_margins,
                         CertifiedResult& result) const;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fcl_artic
