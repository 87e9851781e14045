// SPDX-License-Identifier: BSD-3-Clause
//
// The switches of the paper's method as options of the program.
#pragma once

#include <map>
#include <string>

#include <CLI/CLI.hpp>

#include "fcl_artic/request.h"

namespace fcl_artic::app {

/// Adds --enclosure, --refinement, --independent, --no-newton, --late-validity, --boxes-first and --links-in-world.
inline void addRedonOptions(CLI::App& verb, RedonOptions& o) {
  static const std::map<std::string, MotionEnclosure> kEnclosures{{"chain", MotionEnclosure::intervalChain},
                                                                  {"mean-value", MotionEnclosure::meanValue},
                                                                  {"taylor", MotionEnclosure::taylor}};
  const std::string group = "Method redon2004";
  verb.add_option_function<std::string>(
          "--enclosure", [&o](const std::string& name) { o.enclosure = kEnclosures.at(name); },
          "Bounds on motions: mean-value (the default), chain (interval matrix products, the paper's) or taylor")
      ->check(CLI::IsMember({"chain", "mean-value", "taylor"}))
      ->group(group);
  verb.add_option("--refinement", o.refinement_level,
                  "Bounds on 2^LEVEL parts of the time, 0 to 6; -1: by each link's motion")
      ->check(CLI::Range(-1, 6))
      ->capture_default_str()
      ->group(group)
      ->type_name("LEVEL");
  verb.add_flag_callback(
          "--independent", [&o] { o.simultaneous = false; }, "Solve every equation by itself")
      ->group(group);
  verb.add_flag_callback(
          "--no-newton", [&o] { o.newton = false; }, "No interval Newton: divide only")
      ->group(group);
  verb.add_flag_callback(
          "--late-validity", [&o] { o.early_validity = false; }, "Ask whether features touch only in the last interval")
      ->group(group);
  verb.add_flag_callback(
          "--boxes-first", [&o] { o.in_time_order = false; },
          "All boxes over the whole motion, then all equations; else both in the order of time")
      ->group(group);
  verb.add_flag_callback(
          "--links-in-world", [&o] { o.links_in_world = true; },
          "Bound the boxes of two links in the world, as the paper does; else one seen from the other")
      ->group(group);
}

}  // namespace fcl_artic::app
