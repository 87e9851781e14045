// SPDX-License-Identifier: BSD-3-Clause
#include "query/tube_witness.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "model/bracket.h"
#include "motion/frame_sweep.h"
#include "narrowphase/engine_workspace.h"
#include "numerics/constants.h"
#include "numerics/rotation.h"

namespace fcl_artic {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

/// A place in the tube: joints, and by what the base and both bodies of a contact are off.
struct Place {
  Eigen::VectorXd q;
  RigidTransform base;    ///< in the world: it moves all of the robot
  RigidTransform own[2];  ///< of body 1 and body 2, each in its geometry's frame
};

/// Which of a pair's A and B is body 1 of a contact, and which body 2: links come before obstacles.
struct Order {
  int of_a, of_b;  ///< 0 or 1
};
Order orderOf(const ManagedBody& a) {
  return a.link < 0 ? Order{1, 0} : Order{0, 1};
}

bool isNone(const RigidTransform& deviation) {
  return isIdentity(deviation.isometry());
}

/// The transform of a placement, with its error.
RigidTransform transformOf(const engine::Placement& placement) {
  using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  Isometry3d M = Isometry3d::Identity();
  M.linear() = Eigen::Map<const RowMajor>(placement.R);
  M.translation() = Vector3d::Map(placement.t);
  return RigidTransform::product(M, placement.ulps, placement.length);
}

/// One pair of bodies at single places, at one time of the obstacles' motions.
class PairAtRest {
 public:
  PairAtRest(const AnsweredQuery& asked, const Registry& registry, engine::PairId pair,
             engine::EngineWorkspace& workspace)
      : asked_(asked), parts_(asked.problem.parts(pair)), a_(registry.body(parts_.a)), workspace_(workspace) {
    pair_.a = parts_.a;
    pair_.b = parts_.b;
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

  /// Whether contact is certain at a place, where the obstacles are at time t.
  bool touchesAt(double t, const Place& place, const KinematicTree& tree) {
    setPair(t, place);
    const JointMotion still = JointMotion::still(tree, place.q);
    std::copy_n(still.variables().data(), still.variables().rows(), variables_.data());
    query_.orientations = still.orientations().data();
    engine::Answer answer;
    workspace_.solve(problem_, query_, answer);
    return answer.status == Status::contact && answer.certain;
  }

 private:
  void setPair(double t, const Place& place) {
    pair_.sweep = parts_.sweep;
    pair_.step_b = parts_.step_b;
    pair_.inverse_a = *parts_.inverse_a;
    pair_.placement_b = *parts_.placement_b;
    const Order order = orderOf(a_);
    const RigidTransform &own_a = place.own[order.of_a], &own_b = place.own[order.of_b];
    if (a_.link < 0) {
      // Whatever the obstacle does, at one time it stands still, and the link is seen from the world.
      const engine::Body& link = asked_.problem.bodies[parts_.b];
      const RigidTransform M_0a = a_.moving ? a_.motion.poseWithError(asked_.time.at(t)) : a_.offset;
      pair_.sweep = 0;
      pair_.step_b = link.step;
      pair_.placement_b = link.placement;
      pair_.inverse_a = makePlacement((M_0a * own_a).inverse() * place.base);
    } else if (!isNone(own_a)) {
      pair_.inverse_a = makePlacement(own_a.inverse() * transformOf(pair_.inverse_a));
    }
    if (!isNone(own_b)) pair_.placement_b = makePlacement(transformOf(pair_.placement_b) * own_b);
  }

  const AnsweredQuery& asked_;
  const engine::PairParts parts_;
  const ManagedBody& a_;
  engine::EngineWorkspace& workspace_;
  engine::LinkPair pair_;
  engine::Problem problem_;
  engine::Query query_;
  std::vector<double> variables_;
};

/// How far an object, or the base, may be off at one time. (It is no more than one pose tolerance and a way.)
struct Room {
  double length = 0, angle = 0;  ///< m, rad
  Vector3d pivot = Vector3d::Zero();

  Room() = default;
  Room(const PoseTolerance& tolerance, double factor, double way)
      : length(std::min(factor * tolerance.length + way, kFarthest)),
        angle(std::min(factor * tolerance.angle, M_PI)),
        pivot(tolerance.pivot) {}

