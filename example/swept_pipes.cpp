// SPDX-License-Identifier: BSD-3-Clause
// Culling by visibility, as a picture (after Figure 6 of Redon, Kim, Lin and Manocha 2004): the volume that the arm's
// last two links sweep amid pipes. Grey pipes are told apart by boxes, green ones by visibility; red ones are left to
// the exact test.
#include <cmath>
#include <iostream>
#include <map>
#include <numeric>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl_artic/fcl_artic.h>
#include <fcl_artic/urdf/urdf.h>

#include "generator.h"
#include "render/image.h"
#include "render/renderer.h"

using namespace fcl_artic;

namespace {

using Mesh = fcl::BVHModel<fcl::OBBRSSd>;

/// The connected parts of a mesh, each as a mesh of its own.
std::vector<std::shared_ptr<Mesh>> splitMesh(const render::Triangles& all) {
  std::map<std::array<double, 3>, int> places;  // vertices at one place are one
  std::vector<int> parent;
  const auto root = [&](int i) {
    while (parent[static_cast<std::size_t>(i)] != i) i = parent[static_cast<std::size_t>(i)];
    return i;
  };
  std::vector<int> place;
  for (const Eigen::Vector3d& v : all.vertices) {
    const auto found = places.emplace(std::array<double, 3>{v.x(), v.y(), v.z()}, static_cast<int>(places.size()));
    if (found.second) parent.push_back(static_cast<int>(parent.size()));
    place.push_back(found.first->second);
  }
  const auto rootOf = [&](int vertex) { return root(place[static_cast<std::size_t>(vertex)]); };
  for (const auto& [a, b, c] : all.faces) {
    for (const int other : {b, c}) parent[static_cast<std::size_t>(rootOf(other))] = rootOf(a);
  }
  std::map<int, std::vector<std::array<int, 3>>> parts;
  for (const auto& face : all.faces) parts[rootOf(face[0])].push_back(face);
  std::vector<std::shared_ptr<Mesh>> meshes;
  for (const auto& [part, faces] : parts) {
    auto mesh = std::make_shared<Mesh>();
    mesh->beginModel();
    for (const auto& face : faces) {
      const auto at = [&](int i) { return all.vertices[static_cast<std::size_t>(face[static_cast<std::size_t>(i)])]; };
      mesh->addTriangle(at(0), at(1), at(2));
    }
    mesh->endModel();
    meshes.push_back(mesh);
  }
  return meshes;
}

enum class Fate { boxes, visibility, left };

/// The fate of one pipe: the motion is asked with this pipe alone.
Fate fateOf(const Robot& robot, const std::vector<LinkGeometry>& links, const std::shared_ptr<Mesh>& pipe,
            const JointMotion& motion) {
  fcl::CollisionObjectd obstacle(pipe);
  ArticulatedCollisionManager manager(robot.tree);
  for (const LinkGeometry& body : links) manager.bind(body.link, body.object.get(), body.offset);
  manager.registerObject(&obstacle);
  manager.setup();
  CertifiedRequest request;
  request.check_self = false;
  request.visibility = VisibilityMode::on;
  CertifiedResult result;
  manager.continuousCollide(motion, request, result);
  if (!result.statistics.visibility.pairs) return Fate::boxes;
  return result.statistics.visibility.culled == result.statistics.visibility.pairs ? Fate::visibility : Fate::left;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string file = argc > 1 ? argv[1] : "swept_pipes.png";
  const Robot robot = loadUrdf("data/puma560/puma560.urdf");
  const generator::Mesh pipes = generator::pipes(60000, 3);
  std::vector<LinkGeometry> links;
  for (const LinkGeometry& body : robot.geometry) {
    const std::string& name = robot.tree->linkName(body.link);
    if (name == "wrist_roll" || name == "flange") links.push_back(body);
  }
  Eigen::VectorXd q0(6), q1(6);  // rad
  q0 << -2.1, 1.0, -1.0, -0.1, -0.1, 0.0;
  q1 << -0.1, 0.3, -2.3, -1.0, 1.1, 0.0;
  const JointMotion motion = JointMotion::linear(*robot.tree, q0, q1);

  render::Stage stage;
  std::vector<Eigen::Isometry3d> M_0;
  const auto draw = [](const fcl::CollisionGeometryd& geometry, const Eigen::Isometry3d& M,
                       const Eigen::Vector3f& color) {
    render::Body body;
    body.surface = render::makeSurface(render::triangulate(geometry));
    body.M_0 = M;
    body.color = color;
    return body;
  };
  const Eigen::Vector3f kColors[] = {{0.45f, 0.47f, 0.50f}, {0.10f, 0.50f, 0.18f}, {0.75f, 0.07f, 0.05f}};
  int count[3] = {0, 0, 0};
  for (const auto& pipe : splitMesh({pipes.vertices, pipes.triangles})) {
    const auto fate = static_cast<std::size_t>(fateOf(robot, links, pipe, motion));
    ++count[fate];
    stage.solid.push_back(draw(*pipe, Eigen::Isometry3d::Identity(), kColors[fate]));
  }
  robot.tree->forwardKinematics(q0, M_0);
  for (const LinkGeometry& body : robot.geometry) {
    stage.solid.push_back(draw(*body.object->collisionGeometry(),
                               M_0[static_cast<std::size_t>(body.link)] * body.offset, {0.80f, 0.62f, 0.25f}));
  }
  constexpr int kPoses = 96;
  render::Ghost swept;
  swept.opacity = 0.55f;
  Eigen::AlignedBox3d box;
  for (const LinkGeometry& body : links) {
    const render::Body link =
        draw(*body.object->collisionGeometry(), Eigen::Isometry3d::Identity(), {0.08f, 0.28f, 0.75f});
    for (int i = 0; i <= kPoses; ++i) {
      robot.tree->forwardKinematics(motion.configuration(static_cast<double>(i) / kPoses), M_0);
      swept.bodies.push_back(link);
      swept.bodies.back().M_0 = M_0[static_cast<std::size_t>(body.link)] * body.offset;
      box.extend(swept.bodies.back().M_0.translation());
    }
  }
  stage.ghosts.push_back(std::move(swept));
  stage.focus = box.center();
  stage.radius = 1.3;
  render::Camera camera;
  camera.target = box.center();
  camera.eye = camera.target + Eigen::Vector3d(2.6, -2.9, 1.9);
  render::Renderer renderer;
  render::writePng(file, renderer.draw(stage, camera, 1200, 800));
  std::cout << count[0] << " pipes told apart by boxes, " << count[1] << " by visibility, " << count[2]
            << " left: " << file << "\n";
}
