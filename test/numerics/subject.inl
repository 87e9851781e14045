// SPDX-License-Identifier: BSD-3-Clause
#include "narrowphase/solver.h"
#include "subject.h"

#define FCL_ARTIC_STRING2(x) #x
#define FCL_ARTIC_STRING(x) FCL_ARTIC_STRING2(x)

namespace fcl_artic {
namespace FCL_ARTIC_ISA {
namespace {

using numerics_test::BoxOutput;
using numerics_test::CertificateInput;
using numerics_test::CertificateOutput;
using numerics_test::kSides;
using numerics_test::LssInput;
using numerics_test::PairInput;
using numerics_test::PairOutput;
using numerics_test::Subject;
using numerics_test::TouchInput;
using numerics_test::WholeLanesOutput;

constexpr int kMostSteps = 64;

struct Chain {
  StepBounds bounds[kMostSteps];
  FrameLanes frames[kMostSteps];
  explicit Chain(const PairInput& in) {
    Lanes tm;
    double begin = in.tm[0], end = in.tm[0];
    for (int i = 0; i < kLanes; ++i) {
      tm.set(i, in.tm[i]);
      begin = min(begin, in.tm[i]);
      end = max(end, in.tm[i]);
    }
    boundSteps(in.sweep, in.query, max(0.0, begin - in.d), min(1.0, end + in.d), bounds);
    for (int i = 0; i < in.sweep.num_steps; ++i) evaluateStep(in.sweep, i, bounds, tm, in.d, frames);
  }
};

PairPads relateSides(const PairInput& in, Side* side) {
  const Chain chain(in);
  const StepBounds none = {};
  const FrameMotion motion = {in.step_b < 0 ? nullptr : &chain.frames[in.step_b],
                              in.step_b < 0 ? none : chain.bounds[in.step_b], in.sweep.first_order, in.d};
  const PairPads pads =
      relateBodies(motion, {in.inverse_a, in.placement_b, in.extents}, in.margin, side[0].m, side[1].m);
  invert(side[0].m, side[1].m);
  for (int s = 0; s < kSides; ++s) {
    side[s].m.makeBernstein();
    side[s].margin = in.margin;
    side[s].pad = pads.pad;
  }
  return pads;
}

void write(const Side* side, const PairPads& pads, PairOutput& out) {
  for (int s = 0; s < kSides; ++s) {
    const RigidLanes& m = side[s].m;
    for (int order = 0; order < 3; ++order) {
      for (int lane = 0; lane < kLanes; ++lane) {
        for (int i = 0; i < 9; ++i) out.R[s][order][i][lane] = m.R[order][i / 3][i % 3][lane];
        for (int i = 0; i < 3; ++i) out.c[s][order][i][lane] = m.c[order][i][lane];
      }
    }
    out.rem_c[s] = m.rem_c;
    out.rem_R[s] = m.rem_R;
  }
  out.pad = pads.pad;
  out.pose = pads.pose;
}

void relate(const PairInput& in, PairOutput& out) {
  Side side[kSides];
  const PairPads pads = relateSides(in, side);
  write(side, pads, out);
}

void certify(const CertificateInput& in, CertificateOutput& out, PairOutput& motion) {
  Side side[kSides];
  const PairPads pads = relateSides(in.motion, side);
  write(side, pads, motion);
  side[0].still = side[1].moving = &in.a;
  side[0].moving = side[1].still = &in.b;
  const Side& s = side[in.side];
  const Piece &still = s.still->pieces[0], &moving = s.moving->pieces[0];
  out.separated = certainlySeparated(s, still, moving, Vec3(in.n), kAllLanes);
  out.separated_few = 0;
  for (unsigned lanes = (1u << kFewLanes) - 1; lanes & kAllLanes; lanes <<= kFewLanes) {
    out.separated_few |= certainlySeparated(s, still, moving, Vec3(in.n), lanes & kAllLanes);
  }
  Lanes G[3];
  gapBound(s, still, moving, Vec3(in.n), G);
  for (int lane = 0; lane < kLanes; ++lane) {
    for (int k = 0; k < 3; ++k) out.G[lane][k] = G[k][lane];
    out.prefix[lane] = positivePrefix(out.G[lane]);
  }
  TurningDirection turning;
  for (int k = 0; k < 3; ++k) {
    turning.begin[k] = Lanes(in.n[k] - in.turn[k]);
    turning.end[k] = Lanes(in.n[k] + in.turn[k]);
  }
  Lanes turned[3];
  gapBound(s, still, moving, turning, turned);
  for (int lane = 0; lane < kLanes; ++lane) {
    for (int k = 0; k < 3; ++k) out.turning_G[lane][k] = turned[k][lane];
    out.turning_prefix[lane] = positivePrefix(out.turning_G[lane]);
  }
}

void searchWholeLanes(const CertificateInput& in, WholeLanesOutput& out) {
  Side side[kSides];
  relateSides(in.motion, side);
  side[0].still = side[1].moving = &in.a;
  side[0].moving = side[1].still = &in.b;
  const Side& s = side[in.side];
  const Piece &still = s.still->pieces[0], &moving = s.moving->pieces[0];
  out.slack = slackOf(s, still, moving);
  for (int lane = 0; lane < kLanes; ++lane) {
    const SweptDifference difference(s, still, moving, lane);
    DifferencePoint p;
    difference.support(Vec3(in.n), p);
    out.least[lane] = dot(Vec3(in.n), p.w);
    const unsigned bit = 1u << lane;
    GjkResult g;
    searchNearest(difference, Vec3(in.n), {kWitnessAccuracy, out.slack, 48, out.slack}, g);
    if (g.lower > out.slack) {
      out.told |= bit;
      out.certified |= bit & certainlySeparated(s, still, moving, g.n, bit);
    }
    DifferenceBody body;
    body.tree_a = s.still;
    body.tree_b = s.moving;
    body.a = &still;
    body.b = &moving;
    body.pose = {laneOf(s.m.R[0], lane), laneOf(s.m.c[0], lane)};
    gjk(body, Vec3(in.n), {1e-7, still.radius + moving.radius + in.motion.margin, 48}, g);
    if (g.overlap) continue;
    out.middle |= bit & certainlySeparated(s, still, moving, g.n, bit);
  }
}

void sweepNodeOf(const PairInput& in, int side, const engine::Node& node, BoxOutput& out) {
  Side sides[kSides];
  const PairPads pads = relateSides(in, sides);
  SweptBox box;
  sweepNode(sides[side].m, node, pads.pad + in.margin, box);
  for (int k = 0; k < 3; ++k) {
    const float *lo = reinterpret_cast<const float*>(&box.lo[k]), *hi = reinterpret_cast<const float*>(&box.hi[k]);
    for (int lane = 0; lane < kLanes; ++lane) {
      out.lo[lane][k] = lo[lane];
      out.hi[lane][k] = hi[lane];
    }
  }
}

void sweepLssOf(const Chain& chain, const PairInput& in, const LssInput& lss, SweptLss& out) {
  Body body;
  for (int i = 0; i < 7; ++i) body.lss[i] = lss.lss[i];
  const int step = max(lss.step, 0);
  const FrameLanes* const frame = lss.step < 0 ? nullptr : &chain.frames[step];
  sweepLss({frame, chain.bounds[step], in.sweep.first_order, in.d}, body, out);
}

void boundLssOf(const PairInput& in, const LssInput& lss, BoxOutput& out) {
  const Chain chain(in);
  SweptLss swept;
  sweepLssOf(chain, in, lss, swept);
  Vec3Lanes lo, hi;
  boundLss(swept, 0, lo, hi);
  for (int k = 0; k < 3; ++k) {
    for (int lane = 0; lane < kLanes; ++lane) {
      out.lo[lane][k] = lo[k][lane];
      out.hi[lane][k] = hi[k][lane];
    }
  }
}

unsigned apartFromBox(const PairInput& in, const LssInput& lss, const numerics_test::StillBox& still) {
  SweptLss swept;
  sweepLssOf(Chain(in), in, lss, swept);
  CoreBox box;
  for (int k = 0; k < 3; ++k) {
    box.lo[k] = still.lo[k];
    box.hi[k] = still.hi[k];
  }
  box.radius = still.radius;
  NearestToBox nearest;
  if (!still.from_its_frame) return certainlyApart(swept, box, WorldSeen{still.inverse}, in.margin, nearest);
  SweptLss seen;
  seeFrom(still.inverse, swept, seen);
  return certainlyApart(seen, box, OwnFrame(), in.margin, nearest);
}

unsigned apartFromLss(const PairInput& in, const LssInput& a, const LssInput& b) {
  const Chain chain(in);
  SweptLss swept[2];
  sweepLssOf(chain, in, a, swept[0]);
  sweepLssOf(chain, in, b, swept[1]);
  Lanes square;
  return certainlyApart(swept[0], swept[1], in.margin, square);
}

void sineCosineOf(const double* x, double* sine, double* cosine) {
  Lanes a, s, c;
  for (int i = 0; i < kLanes; ++i) a.set(i, x[i]);
  sineCosine(a, s, c);
  for (int i = 0; i < kLanes; ++i) {
    sine[i] = s[i];
    cosine[i] = c[i];
  }
}

double positivePrefixOf(const double* G) {
  return positivePrefix(G);
}

DifferenceBody differenceOf(const TouchInput& in) {
  DifferenceBody body;
  body.tree_a = &in.a;
  body.tree_b = &in.b;
  body.a = in.a.pieces;
  body.b = in.b.pieces;
  body.pose = {Mat3(in.R), Vec3(in.c)};
  return body;
}

bool certainlyTouchingOf(const TouchInput& in) {
  const DifferenceBody body = differenceOf(in);
  Vec3 point;
  return certainlyTouching(body, in.margin, in.eps, Vec3(in.guess), point);
}

bool certainlyWithinOf(const TouchInput& in) {
  const DifferenceBody body = differenceOf(in);
  const Vec3 x(body.b->kind == PieceKind::vertices ? in.b.vertices : body.b->center);
  return certainlyWithin(*body.a, body.place(x), in.eps);
}

bool certainlyPiercesOf(const TouchInput& in) {
  const DifferenceBody body = differenceOf(in);
  Vec3 chord[2], corners[3];
  for (int i = 0; i < 3; ++i) corners[i] = body.place(Vec3(in.b.vertices + 3 * i));
  if (!longChord(*body.a, (corners[0] + corners[1] + corners[2]) / 3, chord)) return false;
  for (int i = 0; i < 3; ++i) {
    const Vec3 weights(i == 0, i == 1, i == 2);
    if (certainlyPierces(chord, corners, in.eps, weights, 0.5)) return true;
  }
  return false;
}

void arcTangentOf(const double* s, double* angle) {
  Lanes x;
  for (int i = 0; i < kLanes; ++i) x.set(i, s[i]);
  x = arcTangent(x);
  for (int i = 0; i < kLanes; ++i) angle[i] = x[i];
}

void boundVariableOf(const SweepStep& step, const engine::Query& query, double begin, double end, double* m) {
  FactorVariables variables;
  VariableBounds bounds;
  boundVariables(step, query, begin, end, variables, bounds);
  for (int n = 0; n < 4; ++n) m[n] = bounds.m[n];
}

}  // namespace
}  // namespace FCL_ARTIC_ISA

namespace numerics_test {
const Subject FCL_ARTIC_ISA_SUBJECT = {FCL_ARTIC_STRING(FCL_ARTIC_ISA),
                                       &FCL_ARTIC_ISA::sineCosineOf,
                                       &FCL_ARTIC_ISA::relate,
                                       &FCL_ARTIC_ISA::certify,
                                       &FCL_ARTIC_ISA::searchWholeLanes,
                                       &FCL_ARTIC_ISA::sweepNodeOf,
                                       &FCL_ARTIC_ISA::boundLssOf,
                                       &FCL_ARTIC_ISA::apartFromBox,
                                       &FCL_ARTIC_ISA::apartFromLss,
                                       &FCL_ARTIC_ISA::positivePrefixOf,
                                       &FCL_ARTIC_ISA::certainlyTouchingOf,
                                       &FCL_ARTIC_ISA::certainlyWithinOf,
                                       &FCL_ARTIC_ISA::certainlyPiercesOf,
                                       &FCL_ARTIC_ISA::arcTangentOf,
                                       &FCL_ARTIC_ISA::boundVariableOf};
}  // namespace numerics_test
}  // namespace fcl_artic
