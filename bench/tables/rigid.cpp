// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <filesystem>
#include <memory>
#include <stdexcept>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/continuous_collision.h>
#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <boost/property_tree/ini_parser.hpp>
#include <boost/property_tree/ptree.hpp>

#include "averages.h"
#include "exit_status.h"
#include "fcl_artic/ompl/planning_setup.h"
#include "fcl_artic/urdf/urdf.h"
#include "files/files.h"
#include "outputs.h"
#include "plan_options.h"
#include "planning/plans.h"
#include "progress.h"
#include "tables.h"

namespace fcl_artic::app {
namespace {

namespace fs = std::filesystem;
namespace ob = ompl::base;
using namespace planning_data;
using planning::PlanningSetup;

enum Validator { kDiscrete, kAdvancement, kRigidOurs, kRigidValidators };
constexpr const char* kRigidNames[kRigidValidators] = {"FCL, OMPL's 1 %", "FCL, as OMPL.app", "fcl_artic"};

struct RigidOptions {
  std::vector<std::string> problems;  ///< files of OMPL.app (.cfg)
  int seeds = 3;
  double seconds = 20;  ///< for a plan, and for its simplification
  std::string csv;      ///< file of a row for each plan; empty: none
};

/// A body's way to be planned.
struct PlanningTask {
  std::string name;
  std::shared_ptr<fcl::CollisionGeometryd> body;
  Scene scene;
  std::vector<double> start, goal;  ///< x, y, z and the quaternion's x, y, z, w
  planning::SetupOptions options;   ///< bounds of the position
};

bool isCollada(const fs::path& path) {
  return path.extension() == ".dae";
}

/// From z up, as loadMesh() has COLLADA's files, to y up, as OMPL.app (by assimp) has them.
Eigen::Isometry3d yUp(const fs::path& path) {
  return isCollada(path) ? Eigen::Isometry3d(Eigen::AngleAxisd(-EIGEN_PI / 2, Eigen::Vector3d::UnitX()))
                         : Eigen::Isometry3d::Identity();
}

/// The body in OMPL.app's frame: at the mean of the mesh's vertices.
std::shared_ptr<fcl::CollisionGeometryd> readBody(const fs::path& path) {
  using Mesh = fcl::BVHModel<fcl::OBBRSSd>;
  const auto read = std::dynamic_pointer_cast<Mesh>(
      loadMesh(path, Eigen::Vector3d::Ones(), nullptr, false, isCollada(path)));  // not a solid: such a mesh
  std::vector<Eigen::Vector3d> vertices(read->vertices, read->vertices + read->num_vertices);
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (Eigen::Vector3d& v : vertices) {
    v = yUp(path) * v;
    center += v / static_cast<double>(vertices.size());
  }
  for (Eigen::Vector3d& v : vertices) v -= center;
  auto body = std::make_shared<Mesh>();
  body->beginModel();
  body->addSubModel(vertices, std::vector<fcl::Triangle>(read->tri_indices, read->tri_indices + read->num_tris));
  body->endModel();
  body->computeLocalAABB();
  return body;
}

Scene readSurroundings(const fs::path& path) {
  SceneOptions options;
  options.collada_up_axis = isCollada(path);
  Scene scene = loadScene(path, options);
  for (Scene::Obstacle& obstacle : scene.obstacles) {
    obstacle.object->setTransform(yUp(path) * obstacle.object->getTransform());
    obstacle.object->computeAABB();
  }
  return scene;
}

/// Reads the section [problem] of a problem of OMPL.app: meshes beside the file, start and goal as a position and a
/// turn about an axis, bounds of the position.
PlanningTask readTask(const std::string& path) {
  boost::property_tree::ptree tree;
  try {
    boost::property_tree::read_ini(path, tree);
  } catch (const boost::property_tree::ini_parser_error& error) {
    throw std::runtime_error(fmt::format("{}: {}", path, error.message()));
  }
  const auto section = tree.get_child_optional("problem");
  if (!section) throw std::runtime_error(path + ": has no section [problem]");
  using Path = boost::property_tree::ptree::path_type;
  const auto text = [&](const std::string& key) {
    const auto value = section->get_optional<std::string>(Path(key, '/'));  // keys have dots in them
    if (!value) throw std::runtime_error(fmt::format("{}: [problem] has no '{}'", path, key));
    return *value;
  };
  const auto number = [&](const std::string& key) {
    const auto value = section->get_optional<double>(Path(key, '/'));
    if (!value) throw std::runtime_error(fmt::format("{}: [problem] has no number '{}'", path, key));
    return *value;
  };
  const auto point = [&](const std::string& key) {
    return Eigen::Vector3d{number(key + ".x"), number(key + ".y"), number(key + ".z")};
  };
  const auto pose = [&](const std::string& key) {
    const Eigen::Vector3d p = point(key), axis = point(key + ".axis");
    if (!(axis.norm() > 0)) throw std::runtime_error(fmt::format("{}: '{}.axis' is no direction", path, key));
    const Eigen::Quaterniond q(Eigen::AngleAxisd(number(key + ".theta"), axis.normalized()));
    return std::vector<double>{p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()};
  };
  PlanningTask task;
  task.name = text("name");
  task.start = pose("start");
  task.goal = pose("goal");
  task.options.position_lower = point("volume.min");
  task.options.position_upper = point("volume.max");
  const fs::path folder = fs::path(path).parent_path();
  task.body = readBody(folder / text("robot"));
  task.scene = readSurroundings(folder / text("world"));
  return task;
}

fcl::Transform3d toPose(const std::vector<double>& values) {
  return Eigen::Translation3d(values[0], values[1], values[2]) *
         Eigen::Quaterniond(values[6], values[3], values[4], values[5]).normalized();
}

bool touches(const PlanningTask& task, const std::vector<double>& values) {
  const fcl::Transform3d pose = toPose(values);
  return std::any_of(task.scene.obstacles.begin(), task.scene.obstacles.end(), [&](const Scene::Obstacle& obstacle) {
    fcl::CollisionResultd result;
    return fcl::collide(task.body.get(), pose, obstacle.object->collisionGeometry().get(),
                        obstacle.object->getTransform(), fcl::CollisionRequestd(), result) > 0;
  });
}

/// FCL's static test of a state.
class FclState : public ob::StateValidityChecker {
 public:
  FclState(const ob::SpaceInformationPtr& si, PlanningSetup setup, const PlanningTask& task)
      : StateValidityChecker(si), setup_(std::move(setup)), task_(task) {}
  bool isValid(const ob::State* state) const override { return !touches(task_, setup_.values(state)); }

