// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "fcl_artic/clearance.h"
#include "fcl_artic/joint_motion.h"
#include "fcl_artic/link_pairs.h"
#include "fcl_artic/references.h"
#include "fcl_artic/request.h"
#include "fcl_artic/result.h"
#include "fcl_artic/tolerance_left.h"
#include "fcl_artic/trajectory.h"
#include "fcl_artic/tube.h"
#include "fcl_artic/visibility.h"

namespace fcl_artic {

/// Certified continuous collision detection of a forest of links against obstacles and against itself, in FCL's manager
/// idiom: register obstacles, bind geometry to links, call setup(), ask.
///
/// Lengths are in m, angles in rad; the time of a motion is t in [0, 1]. Roots of the tree stand at the world's origin
/// (KinematicTree). A wrong call throws and leaves the manager as it was: std::invalid_argument names the value,
/// std::logic_error asks for the setup() that is missing. A query never throws for what it finds: that is a Status.
///
/// Objects and geometries stay the caller's and are never written to; they must stay alive while they are registered
/// or bound (a shared_ptr sees to that: ObjectRef). registerObject() and bind() read geometry. If it has changed, also
/// in place, setup() and update() read it again: a shape's sizes, a mesh's vertices, an OcTree's cells or threshold.
/// Queries use what was read last.
///
/// After setup() all const members may be called from many threads at once. Members that are not const must not run
/// beside any other. A manager that was moved from may only be destroyed or assigned to.
class FCL_ARTIC_EXPORT ArticulatedCollisionManager {
 public:
  /// Creates a manager without obstacles and geometry. It shares ownership of the tree.
  /// @throws std::invalid_argument if tree is null.
  explicit ArticulatedCollisionManager(std::shared_ptr<const KinematicTree> tree);
  /// Releases the objects; those that the caller owns are not touched.
  ~ArticulatedCollisionManager();
  /// Takes over everything from another manager.
  ArticulatedCollisionManager(ArticulatedCollisionManager&&) noexcept;
  /// Takes over everything from another manager.
  ArticulatedCollisionManager& operator=(ArticulatedCollisionManager&&) noexcept;

  /// The tree of links and joints.
  const KinematicTree& tree() const;
  /// The tree of links and joints, shared.
  std::shared_ptr<const KinematicTree> sharedTree() const;

  /// Adds an obstacle that stands still at the object's own transform, in the world. Needs setup().
  /// @param object  a pointer, or a shared_ptr that keeps it alive until it is unregistered.
  /// @param name    unique among links and obstacles; empty: "obstacle<N>", N counting from 0.
  /// @throws std::invalid_argument for
  ///   - an object that is null, registered or bound already,
  ///   - a name that another obstacle or a link has,
  ///   - geometry of a type that is not known, without a triangle (an FCL model of points: use PointCloud) or vertex,
  ///     or not finite,
  ///   - a transform that is not rigid to 1e-6 or farther than 1e9 m away.
  void registerObject(const ObjectRef<fcl::CollisionObjectd>& object, const std::string& name = {});
  /// Adds obstacles that stand still, named "obstacle<N>": all of them or, if this throws, none. Needs setup().
  /// @throws std::invalid_argument as registerObject().
  void registerObjects(const std::vector<fcl::CollisionObjectd*>& objects);
  /// Removes an obstacle that stands still, also one that is attached to a link, with its allowed pairs and margins:
  /// the next obstacle of its name has none. Needs setup().
  /// @throws std::invalid_argument if it is not registered.
  void unregisterObject(const ObjectRef<fcl::CollisionObjectd>& object);

