// SPDX-License-Identifier: BSD-3-Clause
#include "pair_campaign.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include "bounded_path.h"
#include "exact_look.h"

namespace pair_campaign {
namespace {

using campaign::Case;
using campaign::Finding;
using campaign::format;
using campaign::Mutant;
using fcl_artic::CertifiedContact;
using fcl_artic::CertifiedPairResult;
using fcl_artic::Status;
using pairs::Judge;
using pairs::PairQuery;
using pairs::Random;
using pairs::Truth;
using pairs::Vec3;
using Clock = std::chrono::steady_clock;

/// A contact proven by the library shows to the judge up to the rounding of poses and of FCL's own parameters.
constexpr double kRounding = 1e-12;
/// Poses of the library and of the judge: rounding of FCL's screw axes, which may lie far away.
constexpr double kPose = 1e-11;

pairs::PathPtr randomWobble(bool near, double scale, Random& random) {
  Wobble w;
  w.R1 = random.rotation();
  w.axis = random.direction();
  w.turn = random.uniform(-3, 3);
  w.turn_swing = random.uniform(0, 1);
  w.start = scale * (near ? random.vector(0, 0.5) : random.vector(0.6, 1.6));
  w.way = scale * random.vector(0, near ? 0.5 : 1.6);
  if (!near) w.way -= w.start;
  w.swing = scale * random.vector(0, 0.3);
  w.frequency = random.uniform(0.5, 6);
  w.has_derivatives = random.chance(0.5);
  return boundedPath(w);
}

double offFrom(const pairs::PathPtr& path, double t, const Eigen::Isometry3d& M) {
  const auto own = path->pose(t).cast<double>();
  return std::max((own.rotation - M.linear()).cwiseAbs().maxCoeff(),
                  (own.position - M.translation()).cwiseAbs().maxCoeff());
}

class Examination {
 public:
  Examination(const PairQuery& query, const Judge& judge, const Truth& truth, const Answer& answer)
      : query_(query), judge_(judge), truth_(truth), answer_(answer), result_(answer.result) {}

  std::vector<Finding> run() {
    status();
    if (result_.status == Status::contact) contact();
    poses();
    swapped();
    dropIn();
    return std::move(findings_);
  }

 private:
  void add(const char* fault, const std::string& text) { findings_.push_back({fault, text}); }

  void status() {
    const CertifiedPairResult& r = result_;
    if (r.status == Status::undecided) add("undecided", format("from %.17g", r.t_lower));
    if (!(r.t_lower >= 0 && r.t_lower <= r.t_upper && r.t_upper <= 1))
      add("fields", format("bracket [%.17g, %.17g]", r.t_lower, r.t_upper));
    if (r.status == Status::free) {
      if (truth_.hit) add("missed", format("contact at t = %.17g", truth_.time));
      if (r.t_lower != 1 || r.certain || !r.contacts.empty()) add("fields", "free, with more than that");
    } else if (truth_.hit && r.t_lower > truth_.time) {
      add("late",
          format("t_lower %.17g, contact at t = %.17g (%.3g before)", r.t_lower, truth_.time, r.t_lower - truth_.time));
    }
  }

