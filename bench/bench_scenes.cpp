// SPDX-License-Identifier: BSD-3-Clause
//
// What a free motion of a Panda costs as its surroundings grow: 10 to 10,000 boxes, cylinders and balls, all within
// reach (clutter) or spread out at one density (room), and 20 bumpy spheres of 1k to 1M triangles, as 20 meshes and as
// one. Random motions of 2.7 rad, self collision included. And a cloud of up to a million points, beside the same
// points as cells of an OcTree; and a bumpy body in the hand amid 30 boxes, a mesh or a cloud, as one body and cut into
// many: free motions, any contact, the first. FCL_ARTIC_DATA names the folder with robots/ and problems/.
//
// Clutter leaves a motion its way: obstacles that come within 5 mm of it are left out, so that each motion has a scene
// of its own. The other scenes are drawn once; motions are drawn until enough of them are free.

#include <iostream>
#include <map>
#include <memory>
#include <set>

#include <fcl/geometry/octree/octree.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>
#include <fmt/format.h>

#include "arm_scene.h"
#include "clouds.h"
#include "fcl_artic/point_cloud.h"
#include "options.h"
#include "planning/problems.h"
#include "random_motion.h"

using namespace fcl_artic;
using namespace fcl_artic::bench;
using planning_data::Environment;

namespace {

constexpr Answer kFree = 2;
constexpr double kLength = 2.7, kReach = 1.2, kShoulder = 0.333, kWay = 5e-3;
constexpr double kNearBase = 0.25;        ///< obstacles of shared scenes keep clear of the base
constexpr double kPoint = 3e-3;           ///< radius of a cloud's points
constexpr double kShort[] = {0.35, 1.5};  ///< at most, of each joint: motions amid clouds, and with a body in the hand

/// What is asked of motions that are free, or not.
struct Question {
  const char* set;
  bool hit;
  ContactMode mode;
};
constexpr Question kQuestions[] = {
    {"free", false, ContactMode::first}, {"any", true, ContactMode::any}, {"first", true, ContactMode::first}};

using Geometry = std::shared_ptr<fcl::CollisionGeometryd>;
struct Obstacle {
  Geometry geometry;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
};

/// A manager with what it holds pointers to.
class World {
 public:
  /// @param carried  by the hand, in its frame.
  World(const Robot& robot, const std::vector<Obstacle>& obstacles, const std::vector<Obstacle>& carried = {})
      : manager_(robot.tree) {
    for (const LinkGeometry& g : robot.geometry) {
      objects_.push_back(std::make_unique<fcl::CollisionObjectd>(*g.object));
      manager_.bind(g.link, objects_.back().get(), g.offset);
    }
    manager_.setAllowedCollisions(robot.allowed);
    for (std::size_t i = 0; i < obstacles.size(); ++i) {
      objects_.push_back(std::make_unique<fcl::CollisionObjectd>(obstacles[i].geometry, obstacles[i].pose));
      manager_.registerObject(objects_.back().get(), "o" + std::to_string(i));
    }
    for (const Obstacle& body : carried) {
      objects_.push_back(std::make_unique<fcl::CollisionObjectd>(body.geometry));
      manager_.registerObject(objects_.back().get());
      manager_.attach("panda_hand", objects_.back().get(), body.pose, {"panda_leftfinger", "panda_rightfinger"});
    }
    manager_.setup();
  }
  const ArticulatedCollisionManager& manager() const { return manager_; }

