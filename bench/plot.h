// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace fcl_artic::bench {

struct Series {
  std::string name;
  std::vector<std::pair<double, double>> points;  ///< positive
};

/// A plot with two logarithmic axes, as SVG. Decades are labelled on y, the given points on x.
inline std::string logLogPlot(const std::string& title, const std::string& x_label, const std::string& y_label,
                              const std::vector<Series>& series) {
  constexpr double kWidth = 640, kHeight = 420, kLeft = 80, kRight = 150, kTop = 40, kBottom = 60;
  const char* const colours[] = {"#1b6ca8", "#c23b22", "#2e8b57", "#8e5ea2", "#d98e04", "#555555"};
  std::vector<double> xs;
  double y_low = 1e300, y_high = 1e-300;
  for (const Series& s : series) {
    for (const auto& [x, y] : s.points) {
      xs.push_back(x);
      y_low = std::min(y_low, y);
      y_high = std::max(y_high, y);
    }
  }
  if (xs.empty()) return {};
  std::sort(xs.begin(), xs.end());
  xs.erase(std::unique(xs.begin(), xs.end()), xs.end());
  const double x0 = std::log10(xs.front()), x1 = std::max(std::log10(xs.back()), x0 + 1e-9);
  const double y0 = std::floor(std::log10(y_low)), y1 = std::max(std::ceil(std::log10(y_high)), y0 + 1);
  const auto px = [&](double x) { return kLeft + (std::log10(x) - x0) / (x1 - x0) * (kWidth - kLeft - kRight); };
  const auto py = [&](double y) {
    return kHeight - kBottom - (std::log10(y) - y0) / (y1 - y0) * (kHeight - kTop - kBottom);
  };
  const auto text = [](double x, double y, const char* anchor, const std::string& words) {
    return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", x, y, anchor, words);
  };
  const auto line = [](double xa, double ya, double xb, double yb) {
    return fmt::format("<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\" stroke=\"#dddddd\"/>\n", xa, ya, xb, yb);
  };

  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" "
      "font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"{0}\" height=\"{1}\" fill=\"white\"/>\n",
      kWidth, kHeight);
  svg += text(kWidth / 2, kTop / 2, "middle", title);
  svg += text((kLeft + kWidth - kRight) / 2, kHeight - 15, "middle", x_label);
  svg += fmt::format("<g transform=\"translate(20 {:.1f}) rotate(-90)\">{}</g>\n", (kTop + kHeight - kBottom) / 2,
                     text(0, 0, "middle", y_label));
  for (double decade = y0; decade <= y1; ++decade) {
    const double y = std::pow(10, decade);
    svg += line(kLeft, py(y), kWidth - kRight, py(y)) + text(kLeft - 6, py(y) + 4, "end", fmt::format("{:g}", y));
  }
  for (const double x : xs) {
    svg += line(px(x), kTop, px(x), kHeight - kBottom) +
           text(px(x), kHeight - kBottom + 18, "middle", fmt::format("{:g}", x));
  }
  double legend = kTop + 10;
  for (std::size_t i = 0; i < series.size(); ++i) {
    const char* colour = colours[i % std::size(colours)];
    std::string path;
    for (const auto& [x, y] : series[i].points) {
      path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? 'M' : 'L', px(x), py(y));
      svg += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"{}\"/>\n", px(x), py(y), colour);
    }
    svg += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.5\"/>\n", path, colour);
    svg += fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"10\" height=\"10\" fill=\"{}\"/>\n",
                       kWidth - kRight + 12, legend - 9, colour);
    svg += text(kWidth - kRight + 28, legend, "start", series[i].name);
    legend += 18;
  }
  return svg + "</svg>\n";
}

}  // namespace fcl_artic::bench
