// SPDX-License-Identifier: BSD-3-Clause
#include "checks.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <utility>

#include "random.h"

namespace campaign {
namespace {

using fcl_artic::CertifiedContact;
using fcl_artic::CertifiedResult;
using fcl_artic::Status;

/// A contact is there, as far as a distance computed in doubles tells (m).
constexpr double kContact = 1e-11;

class Examination {
 public:
  Examination(const Scene& scene, const Oracle& oracle, const Truth& truth, const Answer& answer)
      : scene_(scene), oracle_(oracle), truth_(truth), answer_(answer), result_(answer.result) {}

  std::vector<Finding> run() {
    bracket(result_.t_lower, result_.t_upper);
    poses();
    if (result_.status == Status::undecided) add("undecided", "undecided at t_lower %.17g", result_.t_lower);
    if (result_.status == Status::free) {
      if (truth_.hit) add("missed", "free, but contact at t = %.17g", truth_.time);
      if (!result_.contacts.empty() || result_.certain || result_.t_lower != 1)
        add("fields", "free with contacts, certain, or t_lower %.17g", result_.t_lower);
    }
    if (truth_.hit && result_.status != Status::free && result_.t_lower > truth_.time)
      add("late", "t_lower %.17g, contact at t = %.17g (%.3g before)", result_.t_lower, truth_.time,
          result_.t_lower - truth_.time);
    if (result_.status == Status::contact) contacts();
    return std::move(findings_);
  }

 private:
  template <typename... T>
  void add(const char* fault, const char* format, T... values) {
    char line[256];
    std::snprintf(line, sizeof line, format, values...);
    findings_.push_back({fault, line});
  }

  const Geometry& geometry(int body) const { return *scene_.bodies[static_cast<std::size_t>(body)].geometry; }
  Pose poseAt(int body, double t) const { return oracle_.kinematics().bodyPose(body, t); }

  void bracket(double lower, double upper) {
    if (!(0 <= lower && lower <= upper && upper <= 1)) add("fields", "bracket [%.17g, %.17g]", lower, upper);
  }

  void poses() {
    const std::size_t expected = result_.isFree() ? 0 : scene_.links.size();
    if (result_.M_0_at_lower.size() != expected) {
      add("poses", "%zu poses instead of %zu", result_.M_0_at_lower.size(), expected);
      return;
    }
    for (std::size_t i = 0; i < expected; ++i) {
      const Pose own = oracle_.kinematics().linkPose(static_cast<int>(i), result_.t_lower);
      const Eigen::Isometry3d& M = result_.M_0_at_lower[i];
      const double off =
          std::max((M.linear() - own.R).cwiseAbs().maxCoeff(), (M.translation() - own.p).cwiseAbs().maxCoeff());
      if (!(off <= 1e-12)) add("poses", "link%zu off by %.3g at t_lower", i, off);
    }
  }

  /// Furthest way of a point of b, seen from a, between two times.
  double displacement(int a, int b, double from, double to) const {
    const Pose x = poseAt(a, from).inverse() * poseAt(b, from), y = poseAt(a, to).inverse() * poseAt(b, to);
    const Vec3& c = geometry(b).centre();
    return (x * c - y * c).norm() + (x.R - y.R).norm() * geometry(b).radius();
  }

