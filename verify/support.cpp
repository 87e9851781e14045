// SPDX-License-Identifier: BSD-3-Clause
#include "support.h"

#include <map>

namespace verify {

void Box::add(const Box& other) {
  for (std::size_t k = 0; k < 3; ++k) {
    low[k] = std::min(low[k], other.low[k]);
    high[k] = std::max(high[k], other.high[k]);
  }
}

Fix Direction::most(const Box& box) const {
  Fix sum;
  for (std::size_t k = 0; k < 3; ++k) sum += std::max(along(k, box.low[k]), along(k, box.high[k]));
  return sum;
}

void Geometry::prepare() {
  for (std::size_t k = 0; k + 2 < vertices.size(); k += 3)
    points.push_back({enclose(vertices[k]).x, enclose(vertices[k + 1]).x, enclose(vertices[k + 2]).x});
  const std::vector<double>& n = numbers;
  const auto addCell = [&](const std::array<double, 6>& cell) {
    Box box;
    for (std::size_t k = 0; k < 3; ++k) {  // each sum within 2 ulp of the cell's end
      const Fix centre = enclose(cell[k]).x, half = enclose(cell[3 + k]).x;
      box.low[k] = centre - half;
      box.high[k] = centre + half;
    }
    cells_.push_back(box);
  };
  // Halves of numbers below 2^-1022 are covered by an ulp.
  if (kind == mesh) pieces_ = static_cast<std::uint32_t>(triangles.size() / 3);
  if (kind == boxes) pieces_ = static_cast<std::uint32_t>(cells.size() / 6);
  for (const double* c = cells.data(); c != cells.data() + cells.size(); c += 6)
    addCell({c[0], c[1], c[2], c[3], c[4], c[5]});
  if (kind == box) addCell({0, 0, 0, n[0] / 2, n[1] / 2, n[2] / 2});
  if (kind == hull)
    for (const Point& p : points) cells_.push_back({p, p});
  if (kind == sphere) rounds = {{0, {n[0], n[0], n[0]}}};
  if (kind == ellipsoid) rounds = {{0, {n[0], n[1], n[2]}}};
  if (kind == capsule) rounds = {{-n[1] / 2, {n[0], n[0], n[0]}}, {n[1] / 2, {n[0], n[0], n[0]}}};
  if (kind == cylinder) rounds = {{-n[1] / 2, {n[0], n[0], 0}}, {n[1] / 2, {n[0], n[0], 0}}};
  if (kind == cone) rounds = {{-n[1] / 2, {n[0], n[0], 0}}, {n[1] / 2, {0, 0, 0}}};
  const std::size_t items = kind == mesh ? pieces_ : cells_.size();
  if (items > 0) build(0, static_cast<std::uint32_t>(items));
}

Box Geometry::boxOf(std::uint32_t item) const {
  if (kind != mesh) return cells_[item];
  const Point &a = points[triangles[3 * item]], &b = points[triangles[3 * item + 1]],
              &c = points[triangles[3 * item + 2]];
  Box box{a, a};
  box.add({b, b});
  box.add({c, c});
  return box;
}

// Corners at one place are one: so parts that are joined do hang together, and edges that meet cancel.
bool Geometry::joinSurfaces() {
  std::map<std::array<double, 3>, std::uint32_t> places;
  std::vector<std::uint32_t> same, root;  // of each vertex
  for (std::uint32_t k = 0; k < vertices.size() / 3; ++k) {
    const double* const x = &vertices[3 * static_cast<std::size_t>(k)];
    same.push_back(places.emplace(std::array<double, 3>{x[0], x[1], x[2]}, k).first->second);
    root.push_back(k);
  }
  const auto find = [&](std::uint32_t k) {
    while (root[k] != k) k = root[k] = root[root[k]];
    return k;
  };
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::int64_t> edges;  // passed one way more often than the other
  for (std::size_t t = 0; t + 2 < triangles.size(); t += 3) {
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t a = same[triangles[t + c]], b = same[triangles[t + (c + 1) % 3]];
      if (a == b) continue;
      root[std::max(find(a), find(b))] = std::min(find(a), find(b));
      edges[std::minmax(a, b)] += a < b ? 1 : -1;
    }
  }
  for (std::size_t t = 0; t + 2 < triangles.size(); t += 3) part.push_back(find(same[triangles[t]]));
  return std::all_of(edges.begin(), edges.end(), [](const auto& edge) { return edge.second == 0; });
}

