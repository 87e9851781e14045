// SPDX-License-Identifier: BSD-3-Clause
#include "query_options.h"

#include <cstdint>
#include <string>

#include "query/request_options.h"
#include "usage.h"

namespace fcl_artic::app {
namespace {
constexpr const char* kQueryGroup = "Query";

/// Without its full stop, as the program's other options have it.
std::string helpOf(const RequestOption& o) {
  const std::string help = o.help;
  return help.substr(0, help.size() - 1);
}

void add(CLI::App& verb, const RequestOption& o, double& value) {
  verb.add_option(o.program, value, helpOf(o))->check(requireNotNegative)->group(kQueryGroup)->capture_default_str();
}
void add(CLI::App& verb, const RequestOption& o, std::uint64_t& value) {
  verb.add_option(o.program, value, helpOf(o))->group(kQueryGroup)->capture_default_str();
}
void add(CLI::App& verb, const RequestOption& o, bool& value) {
  std::string help = helpOf(o);
  if (value) help = "Do not c" + help.substr(1);  // "Check ..."
  verb.add_flag_callback(
          o.program, [&value, given = !value] { value = given; }, help)
      ->group(kQueryGroup);
}
template <class Other>
void add(CLI::App&, const RequestOption&, Other&) {}  // no option of the program is of such a type

}  // namespace

void addQueryOptions(CLI::App& verb, CertifiedRequest& request) {
  forEachRequestOption([&](const RequestOption& option, auto member) {
    if (option.program) add(verb, option, request.*member);
  });
}

CLI::Option* addClearanceOptions(CLI::App& verb, bool& wanted, ClearanceRequest& request) {
  CLI::Option* clearance = verb.add_flag("--clearance", wanted,
                                         "Also the smallest distance over the whole motion, proven; with tolerances, "
                                         "how many times these are free")
                               ->group(kQueryGroup);
  verb.add_option("--clearance-most", request.most, "Distances beyond this are of no interest, in m")
      ->check(requirePositive)
      ->needs(clearance)
      ->group(kQueryGroup)
      ->capture_default_str();
  return clearance;
}

ClearanceRequest clearanceOf(const ClearanceRequest& request, const CertifiedRequest& query) {
  ClearanceRequest out = request;
  static_cast<Scope&>(out) = query;
  out.work_budget = query.work_budget;
  out.ignore_initial_contact = query.ignore_initial_contact;
  out.ignored_margin = query.margin;
  return out;
}

ToleranceLeftRequest toleranceLeftOf(const CertifiedRequest& query) {
  ToleranceLeftRequest out;
  static_cast<Tolerances&>(out) = query;
  static_cast<Scope&>(out) = query;
  out.work_budget = query.work_budget;
  out.ignore_initial_contact = query.ignore_initial_contact;
  return out;
}

}  // namespace fcl_artic::app
