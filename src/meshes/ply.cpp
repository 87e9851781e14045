// SPDX-License-Identifier: BSD-3-Clause
// PLY: ascii, binary with either end first. A line an entry in ascii.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

#include "meshes/readers.h"
#include "meshes/scalar.h"
#include "meshes/text.h"

namespace fcl_artic::meshes {
namespace {

struct PlyProperty {
  std::string name;
  Scalar count;  ///< of a list
  Scalar value;
  bool isList() const { return count.bytes > 0; }
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  /// The property's number; if there is no such property, a number that no property has.
  std::size_t find(std::string_view property) const {
    const auto at =
        std::find_if(properties.begin(), properties.end(), [&](const auto& p) { return p.name == property; });
    return static_cast<std::size_t>(at - properties.begin());
  }
  bool has(std::string_view property) const { return find(property) < properties.size(); }
};

Scalar plyType(std::string_view name) {
  static constexpr struct {
    const char* name;
    Scalar scalar;
  } kTypes[] = {{"char", {'I', 1}},  {"int8", {'I', 1}},    {"uchar", {'U', 1}},  {"uint8", {'U', 1}},
                {"short", {'I', 2}}, {"int16", {'I', 2}},   {"ushort", {'U', 2}}, {"uint16", {'U', 2}},
                {"int", {'I', 4}},   {"int32", {'I', 4}},   {"uint", {'U', 4}},   {"uint32", {'U', 4}},
                {"float", {'F', 4}}, {"float32", {'F', 4}}, {"double", {'F', 8}}, {"float64", {'F', 8}}};
  for (const auto& type : kTypes) {
    if (name == type.name) return type.scalar;
  }
  return {};
}

// Elements and properties that surely are no geometry.
constexpr std::string_view kPlainElements[] = {"camera", "material", "multi_texture_vertex", "multi_texture_face"};
constexpr std::string_view kPlainOfVertices[] = {"nx",
                                                 "ny",
                                                 "nz",
                                                 "red",
                                                 "green",
                                                 "blue",
                                                 "alpha",
                                                 "r",
                                                 "g",
                                                 "b",
                                                 "a",
                                                 "diffuse_red",
                                                 "diffuse_green",
                                                 "diffuse_blue",
                                                 "ambient_red",
                                                 "ambient_green",
                                                 "ambient_blue",
                                                 "specular_red",
                                                 "specular_green",
                                                 "specular_blue",
                                                 "confidence",
                                                 "intensity",
                                                 "quality",
                                                 "value",
                                                 "flags",
                                                 "label",
                                                 "curvature",
                                                 "u",
                                                 "v",
                                                 "s",
                                                 "t",
                                                 "texture_u",
                                                 "texture_v",
                                                 "material_index"};
constexpr std::string_view kPlainOfFaces[] = {
    "red",      "green",     "blue",      "alpha",          "nx",
    "ny",       "nz",        "flags",     "quality",        "label",
    "texcoord", "texnumber", "texcoords", "material_index", "material_indices"};

class Ply {
 public:
  explicit Ply(const Source& source) : source_(source) { readHead(); }

  bool hasFaces() const {
    const PlyElement* faces = find("face");
    return faces && faces->count > 0;
  }

  TriangleSoup readMesh() {
    if (!hasFaces()) source_.refuse("has no triangles");
    for (const PlyElement& e : elements_) checkElement(e);
    const PlyElement& face = *find("face");
    const std::size_t one = face.find("vertex_indices"), other = face.find("vertex_index");
    const std::size_t list = std::min(one, other), none = face.properties.size();
    if (list == none || !face.properties[list].isList()) source_.refuse("its faces have no list of vertex_indices");
    if (std::max(one, other) < none) source_.refuse("its faces have two lists of vertices");
    TriangleSoup soup;
    std::vector<std::size_t> corners, ends;  // of all faces: the vertices may come after them
    readBody([&](const PlyElement& e, const std::vector<std::vector<double>>& entry, std::uint64_t i) {
      if (e.name == "vertex") soup.vertices.push_back(place(entry));
      if (e.name == "edge") ++soup.lines;
      noteCamera(e, entry);
      if (e.name != "face") return;
      for (const double value : entry[list]) corners.push_back(indexOf(value, i));
      ends.push_back(corners.size());
    });
    std::size_t begin = 0;
    for (const std::size_t end : ends) {
      soup.addFace(corners.data() + begin, end - begin, source_);
      begin = end;
    }
    return soup;
  }

