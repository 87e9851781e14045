// SPDX-License-Identifier: BSD-3-Clause
#include "query/tube_witness.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "model/bracket.h"
#include "narrowphase/engine_workspace.h"

namespace fcl_artic {
namespace {

/// One pair of bodies at single configurations, at one time of the obstacles' motions.
class PairAtRest {
 public:
  PairAtRest(const AnsweredQuery& asked, engine::PairId pair, engine::EngineWorkspace& workspace)
      : asked_(asked), workspace_(workspace) {
    const engine::PairParts parts = asked.problem.parts(pair);
    pair_.a = parts.a;
    pair_.b = parts.b;
    pair_.sweep = parts.sweep;
    pair_.step_b = parts.step_b;
    pair_.inverse_a = *parts.inverse_a;
    pair_.placement_b = *parts.placement_b;
    problem_.bodies = asked.problem.bodies;
    problem_.num_bodies = asked.problem.num_bodies;
    problem_.sweeps = asked.problem.sweeps;
    problem_.num_sweeps = asked.problem.num_sweeps;
    problem_.link_pairs = &pair_;
    problem_.num_link_pairs = 1;
    problem_.contained = asked.problem.contained;
    query_.tolerance_time = asked.query.tolerance_time;
    query_.tolerance_distance = asked.query.tolerance_distance;
    query_.margins = engine::Margins(asked.query.margins.of(pair));
    query_.check_scene = false;
    query_.any = true;
    query_.describe_contacts = false;
    query_.num_variables = asked.query.num_variables;
    variables_.assign(2 * static_cast<std::size_t>(query_.num_variables), 0);
    query_.coefficients = variables_.data();
  }

  /// Whether contact is certain at q, where the obstacles are at time t.
  bool touchesAt(double t, const Eigen::VectorXd& q, const KinematicTree& tree) {
    const std::ptrdiff_t n = query_.num_variables;
    for (std::ptrdiff_t v = 0; v < n; ++v) {
      double value = 0;
      for (std::ptrdiff_t k = asked_.query.degree; k >= 0; --k)
        value = value * t + asked_.query.coefficients[k * n + v];
      variables_[static_cast<std::size_t>(v)] = value;
    }
    const JointMotion still = JointMotion::still(tree, q);
    std::copy_n(still.variables().data(), still.variables().rows(), variables_.data());
    query_.orientations = still.orientations().data();
    engine::Answer answer;
    workspace_.solve(problem_, query_, answer);
    return answer.status == Status::contact && answer.certain;
  }

 private:
  const AnsweredQuery& asked_;
  engine::EngineWorkspace& workspace_;
  engine::LinkPair pair_;
  engine::Problem problem_;
  engine::Query query_;
  std::vector<double> variables_;
};

/// Two points, fixed to the bodies of a contact, and a direction fixed to body 1, as they are at one configuration.
class PointsOfContact {
 public:
  /// @param q  at which the contact's point and normal are.
  PointsOfContact(const KinematicTree& tree, const CertifiedContact& contact, const Eigen::VectorXd& q)
      : tree_(tree), links_{contact.body1.link, contact.body2.link} {
    for (int i = 0; i < 2; ++i) points_[i] = poseOf(i, q).inverse() * contact.point;
    normal_ = poseOf(0, q).linear().transpose() * contact.normal;
  }
  /// Sets the contact's point and normal to where they are at q.
  void place(const Eigen::VectorXd& q, CertifiedContact& contact) const {
    contact.point = poseOf(1, q) * points_[1];
    contact.normal = poseOf(0, q).linear() * normal_;
  }
  /// The configuration within the joints' strays about q at which the points are nearest along the direction, to first
  /// order.
  Eigen::VectorXd nearest(const VariableStrays& strays, const Eigen::VectorXd& q) const {
    const Eigen::Vector3d n = poseOf(0, q).linear() * normal_;
    const auto gap = [&](const Eigen::VectorXd& at) {
      return n.dot(poseOf(1, at) * points_[1] - poseOf(0, at) * points_[0]);
    };
    Eigen::VectorXd found = q;
    for (int v = 0; v < tree_.dof(); ++v) {
      const double stray = strays.of(v);
      if (!(stray > 0) || !std::isfinite(stray)) continue;
      Eigen::VectorXd less = q, more = q;
      less[v] -= stray;
      more[v] += stray;
      const double by_less = gap(less), by_more = gap(more);
      if (by_less == by_more) continue;
      found[v] = by_less < by_more ? less[v] : more[v];
      if (std::abs(found[v] - q[v]) > stray) found[v] = q[v] + (found[v] - q[v]) * (1 - 0x1p-50);  // it was rounded
      if (std::abs(found[v] - q[v]) > stray) found[v] = q[v];
    }
    return found;
  }

 private:
  Eigen::Isometry3d poseOf(int body, const Eigen::VectorXd& q) const {
    return links_[body] < 0 ? Eigen::Isometry3d::Identity() : tree_.linkPose(links_[body], q);
  }

  const KinematicTree& tree_;
  LinkId links_[2];
  Eigen::Vector3d points_[2], normal_;
};

/// When a witness is looked for: from the contact on, ever later.
constexpr double kLater[] = {0, 0x1p-16, 0x1p-13, 0x1p-11, 0x1p-9, 0x1p-8, 0x1p-7, 0x1p-6, 0x1p-5, 0x1p-4, 0x1p-3, 1};

}  // namespace

void findWitnesses(const AnsweredQuery& asked, const Registry& registry, const VariableStrays& strays,
                   const engine::Answer& answer, QueryWorkspace& workspace, CertifiedResult& result) {
  const KinematicTree& tree = *registry.tree();
  // The engine's memory has the answer, which is read from here on: what it holds is copied first.
  const std::vector<engine::LeafContact> leaves(answer.contacts, answer.contacts + answer.num_contacts);
  double proven = engine::kNever;
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    CertifiedContact& contact = result.contacts[i];
    if (contact.certain) {
      const engine::LeafContact& leaf = leaves[i];
      contact.certain = false;
      // The obstacles' motions of unknown kind are known at their own times only, and not as variables.
      const bool known = !asked.problem.sweeps[asked.problem.parts(leaf.pair).sweep].local_bounds;
      const PointsOfContact points(tree, contact, asked.motion.configuration(leaf.t));
      PairAtRest pair(asked, leaf.pair, workspace.engine);
      for (const double later : kLater) {
        const double t = std::min(1.0, leaf.t_upper + later);
        const Eigen::VectorXd q = asked.motion.configuration(t);
        const Eigen::VectorXd nearest = points.nearest(strays, q);
        for (const Eigen::VectorXd* at : {&q, &nearest}) {
          if (!known || contact.certain || !pair.touchesAt(t, *at, tree)) continue;
          contact.certain = true;
          contact.q_witness = *at;
          contact.t_upper = t;
          points.place(*at, contact);
        }
        if (contact.certain || t == 1) break;
      }
      if (contact.certain) proven = std::min(proven, contact.t_upper);
    }
    if (!contact.certain) contact.t_upper = 1;
  }
  result.t_upper = std::min(proven, 1.0);
  result.certain = proven <= 1;
}

}  // namespace fcl_artic
