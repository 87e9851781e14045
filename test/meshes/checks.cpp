// SPDX-License-Identifier: BSD-3-Clause
#include "checks.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#ifdef FCL_ARTIC_GLTF
#include <nlohmann/json.hpp>
#endif

namespace fcl_artic::test {
namespace {

std::string endingOf(const std::string& name) {
  return name.substr(name.rfind('.'));
}

meshes::Points readCloud(const meshes::Source& source) {
  const std::string ending = endingOf(source.path);
  return ending == ".pcd"   ? meshes::readPcd(source)
         : ending == ".xyz" ? meshes::readXyz(source)
                            : meshes::readPlyPoints(source);
}

bool isCloud(const std::string& format) {
  return format == "pcd" || format == "xyz" || format == "cloud.ply";
}

void writeMore(const WrittenFile& file, const std::string& folder) {
  for (const auto& [name, content] : file.more) {
    std::ofstream(std::filesystem::path(folder) / name, std::ios::binary) << content;
  }
}

std::string compare(const WrittenFile& file, const meshes::TriangleSoup& soup) {
  const auto numbers = [](const char* what, std::size_t read, std::size_t written) {
    return std::to_string(read) + " " + what + " read, " + std::to_string(written) + " written";
  };
  if (soup.triangles.size() != file.triangles.size())
    return numbers("triangles", soup.triangles.size(), file.triangles.size());
  if (soup.points != file.points) return numbers("points", soup.points, file.points);
  if (soup.lines != file.lines) return numbers("lines", soup.lines, file.lines);
  double size = 0;
  for (const auto& t : file.triangles) {
    for (const Place& x : t) size = std::max({size, std::abs(x[0]), std::abs(x[1]), std::abs(x[2])});
  }
  for (std::size_t t = 0; t < file.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector3d& x = soup.vertices[soup.triangles[t][static_cast<int>(k)]];
      for (std::size_t i = 0; i < 3; ++i) {
        const double written = file.triangles[t][k][i], read = x[static_cast<Eigen::Index>(i)];
        if (std::abs(read - written) > file.tolerance * size) {
          return "triangle " + std::to_string(t) + ", corner " + std::to_string(k) + ", coordinate " +
                 std::to_string(i) + " is " + std::to_string(read) + ", written " + std::to_string(written);
        }
      }
    }
  }
  return {};
}

std::string compare(const WrittenFile& file, const meshes::Points& points) {
  if (points.size() != file.cloud.size())
    return std::to_string(points.size()) + " points read, " + std::to_string(file.cloud.size()) + " written";
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i] != Eigen::Vector3d(file.cloud[i][0], file.cloud[i][1], file.cloud[i][2]))
      return "point " + std::to_string(i) + " is another one";
  }
  return {};
}

// ---- changes of structure

/// A part of a text: from, to.
using Span = std::pair<std::size_t, std::size_t>;

/// Parts of a text that can be removed, doubled or moved: lines, words, elements of XML with what they hold, values of
/// JSON.
std::vector<Span> partsOf(const std::string& text, Random& random) {
  std::vector<Span> parts;
  const auto between = [&](const char* ends) {
    for (std::size_t at = 0; at < text.size();) {
      const std::size_t end = std::min(text.find_first_of(ends, at), text.size());
      if (end > at) parts.emplace_back(at, std::min(end + 1, text.size()));
      at = end + 1;
    }
  };
  const int kind = static_cast<int>(random() % 3);
  if (kind == 0) between("\n\r");
  if (kind == 1) between(" \t\n\r\",<>=/");
  if (kind == 2) {
    // What is between brackets; between the beginning and the end of an element.
    for (std::size_t at = 0; at < text.size(); ++at) {
      const char open = text[at], close = open == '{' ? '}' : open == '[' ? ']' : '\0';
      if (close) {
        int depth = 0;
        for (std::size_t end = at; end < text.size(); ++end) {
          depth += text[end] == open ? 1 : text[end] == close ? -1 : 0;
          if (depth > 0) continue;
          parts.emplace_back(at, end + 1);
          break;
        }
      }
      if (open == '<' && at + 1 < text.size() && std::isalpha(static_cast<unsigned char>(text[at + 1]))) {
        const std::size_t tag_end = text.find('>', at), name_end = text.find_first_of(" />", at);
        if (tag_end == text.npos || name_end == text.npos) continue;
        if (text[tag_end - 1] == '/') {
          parts.emplace_back(at, tag_end + 1);
        } else {
          const std::string close_tag = "</" + text.substr(at + 1, name_end - at - 1) + ">";
          const std::size_t end = text.find(close_tag, tag_end);
          if (end != text.npos) parts.emplace_back(at, end + close_tag.size());
        }
      }
    }
  }
  return parts;
}

