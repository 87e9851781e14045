// SPDX-License-Identifier: BSD-3-Clause
//
// Random scenes with random tolerances, judged by motions of their own within these: the campaign's oracle samples
// them with its own kinematics. FCL_ARTIC_TUBE_CASES and FCL_ARTIC_TUBE_SEED ask for more and for others.
#include <algorithm>
#include <cmath>

#include "arms.h"
#include "expect.h"
#include "generator.h"

namespace campaign {
namespace tube_campaign_test {
namespace {

using fcl_artic::CertifiedContact;
using fcl_artic::CertifiedResult;
using fcl_artic::Status;

/// An object's pose tolerance about the origin of its frame.
struct Pad {
  double length = 0, angle = 0;
  double speed = 0, since = 0;  ///< of an object that moves by itself
  /// How far it has come by itself.
  double wayAt(double t) const { return speed * std::max(0.0, t - since); }
};

struct Tolerances {
  std::vector<int> links;           ///< of each variable
  std::vector<double> of_variable;  ///< rad or m
  std::vector<Pad> of_body;         ///< of obstacles
  Pad base;                         ///< about the world's origin

  bool any() const {
    return ofPoses() || std::any_of(of_variable.begin(), of_variable.end(), [](double x) { return x > 0; });
  }
  bool ofPoses() const {
    const auto strays = [](const Pad& pad) { return pad.length > 0 || pad.angle > 0 || pad.speed > 0; };
    return strays(base) || std::any_of(of_body.begin(), of_body.end(), strays);
  }
};

/// One robot and scene within the tolerances.
struct Deviation {
  std::vector<double> begin, end;  ///< of each variable, at the motion's ends
};

Tolerances drawTolerances(const Scene& scene, Random& random) {
  Tolerances tolerances;
  for (std::size_t i = 0; i < scene.links.size(); ++i) {
    if (scene.links[i].hasVariable()) tolerances.links.push_back(static_cast<int>(i));
  }
  const double size = random.logUniform(1e-5, 0.1);
  const int kind = random.below(4);
  for (std::size_t v = 0; v < tolerances.links.size(); ++v) {
    const double own = size * random.logUniform(0.1, 10);
    tolerances.of_variable.push_back(kind == 0 || (kind == 1 && random.chance(0.5)) ? size
                                     : kind == 3 && random.chance(0.5)              ? 0
                                                                                    : own);
  }
  tolerances.of_body.resize(scene.bodies.size());
  const bool objects = random.chance(0.3);
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const bool own = objects && scene.bodies[i].link < 0 && random.chance(0.5);
    if (!own) continue;
    tolerances.of_body[i].length = random.chance(0.7) ? size * random.unit() : 0;
    tolerances.of_body[i].angle = random.chance(0.5) ? size * random.unit() : 0;
  }
  if (random.chance(0.3)) {
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
      if (scene.bodies[i].link >= 0 || random.chance(0.5)) continue;
      tolerances.of_body[i].speed = random.logUniform(1e-3, 1);
      tolerances.of_body[i].since = random.chance(0.5) ? 0 : random.uniform(-0.5, 1);
    }
  }
  if (random.chance(0.25)) {
    tolerances.base.length = random.chance(0.7) ? 0.3 * size * random.unit() : 0;
    tolerances.base.angle = random.chance(0.5) ? 0.3 * size * random.unit() : 0;
  }
  return tolerances;
}

bool isPrismatic(const Scene& scene, int link) {
  return scene.links[static_cast<std::size_t>(link)].joint == JointKind::prismatic;
}

void setTolerances(const Scene& scene, const Tolerances& tolerances, fcl_artic::ArticulatedCollisionManager& manager) {
  for (std::size_t v = 0; v < tolerances.links.size(); ++v) {
    const double value = tolerances.of_variable[v];
    const bool slides = isPrismatic(scene, tolerances.links[v]);
    manager.setJointTolerance("joint" + std::to_string(tolerances.links[v]),
                              slides ? fcl_artic::JointTolerance{0, value} : fcl_artic::JointTolerance{value, 0});
  }
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const Pad& pad = tolerances.of_body[i];
    if (pad.length > 0 || pad.angle > 0) {
      manager.setObjectTolerance(scene.nameOf(static_cast<int>(i)), {pad.length, pad.angle, Vec3::Zero()});
    }
    if (pad.speed > 0) manager.setObjectSpeed(scene.nameOf(static_cast<int>(i)), {pad.speed, pad.since});
  }
  manager.setBaseTolerance({tolerances.base.length, tolerances.base.angle, Vec3::Zero()});
  manager.setup();
}