 private:
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> objects_;
  ArticulatedCollisionManager manager_;
};

/// What a planner asks.
CertifiedRequest planned() {
  CertifiedRequest request;
  request.mode = ContactMode::any;
  request.max_contacts = 0;
  request.tolerance_time = 0x1p-12;
  request.tolerance_distance = 1e-5;
  return request;
}

Eigen::Vector3d inBall(Random& random, double radius) {
  for (;;) {
    const double x = random.uniform(-1, 1), y = random.uniform(-1, 1), z = random.uniform(-1, 1);
    const Eigen::Vector3d v(x, y, z);
    if (v.squaredNorm() <= 1) return radius * v;
  }
}

/// @param kinds  1: boxes alone.
Obstacle randomObstacle(Random& random, double size, const Eigen::Vector3d& at, int kinds = 3) {
  Obstacle obstacle;
  const double a = random.uniform(0.3, 1) * size, b = random.uniform(0.3, 1) * size, c = random.uniform(0.3, 1) * size;
  switch (random.index(kinds)) {
    case 0:
      obstacle.geometry = std::make_shared<fcl::Boxd>(a, b, c);
      break;
    case 1:
      obstacle.geometry = std::make_shared<fcl::Cylinderd>(0.5 * a, b);
      break;
    default:
      obstacle.geometry = std::make_shared<fcl::Sphered>(0.5 * a);
  }
  const Eigen::Vector3d axis = inBall(random, 1).normalized();
  obstacle.pose = Eigen::Translation3d(at) * Eigen::AngleAxisd(random.uniform(-kPi, kPi), axis);
  return obstacle;
}

/// Points of 20 bumpy bodies.
std::vector<Eigen::Vector3d> scan(std::size_t n, Random& random) {
  std::vector<TriangleMesh> meshes;
  while (meshes.size() < 20) {
    BumpyEllipsoid body;
    const double x = random.uniform(-0.9, 0.9), y = random.uniform(-0.9, 0.9), z = random.uniform(-0.2, 1.1);
    body.centre = Eigen::Vector3d(x, y, z);
    body.half.setConstant(random.uniform(0.05, 0.12));
    if (body.centre.head<2>().norm() > 0.3) meshes.push_back(body.mesh(80, 40));
  }
  return scan(merge(meshes), n, kPoint, random);
}

/// A bumpy plate in the hand's frame, as so many bodies.
/// @param size  triangles, or points of a cloud.
std::vector<Obstacle> plate(bool as_cloud, std::size_t size, std::size_t bodies) {
  BumpyEllipsoid body;
  body.centre = Eigen::Vector3d(0, 0, 0.22);
  body.half = Eigen::Vector3d(0.04, 0.15, 0.15);
  const int bands =
      as_cloud ? 50 : std::max(4, static_cast<int>(std::lround(std::sqrt(static_cast<double>(size)) / 2)));
  const TriangleMesh mesh = body.mesh(2 * bands, bands + 1);
  Random random(8);
  std::vector<Eigen::Vector3d> points;
  if (as_cloud) points = scan(mesh, size, kPoint, random);
  for (std::size_t i = 0; !as_cloud && i < mesh.triangles.size(); ++i) {
    const fcl::Triangle& t = mesh.triangles[i];
    points.push_back((mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3);
  }
  std::vector<Obstacle> out;
  for (const std::vector<std::size_t>& group : cut(points, bodies)) {
    std::vector<Eigen::Vector3d> own;
    TriangleMesh part{mesh.vertices, {}};
    for (const std::size_t i : group) as_cloud ? own.push_back(points[i]) : part.triangles.push_back(mesh.triangles[i]);
    if (as_cloud) out.push_back({std::make_shared<PointCloud>(std::move(own), kPoint)});
    if (!as_cloud) out.push_back({toBvh<fcl::OBBRSSd>(part)});
  }
  return out;
}

std::shared_ptr<fcl::OcTreed> cellsOf(const std::vector<Eigen::Vector3d>& points) {
  const auto tree = std::make_shared<octomap::OcTree>(2 * kPoint);
  for (const Eigen::Vector3d& p : points) tree->updateNode(p[0], p[1], p[2], true, true);
  tree->updateInnerOccupancy();
  return std::make_shared<fcl::OcTreed>(std::shared_ptr<const octomap::OcTree>(tree));
}

class Bench {
 public:
  Bench(Report& report, const std::filesystem::path& data, std::size_t queries, int passes)
      : report_(report),
        robot_(planning_data::readRobot(data, "panda")),
        environment_(
            planning_data::readEnvironment(planning_data::problemsPath(data, "panda", "table_pick"), *robot_.tree)),
        queries_(queries),
        passes_(passes) {}

  /// All obstacles within reach, each motion in its own. The smaller scenes are beginnings of the larger ones.
  void addClutter(const std::vector<std::size_t>& sizes) {
    const std::size_t most = *std::max_element(sizes.begin(), sizes.end());
    for (const std::size_t size : sizes) {
      report_.add("clutter", "free", fmt::format("{} obstacles", size), [this, size, most] {
        if (clutter_.empty()) {
          clutter_motions_ = freeMotions(World(robot_, {}).manager());
          for (std::size_t i = 0; i < clutter_motions_.size(); ++i)
            clutter_.push_back(around(clutter_motions_[i], most, i));
        }
        std::vector<std::unique_ptr<World>> worlds;
        for (std::vector<Obstacle> obstacles : clutter_) {
          obstacles.resize(size);
          worlds.push_back(std::make_unique<World>(robot_, obstacles));
        }
        return measured(static_cast<double>(size), clutter_motions_,
                        [&](std::size_t i) -> const ArticulatedCollisionManager& { return worlds[i]->manager(); });
      });
    }
  }

  /// 20 obstacles in each ball of the arm's reach, in an ever larger room.
  void addRoom(const std::vector<std::size_t>& sizes) {
    for (const std::size_t size : sizes) {
      report_.add("room", "free", fmt::format("{} obstacles", size), [this, size] {
        Random random(5);
        std::vector<Obstacle> obstacles;
        const double half = kReach * std::cbrt(kPi / 6 * std::max(1.0, static_cast<double>(size) / 20));
        while (obstacles.size() < size) {
          const double x = random.uniform(-half, half), y = random.uniform(-half, half),
                       z = random.uniform(-half, half);
          const Eigen::Vector3d at(x, y, z + kShoulder);
          if (at.head<2>().norm() > kNearBase) obstacles.push_back(randomObstacle(random, 0.15, at));
        }
        return measuredInOne(static_cast<double>(size), obstacles);
      });
    }
  }

  void addMeshes(const std::vector<std::size_t>& sizes) {
    for (const bool merged : {false, true}) {
      for (const std::size_t size : sizes) {
        report_.add(merged ? "one mesh" : "20 meshes", "free", fmt::format("{} triangles", size), [this, size, merged] {
          Random random(6);
          std::vector<TriangleMesh> meshes;
          const int bands = std::max(3, static_cast<int>(std::lround(std::sqrt(static_cast<double>(size) / 80))) + 1);
          std::size_t triangles = 0;
          while (meshes.size() < 20) {
            BumpyEllipsoid sphere;
            sphere.centre = inBall(random, kReach) + Eigen::Vector3d(0, 0, kShoulder);
            sphere.half.setConstant(random.uniform(0.05, 0.12));
            if (sphere.centre.head<2>().norm() < kNearBase) continue;
            meshes.push_back(sphere.mesh(2 * bands, bands));
            triangles += meshes.back().triangles.size();
          }
          if (merged) meshes = {merge(meshes)};
          std::vector<Obstacle> obstacles;
          for (const TriangleMesh& mesh : meshes) obstacles.push_back({toBvh<fcl::OBBRSSd>(mesh)});
          return measuredInOne(static_cast<double>(triangles), obstacles);
        });
      }
    }
  }

  void addPoints(const std::vector<std::size_t>& sizes) {
    for (const std::size_t size : sizes) {
      for (const bool as_cells : {false, true}) {
        forEachQuestion([&](double length, const Question& question) {
          report_.add(as_cells ? "OcTree" : "points", question.set, fmt::format("{} points, {} rad", size, length),
                      [this, size, as_cells, length, question] {
                        Random random(1);
                        const auto cloud = std::make_shared<PointCloud>(scan(size, random), kPoint);
                        const World points(robot_, {{cloud}});
                        const std::vector<JointMotion> motions =
                            shortMotions(points.manager(), length, question.hit, random);
                        if (!as_cells) return measuredIn(points, static_cast<double>(size), motions, question);
                        return measuredIn(World(robot_, {{cellsOf(cloud->points())}}), static_cast<double>(size),
                                          motions, question);
                      });
        });
      }
    }
  }

  /// A plate in the hand, as one body and as many, amid boxes. The same motions for all: those of one body.
  void addCarried(bool as_cloud, std::size_t size, const std::vector<std::size_t>& cuts) {
    forEachQuestion([&](double length, const Question& question) {
      for (const std::size_t bodies : cuts) {
        report_.add(
            as_cloud ? "carried cloud" : "carried mesh", question.set,
            fmt::format("{}, {} rad, {}", size, length, bodies == 1 ? "1 body" : fmt::format("{} bodies", bodies)),
            [this, as_cloud, size, length, question, bodies] {
              Random random(9);
              std::vector<Obstacle> boxes;
              while (boxes.size() < 30) {
                const Eigen::Vector3d at = inBall(random, kReach) + Eigen::Vector3d(0, 0, kShoulder);
                if (at.head<2>().norm() > kNearBase) boxes.push_back(randomObstacle(random, 0.15, at, 1));
              }
              const World one(robot_, boxes, plate(as_cloud, size, 1));
              const std::vector<JointMotion> motions = shortMotions(one.manager(), length, question.hit, random);
              const std::vector<Obstacle> parts = plate(as_cloud, size, bodies);
              Measured out =
                  measuredIn(World(robot_, boxes, parts), static_cast<double>(parts.size()), motions, question);
              if (out.row.hits != (question.hit ? motions.size() : 0))
                throw std::runtime_error("as many bodies a motion is free, and as one it is not, or the reverse");
              return out;
            });
      }
    });
  }

  /// Of each question about what is carried: one body, and the best cut.
  void noteCuts() {
    for (const Row& one : report_.rows()) {
      if (one.scene.rfind("carried", 0) != 0 || one.size != 1) continue;
      const std::string question = one.method.substr(0, one.method.rfind(','));
      const Row* best = nullptr;
      for (const Row& row : report_.rows()) {
        const bool same = row.scene == one.scene && row.set == one.set && row.method.rfind(question + ",", 0) == 0;
        if (same && row.size > 1 && (!best || row.median_us < best->median_us)) best = &row;
      }
      if (best)
        report_.note(fmt::format("{}, {}, {}: one body {:.1f} us, the best cut ({:g} bodies) {:.1f}", one.scene,
                                 one.set, question, one.median_us, best->size, best->median_us));
    }
  }

  /// How much more the larger of two sizes costs than the smaller.
  void noteRatio(const std::string& scene, double small, double large) {
    const Row *a = nullptr, *b = nullptr;
    for (const Row& row : report_.rows()) {
      if (row.scene == scene && row.size == small) a = &row;
      if (row.scene == scene && row.size == large) b = &row;
    }
    if (!a || !b) return;
    report_.note(fmt::format("{}: {:g} obstacles cost {:.2f} times as much as {:g} (median; mean {:.2f})", scene, large,
                             b->median_us / a->median_us, small, b->mean_us / a->mean_us));
  }

 private:
  JointMotion randomMotion(std::mt19937& random) const {
    for (;;) {
      bool within = false;
      const Ends ends = randomEnds(*robot_.tree, environment_.joints, kLength, random, within);
      if (!within) continue;
      return JointMotion::linear(*robot_.tree, environment_.configuration(*robot_.tree, ends.from),
                                 environment_.configuration(*robot_.tree, ends.to));
    }
  }

  std::vector<JointMotion> freeMotions(const ArticulatedCollisionManager& manager) const {
    std::mt19937 random(7);
    std::vector<JointMotion> motions;
    CertifiedResult result;
    for (int tries = 0; motions.size() < queries_ && tries < 100000; ++tries) {
      JointMotion motion = randomMotion(random);
      manager.continuousCollide(motion, planned(), result);
      if (result.isFree()) motions.push_back(std::move(motion));
    }
    return motions;
  }

  template <class Add>
  static void forEachQuestion(const Add& add) {
    for (const double length : kShort) {
      for (const Question& question : kQuestions) add(length, question);
    }
  }

  /// Of eight motions for each query asked for, from free starts, those that are free, or the others.
  std::vector<JointMotion> shortMotions(const ArticulatedCollisionManager& manager, double length, bool hit,
                                        Random& random) const {
    const KinematicTree& tree = *robot_.tree;
    std::vector<JointMotion> motions;
    for (std::size_t drawn = 0; drawn < 8 * queries_;) {
      Eigen::VectorXd q0(tree.dof()), q1(tree.dof());
      for (int v = 0; v < tree.dof(); ++v) {
        const Joint& joint = tree.joint(tree.variableJoint(v));
        q0[v] = random.uniform(joint.lower, joint.upper);
        q1[v] = std::clamp(q0[v] + random.uniform(-length, length), joint.lower, joint.upper);
      }
      if (!manager.isFree(q0, q0)) continue;
      ++drawn;
      if (manager.isFree(q0, q1) != hit) motions.push_back(JointMotion::linear(tree, q0, q1));
    }
    return motions;
  }

  /// Obstacles within reach that leave this motion its way.
  std::vector<Obstacle> around(const JointMotion& motion, std::size_t count, std::uint64_t seed) const {
    Random random(100 + seed);
    std::vector<Obstacle> kept;
    while (kept.size() < count) {
      std::vector<Obstacle> drawn;
      for (std::size_t i = 0; i < count; ++i) {
        drawn.push_back(randomObstacle(random, 0.08, inBall(random, kReach) + Eigen::Vector3d(0, 0, kShoulder)));
      }
      CertifiedRequest request;
      request.mode = ContactMode::firstOfEveryPair;
      request.max_contacts = 1u << 20;
      request.margin = kWay;
      request.check_self = false;
      request.tolerance_time = 1e-3;
      CertifiedResult result;
      const World world(robot_, drawn);
      world.manager().continuousCollide(motion, request, result);
      std::set<std::string> touching;
      for (const CertifiedContact& contact : result.contacts) touching.insert(contact.body2.name);
      for (std::size_t i = 0; i < count && kept.size() < count; ++i) {
        if (!touching.count("o" + std::to_string(i))) kept.push_back(drawn[i]);
      }
    }
    return kept;
  }

  Measured measuredInOne(double size, const std::vector<Obstacle>& obstacles) {
    const World world(robot_, obstacles);
    return measured(size, freeMotions(world.manager()),
                    [&](std::size_t) -> const ArticulatedCollisionManager& { return world.manager(); });
  }

  Measured measuredIn(const World& world, double size, const std::vector<JointMotion>& motions,
                      const Question& question) const {
    return measured(
        size, motions, [&](std::size_t) -> const ArticulatedCollisionManager& { return world.manager(); },
        question.mode == ContactMode::any ? planned() : CertifiedRequest());
  }

  template <class ManagerOf>
  Measured measured(double size, const std::vector<JointMotion>& motions, const ManagerOf& manager,
                    const CertifiedRequest& request = planned()) const {
    CertifiedResult result;
    Measured measured = measure(motions.size(), passes_, [&](std::size_t i) {
      manager(i).continuousCollide(motions[i], request, result);
      return result.isFree() ? kFree : result.t_upper;
    });
    for (std::size_t i = 0; i < motions.size(); ++i) {
      manager(i).continuousCollide(motions[i], request, result);
      addCounters(measured.row, result.statistics);
    }
    measured.row.size = size;
    return measured;
  }

  Report& report_;
  Robot robot_;
  Environment environment_;
  std::size_t queries_;
  int passes_;
  std::vector<JointMotion> clutter_motions_;
  std::vector<std::vector<Obstacle>> clutter_;
};

}  // namespace

int main(int argc, char** argv) try {
  Report report("bench_scenes");
  CLI::App app("A Panda's free motions in growing scenes (FCL_ARTIC_DATA names the data)");
  std::size_t queries = 50;
  int passes = 3;
  std::vector<std::size_t> obstacles = {10, 20, 100, 1000, 10000}, triangles = {1000, 10000, 100000, 1000000},
                           points = {10000, 100000, 1000000}, carried = {10000, 100000}, cuts = {1, 8, 32, 128};
  app.add_option("--queries", queries, "free motions of each scene")->check(CLI::PositiveNumber)->capture_default_str();
  app.add_option("--passes", passes, "passes over the motions at least; the least time of each counts")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--obstacles", obstacles, "numbers of obstacles")->capture_default_str();
  app.add_option("--triangles", triangles, "sizes of the mesh scenes")->capture_default_str();
  app.add_option("--points", points, "sizes of clouds")->capture_default_str();
  app.add_option("--carried", carried, "triangles of a mesh and points of a cloud in the hand")
      ->expected(2)
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--cuts", cuts, "bodies that it is cut into: powers of two")->capture_default_str();
  if (const auto status = readOptions(app, report, argc, argv)) return *status;
  const std::filesystem::path data = planning_data::sharedData();
  if (data.empty()) {
    std::cout << "bench_scenes skipped: FCL_ARTIC_DATA does not name a folder with robots/, problems/ and edges/\n";
    return 0;
  }
  Bench bench(report, data, queries, passes);
  bench.addClutter(obstacles);
  bench.addRoom(obstacles);
  bench.addMeshes(triangles);
  bench.addPoints(points);
  for (const bool as_cloud : {false, true}) bench.addCarried(as_cloud, carried[as_cloud], cuts);
  report.run();
  for (const char* scene : {"clutter", "room"}) bench.noteRatio(scene, 20, 1000);
  bench.noteCuts();
  return report.finish();
} catch (const std::exception& error) {
  std::cerr << "bench_scenes: " << error.what() << '\n';
  return 1;
}
