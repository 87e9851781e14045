// SPDX-License-Identifier: BSD-3-Clause
//
// The room that last valid states keep, with margins of pairs' own. And whether a way leads through an obstacle when
// one motion after the other begins where the last one ended. The motions are accepted ones in all kinds of spaces. FCL
// judges them at many states on OMPL's own way between their ends, with poses that this file works out.
//
// FCL_ARTIC_ROOM_CASES: worlds of the campaign; FCL_ARTIC_ROOM_SEED: others.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <random>

#include <fcl/geometry/shape/capsule.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>
#include <ompl/base/ScopedState.h>
#include <ompl/base/spaces/SE2StateSpace.h>
#include <ompl/base/spaces/SE3StateSpace.h>
#include <ompl/base/spaces/SO2StateSpace.h>
#include <ompl/base/spaces/SO3StateSpace.h>

#include "fcl_artic/ompl/motion_validator.h"
#include "slide.h"

namespace fcl_artic::planning {
namespace room_test {
namespace {

namespace ob = ::ompl::base;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using Shape = std::shared_ptr<fcl::CollisionGeometryd>;
constexpr double kRoom = 1e-5;  // tolerance_distance of planningRequest()

CertifiedRequest requestOf(double margin, bool ignore) {
  CertifiedRequest request = planningRequest();
  request.margin = margin;
  request.ignore_initial_contact = ignore;
  return request;
}

/// A ball of 0.1 m, or a cube as large, on a slide along x, and a ball of 0.1 m at x = 3.
struct Slide {
  std::shared_ptr<ob::RealVectorStateSpace> space = reals(1);
  std::shared_ptr<ob::SpaceInformation> si = std::make_shared<ob::SpaceInformation>(space);
  World world;
  std::unique_ptr<ContinuousMotionValidator> validator;