/// A rigid motion within a pose tolerance.
Pose within(const Pad& pad, Random& random) {
  Pose pose;
  const Vec3 axis = random.direction();
  pose.R = rotationAbout(axis, pad.angle * (random.chance(0.5) ? 1 : random.unit()));
  const Vec3 way = random.direction();
  pose.p = pad.length * (random.chance(0.5) ? 1 : random.unit()) * (1 - 1e-12) * way;
  return pose;
}

/// The scene as it may really be.
Scene deviate(const Scene& nominal, const Tolerances& tolerances, const Deviation& deviation, Random& random) {
  Scene scene = nominal;
  const Kinematics kinematics(nominal);
  for (std::size_t v = 0; v < deviation.begin.size(); ++v) {
    scene.q1[v] = nominal.q0[v] + kinematics.deltaQ(static_cast<int>(v)) + deviation.end[v];
    scene.q0[v] += deviation.begin[v];
  }
  scene.shortest = false;
  // The base and all that stands on it move by T: seen from it, the obstacles move by its inverse.
  const Pose base = within(tolerances.base, random).inverse();
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    Body& body = scene.bodies[i];
    if (body.link >= 0) continue;
    const Pose own = within(tolerances.of_body[i], random);
    // Turned about the object's own origin, then moved.
    body.pose = base * Pose{own.R * body.pose.R, body.pose.p + own.p};
  }
  return scene;
}

/// The corner of the tube that brings two bodies nearest to each other at one time, to first order.
Deviation worst(const Scene& scene, const Tolerances& tolerances, const PairTruth& pair) {
  Deviation deviation;
  Random none(1);
  const Tolerances exact{tolerances.links, tolerances.of_variable, std::vector<Pad>(scene.bodies.size()), {}};
  const std::size_t n = tolerances.links.size();
  deviation.begin.assign(n, 0);
  for (std::size_t v = 0; v < n; ++v) {
    double gap[2];
    for (int side = 0; side < 2; ++side) {
      Deviation one;
      one.begin.assign(n, 0);
      one.begin[v] = side ? tolerances.of_variable[v] : -tolerances.of_variable[v];
      one.end = one.begin;
      const Scene moved = deviate(scene, exact, one, none);
      const Kinematics kinematics(moved);
      const Pose a = kinematics.bodyPose(pair.a, pair.gap_time), b = kinematics.bodyPose(pair.b, pair.gap_time);
      // The direction and points are those of the nominal scene's least gap.
      const Kinematics before(scene);
      const Pose a0 = before.bodyPose(pair.a, pair.gap_time), b0 = before.bodyPose(pair.b, pair.gap_time);
      const Proximity near = Oracle(scene).at(pair.a, pair.b, pair.gap_time, 0.5);
      const Vec3 x = a * (a0.inverse() * near.a), y = b * (b0.inverse() * near.b);
      gap[side] = near.direction.dot(y - x);
    }
    deviation.begin[v] = gap[1] < gap[0] ? tolerances.of_variable[v] : -tolerances.of_variable[v];
  }
  deviation.end = deviation.begin;
  return deviation;
}

/// Of one robot and scene: whether an object that goes straight for another body reaches it before t_lower.
void lookAtSpeeds(const Scene& real, const Tolerances& tolerances, const std::vector<PairTruth>& pairs,
                  const CertifiedResult& r, Random& random, Case& c) {
  const Oracle oracle(real);
  for (const PairTruth& pair : pairs) {
    const Pad &a = tolerances.of_body[static_cast<std::size_t>(pair.a)],
              &b = tolerances.of_body[static_cast<std::size_t>(pair.b)];
    if (!(a.speed + b.speed > 0)) continue;
    for (int k = 0; k < 4; ++k) {
      const double t = k ? random.unit() : std::min(pair.gap_time, 1.0);
      const Proximity near = oracle.at(pair.a, pair.b, t, 1e-3);
      const bool reached = near.touching || near.upper < a.wayAt(t) + b.wayAt(t) - 1e-9;
      c.tally.count("moves by itself", true);
      c.tally.count("reached", reached);
      if (reached && (r.isFree() || t < r.t_lower)) {
        c.fault("missed", format("bodies %d and %d, %.17g apart at %.17g, may meet", pair.a, pair.b, near.gap, t));
      }
    }
  }
}