  void contact() {
    const CertifiedPairResult& r = result_;
    const double tolerance = answer_.request.tolerance_time, near = answer_.request.tolerance_distance;
    if (r.contacts.size() != 1) {
      add("fields", format("%zu contacts", r.contacts.size()));
      return;
    }
    const CertifiedContact& c = r.contacts[0];
    // The contact's own bracket may be narrower: it is of two pieces, sharpened by the equations of their features.
    // It may be proven where the answer's bracket is wider than asked for, which is not certain then; never the other
    // way round, and the answer knows of every proof.
    if (!(c.t_lower >= r.t_lower && c.t_lower <= c.t_upper) || (r.certain && !c.certain) ||
        (r.certain && c.t_upper > r.t_upper) || (c.certain && r.t_upper > c.t_upper))
      add("fields",
          format("contact in [%.17g, %.17g], answer in [%.17g, %.17g]", c.t_lower, c.t_upper, r.t_lower, r.t_upper));
    if (c.o1 != query_.body1->geometry.get() || c.o2 != query_.body2->geometry.get())
      add("fields", "contact of other geometries");
    const auto good = [](const pairs::Body& b, std::intptr_t id) {
      return b.kind == pairs::Kind::mesh ? id >= 0 && id < b.numPieces() : id == -1;
    };
    if (!good(*query_.body1, c.b1) || !good(*query_.body2, c.b2)) {
      add("fields", format("ids %ld and %ld", static_cast<long>(c.b1), static_cast<long>(c.b2)));
      return;
    }

    const double end = r.certain ? r.t_upper : std::min(r.t_upper, r.t_lower + tolerance);
    const double way = judge_.speed() * (end - r.t_lower);
    if (r.certain) {
      const double gap = judge_.at(r.t_upper, 1e-6).gap;
      if (!(gap <= kRounding)) add("unproven", format("gap %.3g m at t_upper %.17g", gap, r.t_upper));
      // 1e-15: t_upper is rounded
      if (r.t_upper - r.t_lower > tolerance + 1e-15 && way > near)
        add("wide", format("width %.3g, way %.3g m", r.t_upper - r.t_lower, way));
    } else {
      const double gap = judge_.at(r.t_lower, 1e-6).gap;
      if (!(gap <= near + way)) add("false", format("gap %.6g m at t_lower %.17g", gap, r.t_lower));
    }

    const double time = r.certain ? r.t_upper : r.t_lower;
    const pairs::Pose M_1 = query_.path1->pose(time), M_2 = query_.path2->pose(time);
    const int i = std::max(0, static_cast<int>(c.b1)), j = std::max(0, static_cast<int>(c.b2));
    const double allowed = 1e-5 + way + (r.certain ? 0 : near);
    const double from1 = pairs::distanceTo(*query_.body1, i, M_1, c.point),
                 from2 = pairs::distanceTo(*query_.body2, j, M_2, c.point);
    if (!(from1 <= allowed && from2 <= allowed))
      add("point", format("point %.3g m and %.3g m from its pieces, allowed %.3g", from1, from2, allowed));

    if (!(std::abs(c.normal.norm() - 1) <= 1e-9)) add("normal", format("normal of length %.17g", c.normal.norm()));
    if (r.t_lower > 0) {
      // At t_lower the pieces are not yet in each other, and the normal parts them, up to some 1e-3 rad of it.
      const pairs::Pose L_1 = query_.path1->pose(r.t_lower), L_2 = query_.path2->pose(r.t_lower);
      const double gap = along(*query_.body1, i, L_1, *query_.body2, j, L_2, c.normal);
      if (!(gap >= -(1e-4 + 2 * way + near))) add("normal", format("pieces overlap by %.3g m along the normal", -gap));
      // At t_lower their gap is what the bodies go until they touch, or what is too near to decide.
      const double apart = (c.nearest1 - c.nearest2).norm(), from = 1e-7 + way;
      const double off1 = pairs::distanceTo(*query_.body1, i, L_1, c.nearest1),
                   off2 = pairs::distanceTo(*query_.body2, j, L_2, c.nearest2);
      if (!(off1 <= from && off2 <= from && apart <= from + near))
        add("witness", format("nearest points %.3g m and %.3g m from their pieces, %.3g m apart", off1, off2, apart));
    }
  }

  /// Gap along n; a half-space or plane has but its own normal.
  static double along(const pairs::Body& a, int i, const pairs::Pose& M_a, const pairs::Body& b, int j,
                      const pairs::Pose& M_b, const Vec3& n) {
    if (!a.unbounded() && !b.unbounded()) return pairs::gapAlong(a, i, M_a, b, j, M_b, n);
    const pairs::Nearness p = pairs::nearness(a, M_a, b, M_b, 1e-6);
    return p.direction.dot(n) > 0.999 ? p.gap : -1;
  }

