// SPDX-License-Identifier: BSD-3-Clause
#include "edges/scene_source.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <stdexcept>

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>
#include <fmt/format.h>

#include "certificate/sha256.h"
#include "edges/first_rows.h"
#include "edges/inputs.h"
#include "usage.h"

namespace fcl_artic::app {
namespace {

namespace fs = std::filesystem;

std::string endingOf(const std::string& path) {
  std::string ending = fs::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  return ending;
}

/// Other files in a folder (materials, pictures, notes) are no scenes.
bool hasSceneEnding(const std::string& path) {
  const std::string ending = endingOf(path);
  for (const char* known : {".urdf", ".scene", ".bt", ".ot", ".pcd", ".xyz", ".ply", ".obj", ".stl", ".dae", ".off",
                            ".gltf", ".glb", ".h5", ".hdf5"}) {
    if (ending == known) return true;
  }
  return false;
}

std::shared_ptr<fcl::CollisionGeometryd> makeShape(std::int64_t kind, const double* size) {
  const auto need = [&](int numbers) {
    for (int k = 0; k < numbers; ++k) {
      if (!(std::isfinite(size[k]) && size[k] > 0))
        throw std::invalid_argument(fmt::format("its size {} is not a length above 0", size[k]));
    }
  };
  switch (kind) {
    case static_cast<std::int64_t>(ShapeKind::box):
      need(3);
      return std::make_shared<fcl::Boxd>(size[0], size[1], size[2]);
    case static_cast<std::int64_t>(ShapeKind::sphere):
      need(1);
      return std::make_shared<fcl::Sphered>(size[0]);
    case static_cast<std::int64_t>(ShapeKind::cylinder):
      need(2);
      return std::make_shared<fcl::Cylinderd>(size[0], size[1]);
    case static_cast<std::int64_t>(ShapeKind::capsule):
      need(2);
      return std::make_shared<fcl::Capsuled>(size[0], size[1]);
    default:
      throw std::invalid_argument(
          fmt::format("its kind {} is none of 0 (box) to {} (capsule)", kind, kNumShapeKinds - 1));
  }
}

}  // namespace

bool isHdf5(const std::string& path) {
  const std::string ending = endingOf(path);
  return ending == ".h5" || ending == ".hdf5";
}

SceneSource::SceneSource() : scenes_(1), hash_(certificate::sha256Text("no scenes")) {
  scenes_[0].name = "scene";
}

SceneSource::SceneSource(const std::vector<std::string>& paths, SceneOptions options) : options_(std::move(options)) {
  std::string hashes;
  for (const std::string& path : paths) {
    const std::string missing = requireInput(path);
    if (!missing.empty()) throw std::invalid_argument("--scenes " + missing);
    std::error_code none;
    if (!fs::is_directory(path, none)) {
      addFile(path, hashes);
      continue;
    }
    std::vector<std::string> files;
    std::vector<std::string> passed_over;
    for (const auto& entry : fs::directory_iterator(path)) {
      const bool is_scene = entry.is_regular_file() && hasSceneEnding(entry.path().string());
      (is_scene ? files : passed_over).push_back(is_scene ? entry.path().string() : entry.path().filename().string());
    }
    std::sort(passed_over.begin(), passed_over.end());
    if (!passed_over.empty()) {
      notes_.push_back(fmt::format("--scenes '{}': passed over, as a scene's ending is none of theirs: {}", path,
                                   fmt::join(passed_over, ", ")));
    }
    if (files.empty())
      throw std::invalid_argument(fmt::format("--scenes '{}': no file of this folder has a scene's ending", path));
    std::sort(files.begin(), files.end());
    for (const std::string& file : files) addFile(file, hashes);
  }
  if (scenes_.empty()) throw std::invalid_argument("--scenes: there is no scene in what is named");
  hash_ = certificate::sha256Text(hashes);
}

void SceneSource::addFile(const std::string& path, std::string& hashes) {
  if (isHdf5(path)) return addShapes(path, hashes);
  scenes_.push_back({fs::path(path).filename().string(), path, -1, 0});
  hashes += sceneFileHash(path, options_) + "\n";
}

void SceneSource::addShapes(const std::string& path, std::string& hashes) {
  hdf5::File file(path);
  const std::vector<std::size_t> first = file.shape("first");
  if (first.size() != 1 || first[0] < 1) {
    throw std::runtime_error(fmt::format("'{}': dataset 'first' is to be one column of obstacles' numbers", path));
  }
  const std::size_t obstacles = file.shape("kind").at(0);
  const auto need = [&](const char* name, std::size_t columns) {
    const std::vector<std::size_t> shape = file.shape(name);
    if (shape == std::vector<std::size_t>{obstacles, columns}) return;
    throw std::runtime_error(fmt::format("'{}': dataset '{}' is to have {} rows of {} columns, one for each obstacle",
                                         path, name, obstacles, columns));
  };
  requireAllRows(file, "first", "kind");
  need("size", 3);
  need("position", 3);
  if (file.has("orientation")) need("orientation", 4);
  std::vector<double> values;
  for (const char* name : {"first", "kind", "size", "position", "orientation"}) {
    if (!file.has(name)) continue;
    const std::size_t rows = file.shape(name)[0];
    for (std::size_t begin = 0; begin < rows; begin += kRowsAtOnce) {
      file.read(name, begin, std::min(kRowsAtOnce, rows - begin), values);
      hashes += name +
                (' ' + certificate::sha256Text(
                           {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(double)})) +
                "\n";
    }
  }
  const std::string stem = fs::path(path).stem().string();
  for (std::size_t s = 0; s + 1 < first[0]; ++s) {
    scenes_.push_back({stem + "/" + std::to_string(s), path, static_cast<int>(files_.size()), s});
  }
  files_.push_back(std::move(file));
}

Scene SceneSource::load(std::size_t scene) const {
  const Entry& entry = scenes_.at(scene);
  if (entry.path.empty()) return {};
  return entry.file < 0 ? loadScene(entry.path, options_) : loadShapes(entry);
}

Scene SceneSource::loadShapes(const Entry& entry) const {
  const hdf5::File& file = files_[static_cast<std::size_t>(entry.file)];
  const auto fail = [&](const std::string& what) {
    throw std::runtime_error(fmt::format("'{}', scene {}: {}", entry.path, entry.number, what));
  };
  std::vector<std::int64_t> first, kind;
  file.read("first", entry.number, 2, first);
  const std::size_t all = file.shape("kind").at(0);
  if (first[0] < 0 || first[1] < first[0] || static_cast<std::size_t>(first[1]) > all) {
    fail(fmt::format("'first' has it hold obstacles {} to {} of {}", first[0], first[1], all));
  }
  const auto begin = static_cast<std::size_t>(first[0]), count = static_cast<std::size_t>(first[1]) - begin;
  std::vector<double> size, position, orientation;
  file.read("kind", begin, count, kind);
  file.read("size", begin, count, size);
  file.read("position", begin, count, position);
  if (file.has("orientation")) file.read("orientation", begin, count, orientation);
  Scene scene;
  for (std::size_t i = 0; i < count; ++i) {
    fcl::Transform3d M = fcl::Transform3d::Identity();
    M.translation() = options_.scale * Eigen::Vector3d::Map(&position[3 * i]);
    if (!orientation.empty()) {
      const Eigen::Quaterniond q(Eigen::Vector4d::Map(&orientation[4 * i]));
      if (!(std::abs(q.norm() - 1) < 1e-3))
        fail(fmt::format("obstacle {}: its orientation is no quaternion of length 1", i));
      M.linear() = q.normalized().toRotationMatrix();
    }
    try {
      const double scaled[3] = {options_.scale * size[3 * i], options_.scale * size[3 * i + 1],
                                options_.scale * size[3 * i + 2]};
      scene.obstacles.push_back(
          {"obstacle" + std::to_string(i), std::make_shared<fcl::CollisionObjectd>(makeShape(kind[i], scaled), M), {}});
    } catch (const std::invalid_argument& error) {
      fail(fmt::format("obstacle {}: {}", i, error.what()));
    }
  }
  return scene;
}

}  // namespace fcl_artic::app
