// SPDX-License-Identifier: BSD-3-Clause
// Whose robot a proof is about: worlds that are not the file's to the last digit, and files that are not read in full.
#include <chrono>
#include <cmath>
#include <ctime>

#include "files.h"

namespace verify::test {
namespace urdf_test {

using VerifyUrdf = VerifyFiles;

const std::string kBall = "<collision><geometry><sphere radius='0.5'/></geometry></collision>";
std::string link(const std::string& name, const std::string& inside = kBall) {
  return "<link name='" + name + "'>" + inside + "</link>";
}
std::string joint(const std::string& name, const std::string& type, const std::string& parent, const std::string& child,
                  const std::string& inside = "") {
  return "<joint name='" + name + "' type='" + type + "'><parent link='" + parent + "'/><child link='" + child + "'/>" +
         inside + "</joint>";
}
std::string robot(const std::string& inside) {
  return "<robot name='r'>" + inside + "</robot>";
}
std::string frame(const std::string& name, int parent, const std::string& elements = "", const M& pose = {}) {
  return "frame " + name + " " + std::to_string(parent) + " " + hex(pose) + "\n" + elements;
}
std::string element(const std::string& kind, const V& axis, int variable, double m = 1, double c = 0) {
  return kind + " " + hex(axis) + " " + std::to_string(variable) + " " + hex(m) + " " + hex(c) + "\n";
}
std::string body(const std::string& role, const std::string& name, int frame, int geometry = 0) {
  return "body " + role + " " + name + " " + std::to_string(frame) + " " + std::to_string(geometry) + " " + hex(M{}) +
         "\n";
}
const std::string kSphere = "geometry sphere " + hex(0.5) + "\n";
const V kX{1, 0, 0}, kZ{0, 0, 1};

/// Links a and b, and a joint j of that axis.
std::string axisUrdf(const std::string& type, const std::string& axis) {
  return robot(link("a") + link("b") + joint("j", type, "a", "b", "<axis xyz='" + axis + "'/>"));
}
std::string axisWorld(const std::string& kind, const V& axis) {
  return kHead + "variable j\n" + frame("a", 0) + frame("b", 1, element(kind, axis, 0)) + kSphere +
         body("link", "a", 1) + body("link", "b", 2);
}

// The axis that the file means is one that the claim is about: exactly where it is a coordinate axis.
TEST_F(VerifyUrdf, AxesOfTheFileAreThoseOfTheClaim) {
  EXPECT_EQ(said(axisWorld("turn", kZ), axisUrdf("revolute", "0 0 3")), "same");
  EXPECT_EQ(said(axisWorld("turn", kZ), axisUrdf("revolute", "0 -0.0 1e-300")), "same");
  EXPECT_NE(said(axisWorld("turn", kZ), axisUrdf("revolute", "0 0 -1")), "same");
  EXPECT_NE(said(axisWorld("turn", kZ), axisUrdf("revolute", "0 1e-17 1")), "same");
  EXPECT_NE(said(axisWorld("slide", kZ), axisUrdf("prismatic", "0 5e-16 1")), "same");
  const double s = std::sqrt(0.5);
  EXPECT_EQ(said(axisWorld("slide", {0, s, s}), axisUrdf("prismatic", "0 1 1")), "same");
  EXPECT_EQ(said(axisWorld("slide", {0, s * (1 + 5e-16), s}), axisUrdf("prismatic", "0 1 1")), "same");
  EXPECT_NE(said(axisWorld("slide", {0, s * (1 + 3e-15), s}), axisUrdf("prismatic", "0 1 1")), "same");  // 2^-49.8
  Rng rng(41);
  int same = 0;
  for (int n = 0; n < 200; ++n) {
    const V meant{uniform(rng, -1, 1), uniform(rng, -1, 1), n % 5 ? uniform(rng, -1, 1) : 0};
    char text[100];
    std::snprintf(text, sizeof text, "%.17g %.17g %.17g", meant[0], meant[1], meant[2]);
    V stated = (1 / norm(meant)) * meant;
    const double size = std::ldexp(1, -47 - n % 8);
    for (double& x : stated) x += x == 0 ? 0 : uniform(rng, -size, size);
    const std::string world = axisWorld("turn", stated);
    if (said(world, axisUrdf("revolute", text)) != "same") continue;
    ++same;
    Fix unit[3];
    unitVector(meant.data(), unit);
    const World read = readWorld(world);
    for (std::size_t k = 0; k < 3; ++k) {
      const Tm& claimed = read.frames[2].elements[0].unit[k];
      EXPECT_LE(abs(unit[k] - claimed.c0).v + 2, claimed.r.v) << n;
    }
  }
  EXPECT_GT(same, 50);
  EXPECT_LT(same, 150);
}

// An axis that may be off by 2^-50 in each entry is off by 0.5 mm after 2^39 m, by 0.7 mm across. That is in the bound,
// beside the errors of the rotations of the frame and the wall.
TEST_F(VerifyUrdf, WhatAnAxisMayBeIsInTheProof) {
  const auto verdict = [](const V& axis, double gap) {
    // The wall lies along the axis, next to the ball's path.
    const V across{-axis[1], axis[0], 0};
    const World world =
        readWorld(kHead + "variable j\n" + frame("b", 0, element("slide", axis, 0)) + "geometry sphere " + hex(1) +
                  "\ngeometry halfspace " + hex(-1 * across) + " " + hex(-(1 + gap) * norm(axis)) + "\n" +
                  body("obstacle", "wall", 0, 1) + body("link", "b", 1));
    MotionText m;
    m.pieces = {"q 0 " + hex(0) + " " + hex(std::ldexp(1, 39)) + "\n"};
    return judge(world, m.write(world), "\x09").verified;
  };
  EXPECT_TRUE(verdict({1, 0, 0}, 0.0042));
  EXPECT_FALSE(verdict({3, 4, 0}, 0.0042));
  EXPECT_TRUE(verdict({3, 4, 0}, 0.005));
}

TEST_F(VerifyUrdf, ChainsOfMimics) {
  const auto mimic = [](const std::string& of, const std::string& more = "") {
    return "<axis xyz='0 0 1'/><mimic joint='" + of + "' " + more + "/>";
  };
  const std::string axis = "<axis xyz='0 0 1'/>";
  const std::string chain = robot(link("a") + link("b") + link("c") + link("d") +
                                  joint("j3", "revolute", "c", "d", mimic("j2", "multiplier='0.1' offset='0.7'")) +
                                  joint("j2", "revolute", "b", "c", mimic("j1", "multiplier='0.3' offset='0.2'")) +
                                  joint("j1", "continuous", "a", "b", axis));
  const auto world = [](const std::string& variables, const std::string& second, const std::string& third) {
    return kHead + variables + frame("a", 0) + frame("b", 1, element("turn", kZ, 0)) + frame("c", 2, second) +
           frame("d", 3, third) + kSphere + body("link", "a", 1) + body("link", "b", 2) + body("link", "c", 3) +
           body("link", "d", 4);
  };
  const std::string one = "variable j1\n", second = element("turn", kZ, 0, 0.3, 0.2);
  EXPECT_EQ(said(world(one, second, element("turn", kZ, 0, 0.1 * 0.3, 0.1 * 0.2 + 0.7)), chain), "same");
  EXPECT_NE(said(world(one, second, element("turn", kZ, 0, 0.1, 0.7)), chain), "same");
  EXPECT_NE(said(world(one, second, element("turn", kZ, 0, 0.03, 0.73)), chain), "same");
  EXPECT_NE(said(world(one, element("turn", kZ, 0, 0.3, 0.2000001), element("turn", kZ, 0, 0.1 * 0.3, 0.1 * 0.2 + 0.7)),
                 chain),
            "same");
  // A variable of the name that the file has, by which nothing else moves: once it was the same robot.
  EXPECT_NE(said(world(one + "variable j2\n", second, element("turn", kZ, 1, 0.1, 0.7)), chain), "same");
  // Mimics of nobody, of itself, of what has several variables.
  const auto single = [&](const std::string& of, const std::string& variable) {
    return said(kHead + "variable " + variable + "\n" + frame("a", 0) + frame("b", 1, element("turn", kZ, 0)) +
                    kSphere + body("link", "a", 1) + body("link", "b", 2),
                robot(link("a") + link("b") + joint("j1", "revolute", "a", "b", mimic(of))));
  };
  EXPECT_NE(single("nobody", "nobody").find("is not there"), std::string::npos) << single("nobody", "nobody");
  EXPECT_NE(single("j1", "j1").find("mimics itself"), std::string::npos) << single("j1", "j1");
  // A joint that mimics one that stands still.
  const auto still = [&](const std::string& offset, const std::string& elements) {
    return said(kHead + "variable j1\n" + frame("a", 0) + frame("b", 1) + frame("c", 2, elements) + kSphere +
                    body("link", "a", 1) + body("link", "b", 2) + body("link", "c", 3),
                robot(link("a") + link("b") + link("c") + joint("j1", "fixed", "a", "b") +
                      joint("j2", "revolute", "b", "c", mimic("j1", offset))));
  };
  EXPECT_EQ(still("multiplier='3'", ""), "same");
  EXPECT_NE(still("multiplier='3'", element("turn", kZ, 0, 3)), "same");
  EXPECT_NE(still("offset='1'", "").find("not compared"), std::string::npos) << still("offset='1'", "");
}

TEST_F(VerifyUrdf, NothingElseMovesAsTheRobotDoes) {
  const std::string urdf = axisUrdf("revolute", "0 0 1");
  const auto world = [](const std::string& variables, const std::string& base, const std::string& root,
                        const std::string& more) {
    return kHead + variables + frame("mount", 0, base) + frame("a", 1, root) + frame("b", 2, element("turn", kZ, 0)) +
           frame("free", 0, more) + kSphere + body("link", "a", 2) + body("link", "b", 3);
  };
  const std::string j = "variable j\n", two = j + "variable base/x\n";
  EXPECT_EQ(said(world(j, "", "", ""), urdf), "same");
  EXPECT_EQ(said(world(two, element("slide", kX, 1), "", ""), urdf), "same");
  EXPECT_EQ(said(world(two, "", element("slide", kX, 1), ""), urdf), "same");
  EXPECT_EQ(said(world(two, "", "", element("slide", kX, 1)), urdf), "same");
  EXPECT_NE(said(world(j, element("turn", kZ, 0, -1), "", ""), urdf), "same");
  EXPECT_NE(said(world(j, "", element("turn", kZ, 0, -1), ""), urdf), "same");
  EXPECT_NE(said(world(j, "", "", element("turn", kZ, 0)), urdf), "same");
  EXPECT_NE(said(world(j + "variable j\n", "", "", element("turn", kZ, 1)), urdf), "same");
  const std::string four = j + "variable p\nvariable q\nvariable r\n";
  EXPECT_EQ(said(world(four, "rotate 1\n", "", ""), urdf), "same");
  EXPECT_NE(said(world("variable j\nvariable p\nvariable q\n", "rotate 0\n", "", ""), urdf), "same");
}

// A root that must stand somewhere stands there: no element takes it elsewhere, but those of a floating base.
TEST_F(VerifyUrdf, ARootWithABaseStandsStill) {
  const std::string path = write("robot.urdf", axisUrdf("revolute", "0 0 1"));
  std::string variables = "variable j\nvariable p\n";
  for (const char* v : {"trans_x", "trans_y", "trans_z", "rot_x", "rot_y", "rot_z"})
    variables += std::string("variable floating_base/") + v + "\n";
  const auto said = [&](const std::string& above, const std::string& root, const std::vector<double>& base) {
    const Comparison c = compareWithUrdf(
        readWorld(kHead + variables + frame("mount", 0, above) + frame("a", 1, root) +
                  frame("b", 2, element("turn", kZ, 0)) + kSphere + body("link", "a", 2) + body("link", "b", 3)),
        path, {}, {}, base);
    return c.differences.empty() ? c.notes.at(0) : c.differences[0];
  };
  const std::vector<double> origin(6, 0);
  const std::string lifted = element("slide", kZ, 1, 0, 5), stands = "root link 'a' stands still in the world",
                    freely = element("slide", kX, 2) + element("slide", {0, 1, 0}, 3) + element("slide", kZ, 4);
  EXPECT_EQ(said("", "", origin), stands);
  for (const std::string& moved : {lifted, element("slide", kZ, 1), element("turn", kZ, 1)}) {
    EXPECT_NE(said(moved, "", origin).find("which neither the file nor --base says"), std::string::npos);
    EXPECT_NE(said("", moved, origin).find("which neither the file nor --base says"), std::string::npos);
  }
  EXPECT_EQ(said("", lifted, {}), "root link 'a' moves in the world, not at the world's origin, by 'p'");
  EXPECT_NE(said("", freely + "rotate 5\n", origin).find("moves in the world, by 'floating_base/"), std::string::npos);
  EXPECT_NE(said(freely + "rotate 5\n", "", origin).find("neither"), std::string::npos);
  EXPECT_NE(said("", freely, origin).find("neither"), std::string::npos);
  EXPECT_NE(said("", element("slide", kZ, 2) + element("slide", {0, 1, 0}, 3) + element("slide", kZ, 4) + "rotate 5\n",
                 origin)
                .find("another axis"),
            std::string::npos);
}

// They are those of a list of values without names.
TEST_F(VerifyUrdf, VariablesAreInTheFilesOrder) {
  const std::string urdf =
      robot(link("a") + link("b") + link("c") + link("d") + link("e") +
            joint("last", "revolute", "c", "d", "<axis xyz='0 0 1'/>") + joint("none", "fixed", "a", "b") +
            joint("flat", "planar", "b", "c", "<axis xyz='0 0 1'/>") +
            joint("same", "revolute", "d", "e", "<axis xyz='0 0 1'/><mimic joint='last'/>"));
  const std::string world = axisWorld("turn", kZ);  // another robot's
  EXPECT_EQ(compare(world, urdf).variables, (std::vector<std::string>{"last", "flat/x", "flat/y", "flat/theta"}));
  EXPECT_EQ(compare(world, replaced(urdf, "planar", "floating")).variables,
            (std::vector<std::string>{"last", "flat/trans_x", "flat/trans_y", "flat/trans_z", "flat/rot_x",
                                      "flat/rot_y", "flat/rot_z", "flat/rot_w"}));
}

TEST_F(VerifyUrdf, NoBodyIsLeftOver) {
  const std::string urdf = axisUrdf("revolute", "0 0 1"), good = axisWorld("turn", kZ);
  EXPECT_EQ(said(good + body("obstacle", "o", 0) + body("carried", "c", 2), urdf), "same");
  EXPECT_NE(said(good + body("link", "ghost", 0), urdf), "same");
  EXPECT_NE(said(good + body("link", "ghost", 2), urdf), "same");
  EXPECT_NE(said(good + body("link", "b", 2), urdf), "same");
  EXPECT_NE(said(good + frame("f", 0) + body("link", "b", 3), urdf), "same");
  EXPECT_NE(said(good + body("obstacle", "o", 2), urdf), "same");
  EXPECT_NE(said(good + frame("f", 2) + body("obstacle", "o", 3), urdf), "same");
  EXPECT_NE(said(good + body("carried", "c", 0), urdf), "same");
  EXPECT_NE(said(good + frame("f", 2) + body("carried", "c", 3), urdf), "same");
  EXPECT_NE(said(good + frame("b", 0), urdf), "same");
}

TEST_F(VerifyUrdf, PlanarJointsHaveTheirXAndY) {
  const auto world = [](const V& x, const V& y, const V& z) {
    return kHead + "variable j/x\nvariable j/y\nvariable j/theta\n" + frame("a", 0) +
           frame("b", 1, element("slide", x, 0) + element("slide", y, 1) + element("turn", z, 2)) + kSphere +
           body("link", "a", 1) + body("link", "b", 2);
  };
  const auto urdf = [](const std::string& axis) { return axisUrdf("planar", axis); };
  EXPECT_EQ(said(world(kX, {0, 1, 0}, kZ), urdf("0 0 1")), "same");
  EXPECT_EQ(said(world(kX, {0, -1, 0}, {0, 0, -1}), urdf("0 0 -1")), "same");
  EXPECT_EQ(said(world({0, 0, -1}, {0, 1, 0}, kX), urdf("1 0 0")), "same");
  EXPECT_NE(said(world({0, 1, 0}, {-1, 0, 0}, kZ), urdf("0 0 1")), "same");  // turned about the axis
  EXPECT_NE(said(world({0.6, 0.8, 0}, {-0.8, 0.6, 0}, kZ), urdf("0 0 1")), "same");
  EXPECT_NE(said(world(kX, {0, -1, 0}, kZ), urdf("0 0 1")), "same");
  // As fcl_artic writes them.
  const V x{0x1.ebb3e119cd7a6p-1, -0x1.44c1ee632859cp-4, -0x1.11acee5602429p-2},
      y{-0x1.44c1ee632859dp-4, 0x1.aecf846735e99p-1, -0x1.11acee560242ap-1},
      z{0x1.11acee560242ap-2, 0x1.11acee560242ap-1, 0x1.9a8365810364p-1};
  EXPECT_EQ(said(world(x, y, z), urdf("1 2 3")), "same");
  EXPECT_NE(said(world(y, -1 * x, z), urdf("1 2 3")), "same");
}

/// A world of one link with a mesh, and its URDF.
class VerifyMeshes : public VerifyFiles {
 protected:
  std::string saidOf(const std::string& mesh, const std::string& file, const std::string& content,
                     const std::string& scale = "1 1 1") {
    write(file, content);
    return said(kHead + frame("a", 0) + mesh + body("link", "a", 1),
                robot(link("a", "<collision><geometry><mesh filename='" + file + "' scale='" + scale +
                                    "'/></geometry></collision>")));
  }
};

std::string obj(const std::vector<V>& vertices, const std::string& faces) {
  std::string s;
  char text[100];
  for (const V& v : vertices) {
    std::snprintf(text, sizeof text, "v %.17g %.17g %.17g\n", v[0], v[1], v[2]);
    s += text;
  }
  return s + faces;
}

TEST_F(VerifyMeshes, TrianglesCountWithOrientationAndMultiplicity) {
  const std::vector<V> two{{0, 0, 0},       {4, 0, 0},     {0, 4, 0},     {0, 0, 4},
                           {0.5, 0.5, 0.5}, {1, 0.5, 0.5}, {0.5, 1, 0.5}, {0.5, 0.5, 1}};
  const std::string file = obj(two, "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\nf 5 7 6\nf 5 6 8\nf 5 8 7\nf 6 7 8\n");
  using T = std::vector<std::array<int, 3>>;
  const T outer{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}, inner{{4, 6, 5}, {4, 5, 7}, {4, 7, 6}, {5, 6, 7}};
  const auto with = [&](const T& more, bool turned = false) {
    T all = outer;
    for (const auto& t : more)
      all.push_back(turned ? std::array<int, 3>{t[0], t[2], t[1]} : std::array<int, 3>{t[1], t[2], t[0]});
    return all;
  };
  for (const bool solid : {false, true}) {
    EXPECT_EQ(saidOf(meshText(two, with(inner), solid), "m.obj", file), "same");
    // The shell within turned round: a cavity.
    EXPECT_NE(saidOf(meshText(two, with(inner, true), solid), "m.obj", file), "same");
    EXPECT_NE(saidOf(meshText(two, outer, solid), "m.obj", file), "same");
    T twice = with(inner);
    twice.insert(twice.end(), outer.begin(), outer.end());
    EXPECT_NE(saidOf(meshText(two, twice, solid), "m.obj", file), "same");
  }
  EXPECT_NE(saidOf(meshText(two, with(inner), false), "m.obj", file, "1 1 1.0000000000000002"), "same");
}

// Where a line goes on, it is one: what readers may take for a vertex or a face by itself is refused.
TEST_F(VerifyMeshes, FacesDoNotHideInNames) {
  using T = std::vector<std::array<int, 3>>;
  const std::vector<V> four{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const std::string mesh = meshText({four[0], four[1], four[2]}, T{{0, 1, 2}}, false);
  const std::vector<V> three(four.begin(), four.begin() + 3);
  EXPECT_EQ(saidOf(mesh, "t.obj", obj(three, "f 1 \\\n 2 3\no name \\\n of two lines\n")), "same");
  for (const char* hidden : {"o name \\\nf 1 3 2\n", "o name\\\n\tf 1 3 2\n", "o a \\\n b \\\nv 0 0 1\n"})
    EXPECT_NE(saidOf(mesh, "t.obj", obj(three, std::string("f 1 2 3\n") + hidden)).find("may be one by itself"),
              std::string::npos)
        << hidden;
}

TEST_F(VerifyMeshes, FacesOfManyCorners) {
  // A dart: the fan from corner 1 is not how it is cut.
  const std::vector<V> dart{{2, 0, 0}, {0, 1, 0}, {-2, -2, 0}, {0, 3, 0}};
  const std::string four = obj(dart, "f 1 2 3 4\n");
  EXPECT_EQ(saidOf(meshText(dart, {{3, 0, 1}, {1, 2, 3}}, false), "d.obj", four), "same");
  EXPECT_EQ(saidOf(meshText(dart, {{0, 1, 2}, {0, 2, 3}}, false), "d.obj", four), "same");
  EXPECT_NE(saidOf(meshText(dart, {{3, 1, 0}, {1, 2, 3}}, false), "d.obj", four), "same");
  EXPECT_NE(saidOf(meshText(dart, {{3, 0, 1}}, false), "d.obj", four), "same");
  EXPECT_NE(saidOf(meshText(dart, {{3, 0, 1}, {1, 2, 3}, {0, 1, 2}}, false), "d.obj", four), "same");
  EXPECT_NE(saidOf(meshText(dart, {{3, 0, 1}, {0, 1, 2}}, false), "d.obj", four), "same");
  EXPECT_NE(saidOf(meshText(dart, {{3, 0, 1}, {1, 2, 3}, {1, 2, 3}}, false), "d.obj", four), "same");
  // Collinear corners, and what has no area left out: what is left out lies on an edge of the others.
  const std::vector<V> square{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}};
  const std::string five = obj(square, "f 1 2 3 4 5\n");
  EXPECT_EQ(saidOf(meshText(square, {{0, 2, 3}, {0, 3, 4}, {0, 1, 2}}, false), "s.obj", five), "same");
  const std::vector<V> rest{square[0], square[2], square[3], square[4]};
  EXPECT_EQ(saidOf(meshText(rest, {{0, 1, 2}, {0, 2, 3}}, false), "s.obj", five), "same");
  // In a fan along an edge of many corners, each triangle lies on the edge of the next one.
  std::vector<V> comb;
  std::string face = "f";
  for (int k = 0; k < 12; ++k) comb.push_back({0.1 * k, 0, 0}), face += " " + std::to_string(k + 1);
  comb.push_back({0, 1, 0});
  EXPECT_EQ(saidOf(meshText({comb[0], comb[11], comb[12]}, {{0, 1, 2}}, false), "c.obj", obj(comb, face + " 13\n")),
            "same");
  EXPECT_NE(saidOf(meshText(rest, {{0, 1, 2}}, false), "s.obj", five), "same");
}

TEST_F(VerifyMeshes, WhatHasNoAreaIsNotLost) {
  const std::vector<V> v{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 9}, {0.5, 0, 0}, {0, 0, 4.5}};
  const std::string mesh = meshText({v[0], v[1], v[2]}, {{0, 1, 2}}, false);
  EXPECT_EQ(saidOf(mesh, "f.obj", obj(v, "f 1 2 3\nf 1 2 2\n")), "same");
  EXPECT_EQ(saidOf(mesh, "f.obj", obj(v, "f 1 2 3\nf 3 3 3\n")), "same");
  EXPECT_EQ(saidOf(mesh, "f.obj", obj(v, "f 1 2 3\nf 1 5 2\n")), "same");
  // A needle, 9 m long.
  EXPECT_NE(saidOf(mesh, "f.obj", obj(v, "f 1 2 3\nf 1 4 4\n")), "same");
  EXPECT_NE(saidOf(mesh, "f.obj", obj(v, "f 1 2 3\nf 1 6 4\n")), "same");
  EXPECT_NE(saidOf(mesh, "f.obj", obj(v, "f 1 2 3\nf 4 4 4\n")), "same");
  // A sliver of 2^-41 of its length: it has an area.
  const std::vector<V> sliver{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.5, 0, std::ldexp(1, -41)}};
  EXPECT_NE(saidOf(mesh, "f.obj", obj(sliver, "f 1 2 3\nf 1 4 2\n")), "same");
}

