// SPDX-License-Identifier: BSD-3-Clause
// Code that was written for FCL's continuous collision, compiled twice: with CCD_NAMESPACE=fcl, and with
// CCD_NAMESPACE=fcl_artic after the change that doc/MIGRATION.md asks for. Exit status 0 when the answers are as
// expected.
#include <cmath>
#include <iostream>
#include <memory>
#include <vector>

#include <fcl/fcl.h>
#include <fcl_artic/continuous_collision.h>

namespace ccd = CCD_NAMESPACE;

namespace {

template <typename S>
ccd::Transform3<S> at(S x, S y) {
  ccd::Transform3<S> M = ccd::Transform3<S>::Identity();
  M.translation() = ccd::Vector3<S>(x, y, 0);
  return M;
}

/// Balls of 0.5 m; one flies past the other, and hits it at x = -sqrt(1 - aside^2).
double fly(double aside, int overload) {
  const auto ball = std::make_shared<ccd::Sphered>(0.5);
  const ccd::Transform3d begin = at(-3.0, aside), end = at(3.0, aside), rest = at(0.0, 0.0);
  ccd::ContinuousCollisionRequestd request;
  request.ccd_solver_type = ccd::CCDC_CONSERVATIVE_ADVANCEMENT;
  request.ccd_motion_type = ccd::CCDM_TRANS;
  request.gjk_solver_type = ccd::GST_LIBCCD;
  ccd::ContinuousCollisionResultd result;
  switch (overload) {
    case 0: {
      const ccd::TranslationMotiond go(begin, end), stay(rest, rest);
      ccd::continuousCollide(static_cast<const ccd::CollisionGeometryd*>(ball.get()),
                             static_cast<const ccd::MotionBased*>(&go), ball.get(), &stay, request, result);
      break;
    }
    case 1:
      ccd::continuousCollide<double>(ball.get(), begin, end, ball.get(), rest, rest, request, result);
      break;
    case 2: {
      const ccd::CollisionObjectd o1(ball, begin), o2(ball, rest);
      ccd::continuousCollide(&o1, end, &o2, rest, request, result);
      break;
    }
    default: {
      const ccd::ContinuousCollisionObjectd o1(ball, std::make_shared<ccd::TranslationMotion<double>>(begin, end));
      const ccd::ContinuousCollisionObjectd o2(ball, std::make_shared<ccd::TranslationMotion<double>>(rest, rest));
      ccd::collide(&o1, &o2, request, result);
    }
  }
  return result.is_collide ? result.time_of_contact : 2;
}

/// Other uses of such code: static queries, meshes, managers, callbacks, other motions. All of it is FCL's own.
bool othersWork() {
  ccd::BVHModel<ccd::OBBRSSd> mesh;
  ccd::generateBVHModel(mesh, ccd::Boxd(1, 1, 1), ccd::Transform3d::Identity(), ccd::FinalizeModel::DO);
  ccd::CollisionObjectd box(std::make_shared<ccd::Boxd>(1, 1, 1), at(0.5, 0.0));
  ccd::CollisionObjectd cone(std::make_shared<ccd::Coned>(0.5, 1), at(4.0, 0.0));
  ccd::CollisionRequestd request;
  ccd::CollisionResultd result;
  const bool touch = ccd::collide(&box, &box, request, result) > 0;
  result.clear();
  const bool apart = ccd::collide<double>(&mesh, at(9.0, 0.0), box.collisionGeometry().get(), box.getTransform(),
                                          request, result) == 0;
  ccd::DistanceRequestd distance_request;
  ccd::DistanceResultd distance_result;
  const double distance = ccd::distance(&box, &cone, distance_request, distance_result);

  ccd::DynamicAABBTreeCollisionManagerd manager;
  manager.registerObject(&box);
  manager.setup();
  ccd::DefaultCollisionData<double> data;
  manager.collide(&cone, &data, ccd::DefaultCollisionFunction<double>);

  const auto rest = std::make_shared<ccd::TranslationMotion<double>>(at(0.0, 0.0), at(0.0, 0.0));
  ccd::ContinuousCollisionObjectd still(std::make_shared<ccd::Boxd>(1, 1, 1), rest);
  const ccd::ContinuousCollisionCallBack<double> callback = ccd::DefaultContinuousCollisionFunction<double>;
  ccd::DefaultContinuousCollisionData<double> moving_data;
  callback(&still, &still, &moving_data);

  const ccd::InterpMotion<double> interp(ccd::Matrix3d::Identity(), ccd::Vector3d(0, 0, 0), ccd::Matrix3d::Identity(),
                                         ccd::Vector3d(1, 0, 0), ccd::Vector3d(0, 0, 0));
  const std::vector<ccd::Vector3d> p(4, ccd::Vector3d(0, 0, 0));
  const ccd::SplineMotion<double> spline(p[0], p[1], p[2], p[3], p[0], p[1], p[2], p[3]);
  const ccd::ScrewMotion<double> screw;
  ccd::Halfspaced half(ccd::Vector3d(0, 0, 1), 0);
  return touch && apart && std::abs(distance - 2.5) < 1e-3 && !data.result.isCollision() &&
         moving_data.result.is_collide && interp.integrate(0) && spline.integrate(0) && screw.integrate(0) &&
         half.getNodeType() == ccd::GEOM_HALFSPACE;
}

}  // namespace

int main() {
  bool right = othersWork();
  for (int overload = 0; overload < 4; ++overload) {
    for (const double aside : {0.0, 0.6, 1.5}) {
      const double expected = aside < 1 ? (3 - std::sqrt(1 - aside * aside)) / 6 : 2;
      const double t = fly(aside, overload);
      std::cout << "overload " << overload << ", " << aside << " m aside: " << t << " (" << expected << ")\n";
      right = right && std::abs(t - expected) < 1e-3;
    }
  }
  std::cout << (right ? "right" : "wrong") << '\n';
  return right ? 0 : 1;
}
