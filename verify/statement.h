// SPDX-License-Identifier: BSD-3-Clause
// World and motion as doc/CERTIFICATES.md describes them, read strictly.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "sha256.h"
#include "support.h"
#include "taylor.h"

namespace verify {

/// Axes that are no coordinate axis may be off what they mean by 2^-kAxisBits in each entry.
constexpr int kAxisBits = 50;

struct Element {
  enum Kind { turn, slide, rotate } kind;
  int variable;
  double axis[3], multiplier, offset;
  Vec unit;  // turn and slide: every unit axis that is meant
  Mat products;
};

/// A place between bodies where tolerances let one side move against the other. A point moves there by at most `slide`
/// + `chord` times its distance from an axis or a centre (tube.cpp).
struct Give {
  int element = -1;   // of the frame; the place is after it, or before all of them
  bool axis = false;  // the distance is that from the axis `at` through 0, else from the point `at`
  Vec at{};
  Fix slide, chord;  // m, and twice the sine of half the angle
};

struct Frame {
  std::string name;
  int parent, depth;
  double numbers[12];  // as stated: rotation by rows, then translation
  Pose origin;         // with every rotation that the numbers may mean
  std::vector<Element> elements;
  std::vector<Give> gives;  // in their order, from the parent on
};

enum class Role { link, carried, obstacle };
enum class Reason { same_frame, obstacles, still, neighbours, allowed, touch_link, scope, ignored };
constexpr int kReasons = 8;
const char* nameOf(Reason reason);
const char* nameOf(Role role);
/// A name in quotes, so that no name looks like another text: quotes, backslashes and characters that do not print
/// become \xNN.
std::string inQuotes(std::string_view name);

struct Body {
  Role role;
  std::string name;
  int name_id, frame, geometry;
  double numbers[12];
  Pose pose;
  std::vector<Give> gives;  // of its pose: none or one; in the geometry's coordinates
};

/// How far slides by variables that follow each other may lead together from where they are stated to lead.
struct VectorTolerance {
  int count;      // of the variables: 2 or 3
  double length;  // m
};

/// How far a pose may be from where it is stated.
struct PoseTolerance {
  double length, angle;  // m, rad
  double pivot[3];       // about which it turns
};

/// How fast a body may move by itself, and from when on.
struct Speed {
  double speed, since;  // m/s; s on the motion's clock
};

struct Unchecked {
  Reason reason;
  std::uint64_t pairs = 0;  // of bodies, that are not checked for it
};

/// A pair that is checked unless the motion's scope leaves it out.
struct Partner {
  int body;
  bool self;  // neither is an obstacle
};

struct World {
  std::string hash;  // of its text
  std::vector<std::string> variables, names;
  std::vector<Frame> frames;  // frame 0: the world
  std::vector<Geometry> geometries;
  std::vector<Body> bodies;
  std::map<int, double> margins;
  std::map<std::pair<int, int>, double> pair_margins;
  std::map<std::pair<int, int>, Unchecked> unchecked;  // by names, the lower number first
  // Tolerances: of variables, of vectors and rotations by their first variable, of frames, of names of bodies.
  std::map<int, double> variable_tolerances, rotation_tolerances;
  std::map<int, VectorTolerance> vector_tolerances;
  std::map<int, PoseTolerance> frame_tolerances, body_tolerances;
  std::map<int, Speed> speeds;  // by names of bodies
  // Derived:
  bool gives = false;                          // a frame or body does
  std::vector<char> moves, turns;              // of each variable: whether an element uses it; a `rotate` begins there
  std::vector<std::vector<Partner>> partners;  // of each body, lower numbers only
  std::uint64_t not_checked[kReasons] = {};
  std::string false_reason;  // a pair that is listed for a reason that it has not, and which; empty: none

  /// margin(A, B) without `added`, where the motion's own is `general`.
  double margin(int a, int b, double general) const;
  std::string describe(int body) const;
};

struct Piece {
  std::map<int, std::vector<double>> polynomials;     // by variable: coefficients of 1, t, t^2, ...
  std::map<int, std::array<double, 9>> orientations;  // by variable
  std::map<std::pair<int, int>, double> ignored;      // by bodies, the lower number first: until when
  /// s: how long the whole motion has taken at t = 0 and at t = 1, linear between. Where the world has speeds.
  double clock[2] = {0, 0};
  bool has_clock = false;
};
struct Motion {
  std::string hash;  // of its text
  std::string world;
  double margin = 0, added = 0, duration = 0, until = 1;
  bool self = false, scene = false;
  std::vector<Piece> pieces;
};

/// Derives from a world the partners of each body, and the pairs that are not checked. @throws BadInput
void derivePairs(World& world);
/// Derives from a world's tolerances what frames and bodies give. @throws BadInput: one that has no meaning.
void deriveGives(World& world);
/// @throws BadInput, naming the line.
World readWorld(std::string_view text);
Motion readMotion(std::string_view text, const World& world);

/// Whether two of three numbers are 0: such an axis is meant exactly.
bool isCoordinateAxis(const double axis[3]);
/// Numbers of a rotation (by rows) and a translation as the statement means them: any rotation whose entries are within
/// 2^-49 of the numbers, exactly that translation.
Mat statedRotation(const double numbers[9]);
Pose statedPose(const double numbers[12]);

}  // namespace verify
