// SPDX-License-Identifier: BSD-3-Clause
#include "readers.h"

#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

namespace verify {
namespace {

using tinyxml2::XMLElement;

/// Numbers of a text, each the nearest double. (The program runs in C's own locale.)
std::vector<double> numbersOf(const std::string& text) {
  std::vector<double> numbers;
  for (const char* at = text.c_str();;) {
    char* end = nullptr;
    const double x = std::strtod(at, &end);
    if (end == at) break;
    if (!std::isfinite(x)) throw BadInput("'" + text.substr(0, 60) + "' has a number that is not finite");
    numbers.push_back(x);
    at = end;
  }
  return numbers;
}
std::string attribute(const XMLElement* e, const char* name, const char* otherwise = "") {
  const char* value = e == nullptr ? nullptr : e->Attribute(name);
  return value == nullptr ? otherwise : value;
}
std::vector<double> attributeNumbers(const XMLElement* e, const char* name, const char* otherwise, std::size_t count) {
  std::vector<double> numbers = numbersOf(attribute(e, name, otherwise));
  if (numbers.size() != count)
    throw BadInput(std::string("an attribute '") + name + "' has not " + std::to_string(count) + " numbers");
  return numbers;
}

/// Rz(yaw) Ry(pitch) Rx(roll), each entry enclosed.
Mat fromAngles(const std::vector<double>& rpy) {
  Tm s[3], c[3];
  for (std::size_t k = 0; k < 3; ++k) sineCosine(constant(enclose(rpy[k])), s[k], c[k]);
  return {c[2] * c[1],
          c[2] * s[1] * s[0] - s[2] * c[0],
          c[2] * s[1] * c[0] + s[2] * s[0],
          s[2] * c[1],
          s[2] * s[1] * s[0] + c[2] * c[0],
          s[2] * s[1] * c[0] - c[2] * s[0],
          -s[1],
          c[1] * s[0],
          c[1] * c[0]};
}
bool within(const Tm& a, const Tm& b, int bits) {
  return bound(a - b) <= Fix{kOne >> bits};
}

/// Whether the numbers are the pose of an <origin>: the rotation within 2^-49, so that it is among those that the claim
/// is about; the translation to the very bit.
bool isOrigin(const XMLElement* origin, const double numbers[12]) {
  const Mat R = fromAngles(attributeNumbers(origin, "rpy", "0 0 0", 3));
  const std::vector<double> t = attributeNumbers(origin, "xyz", "0 0 0", 3);
  for (std::size_t k = 0; k < 9; ++k)
    if (!within(R[k], constant(enclose(numbers[k])), 49)) return false;
  return t[0] == numbers[9] && t[1] == numbers[10] && t[2] == numbers[11];
}

/// Whether element e turns or slides along the axis: unit vectors within 2^-49.
bool isAlong(const Element& e, const std::vector<double>& axis, bool across = false) {
  Fix unit[3];
  unitVector(axis.data(), unit);
  Tm product;
  for (std::size_t k = 0; k < 3; ++k) {
    if (!across && !within(e.unit[k], constant(unit[k]), 49)) return false;
    product = product + e.unit[k] * constant(unit[k]);
  }
  return !across || bound(product) <= Fix{kOne >> 49};
}

// Triangles as sorted corners, so that order and orientation do not count: both have no meaning for the claim.
using Triangle = std::array<std::array<double, 3>, 3>;
std::vector<Triangle> sorted(const std::vector<double>& corners) {
  std::vector<Triangle> all(corners.size() / 9);
  for (std::size_t t = 0; t < all.size(); ++t) {
    for (std::size_t k = 0; k < 9; ++k) all[t][k / 3][k % 3] = corners[9 * t + k] + 0.0;  // -0 becomes 0
    std::sort(all[t].begin(), all[t].end());
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}
/// Whether a triangle is as good as a segment: its area is below 2^-40 of its longest edge's square.
bool hasNoArea(const Triangle& t) {
  double longest = 0, a[3], b[3], area = 0;
  for (int k = 0; k < 3; ++k) {
    a[k] = t[1][static_cast<std::size_t>(k)] - t[0][static_cast<std::size_t>(k)];
    b[k] = t[2][static_cast<std::size_t>(k)] - t[0][static_cast<std::size_t>(k)];
    longest = std::max({longest, std::fabs(a[k]), std::fabs(b[k]), std::fabs(a[k] - b[k])});
  }
  for (int k = 0; k < 3; ++k)
    area = std::max(area, std::fabs(a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3]));
  return area <= std::ldexp(longest * longest, -40);
}

class Urdf {
 public:
  Urdf(const World& world, const std::string& path, const std::map<std::string, std::string>& packages)
      : world_(world), folder_(std::filesystem::absolute(path).parent_path()), packages_(packages) {
    const std::string text = readFile(path);
    if (document_.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS ||
        !(robot_ = document_.FirstChildElement("robot")))
      throw BadInput("'" + path + "' is no URDF");
  }

