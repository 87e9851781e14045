// SPDX-License-Identifier: BSD-3-Clause
// Witnesses of contact: those that show one, and those that do not.
#include <gtest/gtest.h>

#include "worlds.h"

namespace verify::test {
namespace contact_test {

constexpr double kX = 0.125;  // where the first body is at t = 1/2

/// Body 0 stands still in the world, body 1 slides along x as x = t - 3/8, both turned by the same pose. Body 2 is far
/// away, so that something is checked.
struct Pair {
  World world;
  std::string motion;
  Pair(const std::string& still, const std::string& moving, double margin = 0, const M& pose = {}) {
    world = readWorld(kHead + "variable x\nframe f 0 " + hex(pose) + "\nslide " + hex(V{1, 0, 0}) + " 0 " + hex(1) +
                      " " + hex(0) + "\n" + still + moving + "geometry sphere " + hex(0.5) + "\nbody obstacle o 0 0 " +
                      hex(pose) + "\nbody link l 1 1 " + hex(M{}) + "\nbody obstacle far 0 2 " +
                      hex(M{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {1000, 0, 0}}) + "\n");
    MotionText m;
    m.margin = margin;
    m.scope = "scene";
    m.pieces = {"q 0 " + hex(-3 / 8.0) + " " + hex(1) + "\n" + "ignored 0 1 " + hex(0.25) + "\n"};
    m.until = 0.25;
    motion = m.write(world);
  }
  /// The pair of the first root is ignored until the end of the claim, so any node proves it.
  mutable std::string last;
  bool shown(int first, int second, double t, const std::string& witness) const {
    const Verdict v =
        judge(world, motion,
              sep({1, 0, 0}) + sep({1, 0, 0}) + "\x20" + varint(0) + varint(static_cast<std::uint32_t>(first)) +
                  varint(static_cast<std::uint32_t>(second)) + number(t) + witness);
    EXPECT_EQ(v.verified, v.contact);
    EXPECT_EQ(v.near, v.verified && witness[0] == '\4');
    if (v.bad_input) ADD_FAILURE() << v.reason;
    last = v.reason;
    return v.verified;
  }
};
std::string cross(bool of_second, std::uint32_t triangle, std::uint32_t edge, std::uint32_t crossed) {
  return std::string(1, of_second ? '\1' : '\0') + varint(triangle) + varint(edge) + varint(crossed);
}
std::string weights(std::uint32_t piece, const std::vector<std::pair<std::uint32_t, std::uint32_t>>& all) {
  std::string s = varint(piece) + varint(static_cast<std::uint32_t>(all.size()));
  for (const auto& [vertex, weight] : all) s += varint(vertex) + little(weight, 4);
  return s;
}
std::string place(const V& x, std::uint32_t piece = 0) {
  return varint(piece) + number(x[0]) + number(x[1]) + number(x[2]);
}

TEST(VerifyContact, AnEdgeCrossesATriangle) {
  // The still triangle lies in z = 0, corners (0,0), (1,0), (0,1); the moving one has the edge (x + a, a, -1)-(x + a,
  // a, 1).
  const std::string still = meshText({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}, false);
  Rng rng(21);
  int yes = 0, no = 0;
  for (int n = 0; n < 400; ++n) {
    const double a = uniform(rng, -0.5, 1), y = uniform(rng, -0.5, 1), z0 = uniform(rng, -1, 1),
                 z1 = uniform(rng, -1, 1);
    const std::string moving = meshText({{9, 9, 9}, {a, y, z0}, {a, y, z1}}, {{0, 1, 2}}, false);
    const Pair pair(still, moving, 0, anyPose(rng, 1));
    const double x = a + kX;
    const bool truth = x > 0 && y > 0 && x + y < 1 && z0 * z1 < 0;
    EXPECT_EQ(pair.shown(1, 0, 0.5, cross(false, 0, 1, 0)), truth)
        << pair.last << " " << x << " " << y << " " << z0 << " " << z1;
    EXPECT_EQ(pair.shown(0, 1, 0.5, cross(true, 0, 1, 0)), truth);
    EXPECT_FALSE(pair.shown(1, 0, 0.5, cross(false, 0, 0, 0)) && false);
    (truth ? yes : no)++;
    if (truth) {
      EXPECT_FALSE(pair.shown(1, 0, 0.25, cross(false, 0, 1, 0)));  // ignored then
    }
  }
  EXPECT_GT(yes, 20);
  EXPECT_GT(no, 100);
  // An edge that only touches: no sign is certain.
  const Pair touch(still, meshText({{9, 9, 9}, {0.125, 0.25, 0}, {0.125, 0.25, 1}}, {{0, 1, 2}}, false));
  EXPECT_FALSE(touch.shown(1, 0, 0.5, cross(false, 0, 1, 0)));
}

TEST(VerifyContact, APointIsInsideOfAShape) {
  const std::string sphere = "geometry sphere " + hex(0.25) + "\n";  // moving; its centre is at (x, 0, 0) at t
  struct Shape {
    std::string text;
    std::function<bool(const V&)> inside;
  };
  const std::vector<Shape> shapes = {
      {"geometry box " + hex(V{1, 0.5, 2}) + "\n",
       [](const V& p) { return std::fabs(p[0]) < 0.5 && std::fabs(p[1]) < 0.25 && std::fabs(p[2]) < 1; }},
      {"geometry sphere " + hex(0.4) + "\n", [](const V& p) { return norm(p) < 0.4; }},
      {"geometry ellipsoid " + hex(V{0.4, 0.2, 0.6}) + "\n",
       [](const V& p) {
         return norm({p[0] / 0.4, p[1] / 0.2, p[2] / 0.6}) < 1;
       }},
      {"geometry capsule " + hex(0.3) + " " + hex(0.8) + "\n",
       [](const V& p) {
         return norm({p[0], p[1], p[2] - std::max(-0.4, std::min(0.4, p[2]))}) < 0.3;
       }},
      {"geometry cylinder " + hex(0.3) + " " + hex(0.8) + "\n",
       [](const V& p) { return std::hypot(p[0], p[1]) < 0.3 && std::fabs(p[2]) < 0.4; }},
      {"geometry cone " + hex(0.6) + " " + hex(0.8) + "\n",
       [](const V& p) { return std::fabs(p[2]) < 0.4 && std::hypot(p[0], p[1]) < 0.6 * (0.4 - p[2]) / 0.8; }},
      {"geometry halfspace " + hex(V{0, 2, 0}) + " " + hex(0.2) + "\n", [](const V& p) { return p[1] < 0.1; }},
      {"geometry boxes\ncells 2\n" + hex(V{5, 5, 5}) + " " + hex(V{1, 1, 1}) + "\n" + hex(V{0.1, 0, 0}) + " " +
           hex(V{0.2, 0.2, 0.3}) + "\n",
       [](const V& p) { return std::fabs(p[0] - 0.1) < 0.2 && std::fabs(p[1]) < 0.2 && std::fabs(p[2]) < 0.3; }},
      {"geometry hull\nvertices 4\n" + hex(V{0, 0, 0}) + "\n" + hex(V{0, 0.5, 0}) + "\n" + hex(V{1, 0, 0}) + "\n" +
           hex(V{0, 0, 0.5}) + "\n",
       [](const V& p) { return p[0] > 0 && p[1] > 0 && p[2] > 0 && p[0] + 2 * p[1] + 2 * p[2] < 1; }}};
  Rng rng(22);
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    const M pose = anyPose(rng, 1);
    const Pair pair(shapes[k].text, sphere, 0, pose);
    const std::string container =
        varint(k == 7 ? 1 : 0) + (k == 8 ? varint(0) + varint(1) + varint(2) + varint(3) : "");
    int yes = 0, no = 0;
    for (int n = 0; n < 300; ++n) {
      const V p{uniform(rng, -0.25, 0.25), uniform(rng, -0.25, 0.25), uniform(rng, -0.25, 0.25)};
      const V x = p + V{kX, 0, 0};
      const bool truth = norm(p) < 0.25 && shapes[k].inside(x);  // outside of its own ball it is no point of it
      EXPECT_EQ(pair.shown(1, 0, 0.5, "\2" + place(p) + container), truth) << k;
      EXPECT_EQ(pair.shown(0, 1, 0.5, "\3" + place(p) + container), truth) << k;
      (truth ? yes : no)++;
    }
    EXPECT_GT(yes, 5) << k;
    EXPECT_GT(no, 5) << k;
  }
}

TEST(VerifyContact, APointIsInsideOfASmallShape) {
  const std::string sphere = "geometry sphere " + hex(1) + "\n";  // moving; its centre is at (x, 0, 0) at t
  Rng rng(27);
  for (const double u : {1e-2, 1e-3, 1e-5}) {
    struct Shape {
      std::string text;
      std::function<double(const V&)> gauge;  // below 1 inside
    };
    const std::vector<Shape> shapes = {{"geometry sphere " + hex(u) + "\n", [](const V& p) { return norm(p); }},
                                       {"geometry ellipsoid " + hex(V{u, 0.5 * u, u / 8}) + "\n",
                                        [](const V& p) {
                                          return norm({p[0], p[1] / 0.5, p[2] * 8});
                                        }},
                                       {"geometry capsule " + hex(u) + " " + hex(u) + "\n",
                                        [](const V& p) {
                                          return norm({p[0], p[1], p[2] - std::max(-0.5, std::min(0.5, p[2]))});
                                        }},
                                       {"geometry cylinder " + hex(u) + " " + hex(2 * u) + "\n",
                                        [](const V& p) { return std::max(std::hypot(p[0], p[1]), std::fabs(p[2])); }},
                                       {"geometry cone " + hex(u) + " " + hex(2 * u) + "\n", [](const V& p) {
                                          return p[2] < -1 || p[2] > 1 ? 2 : 2 * std::hypot(p[0], p[1]) / (1 - p[2]);
                                        }}};
    for (std::size_t k = 0; k < shapes.size(); ++k) {
      const Pair pair(shapes[k].text, sphere, 0, anyPose(rng, 1));
      int yes = 0, no = 0;
      for (int n = 0; n < 200; ++n) {
        V q;  // in units of u, then so far out that the gauge is next to 1
        do q = {uniform(rng, -1, 1), uniform(rng, -1, 1), uniform(rng, -1, 1)};
        while (!(shapes[k].gauge(q) < 1));
        const bool round = k == 1 || k == 0;  // gauges that scale
        const double to = n % 2 ? 0.999 : 1.001, by = round ? to / shapes[k].gauge(q) : n % 2 ? 1 : 4;
        const V x{u * by * q[0], u * by * q[1], u * by * q[2]}, p{x[0] - kX, x[1], x[2]};
        const double gauge = shapes[k].gauge({by * q[0], by * q[1], by * q[2]});
        if (std::fabs(gauge - 1) < 1e-4) continue;
        EXPECT_EQ(pair.shown(1, 0, 0.5, "\2" + place(p) + varint(0)), gauge < 1) << u << " " << k << " " << gauge;
        (gauge < 1 ? yes : no)++;
      }
      EXPECT_GT(yes, 50) << k;
      EXPECT_GT(no, 20) << k;
    }
  }
}

TEST(VerifyContact, AFlatConeIsADisc) {
  // Its inequality, multiplied by the height, holds for every point of its plane.
  const World world = readWorld(
      kHead + "variable x\nframe f 0 " + hex(M{}) + "\nslide " + hex(V{1, 0, 0}) + " 0 " + hex(1) + " " + hex(0) +
      "\ngeometry cone " + hex(1) + " " + hex(0) + "\ngeometry sphere " + hex(1) + "\nbody obstacle o 0 1 " +
      hex(M{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {1000, 0, 0}}) + "\nbody link cone 1 0 " + hex(M{}) + "\n");
  MotionText m;
  m.pieces = {""};
  const std::string far = number(1000) + number(0) + number(0);
  const Verdict v = judge(
      world, m.write(world),
      sep({-1, 0, 0}) + "\x20" + varint(0) + varint(1) + varint(0) + number(0.5) + "\2" + varint(0) + far + varint(0));
  EXPECT_FALSE(v.verified);
  EXPECT_NE(v.reason.find("not certainly in its piece"), std::string::npos) << v.reason;
}

TEST(VerifyContact, TwoPointsAreNear) {
  const std::string mesh = meshText({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, -7}}, {{0, 1, 3}, {0, 1, 2}}, false);
  const std::string hull = "geometry hull\nvertices 4\n" + hex(V{0.2, 0.25, 0.1}) + "\n" + hex(V{0.2, 0.25, 3}) + "\n" +
                           hex(V{0, 3, 3}) + "\n" + hex(V{3, 0, 3}) + "\n";
  const std::string on_mesh = weights(1, {{0, 500000000}, {1, 325000000}, {2, 250000000 - 75000000}});
  Rng rng(23);
  for (const double margin : {0.0, 0.1, 0.101, 0.2}) {
    const Pair pair(mesh, hull, margin, anyPose(rng, 1));
    // (0.325, 0.175): the hull's vertex 0 is at (0.325, 0.25, 0.1)
    const double distance = std::hypot(0.075, 0.1);
    EXPECT_EQ(pair.shown(0, 1, 0.5, "\4" + on_mesh + weights(0, {{0, 4000000000u}})), distance < margin);
    EXPECT_EQ(pair.shown(1, 0, 0.5, "\4" + weights(0, {{0, 1}}) + on_mesh), distance < margin);
    EXPECT_EQ(pair.shown(0, 1, 0.5, "\4" + weights(1, {{0, 1000}, {1, 650}, {2, 500}}) + weights(0, {{0, 3}, {1, 0}})),
              std::hypot(0.325 - 650 / 2150.0, 0.25 - 500 / 2150.0, 0.1) < margin);
    EXPECT_FALSE(pair.shown(0, 1, 0.5, "\4" + on_mesh + weights(0, {{1, 1}})));
  }
}