  void contacts() {
    const std::size_t most = scene_.every_pair ? 10000 : static_cast<std::size_t>(scene_.max_contacts);
    if (result_.contacts.empty() || result_.contacts.size() > most) {
      add("fields", "%zu contacts", result_.contacts.size());
      return;
    }
    double first_lower = 1;
    bool touches = truth_.hit && truth_.time <= result_.t_upper;
    const auto checked = oracle_.kinematics().pairs();
    for (const CertifiedContact& c : result_.contacts) {
      const int a = answer_.bodyOf(c.body1.object), b = answer_.bodyOf(c.body2.object);
      if (a < 0 || b < 0 ||
          std::find(checked.begin(), checked.end(), std::pair<int, int>(std::minmax(a, b))) == checked.end()) {
        add("fields", "contact of bodies %d and %d, which are no checked pair", a, b);
        continue;
      }
      if (c.body1.name != scene_.nameOf(a) || c.body2.name != scene_.nameOf(b) ||
          c.body1.link != scene_.bodies[static_cast<std::size_t>(a)].link ||
          c.body2.link != scene_.bodies[static_cast<std::size_t>(b)].link || c.o1 != geometry(a).fclGeometry().get() ||
          c.o2 != geometry(b).fclGeometry().get())
        add("fields", "contact of bodies %d and %d: link, name or geometry is another's", a, b);
      bracket(c.t_lower, c.t_upper);
      first_lower = std::min(first_lower, c.t_lower);
      touches = touches || touchesWithin(a, b, result_.t_lower, result_.t_upper);
      contact(c, a, b);
    }
    if (first_lower < result_.t_lower)
      add("fields", "t_lower %.17g, that of its contacts %.17g", result_.t_lower, first_lower);
    if (result_.certain && !touches) add("unproven", "no contact in [%.17g, %.17g]", result_.t_lower, result_.t_upper);
    if (scene_.every_pair) everyPair();
  }

  bool touchesWithin(int a, int b, double from, double to) const {
    const PairTruth p = oracle_.firstContact(std::min(a, b), std::max(a, b), to, from);
    return p.hit || p.doubtful || p.gap <= kContact;
  }

  void contact(const CertifiedContact& c, int a, int b) {
    // What is not certain lies within the time tolerance of t_lower; t_upper can be that of a later contact.
    const double end = c.certain ? c.t_upper : std::min(c.t_upper, c.t_lower + scene_.tolerance_time);
    const PairTruth inside = oracle_.firstContact(std::min(a, b), std::max(a, b), end, c.t_lower);
    const bool touches = inside.hit || inside.doubtful || inside.gap <= kContact;
    if (!touches && inside.gap > scene_.tolerance_distance)
      add("false", "gap %.6g m throughout [%.17g, %.17g]", inside.gap, c.t_lower, end);
    else if (!touches && c.certain)
      add("unproven", "gap %.6g m throughout [%.17g, %.17g]", inside.gap, c.t_lower, end);

    const double way = displacement(a, b, c.t_lower, end), width = c.t_upper - c.t_lower;
    // 1e-15: t_upper is rounded
    if (c.certain && width > scene_.tolerance_time + 1e-15 && way > scene_.tolerance_distance) {
      const Proximity p = oracle_.at(a, b, c.t_lower, 1e-3);
      if (p.gap > kContact) add("wide", "width %.3g, way %.3g m, gap at t_lower %.3g m", width, way, p.gap);
    }

    const double time = c.certain ? c.t_upper : c.t_lower;
    const Pose M_a = poseAt(a, time), M_b = poseAt(b, time);
    const double near = 1e-5 + way + scene_.margin + (c.certain ? 0 : scene_.tolerance_distance);
    const double from_a = distanceTo(geometry(a), M_a, c.point), from_b = distanceTo(geometry(b), M_b, c.point);
    if (!(from_a <= near && from_b <= near))
      add("point", "point %.3g m and %.3g m from its bodies, allowed %.3g", from_a, from_b, near);

    const auto validId = [&](int body, std::intptr_t id) {
      return geometry(body).isMesh() ? id >= 0 && id < geometry(body).numPieces() : id == -1;
    };
    if (!validId(a, c.b1) || !validId(b, c.b2)) {
      add("fields", "ids %ld and %ld of bodies %d and %d", static_cast<long>(c.b1), static_cast<long>(c.b2), a, b);
      return;
    }
    const int i = std::max(0, static_cast<int>(c.b1)), j = std::max(0, static_cast<int>(c.b2));
    const double id_a = distanceTo(geometry(a), i, M_a, c.point), id_b = distanceTo(geometry(b), j, M_b, c.point);
    if (!(id_a <= near && id_b <= near))
      add("point", "point %.3g m and %.3g m from its triangles, allowed %.3g", id_a, id_b, near);

    if (!(std::abs(c.normal.norm() - 1) <= 1e-9)) add("normal", "normal of length %.17g", c.normal.norm());
    if (c.t_lower > 0) {
      // At t_lower the two pieces are not yet in each other, and the normal parts them, up to some 1e-3 rad of it.
      const double apart =
          gapAlong(geometry(a).piece(i, poseAt(a, c.t_lower)), geometry(b).piece(j, poseAt(b, c.t_lower)), c.normal);
      const double allowed = 1e-4 + 2 * way + scene_.tolerance_distance;
      if (!(apart >= -allowed))
        add("normal", "pieces overlap by %.3g m along the normal, allowed %.3g", -apart, allowed);
    }
  }

