// SPDX-License-Identifier: BSD-3-Clause
#include "arms.h"

#include <algorithm>
#include <chrono>

#include "checks.h"
#include "generator.h"

namespace campaign {
namespace {

using fcl_artic::CertifiedResult;
using fcl_artic::Status;
using Clock = std::chrono::steady_clock;

double microseconds(Clock::time_point from) {
  return std::chrono::duration<double, std::micro>(Clock::now() - from).count();
}

bool freeAtEnd(const Oracle& oracle) {
  for (const auto& [a, b] : oracle.kinematics().pairs())
    if (oracle.at(a, b, 1, 0.5).touching) return false;
  return true;
}

std::string describe(const Asked& asked) {
  std::string words;
  for (const PairTruth& p : asked.truth().pairs) {
    const char* verdict = p.hit ? "hit" : p.doubtful ? "doubtful" : "free";
    words += format("oracle %d %d: %s t %.17g gap %.6g at %.17g\n", p.a, p.b, verdict, p.time, p.gap, p.gap_time);
  }
  for (const Answer& answer : asked.answers) {
    static constexpr const char* kVerdicts[] = {"free", "contact", "undecided"};
    const CertifiedResult& r = answer.result;
    words += format("answer %s [%.17g, %.17g]%s in %.1f us\n", kVerdicts[static_cast<int>(r.status)], r.t_lower,
                    r.t_upper, r.certain ? " certain" : "", answer.elapsed_us);
    for (const fcl_artic::CertifiedContact& c : r.contacts) {
      words += format("  %d/%ld %d/%ld [%.17g, %.17g]%s point %.9g %.9g %.9g normal %.9g %.9g %.9g\n",
                      answer.bodyOf(c.body1.object), static_cast<long>(c.b1), answer.bodyOf(c.body2.object),
                      static_cast<long>(c.b2), c.t_lower, c.t_upper, c.certain ? " certain" : "", c.point.x(),
                      c.point.y(), c.point.z(), c.normal.x(), c.normal.y(), c.normal.z());
    }
  }
  return words;
}

}  // namespace

const Oracle& Asked::oracle() const {
  if (!oracle_) oracle_.emplace(scene);
  return *oracle_;
}

const Truth& Asked::truth() const {
  if (!truth_) truth_ = oracle().judge(scene.every_pair);
  return *truth_;
}

void asTheSceneSays(fcl_artic::CertifiedRequest&, Random&) {}

Way byMethod(fcl_artic::Method method) {
  return [method](fcl_artic::CertifiedRequest& request, Random&) { request.method = method; };
}

Way byVisibility(fcl_artic::VisibilityMode mode) {
  return [mode](fcl_artic::CertifiedRequest& request, Random&) { request.visibility = mode; };
}

Judge againstSamples(std::size_t way) {
  return [way](const Asked& asked, Case& c) {
    const auto begin = Clock::now();
    const Truth& truth = asked.truth();
    c.tally.note("oracle, us", microseconds(begin));
    const auto judge = [&](const Answer& answer) { return examine(asked.scene, asked.oracle(), truth, answer); };
    const Answer& answer = asked.answers[way];
    tryMutants(mutants(), asked.scene, answer, judge, c);
    for (Finding& finding : judge(answer)) c.findings.push_back(std::move(finding));

    const CertifiedResult& r = answer.result;
    const bool contact = r.status == Status::contact, uncertain = contact && !r.certain;
    c.tally.count("hits", truth.hit);
    c.tally.count("starts", truth.hit && truth.time == 0);
    c.tally.count("between", truth.hit && truth.time > 0 && freeAtEnd(asked.oracle()));  // two free ends
    c.tally.count("grazes", !truth.hit && std::any_of(truth.pairs.begin(), truth.pairs.end(),
                                                      [](const PairTruth& p) { return p.gap < 1e-3; }));
    c.tally.count("doubtful", !truth.hit && truth.doubtful);  // contact by the rounded corners alone
    c.tally.count("contact", contact);
    c.tally.count("certain", contact && r.certain);
    c.tally.count("uncertain", uncertain);
    c.tally.count("with margin", uncertain && asked.scene.margin > 0);
    c.tally.count("undecided", r.status == Status::undecided);
    c.tally.count("beyond", contact && r.certain && !truth.hit);  // the samples did not find it
    if (r.certain && truth.hit) c.tally.note("sampled contact - t_lower (certain hits)", truth.time - r.t_lower);
  };
}

CaseId Arms::inShares(std::uint64_t seed, std::uint64_t index) {
  return {familyOf(seed, index), Random::mix(seed, index)};
}

Draw drawAnd(std::function<void(Scene& scene)> change) {
  return [change = std::move(change)](Asked& asked, Case& c) {
    asked.scene = makeScene(c.id.family, c.id.seed);
    change(asked.scene);
    asked.question = prepare(asked.scene);
  };
}

Campaign campaignOf(Arms arms) {
  const auto number = arms.number;
  return {families(), number,
          [arms = std::move(arms)](Case& c) {
            const auto begin = Clock::now();
            Asked asked(c.id.seed);
            arms.draw(asked, c);
            c.tally.note("making, us", microseconds(begin));
            asked.question.manager->setVisibility(arms.culler);
            for (const Way& way : arms.ways) {
              fcl_artic::CertifiedRequest request = asked.question.request;
              way(request, asked.random);
              c.query([&] { return asked.question.manager->writeQuery(*asked.question.motion, request); });
              asked.answers.push_back(ask(asked.question, request));
              c.tally.note("query, us", asked.answers.back().elapsed_us);
            }
            if (c.words) *c.words += describe(asked);
            for (const Judge& judge : arms.judges) judge(asked, c);
          },
          "arms"};
}

}  // namespace campaign
