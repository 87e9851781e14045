// SPDX-License-Identifier: BSD-3-Clause
#include "narrowphase/engine_workspace.h"

#include <algorithm>

#include <Eigen/Core>

#include "model/bracket.h"
#include "narrowphase/elementary.h"
#include "numerics/assertion.h"
#include "numerics/baseline_isa.h"

#include "convex/contact_proof.h"

namespace fcl_artic {
namespace engine {
namespace {

using Eigen::Vector3d;
using Rotation = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

const Piece* pieceOf(const Problem& problem, std::int32_t body, std::int32_t piece) {
  return piece < 0 ? nullptr : problem.bodies[body].tree->pieces + piece;
}

/// Those that are later than a proven one go, the others are put in order.
void orderContacts(double t_upper, std::vector<LeafContact>& contacts) {
  const auto later = [&](const LeafContact& contact) { return contact.t_lower > t_upper; };
  contacts.erase(std::remove_if(contacts.begin(), contacts.end(), later), contacts.end());
  std::stable_sort(contacts.begin(), contacts.end(), comesBefore);
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

PairMotion EngineWorkspace::pairMotion(PairId pair, double tm, double d) const {
  PairMotion motion;
  engine_.pairMotion(memory_, pair, tm, d, motion);
  return motion;
}

void EngineWorkspace::nameFeatures(const Problem& problem, const Query& query, LeafContact& contact) const {
  static_assert(static_cast<int>(FeatureKind::edgeFace) == kEdgeFace &&
                static_cast<int>(FeatureKind::faceEdge) == kFaceEdge &&
                static_cast<int>(FeatureKind::volume) == kVolume);
  if (contact.feature >= 0 || query.margins.of(contact.pair) > 0) return;
  const Piece *a = pieceOf(problem, contact.body_a, contact.piece_a),
              *b = pieceOf(problem, contact.body_b, contact.piece_b);
  if (!a || !b || a->num_vertices != 3 || b->num_vertices != 3) return;
  Vector3d p[3], q[3];
  for (int i = 0; i < 3; ++i) {
    p[i] = Vector3d::Map(problem.bodies[contact.body_a].tree->vertices + 3 * (a->first_vertex + i));
    q[i] = Vector3d::Map(problem.bodies[contact.body_b].tree->vertices + 3 * (b->first_vertex + i));
  }
  const MotionAt motion = [&](double tm, double d, ScalarMotion& out) { out = pairMotion(contact.pair, tm, d); };
  RefinedContact refined;
  const double end = contact.certain ? contact.t_upper : std::min(1.0, contact.t_lower + query.tolerance_time);
  if (!refineTriangleContact(p, q, motion, contact.t_lower, end, refined)) return;
  contact.feature = static_cast<std::int32_t>(refined.feature);
  // t_lower stays: before refined.t_lower these two pieces are free, but not all others of their bodies.
  if (refined.certain) {
    contact.certain = true;
    contact.t_upper = refined.t_upper;
  }
  contact.t = refined.certain ? refined.t_upper : refined.t_lower;
  Vector3d::Map(contact.point) = refined.point;
  Vector3d::Map(contact.normal) = refined.normal;
}

void EngineWorkspace::addWitness(const Problem& problem, const Query& query, LeafContact& contact) const {
  const Vector3d point = Vector3d::Map(contact.point), normal = Vector3d::Map(contact.normal);
  Vector3d::Map(contact.nearest_a) = Vector3d::Map(contact.nearest_b) = point;
  contact.t_nearest = contact.t;
  contact.approach_speed = 0;
  if (query.any) return;

  // One look at the motion, about a time next to t_lower within [0, 1]: its linear term is the velocity, and over so
  // short a time the quadratic is the pose. (A report: nothing is proven with it.)
  constexpr double kSpan = 0x1p-14;
  const double tm = std::min(std::max(contact.t_lower, kSpan), 1 - kSpan), tau = (contact.t_lower - tm) / kSpan;
  const PairMotion motion = pairMotion(contact.pair, tm, kSpan);
  const auto quadratic = [&](const auto& x0, const auto& x1, const auto& x2) { return x0 + (x1 + x2 * tau) * tau; };
  baseline::DifferenceBody body;
  body.pose.R = quadratic(baseline::Mat3(motion.R[0]), baseline::Mat3(motion.R[1]), baseline::Mat3(motion.R[2]));
  body.pose.c = quadratic(baseline::Vec3(motion.c[0]), baseline::Vec3(motion.c[1]), baseline::Vec3(motion.c[2]));
  const Vector3d of_b =
      Vector3d::Map(baseline::transposedTimes(body.pose.R, baseline::Vec3(contact.point) - body.pose.c).k);
  const auto change = [&](int order) -> Vector3d {
    return Rotation::Map(motion.R[order]) * of_b + Vector3d::Map(motion.c[order]);
  };
  const Vector3d velocity = (change(1) + 2 * tau * change(2)) / kSpan;
  contact.approach_speed = -velocity.dot(normal) / std::max(normal.norm(), 1e-300);

  body.a = pieceOf(problem, contact.body_a, contact.piece_a);
  body.b = pieceOf(problem, contact.body_b, contact.piece_b);
  if (!body.a || !body.b || baseline::unbounded(*body.a) || baseline::unbounded(*body.b)) return;
  body.tree_a = problem.bodies[contact.body_a].tree;
  body.tree_b = problem.bodies[contact.body_b].tree;
  baseline::GjkResult found;
  constexpr int kMostIterations = 64;
  baseline::gjk(body, baseline::Vec3(contact.normal), 1e-6, body.a->radius + body.b->radius, kMostIterations, found);
  if (found.overlap) return;
  baseline::originWeights(found.simplex);
  baseline::Vec3 a, b;
  baseline::combine(body, found.simplex, a, b);
  (a + found.n * body.a->radius).store(contact.nearest_a);
  (b - found.n * body.b->radius).store(contact.nearest_b);
  contact.t_nearest = contact.t_lower;
}

}  // namespace engine
}  // namespace fcl_artic
