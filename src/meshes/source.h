// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace fcl_artic::meshes {

/// A file that is being read.
struct Source {
  std::string path;
  std::string_view content;
  std::string where;  ///< Names the file in messages, such as "mesh 'a.stl'".
  std::vector<std::string>* notes = nullptr;

  /// @throws std::runtime_error naming the file.
  [[noreturn]] void refuse(const std::string& reason) const { throw std::runtime_error(where + ": " + reason); }
  /// Keeps what was read though unusual, or left out.
  void note(const std::string& text) const {
    if (notes) notes->push_back(where + ": " + text);
  }
};

/// Words of a file as messages show them.
inline std::string shown(std::string_view words) {
  constexpr std::size_t kMax = 40;
  std::string out = "'";
  for (const char c : words.substr(0, kMax)) out += static_cast<unsigned char>(c) < ' ' ? '?' : c;
  return out + (words.size() > kMax ? "...'" : "'");
}

/// "1 line", "2 lines".
inline std::string counted(std::size_t count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

}  // namespace fcl_artic::meshes