  /// @param own  of the pair; below 0: none.
  Slide(bool ball, double own, const CertifiedRequest& request) : world(tree()) {
    const auto sphere = std::make_shared<fcl::Sphered>(0.1);
    const Shape cart = ball ? Shape(sphere) : std::make_shared<fcl::Boxd>(0.2, 0.2, 0.2);
    world.bind("cart", cart).obstacle(sphere, at(3, 0), "wall");
    if (own >= 0) world.margin("cart", "wall", own);
    validator = std::make_unique<ContinuousMotionValidator>(si, world.manager(), request);
  }
  static std::shared_ptr<KinematicTree> tree() {
    auto tree = std::make_shared<KinematicTree>("slide");
    for (const char* link : {"rail", "cart"}) tree->addLink(link);
    tree->addJoint(makeJoint("slide", JointType::prismatic, "rail", "cart", Vector3d::UnitX(), -10, 10));
    return tree;
  }
};

struct Setting {
  double margin, own;  ///< request's, and the pair's; below 0: none
  bool ignore;
};
constexpr Setting kSettings[] = {{0, -1, false},   {0, 0, false},      {0.05, 0, false},   {0, 0.02, false},
                                 {0, -1, true},    {0, 0, true},       {0.05, 0, true},    {0, 0.02, true},
                                 {0.05, -1, true}, {0.05, 0.02, true}, {0.01, 0.04, true}, {0.01, 0.04, false}};

// A motion that ends in contact (x = 3) is known to fewer digits than one that goes on far beyond (x = 9). So one of
// the two separates a gap from contact by its last digits, and the other does not.
TEST(Room, LastValidStateKeepsItWhateverThePairsMargin) {
  for (const Setting& setting : kSettings) {
    const double margin = setting.own >= 0 ? setting.own : setting.margin;
    for (const bool ball : {true, false}) {
      const Slide slide(ball, setting.own, requestOf(setting.margin, setting.ignore));
      for (int i = 0; i < 40; ++i) {
        const TestState from(slide.space, {-2 + 0.0937 * i}), to(slide.space, {3}), last(slide.space, {77});
        std::pair<ob::State*, double> found{last, 2};
        ASSERT_FALSE(slide.validator->checkMotion(from, to, found));
        const double gap = 2.8 - last[0] - margin;  // both bodies end 0.1 from their middles
        EXPECT_GT(gap, 2 * kRoom - 1e-12) << margin;
        EXPECT_LT(gap, 2 * kRoom + 3 * (3 - from[0]) * planningRequest().tolerance_time);
      }
    }
  }
}

TEST(Room, NoWayLeadsThroughFromALastValidState) {
  int motions = 0, through = 0;
  for (const Setting& setting : kSettings) {
    if (!setting.ignore) continue;
    for (const bool ball : {true, false}) {
      const Slide slide(ball, setting.own, requestOf(setting.margin, setting.ignore));
      for (int i = 0; i < 40; ++i) {
        const TestState from(slide.space, {-2 + 0.0937 * i}), to(slide.space, {3}), last(slide.space, {77});
        std::pair<ob::State*, double> found{last, 2};
        ASSERT_FALSE(slide.validator->checkMotion(from, to, found));
        ++motions;
        const TestState past(slide.space, {9});
        through += slide.validator->checkMotion(last, past);
        EXPECT_TRUE(slide.validator->checkMotion(last, from)) << "it can be left";
      }
    }
  }
  EXPECT_EQ(through, 0) << "of " << motions;
  EXPECT_GT(motions, 500);
}

/// The end of an accepted motion, however near it comes: whatever is not ignored there can't be at the next one's
/// start.
TEST(Room, NoWayLeadsThroughFromAnAcceptedEnd) {
  int accepted = 0, refused = 0;
  for (const Setting& setting : kSettings) {
    if (!setting.ignore) continue;
    const double contact = 2.8 - (setting.own >= 0 ? setting.own : setting.margin);
    const Slide slide(true, setting.own, requestOf(setting.margin, true));
    for (int i = 0; i < 200; ++i) {
      const double gap = std::pow(10.0, -2 - 0.06 * i);  // down to 1e-14
      const TestState from(slide.space, {0}), end(slide.space, {contact - gap}), to(slide.space, {9});
      const bool valid = slide.validator->checkMotion(from, end);
      (valid ? accepted : refused)++;
      if (gap > 1.6 * kRoom || gap < 0.999 * kRoom) {
        EXPECT_EQ(valid, gap > kRoom) << gap;
      }
      if (valid) {
        EXPECT_FALSE(slide.validator->checkMotion(end, to)) << gap;
      }
    }
  }
  EXPECT_GT(accepted, 100);
  EXPECT_GT(refused, 100);
}

// --- The campaign.

/// A robot of one body, or two, in a space that drives all of its joints.
struct Kind {
  const char* name;
  ob::StateSpacePtr space;
  std::shared_ptr<KinematicTree> tree;
  std::vector<std::string> links;                                        ///< that carry a body
  std::function<std::vector<Isometry3d>(const ob::State* state)> poses;  ///< of these, by our own reckoning
};

Isometry3d turned(double angle) {
  return Isometry3d(Eigen::AngleAxisd(angle, Vector3d::UnitZ()));
}
Isometry3d moved(double x, double y, double z = 0) {
  return Isometry3d(Eigen::Translation3d(x, y, z));
}
Eigen::Quaterniond rotation(const ob::SO3StateSpace::StateType& q) {
  return Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized();
}

/// A joint's frame is its parent's, 0.9 m along x where the parent is an arm.
std::shared_ptr<KinematicTree> treeOf(const std::vector<std::pair<JointType, Vector3d>>& joints) {
  auto tree = std::make_shared<KinematicTree>("robot");
  tree->addLink("l0");
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const std::string parent = "l" + std::to_string(i), child = "l" + std::to_string(i + 1);
    tree->addLink(child);
    Joint joint = makeJoint("j" + std::to_string(i), joints[i].first, parent, child, joints[i].second, -10, 10);
    if (i) joint.origin = moved(0.9, 0);
    tree->addJoint(joint);
  }
  return tree;
}

std::vector<Kind> kinds() {
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  ob::RealVectorBounds plane(2), room(3);
  plane.setLow(-2);
  plane.setHigh(2);
  room.setLow(-2);
  room.setHigh(2);
  const auto so2 = std::make_shared<ob::SO2StateSpace>();
  const auto so3 = std::make_shared<ob::SO3StateSpace>();
  const auto se2 = std::make_shared<ob::SE2StateSpace>();
  const auto se3 = std::make_shared<ob::SE3StateSpace>();
  se2->setBounds(plane);
  se3->setBounds(room);
  const auto both = [](const ob::StateSpacePtr& a, const ob::StateSpacePtr& b) {
    return std::make_shared<ob::CompoundStateSpace>(std::vector<ob::StateSpacePtr>{a, b}, std::vector<double>{1, 1});
  };
  const auto angleOf = [](const ob::State* s) { return s->as<ob::SO2StateSpace::StateType>()->value; };
  const auto se2Pose = [](const ob::State* s) {
    const auto& at = *s->as<ob::SE2StateSpace::StateType>();
    return moved(at.getX(), at.getY()) * turned(at.getYaw());
  };
  const auto part = [](const ob::State* s, unsigned i) { return s->as<ob::CompoundState>()->components[i]; };
  return {
      {"RealVector",
       reals(3, 2),
       treeOf({{JointType::prismatic, x}, {JointType::prismatic, y}, {JointType::revolute, z}}),
       {"l2", "l3"},
       [](const ob::State* s) {
         const double* q = s->as<ob::RealVectorStateSpace::StateType>()->values;
         const Isometry3d slid = moved(q[0], 0) * moved(0.9, q[1]);
         return std::vector<Isometry3d>{slid, slid * moved(0.9, 0) * turned(q[2])};
       }},
      {"SO2",
       so2,
       treeOf({{JointType::continuous, z}}),
       {"l1"},
       [=](const ob::State* s) { return std::vector<Isometry3d>{turned(angleOf(s))}; }},
      {"SE2",
       se2,
       treeOf({{JointType::planar, z}}),
       {"l1"},
       [=](const ob::State* s) { return std::vector<Isometry3d>{se2Pose(s)}; }},
      {"SO3",
       so3,
       treeOf({{JointType::spherical, x}}),
       {"l1"},
       [](const ob::State* s) {
         return std::vector<Isometry3d>{Isometry3d(rotation(*s->as<ob::SO3StateSpace::StateType>()))};
       }},
      {"SE3",
       se3,
       treeOf({{JointType::floating, x}}),
       {"l1"},
       [](const ob::State* s) {
         const auto& at = *s->as<ob::SE3StateSpace::StateType>();
         return std::vector<Isometry3d>{moved(at.getX(), at.getY(), at.getZ()) * rotation(at.rotation())};
       }},
      {"RealVector and SO2",
       both(reals(1, 2), so2),
       treeOf({{JointType::prismatic, x}, {JointType::continuous, z}}),
       {"l1", "l2"},
       [=](const ob::State* s) {
         const Isometry3d cart = moved(part(s, 0)->as<ob::RealVectorStateSpace::StateType>()->values[0], 0);
         return std::vector<Isometry3d>{cart, cart * moved(0.9, 0) * turned(angleOf(part(s, 1)))};
       }},
      {"SE2 and SO2",
       both(se2, so2),
       treeOf({{JointType::planar, z}, {JointType::continuous, z}}),
       {"l1", "l2"},
       [=](const ob::State* s) {
         const Isometry3d base = se2Pose(part(s, 0));
         return std::vector<Isometry3d>{base, base * moved(0.9, 0) * turned(angleOf(part(s, 1)))};
       }},
  };
}

struct Count {
  long worlds = 0, motions = 0, accepted = 0, starts_in_contact = 0, left = 0, last_valid = 0, second = 0,
       second_accepted = 0, near_contact = 0, samples = 0, wrong = 0, no_room = 0, not_left = 0;
};
std::ostream& operator<<(std::ostream& out, const Count& c) {
  return out << c.worlds << " worlds, " << c.motions << " first motions, " << c.accepted << " accepted ("
             << c.starts_in_contact << " start in contact, " << c.left << " of them accepted), " << c.last_valid
             << " last valid states, " << c.second << " motions from them and from accepted ends, " << c.second_accepted
             << " accepted; " << c.samples << " samples, " << c.near_contact
             << " accepted motions within 0.01 m of contact; wrong " << c.wrong << ", without room " << c.no_room
             << ", not to be left " << c.not_left;
}

class Campaign {
 public:
  Campaign(const Kind& kind, std::uint64_t seed, Count& count) : kind_(kind), random_(seed), count_(count) {}