// Two comparisons that take little time: 100 collision geometries of one mesh in the reverse order of the world's
// bodies, and 3,000 joints that mimic each other in a chain. A comparison that would be too much work is refused.
TEST_F(VerifyMeshes, ComparingTakesNoTime) {
  std::vector<V> v;
  std::vector<std::array<int, 3>> t;
  std::string faces;
  Rng rng(43);
  for (int k = 0; k < 6000; ++k) {
    v.push_back({uniform(rng, -1, 1), uniform(rng, -1, 1), uniform(rng, -1, 1)});
    if (k % 3 == 2)
      t.push_back({k - 2, k - 1, k}),
          faces += "f " + std::to_string(k - 1) + " " + std::to_string(k) + " " + std::to_string(k + 1) + "\n";
  }
  write("m.obj", obj(v, faces));
  std::string world = kHead + frame("a", 0) + meshText(v, t, false), urdf;
  const int n = 100;
  for (int k = 0; k < n; ++k) world += body("link", "a", 1);
  for (int k = 0; k < n; ++k) urdf += "<collision><geometry><mesh filename='m.obj'/></geometry></collision>";
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EQ(said(world, robot(link("a", urdf))), "same");
  std::string other = urdf;  // the last in the file is none of them: all are looked at
  other = "<collision><geometry><mesh filename='m.obj' scale='2 2 2'/></geometry></collision>" +
          other.substr(other.find("</collision>") + 12);
  EXPECT_NE(said(world, robot(link("a", other))), "same");
  std::string chain = link("l0", ""), frames = kHead + "variable j1\n" + frame("l0", 0);
  const int joints = 3000;
  for (int k = 1; k <= joints; ++k) {
    const std::string name = std::to_string(k);
    chain += link("l" + name, "") +
             joint("j" + name, "revolute", "l0", "l" + name,
                   "<axis xyz='0 0 1'/>" + (k > 1 ? "<mimic joint='j" + std::to_string(k - 1) + "'/>" : ""));
    frames += frame("l" + name, 1, element("turn", kZ, 0));
  }
  EXPECT_EQ(said(frames, robot(chain)), "same");
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(), 8);  // 0.3 s
  // Each of 2,000 scales asks for the mesh to be put in order anew: 12 million corners.
  std::string scales;
  for (int k = 0; k < 2000; ++k)
    scales += "<collision><geometry><mesh filename='m.obj' scale='1 1 1." + std::to_string(10000 + k) +
              "'/></geometry></collision>";
  for (int k = n; k < 2000; ++k) world += body("link", "a", 1);
  EXPECT_NE(said(world, robot(link("a", scales))).find("too much work"), std::string::npos);
}

