// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "visibility/executor.h"

namespace fcl_artic {
namespace visibility {
namespace {

constexpr float kNothing = 3e38f;
/// A side flatter than this cuts no column off a row. It is ignored, unless the row as a whole is beyond it.
constexpr double kFlat = 1e-6;

/// Visits the rows of a footprint until one says true: visit(index in the tile of the row's first pixel, number of
/// pixels, their lower and upper depths). The rounding of a row's ends is some 1e-4 pixels, which kEta covers.
/// @return whether one said true.
template <class Visit>
bool anyRow(const Footprint& f, const Visit& visit) {
  float lower[kLargestResolution], upper[kLargestResolution];
  for (int row = f.y0; row <= f.y1; ++row) {
    const double y = row + 0.5;
    double x0 = f.x0, x1 = f.x1;
    for (int s = 0; s < f.num_sides; ++s) {
      const double a = f.sides[s].a, room = f.sides[s].c - f.sides[s].b * y;
      if (a > kFlat) {
        x1 = std::min(x1, room / a - 0.5);
      } else if (a < -kFlat) {
        x0 = std::max(x0, room / a - 0.5);
      } else if (room < -kFlat * kLargestResolution) {
        x1 = -1;
      }
    }
    const int begin = static_cast<int>(std::ceil(std::min(x0, f.x1 + 1.0))),
              n = static_cast<int>(std::floor(std::max(x1, -1.0))) - begin + 1;
    if (n <= 0) continue;
    std::fill_n(lower, n, f.bounds[0].lower);
    std::fill_n(upper, n, f.bounds[0].upper);
    const float x = static_cast<float>(begin) + 0.5f;
    for (int k = 1; k < f.num_bounds; ++k) {
      const DepthBounds& b = f.bounds[k];
      const float at_row = b.b * static_cast<float>(y);
      for (int i = 0; i < n; ++i) {
        const float t = b.a * (x + static_cast<float>(i)) + at_row;
        lower[i] = std::max(lower[i], t + b.lower);
        upper[i] = std::min(upper[i], t + b.upper);
      }
    }
    if (visit(row * f.resolution + begin, n, lower, upper)) return true;
  }
  return false;
}

class CpuExecutor : public Executor {
  void findThatMayOverlap(const Drawing& drawing, std::vector<std::uint8_t>& may) override {
    for (int view = 0; view < kViews; ++view) drawSwept(drawing, view);
    for (const Drawing::Piece& piece : drawing.pieces) {
      std::uint8_t& group = may[static_cast<std::size_t>(piece.group)];
      group = group ||
              (meets(drawing, piece.volume, 0) && meets(drawing, piece.volume, 1) && meets(drawing, piece.volume, 2));
    }
  }

  void drawSwept(const Drawing& drawing, int view) {
    const auto pixels = static_cast<std::size_t>(drawing.resolution * drawing.resolution);
    nearest_[view].assign(pixels, kNothing);
    farthest_[view].assign(pixels, -kNothing);
    for (const Volume& volume : drawing.swept) {
      if (!project(drawing, volume, view, footprint_)) continue;
      anyRow(footprint_, [&](int at, int n, const float* lower, const float* upper) {
        float *nearest = nearest_[view].data() + at, *farthest = farthest_[view].data() + at;
        for (int i = 0; i < n; ++i) {
          nearest[i] = std::min(nearest[i], lower[i]);
          farthest[i] = std::max(farthest[i], upper[i]);
        }
        return false;
      });
    }
  }
  /// Whether in some pixel of the piece's footprint its depths meet those of the swept volumes.
  bool meets(const Drawing& drawing, const Volume& piece, int view) {
    if (!project(drawing, piece, view, footprint_)) return false;
    return anyRow(footprint_, [&](int at, int n, const float* lower, const float* upper) {
      const float *nearest = nearest_[view].data() + at, *farthest = farthest_[view].data() + at;
      int found = 0;
      for (int i = 0; i < n; ++i) found |= upper[i] >= nearest[i] && lower[i] <= farthest[i];
      return found != 0;
    });
  }

  Footprint footprint_;
  std::vector<float> nearest_[kViews], farthest_[kViews];  ///< depths of the swept volumes, by pixel
};

}  // namespace

std::unique_ptr<Executor> makeCpuExecutor() {
  return std::make_unique<CpuExecutor>();
}

}  // namespace visibility
}  // namespace fcl_artic
