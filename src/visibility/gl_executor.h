// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "visibility/footprint.h"
#include "visibility/gl_functions.h"

namespace fcl_artic {
namespace visibility {

/// The rule in OpenGL 4.3: all tiles in one atlas, one draw of what is swept, one of the objects, one read. With the
/// rule `occlusion`: a depth buffer and an occlusion query per group, view and direction.
class GlExecutor : public Executor {
 public:
  /// @throws std::runtime_error when a shader or buffer can't be had.
  explicit GlExecutor(std::unique_ptr<OffscreenContext> context);
  ~GlExecutor() override;
  void run(const Batch& batch, std::vector<std::uint8_t>& may) override;

 private:
  struct Vertex {
    float position[2], corner[2], plane[4], flat_bounds[2];
    std::uint32_t id;
  };
  /// Vertices of a group in a view, one after the other.
  struct VertexRange {
    std::int32_t first = 0, count = 0;
  };
  struct Current;  ///< the context is the thread's while it lives

  void resizeAtlas(int columns, int rows, int resolution);
  void runWindows(const Batch& batch, std::int32_t begin, std::int32_t end, std::vector<std::uint8_t>& may);
  void place(const Batch& batch, const Footprint& footprint, int tile, std::uint32_t id,
             std::vector<Vertex>& vertices) const;
  void draw(GLuint program, const std::vector<Vertex>& vertices) const;
  void upload(const std::vector<Vertex>& vertices) const;
  void markIntervals(std::vector<std::uint32_t>& flags);
  void askQueries(std::vector<std::uint32_t>& flags);
  void requireNoError(const char* what) const;

  std::unique_ptr<OffscreenContext> context_;
  std::unique_ptr<GlFunctions> gl_;
  double eta_ = 0;
  GLuint swept_program_ = 0, object_program_ = 0, near_program_ = 0, far_program_ = 0;
  GLuint array_ = 0, vertices_ = 0, flags_ = 0, intervals_ = 0, depths_ = 0, target_ = 0, empty_target_ = 0,
         depth_target_ = 0;
  int width_ = 0, height_ = 0, columns_ = 1;
  std::vector<GLuint> queries_;
  // State of the present run.
  Projector projector_;
  Footprint footprint_;
  std::vector<Vertex> swept_, objects_;
  std::vector<VertexRange> ranges_;
};

}  // namespace visibility
}  // namespace fcl_artic
