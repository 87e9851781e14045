// SPDX-License-Identifier: BSD-3-Clause
#include "pipe_steps.h"

#include <filesystem>
#include <random>
#include <stdexcept>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fmt/format.h>

#include "generator.h"
#include "kinematics/angles.h"
#include "step_costs.h"
#include "usage.h"

namespace fcl_artic::app {
namespace {

constexpr std::size_t kMaxTrajectories = 200000;  // then the scene is taken to have no more steps of a kind

Robot makePuma() {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / fmt::format("fcl_artic_puma560_{}", std::random_device()());
  generator::writePuma560(folder.string());
  struct Remove {
    std::filesystem::path folder;
    ~Remove() {
      std::error_code ignored;
      std::filesystem::remove_all(folder, ignored);
    }
  } remove{folder};
  return loadUrdf((folder / "puma560.urdf").string());
}

Scene::Obstacle obstacleOf(const generator::Mesh& mesh, const std::string& name) {
  auto model = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
  std::vector<fcl::Triangle> faces;
  for (const auto& t : mesh.triangles) faces.emplace_back(t[0], t[1], t[2]);
  model->beginModel(static_cast<int>(mesh.triangles.size()), static_cast<int>(mesh.vertices.size()));
  model->addSubModel(mesh.vertices, faces);
  model->endModel();
  return {name, std::make_shared<fcl::CollisionObjectd>(model), {}};
}

/// Random configurations and directions within the joints' limits; joints without limits turn within +-pi.
class Space {
 public:
  Space(const KinematicTree& tree, std::uint64_t seed) : random_(seed), low_(tree.dof()), high_(tree.dof()) {
    for (int v = 0; v < tree.dof(); ++v) {
      const Joint& joint = tree.joint(tree.variableJoint(v));
      low_[v] = hasLimits(joint) ? joint.lower : -180 * kRadiansPerDegree;
      high_[v] = hasLimits(joint) ? joint.upper : 180 * kRadiansPerDegree;
    }
  }
  Eigen::VectorXd configuration() {
    Eigen::VectorXd q(low_.size());
    for (int v = 0; v < q.size(); ++v) q[v] = random_.uniform(low_[v], high_[v]);
    return q;
  }
  /// Its largest entry is 1 or -1.
  Eigen::VectorXd direction() {
    Eigen::VectorXd d(low_.size());
    for (double& x : d) x = random_.uniform(-1, 1);
    return d / d.lpNorm<Eigen::Infinity>();
  }
  bool holds(const Eigen::VectorXd& q) const {
    return (q.array() >= low_.array()).all() && (q.array() <= high_.array()).all();
  }

