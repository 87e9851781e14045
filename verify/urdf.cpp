// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "meshes.h"
#include "readers.h"
#include "xml.h"

namespace verify {
namespace {

// ---- the robot, as the file has it

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

struct Place {
  Mat R;
  std::vector<double> t;
};
/// What moves along or about an axis: multiplier * q + offset, q being the variable of that name.
struct Driver {
  std::string variable;
  double multiplier = 1, offset = 0;
};
struct Step {
  Element::Kind kind;
  std::array<double, 3> axis;  // of slide and turn
  Driver driver;
  bool rounded = false;  // the axis is computed: within 2^-52 of what is meant
};
struct Collision {
  Place place;
  Geometry::Kind kind;
  std::vector<double> numbers;  // of a mesh: its scale
  std::string path;             // of a mesh
};
struct Link {
  std::string name;
  std::vector<Collision> collisions;
};
struct Joint {
  std::string name, type, parent, child;
  Place origin;
  std::array<double, 3> axis{1, 0, 0};
  bool mimics = false;
  Driver mimic;  // its variable: the joint that it follows
};

class Robot {
 public:
  Robot(const std::string& path, const std::map<std::string, std::string>& packages)
      : xml_(path), folder_(std::filesystem::absolute(path).parent_path()), packages_(packages) {
    const Xml::Element& robot = xml_.robot();
    xml_.only(robot, {"name", "version", "xmlns", "xsi:schemaLocation"}, {"link", "joint"},
              {"material", "gazebo", "transmission", "ros2_control", "sensor", "force_element", "frame", "bullet",
               "drake:collision_filter_group"});
    for (const Xml::Element* e = robot.FirstChildElement("link"); e; e = e->NextSiblingElement("link")) readLink(*e);
    for (const Xml::Element* e = robot.FirstChildElement("joint"); e; e = e->NextSiblingElement("joint")) readJoint(*e);
    std::set<std::string> children;
    for (const Joint& joint : joints) {
      for (const std::string& link : {joint.parent, joint.child})
        if (link_of_.count(link) == 0)
          throw BadInput("URDF: joint " + inQuotes(joint.name) + " names a link that is not there");
      if (!children.insert(joint.child).second)
        throw BadInput("URDF: link " + inQuotes(joint.child) + " is the child of two joints");
    }
    for (const Link& link : links)
      if (children.count(link.name) == 0) roots.push_back(link.name);
    if (roots.size() != 1) throw BadInput("URDF: there are " + std::to_string(roots.size()) + " root links");
  }

  std::vector<Link> links;
  std::vector<Joint> joints;
  std::vector<std::string> roots;

  bool has(const std::string& link) const { return link_of_.count(link) > 0; }

  /// What drives a joint of one variable: its own, or what it follows in the end. A chain's multipliers and offsets are
  /// put together in doubles, as `m1 (m2 q + c2) + c1 = (m1 m2) q + (m1 c2 + c1)`. Where the joint at the end is fixed,
  /// it stands at `offset`.
  struct Driven {
    Driver driver;
    bool still = false;
  };
  const Driven& drivenBy(std::size_t joint) {
    std::vector<std::size_t> chain;  // of joints that mimic, and of which it is not known yet
    std::size_t at = joint;
    while (joints[at].mimics && known_.count(at) == 0) {
      const Joint& j = joints[at];
      chain.push_back(at);
      if (chain.size() > joints.size()) throw BadInput("URDF: joint " + inQuotes(j.name) + " mimics itself in the end");
      const auto next = joint_of_.find(j.mimic.variable);
      if (next == joint_of_.end())
        throw BadInput("URDF: joint " + inQuotes(j.name) + " mimics " + inQuotes(j.mimic.variable) +
                       ", which is not there");
      at = next->second;
    }
    if (!chain.empty() && (joints[at].type == "planar" || joints[at].type == "floating"))
      throw BadInput("URDF: joint " + inQuotes(joints[joint].name) + " mimics one of several variables");
    Driven driven = known_.try_emplace(at, Driven{{joints[at].name, 1, 0}, joints[at].type == "fixed"}).first->second;
    for (std::size_t k = chain.size(); k-- > 0;) {  // doubles, each rounded
      const Driver& mimic = joints[chain[k]].mimic;
      const volatile double product = mimic.multiplier * driven.driver.multiplier,
                            moved = mimic.multiplier * driven.driver.offset;
      driven.driver.multiplier = product;
      driven.driver.offset = moved + mimic.offset;
      known_[chain[k]] = driven;
    }
    return known_.at(joint);
  }

