// SPDX-License-Identifier: BSD-3-Clause
//
// FCL's names in this library's namespace, so that code written for FCL compiles with `namespace ccd = fcl_artic;` in
// place of `namespace ccd = fcl;`. They are the very same types and functions; only `continuousCollide`, the continuous
// `collide` and DefaultContinuousCollisionFunction, in <fcl_artic/continuous_collision.h>, are this library's own.
//
// Named one by one and not by `using namespace fcl`: that would make ::time and fcl::time ambiguous for whoever writes
// `using namespace fcl_artic`. The contents of fcl::detail and fcl::time keep their own names.
#pragma once

#include <fcl/broadphase/broadphase_SSaP.h>
#include <fcl/broadphase/broadphase_SaP.h>
#include <fcl/broadphase/broadphase_bruteforce.h>
#include <fcl/broadphase/broadphase_collision_manager.h>
#include <fcl/broadphase/broadphase_continuous_collision_manager.h>
#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/broadphase/broadphase_dynamic_AABB_tree_array.h>
#include <fcl/broadphase/broadphase_interval_tree.h>
#include <fcl/broadphase/broadphase_spatialhash.h>
#include <fcl/common/exception.h>
#include <fcl/common/types.h>
#include <fcl/geometry/bvh/BVH_internal.h>
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/bvh/BVH_utility.h>
#include <fcl/geometry/bvh/BV_node.h>
#include <fcl/geometry/bvh/BV_node_base.h>
#include <fcl/geometry/collision_geometry.h>
#include <fcl/geometry/geometric_shape_to_BVH_model.h>
#include <fcl/geometry/octree/octree.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cone.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/ellipsoid.h>
#include <fcl/geometry/shape/halfspace.h>
#include <fcl/geometry/shape/plane.h>
#include <fcl/geometry/shape/shape_base.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/geometry/shape/triangle_p.h>
#include <fcl/geometry/shape/utility.h>
#include <fcl/math/bv/AABB.h>
#include <fcl/math/bv/OBB.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fcl/math/bv/RSS.h>
#include <fcl/math/bv/kDOP.h>
#include <fcl/math/bv/kIOS.h>
#include <fcl/math/bv/utility.h>
#include <fcl/math/constants.h>
#include <fcl/math/geometry.h>
#include <fcl/math/motion/bv_motion_bound_visitor.h>
#include <fcl/math/motion/interp_motion.h>
#include <fcl/math/motion/motion_base.h>
#include <fcl/math/motion/screw_motion.h>
#include <fcl/math/motion/spline_motion.h>
#include <fcl/math/motion/taylor_model/interval.h>
#include <fcl/math/motion/taylor_model/interval_matrix.h>
#include <fcl/math/motion/taylor_model/interval_vector.h>
#include <fcl/math/motion/taylor_model/taylor_matrix.h>
#include <fcl/math/motion/taylor_model/taylor_model.h>
#include <fcl/math/motion/taylor_model/taylor_vector.h>
#include <fcl/math/motion/taylor_model/time_interval.h>
#include <fcl/math/motion/tbv_motion_bound_visitor.h>
#include <fcl/math/motion/translation_motion.h>
#include <fcl/math/motion/triangle_motion_bound_visitor.h>
#include <fcl/math/rng.h>
#include <fcl/math/triangle.h>
#include <fcl/math/variance3.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/collision_object.h>
#include <fcl/narrowphase/collision_request.h>
#include <fcl/narrowphase/collision_result.h>
#include <fcl/narrowphase/contact.h>
#include <fcl/narrowphase/contact_point.h>
#include <fcl/narrowphase/continuous_collision_object.h>
#include <fcl/narrowphase/continuous_collision_request.h>
#include <fcl/narrowphase/continuous_collision_result.h>
#include <fcl/narrowphase/cost_source.h>
#include <fcl/narrowphase/distance.h>
#include <fcl/narrowphase/distance_request.h>
#include <fcl/narrowphase/distance_result.h>
#include <fcl/narrowphase/gjk_solver_type.h>