/// The motion itself, some at random within the tolerances, and corners that bring the nearest pairs together.
std::vector<Deviation> deviationsOf(const Scene& scene, const Tolerances& tolerances, const Truth& truth,
                                    Random& random) {
  const std::size_t n = tolerances.links.size();
  std::vector<Deviation> tried(1, Deviation{std::vector<double>(n, 0), std::vector<double>(n, 0)});
  for (int k = 0; k < 8; ++k) {
    Deviation deviation;
    for (std::size_t v = 0; v < n; ++v) {
      const double t = tolerances.of_variable[v];
      const double one = t * (k < 4 ? random.sign() : random.uniform(-1, 1));
      deviation.begin.push_back(one);
      deviation.end.push_back(k % 2 ? t * random.uniform(-1, 1) : one);
    }
    tried.push_back(deviation);
  }
  std::vector<PairTruth> nearest = truth.pairs;
  std::sort(nearest.begin(), nearest.end(), [](const auto& x, const auto& y) { return x.gap < y.gap; });
  for (std::size_t k = 0; k < std::min<std::size_t>(3, nearest.size()); ++k) {
    if (!nearest[k].hit) tried.push_back(worst(scene, tolerances, nearest[k]));
  }
  return tried;
}

Pose poseOf(const Eigen::Isometry3d& M) {
  Pose pose;
  pose.R = M.linear();
  pose.p = M.translation();
  return pose;
}

/// The angle of a rotation, rad.
double angleOf(const Mat3& R) {
  const Vec3 twice_sine(R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1));
  return std::atan2(twice_sine.norm(), R.trace() - 1);
}

/// Whether a deviation is more than rounding; one that is outside its tolerance is a fault.
bool deviates(const char* of, const Eigen::Isometry3d& M, const Pad& pad, double time, Case& c) {
  const Pose pose = poseOf(M);
  const double angle = angleOf(pose.R), length = pose.p.norm();
  if (angle > pad.angle) c.fault("witness", format("%s turns by %.17g, more than %.17g", of, angle, pad.angle));
  if (length > pad.length + pad.wayAt(time)) {
    c.fault("witness",
            format("%s is off by %.17g, more than %.17g and %.17g", of, length, pad.length, pad.wayAt(time)));
  }
  return angle > 0 || length > 0;
}

struct WitnessSeen {
  bool beside_motion = false;  ///< the joints are at other values than the motion's
  bool off_its_pose = false;   ///< the base, or an object
};

/// A proven contact's configuration is in the tube, and so are base and objects; the two bodies touch there.
WitnessSeen lookAtWitness(const Scene& scene, const Tolerances& tolerances, const fcl_artic::ToleranceWitness& witness,
                          double time, int body1, int body2, Case& c) {
  const std::size_t n = tolerances.links.size();
  const Eigen::VectorXd& q = witness.q_witness;
  WitnessSeen seen;
  if (q.size() != static_cast<Eigen::Index>(n)) {
    c.fault("witness", "of another size");
    return seen;
  }
  Scene real = scene;
  const Kinematics kinematics(scene);
  for (std::size_t v = 0; v < n; ++v) {
    const auto i = static_cast<Eigen::Index>(v);
    const double at = scene.q0[v] + time * kinematics.deltaQ(static_cast<int>(v));
    seen.beside_motion = seen.beside_motion || std::abs(q[i] - at) >= 1e-12;
    if (std::abs(q[i] - at) > tolerances.of_variable[v] + 1e-13 * (1 + std::abs(at))) {
      c.fault("witness", format("variable %zu is off by %.17g", v, q[i] - at));
    }
    real.q0[v] = real.q1[v] = q[i];
  }
  real.shortest = false;
  seen.off_its_pose = deviates("the base", witness.base_deviation, tolerances.base, time, c);
  // The base moves by T: seen from it, the obstacles move by its inverse.
  const Pose base = poseOf(witness.base_deviation).inverse();
  for (Body& body : real.bodies) {
    if (body.link < 0) body.pose = base * body.pose;
  }
  for (const auto& [number, M] : {std::make_pair(body1, witness.deviation1), {body2, witness.deviation2}}) {
    Body& body = real.bodies[static_cast<std::size_t>(number)];
    const bool own = deviates("a body", M, tolerances.of_body[static_cast<std::size_t>(number)], time, c);
    seen.off_its_pose = seen.off_its_pose || own;
    body.pose = body.pose * poseOf(M);
  }
  const Proximity near = Oracle(real).at(body1, body2, 0, 0.5);
  if (!near.touching && near.gap > 1e-9) c.fault("witness", format("the bodies are %.6g apart at it", near.gap));
  return seen;
}

