// SPDX-License-Identifier: BSD-3-Clause
#include "visibility/cpu_executor.h"

#include <algorithm>
#include <cmath>

namespace fcl_artic {
namespace visibility {
namespace {

constexpr float kNothing = 3e38f;
/// A side flatter than this cuts no column off a row. It is ignored, unless the row as a whole is beyond it.
constexpr double kFlat = 1e-6;

/// Ends of a footprint in one row of pixels; empty where begin > end. The rounding of this is some 1e-8 pixels, which
/// kEta covers.
void rowEnds(const Footprint& f, int row, int& begin, int& end) {
  const double y = row + 0.5;
  double x0 = f.x0, x1 = f.x1;
  for (int s = 0; s < f.num_sides; ++s) {
    const HalfPlane& side = f.sides[s];
    const double room = side.c - side.b * y;
    if (side.a > kFlat) {
      x1 = std::min(x1, room / side.a - 0.5);
    } else if (side.a < -kFlat) {
      x0 = std::max(x0, room / side.a - 0.5);
    } else if (room < -kFlat * kLargestResolution) {
      x1 = -1;
    }
  }
  begin = static_cast<int>(std::ceil(std::min(x0, f.x1 + 1.0)));
  end = static_cast<int>(std::floor(std::max(x1, -1.0)));
}

/// Depths of a footprint in pixels [begin, begin + n) of a row.
void rowDepths(const Footprint& f, int row, int begin, int n, float* lower, float* upper) {
  const float y = static_cast<float>(row) + 0.5f, x = static_cast<float>(begin) + 0.5f;
  for (int i = 0; i < n; ++i) {
    lower[i] = f.bounds[0].lower;
    upper[i] = f.bounds[0].upper;
  }
  for (int k = 1; k < f.num_bounds; ++k) {
    const DepthBounds& b = f.bounds[k];
    const float at_row = b.b * y;
    for (int i = 0; i < n; ++i) {
      const float t = b.a * (x + static_cast<float>(i)) + at_row;
      lower[i] = std::max(lower[i], t + b.lower);
      upper[i] = std::min(upper[i], t + b.upper);
    }
  }
}

}  // namespace

void CpuExecutor::drawSwept(const Batch& batch) {
  const std::size_t tiles = kViews * batch.windows.size(), side = static_cast<std::size_t>(batch.resolution);
  nearest_.assign(tiles * side * side, kNothing);
  farthest_.assign(tiles * side * side, -kNothing);
  tile_nearest_.assign(tiles, kNothing);
  tile_farthest_.assign(tiles, -kNothing);
  unusable_.assign(batch.windows.size(), 0);
  float lower[kLargestResolution], upper[kLargestResolution];
  for (const Batch::SweptVolume& swept : batch.swept) {
    const auto w = static_cast<std::size_t>(swept.window);
    for (int view = 0; view < kViews; ++view) {
      const auto outcome = projector_.project(batch, swept.volume, batch.windows[w], view, footprint_);
      if (outcome == Projector::Outcome::unusable) unusable_[w] = 1;
      if (outcome != Projector::Outcome::mayCover) continue;
      const std::size_t tile = tileBegin(batch, swept.window, view),
                        index = kViews * w + static_cast<std::size_t>(view);
      tile_nearest_[index] = std::min(tile_nearest_[index], footprint_.bounds[0].lower);
      tile_farthest_[index] = std::max(tile_farthest_[index], footprint_.bounds[0].upper);
      for (int row = footprint_.y0; row <= footprint_.y1; ++row) {
        int begin, end;
        rowEnds(footprint_, row, begin, end);
        const int n = end - begin + 1;
        if (n <= 0) continue;
        rowDepths(footprint_, row, begin, n, lower, upper);
        const std::size_t at = tile + static_cast<std::size_t>(row) * side + static_cast<std::size_t>(begin);
        for (int i = 0; i < n; ++i) {
          const std::size_t pixel = at + static_cast<std::size_t>(i);
          nearest_[pixel] = std::min(nearest_[pixel], lower[i]);
          farthest_[pixel] = std::max(farthest_[pixel], upper[i]);
        }
      }
    }
  }
}

/// Whether in some pixel of the footprint its depths meet those of the swept volumes.
bool CpuExecutor::meetsDepths(const Batch& batch, int window, int view) const {
  const Footprint& f = footprint_;
  const auto index = static_cast<std::size_t>(kViews * window + view),
             side = static_cast<std::size_t>(batch.resolution);
  // As a whole in front of all swept volumes, or behind all.
  if (!(f.bounds[0].upper >= tile_nearest_[index] && f.bounds[0].lower <= tile_farthest_[index])) return false;
  float lower[kLargestResolution], upper[kLargestResolution];
  for (int row = f.y0; row <= f.y1; ++row) {
    int begin, end;
    rowEnds(f, row, begin, end);
    const int n = end - begin + 1;
    if (n <= 0) continue;
    rowDepths(f, row, begin, n, lower, upper);
    const std::size_t at =
        tileBegin(batch, window, view) + static_cast<std::size_t>(row) * side + static_cast<std::size_t>(begin);
    int meets = 0;
    for (int i = 0; i < n; ++i) {
      const std::size_t pixel = at + static_cast<std::size_t>(i);
      meets |= upper[i] >= nearest_[pixel] && lower[i] <= farthest_[pixel];
    }
    if (meets) return true;
  }
  return false;
}

bool CpuExecutor::mayOverlap(const Batch& batch, const Batch::Object& object) {
  if (unusable_[static_cast<std::size_t>(object.window)]) return true;
  for (int view = 0; view < kViews; ++view) {
    const auto outcome = projector_.project(batch, object.volume, batch.windowOf(object.window), view, footprint_);
    if (outcome == Projector::Outcome::unusable) return true;
    if (outcome == Projector::Outcome::misses || !meetsDepths(batch, object.window, view)) return false;
  }
  return true;
}

void CpuExecutor::run(const Batch& batch, std::vector<std::uint8_t>& may) {
  projector_.setGrowth(batch.growth);
  drawSwept(batch);
  may.assign(static_cast<std::size_t>(batch.num_groups), 0);
  for (const Batch::Object& object : batch.objects) {
    std::uint8_t& group = may[static_cast<std::size_t>(object.group)];
    group = group || mayOverlap(batch, object);
  }
}

}  // namespace visibility
}  // namespace fcl_artic
