// SPDX-License-Identifier: BSD-3-Clause
// Answers to one motion are claims: "free before t_lower", "in contact at some time up to t_upper". However a query is
// put (the paper's method with any switches, any mode, any budget, or the standard method), no claim may contradict
// another, nor a contact that dense sampling finds. More scenes: FCL_ARTIC_REDON_CLAIMS, other ones:
// FCL_ARTIC_REDON_SEED.
#include <algorithm>
#include <sstream>

#include "arms.h"
#include "expect.h"
#include "generator.h"

namespace claims_test {

namespace {

using fcl_artic::CertifiedRequest;
using fcl_artic::CertifiedResult;
using fcl_artic::ContactMode;
using fcl_artic::Method;
using fcl_artic::MotionEnclosure;
using fcl_artic::Status;

/// All that is random about how a scene is asked.
void anyWay(CertifiedRequest& request, campaign::Random& random) {
  request.method = random.chance(0.1) ? Method::standard : Method::redon2004;
  // (The standard method's modes are a campaign of their own.)
  request.mode = request.method == Method::standard ? ContactMode::first : static_cast<ContactMode>(random.below(3));
  request.max_contacts = random.chance(0.5) ? 1 : static_cast<std::size_t>(random.between(1, 50));
  // Some combinations have no end on long motions: a large budget ends them, and what they have proven counts.
  request.work_budget = static_cast<std::uint64_t>(random.chance(0.4) ? random.logUniform(1, 20000) : 40000);
  request.redon.enclosure = static_cast<MotionEnclosure>(random.below(3));
  request.redon.refinement_level = random.chance(0.6) ? -1 : random.between(2, 6);
  request.redon.simultaneous = random.chance(0.5);
  request.redon.newton = random.chance(0.5);
  request.redon.early_validity = random.chance(0.7);
  request.redon.in_time_order = random.chance(0.4);
  request.redon.links_in_world = random.chance(0.4);
  if (random.chance(0.15)) {  // stage 2, which a budget switches off
    request.visibility = fcl_artic::VisibilityMode::on;
    request.work_budget = 0;
    request.redon = fcl_artic::RedonOptions();
  }
}

std::string describe(const CertifiedRequest& r, const CertifiedResult& a) {
  std::ostringstream out;
  out.precision(9);
  out << (r.method == Method::standard ? "standard" : "paper") << " mode " << static_cast<int>(r.mode) << " contacts "
      << r.max_contacts << " budget " << r.work_budget << " level " << r.redon.refinement_level << " together "
      << r.redon.simultaneous << " newton " << r.redon.newton << " early " << r.redon.early_validity << " ordered "
      << r.redon.in_time_order << " in world " << r.redon.links_in_world << " visibility "
      << static_cast<int>(r.visibility) << ": "
      << (a.status == Status::free      ? "free"
          : a.status == Status::contact ? "contact"
                                        : "undecided")
      << " [" << a.t_lower << ", " << a.t_upper << "] certain " << a.certain;
  return out.str();
}

/// A scene that is asked for the first contacts of all pairs. Some start in contact, some have margins of their own.
void draw(campaign::Asked& asked, campaign::Case& c) {
  campaign::Random& random = asked.random;
  campaign::Scene& scene = asked.scene;
  scene = campaign::makeScene(c.id.family, random.bits());
  scene.margin = 0;
  scene.every_pair = true;
  // What starts in contact is asked about too: one obstacle in five comes to where a link starts.
  const bool ignore = random.chance(0.4);
  if (ignore && random.chance(0.7)) {
    int link_body = -1, obstacle = -1;
    for (int b = 0; b < static_cast<int>(scene.bodies.size()); ++b)
      (scene.bodies[static_cast<std::size_t>(b)].link >= 0 ? link_body : obstacle) = b;
    if (link_body >= 0 && obstacle >= 0) {
      campaign::Body& o = scene.bodies[static_cast<std::size_t>(obstacle)];
      o.pose.p = campaign::Kinematics(scene).bodyPose(link_body, 0).p + 0.05 * random.direction();
    }
  }
  asked.question = campaign::prepare(scene);
  asked.question.request.ignore_initial_contact = ignore;
  // Margins of their own take pairs from the paper's method.
  const bool margins = random.chance(0.4);
  c.tally.count("margins", margins);
  if (!margins) return;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    if (scene.bodies[b].link < 0 && random.chance(0.4))
      asked.question.manager->setMargin(scene.nameOf(static_cast<int>(b)),
                                        random.chance(0.3) ? 0 : random.uniform(0, 0.05));
  }
  asked.question.manager->setup();
}

/// The earliest sampled contact of pairs that are apart at t = 0, so that nobody ignores them; 2: none.
double firstSample(const campaign::Asked& asked) {
  double first = 2;
  for (const campaign::PairTruth& p : asked.truth().pairs) {
    if (!p.hit) continue;
    if (asked.question.request.ignore_initial_contact) {
      const campaign::Proximity start = asked.oracle().at(p.a, p.b, 0, 0.5);
      if (start.touching || start.gap < 0.06) continue;  // the largest margin, and a little
    }
    first = std::min(first, p.time);
  }
  return first;
}

/// No claim contradicts another, or a sample.
void judge(const campaign::Asked& asked, campaign::Case& c) {
  double free_before = 0, contact_by = 2;
  std::string free_says, contact_says;
  bool both = false;
  for (const campaign::Answer& answer : asked.answers) {
    const CertifiedRequest& request = answer.request;
    const CertifiedResult& result = answer.result;
    const std::string says = describe(request, result);
    const bool contact = result.status == Status::contact, free = result.status == Status::free;
    c.tally.count("answers");
    c.tally.count("free", free);
    c.tally.count("contact", contact);
    c.tally.count("undecided", result.status == Status::undecided);
    c.tally.count("ignored", !result.ignored_initial_contacts.empty());
    both = both || (result.statistics.redon.pairs_by_standard > 0 && result.statistics.redon.box_tests > 0);
    const double before = free ? 1 : result.t_lower;
    if (before > free_before) free_before = before, free_says = says;
    double by = contact && (result.certain || result.t_upper < 1) ? result.t_upper : 2;
    for (const auto& one : result.contacts) {
      if (one.certain) by = std::min(by, one.t_upper);
      if (contact && one.t_upper < result.t_lower) c.fault("early", "a contact before t_lower: " + says);
    }
    if (by < contact_by) contact_by = by, contact_says = says;
    if (free && by < 2) c.fault("free", "with a contact: " + says);
    if (result.contacts.size() > request.max_contacts && request.method == Method::redon2004)
      c.fault("many", "too many contacts: " + says);
    if (contact && result.contacts.empty()) c.fault("none", "contact of none: " + says);
  }
  c.tally.count("both methods", both);
  // t_upper is a computed time: nothing else is rounded here.
  if (contact_by < free_before) c.fault("claims", "one says\n  " + free_says + "\nanother\n  " + contact_says);
  const double sampled = firstSample(asked);
  c.tally.count("hits", sampled <= 1);
  if (sampled <= 1 && free_before > sampled)
    c.fault("missed", campaign::format("sampled contact at %.17g, and\n  ", sampled) + free_says);
}

TEST(Claims, NoTwoAnswersContradictEachOtherOrASample) {
  campaign::Arms arms;
  arms.number = [](std::uint64_t seed, std::uint64_t index) {
    static constexpr const char* kFamilies[] = {"chain/between", "tree/between", "chain/random", "tree/random",
                                                "chain/graze"};
    const std::uint64_t number = seed * 1000003 + index;
    return campaign::CaseId{kFamilies[number % 5], number};
  };
  arms.draw = draw;
  // The claims of the standard method are the first ones.
  arms.ways = {[](CertifiedRequest& request, campaign::Random&) { request.mode = ContactMode::first; }};
  arms.ways.resize(9, anyWay);
  arms.judges = {judge};
  campaign::Options o;
  o.cases = campaign::fromEnvironment("FCL_ARTIC_REDON_CLAIMS", 60);
  o.seed = campaign::fromEnvironment("FCL_ARTIC_REDON_SEED", 1);
  const campaign::Tally all = runWithoutFaults(campaignOf(arms), o).total;
  EXPECT_GE(all.share("free", "answers"), 0.1);
  EXPECT_GE(all.share("contact", "answers"), 0.2);
  EXPECT_GE(all.share("undecided", "answers"), 0.02);
  EXPECT_GE(all.share("both methods"), 0.25);
  EXPECT_GE(all.share("ignored", "answers"), 0.05);
  EXPECT_GE(all.share("hits"), 0.2);
}

}  // namespace

}  // namespace claims_test
