// SPDX-License-Identifier: BSD-3-Clause
// PCD, of the Point Cloud Library: a head of lines, and points as text, as rows of bytes, or compressed, field by
// field.
#include <algorithm>
#include <cstring>
#include <map>

#include "meshes/readers.h"
#include "meshes/scalar.h"
#include "meshes/text.h"

namespace fcl_artic::meshes {
namespace {

/// LZF (Marc Lehmann's): a byte n below 32 begins a run of n + 1 bytes, any other one a copy of what was written.
std::string decompress(std::string_view in, std::size_t size, const Source& source) {
  std::string out;
  const auto next = [&] {
    if (in.empty()) source.refuse("its compressed points are cut short");
    const auto byte = static_cast<unsigned char>(in.front());
    in.remove_prefix(1);
    return static_cast<std::size_t>(byte);
  };
  while (!in.empty()) {
    const std::size_t control = next();
    if (control < 32) {
      if (in.size() < control + 1) source.refuse("its compressed points are cut short");
      out.append(in.substr(0, control + 1));
      in.remove_prefix(control + 1);
    } else {
      std::size_t length = control >> 5;
      if (length == 7) length += next();
      const std::size_t back = ((control & 31) << 8 | next()) + 1;
      if (back > out.size()) source.refuse("its compressed points are broken");
      for (std::size_t i = 0; i < length + 2; ++i) out.push_back(out[out.size() - back]);
    }
    if (out.size() > size) source.refuse("its compressed points are more than it says");
  }
  if (out.size() != size) source.refuse("its compressed points are fewer than it says");
  return out;
}

class Pcd {
 public:
  explicit Pcd(const Source& source) : source_(source) {}

  Points read() {
    readHead();
    if (data_ == "ascii") return readText();
    if (data_ == "binary") return readRows();
    if (data_ != "binary_compressed") {
      source_.refuse("has points " + shown(data_) + "; ascii, binary, binary_compressed are read");
    }
    std::uint32_t sizes[2];  // compressed, and before that
    if (body_.size() < sizeof sizes) source_.refuse("is cut short");
    std::memcpy(sizes, body_.data(), sizeof sizes);
    body_.remove_prefix(sizeof sizes);
    if (body_.size() < sizes[0]) source_.refuse("is cut short");
    if (sizes[1] != num_points_ * rowBytes()) source_.refuse("its compressed points are not as many as it says");
    requireNoMore(body_.substr(sizes[0]));
    return readColumns(decompress(body_.substr(0, sizes[0]), sizes[1], source_));
  }

 private:
  struct Field {
    std::string name;
    Scalar scalar;
    std::size_t count = 1;
    std::size_t bytes() const { return scalar.bytes * count; }
  };
  using Line = std::vector<std::string_view>;

  void readHead() {
    std::map<std::string, Line, std::less<>> lines;
    body_ = withoutMark(source_);
    while (!lines.count("DATA")) {
      const std::size_t end = body_.find('\n');
      if (end == body_.npos) source_.refuse("has no line DATA: it is no PCD file or is cut short");
      Words words(body_.substr(0, end));
      body_.remove_prefix(end + 1);
      const std::string_view key = words.next();
      if (key.empty() || key[0] == '#') continue;
      static constexpr const char* kKeys[] = {"VERSION", "FIELDS", "COLUMNS",   "SIZE",   "TYPE", "COUNT",
                                              "WIDTH",   "HEIGHT", "VIEWPOINT", "POINTS", "DATA"};
      if (std::find(std::begin(kKeys), std::end(kKeys), key) == std::end(kKeys)) {
        source_.refuse("has a line " + shown(key) + " that PCD files have not");
      }
      Line line;
      for (std::string_view word = words.next(); !word.empty(); word = words.next()) line.push_back(word);
      const bool is_new = lines.emplace(key == "COLUMNS" ? "FIELDS" : key, std::move(line)).second;
      if (!is_new) source_.refuse("has two lines '" + std::string(key) + "'");
    }
    if (const auto version = lines.find("VERSION"); version != lines.end()) {
      const bool known =
          version->second.size() == 1 && isOneOf(version->second[0], {".5", "0.5", ".6", "0.6", ".7", "0.7"});
      if (!known) source_.refuse("is of a VERSION other than .5, .6 and .7");
    }
    readFields(lines);
    noteUnknownFields();
    readCounts(lines);
    const auto viewpoint = lines.find("VIEWPOINT");
    if (viewpoint != lines.end() && !isIdentity(viewpoint->second)) {
      source_.note("its VIEWPOINT is not applied, points are taken as they stand in the file");
    }
    data_ = lines["DATA"].size() == 1 ? lines["DATA"][0] : std::string_view();
  }

