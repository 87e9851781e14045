// SPDX-License-Identifier: BSD-3-Clause
//
// Queries that were once answered wrongly, each a file of test/replay/errata: today's answers are right. (How each was
// found, and what else guards it: doc/ERRATA.md.)
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include <gtest/gtest.h>

#include "fcl_artic/query_text.h"

namespace errata_test {

using namespace fcl_artic;

/// The right answer. Times of contact are those of the first one: from the closed forms of the tests that ERRATA names,
/// or, of the spikes and the floor, from the same query with a tolerance of 1e-11.
struct Right {
  Status status;
  double first = -1;         ///< time of the first contact; -1: there is none
  std::size_t contacts = 0;  ///< reported
  std::size_t ignored = 0, never_apart = 0, unproven_allowed = 0;
};
struct Case {
  const char* file;
  const char* entry;  ///< words of ERRATA's, as they stand there
  Right right;
};

const Case kCases[] = {
    {"lever_of_a_turn_before_a_slide",
     "A false `free` of two links with three joint variables between them",
     {Status::contact, 0, 1}},
    {"lever_of_a_third_variable",
     "The same where the third variable drives a turn and a slide",
     {Status::contact, 0, 1}},
    {"any_ignores_the_initial_contact",
     "Certain contact at t = 0 of the very pair to be ignored",
     {Status::free, -1, 0, 1}},
    {"any_with_a_contact_that_is_not_proven",
     "`t_lower` with `any` later than the first contact",
     {Status::contact, 0.5545, 1}},
    {"every_pair_with_one_contact",
     "`t_lower` of `firstOfEveryPair` later than the first contact",
     {Status::contact, 0.09763356141, 1}},
    {"every_pair_with_three_contacts", "`max_contacts` exceeded", {Status::contact, 0.32679491924, 3}},
    {"trajectory_whose_budget_ends",
     "Trajectories with `firstOfEveryPair` and a budget",
     {Status::undecided, 0.86771243445, 1}},
    {"neighbours_meet", "Neighbours were never checked, and no answer said so", {Status::contact, 0.46652458329, 1}},
    {"paper_boxes_before_equations", "The paper's method, `in_time_order = false`", {Status::contact, 0.69, 1}},
    {"paper_budget_of_every_pair", "The paper's method, `in_time_order = false`", {Status::undecided, 0.268, 0}},
    {"planar_joint_nearly_downwards",
     "A false `free` of a planar joint whose axis is nearly -z",
     {Status::contact, 0.99949001759, 1}},
    {"axis_of_subnormal_length", "False `free` of axes and rotations that were none", {Status::contact, 0, 1}},
    {"ignored_pair_that_never_parts", "`free: proven` of pairs that are never checked", {Status::free, -1, 0, 1, 1}},
    {"allowed_pair_with_a_margin",
     "An allowed pair nearer than its own margin was not counted",
     {Status::free, -1, 0, 0, 0, 2}},
    {"trajectory_of_today", "`t_upper - t_lower <= tolerance_time`", {Status::contact, 1700000807.8003822, 1}},
    {"any_ends_before_the_contact", "A `certain` contact after the motion's end", {Status::free}},
    {"near_miss", "Near misses with `tolerance_distance` of 1e-12", {Status::free}},
    {"solid_around_a_body", "A solid within a closed mesh is `free`", {Status::contact, 0, 1}},
};

std::string read(const std::filesystem::path& file) {
  std::stringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

TEST(Errata, ReplaysAreAnsweredRightly) {
  const std::filesystem::path folder = std::filesystem::path(FCL_ARTIC_SOURCE) / "test/replay/errata";
  for (const Case& one : kCases) {
    SCOPED_TRACE(one.file);
    const RecordedQuery query = readQuery(read(folder / (std::string(one.file) + ".json")));
    const CertifiedResult result = query.ask();
    const Right& right = one.right;
    EXPECT_EQ(result.status, right.status);
    EXPECT_EQ(result.contacts.size(), right.contacts);
    EXPECT_EQ(result.ignored_initial_contacts.size(), right.ignored);
    EXPECT_EQ(result.never_apart_pairs, right.never_apart);
    EXPECT_EQ(result.unproven_allowed_pairs, right.unproven_allowed);
    if (right.first < 0) continue;
    // The digits above; of times of today those of a double, 4 ulp of the times and 8 of a piece (trajectory.h).
    const double digits = right.first > 1e9 ? 8 * 0x1p-22 : 1e-8;
    EXPECT_LE(result.t_lower, right.first + digits);
    if (result.certain) EXPECT_GE(result.t_upper, right.first - digits);
    if (result.certain && query.request.mode == ContactMode::first) {
      EXPECT_GE(result.t_lower, right.first - query.request.tolerance_time - digits);
    }
  }
}

TEST(Errata, EachFileIsOfAnEntryAndEachIsAsked) {
  const std::string errata = read(std::filesystem::path(FCL_ARTIC_SOURCE) / "doc/ERRATA.md");
  std::set<std::string> asked;
  for (const Case& one : kCases) {
    EXPECT_NE(errata.find("**" + std::string(one.entry)), std::string::npos) << one.entry;
    asked.insert(std::string(one.file) + ".json");
  }
  std::set<std::string> there;
  for (const auto& file :
       std::filesystem::directory_iterator(std::filesystem::path(FCL_ARTIC_SOURCE) / "test/replay/errata")) {
    there.insert(file.path().filename().string());
    EXPECT_LE(std::filesystem::file_size(file), 10000u) << file.path();
  }
  EXPECT_EQ(there, asked);
}

}  // namespace errata_test
