// SPDX-License-Identifier: BSD-3-Clause
//
// Many scenes: of files, of a folder of them, or of shapes in an HDF5 file, loaded one after the other.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "fcl_artic/urdf/urdf.h"
#include "hdf5/hdf5.h"

namespace fcl_artic::app {

/// A scene of an HDF5 file: `first` has for each scene the number of its first obstacle, and once more at its end the
/// number of all. Obstacles have `kind`, `size` (three columns), `position` (three) and, unless all stand upright,
/// `orientation` (x, y, z, w).
enum class ShapeKind : std::int8_t {
  box = 0,       ///< size: full lengths along x, y, z
  sphere = 1,    ///< size: radius
  cylinder = 2,  ///< size: radius, length along z
  capsule = 3    ///< size: radius, length along z between the centres of its ends
};
constexpr int kNumShapeKinds = 4;

class SceneSource {
 public:
  /// No scenes of their own: one that has no obstacle.
  SceneSource();
  /// @param paths  files that loadScene() reads, folders of them (those of a known ending, by name), HDF5 files.
  /// @throws std::invalid_argument, std::runtime_error naming what is not there, or holds no scene.
  SceneSource(const std::vector<std::string>& paths, SceneOptions options);

  std::size_t size() const { return scenes_.size(); }
  const std::string& name(std::size_t scene) const { return scenes_[scene].name; }
  /// SHA-256 of all files that scenes are made of.
  const std::string& hash() const { return hash_; }
  /// A line for each folder: the files in it that were passed over.
  const std::vector<std::string>& notes() const { return notes_; }
  /// @throws as loadScene(), naming the file, and of an HDF5 file the scene and its obstacle.
  Scene load(std::size_t scene) const;

 private:
  struct Entry {
    std::string name, path;
    int file = -1;           ///< of HDF5
    std::size_t number = 0;  ///< in it
  };
  void addFile(const std::string& path, std::string& hashes);
  void addShapes(const std::string& path, std::string& hashes);
  Scene loadShapes(const Entry& entry) const;

  SceneOptions options_;
  std::vector<Entry> scenes_;
  std::vector<hdf5::File> files_;
  std::vector<std::string> notes_;
  std::string hash_;
};

/// Whether a path names an HDF5 file by its ending.
bool isHdf5(const std::string& path);

}  // namespace fcl_artic::app