 private:
  PlanningSetup setup_;  ///< for the values of states
  const PlanningTask& task_;
};

/// FCL's continuous collision by conservative advancement along a screw, with the numbers that OMPL.app asks with.
class FclAdvancement : public ob::MotionValidator {
 public:
  FclAdvancement(const ob::SpaceInformationPtr& si, PlanningSetup setup, const PlanningTask& task)
      : MotionValidator(si), setup_(std::move(setup)), task_(task) {}
  bool checkMotion(const ob::State* s1, const ob::State* s2) const override {
    double time = 1;
    return si_->isValid(s2) && !meets(s1, s2, time);
  }
  bool checkMotion(const ob::State* s1, const ob::State* s2, std::pair<ob::State*, double>& lastValid) const override {
    double time = 1;
    if (!meets(s1, s2, time) && si_->isValid(s2)) return true;
    lastValid.second = std::max(time - 0.01, 0.0);
    if (lastValid.first) si_->getStateSpace()->interpolate(s1, s2, lastValid.second, lastValid.first);
    return false;
  }

 private:
  bool meets(const ob::State* s1, const ob::State* s2, double& time) const {
    const fcl::Transform3d begin = toPose(setup_.values(s1)), end = toPose(setup_.values(s2));
    const fcl::ContinuousCollisionRequestd request(10, 0.0001, fcl::CCDM_SCREW, fcl::GST_LIBCCD,
                                                   fcl::CCDC_CONSERVATIVE_ADVANCEMENT);
    bool any = false;
    for (const Scene::Obstacle& obstacle : task_.scene.obstacles) {
      fcl::ContinuousCollisionResultd result;
      const fcl::Transform3d& still = obstacle.object->getTransform();
      fcl::continuousCollide(task_.body.get(), begin, end, obstacle.object->collisionGeometry().get(), still, still,
                             request, result);
      any = any || result.is_collide;
      if (result.is_collide) time = std::min(time, result.time_of_contact);
    }
    return any;
  }

