// SPDX-License-Identifier: BSD-3-Clause
//
// Margins of single bodies and pairs.
#include <cmath>
#include <limits>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fcl/math/motion/translation_motion.h>

#include "expect_time.h"

namespace margin_test {

using namespace fcl_artic;
using namespace fcl_artic::test;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// The cart, whose ball of 0.1 runs along x, and a ball of 0.1 beside its way and ahead of it.
struct Way : Cart {
  std::shared_ptr<fcl::CollisionObjectd> post = ball(0.1, {1, 0.5, 0});  // 0.3 from the cart's ball when that passes
  std::shared_ptr<fcl::CollisionObjectd> wall = object(std::make_shared<fcl::Boxd>(1, 4, 4), pose({2.5, 0, 0}));
  Way() {
    manager->registerObject(post.get(), "post");
    manager->registerObject(wall.get(), "wall");
    manager->setup();
  }
};

CertifiedRequest withMargin(double margin) {
  CertifiedRequest request;
  request.margin = margin;
  return request;
}

/// Time at which the cart, from 0 to 2, comes within `margin` of the wall at x = 2; of the post.
double wallTime(double margin) {
  return (1.9 - margin) / 2;
}
double postTime(double margin) {
  return (1 - std::sqrt((0.2 + margin) * (0.2 + margin) - 0.25)) / 2;
}

}  // namespace

TEST(Margin, OfALinkCountsForAllItsPairs) {
  Way way;
  EXPECT_TRUE(touchesAt(way.run(0, 2), wallTime(0)));
  way.manager->setMargin("cart", 0.2);
  EXPECT_THROW(way.run(0, 2), std::logic_error);
  way.manager->setup();
  EXPECT_TRUE(touchesAt(way.run(0, 2), wallTime(0.2)));
  way.manager->setMargin("cart", 0.4);
  way.manager->setup();
  EXPECT_TRUE(touchesAt(way.run(0, 2), postTime(0.4)));
  // In place of the request's, be that larger or less.
  EXPECT_TRUE(touchesAt(way.run(0, 2, withMargin(0.45)), postTime(0.4)));
  way.manager->setMargin("cart", 0.1);
  way.manager->setup();
  EXPECT_TRUE(touchesAt(way.run(0, 2, withMargin(0.45)), wallTime(0.1)));
  way.manager->resetMargins();
  way.manager->setup();
  EXPECT_TRUE(touchesAt(way.run(0, 2), wallTime(0)));
  EXPECT_TRUE(touchesAt(way.run(0, 2, withMargin(0.45)), postTime(0.45)));
}

TEST(Margin, OfAnObstacleCountsForItAlone) {
  Way way;
  way.manager->setMargin("post", 0.4);
  way.manager->setup();
  EXPECT_TRUE(touchesAt(way.run(0, 2), postTime(0.4)));
  way.manager->setMargin("post", 0.25);
  way.manager->setup();
  EXPECT_TRUE(touchesAt(way.run(0, 2), wallTime(0)));
  EXPECT_TRUE(touchesAt(way.run(0, 2, withMargin(0.05)), wallTime(0.05)));
  // If two bodies have margins, the larger counts.
  way.manager->setMargin("cart", 0.35);
  way.manager->setup();
  EXPECT_TRUE(touchesAt(way.run(0, 2), postTime(0.35)));
  way.manager->setMargin("cart", 0.1);
  way.manager->setMargin("post", 0.35);
  way.manager->setup();
  EXPECT_TRUE(touchesAt(way.run(0, 2), postTime(0.35)));
}

TEST(Margin, OfAPairComesFirst) {
  Way way;
  way.manager->setMargin("cart", 0.4);
  way.manager->setMargin("post", "cart", 0);
  way.manager->setup();
  EXPECT_TRUE(touchesAt(way.run(0, 2), wallTime(0.4)));
  EXPECT_TRUE(touchesAt(way.run(0, 2, withMargin(0.45)), wallTime(0.4)));
  way.manager->setMargin("cart", "wall", 0);
  way.manager->setup();
  EXPECT_TRUE(touchesAt(way.run(0, 2, withMargin(0.45)), wallTime(0)));
  way.manager->setMargin("cart", "post", 0.32);  // the same pair
  way.manager->setup();
  EXPECT_TRUE(touchesAt(way.run(0, 2), postTime(0.32)));
}

