// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include <gtest/gtest.h>

#include "checks.h"
#include "constructed.h"
#include "expect.h"
#include "random.h"

namespace campaign {
namespace constructed_test {
namespace {

using fcl_artic::CertifiedContact;
using fcl_artic::CertifiedResult;
using fcl_artic::Status;

constexpr int kCasesEach = 25;

/// The pose at t* carries the rounding of its chain (up to 3 joints, reach below 3 m): two transforms composed and one
/// inverted, some 30 roundings of at most 3 m * 2^-53 each, 1e-14 m; with the sines within 1e-13 m. At 0.1 m per unit
/// of t or faster that shifts the contact by up to 1e-12.
constexpr double kFloor = 1e-12;

struct ConstructedContact : testing::TestWithParam<std::tuple<std::string, std::string>> {};

TEST_P(ConstructedContact, IsBracketedAtItsPointAndNormal) {
  const auto& [contact, chain] = GetParam();
  int certain = 0;
  for (std::uint64_t i = 0; i < kCasesEach; ++i) {
    Constructed c = constructContact(contact, chain, Random::mix(4, i));
    if (i % 2) c.scene.tolerance_time = 1e-9;
    const Oracle oracle(c.scene);
    const Question question = prepare(c.scene);
    const QueryOfExpectations file("constructed-" + contact + "-" + chain + "-" + std::to_string(i),
                                   [&] { return question.manager->writeQuery(*question.motion, question.request); });
    const Answer answer = ask(question, question.request);
    const CertifiedResult& r = answer.result;
    ASSERT_EQ(r.status, Status::contact);
    EXPECT_LE(r.t_lower, c.time + kFloor) << "late by " << r.t_lower - c.time;
    EXPECT_GE(r.t_upper, c.time - kFloor) << "t_upper before the contact by " << c.time - r.t_upper;
    // From t_lower on at the latest within the distance tolerance.
    EXPECT_GE(r.t_lower, c.time - 2 * std::max(c.scene.tolerance_time, c.scene.tolerance_distance / c.normal_speed));
    certain += r.certain;

    ASSERT_FALSE(r.contacts.empty());
    const CertifiedContact& k = r.contacts[0];
    const bool swapped = answer.bodyOf(k.body1.object) == 1;
    EXPECT_EQ(answer.bodyOf(k.body1.object) + answer.bodyOf(k.body2.object), 1);
    // Directions that part the bodies while their gap is g lie within g / size of the normal, on a smooth side within
    // sqrt(g / radius). A direction is kept for as long as it proves, from gaps of some 1e-6 m on: hence 1e-5 rad.
    const double width = std::max(k.certain ? k.t_upper - k.t_lower : 0, c.time - k.t_lower);
    const double depth = width * oracle.kinematics().relativeSpeed(0, 1) + 1e-9;
    const double spread = c.curved ? 4 * std::sqrt(depth / 0.03) + 1e-5 : 100 * depth + 1e-5;
    EXPECT_LE((k.normal * (swapped ? -1 : 1) - c.normal).norm(), spread);
    const Vec3 off = k.point - c.point;
    EXPECT_LE(std::abs(off.dot(c.normal)), 10 * depth);
    if (!c.region) {
      EXPECT_LE(off.norm(), c.curved ? 4 * std::sqrt(depth) : 100 * depth);
    }

    Truth truth;
    truth.pairs.push_back(oracle.firstContact(0, 1, std::min(1.0, c.time + 1e-3)));
    truth.hit = truth.pairs[0].hit;
    truth.time = truth.pairs[0].time;
    EXPECT_GE(truth.time, c.time - kFloor) << "the construction, or the oracle, is wrong";
    for (const Finding& f : examine(c.scene, oracle, truth, answer)) ADD_FAILURE() << f.fault << ": " << f.text;
  }
  EXPECT_GE(certain, kCasesEach / 2);
  RecordProperty("certain", certain);
}

std::string nameOf(const testing::TestParamInfo<ConstructedContact::ParamType>& info) {
  std::string name = std::get<0>(info.param) + "_" + std::get<1>(info.param);
  for (char& c : name)
    if (c == ' ') c = '_';
  return name;
}

std::vector<std::tuple<std::string, std::string>> combinations() {
  std::vector<std::tuple<std::string, std::string>> all;
  for (const std::string& contact : contactKinds())
    for (const std::string& chain : chainKinds())
      // Faces don't stay parallel while they approach by turning.
      if (contact != "face on face" || chain != "revolute") all.emplace_back(contact, chain);
  return all;
}

INSTANTIATE_TEST_SUITE_P(Campaign, ConstructedContact, testing::ValuesIn(combinations()), nameOf);

}  // namespace
}  // namespace constructed_test
}  // namespace campaign