  void poses() {
    const CertifiedPairResult& r = result_;
    const double off =
        std::max({offFrom(query_.path1, r.t_lower, r.tf1_at_lower), offFrom(query_.path2, r.t_lower, r.tf2_at_lower),
                  offFrom(query_.path1, r.t_upper, r.tf1_at_upper), offFrom(query_.path2, r.t_upper, r.tf2_at_upper)});
    if (!(off <= kPose)) add("poses", format("off by %.3g", off));
  }

  void swapped() {
    const CertifiedPairResult &r = result_, &s = answer_.swapped;
    const double tolerance = answer_.request.tolerance_time;
    if (r.certain && s.certain) {
      if (std::max(r.t_lower, s.t_lower) > std::min(r.t_upper, s.t_upper) ||
          std::abs(r.t_lower - s.t_lower) > tolerance || std::abs(r.t_upper - s.t_upper) > tolerance)
        add("swapped", format("[%.17g, %.17g], swapped [%.17g, %.17g]", r.t_lower, r.t_upper, s.t_lower, s.t_upper));
    } else if (r.status != s.status && (r.certain || s.certain)) {
      add("swapped", "contact proven one way round, free the other");
    } else if (r.status == Status::contact && s.status == Status::contact) {
      // One of them is a graze to its solver: proven times of contact still end after proven free ones.
      if (std::max(r.t_lower, s.t_lower) > std::min(r.certain ? r.t_upper : 1.0, s.certain ? s.t_upper : 1.0))
        add("swapped", "brackets contradict each other");
    }
  }

  void dropIn() {
    const auto& d = answer_.drop_in;
    const double toc = d.time_of_contact;
    const double toc_err = fcl::ContinuousCollisionRequestd().toc_err;
    if (answer_.drop_in_time != toc || !(toc >= 0 && toc <= 1) || (!d.is_collide && toc != 1))
      add("drop-in", format("returns %.17g, result says %d at %.17g", answer_.drop_in_time, d.is_collide, toc));
    const double off = std::max(offFrom(query_.path1, toc, d.contact_tf1), offFrom(query_.path2, toc, d.contact_tf2));
    if (!(off <= kPose)) add("drop-in", format("contact_tf off by %.3g", off));
    if (truth_.hit && !d.is_collide) add("drop-in", format("missed, contact at t = %.17g", truth_.time));
    if (truth_.hit && toc > truth_.time) add("drop-in", format("late: %.17g, contact at t = %.17g", toc, truth_.time));
    if (!d.is_collide) return;
    const Truth after = judge_.firstContact(toc, std::min(1.0, toc + toc_err + 1e-12));
    if (!after.hit && after.gap > fcl_artic::CertifiedPairRequest().tolerance_distance)
      add("drop-in", format("contact at t = %.17g, gap %.3g m for toc_err from there on", toc, after.gap));
  }

