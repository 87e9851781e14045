// SPDX-License-Identifier: BSD-3-Clause
//
// Point clouds from files: PCD (ascii, binary, binary_compressed), PLY without faces (ascii, binary) and lines of
// numbers. Only coordinates are read.
#include "fcl_artic/point_cloud.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "detail.h"
#include "fcl_artic/urdf/urdf.h"
#include "files/files.h"

namespace fcl_artic {
namespace {

using detail::fail;
using Points = std::vector<Eigen::Vector3d>;

/// The next line of a text, which moves on; without "\r\n" or "\n".
bool takeLine(std::string_view& text, std::string_view& line) {
  if (text.empty()) return false;
  const std::size_t end = std::min(text.find('\n'), text.size());
  line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return true;
}

std::vector<std::string_view> wordsOf(std::string_view line, const char* between = " \t") {
  std::vector<std::string_view> words;
  for (std::size_t begin; (begin = line.find_first_not_of(between)) != std::string_view::npos;) {
    line.remove_prefix(begin);
    words.push_back(line.substr(0, line.find_first_of(between)));
    line.remove_prefix(words.back().size());
  }
  return words;
}

template <class T>
bool asNumber(std::string_view word, T& value) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && end == word.data() + word.size();
}
/// A coordinate: "nan" and "inf" are numbers here, of points that were not measured.
bool asCoordinate(std::string_view word, double& value) {
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return (error == std::errc() || error == std::errc::result_out_of_range) && end == word.data() + word.size();
}

/// A number of a binary file, as its header names it.
struct Scalar {
  char kind = 'F';  ///< F: floating point, I: signed, U: unsigned
  std::size_t bytes = 4;
  double read(const char* at, bool swap) const {
    char own[8];
    std::memcpy(own, at, bytes);
    if (swap) std::reverse(own, own + bytes);
    const auto as = [&](auto value) {
      std::memcpy(&value, own, sizeof value);
      return static_cast<double>(value);
    };
    if (kind == 'F') return bytes == 4 ? as(float()) : as(double());
    const bool is_signed = kind == 'I';
    switch (bytes) {
      case 1:
        return is_signed ? as(std::int8_t()) : as(std::uint8_t());
      case 2:
        return is_signed ? as(std::int16_t()) : as(std::uint16_t());
      case 4:
        return is_signed ? as(std::int32_t()) : as(std::uint32_t());
      default:
        return is_signed ? as(std::int64_t()) : as(std::uint64_t());
    }
  }
};

/// LZF (Marc Lehmann's): a byte n below 32 begins a run of n + 1 bytes, any other one a copy of what was written.
std::string decompress(std::string_view in, std::size_t size, const std::string& where) {
  std::string out;
  const auto next = [&] {
    if (in.empty()) fail(where, "its compressed points are cut short");
    const auto byte = static_cast<unsigned char>(in.front());
    in.remove_prefix(1);
    return static_cast<std::size_t>(byte);
  };
  while (!in.empty()) {
    const std::size_t control = next();
    if (control < 32) {
      if (in.size() < control + 1) fail(where, "its compressed points are cut short");
      out.append(in.substr(0, control + 1));
      in.remove_prefix(control + 1);
    } else {
      std::size_t length = control >> 5;
      if (length == 7) length += next();
      const std::size_t back = ((control & 31) << 8 | next()) + 1;
      if (back > out.size()) fail(where, "its compressed points are broken");
      for (std::size_t i = 0; i < length + 2; ++i) out.push_back(out[out.size() - back]);
    }
    if (out.size() > size) fail(where, "its compressed points are more than it says");
  }
  if (out.size() != size) fail(where, "its compressed points are fewer than it says");
  return out;
}

class PcdReader {
 public:
  PcdReader(std::string_view text, const std::string& where) : text_(text), where_(where) {}

  Points read(std::vector<std::string>* notes) {
    readHeader(notes);
    if (data_ == "ascii") return readText();
    if (data_ == "binary") return readRows(text_);
    if (data_ != "binary_compressed")
      fail(where_, "has points '" + data_ + "'; ascii, binary, binary_compressed are read");
    std::uint32_t sizes[2];  // compressed, and before that
    if (text_.size() < sizeof sizes) fail(where_, "is cut short");
    std::memcpy(sizes, text_.data(), sizeof sizes);
    text_.remove_prefix(sizeof sizes);
    if (text_.size() < sizes[0]) fail(where_, "is cut short");
    if (sizes[1] != num_points_ * rowBytes()) fail(where_, "its compressed points are not as many as it says");
    return readColumns(decompress(text_.substr(0, sizes[0]), sizes[1], where_));
  }