  PlanningSetup setup_;
  const PlanningTask& task_;
};

struct RigidOutcome {
  std::string task;
  int validator = 0, seed = 0;
  bool solved = false, raw_collides = false, simplified_collides = false;
  double plan_ms = 0, simplify_ms = 0;
  std::vector<double> valid_us, invalid_us;
};

class RigidBench {
 public:
  explicit RigidBench(const RigidOptions& options) : options_(options) {
    for (const std::string& path : options.problems) tasks_.push_back(readTask(path));
  }

  void run() {
    ProgressBar bar;
    int done = 0;
    for (const PlanningTask& task : tasks_) {
      if (touches(task, task.start)) throw std::runtime_error(task.name + ": the body touches at the start");
      if (touches(task, task.goal)) throw std::runtime_error(task.name + ": the body touches at the goal");
      for (int seed = 1; seed <= options_.seeds; ++seed) {
        for (int v = 0; v < kRigidValidators; ++v) {
          planWith(task, v, seed);
          bar.show(static_cast<double>(++done) /
                   (static_cast<double>(tasks_.size()) * options_.seeds * kRigidValidators));
        }
      }
    }
  }

  bool sound() const {
    return std::none_of(outcomes_.begin(), outcomes_.end(), [](const RigidOutcome& o) {
      return o.validator == kRigidOurs && (o.raw_collides || o.simplified_collides);
    });
  }

  std::string table() const {
    std::string out = fmt::format("A mesh among meshes, RRTConnect, {} seeds each; times: medians\n\n", options_.seeds);
    out += fmt::format("{:<14}{:<18}{:>8}{:>10}{:>13}{:>18}{:>18}{:>14}{:>14}\n", "problem", "validator", "solved",
                       "plan ms", "simplify ms", "valid us (n)", "invalid us (n)", "raw collide", "simplified");
    for (const PlanningTask& task : tasks_) {
      for (int v = 0; v < kRigidValidators; ++v) {
        std::size_t asked = 0, solved = 0, raw = 0, simplified = 0;
        std::vector<double> plan, simplify, valid, invalid;
        for (const RigidOutcome& o : outcomes_) {
          if (o.task != task.name || o.validator != v) continue;
          ++asked;
          valid.insert(valid.end(), o.valid_us.begin(), o.valid_us.end());
          invalid.insert(invalid.end(), o.invalid_us.begin(), o.invalid_us.end());
          if (!o.solved) continue;
          ++solved;
          raw += o.raw_collides;
          simplified += o.simplified_collides;
          plan.push_back(o.plan_ms);
          simplify.push_back(o.simplify_ms);
        }
        out += fmt::format("{:<14}{:<18}{:>8}{:>10.0f}{:>13.0f}{:>18}{:>18}{:>14}{:>14}\n", task.name, kRigidNames[v],
                           fmt::format("{} of {}", solved, asked), median(plan), median(simplify),
                           fmt::format("{:.1f} ({})", median(valid), valid.size()),
                           fmt::format("{:.1f} ({})", median(invalid), invalid.size()), raw, simplified);
      }
    }
    return out +
           "\ncollide: seen by FCL's static test in steps 100 times finer than OMPL's default, along the "
           "space's interpolate()\n";
  }