  /// Of two bodies of the manager's, links or obstacles, one contact is reported; a link may have several geometries.
  void everyPair() {
    using Names = std::pair<std::string, std::string>;
    std::map<Names, double> lower;
    for (const CertifiedContact& c : result_.contacts) {
      if (!lower.emplace(Names(std::minmax(c.body1.name, c.body2.name)), c.t_lower).second)
        add("fields", "two contacts of %s and %s", c.body1.name.c_str(), c.body2.name.c_str());
    }
    for (const PairTruth& p : truth_.pairs) {
      if (!p.hit) continue;
      const std::string a = scene_.nameOf(p.a), b = scene_.nameOf(p.b);
      const auto found = lower.find(Names(std::minmax(a, b)));
      if (found == lower.end())
        add("missed", "pair %d %d not reported, contact at t = %.17g", p.a, p.b, p.time);
      else if (found->second > p.time)
        add("late", "pair %d %d: t_lower %.17g, contact at t = %.17g (%.3g before)", p.a, p.b, found->second, p.time,
            found->second - p.time);
    }
  }

  const Scene& scene_;
  const Oracle& oracle_;
  const Truth& truth_;
  const Answer& answer_;
  const CertifiedResult& result_;
  std::vector<Finding> findings_;
};

void makeFree(Answer& answer) {
  CertifiedResult& r = answer.result;
  r.status = Status::free;
  r.certain = false;
  r.t_lower = r.t_upper = 1;
  r.contacts.clear();
  r.M_0_at_lower.clear();
}

/// A contact between the bodies that come nearest at mid-time, there.
void inventContact(const Oracle& oracle, const Scene& scene, Answer& answer) {
  CertifiedResult& r = answer.result;
  const auto pairs = oracle.kinematics().pairs();
  CertifiedContact c;
  const auto [a, b] = pairs.front();
  const auto refer = [&](int body) {
    return fcl_artic::BodyRef{scene.bodies[static_cast<std::size_t>(body)].link,
                              answer.objects[static_cast<std::size_t>(body)].get(), scene.nameOf(body)};
  };
  const Proximity p = oracle.at(a, b, 0.5, 1e-3);
  c.body1 = refer(a), c.body2 = refer(b);
  c.o1 = scene.bodies[static_cast<std::size_t>(a)].geometry->fclGeometry().get();
  c.o2 = scene.bodies[static_cast<std::size_t>(b)].geometry->fclGeometry().get();
  if (scene.bodies[static_cast<std::size_t>(a)].geometry->isMesh()) c.b1 = p.piece_a;
  if (scene.bodies[static_cast<std::size_t>(b)].geometry->isMesh()) c.b2 = p.piece_b;
  c.point = p.a;
  c.normal = p.direction;
  c.t_lower = 0.5, c.t_upper = 0.5 + scene.tolerance_time;
  c.certain = false;
  r.status = Status::contact;
  r.t_lower = c.t_lower, r.t_upper = c.t_upper;
  r.contacts = {c};
  r.M_0_at_lower.resize(scene.links.size());
  for (std::size_t i = 0; i < r.M_0_at_lower.size(); ++i) {
    const Pose M = oracle.kinematics().linkPose(static_cast<int>(i), 0.5);
    r.M_0_at_lower[i].linear() = M.R;
    r.M_0_at_lower[i].translation() = M.p;
  }
}

/// Draws of its own for each scene: the first one spares all answers but 1 %.
struct Spoiler {
  explicit Spoiler(const Scene& scene) : random(scene.seed ^ 0xbad), one_percent(random.chance(0.01)) {}
  Random random;
  bool one_percent;
};

bool hits(const Answer& answer) {
  return answer.result.status == Status::contact && !answer.result.contacts.empty();
}

bool late(const Scene&, Answer& answer) {
  CertifiedResult& r = answer.result;
  constexpr double kBy = 1e-5;
  if (!hits(answer)) return false;
  r.t_lower = std::min(1.0, r.t_lower + kBy), r.t_upper = std::max(r.t_lower, r.t_upper);
  for (CertifiedContact& c : r.contacts)
    c.t_lower = std::min(1.0, c.t_lower + kBy), c.t_upper = std::max(c.t_lower, c.t_upper);
  return true;
}

bool drop(const Scene& scene, Answer& answer) {
  if (!hits(answer) || !Spoiler(scene).one_percent) return false;
  makeFree(answer);
  return true;
}

bool invent(const Scene& scene, Answer& answer) {
  const Oracle oracle(scene);
  if (answer.result.status != Status::free || !Spoiler(scene).one_percent || oracle.kinematics().pairs().empty())
    return false;
  inventContact(oracle, scene, answer);
  return true;
}

bool widen(const Scene&, Answer& answer) {
  CertifiedResult& r = answer.result;
  if (!hits(answer)) return false;
  r.t_lower = std::max(0.0, r.t_lower - 1e-2);
  for (CertifiedContact& c : r.contacts) c.t_lower = std::max(0.0, c.t_lower - 1e-2);
  return r.t_lower > 0;
}

bool movePoint(const Scene& scene, Answer& answer) {
  if (hits(answer)) answer.result.contacts[0].point += 1e-3 * Spoiler(scene).random.direction();
  return hits(answer);
}

bool turnNormal(const Scene&, Answer& answer) {
  if (hits(answer)) answer.result.contacts[0].normal *= -1;
  return hits(answer);
}

bool movePose(const Scene&, Answer& answer) {
  auto& poses = answer.result.M_0_at_lower;
  if (!poses.empty()) poses.back().translation().x() += 1e-11;
  return !poses.empty();
}

/// The bracket ends before the contact, and claims to be proven.
bool claimCertain(const Scene&, Answer& answer) {
  CertifiedResult& r = answer.result;
  if (!hits(answer) || !(r.t_lower > 1e-3)) return false;
  for (CertifiedContact& c : r.contacts) c.certain = true, c.t_upper = c.t_lower -= 1e-3;
  r.certain = true, r.t_upper = r.t_lower -= 1e-3;
  return true;
}

bool namePairOfOneBody(const Scene&, Answer& answer) {
  if (hits(answer)) answer.result.contacts[0].body1 = answer.result.contacts[0].body2;
  return hits(answer);
}

}  // namespace

std::vector<Finding> examine(const Scene& scene, const Oracle& oracle, const Truth& truth, const Answer& answer) {
  return Examination(scene, oracle, truth, answer).run();
}

const std::vector<Mutant<Scene, Answer>>& mutants() {
  // A moved point can stay inside a solid, and a contact at t = 0 has no direction that parts the bodies.
  static const std::vector<Mutant<Scene, Answer>> all = {{"late", 0.99, late},
                                                         {"drop", 0.99, drop},
                                                         {"invent", 0.99, invent},
                                                         {"widen", 0.99, widen},
                                                         {"point", 0.75, movePoint},
                                                         {"normal", 0.75, turnNormal},
                                                         {"poses", 0.99, movePose},
                                                         {"certain", 0.99, claimCertain},
                                                         {"pair", 0.99, namePairOfOneBody}};
  return all;
}

}  // namespace campaign
