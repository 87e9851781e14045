// SPDX-License-Identifier: BSD-3-Clause
//
// Where stage 2, culling by visibility, pays: a map over kinds of scenes, lengths of motions, numbers of links, and
// executors. Each cell is the time of a set of queries with the stage beside that without it.
//
// Scenes, all about an arm of meshes (1,000 triangles a link) with a reach of 0.95 m:
//   room     a bumpy closed surface around the arm, near enough to touch, as a scan of a cell is: one mesh
//   bushes   150 balls of random small triangles within reach, as clutter: one mesh, or each an object
//   cloud    the corners of the bushes' triangles, as a point cloud
//   moving   the room, or the bushes in one mesh, carried past the arm: an obstacle that moves
//   cabin    the room as the link that carries the arm, an arm in its vehicle: links are checked against each other
//   only itself   nothing but the arm: likewise

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <iostream>
#include <memory>

#include <fcl/math/motion/interp_motion.h>
#include <fcl/narrowphase/continuous_collision_object.h>
#include <fmt/format.h>

#include "arm_scene.h"
#include "fcl_artic/manager.h"
#include "fcl_artic/point_cloud.h"
#include "options.h"
#ifdef FCL_ARTIC_HAS_OFFSCREEN
#include "fcl_artic/visibility/offscreen.h"
#endif

using namespace fcl_artic;
using namespace fcl_artic::bench;

namespace {

constexpr double kReach = 0.95;
/// A block of queries takes at least this, us: they are asked again and again.
constexpr double kLeastBlock = 4000;

/// Of this thread, us: other programs on the machine do not count. (main() has OpenGL draw in it.)
double processorTime() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e6 * static_cast<double>(t.tv_sec) + 1e-3 * static_cast<double>(t.tv_nsec);
}

TriangleMesh makeRoom(int triangles) {
  BumpyEllipsoid room;
  room.half = {0.9, 0.8, 0.75};
  room.bump = 0.12;
  const int bands = std::max(4, static_cast<int>(std::lround(std::sqrt(triangles) / 2)));
  return room.mesh(2 * bands, bands + 1);
}