  const PairQuery& query_;
  const Judge& judge_;
  const Truth& truth_;
  const Answer& answer_;
  const CertifiedPairResult& result_;
  std::vector<Finding> findings_;
};

/// Where the first query of a class stands among kShares.
int firstShare(const Family& family) {
  int first = 0;
  for (const Family& f : families()) {
    if (f.name == family.name) break;
    first += f.share;
  }
  return first;
}

/// The classes take turns: 37 is prime to kShares.
const Family& familyAt(std::uint64_t index) {
  const int slot = static_cast<int>((index * 37) % kShares);
  for (const Family& f : families())
    if (slot >= firstShare(f) && slot < firstShare(f) + f.share) return f;
  throw std::logic_error("shares do not add up");
}

}  // namespace

const std::vector<Family>& families() {
  using pairs::Bodies;
  static const std::vector<Family> all = {
      {"mesh-mesh/interp", Bodies::meshes, "interp", 20},
      {"shape-shape/interp", Bodies::shapes, "interp", 40},
      {"mesh-shape/interp", Bodies::mixed, "interp", 6},
      {"mesh-mesh/translation", Bodies::meshes, "translation", 1},
      {"shape-shape/translation", Bodies::shapes, "translation", 1},
      {"mesh-shape/translation", Bodies::mixed, "translation", 1},
      {"mesh-mesh/screw", Bodies::meshes, "screw", 1},
      {"shape-shape/screw", Bodies::shapes, "screw", 1},
      {"mesh-shape/screw", Bodies::mixed, "screw", 1},
      {"mesh-mesh/spline", Bodies::meshes, "spline", 1},
      {"shape-shape/spline", Bodies::shapes, "spline", 2},
      {"mesh-shape/spline", Bodies::mixed, "spline", 1},
      {"mesh-mesh/bounded", Bodies::meshes, "bounded", 1},
      {"shape-shape/bounded", Bodies::shapes, "bounded", 2},
      {"mesh-shape/bounded", Bodies::mixed, "bounded", 1},
  };
  return all;
}

const Family& familyOf(const std::string& name) {
  for (const Family& f : families())
    if (f.name == name) return f;
  throw std::invalid_argument("no class of queries is named '" + name + "'");
}

PairQuery makeQuery(const Family& family, std::uint64_t seed) {
  Random random(seed);
  pairs::PairOptions options;
  options.bodies = family.bodies;
  options.both_move = random.chance(0.5);
  options.graze = random.chance(0.25);
  options.any_volume = true;
  options.unbounded = true;
  if (family.motion == "translation") options.moves = pairs::Moves::translation;
  if (family.motion == "screw") options.moves = pairs::Moves::screw;
  if (family.motion == "spline") options.moves = pairs::Moves::spline;
  if (family.motion != "bounded") {
    PairQuery q = pairs::makePair(options, random.bits());
    q.family = family.name;
    q.seed = seed;
    return q;
  }
  const bool graze = options.graze;
  options.graze = false;
  PairQuery q = pairs::makePair(options, random.bits());
  const double scale = family.bodies == pairs::Bodies::shapes ? 1 : 0.65;
  q.path1 = randomWobble(false, scale, random);
  if (options.both_move) q.path2 = randomWobble(true, scale, random);
  if (graze) {
    const Truth truth = Judge(q).leastGap();
    double depth = random.logUniform(1e-8, 1e-3);
    if (random.chance(0.5)) depth = -depth;
    if (!truth.hit && truth.gap > 0) q.path2 = q.path2->shifted(-(truth.gap + depth) * truth.direction);
  }
  q.family = family.name;
  q.seed = seed;
  return q;
}

Answer ask(const PairQuery& q) {
  Answer answer;
  Random random(q.seed ^ 0xa5);
  if (random.chance(0.2)) answer.request.tolerance_time = random.logUniform(1e-9, 1e-3);
  if (random.chance(0.2)) answer.request.tolerance_distance = random.logUniform(1e-8, 1e-3);
  const auto *o1 = q.body1->geometry.get(), *o2 = q.body2->geometry.get();
  const auto motion1 = q.path1->motion(), motion2 = q.path2->motion();
  const auto begin = Clock::now();
  fcl_artic::continuousCollide(o1, motion1.get(), o2, motion2.get(), answer.request, answer.result);
  answer.elapsed_us = std::chrono::duration<double, std::micro>(Clock::now() - begin).count();
  fcl_artic::continuousCollide(o2, motion2.get(), o1, motion1.get(), answer.request, answer.swapped);
  // What is left in it must not matter.
  answer.drop_in.is_collide = random.chance(0.5);
  answer.drop_in.time_of_contact = 7;
  answer.drop_in_time = fcl_artic::continuousCollide<double>(o1, motion1.get(), o2, motion2.get(),
                                                             fcl::ContinuousCollisionRequestd(), answer.drop_in);
  return answer;
}

std::vector<Finding> examine(const PairQuery& query, const Judge& judge, const Truth& truth, const Answer& answer) {
  return Examination(query, judge, truth, answer).run();
}

namespace {

bool hits(const Answer& answer) {
  return answer.result.status == Status::contact && !answer.result.contacts.empty();
}
bool provenHit(const Answer& answer) {
  return hits(answer) && answer.result.certain;
}

/// Another bracket, with the poses at its ends.
void moveTo(double lower, double upper, const PairQuery& query, CertifiedPairResult& r) {
  r.t_lower = lower, r.t_upper = upper;
  for (CertifiedContact& c : r.contacts) c.t_lower = lower, c.t_upper = upper;
  const auto pose = [](const pairs::PathPtr& path, double t) {
    const auto M = path->pose(t).cast<double>();
    Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
    out.linear() = M.rotation, out.translation() = M.position;
    return out;
  };
  r.tf1_at_lower = pose(query.path1, lower), r.tf2_at_lower = pose(query.path2, lower);
  r.tf1_at_upper = pose(query.path1, upper), r.tf2_at_upper = pose(query.path2, upper);
}

Vec3 fiveMillimetres(const PairQuery& query) {
  Random random(query.seed ^ 0xbad);
  return 5e-3 * random.direction();
}

bool late(const PairQuery& query, Answer& answer) {
  CertifiedPairResult& r = answer.result;
  if (!provenHit(answer)) return false;
  const double by = std::max(1e-5, 2 * (r.t_upper - r.t_lower));
  moveTo(std::min(1.0, r.t_lower + by), std::min(1.0, r.t_upper + by), query, r);
  return r.t_lower < 1;
}

/// Both ways round, so that only the oracle can tell.
bool drop(const PairQuery& query, Answer& answer) {
  CertifiedPairResult& r = answer.result;
  if (!provenHit(answer)) return false;
  r.contacts.clear();
  r.status = Status::free;
  r.certain = false;
  moveTo(1, 1, query, r);
  answer.swapped = r;
  return true;
}

bool invent(const PairQuery& query, Answer& answer) {
  CertifiedPairResult& r = answer.result;
  if (r.status != Status::free) return false;
  r.status = Status::contact;
  CertifiedContact c;
  c.o1 = query.body1->geometry.get(), c.o2 = query.body2->geometry.get();
  if (query.body1->kind == pairs::Kind::mesh) c.b1 = 0;
  if (query.body2->kind == pairs::Kind::mesh) c.b2 = 0;
  r.contacts = {c};
  moveTo(0.5, 0.5 + answer.request.tolerance_time, query, r);
  return true;
}

bool widen(const PairQuery& query, Answer& answer) {
  CertifiedPairResult& r = answer.result;
  if (!provenHit(answer) || r.t_lower < 0.02) return false;
  moveTo(r.t_lower - 0.02, r.t_upper, query, r);
  return true;
}

bool movePoint(const PairQuery& query, Answer& answer) {
  if (hits(answer)) answer.result.contacts[0].point += fiveMillimetres(query);
  return hits(answer);
}

bool turnNormal(const PairQuery&, Answer& answer) {
  if (hits(answer)) answer.result.contacts[0].normal *= -1;
  return hits(answer) && answer.result.t_lower > 0;
}

bool moveWitness(const PairQuery& query, Answer& answer) {
  if (hits(answer)) answer.result.contacts[0].nearest2 += fiveMillimetres(query);
  return hits(answer) && answer.result.t_lower > 0;
}

bool movePose(const PairQuery&, Answer& answer) {
  answer.result.tf2_at_upper.translation().x() += 1e-9;
  return true;
}

/// Claims a proof somewhat before the contact.
bool claimCertain(const PairQuery& query, Answer& answer) {
  CertifiedPairResult& r = answer.result;
  if (!hits(answer) || r.t_lower < 2e-3) return false;
  r.certain = true;
  for (CertifiedContact& c : r.contacts) c.certain = true;
  moveTo(r.t_lower - 1e-3, r.t_lower - 1e-3, query, r);
  return true;
}

bool renumber(const PairQuery&, Answer& answer) {
  if (hits(answer)) answer.result.contacts[0].b1 += 100000;
  return hits(answer);
}

bool freeTheOtherWayRound(const PairQuery&, Answer& answer) {
  if (!provenHit(answer)) return false;
  answer.swapped = {};
  answer.swapped.status = Status::free;
  return true;
}

bool delayDropIn(const PairQuery&, Answer& answer) {
  answer.drop_in.time_of_contact = answer.drop_in_time = std::min(1.0, 0.99 * answer.drop_in_time + 0.02);
  return answer.drop_in.is_collide && answer.drop_in_time < 1;
}

std::string describe(const PairQuery& query, const Truth& truth, const Answer& answer) {
  std::string words =
      pairs::describe(query) + "\n" +
      format("oracle: %s t %.17g gap %.6g at %.17g\n", truth.hit ? "hit" : "free", truth.time, truth.gap,
             truth.gap_time) +
      format("tolerances %.3g, %.3g m\n", answer.request.tolerance_time, answer.request.tolerance_distance);
  for (const CertifiedPairResult* r : {&answer.result, &answer.swapped}) {
    static constexpr const char* kStatus[] = {"free", "contact", "undecided"};
    words += format("%s: %s [%.17g, %.17g]%s\n", r == &answer.result ? "answer" : "swapped",
                    kStatus[static_cast<int>(r->status)], r->t_lower, r->t_upper, r->certain ? " certain" : "");
    for (const CertifiedContact& c : r->contacts) {
      words += format("  %ld %ld point %.9g %.9g %.9g normal %.9g %.9g %.9g\n", static_cast<long>(c.b1),
                      static_cast<long>(c.b2), c.point.x(), c.point.y(), c.point.z(), c.normal.x(), c.normal.y(),
                      c.normal.z());
    }
  }
  return words + format("drop-in: %d at %.17g\n", answer.drop_in.is_collide, answer.drop_in.time_of_contact);
}

void look(Case& c) {
  const PairQuery query = makeQuery(familyOf(c.id.family), c.id.seed);
  const Judge judge(query, exactLook(query));
  const Truth truth = judge.firstContact();
  c.tally.count("hits", truth.hit);
  c.tally.count("starts", truth.hit && truth.time == 0);
  c.tally.count("between", truth.hit && truth.time > 0 && judge.at(1, 0.5).gap > 0);  // two free ends
  c.tally.count("grazes", !truth.hit && truth.gap <= 1e-3);
  c.queryWithoutFile(campaign::kTwoBodies);
  const Answer answer = ask(query);
  if (c.words) *c.words += describe(query, truth, answer);
  const auto findings = [&](const Answer& one) { return examine(query, judge, truth, one); };
  campaign::tryMutants(mutants(), query, answer, findings, c);
  c.findings = findings(answer);
  const CertifiedPairResult& r = answer.result;
  c.tally.count("certain", r.status == Status::contact && r.certain);
  c.tally.count("uncertain", r.status == Status::contact && !r.certain);
  c.tally.count("beyond", r.certain && !truth.hit);  // the samples did not find it
  c.tally.note(r.status == Status::free ? "free, us" : "hit, us", answer.elapsed_us);
  if (r.certain && truth.hit) c.tally.note("sampled contact - t_lower (certain hits)", truth.time - r.t_lower);
}

}  // namespace

const std::vector<Mutant<PairQuery, Answer>>& mutants() {
  // A moved point can stay inside a solid, and what turns about a tip or comes a little early may still fit.
  static const std::vector<Mutant<PairQuery, Answer>> all = {{"late", 0.97, late},
                                                             {"drop", 0.97, drop},
                                                             {"invent", 0.97, invent},
                                                             {"widen", 0.97, widen},
                                                             {"point", 0.75, movePoint},
                                                             {"normal", 0.75, turnNormal},
                                                             {"witness", 0.97, moveWitness},
                                                             {"poses", 0.97, movePose},
                                                             {"certain", 0.97, claimCertain},
                                                             {"ids", 0.97, renumber},
                                                             {"swapped", 0.97, freeTheOtherWayRound},
                                                             {"drop-in", 0.97, delayDropIn}};
  return all;
}

campaign::Campaign campaignOfPairs() {
  std::vector<std::string> names;
  for (const Family& family : families()) names.push_back(family.name);
  return {names,
          [](std::uint64_t seed, std::uint64_t index) {
            return campaign::CaseId{familyAt(index).name, Random::mix(seed, index)};
          },
          look, "pairs"};
}

}  // namespace pair_campaign