// Halves of the list: neighbours in the list are near each other where the writer ordered it well.
std::uint32_t Geometry::build(std::uint32_t i, std::uint32_t j) {
  constexpr std::uint32_t kLeaf = 8;
  const auto index = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back({i, j, 0, boxOf(i)});
  if (j - i > kLeaf) {
    const std::uint32_t left = build(i, i + (j - i) / 2), right = build(i + (j - i) / 2, j);
    nodes_[index].right = right;
    nodes_[index].box = nodes_[left].box;
    nodes_[index].box.add(nodes_[right].box);
  } else {
    for (std::uint32_t k = i + 1; k < j; ++k) nodes_[index].box.add(boxOf(k));
  }
  return index;
}

/// Branch and bound for the most of a direction over the items [i, j). Every value and every bound is less than 3 ulp
/// too small. So an item that is left out is at most 3 ulp above `best`. And `best` is at most 3 ulp below its own
/// exact value: together 6 ulp.
struct Geometry::Search {
  const Geometry& g;
  const std::uint32_t i, j;
  const Direction w;
  Budget& budget;
  Fix best{-kMost};

  Fix most(std::uint32_t item) const {
    if (g.kind != mesh) return w.most(g.cells_[item]);
    const std::uint32_t* const t = &g.triangles[3 * static_cast<std::size_t>(item)];
    return std::max({w.of(g.points[t[0]]), w.of(g.points[t[1]]), w.of(g.points[t[2]])});
  }
  void look(std::uint32_t at, Fix bound) {
    const Node& node = g.nodes_[at];
    if (bound <= best || node.to <= i || node.from >= j) return;
    budget.spend(1);
    if (node.right != 0) {
      const Fix a = w.most(g.nodes_[at + 1].box), b = w.most(g.nodes_[node.right].box);
      if (a > b) look(at + 1, a);  // the farther one first
      look(node.right, b);
      if (!(a > b)) look(at + 1, a);
      return;
    }
    for (std::uint32_t k = std::max(i, node.from); k < std::min(j, node.to); ++k) {
      budget.spend(2);
      best = std::max(best, most(k));
    }
  }
};

// f(p)(s) = v(s).p + d(s) is, up to the remainder r_v.|p| + r_d, the polynomial C0 + C1 s + C2 s^2 with C_k = v_k.p +
// d_k. In Bernstein's basis of degree 2 on [-1, 1], (1-s)^2/4, (1-s)(1+s)/2, (1+s)^2/4, its coefficients are
//   b0 = C0 - C1 + C2,   b1 = C0 - C2,   b2 = C0 + C1 + C2
// (its values at -1 and 1, and 4 C0 = b0 + 2 b1 + b2). The basis is positive and adds up to 1, so the polynomial is at
// most the largest coefficient. Each is linear in p: b_i(p) = w_i.p + o_i with w_i the same combination of v's.
static std::array<Fix, 3> bernstein(const Tm& a) {
  return {a.c0 - a.c1 + a.c2, a.c0 - a.c2, a.c0 + a.c1 + a.c2};
}