  void world() {
    ++count_.worlds;
    shapes_.clear();
    obstacles_.clear();
    const auto si = std::make_shared<ob::SpaceInformation>(kind_.space);
    World world(kind_.tree);
    for (const std::string& link : kind_.links) {
      const Shape shape =
          uniform(0, 1) < 0.5 ? Shape(std::make_shared<fcl::Sphered>(0.1)) : std::make_shared<fcl::Capsuled>(0.05, 0.3);
      const Isometry3d offset = moved(
          kind_.space->getType() == ob::STATE_SPACE_SO2 || kind_.space->getType() == ob::STATE_SPACE_SO3 || link == "l3"
              ? 1.0
              : 0.2,
          0);
      shapes_.push_back({shape, offset});
      world.bind(link, shape, offset);
    }
    for (int o = 0; o < 3; ++o) {
      const double out = uniform(0, 6.2832), reach = uniform(0.8, 1.2);
      const bool in_room = kind_.name == std::string("SO3") || kind_.name == std::string("SE3");
      const Isometry3d pose = moved(reach * std::cos(out), reach * std::sin(out), in_room ? uniform(-0.5, 0.5) : 0) *
                              turned(uniform(-3, 3));
      const Shape shape =
          uniform(0, 1) < 0.5 ? Shape(std::make_shared<fcl::Sphered>(0.1)) : std::make_shared<fcl::Boxd>(0.2, 0.5, 0.5);
      obstacles_.push_back({shape, pose});
      world.obstacle(shape, pose, "o" + std::to_string(o));
    }
    // Margins: of the request, of some bodies, of some pairs.
    const double kMargins[] = {0, 0, 0.02, 0.1};
    const auto margin = [&] { return kMargins[static_cast<int>(uniform(0, 4))]; };
    const double requested = margin();
    margins_.assign(shapes_.size(), std::vector<double>(obstacles_.size(), requested));
    for (std::size_t l = 0; l < shapes_.size(); ++l) {
      for (std::size_t o = 0; o < obstacles_.size(); ++o) {
        if (uniform(0, 1) < 0.4) continue;
        margins_[l][o] = margin();
        world.margin(kind_.links[l], "o" + std::to_string(o), margins_[l][o]);
      }
    }
    // Only obstacles are judged.
    ignore_ = uniform(0, 1) < 0.6;
    CertifiedRequest request = requestOf(requested, ignore_);
    request.check_self = false;
    validator_ = std::make_unique<ContinuousMotionValidator>(si, world.manager(), request);
    checker_ = std::make_unique<CollisionStateValidityChecker>(si, world.manager(), request);
    for (int i = 0; i < 6; ++i) firstMotion();
  }

