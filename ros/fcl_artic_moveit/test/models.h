// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdlib>
#include <fstream>
#include <functional>
#include <memory>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <geometric_shapes/shapes.h>
#include <gtest/gtest.h>
#include <srdfdom/model.h>
#include <urdf_parser/urdf_parser.h>
#include <moveit/collision_detection_fcl/collision_env_fcl.hpp>
#include <moveit/robot_model/robot_model.hpp>
#include <moveit/robot_state/attached_body.hpp>
#include <moveit/robot_state/robot_state.hpp>
#include <moveit/robot_trajectory/robot_trajectory.hpp>

namespace fcl_artic_moveit {

inline moveit::core::RobotModelConstPtr modelOf(const std::string& urdf, const std::string& srdf) {
  const auto tree = urdf::parseURDF(urdf);
  if (!tree) throw std::runtime_error("the URDF is none");
  auto semantics = std::make_shared<srdf::Model>();
  if (!semantics->initString(*tree, srdf)) throw std::runtime_error("the SRDF is none");
  auto model = std::make_shared<moveit::core::RobotModel>(tree, semantics);
  for (moveit::core::JointModel* joint : model->getJointModels()) {  // as joint_limits.yaml has them
    for (const std::string& variable : joint->getVariableNames()) {
      moveit::core::VariableBounds bounds = joint->getVariableBounds(variable);
      bounds.acceleration_bounded_ = bounds.velocity_bounded_;
      bounds.max_acceleration_ = 2;
      bounds.min_acceleration_ = -2;
      joint->setVariableBounds(variable, bounds);
    }
  }
  return model;
}

/// A link with one box at its origin.
inline std::string boxLink(const std::string& name, double x, double y, double z, const std::string& at = "0 0 0") {
  std::ostringstream out;
  out << "<link name='" << name << "'><collision><origin xyz='" << at << "'/><geometry><box size='" << x << ' ' << y
      << ' ' << z << "'/></geometry></collision></link>";
  return out.str();
}

inline std::string joint(const std::string& name, const std::string& type, const std::string& parent,
                         const std::string& child, const std::string& more = "", const std::string& at = "0 0 0",
                         const std::string& rpy = "0 0 0") {
  const std::string limit =
      type == "revolute" || type == "prismatic" ? "<limit lower='-3' upper='3' effort='1' velocity='1'/>" : "";
  return "<joint name='" + name + "' type='" + type + "'><parent link='" + parent + "'/><child link='" + child +
         "'/><origin xyz='" + at + "' rpy='" + rpy + "'/>" + limit + more + "</joint>";
}

inline std::string sliderUrdf(const std::string& more = "") {
  return "<robot name='slider'>" + boxLink("base", 0.1, 0.1, 0.1, "0 0 -1") + boxLink("cart", 0.2, 0.2, 0.2) +
         boxLink("arm", 1, 0.1, 0.1, "0.5 0 0") + boxLink("finger", 0.1, 0.1, 0.1, "0.1 0 0") +
         joint("rail", "prismatic", "base", "cart", "<axis xyz='1 0 0'/>") +
         joint("turn", "revolute", "cart", "arm", "<axis xyz='0 0 1'/>") +
         joint("reach", "prismatic", "arm", "finger", "<axis xyz='1 0 0'/>", "1 0 0") + more + "</robot>";
}

inline std::string sliderSrdf(const std::string& srdf = "<disable_collisions link1='cart' link2='arm'/>") {
  return "<robot name='slider'><group name='all'><joint name='rail'/><joint name='turn'/><joint name='reach'/>"
         "</group><group name='rail_only'><joint name='rail'/></group>"
         "<group name='reach_only'><joint name='reach'/></group>" +
         srdf + "</robot>";
}

/// A rail along x carries an arm that turns about z, which carries a finger at its end. The boxes of rail and arm
/// overlap where they are joined; arm and finger do not touch. `srdf` is put into the SRDF.
inline moveit::core::RobotModelConstPtr slider(
    const std::string& srdf = "<disable_collisions link1='cart' link2='arm'/>", const std::string& more = "") {
  return modelOf(sliderUrdf(more), sliderSrdf(srdf));
}

/// A robot in a world, checked by FCL as MoveIt does.
struct Surroundings {
  explicit Surroundings(moveit::core::RobotModelConstPtr the_model)
      : model(std::move(the_model)),
        world(std::make_shared<collision_detection::World>()),
        env(std::make_shared<collision_detection::CollisionEnvFCL>(model, world)),
        acm(*model->getSRDF()),
        state(model) {
    state.setToDefaultValues();
    state.update();
  }
  void add(const std::string& id, const shapes::ShapeConstPtr& shape, const Eigen::Vector3d& at) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation() = at;
    world->addToObject(id, shape, pose);
  }
  void attach(const std::string& id, const std::string& link, const shapes::ShapeConstPtr& shape,
              const Eigen::Vector3d& at, const std::set<std::string>& touch_links) {
    attach(state, id, link, shape, at, touch_links);
  }
  static void attach(moveit::core::RobotState& to, const std::string& id, const std::string& link,
                     const shapes::ShapeConstPtr& shape, const Eigen::Vector3d& at,
                     const std::set<std::string>& touch_links) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation() = at;
    to.attachBody(id, pose, {shape}, EigenSTL::vector_Isometry3d{Eigen::Isometry3d::Identity()}, touch_links, link);
    to.update();
  }
  /// PlanningScene::checkCollision(): links against the world padded, against each other not.
  bool moveitCollides(const moveit::core::RobotState& at, const std::string& group = "") const {
    collision_detection::CollisionRequest request;
    request.group_name = group;
    collision_detection::CollisionResult result;
    env->checkRobotCollision(request, result, at, acm);
    if (result.collision) return true;
    collision_detection::CollisionEnvFCL unpadded(model, world);
    unpadded.checkSelfCollision(request, result, at, acm);
    return result.collision;
  }
  robot_trajectory::RobotTrajectory trajectory(const std::string& group,
                                               const std::vector<std::vector<double>>& waypoints,
                                               double step = 1) const {
    robot_trajectory::RobotTrajectory out(model, group);
    for (const std::vector<double>& q : waypoints) {
      moveit::core::RobotState at(state);
      for (std::size_t v = 0; v < q.size(); ++v) at.setVariablePosition(v, q[v]);
      at.update();
      out.addSuffixWayPoint(at, out.empty() ? 0 : step);
    }
    return out;
  }

  moveit::core::RobotModelConstPtr model;
  collision_detection::WorldPtr world;
  std::shared_ptr<collision_detection::CollisionEnvFCL> env;
  collision_detection::AllowedCollisionMatrix acm;
  moveit::core::RobotState state;
};