  /// A deviation that is certainly within: it takes a point x as far along d as that goes, to first order. A matrix
  /// means the proper rotation next to it, off by Rotation::kUlps at most, which adds less than 2^-46 to its angle. The
  /// pivot goes where the numbers say to within the same times its distance from the origin.
  /// @param d  a unit vector.
  RigidTransform towards(const Vector3d& x, const Vector3d& d) const {
    const double turn = angle * (1 - 0x1p-44) - 0x1p-44;
    const double slide = length * (1 - 0x1p-44) - 0x1p-44 * pivot.norm();
    const Vector3d axis = (x - pivot).cross(d);
    const double lever = axis.norm();
    RigidTransform deviation;
    if (turn > 0 && lever > 0 && pivot.norm() <= kFarthest) {
      const Matrix3d R = Eigen::AngleAxisd(turn, axis / lever).toRotationMatrix();
      if (const auto rotation = Rotation::within12Ulps(R, 1e-9)) {
        deviation = RigidTransform(Rotation(), pivot) * RigidTransform(*rotation, Vector3d::Zero()) *
                    RigidTransform(Rotation(), -pivot);
      }
    }
    return slide > 0 ? RigidTransform(Rotation(), slide * d) * deviation : deviation;
  }
};

/// How far the base, and body 1 and body 2 of a contact, may be off.
struct Rooms {
  Room base, own[2];

  bool any() const {
    const auto has = [](const Room& room) { return room.length > 0 || room.angle > 0; };
    return has(base) || has(own[0]) || has(own[1]);
  }
  /// A part of them, in [0, 1].
  Rooms times(double part) const {
    Rooms rooms = *this;
    for (Room* room : {&rooms.base, &rooms.own[0], &rooms.own[1]}) {
      room->length *= part;
      room->angle *= part;
    }
    return rooms;
  }
};

/// Two points, fixed to the bodies of a contact, and a direction fixed to body 1, as they are at one place of the tube.
class PointsOfContact {
 public:
  /// @param body1, body2  the contact's.
  /// @param q, t  the configuration, and the obstacles' time, at which the contact's point and normal are.
  PointsOfContact(const Registry& registry, const TimePart& time, const ManagedBody& body1, const ManagedBody& body2,
                  const CertifiedContact& contact, const Eigen::VectorXd& q, double t)
      : tree_(*registry.tree()), time_(time), bodies_{&body1, &body2} {
    const Place nominal{q, {}, {}};
    for (int i = 0; i < 2; ++i) points_[i] = poseOf(i, nominal, t).inverse() * contact.point;
    normal_ = poseOf(0, nominal, t).linear().transpose() * contact.normal;
  }
  /// Says all of the place, and where the contact's point and normal are there.
  void report(const Place& place, double t, CertifiedContact& contact) const {
    contact.q_witness = place.q;
    contact.base_deviation = place.base;
    contact.deviation1 = place.own[0];
    contact.deviation2 = place.own[1];
    contact.point = poseOf(1, place, t) * points_[1];
    contact.normal = poseOf(0, place, t).linear() * normal_;
  }
  /// The place within the joints' strays about q at which the points are nearest along the direction, to first order.
  Place byJoints(const VariableStrays& strays, const Eigen::VectorXd& q, double t) const {
    const Vector3d n = poseOf(0, {q, {}, {}}, t).linear() * normal_;
    const auto gap = [&](const Eigen::VectorXd& at) { return gapAlong(n, {at, {}, {}}, t); };
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
    return {found, {}, {}};
  }
  /// The same place, but with the base and both bodies where the points come nearest, to first order.
  Place byPoses(const Place& joints, const Rooms& rooms, double t) const {
    Place place = joints;
    const Vector3d n = poseOf(0, joints, t).linear() * normal_;
    const Vector3d towards_other[2] = {n, -n};
    const int robot = bodies_[0]->link < 0 ? 1 : 0;
    if (bodies_[1 - robot]->link < 0) {  // the base moves no two links against each other
      place.base = rooms.base.towards(poseOf(robot, joints, t) * points_[robot], towards_other[robot]);
    }
    for (int i = 0; i < 2; ++i) {
      place.own[i] = rooms.own[i].towards(points_[i], poseOf(i, joints, t).linear().transpose() * towards_other[i]);
    }
    return place;
  }

  /// How much nearer the points are at the one place than at the other, along the direction.
  double closing(const Place& from, const Place& to, double t) const {
    const Vector3d n = poseOf(0, from, t).linear() * normal_;
    return gapAlong(n, from, t) - gapAlong(n, to, t);
  }

 private:
  double gapAlong(const Vector3d& n, const Place& place, double t) const {
    return n.dot(poseOf(1, place, t) * points_[1] - poseOf(0, place, t) * points_[0]);
  }
  /// The pose of a body's geometry in the world.
  Isometry3d poseOf(int i, const Place& place, double t) const {
    const ManagedBody& body = *bodies_[i];
    if (body.link < 0) return body.pose(time_.at(t)) * place.own[i].isometry();
    return place.base.isometry() * tree_.linkPose(body.link, place.q) * body.offset.isometry() *
           place.own[i].isometry();
  }