  /// Fields that surely are neither a place nor an extent.
  void noteUnknownFields() const {
    static constexpr std::string_view kPlain[] = {
        "x",           "y",          "z",           "_",         "rgb",        "rgba",     "r",
        "g",           "b",          "a",           "normal",    "normal_x",   "normal_y", "normal_z",
        "curvature",   "label",      "ring",        "intensity", "time",       "t",        "stamp",
        "timestamp",   "time_stamp", "offset_time", "ambient",   "near_ir",    "noise",    "reflectivity",
        "reflectance", "tag",        "line",        "object",    "confidence", "strength", "vp_x",
        "vp_y",        "vp_z"};
    std::string unknown;
    for (const Field& f : fields_) {
      if (!isOneOf(f.name, kPlain)) unknown += (unknown.empty() ? "'" : ", '") + f.name + "'";
    }
    if (!unknown.empty()) source_.note("passed over of each point: " + unknown);
  }

  void readFields(const std::map<std::string, Line, std::less<>>& lines) {
    const auto entries = [&](const char* key) -> const Line& {
      const auto found = lines.find(key);
      if (found == lines.end()) source_.refuse(std::string("has no line ") + key);
      if (!fields_.empty() && found->second.size() != fields_.size()) {
        source_.refuse(std::string("its line ") + key + " has another number of entries than FIELDS");
      }
      return found->second;
    };
    const Line& names = entries("FIELDS");
    for (const std::string_view name : names) fields_.emplace_back().name = name;
    if (fields_.empty()) source_.refuse("has no fields");
    const Line &sizes = entries("SIZE"), &types = entries("TYPE");
    for (std::size_t i = 0; i < fields_.size(); ++i) {
      Field& f = fields_[i];
      std::uint64_t n = 0, count = 1;
      const char kind = types[i].size() == 1 ? types[i][0] : '?';
      const bool known =
          toCount(sizes[i], n) &&
          (kind == 'F' ? n == 4 || n == 8 : (kind == 'I' || kind == 'U') && (n == 1 || n == 2 || n == 4 || n == 8));
      if (!known) source_.refuse("has a field '" + f.name + "' of a type that PCD files have not");
      if (lines.count("COUNT") && !toCount(entries("COUNT")[i], count))
        source_.refuse("its line COUNT is not as it should be");
      if (count > 4096) source_.refuse("has a field '" + f.name + "' of more than 4,096 numbers");
      f.scalar = {kind, n};
      f.count = count;
      if (isExtent(f.name)) source_.refuse("its points have an extent ('" + f.name + "'), which is not read");
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const std::string name(1, "xyz"[k]);
      const auto is = [&](const Field& f) { return f.name == name; };
      const auto at = std::find_if(fields_.begin(), fields_.end(), is);
      if (at == fields_.end() || at->count != 1) source_.refuse("has no field " + name);
      if (std::find_if(at + 1, fields_.end(), is) != fields_.end()) source_.refuse("has two fields " + name);
      xyz_[k] = static_cast<std::size_t>(at - fields_.begin());
    }
  }

  void readCounts(const std::map<std::string, Line, std::less<>>& lines) {
    const auto count = [&](const char* key, std::uint64_t otherwise) {
      const auto found = lines.find(key);
      if (found == lines.end()) return otherwise;
      std::uint64_t value = 0;
      if (found->second.size() != 1 || !toCount(found->second[0], value) || value > (std::uint64_t{1} << 31)) {
        source_.refuse(std::string("its line ") + key + " is not as it should be" +
                       (found->second.empty() ? "" : ": " + shown(found->second[0])));
      }
      return value;
    };
    const bool sized = lines.count("WIDTH") > 0, counted = lines.count("POINTS") > 0;
    if (!sized && !counted) source_.refuse("does not say how many points it has");
    const std::uint64_t area = count("WIDTH", 0) * count("HEIGHT", 1);
    num_points_ = count("POINTS", area);
    if (sized && area != num_points_) {
      source_.refuse("its POINTS, " + std::to_string(num_points_) + ", are not WIDTH times HEIGHT, " +
                     std::to_string(area));
    }
    // A wrong count must not take all memory.
    if (num_points_ > body_.size() * 1024)
      source_.refuse("says that it has " + std::to_string(num_points_) + " points");
  }

