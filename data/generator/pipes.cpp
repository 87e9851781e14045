// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <stdexcept>
#include <utility>

#include "files/files.h"
#include "loft.h"

namespace fcl_artic::generator {

namespace {

using Cell = Eigen::Vector3i;

constexpr double kCell = 0.1;                           // m; a pipe fills a cell at a time
constexpr int kCells[3] = {24, 24, 16};                 // the grid, centred on the z axis and standing on z = 0
constexpr int kKeepOut = 5;                             // cells: radius about the z axis that stays free
constexpr double kPipeRadii[] = {0.022, 0.028, 0.034};  // m; balls of 1.4 times that stay within their cell
constexpr double kBallFactor = 1.4, kCollarFactor = 1.25, kCollarHalfWidth = 0.012;

/// splitmix64 (Steele, Lea, Flood 2014): whole numbers only, the same everywhere.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  /// In [0, n).
  int below(int n) { return static_cast<int>(((next() >> 32) * static_cast<std::uint64_t>(n)) >> 32); }

 private:
  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  std::uint64_t state_;
};

/// How finely pipes are drawn.
struct Detail {
  int sides;     // of a pipe's cross-section
  int straight;  // rings per straight cell
  int bend;      // rings per bend
  int ball() const { return sides / 2 - 1; }
};

Detail detailFor(std::size_t triangles) {
  if (triangles < 3000) return {8, 1, 3};
  if (triangles < 30000) return {10, 1, 3};
  if (triangles < 300000) return {16, 2, 8};
  return {32, 4, 14};
}

/// Which cells are taken, by pipes or by the free region.
class Grid {
 public:
  Grid() : taken_(static_cast<std::size_t>(kCells[0]) * kCells[1] * kCells[2]) {
    for (int x = 0; x < kCells[0]; ++x) {
      for (int y = 0; y < kCells[1]; ++y) {
        // Distance of the cell's nearest corner from the axis, in cells.
        const int dx = std::max(x - kCells[0] / 2, kCells[0] / 2 - 1 - x);
        const int dy = std::max(y - kCells[1] / 2, kCells[1] / 2 - 1 - y);
        for (int z = 0; dx * dx + dy * dy < kKeepOut * kKeepOut && z < kCells[2]; ++z) take({x, y, z});
      }
    }
  }
  bool isFree(const Cell& c) const {
    for (int k = 0; k < 3; ++k) {
      if (c[k] < 0 || c[k] >= kCells[k]) return false;
    }
    return !taken_[index(c)];
  }
  void take(const Cell& c) { taken_[index(c)] = true; }

 private:
  static std::size_t index(const Cell& c) {
    return (static_cast<std::size_t>(c[2]) * kCells[1] + static_cast<std::size_t>(c[1])) * kCells[0] +
           static_cast<std::size_t>(c[0]);
  }
  std::vector<bool> taken_;
};

Eigen::Vector3d centreOf(const Cell& c) {
  return {(2 * c[0] + 1 - kCells[0]) * kCell / 2, (2 * c[1] + 1 - kCells[1]) * kCell / 2, (2 * c[2] + 1) * kCell / 2};
}

/// Draws one pipe at a time, as a turtle that carries a cross-section along. Everything costs whole rings, each of
/// 2 `sides` triangles (an open tube's rings less one, and its two ends), so that a size is met exactly.
class Pen {
 public:
  Pen(const Detail& detail, int budget) : detail_(detail), circle_(unitCircle(detail.sides)), left_(budget) {}

  int ringsLeft() const { return left_; }
  /// More than any one step costs.
  int ringsOfAStep() const { return std::max({detail_.bend, detail_.ball() + 3, detail_.straight, 5}) + 1; }
  const Cell& direction() const { return along_; }

  void begin(const Eigen::Vector3d& at, const Cell& direction, double radius) {
    at_ = at;
    along_ = direction;
    u_ = Cell(direction[1], direction[2], direction[0]).cast<double>();
    v_ = direction.cast<double>().cross(u_);
    radius_ = radius;
    ring(at_, u_, v_, radius_);
  }
  void straight(double length, int rings) {
    const Eigen::Vector3d d = along_.cast<double>();
    for (int k = 1; k <= rings; ++k) ring(at_ + (length * k / rings) * d, u_, v_, radius_);
    at_ += length * d;
  }
  void straightCell() { straight(kCell, detail_.straight); }
  /// A straight cell with a coupling in its middle.
  void coupling() {
    const Eigen::Vector3d d = along_.cast<double>(), middle = at_ + (kCell / 2) * d;
    for (const int side : {-1, 1}) {
      const Eigen::Vector3d face = middle + side * kCollarHalfWidth * d;
      for (const int k : {-1, 1}) ring(face, u_, v_, k * side < 0 ? radius_ : kCollarFactor * radius_);
    }
    straight(kCell, 1);
  }
  /// A quarter of a torus through a cell, from the middle of one face to that of another.
  void bend(const Cell& to) {
    const Eigen::Vector3d d = along_.cast<double>(), e = to.cast<double>(), b = d.cross(e);
    const Eigen::Vector3d pivot = at_ + (kCell / 2) * e;
    const auto turned = [&](const Eigen::Vector3d& w, double c, double s) -> Eigen::Vector3d {
      return w.dot(b) * b + w.dot(d) * (c * d + s * e) + w.dot(e) * (c * e - s * d);
    };
    for (int k = 1; k <= detail_.bend; ++k) {
      const Eigen::Vector2d p = unitVector(k, 4 * detail_.bend);
      ring(pivot - (kCell / 2) * turned(e, p.x(), p.y()), turned(u_, p.x(), p.y()), turned(v_, p.x(), p.y()), radius_);
    }
    at_ = pivot + (kCell / 2) * d;
    u_ = turned(u_, 0, 1);
    v_ = turned(v_, 0, 1);
    along_ = to;
  }
  /// A ball in the middle of the cell, where the pipe turns sharply.
  void ball(const Cell& to) {
    straight(kCell / 2, 1);
    end();
    const double r = kBallFactor * radius_;
    std::vector<Ring> rings;
    for (int k = 0; k < detail_.ball(); ++k) {
      const Eigen::Vector2d p = unitVector(2 * k + 1, 4 * detail_.ball());
      rings.push_back(crossSection(at_ - r * p.x() * along_.cast<double>(), u_, v_, r * p.y()));
      --left_;
    }
    addLoft(mesh_, rings, at_ - r * along_.cast<double>(), at_ + r * along_.cast<double>());
    begin(at_, to, radius_);
    straight(kCell / 2, 1);
  }
  void end() {
    addLoft(mesh_, rings_);
    rings_.clear();
  }
  /// The mesh that was drawn since the last call.
  Mesh take() { return std::exchange(mesh_, {}); }

