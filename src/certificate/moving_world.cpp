// SPDX-License-Identifier: BSD-3-Clause
#include "certificate/moving_world.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "numerics/baseline_isa.h"

#include "convex/piece_kinds.h"

namespace fcl_artic::certificate {
namespace {

using baseline::Vec3;
using Eigen::Matrix3d;
using Eigen::Vector3d;

Pose poseOf(const Eigen::Isometry3d& M) {
  return {M.linear(), M.translation()};
}

Matrix3d rotationBy(const Vector3d& w) {
  const double angle = w.norm();
  if (angle < 1e-300) return Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, w / angle).toRotationMatrix();
}

/// The core's farthest point, and the rounding radius beyond it.
Vec3 farthestOfPiece(const engine::TreeView& tree, const engine::Piece& piece, const Vec3& u, double length) {
  const Vec3 p = baseline::supportPoint(tree, piece, u);
  return piece.radius > 0 ? p + u * (piece.radius / length) : p;
}

}  // namespace

MovingWorld::MovingWorld(const World& world, const Motion& motion) : world_(world), motion_(motion) {
  for (const Body& body : world.bodies) in_frame_.push_back(poseOf(body.pose));
  for (const Frame& frame : world.frames) origins_.push_back(poseOf(frame.origin));
  const Eigen::MatrixXd& c = motion.coefficients;
  for (Eigen::Index v = 0; v < c.rows(); ++v) {
    double first = 0, second = 0;
    for (Eigen::Index k = 1; k < c.cols(); ++k) {
      first += static_cast<double>(k) * std::abs(c(v, k));
      second += static_cast<double>(k * (k - 1)) * std::abs(c(v, k));
    }
    rate_.push_back(first);
    acceleration_.push_back(second);
  }
}

double MovingWorld::value(int variable, double t) const {
  const Eigen::MatrixXd& c = motion_.coefficients;
  double value = 0;
  for (Eigen::Index k = c.cols() - 1; k >= 0; --k) value = value * t + c(variable, k);
  return value;
}

Pose MovingWorld::pose(const Element& element, double t) const {
  if (element.kind == Element::Kind::rotate) {
    Pose pose;
    pose.R = rotationBy({value(element.variable, t), value(element.variable + 1, t), value(element.variable + 2, t)});
    const auto& list = world_.orientations;
    const auto given = std::find(list.begin(), list.end(), element.variable);
    if (given != list.end()) pose.R *= motion_.orientations[static_cast<std::size_t>(given - list.begin())];
    return pose;
  }
  const double q = element.multiplier * value(element.variable, t) + element.offset;
  if (element.kind == Element::Kind::slide) return {Matrix3d::Identity(), q * element.axis};
  return {Eigen::AngleAxisd(q, element.axis).toRotationMatrix(), Vector3d::Zero()};
}

MovingWorld::Moment& MovingWorld::moment(double t) {
  const auto [it, is_new] = moments_.try_emplace(t);
  Moment& moment = it->second;
  if (!is_new) return moment;
  std::vector<Pose>& poses = moment.frames;
  poses.resize(world_.frames.size());
  moment.places.resize(world_.frames.size());
  for (std::size_t f = 1; f < poses.size(); ++f) {
    const Frame& frame = world_.frames[f];
    poses[f] = poses[static_cast<std::size_t>(frame.parent)] * origins_[f];
    auto give = frame.gives.begin();
    const auto notePlaces = [&](int element) {
      for (; give != frame.gives.end() && give->element == element; ++give) moment.places[f].push_back(poses[f]);
    };
    notePlaces(-1);
    for (std::size_t k = 0; k < frame.elements.size(); ++k) {
      poses[f] = poses[f] * pose(frame.elements[k], t);
      notePlaces(static_cast<int>(k));
    }
  }
  return moment;
}

const Pose& MovingWorld::pose(int body, int frame, double t) {
  const auto i = static_cast<std::size_t>(body);
  const int own = world_.bodies[i].frame;
  if (own == frame) return in_frame_[i];
  Moment& at = moment(t);
  const auto [it, is_new] = at.bodies.try_emplace({body, frame});
  if (!is_new) return it->second;
  const Pose in_world = at.frames[static_cast<std::size_t>(own)] * in_frame_[i];
  return it->second = frame == 0 ? in_world : at.frames[static_cast<std::size_t>(frame)].inverse() * in_world;
}

