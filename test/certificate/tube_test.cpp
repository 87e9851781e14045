// SPDX-License-Identifier: BSD-3-Clause
//
// Certificates of tubes: what the emitter states and finds, and what the verifier makes of it.
#include <cmath>
#include <cstdlib>

#include <gtest/gtest.h>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/halfspace.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/math/bv/OBBRSS.h>

#include "../../verify/test/tubes.h"
#include "certificate/certificate.h"
#include "proof.h"
#include "support/random_placing.h"

namespace fcl_artic {
namespace certificate_tube_test {
namespace {

using certificate::WorldTolerances;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using Object = std::shared_ptr<fcl::CollisionObjectd>;

Isometry3d at(double x, double y, double z) {
  return Isometry3d(Eigen::Translation3d(x, y, z));
}
template <class Shape, class... Sizes>
Object object(const Isometry3d& pose, Sizes... sizes) {
  return std::make_shared<fcl::CollisionObjectd>(std::make_shared<Shape>(sizes...), pose);
}
/// A box's surface, each side cut into 2 n^2 triangles.
Object meshBox(const Isometry3d& pose, const Vector3d& half, int n) {
  auto mesh = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
  mesh->beginModel();
  for (int side = 0; side < 6; ++side) {
    const int k = side / 2;
    const auto corner = [&](int i, int j) {
      Vector3d p;
      p[k] = side % 2 ? 1 : -1;
      p[(k + 1) % 3] = (side % 2 ? 1 : -1) * (2.0 * i / n - 1);
      p[(k + 2) % 3] = 2.0 * j / n - 1;
      return Vector3d(p.cwiseProduct(half));
    };
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        mesh->addTriangle(corner(i, j), corner(i + 1, j), corner(i + 1, j + 1));
        mesh->addTriangle(corner(i, j), corner(i + 1, j + 1), corner(i, j + 1));
      }
  }
  mesh->endModel();
  return std::make_shared<fcl::CollisionObjectd>(mesh, pose);
}

Certificate certify(const certificate::World& world, const JointMotion& motion) {
  certificate::Claim claim;
  claim.pieces.push_back(certificate::motionOf(world, motion, TimePart{}));
  claim.pieces[0].margin = 1e-3;  // samples show by their distance what is nearer
  return certificate::makeCertificate(world, claim, 500);
}
verify::Verdict verdictOn(const Certificate& certificate) {
  const verify::World world = verify::readWorld(*certificate.world);
  const std::string record = certificate.record();
  return verify::verifyRecord(world, verify::splitRecords(record).at(0));
}
void expectProven(const Certificate& certificate) {
  ASSERT_TRUE(certificate) << certificate.missing;
  const verify::Verdict verdict = verdictOn(certificate);
  EXPECT_TRUE(verdict.verified) << verdict.reason << "\n" << *certificate.world << certificate.motion;
}
std::string linesOf(const std::string& text, const std::string& begin) {
  std::string lines;
  for (std::size_t at = 0; at < text.size(); at = text.find('\n', at) + 1)
    if (text.compare(at, begin.size(), begin) == 0) lines += text.substr(at, text.find('\n', at) + 1 - at);
  return lines;
}

Joint ofType(JointType type, const Joint& joint) {
  Joint other = joint;
  other.type = type;
  return other;
}

/// A joint of each kind in a row, 0.5 m apart along x, with a box of 0.1 m on each link.
struct EveryJoint {
  std::shared_ptr<KinematicTree> tree = std::make_shared<KinematicTree>("every");
  std::unique_ptr<Registry> registry;
  WorldTolerances tolerances;
  std::vector<Object> objects;

