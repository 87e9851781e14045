// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "visibility/footprint.h"

namespace fcl_artic {
namespace visibility {

/// Scan conversion of the footprints: no OpenGL, the same bits each time, and no more of a batch drawn than its answer
/// needs.
class FCL_ARTIC_EXPORT CpuExecutor : public Executor {
 public:
  void run(const Batch& batch, std::vector<std::uint8_t>& may) override;

 private:
  void drawSwept(const Batch& batch);
  bool mayOverlap(const Batch& batch, const Batch::Object& object);
  bool meetsDepths(const Batch& batch, int window, int view) const;
  std::size_t tileBegin(const Batch& batch, int window, int view) const {
    const auto side = static_cast<std::size_t>(batch.resolution);
    return static_cast<std::size_t>(kViews * window + view) * side * side;
  }

  Projector projector_;
  Footprint footprint_;
  std::vector<float> nearest_, farthest_;            ///< depths of the swept volumes, by tile and pixel
  std::vector<float> tile_nearest_, tile_farthest_;  ///< the least and the largest of a tile
  std::vector<std::uint8_t> unusable_;               ///< windows of whose swept volumes one can't be drawn
};

}  // namespace visibility
}  // namespace fcl_artic
