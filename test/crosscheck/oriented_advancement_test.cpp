// SPDX-License-Identifier: BSD-3-Clause
//
// Certified answers, of every method, beside FCL's oriented conservative advancement on RSS trees, on the same motions.
//
// What FCL's answer means. It advances by d / bound, where d is a distance and bound the one of FclLinkMotion, and
// stops when that step is at most 1e-5: so it never passes a contact, and when it reports one at t > 0 the gap there is
// at most 1e-5 times the speed bound of the pair. It may thus be early, by much where bodies approach slowly, or report
// a near miss: then the pair is sampled from there on. It says free also when the step that would reach the contact
// ends past t = 1, or when it stands within 1e-5 of the end. All that is allowed for below; nothing else is.
//
// FCL_ARTIC_CROSSCHECK_QUERIES sets the number of queries of each test.

#include <algorithm>
#include <iostream>
#include <memory>
#include <optional>
#include <vector>

#include <fcl/narrowphase/distance.h>
#include <gtest/gtest.h>

#include "../campaign/expect.h"
#include "fcl_artic/manager.h"
#include "random_robot.h"
#include "rivals.h"

namespace fcl_artic {
namespace oriented_advancement_test {
namespace {

using bench::kFree;
using bench::Random;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using Mesh = fcl::BVHModel<fcl::RSSd>;

constexpr double kFclStep = 1e-5;    // FCL's t_err for mesh pairs
constexpr double kAgreement = 1e-4;  // times nearer than this count as equal; the rest needs its explanation
constexpr double kRounding = 1e-9;   // of FCL's distances and of a time computed from them

struct Body {
  LinkId link;  // -1: an obstacle, at `offset` in the world
  Isometry3d offset;
  std::shared_ptr<Mesh> mesh;
  std::unique_ptr<fcl::CollisionObjectd> object;
};

struct Query {
  std::shared_ptr<const KinematicTree> tree;
  std::optional<JointMotion> motion;
  std::vector<Body> bodies;
  std::vector<std::pair<std::size_t, std::size_t>> pairs;  // those to check, by index
};

// Neighbours overlap at their joint. Links rigidly attached to one another count as one here, which leaves out more
// pairs than the manager does by itself; the others are allowed to it by name.
LinkId rigidGroup(const KinematicTree& tree, LinkId link) {
  while (tree.parentJoint(link) >= 0 && tree.joint(tree.parentJoint(link)).type == JointType::fixed) {
    link = tree.parentLink(link);
  }
  return link;
}

bool adjacent(const KinematicTree& tree, LinkId a, LinkId b) {
  const LinkId ga = rigidGroup(tree, a), gb = rigidGroup(tree, b);
  const auto parentGroup = [&](LinkId g) {
    return tree.parentJoint(g) < 0 ? -1 : rigidGroup(tree, tree.parentLink(g));
  };
  return ga == gb || parentGroup(ga) == gb || parentGroup(gb) == ga;
}

std::unique_ptr<fcl::MotionBased> motionOf(const Query& query, const Body& body) {
  if (body.link < 0) return std::make_unique<fcl::TranslationMotion<double>>(bench::still(body.offset));
  return std::make_unique<FclLinkMotion>(*query.tree, *query.motion, body.link, body.offset);
}

double gap(const Query& query, std::size_t a, std::size_t b, double t) {
  fcl::Transform3d M[2];
  const std::size_t index[2] = {a, b};
  for (int k = 0; k < 2; ++k) {
    const auto motion = motionOf(query, query.bodies[index[k]]);
    motion->integrate(t);
    motion->getCurrentTransform(M[k]);
  }
  fcl::DistanceRequestd request;
  fcl::DistanceResultd result;
  fcl::distance(query.bodies[a].mesh.get(), M[0], query.bodies[b].mesh.get(), M[1], request, result);
  return std::max(0.0, result.min_distance);
}

// First of a series of times in [from, to), denser at its beginning, at which the pair touches; 2: none.
double sampledContact(const Query& query, std::size_t a, std::size_t b, double from, double to) {
  constexpr int kSamples = 200;
  for (int i = 0; i < kSamples; ++i) {
    const double s = static_cast<double>(i) / kSamples, t = from + (to - from) * s * s;
    if (gap(query, a, b, t) == 0) return t;
  }
  return kFree;
}

double meshRadius(const Mesh& mesh) {
  double r = 0;
  for (int i = 0; i < mesh.num_vertices; ++i) r = std::max(r, mesh.vertices[i].norm());
  return r;
}

double speedBound(const Query& query, std::size_t index) {
  const Body& body = query.bodies[index];
  if (body.link < 0) return 0;
  return FclLinkMotion(*query.tree, *query.motion, body.link, body.offset).speedBound(meshRadius(*body.mesh));
}

struct FclAnswer {
  double toc = kFree;
  std::size_t a = 0, b = 0;  // the pair
};

FclAnswer askFcl(const Query& query) {
  FclAnswer answer;
  for (const auto& [a, b] : query.pairs) {
    const auto motion_a = motionOf(query, query.bodies[a]), motion_b = motionOf(query, query.bodies[b]);
    const double toc = bench::orientedAdvancement(*query.bodies[a].mesh, *motion_a, *query.bodies[b].mesh, *motion_b);
    if (toc < answer.toc) answer = {toc, a, b};
  }
  return answer;
}

/// A way to the certified answer.
struct CertifiedWay {
  const char* name;
  Method method;
  RedonOptions redon;
  std::uint64_t every;  // every how many queries it is asked: as written, the paper's takes a while
};

/// The library's own, and the paper's with what the library adds to it and without.
std::vector<CertifiedWay> ways() {
  return {{"standard", Method::standard, {}, 1},
          {"redon2004", Method::redon2004, {}, 1},
          {"redon2004 as written", Method::redon2004, RedonOptions::asWritten(), 5}};
}

std::unique_ptr<ArticulatedCollisionManager> makeManager(const Query& query) {
  auto made = std::make_unique<ArticulatedCollisionManager>(query.tree);
  ArticulatedCollisionManager& manager = *made;
  for (const Body& body : query.bodies) {
    if (body.link >= 0) {
      manager.bind(body.link, body.object.get(), body.offset);
    } else {
      manager.registerObject(body.object.get());
    }
  }
  AllowedCollisionMatrix allowed;
  for (const Body& a : query.bodies) {
    for (const Body& b : query.bodies) {
      if (a.link < 0 || b.link <= a.link || !adjacent(*query.tree, a.link, b.link)) continue;
      allowed.allow(query.tree->linkName(a.link), query.tree->linkName(b.link));
    }
  }
  manager.setAllowedCollisions(std::move(allowed));
  manager.setup();
  return made;
}

CertifiedRequest requestOf(const CertifiedWay& way, bool self) {
  CertifiedRequest request;
  request.method = way.method;
  request.redon = way.redon;
  request.check_self = self;
  request.check_scene = !self;
  // With a budget of the caller's the paper's method leaves no query to the standard one for its work.
  if (way.method == Method::redon2004) request.work_budget = std::uint64_t{1} << 40;
  return request;
}

std::shared_ptr<Mesh> randomMesh(Random& random, double size) {
  bench::BumpyEllipsoid shape;
  for (int k = 0; k < 3; ++k) shape.half[k] = size * random.uniform(0.4, 1);
  shape.bump = random.uniform(0, 0.1);
  return bench::toBvh<fcl::RSSd>(shape.mesh(4 + random.index(9), 3 + random.index(7)));
}

Body makeBody(LinkId link, const Isometry3d& offset, std::shared_ptr<Mesh> mesh) {
  auto object = std::make_unique<fcl::CollisionObjectd>(mesh);
  if (link < 0) object->setTransform(offset);
  return {link, offset, std::move(mesh), std::move(object)};
}

// A robot of up to six moving joints with meshes on some links. An obstacle stands near where a link passes, so that
// about half of the motions meet it.
Query randomQuery(Random& random, bool self) {
  Query query;
  query.tree = test::randomTree(random, self ? 4 + random.index(3) : 1 + random.index(6), self ? 0.35 : 0.4);
  query.motion =
      test::randomMotion(*query.tree, random, std::pow(10, self ? random.uniform(0, 0.7) : random.uniform(-1, 0.5)));
  for (LinkId link = self ? 0 : 1; link < query.tree->numLinks(); ++link) {
    if (self || random.coin(0.6) || link + 1 == query.tree->numLinks()) {
      query.bodies.push_back(makeBody(link, test::randomPose(random, 0.1), randomMesh(random, self ? 0.15 : 0.2)));
    }
  }
  const std::size_t links = query.bodies.size();
  if (!self) {
    for (int k = 1 + random.index(2); k > 0; --k) {
      const Body& near = query.bodies[static_cast<std::size_t>(random.index(static_cast<int>(links)))];
      const FclLinkMotion passing(*query.tree, *query.motion, near.link, near.offset);
      Isometry3d at = test::randomPose(random, 0);
      at.translation() =
          passing.pose(random.uniform(0.2, 1)).translation() + random.uniform(0, 0.4) * test::randomDirection(random);
      query.bodies.push_back(makeBody(-1, at, randomMesh(random, 0.2)));
    }
  }
  for (std::size_t a = 0; a < links; ++a) {
    for (std::size_t b = a + 1; b < query.bodies.size(); ++b) {
      if ((b >= links) == self) continue;
      if (self && adjacent(*query.tree, query.bodies[a].link, query.bodies[b].link)) continue;
      query.pairs.emplace_back(a, b);
    }
  }
  return query;
}

bool startsInContact(const Query& query) {
  return std::any_of(query.pairs.begin(), query.pairs.end(),
                     [&](const auto& pair) { return gap(query, pair.first, pair.second, 0) == 0; });
}

std::size_t bodyIndex(const Query& query, const BodyRef& ref) {
  const auto found = std::find_if(query.bodies.begin(), query.bodies.end(),
                                  [&](const Body& body) { return body.object.get() == ref.object; });
  return static_cast<std::size_t>(found - query.bodies.begin());
}

void compare(const Query& query, const CertifiedResult& certified, const FclAnswer& fcl, campaign::Tally& tally) {
  ASSERT_NE(certified.status, Status::undecided);
  const bool contact = certified.status == Status::contact;
  const bool fcl_contact = fcl.toc < kFree;
  tally.count("cases");
  tally.count("hits", contact);
  tally.count("by standard", certified.statistics.redon.pairs_by_standard > 0);  // some pair, by the paper's method

  if (fcl_contact && fcl.toc > 0) {  // what makes FCL's answer usable at all
    EXPECT_LE(gap(query, fcl.a, fcl.b, fcl.toc),
              kFclStep * (speedBound(query, fcl.a) + speedBound(query, fcl.b)) * (1 + 1e-6) + kRounding);
  }
  if (!contact) {
    if (!fcl_contact) {
      tally.count("equal");
      return;
    }
    EXPECT_EQ(sampledContact(query, fcl.a, fcl.b, fcl.toc, 1), kFree) << "proven free, FCL stops at " << fcl.toc;
    tally.count("FCL near miss");
    return;
  }

  ASSERT_EQ(certified.contacts.size(), 1u);
  const CertifiedContact& first = certified.contacts.front();
  if (!certified.certain) {  // a gap below the tolerance counts as contact: FCL may see it either way
    const std::size_t a = bodyIndex(query, first.body1), b = bodyIndex(query, first.body2);
    EXPECT_LE(gap(query, a, b, certified.t_lower), CertifiedRequest().tolerance_distance + kRounding);
    tally.count("undecidable");
    return;
  }
  EXPECT_LE(certified.t_upper - certified.t_lower, 1e-6 + kRounding);
  if (!fcl_contact) {
    EXPECT_GE(certified.t_upper, 1 - kFclStep) << "FCL missed a proven contact";
    tally.count("FCL at the end");
    return;
  }
  EXPECT_LE(fcl.toc, certified.t_upper + kRounding) << "FCL's advancement ran past a proven contact";
  if (fcl.toc > certified.t_lower - kAgreement) {
    tally.count("equal");
  } else {
    EXPECT_EQ(sampledContact(query, fcl.a, fcl.b, fcl.toc, certified.t_lower), kFree)
        << "contact before t_lower = " << certified.t_lower << ", FCL stops at " << fcl.toc;
    tally.count("FCL early");
  }
}

void run(bool self, std::uint64_t seed, std::uint64_t count) {
  Random random(seed);
  const std::vector<CertifiedWay> all = ways();
  std::vector<campaign::Tally> tallies(all.size());
  std::uint64_t in_contact = 0;
  for (std::uint64_t n = 0; n < count;) {
    Query query = randomQuery(random, self);
    if (query.pairs.empty()) continue;
    const bool starts = startsInContact(query);
    if (starts && in_contact * 20 > n) continue;  // a few of them are enough
    in_contact += starts;
    SCOPED_TRACE("seed " + std::to_string(seed) + " query " + std::to_string(n));
    const FclAnswer fcl = askFcl(query);
    EXPECT_EQ(fcl.toc == 0, starts);
    const auto manager = makeManager(query);
    for (std::size_t m = 0; m < all.size(); ++m) {
      if (n % all[m].every != all[m].every - 1) continue;
      SCOPED_TRACE(all[m].name);
      const CertifiedRequest request = requestOf(all[m], self);
      const campaign::QueryOfExpectations file(
          campaign::format("crosscheck-%llu-%llu-%zu", static_cast<unsigned long long>(seed),
                           static_cast<unsigned long long>(n), m),
          [&] { return manager->writeQuery(*query.motion, request); });
      const CertifiedResult certified = manager->continuousCollide(*query.motion, request);
      if (starts) {
        EXPECT_EQ(certified.t_lower, 0);
      }
      compare(query, certified, fcl, tallies[m]);
      if (testing::Test::HasFatalFailure()) return;
    }
    ++n;
  }
  for (std::size_t m = 0; m < all.size(); ++m) {
    SCOPED_TRACE(all[m].name);
    const campaign::Tally& tally = tallies[m];
    std::cout << "seed " << seed << "\n" << toText(all[m].name, tally);
    EXPECT_GE(tally.share("hits"), 0.3);
    EXPECT_LE(tally.share("hits"), 0.7);
    EXPECT_GE(tally.share("equal"), 0.8);
    EXPECT_LE(tally.share("FCL near miss") + tally.share("FCL at the end") + tally.share("undecidable"), 0.05);
    EXPECT_LE(tally.share("by standard"), 0.2);  // the paper's method answers for itself
  }
}

TEST(OrientedAdvancementTest, AgreesOnArmsAmidObstacles) {
  run(false, 20040401, campaign::fromEnvironment("FCL_ARTIC_CROSSCHECK_QUERIES", 300));
}

TEST(OrientedAdvancementTest, AgreesOnArmsAgainstThemselves) {
  run(true, 20040402, campaign::fromEnvironment("FCL_ARTIC_CROSSCHECK_QUERIES", 100));
}

}  // namespace
}  // namespace oriented_advancement_test
}  // namespace fcl_artic
