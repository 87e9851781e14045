// SPDX-License-Identifier: BSD-3-Clause
//
// Motion as the engine sees it: moving factors from a base frame on. Plain data; its owner is FrameSweep.
#pragma once

#include <cstdint>

namespace fcl_artic {
namespace engine {

/// A rigid transform that stands still.
struct Placement {
  double R[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};  ///< row-major
  double t[3] = {0, 0, 0};
  double length = 0;  ///< upper bound of |t| and of the sum of the translations it was multiplied from
  double ulps = 0;    ///< R is this many 2^-52 from the model's rotation, t this many 2^-52 of `length`
  bool identity = true;
};

/// The kind of motion between a step's frame and the one before it.
enum class StepKind : std::int32_t {
  revolute,   ///< a turn about z by q
  prismatic,  ///< a slide along z by q
  slide,      ///< a translation by the vector q
  turn,       ///< exp([q]) R0, q a rotation vector, R0 a rotation that the query gives (none: 1)
  bounded,    ///< BoundedSource, or its inverse
};

/// Whether the step is a turn that a variable says, about an axis or any. (Static: each instruction set has its own.)
static inline bool turns(StepKind kind) {
  return kind == StepKind::revolute || kind == StepKind::turn;
}

/// A motion that only its author knows: plain functions, so that the engine can ask.
struct BoundedSource {
  const void* self = nullptr;
  /// Rotation (row-major), origin, its velocity and acceleration, angular velocity and acceleration: 9 + 5 * 3 numbers.
  void (*state)(const void* self, double t, double* out) = nullptr;
  /// Upper bounds over [begin, end]: origin's first to third derivative, angular velocity and its two derivatives.
  void (*bounds)(const void* self, double begin, double end, double* out) = nullptr;
  bool derivatives = true;  ///< false: only pose, speed and angular speed are meaningful
};

/// Highest power of t in a variable.
constexpr std::int32_t kMaxDegree = 5;

/// One moving factor on the way from a base frame: X = X_parent * C * J(t).
struct SweepStep {
  std::int32_t parent = -1;  ///< step before this one, -1: the base frame
  StepKind kind = StepKind::revolute;
  double C[9], p[3];            ///< constant transform from the parent step's frame
  double perp = 0, axial = 0;   ///< |p| across and along the axis of a revolute parent (others: axial 0, perp |p|)
  double length = 0, ulps = 0;  ///< of C and p, as in Placement
  std::int32_t variable = -1;   ///< revolute, prismatic: the variable; slide, turn: the first of three
  double multiplier = 1, offset = 0;  ///< q = multiplier * q_variable + offset; slide, turn: offset 0
  /// The factor may be this far from what the motion gives it: rad for a revolute step or a turn (the angle of the
  /// rotation between both), m for the others.
  double stray = 0;
  std::int32_t orientation = -1;          ///< turn: number of its R0 among Query::orientations; -1: none
  const BoundedSource* source = nullptr;  ///< bounded
  /// bounded: J is the inverse of the source's pose; turn: of exp([-q]) R0, that is R0^T exp([q]).
  bool inverse = false;
};

/// Steps from one base frame, parents first.
struct SweepView {
  const SweepStep* steps = nullptr;
  std::int32_t num_steps = 0;
  /// Bounds hold for one batch of intervals only (a bounded motion), not for all of [0, 1].
  bool local_bounds = false;
  bool first_order = false;  ///< a bounded motion without derivatives is among the steps
  bool strays = false;       ///< so is a step that strays
};

/// Motion of B's tree frame in A's over [tm - d, tm + d]: X(t) = X[0] + tau X[1] + tau^2 X[2] + e, tau = (t - tm) / d,
/// for the rotation R (row-major) and the position c; a point p of B is at R p + c, up to |e| <= rem_c + rem_R |p| +
/// pad.
struct PairMotion {
  double R[3][9], c[3][3];
  double rem_c, rem_R;  ///< what the quadratic leaves out: shrinks like d^3
  double pad;           ///< rounding: does not shrink
};

}  // namespace engine
}  // namespace fcl_artic
