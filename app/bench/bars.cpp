// SPDX-License-Identifier: BSD-3-Clause
#include "bench/bars.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

namespace fcl_artic::app {
namespace {

constexpr double kWidth = 900, kHeight = 320, kLeft = 80, kRight = 190, kTop = 40, kBottom = 45;
constexpr const char* kColours[] = {"#c23b22", "#d98e04", "#1b6ca8", "#2e8b57"};

std::string text(double x, double y, const char* anchor, const std::string& words) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", x, y, anchor, words);
}

/// Labelled values on the axis: decades, or five steps of 1, 2 or 5 times a power of ten.
std::vector<double> ticksOf(const BarChart& chart) {
  double low = 1e300, high = 0;
  for (const BarChart::Series& s : chart.series) {
    for (const double value : s.values) {
      high = std::max(high, value);
      if (value > 0) low = std::min(low, value);
    }
  }
  std::vector<double> ticks;
  if (chart.logarithmic) {
    if (high <= 0) low = high = 1;
    const int first = static_cast<int>(std::floor(std::log10(low)));
    const int last = std::max(first + 1, static_cast<int>(std::ceil(std::log10(high))));
    for (int k = first; k <= last; ++k) ticks.push_back(std::pow(10, k));
  } else {
    const double most = high > 0 ? high : 1, power = std::pow(10, std::floor(std::log10(most / 5)));
    double step = 10 * power;
    for (const double factor : {5.0, 2.0, 1.0}) {
      if (factor * power * 5 >= most) step = factor * power;
    }
    for (int k = 0; k == 0 || ticks.back() < most; ++k) ticks.push_back(k * step);
  }
  return ticks;
}

std::string drawn(const BarChart& chart, double top) {
  const std::vector<double> ticks = ticksOf(chart);
  const double base = top + kHeight - kBottom, plot = kHeight - kTop - kBottom;
  const auto height = [&](double value) {
    if (!chart.logarithmic) return plot * value / ticks.back();
    return value > 0 ? plot * std::log10(value / ticks.front()) / std::log10(ticks.back() / ticks.front()) : 0;
  };
  std::string svg = text(kWidth / 2, top + kTop / 2, "middle", chart.title);
  svg += fmt::format("<g transform=\"translate(20 {:.1f}) rotate(-90)\">{}</g>\n", base - plot / 2,
                     text(0, 0, "middle", chart.y_label));
  for (const double tick : ticks) {
    const double y = base - height(tick);
    svg += fmt::format("<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\" stroke=\"#dddddd\"/>\n", kLeft, y, kWidth - kRight, y);
    svg += text(kLeft - 6, y + 4, "end", fmt::format("{:g}", tick));
  }
  const double group = (kWidth - kLeft - kRight) / static_cast<double>(chart.groups.size());
  const double bar = 0.8 * group / static_cast<double>(chart.series.size());
  for (std::size_t g = 0; g < chart.groups.size(); ++g) {
    const double left = kLeft + group * (static_cast<double>(g) + 0.1);
    for (std::size_t s = 0; s < chart.series.size(); ++s) {
      const double h = height(chart.series[s].values[g]);
      svg +=
          fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"{}\"/>\n",
                      left + bar * static_cast<double>(s), base - h, 0.92 * bar, h, kColours[s % std::size(kColours)]);
    }
    svg += text(left + 0.4 * group, base + 18, "middle", chart.groups[g]);
  }
  for (std::size_t s = 0; s < chart.series.size(); ++s) {
    const double y = top + kTop + 18 * static_cast<double>(s);
    svg += fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"10\" height=\"10\" fill=\"{}\"/>\n",
                       kWidth - kRight + 12, y, kColours[s % std::size(kColours)]);
    svg += text(kWidth - kRight + 28, y + 9, "start", chart.series[s].name);
  }
  return svg;
}

}  // namespace

std::string toSvg(const std::vector<BarChart>& charts) {
  const double height = kHeight * static_cast<double>(charts.size());
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" "
      "font-family=\"sans-serif\" font-size=\"11\">\n<rect width=\"{0}\" height=\"{1}\" fill=\"white\"/>\n",
      kWidth, height);
  for (std::size_t i = 0; i < charts.size(); ++i) svg += drawn(charts[i], kHeight * static_cast<double>(i));
  return svg + "</svg>\n";
}

}  // namespace fcl_artic::app