TEST(VerifyContact, WhatIsNotCheckedOrNotThereIsRefused) {
  const std::string sphere = "geometry sphere " + hex(0.25) + "\n";
  const Pair pair(sphere, sphere);
  const std::string root = sep({1, 0, 0}) + sep({1, 0, 0}), in = "\2" + place({0, 0, 0}) + varint(0);
  const auto verdict = [&](const std::string& contact) { return judge(pair.world, pair.motion, root + contact); };
  const auto contact = [&](std::uint32_t piece, std::uint32_t a, std::uint32_t b, double t,
                           const std::string& witness) {
    return "\x20" + varint(piece) + varint(a) + varint(b) + number(t) + witness;
  };
  EXPECT_TRUE(verdict(contact(0, 1, 0, 0.5, in)).verified);
  EXPECT_FALSE(verdict(contact(1, 1, 0, 0.5, in)).verified);
  EXPECT_FALSE(verdict(contact(0, 1, 1, 0.5, in)).verified);
  EXPECT_FALSE(verdict(contact(0, 2, 0, 0.5, in)).verified);
  EXPECT_FALSE(verdict(contact(0, 3, 0, 0.5, in)).verified);
  EXPECT_FALSE(verdict(contact(0, 1, 0, 1.5, in)).verified);
  EXPECT_FALSE(verdict(contact(0, 1, 0, std::nan(""), in)).verified);
  EXPECT_FALSE(verdict(contact(0, 1, 0, 0.5, "\5" + in)).verified);
  EXPECT_FALSE(verdict(contact(0, 1, 0, 0.5, in) + "\x20").verified);
  EXPECT_FALSE(verdict(contact(0, 1, 0, 0.5, cross(false, 0, 0, 0))).verified);
  EXPECT_FALSE(verdict(contact(0, 1, 0, 0.5, "\2" + place({0, 0, 0}, 1) + varint(0))).verified);
  EXPECT_FALSE(verdict(contact(0, 1, 0, 0.5, "\2" + place({0, 0, 0}) + varint(1))).verified);
  const World self = readWorld(kHead + sphere + "frame a 0 " + hex(M{}) + "\nbody link a 0 0 " + hex(M{}) +
                               "\nbody link b 1 0 " + hex(M{}) + "\nbody obstacle far 0 0 " +
                               hex(M{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {1000, 0, 0}}) + "\nunchecked allowed a b\n");
  MotionText m;
  m.pieces = {""};
  EXPECT_TRUE(judge(self, m.write(self), sep({1, 0, 0})).verified);
  EXPECT_FALSE(judge(self, m.write(self), sep({1, 0, 0}) + contact(0, 1, 0, 0.5, in)).verified);
}

}  // namespace contact_test
}  // namespace verify::test
