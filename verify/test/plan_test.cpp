// SPDX-License-Identifier: BSD-3-Clause
// Whom a proof is about: the motion of the plan.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <random>

#include "files.h"

namespace verify::test {
namespace plan_test {

class VerifyPlan : public VerifyFiles {
 protected:
  World world_ = readWorld(kHead + "variable a\nvariable b\nvariable door\nframe f 0 " + hex(M{}) + "\nturn " +
                           hex(V{0, 0, 1}) + " 0 " + hex(1) + " " + hex(0) + "\nslide " + hex(V{0, 0, 1}) + " 1 " +
                           hex(1) + " " + hex(0) + "\nframe g 0 " + hex(M{}) + "\nslide " + hex(V{0, 0, 1}) + " 2 " +
                           hex(1) + " " + hex(0) + "\ngeometry sphere " + hex(1) + "\nbody link f 1 0 " + hex(M{}) +
                           "\nbody obstacle door 2 0 " + hex(M{}) + "\n");
  Motion motion(std::vector<std::string> pieces, double until = 1) {
    MotionText m;
    m.pieces = std::move(pieces);
    m.until = until;
    return readMotion(m.write(world_), world_);
  }
  static std::string q(int v, const std::vector<double>& c) {
    std::string text = "q " + std::to_string(v);
    for (const double x : c) text += " " + hex(x);
    return text + "\n";
  }
  /// "same", the first difference, or why they are not compared.
  std::string said(const Motion& motion, const std::string& csv, Interpolation kind = Interpolation::automatic,
                   const std::string& state = "") {
    try {
      Plan plan = readPlan(write("plan.csv", csv));
      plan.interpolation = kind;
      if (!state.empty()) plan.state = readConfiguration(world_, {}, state);
      return said(motion, plan);
    } catch (const BadInput& error) {
      return error.what();
    }
  }
  std::string said(const Motion& motion, const Plan& plan) {
    last_ = compareWithPlan(world_, motion, plan);
    return last_.differences.empty() ? "same" : last_.differences[0];
  }
  bool noted(const std::string& words) const {
    for (const std::string& note : last_.notes)
      if (note.find(words) != std::string::npos) return true;
    return false;
  }
  Comparison last_;
};

const double kStep = 0.7 - 0.1;

TEST_F(VerifyPlan, WaypointsAreThoseOfTheMotion) {
  const std::string csv = "# a plan\ntime,b,a\n0,1,0.1\n2,1,0.7\n\n3,1.5,0.7\n";
  const std::string first = q(0, {0.1, kStep}) + q(1, {1}), second = q(0, {0.7}) + q(1, {1, 0.5});
  const Motion good = motion({first, second});
  EXPECT_EQ(said(good, csv), "same");
  EXPECT_TRUE(noted("waypoints 0 to 2, straight"));
  EXPECT_TRUE(noted("every timing of these straight lines"));
  EXPECT_TRUE(noted("not in the plan, standing still: 'door' 0"));
  EXPECT_EQ(said(motion({q(0, {0.1, kStep, 0}) + q(1, {1}), second}), csv), "same");
  for (const char* wrong : {"time,b,a\n0,1,0.1\n2,1,0.7\n3,1.5,0.70000000000000007\n",
                            "time,b,a\n0,1,0.1\n2,1,0.7\n3,1.6,0.7\n", "time,b,a\n0,1,0.2\n2,1,0.7\n3,1.5,0.7\n",
                            "time,a,b\n0,1,0.1\n2,1,0.7\n3,1.5,0.7\n", "time,b,a\n0,2,0.1\n2,2,0.7\n3,2.5,0.7\n",
                            "time,b,a\n0,1,0.1\n3,1.5,0.7\n", "time,b,a\n0,1,0.1\n2,1,0.7\n3,1.5,0.7\n4,1.5,0.8\n",
                            "time,b,a\n0,1,0.1\n2,1,0.7\n2,1.5,0.7\n", "time,b\n0,1\n2,1\n3,1.5\n"})
    EXPECT_NE(said(good, wrong), "same") << wrong;
  // A motion that bends, stops elsewhere, or that something else joins.
  EXPECT_NE(said(motion({q(0, {0.1, 0, kStep}) + q(1, {1}), second}), csv), "same");
  EXPECT_NE(said(motion({first, q(0, {0.7}) + q(1, {1, std::nextafter(0.5, 1)})}), csv), "same");
  EXPECT_NE(said(motion({first}), csv).find("ends at waypoint 1 of 2"), std::string::npos)
      << said(motion({first}), csv);
  EXPECT_EQ(said(motion({first}, 0.5), csv), "same");  // VERIFIED says until when
  EXPECT_TRUE(noted("waypoints 0 to 1 of 2, up to the time that the claim ends"));
  EXPECT_NE(said(motion({first + q(2, {0, 1}), second + q(2, {1})}), csv).find("'door' moves"), std::string::npos);
}

// Bodies that move by themselves have as long as the plan takes: it may be no later than the motion's clock.
TEST_F(VerifyPlan, IsNowhereLaterThanTheClock) {
  const auto clock = [](double from, double to) { return "clock " + hex(from) + " " + hex(to) + "\n"; };
  const std::string first = q(0, {0.1, kStep}), second = q(0, {0.7, 0.5});
  std::string text = kHead + "variable a\nframe f 0 " + hex(M{}) + "\nturn " + hex(V{0, 0, 1}) + " 0 " + hex(1) + " " +
                     hex(0) + "\ngeometry sphere " + hex(1) + "\nbody link f 1 0 " + hex(M{}) +
                     "\nbody obstacle person 0 0 " + hex(M{}) + "\ntolerance speed person " + hex(1) + " " + hex(0) +
                     "\n";
  world_ = readWorld(text);
  const Motion timed = motion({clock(0, 2) + first, clock(2, 3) + second});
  for (const char* good :
       {"time,a\n0,0.1\n2,0.7\n3,1.2\n", "time,a\n5,0.1\n7,0.7\n8,1.2\n", "time,a\n0,0.1\n1,0.7\n3,1.2\n"})
    EXPECT_EQ(said(timed, good), "same") << good;
  EXPECT_TRUE(noted("timings that are nowhere later than its clock"));
  EXPECT_FALSE(noted("every timing"));
  for (const char* wrong : {"time,a\n0,0.1\n2.0000000000000004,0.7\n3,1.2\n", "time,a\n0,0.1\n2,0.7\n3.5,1.2\n",
                            "time,a\n-1,0.1\n2,0.7\n3,1.2\n"})
    EXPECT_NE(said(timed, wrong).find("bodies that move by themselves get farther"), std::string::npos) << wrong;
  EXPECT_NE(said(timed, "a\n0.1\n0.7\n1.2\n").find("has no times"), std::string::npos);
  // 1 + 2^-60 s after the beginning: the difference of the doubles is 1.
  const Motion exact = motion({clock(0, 1) + first, clock(1, 3) + second});
  EXPECT_EQ(said(exact, "time,a\n0,0.1\n1,0.7\n3,1.2\n"), "same");
  EXPECT_NE(said(exact, "time,a\n-8.673617379884035e-19,0.1\n1,0.7\n2,1.2\n"), "same");
}

TEST_F(VerifyPlan, WhatHasNoColumnStandsAsTheStateSays) {
  const std::string csv = "a\n0.1\n0.7\n";
  const Motion moved = motion({q(0, {0.1, kStep}) + q(1, {0.25})});
  EXPECT_EQ(said(motion({q(0, {0.1, kStep})}), csv), "same");
  EXPECT_NE(said(moved, csv), "same");
  EXPECT_EQ(said(moved, csv, Interpolation::automatic, "b=0.25"), "same");
  EXPECT_NE(said(moved, csv, Interpolation::automatic, "b=0.26"), "same");
  EXPECT_NE(said(moved, csv, Interpolation::automatic, "c=0.25").find("no variable 'c'"), std::string::npos);
}

// A retimed plan needs no new proof where it goes straight and nothing else moves.
TEST_F(VerifyPlan, TimesDoNotCountOnStraightLines) {
  Motion m = motion({q(0, {0.1, kStep}), q(0, {0.7, 0.7 - 0.7}), q(0, {0.7, 1 - 0.7})});
  m.duration = 3;
  EXPECT_EQ(said(m, "t,a\n0,0.1\n1,0.7\n2,0.7\n3,1\n"), "same");
  EXPECT_FALSE(noted("retimed"));
  EXPECT_EQ(said(m, "t,a\n0,0.1\n0.25,0.7\n5,0.7\n5.5,1\n"), "same");
  EXPECT_TRUE(noted("retimed: it takes 5.5 s, the certificate's motion 3 s"));
  // Where an obstacle moves, the proof is of one timing.
  EXPECT_EQ(said(motion({q(0, {0.1, kStep}) + q(2, {0, 1})}), "t,a,door\n0,0.1,0\n7,0.7,1\n"), "same");
  EXPECT_TRUE(noted("of one timing"));
}

// Splines go where velocities and times say: what only meets the same waypoints is another motion.
TEST_F(VerifyPlan, SplinesAreThoseOfTheVelocities) {
  const std::string csv = "t,a,a/velocity\n0,0,0\n2,1,0.5\n", slower = "t,a,a/velocity\n0,0,0\n4,1,0.25\n";
  const Motion cubic = motion({q(0, {0, 0, 3 - 1, 1 - 2})});
  EXPECT_EQ(said(cubic, csv), "same");
  EXPECT_TRUE(noted("these very curves"));
  EXPECT_EQ(said(cubic, slower), "same");  // the same curve, twice as slow
  EXPECT_EQ(said(motion({q(0, {0, 1e-14, 2, -1})}), csv), "same");
  EXPECT_NE(said(motion({q(0, {0, 1e-11, 2, -1})}), csv), "same");
  EXPECT_NE(said(cubic, "t,a,a/velocity\n0,0,0\n3,1,0.5\n"), "same");
  EXPECT_NE(said(cubic, "t,a\n0,0\n2,1\n").find("does not go straight"), std::string::npos);
  EXPECT_NE(said(cubic, "t,a\n0,0\n2,1\n", Interpolation::cubic).find("has not the times, velocities"),
            std::string::npos);
  EXPECT_NE(said(motion({q(0, {0, 1})}), csv), "same");
  EXPECT_EQ(said(motion({q(0, {0, 1})}), csv, Interpolation::linear), "same");
  // From rest to rest: 10 s^3 - 15 s^4 + 6 s^5.
  const std::string rest = "t,a,a_vel,a_acc\n0,0,0,0\n2,1,0,0\n";
  EXPECT_EQ(said(motion({q(0, {0, 0, 0, 10, -15, 6})}), rest), "same");
  EXPECT_NE(said(motion({q(0, {0, 0, 0, 10, -14, 5})}), rest), "same");
  EXPECT_NE(said(motion({q(0, {0, 0, 0, 10, -15, 6})}), "t,a,a_vel,a_acc\n0,0,0,0\n2,1,0,0.001\n"), "same");
}

// Positions alone are joined by the one spline from rest to rest whose velocity and acceleration do not jump.
TEST_F(VerifyPlan, PositionsAloneMayBeUpsampled) {
  const auto upsampled = [&](const std::vector<std::string>& pieces, const std::string& csv) {
    return said(motion(pieces), csv, Interpolation::upsampled);
  };
  // There and back: both halves are from rest to rest, and bend alike in the middle.
  const std::string there = q(0, {0, 0, 3, -2}), back = q(0, {1, 0, -3, 2}), csv = "t,a,b\n1,0,0\n2,1,0\n3,0,0\n";
  EXPECT_EQ(upsampled({there, back}, csv), "same");
  EXPECT_TRUE(noted("waypoints 0 to 2, one smooth spline from rest to rest"));
  EXPECT_TRUE(noted("these very curves"));
  EXPECT_EQ(upsampled({there, back}, "t,a\n0,0\n7,1\n14,0\n"), "same");
  EXPECT_EQ(upsampled({there, back}, "a\n0\n1\n0\n"), "same");  // its points have equal steps
  EXPECT_EQ(upsampled({there}, "a\n0\n1\n"), "same");
  EXPECT_NE(upsampled({there, back}, "t,a\n0,0\n1,1\n3,0\n"), "same");
  EXPECT_NE(said(motion({there, back}), csv), "same");
  // The slopes of both steps are 1, so the velocity between them is 1.5.
  const std::string uneven = "t,a\n0,0\n1,1\n3,3\n";
  EXPECT_EQ(upsampled({q(0, {0, 0, 1.5, -0.5}), q(0, {1, 3, 0, -1})}, uneven), "same");
  EXPECT_EQ(upsampled({q(0, {0, 1e-14, 1.5, -0.5}), q(0, {1, 3, 0, -1})}, uneven), "same");
  // Straight; at rest in the middle, where the acceleration jumps; with another velocity there; a little off.
  for (const auto& pieces :
       std::vector<std::vector<std::string>>{{q(0, {0, 1}), q(0, {1, 2})},
                                             {q(0, {0, 0, 3, -2}), q(0, {1, 0, 6, -4})},
                                             {q(0, {0, 0, 2, -1}), q(0, {1, 2, 2, -2})},
                                             {q(0, {0, 0, 1.5, -0.5}), q(0, {1, 3, 1e-11, -1 - 1e-11})},
                                             {q(0, {0, 1e-11, 1.5, -0.5}), q(0, {1, 3, 0, -1})}})
    EXPECT_NE(upsampled(pieces, uneven).find("smooth spline from rest to rest"), std::string::npos) << pieces[0];
  // A spline that does not bend at its begin and end moves there.
  EXPECT_NE(upsampled({q(0, {0, 1.5, 0, -0.5}), q(0, {1, 0, -1.5, 0.5})}, csv), "same");
  // A point with velocities is not upsampled.
  const std::string with = "t,a,a/velocity\n0,0,0\n1,1,0\n3,3,0\n";
  EXPECT_EQ(upsampled({q(0, {0, 0, 3, -2}), q(0, {1, 0, 6, -4})}, with), "same");
  EXPECT_NE(upsampled({q(0, {0, 0, 1.5, -0.5}), q(0, {1, 3, 0, -1})}, with), "same");
}

// Random plans, against the velocities that Gaussian elimination with pivots finds; then one velocity is another.
TEST_F(VerifyPlan, UpsampledPlansOfManyPoints) {
  std::mt19937_64 random(51);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int round = 0; round < 20; ++round) {
    const std::size_t n = 3 + random() % 12;
    std::vector<double> t{uniform(random)}, x;
    for (std::size_t k = 0; k < n; ++k) {
      x.push_back(uniform(random));
      t.push_back(t.back() + std::exp(3 * uniform(random)));
    }
    std::vector<std::vector<double>> A(n, std::vector<double>(n + 1, 0));
    A[0][0] = A[n - 1][n - 1] = 1;
    for (std::size_t k = 1; k + 1 < n; ++k) {
      const double g = t[k] - t[k - 1], h = t[k + 1] - t[k];
      A[k][k - 1] = 1 / g;
      A[k][k] = 2 / g + 2 / h;
      A[k][k + 1] = 1 / h;
      A[k][n] = 3 * ((x[k] - x[k - 1]) / (g * g) + (x[k + 1] - x[k]) / (h * h));
    }
    for (std::size_t c = 0; c < n; ++c) {
      std::size_t best = c;
      for (std::size_t r = c; r < n; ++r)
        if (std::fabs(A[r][c]) > std::fabs(A[best][c])) best = r;
      std::swap(A[c], A[best]);
      for (std::size_t r = 0; r < n; ++r) {
        const double factor = r == c ? 0 : A[r][c] / A[c][c];
        for (std::size_t j = c; j <= n; ++j) A[r][j] -= factor * A[c][j];
      }
    }
    std::vector<double> v;
    for (std::size_t k = 0; k < n; ++k) v.push_back(A[k][n] / A[k][k]);
    std::string csv = "time,a\n";
    char row[80];
    for (std::size_t k = 0; k < n; ++k) {
      std::snprintf(row, sizeof row, "%.17g,%.17g\n", t[k], x[k]);
      csv += row;
    }
    const auto spline = [&] {
      std::vector<std::string> pieces;
      for (std::size_t k = 0; k + 1 < n; ++k) {
        const double h = t[k + 1] - t[k], d = x[k + 1] - x[k], v0 = h * v[k], v1 = h * v[k + 1];
        pieces.push_back(q(0, {x[k], v0, 3 * d - 2 * v0 - v1, v0 + v1 - 2 * d}));
      }
      return motion(pieces);
    };
    EXPECT_EQ(said(spline(), csv, Interpolation::upsampled), "same") << round;
    v[random() % n] += 1e-6;
    EXPECT_NE(said(spline(), csv, Interpolation::upsampled), "same") << round;
  }
}

// 2,000 obstacles on a chain of 1,000 frames, each with a variable of its own: once each looked at each for each.
TEST_F(VerifyPlan, ComparingTakesNoTime) {
  std::string text = kHead, chain, bodies, plan = "v0\n0\n0\n", piece;
  for (int k = 0; k < 1000; ++k) {
    const std::string number = std::to_string(k);
    text += "variable v" + number + "\n";
    chain += "frame f " + number + " " + hex(M{}) + "\nslide " + hex(V{0, 0, 1}) + " " + number + " " + hex(1) + " " +
             hex(0) + "\n";
    piece += q(k, {0});
  }
  for (int k = 0; k < 2000; ++k) bodies += "body obstacle o 1000 0 " + hex(M{}) + "\n";
  const World world =
      readWorld(text + chain + "geometry sphere " + hex(1) + "\nbody link l 1 0 " + hex(M{}) + "\n" + bodies);
  MotionText m;
  m.pieces = {piece};
  const Motion motion = readMotion(m.write(world), world);
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_TRUE(compareWithPlan(world, motion, readPlan(write("plan.csv", plan))).differences.empty());
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(),
            1);  // 10 ms; was above 10 s
}