  EveryJoint() {
    Joint mimic = Joint::revolute("mimic", "slid", "last", Vector3d::UnitZ(), at(0.5, 0, 0));
    mimic.mimics = true;
    mimic.mimic = {"turn", -0.5, 0.25};
    tree->addLink("base");
    for (const char* link : {"flown", "turned", "rolled", "driven", "slid", "last"}) tree->addLink(link);
    tree->addJoint(ofType(JointType::floating, Joint::fixed("fly", "base", "flown", at(0.5, 0, 0))));
    tree->addJoint(Joint::revolute("turn", "flown", "turned", Vector3d::UnitZ(), at(0.5, 0, 0)));
    tree->addJoint(ofType(JointType::spherical, Joint::fixed("roll", "turned", "rolled", at(0.5, 0, 0))));
    tree->addJoint(ofType(JointType::planar, Joint::revolute("drive", "rolled", "driven",
                                                             Vector3d(0.3, 0.4, 0.5).normalized(), at(0.5, 0, 0))));
    tree->addJoint(Joint::prismatic("slide", "driven", "slid", Vector3d::UnitX(), at(0.5, 0, 0)));
    tree->addJoint(mimic);
    registry = std::make_unique<Registry>(tree);
    for (const char* link : {"flown", "turned", "rolled", "driven", "slid", "last"}) {
      objects.push_back(object<fcl::Boxd>(at(0, 0, 0), 0.1, 0.1, 0.1));
      registry->bind(LinkRef(link), objects.back(), Isometry3d::Identity());
    }
    objects.push_back(object<fcl::Cylinderd>(at(1, 0.6, 0), 0.1, 2.0));
    registry->registerObject(objects.back(), "post");
    objects.push_back(object<fcl::Halfspaced>(at(0, 0, 0), Vector3d(0, 0, 1), -1.0));
    registry->registerObject(objects.back(), "floor");
    tolerances.of_joint.resize(static_cast<std::size_t>(tree->numJoints()));
    for (const char* joint : {"fly", "turn", "roll", "drive", "slide"}) {
      const JointType type = tree->joint(tree->jointId(joint)).type;
      JointTolerance& t = tolerances.of_joint[static_cast<std::size_t>(tree->jointId(joint))];
      if (type != JointType::prismatic) t.angle = 0.01;
      if (type != JointType::revolute && type != JointType::spherical) t.length = 0.002;
    }
    tolerances.of_base = {0.003, 0.004, Vector3d(-1, 0, 0)};
    tolerances.of_object["post"] = {0.005, 0.006, Vector3d(0, 0, -1)};
    tolerances.of_object["nobody"] = {1, 1, Vector3d(0, 0, 0)};
  }
  JointMotion motion() const {
    Eigen::VectorXd q0 = tree->neutralConfiguration(), q1 = q0;
    q1[tree->jointVariable(tree->jointId("turn"))] = -0.4;
    q1[tree->jointVariable(tree->jointId("slide"))] = 0.1;
    q1[tree->jointVariable(tree->jointId("fly"))] = 0.1;
    return JointMotion::linear(*tree, q0, q1);
  }
};

TEST(CertificateTube, ToleranceOfEveryJoint) {
  const EveryJoint every;
  const certificate::World world = certificate::makeWorld(*every.registry, every.tolerances);
  const auto line = [](const std::string& what, std::initializer_list<double> numbers) {
    std::string s = "tolerance " + what;
    for (const double x : numbers) s += " " + certificate::numberText(x);
    return s + "\n";
  };
  EXPECT_EQ(linesOf(*world.text, "tolerance"),
            line("vector 0 3", {0.002}) + line("rotation 3", {0.01}) + line("variable 7", {0.01}) +
                line("rotation 8", {0.01}) + line("vector 12 2", {0.002}) + line("variable 14", {0.01}) +
                line("variable 15", {0.002}) + line("frame 1", {0.003, 0.004, -1, 0, 0}) +
                line("body post", {0.005, 0.006, 0, 0, -1}));
  const Certificate certificate = certify(world, every.motion());
  expectProven(certificate);
  // The verifier has a sum of its own: with ten times the tolerances the same proof is refused.
  WorldTolerances larger = every.tolerances;
  for (JointTolerance& t : larger.of_joint) t = {30 * t.angle, 30 * t.length};
  Certificate forged = certify(certificate::makeWorld(*every.registry, larger), every.motion());
  EXPECT_FALSE(forged);
}

// Forged records of an object that moves by itself: of a smaller speed, a later begin, another clock.
TEST(CertificateTube, SpeedsAreStatedWithTheirClock) {
  EveryJoint every;
  every.tolerances = {};
  every.tolerances.speeds["post"] = {0.25, 0};
  every.tolerances.speeds["nobody"] = {1, 0};
  const certificate::World world = certificate::makeWorld(*every.registry, every.tolerances);
  EXPECT_EQ(linesOf(*world.text, "tolerance"), "tolerance speed post 0x1p-2 0x0p+0\n");
  const Certificate certificate = certify(world, every.motion());
  EXPECT_EQ(linesOf(certificate.motion, "clock"), "clock 0x0p+0 0x1p+0\n");
  expectProven(certificate);
  // A faster one gets to the robot.
  every.tolerances.speeds["post"].speed = 2;
  const certificate::World fast = certificate::makeWorld(*every.registry, every.tolerances);
  EXPECT_FALSE(certify(fast, every.motion()));
  // The proof of the slow one, or one that knows of no speed, proves nothing of the fast one; nor one of another world.
  certificate::World bare = fast;
  for (certificate::Body& body : bare.bodies) body.speed = {};
  Certificate lie = certify(bare, every.motion());
  ASSERT_TRUE(lie);
  EXPECT_FALSE(verdictOn(lie).verified);
  lie.proof.replace(32, std::string::npos, certificate.proof.substr(32));
  EXPECT_FALSE(verdictOn(lie).verified);
  for (const auto& [from, to] : {std::pair("0x1p-2 0x0p+0", "0x1p-3 0x0p+0"), {"0x1p-2 0x0p+0", "0x1p-2 0x1p-1"}}) {
    Certificate other = certificate;  // a smaller speed, a later begin: of these the record does not speak
    std::string text = *certificate.world;
    text.replace(text.find(from), std::string(from).size(), to);
    other.world = std::make_shared<const std::string>(text);
    const verify::Verdict verdict = verdictOn(other);
    EXPECT_NE(verdict.reason.find("about another world"), std::string::npos) << verdict.reason;
  }
  Certificate slower = certificate;  // a clock that goes slower: of this the proof does not speak
  slower.motion.replace(slower.motion.find("clock 0x0p+0 0x1p+0"), 19, "clock 0x0p+0 0x1p-1");
  const verify::Verdict verdict = verdictOn(slower);
  EXPECT_NE(verdict.reason.find("about another motion"), std::string::npos) << verdict.reason;
}

TEST(CertificateTube, NumbersThatNoVerifierReadsAreNotStated) {
  EveryJoint every;
  every.tolerances = {};
  for (const ObjectSpeed& speed : {ObjectSpeed{0.25, 1e13}, {0x1.1p40, 2}, {0.25, -1e300}}) {
    every.tolerances.speeds["post"] = speed;
    const Certificate none = certify(certificate::makeWorld(*every.registry, every.tolerances), every.motion());
    EXPECT_FALSE(none);
    EXPECT_NE(none.missing.find("'post'"), std::string::npos) << none.missing;
  }
  every.tolerances.speeds["post"] = {0.25, 0x1p40};
  expectProven(certify(certificate::makeWorld(*every.registry, every.tolerances), every.motion()));
}

// Without tolerances, a world has the bytes that it had before there were any.
TEST(CertificateTube, NoToleranceNoLine) {
  const EveryJoint every;
  const certificate::World world = certificate::makeWorld(*every.registry, {}),
                           none = certificate::makeWorld(*every.registry, {});
  EXPECT_EQ(linesOf(*world.text, "tolerance"), "");
  EXPECT_EQ(*world.text, *none.text);
  WorldTolerances zero;
  zero.of_joint.resize(static_cast<std::size_t>(every.tree->numJoints()));
  zero.of_object["post"] = {};
  const certificate::World still = certificate::makeWorld(*every.registry, zero);
  EXPECT_EQ(*world.text, *still.text);
  const Certificate a = certify(world, every.motion()), b = certify(still, every.motion());
  expectProven(a);
  EXPECT_EQ(a.record(), b.record());
}

// Several roots are off together, not against each other.
TEST(CertificateTube, TheBaseOfSeveralRoots) {
  const auto tree = std::make_shared<KinematicTree>("two");
  for (const char* link : {"left", "left_arm", "right", "right_arm"}) tree->addLink(link);
  tree->addJoint(Joint::revolute("a", "left", "left_arm", Vector3d::UnitZ(), at(0, 0, 0.5)));
  tree->addJoint(Joint::revolute("b", "right", "right_arm", Vector3d::UnitZ(), at(1, 0, 0.5)));
  Registry registry(tree);
  std::vector<Object> objects;
  for (const char* link : {"left_arm", "right_arm"}) {
    objects.push_back(object<fcl::Sphered>(at(0, 0, 0), 0.49));
    registry.bind(LinkRef(link), objects.back(), Isometry3d::Identity());
  }
  objects.push_back(object<fcl::Sphered>(at(0, 2, 0), 0.1));
  registry.registerObject(objects.back(), "ball");
  WorldTolerances tolerances;
  tolerances.of_base = {0.05, 0.01, Vector3d(0, 0, 0)};
  const JointMotion motion = JointMotion::linear(*tree, Eigen::Vector2d(0, 0), Eigen::Vector2d(1, 1));
  expectProven(certify(certificate::makeWorld(registry, tolerances), motion));  // 0.02 between the two
  tolerances.of_base.length = 1.5;
  EXPECT_FALSE(certify(certificate::makeWorld(registry, tolerances), motion));
}

/// An arm with bodies of several kinds, obstacles, and tolerances at random.
struct RandomTube {
  std::shared_ptr<KinematicTree> tree = std::make_shared<KinematicTree>("arm");
  std::unique_ptr<Registry> registry;
  WorldTolerances tolerances;
  std::vector<Object> objects;
  JointMotion motion;

