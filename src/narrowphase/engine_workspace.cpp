// SPDX-License-Identifier: BSD-3-Clause
#include "narrowphase/engine_workspace.h"

#include <algorithm>

#include <Eigen/Core>

#include "model/bracket.h"
#include "narrowphase/elementary.h"
#include "narrowphase/least_depth.h"
#include "numerics/assertion.h"
#include "numerics/baseline_isa.h"

#include "convex/cloud.h"
#include "convex/contact_proof.h"

namespace fcl_artic {
namespace engine {
namespace {

using Eigen::Vector3d;
using Rotation = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

constexpr int kMaxIterations = 256;
/// Least distance, as a part of the size, between points whose direction is sharp: rounding, some 1e-16 of the size,
/// turns it by 1e-6 rad at most.
constexpr double kSharp = 1e-10;

/// Null: the contact names none.
const Piece* pieceOf(const Problem& problem, std::int32_t body, std::int32_t piece, baseline::PieceRoom& room) {
  return piece < 0 ? nullptr : &baseline::pieceOf(*problem.bodies[body].tree, piece, room);
}

/// Removes contacts that are later than a proven one, and puts the others in order.
void orderContacts(double t_upper, std::vector<LeafContact>& contacts) {
  const auto later = [&](const LeafContact& contact) { return contact.t_lower > t_upper; };
  contacts.erase(std::remove_if(contacts.begin(), contacts.end(), later), contacts.end());
  std::stable_sort(contacts.begin(), contacts.end(), comesBefore);
}

Vector3d middleOf(const Node& node) {
  return 0.5 * (Eigen::Vector3f::Map(node.lo) + Eigen::Vector3f::Map(node.hi)).cast<double>();
}

/// From the middle of A's body to that of B's.
Vector3d betweenMiddles(const baseline::DifferenceBody& body) {
  const Vector3d a = middleOf(body.tree_a->nodes[0]), b = middleOf(body.tree_b->nodes[0]);
  return Vector3d::Map(body.place(baseline::Vec3(b.data())).k) - a;
}

/// The nearest points at t_lower of a half-space or plane and a bounded piece, unless these overlap.
void nearestToWall(const baseline::DifferenceBody& body, LeafContact& contact) {
  const double radii = body.a->radius + body.b->radius;
  baseline::GjkResult found;
  baseline::unboundedGap(body, radii, found);
  if (found.overlap) return;
  baseline::DifferencePoint lowest;
  body.support(found.n, lowest);
  const baseline::Vec3 gap = found.n * (found.lower - radii);
  const baseline::Vec3 a = baseline::unbounded(*body.b) ? lowest.a + found.n * body.a->radius
                                                        : body.place(lowest.b) - found.n * body.b->radius - gap;
  a.store(contact.nearest_a);
  (a + gap).store(contact.nearest_b);
  contact.t_nearest = contact.t_lower;
}

/// The normal of bounded pieces that overlap from the start, if no features have given it.
/// @param towards  from A's body to B's.
void leastDepth(const baseline::DifferenceBody& body, const Vector3d& towards, LeafContact& contact) {
  if (contact.feature >= 0 || contact.t_lower > 0) return;
  const auto lowest = [&](const Vector3d& n) -> Vector3d {
    baseline::DifferencePoint point;
    body.support(baseline::Vec3(n.data()), point);
    return Vector3d::Map(point.w.k);
  };
  // If the pieces' cores (without their radii) are apart by more than rounding, the normal is the direction between
  // their nearest points.
  baseline::GjkResult cores;
  baseline::gjk<true>(body, baseline::Vec3(contact.normal), {1e-6, 0, kMaxIterations}, cores);
  if (!cores.overlap) cores.n.store(contact.normal);
  const double size = baseline::norm(body.pose.c) + towards.norm();
  if (!cores.overlap && cores.lower > kSharp * size) return;
  Vector3d::Map(contact.normal) = LeastDepth(lowest, Vector3d(Vector3d::Map(contact.normal)), towards).direction();
}

/// The nearest points at t_lower of two bounded pieces. Where no features have given the normal, it becomes the
/// direction along which the search sees most of this gap. The solver's last direction is a worse normal: it was found
/// for the solver's own steps.
void nearestPoints(const baseline::DifferenceBody& body, const Vector3d& towards, LeafContact& contact) {
  baseline::GjkResult found;
  const double radii = body.a->radius + body.b->radius;
  baseline::gjk<true>(body, baseline::Vec3(contact.normal), {1e-6, radii, kMaxIterations}, found);
  if (found.overlap) return leastDepth(body, towards, contact);
  baseline::originWeights(found.simplex);
  baseline::Vec3 a, b;
  baseline::combine(body, found.simplex, a, b);
  const double size = baseline::norm(a) + baseline::norm(b), between = baseline::norm(b - a);
  // If the search has not converged, as next to contact of curved surfaces, no nearest points are reported: the contact
  // point stays.
  const double gap = found.lower - radii;
  if (!(between - radii <= 2 * std::max(0.0, gap) + 1e-12 * size)) return;
  const bool sharp = between > kSharp * size;
  const baseline::Vec3 n = sharp ? (b - a) * (1 / between) : found.n;
  (a + n * body.a->radius).store(contact.nearest_a);
  (b - n * body.b->radius).store(contact.nearest_b);
  contact.t_nearest = contact.t_lower;
  if (contact.feature < 0 && sharp) found.n.store(contact.normal);  // along it the gap is seen
}

}  // namespace

void EngineWorkspace::solve(const Problem& problem, const Query& query, Answer& answer) {
  engine_.solve(memory_, problem, query, answer);
  for (std::int32_t i = 0; i < answer.num_contacts; ++i) {
    FCL_ARTIC_ASSERT(answer.contacts[i].t_lower <= answer.contacts[i].t_upper && answer.status != Status::free);
  }
  if (!query.describe_contacts || answer.num_contacts == 0) return;
  contacts_.assign(answer.contacts, answer.contacts + answer.num_contacts);
  for (LeafContact& contact : contacts_) {
    nameFeatures(problem, query, contact);
    addWitness(problem, query, contact);
    if (contact.certain) sharpen(answer, contact.t_upper, query.tolerance_time, query.any);
  }
  if (!query.every_pair && contacts_.size() > 1) orderContacts(answer.t_upper, contacts_);
  answer.contacts = contacts_.data();
  answer.num_contacts = static_cast<std::int32_t>(contacts_.size());
}

PairMotion EngineWorkspace::lookAt(const Problem& problem, PairId pair, double tm, double d) const {
  PairMotion motion = pairMotion(pair, tm, d);
  if (!problem.sweeps[problem.parts(pair).sweep].first_order) return motion;
  // A motion without derivatives has poses only: the velocity is taken between two of them.
  const PairMotion before = pairMotion(pair, tm - d, d), after = pairMotion(pair, tm + d, d);
  Rotation::Map(motion.R[1]) = 0.5 * (Rotation::Map(after.R[0]) - Rotation::Map(before.R[0]));
  Vector3d::Map(motion.c[1]) = 0.5 * (Vector3d::Map(after.c[0]) - Vector3d::Map(before.c[0]));
  return motion;
}

PairMotion EngineWorkspace::pairMotion(PairId pair, double tm, double d) const {
  PairMotion motion;
  engine_.pairMotion(memory_, pair, tm, d, motion);
  return motion;
}

void EngineWorkspace::nameFeatures(const Problem& problem, const Query& query, LeafContact& contact) const {
  static_assert(static_cast<int>(FeatureKind::edgeFace) == kEdgeFace &&
                static_cast<int>(FeatureKind::faceEdge) == kFaceEdge &&
                static_cast<int>(FeatureKind::volume) == kVolume);
  if (contact.feature >= 0 || query.margins.of(contact.pair) > 0 || problem.strays) return;
  baseline::PieceRoom room_a, room_b;
  const Piece *a = pieceOf(problem, contact.body_a, contact.piece_a, room_a),
              *b = pieceOf(problem, contact.body_b, contact.piece_b, room_b);
  if (!a || !b || a->num_vertices != 3 || b->num_vertices != 3) return;
  Vector3d p[3], q[3];
  for (int i = 0; i < 3; ++i) {
    p[i] = Vector3d::Map(problem.bodies[contact.body_a].tree->vertices + 3 * (a->first_vertex + i));
    q[i] = Vector3d::Map(problem.bodies[contact.body_b].tree->vertices + 3 * (b->first_vertex + i));
  }
  const MotionAt motion = [&](double tm, double d, ScalarMotion& out) { out = pairMotion(contact.pair, tm, d); };
  RefinedContact refined;
  const double end = contact.certain ? contact.t_upper : std::min(1.0, contact.t_lower + query.tolerance_time);
  if (!refineTriangleContact(p, q, motion, {contact.t_lower, end, contact.certain}, refined)) return;
  contact.feature = static_cast<std::int32_t>(refined.feature);
  // t_lower stays: before refined.t_lower these two pieces are free, but not all others of their bodies.
  if (refined.certain) {
    contact.certain = true;
    contact.t_upper = refined.t_upper;
  }
  Vector3d::Map(contact.normal) = refined.normal;
  if (contact.certain && !refined.certain) return;  // the solver's own proof stays, with its point
  contact.t = refined.certain ? refined.t_upper : refined.t_lower;
  Vector3d::Map(contact.point) = refined.point;
}

void EngineWorkspace::addWitness(const Problem& problem, const Query& query, LeafContact& contact) const {
  Vector3d::Map(contact.nearest_a) = Vector3d::Map(contact.nearest_b) = Vector3d::Map(contact.point);
  contact.t_nearest = contact.t;
  contact.approach_speed = 0;
  if (query.any) return;

  // One quadratic of the motion, about a time next to t_lower within [0, 1]. Its linear term is the velocity, and over
  // so short a time it is the pose. (This is for reports: nothing is proven with it.)
  constexpr double kSpan = 0x1p-14;
  const double tm = std::min(std::max(contact.t_lower, kSpan), 1 - kSpan), tau = (contact.t_lower - tm) / kSpan;
  const PairMotion motion = lookAt(problem, contact.pair, tm, kSpan);
  const auto quadratic = [&](const auto& x0, const auto& x1, const auto& x2) { return x0 + (x1 + x2 * tau) * tau; };
  baseline::DifferenceBody body;
  body.pose.R = quadratic(baseline::Mat3(motion.R[0]), baseline::Mat3(motion.R[1]), baseline::Mat3(motion.R[2]));
  body.pose.c = quadratic(baseline::Vec3(motion.c[0]), baseline::Vec3(motion.c[1]), baseline::Vec3(motion.c[2]));
  baseline::PieceRoom room_a, room_b;
  body.a = pieceOf(problem, contact.body_a, contact.piece_a, room_a);
  body.b = pieceOf(problem, contact.body_b, contact.piece_b, room_b);
  if (body.a && body.b) {
    body.tree_a = problem.bodies[contact.body_a].tree;
    body.tree_b = problem.bodies[contact.body_b].tree;
    const bool wall_a = baseline::unbounded(*body.a), wall_b = baseline::unbounded(*body.b);
    if (wall_a != wall_b) nearestToWall(body, contact);
    if (!wall_a && !wall_b) nearestPoints(body, betweenMiddles(body), contact);
  }

  const Vector3d point = Vector3d::Map(contact.point), normal = Vector3d::Map(contact.normal);
  const Vector3d of_b =
      Vector3d::Map(baseline::transposedTimes(body.pose.R, baseline::Vec3(point.data()) - body.pose.c).k);
  const auto change = [&](int order) -> Vector3d {
    return Rotation::Map(motion.R[order]) * of_b + Vector3d::Map(motion.c[order]);
  };
  const Vector3d velocity = (change(1) + 2 * tau * change(2)) / kSpan;
  contact.approach_speed = -velocity.dot(normal) / std::max(normal.norm(), 1e-300);
}

}  // namespace engine
}  // namespace fcl_artic
