// SPDX-License-Identifier: BSD-3-Clause
//
// Queries as text: read again they are asked again, with the same bits; what is not understood is refused by name.
#include <array>
#include <cstring>
#include <set>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "fcl_artic/query_text.h"
#include "worlds.h"

namespace query_text_test {

using namespace fcl_artic;
using namespace fcl_artic::test;
using Json = nlohmann::ordered_json;

template <class T>
std::array<unsigned char, sizeof(T)> bytesOf(const T& value) {
  std::array<unsigned char, sizeof(T)> bytes;
  std::memcpy(bytes.data(), &value, sizeof value);
  return bytes;
}
template <class T>
void expectBits(const T& a, const T& b, const std::string& what) {
  EXPECT_EQ(bytesOf(a), bytesOf(b)) << what << ": " << a << " and " << b;
}
void expectBits(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const std::string& what) {
  for (int k = 0; k < 3; ++k) expectBits(a[k], b[k], what);
}

template <class Statistics>
void expectSameCounts(const Statistics& a, const Statistics& b) {
  Statistics::forEachField([&](const char* name, auto member) {
    if (std::is_integral_v<std::decay_t<decltype(a.*member)>>) EXPECT_EQ(a.*member, b.*member) << name;
  });
}

void expectSameAnswer(const CertifiedResult& a, const CertifiedResult& b) {
  EXPECT_EQ(a.status, b.status);
  EXPECT_EQ(a.certain, b.certain);
  expectBits(a.t_lower, b.t_lower, "t_lower");
  expectBits(a.t_upper, b.t_upper, "t_upper");
  ASSERT_EQ(a.contacts.size(), b.contacts.size());
  for (std::size_t i = 0; i < a.contacts.size(); ++i) {
    const CertifiedContact &x = a.contacts[i], &y = b.contacts[i];
    EXPECT_EQ(x.body1.name, y.body1.name);
    EXPECT_EQ(x.body2.name, y.body2.name);
    EXPECT_EQ(x.feature, y.feature);
    // Of an OcTree's cell it is a distance in memory.
    if (x.o1->getNodeType() != fcl::GEOM_OCTREE) EXPECT_EQ(x.b1, y.b1);
    if (x.o2->getNodeType() != fcl::GEOM_OCTREE) EXPECT_EQ(x.b2, y.b2);
    expectBits(x.t_lower, y.t_lower, "contact's t_lower");
    expectBits(x.t_upper, y.t_upper, "contact's t_upper");
    expectBits(x.point, y.point, "point");
    expectBits(x.normal, y.normal, "normal");
    expectBits(x.nearest1, y.nearest1, "nearest1");
    expectBits(x.nearest2, y.nearest2, "nearest2");
    expectBits(x.approach_speed, y.approach_speed, "approach_speed");
  }
  EXPECT_EQ(a.ignored_initial_contacts.size(), b.ignored_initial_contacts.size());
  EXPECT_EQ(a.never_apart_pairs, b.never_apart_pairs);
  EXPECT_EQ(a.unproven_allowed_pairs, b.unproven_allowed_pairs);
  EXPECT_EQ(a.statistics.pairs, b.statistics.pairs);
  EXPECT_EQ(a.statistics.pairs_after_culling, b.statistics.pairs_after_culling);
  expectSameCounts<StandardStatistics>(a.statistics, b.statistics);
  expectSameCounts(a.statistics.redon, b.statistics.redon);
}

/// Writes a query, reads it, asks both. @return the answer
template <class Motion>
CertifiedResult expectSameBits(const ArticulatedCollisionManager& manager, const Motion& motion,
                               const CertifiedRequest& request) {
  const std::string text = manager.writeQuery(motion, request);
  const RecordedQuery query = readQuery(text);
  const CertifiedResult result = manager.continuousCollide(motion, request);
  expectSameAnswer(result, query.ask());
  const std::string again = query.trajectory ? query.manager.writeQuery(*query.trajectory, query.request)
                                             : query.manager.writeQuery(*query.motion, query.request);
  EXPECT_EQ(text, again);
  return result;
}

/// Values that a reader could lose: each is in some world's text, so that writing it again shows the loss.
const char* const kTelling[] = {"\"mimic\"",
                                "\"touch_links\"",
                                "\"attached\"",
                                "\"references\"",
                                "\"inf\"",
                                "\"solid\":true",
                                "\"cells\"",
                                "\"radii\"",
                                "\"turn\"",
                                "\"halfspace\"",
                                "\"plane\"",
                                "\"spherical\"",
                                "\"floating\"",
                                "\"planar\"",
                                "\"of\":[\"",
                                "\"complete\": true",
                                "\"disallowed\": [[",
                                "\"redon2004\"",
                                "\"refinement_level\":1"};

TEST(QueryText, RandomWorldsAnswerWithTheSameBits) {
  std::set<std::string> told;
  std::size_t free = 0, contact = 0, undecided = 0, others = 0;
  for (std::uint64_t seed = 0; seed < 24 && !HasFailure(); ++seed) {
    SCOPED_TRACE(seed);
    const World one = world(seed);
    Random random(seed + 1000);
    for (int k = 0; k < 4; ++k) {
      const Eigen::VectorXd q0 = configuration(random, *one.tree), q1 = configuration(random, *one.tree);
      CertifiedRequest asked = request(random);
      if (asked.method == Method::redon2004) asked.visibility = VisibilityMode::off;
      const JointMotion motion = random.chance(0.5) ? JointMotion::linear(*one.tree, q0, q1)
                                                    : JointMotion::tangentHalfAngle(*one.tree, q0, q1);
      const CertifiedResult result = expectSameBits(one.manager, motion, asked);
      const std::string text = one.manager.writeQuery(motion, asked);
      for (const char* value : kTelling) {
        if (text.find(value) != std::string::npos) told.insert(value);
      }
      free += result.status == Status::free;
      contact += result.status == Status::contact;
      undecided += result.status == Status::undecided;
      others += result.status == Status::contact && asked.max_contacts > 1 && result.contacts.size() > 1;
    }
  }
  for (const char* value : kTelling) EXPECT_EQ(told.count(value), 1u) << value << " is in no world";
  EXPECT_GT(free, 10u);  // so that the cases tell
  EXPECT_GT(contact, 10u);
  EXPECT_GT(undecided, 0u);
  EXPECT_GT(others, 3u);
}

TEST(QueryText, TrajectoriesAnswerWithTheSameBits) {
  std::size_t contacts = 0;
  for (std::uint64_t seed = 100; seed < 108; ++seed) {
    SCOPED_TRACE(seed);
    const World one = world(seed);
    Random random(seed);
    std::vector<double> times = {random.uniform(1e9, 2e9)};
    std::vector<Eigen::VectorXd> waypoints = {configuration(random, *one.tree)}, rates;
    for (int k = 0; k < 3; ++k) {
      times.push_back(times.back() + random.uniform(0.1, 1));
      waypoints.push_back(waypoints.back() + 0.2 * configuration(random, *one.tree));
      for (const JointId j : one.tree->quaternionJoints()) {
        const int v = one.tree->quaternionVariable(j);
        waypoints.back().segment<4>(v).normalize();
      }
    }
    rates.assign(waypoints.size(), Eigen::VectorXd::Constant(one.tree->dof(), 0.1));
    for (Eigen::VectorXd& rate : rates) {
      for (const JointId j : one.tree->quaternionJoints()) rate[one.tree->quaternionVariable(j) + 3] = 0;
    }
    CertifiedRequest asked = request(random);
    asked.visibility = VisibilityMode::off;
    const JointTrajectory trajectory = seed % 2 ? JointTrajectory::linear(*one.tree, times, waypoints)
                                                : JointTrajectory::cubic(*one.tree, times, waypoints, rates);
    contacts += expectSameBits(one.manager, trajectory, asked).status == Status::contact;
  }
  EXPECT_GT(contacts, 1u);
}

/// A link that turns by an obstacle.
struct Turning {
  explicit Turning(const std::shared_ptr<fcl::CollisionGeometryd>& obstacle,
                   const std::shared_ptr<fcl::CollisionGeometryd>& arm = std::make_shared<fcl::Boxd>(0.4, 0.1, 0.1)) {
    tree->addLink("base");
    tree->addLink("arm");
    tree->addJoint(Joint::revolute("turn", "base", "arm", Eigen::Vector3d::UnitZ(), Eigen::Isometry3d::Identity(), -1,
                                   std::numeric_limits<double>::infinity()));
    const auto object = [](const auto& shape) { return std::make_shared<fcl::CollisionObjectd>(shape); };
    manager.bind("arm", object(arm), Eigen::Isometry3d(Eigen::Translation3d(0.3, 0, 0)));
    still = object(obstacle);
    still->setTranslation({0, 0.6, 0});
    manager.registerObject(still, "obstacle");
    manager.setup();
  }
  JointMotion motion() const {
    return JointMotion::linear(*tree, Eigen::VectorXd::Zero(1), Eigen::VectorXd::Constant(1, 3));
  }
  Json json() const { return Json::parse(manager.writeQuery(motion())); }