std::vector<TriangleMesh> makeBushes(int triangles) {
  constexpr int kBushes = 150;
  Random random(23);
  const auto inBall = [&]() -> fcl::Vector3d {
    for (;;) {
      const fcl::Vector3d v(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      if (v.norm() < 1) return v;
    }
  };
  std::vector<TriangleMesh> bushes;
  while (bushes.size() < kBushes) {
    const fcl::Vector3d centre = kReach * inBall();
    if (centre.norm() < 0.25) continue;
    const double radius = random.uniform(0.02, 0.07);
    const int count = triangles / kBushes;
    const double size = radius / std::cbrt(count);
    TriangleMesh mesh;
    for (int i = 0; i < count; ++i) {
      const fcl::Vector3d at = centre + radius * inBall();
      for (int k = 0; k < 3; ++k) mesh.vertices.push_back(at + size * inBall());
      mesh.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
    }
    bushes.push_back(std::move(mesh));
  }
  return bushes;
}

/// What the meshes of a scene are. Where they are no obstacles, links are checked against each other, and only so.
enum class Role { obstacles, cloud, movingObstacles, link };
/// A kind of scene; its meshes for a number of triangles.
struct Kind {
  std::string name;
  std::function<std::vector<TriangleMesh>(int triangles)> make;
  Role role = Role::obstacles;
};
std::vector<Kind> kinds() {
  const auto room = [](int n) { return std::vector<TriangleMesh>{makeRoom(n)}; };
  const auto bushes = [](int n) { return std::vector<TriangleMesh>{merge(makeBushes(n))}; };
  return {{"room", room},
          {"bushes, one mesh", bushes},
          {"bushes", makeBushes},
          {"cloud", bushes, Role::cloud},
          {"moving room", room, Role::movingObstacles},
          {"moving bushes", bushes, Role::movingObstacles},
          {"cabin", room, Role::link},
          {"itself", [](int) { return std::vector<TriangleMesh>(); }, Role::link}};
}
/// How far obstacles that move do, m, and turn, rad.
const fcl::Vector3d kCarried(0.1, 0.05, 0);
constexpr double kTurned = 0.1;

/// An arm and obstacles in a manager.
class Place {
 public:
  Place(int links, const std::vector<TriangleMesh>& meshes, Role role)
      : itself_(role == Role::link), random_(5), arm_(makeArm(links)), manager_(arm_.tree) {
    for (const ArmLink& link : arm_.links) {
      objects_.push_back(std::make_unique<fcl::CollisionObjectd>(toBvh<fcl::OBBRSSd>(link.mesh)));
      manager_.bind(link.link, objects_.back().get(), link.offset);
    }
    for (const TriangleMesh& mesh : meshes) {
      triangles_ += mesh.triangles.size();
      if (role == Role::movingObstacles) {
        fcl::Transform3d to = fcl::Transform3d::Identity();
        to.translate(kCarried);
        to.rotate(Eigen::AngleAxisd(kTurned, fcl::Vector3d::UnitZ()));
        moving_.push_back(std::make_unique<fcl::ContinuousCollisionObjectd>(
            toBvh<fcl::OBBRSSd>(mesh),
            std::make_shared<fcl::InterpMotion<double>>(Eigen::Matrix3d::Identity(), fcl::Vector3d::Zero(), to.linear(),
                                                        to.translation(), fcl::Vector3d::Zero())));
        manager_.registerObject(moving_.back().get());
        continue;
      }
      std::shared_ptr<fcl::CollisionGeometryd> geometry = toBvh<fcl::OBBRSSd>(mesh);
      if (role == Role::cloud) {
        geometry = std::make_shared<PointCloud>(
            std::vector<Eigen::Vector3d>(mesh.vertices.begin(), mesh.vertices.end()), 0.002);
      }
      objects_.push_back(std::make_unique<fcl::CollisionObjectd>(geometry));
      if (role == Role::link) {
        manager_.bind(arm_.tree->linkName(0), objects_.back().get());
      } else {
        manager_.registerObject(objects_.back().get());
      }
    }
    manager_.setup();
  }
  ArticulatedCollisionManager& manager() { return manager_; }
  std::size_t triangles() const { return triangles_; }
  /// The arm is checked against itself only.
  bool itself() const { return itself_; }

  /// Random motions of which nothing is nearer than 5 mm at the start; each joint turns by at most `step`, rad.
  /// @param set  those that are "free", those in "contact", or "any".
  /// @return fewer than `count` where they are rare.
  std::vector<JointMotion> motions(double step, const std::string& set, std::size_t count) {
    CertifiedRequest clear, query;
    clear.check_self = query.check_self = itself_;
    clear.margin = 0.005;
    const auto n = static_cast<Eigen::Index>(arm_.tree->dof());
    Eigen::VectorXd q(n), dq(n);
    std::vector<JointMotion> found;
    for (std::size_t tried = 0; found.size() < count && tried < 400 * count; ++tried) {
      for (Eigen::Index i = 0; i < n; ++i) {
        q[i] = random_.uniform(-kPi, kPi);
        dq[i] = random_.uniform(-1, 1) * step;
      }
      if (!manager_.isFree(q, q, clear)) continue;
      JointMotion motion = JointMotion::linear(*arm_.tree, q, q + dq);
      if (set == "any" || manager_.isFree(motion, query) == (set == "free")) found.push_back(std::move(motion));
    }
    return found;
  }

 private:
  static ArmScene makeArm(int links) {
    ArmSceneOptions options;
    options.spheres = 1;
    options.scene_triangles = 100;
    if (links != 6) {
      Random random(11);
      options.rows = randomRows(links, kReach, random);
      options.first_link = 1;
      options.thickness = std::clamp(0.25 * kReach / links, 0.015, 0.055);
    }
    return makeArmScene(options);
  }
  bool itself_;
  Random random_;
  ArmScene arm_;
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> objects_;
  std::vector<std::unique_ptr<fcl::ContinuousCollisionObjectd>> moving_;
  ArticulatedCollisionManager manager_;
  std::size_t triangles_ = 0;
};

/// One cell of the map.
struct Cell {
  std::string scene;
  std::size_t triangles;
  int links;
  double degrees;
  std::string set;  ///< "free", "contact" or "any"
  std::string executor;
  std::size_t queries;
  double off_us, us, ratio;  ///< a query; the ratio is the median of those of blocks taken in turns
  double culled;             ///< of the pairs that the stage saw
  double drawn;              ///< pieces a query
};

class Asker {
 public:
  Asker(Place& place, const std::vector<JointMotion>& motions, VisibilityMode mode) : place_(place), motions_(motions) {
    request_.check_self = place.itself();
    request_.visibility = mode;
    request_.tolerance_time = 0x1p-13;
    results_.resize(motions.size());
  }
  /// Mean time of all queries together, us.
  double ask() {
    const double begin = processorTime();
    double sum = 0;
    int n = 0;
    for (; sum < kLeastBlock; ++n) {
      for (std::size_t i = 0; i < motions_.size(); ++i) {
        place_.manager().continuousCollide(motions_[i], request_, results_[i]);
      }
      sum = processorTime() - begin;
    }
    return sum / n;
  }
  const std::vector<CertifiedResult>& results() const { return results_; }

 private:
  Place& place_;
  const std::vector<JointMotion>& motions_;
  CertifiedRequest request_;
  std::vector<CertifiedResult> results_;
};

/// @return the number of verdicts that differ.
std::size_t measure(Place& place, const std::vector<JointMotion>& motions, int blocks, Cell& cell) {
  Asker without(place, motions, VisibilityMode::off), with(place, motions, VisibilityMode::on);
  std::vector<double> ratios;
  double off_us = HUGE_VAL, us = HUGE_VAL;
  for (int i = 0; i < blocks; ++i) {
    const double a = without.ask(), b = with.ask();
    ratios.push_back(b / a);
    off_us = std::min(off_us, a);
    us = std::min(us, b);
  }
  std::sort(ratios.begin(), ratios.end());
  double pairs = 0, culled = 0, pieces = 0;
  std::size_t differ = 0;
  for (std::size_t i = 0; i < motions.size(); ++i) {
    const VisibilityStatistics& s = with.results()[i].statistics.visibility;
    pairs += static_cast<double>(s.pairs);
    culled += static_cast<double>(s.culled);
    pieces += static_cast<double>(s.pieces);
    differ += with.results()[i].status != without.results()[i].status;
  }
  const auto n = static_cast<double>(motions.size());
  cell.queries = motions.size();
  cell.off_us = off_us / n;
  cell.us = us / n;
  cell.ratio = ratios[ratios.size() / 2];
  cell.culled = pairs > 0 ? culled / pairs : 0;
  cell.drawn = pieces / n;
  return differ;
}

std::shared_ptr<const VisibilityCuller> cullerOf(const std::string& executor) {
  if (executor == "cpu") return std::make_shared<const VisibilityCuller>();
#ifdef FCL_ARTIC_HAS_OFFSCREEN
  if (executor == "osmesa") return makeOffscreenCuller(OffscreenBackend::osmesa);
  if (executor == "egl") return makeOffscreenCuller(OffscreenBackend::egl);
#endif
  throw std::runtime_error("no executor '" + executor + "'");
}

}  // namespace