namespace fcl {
// <fcl/broadphase/default_broadphase_callbacks.h> is left to those who use it: it brings FCL's own continuousCollide,
// of the same name and signature, and the slowest of FCL's headers.
template <typename S>
struct DefaultCollisionData;
template <typename S>  // NOLINTNEXTLINE(readability-redundant-declaration): not where FCL's header is left out
bool DefaultCollisionFunction(CollisionObject<S>* o1, CollisionObject<S>* o2, void* data);
template <typename S>
struct DefaultContinuousCollisionData;
template <typename S>
struct DefaultDistanceData;
template <typename S>  // NOLINTNEXTLINE(readability-redundant-declaration): likewise
bool DefaultDistanceFunction(CollisionObject<S>* o1, CollisionObject<S>* o2, void* data, S& dist);
}  // namespace fcl

namespace fcl_artic {

// --- Numbers, vectors, transforms
// <fcl/common/types.h>
using fcl::aligned_map;
using fcl::aligned_vector;
using fcl::AngleAxis;
using fcl::AngleAxisd;
using fcl::AngleAxisf;
using fcl::int32;
using fcl::int64;
using fcl::make_aligned_shared;
using fcl::Matrix3;
using fcl::Matrix3d;
using fcl::Matrix3f;
using fcl::Quaternion;
using fcl::Quaterniond;
using fcl::Quaternionf;
using fcl::Transform3;
using fcl::Transform3d;
using fcl::Transform3f;
using fcl::Translation3;
using fcl::Translation3d;
using fcl::Translation3f;
using fcl::uint32;
using fcl::uint64;
using fcl::Vector2;
using fcl::Vector3;
using fcl::Vector3d;
using fcl::Vector3f;
using fcl::Vector6;
using fcl::Vector7;
using fcl::VectorN;
using fcl::VectorNd;
using fcl::VectorNf;
using fcl::VectorX;
using fcl::VectorXd;
using fcl::VectorXf;
// <fcl/common/exception.h>
using fcl::Exception;
// <fcl/math/constants.h>
using fcl::constants;
using fcl::constantsd;
using fcl::constantsf;
// <fcl/math/geometry.h>
using fcl::axisFromEigen;
using fcl::circumCircleComputation;
using fcl::combine;
using fcl::eigen;
using fcl::generateCoordinateSystem;
using fcl::getCovariance;
using fcl::getExtentAndCenter;
using fcl::getRadiusAndOriginAndRectangleSize;
using fcl::hat;
using fcl::maximumDistance;
using fcl::normalize;
using fcl::relativeTransform;
using fcl::triple;
// <fcl/math/rng.h>
using fcl::RNG;
using fcl::RNGd;
using fcl::RNGf;
// <fcl/math/triangle.h>
using fcl::Triangle;
// <fcl/math/variance3.h>
using fcl::Variance3;
using fcl::Variance3d;
using fcl::Variance3f;

// --- Bounding volumes
// <fcl/math/bv/AABB.h>
using fcl::AABB;
using fcl::AABBd;
using fcl::AABBf;
using fcl::translate;
// <fcl/math/bv/OBB.h>
using fcl::computeVertices;
using fcl::merge_largedist;
using fcl::merge_smalldist;
using fcl::OBB;
using fcl::OBBd;
using fcl::obbDisjoint;
using fcl::OBBf;
using fcl::overlap;
// <fcl/math/bv/RSS.h>
using fcl::distance;
using fcl::rectDistance;
using fcl::RSS;
using fcl::RSSd;
using fcl::RSSf;
// <fcl/math/bv/OBBRSS.h>
using fcl::OBBRSS;
using fcl::OBBRSSd;
using fcl::OBBRSSf;
// <fcl/math/bv/kDOP.h>
using fcl::getDistances;
using fcl::KDOP;
using fcl::KDOPd;
using fcl::KDOPf;
using fcl::minmax;
// <fcl/math/bv/kIOS.h>
using fcl::kIOS;
using fcl::kIOSd;
using fcl::kIOSf;
// <fcl/math/bv/utility.h>
using fcl::convertBV;
using fcl::fit;

// --- Motions
// <fcl/math/motion/motion_base.h>
using fcl::MotionBase;
using fcl::MotionBased;
using fcl::MotionBasef;
using fcl::MotionBasePtr;
// <fcl/math/motion/translation_motion.h>
using fcl::TranslationMotion;
using fcl::TranslationMotiond;
using fcl::TranslationMotionf;
// <fcl/math/motion/interp_motion.h>
using fcl::InterpMotion;
// <fcl/math/motion/screw_motion.h>
using fcl::ScrewMotion;
// <fcl/math/motion/spline_motion.h>
using fcl::SplineMotion;
// <fcl/math/motion/bv_motion_bound_visitor.h>
using fcl::BVMotionBoundVisitor;
// <fcl/math/motion/triangle_motion_bound_visitor.h>
using fcl::TriangleMotionBoundVisitor;
// <fcl/math/motion/taylor_model/time_interval.h>
using fcl::TimeInterval;
// <fcl/math/motion/taylor_model/interval.h>
using fcl::bound;
using fcl::Interval;
// <fcl/math/motion/taylor_model/interval_vector.h>
using fcl::IVector3;
// <fcl/math/motion/taylor_model/interval_matrix.h>
using fcl::IMatrix3;
using fcl::rotationConstrain;
// <fcl/math/motion/taylor_model/taylor_model.h>
using fcl::generateTaylorModelForCosFunc;
using fcl::generateTaylorModelForLinearFunc;
using fcl::generateTaylorModelForSinFunc;
using fcl::TaylorModel;
// <fcl/math/motion/taylor_model/taylor_vector.h>
using fcl::generateTVector3ForLinearFunc;
using fcl::TVector3;
// <fcl/math/motion/taylor_model/taylor_matrix.h>
using fcl::TMatrix3;

// --- Geometries
// <fcl/geometry/collision_geometry.h>
using fcl::BV_AABB;
using fcl::BV_KDOP16;
using fcl::BV_KDOP18;
using fcl::BV_KDOP24;
using fcl::BV_kIOS;
using fcl::BV_OBB;
using fcl::BV_OBBRSS;
using fcl::BV_RSS;
using fcl::BV_UNKNOWN;
using fcl::CollisionGeometry;
using fcl::CollisionGeometryd;
using fcl::CollisionGeometryf;
using fcl::GEOM_BOX;
using fcl::GEOM_CAPSULE;
using fcl::GEOM_CONE;
using fcl::GEOM_CONVEX;
using fcl::GEOM_CYLINDER;
using fcl::GEOM_ELLIPSOID;
using fcl::GEOM_HALFSPACE;
using fcl::GEOM_OCTREE;
using fcl::GEOM_PLANE;
using fcl::GEOM_SPHERE;
using fcl::GEOM_TRIANGLE;
using fcl::NODE_COUNT;
using fcl::NODE_TYPE;
using fcl::OBJECT_TYPE;
using fcl::OT_BVH;
using fcl::OT_COUNT;
using fcl::OT_GEOM;
using fcl::OT_OCTREE;
using fcl::OT_UNKNOWN;
// <fcl/geometry/shape/shape_base.h>
using fcl::ShapeBase;
using fcl::ShapeBased;
using fcl::ShapeBasef;
// <fcl/geometry/shape/box.h>
using fcl::Box;
using fcl::Boxd;
using fcl::Boxf;
// <fcl/geometry/shape/sphere.h>
using fcl::Sphere;
using fcl::Sphered;
using fcl::Spheref;
// <fcl/geometry/shape/ellipsoid.h>
using fcl::Ellipsoid;
using fcl::Ellipsoidd;
using fcl::Ellipsoidf;
// <fcl/geometry/shape/capsule.h>
using fcl::Capsule;
using fcl::Capsuled;
using fcl::Capsulef;
// <fcl/geometry/shape/cone.h>
using fcl::Cone;
using fcl::Coned;
using fcl::Conef;
// <fcl/geometry/shape/cylinder.h>
using fcl::Cylinder;
using fcl::Cylinderd;
using fcl::Cylinderf;
// <fcl/geometry/shape/convex.h>
using fcl::Convex;
using fcl::Convexd;
using fcl::Convexf;
// <fcl/geometry/shape/halfspace.h>
using fcl::Halfspace;
using fcl::Halfspaced;
using fcl::Halfspacef;
using fcl::transform;
// <fcl/geometry/shape/plane.h>
using fcl::Plane;
using fcl::Planed;
using fcl::Planef;
// <fcl/geometry/shape/triangle_p.h>
using fcl::TriangleP;
using fcl::TrianglePd;
using fcl::TrianglePf;
// <fcl/geometry/shape/utility.h>
using fcl::computeBV;
using fcl::constructBox;
// <fcl/geometry/bvh/BVH_internal.h>
using fcl::BVH_BUILD_STATE_BEGUN;
using fcl::BVH_BUILD_STATE_EMPTY;
using fcl::BVH_BUILD_STATE_PROCESSED;
using fcl::BVH_BUILD_STATE_REPLACE_BEGUN;
using fcl::BVH_BUILD_STATE_UPDATE_BEGUN;
using fcl::BVH_BUILD_STATE_UPDATED;
using fcl::BVH_ERR_BUILD_EMPTY_MODEL;
using fcl::BVH_ERR_BUILD_EMPTY_PREVIOUS_FRAME;
using fcl::BVH_ERR_BUILD_OUT_OF_SEQUENCE;
using fcl::BVH_ERR_INCORRECT_DATA;
using fcl::BVH_ERR_MODEL_OUT_OF_MEMORY;
using fcl::BVH_ERR_UNKNOWN;
using fcl::BVH_ERR_UNSUPPORTED_FUNCTION;
using fcl::BVH_ERR_UNUPDATED_MODEL;
using fcl::BVH_MODEL_POINTCLOUD;
using fcl::BVH_MODEL_TRIANGLES;
using fcl::BVH_MODEL_UNKNOWN;
using fcl::BVH_OK;
using fcl::BVHBuildState;
using fcl::BVHModelType;
using fcl::BVHReturnCode;
// <fcl/geometry/bvh/BV_node_base.h>
using fcl::BVNodeBase;
// <fcl/geometry/bvh/BV_node.h>
using fcl::BVNode;
// <fcl/geometry/bvh/BVH_model.h>
using fcl::BVHModel;
// <fcl/geometry/bvh/BVH_utility.h>
using fcl::BVHExpand;
// <fcl/geometry/geometric_shape_to_BVH_model.h>
using fcl::FinalizeModel;
using fcl::generateBVHModel;
// <fcl/geometry/octree/octree.h>
using fcl::computeChildBV;
using fcl::OcTree;
using fcl::OcTreed;
using fcl::OcTreef;

// --- Queries of two objects
// <fcl/narrowphase/gjk_solver_type.h>
using fcl::GJKSolverType;
using fcl::GST_INDEP;
using fcl::GST_LIBCCD;
// <fcl/narrowphase/collision_object.h>
using fcl::CollisionObject;
using fcl::CollisionObjectd;
using fcl::CollisionObjectf;
// <fcl/narrowphase/contact.h>
using fcl::Contact;
using fcl::Contactd;
using fcl::Contactf;
// <fcl/narrowphase/contact_point.h>
using fcl::comparePenDepth;
using fcl::ContactPoint;
using fcl::ContactPointd;
using fcl::ContactPointf;
using fcl::flipNormal;
// <fcl/narrowphase/cost_source.h>
using fcl::CostSource;
using fcl::CostSourced;
using fcl::CostSourcef;
// <fcl/narrowphase/collision_request.h>
using fcl::CollisionRequest;
using fcl::CollisionRequestd;
using fcl::CollisionRequestf;
// <fcl/narrowphase/collision_result.h>
using fcl::CollisionResult;
using fcl::CollisionResultd;
using fcl::CollisionResultf;
// <fcl/narrowphase/distance_request.h>
using fcl::DistanceRequest;
using fcl::DistanceRequestd;
using fcl::DistanceRequestf;
// <fcl/narrowphase/distance_result.h>
using fcl::DistanceResult;
using fcl::DistanceResultd;
using fcl::DistanceResultf;
// <fcl/narrowphase/continuous_collision_object.h>
using fcl::ContinuousCollisionObject;
using fcl::ContinuousCollisionObjectd;
using fcl::ContinuousCollisionObjectf;
// <fcl/narrowphase/continuous_collision_request.h>
using fcl::CCDC_CONSERVATIVE_ADVANCEMENT;
using fcl::CCDC_NAIVE;
using fcl::CCDC_POLYNOMIAL_SOLVER;
using fcl::CCDC_RAY_SHOOTING;
using fcl::CCDM_LINEAR;
using fcl::CCDM_SCREW;
using fcl::CCDM_SPLINE;
using fcl::CCDM_TRANS;
using fcl::CCDMotionType;
using fcl::CCDSolverType;
using fcl::ContinuousCollisionRequest;
using fcl::ContinuousCollisionRequestd;
using fcl::ContinuousCollisionRequestf;
// <fcl/narrowphase/continuous_collision_result.h>
using fcl::ContinuousCollisionResult;
using fcl::ContinuousCollisionResultd;
using fcl::ContinuousCollisionResultf;

// --- Managers
// <fcl/broadphase/broadphase_collision_manager.h>
using fcl::BroadPhaseCollisionManager;
using fcl::BroadPhaseCollisionManagerd;
using fcl::BroadPhaseCollisionManagerf;
using fcl::CollisionCallBack;
using fcl::DistanceCallBack;
// <fcl/broadphase/broadphase_continuous_collision_manager.h>
using fcl::BroadPhaseContinuousCollisionManager;
using fcl::BroadPhaseContinuousCollisionManagerd;
using fcl::BroadPhaseContinuousCollisionManagerf;
using fcl::ContinuousCollisionCallBack;
using fcl::ContinuousDistanceCallBack;
// <fcl/broadphase/broadphase_bruteforce.h>
using fcl::NaiveCollisionManager;
using fcl::NaiveCollisionManagerd;
using fcl::NaiveCollisionManagerf;
// <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
using fcl::DynamicAABBTreeCollisionManager;
using fcl::DynamicAABBTreeCollisionManagerd;
using fcl::DynamicAABBTreeCollisionManagerf;
// <fcl/broadphase/broadphase_dynamic_AABB_tree_array.h>
using fcl::DynamicAABBTreeCollisionManager_Array;
using fcl::DynamicAABBTreeCollisionManager_Arrayd;
using fcl::DynamicAABBTreeCollisionManager_Arrayf;
// <fcl/broadphase/broadphase_interval_tree.h>
using fcl::IntervalTreeCollisionManager;
using fcl::IntervalTreeCollisionManagerd;
using fcl::IntervalTreeCollisionManagerf;
// <fcl/broadphase/broadphase_SaP.h>
using fcl::SaPCollisionManager;
using fcl::SaPCollisionManagerd;
using fcl::SaPCollisionManagerf;
// <fcl/broadphase/broadphase_SSaP.h>
using fcl::SSaPCollisionManager;
using fcl::SSaPCollisionManagerd;
using fcl::SSaPCollisionManagerf;
// <fcl/broadphase/broadphase_spatialhash.h>
using fcl::SpatialHashingCollisionManager;
using fcl::SpatialHashingCollisionManagerd;
using fcl::SpatialHashingCollisionManagerf;
// <fcl/broadphase/default_broadphase_callbacks.h>
using fcl::DefaultCollisionData;
using fcl::DefaultCollisionFunction;
using fcl::DefaultContinuousCollisionData;
using fcl::DefaultDistanceData;
using fcl::DefaultDistanceFunction;

// --- Static queries
// <fcl/narrowphase/distance.h>
using fcl::distance;

// <fcl/narrowphase/collision.h>
// Forwarded, as a using-declaration would bring FCL's continuous `collide` along wherever that is known. `Request` is a
// parameter of its own to make these templates the less specialised ones: an unqualified call, which sees FCL's too, is
// not ambiguous.

/// Asks FCL's static query of two objects at their own transforms: fcl::collide(). Nothing is proven by this library.
/// @return the number of contacts found.
template <typename S, typename Request>
std::size_t collide(const CollisionObject<S>* o1, const CollisionObject<S>* o2, const Request& request,
                    CollisionResult<S>& result) {
  return fcl::collide(o1, o2, request, result);
}
/// Asks FCL's static query of two geometries at given transforms, in the world: fcl::collide(). Nothing is proven by
/// this library.
/// @return the number of contacts found.
template <typename S, typename Request>
std::size_t collide(const CollisionGeometry<S>* o1, const Transform3<S>& tf1, const CollisionGeometry<S>* o2,
                    const Transform3<S>& tf2, const Request& request, CollisionResult<S>& result) {
  return fcl::collide(o1, tf1, o2, tf2, request, result);
}

}  // namespace fcl_artic