 private:
  Random random_;
  Eigen::VectorXd low_, high_;
};

}  // namespace

void addPipeOptions(CLI::App& verb, PipeOptions& o) {
  verb.add_option("--angles", o.angles, "Angle by which the joint that moves most moves in a step, degrees")
      ->check(CLI::Range(0.01, 90.0))
      ->capture_default_str()
      ->type_name("DEG...");
  verb.add_option("--queries", o.queries, "Colliding steps and free steps for each angle")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  verb.add_option("--closeness", o.closeness, "Free steps come within this of a pipe, in m")
      ->check(requirePositive)
      ->capture_default_str();
  verb.add_flag("--self", o.self, "Links against links too; else, as in the paper, against the pipes only");
  verb.add_option("--triangles", o.triangles, "Triangles of the pipes")
      ->check(CLI::Range(generator::kMinPipeTriangles, generator::kMaxPipeTriangles))
      ->capture_default_str();
  verb.add_flag("--one-mesh", o.one_mesh, "All pipes are one obstacle; else each is one of its own");
  verb.add_option("--seed", o.seed, "The same seed asks the same queries")->capture_default_str();
}

PumaInPipes pumaInPipes(const PipeOptions& o) {
  PumaInPipes s;
  s.robot = makePuma();
  if (o.one_mesh) {
    s.pipes.obstacles.push_back(obstacleOf(generator::pipes(o.triangles, o.seed), "pipes"));
  } else {
    for (const generator::Mesh& pipe : generator::separatePipes(o.triangles, o.seed)) {
      s.pipes.obstacles.push_back(obstacleOf(pipe, fmt::format("pipe {}", s.pipes.obstacles.size() + 1)));
    }
  }
  s.manager = std::make_unique<ArticulatedCollisionManager>(s.robot.tree);
  s.robot.addTo(*s.manager);
  s.pipes.addTo(*s.manager);
  s.manager->prepareFor(Method::redon2004);
  s.manager->setup();
  return s;
}

std::string CloseSteps::summary() const {
  return fmt::format("{:g} degrees: {} of {} free steps are close; {:.1f} leaf pairs in the mean\n", degrees,
                     free.size(), looked_at, leaf_pairs);
}

std::string CloseSteps::refusal() const {
  if (leaf_pairs > 0) return {};
  return fmt::format("the free steps of {:g} degrees have no leaf pairs, so they measure no exact contact", degrees);
}

CloseSteps closeSteps(const PumaInPipes& scenery, const PipeOptions& o, double degrees) {
  const KinematicTree& tree = *scenery.robot.tree;
  CloseSteps steps;
  steps.degrees = degrees;
  const double angle = degrees * kRadiansPerDegree;
  Space space(tree, 100000 * o.seed + static_cast<std::uint64_t>(1000 * degrees));
  CertifiedRequest verdict, near;
  near.mode = ContactMode::any;
  near.check_self = false;
  near.margin = o.closeness;
  CertifiedResult result;
  for (std::size_t n = 0; steps.colliding.size() < o.queries || steps.free.size() < o.queries; ++n) {
    if (n == kMaxTrajectories) {
      throw std::runtime_error(fmt::format(
          "{} trajectories in steps of {:g} degrees have {} steps that hit a pipe and {} "
          "free ones within {:g} m of one; {} of each were asked for",
          kMaxTrajectories, steps.degrees, steps.colliding.size(), steps.free.size(), o.closeness, o.queries));
    }
    Eigen::VectorXd q = space.configuration();
    const Eigen::VectorXd step = angle * space.direction();
    scenery.manager->collide(q, verdict, result);
    if (result.status != Status::free) continue;
    for (; space.holds(q + step); q += step) {
      const JointMotion motion = JointMotion::linear(tree, q, q + step);
      scenery.manager->continuousCollide(motion, verdict, result);
      if (result.status != Status::free) {
        const bool hits = result.status == Status::contact && result.certain && result.first()->body2.link < 0;
        if (hits && steps.colliding.size() < o.queries) steps.colliding.push_back(motion);
        break;
      }
      if (steps.free.size() == o.queries) continue;
      ++steps.looked_at;
      scenery.manager->continuousCollide(motion, near, result);
      if (result.status != Status::free) steps.free.push_back(motion);
    }
  }
  CertifiedRequest paper;
  paper.method = Method::redon2004;
  paper.check_self = o.self;
  std::size_t differ = 0;
  steps.leaf_pairs = measureSteps(*scenery.manager, steps.free, paper, 1, false, differ).leaf_pairs;
  return steps;
}

std::string description(const PumaInPipes& scenery, const PipeOptions& o, int passes) {
  const std::size_t pipes = scenery.pipes.obstacles.size();
  return fmt::format(
      "PUMA 560 in Pipes of {} triangles, {}. (The paper's own scene of\n"
      "that name is another one; its size isn't known.) Steps of straight trajectories\n"
      "from random free configurations, the joint that moves most by the angle: {} that\n"
      "hit a pipe and {} free ones within {:g} mm of a pipe, the fastest of {} runs each.\n"
      "Links are checked against {}.\n",
      o.triangles, o.one_mesh ? "one mesh" : fmt::format("{} obstacle{}", pipes, pipes == 1 ? "" : "s"), o.queries,
      o.queries, 1e3 * o.closeness, passes, o.self ? "pipes and against each other" : "pipes only");
}

}  // namespace fcl_artic::app