TEST_F(VerifyPlan, FromAndTo) {
  const double right = 90 * (3.14159265358979323846 / 180);
  const Motion m = motion({q(0, {0.1, right - 0.1}) + q(1, {-1})});
  EXPECT_EQ(said(m, planBetween(world_, {}, "0.1 -1 0", "90deg, -1, 0")), "same");
  EXPECT_EQ(said(m, planBetween(world_, {}, "a=0.1 b=-1", "b=-1,a=90deg")), "same");
  EXPECT_NE(said(m, planBetween(world_, {}, "a=0.1 b=-1", "a=90deg")), "same");
  EXPECT_THROW(planBetween(world_, {}, "0.1 -1", "90deg -1 0"), BadInput);
  EXPECT_THROW(planBetween(world_, {}, "a=0.1 -1", "a=0"), BadInput);
  EXPECT_THROW(planBetween(world_, {}, "a=0.1 a=1", "a=0"), BadInput);
  EXPECT_THROW(planBetween(world_, {}, "a=0,1", "a=0"), BadInput);
}

// Values without names are those of the robot's joints, in its file's order: a world may have its variables in another.
TEST_F(VerifyPlan, ValuesWithoutNamesAreInTheRobotsOrder) {
  const Motion m = motion({q(0, {0.1, kStep}) + q(1, {-1})});
  EXPECT_EQ(said(m, planBetween(world_, {"b", "a"}, "-1, 0.1", "-1, 0.7")), "same");
  EXPECT_NE(said(m, planBetween(world_, {"b", "a"}, "0.1, -1", "0.7, -1")), "same");
  EXPECT_EQ(said(m, planBetween(world_, {"a", "b"}, "0.1, -1", "0.7, -1")), "same");
  EXPECT_TRUE(noted("not in the plan, standing still: 'door' 0"));
  EXPECT_THROW(planBetween(world_, {"a", "b"}, "0.1, -1, 0", "0.7, -1, 0"), BadInput);
  EXPECT_EQ(said(m, planBetween(world_, {"b", "a"}, "b=-1, a=0.1", "a=0.7, b=-1, door=0")), "same");
}