  /// Swaps the scene: takes these obstacles that stand still in place of all that there are, and makes that effective
  /// without setup(): all or, if this throws, nothing. All that was made of the robot stays as it is, and is not
  /// looked at again: it is setup() that finds geometry of links that was changed in place. Obstacles that move and
  /// attached objects stay. Allowed pairs and margins are here meant for names. If a name in `names` has some, they
  /// count for the object that has the name now. If an obstacle's name is not given again, its allowed pairs and
  /// margins go. (Changes that wait for setup() are made effective too.)
  /// @param objects  kept alive as long as they are registered; one that was there before, the same in all that
  ///   setup() compares, is not read again.
  /// @param names  one for each object, unique among links and obstacles; none: "obstacle<N>", N counting from 0.
  /// @throws std::invalid_argument as registerObject() and setup(), and for another number of names.
  void replaceObstacles(const std::vector<std::shared_ptr<const fcl::CollisionObjectd>>& objects,
                        const std::vector<std::string>& names = {});
  /// Returns a manager of the same robot: geometry bound to links, attached objects, allowed pairs of these, margins
  /// and proofs of pairs, without any obstacle that stands still or moves. Both share, for good, what setup() has made
  /// of the robot: trees of its meshes and tables of pairs of links. Changes of one are not seen by the other. So
  /// scenes or threads have a manager each at the cost of their obstacles. Stage 2 is at its defaults
  /// (setVisibility()). The objects must outlive both managers where only their pointers were given.
  /// @throws std::logic_error if setup() has not been called since the last change.
  [[nodiscard]] ArticulatedCollisionManager shareRobot() const;

  /// Returns a manager of the same robot and scene, with all that was set. Both share, for good, what setup() has made
  /// of geometry and of pairs of links; changes of one are not seen by the other. The copy needs setup(), or update()
  /// of no objects, which looks at no geometry again. A scene with one object changed costs that object, and lists
  /// of the others (LiveScene). Objects must outlive both managers where only their pointers were given.
  [[nodiscard]] ArticulatedCollisionManager copy() const;
  /// Puts another object in the place of an obstacle that stands still. It takes over the name, and with it allowed
  /// pairs, margins, tolerance and speed. Needs setup().
  /// @param name  of the obstacle.
  /// @param object  a pointer, or a shared_ptr that keeps it alive; the object that is there already is read again.
  /// @throws std::invalid_argument: no such obstacle; and as registerObject().
  void replaceObject(const std::string& name, const ObjectRef<fcl::CollisionObjectd>& object);

  /// Adds an obstacle that moves. The time of its motion is the query's, t in [0, 1] (for a trajectory, all of it),
  /// whatever the robot does. Links are checked against it as against any obstacle (CertifiedRequest::check_scene);
  /// obstacles are not checked against each other. The geometry may be unbounded. Needs setup().
  ///
  /// Object, geometry and motion must stay alive until it is unregistered; a shared_ptr sees to that. The motion is
  /// read by registerObject(), setup() and update(); a BoundedMotion is asked during queries too.
  /// @throws std::invalid_argument as for an obstacle that stands still, and for a motion that
  ///   fcl_artic::continuousCollide() refuses.
  void registerObject(const ObjectRef<fcl::ContinuousCollisionObjectd>& object, const std::string& name = {});
  /// Removes an obstacle that moves, with its allowed pairs and margins. Needs setup().
  /// @throws std::invalid_argument if it is not registered.
  void unregisterObject(const ObjectRef<fcl::ContinuousCollisionObjectd>& object);

  /// Fixes a geometry to a link; the object's own transform is not used. Needs setup().
  /// @param link    its LinkId, or its name.
  /// @param object  a pointer, or a shared_ptr that keeps it alive until it is unbound.
  /// @param offset  pose of the geometry's frame in the link's frame.
  /// @throws std::invalid_argument as registerObject(), and for an unknown link, unbounded geometry (Halfspace, Plane)
  ///   or an offset that is not rigid to 1e-6.
  void bind(const LinkRef& link, const ObjectRef<fcl::CollisionObjectd>& object,
            const Eigen::Isometry3d& offset = Eigen::Isometry3d::Identity());
  /// Removes a geometry from its link. Needs setup().
  /// @throws std::invalid_argument if it is bound to no link, or attached (use detach()).
  void unbind(const ObjectRef<fcl::CollisionObjectd>& object);

