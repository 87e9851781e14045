// SPDX-License-Identifier: BSD-3-Clause
//
// Component `tesseract`: a continuous contact manager for tesseract that proves its answers.
#pragma once

#include <memory>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include <tesseract/collision/contact_managers_plugin_factory.h>
#include <tesseract/collision/continuous_contact_manager.h>
#include <tesseract/common/collision_margin_data.h>

#include "fcl_artic/export.h"
#include "fcl_artic/request.h"
#include "fcl_artic/result.h"

namespace fcl_artic {

/// Options of a TesseractContactManager; the plug-in's `config` has them by these names.
struct TesseractOptions {
  Tolerances tolerances;  ///< `tolerance_time` and `tolerance_distance`; margins are tesseract's.
  /// Whether ContactTestType::FIRST takes any contact that can be proven soon (ContactMode::any) in place of the first
  /// one in time: cheaper, and as certain. The time of the contact is then one at which it is proven.
  bool any_contact = false;
};

/// tesseract's ContinuousContactManager with certified answers: contactTest() finds no contact only if it is proven
/// that no checked pair comes within its margin at any time between the two poses.
///
/// Between pose1 and pose2 of a moving object, the origin of its frame goes straight at constant velocity. The object
/// turns about a fixed axis at constant speed, the shortest way. All objects move at the same time, t in [0, 1].
/// (Objects with one pose stand still.) tesseract's own managers take another body: for each object the convex hull of
/// its shape at pose1 and at pose2. That hull is more than what is swept where both objects move, as the two need not
/// be there at the same time, and less where the object turns.
///
/// A contact that is reported is the first in time. ContactTestType says how many there are:
/// - ALL, LIMITED: one for each pair of links; if one of them stands still, one for each of its shapes;
/// - CLOSEST: one for each pair of links;
/// - FIRST: one at all.
///
/// Its cc_time is the time of first contact, its distance the distance then, 0 to the margin. Nothing is penetrated at
/// first contact, so that there is no depth for optimizers to go down. Nearest points and normal are those at that
/// time.
///
/// Margins below 0 count as 0. Shapes are those of tesseract's FCL manager: box, sphere, cylinder, cone, capsule, plane
/// (as a surface), mesh (as a surface), convex mesh, compound mesh, and octree with boxes.
///
/// As with tesseract's managers, each thread takes a clone().
class FCL_ARTIC_EXPORT TesseractContactManager : public ::tesseract::collision::ContinuousContactManager {
 public:
  using ObjectId = ::tesseract::common::LinkId;  ///< tesseract's name of an object.

  /// Creates a manager without objects.
  /// @throws std::invalid_argument for tolerances that are not positive numbers.
  explicit TesseractContactManager(std::string name = "FclArticContactManager", const TesseractOptions& options = {});
  /// Releases the objects.
  ~TesseractContactManager() override;

  /// The name given to the constructor.
  std::string getName() const override;
  /// Makes a manager with the same objects, poses, margins and validator. Geometries are shared.
  UPtr clone() const override;

  /// Adds an object, in place of one with this id. It stands at the identity. It is active where the one whose place it
  /// takes was; with tesseract's own managers it is not, and stands still until setActiveCollisionObjects().
  /// @return false for no shapes, or another number of poses.
  /// @throws std::invalid_argument naming the object, for a geometry that is not supported (polygon mesh, signed
  ///   distance field, octree of spheres), or empty.
  bool addCollisionObject(const ObjectId& id, const int& mask_id,
                          const ::tesseract::collision::CollisionShapesConst& shapes,
                          const ::tesseract::common::VectorIsometry3d& shape_poses, bool enabled = true) override;
  /// The shapes of an object; empty if it is not there.
  const ::tesseract::collision::CollisionShapesConst& getCollisionObjectGeometries(const ObjectId& id) const override;
  /// The poses of an object's shapes in its frame; empty if it is not there.
  const ::tesseract::common::VectorIsometry3d& getCollisionObjectGeometriesTransforms(
      const ObjectId& id) const override;
  bool hasCollisionObject(const ObjectId& id) const override;        ///< Whether the object is there.
  bool removeCollisionObject(const ObjectId& id) override;           ///< Removes an object; false if it is not there.
  bool enableCollisionObject(const ObjectId& id) override;           ///< Has it checked; false if it is not there.
  bool disableCollisionObject(const ObjectId& id) override;          ///< Leaves it out; false if it is not there.
  bool isCollisionObjectEnabled(const ObjectId& id) const override;  ///< Whether it is there and is checked.

