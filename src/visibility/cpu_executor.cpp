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
/// pixels). The rounding of a row's ends is some 1e-4 pixels, which kEta covers.
/// @return whether one said true.
template <class Visit>
bool anyRow(const Footprint& f, const Visit& visit) {
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
    if (n > 0 && visit(row * f.resolution + begin, n)) return true;
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
    float *nearest = nearest_[view].data(), *farthest = farthest_[view].data();
    for (const Volume& volume : drawing.swept) {
      if (!project(drawing, volume, view, footprint_)) continue;
      anyRow(footprint_, [&](int at, int n) {
        for (int i = at; i < at + n; ++i) {
          nearest[i] = std::min(nearest[i], footprint_.nearest);
          farthest[i] = std::max(farthest[i], footprint_.farthest);
        }
        return false;
      });
    }
  }
  /// Whether in some pixel of the piece's footprint its depths meet those of the swept volumes.
  bool meets(const Drawing& drawing, const Volume& piece, int view) {
    if (!project(drawing, piece, view, footprint_)) return false;
    return anyRow(footprint_, [&](int at, int n) {
      const float *nearest = nearest_[view].data() + at, *farthest = farthest_[view].data() + at;
      int found = 0;
      for (int i = 0; i < n; ++i) found |= footprint_.farthest >= nearest[i] && footprint_.nearest <= farthest[i];
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