  /// Attaches a registered obstacle to a link, as a gripper picks it up: after the next setup() the link carries it. It
  /// keeps its name, and with it its allowed pairs and margins. It is checked against the rest of the scene and against
  /// all links, neighbours too, except the link that carries it and `touch_links`. Meanwhile it is no obstacle:
  /// getObjects() and size() leave it out, boundObjects() contains it.
  /// @param link    its LinkId, or its name.
  /// @param object  an obstacle that stands still.
  /// @param offset  pose of the geometry's frame in the link's frame; the object's own transform is not used.
  /// @param touch_links  names of further links that it may touch.
  /// @throws std::invalid_argument: not an obstacle that stands still, unbounded geometry, an unknown link, an offset
  ///   that is not rigid to 1e-6.
  void attach(const LinkRef& link, const ObjectRef<fcl::CollisionObjectd>& object, const Eigen::Isometry3d& offset,
              const std::vector<std::string>& touch_links = {});
  /// Puts an attached object down: it is an obstacle again, at the object's own transform. Needs setup().
  /// (unregisterObject() removes it altogether.)
  /// @throws std::invalid_argument if it is not attached, or for a transform or geometry that registerObject() refuses.
  void detach(const ObjectRef<fcl::CollisionObjectd>& object);

  /// Replaces the pairs that may touch, given by names of links, obstacles and attached objects. Needs setup(). A pair
  /// goes with its obstacle or attached object (unregisterObject()); one of two links stays.
  ///
  /// Two bodies that no joint moves against each other are not checked, unless disallow() has asked for the pair. Such
  /// bodies are links that fixed joints connect, what they carry, and an obstacle that stands still beside a link that
  /// does. notes() names the pairs that touch.
  ///
  /// Neighbours are links with one moving joint between them and no other link with geometry. (But a link that a
  /// planar or floating joint moves freely in the world is no neighbour of what stands still.) If the matrix neither
  /// allows neighbours nor has them checked (AllowedCollisionMatrix::mustBeChecked()), setup() decides. It finds out
  /// what they do over all values of the joint between them, as classifyLinkPairs() does of all pairs, once and with
  /// less work:
  /// - If geometries of theirs touch, or are too near to tell, at all tried values of the joint, as housings that
  ///   overlap in it, they are not checked. notes() names the links. Their other geometries are checked.
  /// - All others that touch nowhere, proven, or somewhere are checked, for touching. A request's margin and those of
  ///   the two bodies do not count for them, but only the pair's own (setMargin()) and what a request adds
  ///   (added_margin).
  /// - Neighbours of which it can't be decided are not checked, and are counted in each answer
  ///   (CertifiedResult::unproven_neighbours).
  /// @throws std::invalid_argument naming what is no link, obstacle or attached object; nothing is changed then.
  void setAllowedCollisions(AllowedCollisionMatrix matrix);
  /// Lets one more pair touch. Needs setup().
  /// @throws std::invalid_argument naming what is no link, obstacle or attached object.
  void allow(const std::string& a, const std::string& b);
  /// Has a pair checked again, also if the two are neighbours, or stand still against each other. Needs setup(). An
  /// attached object may touch the link that carries it and its `touch_links` all the same (attach()).
  /// @throws std::invalid_argument as allow().
  void disallow(const std::string& a, const std::string& b);
  /// The pairs that may touch, as set by setAllowedCollisions(), allow() and disallow(); what the rule for neighbours
  /// leaves out is not listed.
  const AllowedCollisionMatrix& allowedCollisions() const;
  /// Returns the findings of setup() of neighbours that the matrix neither allows nor has checked
  /// (setAllowedCollisions()), by the links' order in the tree.
  /// @throws std::logic_error if setup() or update() was not called after the last change.
  std::vector<LinkPairFinding> neighbours() const;
  /// Returns what is unusual about the world as it was set up, one line each:
  /// - pairs that touch, or can't be told apart, and stand still against each other;
  /// - neighbours that are not checked because they touch whatever the joint between them does;
  /// - neighbours of which that can't be decided.
  ///
  /// The pairs that stand still against each other are looked at when this is called.
  /// @throws std::logic_error if setup() or update() was not called after the last change.
  std::vector<std::string> notes() const;