  Comparison run() {
    for (std::size_t f = 0; f < world_.frames.size(); ++f)
      frames_[world_.frames[f].name].push_back(static_cast<int>(f));
    frames_["world"].erase(std::remove(frames_["world"].begin(), frames_["world"].end(), 0), frames_["world"].end());
    for (std::size_t b = 0; b < world_.bodies.size(); ++b)
      if (world_.bodies[b].role == Role::link) ++link_bodies_;
    std::set<std::string> variables;
    for (const std::string& variable : world_.variables)
      if (!variables.insert(variable).second) different("the world has two variables of the name '" + variable + "'");
    std::set<std::string> children;
    std::size_t joints = 0, links = 0;
    for (const XMLElement* j = robot_->FirstChildElement("joint"); j != nullptr; j = j->NextSiblingElement("joint")) {
      if (!children.insert(attribute(j->FirstChildElement("child"), "link")).second)
        different("a link is the child of two joints in the file");
      joint(*j);
      ++joints;
    }
    for (const XMLElement* l = robot_->FirstChildElement("link"); l != nullptr; l = l->NextSiblingElement("link")) {
      const std::string name = attribute(l, "name");
      link(*l);
      ++links;
      if (children.count(name) == 0) root(name);
    }
    result_.notes.push_back("the file has " + std::to_string(links) + " links, " + std::to_string(joints) +
                            " joints and " + std::to_string(matched_) + " collision geometries; the world has " +
                            std::to_string(link_bodies_ - matched_) + " more bodies of links");
    return result_;
  }

 private:
  void different(const std::string& what) { result_.differences.push_back(what); }
  int frameOf(const std::string& link) {
    const std::vector<int>& all = frames_[link];
    if (all.size() == 1) return all[0];
    different("link '" + link + "' has " + (all.empty() ? "no frame" : "several frames") + " in the world");
    return -1;
  }

  void root(const std::string& name) {
    const int f = frameOf(name);
    if (f < 0) return;
    const Frame& frame = world_.frames[f];
    bool still = true;
    for (int up = f; up > 0; up = world_.frames[up].parent) still = still && world_.frames[up].elements.empty();
    std::string text = "root link '" + name + "' " + (still ? "stands still" : "moves") + " in the world";
    bool identity = frame.parent == 0;
    for (int k = 0; k < 12; ++k) identity = identity && frame.numbers[k] == (k < 9 && k % 4 == 0 ? 1.0 : 0.0);
    if (!identity) text += ", not at the world's origin";
    result_.notes.push_back(text);
  }

  /// Whether the elements of a planar or floating joint move by variables of their own, as they are.
  template <class Wrong>
  void own(const std::vector<Element>& elements, const Wrong& wrong) {
    for (const Element& e : elements) {
      for (int k = 0; k < (e.kind == Element::rotate ? 3 : 1); ++k)
        if (!used_.insert(e.variable + k).second) wrong("its variables move something else, too");
      if (e.kind != Element::rotate && (e.multiplier != 1 || e.offset != 0)) wrong("another multiplier or offset");
    }
  }