// A pair that is near by construction, as neighbours two joints apart, keeps a little margin while all else has a large
// one.
TEST(Margin, OfTwoLinks) {
  auto tree = std::make_shared<KinematicTree>("crane");
  for (const char* name : {"rail", "cart", "mast", "hook"}) tree->addLink(name);
  tree->addJoint(makeJoint("slide", JointType::prismatic, "rail", "cart", Vector3d::UnitX()));
  tree->addJoint(makeJoint("turn", JointType::revolute, "cart", "mast", Vector3d::UnitZ()));
  tree->addJoint(makeJoint("drop", JointType::prismatic, "mast", "hook", -Vector3d::UnitX()));
  ArticulatedCollisionManager manager(tree);
  const auto foot = ball(0.1), weight = ball(0.1), post = ball(0.1, {3, 0.5, 0});
  manager.bind("cart", foot.get());
  manager.bind("hook", weight.get(), pose({1, 0, 0}));
  manager.registerObject(post.get(), "post");
  manager.setup();
  // The hook comes from 1 to 0.3 of the cart, which drives from 0 to 3: 1 - 0.7 t = 0.2 + margin; at the end the cart
  // is 0.3 from the post.
  const auto run = [&](const CertifiedRequest& request) {
    return ask(manager, Vector3d(0, 0, 0), Vector3d(3, 0, 0.7), request);
  };
  EXPECT_TRUE(run({}).isFree());
  EXPECT_TRUE(touchesAt(run(withMargin(0.2)), 0.6 / 0.7));
  manager.setMargin("cart", "hook", 0.05);
  manager.setup();
  EXPECT_TRUE(run(withMargin(0.2)).isFree());
  CertifiedRequest request = withMargin(0.35);
  request.check_self = false;
  EXPECT_EQ(run(request).status, Status::contact);
  manager.setMargin("hook", "cart", 0.15);
  manager.setup();
  EXPECT_TRUE(touchesAt(run(withMargin(0.05)), 0.65 / 0.7));
}

// A ball of 0.2 comes from x = 2 to 0; pairs with it stand behind those of links.
TEST(Margin, OfAMovingObstacle) {
  Cart cart;
  Eigen::Isometry3d from = pose({2, 0, 0}), to = pose({0, 0, 0});
  fcl::ContinuousCollisionObjectd bowl(std::make_shared<fcl::Sphered>(0.2),
                                       std::make_shared<fcl::TranslationMotiond>(from, to));
  cart.manager->registerObject(&bowl, "bowl");
  cart.manager->setMargin("bowl", 0.1);
  cart.manager->setup();
  EXPECT_TRUE(touchesAt(cart.run(0, 0), 0.8));
  CertifiedRequest request;
  request.check_self = false;
  EXPECT_TRUE(touchesAt(cart.run(0, 0, request), 0.8));
  cart.manager->setMargin("cart", "bowl", 0.3);
  cart.manager->setup();
  EXPECT_TRUE(touchesAt(cart.run(0, 0, request), 0.7));
}

// The same past two links 5 apart, whose own pair has a margin that must not be taken for the ball's.
TEST(Margin, OfAMovingObstacleBesideTwoLinks) {
  const auto still = ball(0.1), moving = ball(0.1);
  ArticulatedCollisionManager manager(sliderTree({"base", "between", "cart"}));
  manager.bind("base", still.get());
  manager.bind("cart", moving.get(), pose({0, 5, 0}));
  const Eigen::Isometry3d from = pose({2, 5, 0}), to = pose({0, 5, 0});
  fcl::ContinuousCollisionObjectd bowl(std::make_shared<fcl::Sphered>(0.2),
                                       std::make_shared<fcl::TranslationMotiond>(from, to));
  manager.registerObject(&bowl, "bowl");
  manager.setMargin("bowl", 0.1);
  manager.setMargin("base", "cart", 6);
  manager.setup();
  const Eigen::VectorXd q = Eigen::VectorXd::Zero(2);
  EXPECT_TRUE(touchesAt(ask(manager, q, q), 0));
  CertifiedRequest request;
  request.check_self = false;
  EXPECT_TRUE(touchesAt(ask(manager, q, q, request), 0.8));
}

