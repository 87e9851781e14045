// SPDX-License-Identifier: BSD-3-Clause
//
// Proofs over the whole ranges of joints, against FCL: of two random links the nearest configuration that a search with
// FCL's distances finds within the limits is a fact. A proof that the links keep more than that is false; one that they
// keep half of it should be there.
#include <cstdlib>
#include <iostream>

#include <fcl/narrowphase/distance.h>
#include <gtest/gtest.h>

#include "fcl_artic/manager.h"
#include "random_links.h"

namespace range_proofs_test {

using namespace fcl_artic;
using Eigen::VectorXd;
using tables::RandomLinks;

namespace {

/// FCL's distances of shapes are within this of the truth (its default tolerance 1e-6, measured 2e-6 at most).
constexpr double kFclError = 1e-5;

std::uint64_t asked(const char* name, std::uint64_t otherwise) {
  const char* text = std::getenv(name);
  return text ? std::strtoull(text, nullptr, 10) : otherwise;
}

/// Two links with two to six turns and slides between them, some of which follow others, on one or both sides of where
/// they part.
struct LongLinks {
  std::shared_ptr<KinematicTree> tree = std::make_shared<KinematicTree>("long");
  std::shared_ptr<fcl::CollisionObjectd> a, b;
  Eigen::Isometry3d on_a, on_b;

  explicit LongLinks(pairs::Random& random) {
    const int joints = 2 + random.below(5), part = random.chance(0.5) ? 0 : random.below(joints);
    tree->addLink("root");
    std::string at = "root";
    for (int i = 0; i < joints; ++i) {
      if (i == part) {
        first_ = at;
        at = "root";  // what comes now carries b
      }
      Joint joint;
      joint.name = "j" + std::to_string(i);
      joint.parent = at;
      joint.child = "l" + std::to_string(i);
      joint.type = random.chance(0.8) ? JointType::revolute : JointType::prismatic;
      joint.axis = random.direction();
      joint.origin.translation() = random.vector(0, 0.5);
      const double range = joint.type == JointType::revolute ? random.uniform(0.2, 4) : random.uniform(0.02, 0.4);
      joint.lower = random.uniform(-range, 0);
      joint.upper = joint.lower + range;
      if (joint.type == JointType::revolute && random.chance(0.15)) joint.lower = joint.upper = 0;  // no limits
      if (i > 0 && random.chance(0.15)) {
        joint.mimics = true;
        joint.mimic = {"j0", random.uniform(-2, 2), random.uniform(-0.5, 0.5)};
      }
      tree->addLink(joint.child);
      tree->addJoint(joint);
      at = joint.child;
    }
    a = shape(random);
    b = shape(random);
    link_a = first_;
    link_b = at;
    on_a = placed(random);
    on_b = placed(random);
  }
  std::string link_a, link_b;

 private:
  static Eigen::Isometry3d placed(pairs::Random& random) {
    Eigen::Isometry3d M = Eigen::Isometry3d::Identity();
    M.linear() = random.rotation();
    M.translation() = random.vector(0, 0.3);
    return M;
  }
  static std::shared_ptr<fcl::CollisionObjectd> shape(pairs::Random& random) {
    const double size = random.logUniform(0.01, 0.3);
    std::shared_ptr<fcl::CollisionGeometryd> geometry;
    switch (random.below(3)) {
      case 0:
        geometry = std::make_shared<fcl::Sphered>(size);
        break;
      case 1:
        geometry = std::make_shared<fcl::Capsuled>(size, random.uniform(0.5, 4) * size);
        break;
      default:
        geometry = std::make_shared<fcl::Boxd>(size, random.uniform(0.3, 3) * size, random.uniform(0.3, 3) * size);
    }
    return std::make_shared<fcl::CollisionObjectd>(geometry);
  }
  std::string first_;
};

/// Both kinds of links as the test sees them.
struct Links {
  std::shared_ptr<const KinematicTree> tree;
  std::shared_ptr<const fcl::CollisionObjectd> a, b;
  Eigen::Isometry3d on_a, on_b;
  std::string link_a, link_b;

