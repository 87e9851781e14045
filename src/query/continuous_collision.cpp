// SPDX-License-Identifier: BSD-3-Clause
//
// The drop-in: reads FCL's objects, asks solvePair(), writes FCL's result.
#include "fcl_artic/continuous_collision.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "fcl/fcl_geometry.h"
#include "fcl/fcl_motion.h"
#include "numerics/shown.h"
#include "query/claim_nothing.h"
#include "query/engine_query.h"
#include "query/pair_query.h"

namespace fcl_artic {
namespace {

template <class T>
const T& require(const T* pointer, const char* what) {
  if (!pointer) throw std::invalid_argument(std::string("its ") + what + " is null");
  return *pointer;
}

/// One of the two bodies, read.
template <class S>
struct FclBody {
  const fcl::CollisionGeometry<S>* geometry;
  std::shared_ptr<const ShapeTree> shape;  ///< of an OcTree: null until readCells()
  BodyMotion motion;
};

template <class S>
bool isOcTree(const fcl::CollisionGeometry<S>& geometry) {
  return FCL_HAVE_OCTOMAP && geometry.getNodeType() == fcl::GEOM_OCTREE;
}

template <class S>
std::shared_ptr<const ShapeTree> readShape(const fcl::CollisionGeometry<S>* geometry) {
  return isOcTree(require(geometry, "geometry")) ? nullptr : cachedGeometry(*geometry);
}

template <class S>
FclBody<S> read(const fcl::CollisionGeometry<S>* geometry, const fcl::MotionBase<S>* motion) {
  return {geometry, readShape(geometry), readMotion(require(motion, "motion"))};
}

template <class S>
FclBody<S> read(const fcl::CollisionGeometry<S>* geometry, const fcl::Transform3<S>& begin,
                const fcl::Transform3<S>& end, fcl::CCDMotionType type) {
  return {geometry, readShape(geometry),
          motionBetween(readTransform<S>(begin, "its start"), readTransform<S>(end, "its end"), type)};
}

template <class S>
FclBody<S> read(const fcl::CollisionObject<S>* object, const fcl::Transform3<S>& end, fcl::CCDMotionType type) {
  if (!object) throw std::invalid_argument("it is null");
  return read<S>(object->collisionGeometry().get(), object->getTransform(), end, type);
}

template <class S>
FclBody<S> read(const fcl::ContinuousCollisionObject<S>* object) {
  if (!object) throw std::invalid_argument("it is null");
  return read<S>(object->collisionGeometry().get(), object->getMotion());
}

/// Reads object 1 or 2; errors name the number.
template <class S, class... Args>
FclBody<S> body(int number, const Args&... args) {
  try {
    return read<S>(args...);
  } catch (const std::invalid_argument& e) {
    throw std::invalid_argument("object " + std::to_string(number) + ": " + e.what());
  }
}

const fcl::CollisionGeometryd* reported(const fcl::CollisionGeometryd* geometry) {
  return geometry;
}
const fcl::CollisionGeometryd* reported(const fcl::CollisionGeometry<float>*) {
  return nullptr;
}

bool standsStill(const BodyMotion& motion) {
  return std::all_of(motion.elements.begin(), motion.elements.end(),
                     [](const MotionElement& element) { return !element.bounded && element.degree() == 0; });
}

/// Reads an OcTree's cells. If the other body is an OcTree too, it has been read. If the tree stands still, only those
/// cells are read that the other body can come to: most of a map is far from any one motion.
/// @param all  all cells: a certificate is about the whole map.
template <class S>
void readCells(FclBody<S>& tree, const FclBody<S>& other, double margin, bool all) {
#if FCL_HAVE_OCTOMAP
  const auto& octree = static_cast<const fcl::OcTree<S>&>(*tree.geometry);
  Eigen::Vector3d lower, upper;
  lower.setConstant(-INFINITY);
  upper.setConstant(INFINITY);
  const bool bounded = other.shape && other.shape->view().nodes[0].radius < engine::kUnbounded;
  if (standsStill(tree.motion) && bounded && !all) {
    BodyMotion seen = other.motion;  // from the tree's frame
    RigidTransform& first = seen.elements.empty() ? seen.after : seen.elements.front().before;
    first = tree.motion.poseWithError(0).inverse() * first;
    enclosePath(seen, other.shape->lower(), other.shape->upper(), lower, upper);
    // The path's own pads do not include the rounding of these sums.
    const double size = (upper - lower).norm() + lower.norm();
    const double pad = margin + 0x1p-40 * (first.length() + size + margin);
    lower.array() -= pad;
    upper.array() += pad;
  }
  tree.shape = readOcTree(octree, lower, upper);
#else
  (void)tree, (void)other, (void)margin, (void)all;
#endif
}

template <class S>
void answer(FclBody<S>&& body1, FclBody<S>&& body2, const CertifiedPairRequest& request, CertifiedPairResult& result) {
  const double margin = marginsOf(request).largest();
  const bool all = request.certificate;
  if (!body1.shape && !body2.shape && !standsStill(body2.motion)) readCells(body2, body1, margin, all);
  if (!body1.shape) readCells(body1, body2, margin, all);
  if (!body2.shape) readCells(body2, body1, margin, all);
  solvePair({*body1.shape, body1.motion, reported(body1.geometry)},
            {*body2.shape, body2.motion, reported(body2.geometry)}, request, result);
}

/// The largest S that is not later than t.
double roundedDown(double t, double) {
  return t;
}
float roundedDown(double t, float) {
  const float rounded = static_cast<float>(t);
  return static_cast<double>(rounded) > t ? std::nextafter(rounded, 0.0f) : rounded;
}

/// Sets FCL's result to the values that it has while nothing is proven.
template <class S>
void reset(fcl::ContinuousCollisionResult<S>& result) {
  result.is_collide = true;
  result.time_of_contact = 0;
  result.contact_tf1.setIdentity();
  result.contact_tf2.setIdentity();
}

void reset(CertifiedPairResult& result) {
  result = CertifiedPairResult();
}

/// Runs a query. If it throws, the result is reset. It is not reset before: the input may lie in the result, if a
/// caller goes on from the poses of the last query.
template <class Result, class Query>
auto answering(Result& result, Query&& query) {
  return resetUnlessAnswered([&] { reset(result); }, query);
}

template <class S>
CertifiedPairRequest certified(const fcl::ContinuousCollisionRequest<S>& request) {
  const double tolerance = static_cast<double>(request.toc_err);
  if (!(tolerance >= 0) || !std::isfinite(tolerance)) {
    throw std::invalid_argument("the request's toc_err is " + shown(tolerance) + ", not a tolerance of time");
  }
  constexpr double kFinest = 1e-12;  // a few thousand ulp of t = 1: doubles can separate no less
  // A bracket narrower than this takes no more time. A wider one takes more, as more of the bodies is looked at in a
  // wider interval (a link among pipes: 0.19 ms for 1e-4, 0.33 ms for 1e-2, 5 ms for 0.3). A narrower bracket satisfies
  // the request, too.
  constexpr double kCoarsest = 1e-4;
  CertifiedPairRequest certified;
  certified.tolerance_time = std::min(std::max(tolerance, kFinest), kCoarsest);
  if (tolerance >= 1) certified.mode = ContactMode::any;  // any bracket within [0, 1] will do
  return certified;
}

template <class S>
S answer(FclBody<S>&& body1, FclBody<S>&& body2, const fcl::ContinuousCollisionRequest<S>& request,
         fcl::ContinuousCollisionResult<S>& result) {
  CertifiedPairResult proven;
  answer(std::move(body1), std::move(body2), certified(request), proven);
  result.is_collide = !proven.isFree();
  result.time_of_contact = result.is_collide ? roundedDown(proven.t_lower, S()) : S(1);
  const double t = static_cast<double>(result.time_of_contact);
  const bool same = t == proven.t_lower;
  // NOLINTBEGIN(bugprone-use-after-move): what is asked above reads bodies, it keeps nothing of them
  result.contact_tf1 = (same ? proven.tf1_at_lower : body1.motion.pose(t)).template cast<S>();
  result.contact_tf2 = (same ? proven.tf2_at_lower : body2.motion.pose(t)).template cast<S>();
  // NOLINTEND(bugprone-use-after-move)
  return result.time_of_contact;
}

}  // namespace

template <class S>
S continuousCollide(const fcl::CollisionGeometry<S>* o1, const fcl::MotionBase<S>* motion1,
                    const fcl::CollisionGeometry<S>* o2, const fcl::MotionBase<S>* motion2,
                    const fcl::ContinuousCollisionRequest<S>& request, fcl::ContinuousCollisionResult<S>& result) {
  return answering(result, [&] { return answer(body<S>(1, o1, motion1), body<S>(2, o2, motion2), request, result); });
}

template <class S>
S continuousCollide(const fcl::CollisionGeometry<S>* o1, const fcl::Transform3<S>& tf1_beg,
                    const fcl::Transform3<S>& tf1_end, const fcl::CollisionGeometry<S>* o2,
                    const fcl::Transform3<S>& tf2_beg, const fcl::Transform3<S>& tf2_end,
                    const fcl::ContinuousCollisionRequest<S>& request, fcl::ContinuousCollisionResult<S>& result) {
  return answering(result, [&] {
    return answer(body<S>(1, o1, tf1_beg, tf1_end, request.ccd_motion_type),
                  body<S>(2, o2, tf2_beg, tf2_end, request.ccd_motion_type), request, result);
  });
}

template <class S>
S continuousCollide(const fcl::CollisionObject<S>* o1, const fcl::Transform3<S>& tf1_end,
                    const fcl::CollisionObject<S>* o2, const fcl::Transform3<S>& tf2_end,
                    const fcl::ContinuousCollisionRequest<S>& request, fcl::ContinuousCollisionResult<S>& result) {
  return answering(result, [&] {
    return answer(body<S>(1, o1, tf1_end, request.ccd_motion_type), body<S>(2, o2, tf2_end, request.ccd_motion_type),
                  request, result);
  });
}

template <class S>
S collide(const fcl::ContinuousCollisionObject<S>* o1, const fcl::ContinuousCollisionObject<S>* o2,
          const fcl::ContinuousCollisionRequest<S>& request, fcl::ContinuousCollisionResult<S>& result) {
  return answering(result, [&] { return answer(body<S>(1, o1), body<S>(2, o2), request, result); });
}

Status continuousCollide(const fcl::CollisionGeometryd* o1, const fcl::MotionBased* motion1,
                         const fcl::CollisionGeometryd* o2, const fcl::MotionBased* motion2,
                         const CertifiedPairRequest& request, CertifiedPairResult& result) {
  return answering(result, [&] {
    answer(body<double>(1, o1, motion1), body<double>(2, o2, motion2), request, result);
    return result.status;
  });
}

Status continuousCollide(const fcl::CollisionGeometryd* o1, const fcl::Transform3d& tf1_beg,
                         const fcl::Transform3d& tf1_end, const fcl::CollisionGeometryd* o2,
                         const fcl::Transform3d& tf2_beg, const fcl::Transform3d& tf2_end,
                         fcl::CCDMotionType motion_type, const CertifiedPairRequest& request,
                         CertifiedPairResult& result) {
  return answering(result, [&] {
    answer(body<double>(1, o1, tf1_beg, tf1_end, motion_type), body<double>(2, o2, tf2_beg, tf2_end, motion_type),
           request, result);
    return result.status;
  });
}

Status continuousCollide(const fcl::CollisionObjectd* o1, const fcl::Transform3d& tf1_end,
                         const fcl::CollisionObjectd* o2, const fcl::Transform3d& tf2_end,
                         fcl::CCDMotionType motion_type, const CertifiedPairRequest& request,
                         CertifiedPairResult& result) {
  return answering(result, [&] {
    answer(body<double>(1, o1, tf1_end, motion_type), body<double>(2, o2, tf2_end, motion_type), request, result);
    for (CertifiedContact& contact : result.contacts) {
      contact.body1.object = o1;
      contact.body2.object = o2;
    }
    return result.status;
  });
}

Status collide(const fcl::ContinuousCollisionObjectd* o1, const fcl::ContinuousCollisionObjectd* o2,
               const CertifiedPairRequest& request, CertifiedPairResult& result) {
  return answering(result, [&] {
    answer(body<double>(1, o1), body<double>(2, o2), request, result);
    return result.status;
  });
}

#define FCL_ARTIC_INSTANTIATE(S)                                                                                 \
  template FCL_ARTIC_EXPORT S continuousCollide<S>(                                                              \
      const fcl::CollisionGeometry<S>*, const fcl::MotionBase<S>*, const fcl::CollisionGeometry<S>*,             \
      const fcl::MotionBase<S>*, const fcl::ContinuousCollisionRequest<S>&, fcl::ContinuousCollisionResult<S>&); \
  template FCL_ARTIC_EXPORT S continuousCollide<S>(                                                              \
      const fcl::CollisionGeometry<S>*, const fcl::Transform3<S>&, const fcl::Transform3<S>&,                    \
      const fcl::CollisionGeometry<S>*, const fcl::Transform3<S>&, const fcl::Transform3<S>&,                    \
      const fcl::ContinuousCollisionRequest<S>&, fcl::ContinuousCollisionResult<S>&);                            \
  template FCL_ARTIC_EXPORT S continuousCollide<S>(                                                              \
      const fcl::CollisionObject<S>*, const fcl::Transform3<S>&, const fcl::CollisionObject<S>*,                 \
      const fcl::Transform3<S>&, const fcl::ContinuousCollisionRequest<S>&, fcl::ContinuousCollisionResult<S>&); \
  template FCL_ARTIC_EXPORT S collide<S>(                                                                        \
      const fcl::ContinuousCollisionObject<S>*, const fcl::ContinuousCollisionObject<S>*,                        \
      const fcl::ContinuousCollisionRequest<S>&, fcl::ContinuousCollisionResult<S>&);
FCL_ARTIC_INSTANTIATE(double)
FCL_ARTIC_INSTANTIATE(float)
#undef FCL_ARTIC_INSTANTIATE

}  // namespace fcl_artic
