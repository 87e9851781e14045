// SPDX-License-Identifier: BSD-3-Clause
// Whether a body's geometry is the one that a file names.
#pragma once

#include <set>
#include <string>

#include "readers.h"
#include "robot.h"

namespace verify {

class ShapeComparison {
 public:
  /// @param scale  of all lengths of the file.
  ShapeComparison(const World& world, const Solids& solids, double scale = 1)
      : world_(world), solids_(solids), scale_(scale), meshes_(world) {}

  /// Whether the body's geometry, wherever it is, is that shape. @param name  of its link or obstacle in the file.
  bool same(const Collision& shape, const std::set<std::string>& names, int body);
  /// A possible reason of the last answer, as an end of a message.
  const std::string& why() const { return why_; }
  /// Adds notes: how many meshes were found to be surfaces and solids, which had to be solids, and which of their
  /// triangles are left out.
  /// @param whose  "links"
  void note(const std::string& whose, Comparison& comparison) const;

 private:
  const World& world_;
  const Solids& solids_;
  const double scale_;
  MeshComparison meshes_;
  std::map<std::string, std::size_t> left_out_;  // triangles, of files
  std::set<std::string> solids_found_;
  std::size_t surfaces_ = 0, solid_meshes_ = 0;
  std::string why_;
};

}  // namespace verify
