// SPDX-License-Identifier: BSD-3-Clause
#include "query_options.h"

#include <string>

#include "usage.h"

namespace fcl_artic::app {
namespace {
constexpr const char* kQueryGroup = "Query";
}  // namespace

void addQueryOptions(CLI::App& verb, CertifiedRequest& request) {
  const auto number = [&](const std::string& name, double& value, const std::string& help) {
    verb.add_option(name, value, help)->check(requireNotNegative)->group(kQueryGroup)->capture_default_str();
  };
  number("--margin", request.margin, "Nearer than this counts as touching, in m");
  number("--tolerance-time", request.tolerance_time, "Wanted width of the bracket of the contact time");
  number("--tolerance-distance", request.tolerance_distance,
         "A gap below this, in m, may be taken for a contact that is not certain");
  verb.add_option("--budget", request.work_budget, "Tests after which the answer is 'undecided'; 0: no limit")
      ->group(kQueryGroup)
      ->capture_default_str();
  verb.add_flag("--ignore-initial-contact", request.ignore_initial_contact,
                "Pairs that touch at t = 0 may separate; they are watched from then on. So may pairs that are within "
                "their margin then")
      ->group(kQueryGroup);
  verb.add_flag_callback(
          "--no-self", [&request] { request.check_self = false; }, "Do not check links against links")
      ->group(kQueryGroup);
  verb.add_flag_callback(
          "--no-scene", [&request] { request.check_scene = false; }, "Do not check links against obstacles")
      ->group(kQueryGroup);
}

CLI::Option* addClearanceOptions(CLI::App& verb, bool& wanted, ClearanceRequest& request) {
  CLI::Option* clearance =
      verb.add_flag("--clearance", wanted, "Also the smallest distance over the whole motion, proven")
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

}  // namespace fcl_artic::app
