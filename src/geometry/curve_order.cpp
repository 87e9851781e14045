// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/curve_order.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include <Eigen/Core>

#include "numerics/assertion.h"
#include "numerics/constants.h"
#include "threads/parallel.h"

namespace fcl_artic {
namespace {

/// CurveCells along each axis, as a power of two.
constexpr int kBits = 10;
/// Up to this number of points of one cell are split at the middle of their longest axis. More get finer cells, this
/// many times: then no point that lies far from all others makes the cells too coarse for these. (Measured: to split
/// all small ranges so makes no query faster.)
constexpr std::size_t kFewInACell = 256;
constexpr int kMostCells = 3;
/// From this number of points on the work goes over threads, which wait for each other at each digit.
constexpr std::size_t kManyPoints = 1 << 16;

struct PlaceBox {
  Eigen::Array3d lo = Eigen::Array3d::Constant(std::numeric_limits<double>::infinity()), hi = -lo;
  bool is_good = true;  ///< no coordinate was infinite, NaN or too far away
  void add(const double* point) {
    const Eigen::Array3d x = Eigen::Array3d::Map(point);
    lo = lo.min(x);
    hi = hi.max(x);
    is_good &= (x.abs() <= kFarthest).all();
  }
  void add(const PlaceBox& other) {
    lo = lo.min(other.lo);
    hi = hi.max(other.hi);
    is_good &= other.is_good;
  }
  int longestAxis() const {
    const Eigen::Array3d size = hi - lo;
    return size[0] >= size[1] ? (size[0] >= size[2] ? 0 : 2) : (size[1] >= size[2] ? 1 : 2);
  }
  double longest() const { return (hi - lo).maxCoeff(); }
};

/// Ten bits with two zeros after each.
std::uint32_t spreadBits(std::uint32_t x) {
  x = (x | x << 16) & 0x030000ff;
  x = (x | x << 8) & 0x0300f00f;
  x = (x | x << 4) & 0x030c30c3;
  return (x | x << 2) & 0x09249249;
}

/// The cells of a cube that holds a box: equal along all axes, so that a cell is no longer in one than in another.
struct CurveCells {
  explicit CurveCells(const PlaceBox& box) : scale((1 << kBits) / box.longest()) {
    std::copy_n(box.lo.data(), 3, lo);
    // (Sizes whose quotient is no number are next to none: all points are in one cell, and are split at the middle.)
    if (!(scale <= std::numeric_limits<double>::max())) scale = 0;
  }
  std::uint32_t cell(double x, int axis) const {
    const auto cell = static_cast<std::int32_t>((x - lo[axis]) * scale);  // 0 to 2^kBits
    return static_cast<std::uint32_t>(std::min(cell, (1 << kBits) - 1));
  }
  std::uint32_t key(const double* x) const {
    return spreadBits(cell(x[0], 0)) << 2 | spreadBits(cell(x[1], 1)) << 1 | spreadBits(cell(x[2], 2));
  }
  double lo[3], scale;
};

/// Sorts by keys of 3 kBits bits, digit by digit; equal ones stay as they are.
void sortByKey(CurvePlace* places, std::size_t size, int threads) {
  constexpr std::size_t kDigits = std::size_t{1} << kBits;
  const std::size_t shares = std::min<std::size_t>(threadsFor(threads), 16);
  std::vector<std::array<std::uint32_t, kDigits>> next(shares);
  const LargeArray<CurvePlace> scratch(size);
  CurvePlace *from = places, *to = const_cast<CurvePlace*>(scratch.data());
  for (int shift = 0; shift < 3 * kBits; shift += kBits) {
    const auto digit = [&](const CurvePlace& place) { return place.key >> shift & (kDigits - 1); };
    parallelShares(size, shares, [&](std::size_t s, std::size_t begin, std::size_t end) {
      next[s].fill(0);
      for (std::size_t i = begin; i < end; ++i) ++next[s][digit(from[i])];
    });
    std::uint32_t sum = 0;
    bool one_digit = false;  // for all
    for (std::size_t d = 0; d < kDigits; ++d) {
      const std::uint32_t before = sum;
      for (auto& each : next) {
        const std::uint32_t count = each[d];
        each[d] = sum;
        sum += count;
      }
      one_digit = one_digit || sum - before == size;
    }
    if (one_digit) continue;
    parallelShares(size, shares, [&](std::size_t s, std::size_t begin, std::size_t end) {
      auto& at = next[s];
      for (std::size_t i = begin; i < end; ++i) to[at[digit(from[i])]++] = from[i];
    });
    std::swap(from, to);
  }
  if (from != places) std::copy_n(from, size, places);
}

}  // namespace

CurveOrder::CurveOrder(PointsAt points, std::size_t size, int threads) : points_(points), places_(size) {
  FCL_ARTIC_ASSERT(size > 0 && size <= static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()));
  if (size < kManyPoints) threads = 1;
  parallelShares(size, threadsFor(threads), [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) places_[i] = {0, static_cast<std::uint32_t>(i)};
  });
  layCells(all(), threads);
}

