// SPDX-License-Identifier: BSD-3-Clause
//
// How deep bodies seem to be in each other decides what is tried first. Nothing is proven with them. They are ordered
// from barely touching to deep. The first two are depths of hulls, as parts of the smaller body's radius. The next
// three are distances from a line swept sphere's segment, as parts of the sphere's radius: a deeper body has a smaller
// distance. The last is a width.
#pragma once

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

/// A body no deeper than this in another one's hull may rest on it.
constexpr double kBarely = 1e-6;
/// Hulls may rest on each other if they are about as deep as this at most.
constexpr double kShallow = 0.01;
/// A body is expected to touch whatever is nearer to its segment. Measured: from 0.7 on to 1 it makes no difference,
/// below contacts are found later.
constexpr double kDeep = 0.7;
/// Two links are expected to touch if their segments are nearer than this part of the radii's sum.
constexpr double kDeepLinks = 0.7;
/// If a body is nearer to the segment than this, triangles may meet at that pose though no ball or vertex is inside.
constexpr double kVeryDeep = 0.35;
/// In solids whose width is less than this part of the sphere's radius chords are tried before vertices.
constexpr double kThinSolid = 0.5;

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