  std::shared_ptr<KinematicTree> tree = std::make_shared<KinematicTree>("turning");
  ArticulatedCollisionManager manager{tree};
  std::shared_ptr<fcl::CollisionObjectd> still;
};

/// Such a robot has motions of no rows.
TEST(QueryText, RobotsWithoutVariablesAreRead) {
  auto tree = std::make_shared<KinematicTree>("still");
  tree->addLink("base");
  ArticulatedCollisionManager manager(tree);
  manager.bind("base", std::make_shared<fcl::CollisionObjectd>(std::make_shared<fcl::Sphered>(0.1)));
  const Eigen::Isometry3d from(Eigen::Translation3d(-1, 0, 0)), to(Eigen::Translation3d(1, 0, 0));
  const auto way = std::make_shared<fcl::TranslationMotiond>(from, to);
  manager.registerObject(std::make_shared<fcl::ContinuousCollisionObjectd>(std::make_shared<fcl::Sphered>(0.1), way),
                         "ball");
  manager.setup();
  const Eigen::VectorXd none(0);
  EXPECT_TRUE(expectSameBits(manager, JointMotion::linear(*tree, none, none), {}).certain);
  EXPECT_TRUE(expectSameBits(manager, JointTrajectory::linear(*tree, {0, 1, 3}, {none, none, none}), {}).certain);
}

TEST(QueryText, EachGeometryIsReadAgain) {
  for (int kind = 0; kind < kKinds; ++kind) {
    SCOPED_TRACE(kind);
    Random random(static_cast<std::uint64_t>(kind));
    const Turning world(geometry(kind, random));
    (void)expectSameBits(world.manager, world.motion(), {});
  }
  const Turning empty(std::make_shared<fcl::OcTreed>(0.1));
  EXPECT_TRUE(expectSameBits(empty.manager, empty.motion(), {}).isFree());
}

/// The message with which text is refused; empty: it is not.
std::string refusal(const std::string& text) {
  try {
    (void)readQuery(text);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

/// Calls change(copy, place in it, way to it) for each value below, and expects each copy to be refused by that way.
template <class Change>
void expectRefusals(const Json& whole, const Json::json_pointer& place, const std::string& at, const Change& change,
                    int& count) {
  const Json& here = whole.at(place);
  Json spoilt = whole;
  if (change(spoilt.at(place))) {
    ++count;
    const std::string said = refusal(spoilt.dump());
    EXPECT_NE(said.find(at.empty() ? "query: " : at), std::string::npos) << at << " is refused as: " << said;
  }
  if (here.is_object()) {
    for (const auto& [name, value] : here.items()) {
      expectRefusals(whole, place / name, at.empty() ? name : at + "." + name, change, count);
    }
  } else if (here.is_array()) {
    for (std::size_t i = 0; i < std::min<std::size_t>(here.size(), 2); ++i) {
      expectRefusals(whole, place / i, at + "[" + std::to_string(i) + "]", change, count);
    }
  }
}

/// One of each geometry and list.
Json richQuery() {
  for (std::uint64_t seed = 0;; ++seed) {
    const World one = world(seed);
    Random random(seed);
    const Eigen::VectorXd q0 = configuration(random, *one.tree);
    const Json json = Json::parse(one.manager.writeQuery(
        JointTrajectory::tangentHalfAngle(*one.tree, {0, 1}, {q0, configuration(random, *one.tree)})));
    bool rich = true;
    for (const char* name : {"geometries", "carried", "moving", "obstacles", "margins"})
      rich = rich && !json[name].empty();
    if (rich && json.dump().find("attached") != std::string::npos &&
        json.dump().find("\"mimic\"") != std::string::npos) {
      return json;
    }
  }
}

TEST(QueryText, WhatIsOfAnotherKindIsRefusedByItsPlace) {
  int count = 0;
  expectRefusals(
      richQuery(), Json::json_pointer(), "", [](Json& value) { return value = nullptr, true; }, count);
  EXPECT_GT(count, 150);
}

TEST(QueryText, WhatIsNotKnownIsRefusedByName) {
  int count = 0;
  const auto add = [](Json& value) {
    if (!value.is_object()) return false;
    value["colour"] = "red";
    return true;
  };
  expectRefusals(richQuery(), Json::json_pointer(), "", add, count);
  EXPECT_GT(count, 20);
}

TEST(QueryText, WhatIsMissingIsRefusedByName) {
  const Json whole = Turning(std::make_shared<fcl::Sphered>(0.1)).json();
  for (const auto& [name, value] : whole.items()) {
    Json without = whole;
    without.erase(name);
    EXPECT_NE(refusal(without.dump()).find("lacks '" + name + "'"), std::string::npos) << refusal(without.dump());
  }
}

TEST(QueryText, WrongValuesAreRefusedByTheirPlace) {
  const Json whole = Turning(test::cubeMesh(0.1)).json();
  const struct {
    const char* place;
    Json value;
    const char* said;
  } kWrong[] = {
      {"/fcl_artic_query", 2, "is 2, and this library reads 1"},
      {"/robot/joints/0/type", "hinge", "robot.joints[0].type is 'hinge', which is none of fixed, revolute"},
      {"/robot/joints/0/parent", "bse", "unknown parent link 'bse'"},
      {"/robot/joints/0/axis", Json::array({0, 0, 0}), "joint 'turn' has an axis that is zero"},
      {"/robot/joints/0/origin/0", 2, "joint 'turn' has an origin that is no rigid transform"},
      {"/robot/joints/0/lower", "nan", "joint 'turn' has a limit that is not a number"},
      {"/robot/joints/0/upper", "large", "robot.joints[0].upper is no number"},
      {"/geometries/1/triangles/3/1", 8, "geometries[1].triangles[3] names a point that is not there: 8"},
      {"/geometries/1/triangles/3/1", -1, "geometries[1].triangles[3] names a point that is not there: -1"},
      {"/geometries/1/triangles/3/1", 4294967297, "geometries[1].triangles[3][1] is no whole number of this range"},
      {"/geometries/1/triangles", Json::array(), "geometries[1] has no triangle"},
      {"/geometries/1/points/0/0", "inf", "obstacle 'obstacle'"},
      {"/geometries/0/sizes", Json::array({1, 1}), "geometries[0].sizes has 2 entries, not 3"},
      {"/geometries/0/sizes/0", -1, "geometry of link 'arm'"},
      {"/carried/0/geometry", 2, "carried[0].geometry is 2, and there are 2"},
      {"/carried/0/link", "leg", "has no link 'leg'"},
      {"/obstacles/0/name", "arm", "obstacle 'arm': the name is that of a link"},
      {"/obstacles/0/name", "", "obstacles[0].name is empty"},
      {"/pairs/allowed", Json::array({Json::array({"arm", "leg"})}), "'leg' is no link of robot 'turning'"},
      {"/margins", Json::array({Json{{"of", Json::array({"arm"})}, {"margin", -1}}}), "margin"},
      {"/margins", Json::array({Json{{"of", Json::array()}, {"margin", 1}}}), "margins[0].of are not one or two names"},
      {"/proofs", Json::array({Json{{"of", Json::array({"arm", "base"})}, {"margin", 0}}}),
       "proofs[0] is of 'arm' and 'base', which are not proven apart"},
      {"/motion/pieces", Json::array(), "motion.pieces are 0, without times"},
      {"/motion/pieces/0/coefficients/0/0", "nan", "not finite"},
      {"/request/mode", "last", "request.mode is 'last', which is none of first, any, first_of_every_pair"},
      {"/request/visibility", "at_once", "request.visibility is 'at_once', which is none of off, on"},
      {"/request/work_budget", -1, "request.work_budget is no whole number"},
      {"/request/redon/refinement_level", 0.5, "request.redon.refinement_level is no whole number"},
  };
  for (const auto& wrong : kWrong) {
    Json spoilt = whole;
    spoilt[Json::json_pointer(wrong.place)] = wrong.value;
    EXPECT_NE(refusal(spoilt.dump()).find(wrong.said), std::string::npos)
        << wrong.place << " = " << wrong.value << " is refused as: " << refusal(spoilt.dump());
  }
  for (const char* text : {"", "{", "[]", "1", "{\"robot\": 1}", "{\"a\": 1, \"a\": 2}"}) {
    EXPECT_EQ(refusal(text).rfind("query: ", 0), 0u) << text << " is refused as: " << refusal(text);
  }
}

TEST(QueryText, OcTreesOfAnotherFormAreRefused) {
  const auto tree = std::make_shared<octomap::OcTree>(0.1);
  tree->updateNode(octomap::point3d(0.05f, 0.05f, 0.05f), true);
  Json whole = Turning(std::make_shared<fcl::OcTreed>(std::shared_ptr<const octomap::OcTree>(tree))).json();
  Json& cells = whole["geometries"][1]["cells"];
  const std::string good = cells.get<std::string>();
  EXPECT_EQ(refusal(whole.dump()), "");
  std::string deep = good;
  deep.replace(deep.find('#'), 1, "+#.......");
  for (const std::string& bad :
       {good + ".", good.substr(0, good.size() - 1), "x" + good, std::string("."), std::string("+........"), deep}) {
    cells = bad;
    EXPECT_NE(refusal(whole.dump()).find("geometries[1].cells"), std::string::npos) << bad;
  }
}

TEST(QueryText, MotionsOfObstaclesAreHeldToWhatPadsHoldFor) {
  Turning world(std::make_shared<fcl::Sphered>(0.1));
  const KinematicTree arm = smallArm();
  world.manager.registerObject(std::make_shared<fcl::ContinuousCollisionObjectd>(
                                   std::make_shared<fcl::Sphered>(0.1),
                                   std::make_shared<FclLinkMotion>(
                                       arm, JointMotion::linear(arm, Eigen::Vector2d(0, 0), Eigen::Vector2d(1, 1)), 2)),
                               "mover");
  world.manager.setup();
  const Json whole = world.json();
  const std::string element = "/moving/0/elements/0";
  const struct {
    std::string place;
    Json value;
    const char* said;
  } kWrong[] = {
      {element + "/before/ulps", 23, "moving[0].elements[0].before.ulps is not within"},
      {element + "/before/length", 0, "moving[0].elements[0].before.length is less than"},
      {element + "/before/pose/0", 1 + 1e-14, "moving[0].elements[0].before.pose is no rigid transform"},
      {element + "/before/pose/0", -1, "moving[0].elements[0].before.pose is no rigid transform"},
      {element + "/before/pose/3", 2e9, "moving[0].elements[0].before.pose is no rigid transform"},
      {element + "/axis", Json::array({0, 0, 0}), "moving[0].elements[0].axis is zero"},
      {element + "/coefficients/0/1", 1.1e5, "moving[0].elements[0].coefficients turn by more than 1e5 rad"},
      {element + "/coefficients/0/1", "inf", "moving[0].elements[0].coefficients are not finite"},
      {element + "/coefficients/0", Json::array({0, 0}), "moving[0].elements[0].coefficients"},
      {element + "/kind", "bounded", "moving[0].elements[0].kind is 'bounded', which is none of"},
  };
  for (const auto& wrong : kWrong) {
    Json spoilt = whole;
    spoilt[Json::json_pointer(wrong.place)] = wrong.value;
    EXPECT_NE(refusal(spoilt.dump()).find(wrong.said), std::string::npos)
        << wrong.place << " = " << wrong.value << " is refused as: " << refusal(spoilt.dump());
  }
}

TEST(QueryText, ProofsOfPairsOfLinksAreMadeAgain) {
  // Two arms whose boxes can't reach each other, and a third link that can reach both.
  auto tree = std::make_shared<KinematicTree>("arms");
  tree->addLink("base");
  ArticulatedCollisionManager manager(tree);
  for (const double x : {-1.0, 0.0, 1.0}) {
    const std::string name = "arm" + std::to_string(static_cast<int>(x) + 1);
    tree->addLink(name);
    tree->addJoint(Joint::revolute("turn_" + name, "base", name, Eigen::Vector3d::UnitZ(),
                                   Eigen::Isometry3d(Eigen::Translation3d(x, 0, 0)), -3, 3));
    manager.bind(name, std::make_shared<fcl::CollisionObjectd>(std::make_shared<fcl::Boxd>(0.7, 0.1, 0.1)),
                 Eigen::Isometry3d(Eigen::Translation3d(0.35, 0, 0)));
  }
  manager.setLinkPairProofs(manager.classifyLinkPairs().proofs);
  manager.setup();
  const JointMotion motion = JointMotion::linear(*tree, Eigen::Vector3d(1, 1, 1), Eigen::Vector3d(2, 2, 2));
  const Json whole = Json::parse(manager.writeQuery(motion));
  ASSERT_EQ(whole["proofs"].size(), 1u);
  EXPECT_EQ(whole["proofs"][0]["of"], Json::array({"arm0", "arm2"}));
  EXPECT_TRUE(expectSameBits(manager, motion, {}).isFree());
  Json forged = whole;
  forged["proofs"][0]["of"][1] = "arm1";
  EXPECT_NE(refusal(forged.dump()).find("proofs[0] is of 'arm0' and 'arm1', which are not proven apart"),
            std::string::npos);
}

TEST(QueryText, WhatNoTextHoldsIsSaid) {
  struct Swing : fcl::MotionBased, BoundedMotion {
    bool integrate(double) const override { return true; }
    void getCurrentTransform(fcl::Transform3d& M) const override { M.setIdentity(); }
    double computeMotionBound(const fcl::BVMotionBoundVisitor<double>&) const override { return 0; }
    double computeMotionBound(const fcl::TriangleMotionBoundVisitor<double>&) const override { return 0; }
    void getTaylorModel(fcl::TMatrix3<double>&, fcl::TVector3<double>&) const override {}
    State state(double) const override { return {}; }
    Bounds bounds(double, double) const override { return {}; }
  };
  const auto said = [](const Turning& world) -> std::string {
    try {
      (void)world.manager.writeQuery(world.motion());
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  Turning world(std::make_shared<fcl::Sphered>(0.1));
  world.still->setTranslation({0, 0.7, 0});
  EXPECT_EQ(said(world), "writeQuery: obstacle 'obstacle' has changed since setup(); call update()");
  world.manager.update();
  EXPECT_EQ(said(world), "");
  world.manager.registerObject(
      std::make_shared<fcl::ContinuousCollisionObjectd>(std::make_shared<fcl::Sphered>(0.1), std::make_shared<Swing>()),
      "swing");
  EXPECT_THROW((void)world.manager.writeQuery(world.motion()), std::logic_error);  // setup() is missing
  world.manager.setup();
  EXPECT_EQ(said(world), "writeQuery: obstacle 'swing' moves as its BoundedMotion says, and only that knows how");
  Turning named(std::make_shared<fcl::Sphered>(0.1));
  named.manager.registerObject(std::make_shared<fcl::CollisionObjectd>(std::make_shared<fcl::Sphered>(0.1)), "\xff");
  named.manager.setup();
  EXPECT_EQ(said(named), "writeQuery: a name is no text in UTF-8");
}

}  // namespace query_text_test