  /// Finds out what pairs of links do over all values within their joints' limits: which never touch, proven; which
  /// always do; which do sometimes, with a configuration that shows it. All pairs of links with geometry are looked at,
  /// whether they are allowed or not; attached objects and obstacles are not. The manager itself stays as it is:
  /// setAllowedCollisions() and setLinkPairProofs() take what is found. It needs no setup(), and takes about 0.2 s for
  /// a Panda and some seconds for a humanoid.
  /// @throws std::invalid_argument for a margin that is negative or not finite, no samples, or a negative number of
  ///   threads; what `progress` throws.
  [[nodiscard]] LinkPairReport classifyLinkPairs(const LinkPairOptions& options = {}) const;
  /// Uses proofs of pairs that never touch. If the motion keeps within the joints' limits and the margin is no larger
  /// than the proof's, queries leave such a pair out. Otherwise they check it. A proof counts only for the very
  /// geometry, offsets and tree that it was made for; others do no harm. Needs setup().
  /// @param proofs  of classifyLinkPairs(), of this manager or another one; null: none.
  void setLinkPairProofs(std::shared_ptr<const LinkPairProofs> proofs);

  /// Sets a margin of the body's own. It replaces CertifiedRequest::margin for all pairs of the body, also where it is
  /// the smaller one; CertifiedRequest::added_margin is added to it too. If both bodies of a pair have one, the larger
  /// counts. Needs setup().
  /// @param body  name of a link (all of its geometry), an obstacle or an attached object, which the margin goes with
  ///   when it is unregistered.
  /// @param margin  m, finite, at least 0.
  /// @throws std::invalid_argument: no such name, margin negative or not finite.
  void setMargin(const std::string& body, double margin);
  /// Sets a margin of one pair's own, which replaces those of its bodies and of the request: for example 0 where a
  /// gripper has to get near. CertifiedRequest::added_margin is added to it. Needs setup().
  /// @param margin  m, finite, at least 0.
  /// @throws std::invalid_argument: no such name, margin negative or not finite.
  void setMargin(const std::string& a, const std::string& b, double margin);
  /// Forgets all margins of bodies and pairs. Needs setup().
  void resetMargins();

  /// Sets how far all joints may be from what a motion says, at each time: those that turn by `all.angle` rad, those
  /// that slide by `all.length` m. Joints with a tolerance of their own keep it; joints that mimic others follow them.
  /// Needs setup().
  ///
  /// Where a joint, the base or an object has a tolerance, `free` holds for every path within all tolerances
  /// (doc/PROMISE.md, "Tolerances"). So do all other answers of this manager, clearance() too.
  /// CertifiedContact::q_witness and the deviations beside it show a contact within them. Certificates state them
  /// (doc/TUBES.md).
  /// Method::redon2004 does not know them: it throws std::invalid_argument.
  /// @throws std::invalid_argument: a number that is negative or not finite.
  void setJointTolerances(const JointTolerance& all);
  /// Sets the tolerance of one joint, in place of that of all joints. Needs setup().
  /// @throws std::invalid_argument for
  ///   - an unknown joint, one that is fixed, one that mimics another,
  ///   - a length for a joint that does not slide, an angle for one that does not turn,
  ///   - a number that is negative or not finite.
  void setJointTolerance(const std::string& joint, const JointTolerance& tolerance);
  /// Sets how far the robot's base may be from the world's origin, where its roots stand: what calibration leaves. The
  /// pivot is a point of the world. Links are off against obstacles, not against each other. Needs setup().
  /// @throws std::invalid_argument: a number that is negative or not finite.
  void setBaseTolerance(const PoseTolerance& tolerance);
  /// Sets how far an obstacle, or an attached object, may be from the pose that it is said to have. Needs setup().
  /// @param name  of the object; its tolerance goes when it is unregistered.
  /// @throws std::invalid_argument: no such obstacle or attached object; a number that is negative or not finite.
  void setObjectTolerance(const std::string& name, const PoseTolerance& tolerance);
  /// Says how fast an obstacle may move by itself, in any direction, as a person does: `free` then holds wherever it
  /// goes at up to that speed. Its pose tolerance is added. (For an obstacle that moves: beside its motion. For an
  /// attached object: beside the link.) Certificates state it (doc/TUBES.md). Needs setup().
  /// @param name  of the object; its speed goes when it is unregistered.
  /// @throws std::invalid_argument: no such obstacle or attached object; a speed negative or not finite, a time not
  ///   finite.
  void setObjectSpeed(const std::string& name, const ObjectSpeed& speed);
  /// Sets how much earlier or later than the motion says the robot may be, against obstacles that have a motion of
  /// their own: `free` then holds for every shift of their time by up to that much. Before its motion begins, and after
  /// it ends, an obstacle stands. An object with a speed (ObjectSpeed) has as much longer to move. Needs setup(), which
  /// throws std::invalid_argument if nothing bounds an obstacle's speed. Certificates do not state it: a request for
  /// one throws std::invalid_argument.
  /// @param time  in the unit of the motion's time, s for most trajectories; a JointMotion takes 1. Finite, at least 0.
  /// @throws std::invalid_argument: a number that is negative or not finite.
  void setTimeTolerance(double time);
  /// Whether an object has a speed (setObjectSpeed()). Answers about motions then hold for these motions only, not for
  /// plans that are made of them: objects have longer to move meanwhile.
  bool hasSpeeds() const;
  /// Forgets the tolerances of joints, the base, objects and time, and the objects' speeds. Needs setup().
  void resetTolerances();
  /// Returns all tolerances in one line for people, as "joints 0.3 deg, base 2 mm"; empty if there is none.
  std::string describeTolerances() const;

