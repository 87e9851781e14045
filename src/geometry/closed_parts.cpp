// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/closed_parts.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <numeric>
#include <utility>

namespace fcl_artic {
namespace {

using Index = std::uint32_t;
using Corners = std::array<Index, 3>;

/// Numbers corners so that those at the very same place share one.
class Welder {
 public:
  explicit Welder(std::size_t corners) {
    std::size_t size = 64;
    while (size < 2 * corners) size *= 2;
    slots_.assign(size, kEmpty);
  }
  Index number(const double* x) {
    std::array<std::uint64_t, 3> bits;
    std::uint64_t hash = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double value = x[k] + 0.0;  // one zero
      std::memcpy(&bits[k], &value, sizeof value);
      hash = (hash ^ bits[k]) * 0x9e3779b97f4a7c15u;
      hash ^= hash >> 32;
    }
    for (std::size_t slot = hash & (slots_.size() - 1);; slot = (slot + 1) & (slots_.size() - 1)) {
      if (slots_[slot] == kEmpty) {
        places_.push_back(bits);
        return slots_[slot] = static_cast<Index>(places_.size() - 1);
      }
      if (places_[slots_[slot]] == bits) return slots_[slot];
    }
  }
  std::size_t count() const { return places_.size(); }

 private:
  static constexpr Index kEmpty = 0xffffffffu;
  std::vector<Index> slots_;
  std::vector<std::array<std::uint64_t, 3>> places_;
};

/// Sets that grow together: union and find.
class Groups {
 public:
  explicit Groups(std::size_t n) : above_(n) { std::iota(above_.begin(), above_.end(), 0u); }
  Index of(Index i) {
    while (above_[i] != i) i = above_[i] = above_[above_[i]];
    return i;
  }
  void join(Index i, Index j) { above_[of(i)] = of(j); }

 private:
  std::vector<Index> above_;
};

/// Calls visit(i) with a corner of each edge that belongs to an odd number of triangles. A triangle with two corners in
/// one place has no area and, as a sum of edges modulo 2, no border.
template <class F>
void forOddEdges(const std::vector<Corners>& triangles, std::size_t corners, const F& visit) {
  std::vector<Index> first(corners + 1, 0);
  std::vector<std::pair<Index, Index>> edges;
  edges.reserve(3 * triangles.size());
  for (const Corners& t : triangles) {
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      edges.push_back(std::minmax(t[k], t[(k + 1) % 3]));
      ++first[edges.back().first + 1];
    }
  }
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<Index> ends(edges.size()), next(first.begin(), first.end() - 1);
  for (const auto& [low, high] : edges) ends[next[low]++] = high;
  for (std::size_t corner = 0; corner < corners; ++corner) {
    const auto begin = ends.begin() + first[corner], end = ends.begin() + first[corner + 1];
    std::sort(begin, end);
    for (auto run = begin; run != end;) {
      const auto stop = std::find_if(run, end, [&](Index other) { return other != *run; });
      if ((stop - run) % 2) visit(static_cast<Index>(corner));
      run = stop;
    }
  }
}

}  // namespace

ClosedParts findClosedParts(const engine::TreeView& mesh) {
  const std::size_t n = static_cast<std::size_t>(mesh.num_pieces);
  Welder welder(3 * n);
  std::vector<Corners> triangles(n);
  for (std::size_t i = 0; i < n; ++i) {
    const double* v = mesh.vertices + 3 * static_cast<std::ptrdiff_t>(mesh.pieces[i].first_vertex);
    for (std::size_t k = 0; k < 3; ++k) triangles[i][k] = welder.number(v + 3 * k);
  }
  Groups groups(welder.count());
  for (const Corners& t : triangles) {
    groups.join(t[0], t[1]);
    groups.join(t[0], t[2]);
  }
  constexpr std::int32_t kUnnumbered = -1, kOpen = -2;
  std::vector<std::int32_t> part(welder.count(), kUnnumbered);  // of a group
  forOddEdges(triangles, welder.count(), [&](Index corner) { part[groups.of(corner)] = kOpen; });
  ClosedParts parts;
  parts.part_of_piece.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    std::int32_t& mine = part[groups.of(triangles[i][0])];
    if (mine == kUnnumbered) mine = parts.count++;
    parts.part_of_piece[i] = std::max(mine, -1);
  }
  return parts;
}

}  // namespace fcl_artic
