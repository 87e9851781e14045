// SPDX-License-Identifier: BSD-3-Clause
// Texts for people: about a world, a motion, a verdict. Nothing is proven here.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "proof.h"

namespace verify {

/// "1 link", "2 links". @param many  of a noun that does not end in s when there are several of it.
std::string counted(std::size_t n, const std::string& one, const std::string& many = {});

/// The statements of the world beside its numbers, one line each: whose bodies, which of them move with a link, which
/// pairs are not checked, margins.
std::vector<std::string> linesOf(const World& world);
/// Which paths and poses a claim covers beside those stated, as words before "none of 3 pairs": "for every path within
/// 0.3 deg of it, base 'foot' within 2 mm and 0.1 deg, ". Empty: no others.
std::string coveredBy(const World& world);
/// How long bodies have to move by themselves, as "in at most 2 s, "; empty: none does.
std::string timeTaken(const World& world, const Motion& motion);
/// The statements of the motion: what is checked, margin, start and goal, pairs that are ignored up to a time.
std::vector<std::string> linesOf(const World& world, const Motion& motion, const Verdict& verdict);
/// Whether a verified claim leaves something out that files do not: it ends early, or the motion itself leaves out a
/// pair, for some time or always.
bool isInPart(const Verdict& verdict);
/// Whom a claim is about, as the parts of a sentence; a file is named where it was compared with one.
struct Subject {
  std::string robot = "the robot of this world";
  std::string motion = "as this record says";
  std::string scene = "without obstacles";
  std::string pairs = "pairs of bodies";
  std::string meets = "touches";
  std::string covered;  // coveredBy()
};
/// "VERIFIED: the robot of 'arm.urdf' moves ..., and none of 3 pairs of bodies touches." or "NOT VERIFIED: ...".
std::string lineOf(const Verdict& verdict, const Subject& subject = {});
/// How many pairs are not checked, by reason: "1 neighbours, 2 allowed". Empty: none.
std::string notChecked(const Verdict& verdict);

/// "HEADING: ITEM, ITEM, ...", made safe to print, in lines of at most 120 columns, cut between items; all but the
/// first, which begins with `begin`, are indented.
std::string wrapped(const std::string& begin, std::string_view text);

/// Text that may hold names, made safe to print. Characters that do not print become \xNN, and "VERIFIED" does not
/// stand in it, so that no name looks like a verdict.
std::string shown(std::string_view text);

/// The same as JSON. Numbers that JSON has not, "nan" and infinite ones, are strings.
std::string quotedJson(std::string_view text);
std::string listAsJson(const std::vector<std::string>& lines);
std::string verdictAsJson(const Verdict& verdict);
/// The motion's text and the proof. @throws BadInput where it has no form at all.
std::string proofAsJson(const World& world, const Record& record);

}  // namespace verify