// Each link's way to the root is gone once. (With the square of the links, 10,000 take 10 s.)
TEST_F(VerifyUrdf, LongChainsAreReadAtOnce) {
  std::string chain = link("l0", "");
  for (int k = 1; k <= 10000; ++k) {
    const std::string name = std::to_string(k);
    chain += link("l" + name, "") + joint("j" + name, "fixed", "l" + std::to_string(k - 1), "l" + name);
  }
  const std::clock_t begin = std::clock();
  EXPECT_NE(said(kHead + frame("l0", 0), robot(chain)).find("has no frame"), std::string::npos);
  EXPECT_LT(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC, 3);
}

TEST_F(VerifyMeshes, NumbersAreReadInFull) {
  const std::string spaces(150, ' ');
  const auto stl = [&](const std::string& last) {
    return "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 " + last +
           "\nendloop\nendfacet\nendsolid\n";
  };
  const auto mesh = [](double z) { return meshText({{0, 0, 0}, {1, 0, 0}, {0, 1, z}}, {{0, 1, 2}}, false); };
  // Once lines were cut at 120 characters: 35 became 3.
  const std::string cut(111, ' ');
  for (std::size_t n = 100; n < 120; ++n) {
    EXPECT_EQ(saidOf(mesh(35), "l.stl", stl(std::string(n, ' ') + "35")), "same") << n;
    EXPECT_NE(saidOf(mesh(3), "l.stl", stl(std::string(n, ' ') + "35")), "same") << n;
  }
  for (const char* last : {"3,5", "3x", "0x3", "3 5 ;", "3.e", "inf", "--3"})
    EXPECT_NE(saidOf(mesh(3), "l.stl", stl(last)), "same") << last;
  EXPECT_EQ(saidOf(mesh(0.1), "l.stl", stl("0.1")), "same");
  EXPECT_NE(saidOf(mesh(0.1f), "l.stl", stl("0.1")), "same");
}