 private:
  [[noreturn]] void twice(const Xml::Element& e) const { xml_.refuse(e, "the name is there twice"); }

  Place readPlace(const Xml::Element& parent) const {
    const Xml::Element* const origin = xml_.one(parent, "origin");
    if (origin != nullptr) xml_.only(*origin, {"xyz", "rpy"});
    return {fromAngles(xml_.numbers(origin, "rpy", "0 0 0", 3)), xml_.numbers(origin, "xyz", "0 0 0", 3)};
  }

  void readLink(const Xml::Element& e) {
    xml_.only(e, {"name", "type", "concave"}, {"collision"},
              {"visual", "inertial", "contact", "surface", "gravity", "kinematic", "sensor", "audio_source", "bullet",
               "self_filter"});
    Link link;
    link.name = xml_.attribute(e, "name");
    if (!link_of_.emplace(link.name, links.size()).second) twice(e);
    for (const Xml::Element* c = e.FirstChildElement("collision"); c; c = c->NextSiblingElement("collision")) {
      xml_.only(*c, {"name", "concave", "group", "mask"}, {"origin", "geometry"},
                {"material", "verbose", "contact_coefficients", "drake:proximity_properties"});
      Collision collision = readShape(*c);
      collision.place = readPlace(*c);
      link.collisions.push_back(std::move(collision));
    }
    links.push_back(std::move(link));
  }

  Collision readShape(const Xml::Element& parent) const {
    const Xml::Element* const geometry = xml_.one(parent, "geometry");
    if (geometry == nullptr) xml_.refuse(parent, "it has no <geometry>");
    xml_.only(*geometry, {}, {"box", "sphere", "cylinder", "capsule", "mesh"});
    const Xml::Element* const e = geometry->FirstChildElement();
    if (e == nullptr || e->NextSiblingElement() != nullptr) xml_.refuse(*geometry, "it has not one shape");
    const std::string kind = e->Name();
    Collision c;
    if (kind == "box") {
      xml_.only(*e, {"size"});
      c.kind = Geometry::box;
      c.numbers = xml_.numbers(e, "size", nullptr, 3);
    } else if (kind == "sphere") {
      xml_.only(*e, {"radius"});
      c.kind = Geometry::sphere;
      c.numbers = xml_.numbers(e, "radius", nullptr, 1);
    } else if (kind == "mesh") {
      xml_.only(*e, {"filename", "scale"});
      c.kind = Geometry::mesh;
      c.numbers = xml_.numbers(e, "scale", "1 1 1", 3);
      c.path = find(xml_.attribute(*e, "filename"));
    } else {
      xml_.only(*e, {"radius", "length"});
      c.kind = kind == "capsule" ? Geometry::capsule : Geometry::cylinder;
      c.numbers = {xml_.numbers(e, "radius", nullptr, 1)[0], xml_.numbers(e, "length", nullptr, 1)[0]};
    }
    return c;
  }

