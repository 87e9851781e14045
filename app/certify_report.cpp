// SPDX-License-Identifier: BSD-3-Clause
#include "certify_report.h"

#include <algorithm>
#include <functional>
#include <sstream>

#include <fmt/format.h>

#include "exit_status.h"
#include "report/report.h"
#include "text/counted.h"
#include "text/one_line.h"

namespace fcl_artic::app {
namespace {

using Json = nlohmann::ordered_json;

/// Totals over the plans.
struct Sum {
  std::size_t free = 0, contact = 0, undecided = 0, wrong = 0;
  std::size_t mended = 0;     ///< of those in contact: free, as mended
  std::size_t left_line = 0;  ///< without contact; whether for certain or not
  double median_us = 0, slowest_us = 0;
};

Sum sumOf(const std::vector<CertifiedPlan>& plans) {
  Sum sum;
  std::vector<double> us;
  for (const CertifiedPlan& plan : plans) {
    if (!plan.error.empty()) {
      ++sum.wrong;
      continue;
    }
    us.push_back(plan.us);
    const int status = exitStatus(plan.result);  // of a motion without a pair to check nothing is known
    const bool left_line = status == kExitFree && plan.ownExitStatus() != kExitFree;
    ++(left_line                ? sum.left_line
       : status == kExitFree    ? sum.free
       : status == kExitContact ? sum.contact
                                : sum.undecided);
    sum.mended += plan.as_mended && plan.as_mended->exitStatus() == kExitFree;
  }
  if (us.empty()) return sum;
  std::sort(us.begin(), us.end());
  sum.median_us = us[us.size() / 2];
  sum.slowest_us = us.back();
  return sum;
}

/// "linear, 12 waypoints, t from 0 to 3.5".
std::string motionText(const CertifiedPlan& plan) {
  const plans::PlanMotion& m = *plan.motion;
  return fmt::format("{}, {} waypoints, t {} to {:g}{}", toString(m.interpolation), m.times.size(), m.times.front(),
                     m.times.back(), m.timed ? " s" : " (numbers of waypoints)");
}

std::string verdictText(const CertifiedPlan& plan) {
  if (!plan.error.empty()) return "error: " + plan.error;
  const CertifiedResult& result = plan.result;
  std::ostringstream out;
  out << result;
  if (const CertifiedContact* c = result.first()) {
    out << fmt::format(", after waypoint {}: '{}' and '{}' at {}, normal {}",
                       plan.motion->waypointBefore(result.t_lower), c->body1.name, c->body2.name,
                       placeText(c->point, 4), directionText(c->normal, 3));
  }
  if (plan.line) out << "; " << plan.line->text();
  if (plan.clearance) out << fmt::format("; clearance at least {:.6g} m", plan.clearance->lower);
  return out.str();
}

/// The meaning that the columns of plans without names have. It is the same for all of them, so it is said once. Empty
/// where all have names.
std::string columnsText(const CertifyReport& r) {
  std::size_t unnamed = 0;
  std::string names;
  for (const CertifiedPlan& plan : r.plans) {
    if (!plan.motion || plan.motion->named || plan.plan.joints_counted) continue;  // which its own note says
    if (unnamed++ > 0) continue;
    for (const std::string& name : plan.motion->joints) names += (names.empty() ? "" : ", ") + name;
  }
  if (unnamed == 0) return {};
  const std::string who = r.plans.size() == 1
                              ? "the plan names no joints: its"
                              : fmt::format("{} of {} plans name{} no joints: {}", unnamed, r.plans.size(),
                                            unnamed == 1 ? "s" : "", unnamed == 1 ? "its" : "their");
  return text::oneLine(fmt::format("note: {} columns are taken for {}", who, names)) + "\n";
}

std::string mendedText(const CertifiedPlan& plan) {
  if (!plan.not_mended.empty()) return "not mended: " + plan.not_mended;
  if (!plan.as_mended) return {};
  const Mended& m = *plan.mended;
  std::string text = fmt::format(
      "mended in {:.1f} ms, {} at {:g} m beyond the margin, {} waypoints, {:.4g} times as long, off by at "
      "most {:.4g} {} ('{}')",
      m.ms, text::counted(m.detours, "detour"), m.kept, m.plan.positions.size(), m.length_ratio, m.deviation,
      m.deviation_is_angle ? "rad" : "m", m.deviation_joint);
  if (plan.motion->timed) text += fmt::format(", {:.4g} s longer", m.added_time);
  text += fmt::format("; straight between waypoints: make its time law anew, for the controller; certified again: {}",
                      verdictText(*plan.as_mended));
  if (plan.as_mended->clearance && plan.as_mended->clearance->upper < m.kept) {
    text += "; nearer than the detours' clearance only where the plan as given is, or pairs that begin or end so";
  }
  return text;
}

std::string sumText(const CertifyReport& r) {
  const Sum sum = sumOf(r.plans);
  std::string text =
      fmt::format("{}: {} free, {} in contact, {} undecided, {} wrong", text::counted(r.plans.size(), "plan"), sum.free,
                  sum.contact, sum.undecided, sum.wrong);
  if (sum.left_line > 0)
    text += fmt::format(", {} without contact that leave, or may leave, the tool's line", sum.left_line);
  const bool mending = std::any_of(r.plans.begin(), r.plans.end(),
                                   [](const CertifiedPlan& p) { return p.as_mended || !p.not_mended.empty(); });
  if (mending) text += fmt::format("; {} of {} mended", sum.mended, sum.contact);
  return text + fmt::format("; median {:.1f} us, slowest {:.1f} us, {:.3g} s in all\n", sum.median_us, sum.slowest_us,
                            r.seconds);
}

Json planJson(const CertifyReport& r, const CertifiedPlan& plan) {
  Json out = {{"file", plan.file}, {"plan", plan.plan.name.empty() ? Json() : Json(plan.plan.name)}};
  if (!plan.error.empty()) {
    out.update({{"status", "error"}, {"error", plan.error}, {"notes", plan.notes}});
    return out;
  }
  const plans::PlanMotion& motion = *plan.motion;
  const Json all = jsonReport(reportOf(r, plan));
  for (const char* key :
       {"status", "t_lower", "t_upper", "certain", "nothing_checked", "t_begin", "t_end", "tolerances"}) {
    out[key] = all.at(key);
  }
  const bool free = plan.result.isFree();
  out["waypoint"] = free ? Json() : Json(motion.waypointBefore(plan.result.t_lower));
  out["interpolation"] = toString(motion.interpolation);
  out["waypoints"] = motion.times.size();
  out["joints"] = motion.joints;
  out["joints_named"] = motion.named;
  out["timed"] = motion.timed;
  out["contacts"] = all.at("contacts");
  if (!free) out["q_at_t_lower"] = all.at("q_at_t_lower");
  out["clearance"] = all.at("clearance");
  out["line"] = plan.line ? plan.line->json() : Json();
  for (const char* key : kExceptions) out[key] = all.at(key);
  out["certificate"] = all.at("certificate");
  out["us"] = plan.us;
  out["notes"] = plan.notes;
  if (!plan.not_mended.empty()) out["mended"] = {{"status", "error"}, {"error", plan.not_mended}};
  if (plan.as_mended) {
    Json& mended = out["mended"] = planJson(r, *plan.as_mended);
    mended["detours"] = plan.mended->detours;
    mended["clearance_kept"] = plan.mended->kept;
    mended["deviation"] = plan.mended->deviation;
    mended["deviation_joint"] = plan.mended->deviation_joint;
    mended["deviation_unit"] = plan.mended->deviation_is_angle ? "rad" : "m";
    mended["added_time"] = motion.timed ? Json(plan.mended->added_time) : Json();
    mended["time_law"] = "to be made anew";
    mended["length_ratio"] = plan.mended->length_ratio;
    mended["ms"] = plan.mended->ms;
  }
  return out;
}

/// A line of a report: names in it cannot begin another.
std::string line(const char* begin, const std::string& text) {
  return begin + text::oneLine(text) + "\n";
}

/// A field of CSV.
std::string field(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c == '\n' ? ' ' : c);
  return out + "\"";
}

}  // namespace

