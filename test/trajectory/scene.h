// SPDX-License-Identifier: BSD-3-Clause
//
// Small robots and obstacles of the trajectory tests.
#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/sphere.h>
#include <gtest/gtest.h>

#include "fcl_artic/fcl_artic.h"

namespace trajectory_test {

using namespace fcl_artic;
using Eigen::Isometry3d;
using Eigen::MatrixXd;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kPi = 3.14159265358979323846;

inline Isometry3d translation(const Vector3d& x) {
  return Isometry3d(Eigen::Translation3d(x));
}

inline VectorXd values(std::initializer_list<double> list) {
  VectorXd q(static_cast<Eigen::Index>(list.size()));
  std::copy(list.begin(), list.end(), q.data());
  return q;
}

/// A tree with geometry, and obstacles.
struct Scene {
  std::shared_ptr<KinematicTree> tree = std::make_shared<KinematicTree>("robot");
  std::unique_ptr<ArticulatedCollisionManager> manager;
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> objects;

  explicit Scene(const std::string& root = "base") { tree->addLink(root); }

  Joint& add(const std::string& name, JointType type, const std::string& parent, const std::string& child,
             const Vector3d& axis = Vector3d::UnitZ(), const Isometry3d& origin = Isometry3d::Identity(),
             const Mimic* mimic = nullptr) {
    joint_ = Joint();
    joint_.name = name;
    joint_.type = type;
    joint_.parent = parent;
    joint_.child = child;
    joint_.axis = axis;
    joint_.origin = origin;
    joint_.mimics = mimic != nullptr;
    if (mimic) joint_.mimic = *mimic;
    tree->addLink(child);
    tree->addJoint(joint_);
    return joint_;
  }
  void bind(const std::string& link, const std::shared_ptr<fcl::CollisionGeometryd>& geometry,
            const Isometry3d& offset = Isometry3d::Identity()) {
    objects.push_back(std::make_unique<fcl::CollisionObjectd>(geometry));
    ready().bind(link, objects.back().get(), offset);
  }
  void ball(const std::string& link, double radius, const Vector3d& at = Vector3d::Zero()) {
    bind(link, std::make_shared<fcl::Sphered>(radius), translation(at));
  }
  void obstacle(const std::string& name, const std::shared_ptr<fcl::CollisionGeometryd>& geometry,
                const Isometry3d& M) {
    objects.push_back(std::make_unique<fcl::CollisionObjectd>(geometry, M));
    ready().registerObject(objects.back().get(), name);
  }
  template <class Motion>
  CertifiedResult run(const Motion& motion, const CertifiedRequest& request = {}) {
    ready().setup();
    CertifiedResult result;
    manager->continuousCollide(motion, request, result);
    return result;
  }
  ArticulatedCollisionManager& ready() {
    if (!manager) manager = std::make_unique<ArticulatedCollisionManager>(tree);
    return *manager;
  }

 private:
  Joint joint_;
};

/// Bracket holds t, and is certain.
inline void expectContact(const CertifiedResult& r, double t, double tolerance = 1e-6, double rounding = 1e-9) {
  ASSERT_EQ(r.status, Status::contact);
  EXPECT_TRUE(r.certain);
  EXPECT_LE(r.t_lower, t + rounding);
  EXPECT_GE(r.t_upper, t - rounding);
  EXPECT_LE(r.t_upper - r.t_lower, tolerance * 1.001);
  ASSERT_GE(r.contacts.size(), 1u);
  EXPECT_LE(r.contacts[0].t_lower, t + rounding);
  EXPECT_GE(r.contacts[0].t_upper, t - rounding);
}

/// Where an increasing function of [0, 1] takes the value.
inline double solve(const std::function<long double(long double)>& f, long double value) {
  long double lower = 0, upper = 1;
  for (int i = 0; i < 90; ++i) {
    const long double middle = (lower + upper) / 2;
    (f(middle) < value ? lower : upper) = middle;
  }
  return static_cast<double>(lower);
}

/// 10 s^3 - 15 s^4 + 6 s^5: from rest to rest.
inline long double minimumJerk(long double s) {
  return s * s * s * (10 + s * (-15 + s * 6));
}

template <class F>
std::string refusal(F&& f) {
  try {
    f();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "(not refused)";
}

inline void expectContains(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << "'" << part << "' is not in: " << text;
}

}  // namespace trajectory_test