  void readJoint(const Xml::Element& e) {
    xml_.only(e, {"name", "type", "dont_collapse"}, {"parent", "child", "origin", "axis", "mimic"},
              {"limit", "dynamics", "safety_controller", "calibration", "controller_gains", "joint_properties",
               "traits", "hardwareInterface"});
    static const std::set<std::string> kTypes{"fixed", "revolute", "continuous", "prismatic", "planar", "floating"};
    Joint joint;
    joint.name = xml_.attribute(e, "name");
    joint.type = xml_.attribute(e, "type");
    if (kTypes.count(joint.type) == 0) xml_.refuse(e, "there is no type " + inQuotes(joint.type));
    if (!joint_of_.emplace(joint.name, joints.size()).second) twice(e);
    for (const char* end : {"parent", "child"}) {
      const Xml::Element* const link = xml_.one(e, end);
      if (link == nullptr) xml_.refuse(e, std::string("it has no <") + end + ">");
      xml_.only(*link, {"link"});
      (end[0] == 'p' ? joint.parent : joint.child) = xml_.attribute(*link, "link");
    }
    joint.origin = readPlace(e);
    if (const Xml::Element* const axis = xml_.one(e, "axis")) {
      xml_.only(*axis, {"xyz"});
      const std::vector<double> xyz = xml_.numbers(axis, "xyz", nullptr, 3);
      std::copy(xyz.begin(), xyz.end(), joint.axis.begin());
      if (joint.type != "fixed" && joint.type != "floating" && xyz == std::vector<double>(3, 0))
        xml_.refuse(*axis, "it is zero");
    }
    if (const Xml::Element* const mimic = xml_.one(e, "mimic")) {
      xml_.only(*mimic, {"joint", "multiplier", "offset"});
      joint.mimic = {xml_.attribute(*mimic, "joint"), xml_.numbers(mimic, "multiplier", "1", 1)[0],
                     xml_.numbers(mimic, "offset", "0", 1)[0]};
      joint.mimics = joint.type != "fixed";
      if (joint.type == "planar" || joint.type == "floating") xml_.refuse(*mimic, "the joint has several variables");
    }
    joints.push_back(std::move(joint));
  }

  /// file:///PATH or file://localhost/PATH, with %20 and the like decoded.
  static std::string fileOfUrl(const std::string& url) {
    std::string path = url.substr(7), decoded;
    if (path.rfind("localhost/", 0) == 0) path.erase(0, 9);
    for (std::size_t k = 0; k < path.size(); ++k) {
      if (path[k] != '%') {
        decoded += path[k];
        continue;
      }
      const std::string digits = path.substr(k + 1, 2);
      if (digits.size() != 2 || digits.find_first_not_of("0123456789abcdefABCDEF") != std::string::npos ||
          digits == "00")
        throw BadInput("'" + url + "': a % stands before two hexadecimal digits");
      decoded += static_cast<char>(std::stoi(digits, nullptr, 16));
      k += 2;
    }
    if (decoded.empty() || decoded[0] != '/') throw BadInput("'" + url + "' has no absolute path");
    return decoded;
  }

  std::string find(std::string name) const {
    namespace fs = std::filesystem;
    if (name.rfind("file://", 0) == 0) return fileOfUrl(name);
    if (name.rfind("package://", 0) != 0) {
      if (name.find("://") != std::string::npos) throw BadInput("'" + name + "' is neither file:// nor package://");
      return (folder_ / name).string();
    }
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

  const Xml xml_;
  const std::filesystem::path folder_;
  const std::map<std::string, std::string>& packages_;
  std::map<std::string, std::size_t> link_of_, joint_of_;
  std::map<std::size_t, Driven> known_;
};

// ---- and the world

/// Whether the numbers are that place: the rotation within 2^-49, so that it is among those that the claim is about;
/// the translation to the very bit.
bool isAt(const Place& place, const double numbers[12]) {
  for (std::size_t k = 0; k < 3; ++k)
    if (place.t[k] != numbers[9 + k]) return false;
  for (std::size_t k = 0; k < 9; ++k)
    if (bound(place.R[k] - constant(enclose(numbers[k]))) > Fix{kOne >> 49}) return false;
  return true;
}

/// Whether the unit vector along `axis` is one that the element is about: of a coordinate axis this very one, else one
/// within 2^-50 in each entry of the unit vector along the element's numbers.
/// @param off  how far that unit vector may be off what is meant, in each entry.
bool isAlong(const Element& e, const std::array<double, 3>& axis, Fix off) {
  if (isCoordinateAxis(e.axis)) {
    for (std::size_t k = 0; k < 3; ++k)
      if ((axis[k] > 0) != (e.axis[k] > 0) || (axis[k] < 0) != (e.axis[k] < 0)) return false;
    return true;
  }
  Fix meant[3], stated[3];
  unitVector(axis.data(), meant);
  unitVector(e.axis, stated);
  for (std::size_t k = 0; k < 3; ++k)
    if (abs(meant[k] - stated[k]) + ulps(4) + off > Fix{kOne >> kAxisBits}) return false;
  return true;
}

/// A planar joint's x and y: those of its frame, turned the shortest way that takes z to the axis n. That is
/// c I + [v]x + v v^T / (1 + c) with v = e_z x n and c = n_z; next to -z it is |v|^2 / (1 - c) in place of 1 + c.
std::array<std::array<double, 3>, 2> planeOf(const std::array<double, 3>& axis) {
  if (axis[0] == 0 && axis[1] == 0) return {{{1, 0, 0}, {0, axis[2] < 0 ? -1.0 : 1.0, 0}}};
  const double largest = std::max({std::fabs(axis[0]), std::fabs(axis[1]), std::fabs(axis[2])});
  const long double a = axis[0] / static_cast<long double>(largest), b = axis[1] / static_cast<long double>(largest),
                    z = axis[2] / static_cast<long double>(largest), length = std::sqrt(a * a + b * b + z * z);
  const long double x = -b / length, y = a / length, c = z / length;
  const long double k = c < 0 ? (1 - c) / (x * x + y * y) : 1 / (1 + c);
  const auto d = [](long double v) { return static_cast<double>(v); };
  return {{{d(c + k * x * x), d(k * x * y), d(-y)}, {d(k * x * y), d(c + k * y * y), d(x)}}};
}

class UrdfComparison {
 public:
  UrdfComparison(const World& world, Robot& robot, const Solids& solids)
      : world_(world), robot_(robot), solids_(solids), meshes_(world) {}

