// SPDX-License-Identifier: BSD-3-Clause
// Enclosures against references at random; random worlds with proofs by samples, true and forged.
#include <gtest/gtest.h>

#include <algorithm>

#include "big.h"
#include "cases.h"

namespace verify::test {
namespace random_test {

BigPose bigTurn(Rng& rng) {
  return turned(BigVec{Big(uniform(rng, -1, 1)), Big(uniform(rng, -1, 1)), Big(uniform(rng, -1, 1))},
                Big(uniform(rng, -3, 3)));
}
/// A proper rotation, and its numbers rounded to doubles as a writer states them.
BigPose stated(Rng& rng, double size, M& rounded) {
  BigPose pose = rng() % 4 == 0 ? identity() : bigTurn(rng);
  for (std::size_t k = 0; k < 9; ++k) rounded.R[k] = pose.R[k].toDouble();
  for (std::size_t k = 0; k < 3; ++k) pose.t[k] = Big(rounded.t[k] = uniform(rng, -size, size));
  return pose;
}

Big value(const std::vector<double>& coefficients, const Big& t) {
  Big x;
  for (std::size_t k = coefficients.size(); k-- > 0;) x = x * t + Big(coefficients[k]);
  return x;
}

// Random trees with all elements, random intervals of time: a functional carried from one frame to another holds the
// exact value of n . (inverse pose of the one) (pose of the other) x.
TEST(VerifyMotion, FunctionalsHoldTheExactKinematics) {
  Rng rng(11);
  int wide = 0;
  for (int n = 0; n < 400; ++n) {
    const int variables = 8, frames = 2 + static_cast<int>(rng() % 7);
    std::string text = kHead;
    for (int v = 0; v < variables; ++v) text += "variable v" + std::to_string(v) + "\n";
    struct Step {
      int kind, variable;
      V axis;
      double m, c;
    };
    std::vector<BigPose> origins(1);
    std::vector<std::vector<Step>> steps(1);
    std::vector<int> parents{0};
    for (int f = 1; f <= frames; ++f) {
      M rounded;
      origins.push_back(stated(rng, 1, rounded));
      parents.push_back(rng() % 3 ? f - 1 : static_cast<int>(rng() % static_cast<unsigned>(f)));
      text += "frame f 0 " + hex(rounded) + "\n";
      text.replace(text.rfind("frame f 0 "), 10, "frame f " + std::to_string(parents.back()) + " ");
      steps.emplace_back();
      for (unsigned e = static_cast<unsigned>(rng() % 3); e > 0; --e) {
        Step s{static_cast<int>(rng() % 5),
               static_cast<int>(rng() % 6),
               {uniform(rng, -1, 1), uniform(rng, -1, 1), uniform(rng, -1, 1)},
               uniform(rng, -2, 2),
               uniform(rng, -3, 3)};
        if (rng() % 2) s.axis = {0, 0, rng() % 2 ? 1.0 : -1.0};
        if (rng() % 2) s.m = 1, s.c = 0;
        steps.back().push_back(s);
        if (s.kind == 4) {
          text += "rotate " + std::to_string(s.variable) + "\n";
        } else {
          text += std::string(s.kind == 3 ? "slide " : "turn ") + hex(s.axis) + " " + std::to_string(s.variable) + " " +
                  hex(s.m) + " " + hex(s.c) + "\n";
        }
      }
    }
    text += "frame user 0 " + hex(M{}) + "\n";  // of all variables, so that every line of the motion counts
    for (int v = 0; v < variables; ++v)
      text += v + 2 < variables
                  ? "rotate " + std::to_string(v) + "\n"
                  : "turn " + hex(V{0, 0, 1}) + " " + std::to_string(v) + " " + hex(1) + " " + hex(0) + "\n";
    const World world = readWorld(text + "geometry sphere " + hex(1) + "\nbody link a 0 0 " + hex(M{}) + "\n");
    MotionText motion;
    std::vector<std::vector<double>> q(variables);
    std::string piece;
    std::vector<BigPose> orientations(variables, identity());
    for (int v = 0; v < variables; ++v) {
      if (rng() % 5 == 0) continue;
      piece += "q " + std::to_string(v);
      for (unsigned k = 1 + static_cast<unsigned>(rng() % 6); k > 0; --k) {
        q[static_cast<std::size_t>(v)].push_back(uniform(rng, -1, 1));
        piece += " " + hex(q[static_cast<std::size_t>(v)].back());
      }
      piece += "\n";
    }
    for (int v = 0; v < 6; ++v) {
      if (rng() % 2) continue;
      M rounded;
      orientations[static_cast<std::size_t>(v)] = stated(rng, 0, rounded);
      piece += "orientation " + std::to_string(v);
      for (const double x : rounded.R) piece += " " + hex(x);
      piece += "\n";
    }
    motion.pieces = {piece};
    const Motion read = readMotion(motion.write(world), world);
    Budget budget{1000000000};
    Poses poses(world, read.pieces[0], budget);
    const double a = uniform(rng, 0, 1), width = std::ldexp(1, -static_cast<int>(rng() % 20));
    const Span span{encloseDown(a * (1 - width)), encloseDown(a * (1 - width) + width)};
    const int from = static_cast<int>(rng() % static_cast<unsigned>(frames + 1)),
              to = static_cast<int>(rng() % static_cast<unsigned>(frames + 1));
    const V n0{uniform(rng, -1, 1), uniform(rng, -1, 1), uniform(rng, -1, 1)};
    Vec direction;
    for (std::size_t k = 0; k < 3; ++k) direction[k] = {encloseDown(n0[k]), encloseDown(n0[k] / 3), {}, {}};
    Functional::Value f;
    try {
      f = Functional(world, poses, span, from, direction, Tm{}).in(to);
    } catch (const NotProven&) {
      ++wide;
      continue;
    }
    for (const double at : {-1.0, 1.0, 0.0, uniform(rng, -1, 1), uniform(rng, -1, 1)}) {
      const Big half = (Big(span.b) - Big(span.a)) / Big(2.0), s(at);
      // The model's t: centre rounded down, half rounded up; t is taken so, not from the middle.
      const Fix centre = span.middle(), h = std::max(span.b - centre, centre - span.a);
      const Big t = Big(centre) + s * Big(h);
      ASSERT_TRUE((t - Big(span.a) - half - s * half).abs() <= Big(ulps(2)));
      std::vector<BigPose> pose(1, identity());
      for (std::size_t k = 1; k < origins.size(); ++k) {
        BigPose p = pose[static_cast<std::size_t>(parents[k])] * origins[k];
        for (const Step& e : steps[k]) {
          const auto v = static_cast<std::size_t>(e.variable);
          if (e.kind == 4) {
            const BigVec w{value(q[v], t), value(q[v + 1], t), value(q[v + 2], t)};
            p = p * turned(w, (w[0] * w[0] + w[1] * w[1] + w[2] * w[2]).sqrt()) * orientations[v];
            continue;
          }
          const Big x = Big(e.m) * value(q[v], t) + Big(e.c);
          const BigVec axis{Big(e.axis[0]), Big(e.axis[1]), Big(e.axis[2])};
          if (e.kind == 3) {
            const Big length = (axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]).sqrt();
            BigPose slide = identity();
            for (std::size_t c = 0; c < 3; ++c) slide.t[c] = axis[c] / length * x;
            p = p * slide;
          } else {
            p = p * turned(axis, x);
          }
        }
        pose.push_back(p);
      }
      const V x{uniform(rng, -1, 1), uniform(rng, -1, 1), uniform(rng, -1, 1)};
      const BigVec world_x = pose[static_cast<std::size_t>(to)] * BigVec{Big(x[0]), Big(x[1]), Big(x[2])};
      const BigPose& F = pose[static_cast<std::size_t>(from)];
      Big exact;
      for (std::size_t k = 0; k < 3; ++k) {
        const Big nk = Big(direction[k].c0) + s * Big(direction[k].c1);
        for (std::size_t c = 0; c < 3; ++c) exact = exact + nk * F.R[3 * c + k] * (world_x[c] - F.t[c]);
      }
      Tm model = f.d;
      for (std::size_t k = 0; k < 3; ++k) model = model + f.v[k] * exactly(x[k]);
      // `f` is up to a constant: what is common to all frames. It begins as 0 at the first frame's origin.
      ASSERT_TRUE(holds(model, s, exact)) << "case " << n << " width " << width;
      if (width < 1e-5) {
        ASSERT_LT(toDouble(model.r), 1e-7);
      }
    }
  }
  EXPECT_LT(wide, 60);
}

// A random v(s): the bound, as a polynomial in Bernstein's form, is above f of every sampled point of the pieces, and
// not far above the farthest.
TEST(VerifySupport, ReachIsAboveEveryPointAndNear) {
  Rng rng(12);
  int near = 0, all = 0;
  for (int n = 0; n < 3000; ++n) {
    const int kind = n % 10;
    const World world = readWorld(kHead + anyGeometry(rng, kind, 1) + "body link a 0 0 " + hex(M{}) + "\n");
    const Geometry& g = world.geometries[0];
    std::uint32_t i = static_cast<std::uint32_t>(rng() % g.pieces()),
                  j = i + 1 + static_cast<std::uint32_t>(rng() % (g.pieces() - i));
    // A unit vector that turns about z, for the ball's sake; its remainder is one of any function in it.
    const double w0 = uniform(rng, -3, 3), w1 = n % 3 ? uniform(rng, -0.3, 0.3) : 0, z = uniform(rng, -1, 1),
                 size = n % 4 ? 1e-6 : 1e-2;
    Tm sine, cosine;
    sineCosine(Tm{encloseDown(w0), encloseDown(w1), {}, {}}, sine, cosine);
    Vec v{constant(encloseDown(std::sqrt(1 - z * z))) * cosine, constant(encloseDown(std::sqrt(1 - z * z))) * sine,
          constant(encloseDown(z))};
    const double part[3] = {uniform(rng, -1, 1), 1, -1};
    const bool ball = kind == 1 || kind == 3;
    if (!ball)
      for (Tm& c : v) c.r += encloseUp(size);
    const Tm d{encloseDown(uniform(rng, -5, 5)), encloseDown(uniform(rng, -1, 1)), {}, encloseUp(size)};
    Budget budget{1000000000};
    const std::array<Fix, 3> reach = g.reach(i, j, v, d, integer(1) + ulps(10000), budget);
    for (const double s : {-1.0, 1.0, 0.0, uniform(rng, -1, 1)}) {
      V at;
      const double angle = w0 + w1 * s;
      for (std::size_t k = 0; k < 3; ++k) {
        const Tm& c = v[k];
        at[k] = toDouble(c.c0) + s * (toDouble(c.c1) + s * toDouble(c.c2)) + (ball ? 0 : part[k] * toDouble(c.r));
      }
      if (ball) at = {std::sqrt(1 - z * z) * std::cos(angle), std::sqrt(1 - z * z) * std::sin(angle), z};
      const double most = dot(at, farthest(g, i, j, at)) + toDouble(d.c0) + s * toDouble(d.c1) + toDouble(d.r);
      const double bound = (toDouble(reach[0]) * (1 - s) * (1 - s) + 2 * toDouble(reach[1]) * (1 - s) * (1 + s) +
                            toDouble(reach[2]) * (1 + s) * (1 + s)) /
                           4;
      ASSERT_LE(most, bound + 1e-14) << "kind " << kind << " s " << s;
      ++all;
      near += bound - most < 0.02 + 3 * size;
      if (w1 == 0) {
        ASSERT_LT(bound - most, 10 * size + 1e-6) << "kind " << kind;
      }
    }
    EXPECT_LT(0, budget.left);
  }
  EXPECT_GT(near, 0.7 * all);
}

/// Whether a sample is certainly nearer than the margin: then the claim is false.
bool certainlyFalse(const World& world, const Motion& motion, int samples, int steps = 200) {
  const Sampler sampler(world, motion);
  for (std::size_t piece = 0; piece < motion.pieces.size(); ++piece) {
    const double end = piece + 1 == motion.pieces.size() ? motion.until : 1;
    for (int m = 0; m < samples; ++m) {
      const double t = end * m / (samples - 1);
      const std::vector<M> poses = sampler.bodies(piece, t);
      for (std::size_t a = 0; a < world.bodies.size(); ++a)
        for (const Opponent& o : opponents(world, motion, piece, static_cast<int>(a)))
          if (t >= toDouble(o.from) &&
              upperDistance(world, poses, static_cast<int>(a), o.body, steps) < toDouble(o.margin) - 1e-7)
            return true;
    }
  }
  return false;
}

TEST(VerifyRandom, TrueClaimsAreProvenAndFalseOnesNever) {
  Rng rng(13);
  int verified = 0, finished = 0, is_false = 0, forged = 0, accepted_wrong = 0, refused_complete = 0;
  for (int n = 0; n < 300; ++n) {
    const Case c = anyCase(rng);
    const World world = readWorld(c.world_text);
    const std::string text = c.motion.write(world);
    const Motion motion = readMotion(text, world);
    Prover prover(world, motion);
    prover.most_time_depth = 4;
    const std::string nodes = prover.roots();
    const bool wrong = certainlyFalse(world, motion, 25);
    Options options;
    options.work = 20000000;
    const Verdict v = judge(world, record(text, nodes), options);
    is_false += wrong;
    if (wrong) {
      accepted_wrong += v.verified;
      continue;
    }
    finished += prover.complete;
    verified += v.verified;
    if (prover.complete && !v.verified) ++refused_complete;
    if (!v.verified) continue;
    // The same proof for claims that are false: a larger margin, a shifted motion.
    for (int k = 0; k < 4; ++k) {
      MotionText more = c.motion;
      if (k < 2) more.added = uniform(rng, 0, 0.4);
      const std::string other_q =
          hex(uniform(rng, -3, 3)) + " " + hex(more.pieces.size() > 1 ? 0 : uniform(rng, -3, 3));
      if (k >= 2)
        for (std::string& piece : more.pieces) piece.replace(piece.find("q 0 ") + 4, piece.find('\n') - 4, other_q);
      const std::string other = more.write(world);
      const Motion changed = readMotion(other, world);
      const Verdict w = judge(world, record(other, nodes), options);
      if (certainlyFalse(world, changed, 25, 60)) {
        ++forged;
        accepted_wrong += w.verified;
      }
    }
  }
  std::printf("%d verified of %d that the prover finished (%d refused); %d false, %d forged, %d wrong ones accepted\n",
              verified, finished, refused_complete, is_false, forged, accepted_wrong);
  EXPECT_EQ(accepted_wrong, 0);
  EXPECT_GT(is_false, 25);
  EXPECT_GT(forged, 100);
  EXPECT_GT(verified, 60);
  EXPECT_LT(refused_complete, 0.1 * finished);
}

TEST(VerifyRandom, FlippedBits) {
  Rng rng(14);
  int records = 0, flips = 0, still = 0, wrong = 0;
  while (records < 8) {
    const Case c = anyCase(rng);
    const World world = readWorld(c.world_text);
    const std::string text = c.motion.write(world);
    const Motion motion = readMotion(text, world);
    const std::string nodes = Prover(world, motion).roots();
    Options options;
    options.work = 5000000;
    const std::string good = record(text, nodes);
    if (nodes.size() > 150 || !judge(world, good, options).verified) continue;
    ++records;
    options.work = 300000;
    for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
      std::string bytes = good;
      bytes[bit / 8] = static_cast<char>(bytes[bit / 8] ^ (1 << bit % 8));
      ++flips;
      try {
        for (const Record& r : splitRecords(bytes)) {
          if (!verifyRecord(world, r, options).verified) continue;
          ++still;
          wrong += bit / 8 < 8 + text.size() + 4 + 32;  // motion, lengths and hash: never
        }
      } catch (const BadInput&) {
      }
    }
    // The motion's bits flipped, and the hash made to fit: another claim, judged by samples.
    for (int k = 0; k < 300; ++k) {
      std::string other = text;
      const std::size_t bit = static_cast<std::size_t>(rng()) % (8 * other.size());
      other[bit / 8] = static_cast<char>(other[bit / 8] ^ (1 << bit % 8));
      ++flips;
      if (!judge(world, record(other, nodes), options).verified) continue;
      ++still;
      wrong += certainlyFalse(world, readMotion(other, world), 25, 60);
    }
  }
  std::printf("%d bits flipped, %d records still prove, %d of them wrongly\n", flips, still, wrong);
  EXPECT_EQ(wrong, 0);
}

