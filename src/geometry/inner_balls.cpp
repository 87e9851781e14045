// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/inner_balls.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <queue>

#include <Eigen/Geometry>

#include "geometry/mesh_triangle.h"
#include "numerics/constants.h"

namespace fcl_artic {
namespace {

using Eigen::Vector3d;
using engine::ClosedPart;
using engine::InnerBalls;
using engine::Node;
using engine::PieceKind;

/// Numbers of points that are tried in a mesh, and at least in its smallest part.
constexpr int kSamples = 400, kFewestSamples = 40;
/// Parts that get balls: at most kMaxParts, none smaller than kLeastPart of the largest.
constexpr std::size_t kMaxParts = 8;
constexpr double kLeastPart = 0.1;
/// Steps by which a ball is moved away from where it touches.
constexpr int kMoveSteps = 6;

double distanceFromSegment(const LineSweptSphere& around, const Vector3d& x) {
  const Vector3d begin = Vector3d::Map(&around[0]), along = Vector3d::Map(&around[3]) - begin;
  const double square = along.squaredNorm();
  const double part = square > 0 ? std::clamp((x - begin).dot(along) / square, 0.0, 1.0) : 0;
  return (x - begin - part * along).norm();
}

/// A ball that may be taken.
struct Ball {
  Vector3d center;
  double radius;
  std::int32_t part;
  double weight;  ///< of the space around its centre
};

/// Adds points spread through the space that a part encloses: on lines of a grid along its longest axis, where they run
/// inside.
void addSamples(const EnclosedSpace& space, std::int32_t part, const Vector3d& lo, const Vector3d& size, double count,
                std::vector<Ball>& samples) {
  int axis;
  const double longest = size.maxCoeff(&axis);
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const double step = std::cbrt(size.prod() / count);
  if (!(step > 0) || !(longest / step < 1e4)) return;  // flat
  const int columns[2] = {static_cast<int>(std::ceil(size[u] / step)), static_cast<int>(std::ceil(size[v] / step))};
  std::vector<EnclosedSpace::Crossing> found;
  std::vector<double> heights;
  for (int i = 0; i < columns[0]; ++i) {
    for (int j = 0; j < columns[1]; ++j) {
      Vector3d x = lo;
      x[u] += size[u] * (i + 0.501) / columns[0];  // not along an edge in the middle of a body
      x[v] += size[v] * (j + 0.503) / columns[1];
      if (!space.crossings(part, x, axis, found)) continue;
      heights.clear();
      for (const auto& crossing : found) heights.push_back(crossing.height);
      std::sort(heights.begin(), heights.end());
      for (std::size_t k = 0; k + 1 < heights.size(); k += 2) {
        const double inside = heights[k + 1] - heights[k];
        const int points = std::max(1, static_cast<int>(std::lround(inside / step)));
        for (int p = 0; p < points; ++p) {
          Vector3d y = x;
          y[axis] += heights[k] + inside * (p + 0.5) / points;
          samples.push_back({y, 0, part, inside / points * size[u] * size[v] / (columns[0] * columns[1])});
        }
      }
    }
  }
}

/// Moves a ball away from the point where it touches, as long as that makes it larger by at least half of the way.
void enlarge(const EnclosedSpace& space, Ball& ball) {
  Vector3d nearest;
  ball.radius = space.clearance(ball.part, ball.center, nearest);
  double way = 0.5 * ball.radius;
  for (int i = 0; i < kMoveSteps && ball.radius > 0; ++i) {
    const Vector3d center = ball.center + way * (ball.center - nearest).normalized();
    Vector3d touched;
    const double radius = space.clearance(ball.part, center, touched);
    if (radius > ball.radius + 0.5 * way) {
      ball.center = center;
      ball.radius = radius;
      nearest = touched;
    } else {
      way *= 0.4;
    }
  }
}

bool holds(const Ball& ball, const Ball& sample) {
  return ball.part == sample.part && (sample.center - ball.center).squaredNorm() <= ball.radius * ball.radius;
}

/// The balls that together hold most of the samples' weight, one after the other.
std::vector<Ball> choose(const EnclosedSpace& space, std::vector<Ball>& samples) {
  std::vector<bool> held(samples.size(), false);
  const auto weightOf = [&](const Ball& ball) {
    double sum = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (!held[i] && holds(ball, samples[i])) sum += samples[i].weight;
    }
    return sum;
  };
  // The gain of a ball only ever decreases. So if the first ball in the queue, weighed anew, stays first, it is the
  // best.
  std::priority_queue<std::pair<double, std::size_t>> queue;
  for (std::size_t i = 0; i < samples.size(); ++i) queue.emplace(weightOf(samples[i]), i);
  std::vector<Ball> chosen;
  while (!queue.empty() && chosen.size() < static_cast<std::size_t>(InnerBalls::kMax)) {
    const auto [weight, index] = queue.top();
    queue.pop();
    const double now = weightOf(samples[index]);
    if (!(now > 0)) continue;
    if (now < weight && !queue.empty() && now < queue.top().first) {
      queue.emplace(now, index);
      continue;
    }
    Ball ball = samples[index];
    enlarge(space, ball);
    for (std::size_t i = 0; i < samples.size(); ++i) held[i] = held[i] || holds(ball, samples[i]);
    if (ball.radius > 0 && space.certainlyEncloses(ball.part, ball.center)) chosen.push_back(ball);
  }
  return chosen;
}

/// A part's box, and its points farthest along eight directions.
ClosedPart boundPart(const engine::TreeView& mesh, const ClosedParts& parts, std::int32_t part) {
  ClosedPart bound;
  for (int k = 0; k < 3; ++k) {
    bound.lo[k] = kInfinity;
    bound.hi[k] = -kInfinity;
  }
  double most[8];
  std::fill(std::begin(most), std::end(most), -kInfinity);
  for (std::int32_t i = 0; i < mesh.num_pieces; ++i) {
    if (parts.part_of_piece[static_cast<std::size_t>(i)] != part) continue;
    for (const Vector3d& x : triangleOf(mesh, i).corner) {
      const double along[8] = {x[0], -x[0], x[1], -x[1], x[2], -x[2], x.sum(), -x.sum()};
      for (int d = 0; d < 8; ++d) {
        if (!(along[d] > most[d])) continue;
        most[d] = along[d];
        for (int k = 0; k < 3; ++k) bound.points[k][d] = x[k];
      }
      for (int k = 0; k < 3; ++k) {
        bound.lo[k] = std::min(bound.lo[k], x[k]);
        bound.hi[k] = std::max(bound.hi[k], x[k]);
      }
    }
  }
  return bound;
}

}  // namespace