/// Bound over the joints between the two frames. The point x turns about each joint at a rate w, r away from it, so
/// |x''| <= (sum w)^2 max r + ..., which is at most 2 (sum w)(sum w r + sum of slides' rates) + sum |q''| r.
double MovingWorld::acceleration(int body, int frame, double t) {
  const std::vector<Pose>& poses = moment(t).frames;
  const auto i = static_cast<std::size_t>(body);
  const Vector3d centre = (poses[static_cast<std::size_t>(world_.bodies[i].frame)] * in_frame_[i]).c;
  const double radius = geometry(body).radius;
  double turning = 0, speed = 0, own = 0;
  int a = world_.bodies[i].frame, b = frame;
  while (a != b) {
    int& deeper = a > b ? a : b;  // parents have lower numbers
    const Frame& f = world_.frames[static_cast<std::size_t>(deeper)];
    for (const Element& element : f.elements) {
      const bool rotate = element.kind == Element::Kind::rotate;
      double rate = 0, second = 0;
      for (std::size_t k = 0; k < (rotate ? 3u : 1u); ++k) {
        const std::size_t v = static_cast<std::size_t>(element.variable) + k;
        rate += rate_[v];
        second += acceleration_[v];
      }
      rate *= std::abs(element.multiplier);
      second *= std::abs(element.multiplier);
      if (element.kind == Element::Kind::slide) {
        speed += rate;
        own += second;
        continue;
      }
      const double lever = (poses[static_cast<std::size_t>(deeper)].c - centre).norm() + radius;
      turning += rate;
      speed += rate * lever;
      own += (second + (rotate ? rate * rate : 0)) * lever;
    }
    deeper = f.parent;
  }
  return 2 * turning * speed + own;
}

std::vector<MovingWorld::Place> MovingWorld::placesBetween(int a, int b) const {
  std::vector<Place> up, down;
  const auto addOwn = [&](int i, std::vector<Place>& list) {
    if (!body(i).gives.empty()) list.push_back({-1, 0, i});
  };
  addOwn(a, up);
  addOwn(b, down);
  int f = body(a).frame, g = body(b).frame;
  while (f != g) {
    int& deeper = f > g ? f : g;  // parents have lower numbers
    const Frame& frame = world_.frames[static_cast<std::size_t>(deeper)];
    for (std::size_t k = frame.gives.size(); k-- > 0;) (f > g ? up : down).push_back({deeper, static_cast<int>(k), -1});
    deeper = frame.parent;
  }
  up.insert(up.end(), down.rbegin(), down.rend());
  return up;
}

double MovingWorld::moveAt(const Place& place, int i, std::int32_t node, double t) {
  const Give& give =
      place.frame < 0
          ? body(place.body).gives[0]
          : world_.frames[static_cast<std::size_t>(place.frame)].gives[static_cast<std::size_t>(place.give)];
  if (give.chord == 0) return give.slide;
  if (geometry(i).unbounded) return std::numeric_limits<double>::infinity();
  Moment& at = moment(t);
  const auto [it, is_new] =
      at.moves.try_emplace({i, node, place.frame < 0 ? -1 - place.body : place.frame, place.give});
  if (!is_new) return it->second;
  const auto inWorld = [&](int k) {
    return at.frames[static_cast<std::size_t>(body(k).frame)] * in_frame_[static_cast<std::size_t>(k)];
  };
  const Pose there = place.frame < 0
                         ? inWorld(place.body)
                         : at.places[static_cast<std::size_t>(place.frame)][static_cast<std::size_t>(place.give)];
  const Pose seen = inWorld(i).inverse() * there;
  const Vector3d point = give.axis ? seen.c : Vector3d(seen.R * give.at + seen.c);
  const Vector3d axis = give.axis ? Vector3d(seen.R * give.at) : Vector3d(Vector3d::Zero());
  return it->second = give.slide + give.chord * largestDistance(geometry(i), node, point, axis);
}

double MovingWorld::wayOf(int i, double t) const {
  const ObjectSpeed& speed = body(i).speed;
  if (speed.speed == 0) return 0;
  const double now = motion_.clock_begin + t * (motion_.clock_end - motion_.clock_begin);
  return speed.speed * std::max(0.0, now - speed.since);
}

double MovingWorld::stray(int a, std::int32_t node_a, int b, std::int32_t node_b, double t) {
  if (!world_.tolerant) return 0;
  const std::vector<Place> places = placesBetween(a, b);
  // Seen from the k-th place on: A moves at those before it, B at the others.
  double least = std::numeric_limits<double>::infinity();
  std::vector<double> of_b;
  for (const Place& place : places) of_b.push_back(moveAt(place, b, node_b, t));
  double own = 0;
  for (std::size_t k = 0; k <= places.size(); ++k) {
    double sum = own;  // summed anew: infinite ones can't be subtracted
    for (std::size_t j = k; j < places.size(); ++j) sum += of_b[j];
    least = std::min(least, sum);
    if (k < places.size()) own += moveAt(places[k], a, node_a, t);
  }
  return least + wayOf(a, t) + wayOf(b, t);
}

double MovingWorld::stray(int i, std::int32_t node, double t) {
  if (!world_.tolerant) return 0;
  double sum = ownStray(i, node) + wayOf(i, t);
  for (int f = body(i).frame; f > 0; f = world_.frames[static_cast<std::size_t>(f)].parent) {
    const std::size_t count = world_.frames[static_cast<std::size_t>(f)].gives.size();
    for (std::size_t k = 0; k < count; ++k) sum += moveAt({f, static_cast<int>(k), -1}, i, node, t);
  }
  return sum;
}

double MovingWorld::ownStray(int i, std::int32_t node) {
  return body(i).gives.empty() ? 0 : moveAt({-1, 0, i}, i, node, 0);
}