 private:
  Ring crossSection(const Eigen::Vector3d& at, const Eigen::Vector3d& u, const Eigen::Vector3d& v, double r) const {
    Ring ring;
    for (const auto& p : circle_) ring.push_back(at + (r * p.x()) * u + (r * p.y()) * v);
    return ring;
  }
  void ring(const Eigen::Vector3d& at, const Eigen::Vector3d& u, const Eigen::Vector3d& v, double r) {
    rings_.push_back(crossSection(at, u, v, r));
    --left_;
  }

  Mesh mesh_;
  Detail detail_;
  std::vector<Eigen::Vector2d> circle_;
  std::vector<Ring> rings_;  // of the tube being drawn
  Eigen::Vector3d at_, u_, v_;
  Cell along_;
  double radius_ = 0;
  int left_;
};

const Cell kDirections[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};

/// Directions from the cell into free neighbours.
std::vector<Cell> waysOut(const Grid& grid, const Cell& cell) {
  std::vector<Cell> ways;
  for (const Cell& d : kDirections) {
    if (grid.isFree(cell + d)) ways.push_back(d);
  }
  return ways;
}

}  // namespace

std::vector<Mesh> separatePipes(std::size_t triangles, std::uint64_t seed) {
  if (triangles < kMinPipeTriangles || triangles > kMaxPipeTriangles) {
    throw std::invalid_argument("a scene of " + std::to_string(triangles) + " triangles was asked for, between " +
                                std::to_string(kMinPipeTriangles) + " and " + std::to_string(kMaxPipeTriangles) +
                                " can be made");
  }
  const Detail detail = detailFor(triangles);
  const int ring = 2 * detail.sides;
  std::vector<Mesh> pipes;
  Grid grid;
  Random random(seed);
  Pen pen(detail, (static_cast<int>(triangles) + ring / 2) / ring);

  while (pen.ringsLeft() > 0) {
    Cell cell;
    std::vector<Cell> ways;
    do {
      cell = {random.below(kCells[0]), random.below(kCells[1]), random.below(kCells[2])};
      ways = waysOut(grid, cell);
    } while (!grid.isFree(cell) || ways.empty());
    grid.take(cell);
    // One after the other: arguments have no order.
    const double radius = kPipeRadii[random.below(3)];
    const Cell way = ways[static_cast<std::size_t>(random.below(static_cast<int>(ways.size())))];
    pen.begin(centreOf(cell), way, radius);
    pen.straight(kCell / 2, 1);

    for (int cells = 20 + random.below(40);; --cells) {
      // The pen stands on the face to the next cell, which is free.
      cell += pen.direction();
      grid.take(cell);
      ways = waysOut(grid, cell);
      // The remaining rings, always more than none, are spent where the last pipe ends.
      const bool last = pen.ringsLeft() <= pen.ringsOfAStep() + 3;
      if (last || cells == 0 || ways.empty()) {
        pen.straight(kCell / 2, last ? pen.ringsLeft() : 1);
        pen.end();
        break;
      }
      const bool ahead = grid.isFree(cell + pen.direction());
      if (ahead && random.below(100) < 65) {
        if (random.below(6) == 0) {
          pen.coupling();
        } else {
          pen.straightCell();
        }
        continue;
      }
      const Cell to = ways[static_cast<std::size_t>(random.below(static_cast<int>(ways.size())))];
      if (to == pen.direction()) {
        pen.straightCell();
      } else if (random.below(4) == 0) {
        pen.ball(to);
      } else {
        pen.bend(to);
      }
    }
    pipes.push_back(pen.take());
    snap(pipes.back());
  }
  return pipes;
}

Mesh pipes(std::size_t triangles, std::uint64_t seed) {
  Mesh all;
  for (const Mesh& pipe : separatePipes(triangles, seed)) {
    const int first = static_cast<int>(all.vertices.size());
    all.vertices.insert(all.vertices.end(), pipe.vertices.begin(), pipe.vertices.end());
    for (const auto& t : pipe.triangles) all.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
  return all;
}

void writePipes(std::size_t triangles, std::uint64_t seed, const std::string& obj_path) {
  files::write(obj_path,
               objText(pipes(triangles, seed), "Pipes: " + std::to_string(triangles) + " triangles wanted, seed " +
                                                   std::to_string(seed) + "; m"));
}

}  // namespace fcl_artic::generator