  explicit Links(const RandomLinks& links)
      : tree(links.tree), a(links.a), b(links.b), on_a(links.on_a), on_b(links.on_b), link_a("a"), link_b("b") {}
  explicit Links(const LongLinks& links)
      : tree(links.tree),
        a(links.a),
        b(links.b),
        on_a(links.on_a),
        on_b(links.on_b),
        link_a(links.link_a),
        link_b(links.link_b) {}

  double distance(const VectorXd& q, fcl::GJKSolverType solver = fcl::GST_LIBCCD) const {
    std::vector<Eigen::Isometry3d> M_0;
    tree->forwardKinematics(q, M_0);
    fcl::DistanceRequestd request;
    request.gjk_solver_type = solver;
    fcl::DistanceResultd result;
    return fcl::distance(a->collisionGeometry().get(), M_0[static_cast<std::size_t>(tree->linkId(link_a))] * on_a,
                         b->collisionGeometry().get(), M_0[static_cast<std::size_t>(tree->linkId(link_b))] * on_b,
                         request, result);
  }

  /// By the one of FCL's solvers that finds less: some of libccd's distances are nearly a millimetre too large.
  double leastDistance(const VectorXd& q) const { return std::min(distance(q), distance(q, fcl::GST_INDEP)); }

  std::pair<double, double> range(int v) const {
    const Joint& joint = tree->joint(tree->variableJoint(v));
    return hasLimits(joint) ? std::make_pair(joint.lower, joint.upper) : std::make_pair(-9.0, 9.0);
  }

  /// The smallest distance within the limits that a search finds; 0 where they touch.
  double nearest(pairs::Random& random, VectorXd& best) const {
    double least = std::numeric_limits<double>::infinity();
    for (int start = 0; start < 6; ++start) {
      VectorXd q(tree->dof());
      double here = std::numeric_limits<double>::infinity();
      double step = 1;
      for (int i = 0; i < 150 && here > 0; ++i) {
        VectorXd other(tree->dof());
        for (int v = 0; v < tree->dof(); ++v) {
          const auto [lower, upper] = range(v);
          other[v] = i < 30 ? random.uniform(lower, upper)
                            : q[v] + (random.chance(0.5) ? random.uniform(-0.5, 0.5) * step * (upper - lower) : 0);
          other[v] = random.chance(0.03) ? lower : random.chance(0.03) ? upper : std::clamp(other[v], lower, upper);
        }
        const double there = std::max(0.0, distance(other));
        if (there < here) {
          here = there;
          q = other;
        } else if (i >= 30) {
          step *= 0.95;
        }
      }
      if (here < least) {
        least = here;
        best = q;
      }
    }
    return least;
  }
};

struct Counts {
  std::uint64_t links = 0, touching = 0, proven = 0, unproven = 0, near = 0, wrong = 0;
};

LinkPairFinding classify(const Links& links, double margin, LinkPairReport* whole = nullptr) {
  ArticulatedCollisionManager manager(links.tree);
  manager.bind(links.link_a, links.a, links.on_a);
  manager.bind(links.link_b, links.b, links.on_b);
  LinkPairOptions options;
  options.margin = margin;
  options.threads = 1;
  options.samples = 50;
  options.work = 100000;
  const LinkPairReport report = manager.classifyLinkPairs(options);
  if (whole) *whole = report;
  return report.pairs.at(0);
}

void run(const Links& links, pairs::Random& random, Counts& counts) {
  VectorXd q;
  const double nearest = links.nearest(random, q);
  ++counts.links;
  counts.touching += nearest <= 0;
  // More than they keep: by a little and by more. Between margins near the distance lies what faults of levers show.
  for (const double more : {1.001, 1.05, 1.3}) {
    const double margin = nearest * more + kFclError;
    const LinkPairFinding finding = classify(links, margin);
    if (finding.neighbours) return;
    counts.wrong += finding.kind == LinkPairKind::never;
    EXPECT_NE(finding.kind, LinkPairKind::never)
        << "margin " << margin << ", but FCL says " << nearest << " at " << q.transpose();
  }
  if (nearest <= 0) {
    const LinkPairFinding finding = classify(links, 0);
    EXPECT_NE(finding.kind, LinkPairKind::never) << "they touch at " << q.transpose();
    return;
  }
  for (const double less : {0.5, 0.9}) {
    const LinkPairFinding finding = classify(links, nearest * less);
    const bool proven = finding.kind == LinkPairKind::never;
    (proven ? counts.proven : counts.unproven) += 1;
    counts.near += proven && less > 0.8;
    // The stated least distance is an upper bound, reached in the configuration.
    if (std::isfinite(finding.nearest) && finding.configuration.size() > 0) {
      EXPECT_LE(links.leastDistance(finding.configuration), finding.nearest + kFclError);
    }
    // A pair that is found in contact is so: the configuration lies within the limits, and FCL agrees.
    if (finding.kind == LinkPairKind::always || finding.kind == LinkPairKind::sometimes) {
      ASSERT_EQ(finding.configuration.size(), links.tree->dof());
      EXPECT_LE(links.leastDistance(finding.configuration), nearest * less + kFclError);
      for (int v = 0; v < links.tree->dof(); ++v) {
        const auto [lower, upper] = links.range(v);
        EXPECT_GE(finding.configuration[v], lower);
        EXPECT_LE(finding.configuration[v], upper);
      }
    }
  }
}

}  // namespace

/// Two arms on one root, in a plane and across the arms' turns. The reach of each is a sum of lengths, and so is the
/// smallest distance of their ends. Any number of turns, slides and joints that follow others are on the way.
///
///     D (= reaches of a and b, and the gap)
///     o--turn--slide--turn-- ... (a)   gap   (b) ... --turn--o
struct PlaneArms {
  std::shared_ptr<KinematicTree> tree = std::make_shared<KinematicTree>("arms");
  std::shared_ptr<fcl::CollisionObjectd> a, b;
  Eigen::Isometry3d on_a = Eigen::Isometry3d::Identity(), on_b = on_a;
  std::string link_a = "root", link_b;
  double gap;