  /// Selects the culler of stage 2, culling by visibility (CertifiedRequest::visibility); null: the CPU culler, which
  /// is the default. Effective at once.
  void setVisibility(std::shared_ptr<const VisibilityCuller> culler);

  /// Makes all changes effective. Needed before the first query, after every member that says so, and after the tree
  /// has grown; queries throw std::logic_error otherwise.
  ///
  /// It also looks for what callers have changed in place, which queries do not notice by themselves: geometry of
  /// links and obstacles, transforms and motions of obstacles. Each of these that is the same, byte for byte, is kept
  /// with all that was computed from it. To find that out takes as long as comparing all vertices and triangles and
  /// walking through OcTrees: 17 µs for 9 meshes of 1,800 triangles, 2 ms for one of 500,000. With large maps in the
  /// scene update(object) is cheaper. The first time, what is computed of each link's geometry and of each pair of
  /// links is computed on all cores.
  /// @throws std::invalid_argument as registerObject() and bind(), for what an object or the tree has become. The
  ///   manager then keeps what was read before, and what was set up stays in use.
  void setup();
  /// Has setup(), this time and from now on, compute beforehand what the first query by this method would: for
  /// Method::redon2004 each geometry's tree of oriented boxes. Needs setup().
  void prepareFor(Method method);
  /// Makes all changes effective, also those that callers have made in place: does what setup() does.
  /// @throws std::invalid_argument as setup().
  void update();
  /// Reads one object again, an obstacle or one that a link carries, and makes all changes effective.
  /// @throws std::invalid_argument as setup(), and if the object is neither registered nor bound.
  void update(const ObjectRef<fcl::CollisionObjectd>& object);
  /// Reads these objects again, obstacles or those that links carry, and makes all changes effective.
  /// @throws std::invalid_argument as setup(), and for an object that is neither registered nor bound.
  void update(const std::vector<fcl::CollisionObjectd*>& objects);
  /// Reads one obstacle that moves again, and makes all changes effective.
  /// @throws std::invalid_argument as setup(), and if the object is not registered.
  void update(const ObjectRef<fcl::ContinuousCollisionObjectd>& object);
  /// Removes all obstacles, bindings and attached objects. Allowed pairs and margins of links are kept. Needs setup().
  void clear();

