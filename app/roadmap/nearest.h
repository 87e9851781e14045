// SPDX-License-Identifier: BSD-3-Clause
//
// The k nearest of many points in a few dimensions, by a k-d tree (Bentley 1975).
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace fcl_artic::app {

class NearestPoints {
 public:
  /// @param points  dimensions numbers each, one after the other; must outlive this object.
  NearestPoints(const std::vector<double>& points, std::size_t dimensions);

  /// Numbers of the k points nearest to point i by Euclidean distance, itself left out, nearest first, of equally near
  /// ones the lower number. Fewer where there are fewer points.
  std::vector<std::int64_t> of(std::size_t i, std::size_t k) const;

 private:
  struct Node {
    std::size_t begin, end;            ///< of order_
    int axis = -1;                     ///< -1: a leaf
    double at = 0;                     ///< where it is cut
    std::size_t below = 0, above = 0;  ///< nodes
  };
  struct Neighbour {
    double squared;
    std::int64_t number;
    bool operator<(const Neighbour& other) const {
      return squared != other.squared ? squared < other.squared : number < other.number;
    }
  };
  std::size_t build(std::size_t begin, std::size_t end);
  void search(std::size_t node, const double* point, std::size_t self, std::size_t k,
              std::vector<Neighbour>& found) const;
  const double* point(std::size_t i) const { return points_.data() + i * dimensions_; }

  const std::vector<double>& points_;
  std::size_t dimensions_;
  std::vector<std::size_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace fcl_artic::app