  /// No shift, and the turn by the quaternion 1 0 0 0.
  static bool isIdentity(const Line& viewpoint) {
    if (viewpoint.size() != 7) return false;
    for (std::size_t k = 0; k < 7; ++k) {
      double value = 0;
      if (!toNumber(viewpoint[k], value) || (k == 3 ? value != 1 && value != -1 : value != 0)) return false;
    }
    return true;
  }

  std::size_t rowBytes() const {
    std::size_t bytes = 0;
    for (const Field& f : fields_) bytes += f.bytes();
    return bytes;
  }

  /// Old writers of binary files end them with zeros, up to the end of a page of memory.
  void requireNoMore(std::string_view rest) const {
    if (rest.find_first_not_of('\0') != rest.npos) source_.refuse("goes on after its last point");
  }

  Points readText() {
    std::size_t columns[3] = {0, 0, 0}, width = 0;
    for (std::size_t i = 0; i < fields_.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        if (xyz_[k] == i) columns[k] = width;
      }
      width += fields_[i].count;
    }
    Points points;
    Line words;
    Lines lines(body_, source_, '#');
    while (lines.next()) {
      if (points.size() == num_points_) source_.refuse("goes on after its last point");
      words.clear();
      while (!lines.rest().empty()) words.push_back(lines.word());
      Eigen::Vector3d& x = points.emplace_back();
      for (std::size_t k = 0; k < 3; ++k) {
        if (words.size() != width || !toCoordinate(words[columns[k]], x[static_cast<Eigen::Index>(k)])) {
          source_.refuse("point " + std::to_string(points.size() - 1) + " is not as FIELDS says");
        }
      }
    }
    if (points.size() < num_points_) {
      source_.refuse("is cut short: " + std::to_string(points.size()) + " of " + std::to_string(num_points_) +
                     " points");
    }
    noteOpenEnd(source_);
    return points;
  }

  Points readRows() const {
    const std::size_t row = rowBytes();
    if (row == 0 || body_.size() / row < num_points_) source_.refuse("is cut short");
    requireNoMore(body_.substr(num_points_ * row));
    Points points(num_points_);
    for (std::size_t k = 0; k < 3; ++k) {
      std::size_t begin = 0;
      for (std::size_t i = 0; i < xyz_[k]; ++i) begin += fields_[i].bytes();
      const Scalar& scalar = fields_[xyz_[k]].scalar;
      for (std::size_t i = 0; i < num_points_; ++i) {
        points[i][static_cast<Eigen::Index>(k)] = scalar.read(&body_[i * row + begin], false);
      }
    }
    return points;
  }

  /// Field by field, as compressed points are.
  Points readColumns(const std::string& bytes) const {
    Points points(num_points_);
    for (std::size_t k = 0; k < 3; ++k) {
      std::size_t begin = 0;
      for (std::size_t i = 0; i < xyz_[k]; ++i) begin += fields_[i].bytes() * num_points_;
      const Scalar& scalar = fields_[xyz_[k]].scalar;
      for (std::size_t i = 0; i < num_points_; ++i) {
        points[i][static_cast<Eigen::Index>(k)] = scalar.read(&bytes[begin + i * scalar.bytes], false);
      }
    }
    return points;
  }

  const Source& source_;
  std::string_view body_;  ///< what is yet to be read
  std::vector<Field> fields_;
  std::size_t xyz_[3] = {0, 0, 0};
  std::size_t num_points_ = 0;
  std::string_view data_;
};

}  // namespace

Points readPcd(const Source& source) {
  return Pcd(source).read();
}

}  // namespace fcl_artic::meshes