// No name that a world adds changes what a column means.
TEST_F(VerifyPlan, NamesOfAWorldChangeNoColumn) {
  World other = world_;
  for (const auto& [from, to] : {std::pair("b", "a/velocity"), std::pair("door", "time")})
    *std::find(other.variables.begin(), other.variables.end(), from) = to;
  Plan plan = readPlan(write("plan.csv", "time,a,a/velocity\n0,0,0\n2,1,0.5\n"));
  const auto same = [&](const std::string& pieces) {
    MotionText text;
    text.pieces = {pieces};
    return compareWithPlan(other, readMotion(text.write(other), other), plan).differences.empty();
  };
  const std::string straight = q(0, {0, 1}) + q(1, {0, 0.5}) + q(2, {0, 2}), cubic = q(0, {0, 0, 2, -1});
  plan.robot = {"a"};
  EXPECT_TRUE(same(cubic));
  EXPECT_FALSE(same(straight));
  // If the world is no file's, its names are its own.
  plan.robot.clear();
  EXPECT_TRUE(same(straight));
}

TEST_F(VerifyPlan, WhatIsNotInAPlanIsRefused) {
  const Motion m = motion({q(0, {0.1, kStep})});
  EXPECT_NE(said(m, "a,c\n0.1,0\n0.7,0\n").find("'c' is no variable"), std::string::npos);
  EXPECT_NE(said(m, "a\n0.1\n0.7").find("no line end"), std::string::npos);
  EXPECT_NE(said(m, "a\n0.1\n0x1p-1\n").find("no decimal number"), std::string::npos);
  EXPECT_NE(said(m, "a\n0.1\n0,7\n").find("another number of columns"), std::string::npos);
  EXPECT_NE(said(m, "a\n0.1\nnan\n").find("no decimal number"), std::string::npos);
  EXPECT_NE(said(m, "a,a\n0.1,0.1\n0.7,0.7\n").find("two columns"), std::string::npos);
  EXPECT_NE(said(m, "a,b_vel\n0.1,0\n0.7,0\n").find("has not all of the columns"), std::string::npos);
  EXPECT_NE(said(m, "a\n0.1\n").find("two waypoints"), std::string::npos);
}

}  // namespace plan_test
}  // namespace verify::test