  /// Lists the obstacles that stand still; attached objects are not among them.
  /// @param[out] objects  replaced.
  void getObjects(std::vector<const fcl::CollisionObjectd*>& objects) const;
  /// Lists the obstacles that move.
  /// @param[out] objects  replaced.
  void getObjects(std::vector<const fcl::ContinuousCollisionObjectd*>& objects) const;
  /// Returns all objects that links carry, bound or attached, each with its link.
  std::vector<std::pair<LinkId, const fcl::CollisionObjectd*>> boundObjects() const;
  /// Returns the pairs of what links carry that queries check against each other (CertifiedRequest::check_self). Each
  /// pair is there once, as names of two links, of a link and an attached object or of two attached objects. All
  /// others are allowed, neighbours that touch (setAllowedCollisions()), or stand still against each other.
  /// @throws std::logic_error if setup() or update() was not called after the last change.
  std::vector<std::pair<std::string, std::string>> checkedLinkPairs() const;
  /// Returns the pose of a bound or attached geometry's frame in its link's frame.
  /// @throws std::invalid_argument if no link carries the object.
  Eigen::Isometry3d boundOffset(const ObjectRef<fcl::CollisionObjectd>& object) const;
  /// Number of obstacles, moving ones included; attached objects are not.
  std::size_t size() const;
  /// Whether there is no obstacle.
  bool empty() const { return size() == 0; }

  /// Finds the first contact of a motion, or proves that there is none (doc/PROMISE.md).
  ///
  /// If it throws, whatever it is, the result claims nothing: it is reset to `undecided` with t_lower at the motion's
  /// begin and no contacts. (A callback sees it like that while the query runs.)
  /// @param motion  over t in [0, 1], made for tree() or one with the same joint variables (JointMotion::isOf()).
  /// @param[out] result  written in full; its memory is used again.
  /// @throws std::invalid_argument if the motion is of other joint variables, for tolerances that are not positive
  ///   numbers, and for margins that are negative or not finite.
  /// @throws std::logic_error if setup() or update() was not called after the last change, of the tree too.
  void continuousCollide(const JointMotion& motion, const CertifiedRequest& request, CertifiedResult& result) const;
  /// Finds the first contact of a motion, or proves that there is none (doc/PROMISE.md), and returns the answer. (In a
  /// loop the form with `result` is a little faster.)
  /// @param motion  over t in [0, 1], made for tree() or one with the same joint variables (JointMotion::isOf()).
  /// @throws std::invalid_argument, std::logic_error as the form with `result`.
  [[nodiscard]] CertifiedResult continuousCollide(const JointMotion& motion,
                                                  const CertifiedRequest& request = {}) const;
  /// Finds the first contact on the straight way from q0 to q1 in joint space (JointMotion::linear()), or proves that
  /// there is none.
  /// @param q0, q1  tree().dof() joint values each, rad or m.
  /// @throws std::invalid_argument, std::logic_error as for a motion, and as JointMotion::linear().
  [[nodiscard]] CertifiedResult continuousCollide(const Eigen::VectorXd& q0, const Eigen::VectorXd& q1,
                                                  const CertifiedRequest& request = {}) const;
  /// Whether the straight way from q0 to q1 in joint space is proven free: the fastest question. False also if contact
  /// can't be excluded within the tolerances, and if the work budget ran out. True says nothing of pairs that are not
  /// checked: allowed ones and neighbours without a proof, and with ignore_initial_contact those that never come apart
  /// (exceptionsOf() a full answer).
  /// @param q0, q1  tree().dof() joint values each, rad or m.
  /// @param request  its mode is not used: any contact ends the search (ContactMode::any).
  /// @throws std::invalid_argument, std::logic_error as continuousCollide().
  [[nodiscard]] bool isFree(const Eigen::VectorXd& q0, const Eigen::VectorXd& q1,
                            const CertifiedRequest& request = {}) const;
  /// Whether a motion is proven free: the fastest question. False also if contact can't be excluded within the
  /// tolerances, and if the work budget ran out. True says nothing of pairs that are not checked: allowed ones, and
  /// with ignore_initial_contact those that never come apart (exceptionsOf() a full answer).
  /// @param request  its mode is not used: any contact ends the search (ContactMode::any).
  /// @throws std::invalid_argument, std::logic_error as continuousCollide().
  [[nodiscard]] bool isFree(const JointMotion& motion, const CertifiedRequest& request = {}) const;