std::string changed(std::string text, Random& random) {
  static const std::vector<std::string> kWords{"0",    "-1",    "1",   "3",      "4294967295", "99999999999999999999",
                                               "1.5",  "1e999", "nan", "-inf",   "x",          "",
                                               "\"\"", "null",  "[]",  "{}",     "true",       "#g0",
                                               "#n0",  "65535", "2",   "vertex", "face"};
  for (int changes = 1 + static_cast<int>(random() % 3); changes > 0; --changes) {
    const std::vector<Span> parts = partsOf(text, random);
    if (parts.empty()) continue;
    const Span one = parts[random() % parts.size()], other = parts[random() % parts.size()];
    const std::string part = text.substr(one.first, one.second - one.first);
    switch (random() % 4) {
      case 0:
        text.erase(one.first, part.size());
        break;
      case 1:
        text.insert(one.first, part);
        break;
      case 2:
        text.insert(other.first, part);
        break;
      default:
        text.replace(one.first, part.size() > 1 ? part.size() - 1 : 1, kWords[random() % kWords.size()]);
    }
  }
  return text;
}

#ifdef FCL_ARTIC_GLTF
/// All values of a document.
void collectValues(nlohmann::json& value, std::vector<nlohmann::json*>& all) {
  all.push_back(&value);
  if (!value.is_structured()) return;
  for (nlohmann::json& part : value) collectValues(part, all);
}

std::string changedJson(const std::string& text, Random& random) {
  using Json = nlohmann::json;
  Json root = Json::parse(text);
  for (int changes = 1 + static_cast<int>(random() % 3); changes > 0; --changes) {
    std::vector<Json*> all;
    collectValues(root, all);
    Json& one = *all[random() % all.size()];
    const Json other = *all[random() % all.size()];
    static const Json kValues[] = {
        0, -1, 1, 2, 3, 7, 1.5, 1e300, 4294967295u, "x", nullptr, true, Json::array(), Json::object()};
    const std::size_t at = one.is_structured() && !one.empty() ? random() % one.size() : 0;
    switch (random() % 4) {
      case 0:
        if (one.is_array() && !one.empty()) one.erase(at);
        if (one.is_object() && !one.empty()) one.erase(std::next(one.begin(), static_cast<std::ptrdiff_t>(at)));
        break;
      case 1:
        if (one.is_array() && !one.empty()) one.insert(one.begin(), Json(one[at]));
        break;
      case 2:
        one = other;
        break;
      default:
        one = kValues[random() % std::size(kValues)];
    }
  }
  return root.dump();
}
#endif

std::string changedFile(const std::string& name, const std::string& content, Random& random) {
#ifdef FCL_ARTIC_GLTF
  if (endingOf(name) == ".gltf" && random() % 4 != 0) return changedJson(content, random);
#endif
  (void)name;
  return changed(content, random);
}

std::string faultOf(const meshes::TriangleSoup& soup) {
  for (const fcl::Triangle& t : soup.triangles) {
    for (int k = 0; k < 3; ++k) {
      if (t[k] >= soup.vertices.size())
        return "a triangle has vertex " + std::to_string(t[k]) + " of " + std::to_string(soup.vertices.size());
    }
  }
  return {};
}

}  // namespace

meshes::TriangleSoup readWritten(const WrittenFile& file, const meshes::Source& source) {
  const std::string ending = endingOf(file.name);
  if (ending == ".stl") return meshes::readStl(source);
  if (ending == ".obj") return meshes::readObj(source);
  if (ending == ".off") return meshes::readOff(source);
  if (ending == ".ply") return meshes::readPly(source);
  if (ending == ".dae") return meshes::readCollada(source, file.turn);
  return meshes::readGltf(source, file.turn);
}

std::string readsWhatIsWritten(const std::string& format, int files, std::uint64_t seed, const std::string& folder) {
  for (int k = 0; k < files; ++k) {
    Random random(seed + static_cast<std::uint64_t>(k));
    const WrittenFile file = writeRandomFile(format, random);
    writeMore(file, folder);
    const meshes::Source source{(std::filesystem::path(folder) / file.name).string(), file.content, file.name, nullptr};
    std::string wrong;
    try {
      wrong = isCloud(format)          ? compare(file, readCloud(source))
              : file.triangles.empty() ? std::string()
                                       : compare(file, readWritten(file, source));
    } catch (const std::runtime_error& error) {
      wrong = std::string("refused: ") + error.what();
    }
    if (!wrong.empty())
      return "seed " + std::to_string(seed + static_cast<std::uint64_t>(k)) + ": " + wrong + "\n" +
             file.content.substr(0, 4000);
  }
  return {};
}

std::string survivesChanges(const std::string& format, int files, std::uint64_t seed, const std::string& folder,
                            int& read, int& refused) {
  read = refused = 0;
  for (int k = 0; k < files; ++k) {
    const std::uint64_t own_seed = seed + static_cast<std::uint64_t>(k);
    Random random(own_seed);
    WrittenFile file = writeRandomFile(format, random);
    writeMore(file, folder);
    file.content = changedFile(file.name, file.content, random);
    const meshes::Source source{(std::filesystem::path(folder) / file.name).string(), file.content, file.name, nullptr};
    std::string wrong;
    try {
      if (isCloud(format)) {
        readCloud(source);
      } else {
        wrong = faultOf(readWritten(file, source));
      }
      ++read;
    } catch (const std::runtime_error& error) {
      ++refused;
      if (std::string(error.what()).find(file.name) != 0)
        wrong = std::string("an error does not name the file: ") + error.what();
    }
    if (!wrong.empty()) return "seed " + std::to_string(own_seed) + ": " + wrong;
  }
  return {};
}

}  // namespace fcl_artic::test
