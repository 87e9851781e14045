// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/closed_parts.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <numeric>
#include <sstream>
#include <utility>

#include <Eigen/Core>

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
  Eigen::Vector3d place(Index corner) const {
    Eigen::Vector3d x;
    std::memcpy(x.data(), places_[corner].data(), sizeof x);
    return x;
  }

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

/// Corners of a mesh's triangles, numbered.
std::vector<Corners> weld(const engine::TreeView& mesh, Welder& welder) {
  std::vector<Corners> triangles(static_cast<std::size_t>(mesh.num_pieces));
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const double* v = mesh.vertices + 3 * static_cast<std::ptrdiff_t>(mesh.pieces[i].first_vertex);
    for (std::size_t k = 0; k < 3; ++k) triangles[i][k] = welder.number(v + 3 * k);
  }
  return triangles;
}

Groups join(const std::vector<Corners>& triangles, std::size_t corners) {
  Groups groups(corners);
  for (const Corners& t : triangles) {
    groups.join(t[0], t[1]);
    groups.join(t[0], t[2]);
  }
  return groups;
}

/// Calls visit(low, high, upward, downward) for each edge. `low` and `high` are its corners, `upward` counts the
/// triangles that pass it from `low` to `high`, `downward` the others. A triangle with two corners in one place has no
/// area and, as a sum of edges, no border.
template <class F>
void forEdges(const std::vector<Corners>& triangles, std::size_t corners, const F& visit) {
  std::vector<Index> first(corners + 1, 0);
  struct Edge {
    Index low, high;
    bool upward;
  };
  std::vector<Edge> edges;
  edges.reserve(3 * triangles.size());
  for (const Corners& t : triangles) {
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const Index from = t[k], to = t[(k + 1) % 3];
      edges.push_back({std::min(from, to), std::max(from, to), from < to});
      ++first[edges.back().low + 1];
    }
  }
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<std::pair<Index, bool>> ends(edges.size());
  std::vector<Index> next(first.begin(), first.end() - 1);
  for (const Edge& e : edges) ends[next[e.low]++] = {e.high, e.upward};
  for (std::size_t corner = 0; corner < corners; ++corner) {
    const auto begin = ends.begin() + first[corner], end = ends.begin() + first[corner + 1];
    std::sort(begin, end);
    for (auto run = begin; run != end;) {
      const auto stop = std::find_if(run, end, [&](const auto& other) { return other.first != run->first; });
      const auto upward = std::count_if(run, stop, [](const auto& e) { return e.second; });
      visit(static_cast<Index>(corner), run->first, upward, stop - run - upward);
      run = stop;
    }
  }
}

}  // namespace

ClosedParts findClosedParts(const engine::TreeView& mesh) {
  Welder welder(3 * static_cast<std::size_t>(mesh.num_pieces));
  const std::vector<Corners> triangles = weld(mesh, welder);
  Groups groups = join(triangles, welder.count());
  constexpr std::int32_t kUnnumbered = -1, kOpen = -2;
  std::vector<std::int32_t> part(welder.count(), kUnnumbered);  // of a group
  forEdges(triangles, welder.count(), [&](Index corner, Index, std::ptrdiff_t upward, std::ptrdiff_t downward) {
    if ((upward + downward) % 2) part[groups.of(corner)] = kOpen;
  });
  ClosedParts parts;
  parts.part_of_piece.resize(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    std::int32_t& mine = part[groups.of(triangles[i][0])];
    if (mine == kUnnumbered) mine = parts.count++;
    parts.part_of_piece[i] = std::max(mine, -1);
  }
  return parts;
}

ConnectedParts findConnectedParts(const engine::TreeView& mesh) {
  Welder welder(3 * static_cast<std::size_t>(mesh.num_pieces));
  const std::vector<Corners> triangles = weld(mesh, welder);
  Groups groups = join(triangles, welder.count());
  std::vector<std::int32_t> part(welder.count(), -1);  // of a group
  ConnectedParts parts;
  for (const Corners& t : triangles) {
    std::int32_t& mine = part[groups.of(t[0])];
    if (mine < 0) mine = parts.count++;
    parts.part_of_piece.push_back(mine);
  }
  return parts;
}

std::string whyNoSolid(const engine::TreeView& mesh) {
  Welder welder(3 * static_cast<std::size_t>(mesh.num_pieces));
  const std::vector<Corners> triangles = weld(mesh, welder);
  std::size_t open = 0, unlike = 0;
  std::pair<Index, Index> first_open, first_unlike;
  forEdges(triangles, welder.count(), [&](Index low, Index high, std::ptrdiff_t upward, std::ptrdiff_t downward) {
    if ((upward + downward) % 2) {
      if (open++ == 0) first_open = {low, high};
    } else if (upward != downward) {
      if (unlike++ == 0) first_unlike = {low, high};
    }
  });
  if (!open && !unlike) return {};
  const auto place = [&](std::ostringstream& out, Index corner) {
    const Eigen::Vector3d x = welder.place(corner);
    out << "(" << x[0] << ", " << x[1] << ", " << x[2] << ")";
  };
  const auto& [low, high] = open ? first_open : first_unlike;
  std::ostringstream out;
  if (open) {
    out << "it is not closed: " << open << (open == 1 ? " edge belongs" : " edges belong")
        << " to an odd number of triangles, the first one from ";
  } else {
    out << "it is not consistently oriented: " << unlike << (unlike == 1 ? " edge is" : " edges are")
        << " passed more often in one direction than in the other, the first one from ";
  }
  place(out, low);
  out << " to ";
  place(out, high);
  return out.str();
}

}  // namespace fcl_artic