  Comparison run() {
    for (std::size_t v = 0; v < world_.variables.size(); ++v)
      if (!variable_of_.emplace(world_.variables[v], static_cast<int>(v)).second)
        different("the world has two variables of the name " + inQuotes(world_.variables[v]));
    for (std::size_t f = 1; f < world_.frames.size(); ++f)
      if (robot_.has(world_.frames[f].name)) frames_[world_.frames[f].name].push_back(static_cast<int>(f));
    bodies_.resize(world_.frames.size());
    for (std::size_t b = 0; b < world_.bodies.size(); ++b)
      if (world_.bodies[b].role == Role::link)
        bodies_[static_cast<std::size_t>(world_.bodies[b].frame)].push_back(static_cast<int>(b));
    for (const Link& link : robot_.links) frameOf(link.name);
    for (const std::string& link : solids_.links)
      if (!robot_.has(link)) different("link " + inQuotes(link) + ", whose meshes are solids, is not in the file");
    for (std::size_t j = 0; j < robot_.joints.size(); ++j) joint(j);
    for (const Link& l : robot_.links) link(l);
    nothingLeft();
    root();
    result_.notes.push_back("the file has " + std::to_string(robot_.links.size()) + " links, " +
                            std::to_string(robot_.joints.size()) + " joints and " + std::to_string(matched_) +
                            " collision geometries, as the world has");
    if (surfaces_ + solid_meshes_ > 0)
      result_.notes.push_back(std::to_string(surfaces_) +
                              " meshes of links are surfaces, of which what lies inside is not " + "checked, and " +
                              std::to_string(solid_meshes_) + " are solids");
    result_.notes.push_back("obstacles, and what links carry, are compared with no file");
    return std::move(result_);
  }

 private:
  void different(const std::string& what) {
    if (result_.differences.size() < 1000) result_.differences.push_back(what);
  }

  /// The one frame of that name; -1: there is none, or several, which is said once.
  int frameOf(const std::string& link) {
    const auto found = frames_.find(link);
    if (found != frames_.end() && found->second.size() == 1) return found->second[0];
    if (said_.insert(link).second)
      different("link " + inQuotes(link) + " has " + (found == frames_.end() ? "no frame" : "several frames") +
                " in the world");
    return -1;
  }