Report reportOf(const CertifyReport& all, const CertifiedPlan& plan) {
  const JointTrajectory& way = plan.motion->trajectory;
  Report report{all.tree,
                all.request,
                plan.result,
                plan.notes,
                [&way](double t) { return way.configuration(t); },
                way.beginTime(),
                way.endTime(),
                plan.clearance ? &*plan.clearance : nullptr};
  report.pieces = way.numPieces();
  report.tolerances = all.tolerances;
  return report;
}

std::string textReport(const CertifyReport& r) {
  std::string text;
  if (r.plans.size() == 1 && r.plans[0].error.empty()) {
    const CertifiedPlan& plan = r.plans[0];
    text = line("", plan.title() + ": " + motionText(plan));
    if (plan.result.status != Status::free) {
      text += fmt::format("after waypoint {}\n", plan.motion->waypointBefore(plan.result.t_lower));
    }
    text += textReport(reportOf(r, plan));
    if (plan.line) text += line("", plan.line->text());
    if (const std::string mended = mendedText(plan); !mended.empty()) text += line("", mended);
    for (const std::string& note : r.notes) text += line("note: ", note);
    return text + columnsText(r);
  }
  for (const CertifiedPlan& plan : r.plans) {
    if (r.failed_only && plan.exitStatus() == kExitFree) continue;
    std::string of_plan = plan.title() + ": " + verdictText(plan);
    if (plan.error.empty()) of_plan += fmt::format(" ({})", motionText(plan));
    text += line("", of_plan);
    if (const std::string mended = mendedText(plan); !mended.empty()) text += line("  ", mended);
    for (const std::string& note : plan.notes) text += line("  note: ", note);
  }
  for (const std::string& note : r.notes) text += line("note: ", note);
  if (const std::string scope = scopeText(r.request); !scope.empty()) text += line("note: ", scope);
  return text + columnsText(r) + sumText(r);
}

