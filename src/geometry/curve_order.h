// SPDX-License-Identifier: BSD-3-Clause
//
// The order of many points along Morton's curve, and the tree that it makes. Each node is a range of the order, and its
// children are the two parts of that range: a tree needs one sort, not one for each level.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>

#include "geometry/large_array.h"

namespace fcl_artic {

/// Where points lie in memory: x, y and z of each side by side, `stride` numbers from one point to the next.
struct PointsAt {
  const double* first;
  std::size_t stride;
  const double* operator[](std::size_t i) const { return first + i * stride; }
};

/// The number of a point, and its cell's place on the curve.
struct CurvePlace {
  std::uint32_t key, number;
};

/// Points in the order of a tree over them. The order depends on the points alone: not on the number of threads, nor on
/// the machine.
class CurveOrder {
 public:
  /// Ranges that split() hands out have one point at least.
  struct Range {
    std::size_t begin, end;
    int cells;  ///< times that the grid of cells was laid anew, finer, for points of one cell
    std::size_t size() const { return end - begin; }
  };

  /// @param points  at least one and at most 2^31 - 1; they must stay where they are.
  /// @param threads  at most; 0: as many as the machine runs at once.
  /// @throws std::invalid_argument for a coordinate that is not finite or beyond 1e9 m.
  CurveOrder(PointsAt points, std::size_t size, int threads);

  /// All points.
  Range all() const { return {0, places_.size(), 0}; }
  /// The two parts of a range, which has two points at least. A range must be split before its parts
  /// are, and once only, as this may put its points into another order. Two threads may split ranges that have no point
  /// in common.
  std::pair<Range, Range> split(Range range);
  /// Orders the points of a range that is split no further: so that its halves, theirs, and so on, are near each other
  /// where split() would not tell them apart.
  void finish(Range range);
  /// The number of the point in this place, which changes while a range that holds it is split.
  std::uint32_t number(std::size_t place) const { return places_[place].number; }

 private:
  void layCells(Range range, int threads);
  std::size_t endOfFirstPart(Range& range);
  std::size_t splitAtMiddle(Range range);

  const PointsAt points_;
  LargeArray<CurvePlace> places_;
};

}  // namespace fcl_artic