  void joint(std::size_t number) {
    const Joint& j = robot_.joints[number];
    const int parent = frameOf(j.parent), child = frameOf(j.child);
    if (parent < 0 || child < 0) return;
    const Frame& frame = world_.frames[static_cast<std::size_t>(child)];
    const auto wrong = [&](const std::string& why) { different("joint " + inQuotes(j.name) + ": " + why); };
    if (frame.parent != parent) return wrong("the child's frame has another parent");
    if (!isAt(j.origin, frame.numbers)) wrong("another origin");
    std::vector<Step> steps;
    if (j.type == "floating") {
      const char* const names[] = {"/trans_x", "/trans_y", "/trans_z"};
      for (std::size_t k = 0; k < 3; ++k) {
        std::array<double, 3> axis{};
        axis[k] = 1;
        steps.push_back({Element::slide, axis, {j.name + names[k], 1, 0}});
      }
      steps.push_back({Element::rotate, {}, {j.name + "/rot_x", 1, 0}});
    } else if (j.type == "planar") {
      const auto plane = planeOf(j.axis);
      steps = {{Element::slide, plane[0], {j.name + "/x", 1, 0}, true},
               {Element::slide, plane[1], {j.name + "/y", 1, 0}, true},
               {Element::turn, j.axis, {j.name + "/theta", 1, 0}}};
      if (j.axis[0] != 0 || j.axis[1] != 0)
        result_.notes.push_back(
            "joint " + inQuotes(j.name) +
            " is planar: its x and y are those of its frame, turned the shortest way that takes z to the axis");
    } else if (j.type != "fixed") {
      const Robot::Driven& driven = robot_.drivenBy(number);
      if (!driven.still)
        steps = {{j.type == "prismatic" ? Element::slide : Element::turn, j.axis, driven.driver}};
      else if (driven.driver.offset != 0)
        return wrong("it mimics a fixed joint and stands at another place than 0: that is not compared");
    }
    if (frame.elements.size() != steps.size()) return wrong("another kind of motion");
    for (std::size_t k = 0; k < steps.size(); ++k) step(steps[k], frame.elements[k], j.mimics, wrong);
  }

  template <class Wrong>
  void step(const Step& meant, const Element& e, bool mimics, const Wrong& wrong) {
    if (e.kind != meant.kind) return wrong("another kind of motion");
    const bool rotate = e.kind == Element::rotate;
    if (!rotate && !isAlong(e, meant.axis, Fix{meant.rounded ? kOne >> 52 : 0})) wrong("another axis");
    if (!rotate && (e.multiplier != meant.driver.multiplier || e.offset != meant.driver.offset))
      wrong("another multiplier or offset");
    const char* const names[] = {"x", "y", "z"};
    for (int k = 0; k < (rotate ? 3 : 1); ++k) {
      const int v = e.variable + k;
      std::string name = meant.driver.variable;
      if (rotate) name.back() = names[k][0];
      if (world_.variables[static_cast<std::size_t>(v)] != name) return wrong("another variable");
      if (!driven_.insert(v).second && !mimics && owned_.count(v) > 0) wrong("its variable is that of another joint");
      if (!mimics) owned_.insert(v);
    }
  }

  void link(const Link& l) {
    const int frame = frameOf(l.name);
    if (frame < 0) return;
    std::vector<int>& bodies = bodies_[static_cast<std::size_t>(frame)];
    // Most writers keep the file's order; where one does not, each body is looked for.
    std::vector<char> used(bodies.size(), 0);
    std::vector<std::size_t> open;
    for (std::size_t k = 0; k < l.collisions.size(); ++k)
      if (k >= bodies.size() || !(used[k] = isBody(l, l.collisions[k], bodies[k]))) open.push_back(k);
    for (const std::size_t k : open) {
      std::size_t b = 0;
      while (b < bodies.size() && (used[b] || !isBody(l, l.collisions[k], bodies[b]))) ++b;
      if (b == bodies.size())
        different("link " + inQuotes(l.name) + ": no body of the world is its collision geometry " + std::to_string(k) +
                  why_);
      else
        used[b] = 1;
    }
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      if (used[b])
        ++matched_;
      else
        different(world_.describe(bodies[b]) + " is not in the file");
    }
    bodies.clear();
  }

  bool isBody(const Link& link, const Collision& c, int body) {
    if (++pairs_ > 2000000)
      throw BadInput("URDF: a link has many collision geometries in another order than the world: not compared");
    const Body& b = world_.bodies[static_cast<std::size_t>(body)];
    const Geometry& g = world_.geometries[static_cast<std::size_t>(b.geometry)];
    why_.clear();
    if (b.name != link.name || g.kind != c.kind || !isAt(c.place, b.numbers)) return false;
    if (c.kind != Geometry::mesh) return g.numbers == c.numbers;
    if (!g.solid && (solids_.all || solids_.links.count(link.name) > 0)) {
      why_ = ", as a solid";
      return false;
    }
    std::size_t missing = 0;
    if (!meshes_.same(g, b.geometry, c.path, c.numbers, missing)) return false;
    if (missing > 0 && noted_.insert(c.path).second)
      result_.notes.push_back("'" + c.path + "': " + std::to_string(missing) +
                              " triangles without area are not in the world, which lie on edges of others");
    ++(g.solid ? solid_meshes_ : surfaces_);
    return true;
  }