  explicit PlaneArms(pairs::Random& random) : gap(random.logUniform(0.003, 0.3)), turned_(random.rotation()) {
    tree->addLink("root");
    const int of_a = random.below(4), of_b = random.below(4) + (of_a == 0);
    const double reach_a = addArm(random, "a", of_a, 0, link_a, a, on_a);
    // One's reach is known before it is known where it stands: the arm is made anew at its place.
    pairs::Random again = random;
    auto other = std::make_shared<KinematicTree>(*tree);
    std::swap(tree, other);
    const double reach_b = addArm(random, "b", of_b, 0, link_b, b, on_b);
    std::swap(tree, other);
    random = again;
    addArm(random, "b", of_b, reach_a + reach_b + gap, link_b, b, on_b);
  }

 private:
  /// @return what the arm reaches, from its first turn on.
  double addArm(pairs::Random& random, const std::string& name, int joints, double away, std::string& link,
                std::shared_ptr<fcl::CollisionObjectd>& ball, Eigen::Isometry3d& on) {
    double reach = 0;
    Eigen::Vector3d at(0, away, 0);  // the next joint, seen from the one before
    Eigen::Matrix3d turned = turned_;
    link = "root";
    std::string slide;
    for (int i = 0; i < joints; ++i) {
      Joint joint;
      joint.name = name + std::to_string(i);
      joint.parent = link;
      joint.child = link = name + "_link" + std::to_string(i);
      joint.origin.linear() = turned;
      joint.origin.translation() = i == 0 ? Eigen::Vector3d(turned_ * at) : at;
      if (i > 0) reach += at.norm();
      if (i == 0 || random.chance(0.5)) {
        joint.type = JointType::revolute;
        joint.axis = Eigen::Vector3d::UnitZ();
        joint.lower = joint.upper = 0;  // no limits
      } else {
        joint.type = JointType::prismatic;
        joint.axis = Eigen::Vector3d::UnitX();
        joint.lower = random.uniform(0, 0.1);
        joint.upper = joint.lower + random.uniform(0.01, 0.2);
        if (!slide.empty() && random.chance(0.5)) {
          joint.mimics = true;
          joint.mimic = {slide, random.uniform(0.2, 2), random.uniform(0, 0.1)};
          reach += joint.mimic.multiplier * most_ + joint.mimic.offset;
        } else {
          slide = joint.name;
          reach += most_ = joint.upper;
        }
      }
      tree->addLink(joint.child);
      tree->addJoint(joint);
      at = Eigen::Vector3d(random.uniform(0.05, 0.4), 0, 0);
      turned.setIdentity();
    }
    const double radius = random.uniform(0.01, 0.1);
    ball = std::make_shared<fcl::CollisionObjectd>(std::make_shared<fcl::Sphered>(radius));
    on = Eigen::Isometry3d::Identity();
    on.translation() = joints == 0 ? Eigen::Vector3d(turned_ * at) : at;
    return reach + radius + (joints == 0 ? 0 : at.norm());
  }
  Eigen::Matrix3d turned_;
  double most_ = 0;
};

TEST(RangeProofs, KeepWhatFclFindsNearest) {
  const std::uint64_t n = asked("FCL_ARTIC_RANGE_LINKS", 400), seed = asked("FCL_ARTIC_SEED", 1);
  Counts counts;
  for (std::uint64_t i = 0; i < n && !HasFatalFailure() && counts.wrong < 5; ++i) {
    pairs::Random random(seed * 1000003 + i);
    SCOPED_TRACE("seed " + std::to_string(seed) + ", links " + std::to_string(i));
    if (random.chance(0.3)) {
      run(Links(RandomLinks(random)), random, counts);
    } else {
      run(Links(LongLinks(random)), random, counts);
    }
  }
  std::cout << counts.links << " pairs of links, " << counts.touching
            << " touch; margins below the distance: " << counts.proven << " proven, " << counts.near
            << " of them at 0.9 of it, " << counts.unproven << " not; wrong: " << counts.wrong << "\n";
  EXPECT_GT(counts.touching, n / 10);
  EXPECT_GT(counts.near, n / 10);
}

// The arms' ends come as near as the gap where both are stretched towards each other, and balls about the first turns
// hold all that they reach. A proof of more is false, and one of a little less needs next to no work. Joints go 1/1000
// of their ranges beyond their limits, which the proof pays for.
TEST(RangeProofs, OfStretchedArmsEndAtTheirReach) {
  const std::uint64_t n = asked("FCL_ARTIC_RANGE_LINKS", 400), seed = asked("FCL_ARTIC_SEED", 1);
  std::uint64_t wrong = 0, proven = 0;
  for (std::uint64_t i = 0; i < n; ++i) {
    pairs::Random random(seed * 1000003 + i);
    SCOPED_TRACE("seed " + std::to_string(seed) + ", arms " + std::to_string(i));
    const PlaneArms arms(random);
    const auto kind = [&](double margin) {
      ArticulatedCollisionManager manager(arms.tree);
      manager.bind(arms.link_a, arms.a, arms.on_a);
      manager.bind(arms.link_b, arms.b, arms.on_b);
      LinkPairOptions options;
      options.margin = margin;
      options.threads = 1;
      options.samples = 10;
      options.work = 10000;
      return manager.classifyLinkPairs(options).pairs.at(0).kind;
    };
    const LinkPairKind more = kind(arms.gap + 1e-6), less = kind(arms.gap - 0.0025);
    EXPECT_NE(more, LinkPairKind::never) << "margin " << arms.gap + 1e-6 << ", but they keep " << arms.gap;
    wrong += more == LinkPairKind::never;
    EXPECT_EQ(less, LinkPairKind::never) << "they keep " << arms.gap;
    proven += less == LinkPairKind::never;
  }
  std::cout << n << " pairs of arms, " << proven << " proven, " << wrong << " wrong\n";
  EXPECT_GT(proven, n / 2);
}

}  // namespace range_proofs_test
