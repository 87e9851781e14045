// SPDX-License-Identifier: BSD-3-Clause
//
// Campaigns on the scenes of generator.h: arms, trees and single bodies before obstacles.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine.h"
#include "harness.h"
#include "oracle.h"
#include "random.h"

namespace campaign {

/// A scene, asked in one or more ways.
class Asked {
 public:
  explicit Asked(std::uint64_t seed) : random(Random::mix(0xc1a135, seed)) {}
  Asked(const Asked&) = delete;
  Asked& operator=(const Asked&) = delete;

  Random random;  ///< the case's own, for what the scene does not settle
  Scene scene;
  Question question;
  std::vector<Answer> answers;  ///< one for each way, in their order

  const fcl_artic::CertifiedResult& result(std::size_t way) const { return answers[way].result; }
  const Oracle& oracle() const;
  /// The first contact that sampling finds, of every pair if the scene asks for that.
  const Truth& truth() const;

 private:
  mutable std::optional<Oracle> oracle_;
  mutable std::optional<Truth> truth_;
};

/// Changes the request that a scene brings along.
using Way = std::function<void(fcl_artic::CertifiedRequest& request, Random& random)>;
using Judge = std::function<void(const Asked& asked, Case& c)>;

void asTheSceneSays(fcl_artic::CertifiedRequest& request, Random& random);
Way byMethod(fcl_artic::Method method);
Way byVisibility(fcl_artic::VisibilityMode mode);

/// Judges the answer of one way by the samples (checks.h), and counts how hard the cases are.
Judge againstSamples(std::size_t way = 0);

/// Makes a case's scene and question.
using Draw = std::function<void(Asked& asked, Case& c)>;
/// Draws the scene of the class and the seed, and changes it.
Draw drawAnd(std::function<void(Scene& scene)> change);

struct Arms {
  std::function<CaseId(std::uint64_t seed, std::uint64_t index)> number = inShares;
  Draw draw = drawAnd([](Scene&) {});
  std::vector<Way> ways = {asTheSceneSays};
  std::vector<Judge> judges = {againstSamples()};
  std::shared_ptr<const fcl_artic::VisibilityCuller> culler;  ///< who does stage 2; null: the executor cpu

  /// All classes in their shares.
  static CaseId inShares(std::uint64_t seed, std::uint64_t index);
};
Campaign campaignOf(Arms arms);

}  // namespace campaign
