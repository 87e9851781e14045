// SPDX-License-Identifier: BSD-3-Clause
#include "query/pair_query.h"

#include <algorithm>
#include <cmath>

#include "certificate/certificate.h"
#include "geometry/solid_space.h"
#include "motion/frame_sweep.h"
#include "motion/variables.h"
#include "narrowphase/engine_workspace.h"
#include "numerics/baseline_isa.h"
#include "query/engine_query.h"
#include "query/report.h"

#include "convex/piece_kinds.h"

namespace fcl_artic {
namespace {

using engine::Piece;
using engine::PieceKind;

/// The way from body 1 to body 2: up the one's motion, down the other's.
/// @param[out] query  gets the variables, kept in the workspace.
/// @param[out] pair  gets the placements.
engine::SweepView pathBetween(const BodyMotion& motion1, const BodyMotion& motion2, QueryWorkspace& workspace,
                              engine::Query& query, engine::LinkPair& pair) {
  int degree = 1, variables = 0;
  std::size_t bounded = 0;
  for (const BodyMotion* motion : {&motion1, &motion2}) {
    degree = std::max(degree, degreeOf(*motion));
    variables += numVariables(*motion);
    for (const MotionElement& element : motion->elements) bounded += element.bounded != nullptr;
  }
  workspace.coefficients.assign(static_cast<std::size_t>((degree + 1) * std::max(variables, 1)), 0);
  workspace.sources.clear();
  workspace.sources.reserve(bounded);  // steps point into it
  workspace.sweep.clear();
  Carrier at;
  int variable = 0;
  const auto cross = [&](const MotionElement& element, bool down) {
    const engine::BoundedSource* source = nullptr;
    if (element.bounded) {
      workspace.sources.push_back(boundedSource(*element.bounded));
      source = &workspace.sources.back();
    }
    writeCoefficients(element, variable, variables, degree, workspace.coefficients.data());
    at = workspace.sweep.cross(at, element, variable, source, down);
    variable += numVariables(element);
  };
  for (auto it = motion1.elements.rbegin(); it != motion1.elements.rend(); ++it) cross(*it, false);
  for (const MotionElement& element : motion2.elements) cross(element, true);

  query.coefficients = workspace.coefficients.data();
  query.num_variables = variables;
  query.degree = degree;
  pair.inverse_a = makePlacement(motion1.after.inverse());
  pair.placement_b = makePlacement(at, motion2.after);
  pair.step_b = at.step;
  return workspace.sweep.view();
}

const Piece* unboundedPiece(const ShapeTree& shape) {
  const Piece& piece = shape.view().pieces[0];
  return shape.view().num_pieces == 1 && baseline::unbounded(piece) ? &piece : nullptr;
}

std::shared_ptr<const Certificate> withoutProof(const char* reason) {
  Certificate none;
  none.missing = reason;
  return std::make_shared<const Certificate>(std::move(none));
}

/// Poses at t_lower and t_upper.
void setPoses(const BodyMotion& motion1, const BodyMotion& motion2, CertifiedPairResult& result) {
  result.tf1_at_lower = motion1.pose(result.t_lower);
  result.tf2_at_lower = motion2.pose(result.t_lower);
  const bool same = result.t_lower == result.t_upper;  // so of free pairs
  result.tf1_at_upper = same ? result.tf1_at_lower : motion1.pose(result.t_upper);
  result.tf2_at_upper = same ? result.tf2_at_lower : motion2.pose(result.t_upper);
}

void solveBounded(const MovingShape& body1, const MovingShape& body2, const CertifiedPairRequest& request,
                  CertifiedPairResult& result);

/// Two half-spaces or planes. If their normals are parallel and stay so, the distance of one's boundary from the other
/// is that of any point of this boundary, so a point takes its place. Else the two meet. Normals that stay within
/// rounding of parallel count as parallel: the promise is about the parallel ones next to them (doc/NUMERICS.md,
/// "Unbounded pieces").
void solveUnbounded(const MovingShape& body1, const Piece& piece1, const MovingShape& body2, const Piece& piece2,
                    const CertifiedPairRequest& request, CertifiedPairResult& result) {
  constexpr double kParallel = 64 * 0x1p-52;
  const auto normalOf = [](const Piece& piece) { return UnitVector::within3Ulps(Eigen::Vector3d::Map(piece.size)); };
  const Heading heading1 = headingOf(body1.motion, normalOf(piece1).value());
  const Heading heading2 = headingOf(body2.motion, normalOf(piece2).value());
  const Eigen::Vector3d &n1 = heading1.direction, &n2 = heading2.direction;
  const double askew = n1.cross(n2).norm(), least = kParallel + heading1.author + heading2.author;
  const bool parallel = askew <= least;
  const bool stay_parallel = askew + heading1.deviation + heading2.deviation <= least;
  const bool solids = piece1.kind == PieceKind::halfspace && piece2.kind == PieceKind::halfspace;
  const bool alike = solids && n1.dot(n2) > 0;  // one holds the other, wherever they are
  std::shared_ptr<const Certificate> none;
  if (request.certificate) none = withoutProof("both bodies are unbounded, and no hint fits two of them");
  if (stay_parallel && !alike) {
    const bool keep_first = piece1.kind == PieceKind::halfspace || piece2.kind == PieceKind::plane;
    const Piece& other = keep_first ? piece2 : piece1;
    Piece point;
    point.kind = PieceKind::point;
    for (int k = 0; k < 3; ++k) point.center[k] = other.center[0] * other.size[k];
    const std::shared_ptr<const ShapeTree> shape = ShapeTree::fromPiece(point);
    const MovingShape &stays = keep_first ? body1 : body2, &goes = keep_first ? body2 : body1;
    const MovingShape pointwise{*shape, goes.motion, goes.geometry};
    CertifiedPairRequest bounded = request;
    bounded.certificate = false;  // it would be about the point
    keep_first ? solveBounded(stays, pointwise, bounded, result) : solveBounded(pointwise, stays, bounded, result);
    result.certificate = none;
    return;
  }
  result = CertifiedPairResult();
  result.certificate = none;
  // They never separate if one holds the other all along. Nor do they if they are parallel at single instants at most,
  // as along analytic motions that don't leave them parallel. A bounded motion may stop turning when they are parallel,
  // and then anything may follow: the answer is left open, as a contact that is not certain.
  const bool never_apart = (alike && stay_parallel) || ((!parallel || alike) && heading1.analytic && heading2.analytic);
  result.ignored_initial_contact = request.ignore_initial_contact && never_apart;
  result.never_apart = result.ignored_initial_contact;
  engine::FirstContact first;
  if (!result.ignored_initial_contact) {
    const bool left_open = request.ignore_initial_contact;  // they do touch at the start
    first = {0, (parallel && !alike) || left_open ? engine::kNever : 0};
  }
  static_cast<Bracket&>(result) = engine::bracketOf(first, request.tolerance_time, false);
  setPoses(body1.motion, body2.motion, result);
  if (result.status == Status::free || request.max_contacts == 0) return;
  CertifiedContact contact;
  contact.o1 = body1.geometry;
  contact.o2 = body2.geometry;
  contact.normal = n1;
  contact.point = body1.motion.pose(0) * Eigen::Vector3d(piece1.center[0] * Eigen::Vector3d::Map(piece1.size));
  if (!parallel) {  // a point of both boundaries: the one nearest to the first's own
    const Eigen::Vector3d across = (n2 - n1.dot(n2) * n1).normalized();
    const Eigen::Vector3d p2 =
        body2.motion.pose(0) * Eigen::Vector3d(piece2.center[0] * Eigen::Vector3d::Map(piece2.size));
    contact.point += across * (n2.dot(p2 - contact.point) / n2.dot(across));
  }
  contact.nearest1 = contact.nearest2 = contact.point;
  contact.t_lower = 0;
  contact.t_upper = result.t_upper;
  contact.certain = result.certain;
  result.contacts.push_back(contact);
}

std::shared_ptr<const Certificate> certificateOf(const MovingShape& body1, const MovingShape& body2,
                                                 const CertifiedPairRequest& request, const engine::Answer& answer) {
  const certificate::World world = certificate::makeWorld(body1.shape, body1.motion, body2.shape, body2.motion);
  certificate::Motion motion;
  motion.coefficients = world.moving;
  certificate::claimAnswer(request, answer, motion);
  if (answer.num_ignored > 0) motion.ignored.push_back({0, 1, std::min(1.0, answer.ignored[0].watch_from)});
  certificate::Claim claim{{motion}, 1, std::nullopt};
  if (answer.num_contacts > 0 && answer.contacts[0].certain) {
    const engine::LeafContact& leaf = answer.contacts[0];
    claim.meeting = certificate::Meeting{
        0, leaf.body_a, leaf.body_b, leaf.piece_a, leaf.piece_b, leaf.t_upper, request.tolerance_time};
  }
  return std::make_shared<const Certificate>(certificate::makeCertificate(world, claim));
}

/// At least one of the bodies is bounded.
void solveBounded(const MovingShape& body1, const MovingShape& body2, const CertifiedPairRequest& request,
                  CertifiedPairResult& result) {
  engine::Query query = makeQuery(request);
  query.check_scene = false;
  query.check_self = true;
  query.every_pair = false;
  const WorkspaceLoan workspace;
  engine::Body(&bodies)[2] = workspace->bodies;
  bodies[0].tree = &body1.shape.view();
  bodies[1].tree = &body2.shape.view();
  engine::LinkPair pair;
  pair.a = 0;
  pair.b = 1;
  const engine::SweepView sweep = pathBetween(body1.motion, body2.motion, *workspace, query, pair);
  engine::Problem problem;
  problem.bodies = bodies;
  problem.num_bodies = 2;
  problem.sweeps = &sweep;
  problem.num_sweeps = 1;
  problem.link_pairs = &pair;
  problem.num_link_pairs = 1;
  const MovingShape* shapes[2] = {&body1, &body2};
  if (body1.shape.space() || body2.shape.space()) problem.contained = &findContained;
  for (int i = 0; i < 2; ++i) {
    bodies[i].space = shapes[i]->shape.space();
    bodies[i].points = problem.contained ? shapes[i]->shape.surfacePoints() : nullptr;
  }
  engine::Answer answer;
  RedonStatistics redon_work;
  if (request.method == Method::redon2004) {
    const auto treeOf = [&](std::int32_t body) { return (body == 0 ? body1 : body2).shape.obbTree(); };
    redon::solve(workspace->redon(), workspace->engine, problem, query, request.redon, treeOf, answer, redon_work);
  } else {
    workspace->engine.solve(problem, query, answer);
  }

  static_cast<Bracket&>(result) = answer;
  result.ignored_initial_contact = answer.num_ignored > 0;
  result.never_apart = engine::numNeverApart(answer) > 0;
  result.statistics = statisticsOf(answer.statistics);
  result.statistics.redon = redon_work;
  result.contacts.clear();
  for (std::int32_t i = 0; i < answer.num_contacts; ++i) {
    const engine::LeafContact& leaf = answer.contacts[i];
    const ReportedBody a = {{}, body1.geometry, body1.shape}, b = {{}, body2.geometry, body2.shape};
    result.contacts.push_back(reportContact(leaf, a, b, body1.motion.pose(leaf.t), body1.motion.pose(leaf.t_nearest)));
  }
  setPoses(body1.motion, body2.motion, result);
  result.certificate.reset();
  if (request.certificate) result.certificate = certificateOf(body1, body2, request, answer);
}

}  // namespace

void solvePair(const MovingShape& body1, const MovingShape& body2, const CertifiedPairRequest& request,
               CertifiedPairResult& result) {
  if (!body1.shape.view().num_pieces || !body2.shape.view().num_pieces) {  // an OcTree without an occupied cell
    makeQuery(request);
    result = CertifiedPairResult();
    if (request.certificate) result.certificate = withoutProof("a body is empty: there is nothing to prove");
    result.status = Status::free;
    result.t_lower = 1;
    result.tf1_at_lower = result.tf1_at_upper = body1.motion.pose(1);
    result.tf2_at_lower = result.tf2_at_upper = body2.motion.pose(1);
    return;
  }
  const Piece *piece1 = unboundedPiece(body1.shape), *piece2 = unboundedPiece(body2.shape);
  if (piece1 && piece2) {
    makeQuery(request);  // throws for what it throws
    return solveUnbounded(body1, *piece1, body2, *piece2, request, result);
  }
  solveBounded(body1, body2, request, result);
}

}  // namespace fcl_artic
