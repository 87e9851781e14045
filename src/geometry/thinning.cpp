// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/thinning.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "threads/parallel.h"

namespace fcl_artic {
namespace {

using Eigen::Vector3d;
using VoxelCell = Eigen::Array<std::int64_t, 3, 1>;

/// From this number of points on the work goes over threads.
constexpr std::size_t kManyToThin = 1 << 14;

/// A cube of the grid, and what lies in it.
struct Voxel {
  explicit Voxel(const VoxelCell& at) : cell(at) {}
  VoxelCell cell;
  Eigen::Array3d lo = Eigen::Array3d::Constant(std::numeric_limits<double>::infinity()), hi = -lo;  ///< of the points
  double reach = 0;  ///< how far their balls reach from the middle of these
  void add(const Eigen::Array3d& lower, const Eigen::Array3d& upper) {
    lo = lo.min(lower);
    hi = hi.max(upper);
  }
};

/// The voxels that points were put into, in the order of their first points.
class VoxelTable {
 public:
  VoxelTable() : slots_(1024, kNone) {}
  /// The number of a cell's voxel, which is made where there is none.
  std::uint32_t find(const VoxelCell& cell) {
    if (last_ < voxels.size() && isIn(voxels[last_], cell)) return last_;  // points mostly come side by side
    std::size_t slot = hash(cell) & (slots_.size() - 1);
    for (; slots_[slot] != kNone; slot = (slot + 1) & (slots_.size() - 1)) {
      if (isIn(voxels[slots_[slot]], cell)) return last_ = slots_[slot];
    }
    last_ = slots_[slot] = static_cast<std::uint32_t>(voxels.size());
    voxels.emplace_back(cell);
    if (2 * voxels.size() > slots_.size()) grow();
    return last_;
  }
  std::vector<Voxel> voxels;

 private:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  static bool isIn(const Voxel& voxel, const VoxelCell& cell) {
    return (voxel.cell[0] == cell[0]) & (voxel.cell[1] == cell[1]) & (voxel.cell[2] == cell[2]);
  }
  static std::size_t hash(const VoxelCell& cell) {
    std::uint64_t h = 0;
    for (const std::int64_t place : cell) h = (h ^ static_cast<std::uint64_t>(place)) * 0x9e3779b97f4a7c15u;
    return h ^ h >> 32;
  }
  void grow() {
    slots_.assign(2 * slots_.size(), kNone);
    for (std::size_t i = 0; i < voxels.size(); ++i) {
      std::size_t slot = hash(voxels[i].cell) & (slots_.size() - 1);
      while (slots_[slot] != kNone) slot = (slot + 1) & (slots_.size() - 1);
      slots_[slot] = static_cast<std::uint32_t>(i);
    }
  }
  std::vector<std::uint32_t> slots_;  ///< twice as many as voxels, at least; a power of two
  std::uint32_t last_ = 0;
};

/// The middle of a voxel's points. (A sum of two is far from overflow.)
Vector3d middleOfPoints(const Voxel& voxel) {
  return 0.5 * (voxel.lo + voxel.hi);
}

/// One thread's share of the points.
struct Share {
  std::size_t begin, end;
  VoxelTable table;
  std::vector<std::uint32_t> voxel_of;  ///< of each point, in `table`
  std::vector<std::uint32_t> number;    ///< of each voxel, among those of all shares
};

}  // namespace

ThinnedBalls thin(const std::vector<Vector3d>& points, const std::vector<double>& radii, double voxel) {
  const int threads = points.size() < kManyToThin ? 1 : 0;
  std::vector<Share> shares(threadsFor(threads));
  for (std::size_t s = 0; s < shares.size(); ++s) {
    shares[s].begin = points.size() / shares.size() * s;
    shares[s].end = s + 1 == shares.size() ? points.size() : points.size() / shares.size() * (s + 1);
  }
  const double per_voxel = 1 / voxel;
  parallelFor(shares.size(), threads, [&](std::size_t s) {
    Share& share = shares[s];
    share.voxel_of.resize(share.end - share.begin);
    for (std::size_t i = share.begin; i < share.end; ++i) {
      const Eigen::Array3d x = points[i].array() * per_voxel;
      const VoxelCell towards_zero = x.cast<std::int64_t>();
      const VoxelCell cell = towards_zero - (x < towards_zero.cast<double>()).cast<std::int64_t>();
      const std::uint32_t found = share.voxel_of[i - share.begin] = share.table.find(cell);
      share.table.voxels[found].add(points[i].array(), points[i].array());
    }
  });
  // Share after share: so voxels follow each other by their first points, whatever the shares. (Boxes of boxes and
  // greatest reaches do not depend on the order.)
  VoxelTable all;
  for (Share& share : shares) {
    share.number.resize(share.table.voxels.size());
    for (std::size_t v = 0; v < share.number.size(); ++v) {
      const Voxel& part = share.table.voxels[v];
      share.number[v] = all.find(part.cell);
      all.voxels[share.number[v]].add(part.lo, part.hi);
    }
  }
  ThinnedBalls balls;
  balls.centers.resize(all.voxels.size());
  for (std::size_t v = 0; v < all.voxels.size(); ++v) balls.centers[v] = middleOfPoints(all.voxels[v]);
  const bool one_radius = radii.size() == 1;
  parallelFor(shares.size(), threads, [&](std::size_t s) {
    Share& share = shares[s];
    for (std::size_t i = share.begin; i < share.end; ++i) {
      Voxel& into = share.table.voxels[share.voxel_of[i - share.begin]];
      const Vector3d& center = balls.centers[share.number[share.voxel_of[i - share.begin]]];
      const double away = std::sqrt((points[i] - center).squaredNorm());
      into.reach = std::max(into.reach, away + radii[one_radius ? 0 : i]);
    }
  });
  for (Share& share : shares) {
    for (std::size_t v = 0; v < share.number.size(); ++v) {
      double& reach = all.voxels[share.number[v]].reach;
      reach = std::max(reach, share.table.voxels[v].reach);
    }
  }
  // Up: for the roundings of differences, squares, sums, root and sum, and for squares too small for a double.
  constexpr double kUp = 1 + 0x1p-48, kTiny = 0x1p-500;
  balls.radii.resize(all.voxels.size());
  for (std::size_t v = 0; v < all.voxels.size(); ++v) {
    const Voxel& of = all.voxels[v];
    const bool one_point = (of.lo == of.hi).all();  // and so its middle, exactly
    balls.radii[v] = one_point ? of.reach : of.reach * kUp + kTiny;
  }
  return balls;
}

}  // namespace fcl_artic