/// Gives each point of the range its cell's place on the curve, and sorts them. Points of one cell stay in the order in
/// which they are, so the order is that of (key, number).
void CurveOrder::layCells(Range range, int threads) {
  CurvePlace* const places = places_.data() + range.begin;
  const std::size_t size = range.size(), shares = threadsFor(threads);
  std::vector<PlaceBox> boxes(shares);
  const auto inShares = [&](const auto& act) {
    parallelShares(size, shares, [&](std::size_t s, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) act(s, places[i]);
    });
  };
  inShares([&](std::size_t s, const CurvePlace& place) { boxes[s].add(points_[place.number]); });
  for (std::size_t s = 1; s < shares; ++s) boxes[0].add(boxes[s]);
  if (!boxes[0].is_good) throw std::invalid_argument("a place is not finite or beyond 1e9 m");
  const CurveCells cells(boxes[0]);
  inShares([&](std::size_t, CurvePlace& place) { place.key = cells.key(points_[place.number]); });
  if (size > 1024) return sortByKey(places, size, threads);
  std::sort(places, places + size, [](const CurvePlace& a, const CurvePlace& b) {
    return a.key != b.key ? a.key < b.key : a.number < b.number;
  });
}

std::pair<CurveOrder::Range, CurveOrder::Range> CurveOrder::split(Range range) {
  const std::size_t middle = endOfFirstPart(range);
  return {{range.begin, middle, range.cells}, {middle, range.end, range.cells}};
}

/// Where the range is to be split; it may get finer cells.
std::size_t CurveOrder::endOfFirstPart(Range& range) {
  FCL_ARTIC_ASSERT(range.size() > 1);
  if (places_[range.begin].key == places_[range.end - 1].key) {
    if (range.size() <= kFewInACell || range.cells == kMostCells) return splitAtMiddle(range);
    ++range.cells;
    layCells(range, 1);
  }
  // The highest bit in which keys of the range differ: the first ones, in order, have not got it.
  const std::uint32_t differs = places_[range.begin].key ^ places_[range.end - 1].key;
  if (differs == 0) return splitAtMiddle(range);
  const std::uint32_t bit = std::uint32_t{1} << (31 - __builtin_clz(differs));
  std::size_t without = range.begin, with = range.end - 1;  // a place without the bit, and one with it
  while (with - without > 1) {
    const std::size_t middle = without + (with - without) / 2;
    (places_[middle].key & bit ? with : without) = middle;
  }
  return with;
}

void CurveOrder::finish(Range range) {
  if (range.size() <= 2 || places_[range.begin].key != places_[range.end - 1].key) return;
  const std::size_t half = splitAtMiddle(range);
  finish({range.begin, half, range.cells});
  finish({half, range.end, range.cells});
}

/// Puts half of the range's points, those that come first along its longest axis, before the others.
std::size_t CurveOrder::splitAtMiddle(Range range) {
  const std::size_t half = (range.begin + range.end) / 2;
  if (range.size() == 2) return half;
  CurvePlace* const places = places_.data();
  PlaceBox box;
  for (std::size_t i = range.begin; i < range.end; ++i) box.add(points_[places[i].number]);
  const int axis = box.longestAxis();
  // All keys get equal: the parts are split in this way too.
  for (std::size_t i = range.begin; i < range.end; ++i) places[i].key = 0;
  std::nth_element(places + range.begin, places + half, places + range.end,
                   [&](const CurvePlace& a, const CurvePlace& b) {
                     const double x = points_[a.number][axis], y = points_[b.number][axis];
                     return x != y ? x < y : a.number < b.number;
                   });
  return half;
}

}  // namespace fcl_artic