// The next obstacle of a name is another object: what the first was allowed, and how near it might be, is not said of
// it.
TEST(Margin, GoesWithItsObstacle) {
  Way way;
  const auto useAgain = [&] {
    way.manager->registerObject(way.post.get(), "post");
    way.manager->setup();
  };
  way.manager->setMargin("cart", 0.4);
  way.manager->setMargin("cart", "post", 0);
  way.manager->allow("cart", "wall");
  way.manager->setup();
  EXPECT_TRUE(way.run(0, 2).isFree());
  way.manager->unregisterObject(way.post.get());
  useAgain();
  EXPECT_TRUE(touchesAt(way.run(0, 2), postTime(0.4))) << "a margin of a pair of before";
  way.manager->setMargin("cart", "post", 0);
  way.manager->unregisterObject(way.wall.get());
  way.manager->registerObject(way.wall.get(), "wall");
  way.manager->setup();
  EXPECT_TRUE(touchesAt(way.run(0, 2), wallTime(0.4))) << "an allowed pair of before";
  EXPECT_TRUE(way.manager->allowedCollisions().pairs().empty());
  // So of what a link carries, and of a margin of the body's own.
  way.manager->setMargin("cart", 0);
  way.manager->setMargin("post", 0.3);
  way.manager->attach("cart", way.post.get(), pose({0.5, 0, 0}));
  way.manager->unregisterObject(way.post.get());
  useAgain();
  EXPECT_TRUE(touchesAt(way.run(0, 2), wallTime(0)));
  // Links are not unregistered: theirs stay.
  way.manager->setMargin("cart", 0.4);
  way.manager->setMargin("cart", "post", 0);
  way.manager->clear();
  way.manager->bind("cart", way.body.get());
  useAgain();
  EXPECT_TRUE(touchesAt(way.run(0, 2), postTime(0.4)));
}

TEST(Margin, GoesWithAnObstacleThatMoves) {
  Cart cart;
  fcl::ContinuousCollisionObjectd bowl(std::make_shared<fcl::Sphered>(0.2),
                                       std::make_shared<fcl::TranslationMotiond>(pose({2, 0, 0}), pose({0, 0, 0})));
  cart.manager->registerObject(&bowl, "bowl");
  cart.manager->setMargin("bowl", 0.1);
  cart.manager->allow("bowl", "cart");
  cart.manager->unregisterObject(&bowl);
  cart.manager->registerObject(&bowl, "bowl");
  cart.manager->setup();
  EXPECT_TRUE(touchesAt(cart.run(0, 0), 0.85));
}

TEST(Margin, OfAnObstacleIsKeptWhereALinkCarriesIt) {
  Way way;
  way.manager->setMargin("post", 0.4);
  // Carried 0.5 ahead the post meets the wall: 2 - 0.6 - margin.
  way.manager->attach("cart", way.post.get(), pose({0.5, 0, 0}));
  way.manager->setup();
  EXPECT_TRUE(touchesAt(way.run(0, 2), 0.5));
}

// Two triangles have features only where they touch: a mesh with a margin of 0 among others.
TEST(Margin, FeaturesAreNamedWhereThePairHasNone) {
  const auto triangle = [](double x) {
    auto mesh = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
    mesh->beginModel();
    mesh->addTriangle({x, -1, -1}, {x, 1, -1}, {x, 0, 1});
    mesh->endModel();
    return mesh;
  };
  Cart cart;
  const auto flag = object(triangle(0)), other = object(triangle(1));
  const auto spike = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
  spike->beginModel();
  spike->addTriangle({0.2, 0, 0}, {-0.2, 0.1, 0}, {-0.2, -0.1, 0});
  spike->endModel();
  const auto tip = object(spike);
  cart.manager->unbind(cart.body.get());
  cart.manager->bind("cart", tip.get());
  cart.manager->registerObject(other.get(), "flag");
  for (const Method method : {Method::standard, Method::redon2004}) {
    CertifiedRequest request = withMargin(0.2);
    request.method = method;
    cart.manager->resetMargins();
    cart.manager->setMargin("cart", 0.1);
    cart.manager->setup();
    const CertifiedResult far = cart.run(0, 1, request);
    EXPECT_TRUE(touchesAt(far, 0.7));
    EXPECT_EQ(far.contacts.at(0).feature, FeatureKind::volume);
    cart.manager->setMargin("cart", "flag", 0);
    cart.manager->setup();
    const CertifiedResult near = cart.run(0, 1, request);
    EXPECT_TRUE(touchesAt(near, 0.8));
    EXPECT_EQ(near.contacts.at(0).feature, FeatureKind::vertexFace);
  }
}

