// SPDX-License-Identifier: BSD-3-Clause
//
// One query: the motion's variables, the pairs and margins that are asked for, one of the solvers, and the answer as
// users see it.
#include <algorithm>
#include <chrono>
#include <stdexcept>

#include "model/add_fields.h"
#include "motion/half_angles.h"
#include "narrowphase/engine_workspace.h"
#include "query/claim_nothing.h"
#include "query/engine_query.h"
#include "query/manager_impl.h"
#include "query/query_context.h"
#include "query/report.h"
#include "query/tube_witness.h"
#include "visibility/stage.h"

namespace fcl_artic {
namespace {

/// Gives the solver, as its advisor, all knowledge about a motion that the tables of two links have.
struct TableAdvice {
  const LinkTables& tables;
  const ProvenPairs& proven;
  const engine::Problem& problem;
  const JointMotion& motion;
  const VariableStrays strays;
  const engine::Margins& margins;
  QueryWorkspace& workspace;

  engine::Advisor advisor() {
    engine::Advisor advisor;
    advisor.self = this;
    if (!tables.empty()) {
      advisor.freePartsOf = [](void* self, std::int32_t link_pair) {
        const auto& of = *static_cast<TableAdvice*>(self);
        return of.tables.freeParts(of.problem, of.motion, of.strays, of.margins, link_pair);
      };
    }
    if (!proven.empty()) {
      advisor.freeParts = [](void* self) -> const std::uint8_t* {
        const auto& of = *static_cast<TableAdvice*>(self);
        std::vector<std::uint8_t>& parts = of.workspace.link_free;
        parts.assign(static_cast<std::size_t>(of.problem.num_link_pairs), 0);
        of.proven.addFreeParts(of.problem, of.motion, of.strays, of.margins, parts);
        return parts.data();
      };
    }
    advisor.suggest = [](void* self, std::int32_t& count) -> const engine::LikelyContact* {
      const auto& of = *static_cast<TableAdvice*>(self);
      of.tables.likelyContacts(of.motion, of.workspace.likely);
      count = static_cast<std::int32_t>(of.workspace.likely.size());
      return of.workspace.likely.data();
    };
    return advisor;
  }
};

/// Gives the query the motion's variables, then those of the moving obstacles.
/// @param moving  the latter, column k for t^k.
/// @param time  of the obstacles' motions.
/// @param memory  for them, when there are both.
void setVariables(const JointMotion& motion, const Eigen::MatrixXd& moving, const TimePart& time,
                  std::vector<double>& memory, engine::Query& query) {
  const Eigen::MatrixXd& own = motion.variables();
  const Eigen::MatrixXd part = time.whole() ? Eigen::MatrixXd() : partOf(moving, time);
  const Eigen::MatrixXd& others = time.whole() ? moving : part;
  query.coefficients = own.data();
  query.num_variables = static_cast<std::int32_t>(own.rows());
  query.degree = static_cast<std::int32_t>(own.cols()) - 1;
  query.orientations = motion.orientations().data();
  query.half_angles = halfAnglesOf(motion);
  if (others.rows() == 0) return;
  const Eigen::Index columns = std::max(own.cols(), others.cols());
  memory.assign(static_cast<std::size_t>((own.rows() + others.rows()) * columns), 0);
  Eigen::Map<Eigen::MatrixXd> all(memory.data(), own.rows() + others.rows(), columns);
  all.topLeftCorner(own.rows(), own.cols()) = own;
  all.bottomLeftCorner(others.rows(), others.cols()) = others;
  query.coefficients = memory.data();
  query.num_variables = static_cast<std::int32_t>(all.rows());
  query.degree = static_cast<std::int32_t>(columns) - 1;
}

/// Keeps the link pairs that the request asks for. Pairs of a link and a moving obstacle count as the scene's, though
/// they stand in the list of link pairs.
void restrictPairs(const CertifiedRequest& request, const Setup& setup, engine::Problem& problem,
                   engine::Margins& margins) {
  const std::int32_t num_self_pairs = setup.numSelfPairs(), num_self_rows = setup.numSelfRows();
  if (!request.check_scene) {
    problem.num_link_pairs = num_self_pairs;
    problem.num_mover_rows = num_self_rows;
  }
  if (!request.check_self) {
    problem.mover_rows += num_self_rows;
    problem.num_mover_rows -= num_self_rows;
    problem.first_in_rows = num_self_pairs;
    problem.link_pairs += num_self_pairs;
    problem.link_movers += num_self_pairs;
    margins.skipLinkPairs(num_self_pairs);
    problem.num_link_pairs -= num_self_pairs;
  }
}

/// Allows pairs of a problem that is restricted already.
void leaveOut(const std::vector<engine::PairId>& pairs, QueryWorkspace& workspace, engine::Problem& problem) {
  FCL_ARTIC_ASSERT(!problem.link_allowed);
  std::vector<std::uint8_t>&scene = workspace.scene_allowed, &links = workspace.link_allowed;
  scene.assign(static_cast<std::size_t>(problem.num_scene_pairs), 0);
  if (problem.scene_allowed) std::copy_n(problem.scene_allowed, scene.size(), scene.begin());
  links.assign(static_cast<std::size_t>(problem.num_link_pairs), 0);
  for (const engine::PairId pair : pairs) {
    std::uint8_t& allowed = *problem.in(scene.data(), links.data(), pair);
    if (problem.isScenePair(pair)) problem.num_scene_allowed += !allowed;
    allowed = 1;
  }
  problem.scene_allowed = scene.data();
  problem.link_allowed = links.data();
}

/// A solver's answer, and the reports of stage 2 and of the paper's method.
struct Solved {
  engine::Answer answer;
  visibility::Report stage;
  RedonStatistics redon;
};

void solve(const Registry& registry, const VisibilityCuller& culler, const CertifiedRequest& request,
           const engine::Problem& problem, const engine::Query& query, QueryWorkspace& workspace, Solved& solved) {
  const auto treeOf = [&](std::int32_t body) { return registry.body(body).shape->obbTree(); };
  const auto method = [&](const engine::Query& asked, engine::Answer& out) {
    if (request.method == Method::standard) return workspace.engine.solve(problem, asked, out);
    RedonStatistics work;
    redon::solve(workspace.redon(), workspace.engine, problem, asked, request.redon, treeOf, out, work);
    engine::addFields(work, solved.redon);  // of both solves, where there are two
    solved.redon.pairs_by_standard = work.pairs_by_standard;
  };
  if (request.visibility == VisibilityMode::off) return method(query, solved.answer);
  visibility::solve(culler, method, query, solved.answer, solved.stage);
}

/// A contact as users see it, links before obstacles.
/// @param time  of the obstacles' motions.
CertifiedContact report(const Registry& registry, const JointMotion& motion, const TimePart& time,
                        const engine::LeafContact& leaf) {
  const auto poseAt = [&](const ManagedBody& body, double t) -> Eigen::Isometry3d {
    if (body.link < 0) return body.pose(time.at(t));
    return registry.tree()->linkPose(body.link, motion.configuration(t)) * body.offset;
  };
  const auto reported = [&](const ManagedBody& body) -> ReportedBody {
    return {body.reference(), body.geometry.get(), *body.shape};
  };
  const ManagedBody &a = registry.body(leaf.body_a), &b = registry.body(leaf.body_b);
  const Eigen::Isometry3d M_0a = poseAt(a, leaf.t);
  const Eigen::Isometry3d M_0a_nearest = leaf.t_nearest == leaf.t ? M_0a : poseAt(a, leaf.t_nearest);
  const CertifiedContact contact = reportContact(leaf, reported(a), reported(b), M_0a, M_0a_nearest);
  return a.link < 0 ? swapBodies(contact) : contact;
}

/// The solver's work and stage 2's.
QueryStatistics workOf(const Solved& solved) {
  QueryStatistics statistics = statisticsOf(solved.answer.statistics);
  statistics.visibility = solved.stage.work;
  statistics.visibility_executor = solved.stage.executor;
  statistics.visibility_fallback = solved.stage.fallback;
  statistics.redon = solved.redon;
  return statistics;
}

}  // namespace

void ArticulatedCollisionManager::Impl::appendClaim(const JointMotion& motion, const TimePart& time,
                                                    const CertifiedRequest& request, const Bracket& answer,
                                                    const QueryContext::Details& details,
                                                    certificate::Claim& claim) const {
  const std::shared_ptr<const certificate::World> about = world();
  certificate::Motion stated = certificate::motionOf(*about, motion, time);
  certificate::claimAnswer(request, answer, stated);
  stated.self = request.check_self;
  stated.scene = request.check_scene;
  for (const engine::Ignored& pair : details.ignored) {
    const int a = about->bodyOf(pair.body_a), b = about->bodyOf(pair.body_b);
    stated.ignored.push_back({std::min(a, b), std::max(a, b), std::min(1.0, pair.watch_from)});
  }
  if (details.contact) {
    const engine::LeafContact& leaf = *details.contact;
    claim.meeting = certificate::Meeting{static_cast<int>(claim.pieces.size()),
                                         about->bodyOf(leaf.body_a),
                                         about->bodyOf(leaf.body_b),
                                         leaf.piece_a,
                                         leaf.piece_b,
                                         leaf.t_upper,
                                         request.tolerance_time};
  }
  claim.pieces.push_back(std::move(stated));
}

void ArticulatedCollisionManager::Impl::noteBeside(const engine::Answer& answer, const QueryContext& context,
                                                   CertifiedResult& result) const {
  result.never_apart_pairs = engine::numNeverApart(answer);
  result.ignored_initial_contacts.clear();
  for (std::int32_t i = 0; i < answer.num_ignored; ++i) {
    result.ignored_initial_contacts.emplace_back(registry.body(answer.ignored[i].body_a).reference(),
                                                 registry.body(answer.ignored[i].body_b).reference());
  }
  if (context.details) {
    context.details->ignored.assign(answer.ignored, answer.ignored + answer.num_ignored);
    context.details->contact.reset();
    // (With tolerances the motion itself may not touch there, and a certificate names no other.)
    const bool touches = answer.num_contacts > 0 && answer.contacts[0].certain && !setup.strays();
    if (touches) context.details->contact = answer.contacts[0];
  }
  if (context.never_apart) {
    context.never_apart->clear();
    for (std::int32_t i = 0; i < answer.num_ignored; ++i) {
      if (engine::neverApart(answer.ignored[i])) context.never_apart->push_back(answer.ignored[i].pair);
    }
  }
}

void ArticulatedCollisionManager::Impl::finishAnswer(const JointMotion& motion, const CertifiedRequest& request,
                                                     const QueryContext::Details& details,
                                                     CertifiedResult& result) const {
  const JointMotion* const motions[] = {&motion};
  countUnchecked(motions, 1, request, true, result);
  result.certificate.reset();
  if (request.certificate) {
    certificate::Claim claim;
    appendClaim(motion, TimePart(), request, result, details, claim);
    result.certificate = std::make_shared<const Certificate>(certificate::makeCertificate(*world(), claim));
  }
  if (result.contacts.size() > request.max_contacts) result.contacts.resize(request.max_contacts);
}

void ArticulatedCollisionManager::continuousCollide(const JointMotion& motion, const CertifiedRequest& request,
                                                    CertifiedResult& result) const {
  answerOrClaimNothing(result, 0, 1, [&] { collideMotion(motion, request, result); });
}

void ArticulatedCollisionManager::collideMotion(const JointMotion& motion, const CertifiedRequest& request,
                                                CertifiedResult& result) const {
  QueryContext context;
  QueryContext::Details details;
  if (request.certificate) context.details = &details;
  collideMotion(motion, request, context, result);
  impl_->finishAnswer(motion, request, details, result);
}

void ArticulatedCollisionManager::collideMotion(const JointMotion& motion, const CertifiedRequest& request,
                                                const QueryContext& context, CertifiedResult& result) const {
  const Registry& registry = impl_->registry;
  const Setup& setup = impl_->setup;
  const KinematicTree& robot = *registry.tree();
  impl_->requireReady();
  motion.requireOf(robot);
  if (setup.strays() && request.method == Method::redon2004) {
    throw std::invalid_argument(
        "Method::redon2004 does not know tolerances of joints, base or objects; resetTolerances() takes them away");
  }
  if (setup.lags() && request.certificate) {
    throw std::invalid_argument("certificates do not state that obstacles are earlier or later (setTimeTolerance)");
  }
  engine::Query query = makeQuery(request);
  query.check_scene = request.check_scene;
  query.tube = {context.stray_factor, context.clock, setup.lags() ? (1 + 0x1p-50) / context.duration : 0};
  if (context.limit) {
    query.max_contacts = 1;
    query.describe_contacts = false;
  }

  using Clock = std::chrono::steady_clock;
  const auto since = [](Clock::time_point t) {
    return std::chrono::duration<double, std::micro>(Clock::now() - t).count();
  };
  const Clock::time_point begin = request.measure_times ? Clock::now() : Clock::time_point();
  const WorkspaceLoan workspace;
  setVariables(motion, setup.movingCoefficients(), context.time, workspace->coefficients, query);
  engine::Problem problem = setup.problem();
  problem.strays = problem.strays && (context.stray_factor > 0 || setup.moves() || setup.lags());
  const BoundedParts parts(context.time, problem);
  (context.own_margins ? setup.margins() : setup.marginsOfNeighbours()).putInto(query.margins);
  restrictPairs(request, setup, problem, query.margins);
  if (context.left_out && !context.left_out->empty()) leaveOut(*context.left_out, *workspace, problem);
  const VariableStrays variable_strays =
      context.variable_strays ? VariableStrays{context.variable_strays, 1} : setup.variableStrays(context.stray_factor);
  TableAdvice advice{setup.tables(), setup.proven(), problem, motion, variable_strays, query.margins, *workspace};
  if (request.check_self && request.method == Method::standard) query.ask(advice.advisor());
  if (context.may_ignore) {
    query.may_ignore = context.may_ignore->data();
    query.num_may_ignore = static_cast<std::int32_t>(context.may_ignore->size());
  }
  query.check_self = problem.num_link_pairs > 0;
  Solved solved;
  solve(registry, *impl_->culler, request, problem, query, *workspace, solved);
  const engine::Answer& answer = solved.answer;
  const Clock::time_point end = request.measure_times ? Clock::now() : Clock::time_point();

  static_cast<Bracket&>(result) = answer;
  result.contacts.clear();
  if (context.limit) {
    context.limit->reset();
    if (answer.num_contacts > 0) *context.limit = answer.contacts[0];
  }
  for (std::int32_t i = 0; i < answer.num_contacts && !context.limit; ++i) {
    result.contacts.push_back(report(registry, motion, context.time, answer.contacts[i]));
  }
  if (problem.strays && !result.isFree() && !context.limit) {
    findWitnesses({problem, query, motion, context.time}, registry, variable_strays, answer, *workspace, result);
  }
  keepFirstOfEachPair(result.certain, result.contacts);
  result.M_0_at_lower.clear();
  if (!result.isFree() && request.max_contacts > 0)
    robot.forwardKinematics(motion.configuration(answer.t_lower), result.M_0_at_lower);
  impl_->noteBeside(answer, context, result);
  result.statistics = workOf(solved);
  if (request.measure_times) {
    result.statistics.report_us = since(end);
    result.statistics.total_us = since(begin);
  }
}

void ArticulatedCollisionManager::collide(const Eigen::VectorXd& q, const CertifiedRequest& request,
                                          CertifiedResult& result) const {
  answerOrClaimNothing(result, 0, 1, [&] { collideMotion(JointMotion::still(tree(), q), request, result); });
}

CertifiedResult ArticulatedCollisionManager::continuousCollide(const JointMotion& motion,
                                                               const CertifiedRequest& request) const {
  CertifiedResult result;
  continuousCollide(motion, request, result);
  return result;
}

CertifiedResult ArticulatedCollisionManager::continuousCollide(const Eigen::VectorXd& q0, const Eigen::VectorXd& q1,
                                                               const CertifiedRequest& request) const {
  return continuousCollide(JointMotion::linear(tree(), q0, q1), request);
}

bool ArticulatedCollisionManager::isFree(const Eigen::VectorXd& q0, const Eigen::VectorXd& q1,
                                         const CertifiedRequest& request) const {
  return isFree(JointMotion::linear(tree(), q0, q1), request);
}

bool ArticulatedCollisionManager::isFree(const JointMotion& motion, const CertifiedRequest& request) const {
  CertifiedRequest any = request;
  any.mode = ContactMode::any;
  any.max_contacts = 0;
  return continuousCollide(motion, any).isFree();
}

CertifiedResult ArticulatedCollisionManager::collide(const Eigen::VectorXd& q, const CertifiedRequest& request) const {
  CertifiedResult result;
  collide(q, request, result);
  return result;
}

}  // namespace fcl_artic