TEST_F(VerifyUrdf, NumbersOfTheFileAreReadInFull) {
  const std::string world = kHead + frame("a", 0) + kSphere + "body link a 1 0 " + hex([] {
                              M m;
                              m.t = {1, 0, 0};
                              return m;
                            }()) +
                            "\n";
  const auto at = [&](const std::string& xyz) {
    return said(world, robot(link("a", "<collision><origin xyz='" + xyz +
                                           "'/><geometry><sphere radius='0.5'/></geometry></collision>")));
  };
  EXPECT_EQ(at("1 0 0"), "same");
  EXPECT_EQ(at(" +1.0e0\n0 \t 0 "), "same");
  for (const char* xyz :
       {"1,5 0 0", "1 0 0,5", "1&zero; 0 0", "1 0 0 0", "1 0", "0x1 0 0", "1 0 nan", "1 0 0 x", "1;0 0 0", "1.0f 0 0"})
    EXPECT_NE(at(xyz), "same") << xyz;
  const std::string type = "<!DOCTYPE robot [<!ENTITY zero '0'>]>";
  EXPECT_NE(
      said(world,
           type + robot(link(
                      "a", "<collision><origin xyz='1 0 0'/><geometry><sphere radius='0.5'/></geometry></collision>"))),
      "same");
}