  static Object any(test::Random& random, const Isometry3d& pose) {
    const double a = random.uniform(0.05, 0.2), b = random.uniform(0.05, 0.2), c = random.uniform(0.2, 0.5);
    switch (random.below(4)) {
      case 0:
        return object<fcl::Boxd>(pose, a, b, c);
      case 1:
        return object<fcl::Sphered>(pose, a);
      case 2:
        return object<fcl::Cylinderd>(pose, a, c);
      default:
        return meshBox(pose, Vector3d(a, b, c) / 2, 1);
    }
  }
  static PoseTolerance anyPose(test::Random& random, double size) {
    const double length = random.uniform(0, size), angle = random.uniform(0, size);
    return {length, angle, random.box(0.5)};
  }
  explicit RandomTube(test::Random& random) : motion(draw(random)) {}

  JointMotion draw(test::Random& random) {
    const int joints = 1 + random.below(5);
    tree->addLink("l0");
    for (int j = 0; j < joints; ++j) {
      const std::string parent = "l" + std::to_string(j), child = "l" + std::to_string(j + 1),
                        name = "j" + std::to_string(j);
      tree->addLink(child);
      const Vector3d axis = (random.box(1) + Vector3d(0, 0, 1.1)).normalized();
      Joint joint = random.oneIn(5) ? Joint::prismatic(name, parent, child, axis, at(0.3, 0, 0))
                                    : Joint::revolute(name, parent, child, axis, at(0.3, 0, 0));
      if (j > 0 && !tree->joint(0).mimics && random.oneIn(5)) {
        joint.mimics = true;
        joint.mimic = {"j0", random.uniform(-2, 2), random.uniform(-0.2, 0.2)};
      }
      tree->addJoint(joint);
    }
    registry = std::make_unique<Registry>(tree);
    for (int j = 0; j <= joints; ++j) {
      objects.push_back(any(random, Isometry3d::Identity()));
      registry->bind(LinkRef("l" + std::to_string(j)), objects.back(), random.pose(0.03));
    }
    for (int j = 0; j < joints; ++j) registry->allow("l" + std::to_string(j), "l" + std::to_string(j + 1));
    for (int o = 3 + random.below(6); o >= 0; --o) {
      objects.push_back(any(random, random.pose(1)));
      registry->registerObject(objects.back(), "o" + std::to_string(o));
    }
    const double size = random.logUniform(1e-4, 0.1);
    tolerances.of_joint.resize(static_cast<std::size_t>(joints));
    for (JointId j = 0; j < joints; ++j) {
      JointTolerance& t = tolerances.of_joint[static_cast<std::size_t>(j)];
      if (!random.oneIn(5))
        (tree->joint(j).type == JointType::prismatic ? t.length : t.angle) = random.uniform(0, size);
    }
    if (random.oneIn(2)) tolerances.of_base = anyPose(random, size);
    if (random.oneIn(2)) tolerances.of_object["o0"] = anyPose(random, size);
    if (random.oneIn(2)) tolerances.speeds["o1"] = {random.uniform(0.1, 1) * size, random.uniform(-0.5, 0.8)};
    Eigen::VectorXd q0(tree->dof()), q1(tree->dof());
    for (int v = 0; v < tree->dof(); ++v) {
      q0[v] = random.uniform(-1, 1);
      q1[v] = q0[v] + random.uniform(-0.7, 0.7);
    }
    return JointMotion::linear(*tree, q0, q1);
  }
};

/// How many random tubes: FCL_ARTIC_TUBES of the environment.
int numberOfTubes(int usual) {
  const char* const number = std::getenv("FCL_ARTIC_TUBES");
  return number ? std::atoi(number) : usual;
}
void multiply(WorldTolerances& tolerances, double factor) {
  for (JointTolerance& t : tolerances.of_joint) t = {factor * t.angle, factor * t.length};
  const auto pose = [&](PoseTolerance& t) { t = {factor * t.length, factor * t.angle, t.pivot}; };
  pose(tolerances.of_base);
  for (auto& entry : tolerances.of_object) pose(entry.second);
  for (auto& entry : tolerances.speeds) entry.second.speed *= factor;
}

/// Samples of the tube by the kinematics of the verifier's tests, which are no part of the library.
class Samples {
 public:
  explicit Samples(std::uint64_t seed) : random_(seed) {}
  /// Whether one certainly touches.
  bool touch(const Certificate& certificate, int count) {
    const verify::World world = verify::readWorld(*certificate.world);
    return verify::test::tubeIsFalse(random_, world, verify::readMotion(certificate.motion, world), count, 30);
  }