namespace {

/// f(point, radius) of points that, with balls around them, hold the piece: for a distance, which is convex.
template <class F>
void forEachEnd(const engine::TreeView& tree, const engine::Piece& piece, const F& f) {
  const double* const e = piece.size;
  const Vector3d centre = Vector3d::Map(piece.center);
  switch (piece.kind) {
    case engine::PieceKind::vertices:
      for (int i = 0; i < piece.num_vertices; ++i)
        f(Vector3d::Map(baseline::VerticesKind::points(tree, piece) + 3 * i), piece.radius);
      break;
    case engine::PieceKind::hull:
      for (int i = 0; i < piece.num_vertices; ++i) {
        const Vec3 v = baseline::HullKind::vertex(tree, piece, i);
        f(Vector3d(v[0], v[1], v[2]), piece.radius);
      }
      break;
    case engine::PieceKind::box:
      for (unsigned c = 0; c < 8; ++c)
        f(Vector3d(centre + Vector3d(c & 1 ? e[0] : -e[0], c & 2 ? e[1] : -e[1], c & 4 ? e[2] : -e[2])), piece.radius);
      break;
    case engine::PieceKind::point:
      f(centre, piece.radius);
      break;
    case engine::PieceKind::ellipsoid:
      f(centre, std::max({e[0], e[1], e[2]}));
      break;
    case engine::PieceKind::segment:
    case engine::PieceKind::cylinder:
    case engine::PieceKind::cone:
      for (const double z : {-e[2], e[2]}) {
        const bool disc = piece.kind == engine::PieceKind::cylinder || (piece.kind == engine::PieceKind::cone && z < 0);
        f(Vector3d(centre + Vector3d(0, 0, z)), piece.kind == engine::PieceKind::segment ? piece.radius
                                                : disc                                   ? e[0]
                                                                                         : 0);
      }
      break;
    case engine::PieceKind::halfspace:
    case engine::PieceKind::plane:
      f(centre, std::numeric_limits<double>::infinity());
      break;
  }
}

}  // namespace

double largestDistance(const Geometry& geometry, std::int32_t node, const Vector3d& point, const Vector3d& axis) {
  const engine::TreeView& tree = geometry.shape->view();
  const auto distance = [&](const Vector3d& x) {
    const Vector3d d = x - point;
    return (d - axis * axis.dot(d)).norm();
  };
  const auto upper = [&](const engine::Node& n) {
    const Vector3d lo(n.lo[0], n.lo[1], n.lo[2]), hi(n.hi[0], n.hi[1], n.hi[2]);
    return distance(0.5 * (lo + hi)) + 0.5 * (hi - lo).norm();
  };
  double most = 0;
  struct Open {
    std::int32_t node;
    double upper;
  };
  Open stack[64];  // the tree is balanced
  int open = 0;
  stack[open++] = {node, std::numeric_limits<double>::infinity()};
  while (open > 0) {
    const Open next = stack[--open];
    if (next.upper <= most) continue;
    const engine::Node& n = tree.nodes[next.node];
    if (n.isLeaf()) {
      forEachEnd(tree, tree.pieces[n.piece()],
                 [&](const Vector3d& x, double radius) { most = std::max(most, distance(x) + radius); });
      continue;
    }
    Open left = {n.left(), upper(tree.nodes[n.left()])}, right = {n.right(), upper(tree.nodes[n.right()])};
    if (left.upper > right.upper) std::swap(left, right);
    stack[open++] = left;
    stack[open++] = right;
  }
  return most;
}

Vector3d farthest(const Geometry& geometry, std::int32_t node, const Vector3d& u, bool exact) {
  const engine::TreeView& tree = geometry.shape->view();
  const Vec3 d(u[0], u[1], u[2]);
  const double length = u.norm();
  if (node == 0 && !exact && tree.outer) {
    const Vec3 p = farthestOfPiece(tree, *tree.outer, d, length);
    return {p[0], p[1], p[2]};
  }
  Vec3 best(0, 0, 0);
  double most = -baseline::kInfinite;
  const auto upper = [&](const engine::Node& n) {
    double value = 0;
    for (int k = 0; k < 3; ++k)
      value += d[k] < 0 ? d[k] * static_cast<double>(n.lo[k]) : d[k] * static_cast<double>(n.hi[k]);
    return value;
  };
  struct Open {
    std::int32_t node;
    double upper;
  };
  Open stack[64];  // the tree is balanced
  int open = 0;
  stack[open++] = {node, baseline::kInfinite};
  while (open > 0) {
    const Open next = stack[--open];
    if (next.upper <= most) continue;
    const engine::Node& n = tree.nodes[next.node];
    if (n.isLeaf()) {
      const Vec3 p = farthestOfPiece(tree, tree.pieces[n.piece()], d, length);
      const double value = dot(d, p);
      if (value > most) {
        most = value;
        best = p;
      }
      continue;
    }
    Open left = {n.left(), upper(tree.nodes[n.left()])}, right = {n.right(), upper(tree.nodes[n.right()])};
    if (left.upper > right.upper) std::swap(left, right);
    stack[open++] = left;
    stack[open++] = right;
  }
  return {best[0], best[1], best[2]};
}

}  // namespace fcl_artic::certificate
