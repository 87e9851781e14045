// SPDX-License-Identifier: BSD-3-Clause
//
// What must hold among all answers to one motion, whatever mode, method, margins, budget and limits they were asked
// with.
//
//   bracket    0 <= t_lower <= t_upper within the motion; free: at its end; a certain `first` is no wider than the
//              tolerance of time; a contact's own bracket lies in its motion and begins no earlier than the answer's
//   most       no more contacts than max_contacts, none where none is asked for, at least one in contact
//   order      one contact of each pair, in the order of their t_lower; of a certain answer the one proven first leads
//   budget     undecided only with a budget
//   ordered    Question Q asks for all that question P asks for (more pairs, no smaller margins, nothing left out):
//   what
//              Q proves free until t_lower, no answer to P proves in contact before; Q = P: all modes, methods, budgets
//   pairs      a pair with a proven contact is among those of every answer to the same question for every pair
//   ignored    all answers to one question leave the same pairs out
//   cut        t_lower and the verdict do not depend on max_contacts
//   sampled    FCL's static test at random poses before the latest t_lower finds no contact (of geometry a little
//   smaller) proven     FCL's distance at a proven contact's t_upper is no more than the margin (and a little)
//
// Each rule counts the cases in which it was telling: in which an answer that is wrong could have been seen.
#pragma once

#include <string>
#include <vector>

#include "harness.h"
#include "world.h"

namespace modes {

/// What is asked for. Whoever asks more of everything must find contact no later.
struct Question {
  bool check_scene = true, check_self = true, ignore_initial = false;
  double margin = 0;
  /// Whether all that `other` asks for is asked for too. (With a larger margin more is in contact at the start and left
  /// out.)
  bool covers(const Question& other) const {
    return check_scene >= other.check_scene && check_self >= other.check_self &&
           (ignore_initial ? other.ignore_initial && margin == other.margin : margin >= other.margin);
  }
  bool same(const Question& other) const { return covers(other) && other.covers(*this); }
};

struct Asked {
  Question question;
  fcl_artic::CertifiedRequest request;
  fcl_artic::CertifiedResult result;
};

/// Names of the rules. How often one was telling is counted as "<rule> told".
const std::vector<std::string>& rules();

std::string describe(const Asked& asked);

/// A random question's queries. The last max_contacts etc. are chosen at random.
std::vector<Asked> randomQueries(Random& random, int count);

/// Checks all rules among these answers. Of each rule the first fault is one of the case's.
void check(const World& world, const std::vector<Asked>& asked, Random& random, campaign::Case& c);

/// A case is a world and its queries; its seed is the campaign's plus its number.
campaign::Campaign campaignOfModes();

}  // namespace modes
