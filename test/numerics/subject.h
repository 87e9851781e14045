// SPDX-License-Identifier: BSD-3-Clause
//
// The engine's arithmetic behind plain arrays, compiled once per instruction set (subject_*.cpp), so that the tests
// themselves hold no code that a processor may lack.
#pragma once

#include <cstdint>
#include <vector>

#include "model/query.h"

namespace fcl_artic {
namespace numerics_test {

constexpr int kSides = 2;  ///< 0: B seen from A, 1: A seen from B

/// A pair over eight intervals [tm - d, tm + d].
struct PairInput {
  engine::SweepView sweep;
  std::int32_t step_b = -1;
  engine::Placement inverse_a, placement_b;
  double extents = 0, margin = 0;
  engine::Query query;  ///< its coefficients count
  double tm[8] = {}, d = 0;
};

/// Quadratics [side][order][entry][lane], and bounds on what they leave out.
struct PairOutput {
  double R[kSides][3][9][8], c[kSides][3][3][8];
  double rem_c[kSides], rem_R[kSides], pad, pose;
};

struct CertificateInput {
  PairInput motion;
  engine::TreeView a, b;  ///< of one piece each
  double n[3] = {};       ///< unit, in A's frame for side 0, in B's for side 1
  int side = 0;
  double turn[3] = {};  ///< the direction that turns goes from n - turn to n + turn over each interval
};
struct CertificateOutput {
  double G[8][3], prefix[8];
  double turning_G[8][3], turning_prefix[8];  ///< along the direction that turns
  unsigned separated;
  unsigned separated_few;  ///< the same, asked for a few lanes at a time
};

/// Results for whole lanes, each searched by itself from CertificateInput::n on.
struct WholeLanesOutput {
  double least[8];         ///< of n.x over the difference of the moving piece's Bernstein poses and the still piece
  double slack;            ///< what it has to be larger than
  unsigned told = 0;       ///< lanes in which a direction is said to do
  unsigned certified = 0;  ///< in which it does
  unsigned middle = 0;     ///< in which the witness at the lane's middle does
};

struct BoxOutput {
  double lo[8][3], hi[8][3];
};

/// A line swept sphere that a step carries.
struct LssInput {
  std::int32_t step = -1;  ///< -1: it stands in the base frame
  double lss[7];           ///< in the step's frame
};
/// A box, grown by a ball, that stands still.
struct StillBox {
  double lo[3], hi[3], radius = 0;
  engine::Placement inverse;    ///< the base frame in the box's
  bool from_its_frame = false;  ///< the line swept sphere is seen from there first, as stage 1 sees it in a large body
};

struct TouchInput {
  engine::TreeView a, b;  ///< of one piece each
  double R[9], c[3];      ///< B in A's frame
  double margin = 0, eps = 0, guess[3] = {};
};

struct Subject {
  const char* name;
  void (*sineCosine)(const double* x, double* sine, double* cosine);
  void (*relate)(const PairInput& in, PairOutput& out);
  void (*certify)(const CertificateInput& in, CertificateOutput& out, PairOutput& motion);
  void (*searchWholeLanes)(const CertificateInput& in, WholeLanesOutput& out);
  /// The moving node's box on the given side.
  void (*sweepNode)(const PairInput& in, int side, const engine::Node& node, BoxOutput& out);
  /// Box of a line swept sphere, seen from the base frame.
  void (*boundLss)(const PairInput& in, const LssInput& lss, BoxOutput& out);
  /// Lanes in which it is certainly apart from a box, and from another one of the sweep; margin: in.margin.
  unsigned (*apartFromBox)(const PairInput& in, const LssInput& lss, const StillBox& box);
  unsigned (*apartFromLss)(const PairInput& in, const LssInput& a, const LssInput& b);
  double (*positivePrefix)(const double* G);
  bool (*certainlyTouching)(const TouchInput& in);
  /// B's first vertex, or its core's centre, within A.
  bool (*certainlyWithin)(const TouchInput& in);
  /// A chord of A through B, a triangle, by any of the prism's tetrahedra.
  bool (*certainlyPierces)(const TouchInput& in);
  void (*arcTangent)(const double* s, double* angle);
  /// Bounds over [begin, end] of the step's variable and its first three derivatives.
  void (*boundVariable)(const engine::SweepStep& step, const engine::Query& query, double begin, double end, double* m);
};

extern const Subject kSubjectPortable, kSubjectSse2, kSubjectAvx2, kSubjectAvx512, kSubjectNeon;

/// The subjects that this processor runs.
std::vector<const Subject*> subjects();

}  // namespace numerics_test
}  // namespace fcl_artic
