// SPDX-License-Identifier: BSD-3-Clause
#include "robot.h"

#include <algorithm>
#include <set>

namespace verify {
namespace {

/// Rz(yaw) Ry(pitch) Rx(roll), each entry enclosed.
Mat fromAngles(const std::vector<double>& rpy) {
  Tm s[3], c[3];
  for (std::size_t k = 0; k < 3; ++k) sineCosine(exactly(rpy[k]), s[k], c[k]);
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

}  // namespace

Robot::Robot(const std::string& path, const Packages& packages) : xml_(path), files_(path, packages) {
  const Xml::Element& robot = xml_.robot();
  xml_.only(robot, {"name", "version", "xmlns", "xsi:schemaLocation"}, {"link", "joint"},
            {"material", "gazebo", "transmission", "ros2_control", "sensor", "force_element", "frame", "bullet",
             "drake:collision_filter_group"});
  for (const Xml::Element* e = robot.FirstChildElement("link"); e; e = e->NextSiblingElement("link")) readLink(*e);
  for (const Xml::Element* e = robot.FirstChildElement("joint"); e; e = e->NextSiblingElement("joint")) readJoint(*e);
  requireTree();
}

void Robot::requireTree() {
  for (std::size_t j = 0; j < joints.size(); ++j) {
    for (const std::string& link : {joints[j].parent, joints[j].child})
      if (!has(link)) throw BadInput("URDF: joint " + inQuotes(joints[j].name) + " names a link that is not there");
    if (!above_.emplace(joints[j].child, j).second)
      throw BadInput("URDF: link " + inQuotes(joints[j].child) + " is the child of two joints");
  }
  std::size_t roots = 0;
  for (const Link& link : links) {
    if (above_.count(link.name) > 0) continue;
    root = link.name;
    ++roots;
  }
  if (roots != 1) throw BadInput("URDF: there are " + std::to_string(roots) + " root links");
  std::set<std::string> on_root{root};
  for (const Link& link : links) {
    std::set<std::string> way;  // up to one that is known to hang on the root
    for (std::string name = link.name; on_root.count(name) == 0; name = jointAbove(name)->parent)
      if (!way.insert(name).second) throw BadInput("URDF: link " + inQuotes(link.name) + " hangs on itself in the end");
    on_root.merge(way);
  }
}

const Joint* Robot::jointAbove(const std::string& link) const {
  const auto found = above_.find(link);
  return found == above_.end() ? nullptr : &joints[found->second];
}

const Robot::Driven& Robot::drivenBy(std::size_t joint) {
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

Place Robot::readPlace(const Xml::Element& parent) const {
  const Xml::Element* const origin = xml_.one(parent, "origin");
  if (origin != nullptr) xml_.only(*origin, {"xyz", "rpy"});
  return {fromAngles(xml_.numbers(origin, "rpy", "0 0 0", 3)), xml_.numbers(origin, "xyz", "0 0 0", 3)};
}

void Robot::readLink(const Xml::Element& e) {
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
    if (collision.kind == Geometry::sphere && collision.numbers[0] == 0) continue;  // a point is no body
    collision.place = readPlace(*c);
    link.collisions.push_back(std::move(collision));
  }
  links.push_back(std::move(link));
}

Collision Robot::readShape(const Xml::Element& parent) {
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
    c.path = files_.find(xml_.attribute(*e, "filename"));
  } else {
    xml_.only(*e, {"radius", "length"});
    c.kind = kind == "capsule" ? Geometry::capsule : Geometry::cylinder;
    c.numbers = {xml_.numbers(e, "radius", nullptr, 1)[0], xml_.numbers(e, "length", nullptr, 1)[0]};
  }
  return c;
}

void Robot::readJoint(const Xml::Element& e) {
  xml_.only(e, {"name", "type", "dont_collapse"}, {"parent", "child", "origin", "axis", "mimic"},
            {"limit", "dynamics", "safety_controller", "calibration", "controller_gains", "joint_properties", "traits",
             "hardwareInterface"});
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

Place placeOf(const std::vector<double>& six) {
  return {fromAngles({six.begin() + 3, six.end()}), {six.begin(), six.begin() + 3}};
}
bool isRotation(const Mat& R, const double numbers[9]) {
  for (std::size_t k = 0; k < 9; ++k)
    if (bound(R[k] - exactly(numbers[k])) > Fix{kOne >> 49}) return false;
  return true;
}
bool isAt(const Place& place, const double numbers[12]) {
  return std::equal(place.t.begin(), place.t.end(), numbers + 9) && isRotation(place.R, numbers);
}

}  // namespace verify