// A world with one more obstacle, in the way: the proof of the world without it is refused, however it is patched.
TEST(VerifyRandom, ADroppedPartner) {
  Rng rng(15);
  int tried = 0;
  for (int n = 0; n < 200 && tried < 20; ++n) {
    const Case c = anyCase(rng);
    const World world = readWorld(c.world_text);
    const Motion motion = readMotion(c.motion.write(world), world);
    const std::string nodes = Prover(world, motion).roots();
    Options options;
    options.work = 5000000;
    if (!judge(world, record(c.motion.write(world), nodes), options).verified) continue;
    const Sampler sampler(world, motion);
    const V middle = sampler.bodies(0, 0.5).back().t;  // within the last link
    M pose;
    pose.t = middle;
    const std::string add = "geometry sphere " + hex(0.3) + "\nbody obstacle more 0 " +
                            std::to_string(world.geometries.size()) + " " + hex(pose) + "\n";
    const std::size_t at = c.world_text.find("body ");
    for (const std::string& text : {c.world_text + add, c.world_text.substr(0, at) + add + c.world_text.substr(at)}) {
      const World larger = readWorld(text);
      if (!certainlyFalse(larger, readMotion(c.motion.write(larger), larger), 25)) continue;
      ++tried;
      const std::string claim = c.motion.write(larger);
      EXPECT_FALSE(judge(larger, record(claim, nodes), options).verified);
      for (const std::string& patch : {sep({1, 0, 0}), sep({0, 1, 0}), sep({0, 0, 1}), sep({-1, 0, 0})}) {
        EXPECT_FALSE(judge(larger, record(claim, nodes + patch), options).verified);
        EXPECT_FALSE(judge(larger, record(claim, patch + nodes), options).verified);
      }
    }
  }
  EXPECT_GE(tried, 10);
}

}  // namespace random_test
}  // namespace verify::test
