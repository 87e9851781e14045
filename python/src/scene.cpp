// SPDX-License-Identifier: BSD-3-Clause
#include "scene.h"

#include <pybind11/stl.h>

#include <algorithm>

#include "guard_files.h"
#include "kinematics.h"
#include "robot.h"
#include "text/counted.h"
#include "text/nearest_name.h"

namespace fcl_artic::python {
namespace {

Scene load(py::handle path, bool unknown_cells, bool solid_meshes, bool collada_up_axis, double scale,
           double point_radius, py::handle packages, bool import_meshes) {
  const auto file = py::cast<std::string>(py::module_::import("os").attr("fspath")(path));
  SceneOptions options;
  options.unknown_cells = unknown_cells;
  options.solid_meshes = solid_meshes;
  options.collada_up_axis = collada_up_axis;
  options.import_meshes = import_meshes;
  options.scale = scale;
  options.point_radius = point_radius;
  options.packages = packagesOf(packages);
  return guardFiles(file, [&] { return loadScene(file, options); });
}

/// @throws py::value_error naming what is not there.
std::vector<Scene::Obstacle>::iterator find(Scene& scene, const std::string& name) {
  const auto at = std::find_if(scene.obstacles.begin(), scene.obstacles.end(),
                               [&](const Scene::Obstacle& o) { return o.name == name; });
  if (at != scene.obstacles.end()) return at;
  std::vector<std::string> names;
  for (const Scene::Obstacle& o : scene.obstacles) names.push_back(o.name);
  valueError("the scene has no obstacle '" + name + "'" + text::didYouMean(name, names));
}

void add(Scene& scene, const std::string& name, py::handle geometry, py::handle pose) {
  if (name.empty()) valueError("an obstacle needs a name");
  const auto taken = [&](const Scene::Obstacle& o) { return o.name == name; };
  if (std::any_of(scene.obstacles.begin(), scene.obstacles.end(), taken)) {
    valueError("the scene has an obstacle '" + name + "' already");
  }
  scene.obstacles.push_back({name, objectOf(geometryOf(geometry, "geometry"), poseOf(pose, "pose")), {}});
}

Geometry geometryOfObstacle(const Scene::Obstacle& o) {
  return {std::const_pointer_cast<fcl::CollisionGeometryd>(o.object->collisionGeometry())};
}

py::tuple sceneState(const Scene& scene) {
  py::list obstacles;
  for (const Scene::Obstacle& o : scene.obstacles) {
    obstacles.append(py::make_tuple(o.name, geometryState(geometryOfObstacle(o)),
                                    arrayOf(Eigen::Isometry3d(o.object->getTransform())), o.shape_of));
  }
  return py::make_tuple(obstacles, textsOf(scene.notes));
}

Scene sceneOfState(const py::tuple& s) {
  Scene scene;
  for (const py::handle item : py::list(s[0])) {
    const auto o = py::reinterpret_borrow<py::tuple>(item);
    scene.obstacles.push_back({py::cast<std::string>(o[0]), objectOf(geometryOfState(o[1]), poseOf(o[2], "pose")),
                               py::cast<std::string>(o[3])});
  }
  scene.notes = py::cast<std::vector<std::string>>(s[1]);
  return scene;
}

}  // namespace

void bindScene(py::module_& module) {
  py::class_<Scene::Obstacle>(module, "Obstacle", "One obstacle of a scene.")
      .def_readonly("name", &Scene::Obstacle::name)
      .def_readonly("shape_of", &Scene::Obstacle::shape_of)
      .def_property_readonly("geometry", &geometryOfObstacle)
      .def_property_readonly(
          "pose", [](const Scene::Obstacle& o) { return arrayOf(Eigen::Isometry3d(o.object->getTransform())); })
      .def("__repr__", [](const Scene::Obstacle& o) { return py::str("<Obstacle {!r}>").format(o.name); });

  py::class_<Scene>(module, "Scene", "Obstacles that stand still, each with a name.")
      .def(py::init<>())
      .def("add", &add, "Adds an obstacle at a pose in the world.", py::arg("name"), py::arg("geometry"),
           py::arg("pose") = py::none())
      .def(
          "remove", [](Scene& s, const std::string& name) { s.obstacles.erase(find(s, name)); }, "Removes an obstacle.",
          py::arg("name"))
      .def_property_readonly("obstacles", [](const Scene& s) { return py::cast(s.obstacles); })
      .def_property_readonly("names",
                             [](const Scene& s) {
                               py::list names;
                               for (const Scene::Obstacle& o : s.obstacles) names.append(o.name);
                               return names;
                             })
      .def_property_readonly("notes", [](const Scene& s) { return textsOf(s.notes); })
      .def("__getitem__", [](Scene& s, const std::string& name) { return *find(s, name); })
      .def("__contains__",
           [](const Scene& s, const std::string& name) {
             return std::any_of(s.obstacles.begin(), s.obstacles.end(),
                                [&](const Scene::Obstacle& o) { return o.name == name; });
           })
      .def("__iter__", [](const Scene& s) { return py::iter(py::cast(s.obstacles)); })
      .def("__len__", [](const Scene& s) { return s.obstacles.size(); })
      .def("__repr__", [](const Scene& s) { return "<Scene: " + text::counted(s.obstacles.size(), "obstacle") + ">"; })
      .def(py::pickle(&sceneState, &sceneOfState));

  module.def(
      "load_scene", &load,
      "Reads a scene: a mesh (.stl, .obj, .ply, .off, .dae, .gltf, .glb; with `import_meshes` others, by assimp), "
      "URDF,\n"
      "MoveIt's .scene, OctoMap's .bt and .ot, points (.pcd, .xyz, .ply without faces), each a ball of `point_radius`.",
      py::arg("path"), py::kw_only(), py::arg("unknown_cells") = false, py::arg("solid_meshes") = false,
      py::arg("collada_up_axis") = false, py::arg("scale") = 1.0, py::arg("point_radius") = 0.0,
      py::arg("packages") = py::none(), py::arg("import_meshes") = false);
  module.def(
      "load_mesh",
      [](py::handle path, py::handle scale, bool solid, bool collada_up_axis, bool import_meshes) {
        const auto file = py::cast<std::string>(py::module_::import("os").attr("fspath")(path));
        const Eigen::Vector3d factors =
            scale.is_none() ? Eigen::Vector3d(Eigen::Vector3d::Ones()) : vector3Of(scale, "scale");
        std::vector<std::string> notes;
        const Geometry mesh{
            guardFiles(file, [&] { return loadMesh(file, factors, &notes, solid, collada_up_axis, import_meshes); })};
        warn(notes);
        return mesh;
      },
      "Reads a mesh (.stl, .obj, .ply, .off, .dae, .gltf, .glb; with `import_meshes` others, by assimp); `scale` has "
      "a\n"
      "factor for each axis. What is unusual, as what was left out, is a UserWarning.",
      py::arg("path"), py::kw_only(), py::arg("scale") = py::none(), py::arg("solid") = false,
      py::arg("collada_up_axis") = false, py::arg("import_meshes") = false);
  module.def(
      "load_points",
      [](py::handle path, double radius) {
        const auto file = py::cast<std::string>(py::module_::import("os").attr("fspath")(path));
        std::vector<std::string> notes;
        const Geometry cloud{guardFiles(file, [&] { return loadPointCloud(file, radius, &notes); })};
        warn(notes);
        return cloud;
      },
      "Reads a point cloud (.pcd, .ply, .xyz): each point a ball of this radius. What was left out is a UserWarning.",
      py::arg("path"), py::arg("radius"));
  module.def(
      "combine_scenes",
      [](const std::vector<Scene>& scenes, py::handle tree) { return combineScenes(scenes, *treeOf(tree)); },
      "Combines scenes into one for a robot: names that come twice become NAME#2 or so.", py::arg("scenes"),
      py::arg("tree"));
  module.def(
      "unit_notes", [](const Robot& robot, const Scene& scene) { return unitNotes(robot, scene); },
      "What suggests that robot or scene is in other units than metres.", py::arg("robot"), py::arg("scene"));
}

}  // namespace fcl_artic::python
