// SPDX-License-Identifier: BSD-3-Clause
#include "support.h"

#include <algorithm>
#include <array>

namespace verify {

void Box::add(const Fix x[3]) {
  for (int k = 0; k < 3; ++k) {
    low[k] = least(low[k], x[k]);
    high[k] = most(high[k], x[k]);
  }
}
void Box::add(const Box& other) {
  add(other.low);
  add(other.high);
}

namespace {

constexpr std::uint32_t kLeaf = 8;

/// w.p with three products, each less than one ulp too small.
Fix along(const Fix w[3], const Fix p[3]) {
  return w[0] * p[0] + w[1] * p[1] + w[2] * p[2];
}
/// The most of w.p in a box: its farthest corner.
Fix along(const Fix w[3], const Box& box) {
  Fix sum;
  for (int k = 0; k < 3; ++k) sum += w[k] * (w[k].v < 0 ? box.low[k] : box.high[k]);
  return sum;
}
/// Above the length of the vector a(s). With l the linear part of a, |a| <= |l| + sum (|c2| + r), and |l(s)|, a length
/// of what is linear, is convex: not above the line between |l(-1)| and |l(1)|. Exact at both ends but for these and
/// the rounding: where a passes through 0 at an end, as a disc's direction that comes to be its axis, no mean of
/// squares is.
Tm chordOfLength(const std::array<Tm, 3>& a) {
  Fix end[2], rest;
  for (int i = 0; i < 2; ++i) {
    Fix squares, sum;
    for (const Tm& x : a) {
      const Fix l = abs(i == 0 ? x.c0 - x.c1 : x.c0 + x.c1);
      squares += mulUp(l, l);
      sum += l;
    }
    end[i] = least(sqrtUp(squares), sum);
  }
  for (const Tm& x : a) rest += abs(x.c2) + x.r;
  // Both halves are rounded down by half an ulp at most.
  return {shifted(end[0] + end[1], 1) + ulps(1) + rest, shifted(end[1] - end[0], 1), {}, {}};
}
/// Of a model's Bernstein points, remainder included.
Fix sumOfCoefficients(const Tm& a) {
  return a.c0 + a.c0 + a.c0 + a.c2 + a.r + a.r + a.r;
}
Box boxAt(const Fix x[3]) {
  Box box;
  for (int k = 0; k < 3; ++k) box.low[k] = box.high[k] = x[k];
  return box;
}

}  // namespace

void Geometry::prepare() {
  for (std::size_t k = 0; k + 2 < vertices.size(); k += 3)
    points.push_back({{enclose(vertices[k]).x, enclose(vertices[k + 1]).x, enclose(vertices[k + 2]).x}});
  const auto addBox = [&](const double centre[3], const double half[3]) {
    Box box;
    for (int k = 0; k < 3; ++k) {  // each sum within 2 ulp of the cell's end
      box.low[k] = enclose(centre[k]).x - enclose(half[k]).x;
      box.high[k] = enclose(centre[k]).x + enclose(half[k]).x;
    }
    cell_boxes.push_back(box);
  };
  const std::vector<double>& n = numbers;
  const auto addRound = [&](double z, double a, double b, double c) {
    rounds.push_back({{0, 0, z}, {a, b, c}, a == b && b == c});
  };
  pieces_ = 1;
  switch (kind) {
    case mesh:
      pieces_ = items_ = static_cast<std::uint32_t>(triangles.size() / 3);
      break;
    case boxes:
      for (std::size_t k = 0; k + 5 < cells.size(); k += 6) addBox(&cells[k], &cells[k + 3]);
      pieces_ = items_ = static_cast<std::uint32_t>(cell_boxes.size());
      break;
    case box: {
      const double centre[3] = {0, 0, 0}, half[3] = {n[0] / 2, n[1] / 2, n[2] / 2};  // below 2^-1022 an ulp covers it
      addBox(centre, half);
      items_ = 1;
      break;
    }
    case hull:
      items_ = static_cast<std::uint32_t>(points.size());
      break;
    case sphere:
      addRound(0, n[0], n[0], n[0]);
      break;
    case ellipsoid:
      addRound(0, n[0], n[1], n[2]);
      break;
    case capsule:
      addRound(-n[1] / 2, n[0], n[0], n[0]);
      addRound(n[1] / 2, n[0], n[0], n[0]);
      break;
    case cylinder:
      addRound(-n[1] / 2, n[0], n[0], 0);
      addRound(n[1] / 2, n[0], n[0], 0);
      break;
    case cone:
      addRound(-n[1] / 2, n[0], n[0], 0);
      addRound(n[1] / 2, 0, 0, 0);
      break;
    case halfspace:
    case plane:
      break;
  }
  if (items_ > 0) build(0, items_);
}

Box Geometry::boxOf(std::uint32_t item) const {
  if (!cell_boxes.empty()) return cell_boxes[item];
  if (kind == hull) return boxAt(points[item].x);
  Box box = boxAt(points[triangles[3 * item]].x);
  for (int k = 1; k < 3; ++k) box.add(points[triangles[3 * item + k]].x);
  return box;
}

// Corners at one place are one: so what is joined does hang together, and edges that meet cancel.
bool Geometry::joinSurfaces() {
  const auto n = static_cast<std::uint32_t>(vertices.size() / 3);
  std::vector<std::uint32_t> order(n), same(n), root(n);
  for (std::uint32_t k = 0; k < n; ++k) order[k] = root[k] = k;
  const auto before = [&](std::uint32_t a, std::uint32_t b) {
    return std::lexicographical_compare(&vertices[3 * a], &vertices[3 * a] + 3, &vertices[3 * b], &vertices[3 * b] + 3);
  };
  std::sort(order.begin(), order.end(), before);
  for (std::uint32_t k = 0; k < n; ++k)
    same[order[k]] = k > 0 && !before(order[k - 1], order[k]) ? same[order[k - 1]] : order[k];
  const auto find = [&](std::uint32_t k) {
    while (root[k] != k) k = root[k] = root[root[k]];
    return k;
  };
  std::vector<std::pair<std::uint64_t, int>> edges;
  for (std::size_t t = 0; t + 2 < triangles.size(); t += 3) {
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t a = same[triangles[t + c]], b = same[triangles[t + (c + 1) % 3]];
      if (a == b) continue;
      root[std::max(find(a), find(b))] = std::min(find(a), find(b));
      edges.push_back({static_cast<std::uint64_t>(std::min(a, b)) << 32 | std::max(a, b), a < b ? 1 : -1});
    }
  }
  std::sort(edges.begin(), edges.end());
  bool closed = true;
  for (std::size_t i = 0, j; i < edges.size(); i = j) {
    std::int64_t sum = 0;
    for (j = i; j < edges.size() && edges[j].first == edges[i].first; ++j) sum += edges[j].second;
    closed = closed && sum == 0;
  }
  for (std::size_t t = 0; t + 2 < triangles.size(); t += 3) part.push_back(find(same[triangles[t]]));
  return closed;
}

