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
  Voxel(const VoxelCell& at, std::uint32_t point) : cell(at), first(point) {}
  VoxelCell cell;
  Eigen::Array3d lo = Eigen::Array3d::Constant(std::numeric_limits<double>::infinity()), hi = -lo;  ///< of the points
  double reach = 0;     ///< how far their balls reach from the middle of these
  std::uint32_t first;  ///< point
  /// (A sum of two is far from overflow.)
  Vector3d middle() const { return 0.5 * (lo + hi); }
  /// The radius of the ball around the middle that holds all of their balls. Up: for the roundings of differences,
  /// squares, sums, root and sum, and for squares too small for a double.
  double radius() const {
    constexpr double kUp = 1 + 0x1p-48, kTiny = 0x1p-500;
    const bool one_point = (lo == hi).all();  // and so its middle, exactly
    return one_point ? reach : reach * kUp + kTiny;
  }
};

/// The voxels that points were put into, in the order of their first points.
class VoxelTable {
 public:
  explicit VoxelTable(std::size_t points) {
    std::size_t slots = 1024;
    while (slots < points) slots *= 2;
    slots_.assign(slots, kNone);
    voxels.reserve(points / 2);
  }
  /// The number of a cell's voxel, which is made where there is none.
  std::uint32_t find(const VoxelCell& cell, std::uint64_t hash, std::uint32_t point) {
    if (last_ < voxels.size() && isIn(voxels[last_], cell)) return last_;  // points mostly come side by side
    std::size_t slot = hash & (slots_.size() - 1);
    for (; slots_[slot] != kNone; slot = (slot + 1) & (slots_.size() - 1)) {
      if (isIn(voxels[slots_[slot]], cell)) return last_ = slots_[slot];
    }
    last_ = slots_[slot] = static_cast<std::uint32_t>(voxels.size());
    voxels.emplace_back(cell, point);
    if (2 * voxels.size() > slots_.size()) grow();
    return last_;
  }
  static std::uint64_t hash(const VoxelCell& cell) {
    std::uint64_t h = 0;
    for (const std::int64_t place : cell) h = (h ^ static_cast<std::uint64_t>(place)) * 0x9e3779b97f4a7c15u;
    return h ^ h >> 32;
  }
  std::vector<Voxel> voxels;

 private:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  static bool isIn(const Voxel& voxel, const VoxelCell& cell) { return (voxel.cell == cell).all(); }
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

}  // namespace

ThinnedBalls thin(const std::vector<Vector3d>& points, const std::vector<double>& radii, double voxel) {
  const int threads = points.size() < kManyToThin ? 1 : 0;
  const std::size_t shares = threadsFor(threads);
  const auto cellOf = [per_voxel = 1 / voxel](const Vector3d& point) -> VoxelCell {
    const Eigen::Array3d x = point.array() * per_voxel;
    const VoxelCell towards_zero = x.cast<std::int64_t>();
    return towards_zero - (x < towards_zero.cast<double>()).cast<std::int64_t>();
  };
  std::vector<std::uint64_t> hashes(points.size());
  parallelShares(points.size(), shares, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) hashes[i] = VoxelTable::hash(cellOf(points[i]));
  });
  // Each thread has the voxels of some hashes, with all of their points: nothing is merged, and no voxel depends on the
  // number of threads.
  std::vector<std::vector<Voxel>> parts(shares);
  std::vector<std::uint32_t> voxel_of(points.size());  // in its part
  const bool one_radius = radii.size() == 1;
  parallelFor(shares, threads, [&](std::size_t s) {
    VoxelTable table(points.size() / shares);
    const auto forEachOwn = [&](const auto& act) {
      for (std::size_t i = 0; i < points.size(); ++i) {
        if ((hashes[i] >> 40) * shares >> 24 == s) act(i);  // of 24 bits
      }
    };
    forEachOwn([&](std::size_t i) {
      Voxel& into = table.voxels[voxel_of[i] = table.find(cellOf(points[i]), hashes[i], static_cast<std::uint32_t>(i))];
      into.lo = into.lo.min(points[i].array());
      into.hi = into.hi.max(points[i].array());
    });
    forEachOwn([&](std::size_t i) {
      Voxel& into = table.voxels[voxel_of[i]];
      const double away = std::sqrt((points[i] - into.middle()).squaredNorm());
      into.reach = std::max(into.reach, away + radii[one_radius ? 0 : i]);
    });
    parts[s] = std::move(table.voxels);
  });
  ThinnedBalls balls;
  std::size_t all = 0;
  for (const std::vector<Voxel>& part : parts) all += part.size();
  balls.centers.reserve(all);
  balls.radii.reserve(all);
  for (std::vector<std::size_t> next(shares, 0); balls.radii.size() < all;) {
    std::size_t first = shares;  // the part whose next voxel comes first
    for (std::size_t s = 0; s < shares; ++s) {
      if (next[s] == parts[s].size()) continue;
      if (first == shares || parts[s][next[s]].first < parts[first][next[first]].first) first = s;
    }
    const Voxel& of = parts[first][next[first]++];
    balls.centers.push_back(of.middle());
    balls.radii.push_back(of.radius());
  }
  return balls;
}

}  // namespace fcl_artic