  /// Frames that are not the robot's do not move as its joints do, obstacles do not move with it, and no body of a link
  /// is left over.
  void nothingLeft() {
    std::vector<char> robots(world_.frames.size(), 0), below(world_.frames.size(), 0);
    for (const auto& [name, frames] : frames_)
      for (const int f : frames) robots[static_cast<std::size_t>(f)] = 1;
    for (std::size_t f = 1; f < world_.frames.size(); ++f) {
      const Frame& frame = world_.frames[f];
      below[f] = robots[f] || below[static_cast<std::size_t>(frame.parent)];
      const bool is_root = robots[f] && frame.name == robot_.roots[0];
      if (robots[f] && !is_root) continue;
      for (const Element& e : frame.elements)
        for (int k = 0; k < (e.kind == Element::rotate ? 3 : 1); ++k)
          if (driven_.count(e.variable + k) > 0)
            different("the frame " + inQuotes(frame.name) + ", which is no joint's, moves with the variable " +
                      inQuotes(world_.variables[static_cast<std::size_t>(e.variable + k)]) + " of a joint");
      for (const int b : bodies_[f]) different(world_.describe(b) + " is not in the file");
    }
    for (const int b : bodies_[0]) different(world_.describe(b) + " is not in the file");
    for (std::size_t b = 0; b < world_.bodies.size(); ++b) {
      const Body& body = world_.bodies[b];
      const auto f = static_cast<std::size_t>(body.frame);
      if (body.role == Role::obstacle && below[f])
        different(world_.describe(static_cast<int>(b)) + " is in a frame of the robot");
      if (body.role == Role::carried && !robots[f])
        different(world_.describe(static_cast<int>(b)) + " is carried by no link of the robot");
    }
  }

  void root() {
    const std::string& name = robot_.roots[0];
    const int f = frameOf(name);
    if (f < 0) return;
    bool identity = true;
    std::set<std::string> variables;
    for (int up = f; up > 0; up = world_.frames[static_cast<std::size_t>(up)].parent) {
      const Frame& frame = world_.frames[static_cast<std::size_t>(up)];
      if (up != f && robot_.has(frame.name)) different("the root link " + inQuotes(name) + " hangs on another link");
      for (int k = 0; k < 12; ++k) identity = identity && frame.numbers[k] == (k < 9 && k % 4 == 0 ? 1.0 : 0.0);
      for (const Element& e : frame.elements)
        for (int k = 0; k < (e.kind == Element::rotate ? 3 : 1); ++k)
          variables.insert(world_.variables[static_cast<std::size_t>(e.variable + k)]);
    }
    std::string text =
        "root link " + inQuotes(name) + (variables.empty() ? " stands still" : " moves") + " in the world";
    if (!identity) text += ", not at the world's origin";
    for (const std::string& variable : variables)
      text += (variable == *variables.begin() ? ", by " : ", ") + inQuotes(variable);
    result_.notes.push_back(text);
  }

  const World& world_;
  Robot& robot_;
  const Solids& solids_;
  std::map<std::string, std::vector<int>> frames_;  // of the robot's links
  std::map<std::string, int> variable_of_;
  std::vector<std::vector<int>> bodies_;  // of role link, by frame; those that are matched are taken out
  std::set<int> driven_, owned_;          // variables of joints; of joints that do not mimic
  std::set<std::string> said_, noted_;
  std::size_t matched_ = 0, pairs_ = 0, surfaces_ = 0, solid_meshes_ = 0;
  std::string why_;
  MeshComparison meshes_;
  Comparison result_;
};

}  // namespace

std::string readFile(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in || std::filesystem::is_directory(path)) throw BadInput("can't open '" + path + "'");
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

Comparison compareWithUrdf(const World& world, const std::string& path,
                           const std::map<std::string, std::string>& packages, const Solids& solids) {
  Robot robot(path, packages);
  return UrdfComparison(world, robot, solids).run();
}

}  // namespace verify