 private:
  struct Field {
    std::string name;
    Scalar scalar;
    std::size_t count = 1;
  };

  void readHeader(std::vector<std::string>* notes) {
    std::string_view line;
    std::size_t width = 0, height = 1;
    bool counted = false;
    while (data_.empty()) {
      if (!takeLine(text_, line)) fail(where_, "has no line DATA: it is no PCD file or is cut short");
      if (line.empty() || line.front() == '#') continue;
      const std::vector<std::string_view> words = wordsOf(line);
      if (words.empty()) continue;
      const std::string key(words[0]);
      const auto count = [&](std::size_t at) {
        std::size_t value = 0;
        if (at >= words.size() || !asNumber(words[at], value))
          fail(where_, "its line " + key + " is not as it should be");
        return value;
      };
      const auto eachField = [&](const auto& set) {
        if (words.size() != fields_.size() + 1)
          fail(where_, "its line " + key + " has another number of entries than FIELDS");
        for (std::size_t i = 0; i < fields_.size(); ++i) set(fields_[i], i + 1);
      };
      if (key == "FIELDS" || key == "COLUMNS") {
        fields_.resize(words.size() - 1);
        for (std::size_t i = 0; i < fields_.size(); ++i) fields_[i].name = words[i + 1];
      } else if (key == "SIZE") {
        eachField([&](Field& f, std::size_t at) { f.scalar.bytes = count(at); });
      } else if (key == "TYPE") {
        eachField([&](Field& f, std::size_t at) { f.scalar.kind = words[at].size() == 1 ? words[at][0] : '?'; });
      } else if (key == "COUNT") {
        eachField([&](Field& f, std::size_t at) { f.count = count(at); });
      } else if (key == "WIDTH") {
        width = count(1);
      } else if (key == "HEIGHT") {
        height = count(1);
      } else if (key == "POINTS") {
        num_points_ = count(1);
        counted = true;
      } else if (key == "VIEWPOINT") {
        if (notes && line.find("0 0 0 1 0 0 0") == std::string_view::npos) {
          notes->push_back(where_ + ": its VIEWPOINT is not applied, points are taken as they stand in the file");
        }
      } else if (key == "DATA") {
        data_ = words.size() > 1 ? std::string(words[1]) : "nothing";
      } else if (key != "VERSION") {
        fail(where_, "has a line '" + key + "' that PCD files have not");
      }
    }
    if (!counted) num_points_ = width * height;
    for (const Field& f : fields_) {
      const std::size_t n = f.scalar.bytes;
      const bool known = f.scalar.kind == 'F'
                             ? n == 4 || n == 8
                             : (f.scalar.kind == 'I' || f.scalar.kind == 'U') && (n == 1 || n == 2 || n == 4 || n == 8);
      if (!known) fail(where_, "has a field '" + f.name + "' of a type that PCD files have not");
      if (f.count > 4096) fail(where_, "has a field '" + f.name + "' of more than 4,096 numbers");
    }
    for (int k = 0; k < 3; ++k) {
      const std::string name(1, "xyz"[k]);
      const auto field = std::find_if(fields_.begin(), fields_.end(), [&](const Field& f) { return f.name == name; });
      if (field == fields_.end() || field->count != 1) fail(where_, "has no field " + name);
      xyz_[k] = static_cast<std::size_t>(field - fields_.begin());
    }
    // A wrong count must not take all memory.
    if (num_points_ > text_.size() * 1024) fail(where_, "says that it has " + std::to_string(num_points_) + " points");
  }

  std::size_t rowBytes() const {
    std::size_t bytes = 0;
    for (const Field& f : fields_) bytes += f.scalar.bytes * f.count;
    return bytes;
  }

  Points readText() {
    Points points;
    std::size_t columns[3] = {0, 0, 0}, width = 0;
    for (std::size_t i = 0; i < fields_.size(); ++i) {
      for (int k = 0; k < 3; ++k) {
        if (xyz_[k] == i) columns[k] = width;
      }
      width += fields_[i].count;
    }
    std::string_view line;
    while (points.size() < num_points_ && takeLine(text_, line)) {
      const std::vector<std::string_view> words = wordsOf(line);
      if (words.empty()) continue;
      Eigen::Vector3d x;
      for (int k = 0; k < 3; ++k) {
        if (words.size() != width || !asCoordinate(words[columns[k]], x[k]))
          fail(where_, "point " + std::to_string(points.size()) + " is not as FIELDS says");
      }
      points.push_back(x);
    }
    if (points.size() < num_points_)
      fail(where_, "is cut short: " + std::to_string(points.size()) + " of " + std::to_string(num_points_) + " points");
    return points;
  }