// By a whitelist: what is not known is refused by its name.
TEST_F(VerifyUrdf, WhatIsNotKnownIsRefused) {
  const std::string urdf =
      robot("<material name='red'/><gazebo reference='a'><anything/></gazebo><sensor name='s'/>" +
            link("a",
                 "<visual><geometry><mesh filename='x.dae'/></geometry></visual><inertial/><collision name='c'><origin "
                 "xyz='0 0 0' rpy='0 0 0'/><geometry><sphere radius='0.5'/></geometry></collision>") +
            link("b") +
            joint("j", "revolute", "a", "b",
                  "<origin/><axis xyz='0 0 1'/><limit lower='0' upper='1'/><dynamics "
                  "damping='1'/><safety_controller/><calibration/>"));
  const std::string world = axisWorld("turn", kZ);
  EXPECT_EQ(said(world, urdf), "same");
  for (const auto& [what, by, words] : std::vector<std::array<std::string, 3>>{
           {"rpy='0 0 0'", "quat_xyzw='0 0 1 0'", "quat_xyzw"},
           {"<origin/>", "<origin quat_xyzw='0 0 1 0'/>", "quat_xyzw"},
           {"<origin/>", "<origin XYZ='0 0 1'/>", "XYZ"},
           {"<origin/>", "<Origin xyz='0 0 1'/>", "Origin"},
           {"<origin/>", "<origin/><origin xyz='0 0 1'/>", "two elements <origin>"},
           {"<origin/>", "<pose>0 0 1 0 0 0</pose>", "pose"},
           {"<origin/>", "<origin>0 0 1</origin>", "text"},
           {"<axis xyz='0 0 1'/>", "<axis xyz='0 0 1'/><axis2 xyz='1 0 0'/>", "axis2"},
           {"<axis xyz='0 0 1'/>", "<axis xyz='0 0 1'/><axis xyz='0 0 1'/>", "two elements <axis>"},
           {"<axis xyz='0 0 1'/>", "<axis xyz='0 0 1' xyz='1 0 0'/>", ""},
           {"<axis xyz='0 0 1'/>", "<axis xyz='0 0 1' frame='world'/>", "frame"},
           {"<axis xyz='0 0 1'/>", "<axis/>", "missing"},
           {"<axis xyz='0 0 1'/>", "<axis xyz='0 0 0'/>", "zero"},
           {"type='revolute'", "type='screw'", "type 'screw'"},
           {"type='revolute'", "type='revolute' pitch='1'", "pitch"},
           {"radius='0.5'", "radius='0.5' scale='2'", "scale"},
           {"<sphere radius='0.5'/>", "<sphere radius='0.5'/><box size='9 9 9'/>", "one shape"},
           {"<sphere radius='0.5'/>", "<ellipsoid radius='0.5'/>", "ellipsoid"},
           {"<geometry><sphere radius='0.5'/></geometry>",
            "<geometry><sphere radius='0.5'/></geometry><geometry><box size='9 9 9'/></geometry>",
            "two elements <geometry>"},
           {"<geometry><sphere radius='0.5'/></geometry>", "", "no <geometry>"},
           {"<inertial/>", "<inertial/><collision_model/>", "collision_model"},
           {"<link name='b'>", "<link name='b' pose='1'>", "pose"},
           {"<link name='b'>", "<link name='a'>", "twice"},
           {"<parent link='a'/>", "<parent link='c'/>", "not there"},
           {"<material name='red'/>", "<loop_joint name='l'/>", "loop_joint"},
           {"<material name='red'/>", "<link name='c'/>", "2 root links"},
           {"<material name='red'/>", "<include file='other.urdf'/>", "include"},
           {"<robot name='r'>", "<robot name='r' scale='2'>", "scale"}}) {
    const std::string answer = said(world, replaced(urdf, what, by));
    EXPECT_NE(answer, "same") << by;
    EXPECT_NE(answer.find(words), std::string::npos) << by << ": " << answer;
  }
  EXPECT_NE(said(world, urdf + "<robot name='other'/>"), "same");
  EXPECT_NE(said(world, urdf + "text"), "same");
  // Numbers that are no character: what follows one in an attribute would not be seen.
  for (const char* number : {"&#0;", "&#x0;", "&#0000;", "&#x100000000;", "&#x110000;"})
    EXPECT_NE(
        said(world, replaced(urdf, "rpy='0 0 0'", std::string("rpy='0 0 0") + number + "5'")).find("no character"),
        std::string::npos)
        << number;
  EXPECT_EQ(said(world, replaced(urdf, "rpy='0 0 0'", "rpy='&#48; &#x30; 0'")), "same");
  EXPECT_NE(said(world, urdf + std::string(1, '\0') + "<robot name='other'/>"), "same");
  EXPECT_EQ(said(world, "<?xml version='1.0'?><!-- for people -->\n" + urdf + "\n"), "same");
}

