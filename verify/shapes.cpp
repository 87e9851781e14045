// SPDX-License-Identifier: BSD-3-Clause
#include "shapes.h"

#include "report.h"

namespace verify {

bool ShapeComparison::same(const Collision& shape, const std::set<std::string>& names, int body) {
  const int number = world_.bodies[static_cast<std::size_t>(body)].geometry;
  const Geometry& g = world_.geometries[static_cast<std::size_t>(number)];
  why_.clear();
  if (g.kind != shape.kind) return false;
  if (shape.kind != Geometry::mesh) {
    std::vector<double> numbers = shape.numbers;
    for (double& x : numbers) x *= scale_;
    return g.numbers == numbers;
  }
  bool named = false;
  for (const std::string& name : names) {
    if (solids_.names.count(name) == 0) continue;
    named = true;
    solids_found_.insert(name);
  }
  if (!g.solid && (solids_.all || named)) {
    why_ = ", as a solid";
    return false;
  }
  std::vector<double> scale = shape.numbers;
  if (scale_ != 1) scale.insert(scale.end(), 3, scale_);
  std::size_t missing = 0;
  if (!meshes_.same(g, number, shape.path, scale, missing)) return false;
  if (missing > 0) left_out_[shape.path] = missing;
  ++(g.solid ? solid_meshes_ : surfaces_);
  return true;
}

void ShapeComparison::note(const std::string& whose, Comparison& comparison) const {
  comparison.solids = solids_found_;
  for (const auto& [path, count] : left_out_)
    comparison.notes.push_back("'" + path + "': " + counted(count, "triangle") +
                               " without area, on edges of others, left out of the world");
  if (surfaces_ + solid_meshes_ > 0)
    comparison.notes.push_back("meshes of " + whose + ": " + counted(surfaces_, "surface") +
                               ", of which what lies inside is not checked, and " + counted(solid_meshes_, "solid"));
}

}  // namespace verify