double EnclosedSpace::clearance(std::int32_t part, const Vector3d& x, Vector3d& nearest) const {
  const auto clearance = [&](std::int32_t piece, Vector3d& point) {
    if (parts_.part_of_piece[static_cast<std::size_t>(piece)] != part) return kInfinity;
    const MeshTriangle t = triangleOf(mesh_, piece);
    point = nearestPoint(t, x);
    return clearanceOf(t, x, point);
  };
  return leastClearance(mesh_, x, clearance, nearest);
}

bool EnclosedSpace::crossings(std::int32_t part, const Vector3d& x, int axis, std::vector<Crossing>& found) const {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  found.clear();
  std::int32_t open[64];
  std::size_t count = 0;
  open[count++] = 0;
  while (count) {
    const Node& node = mesh_.nodes[open[--count]];
    if (x[u] < node.lo[u] || x[u] > node.hi[u] || x[v] < node.lo[v] || x[v] > node.hi[v]) continue;
    if (!node.isLeaf()) {
      open[count++] = node.left();
      open[count++] = node.right();
      continue;
    }
    if (parts_.part_of_piece[static_cast<std::size_t>(node.piece())] != part) continue;
    const MeshTriangle t = triangleOf(mesh_, node.piece());
    if (t.corner[0] == t.corner[1] || t.corner[1] == t.corner[2] || t.corner[2] == t.corner[0]) continue;
    Crossing crossing;
    const Crosses answer = crosses(t, x, axis, crossing);
    if (answer == Crosses::unknown) return false;
    if (answer == Crosses::yes) found.push_back(crossing);
  }
  return true;
}