/// Above the length of the vector a(s). With l the linear part of a, |a| <= |l| + sum (|c2| + r), and |l(s)|, a length
/// of what is linear, is convex: not above the line between |l(-1)| and |l(1)|. Exact at both ends but for these and
/// the rounding, also where a passes through 0 at an end, as a disc's direction that comes to be its axis.
static Tm chordOfLength(const Vec& a) {
  Fix end[2], rest;
  for (int i = 0; i < 2; ++i) {
    Fix squares, sum;
    for (const Tm& x : a) {
      const Fix l = abs(i == 0 ? x.c0 - x.c1 : x.c0 + x.c1);
      squares += mulUp(l, l);
      sum += l;
    }
    end[i] = std::min(sqrtUp(squares), sum);
  }
  for (const Tm& x : a) rest += abs(x.c2) + x.r;
  // Both halves are rounded down by half an ulp at most.
  return {shifted(end[0] + end[1], 1) + ulps(1) + rest, shifted(end[1] - end[0], 1), {}, {}};
}

std::array<Fix, 3> Geometry::reach(std::uint32_t i, std::uint32_t j, const Vec& v, const Tm& d, Fix length,
                                   Budget& budget) const {
  if (rounds.empty() && nodes_.empty()) throw NotProven("SEP of a body without bounds");
  std::array<Fix, 3> most{Fix{-kMost}, Fix{-kMost}, Fix{-kMost}};
  // Round shapes: for each generator f + the reach E of its ellipsoid, which is |a|, a_k = (semi-axis k) v_k. A ball: r
  // |v|, and |v| is that of the direction before rotation.
  for (const Round& round : rounds) {
    budget.spend(20);
    const auto& r = round.axes;
    const bool ball = r[0] == r[1] && r[1] == r[2];
    const Tm f = v[2] * exactly(round.z) + d +
                 (ball ? constant(mulUp(encloseUp(r[0]), length))
                       : chordOfLength({exactly(r[0]) * v[0], exactly(r[1]) * v[1], exactly(r[2]) * v[2]}));
    for (std::size_t c = 0; c < 3; ++c) most[c] = std::max(most[c], bernstein(f)[c] + f.r);
  }
  for (std::size_t c = 0; c < 3 && !nodes_.empty(); ++c) {
    Direction w;
    Fix size;
    for (std::size_t k = 0; k < 3; ++k) {
      const Fix x = bernstein(v[k])[c];
      w.up[k] = x + v[k].r;
      w.down[k] = x - v[k].r;
      size += abs(x) + v[k].r;
    }
    // 6 ulp of the search, and points and cells within 2 ulp of the stated ones: 2 |w|_1 ulp.
    Search search{*this, pieces_ == 1 ? 0 : i, pieces_ == 1 ? nodes_[0].to : j, w, budget};
    search.look(0, Fix{kMost});
    most[c] = search.best + bernstein(d)[c] + d.r + ulps(8) + Fix{2 * (size.v >> 64) + 2};
  }
  return most;
}

/// Branch and bound for the most of |W p + o|^2 over the items [i, j). All values are too large rather than too small.
/// Products are less than 1 ulp too small each, and points within 2 ulp of those stated. So a coordinate of W p + o is
/// off by less than 3 + 2 |w|_1 ulp, w its row of W: `slack` is no less. A node's coordinates have 6 ulp more, so that
/// they are not below those computed for its items.
struct Geometry::FarSearch {
  const Geometry& g;
  const std::uint32_t i, j;
  const std::array<Fix, 9> W;
  const std::array<Fix, 3> o;
  std::array<Fix, 3> slack;
  Budget& budget;
  Fix best{0};