void lookAtCase(Case& c) {
  Asked asked(c.id.seed);
  asked.scene = makeScene(c.id.family, c.id.seed);
  Scene& scene = asked.scene;
  scene.every_pair = false;
  Random random(Random::mix(0x70be, c.id.seed));
  const Tolerances tolerances = drawTolerances(scene, random);
  asked.question = prepare(scene);
  setTolerances(scene, tolerances, *asked.question.manager);
  fcl_artic::CertifiedRequest request = asked.question.request;
  if (random.chance(0.3)) request.mode = fcl_artic::ContactMode::any;
  if (random.chance(0.2)) request.visibility = fcl_artic::VisibilityMode::on;
  c.query([&] { return asked.question.manager->writeQuery(*asked.question.motion, request); });
  const Answer answer = ask(asked.question, request);
  const CertifiedResult& r = answer.result;
  c.tally.count("free", r.isFree());
  c.tally.count("contact", r.status == Status::contact);
  c.tally.count("certain", r.certain);
  if (r.status == Status::undecided) c.fault("undecided", "without a budget");
  if (random.chance(0.125)) {
    const std::string text = asked.question.manager->writeQuery(*asked.question.motion, request);
    const CertifiedResult again = fcl_artic::readQuery(text).ask();
    if (again.t_lower != r.t_lower || again.t_upper != r.t_upper || again.status != r.status) {
      c.fault("text", "the query as text has another answer");
    }
  }

  // Before t_lower every motion of the tube is free.
  const Truth& truth = asked.truth();
  c.tally.count("nominal hits", truth.hit);
  const std::vector<Deviation> tried = deviationsOf(scene, tolerances, truth, random);
  if (r.t_lower > 0) {
    bool hit = false;
    for (std::size_t k = 0; k < tried.size(); ++k) {
      const Scene real = deviate(scene, tolerances, tried[k], random);
      const Truth of = Oracle(real).judge(false);
      hit = hit || of.hit;
      if (of.hit && (r.isFree() || of.time < r.t_lower)) {
        c.fault("missed", format("deviation %zu touches at %.17g, before %.17g", k, of.time, r.t_lower));
      }
    }
    c.tally.count("deviations that hit", hit);
    for (std::size_t k = 0; k < 3; ++k) {
      lookAtSpeeds(deviate(scene, tolerances, tried[k], random), tolerances, truth.pairs, r, random, c);
    }
  }
  c.tally.count("free, nominal free", r.isFree() && !truth.hit);
  c.tally.count("nominal free", !truth.hit);

  // A witness is in the tube, and touches.
  for (const CertifiedContact& contact : r.contacts) {
    c.tally.count("tube contacts", tolerances.any());
    c.tally.count("tube contacts, certain", tolerances.any() && contact.certain);
    c.tally.count("tube contacts with poses", tolerances.ofPoses());
    c.tally.count("tube contacts with poses, certain", tolerances.ofPoses() && contact.certain);
    if (!contact.certain) {
      if (contact.q_witness.size()) c.fault("witness", "of a contact that is not certain");
      continue;
    }
    if (!tolerances.any()) continue;  // none is wanted
    const WitnessSeen seen = lookAtWitness(scene, tolerances, contact, contact.t_upper,
                                           answer.bodyOf(contact.body1.object), answer.bodyOf(contact.body2.object), c);
    c.tally.count("witness beside the motion", seen.beside_motion);
    c.tally.count("witness off a pose", seen.off_its_pose);
  }
}

Tolerances times(Tolerances tolerances, double factor) {
  for (double& one : tolerances.of_variable) one *= factor;
  const auto scale = [&](Pad& pad) { pad.length *= factor, pad.angle *= factor; };
  scale(tolerances.base);
  std::for_each(tolerances.of_body.begin(), tolerances.of_body.end(), scale);
  return tolerances;
}