  void joint(const XMLElement& j) {
    const std::string name = attribute(&j, "name"), type = attribute(&j, "type");
    const int parent = frameOf(attribute(j.FirstChildElement("parent"), "link"));
    const int child = frameOf(attribute(j.FirstChildElement("child"), "link"));
    if (parent < 0 || child < 0) return;
    const Frame& frame = world_.frames[child];
    const auto wrong = [&](const std::string& why) { different("joint '" + name + "': " + why); };
    if (frame.parent != parent) return wrong("the child's frame has another parent");
    if (!isOrigin(j.FirstChildElement("origin"), frame.numbers)) wrong("another origin");
    const std::vector<Element>& e = frame.elements;
    if (type == "fixed") {
      if (!e.empty()) wrong("it is fixed, and moves in the world");
      return;
    }
    if (type == "floating") {
      bool right = e.size() == 4 && e[3].kind == Element::rotate;
      for (std::size_t k = 0; right && k < 3; ++k) {
        std::vector<double> axis(3);
        axis[k] = 1;
        right = e[k].kind == Element::slide && isAlong(e[k], axis) && e[k].multiplier == 1 && e[k].offset == 0;
      }
      if (!right) return wrong("it is floating, and not so in the world");
      own(e, wrong);
      return;
    }
    const std::vector<double> axis = attributeNumbers(j.FirstChildElement("axis"), "xyz", "1 0 0", 3);
    const bool slides = type == "prismatic", planar = type == "planar";
    if (!slides && !planar && type != "revolute" && type != "continuous")
      return wrong("there is no type '" + type + "'");
    if (planar) {
      if (e.size() != 3 || e[0].kind != Element::slide || e[1].kind != Element::slide || e[2].kind != Element::turn ||
          !isAlong(e[0], axis, true) || !isAlong(e[1], axis, true) || !isAlong(e[2], axis) ||
          !isAlong(e[0], {e[1].axis[0], e[1].axis[1], e[1].axis[2]}, true))
        return wrong("it is planar, and not so in the world");
      own(e, wrong);
      return;
    }
    if (e.size() != 1 || e[0].kind != (slides ? Element::slide : Element::turn)) return wrong("another kind of motion");
    if (!isAlong(e[0], axis)) wrong("another axis");
    const XMLElement* mimic = j.FirstChildElement("mimic");
    const std::string variable = mimic == nullptr ? name : attribute(mimic, "joint");
    const double multiplier = mimic == nullptr ? 1 : attributeNumbers(mimic, "multiplier", "1", 1)[0];
    const double offset = mimic == nullptr ? 0 : attributeNumbers(mimic, "offset", "0", 1)[0];
    if (world_.variables[static_cast<std::size_t>(e[0].variable)] != variable) wrong("another variable");
    if (e[0].multiplier != multiplier || e[0].offset != offset) wrong("another multiplier or offset");
    if (mimic == nullptr && !used_.insert(e[0].variable).second) wrong("its variable moves something else, too");
  }

  void link(const XMLElement& l) {
    const std::string name = attribute(&l, "name");
    const int frame = frameOf(name);
    if (frame < 0) return;
    std::vector<int> bodies;
    for (std::size_t b = 0; b < world_.bodies.size(); ++b) {
      const Body& body = world_.bodies[b];
      if (body.role == Role::link && body.name == name && body.frame == frame) bodies.push_back(static_cast<int>(b));
    }
    int number = 0;
    for (const XMLElement* c = l.FirstChildElement("collision"); c != nullptr;
         c = c->NextSiblingElement("collision"), ++number) {
      const auto body = std::find_if(bodies.begin(), bodies.end(), [&](int b) {
        return isOrigin(c->FirstChildElement("origin"), world_.bodies[static_cast<std::size_t>(b)].numbers) &&
               isGeometry(c->FirstChildElement("geometry"), world_.bodies[static_cast<std::size_t>(b)].geometry);
      });
      if (body == bodies.end()) {
        different("link '" + name + "': no body of the world is its collision geometry " + std::to_string(number));
      } else {
        bodies.erase(body);
        ++matched_;
      }
    }
    if (!bodies.empty()) different("link '" + name + "': the world has a body of it that the file has not");
  }

  bool isGeometry(const XMLElement* geometry, int number) {
    const Geometry& g = world_.geometries[static_cast<std::size_t>(number)];
    const XMLElement* e = geometry == nullptr ? nullptr : geometry->FirstChildElement();
    if (e == nullptr) return false;
    const std::string kind = e->Name();
    if (kind == "box") return g.kind == Geometry::box && attributeNumbers(e, "size", "", 3) == g.numbers;
    if (kind == "sphere") return g.kind == Geometry::sphere && attributeNumbers(e, "radius", "", 1) == g.numbers;
    if (kind == "cylinder" || kind == "capsule")
      return g.kind == (kind == "capsule" ? Geometry::capsule : Geometry::cylinder) &&
             attributeNumbers(e, "radius", "", 1)[0] == g.numbers[0] &&
             attributeNumbers(e, "length", "", 1)[0] == g.numbers[1];
    return kind == "mesh" && g.kind == Geometry::mesh &&
           isMesh(find(attribute(e, "filename")), attributeNumbers(e, "scale", "1 1 1", 3), g);
  }

