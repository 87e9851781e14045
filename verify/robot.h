// SPDX-License-Identifier: BSD-3-Clause
// A URDF as the file has it, read by a whitelist.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "meshes.h"
#include "packages.h"
#include "xml.h"

namespace verify {

struct Place {
  Mat R;
  std::vector<double> t;
};
/// The value along or about an axis: multiplier * q + offset, q being the variable of that name.
struct Driver {
  std::string variable;
  double multiplier = 1, offset = 0;
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
  /// @throws BadInput: unreadable, with something in it that is not known, or no tree.
  Robot(const std::string& path, const Packages& packages);

  std::vector<Link> links;
  std::vector<Joint> joints;
  std::string root;

  bool has(const std::string& link) const { return link_of_.count(link) > 0; }
  /// The joint that carries a link; null: the link is the root.
  const Joint* jointAbove(const std::string& link) const;

  /// The variable that drives a joint of one variable: its own, or the one that it follows in the end. A chain's
  /// multipliers and offsets are put together in doubles, as `m1 (m2 q + c2) + c1 = (m1 m2) q + (m1 c2 + c1)`. Where
  /// the joint at the end is fixed, it stands at `offset`.
  struct Driven {
    Driver driver;
    bool still = false;
  };
  const Driven& drivenBy(std::size_t joint);

 private:
  [[noreturn]] void twice(const Xml::Element& e) const { xml_.refuse(e, "the name is there twice"); }
  Place readPlace(const Xml::Element& parent) const;
  void readLink(const Xml::Element& e);
  Collision readShape(const Xml::Element& parent);
  void readJoint(const Xml::Element& e);
  void requireTree();

  const Xml xml_;
  FileFinder files_;
  std::map<std::string, std::size_t> link_of_, joint_of_, above_;  // above_: the joint above each link
  std::map<std::size_t, Driven> known_;
};

/// The place with these x, y, z, roll, pitch, yaw.
Place placeOf(const std::vector<double>& six);
/// Whether the numbers are that place: the rotation within 2^-49, so that it is among those that the claim is about;
/// the translation to the very bit.
bool isAt(const Place& place, const double numbers[12]);
bool isRotation(const Mat& R, const double numbers[9]);

}  // namespace verify