int main(int argc, char** argv) {
  Report report("bench_visibility_map");
  CLI::App app("Where culling by visibility pays: a map");
  std::size_t count = 60;
  int blocks = 5;
  std::vector<int> sizes = {100000}, links = {6, 20};
  std::vector<double> steps = {5, 20, 60, 180};
  std::vector<std::string> executors = {"cpu", "osmesa"}, scenes;
  for (const Kind& kind : kinds()) scenes.push_back(kind.name);
  app.add_option("--queries", count, "motions of each set")->check(CLI::PositiveNumber)->capture_default_str();
  app.add_option("--blocks", blocks, "times that each executor is asked, in turns with `off`")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--triangles", sizes, "of a scene")->capture_default_str();
  app.add_option("--links", links, "of the arm")->capture_default_str();
  app.add_option("--steps", steps, "degrees that a joint turns by at most")->capture_default_str();
  app.add_option("--executors", executors, "cpu, osmesa, egl")->capture_default_str();
  app.add_option("--scenes", scenes, "kinds of scenes")->capture_default_str();
  if (const auto status = readOptions(app, report, argc, argv)) return *status;
  setenv("LP_NUM_THREADS", "0", 1);  // llvmpipe draws in the thread that asks

  std::string csv = "scene,triangles,links,degrees,set,executor,queries,off_us,with_us,ratio,culled,drawn\n";
  std::size_t differ = 0;
  fmt::print("{:<18} {:>8} {:>5} {:>4} {:<8} {:<9} {:>9} {:>9} {:>7} {:>7} {:>8}\n", "scene", "triangles", "links",
             "deg", "set", "executor", "off us", "with us", "ratio", "culled", "drawn");
  const auto addCell = [&](const Cell& c) {
    csv += fmt::format("\"{}\",{},{},{:g},{},{},{},{:.2f},{:.2f},{:.3f},{:.3f},{:.0f}\n", c.scene, c.triangles, c.links,
                       c.degrees, c.set, c.executor, c.queries, c.off_us, c.us, c.ratio, c.culled, c.drawn);
    fmt::print("{:<18} {:>8} {:>5} {:>4g} {:<8} {:<9} {:>9.1f} {:>9.1f} {:>7.2f} {:>6.1f}% {:>8.0f}\n", c.scene,
               c.triangles, c.links, c.degrees, c.set, c.executor, c.off_us, c.us, c.ratio, 100 * c.culled, c.drawn);
    std::cout.flush();
  };
  std::vector<std::shared_ptr<const VisibilityCuller>> cullers;
  for (const std::string& executor : executors) {
    cullers.push_back(cullerOf(executor));
    if (cullers.back()->executor() != executor) throw std::runtime_error(cullers.back()->fallbackReason());
  }
  for (const Kind& kind : kinds()) {
    if (std::find(scenes.begin(), scenes.end(), kind.name) == scenes.end()) continue;
    for (const int size : sizes) {
      const std::vector<TriangleMesh> obstacles = kind.make(size);
      for (const int n : links) {
        Place place(n, obstacles, kind.role);
        for (const double degrees : steps) {
          for (const std::string set : {"free", "contact", "any"}) {
            const std::vector<JointMotion> motions = place.motions(degrees * kPi / 180, set, count);
            if (motions.size() < 8) continue;
            for (std::size_t e = 0; e < executors.size(); ++e) {
              place.manager().setVisibility(cullers[e]);
              Cell cell{kind.name, place.triangles(), n, degrees, set, executors[e], 0, 0, 0, 0, 0, 0};
              differ += measure(place, motions, blocks, cell);
              addCell(cell);
            }
          }
        }
      }
    }
  }
  report.write("bench_visibility_map.csv", csv);
  if (differ) fmt::print("{} verdicts differ\n", differ);
  return differ ? 1 : 0;
}
