// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "readers.h"
#include "report.h"
#include "robot.h"
#include "shapes.h"

namespace verify {
namespace {

struct Step {
  Element::Kind kind;
  std::array<double, 3> axis;  // of slide and turn
  Driver driver;
  bool rounded = false;  // the axis is computed: within 2^-52 of the one that is meant
};

/// Whether the unit vector along `axis` is one that the element is about. For a coordinate axis this is the very
/// vector. For any other axis it is a vector within 2^-50, in each entry, of the unit vector along the element's
/// numbers.
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

/// The endings that a joint adds to the names of its variables.
std::vector<const char*> endingsOf(const Joint& j) {
  if (j.type == "fixed" || j.mimics) return {};
  if (j.type == "planar") return {"/x", "/y", "/theta"};
  if (j.type != "floating") return {""};
  return {"/trans_x", "/trans_y", "/trans_z", "/rot_x", "/rot_y", "/rot_z", "/rot_w"};
}

/// How a floating joint of that name moves.
std::vector<Step> freely(const std::string& joint) {
  return {{Element::slide, {1, 0, 0}, {joint + "/trans_x", 1, 0}},
          {Element::slide, {0, 1, 0}, {joint + "/trans_y", 1, 0}},
          {Element::slide, {0, 0, 1}, {joint + "/trans_z", 1, 0}},
          {Element::rotate, {}, {joint + "/rot_x", 1, 0}}};
}

class UrdfComparison {
 public:
  UrdfComparison(const World& world, Robot& robot, const Solids& solids, const std::vector<double>& base)
      : world_(world), robot_(robot), base_(base), shapes_(world, solids) {}

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
    for (const Joint& j : robot_.joints)
      for (const char* ending : endingsOf(j)) result_.variables.push_back(j.name + ending);
    for (const Link& link : robot_.links) frameOf(link.name);
    for (std::size_t j = 0; j < robot_.joints.size(); ++j) joint(j);
    for (const Link& l : robot_.links) link(l);
    nothingLeft();
    root();
    result_.notes.push_back("the file has " + counted(robot_.links.size(), "link") + ", " +
                            counted(robot_.joints.size(), "joint") + " and " +
                            counted(matched_, "collision geometry", "collision geometries") + ", as the world has");
    shapes_.note("links", result_);
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
      steps = freely(j.name);
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
    compareSteps(steps, frame, j.mimics, wrong);
  }

  template <class Wrong>
  void compareSteps(const std::vector<Step>& steps, const Frame& frame, bool mimics, const Wrong& wrong) {
    if (frame.elements.size() != steps.size()) return wrong("another kind of motion");
    for (std::size_t k = 0; k < steps.size(); ++k) step(steps[k], frame.elements[k], mimics, wrong);
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
    // Most writers keep the file's order. If one does not, each body is searched for.
    std::vector<char> used(bodies.size(), 0);
    std::vector<std::size_t> open;
    for (std::size_t k = 0; k < l.collisions.size(); ++k)
      if (k >= bodies.size() || !(used[k] = isBody(l, l.collisions[k], bodies[k]))) open.push_back(k);
    for (const std::size_t k : open) {
      std::size_t b = 0;
      while (b < bodies.size() && (used[b] || !isBody(l, l.collisions[k], bodies[b]))) ++b;
      if (b == bodies.size())
        different("link " + inQuotes(l.name) + ": no body of the world is its collision geometry " + std::to_string(k) +
                  shapes_.why());
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
    return b.name == link.name && isAt(c.place, b.numbers) && shapes_.same(c, {link.name}, body);
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
      const bool is_root = robots[f] && frame.name == robot_.root;
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
    const std::string& name = robot_.root;
    const int f = frameOf(name);
    if (f < 0) return;
    static constexpr double kIdentity[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
    bool identity = true;
    std::set<std::string> variables;
    const auto wrong = [&](const std::string& why) {
      different("the root link " + inQuotes(name) + " moves, which neither the file nor --base says (" + why + ")");
    };
    for (int up = f; up > 0; up = world_.frames[static_cast<std::size_t>(up)].parent) {
      const Frame& frame = world_.frames[static_cast<std::size_t>(up)];
      if (up != f && robot_.has(frame.name)) different("the root link " + inQuotes(name) + " hangs on another link");
      const bool here = std::equal(std::begin(kIdentity), std::end(kIdentity), frame.numbers);
      identity = identity && here;
      // A writer puts the base's pose into one frame, the root's own.
      if (!base_.empty() && !(up == f ? isAt(placeOf(base_), frame.numbers) : here))
        different("the root link " + inQuotes(name) + " is not where --base says (else at the world's origin)");
      // If it must stand somewhere, it moves from there as a joint that a writer adds, or not at all.
      if (!base_.empty() && !frame.elements.empty())
        compareSteps(up == f ? freely("floating_base") : std::vector<Step>(), frame, false, wrong);
      for (const Element& e : frame.elements) {
        identity = identity && (e.kind == Element::rotate || e.offset == 0);
        for (int k = 0; k < (e.kind == Element::rotate ? 3 : 1); ++k)
          variables.insert(world_.variables[static_cast<std::size_t>(e.variable + k)]);
      }
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
  const std::vector<double>& base_;
  std::map<std::string, std::vector<int>> frames_;  // of the robot's links
  std::map<std::string, int> variable_of_;
  std::vector<std::vector<int>> bodies_;  // of role link, by frame; those that are matched are taken out
  std::set<int> driven_, owned_;          // variables of joints; of joints that do not mimic
  std::set<std::string> said_;
  std::size_t matched_ = 0, pairs_ = 0;
  ShapeComparison shapes_;
  Comparison result_;
};

}  // namespace

Comparison compareWithUrdf(const World& world, const std::string& path, const Packages& packages, const Solids& solids,
                           const std::vector<double>& base) {
  Robot robot(path, packages);
  return UrdfComparison(world, robot, solids, base).run();
}

}  // namespace verify