/// The largest free factor is that of queries with tolerances that are multiplied by hand.
void lookAtFactor(Case& c) {
  Asked asked(c.id.seed);
  asked.scene = makeScene(c.id.family, c.id.seed);
  Scene& scene = asked.scene;
  scene.every_pair = false;
  Random random(Random::mix(0x1ef7, c.id.seed));
  const Tolerances tolerances = drawTolerances(scene, random);
  if (!tolerances.any()) return;
  asked.question = prepare(scene);
  fcl_artic::ArticulatedCollisionManager& manager = *asked.question.manager;
  setTolerances(scene, tolerances, manager);
  fcl_artic::ToleranceLeftRequest request;
  static_cast<fcl_artic::Tolerances&>(request) = asked.question.request;
  static_cast<fcl_artic::Scope&>(request) = asked.question.request;
  request.most = random.logUniform(1, 1000);
  const fcl_artic::ToleranceLeft left = manager.toleranceLeft(*asked.question.motion, request);
  c.tally.count("none", left.upper == 0);
  c.tally.count("a factor", left.lower > 0 && std::isfinite(left.upper));
  c.tally.count("certain", left.certain && left.upper > 0);
  if (!left.within_accuracy || left.lower > left.upper) {
    c.fault("bracket", format("[%.17g, %.17g]", left.lower, left.upper));
  }
  if (left.certain && left.upper > 0) {
    Answer bodies;
    bodies.objects = asked.question.objects;
    lookAtWitness(scene, times(tolerances, left.upper), left, left.time, bodies.bodyOf(left.body1.object),
                  bodies.bodyOf(left.body2.object), c);
  }

  const auto isFree = [&](double factor) {
    manager.resetTolerances();
    setTolerances(scene, times(tolerances, factor), manager);
    const CertifiedResult result = ask(asked.question, asked.question.request).result;
    return result.isFree();
  };
  // Smaller ones are proven, too, by the larger tube. A query for them finds that, if not very near its own limit.
  for (const double factor : {left.lower, 0.9 * left.lower * random.unit()}) {
    if (factor > 0 && !isFree(factor)) c.fault("by hand", format("not free with %.17g", factor));
  }
  if (std::isfinite(left.upper) && isFree(left.upper)) c.fault("by hand", format("free with %.17g", left.upper));
  // No motion within the tolerances times `lower` touches.
  if (left.lower > 0) {
    const Tolerances largest = times(tolerances, left.lower);
    for (const Deviation& deviation : deviationsOf(scene, largest, asked.truth(), random)) {
      if (Oracle(deviate(scene, largest, deviation, random)).judge(false).hit) c.fault("missed", "a deviation touches");
    }
  }
}

TEST(Tubes, NoMotionWithinThemTouchesBeforeItIsSaid) {
  Options options;
  options.cases = fromEnvironment("FCL_ARTIC_TUBE_CASES", 400);
  options.seed = fromEnvironment("FCL_ARTIC_TUBE_SEED", 1);
  Campaign campaign;
  campaign.families = families();
  campaign.number = Arms::inShares;
  campaign.look = lookAtCase;
  const Tally all = runWithoutFaults(campaign, options).total;
  EXPECT_GE(all.share("free"), 0.15);
  EXPECT_GE(all.share("deviations that hit"), 0.05) << "no deviation tells";
  EXPECT_GE(all["witness beside the motion"], options.cases / 100);
  EXPECT_GE(all["witness off a pose"], options.cases / 100);
  EXPECT_GE(all["reached"], options.cases / 10);
}

TEST(Tubes, TheLargestFreeFactorIsThatOfTolerancesMultipliedByHand) {
  Options options;
  options.cases = fromEnvironment("FCL_ARTIC_TUBE_CASES", 200);
  options.seed = fromEnvironment("FCL_ARTIC_TUBE_SEED", 1);
  Campaign campaign;
  campaign.families = families();
  campaign.number = Arms::inShares;
  campaign.look = lookAtFactor;
  const Tally all = runWithoutFaults(campaign, options).total;
  EXPECT_GE(all.share("a factor"), 0.08);
  EXPECT_GE(all.share("certain"), 0.015);
}

}  // namespace
}  // namespace tube_campaign_test
}  // namespace campaign