  bool isMesh(const std::string& path, const std::vector<double>& scale, const Geometry& g) {
    std::vector<double> corners;
    for (const std::uint32_t v : g.triangles)
      for (std::size_t k = 0; k < 3; ++k) corners.push_back(g.vertices[3 * static_cast<std::size_t>(v) + k]);
    const std::vector<Triangle> stated = sorted(corners);
    auto& file = meshes_[path];
    if (file.empty()) file = readMesh(path);
    corners = file;
    for (std::size_t k = 0; k < corners.size(); ++k) corners[k] *= scale[k % 3];
    const std::vector<Triangle> read = sorted(corners);
    if (!std::includes(read.begin(), read.end(), stated.begin(), stated.end())) return false;
    std::vector<Triangle> missing;
    std::set_difference(read.begin(), read.end(), stated.begin(), stated.end(), std::back_inserter(missing));
    if (!std::all_of(missing.begin(), missing.end(), hasNoArea)) return false;
    if (!missing.empty())
      result_.notes.push_back("'" + path + "': " + std::to_string(missing.size()) +
                              " triangles without area are not in the world");
    return true;
  }

  std::string find(std::string name) const {
    namespace fs = std::filesystem;
    if (name.rfind("file://", 0) == 0) return name.substr(7);
    if (name.rfind("package://", 0) != 0) return (folder_ / name).string();
    name = name.substr(10);
    const std::size_t slash = name.find('/');
    const std::string package = name.substr(0, slash), rest = slash == std::string::npos ? "" : name.substr(slash + 1);
    const auto given = packages_.find(package);
    if (given != packages_.end()) return (fs::path(given->second) / rest).string();
    for (fs::path up = folder_;; up = up.parent_path()) {
      for (const fs::path& candidate : {up / package / rest, up / rest})
        if ((candidate != up / rest || up.filename() == package) && fs::exists(candidate)) return candidate.string();
      if (up == up.parent_path()) break;
    }
    throw BadInput("package '" + package + "' is not found; name its folder: --package " + package + "=FOLDER");
  }