  Points readRows(std::string_view bytes) {
    const std::size_t row = rowBytes();
    if (row == 0 || bytes.size() / row < num_points_) fail(where_, "is cut short");
    std::size_t begins[3];
    for (int k = 0; k < 3; ++k) {
      begins[k] = 0;
      for (std::size_t i = 0; i < xyz_[k]; ++i) begins[k] += fields_[i].scalar.bytes * fields_[i].count;
    }
    Points points(num_points_);
    for (std::size_t i = 0; i < num_points_; ++i) {
      for (int k = 0; k < 3; ++k) points[i][k] = fields_[xyz_[k]].scalar.read(&bytes[i * row + begins[k]], false);
    }
    return points;
  }

  /// Field by field, as compressed points are.
  Points readColumns(const std::string& bytes) {
    Points points(num_points_);
    for (int k = 0; k < 3; ++k) {
      std::size_t begin = 0;
      for (std::size_t i = 0; i < xyz_[k]; ++i) begin += fields_[i].scalar.bytes * fields_[i].count * num_points_;
      const Scalar& scalar = fields_[xyz_[k]].scalar;
      for (std::size_t i = 0; i < num_points_; ++i) points[i][k] = scalar.read(&bytes[begin + i * scalar.bytes], false);
    }
    return points;
  }

  std::string_view text_;
  const std::string& where_;
  std::vector<Field> fields_;
  std::size_t xyz_[3] = {0, 0, 0};
  std::size_t num_points_ = 0;
  std::string data_;
};

/// The vertices of a PLY file, which come first.
class PlyReader {
 public:
  PlyReader(std::string_view text, const std::string& where) : text_(text), where_(where) {}

  Points read() {
    readHeader();
    Points points;
    if (format_ == "ascii") {
      std::string_view line;
      while (points.size() < num_vertices_ && takeLine(text_, line)) {
        const std::vector<std::string_view> words = wordsOf(line);
        if (words.empty()) continue;
        Eigen::Vector3d x;
        for (int k = 0; k < 3; ++k) {
          if (words.size() < properties_.size() || !asCoordinate(words[xyz_[k]], x[k]))
            fail(where_, "vertex " + std::to_string(points.size()) + " is not as its header says");
        }
        points.push_back(x);
      }
    } else {
      std::size_t row = 0, begins[3] = {0, 0, 0};
      for (std::size_t i = 0; i < properties_.size(); ++i) {
        for (int k = 0; k < 3; ++k) {
          if (xyz_[k] == i) begins[k] = row;
        }
        row += properties_[i].second.bytes;
      }
      const bool swap = format_ == "binary_big_endian";
      for (; points.size() < num_vertices_ && text_.size() >= row; text_.remove_prefix(row)) {
        Eigen::Vector3d x;
        for (int k = 0; k < 3; ++k) x[k] = properties_[xyz_[k]].second.read(&text_[begins[k]], swap);
        points.push_back(x);
      }
    }
    if (points.size() < num_vertices_)
      fail(where_,
           "is cut short: " + std::to_string(points.size()) + " of " + std::to_string(num_vertices_) + " vertices");
    return points;
  }

 private:
  void readHeader() {
    std::string_view line;
    if (!takeLine(text_, line) || line != "ply") fail(where_, "is no PLY file");
    std::string element;
    bool ended = false;
    while (!ended) {
      if (!takeLine(text_, line)) fail(where_, "has no line end_header: it is cut short");
      const std::vector<std::string_view> words = wordsOf(line);
      if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
      if (words[0] == "end_header") {
        ended = true;
      } else if (words[0] == "format" && words.size() > 1) {
        format_ = words[1];
      } else if (words[0] == "element" && words.size() == 3) {
        if (element.empty() && words[1] != "vertex") fail(where_, "does not begin with its vertices");
        element = words[1];
        if (element == "vertex" && !asNumber(words[2], num_vertices_))
          fail(where_, "its number of vertices is no number");
      } else if (words[0] == "property" && words.size() >= 3) {
        if (element == "vertex") addProperty(words);
      } else {
        fail(where_, "has a line '" + std::string(line.substr(0, 60)) + "' in its header that PLY files have not");
      }
    }
    if (format_ != "ascii" && format_ != "binary_little_endian" && format_ != "binary_big_endian")
      fail(where_, "has the format '" + format_ + "', which PLY files have not");
    for (int k = 0; k < 3; ++k) {
      const std::string name(1, "xyz"[k]);
      const auto at =
          std::find_if(properties_.begin(), properties_.end(), [&](const auto& p) { return p.first == name; });
      if (at == properties_.end()) fail(where_, "its vertices have no property " + name);
      xyz_[k] = static_cast<std::size_t>(at - properties_.begin());
    }
  }