TEST_F(VerifyUrdf, AnSrdfIsReadByAWhitelist) {
  const World world = readWorld(axisWorld("turn", kZ) + "unchecked allowed a b\n");
  const auto answer = [&](const std::string& inside) -> std::string {
    try {
      const Comparison c = compareWithSrdf(world, write("r.srdf", robot(inside)));
      return c.differences.empty() ? "same" : c.differences[0];
    } catch (const BadInput& error) {
      return error.what();
    }
  };
  EXPECT_EQ(answer("<group name='g'><link name='a'/></group><disable_collisions link1='a' link2='b' reason='Never'/>"),
            "same");
  EXPECT_NE(answer("<disable_collisions link1='a' link2='b' until='1'/>").find("until"), std::string::npos);
  EXPECT_NE(answer("<disable_collisions link1='a' link2='b'/><check_collisions link1='a' link2='b'/>")
                .find("check_collisions"),
            std::string::npos);
  EXPECT_NE(answer("<disable_collisions link1='a' link2='b' link1='c'/>"), "same");
  EXPECT_NE(answer("<disable_collisions link1='a'/>").find("missing"), std::string::npos);
  const std::string pair = "<disable_collisions link1='a' link2='b' reason='Never'/>";
  EXPECT_EQ(answer("text <virtual_joint name='v' type='fixed'/><gripper/>" + pair), "same");
  EXPECT_EQ(answer("<disable_default_collisions link='a' reason='Default'/>"), "same");
  EXPECT_NE(
      answer("<disable_default_collisions link='a'/><enable_collisions link1='a' link2='B'/>").find("has no such link"),
      std::string::npos);
  for (const char* other : {"<enable_colisions link1='a' link2='b'/>", "<disable_colisions link1='a' link2='b'/>",
                            "<Enable link1='a' link2='b'/>", "<collision_margins/>", "<xacro:if value='1'/>"}) {
    EXPECT_NE(answer(pair + other).find("not known in <robot>"), std::string::npos) << other;
  }
  EXPECT_NE(answer("<disable_collisions link1='a' link2='b'><enable/></disable_collisions>").find("<enable>"),
            std::string::npos);
  EXPECT_NE(answer("<disable_default_collisions link='a' except='b'/>").find("except"), std::string::npos);
}

}  // namespace urdf_test
}  // namespace verify::test
