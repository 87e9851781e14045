// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>

namespace fcl_artic {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Bounds the relative error of one operation in any rounding mode.
constexpr double kUlp = 0x1p-52;

/// By how much the poses that a BoundedMotion gives, and their inverses, may be off, in kUlp: of the rotation, and of
/// the origin's length. By contract an entry of a rotation is off by 5e-13, so the rotation by 1.5e-12 (Frobenius), and
/// a vector by 5e-13 of its length. The inverse's origin -R^T c is off by both together, and a few roundings.
constexpr double kBoundedUlps = 12288;
static_assert(kBoundedUlps * kUlp > 1.5e-12 + 5e-13 + 64 * kUlp);

/// Coordinates and lengths allowed, m: up to here pads stay small enough for precise answers.
constexpr double kFarthest = 1e9;

}  // namespace fcl_artic