  /// Finds the first contacts of many motions on several threads. Result i is what motion i gets by itself, bit for
  /// bit, except for measured times and the work of stage 2.
  /// @param request  `progress` is not called.
  /// @param[out] results  resized to the number of motions; its memory is used again.
  /// @param threads  maximum number of threads; 0: as many as the machine runs at once.
  /// @throws std::invalid_argument, std::logic_error as for one motion, naming a motion that is of other joint
  ///   variables, and for a negative number of threads. All results are reset then.
  void continuousCollide(const std::vector<JointMotion>& motions, const CertifiedRequest& request,
                         std::vector<CertifiedResult>& results, int threads = 0) const;

  /// Finds the first contact of a whole trajectory, or proves that there is none.
  ///
  /// All times are the trajectory's own: the request's tolerance_time and progress, t_lower and t_upper of the result
  /// and of its contacts. Both ends are rounded outward, so that t_upper - t_lower may exceed tolerance_time by 4 ulp
  /// of the times and 8 ulp of a piece's duration (1e-6 s at 1.7e9 s, where doubles are 2.4e-7 s apart). Obstacles that
  /// move take as long as the trajectory.
  ///
  /// With ignore_initial_contact, pairs that touch at the trajectory's begin may separate. Each is watched from the
  /// moment it has (found in steps of 1/512 of a piece at most) and is not ignored again. A pair that separates for a
  /// shorter time may be taken as never apart. With ContactMode::firstOfEveryPair, a budget that ends after a contact
  /// leaves the answer undecided, with the contacts found so far.
  /// @param trajectory  made for tree() or one with the same joint variables.
  /// @param[out] result  written in full; reset (undecided, t_lower at the trajectory's begin) if this throws.
  /// @throws std::invalid_argument, std::logic_error as for a motion.
  void continuousCollide(const JointTrajectory& trajectory, const CertifiedRequest& request,
                         CertifiedResult& result) const;
  /// Finds the first contact of a whole trajectory, in the trajectory's own time, or proves that there is none, and
  /// returns the answer.
  /// @param trajectory  made for tree() or one with the same joint variables.
  /// @throws std::invalid_argument, std::logic_error as the form with `result`.
  [[nodiscard]] CertifiedResult continuousCollide(const JointTrajectory& trajectory,
                                                  const CertifiedRequest& request = {}) const;

  /// Finds what touches while the links stand still at one configuration. (Obstacles that move do so all the same.)
  /// @param q  tree().dof() joint values, rad or m.
  /// @param[out] result  written in full; reset if this throws. Without moving obstacles a contact is at t_lower = 0.
  /// @throws std::invalid_argument, std::logic_error as continuousCollide() from q to q.
  void collide(const Eigen::VectorXd& q, const CertifiedRequest& request, CertifiedResult& result) const;
  /// Finds what touches while the links stand still at one configuration, and returns the answer. (Obstacles that move
  /// do so all the same. Without them a contact is at t_lower = 0.)
  /// @param q  tree().dof() joint values, rad or m.
  /// @throws std::invalid_argument, std::logic_error as continuousCollide() from q to q.
  [[nodiscard]] CertifiedResult collide(const Eigen::VectorXd& q, const CertifiedRequest& request = {}) const;

  /// Finds the smallest distance of any checked pair over a whole motion, proven from below and from above, with the
  /// pair and the time at which it is nearly reached. It is the distance of the bodies themselves, whatever margins are
  /// set. Pairs that are near by construction limit it: allow them, or ask without check_self.
  /// @throws std::invalid_argument if the motion is of other joint variables, and for values of the request that are
  ///   out of range (ClearanceRequest).
  /// @throws std::logic_error as continuousCollide().
  [[nodiscard]] Clearance clearance(const JointMotion& motion, const ClearanceRequest& request = {}) const;
  /// Finds the smallest distance of any checked pair over a whole trajectory, proven from below and from above. It
  /// comes with the pair and the time, the trajectory's own, at which it is nearly reached. Margins that are set do
  /// not count.
  /// @throws std::invalid_argument, std::logic_error as for a motion.
  [[nodiscard]] Clearance clearance(const JointTrajectory& trajectory, const ClearanceRequest& request = {}) const;