nlohmann::ordered_json jsonReport(const CertifyReport& r) {
  const Sum sum = sumOf(r.plans);
  Json plans = Json::array();
  for (const CertifiedPlan& plan : r.plans) plans.push_back(planJson(r, plan));
  return {{"robot", r.tree.name()},
          {"plans", std::move(plans)},
          {"summary",
           {{"free", sum.free},
            {"contact", sum.contact},
            {"undecided", sum.undecided},
            {"error", sum.wrong},
            {"mended", sum.mended},
            {"left_line", sum.left_line},
            {"median_us", sum.median_us},
            {"slowest_us", sum.slowest_us},
            {"seconds", r.seconds}}},
          {"notes", r.notes}};
}

std::string csvReport(const CertifyReport& r) {
  std::string out =
      "file,plan,status,certain,t_lower,t_upper,waypoint,body1,body2,x,y,z,normal_x,normal_y,normal_z,clearance_lower,"
      "clearance_upper,interpolation,waypoints,us,mended,deviation,length_ratio,mend_ms,ignored_initial_contacts,"
      "never_apart_pairs,unproven_allowed_pairs,line,error\n";
  for (const CertifiedPlan& plan : r.plans) {
    out += fmt::format("{},{},", field(plan.file), field(plan.plan.name));
    if (!plan.error.empty()) {
      out += fmt::format("error{}{}\n", std::string(26, ','), field(plan.error));
      continue;
    }
    const CertifiedResult& result = plan.result;
    const plans::PlanMotion& motion = *plan.motion;
    out += fmt::format("{},{:d},{},{},", toString(result.status), result.certain, result.t_lower, result.t_upper);
    if (const CertifiedContact* c = result.first()) {
      out += fmt::format("{},{},{},{},{},{},{},{},{},", motion.waypointBefore(result.t_lower), field(c->body1.name),
                         field(c->body2.name), c->point.x(), c->point.y(), c->point.z(), c->normal.x(), c->normal.y(),
                         c->normal.z());
    } else {
      out += (result.isFree() ? "" : std::to_string(motion.waypointBefore(result.t_lower))) + std::string(9, ',');
    }
    out += plan.clearance ? fmt::format("{},{},", plan.clearance->lower, plan.clearance->upper) : ",,";
    out += fmt::format("{},{},{:.3f},", toString(motion.interpolation), motion.times.size(), plan.us);
    out += plan.as_mended
               ? fmt::format("{},{},{},{:.3f},",
                             plan.as_mended->error.empty() ? toString(plan.as_mended->result.status) : "error",
                             plan.mended->deviation, plan.mended->length_ratio, plan.mended->ms)
               : ",,,,";
    out += fmt::format("{},{},{},", result.ignored_initial_contacts.size(), result.never_apart_pairs,
                       result.unproven_allowed_pairs);
    out += plan.line ? fmt::format("{},", plan.line->verdict()) : ",";
    out += field(plan.not_mended) + "\n";
  }
  return out;
}

}  // namespace fcl_artic::app