// Balls of a turning arm among balls, with and without margins of their own. The first time at which any comes nearer
// than its margin is sampled in closed form.
TEST(Margin, RandomPairsAgainstDenseSampling) {
  std::mt19937_64 random(7);
  const auto uniform = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); };
  constexpr int kSamples = 4096;
  int hits = 0, free = 0;
  for (int n = 0; n < 200; ++n) {
    auto tree = std::make_shared<KinematicTree>("arm");
    for (const char* name : {"base", "upper", "lower"}) tree->addLink(name);
    tree->addJoint(makeJoint("shoulder", JointType::revolute, "base", "upper", Vector3d::UnitZ()));
    tree->addJoint(makeJoint("elbow", JointType::revolute, "upper", "lower", Vector3d::UnitY(), pose({1, 0, 0})));
    ArticulatedCollisionManager manager(tree);
    const auto upper = ball(0.1), lower = ball(0.1);
    manager.bind("upper", upper.get(), pose({0.7, 0, 0}));
    manager.bind("lower", lower.get(), pose({0.8, 0, 0}));
    std::vector<std::shared_ptr<fcl::CollisionObjectd>> obstacles;
    double own[2][4];  // by link and obstacle
    const double base = uniform(0, 0.1);
    for (double& margin : own[0]) margin = base;
    for (double& margin : own[1]) margin = base;
    for (int o = 0; o < 4; ++o) {
      obstacles.push_back(ball(0.1, Vector3d(uniform(-1.5, 1.5), uniform(-1.5, 1.5), uniform(-0.8, 0.8))));
      manager.registerObject(obstacles.back().get(), "o" + std::to_string(o));
    }
    double link_margin = -1;
    if (uniform(0, 1) < 0.5) manager.setMargin("lower", link_margin = uniform(0, 0.3));
    double obstacle_margin = -1;
    if (uniform(0, 1) < 0.5) manager.setMargin("o1", obstacle_margin = uniform(0, 0.3));
    for (int l = 0; l < 2; ++l) {
      for (int o = 0; o < 4; ++o) {
        const double margin = std::max(l == 1 ? link_margin : -1, o == 1 ? obstacle_margin : -1);
        if (margin >= 0) own[l][o] = margin;
      }
    }
    manager.setMargin("upper", "o2", own[0][2] = uniform(0, 0.3));
    manager.setMargin("o3", "lower", own[1][3] = uniform(0, 0.3));
    manager.setup();
    const Eigen::Vector2d q0(uniform(-3, 3), uniform(-2, 2)), q1(uniform(-3, 3), uniform(-2, 2));
    const CertifiedResult r = ask(manager, q0, q1, withMargin(base));
    double first = 2, least = 1;
    for (int i = 0; i <= kSamples && first > 1; ++i) {
      const double t = static_cast<double>(i) / kSamples;
      std::vector<Eigen::Isometry3d> M;
      tree->forwardKinematics(q0 + t * (q1 - q0), M);
      for (int o = 0; o < 4; ++o) {
        const Vector3d c = obstacles[static_cast<std::size_t>(o)]->getTranslation();
        const double gaps[2] = {(M[1] * Vector3d(0.7, 0, 0) - c).norm() - 0.2 - own[0][o],
                                (M[2] * Vector3d(0.8, 0, 0) - c).norm() - 0.2 - own[1][o]};
        least = std::min({least, gaps[0], gaps[1]});
        if (least <= 0) first = t;
      }
    }
    SCOPED_TRACE(n);
    if (first <= 1) {
      ++hits;
      EXPECT_EQ(r.status, Status::contact);
      EXPECT_LE(r.t_lower, first);
      EXPECT_GE(r.t_upper, first - 2.0 / kSamples);
    } else if (least > 5e-3) {  // between samples no ball goes so far
      ++free;
      EXPECT_TRUE(r.isFree());
    }
  }
  EXPECT_GT(hits, 40);
  EXPECT_GT(free, 40);
}

TEST(Margin, BadInputIsRefusedAndChangesNothing) {
  Way way;
  for (const double margin : {-0.1, kNaN, std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(way.manager->setMargin("cart", margin), std::invalid_argument);
    EXPECT_THROW(way.manager->setMargin("cart", "post", margin), std::invalid_argument);
  }
  EXPECT_THROW(way.manager->setMargin("cat", 0.4), std::invalid_argument);
  EXPECT_THROW(way.manager->setMargin("cart", "pots", 0.4), std::invalid_argument);
  EXPECT_THROW(way.manager->setMargin("pots", "cart", 0.4), std::invalid_argument);
  EXPECT_TRUE(touchesAt(way.run(0, 2), wallTime(0)));
}

}  // namespace margin_test