 private:
  verify::test::Rng random_;
};

/// The claim, with a proof that has no regard to tolerances.
Certificate claimAlone(const certificate::World& world, const RandomTube& tube) {
  certificate::World bare = world;  // the same text, and nothing that gives
  for (certificate::Frame& frame : bare.frames) frame.gives.clear();
  for (certificate::Body& body : bare.bodies) {
    body.gives.clear();
    body.speed = {};
  }
  bare.tolerant = false;
  return certify(bare, tube.motion);
}

// Every proof that is written holds, and no sample of its tube touches. Then the tolerances grow until a sample does:
// neither the proof that was, nor one made without regard to tolerances, nor what the emitter finds is verified.
TEST(CertificateTube, RandomTubes) {
  const int wanted = numberOfTubes(40);
  int found = 0, verified = 0, touching = 0, none = 0, none_explained = 0, forged = 0, accepted = 0;
  std::size_t bytes = 0, bytes_without = 0;
  for (std::uint64_t i = 0; found < wanted || forged < wanted; ++i) {
    test::Random random(test::Random::mix(47, i));
    RandomTube tube(random);
    Samples samples(i);
    const certificate::World world = certificate::makeWorld(*tube.registry, tube.tolerances);
    const Certificate without = certify(certificate::makeWorld(*tube.registry, {}), tube.motion);
    if (!without) continue;  // the motion itself touches, for the most part
    const Certificate certificate = certify(world, tube.motion);
    if (!certificate) {
      ++none;
      const Certificate claim = claimAlone(world, tube);
      none_explained += samples.touch(claim, 1000);
      continue;
    }
    ++found;
    const verify::Verdict verdict = verdictOn(certificate);
    verified += verdict.verified;
    EXPECT_TRUE(verdict.verified) << i << ": " << verdict.reason;
    bytes += certificate.proof.size();
    bytes_without += without.proof.size();
    touching += samples.touch(certificate, 100);
    for (int k = 0; k < 14; ++k) {
      multiply(tube.tolerances, 1.8);
      const certificate::World larger = certificate::makeWorld(*tube.registry, tube.tolerances);
      Certificate lie = claimAlone(larger, tube);
      if (!samples.touch(lie, 100)) continue;
      ++forged;
      accepted += verdictOn(lie).verified;
      lie.proof.replace(32, std::string::npos, certificate.proof.substr(32));
      accepted += verdictOn(lie).verified;
      const Certificate own = certify(larger, tube.motion);
      accepted += own && verdictOn(own).verified;
      break;
    }
  }
  std::printf(
      "%d proofs, %d verified, %d with a sample that touches; %d without a proof, of %d of these a sample does; "
      "%d forged, %d accepted; %.3f times the bytes of proofs without tolerances\n",
      found, verified, touching, none, none_explained, forged, accepted,
      static_cast<double>(bytes) / static_cast<double>(bytes_without));
  EXPECT_EQ(touching, 0);
  EXPECT_EQ(accepted, 0);
}

}  // namespace
}  // namespace certificate_tube_test
}  // namespace fcl_artic
