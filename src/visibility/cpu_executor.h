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
  /// The findings of an object's fragments: some is not in front of the swept volumes, some not behind, some neither.
  struct DepthFindings {
    bool not_in_front = false, not_behind = false, between = false;
    bool all() const { return not_in_front && not_behind && between; }
  };
  void drawSwept(const Batch& batch);
  DepthFindings compareDepths(const Batch& batch, const Footprint& footprint, int window, int view) const;
  bool mayOverlap(const Batch& batch, const Batch::Object& object);
  bool groupMayOverlap(const Batch& batch, std::size_t begin, std::size_t end);
  std::size_t tileBegin(const Batch& batch, int window, int view) const {
    const auto side = static_cast<std::size_t>(batch.resolution);
    return static_cast<std::size_t>(kViews * window + view) * side * side;
  }

  Projector projector_;
  Footprint footprint_;
  std::vector<float> nearest_, farthest_;  ///< of the swept volumes, by tile and pixel
  std::vector<float> tile_nearest_, tile_farthest_;
  std::vector<std::uint8_t> unusable_;  ///< by window: something in it could not be drawn
};

}  // namespace visibility
}  // namespace fcl_artic