inline std::string textOf(const std::string& path) {
  std::ifstream in(path);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

/// Folder of the Panda's files; empty where there is none.
inline std::string pandaFolder() {
  const char* data = std::getenv("FCL_ARTIC_DATA");
  const std::string folder = std::string(data ? data : "") + "/robots/panda_mbm";
  return data && std::ifstream(folder + "/panda_mbm.urdf").good() ? folder : "";
}

inline moveit::core::RobotModelConstPtr panda() {
  const std::string folder = pandaFolder();
  std::string urdf = textOf(folder + "/panda_mbm.urdf");
  const std::string from = "filename=\"meshes/", to = "filename=\"file://" + folder + "/meshes/";
  for (std::size_t at = 0; (at = urdf.find(from, at)) != std::string::npos; at += to.size()) {
    urdf.replace(at, from.size(), to);
  }
  return modelOf(urdf, textOf(folder + "/panda_mbm.srdf"));
}

/// The message of the std::invalid_argument that `call` throws.
inline std::string refusal(const std::function<void()>& call) {
  try {
    call();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  ADD_FAILURE() << "throws nothing";
  return {};
}

inline void expectContains(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << "'" << part << "' is not in: " << text;
}

/// A mesh of 12 triangles: a box of these sizes around the origin.
inline shapes::ShapeConstPtr boxMesh(double x, double y, double z) {
  auto mesh = std::make_shared<shapes::Mesh>(8, 12);
  for (unsigned int i = 0; i < 8; ++i) {
    mesh->vertices[3 * i] = (i & 1 ? 0.5 : -0.5) * x;
    mesh->vertices[3 * i + 1] = (i & 2 ? 0.5 : -0.5) * y;
    mesh->vertices[3 * i + 2] = (i & 4 ? 0.5 : -0.5) * z;
  }
  const unsigned int corners[36] = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                    2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
  std::copy(corners, corners + 36, mesh->triangles);
  mesh->computeTriangleNormals();
  mesh->computeVertexNormals();
  return mesh;
}

}  // namespace fcl_artic_moveit