  const KinematicTree& tree_;
  const TimePart& time_;
  const ManagedBody* bodies_[2];
  Vector3d points_[2], normal_;
};

/// When a witness is looked for: from the contact on, ever later.
constexpr double kLater[] = {0, 0x1p-16, 0x1p-13, 0x1p-11, 0x1p-9, 0x1p-8, 0x1p-7, 0x1p-6, 0x1p-5, 0x1p-4, 0x1p-3, 1};

/// All that a query knows of its contacts' bodies.
class WitnessSearch {
 public:
  WitnessSearch(const AnsweredQuery& asked, const Registry& registry, const VariableStrays& strays,
                QueryWorkspace& workspace)
      : asked_(asked), registry_(registry), strays_(strays), workspace_(workspace) {}

  /// Makes the contact one with a witness, if one is found.
  /// @param contact  `leaf`, as it is reported.
  bool find(const engine::LeafContact& leaf, CertifiedContact& contact) {
    const engine::PairParts parts = asked_.problem.parts(leaf.pair);
    const Order order = orderOf(registry_.body(parts.a));
    const std::int32_t numbers[2] = {order.of_a ? parts.b : parts.a, order.of_a ? parts.a : parts.b};
    const ManagedBody* const bodies[2] = {&registry_.body(numbers[0]), &registry_.body(numbers[1])};
    // A motion that only its author knows is looked at by the engine, and nowhere else.
    if (asked_.problem.sweeps[parts.sweep].local_bounds) return false;
    const PointsOfContact points(registry_, asked_.time, *bodies[0], *bodies[1], contact,
                                 asked_.motion.configuration(leaf.t), leaf.t);
    PairAtRest pair(asked_, registry_, leaf.pair, workspace_.engine);
    const double gap = (contact.nearest2 - contact.nearest1).norm();
    for (const double later : kLater) {
      const double t = std::min(1.0, leaf.t_upper + later);
      const auto touches = [&](const Place& place) {
        if (!pair.touchesAt(t, place, *registry_.tree())) return false;
        points.report(place, t, contact);
        contact.t_upper = t;
        return true;
      };
      const Place nominal{asked_.motion.configuration(t), {}, {}};
      const Place joints = points.byJoints(strays_, nominal.q, t);
      if (touches(nominal) || touches(joints)) return true;
      const Rooms rooms{Room(registry_.tolerances().base(), asked_.query.tube.factor, 0),
                        {roomOf(*bodies[0], t), roomOf(*bodies[1], t)}};
      if (rooms.any()) {
        const Place all = points.byPoses(joints, rooms, t);
        if (touches(all)) return true;
        // With all of its room a body may go through the other one and out again.
        const double needed = std::min(1.0, gap / std::max(gap, points.closing(nominal, all, t)));
        const double beyond = needed > 0 ? std::min(needed, 1 - needed) : 1;
        for (const double depth : {0.125, 0.5}) {
          const double part = needed + depth * beyond;
          if (part < 1 && touches(points.byPoses(joints, rooms.times(part), t))) return true;
        }
      }
      if (t == 1) break;
    }
    return false;
  }

 private:
  Room roomOf(const ManagedBody& body, double t) const {
    const NamedTolerances& tolerances = registry_.tolerances();
    const auto found = tolerances.ofObjects().find(body.name);
    const PoseTolerance tolerance = found == tolerances.ofObjects().end() ? PoseTolerance() : found->second;
    return Room(tolerance, asked_.query.tube.factor, wayOf(tolerances.speedOf(body.name), t));
  }
  /// A lower bound of how far an object can have come by itself at t: as Strays::wayOf(), rounded the other way.
  double wayOf(const ObjectSpeed& speed, double t) const {
    if (!(speed.speed > 0)) return 0;
    const engine::Clock& clock = asked_.query.tube.clock;
    const double now = t >= 1 ? clock.end : clock.begin + t * (clock.end - clock.begin);
    const double sizes = std::abs(clock.begin) + std::abs(clock.end) + std::abs(speed.since);
    return speed.speed * std::max(0.0, now - speed.since - 4 * kUlp * sizes) * (1 - 2 * kUlp);
  }

  const AnsweredQuery& asked_;
  const Registry& registry_;
  const VariableStrays strays_;
  QueryWorkspace& workspace_;
};

}  // namespace

void findWitnesses(const AnsweredQuery& asked, const Registry& registry, const VariableStrays& strays,
                   const engine::Answer& answer, QueryWorkspace& workspace, CertifiedResult& result) {
  // The engine's memory has the answer, which is read from here on: what it holds is copied first.
  const std::vector<engine::LeafContact> leaves(answer.contacts, answer.contacts + answer.num_contacts);
  WitnessSearch search(asked, registry, strays, workspace);
  double proven = engine::kNever;
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    CertifiedContact& contact = result.contacts[i];
    contact.certain = contact.certain && search.find(leaves[i], contact);
    if (contact.certain) {
      proven = std::min(proven, contact.t_upper);
    } else {
      contact.t_upper = 1;
    }
  }
  result.t_upper = std::min(proven, 1.0);
  result.certain = proven <= 1;
}

}  // namespace fcl_artic