  Fix squared(const Point& p, const Point& half, Fix more) const {
    Fix sum;
    for (std::size_t c = 0; c < 3; ++c) {
      Fix x = abs(W[3 * c] * p[0] + W[3 * c + 1] * p[1] + W[3 * c + 2] * p[2] + o[c]) + slack[c] + more;
      for (std::size_t k = 0; k < 3 && more > Fix{0}; ++k) x += mulUp(abs(W[3 * c + k]), half[k]);
      sum += mulUp(x, x);
    }
    return sum;
  }
  Fix most(std::uint32_t item) const {
    Fix far;
    if (g.kind == mesh) {
      for (std::size_t c = 0; c < 3; ++c)
        far = std::max(far, squared(g.points[g.triangles[3 * static_cast<std::size_t>(item) + c]], {}, Fix{0}));
      return far;
    }
    const Box& box = g.cells_[item];  // the distance is convex: a corner is farthest
    for (unsigned c = 0; c < (g.kind == hull ? 1u : 8u); ++c)
      far = std::max(far, squared({(c & 1 ? box.high : box.low)[0], (c & 2 ? box.high : box.low)[1],
                                   (c & 4 ? box.high : box.low)[2]},
                                  {}, Fix{0}));
    return far;
  }
  Fix most(const Box& box) const {
    Point middle, half;
    for (std::size_t k = 0; k < 3; ++k) {
      middle[k] = shifted(box.low[k] + box.high[k], 1);  // rounded down: the upper half is the longer one
      half[k] = box.high[k] - middle[k];
    }
    return squared(middle, half, ulps(6));
  }
  void look(std::uint32_t at, Fix bound) {
    const Node& node = g.nodes_[at];
    if (bound <= best || node.to <= i || node.from >= j) return;
    budget.spend(4);
    if (node.right != 0) {
      const Fix left = most(g.nodes_[at + 1].box), right = most(g.nodes_[node.right].box);
      if (left > right) look(at + 1, left);  // the farther one first
      look(node.right, right);
      if (!(left > right)) look(at + 1, left);
      return;
    }
    for (std::uint32_t k = std::max(i, node.from); k < std::min(j, node.to); ++k) {
      budget.spend(g.kind == boxes || g.kind == box ? 12 : 5);
      best = std::max(best, most(k));
    }
  }
};

// With the coefficients b_0, b_1, b_2 of W p + o: |sum B_i b_i| <= sum B_i |b_i|, and |b_i| is convex in p. Points
// around a round shape's generator are at most its longest semi-axis farther from the axis or centre.
std::array<Fix, 3> Geometry::distance(std::uint32_t i, std::uint32_t j, const Mat& W, const Vec& o,
                                      Budget& budget) const {
  if (rounds.empty() && nodes_.empty()) throw NotProven("a distance to a body without bounds");
  // The remainder at a point p: sum of r |p_k| over all nine entries of W, and of those of o.
  Fix rest = o[0].r + o[1].r + o[2].r;
  for (std::size_t k = 0; k < 3; ++k) {
    Fix far;
    for (const Round& round : rounds)
      if (k == 2) far = std::max(far, encloseUp(std::fabs(round.z)));
    if (!nodes_.empty()) far = std::max(abs(nodes_[0].box.low[k]), abs(nodes_[0].box.high[k])) + ulps(2);
    rest += mulUp(W[k].r + W[3 + k].r + W[6 + k].r, far);
  }
  std::array<Fix, 3> most;
  for (std::size_t b = 0; b < 3; ++b) {
    std::array<Fix, 9> w;
    for (std::size_t k = 0; k < 9; ++k) w[k] = bernstein(W[k])[b];
    FarSearch search{*this,
                     pieces_ == 1 ? 0 : i,
                     pieces_ == 1 && !nodes_.empty() ? nodes_[0].to : j,
                     w,
                     {bernstein(o[0])[b], bernstein(o[1])[b], bernstein(o[2])[b]},
                     {},
                     budget,
                     {}};
    for (std::size_t c = 0; c < 3; ++c)
      search.slack[c] = ulps(6) + Fix{2 * ((abs(w[3 * c]) + abs(w[3 * c + 1]) + abs(w[3 * c + 2])).v >> 64) + 2};
    for (const Round& round : rounds) {
      budget.spend(20);
      const Fix centre = sqrtUp(search.squared(Point{Fix{}, Fix{}, enclose(round.z).x}, {}, Fix{0}));
      most[b] = std::max(most[b], centre + encloseUp(std::max({round.axes[0], round.axes[1], round.axes[2]})));
    }
    if (!nodes_.empty()) {
      search.look(0, Fix{kMost});
      most[b] = std::max(most[b], sqrtUp(search.best));
    }
    most[b] += rest;
  }
  return most;
}

}  // namespace verify