 private:
  struct Placed {
    Shape shape;
    Isometry3d pose;
  };

  double uniform(double a, double b) { return std::uniform_real_distribution<double>(a, b)(random_); }

  /// FCL's distance beyond the margin. (Below 0: touches.)
  double gap(std::size_t l, std::size_t o, const std::vector<Isometry3d>& poses) const {
    fcl::CollisionObjectd a(shapes_[l].shape, poses[l] * shapes_[l].pose), b(obstacles_[o].shape, obstacles_[o].pose);
    fcl::CollisionResultd touching;
    if (fcl::collide(&a, &b, fcl::CollisionRequestd(), touching)) return -1;
    fcl::DistanceResultd result;
    return fcl::distance(&a, &b, fcl::DistanceRequestd(), result) - margins_[l][o];
  }

  /// Pairs that are within their margins at a state, or nearly.
  std::vector<std::vector<bool>> touchingAt(const ob::State* state) const {
    const std::vector<Isometry3d> poses = kind_.poses(state);
    std::vector<std::vector<bool>> touching(shapes_.size(), std::vector<bool>(obstacles_.size()));
    for (std::size_t l = 0; l < shapes_.size(); ++l) {
      for (std::size_t o = 0; o < obstacles_.size(); ++o) touching[l][o] = gap(l, o, poses) < 1e-6;
    }
    return touching;
  }

