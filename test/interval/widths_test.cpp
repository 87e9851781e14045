// SPDX-License-Identifier: BSD-3-Clause
//
// How wide the enclosures of an arm's motion are, as a multiple of the range that its points sweep.
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include <gtest/gtest.h>

#include "numerics/cases.h"
#include "redon/chain_bounds.h"

namespace fcl_artic {
namespace numerics_test {
namespace widths_test {
namespace {

constexpr int kJoints = 6;

/// The PUMA 560 by its Denavit and Hartenberg parameters: each origin moves along the last joint's axis and turns to
/// the next one's.
KinematicTree puma() {
  const double a[kJoints] = {0, 0, 0.4318, 0.0203, 0, 0}, d[kJoints] = {0, 0, 0, 0.15005, 0.4318, 0};
  const double twist[kJoints] = {0, M_PI_2, 0, -M_PI_2, M_PI_2, -M_PI_2};
  KinematicTree tree;
  tree.addLink("base");
  for (std::size_t i = 0; i < kJoints; ++i) {
    const std::string name = std::to_string(i);
    tree.addLink("link" + name);
    Joint joint;
    joint.name = "joint" + name;
    joint.parent = i == 0 ? "base" : "link" + std::to_string(i - 1);
    joint.child = "link" + name;
    joint.type = JointType::revolute;
    joint.axis = Eigen::Vector3d::UnitZ();
    joint.origin.linear() = Eigen::AngleAxisd(twist[i], Eigen::Vector3d::UnitX()).toRotationMatrix();
    joint.origin.translation() = Eigen::Vector3d(a[i], 0, d[i]);
    tree.addJoint(joint);
  }
  return tree;
}

/// Width of a tool point's box / range it sweeps, both summed over axes and random motions, per enclosure.
std::array<double, 3> widths(Random& random, double step_degrees) {
  constexpr Enclosure kEnclosures[3] = {Enclosure::intervalChain, Enclosure::meanValue, Enclosure::taylor};
  const KinematicTree tree = puma();
  const FrameSweep sweep = FrameSweep::fromWorld(tree);
  constexpr int kMotions = 40, kSamples = 64;
  std::array<double, 3> sum = {};
  double range = 0;
  for (int motion = 0; motion < kMotions; ++motion) {
    double coefficients[2 * kJoints];
    for (int v = 0; v < kJoints; ++v) {
      coefficients[v] = random.in(-M_PI, M_PI);
      coefficients[kJoints + v] = step_degrees * M_PI / 180 * (random.chance(0.5) ? 1 : -1);
    }
    engine::Query query;
    query.coefficients = coefficients;
    query.num_variables = kJoints;
    ChainBounds chain;
    chain.reset(sweep.view(), query);
    FrameBounds frames[kJoints];
    const double tool[3] = {0.03, 0.02, 0.056};
    const auto box = [&](double begin, double end, Enclosure enclosure) {
      chain.enclose(begin, end, enclosure, Derivatives::none, frames);
      const RoundUpward upward;
      return frames[kJoints - 1].pose * tool;
    };
    IntervalVec3 swept = box(0, 0, Enclosure::intervalChain);
    for (int i = 1; i <= kSamples; ++i) {
      const double t = static_cast<double>(i) / kSamples;
      swept = hull(swept, box(t, t, Enclosure::intervalChain));
    }
    for (int k = 0; k < 3; ++k) range += swept[k].width();
    for (std::size_t e = 0; e < 3; ++e) {
      const IntervalVec3 bound = box(0, 1, kEnclosures[e]);
      for (int k = 0; k < 3; ++k) sum[e] += bound[k].width();
    }
  }
  for (double& width : sum) width /= range;
  return sum;
}

TEST(ChainBounds, TighterEnclosuresAreTighter) {
  Random random(seedOf("Widths"));
  std::printf("width of a tool point's box / range it sweeps: interval chain, mean value, Taylor\n");
  for (const double step : {1.0, 5.0, 15.0, 30.0, 90.0}) {
    const std::array<double, 3> width = widths(random, step);
    std::printf("  %4.0f degrees  %6.3f  %6.3f  %6.3f\n", step, width[0], width[1], width[2]);
    EXPECT_GE(width[2], 0.99);  // samples miss some of the range
    EXPECT_GT(width[0], 2);     // the products' dependency doesn't vanish with the step
    EXPECT_LE(width[1], width[0]);
    EXPECT_LE(width[2], width[0]);
    if (step <= 30) {
      EXPECT_LT(width[2], width[1]);
    }
    if (step <= 5) {
      EXPECT_LT(width[2], 1.4);  // what a matrix of intervals loses: its entries don't peak together
    }
  }
}

}  // namespace
}  // namespace widths_test
}  // namespace numerics_test
}  // namespace fcl_artic
