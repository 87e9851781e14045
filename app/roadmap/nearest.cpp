// SPDX-License-Identifier: BSD-3-Clause
#include "roadmap/nearest.h"

#include <algorithm>
#include <numeric>

namespace fcl_artic::app {
namespace {
constexpr std::size_t kLeaf = 12;
}

NearestPoints::NearestPoints(const std::vector<double>& points, std::size_t dimensions)
    : points_(points), dimensions_(dimensions), order_(points.size() / dimensions) {
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  if (!order_.empty()) build(0, order_.size());
}

std::size_t NearestPoints::build(std::size_t begin, std::size_t end) {
  const std::size_t number = nodes_.size();
  nodes_.push_back({begin, end});
  if (end - begin <= kLeaf) return number;
  int axis = 0;
  double widest = -1;
  for (std::size_t d = 0; d < dimensions_; ++d) {
    double low = point(order_[begin])[d], high = low;
    for (std::size_t i = begin; i < end; ++i) {
      low = std::min(low, point(order_[i])[d]);
      high = std::max(high, point(order_[i])[d]);
    }
    if (high - low > widest) {
      widest = high - low;
      axis = static_cast<int>(d);
    }
  }
  const std::size_t middle = begin + (end - begin) / 2;
  const auto at = [&](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(begin), at(middle), at(end),
                   [&](std::size_t a, std::size_t b) { return point(a)[axis] < point(b)[axis]; });
  const double cut = point(order_[middle])[axis];
  const std::size_t below = build(begin, middle), above = build(middle, end);
  nodes_[number].axis = axis;
  nodes_[number].at = cut;
  nodes_[number].below = below;
  nodes_[number].above = above;
  return number;
}

void NearestPoints::search(std::size_t number, const double* from, std::size_t self, std::size_t k,
                           std::vector<Neighbour>& found) const {
  const Node& node = nodes_[number];
  if (node.axis < 0) {
    for (std::size_t i = node.begin; i < node.end; ++i) {
      if (order_[i] == self) continue;
      double squared = 0;
      for (std::size_t d = 0; d < dimensions_; ++d) {
        const double apart = point(order_[i])[d] - from[d];
        squared += apart * apart;
      }
      const Neighbour one{squared, static_cast<std::int64_t>(order_[i])};
      if (found.size() == k && !(one < found.front())) continue;
      if (found.size() == k) {
        std::pop_heap(found.begin(), found.end());
        found.pop_back();
      }
      found.push_back(one);
      std::push_heap(found.begin(), found.end());
    }
    return;
  }
  const double apart = from[node.axis] - node.at;
  search(apart < 0 ? node.below : node.above, from, self, k, found);
  // Points on the cut may lie on either side.
  if (found.size() < k || apart * apart <= found.front().squared) {
    search(apart < 0 ? node.above : node.below, from, self, k, found);
  }
}

std::vector<std::int64_t> NearestPoints::of(std::size_t i, std::size_t k) const {
  std::vector<Neighbour> found;
  if (k > 0 && !nodes_.empty()) search(0, point(i), i, k, found);
  std::sort(found.begin(), found.end());
  std::vector<std::int64_t> numbers;
  for (const Neighbour& one : found) numbers.push_back(one.number);
  return numbers;
}

}  // namespace fcl_artic::app
