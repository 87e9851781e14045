// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace fcl_artic::app {

/// One group of bars for each name, one bar of it for each series.
struct BarChart {
  std::string title, y_label;
  bool logarithmic = false;  ///< values are positive then; a value of 0 has no bar
  std::vector<std::string> groups;
  struct Series {
    std::string name;
    std::vector<double> values;  ///< by group
  };
  std::vector<Series> series;
};

/// The charts below each other, as SVG.
std::string toSvg(const std::vector<BarChart>& charts);

}  // namespace fcl_artic::app