bool EnclosedSpace::certainlyEncloses(std::int32_t part, const Vector3d& x) const {
  std::vector<Crossing> found;
  for (int axis = 0; axis < 3; ++axis) {
    if (!crossings(part, x, axis, found)) continue;
    if (!std::all_of(found.begin(), found.end(), [](const Crossing& c) { return c.certain; })) continue;
    return std::count_if(found.begin(), found.end(), [](const Crossing& c) { return c.height > 0; }) % 2 == 1;
  }
  return false;
}

std::unique_ptr<const BallsInMesh> BallsInMesh::find(const engine::TreeView& mesh, const LineSweptSphere& around) {
  for (std::int32_t i = 0; i < mesh.num_pieces; ++i) {
    if (mesh.pieces[i].kind != PieceKind::vertices || mesh.pieces[i].num_vertices != 3) return nullptr;
  }
  const EnclosedSpace space(mesh);
  const ClosedParts& parts = space.parts();
  struct Sized {
    std::int32_t part;
    Vector3d lo, size;
  };
  std::vector<Sized> sized;
  {
    std::vector<Vector3d> lo(static_cast<std::size_t>(parts.count), Vector3d::Constant(kInfinity)), hi;
    for (const Vector3d& x : lo) hi.push_back(-x);
    for (std::int32_t i = 0; i < mesh.num_pieces; ++i) {
      const std::int32_t part = parts.part_of_piece[static_cast<std::size_t>(i)];
      if (part < 0) continue;
      for (const Vector3d& x : triangleOf(mesh, i).corner) {
        lo[static_cast<std::size_t>(part)] = lo[static_cast<std::size_t>(part)].cwiseMin(x);
        hi[static_cast<std::size_t>(part)] = hi[static_cast<std::size_t>(part)].cwiseMax(x);
      }
    }
    for (std::size_t p = 0; p < lo.size(); ++p) sized.push_back({static_cast<std::int32_t>(p), lo[p], hi[p] - lo[p]});
  }
  std::stable_sort(sized.begin(), sized.end(),
                   [](const Sized& a, const Sized& b) { return a.size.norm() > b.size.norm(); });
  double volume = 0;
  std::size_t kept = 0;
  while (kept < std::min(kMaxParts, sized.size()) && sized[kept].size.norm() >= kLeastPart * sized[0].size.norm()) {
    volume += sized[kept++].size.prod();
  }
  std::vector<Ball> samples;
  for (std::size_t i = 0; i < kept; ++i) {
    const double share = kSamples * sized[i].size.prod() / volume;
    addSamples(space, sized[i].part, sized[i].lo, sized[i].size, std::max<double>(kFewestSamples, share), samples);
  }
  for (Ball& sample : samples) {
    Vector3d nearest;
    sample.radius = space.clearance(sample.part, sample.center, nearest);
  }
  const std::vector<Ball> chosen = choose(space, samples);
  if (chosen.empty()) return nullptr;

  std::unique_ptr<BallsInMesh> found(new BallsInMesh());
  InnerBalls& balls = found->balls_;
  balls.count = static_cast<std::int32_t>(chosen.size());
  std::vector<std::int32_t> number(static_cast<std::size_t>(parts.count), -1);
  for (std::int32_t i = 0; i < InnerBalls::kMax; ++i) {
    const bool is_one = i < balls.count;
    const Ball ball = is_one ? chosen[static_cast<std::size_t>(i)] : Ball{Vector3d::Zero(), -1e30, -1, 0};
    for (int k = 0; k < 3; ++k) balls.center[k][i] = ball.center[k];
    balls.radius[i] = ball.radius;
    balls.part[i] = -1;
    if (!is_one) continue;
    balls.reach = std::max(balls.reach, distanceFromSegment(around, ball.center) + ball.radius);
    std::int32_t& part = number[static_cast<std::size_t>(ball.part)];
    if (part < 0) {
      part = static_cast<std::int32_t>(found->parts_.size());
      found->parts_.push_back(boundPart(mesh, parts, ball.part));
    }
    balls.part[i] = part;
  }
  balls.parts = found->parts_.data();
  return found;
}

}  // namespace fcl_artic
