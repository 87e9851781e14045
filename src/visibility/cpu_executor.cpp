// SPDX-License-Identifier: BSD-3-Clause
#include "visibility/cpu_executor.h"

#include <algorithm>
#include <cmath>

namespace fcl_artic {
namespace visibility {
namespace {

constexpr float kNothing = 3e38f;
/// Growth::eta of this executor: nothing is snapped, and rounding is far less.
constexpr double kEta = 1.0 / 64;
/// A side flatter than this cuts no column off a row. It is ignored, unless the row as a whole is beyond it.
constexpr double kFlat = 1e-6;

/// Ends of a footprint in one row of pixels; empty where begin > end. The rounding of this is some 1e-8 pixels, which
/// Growth::eta covers.
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
        float* near = nearest_.data() + tile + static_cast<std::size_t>(row) * side + static_cast<std::size_t>(begin);
        float* far = farthest_.data() + tile + static_cast<std::size_t>(row) * side + static_cast<std::size_t>(begin);
        for (int i = 0; i < n; ++i) {
          near[i] = std::min(near[i], lower[i]);
          far[i] = std::max(far[i], upper[i]);
        }
      }
    }
  }
}

CpuExecutor::DepthFindings CpuExecutor::compareDepths(const Batch& batch, const Footprint& f, int window,
                                                      int view) const {
  DepthFindings findings;
  const std::size_t index = static_cast<std::size_t>(kViews * window + view);
  const bool intervals = batch.rule == VisibilityRule::intervals;
  // As a whole before or behind all of the swept volumes.
  if (intervals && !(f.bounds[0].upper >= tile_nearest_[index] && f.bounds[0].lower <= tile_farthest_[index]))
    return findings;
  const std::size_t tile = tileBegin(batch, window, view), side = static_cast<std::size_t>(batch.resolution);
  float lower[kLargestResolution], upper[kLargestResolution];
  for (int row = f.y0; row <= f.y1; ++row) {
    int begin, end;
    rowEnds(f, row, begin, end);
    const int n = end - begin + 1;
    if (n <= 0) continue;
    rowDepths(f, row, begin, n, lower, upper);
    const float* near = nearest_.data() + tile + static_cast<std::size_t>(row) * side + static_cast<std::size_t>(begin);
    const float* far = farthest_.data() + tile + static_cast<std::size_t>(row) * side + static_cast<std::size_t>(begin);
    int not_in_front = 0, not_behind = 0, between = 0;
    for (int i = 0; i < n; ++i) {
      const int reaches = upper[i] >= near[i], begins = lower[i] <= far[i];
      not_in_front |= reaches;
      not_behind |= begins;
      between |= reaches & begins;
    }
    findings.not_in_front |= not_in_front != 0;
    findings.not_behind |= not_behind != 0;
    findings.between |= between != 0;
    if (findings.between) return {true, true, true};
  }
  return findings;
}

bool CpuExecutor::mayOverlap(const Batch& batch, const Batch::Object& object) {
  const Window& window = batch.windows[static_cast<std::size_t>(object.window)];
  for (int view = 0; view < kViews; ++view) {
    const auto outcome = projector_.project(batch, object.volume, window, view, footprint_);
    if (outcome == Projector::Outcome::unusable) return true;
    if (outcome == Projector::Outcome::misses || !compareDepths(batch, footprint_, object.window, view).between)
      return false;
  }
  return true;
}

/// CULLIDE's rule: the whole group in front of the swept volumes, or behind them, in some view.
bool CpuExecutor::groupMayOverlap(const Batch& batch, std::size_t begin, std::size_t end) {
  for (int view = 0; view < kViews; ++view) {
    DepthFindings all;
    for (std::size_t i = begin; i < end && !all.all(); ++i) {
      const Batch::Object& object = batch.objects[i];
      const auto outcome = projector_.project(batch, object.volume,
                                              batch.windows[static_cast<std::size_t>(object.window)], view, footprint_);
      if (outcome == Projector::Outcome::unusable) return true;
      if (outcome == Projector::Outcome::misses) continue;
      const DepthFindings findings = compareDepths(batch, footprint_, object.window, view);
      all.not_in_front |= findings.not_in_front;
      all.not_behind |= findings.not_behind;
    }
    if (!all.not_in_front || !all.not_behind) return false;
  }
  return true;
}

void CpuExecutor::run(const Batch& batch, std::vector<std::uint8_t>& may) {
  projector_.setGrowth(batch.growth.orOwn(kEta));
  drawSwept(batch);
  may.assign(batch.objects.size(), 1);
  std::size_t end = 0;
  for (std::size_t begin = 0; begin < batch.objects.size(); begin = end) {
    const Batch::Object& first = batch.objects[begin];
    for (end = begin; end < batch.objects.size() && batch.objects[end].group == first.group;) ++end;
    if (unusable_[static_cast<std::size_t>(first.window)]) continue;
    if (batch.rule == VisibilityRule::occlusion) {
      if (!groupMayOverlap(batch, begin, end))
        std::fill(may.begin() + static_cast<std::ptrdiff_t>(begin), may.begin() + static_cast<std::ptrdiff_t>(end), 0);
      continue;
    }
    for (std::size_t i = begin; i < end; ++i) {
      may[i] = mayOverlap(batch, batch.objects[i]);
      if (may[i] && batch.groups_only) break;  // the rest stays 1
    }
  }
}

}  // namespace visibility
}  // namespace fcl_artic
