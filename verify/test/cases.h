// SPDX-License-Identifier: BSD-3-Clause
// Random worlds and motions for tests.
#pragma once

#include "worlds.h"

namespace verify::test {

/// Lines of a geometry of that kind, 0 to 9.
inline std::string anyGeometry(Rng& rng, int kind, double size) {
  const auto r = [&]() { return hex(uniform(rng, 0.05, 1) * size); };
  const auto p = [&]() {
    return hex(V{uniform(rng, -size, size), uniform(rng, -size, size), uniform(rng, -size, size)});
  };
  std::string s;
  switch (kind) {
    case 0:
      return "geometry box " + r() + " " + r() + " " + r() + "\n";
    case 1:
      return "geometry sphere " + r() + "\n";
    case 2:
      return "geometry ellipsoid " + r() + " " + r() + " " + r() + "\n";
    case 3:
      return "geometry capsule " + r() + " " + r() + "\n";
    case 4:
      return "geometry cylinder " + r() + " " + r() + "\n";
    case 5:
      return "geometry cone " + r() + " " + r() + "\n";
    case 6:
      s = "geometry hull\nvertices 20\n";
      for (int k = 0; k < 20; ++k) s += p() + "\n";
      return s;
    case 7:
      s = "geometry boxes\ncells 30\n";
      for (int k = 0; k < 30; ++k) s += p() + " " + hex(0.1 * size) + " " + r() + " " + hex(0) + "\n";
      return s;
    case 8:
      return boxMesh({uniform(rng, 0.1, 1) * size, uniform(rng, 0.1, 1) * size, uniform(rng, 0.1, 1) * size},
                     rng() % 2);
    default:
      s = "geometry mesh surface\nvertices 150\n";
      for (int k = 0; k < 150; ++k) s += p() + "\n";
      s += "triangles 50\n";
      for (int k = 0; k < 50; ++k)
        s += std::to_string(3 * k) + " " + std::to_string(3 * k + 1) + " " + std::to_string(3 * k + 2) + "\n";
      return s;
  }
}

struct Case {
  std::string world_text, without_last;
  MotionText motion;
};

/// A chain with bodies of all kinds, obstacles around it, a motion.
inline Case anyCase(Rng& rng) {
  Case c;
  std::string& s = c.world_text;
  s = kHead;
  const int joints = 1 + static_cast<int>(rng() % 4);
  const bool floating = rng() % 4 == 0;
  const int variables = joints + (floating ? 6 : 0);
  for (int v = 0; v < variables; ++v) s += "variable v" + std::to_string(v) + "\n";
  int parent = 0;
  if (floating) {
    s += "frame float 0 " + hex(M{}) + "\n";
    for (int k = 0; k < 3; ++k)
      s += "slide " + hex(V{k == 0 ? 1.0 : 0, k == 1 ? 1.0 : 0, k == 2 ? 1.0 : 0}) + " " + std::to_string(joints + k) +
           " " + hex(1) + " " + hex(0) + "\n";
    s += "rotate " + std::to_string(joints + 3) + "\n";
    parent = 1;
  }
  std::vector<int> frames;
  for (int f = 0; f < joints; ++f) {
    M origin = rotationAbout({uniform(rng, -1, 1), uniform(rng, -1, 1), uniform(rng, -1, 1)}, uniform(rng, -1, 1));
    origin.t = {f == 0 ? 0 : 0.5, 0, 0};
    s += "frame f" + std::to_string(f) + " " + std::to_string(parent) + " " + hex(origin) + "\n";
    if (rng() % 4) {
      s += "turn " + hex(V{uniform(rng, -1, 1), uniform(rng, -1, 1), 1}) + " " + std::to_string(f) + " " + hex(1) +
           " " + hex(0) + "\n";
    } else {
      s += "slide " + hex(V{uniform(rng, -1, 1), 0, 1}) + " " + std::to_string(f) + " " + hex(0.3) + " " + hex(0.1) +
           "\n";
    }
    parent = f + 1 + (floating ? 1 : 0);
    frames.push_back(parent);
  }
  std::string bodies;
  int geometries = 0;
  const int obstacles = 1 + static_cast<int>(rng() % 5);
  for (int o = 0; o < obstacles; ++o) {
    M pose = anyPose(rng, 0);
    const double angle = uniform(rng, -3, 3), r = uniform(rng, 0.4, 1.6);
    pose.t = {r * std::cos(angle), r * std::sin(angle), uniform(rng, -1, 1)};
    if (rng() % 8 == 0) {
      s += std::string("geometry ") + (rng() % 2 ? "halfspace " : "plane ") + hex(V{0.2, 0.1, 2}) + " " +
           hex(uniform(rng, -3, -1)) + "\n";
      pose = M{};
    } else {
      s += anyGeometry(rng, static_cast<int>(rng() % 9), 0.3);
    }
    bodies += "body obstacle o" + std::to_string(o) + " 0 " + std::to_string(geometries++) + " " + hex(pose) + "\n";
  }
  for (std::size_t f = 0; f < frames.size(); ++f) {
    s += anyGeometry(rng, static_cast<int>(rng() % 9), 0.2);
    M pose = anyPose(rng, 0);
    pose.t = {0.25, 0, 0};
    bodies += "body link l" + std::to_string(f) + " " + std::to_string(frames[f]) + " " + std::to_string(geometries++) +
              " " + hex(pose) + "\n";
    if (f > 0) bodies += "unchecked allowed l" + std::to_string(f - 1) + " l" + std::to_string(f) + "\n";
  }
  s += bodies;
  c.motion.margin = rng() % 2 ? 0.001 : uniform(rng, 0.001, 0.05);
  const int pieces = rng() % 5 == 0 ? 2 : 1;
  std::vector<double> at;  // where the variables are when a piece begins
  for (int v = 0; v < variables; ++v) at.push_back(v < joints || v < joints + 3 ? uniform(rng, -1, 1) : 0);
  for (int p = 0; p < pieces; ++p) {
    std::string piece;
    for (int v = 0; v < variables; ++v) {
      double& x = at[static_cast<std::size_t>(v)];
      piece += "q " + std::to_string(v) + " " + hex(x);
      for (int k = pieces > 1 ? 3 : 1; k > 0; --k) {
        const double c = uniform(rng, -0.6, 0.6);
        piece += " " + hex(c);
        x += c;
      }
      piece += "\n";
    }
    c.motion.pieces.push_back(piece);
  }
  return c;
}

}  // namespace verify::test