  Points readPoints() {
    for (const PlyElement& e : elements_) {
      if (e.name != "face") checkElement(e);
    }
    Points points;
    readBody([&](const PlyElement& e, const std::vector<std::vector<double>>& entry, std::uint64_t) {
      if (e.name == "vertex") points.push_back(place(entry));
      noteCamera(e, entry);
    });
    for (const PlyElement& e : elements_) {
      if ((e.name != "face" && e.name != "edge") || e.count == 0) continue;
      source_.note("its " + e.name + "s, " + std::to_string(e.count) + ", are left out: only its vertices are points");
    }
    return points;
  }

 private:
  const PlyElement* find(std::string_view name) const {
    for (const PlyElement& e : elements_) {
      if (e.name == name) return &e;
    }
    return nullptr;
  }

  /// A line of the head, which ends in a line feed or in both.
  std::string_view takeHeadLine() {
    const std::size_t end = body_.find('\n');
    if (end == body_.npos) source_.refuse("is cut short or broken within its head");
    std::string_view line = body_.substr(0, end);
    body_.remove_prefix(end + 1);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    return line;
  }

  void readHead() {
    body_ = withoutMark(source_);
    if (takeHeadLine() != "ply") source_.refuse("is no PLY");
    std::string format;
    for (;;) {
      const std::string_view line = takeHeadLine();
      Words words(line);
      const std::string_view key = words.next();
      if (key == "comment" || key == "obj_info" || key.empty()) continue;
      const auto broken = [&] { source_.refuse("has a line " + shown(line) + " in its head that PLY files have not"); };
      if (key == "end_header") {
        if (!words.next().empty()) broken();
        break;
      }
      if (key == "format") {
        if (!format.empty()) source_.refuse("has two lines 'format'");
        format = words.next();
        if (words.next() != "1.0") broken();
      } else if (key == "element") {
        PlyElement e;
        e.name = words.next();
        if (e.name.empty() || !toCount(words.next(), e.count))
          source_.refuse("does not say how many '" + e.name + "' it has");
        if (find(e.name)) source_.refuse("has two elements '" + e.name + "'");
        elements_.push_back(std::move(e));
      } else if (key == "property") {
        if (elements_.empty()) source_.refuse("has a property of no element");
        PlyProperty property;
        std::string_view type = words.next();
        if (type == "list") {
          property.count = plyType(words.next());
          type = words.next();
          if (property.count.bytes == 0 || property.count.kind == 'F')
            source_.refuse("has a property of an unknown type");
        }
        property.value = plyType(type);
        if (property.value.bytes == 0) source_.refuse("has a property of an unknown type");
        property.name = words.next();
        PlyElement& e = elements_.back();
        if (property.name.empty()) broken();
        if (e.has(property.name)) source_.refuse("has two properties '" + property.name + "' of '" + e.name + "'");
        e.properties.push_back(std::move(property));
      } else {
        broken();
      }
      if (!words.next().empty()) broken();
    }
    ascii_ = format == "ascii";
    big_ = format == "binary_big_endian";
    if (!ascii_ && !big_ && format != "binary_little_endian")
      source_.refuse("is of an unknown format '" + format + "'");
    for (const PlyElement& e : elements_) {
      if (e.properties.empty() && e.count > 0) source_.refuse("has an element '" + e.name + "' without properties");
    }
    const PlyElement* vertices = find("vertex");
    if (!vertices) source_.refuse("has no element 'vertex'");
    for (std::size_t k = 0; k < 3; ++k) {
      const std::string name(1, "xyz"[k]);
      xyz_[k] = vertices->find(name);
      if (xyz_[k] == vertices->properties.size()) source_.refuse("its vertices have no property " + name);
      if (vertices->properties[xyz_[k]].isList()) source_.refuse("the property " + name + " of its vertices is a list");
    }
  }

  /// Refuses elements and properties that may be geometry; notes properties that nobody knows.
  void checkElement(const PlyElement& e) const {
    if (e.count == 0 || isOneOf(e.name, kPlainElements)) return;
    if (e.name == "tristrips") source_.refuse("has triangle strips: save it with faces");
    const bool vertices = e.name == "vertex", faces = e.name == "face";
    if (e.name == "edge") return;
    if (!vertices && !faces)
      source_.refuse("has an element '" + e.name + "', which is not read: save it with vertices and faces");
    std::string unknown;
    for (const PlyProperty& p : e.properties) {
      if (vertices && isExtent(p.name))
        source_.refuse("its vertices have an extent ('" + p.name + "'), which is not read");
      if (vertices ? p.name == "x" || p.name == "y" || p.name == "z" || isOneOf(p.name, kPlainOfVertices)
                   : p.name == "vertex_indices" || p.name == "vertex_index" || isOneOf(p.name, kPlainOfFaces)) {
        continue;
      }
      if (p.isList()) source_.refuse("its element '" + e.name + "' has a list '" + p.name + "', which is not read");
      unknown += (unknown.empty() ? "'" : ", '") + p.name + "'";
    }
    if (!unknown.empty()) source_.note("passed over of each " + e.name + ": " + unknown);
  }