  const World& world_;
  const std::filesystem::path folder_;
  const std::map<std::string, std::string>& packages_;
  tinyxml2::XMLDocument document_;
  const XMLElement* robot_ = nullptr;
  std::map<std::string, std::vector<int>> frames_;
  std::map<std::string, std::vector<double>> meshes_;
  std::set<int> used_;  // variables of joints that do not mimic
  std::size_t link_bodies_ = 0, matched_ = 0;
  Comparison result_;
};

std::vector<double> readStl(const std::string& bytes) {
  std::vector<double> corners;
  std::uint32_t count = 0;
  if (bytes.size() >= 84) {
    for (std::size_t k = 0; k < 4; ++k)
      count |= static_cast<std::uint32_t>(static_cast<std::uint8_t>(bytes[80 + k])) << 8 * k;
    if (bytes.size() >= 84 + 50 * static_cast<std::uint64_t>(count) && count > 0) {  // normal, 3 corners, 2 bytes
      for (std::size_t t = 0; t < count; ++t) {
        for (std::size_t k = 0; k < 9; ++k) {
          std::uint32_t bits = 0;
          for (std::size_t b = 0; b < 4; ++b)
            bits |= static_cast<std::uint32_t>(static_cast<std::uint8_t>(bytes[84 + 50 * t + 12 + 4 * k + b])) << 8 * b;
          float x = 0;
          std::memcpy(&x, &bits, sizeof x);
          if (!std::isfinite(x)) throw BadInput("an STL file has a number that is not finite");
          corners.push_back(x);
        }
      }
      return corners;
    }
  }
  std::string text = bytes;
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  for (std::size_t at = text.find("vertex"); at != std::string::npos; at = text.find("vertex", at)) {
    at += 6;
    const std::vector<double> x = numbersOf(text.substr(at, 120));
    if (x.size() < 3) throw BadInput("an STL file has a vertex without three numbers");
    corners.insert(corners.end(), x.begin(), x.begin() + 3);
  }
  return corners;
}

std::vector<double> readObj(const std::string& text) {
  std::vector<double> vertices, corners;
  for (std::size_t at = 0, end; at < text.size(); at = end + 1) {
    end = std::min(text.find('\n', at), text.size());
    std::string line = text.substr(at, end - at);
    line.erase(0, std::min(line.find_first_not_of(" \t"), line.size()));
    if (line.size() > 1 && line[1] == '\t') line[1] = ' ';
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
    if (!line.empty() && line[0] != '#' && line.back() == '\\')
      throw BadInput("an OBJ file has a line that goes on in the next one");
    if (line.rfind("v ", 0) == 0) {
      const std::vector<double> x = numbersOf(line.substr(2));
      if (x.size() < 3) throw BadInput("an OBJ file has a vertex without three numbers");
      vertices.insert(vertices.end(), x.begin(), x.begin() + 3);
    } else if (line.rfind("f ", 0) == 0) {
      std::vector<std::size_t> face;
      for (std::size_t k = 1; k < line.size();) {
        const std::size_t word = line.find_first_not_of(" \t\r", k);
        if (word == std::string::npos) break;
        const long index = std::strtol(line.c_str() + word, nullptr, 10), n = static_cast<long>(vertices.size() / 3);
        if (index == 0 || index > n || index < -n)
          throw BadInput("an OBJ file has a face of a vertex that is not there");
        face.push_back(static_cast<std::size_t>(index > 0 ? index - 1 : n + index));
        k = std::min(line.find_first_of(" \t\r", word), line.size());
      }
      for (std::size_t k = 2; k < face.size(); ++k)
        for (const std::size_t v : {face[0], face[k - 1], face[k]})
          corners.insert(corners.end(), vertices.begin() + static_cast<std::ptrdiff_t>(3 * v),
                         vertices.begin() + static_cast<std::ptrdiff_t>(3 * v + 3));
    }
  }
  return corners;
}

}  // namespace

std::string readFile(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in || std::filesystem::is_directory(path)) throw BadInput("can't open '" + path + "'");
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

std::vector<double> readMesh(const std::string& path) {
  std::string ending = path.substr(std::min(path.rfind('.'), path.size()));
  for (char& c : ending)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  std::vector<double> corners;
  if (ending == ".stl") {
    corners = readStl(readFile(path));
  } else if (ending == ".obj") {
    corners = readObj(readFile(path));
  } else {
    throw BadInput("'" + path + "' is neither STL nor OBJ, the formats that are compared");
  }
  if (corners.empty() || corners.size() % 9 != 0) throw BadInput("'" + path + "' has no whole triangles");
  return corners;
}

Comparison compareWithUrdf(const World& world, const std::string& path,
                           const std::map<std::string, std::string>& packages) {
  return Urdf(world, path, packages).run();
}

// MoveIt's rules: a pair is disabled by name, or where a link is disabled by default and the pair is not enabled.
Comparison compareWithSrdf(const World& world, const std::string& path) {
  const std::string text = readFile(path);
  tinyxml2::XMLDocument document;
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) throw BadInput("'" + path + "' is no SRDF");
  const XMLElement* robot = document.FirstChildElement("robot");
  if (robot == nullptr) throw BadInput("'" + path + "' is no SRDF");
  std::set<std::pair<std::string, std::string>> disabled, enabled;
  std::set<std::string> defaults;
  for (const XMLElement* e = robot->FirstChildElement(); e != nullptr; e = e->NextSiblingElement()) {
    const std::string kind = e->Name();
    if (kind == "disable_default_collisions") defaults.insert(attribute(e, "link"));
    if (kind != "disable_collisions" && kind != "enable_collisions") continue;
    const std::string a = attribute(e, "link1"), b = attribute(e, "link2");
    (kind[0] == 'd' ? disabled : enabled).insert({std::min(a, b), std::max(a, b)});
  }
  Comparison result;
  std::set<std::string> links, others;
  for (const Body& body : world.bodies) (body.role == Role::link ? links : others).insert(body.name);
  for (const std::string& name : others) links.erase(name);  // the SRDF's word is about links
  std::size_t found = 0;
  for (const auto& [pair, reason] : world.unchecked) {
    if (reason != Reason::allowed) continue;
    const std::string &x = world.names[static_cast<std::size_t>(pair.first)],
                      &y = world.names[static_cast<std::size_t>(pair.second)];
    const std::pair<std::string, std::string> key(std::min(x, y), std::max(x, y));
    const bool by_default = (defaults.count(x) > 0 || defaults.count(y) > 0) && enabled.count(key) == 0;
    if (links.count(x) > 0 && links.count(y) > 0 && (disabled.count(key) > 0 || by_default)) {
      ++found;
    } else {
      result.differences.push_back("the world allows '" + x + "' and '" + y + "' to touch, the SRDF does not");
    }
  }
  result.notes.push_back(std::to_string(found) + " pairs of names that the world allows are in the SRDF");
  return result;
}

}  // namespace verify
