// SPDX-License-Identifier: BSD-3-Clause
// Tolerances: tubes of which it is known by closed forms how wide they may be, and random ones against samples.
#include <gtest/gtest.h>

#include "../report.h"
#include "tubes.h"

namespace verify::test {
namespace tube_test {

void expectRefused(const Verdict& v, const std::string& words = "not shown to be apart") {
  EXPECT_FALSE(v.verified);
  EXPECT_NE(v.reason.find(words), std::string::npos) << v.reason;
}
void expectVerified(const Verdict& v) {
  EXPECT_TRUE(v.verified) << v.reason;
}
double chord(double angle) {
  return 2 * std::sin(angle / 2);
}

// The bound of the verifier is exact where all chords go straight to the obstacle. Then rounding is all that is left:
// rotations are meant up to 2^-49, so 2e-14 m. In these tubes that is a part of 1e-12 of the tolerance where they stand
// still. It is 1e-7 where one only passes by, as the verifier halves time at most 14 times.
constexpr double kStill = 1e-12, kPassing = 1e-7;

std::string turnLine(int variable, double multiplier = 1, const V& axis = {0, 0, 1}) {
  return "turn " + hex(axis) + " " + std::to_string(variable) + " " + hex(multiplier) + " " + hex(0) + "\n";
}
std::string slideLine(int variable, double multiplier, const V& axis) {
  return "slide " + hex(axis) + " " + std::to_string(variable) + " " + hex(multiplier) + " " + hex(0) + "\n";
}
std::string tolerance(const std::string& of, double d) {
  return "tolerance " + of + " " + hex(d) + "\n";
}

enum class Below { halfspace, ball };

/// The floor under a point: y <= height, or a ball of radius 0.3 straight below (x, y).
std::string floorUnder(Below below, double x, double height) {
  if (below == Below::halfspace)
    return "geometry halfspace " + hex(V{0, 1, 0}) + " " + hex(height) + "\nbody obstacle floor 0 0 " + hex(kHere) +
           "\n";
  return "geometry sphere " + hex(0.3) + "\nbody obstacle floor 0 0 " + hex(at(x, height - 0.3, 0)) + "\n";
}
std::string proofOf(Below below) {
  return below == Below::halfspace ? std::string(1, '\x09') : fine({0, 1, 0});
}

/// Accepted up to the tolerance `d`, and from there on refused.
/// @param world  its text with a tolerance of that factor of d.
void expectExact(const std::function<std::string(double)>& world, const MotionText& motion, const std::string& proof,
                 double slack) {
  const World fits = readWorld(world(1 - slack)), none = readWorld(world(1 + slack));
  expectVerified(judge(fits, motion.write(fits), proof));
  expectRefused(judge(none, motion.write(none), proof));
}

// The tip of an arm of length L stands at the angle d/2. Within d of it, it reaches down to the angle -d/2: straight
// down by 2 L sin(d/2).
TEST(VerifyTube, OneTurn) {
  for (const Below below : {Below::halfspace, Below::ball})
    for (const double d : {1e-4, 0.02, 0.7, 3.0})
      for (const double multiplier : {1.0, -3.0}) {
        if (std::fabs(multiplier) * d > 3) continue;
        SCOPED_TRACE(std::to_string(d) + " " + std::to_string(multiplier) + (below == Below::ball ? " ball" : ""));
        const double L = 0.8, angle = std::fabs(multiplier) * d;
        const auto text = [&](double factor) {
          return kHead + "variable a\nframe arm 0 " + hex(kHere) + "\n" + turnLine(0, multiplier) + "geometry sphere " +
                 hex(0) + "\n" + "body link tip 1 0 " + hex(at(L, 0, 0)) + "\n" +
                 [&] {
                   std::string s = floorUnder(below, L * std::cos(angle / 2), -L * std::sin(angle / 2));
                   s.replace(s.find("floor 0 0"), 9, "floor 0 1");
                   return s;
                 }() +
                 tolerance("variable 0", factor * d);
        };
        // (A body of higher number, the floor, has the roots: its partner is the tip.)
        const std::string proof = below == Below::halfspace ? std::string(1, '\x09') : fine({0, -1, 0});
        MotionText still;
        still.pieces = {"q 0 " + hex(angle / 2 / multiplier) + "\n"};
        expectExact(text, still, proof, std::max(below == Below::ball ? 1e-8 : kStill, 2e-14 / d));
        if (d > 1) continue;
        // Down to that angle and back: 4 (t - 1/2)^2 above it.
        MotionText passing;
        passing.pieces = {"q 0 " + hex((angle / 2 + 0.25) / multiplier) + " " + hex(-1 / multiplier) + " " +
                          hex(1 / multiplier) + "\n"};
        expectExact(text, passing, proof, below == Below::ball ? 1e-6 : kPassing * std::max(1.0, 1e-3 / d));
      }
}

// Two links. Within d1 and d2 both chords go straight down where the tip stands at the angle d1/2 as seen from the
// first axis, and the second link at d1 + d2/2.
struct TwoTurns {
  double L1 = 0.8, L2 = 0.5, d1, d2, q1, q2, rho1, x, height;
  TwoTurns(double a, double b) : d1(a), d2(b) {
    const double phi = d1 / 2, psi = d1 + d2 / 2, first = phi - std::asin(L2 / L1 * std::sin(psi - phi));
    q1 = first;
    q2 = psi - first;
    rho1 = L1 * std::cos(first - phi) + L2 * std::cos(psi - phi);
    x = rho1 * std::cos(phi);
    height = rho1 * std::sin(phi) - chord(d1) * rho1 - chord(d2) * L2;
  }
  /// @param second  lines of the second frame's elements.
  std::string world(Below below, const std::string& second, const std::string& tolerances) const {
    return kHead + "variable a\nvariable b\nframe one 0 " + hex(kHere) + "\n" + turnLine(0) + "frame two 1 " +
           hex(at(L1, 0, 0)) + "\n" + second + floorUnder(below, x, height) + "geometry sphere " + hex(0) +
           "\nbody link tip 2 1 " + hex(at(L2, 0, 0)) + "\n" + tolerances;
  }
};

TEST(VerifyTube, TwoTurns) {
  for (const Below below : {Below::halfspace, Below::ball})
    for (const auto& [d1, d2] : {std::pair(0.01, 0.02), std::pair(0.3, 0.1), std::pair(1e-3, 0.4)}) {
      const TwoTurns arm(d1, d2);
      const auto text = [&, one = d1, two = d2](double factor) {
        return arm.world(below, turnLine(1),
                         tolerance("variable 0", factor * one) + tolerance("variable 1", factor * two));
      };
      MotionText m;
      m.pieces = {"q 0 " + hex(arm.q1) + "\nq 1 " + hex(arm.q2) + "\n"};
      expectExact(text, m, proofOf(below), below == Below::ball ? 1e-8 : kStill);
    }
}

// The second joint mimics the first: |m| of its tolerance. (The other sign is no better: errors are added up as if they
// were independent.)
TEST(VerifyTube, AMimicTakesItsMultipleOfTheTolerance) {
  for (const double multiplier : {0.5, 3.0}) {
    const double d = 0.05;
    const TwoTurns arm(d, multiplier * d);
    const auto text = [&](double factor) {  // q2 = m q1 + c
      std::string s = arm.world(
          Below::halfspace,
          "turn " + hex(V{0, 0, 1}) + " 0 " + hex(multiplier) + " " + hex(arm.q2 - multiplier * arm.q1) + "\n",
          tolerance("variable 0", factor * d));
      return s.replace(s.find("variable b\n"), 11, "");
    };
    MotionText m;
    m.pieces = {"q 0 " + hex(arm.q1) + "\n"};
    expectExact(text, m, proofOf(Below::halfspace), kStill);
  }
}

/// A box of 0.2 m below `elements`, its centre at y = 1 over the floor y <= 0.
World boxOver(const std::string& variables, const std::string& elements, const std::string& tolerances, double y = 1) {
  return readWorld(kHead + variables + "frame f 0 " + hex(at(0, y, 0)) + "\n" + elements +
                   floorUnder(Below::halfspace, 0, 0) + "geometry box " + hex(V{0.2, 0.2, 0.2}) +
                   "\nbody link box 1 1 " + hex(kHere) + "\n" + tolerances);
}
MotionText standing() {
  MotionText m;
  m.pieces = {""};
  return m;
}

TEST(VerifyTube, Slides) {
  const std::string wall(1, '\x09');
  for (const double multiplier : {1.0, -2.5}) {
    const auto fits = [&](double d) {
      const World world = boxOver("variable x\n", slideLine(0, multiplier, {0, 2, 0}), tolerance("variable 0", d));
      return judge(world, standing().write(world), wall);
    };
    expectVerified(fits(0.9 / std::fabs(multiplier) * (1 - kStill)));
    expectRefused(fits(0.9 / std::fabs(multiplier) * (1 + kStill)));
  }
  // A vector of three slides has one length, also along no axis; three tolerances of their own add up.
  const std::string three = "variable x\nvariable y\nvariable z\n",
                    slides = slideLine(0, 1, {1, 0, 0}) + slideLine(1, 1, {0, -1, 0}) + slideLine(2, 1, {0, 0, 1});
  const World fits = boxOver(three, slides, tolerance("vector 0 3", 0.9 * (1 - kStill))),
              none = boxOver(three, slides, tolerance("vector 0 3", 0.9 * (1 + kStill))),
              sum = boxOver(
                  three, slides,
                  tolerance("variable 0", 0.31) + tolerance("variable 1", 0.31) + tolerance("variable 2", 0.31));
  expectVerified(judge(fits, standing().write(fits), wall));
  expectRefused(judge(none, standing().write(none), wall));
  expectRefused(judge(sum, standing().write(sum), wall));
}

// A joint that mimics a vector takes its multiple. Slides that do not follow each other are no vector.
TEST(VerifyTube, VectorsAreSlidesOneAfterTheOther) {
  const std::string three = "variable x\nvariable y\nvariable z\n", wall(1, '\x09');
  const auto slides = [](const std::vector<int>& order, double last) {
    std::string s;
    for (const int v : order)
      s += slideLine(v, v == 1 ? last : -2, {v == 0 ? 1.0 : 0, v == 1 ? 1.0 : 0, v == 2 ? 1.0 : 0});
    return s;
  };
  for (const double d : {0.449, 0.451}) {
    const World world = boxOver(three, slides({0, 1, 2}, 2), tolerance("vector 0 3", d));
    EXPECT_EQ(judge(world, standing().write(world), wall).verified, d < 0.45);
  }
  EXPECT_NO_THROW(boxOver(three, slides({0, 1, 2}, 2), tolerance("vector 0 2", 1)));
  EXPECT_THROW(boxOver(three, slides({0, 2, 1}, 2), tolerance("vector 0 2", 1)), BadInput);
  EXPECT_THROW(boxOver(three, slides({0, 1, 2}, 1), tolerance("vector 0 2", 1)), BadInput);
}

// A tip that turns about a point by d, whatever the axis, from the angle d/2 over it: straight down by 2 r sin(d/2).
TEST(VerifyTube, PosesAndRotations) {
  const double d = 0.04, r = 0.6, length = 0.01;
  M place = at(r * std::cos(d / 2), r * std::sin(d / 2), 0);
  const std::string tip = "geometry sphere " + hex(0) + "\n",
                    floor = floorUnder(Below::halfspace, 0, -r * std::sin(d / 2)),
                    lower = floorUnder(Below::halfspace, 0, -r * std::sin(d / 2) - length);
  const auto rotation = [&](double factor) {
    return kHead + "variable u\nvariable v\nvariable w\nframe f 0 " + hex(kHere) + "\nrotate 0\n" + floor + tip +
           "body link tip 1 1 " + hex(place) + "\n" + tolerance("rotation 0", factor * d);
  };
  expectExact(rotation, standing(), proofOf(Below::halfspace), kStill);
  // A frame that stands; a motion needs something that moves: a turn below it about the tip.
  const auto frame = [&](double factor) {
    return kHead + "variable a\nframe base 0 " + hex(at(-2, 0, 0.5)) + "\nframe arm 1 " + hex(at(2, 0, -0.5) * place) +
           "\n" + turnLine(0) + lower + tip + "body link tip 2 1 " + hex(kHere) + "\n" + "tolerance frame 1 " +
           hex(factor * length) + " " + hex(factor * d) + " " + hex(V{2, 0, -0.5}) + "\n";
  };
  expectExact(frame, standing(), proofOf(Below::halfspace), kStill);
  // The frame that turns has it itself.
  const auto own = [&](double factor) {
    std::string s = kHead + "variable a\nframe arm 0 " + hex(kHere) + "\n" + turnLine(0) + lower + tip +
                    "body link tip 1 1 " + hex(at(r, 0, 0)) + "\n" + "tolerance frame 1 " + hex(factor * length) + " " +
                    hex(factor * d) + " " + hex(V{0, 0, 0}) + "\n";
    return s;
  };
  MotionText at_angle;
  at_angle.pieces = {"q 0 " + hex(d / 2) + "\n"};
  expectExact(own, at_angle, proofOf(Below::halfspace), kStill);
  // The floor itself, about a pivot: seen from it the tip moves. And a tip about a pivot of its own.
  for (const std::string name : {"floor", "tip"}) {
    const auto body = [&](double factor) {
      return kHead + "variable a\nframe arm 0 " + hex(at(0, 0, -0.75) * place) + "\n" + turnLine(0) + lower + tip +
             "body link tip 1 1 " + hex(at(0, 0, 0.75)) + "\n" + "tolerance body " + name + " " + hex(factor * length) +
             " " + hex(factor * d) + " " + hex(name == "floor" ? V{0, 0, 0} : -1 * place.t) + "\n";
    };
    expectExact(body, standing(), proofOf(Below::halfspace), kStill);
  }
}

// A long arm passes over a small ball near its axis. Seen from the ball the far end of the arm moves most, seen from
// the arm the ball hardly does.
TEST(VerifyTube, BothSidesMayBeSeenFromAnyPlaceBetween) {
  const auto verdict = [&](double d) {
    const World world =
        readWorld(kHead + "variable a\nframe arm 0 " + hex(kHere) + "\n" + turnLine(0) + "geometry sphere " +
                  hex(0.01) + "\ngeometry box " + hex(V{2, 0.1, 0.1}) + "\nbody obstacle ball 0 0 " +
                  hex(at(0.1, 0.1, 0)) + "\nbody link arm 1 1 " + hex(at(1, 0, 0)) + "\n" + tolerance("variable 0", d));
    return judge(world, standing().write(world), sep({0, -1, 0}));
  };
  // The gap is 0.04; the ball's farthest point is 0.1514 from the axis, the arm's 2.0006.
  expectVerified(verdict(0.2));
  expectRefused(verdict(0.28));
  // Two links of one base: joints on both branches count, each with the points of the side beyond it.
  const auto branches = [&](double a, double b) {
    const auto place = [](double x, double angle) {
      M m = rotationAbout({0, 0, 1}, -angle);
      m.t = turn(m, {x, 0, 0});
      return m;
    };
    const World world =
        readWorld(kHead + "variable a\nvariable b\nframe one 0 " + hex(at(-1, 0, 0)) + "\n" + turnLine(0) +
                  "frame two 0 " + hex(at(1, 0, 0)) + "\n" + turnLine(1) + "geometry sphere " + hex(0) +
                  "\nbody link left 1 0 " + hex(place(0.9, 0.5)) + "\nbody link right 2 0 " + hex(place(-0.9, 1)) +
                  "\n" + tolerance("variable 0", a) + tolerance("variable 1", b));
    MotionText m;
    m.pieces = {"q 0 " + hex(0.5) + "\nq 1 " + hex(1) + "\n"};
    return judge(world, m.write(world), sep({1, 0, 0}));
  };
  const double all = 2 * std::asin(0.05 / 0.9);  // (chord(a) + chord(b)) 0.9 = 0.2 for a = b
  expectVerified(branches(all * 0.999, all * 0.999));
  expectRefused(branches(all * 1.001, all * 1.001));
  expectVerified(branches(all * 1.2, all * 0.79));
  expectRefused(branches(all * 1.2, all * 0.81));
}

// A wall on a link of a link: only the points of the other body have a distance from the joints' axes. The second axis
// is at (1/2, 0) of the first link, which is turned by 1 rad.
TEST(VerifyTube, AWallThatMovesIsSeenFromItself) {
  const V there{0.3 * std::cos(1) + 0.5 * std::sin(1) - 0.5, -0.3 * std::sin(1) + 0.5 * std::cos(1), 0};
  const auto text = [&](double factor) {
    return kHead + "variable a\nvariable b\nframe one 0 " + hex(kHere) + "\n" + turnLine(0) + "frame two 1 " +
           hex(at(0.5, 0, 0)) + "\n" + turnLine(1) + "geometry sphere " + hex(0) + "\ngeometry halfspace " +
           hex(V{0, 1, 0}) + " " + hex(there[1] - chord(0.1) * norm(there)) + "\nbody obstacle point 0 0 " +
           hex(at(0.3, 0.5, 0)) + "\nbody link wall 2 1 " + hex(kHere) + "\n" + tolerance("variable 1", factor * 0.1);
  };
  MotionText m;
  m.pieces = {"q 0 " + hex(1) + "\n"};
  expectExact(text, m, proofOf(Below::halfspace), 10 * kStill);
}

// The distance to the axis grows from 0 to 1 while the tip slides out: the most counts, not the middle's.
TEST(VerifyTube, TheWholeIntervalCounts) {
  const auto verdict = [&](double slope, double bend, double d, const std::string& proof) {
    const World world = readWorld(kHead + "variable a\nvariable x\nframe arm 0 " + hex(kHere) + "\n" + turnLine(0) +
                                  "frame tip 1 " + hex(kHere) + "\n" + slideLine(1, 1, {1, 0, 0}) +
                                  floorUnder(Below::halfspace, 0, -0.1) + "geometry sphere " + hex(0) +
                                  "\nbody link tip 2 1 " + hex(kHere) + "\n" + tolerance("variable 0", d));
    MotionText m;
    m.pieces = {"q 1 " + hex(slope < 0 ? -slope : 0.0) + " " + hex(slope) + " " + hex(bend) + "\n"};
    return judge(world, m.write(world), proof);
  };
  const std::string wall(1, '\x09'), cut = node(kTime, wall, wall);
  for (const std::string& proof : {wall, cut})
    for (const auto& [slope, bend] : {std::pair(1.0, 0.0), std::pair(-1.0, 0.0), std::pair(4.0, -4.0)}) {
      const double d = 2 * std::asin(0.05);  // chord 0.1
      expectVerified(verdict(slope, bend, d * 0.9999, proof));
      expectRefused(verdict(slope, bend, d * 1.0001, proof));
    }
}

// More than half a turn takes the tip to the other side of the axis, and not back from there.
TEST(VerifyTube, MoreThanHalfATurnIsAllOfTheCircle) {
  const auto verdict = [](double d, double height) {
    const World world = readWorld(kHead + "variable a\nframe arm 0 " + hex(kHere) + "\n" + turnLine(0) +
                                  floorUnder(Below::halfspace, 0, height) + "geometry sphere " + hex(0) +
                                  "\nbody link tip 1 1 " + hex(at(0, 1, 0)) + "\n" + tolerance("variable 0", d));
    return judge(world, standing().write(world), std::string(1, '\x09'));
  };
  for (const double d : {3.13, kPi, 3.5, 6.28, 100.0}) {
    expectVerified(verdict(d, -1.0001));
    expectRefused(verdict(d, -0.999));
  }
}

// A planar joint: its frame's origin is where the slides begin, not where they lead.
TEST(VerifyTube, TheFramesOriginIsBeforeItsElements) {
  const auto text = [](double factor) {
    return kHead + "variable x\nvariable y\nvariable a\nframe f 0 " + hex(kHere) + "\n" + slideLine(0, 1, {1, 0, 0}) +
           slideLine(1, 1, {0, 1, 0}) + turnLine(2) + floorUnder(Below::halfspace, 0, -std::sin(0.05)) +
           "geometry sphere " + hex(0) + "\nbody link tip 1 1 " + hex(kHere) + "\ntolerance frame 1 " + hex(0) + " " +
           hex(factor * 0.1) + " " + hex(V{0, 0, 0}) + "\n";
  };
  MotionText m;
  m.pieces = {"q 0 " + hex(std::cos(0.05)) + "\nq 1 " + hex(std::sin(0.05)) + "\nq 2 " + hex(1) + "\n"};
  expectExact(text, m, proofOf(Below::halfspace), kStill);
  // The turn's own tolerance: about where the slides lead, where the tip is.
  const World world = readWorld([&] {
    std::string s = text(1);
    return s.substr(0, s.find("tolerance")) + tolerance("variable 2", 3) + tolerance("variable 1", 0.0999);
  }());
  expectVerified(judge(world, m.write(world), proofOf(Below::halfspace)));
}

// Partners of one leaf: each with what it gives itself, and with the joints that lead to it.
TEST(VerifyTube, PartnersOfOneLeafDiffer) {
  const auto verdict = [](double first, double second, double joint) {
    const std::string none = hex(V{0, 0, 0}) + "\n";
    const World world =
        readWorld(kHead + "variable x\nvariable y\nframe one 0 " + hex(kHere) + "\n" + slideLine(0, 1, {1, 0, 0}) +
                  "frame two 1 " + hex(kHere) + "\n" + slideLine(1, 1, {0, 1, 0}) + "geometry sphere " + hex(0.1) +
                  "\nbody obstacle first 0 0 " + hex(at(0, -1, 0)) + "\nbody obstacle second 0 0 " +
                  hex(at(0.5, -1, 0)) + "\nbody obstacle third 0 0 " + hex(at(-0.5, -1, 0)) + "\nbody link near 1 0 " +
                  hex(at(0, -1, 0.5)) + "\nbody link tip 2 0 " + hex(kHere) +
                  "\nunchecked allowed near first\nunchecked allowed near second\nunchecked allowed near third\n" +
                  "tolerance body first " + hex(first) + " " + hex(0) + " " + none + "tolerance body second " +
                  hex(second) + " " + hex(0) + " " + none + tolerance("variable 0", joint));
    return judge(world, standing().write(world), sep({0, 1, 0}));
  };
  expectVerified(verdict(0.3, 0.3, 0.49));
  expectRefused(verdict(0.31, 0.3, 0.5));
  expectRefused(verdict(0.3, 0.31, 0.5));
  expectRefused(verdict(0.1, 0.1, 0.81));
}

TEST(VerifyTube, MarginsAndTolerancesAddUp) {
  const auto verdict = [&](double margin, double d) {
    const World world = boxOver("variable y\n", slideLine(0, 1, {0, 1, 0}), tolerance("variable 0", d));
    MotionText m = standing();
    m.margin = margin;
    return judge(world, m.write(world), std::string(1, '\x09'));
  };
  expectVerified(verdict(0.4999, 0.4));
  expectRefused(verdict(0.5001, 0.4));
  expectRefused(verdict(0.4999, 0.4002));
}

// A joint that carries both bodies does not count.
TEST(VerifyTube, WhatBothBodiesShareDoesNotCount) {
  const World world =
      readWorld(kHead + "variable a\nvariable b\nframe one 0 " + hex(kHere) + "\n" + turnLine(0) + "frame two 1 " +
                hex(at(5, 0, 0)) + "\n" + turnLine(1) + "geometry sphere " + hex(0.1) + "\nbody link left 1 0 " +
                hex(at(5.5, 0, 0)) + "\nbody link right 2 0 " + hex(kHere) + "\ntolerance variable 0 " + hex(1) +
                "\ntolerance frame 1 " + hex(9) + " " + hex(3) + " " + hex(V{0, 0, 0}) + "\n");
  expectVerified(judge(world, standing().write(world), sep({-1, 0, 0})));
}

// A solid of many pieces: no part of it is inside of the other at the beginning, and the surfaces stay apart in the
// whole tube, which hangs together.
TEST(VerifyTube, SolidsStayOutside) {
  const auto verdict = [&](double d, const std::string& points) {
    const World world =
        readWorld(kHead + "variable x\nframe f 0 " + hex(kHere) + "\n" + slideLine(0, 1, {1, 0, 0}) +
                  boxMesh({1, 1, 1}, true) + boxMesh({0.5, 0.5, 0.5}, true) + "body obstacle large 0 0 " + hex(kHere) +
                  "\nbody link small 1 1 " + hex(at(2, 0, 0)) + "\n" + tolerance("variable 0", d));
    const std::string s = sep({1, 0, 0});
    return judge(world, standing().write(world), std::string(1, kSolid) + points + cutNode(kOwn, 6, s, s));
  };
  const std::string points = varint(2) + varint(0) + std::string(1, '\0') + varint(0) + std::string(1, '\x03');
  const Verdict good = verdict(0.4999, points);
  expectVerified(good);
  expectRefused(verdict(0.5001, points));
}

/// A ball of radius 0.1 on a slide along x, and one of radius 0.2 at (0, y, 0), which may move by itself.
struct Person {
  double y = 1;
  std::string world(double speed, double since, const std::string& more = "") const {
    return kHead + "variable a\nframe cart 0 " + hex(kHere) + "\n" + slideLine(0, 1, {1, 0, 0}) + "geometry sphere " +
           hex(0.1) + "\ngeometry sphere " + hex(0.2) + "\nbody obstacle person 0 1 " + hex(at(0, y, 0)) +
           "\nbody link cart 1 0 " + hex(kHere) + "\n" + "tolerance speed person " + hex(speed) + " " + hex(since) +
           "\n" + more;
  }
  /// The cart stands still for two pieces, up to these times.
  static MotionText still(double first, double second) {
    MotionText m;
    m.pieces = {"clock " + hex(0) + " " + hex(first) + "\n", "clock " + hex(first) + " " + hex(second) + "\n"};
    return m;
  }
  std::string proof() const { return fine({0, -1, 0}) + fine({0, -1, 0}); }
};

// The two are 0.7 m apart: the speed v gets there in 0.7 / v s from when on the person moves.
TEST(VerifyTube, ASpeedIsExact) {
  const Person person;
  for (const double since : {0.0, 0.75, -0.5}) {
    const auto world = [&](double factor) { return person.world(factor * 0.7 / (2 - since), since); };
    expectExact(world, Person::still(1.25, 2), person.proof(), kStill);
    // So is the time: a later end is refused, and a later beginning of the person's moves is another claim.
    const World fits = readWorld(world(1 - kStill));
    expectRefused(judge(fits, Person::still(1.25, 2.001).write(fits), person.proof()));
    const World later = readWorld(person.world(0.7 / (2 - since), since + 0.001));
    expectVerified(judge(later, Person::still(1.25, 2).write(later), person.proof()));
    // A claim up to t = 1/2 of the second piece is about its clock's time there.
    MotionText half = Person::still(1.25, 2.75);
    half.until = 0.5;
    expectVerified(judge(fits, half.write(fits), person.proof()));
    half.until = 0.501;
    expectRefused(judge(fits, half.write(fits), person.proof()));
  }
  // It counts beside the pose's tolerance, for a body that is carried, and for both.
  const std::string pose = "tolerance body person " + hex(0.3) + " " + hex(0) + " " + hex(V{0, 0, 0}) + "\n";
  expectExact([&](double factor) { return person.world(factor * 0.2, 0, pose); }, Person::still(1, 2), person.proof(),
              kStill);
  expectExact(
      [&](double factor) {
        return person.world(0.2, 0, "tolerance speed cart " + hex(factor * 0.3) + " " + hex(1) + "\n");
      },
      Person::still(1, 2), person.proof(), kStill);
}

// The cart goes away by t^2, the person comes by t: they are nearest, by 1/4 less than at both ends, in the middle.
TEST(VerifyTube, AWayCountsBetweenItsEnds) {
  for (const double gap : {0.2, 0.249, 0.251}) {
    Person person;
    person.y = 0.3 + gap;
    std::string text = person.world(1, 0);
    const std::string along = slideLine(0, 1, {1, 0, 0});
    text.replace(text.find(along), along.size(), slideLine(0, 1, {0, -1, 0}));
    const World world = readWorld(text);
    MotionText m;
    m.pieces = {"clock " + hex(0) + " " + hex(1) + "\nq 0 " + hex(0) + " " + hex(0) + " " + hex(1) + "\n"};
    const Verdict v = judge(world, m.write(world), fine({0, -1, 0}));
    if (gap > 0.25)
      expectVerified(v);
    else
      expectRefused(v);
  }
}

TEST(VerifyTube, TheClockIsStatedAndGoesOn) {
  const Person person;
  const World world = readWorld(person.world(0.1, 0));
  const auto refused = [&](const World& w, const std::vector<std::string>& pieces, const std::string& words) {
    MotionText m;
    m.pieces = pieces;
    const Verdict v = judge(w, m.write(w), person.proof());
    EXPECT_TRUE(v.bad_input);
    expectRefused(v, words);
  };
  const auto clock = [](double a, double b) { return "clock " + hex(a) + " " + hex(b) + "\n"; };
  expectVerified(judge(world, Person::still(1, 2).write(world), person.proof()));
  refused(world, {"", ""}, "has no 'clock'");
  refused(world, {clock(0, 1), ""}, "has no 'clock'");
  refused(world, {clock(0.5, 1), clock(1, 2)}, "begins at 0");
  refused(world, {clock(-1, 1), clock(1, 2)}, "begins at 0");
  refused(world, {clock(0, 1), clock(0.5, 2)}, "another one than at the end of the piece before");
  refused(world, {clock(0, 1), clock(1, 0.5)}, "goes back");
  refused(world, {clock(0, 1) + clock(0, 1), clock(1, 2)}, "has one clock");
  const std::string text = person.world(0.1, 0);
  const World none = readWorld(text.substr(0, text.find("tolerance speed")));
  refused(none, {clock(0, 1), clock(1, 2)}, "a clock means nothing");
  EXPECT_EQ(coveredBy(world), "for every way of 'person' at up to 0.1 m/s from 0 s on, ");
  const Motion motion = readMotion(Person::still(1, 2).write(world), world);
  const std::vector<std::string> lines = linesOf(world, motion, {});
  EXPECT_NE(std::find(lines.begin(), lines.end(),
                      "clock, by which bodies move by themselves: 0 s at the start, 2 s at t = 1 of piece 1"),
            lines.end());
}

TEST(VerifyTube, LinesWithoutAMeaningAreRefused) {
  const std::string head =
      kHead +
      "variable a\nvariable u\nvariable v\nvariable w\nvariable x\nvariable y\nvariable z\nvariable none\n"
      "frame f 0 " +
      hex(kHere) + "\n" + turnLine(0) + "rotate 1\n" + slideLine(4, 1, {1, 0, 0}) + slideLine(5, 1, {0, 1, 0}) +
      slideLine(6, 1, {0, 0, 1}) + "frame empty 0 " + hex(kHere) + "\ngeometry sphere " + hex(1) +
      "\nbody link ball 1 0 " + hex(kHere) + "\n";
  const auto refused = [&](const std::string& line, const std::string& words) {
    try {
      readWorld(head + "tolerance " + line + "\n");
      ADD_FAILURE() << line;
    } catch (const BadInput& error) {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
  };
  const std::string d = hex(0.1), zero = hex(0);
  for (const std::string& good :
       {"variable 0 " + d, "rotation 1 " + d, "vector 4 3 " + d, "vector 4 2 " + d, "vector 5 2 " + d,
        "frame 1 " + d + " " + zero + " " + hex(V{1, 2, 3}), "frame 1 " + zero + " " + d + " " + hex(V{0, 0, 0}),
        "body ball " + d + " " + d + " " + hex(V{1, 2, 3}), "speed ball " + d + " " + hex(-1)})
    EXPECT_NO_THROW(readWorld(head + "tolerance " + good + "\n")) << good;
  refused("joint 0 " + d, "a tolerance is of a variable, vector, rotation, frame, body or speed");
  refused("speed ball " + d, "a word is missing");
  refused("speed ball " + zero + " " + d, "above 0");
  refused("speed ball " + hex(-0.1) + " " + d, "negative");
  refused("speed cup " + d + " " + d, "no body is called so");
  refused("speed ball " + d + " " + d + "\ntolerance speed ball " + d + " " + zero, "there already");
  refused("variable 0", "a word is missing");
  refused("variable 0 " + d + " " + d, "too many words");
  refused("variable 0 " + hex(-0.1), "negative");
  refused("variable 0 " + zero, "above 0");
  refused("variable 8 " + d, "not below 8");
  refused("variable 7 " + d, "no element slides or turns by it");
  refused("variable 2 " + d, "one of a 'rotate'");
  refused("rotation 0 " + d, "no element rotates by it");
  refused("rotation 2 " + d, "no element rotates by it");
  refused("vector 0 2 " + d, "do more than slide");
  refused("vector 5 3 " + d, "do more than slide");
  refused("vector 3 3 " + d, "do more than slide");
  refused("vector 4 3 " + d + "\ntolerance variable 5 " + d, "tolerances of their own");
  refused("variable 0 " + d + "\ntolerance variable 0 " + d, "there already");
  refused("vector 4 1 " + d, "two or three");
  refused("vector 4 4 " + d, "not below 4");
  refused("vector 4 2 " + d + "\ntolerance vector 5 2 " + d, "the first of such slides");
  refused("frame 0 " + d + " " + d, "the world");
  refused("frame 3 " + d + " " + d, "not below 3");
  refused("frame 1 " + d, "a word is missing");
  refused("frame 1 " + zero + " " + zero + " " + hex(V{1, 2, 3}), "above 0");
  refused("frame 2 " + d + " " + d + " " + hex(V{1, 2, 3}), "no body is in it or below it");
  refused("body cup " + d + " " + d + " " + hex(V{0, 0, 0}), "no body is called so");
  refused("body ball " + d + " " + d, "a word is missing");
  refused("body ball " + zero + " " + zero + " " + hex(V{0, 0, 0}), "above 0");
}

TEST(VerifyTube, SaysWhatIsCovered) {
  const double degree = kPi / 180;
  const std::string arm = kHead + "variable j1\nvariable j2\nvariable lift\nframe foot 0 " + hex(kHere) +
                          "\nframe one 1 " + hex(kHere) + "\n" + turnLine(0) + "frame two 2 " + hex(kHere) + "\n" +
                          turnLine(1) + "frame three 3 " + hex(kHere) + "\n" + slideLine(2, 1, {0, 0, 1}) +
                          "geometry sphere " + hex(0.1) + "\nbody obstacle cell 0 0 " + hex(at(9, 0, 0)) +
                          "\nbody link hand 4 0 " + hex(kHere) + "\n";
  const auto said = [&](const std::string& lines) { return coveredBy(readWorld(arm + lines)); };
  EXPECT_EQ(said(""), "");
  EXPECT_EQ(said(tolerance("variable 0", 0.3 * degree) + tolerance("variable 1", 0.3 * degree) +
                 tolerance("variable 2", 0.002)),
            "for every path within 0.3 deg of it ('lift' 2 mm), ");
  EXPECT_EQ(said(tolerance("variable 0", 0.5 * degree)), "for every path within 0.5 deg of it ('j2' 0, 'lift' 0), ");
  EXPECT_EQ(said(tolerance("variable 0", 0.1)),
            "for every path within 0.10000000000000001 rad of it ('j2' 0, 'lift' 0), ");
  const std::string base = "tolerance frame 1 " + hex(0.002) + " " + hex(0.1 * degree) + " " + hex(V{0, 0, 0}) + "\n",
                    cell = "tolerance body cell " + hex(0.005) + " " + hex(0) + " " + hex(V{9, 0, 0}) + "\n";
  EXPECT_EQ(said(base + cell), "with base 'foot' within 2 mm and 0.1 deg, 'cell' within 5 mm, ");
  const World world = readWorld(arm + base + cell + tolerance("variable 0", 0.3 * degree));
  const Verdict verdict = judge(world, standing().write(world), sep({-1, 0, 0}));
  expectVerified(verdict);
  Subject subject;
  subject.covered = coveredBy(world);
  EXPECT_EQ(
      lineOf(verdict, subject),
      "VERIFIED: the robot of this world moves as this record says without obstacles, and for every path within 0.3 "
      "deg of it ('j2' 0, 'lift' 0), base 'foot' within 2 mm and 0.1 deg, 'cell' within 5 mm, none of 1 pairs of "
      "bodies touches.");
  const std::vector<std::string> lines = linesOf(world);
  for (const char* line :
       {"tolerances about the motion: 'j1' 0.3 deg, 'j2' 0, 'lift' 0",
        "tolerances of frames: 'foot' within 2 mm and 0.1 deg about 0 0 0", "tolerances of bodies: 'cell' within 5 mm"})
    EXPECT_NE(std::find(lines.begin(), lines.end(), line), lines.end()) << line;
}

// A smaller tolerance in the world than in the claim is another world: the motion names its own by hash.
TEST(VerifyTube, AnotherToleranceIsAnotherWorld) {
  const auto world = [](double d) {
    return boxOver("variable y\n", slideLine(0, 1, {0, 1, 0}), tolerance("variable 0", d));
  };
  const World large = world(0.5), small = world(0.25), none = boxOver("variable y\n", slideLine(0, 1, {0, 1, 0}), "");
  const std::string good = record(standing().write(large), std::string(1, '\x09'));
  expectVerified(judge(large, good));
  expectRefused(judge(small, good), "another world");
  expectRefused(judge(none, good), "another world");
}

// For random affine maps: the bound, as a polynomial in Bernstein's form, is not below the distance of any point.
TEST(VerifyTube, DistancesAreAboveEveryPointAndNear) {
  Rng rng(31);
  int near = 0;
  for (int n = 0; n < 2000; ++n) {
    const int kind = n % 10;
    const World world = readWorld(kHead + anyGeometry(rng, kind, 1) + "body link a 0 0 " + hex(M{}) + "\n");
    const Geometry& g = world.geometries[0];
    const auto i = static_cast<std::uint32_t>(rng() % g.pieces()),
               j = i + 1 + static_cast<std::uint32_t>(rng() % (g.pieces() - i));
    const bool axis = rng() % 2;
    // Turning about z while it is carried along: W = R_z(a + w s), less its third row about an axis.
    const double w0 = uniform(rng, -3, 3), w1 = n % 3 ? uniform(rng, -0.2, 0.2) : 0;
    Tm sine, cosine;
    sineCosine(Tm{encloseDown(w0), encloseDown(w1), {}, {}}, sine, cosine);
    Mat W{cosine, -sine, Tm{}, sine, cosine, Tm{}, Tm{}, Tm{}, axis ? Tm{} : constant(integer(1))};
    Vec o;
    for (std::size_t c = 0; c < (axis ? 2 : 3); ++c)
      o[c] = {encloseDown(uniform(rng, -2, 2)), encloseDown(uniform(rng, -0.3, 0.3)), {}, {}};
    const double size = n % 2 ? 1e-6 : 0;
    for (Tm& x : W) x.r += encloseUp(size);
    Budget budget{1000000000};
    const std::array<Fix, 3> far = g.distance(i, j, W, o, budget);
    double least = 1e9;
    for (int k = 0; k < 60; ++k) {
      const double t = k < 3 ? k - 1 : uniform(rng, -1, 1), a = w0 + w1 * t;
      const V p = farthest(g, i, j, {uniform(rng, -1, 1), uniform(rng, -1, 1), uniform(rng, -1, 1)});
      V x{std::cos(a) * p[0] - std::sin(a) * p[1], std::sin(a) * p[0] + std::cos(a) * p[1], axis ? 0 : p[2]};
      for (std::size_t c = 0; c < 3; ++c) x[c] += toDouble(o[c].c0) + t * toDouble(o[c].c1);
      const double bound = (toDouble(far[0]) * (1 - t) * (1 - t) + 2 * toDouble(far[1]) * (1 - t) * (1 + t) +
                            toDouble(far[2]) * (1 + t) * (1 + t)) /
                           4;
      ASSERT_LE(norm(x), bound + 1e-13) << "kind " << kind << " t " << t;
      least = std::min(least, bound - norm(x));
    }
    near += least < 0.1;
  }
  EXPECT_GT(near, 1400);
}

TEST(VerifyTube, RandomTubesAgainstSamples) {
  const TubeCounts counts = tubeCampaign(32, 25, 25, 100, true);
  std::printf("%d verified, %d of them falsified by samples, %d not proven; %d forged, %d of them accepted\n",
              counts.verified, counts.falsified, counts.refused, counts.forged, counts.accepted);
  EXPECT_EQ(counts.falsified, 0);
  EXPECT_EQ(counts.accepted, 0);
}

}  // namespace tube_test
}  // namespace verify::test
