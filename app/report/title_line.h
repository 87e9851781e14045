// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdio>
#include <string>

#include "fcl_artic/result.h"

namespace fcl_artic::app {

/// The answer in one line, the title of pages and pictures: the two bodies and the time, or the proof.
inline std::string titleLine(const CertifiedResult& result) {
  if (result.nothingChecked()) return "nothing was checked";
  if (result.status == Status::free) {
    const std::string exceptions = exceptionsOf(result);
    return "free: proven for the whole motion" + (exceptions.empty() ? "" : ", " + exceptions);
  }
  char time[32];
  std::snprintf(time, sizeof time, "%.4f", result.t_lower);
  if (result.status == Status::undecided) return std::string("undecided: proven free before t = ") + time;
  std::string text = std::string("first contact at t = ") + time;
  if (const CertifiedContact* c = result.first()) text += ": " + c->body1.name + " - " + c->body2.name;
  return text + (result.certain ? "" : " (not certain)");
}

}  // namespace fcl_artic::app
