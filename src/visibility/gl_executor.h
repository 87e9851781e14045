// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "visibility/footprint.h"
#include "visibility/gl_functions.h"

namespace fcl_artic {
namespace visibility {

/// The rule in OpenGL 4.3: all tiles in one atlas, one draw of what is swept, one of the objects, one read.
class GlExecutor : public Executor {
 public:
  /// @throws std::runtime_error when a shader or buffer can't be had.
  explicit GlExecutor(std::unique_ptr<OffscreenContext> context);
  ~GlExecutor() override;
  void run(const Batch& batch, std::vector<std::uint8_t>& may) override;

 private:
  /// A footprint as shaders read it.
  struct Record {
    float box[4];   ///< x0, y0, x1 + 1, y1 + 1 in the tile's pixels
    float tile[4];  ///< its corner in the atlas, number of sides, number of bounds
    float sides[Footprint::kMaxSides][4];
    float bounds[Footprint::kMaxBounds][4];
  };
  struct Current;  ///< the context is the thread's while it lives

  void resizeAtlas(int tiles, int resolution);
  void runWindows(const Batch& batch, std::int32_t begin, std::int32_t end, std::vector<std::uint8_t>& may);
  bool add(const Batch& batch, const Volume& volume, std::int32_t window, std::int32_t first_window,
           std::vector<Record>& to);
  void draw(GLuint program, const std::vector<Record>& records) const;
  void readFlags(std::vector<std::uint32_t>& flags) const;
  void requireNoError(const char* what) const;

  std::unique_ptr<OffscreenContext> context_;
  std::unique_ptr<GlFunctions> gl_;
  GLuint swept_program_ = 0, object_program_ = 0, array_ = 0;
  GLuint footprints_ = 0, flags_ = 0, intervals_ = 0;  ///< buffers, and a texture: the swept interval of each pixel
  GLuint target_ = 0, empty_target_ = 0;               ///< the second one takes no colour: objects leave flags only
  int width_ = 0, height_ = 0, columns_ = 1;
  // State of the present run.
  Projector projector_;
  Footprint footprint_;
  std::vector<Record> swept_, objects_;  ///< three records of an object, one a view
  std::vector<std::int32_t> group_of_;   ///< of each object
};

}  // namespace visibility
}  // namespace fcl_artic