  /// A camera says from where points were seen. It may mean that they are to be moved by its pose, as a PCD's
  /// VIEWPOINT.
  void noteCamera(const PlyElement& e, const std::vector<std::vector<double>>& entry) {
    if (e.name != "camera" || camera_noted_) return;
    static constexpr const char* kPose[] = {"view_px", "view_py", "view_pz", "x_axisx", "x_axisy", "x_axisz",
                                            "y_axisx", "y_axisy", "y_axisz", "z_axisx", "z_axisy", "z_axisz"};
    for (std::size_t k = 0; k < std::size(kPose); ++k) {
      const std::size_t p = e.find(kPose[k]);
      const double usual = k == 3 || k == 7 || k == 11;  // at the origin, with the axes of the file
      if (p == e.properties.size() || entry[p] == std::vector<double>{usual}) continue;
      camera_noted_ = true;
      return source_.note(
          "its camera is elsewhere than at the origin, which is not applied: places are taken as they stand");
    }
  }

  Eigen::Vector3d place(const std::vector<std::vector<double>>& entry) const {
    return {entry[xyz_[0]][0], entry[xyz_[1]][0], entry[xyz_[2]][0]};
  }

  std::size_t indexOf(double value, std::uint64_t face) const {
    const auto vertices = static_cast<double>(find("vertex")->count);
    if (value != std::floor(value) || !(value >= 0 && value < vertices)) {
      source_.refuse("has a face with vertex " +
                     std::to_string(static_cast<long long>(std::max(-1e15, std::min(value, 1e15)))) + " of " +
                     std::to_string(find("vertex")->count) + ", face " + std::to_string(face));
    }
    return static_cast<std::size_t>(value);
  }

  [[noreturn]] void cut(const PlyElement& e, std::uint64_t i) const {
    source_.refuse("is cut short or broken: its head says " + std::to_string(e.count) + " of '" + e.name +
                   "', number " + std::to_string(i) + " isn't there or has other entries");
  }

  /// Calls take(element, values of each property, number of the entry) for all entries.
  template <class F>
  void readBody(const F& take) {
    Lines lines(body_, source_, '\0');
    std::vector<std::vector<double>> entry;
    for (const PlyElement& e : elements_) {
      entry.resize(e.properties.size());
      for (std::uint64_t i = 0; i < e.count; ++i) {
        if (ascii_ && !lines.next()) cut(e, i);
        for (std::size_t p = 0; p < e.properties.size(); ++p) {
          const PlyProperty& property = e.properties[p];
          entry[p].clear();
          std::uint64_t values = 1;
          if (ascii_) {
            if (property.isList() && !toCount(lines.word(), values)) cut(e, i);
            for (std::uint64_t k = 0; k < values; ++k) {
              if (!toCoordinate(lines.word(), entry[p].emplace_back())) cut(e, i);
            }
            continue;
          }
          if (property.isList()) {
            const double count = takeBinary(property.count, e, i);
            if (!(count >= 0)) cut(e, i);
            values = static_cast<std::uint64_t>(count);
          }
          for (std::uint64_t k = 0; k < values; ++k) entry[p].push_back(takeBinary(property.value, e, i));
        }
        if (ascii_ && !lines.rest().empty()) cut(e, i);
        take(e, entry, i);
      }
    }
    if (ascii_ ? lines.next() : !body_.empty()) source_.refuse("goes on after its last element");
    if (ascii_) noteOpenEnd(source_);
  }

  double takeBinary(const Scalar& scalar, const PlyElement& e, std::uint64_t i) {
    if (body_.size() < scalar.bytes) cut(e, i);
    const double value = scalar.read(body_.data(), big_);
    body_.remove_prefix(scalar.bytes);
    return value;
  }

  const Source& source_;
  std::string_view body_;  ///< what is yet to be read
  bool ascii_ = false, big_ = false, camera_noted_ = false;
  std::vector<PlyElement> elements_;
  std::size_t xyz_[3] = {0, 0, 0};
};

}  // namespace

TriangleSoup readPly(const Source& source) {
  return Ply(source).readMesh();
}

Points readPlyPoints(const Source& source) {
  return Ply(source).readPoints();
}

bool plyHasFaces(const Source& source) {
  return Ply(source).hasFaces();
}

}  // namespace fcl_artic::meshes