  /// Looks at an accepted motion. @param excused  pairs that may touch on it.
  void judge(const ob::State* s1, const ob::State* s2, const std::vector<std::vector<bool>>& excused,
             const char* what) {
    constexpr int kSamples = 256;
    ob::ScopedState<> state(kind_.space);
    double least = 1;
    for (int i = 0; i <= kSamples; ++i) {
      kind_.space->interpolate(s1, s2, i / (1.0 * kSamples), state.get());
      const std::vector<Isometry3d> poses = kind_.poses(state.get());
      ++count_.samples;
      for (std::size_t l = 0; l < shapes_.size(); ++l) {
        for (std::size_t o = 0; o < obstacles_.size(); ++o) {
          if (!excused.empty() && excused[l][o]) continue;
          least = std::min(least, gap(l, o, poses));
        }
      }
    }
    count_.near_contact += least < 0.01;
    if (least > -1e-6) return;  // what FCL's distances are good for
    if (++count_.wrong < 10) ADD_FAILURE() << kind_.name << ": " << what << " comes " << least << " too near";
  }

  void sample(ob::State* state, bool in_contact) {
    for (int i = 0; i < 30; ++i) {
      sample(*kind_.space, state);
      if (!in_contact || anyOf(touchingAt(state))) return;
    }
  }

  /// A state anywhere: positions within 2 m, of slides too.
  void sample(const ob::StateSpace& space, ob::State* state) {
    switch (space.getType()) {
      case ob::STATE_SPACE_SO2:
        state->as<ob::SO2StateSpace::StateType>()->value = uniform(-3.14, 3.14);
        return;
      case ob::STATE_SPACE_SO3: {
        std::normal_distribution<double> normal;
        auto& q = *state->as<ob::SO3StateSpace::StateType>();
        q.x = normal(random_), q.y = normal(random_), q.z = normal(random_), q.w = normal(random_);
        return space.enforceBounds(state);
      }
      case ob::STATE_SPACE_REAL_VECTOR:
        for (unsigned i = 0; i < space.getDimension(); ++i) {
          state->as<ob::RealVectorStateSpace::StateType>()->values[i] = uniform(-2, 2);
        }
        return;
      default:
        const auto& compound = static_cast<const ob::CompoundStateSpace&>(space);
        for (unsigned i = 0; i < compound.getSubspaceCount(); ++i) {
          sample(*compound.getSubspace(i), state->as<ob::CompoundState>()->components[i]);
        }
    }
  }

  static bool anyOf(const std::vector<std::vector<bool>>& pairs) {
    return std::any_of(pairs.begin(), pairs.end(),
                       [](const std::vector<bool>& row) { return std::count(row.begin(), row.end(), true) > 0; });
  }

  /// Takes angles and quaternions that were extrapolated to where their spaces have them.
  static void wrap(const ob::StateSpace& space, ob::State* state) {
    const int type = space.getType();
    if (type == ob::STATE_SPACE_SO2 || type == ob::STATE_SPACE_SO3) return space.enforceBounds(state);
    if (!space.isCompound()) return;
    const auto& compound = static_cast<const ob::CompoundStateSpace&>(space);
    for (unsigned i = 0; i < compound.getSubspaceCount(); ++i) {
      wrap(*compound.getSubspace(i), state->as<ob::CompoundState>()->components[i]);
    }
  }