  using ContinuousContactManager::setCollisionObjectsTransform;
  /// Has an object stand still at this pose in the world, m. Objects that are not there are ignored, here and below.
  void setCollisionObjectsTransform(const ObjectId& id, const Eigen::Isometry3d& pose) override;
  /// Returns the object's pose at t = 0, in the world.
  /// @throws std::out_of_range naming the object, if it is not there.
  Eigen::Isometry3d getCollisionObjectsTransform(const ObjectId& id) const override;
  /// Has objects stand still at these poses.
  void setCollisionObjectsTransform(const ::tesseract::common::LinkIdTransformMap& transforms) override;
  /// Has an object move from one pose to the other. One that is not active stands still at pose1.
  void setCollisionObjectsTransform(const ObjectId& id, const Eigen::Isometry3d& pose1,
                                    const Eigen::Isometry3d& pose2) override;
  /// Has objects move from one pose to the other.
  /// @throws std::invalid_argument naming the object, if it has no second pose.
  void setCollisionObjectsTransform(const ::tesseract::common::LinkIdTransformMap& pose1,
                                    const ::tesseract::common::LinkIdTransformMap& pose2) override;

  /// The objects, in the order in which they were added.
  const std::vector<ObjectId>& getCollisionObjects() const override;
  using ContinuousContactManager::setActiveCollisionObjects;
  /// Selects the objects that may move, which are checked against each other and all others; none: all.
  void setActiveCollisionObjects(const std::unordered_set<ObjectId>& ids) override;
  /// The objects that may move, as they were set.
  const std::unordered_set<ObjectId>& getActiveCollisionObjects() const override;

  /// Sets all margins, m.
  void setCollisionMarginData(::tesseract::collision::CollisionMarginData collision_margin_data) override;
  /// The margins, m.
  const ::tesseract::collision::CollisionMarginData& getCollisionMarginData() const override;
  /// Sets margins of pairs, m.
  void setCollisionMarginPairData(const ::tesseract::collision::CollisionMarginPairData& pair_margin_data,
                                  ::tesseract::collision::CollisionMarginPairOverrideType override_type =
                                      ::tesseract::collision::CollisionMarginPairOverrideType::REPLACE) override;
  void setDefaultCollisionMargin(double default_collision_margin) override;  ///< Sets the margin of other pairs, m.
  /// Sets the margin of a pair, m.
  void setCollisionMarginPair(const ObjectId& id1, const ObjectId& id2, double collision_margin) override;
  void incrementCollisionMargin(double increment) override;  ///< Adds to all margins, m.

  /// Sets the validator, which decides the pairs that may touch; null: no pair may. Each contactTest() asks it about
  /// every pair.
  void setContactAllowedValidator(
      std::shared_ptr<const ::tesseract::common::ContactAllowedValidator> validator) override;
  /// Who allows pairs to touch.
  std::shared_ptr<const ::tesseract::common::ContactAllowedValidator> getContactAllowedValidator() const override;

  /// Finds the contacts of the motion, or proves that there are none, and adds them to `collisions`.
  ///
  /// A contact that can't be excluded within the tolerances counts as one, too; result() says which.
  /// @throws std::invalid_argument for poses that are not finite or farther than 1e5 m away, and for margins that are
  ///   not finite.
  void contactTest(::tesseract::collision::ContactResultMap& collisions,
                   const ::tesseract::collision::ContactRequest& request) override;

  /// The library's own answer to the last contactTest(): verdict, bracket, whether it is certain, work. Contacts that
  /// the request's validator rejected are among its contacts.
  const CertifiedResult& result() const;

 private:
  struct Impl;
  explicit TesseractContactManager(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// Makes TesseractContactManagers for tesseract's plug-in loader: class `FclArticContactManagerFactory` of the library
/// `fcl_artic_tesseract`. Its `config` may have the fields of TesseractOptions: tolerance_time, tolerance_distance,
/// any_contact.
class FCL_ARTIC_EXPORT FclArticContactManagerFactory : public ::tesseract::collision::ContinuousContactManagerFactory {
 public:
  /// @throws std::invalid_argument naming a field of the configuration that is unknown, or no number or truth value.
  std::unique_ptr<::tesseract::collision::ContinuousContactManager> create(const std::string& name,
                                                                           const YAML::Node& config) const override;
};

}  // namespace fcl_artic
