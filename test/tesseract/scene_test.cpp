// SPDX-License-Identifier: BSD-3-Clause
//
// Scene graphs as managers: trajectories of joints, certified.
#include <cmath>
#include <iostream>
#include <random>

#include <gtest/gtest.h>
#include <tesseract/collision/fcl/fcl_discrete_managers.h>
#include <tesseract/common/allowed_collision_matrix.h>
#include <tesseract/common/contact_allowed_validator.h>
#include <tesseract/geometry/geometries.h>
#include <tesseract/scene_graph/joint.h>
#include <tesseract/scene_graph/link.h>

#include "fcl_artic/tesseract/scene.h"

namespace fcl_artic {
namespace scene_test {
namespace {

namespace collision = ::tesseract::collision;
namespace common = ::tesseract::common;
namespace geometry = ::tesseract::geometry;
namespace scene_graph = ::tesseract::scene_graph;

Eigen::Isometry3d at(double x, double y, double z) {
  return Eigen::Isometry3d(Eigen::Translation3d(x, y, z));
}

scene_graph::Link link(const std::string& name, std::shared_ptr<const geometry::Geometry> shape = nullptr,
                       const Eigen::Isometry3d& origin = Eigen::Isometry3d::Identity()) {
  scene_graph::Link made{common::LinkId(name)};
  if (shape) {
    auto body = std::make_shared<scene_graph::Collision>();
    body->geometry = std::move(shape);
    body->origin = origin;
    made.collision.push_back(body);
  }
  return made;
}

scene_graph::Joint joint(const std::string& name, scene_graph::JointType type, const std::string& parent,
                         const std::string& child, const Eigen::Isometry3d& origin = Eigen::Isometry3d::Identity()) {
  scene_graph::Joint made{common::JointId(name)};
  made.type = type;
  made.parent_link_id = common::LinkId(parent);
  made.child_link_id = common::LinkId(child);
  made.parent_to_joint_origin_transform = origin;
  made.axis = Eigen::Vector3d::UnitZ();
  if (type == scene_graph::JointType::REVOLUTE || type == scene_graph::JointType::PRISMATIC) {
    made.limits = std::make_shared<scene_graph::JointLimits>(-3, 3, 1, 1, 1, 1);
  }
  return made;
}

void add(scene_graph::SceneGraph& graph, scene_graph::Link l, scene_graph::Joint j) {
  ASSERT_TRUE(graph.addLink(std::move(l), std::move(j)));
}

/// A post that stands, an arm of two joints in the plane with a ball at its end, 2 m from the shoulder.
scene_graph::SceneGraph arm() {
  using Type = scene_graph::JointType;
  scene_graph::SceneGraph graph("arm");
  EXPECT_TRUE(graph.addLink(link("world")));
  EXPECT_TRUE(graph.setRoot("world"));
  add(graph, link("post", std::make_shared<geometry::Box>(0.2, 0.2, 1)),
      joint("post_joint", Type::FIXED, "world", "post", at(0, 2, 0)));
  add(graph, link("link1", std::make_shared<geometry::Box>(0.9, 0.1, 0.1), at(0.5, 0, 0)),
      joint("shoulder", Type::REVOLUTE, "world", "link1"));
  add(graph, link("link2"), joint("elbow", Type::CONTINUOUS, "link1", "link2", at(1, 0, 0)));
  add(graph, link("tip", std::make_shared<geometry::Sphere>(0.1)),
      joint("tip_joint", Type::FIXED, "link2", "tip", at(1, 0, 0)));
  return graph;
}

common::JointTrajectory trajectory(const std::vector<Eigen::Vector2d>& positions, bool swapped = false) {
  common::JointTrajectory out;
  for (const Eigen::Vector2d& q : positions) {
    const std::vector<common::JointId> ids =
        swapped ? std::vector<common::JointId>{"elbow", "shoulder"} : std::vector<common::JointId>{"shoulder", "elbow"};
    out.push_back(common::JointState(ids, swapped ? Eigen::VectorXd(q.reverse()) : Eigen::VectorXd(q)));
  }
  return out;
}

TEST(TesseractScene, WorkedNumber) {
  // As the stretched arm turns, the ball's centre (2 cos a, 2 sin a) meets the post's face x = 0.1 at cos a = 0.1.
  const TesseractScene scene = fromTesseract(arm());
  EXPECT_TRUE(scene.notes.empty());
  for (const bool swapped : {false, true}) {
    const CertifiedResult result = scene.certify(trajectory({{0, 0}, {1, 0}, {3, 0}}, swapped));
    ASSERT_TRUE(result.certain);
    EXPECT_NEAR(result.t_lower, 1 + (std::acos(0.1) - 1) / 2, 2e-6);  // states at times 0, 1, 2
    EXPECT_EQ(result.first()->body1.name, "tip/0");
    EXPECT_EQ(result.first()->body2.name, "post/0");
  }
  common::JointTrajectory timed = trajectory({{0, 0}, {3, 0}});
  timed.states[0].time = 5;
  timed.states[1].time = 8;
  EXPECT_NEAR(scene.certify(timed).t_lower, 5 + std::acos(0.1), 1e-5);
  EXPECT_EQ(scene.certify(trajectory({{0, 0}, {1, 0}})).status, Status::free);
}

TEST(TesseractScene, AllowedPairsNeighboursAndMargins) {
  scene_graph::SceneGraph graph = arm();
  // The elbow folds the ball onto the link before it, its neighbour.
  const common::JointTrajectory fold = trajectory({{0, 0}, {0, 3.14}});
  EXPECT_EQ(fromTesseract(graph).certify(fold).status, Status::contact);
  graph.addAllowedCollision("link1", "tip", "adjacent");
  EXPECT_EQ(fromTesseract(graph).certify(fold).status, Status::free);
  EXPECT_EQ(fromTesseract(graph).certify(fold).unproven_allowed_pairs, 0u);  // a neighbour, if it is not attached
  // Stretched at 1 rad the ball is 0.905 m from the post.
  const common::JointTrajectory near = trajectory({{0, 0}, {1, 0}});
  EXPECT_EQ(fromTesseract(graph, common::CollisionMarginData(0.91)).certify(near).status, Status::contact);
  common::CollisionMarginData margins(0.91);
  margins.setCollisionMargin("tip", "post", 0.1);
  margins.setCollisionMargin("link1", "post", 0.1);
  EXPECT_EQ(fromTesseract(graph, margins).certify(near).status, Status::free);
  graph.setLinkCollisionEnabled("tip", false);
  EXPECT_EQ(fromTesseract(graph).certify(trajectory({{0, 0}, {3, 0}})).status, Status::free);
}

TEST(TesseractScene, WhatIsNotCheckedIsNoted) {
  scene_graph::SceneGraph graph = arm();
  add(graph, link("tool", std::make_shared<geometry::Box>(0.1, 0.1, 0.1)),
      joint("tool_joint", scene_graph::JointType::FIXED, "tip", "tool", at(0.1, 0, 0)));
  const TesseractScene scene = fromTesseract(graph);
  ASSERT_EQ(scene.notes.size(), 1u);
  EXPECT_EQ(scene.notes[0], "links 'tip' and 'tool' are not checked: no joint moves them against each other");
}

TEST(TesseractScene, ErrorsNameTheState) {
  const TesseractScene scene = fromTesseract(arm());
  const auto refusal = [&](const common::JointTrajectory& t) -> std::string {
    try {
      (void)scene.certify(t);
    } catch (const std::invalid_argument& e) {
      return e.what();
    }
    return "nothing was thrown";
  };
  const auto expect = [&](const common::JointTrajectory& t, const std::string& part) {
    const std::string message = refusal(t);
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  expect({}, "has 0 states");
  common::JointTrajectory t = trajectory({{0, 0}, {1, 0}});
  t.states[1].joint_ids[0] = "no_such";
  expect(t, "state 1: 'no_such' is no joint");
  t.states[1].joint_ids[0] = "elbow";
  expect(t, "state 1: joint 'elbow' is named twice");
  t = trajectory({{0, 0}, {1, NAN}});
  expect(t, "state 1: the position of joint 'elbow' is not finite");
  t.states[0].position.resize(1);
  expect(t, "state 0: 1 positions for 2 joints");
  t = trajectory({{0, 0}, {1, 0}});
  t.states[0].time = 0;
  t.states[1].time = 0.5;
  EXPECT_EQ(refusal(t), "nothing was thrown");

  scene_graph::SceneGraph graph = arm();
  graph.getLink("tip");
  add(graph, link("sheet", std::make_shared<geometry::Plane>(0, 0, 1, 0)),
      joint("sheet_joint", scene_graph::JointType::FIXED, "tip", "sheet"));
  try {
    fromTesseract(graph);
    ADD_FAILURE() << "a plane that moves was taken";
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find("link 'sheet'"), std::string::npos) << e.what();
  }
}

/// The ball meets the post at a shoulder of acos(0.1) where the elbow is at 0, and not where it is at 2.
TEST(TesseractScene, JointsThatNoStateNamesHaveAValueOfTheirOwn) {
  const TesseractScene scene = fromTesseract(arm());
  const auto states = [](const std::vector<std::vector<std::pair<std::string, double>>>& all) {
    common::JointTrajectory out;
    for (const auto& one : all) {
      std::vector<common::JointId> ids;
      Eigen::VectorXd q(static_cast<Eigen::Index>(one.size()));
      for (std::size_t i = 0; i < one.size(); ++i) {
        ids.emplace_back(one[i].first);
        q[static_cast<Eigen::Index>(i)] = one[i].second;
      }
      out.push_back(common::JointState(ids, q));
    }
    return out;
  };
  const auto refused = [&](const common::JointTrajectory& t, const Eigen::VectorXd& others, const std::string& part) {
    try {
      (void)scene.certify(t, {}, others);
      ADD_FAILURE() << "was taken: " << part;
    } catch (const std::invalid_argument& e) {
      EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
    }
  };
  const common::JointTrajectory shoulder = states({{{"shoulder", 0}}, {{"shoulder", 3}}});
  refused(shoulder, {}, "state 0: joint 'elbow' is not named: `others`");
  Eigen::VectorXd others = scene.tree->neutralConfiguration();
  EXPECT_EQ(scene.certify(shoulder, {}, others).status, Status::contact);
  others[1] = 2;
  EXPECT_EQ(scene.certify(shoulder, {}, others).status, Status::free);
  // A state that leaves out what the one before has moved would put it back where `others` has it.
  const common::JointTrajectory restarted = states({{{"shoulder", 0}, {"elbow", 0}}, {{"shoulder", 3}}});
  refused(restarted, others, "state 1: joint 'elbow' is not named, in state 0 it is");
  refused(states({{{"shoulder", 0}}, {{"elbow", 0}, {"shoulder", 3}}}), others,
          "state 1: joint 'elbow' is named, in state 0 it is not");
}

/// A joint that floats can't be named by a state: where it stands is said.
TEST(TesseractScene, FloatingJointsHaveAValueOfTheirOwn) {
  scene_graph::SceneGraph graph = arm();
  add(graph, link("crate", std::make_shared<geometry::Box>(0.2, 0.2, 0.2)),
      joint("float", scene_graph::JointType::FLOATING, "world", "crate"));
  const TesseractScene scene = fromTesseract(graph);
  const common::JointTrajectory turn = trajectory({{-0.5, 0}, {0.5, 0}});
  EXPECT_THROW((void)scene.certify(turn), std::invalid_argument);
  Eigen::VectorXd others = scene.tree->neutralConfiguration();
  const int x = scene.tree->jointVariable(scene.tree->parentJoint(scene.tree->linkId("crate")));
  others[x + 2] = 5;
  EXPECT_EQ(scene.certify(turn, {}, others).status, Status::free);
  others[x + 2] = 0;
  others[x] = 2;
  EXPECT_EQ(scene.certify(turn, {}, others).status, Status::contact);
}

/// A margin of the request's would be dropped where tesseract's are set.
TEST(TesseractScene, MarginsOfTheRequestAreNotDropped) {
  const common::JointTrajectory near = trajectory({{0, 0}, {1, 0}});  // 0.905 m from the post
  CertifiedRequest request;
  request.margin = 0.91;
  EXPECT_EQ(fromTesseract(arm()).certify(near, request).status, Status::contact);
  const TesseractScene scene = fromTesseract(arm(), common::CollisionMarginData(0.01));
  EXPECT_THROW((void)scene.certify(near, request), std::invalid_argument);
  request.margin = 0;
  EXPECT_EQ(scene.certify(near, request).status, Status::free);
  request.added_margin = 0.9;
  EXPECT_EQ(scene.certify(near, request).status, Status::contact);
}

/// Random arms of three to six joints, mimic ones too, with obstacles: tesseract's discrete manager looks on the way,
/// the links placed by this library's forward kinematics.
TEST(TesseractScene, ThousandTrajectories) {
  std::mt19937_64 engine(31);
  const auto uniform = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(engine); };
  const auto random_pose = [&](double reach) {
    Eigen::Isometry3d M = Eigen::Isometry3d::Identity();
    M.linear() =
        Eigen::Quaterniond(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)).normalized().matrix();
    M.translation() = Eigen::Vector3d(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)) * reach;
    return M;
  };
  const auto random_shape = [&]() -> std::shared_ptr<const geometry::Geometry> {
    if (engine() % 2)
      return std::make_shared<geometry::Box>(uniform(0.05, 0.2), uniform(0.05, 0.2), uniform(0.05, 0.2));
    return std::make_shared<geometry::Capsule>(uniform(0.03, 0.1), uniform(0.05, 0.3));
  };
  int free = 0, touching = 0, initial = 0, missed = 0, not_there = 0;
  for (int robot = 0; robot < 50; ++robot) {
    scene_graph::SceneGraph graph("random");
    graph.addLink(link("world"));
    graph.setRoot("world");
    const int joints = 3 + static_cast<int>(engine() % 4);
    std::vector<std::string> links, movers;
    for (int i = 0; i < joints; ++i) {
      using Type = scene_graph::JointType;
      const Type type = engine() % 3 ? Type::REVOLUTE : engine() % 2 ? Type::PRISMATIC : Type::CONTINUOUS;
      const std::string name = std::to_string(i);
      auto moved = joint("joint" + name, type, i == 0 ? "world" : "link" + std::to_string(i - 1), "link" + name,
                         random_pose(0.3));
      moved.axis = Eigen::Vector3d(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)).normalized();
      if (i == 2) moved.mimic = std::make_shared<scene_graph::JointMimic>(0.1, -0.5, common::JointId("joint0"));
      if (i != 2) movers.push_back(moved.getName());
      links.push_back("link" + name);
      add(graph, link(links.back(), random_shape(), random_pose(0.1)), std::move(moved));
    }
    for (int i = 0; i < 3; ++i) {
      links.push_back("obstacle" + std::to_string(i));
      add(graph, link(links.back(), random_shape()),
          joint("fixed" + std::to_string(i), scene_graph::JointType::FIXED, "world", links.back(), random_pose(1.2)));
    }
    common::AllowedCollisionMatrix allowed;
    for (std::size_t a = 0; a < links.size(); ++a) {
      for (std::size_t b = a + 1; b < links.size(); ++b) {
        const bool next = b == a + 1 && b < static_cast<std::size_t>(joints);
        if (next ? engine() % 8 != 0 : engine() % 4 == 0) {
          graph.addAllowedCollision(links[a], links[b], "random");
          allowed.addAllowedCollision(links[a], links[b], "random");
        }
      }
    }
    const TesseractScene scene = fromTesseract(graph);
    collision::FCLDiscreteBVHManager looker;
    for (const std::string& name : links) {
      const auto body = graph.getLink(name)->collision[0];
      looker.addCollisionObject(name, 0, {body->geometry}, {body->origin});
    }
    std::vector<common::LinkId> active;
    for (int i = 0; i < joints; ++i) active.emplace_back(links[static_cast<std::size_t>(i)]);
    looker.setActiveCollisionObjects(active);
    looker.setContactAllowedValidator(std::make_shared<common::ACMContactAllowedValidator>(allowed));
    const auto touches = [&](const Eigen::VectorXd& q) {
      std::vector<Eigen::Isometry3d> M_0;
      scene.tree->forwardKinematics(q, M_0);
      for (const std::string& name : links) {
        looker.setCollisionObjectsTransform(name, M_0[static_cast<std::size_t>(scene.tree->linkId(name))]);
      }
      collision::ContactResultMap seen;
      looker.contactTest(seen, collision::ContactRequest(collision::ContactTestType::FIRST));
      for (const auto& [pair, contacts] : seen) {
        for (const auto& contact : contacts) {
          if (contact.distance < -1e-6) return true;
        }
      }
      return false;
    };
    for (int query = 0; query < 20; ++query) {
      common::JointTrajectory asked;
      Eigen::VectorXd q(static_cast<Eigen::Index>(movers.size()));
      for (Eigen::Index v = 0; v < q.size(); ++v) q[v] = uniform(-1, 1);
      for (int state = 0; state < 3; ++state) {
        asked.push_back(common::JointState(common::toIds<common::JointId>(movers), q));
        for (Eigen::Index v = 0; v < q.size(); ++v) q[v] += uniform(-0.8, 0.8);
      }
      const CertifiedResult result = scene.certify(asked);
      const JointTrajectory motion = scene.trajectory(asked);
      double until = 2;
      if (result.status == Status::free) {
        ++free;
      } else {
        ++touching;
        initial += result.t_lower <= 0;
        until = result.t_lower;
        bool seen = touches(motion.configuration(result.t_upper));
        for (double later = 1e-6; !seen && later < 0.3; later *= 4) {
          seen = touches(motion.configuration(std::min(2.0, result.t_upper + later)));
        }
        not_there += !seen;
      }
      for (int k = 0; k <= 100; ++k) {
        const double t = until * k / 100;
        if (result.status != Status::free && t >= until) break;
        if (touches(motion.configuration(t))) {
          ++missed;
          break;
        }
      }
    }
  }
  std::cout << free << " free, " << touching << " in contact (" << initial << " from the start); missed: " << missed
            << ", contacts that tesseract does not see within 0.3 later: " << not_there << "\n";
  EXPECT_EQ(free + touching, 1000);
  EXPECT_GT(free, 100);
  EXPECT_GT(touching - initial, 100);
  EXPECT_EQ(missed, 0);
  EXPECT_LE(not_there, touching / 100);
}

}  // namespace
}  // namespace scene_test
}  // namespace fcl_artic
