// SPDX-License-Identifier: BSD-3-Clause
// A line of text without a font file: glyphs are strokes on a small grid, drawn as thick anti-aliased lines.
#include "text.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include <Eigen/Core>

namespace fcl_artic::render {
namespace {

using Eigen::Vector2d;
using Stroke = std::vector<Vector2d>;

/// Width and strokes. A stroke is a row of grid points "xy" (baseline y = 2, small letters up to 6, capitals up to 8,
/// tails down to 0); "~" before it rounds its corners.
struct Glyph {
  int width;
  const char* strokes;
};

const std::map<char, Glyph>& glyphs() {
  static const std::map<char, Glyph> table = {{' ', {2, ""}},
                                              {'a', {4, "~0646420206 4642"}},
                                              {'b', {4, "~0646420206 0802"}},
                                              {'c', {4, "~453606023243"}},
                                              {'d', {4, "~0646420206 4842"}},
                                              {'e', {4, "0444 ~444606023243"}},
                                              {'f', {3, "~381812 0626"}},
                                              {'g', {4, "~0646420206 ~46401001"}},
                                              {'h', {4, "0802 ~04064642"}},
                                              {'i', {2, "1612 1818"}},
                                              {'j', {2, "~262000 2828"}},
                                              {'k', {4, "0802 4604 1542"}},
                                              {'l', {2, "1812"}},
                                              {'m', {6, "0602 ~04063632 ~34366662"}},
                                              {'n', {4, "0602 ~04064642"}},
                                              {'o', {4, "~0646420206"}},
                                              {'p', {4, "~0646420206 0600"}},
                                              {'q', {4, "~0646420206 4640"}},
                                              {'r', {3, "0602 ~040636"}},
                                              {'s', {4, "~4536060444421203"}},
                                              {'t', {3, "~181232 0636"}},
                                              {'u', {4, "~06024244 4642"}},
                                              {'v', {4, "062246"}},
                                              {'w', {6, "0612365266"}},
                                              {'x', {4, "0642 4602"}},
                                              {'y', {4, "0622 4610"}},
                                              {'z', {4, "06460242"}},
                                              {'A', {4, "022842 1434"}},
                                              {'B', {4, "0802 ~08484505 ~05454202"}},
                                              {'C', {4, "~474808024243"}},
                                              {'D', {4, "0802 ~08484202"}},
                                              {'E', {4, "48080242 0535"}},
                                              {'F', {4, "480802 0535"}},
                                              {'G', {4, "~474808024243 434525"}},
                                              {'H', {4, "0802 4842 0545"}},
                                              {'I', {2, "1812"}},
                                              {'J', {3, "~38320203"}},
                                              {'K', {4, "0802 4804 1642"}},
                                              {'L', {4, "080242"}},
                                              {'M', {6, "0208346862"}},
                                              {'N', {4, "02084248"}},
                                              {'O', {5, "~0858520208"}},
                                              {'P', {4, "0802 ~08484505"}},
                                              {'Q', {5, "~0858520208 3351"}},
                                              {'R', {4, "0802 ~08484505 2542"}},
                                              {'S', {4, "~4748080545420203"}},
                                              {'T', {4, "0848 2822"}},
                                              {'U', {4, "~08024248"}},
                                              {'V', {4, "082248"}},
                                              {'W', {6, "0812365268"}},
                                              {'X', {4, "0842 4802"}},
                                              {'Y', {4, "082548 2522"}},
                                              {'Z', {4, "08480242"}},
                                              {'0', {4, "~0848420208"}},
                                              {'1', {4, "172822 1232"}},
                                              {'2', {4, "~0708484502 0242"}},
                                              {'3', {4, "~0708484515 ~1545420203"}},
                                              {'4', {4, "380444 3832"}},
                                              {'5', {4, "480805 ~051646420203"}},
                                              {'6', {4, "~0545420205 ~380803"}},
                                              {'7', {4, "084812"}},
                                              {'8', {4, "~0848450508 ~0545420205"}},
                                              {'9', {4, "~0848450508 ~474212"}},
                                              {'.', {2, "1212"}},
                                              {',', {2, "1201"}},
                                              {':', {2, "1515 1212"}},
                                              {'-', {4, "0444"}},
                                              {'_', {4, "0141"}},
                                              {'=', {4, "0545 0343"}},
                                              {'+', {4, "2226 0444"}},
                                              {'/', {3, "0238"}},
                                              {'#', {4, "0545 0343 1227 2237"}},
                                              {'\'', {2, "1816"}},
                                              {'(', {2, "~28060422"}},
                                              {')', {2, "~08262402"}},
                                              {'[', {2, "28080222"}},
                                              {']', {2, "08282202"}}};
  return table;
}

constexpr Glyph kUnknown{4, "0848420208"};
constexpr double kSpacing = 1.9;  // between glyphs, grid units

/// Cuts the corners of a stroke three times (Chaikin); the ends stay, a closed stroke is rounded all the way.
Stroke rounded(Stroke stroke) {
  const bool closed = stroke.front() == stroke.back();
  for (int round = 0; round < 3; ++round) {
    Stroke finer;
    for (std::size_t i = 0; i + 1 < stroke.size(); ++i) {
      finer.push_back(0.75 * stroke[i] + 0.25 * stroke[i + 1]);
      finer.push_back(0.25 * stroke[i] + 0.75 * stroke[i + 1]);
    }
    if (closed) {
      finer.push_back(finer.front());
    } else {
      finer.front() = stroke.front();
      finer.back() = stroke.back();
    }
    stroke = std::move(finer);
  }
  return stroke;
}

std::vector<Stroke> strokesOf(const Glyph& glyph) {
  std::vector<Stroke> strokes;
  bool round = false;
  Stroke stroke;
  const auto finish = [&] {
    if (!stroke.empty()) strokes.push_back(round ? rounded(stroke) : stroke);
    stroke.clear();
    round = false;
  };
  for (const char* at = glyph.strokes; *at;) {
    if (*at == ' ') {
      finish();
      ++at;
    } else if (*at == '~') {
      round = true;
      ++at;
    } else {
      stroke.emplace_back(at[0] - '0', at[1] - '0');
      at += 2;
    }
  }
  finish();
  return strokes;
}

const Glyph& glyphOf(char c) {
  const auto found = glyphs().find(c);
  return found == glyphs().end() ? kUnknown : found->second;
}

double textWidth(const std::string& text) {
  double width = 0;
  for (const char c : text) width += glyphOf(c).width + kSpacing;
  return width;
}

double distanceToSegment(const Vector2d& p, const Vector2d& a, const Vector2d& b) {
  const Vector2d ab = b - a;
  const double length2 = ab.squaredNorm();
  const double s = length2 > 0 ? std::clamp((p - a).dot(ab) / length2, 0.0, 1.0) : 0;
  return (p - a - s * ab).norm();
}

}  // namespace

void drawTitle(Image& image, const std::string& title) {
  if (title.empty()) return;
  const double unit = image.height * 0.0030;  // pixels per grid unit
  const double margin = 0.03 * image.height, half_width = 0.42 * unit, rim = 1.1 * unit;
  std::string text = title;
  while (textWidth(text) * unit > image.width - 2 * margin && text.size() > 3) {
    text.resize(text.size() - 4);
    text += "...";
  }

  // Distance from each pixel of the line to the nearest stroke.
  const int top = static_cast<int>(margin - rim), rows = static_cast<int>(9 * unit + 2 * rim) + 2;
  std::vector<float> distance(static_cast<std::size_t>(rows) * static_cast<std::size_t>(image.width), 1e9f);
  double x = margin;
  for (const char c : text) {
    for (const Stroke& stroke : strokesOf(glyphOf(c))) {
      for (std::size_t i = 0; i + 1 < stroke.size(); ++i) {
        const auto pixel = [&](const Vector2d& g) { return Vector2d(x + g.x() * unit, margin + (8 - g.y()) * unit); };
        const Vector2d a = pixel(stroke[i]), b = pixel(stroke[i + 1]);
        const double reach = half_width + rim + 1;
        const int x0 = std::max(0, static_cast<int>(std::min(a.x(), b.x()) - reach));
        const int x1 = std::min(image.width - 1, static_cast<int>(std::max(a.x(), b.x()) + reach));
        const int y0 = std::max(top, static_cast<int>(std::min(a.y(), b.y()) - reach));
        const int y1 = std::min(top + rows - 1, static_cast<int>(std::max(a.y(), b.y()) + reach));
        for (int py = y0; py <= y1; ++py) {
          for (int px = x0; px <= x1; ++px) {
            float& d = distance[static_cast<std::size_t>(py - top) * static_cast<std::size_t>(image.width) +
                                static_cast<std::size_t>(px)];
            d = std::min(d, static_cast<float>(distanceToSegment({px + 0.5, py + 0.5}, a, b)));
          }
        }
      }
    }
    x += (glyphOf(c).width + kSpacing) * unit;
  }

  constexpr double kInk[3] = {38, 50, 66}, kPaper[3] = {246, 248, 250};
  for (int row = 0; row < rows; ++row) {
    const int y = top + row;
    if (y < 0 || y >= image.height) continue;
    for (int column = 0; column < image.width; ++column) {
      const double d = distance[static_cast<std::size_t>(row) * static_cast<std::size_t>(image.width) +
                                static_cast<std::size_t>(column)];
      const double ink = std::clamp(half_width + 0.5 - d, 0.0, 1.0);
      const double halo = 0.75 * std::clamp((half_width + rim - d) / rim, 0.0, 1.0);
      if (ink == 0 && halo == 0) continue;
      std::uint8_t* pixel = &image.rgb[3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                                            static_cast<std::size_t>(column))];
      for (int channel = 0; channel < 3; ++channel) {
        const double paper = pixel[channel] + halo * (kPaper[channel] - pixel[channel]);
        pixel[channel] = static_cast<std::uint8_t>(std::lround(paper + ink * (kInk[channel] - paper)));
      }
    }
  }
}

}  // namespace fcl_artic::render