  void addProperty(const std::vector<std::string_view>& words) {
    static const struct {
      const char* name;
      Scalar scalar;
    } kTypes[] = {{"char", {'I', 1}},  {"int8", {'I', 1}},    {"uchar", {'U', 1}},  {"uint8", {'U', 1}},
                  {"short", {'I', 2}}, {"int16", {'I', 2}},   {"ushort", {'U', 2}}, {"uint16", {'U', 2}},
                  {"int", {'I', 4}},   {"int32", {'I', 4}},   {"uint", {'U', 4}},   {"uint32", {'U', 4}},
                  {"float", {'F', 4}}, {"float32", {'F', 4}}, {"double", {'F', 8}}, {"float64", {'F', 8}}};
    for (const auto& type : kTypes) {
      if (words[1] == type.name) return (void)properties_.emplace_back(std::string(words[2]), type.scalar);
    }
    fail(where_, "its vertices have a property of type '" + std::string(words[1]) + "'");
  }

  std::string_view text_;
  const std::string& where_;
  std::string format_;
  std::size_t num_vertices_ = 0;
  std::vector<std::pair<std::string, Scalar>> properties_;
  std::size_t xyz_[3] = {0, 0, 0};
};

/// A point a line: three numbers, and what follows them; what is after a '#' is a comment.
Points readLines(std::string_view text, const std::string& where) {
  Points points;
  std::string_view line;
  for (std::size_t number = 1; takeLine(text, line); ++number) {
    const std::vector<std::string_view> words = wordsOf(line.substr(0, line.find('#')), " \t,;");
    if (words.empty()) continue;
    Eigen::Vector3d x;
    for (std::size_t k = 0; k < 3; ++k) {
      if (words.size() < 3 || !asCoordinate(words[k], x[static_cast<Eigen::Index>(k)]))
        fail(where, "line " + std::to_string(number) + " does not begin with three numbers");
    }
    points.push_back(x);
  }
  return points;
}

}  // namespace

namespace detail {

bool isPlyWithoutFaces(std::string_view content) {
  std::string_view line;
  bool is_ply = false;
  while (takeLine(content, line) && line != "end_header") {
    is_ply = is_ply || line == "ply";
    const std::vector<std::string_view> words = wordsOf(line);
    if (words.size() == 3 && words[0] == "element" && (words[1] == "face" || words[1] == "tristrips") &&
        words[2] != "0")
      return false;
  }
  return is_ply;
}

}  // namespace detail

std::shared_ptr<PointCloud> loadPointCloud(const std::string& path, double radius, std::vector<std::string>* notes) {
  const std::string where = "point cloud '" + path + "'", ending = detail::endingOf(path);
  if (!(radius > 0 && std::isfinite(radius))) {
    throw std::invalid_argument("loadPointCloud: a radius of " + detail::text(radius) + " m is not above 0 and finite");
  }
  const std::string content = files::read(path);
  Points points;
  if (ending == ".pcd") {
    points = PcdReader(content, where).read(notes);
  } else if (ending == ".ply") {
    points = PlyReader(content, where).read();
  } else if (ending == ".xyz") {
    points = readLines(content, where);
  } else {
    fail(where, "its name ends in none of .pcd, .ply and .xyz");
  }
  const std::size_t all = points.size();
  points.erase(std::remove_if(points.begin(), points.end(), [](const Eigen::Vector3d& x) { return !x.allFinite(); }),
               points.end());
  if (points.empty()) fail(where, "has no point");
  if (notes && points.size() < all) {
    notes->push_back(where + ": " + std::to_string(all - points.size()) + " of " + std::to_string(all) +
                     " points are not finite, as of rays without an echo, and left out");
  }
  try {
    return std::make_shared<PointCloud>(std::move(points), radius);
  } catch (const std::invalid_argument& e) {
    fail(where, e.what());
  }
}

}  // namespace fcl_artic
