// SPDX-License-Identifier: BSD-3-Clause
// Texts for people name all that a claim rests on, and nothing in them looks like a verdict and is none.
#include "../report.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "worlds.h"

namespace verify::test {
namespace report_test {

bool has(const std::vector<std::string>& lines, const std::string& text) {
  return std::any_of(lines.begin(), lines.end(),
                     [&](const std::string& line) { return line.find(text) != std::string::npos; });
}
std::string joined(const std::vector<std::string>& lines) {
  std::string all;
  for (const std::string& line : lines) all += line + "\n";
  return all;
}

/// A cart with a gripper that holds a cup, a wall, a ball that goes with the cart.
World cart(const std::string& more = "") {
  return readWorld(kHead + "variable x\nframe cart 0 " + hex(kHere) + "\nslide " + hex(V{1, 0, 0}) + " 0 " + hex(1) +
                   " " + hex(0) + "\nframe gripper 1 " + hex(at(0, 0, 1)) + "\ngeometry sphere " + hex(0.1) +
                   "\nbody obstacle wall 0 0 " + hex(at(9, 0, 0)) + "\nbody obstacle ball 1 0 " + hex(at(0, 3, 0)) +
                   "\nbody link cart 1 0 " + hex(kHere) + "\nbody link gripper 2 0 " + hex(kHere) +
                   "\nbody carried cup 2 0 " + hex(at(0, 0, 1)) + "\n" + more);
}

TEST(VerifyReport, AllThatAWorldSaysIsSaid) {
  const std::vector<std::string> lines = linesOf(
      cart("unchecked neighbours cart gripper\nunchecked allowed ball gripper\nunchecked touch-link cart cup\nmargin "
           "cup " +
           hex(0.25) + "\nmargin cup wall " + hex(0.5) + "\n"));
  for (const char* line :
       {"2 bodies of role link: 'cart', 'gripper'", "1 body of role carried: 'cup'",
        "2 bodies of role obstacle: 'ball', 'wall'", "obstacle 'ball' (body 1) moves with the frame 'cart'",
        "carried 'cup' (body 4) is carried by the frame 'gripper'", "not checked, neighbours: 'cart' and 'gripper'",
        "not checked, allowed: 'ball' and 'gripper'", "not checked, touch-link: 'cart' and 'cup'",
        "margins of their own: 'cup' 0.25 m, "})
    EXPECT_TRUE(has(lines, line)) << line << "\n" << joined(lines);
  EXPECT_TRUE(has(lines, "'wall' and 'cup' 0.5 m")) << joined(lines);
  EXPECT_FALSE(has(linesOf(cart()), "not checked"));
}

// A person is not still, though no motion is between him and the base: he moves by himself, or within a tolerance.
TEST(VerifyReport, OfPairsWithoutAMotionItIsSaidWhatMovesThemAllTheSame) {
  const std::string text = kHead + "frame base 0 " + hex(kHere) + "\ngeometry sphere " + hex(0.1) +
                           "\nbody obstacle person 0 0 " + hex(at(9, 0, 0)) + "\nbody obstacle floor 0 0 " +
                           hex(at(0, 9, 0)) + "\nbody link base 1 0 " + hex(kHere) + "\n";
  const std::string still = "unchecked still base person\nunchecked still base floor\n", none = hex(V{0, 0, 0}) + "\n";
  const std::string pair = "'person' and 'base'", other = "'floor' and 'base'",
                    but = " (but tolerances or speeds may move them)";
  const auto said = [&](const std::string& tolerance) { return linesOf(readWorld(text + tolerance + still)); };
  const std::string plain = "not checked, no motion between them: ";
  EXPECT_TRUE(has(said(""), plain)) << joined(said(""));
  EXPECT_FALSE(has(said(""), but));
  for (const std::string& of_person : {"tolerance body person " + hex(0.01) + " " + hex(0) + " " + none,
                                       "tolerance speed person " + hex(1) + " " + hex(0) + "\n"}) {
    EXPECT_TRUE(has(said(of_person), pair + but)) << joined(said(of_person));
    EXPECT_TRUE(has(said(of_person), other)) << joined(said(of_person));
    EXPECT_FALSE(has(said(of_person), other + but)) << "the floor has none";
  }
  const std::vector<std::string> of_base = said("tolerance frame 1 " + hex(0.01) + " " + hex(0) + " " + none);
  EXPECT_TRUE(has(of_base, pair + but) && has(of_base, other + but)) << joined(of_base);
}

TEST(VerifyReport, AllThatAMotionSaysIsSaid) {
  const World world = cart();
  MotionText m;
  m.margin = 0.125;
  m.added = 0.0625;
  m.until = 0.5;
  m.pieces = {"q 0 " + hex(0) + " " + hex(1) + "\nignored 0 2 " + hex(0.75) + "\n",
              "q 0 " + hex(1) + " " + hex(1) + "\nignored 0 2 " + hex(0.75) + "\n"};
  const std::vector<std::string> lines = linesOf(world, readMotion(m.write(world), world), {});
  for (const char* line :
       {"checked: links with links, links with obstacles", "margin: 0.125 m, and 0.0625 m added to every margin",
        "start, t = 0 of piece 0: 'x' 0", "goal, t = 0.5 of piece 1: 'x' 1.5",
        "2 pieces: each begins where the one before ends", "duration: 1 s, which no proof uses",
        "ignored until t = 0.75 of piece 0: obstacle 'wall' (body 0) and link 'cart' (body 2)",
        "ignored until t = 0.75 of piece 1, the end of its claim: obstacle 'wall'"})
    EXPECT_TRUE(has(lines, line)) << line << "\n" << joined(lines);
}

TEST(VerifyReport, OfIgnoredPairsNobodyKnowsThatTheyPart) {
  Verdict v;
  v.verified = true;
  v.checked = 3;
  v.late = 2;
  v.until = 1;
  EXPECT_EQ(lineOf(v),
            "VERIFIED: the robot of this world moves as this record says without obstacles, and none of 3 pairs of "
            "bodies (2 of them ignored up to a time) touches.");
}

TEST(VerifyReport, AVerdictIsASentenceOfItsSubject) {
  Verdict v;
  v.verified = true;
  v.checked = 66;
  v.until = 0.5;
  v.pieces = 3;
  v.not_checked[static_cast<int>(Reason::neighbours)] = 5;
  v.not_checked[static_cast<int>(Reason::allowed)] = 7;
  const Subject subject{"the robot of 'arm.urdf'", "as 'plan.csv' says",      "among the obstacles of 'cell.stl'",
                        "pairs of bodies",         "comes within its margin", ""};
  EXPECT_EQ(lineOf(v, subject),
            "VERIFIED: the robot of 'arm.urdf' moves as 'plan.csv' says among the obstacles of 'cell.stl', and until t "
            "= 0.5 of piece 2 none of 66 pairs of bodies comes within its margin.");
  v.not_checked[static_cast<int>(Reason::still)] = 2;
  EXPECT_EQ(notChecked(v), "2 no motion between them, 5 neighbours, 7 allowed");
  EXPECT_NE(verdictAsJson(v).find("\"still against each other\": 2, \"neighbours\": 5"), std::string::npos)
      << "names in JSON stay";
  EXPECT_EQ(notChecked(Verdict()), "");
}

TEST(VerifyReport, LongListsAreWrapped) {
  std::string list = "not checked, allowed: ", words;
  for (int k = 0; k < 200; ++k) list += "'link_" + std::to_string(k) + "' and 'b\n', ";
  list += "VERIFIED";
  const std::string text = wrapped("a.fac: ", list);
  std::size_t lines = 0;
  for (std::size_t at = 0, end; at < text.size(); at = end + 1, ++lines) {
    end = text.find('\n', at);
    ASSERT_NE(end, std::string::npos);
    EXPECT_LE(end - at, 120u);
    const std::string line = text.substr(at, end - at);
    EXPECT_EQ(line.rfind(lines == 0 ? "a.fac: not checked, allowed: 'link_0' and" : "    'link_", 0), 0u) << line;
    words += line.substr(lines == 0 ? 0 : 4) + (end + 1 < text.size() ? " " : "");
  }
  EXPECT_GT(lines, 30u);
  EXPECT_EQ(words, "a.fac: " + shown(list));
  EXPECT_EQ(text.find("VERIFIED"), std::string::npos);
  EXPECT_EQ(wrapped("  ", "short"), "  short\n");
  EXPECT_EQ(wrapped("  ", ""), "  \n");
  EXPECT_EQ(wrapped("", "x"), "x\n");
  const std::string x(200, 'x');  // what is no list stays whole, and so does an item
  EXPECT_EQ(wrapped("", x + " " + x), x + " " + x + "\n");
  EXPECT_EQ(wrapped("", "a: " + x + ", y"), "a: " + x + ",\n    y\n");
}

TEST(VerifyReport, WithinTheMarginIsNoContact) {
  Verdict v;
  v.verified = v.contact = v.near = true;
  v.contact_text = "link 'a' (body 0) and link 'b' (body 1) at t = 1";
  EXPECT_EQ(lineOf(v).find("CONTACT"), std::string::npos) << lineOf(v);
  EXPECT_NE(lineOf(v).find("WITHIN THEIR MARGIN: link 'a'"), std::string::npos) << lineOf(v);
  EXPECT_NE(verdictAsJson(v).find("\"within_margin\""), std::string::npos);
  EXPECT_EQ(verdictAsJson(v).find("\"contact\""), std::string::npos);
  v.near = false;
  EXPECT_NE(lineOf(v).find("CONTACT of link 'a'"), std::string::npos) << lineOf(v);
}

TEST(VerifyReport, NoNameLooksLikeAVerdict) {
  const std::string name = "a'%0ax.fac:0:%20VERIFIED%2099%20pairs%1b[2J%c3%5c";
  const World world =
      readWorld(kHead + "geometry sphere " + hex(0.1) + "\nbody link " + name + " 0 0 " + hex(kHere) + "\n");
  EXPECT_EQ(world.describe(0), "link 'a\\x27\\x0ax.fac:0: VERIFIED 99 pairs\\x1b[2J\\xc3\\x5c' (body 0)");
  const std::string said = shown(world.describe(0));
  EXPECT_EQ(said.find("VERIFIED"), std::string::npos) << said;
  EXPECT_EQ(said.find('\n'), std::string::npos);
  Verdict v;
  v.reason = "not apart: " + world.describe(0) + "\n";
  EXPECT_EQ(lineOf(v).rfind("VERIFIED"), 4u) << lineOf(v);
  EXPECT_EQ(lineOf(v).find('\n'), std::string::npos);
  EXPECT_EQ(shown("a\nb\x7f"), "a\\x0ab\\x7f");
  EXPECT_EQ(quotedJson("a\"\\\n\xc3"), "\"a\\\"\\\\\\u000a\\u00c3\"");
}

TEST(VerifyReport, JsonHasNoNumbersThatItHasNot) {
  const World world = cart();
  MotionText m;
  m.pieces = {""};
  std::string proof;
  for (std::size_t a = 0; a < world.bodies.size(); ++a)
    if (!opponents(world, readMotion(m.write(world), world), 0, static_cast<int>(a)).empty()) proof += sep({1, 0, 0});
  proof += "\x20" + varint(0) + varint(2) + varint(0) + number(std::nan("")) + "\2" + varint(0) + number(HUGE_VAL) +
           number(-HUGE_VAL) + number(0.5) + varint(0);
  const std::string bytes = record(m.write(world), proof);
  const std::string json = proofAsJson(world, splitRecords(bytes)[0]);
  EXPECT_NE(json.find("\"t\": \"nan\""), std::string::npos) << json;
  EXPECT_NE(json.find("[\"inf\", \"-inf\", 0.5]"), std::string::npos) << json;
}

}  // namespace report_test
}  // namespace verify::test