// Halves of the list: neighbours in the list are near each other where the writer ordered it well.
std::uint32_t Geometry::build(std::uint32_t i, std::uint32_t j) {
  const auto index = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back({i, j, 0, 0, 0, boxOf(i)});
  for (std::uint32_t k = i + 1; j - i <= kLeaf && k < j; ++k) nodes_[index].box.add(boxOf(k));
  if (j - i > kLeaf) {
    const std::uint32_t m = i + (j - i) / 2;
    build(i, m);
    const std::uint32_t right = build(m, j);
    nodes_[index].right = right;
    nodes_[index].box = nodes_[index + 1].box;
    nodes_[index].box.add(nodes_[right].box);
  } else if (kind == mesh) {
    std::vector<std::uint32_t> corners(triangles.begin() + 3 * i, triangles.begin() + 3 * j);
    std::sort(corners.begin(), corners.end());
    corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
    nodes_[index].first = static_cast<std::uint32_t>(leaf_points_.size());
    leaf_points_.insert(leaf_points_.end(), corners.begin(), corners.end());
    nodes_[index].last = static_cast<std::uint32_t>(leaf_points_.size());
  }
  return index;
}

// A box around the items [i, j), from the boxes of nodes that lie in the range and of single items.
void Geometry::rangeBox(std::uint32_t i, std::uint32_t j, Box& box) const {
  box = boxOf(i);
  std::uint32_t stack[64], top = 0;
  stack[top++] = 0;
  while (top > 0) {
    const std::uint32_t at = stack[--top];
    const Node& node = nodes_[at];
    if (node.to <= i || node.from >= j) continue;
    if (node.from >= i && node.to <= j) {
      box.add(node.box);
    } else if (node.right != 0) {
      stack[top++] = at + 1;
      stack[top++] = node.right;
    } else {
      for (std::uint32_t k = std::max(i, node.from); k < std::min(j, node.to); ++k) box.add(boxOf(k));
    }
  }
}

