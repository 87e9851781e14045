// SPDX-License-Identifier: BSD-3-Clause
//
// The one table of a request's options: the program's options, Python's keywords with their docstrings, and JSON are
// made from it. The names of enumerations' values in JSON are here too.
#pragma once

#include <string>

#include "fcl_artic/request.h"

namespace fcl_artic {

/// A value of an enumeration as text.
template <class E>
struct NamedValue {
  E value;
  const char* name;
};
inline constexpr NamedValue<ContactMode> kContactModes[] = {
    {ContactMode::first, "first"}, {ContactMode::any, "any"}, {ContactMode::firstOfEveryPair, "first_of_every_pair"}};
inline constexpr NamedValue<Method> kMethods[] = {{Method::standard, "standard"}, {Method::redon2004, "redon2004"}};
inline constexpr NamedValue<VisibilityMode> kVisibilityModes[] = {{VisibilityMode::off, "off"},
                                                                  {VisibilityMode::on, "on"}};
inline constexpr NamedValue<MotionEnclosure> kMotionEnclosures[] = {{MotionEnclosure::intervalChain, "interval_chain"},
                                                                    {MotionEnclosure::meanValue, "mean_value"},
                                                                    {MotionEnclosure::taylor, "taylor"}};
// All names of an enumeration, found by the type of the argument.
constexpr const auto& namesOf(ContactMode) {
  return kContactModes;
}
constexpr const auto& namesOf(Method) {
  return kMethods;
}
constexpr const auto& namesOf(VisibilityMode) {
  return kVisibilityModes;
}
constexpr const auto& namesOf(MotionEnclosure) {
  return kMotionEnclosures;
}
/// The name of one of these values.
template <class E>
const char* nameOf(E value) {
  for (const NamedValue<E>& known : namesOf(E())) {
    if (known.value == value) return known.name;
  }
  return "";
}

struct RequestOption {
  const char* name;  ///< in Python and in JSON
  /// The program's option; for a flag that is on by default, the one that switches it off; null: none.
  const char* program;
  const char* help;  ///< for a flag that is on by default, an imperative
};

/// Calls visit(option, member) for each, in the order in which they are listed.
template <class Visit>
void forEachRequestOption(const Visit& visit) {
  using C = CertifiedRequest;
  visit(RequestOption{"mode", nullptr, "Which contacts are looked for."}, &C::mode);
  visit(RequestOption{"max_contacts", nullptr,
                      "Contacts to report at most; 0: the verdict alone, which takes less time."},
        &C::max_contacts);
  visit(RequestOption{"tolerance_time", "--tolerance-time",
                      "Wanted width of the bracket of the contact time, in the motion's time."},
        &C::tolerance_time);
  visit(
      RequestOption{
          "tolerance_distance", "--tolerance-distance",
          "A gap below this, m, may count as touching where it can't be proven: contact that is not certain."},
      &C::tolerance_distance);
  visit(RequestOption{"margin", "--margin",
                      "Nearer than this counts as touching, m. Margins of a body's or pair's own replace it."},
        &C::margin);
  visit(RequestOption{"added_margin", nullptr, "Added to every margin, also to those of bodies and pairs, m."},
        &C::added_margin);
  visit(RequestOption{"check_scene", "--no-scene", "Check links against obstacles."}, &C::check_scene);
  visit(RequestOption{"check_self", "--no-self", "Check links against links."}, &C::check_self);
  visit(RequestOption{"ignore_initial_contact", "--ignore-initial-contact",
                      "Pairs that touch at the start, or are within their margin, may separate: they are checked from "
                      "then on. One that never separates is never checked, and the answer counts it. All of a body is "
                      "one: a link that touches one point of a cloud is not checked against the others."},
        &C::ignore_initial_contact);
  visit(RequestOption{"certificate", nullptr, "Whether a proof is asked for."}, &C::certificate);
  visit(RequestOption{"visibility", nullptr, "Whether stage 2, culling by visibility, takes part."}, &C::visibility);
  visit(RequestOption{"method", nullptr, "The library's own method, or the paper's."}, &C::method);
  visit(RequestOption{"redon", nullptr, "Options of the paper's method."}, &C::redon);
  visit(RequestOption{"work_budget", "--budget", "Tests after which the answer is undecided; 0: no limit."},
        &C::work_budget);
  visit(RequestOption{"measure_times", nullptr, "Whether the statistics have times."}, &C::measure_times);
}

}  // namespace fcl_artic