  void firstMotion() {
    ob::ScopedState<> s1(kind_.space), s2(kind_.space), last(kind_.space);
    sample(s1.get(), uniform(0, 1) < 0.2);
    sample(s2.get(), uniform(0, 1) < 0.5);
    ++count_.motions;
    const auto start = touchingAt(s1.get());
    const bool contact = anyOf(start);
    count_.starts_in_contact += contact;
    std::pair<ob::State*, double> found{last.get(), 2};
    if (validator_->checkMotion(s1.get(), s2.get(), found)) {
      ++count_.accepted;
      count_.left += contact;
      judge(s1.get(), s2.get(), ignore_ ? start : std::vector<std::vector<bool>>(), "a first motion");
      if (ignore_) nextMotions(s2.get(), s1.get(), "a motion from an accepted end");
      return;
    }
    if (found.second == 0) return;
    ++count_.last_valid;
    judge(s1.get(), last.get(), ignore_ ? start : std::vector<std::vector<bool>>(), "the motion to a last valid state");
    const std::vector<Isometry3d> poses = kind_.poses(last.get());
    for (std::size_t l = 0; l < shapes_.size(); ++l) {
      for (std::size_t o = 0; o < obstacles_.size(); ++o) {
        const bool round = shapes_[l].shape->getNodeType() == fcl::GEOM_SPHERE;  // FCL's distance is in closed form
        count_.no_room += round && gap(l, o, poses) < 1.9 * kRoom && !(ignore_ && contact);
      }
    }
    count_.no_room += !checker_->isValid(last.get());
    if (!contact) count_.not_left += !validator_->checkMotion(last.get(), s1.get());
    nextMotions(last.get(), s2.get(), "a motion from a last valid state");
  }

  /// On to where the first one was bound for, far past that, and to somewhere else.
  void nextMotions(const ob::State* from, const ob::State* to, const char* what) {
    ob::ScopedState<> target(kind_.space);
    for (int i = 0; i < 5; ++i) {
      if (i == 0) {
        kind_.space->copyState(target.get(), to);
      } else if (i < 3) {
        kind_.space->interpolate(from, to, uniform(1, i == 1 ? 2 : 8), target.get());
        wrap(*kind_.space, target.get());
      } else {
        sample(*kind_.space, target.get());
      }
      ++count_.second;
      if (!validator_->checkMotion(from, target.get())) continue;
      ++count_.second_accepted;
      judge(from, target.get(), {}, what);
    }
  }

  const Kind& kind_;
  std::mt19937_64 random_;
  Count& count_;
  std::vector<Placed> shapes_, obstacles_;
  std::vector<std::vector<double>> margins_;  ///< by link and obstacle
  bool ignore_ = false;
  std::unique_ptr<ContinuousMotionValidator> validator_;
  std::unique_ptr<CollisionStateValidityChecker> checker_;
};

long fromEnvironment(const char* name, long otherwise) {
  const char* const value = std::getenv(name);
  return value ? std::atol(value) : otherwise;
}

TEST(Room, AcceptedMotionsInAllSpacesAgainstFcl) {
  const long cases = fromEnvironment("FCL_ARTIC_ROOM_CASES", 15);
  const long seed = fromEnvironment("FCL_ARTIC_ROOM_SEED", 1);
  for (const Kind& kind : kinds()) {
    Count count;
    Campaign campaign(kind, static_cast<std::uint64_t>(seed), count);
    for (long i = 0; i < cases; ++i) campaign.world();
    std::cout << kind.name << ", seed " << seed << ": " << count << '\n';
    EXPECT_EQ(count.wrong, 0);
    EXPECT_EQ(count.no_room, 0);
    EXPECT_EQ(count.not_left, 0);
    EXPECT_GT(count.accepted, cases / 5) << "telling";
    EXPECT_GT(count.last_valid, cases / 5) << "telling";
    EXPECT_GT(count.second_accepted, cases / 5) << "telling";
    EXPECT_GT(count.near_contact, 0) << "telling";
  }
}

}  // namespace
}  // namespace room_test
}  // namespace fcl_artic::planning