// Branch and bound for the most of w.p. Every value and every bound is less than 3 ulp too small (along()), so what is
// left out is at most 3 ulp above what is returned, which is at most 3 ulp below its own exact value: together 6 ulp.
Fix Geometry::farthest(std::uint32_t i, std::uint32_t j, const Fix w[3], Budget& budget) const {
  Fix best{-kMost};
  struct Open {
    std::uint32_t node;
    Fix bound;
  } stack[64];
  int top = 0;
  stack[top++] = {0, Fix{kMost}};
  std::uint64_t steps = 0;
  while (top > 0) {
    const Open open = stack[--top];
    if (open.bound <= best) continue;
    const Node& node = nodes_[open.node];
    if (node.to <= i || node.from >= j) continue;
    ++steps;
    if (node.right != 0) {
      const Open a{open.node + 1, along(w, nodes_[open.node + 1].box)}, b{node.right, along(w, nodes_[node.right].box)};
      const bool a_first = a.bound > b.bound;  // the farther one is opened first
      stack[top++] = a_first ? b : a;
      stack[top++] = a_first ? a : b;
    } else if (kind == mesh && node.from >= i && node.to <= j) {
      for (std::uint32_t k = node.first; k < node.last; ++k) best = most(best, along(w, points[leaf_points_[k]].x));
      steps += node.last - node.first;
    } else {
      for (std::uint32_t k = std::max(i, node.from); k < std::min(j, node.to); ++k) {
        ++steps;
        if (!cell_boxes.empty()) {
          best = most(best, along(w, cell_boxes[k]));
        } else if (kind == hull) {
          best = most(best, along(w, points[k].x));
        } else {
          for (int c = 0; c < 3; ++c) best = most(best, along(w, points[triangles[3 * k + c]].x));
        }
      }
    }
  }
  budget.spend(steps);
  return best;
}