  std::string csv() const {
    std::string out =
        "problem,validator,seed,solved,plan_ms,simplify_ms,valid_motions,valid_median_us,invalid_motions,"
        "invalid_median_us,raw_collides,simplified_collides\n";
    for (const RigidOutcome& o : outcomes_) {
      out += fmt::format("{},\"{}\",{},{:d},{:.3f},{:.3f},{},{:.3f},{},{:.3f},{:d},{:d}\n", o.task,
                         kRigidNames[o.validator], o.seed, o.solved, o.plan_ms, o.simplify_ms, o.valid_us.size(),
                         median(o.valid_us), o.invalid_us.size(), median(o.invalid_us), o.raw_collides,
                         o.simplified_collides);
    }
    return out;
  }

 private:
  void planWith(const PlanningTask& task, int validator, int seed) {
    const PlanningSetup ours = planning::setUpRigidBody(task.body, task.scene, task.options);
    ob::SpaceInformationPtr si = ours.si;
    if (validator != kRigidOurs) {
      si = std::make_shared<ob::SpaceInformation>(ours.space);
      si->setStateValidityChecker(std::make_shared<FclState>(si, ours, task));
      if (validator == kAdvancement) si->setMotionValidator(std::make_shared<FclAdvancement>(si, ours, task));
      si->setup();
    }
    const auto timed = TimedMotionValidator::wrap(si);
    const Plans made = plan(si, ours, task.start, task.goal, static_cast<unsigned>(seed), options_.seconds);
    RigidOutcome outcome;
    outcome.task = task.name;
    outcome.validator = validator;
    outcome.seed = seed;
    outcome.solved = made.solved;
    outcome.plan_ms = made.plan_ms;
    outcome.simplify_ms = made.simplify_ms;
    outcome.valid_us = timed->valid_us;
    outcome.invalid_us = timed->invalid_us;
    if (made.solved) {
      const auto collides = [&](const Way& way) {
        return firstSample(ours, way, [&](const std::vector<double>& q) { return touches(task, q); }) >= 0;
      };
      outcome.raw_collides = collides(made.raw);
      outcome.simplified_collides = collides(made.simplified);
    }
    outcomes_.push_back(std::move(outcome));
  }

  const RigidOptions& options_;
  std::vector<PlanningTask> tasks_;
  std::vector<RigidOutcome> outcomes_;
};

int runRigid(RigidOptions& o) {
  removeEarlierOutputs({{"--csv", &o.csv}}, o.problems);
  RigidBench bench(o);
  bench.run();
  fmt::print("{}", bench.table());
  if (!o.csv.empty()) files::write(o.csv, bench.csv());
  return bench.sound() ? kExitFree : kExitContact;
}

}  // namespace

void addRigid(CLI::App& program, int& exit_status) {
  auto options = std::make_shared<RigidOptions>();
  RigidOptions& o = *options;
  CLI::App* verb = program.add_subcommand(
      "rigid", "A mesh among meshes, planned with OMPL's discrete validator over FCL, FCL's continuous one, and ours");
  verb->footer(
      "PROBLEM is a file of OMPL.app (resources/3D of its sources): names of two meshes beside it, start, goal and "
      "the\n"
      "bounds of the position. Every plan is looked at by FCL in steps 100 times finer than OMPL's default.\n"
      "Exit status: 0 no plan made with fcl_artic collides, 1 one does, 2 error.");
  verb->add_option("problems", o.problems, "Files of OMPL.app")
      ->required()
      ->check(CLI::ExistingFile)
      ->type_name("PROBLEM.cfg...");
  addRunOptions(*verb, o);
  verb->callback([options, &exit_status] { exit_status = runRigid(*options); });
}

}  // namespace fcl_artic::app