  /// Finds how many times all tolerances together may be as large, so that the motion is still free (ToleranceLeft),
  /// with the pair and the time that limit it. Margins count.
  /// @throws std::invalid_argument if the motion is of other joint variables, and for values of the request that are
  ///   out of range (ToleranceLeftRequest).
  /// @throws std::logic_error as continuousCollide(), and where no tolerance is set.
  [[nodiscard]] ToleranceLeft toleranceLeft(const JointMotion& motion, const ToleranceLeftRequest& request = {}) const;
  /// Finds how many times all tolerances together may be as large, so that the trajectory is still free. It comes with
  /// the pair and the time, the trajectory's own, that limit it.
  /// @throws std::invalid_argument, std::logic_error as for a motion.
  [[nodiscard]] ToleranceLeft toleranceLeft(const JointTrajectory& trajectory,
                                            const ToleranceLeftRequest& request = {}) const;

  /// Drops points that a sensor has seen of the robot itself. These lie in or within `padding` of the geometry that
  /// links carry at q, attached objects included; obstacles do not count. A mesh is its surface, unless it is a solid.
  /// The others keep their order.
  ///
  /// It is certain that no point farther than `padding` is dropped, if the padding is more than twice the links' error
  /// by rounding. For an arm that is some 1e-12 m (doc/NUMERICS.md, "Points on the robot"). A point that is nearer may
  /// stay: by no more than that error, or where a search for the nearest point of a hull, cone or ellipsoid ends early.
  /// @param points  in m; what is not finite stays.
  /// @param q       tree().dof() joint values, rad or m.
  /// @param padding  m, at least 0: how far sensor and model err.
  /// @param frame   pose of the points' frame in the world.
  /// @return how many were dropped.
  /// @throws std::invalid_argument as collide(), for another padding, and for a frame that is not rigid to 1e-6.
  /// @throws std::logic_error as collide().
  std::size_t removeSelf(std::vector<Eigen::Vector3d>& points, const Eigen::VectorXd& q, double padding = 0,
                         const Eigen::Isometry3d& frame = Eigen::Isometry3d::Identity()) const;
  /// Returns for each point whether removeSelf() would drop it: 1, or 0.
  /// @throws std::invalid_argument, std::logic_error as removeSelf().
  [[nodiscard]] std::vector<std::uint8_t> pointsOnSelf(
      const std::vector<Eigen::Vector3d>& points, const Eigen::VectorXd& q, double padding = 0,
      const Eigen::Isometry3d& frame = Eigen::Isometry3d::Identity()) const;

  /// Returns the query continuousCollide(motion, request) as text in JSON: robot, geometry, obstacles, allowed pairs,
  /// margins, motion and request. readQuery() (fcl_artic/query_text.h) reads the text, also in another process, and the
  /// query is answered with the same bits on processors with the same instructionSet(). The text leaves `progress` and
  /// setVisibility() out.
  /// @throws std::invalid_argument naming the object, for
  ///   - an obstacle that moves as a BoundedMotion says,
  ///   - an object that has changed since setup(),
  ///   - a rotation or axis that would be rounded once more when it is read (one of 60,000),
  ///   - a name that is not in UTF-8;
  ///
  ///   and if the motion is of other joint variables.
  /// @throws std::logic_error as continuousCollide().
  /// @throws std::runtime_error if the library was built without nlohmann-json.
  [[nodiscard]] std::string writeQuery(const JointMotion& motion, const CertifiedRequest& request = {}) const;
  /// Returns the query continuousCollide(trajectory, request) as text in JSON.
  /// @throws as for a motion.
  [[nodiscard]] std::string writeQuery(const JointTrajectory& trajectory, const CertifiedRequest& request = {}) const;

 private:
  struct Impl;
  struct QueryContext;
  friend class Guard;
  struct MotionQueries;
  void collideMotion(const JointMotion& motion, const CertifiedRequest& request, CertifiedResult& result) const;
  void collideMotion(const JointMotion& motion, const CertifiedRequest& request, const QueryContext& context,
                     CertifiedResult& result) const;
  void collideTrajectory(const JointTrajectory& trajectory, const CertifiedRequest& request,
                         const QueryContext& context, CertifiedResult& result) const;
  MotionQueries queriesOf(const JointMotion& motion) const;
  MotionQueries queriesOf(const JointTrajectory& trajectory) const;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fcl_artic