// f(p)(s) = v(s).p + d(s) is, up to the remainder r_v.|p| + r_d, the polynomial C0 + C1 s + C2 s^2 with C_k = v_k.p +
// d_k. In Bernstein's basis of degree 2 on [-1, 1], (1-s)^2/4, (1-s)(1+s)/2, (1+s)^2/4, its coefficients are
//   b0 = C0 - C1 + C2,   b1 = C0 - C2,   b2 = C0 + C1 + C2
// (its values at -1 and 1, and 4 C0 = b0 + 2 b1 + b2). The basis is positive and adds up to 1, so the polynomial is at
// most the largest coefficient. Each is linear in p: b_i(p) = w_i.p + o_i with w_i the same combination of v's.
// Slack: 6 ulp of farthest(), and points and cells within 2 ulp of the stated ones: 2 |w|_1 ulp.
Geometry::Reach Geometry::reach(std::uint32_t i, std::uint32_t j, const Vec& v, const Tm& d, Fix length,
                                Budget& budget) const {
  Fix w[4][3], o[4];
  for (int k = 0; k < 3; ++k) {
    w[0][k] = v[k].c0 - v[k].c1 + v[k].c2;
    w[1][k] = v[k].c0 - v[k].c2;
    w[2][k] = v[k].c0 + v[k].c1 + v[k].c2;
    w[3][k] = v[k].c0;
  }
  o[0] = d.c0 - d.c1 + d.c2;
  o[1] = d.c0 - d.c2;
  o[2] = d.c0 + d.c1 + d.c2;
  o[3] = d.c0;
  Reach reach;
  Fix* const out[4] = {&reach.b[0], &reach.b[1], &reach.b[2], &reach.centre};
  if (items_ > 0) {
    if (kind == hull || kind == box) {  // one piece
      i = 0;
      j = items_;
    }
    Box box;
    rangeBox(i, j, box);
    reach.slack = d.r;
    for (int k = 0; k < 3; ++k)
      if (v[k].r.v != 0) reach.slack += mulUp(most(abs(box.low[k]), abs(box.high[k])) + ulps(2), v[k].r);
    for (int c = 0; c < 4; ++c) {
      const Fix sum = abs(w[c][0]) + abs(w[c][1]) + abs(w[c][2]);
      const Fix rounding = ulps(8) + Fix{2 * (sum.v >> 64) + 2};
      *out[c] = farthest(i, j, w[c], budget) + o[c] + reach.slack + rounding;
    }
    return reach;
  }
  // Round shapes: for each generator f + the reach E of its ellipsoid. E(s) = sqrt(Q(s)), Q = sum (a_k v_k)^2, and for
  // every g > 0 sqrt(Q) <= (Q g + 1/g) / 2 (means); or E is below its chord. Of both bounds the one that is lower on
  // the whole. A ball: r |v|, and |v| is that of the direction before rotation.
  for (int c = 0; c < 4; ++c) *out[c] = Fix{-kMost};
  for (const Round& round : rounds) {
    Vec centre;
    for (int k = 0; k < 3; ++k) centre[k] = constant(enclose(round.centre[k]));
    Tm f = dot(v, centre) + d;
    Fix at_centre;
    if (round.ball) {
      f = f + constant(mulUp(encloseUp(round.axes[0]), length));
    } else if (round.axes[0] != 0 || round.axes[1] != 0 || round.axes[2] != 0) {
      Tm Q;
      std::array<Tm, 3> a;
      Fix simple, at_middle;  // E <= sum |a_k v_k|: better where v is as good as along an axis without reach
      for (std::size_t k = 0; k < 3; ++k) {
        a[k] = constant(enclose(round.axes[k])) * v[k];
        Q = Q + a[k] * a[k];
        simple += bound(a[k]);
        at_middle += abs(a[k].c0);
      }
      at_centre = least(sqrtUp(most(Q.c0, Fix{0})), at_middle);
      // g near 1/sqrt(Q), so that 1/g is near sqrt(Q); where Q varies much, nearer to its most.
      Fix width = sqrtUp(most(abs(Q.c0), shifted(bound(Q), 2)));
      Tm mean = chordOfLength(a);
      if (simple > width) {
        width = most(width, Fix{kOne >> 31});
        const Fix g = checked(static_cast<Int>(~static_cast<Uint>(0) / static_cast<Uint>(width.v)));
        const Fix inverse = checked(static_cast<Int>(~static_cast<Uint>(0) / static_cast<Uint>(g.v)) + 1);  // >= 1/g
        const Tm other = divided(Q * constant(g) + constant(inverse), 2);
        if (sumOfCoefficients(other) < sumOfCoefficients(mean)) mean = other;
      }
      at_centre = at_centre - mean.c0;
      f = f + mean;
    }
    budget.spend(20);
    reach.b[0] = most(reach.b[0], f.c0 - f.c1 + f.c2 + f.r);
    reach.b[1] = most(reach.b[1], f.c0 - f.c2 + f.r);
    reach.b[2] = most(reach.b[2], f.c0 + f.c1 + f.c2 + f.r);
    reach.centre = most(reach.centre, f.c0 + at_centre + f.r);
    reach.slack = most(reach.slack, f.r);
  }
  return reach;
}

}  // namespace verify
