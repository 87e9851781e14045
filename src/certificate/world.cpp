// SPDX-License-Identifier: BSD-3-Clause
#include "certificate/world.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>

#include "certificate/sha256.h"
#include "kinematics/joint_factors.h"
#include "numerics/assertion.h"

#include "numerics/baseline_isa.h"

#include "convex/piece_kinds.h"
#include "setup/neighbour_findings.h"

namespace fcl_artic::certificate {
namespace {

using engine::Node;
using engine::Piece;
using engine::PieceKind;
using engine::TreeView;

/// A word of a statement. Characters that do not print, or would end the word, become two hexadecimal digits.
std::string word(const std::string& name) {
  std::string text;
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    char digits[4];
    std::snprintf(digits, sizeof digits, byte > 32 && byte < 127 && c != '%' ? "%c" : "%%%02x", byte);
    text += digits;
  }
  return text;
}

std::string vectorText(const Eigen::Vector3d& v) {
  return numberText(v[0]) + " " + numberText(v[1]) + " " + numberText(v[2]);
}
std::string poseText(const Eigen::Isometry3d& M) {
  return rotationText(M.linear()) + " " + vectorText(M.translation());
}

Frame frameOf(const KinematicTree& tree, LinkId link, const std::vector<int>& frame_of_link) {
  Frame frame;
  frame.name = tree.linkName(link);
  const JointId j = tree.parentJoint(link);
  if (j < 0) return frame;
  frame.parent = frame_of_link[static_cast<std::size_t>(tree.parentLink(link))];
  const Joint& joint = tree.joint(j);
  frame.origin = joint.origin;
  for (const JointFactor& factor : factorsOf(joint)) {
    Element element;
    element.variable = tree.jointVariable(j) + factor.variable;
    if (joint.mimics) {
      element.multiplier = joint.mimic.multiplier;
      element.offset = joint.mimic.offset;
    }
    element.axis = factor.axis;
    switch (factor.kind) {
      case JointFactor::Kind::revolute:
      case JointFactor::Kind::prismatic:
        element.kind = factor.kind == JointFactor::Kind::revolute ? Element::Kind::turn : Element::Kind::slide;
        frame.elements.push_back(element);
        break;
      case JointFactor::Kind::slide:
        element.kind = Element::Kind::slide;
        for (int k = 0; k < 3; ++k) {
          element.axis = Eigen::Vector3d::Unit(k);
          frame.elements.push_back(element);
          ++element.variable;
        }
        break;
      case JointFactor::Kind::turn:
        element.kind = Element::Kind::rotate;
        frame.elements.push_back(element);
        break;
    }
  }
  return frame;
}

/// No shorter than the chord of an angle.
double chordOf(double angle) {
  return std::min(angle, 2.0);
}

std::string toleranceText(const PoseTolerance& t) {
  return " " + numberText(t.length) + " " + numberText(t.angle) + " " + vectorText(t.pivot) + "\n";
}
Give giveOf(const PoseTolerance& t) {
  Give give;
  give.at = t.pivot;
  give.slide = t.length;
  give.chord = chordOf(t.angle);
  return give;
}

/// The lines of a joint's tolerance: of its variables, or of what several of them make up.
std::string toleranceText(const KinematicTree& tree, JointId j, const JointTolerance& t) {
  const int v = tree.jointVariable(j), slides = tree.joint(j).type == JointType::planar ? 2 : 3;
  std::string text;
  const auto line = [&](const char* what, int variable, double value) {
    if (value > 0)
      text += "tolerance " + std::string(what) + " " + std::to_string(variable) + " " + numberText(value) + "\n";
  };
  const auto vector = [&] {
    if (t.length > 0)
      text +=
          "tolerance vector " + std::to_string(v) + " " + std::to_string(slides) + " " + numberText(t.length) + "\n";
  };
  switch (tree.joint(j).type) {
    case JointType::fixed:
      break;
    case JointType::revolute:
    case JointType::continuous:
      line("variable", v, t.angle);
      break;
    case JointType::prismatic:
      line("variable", v, t.length);
      break;
    case JointType::planar:
      vector();
      line("variable", v + 2, t.angle);
      break;
    case JointType::spherical:
      line("rotation", v, t.angle);
      break;
    case JointType::floating:
      vector();
      line("rotation", v + 3, t.angle);
      break;
  }
  return text;
}

/// The gives of a joint's elements. @param t  of the joint, or of the one that it mimics.
std::vector<Give> givesOf(const std::vector<Element>& elements, const JointTolerance& t) {
  std::vector<Give> gives;
  bool slid = false;
  for (std::size_t k = 0; k < elements.size(); ++k) {
    const Element& e = elements[k];
    Give give;
    give.element = static_cast<int>(k);
    give.axis = e.kind == Element::Kind::turn;
    if (give.axis) give.at = e.axis;
    const double factor = std::abs(e.multiplier);
    // A joint that mimics one of another kind takes its number.
    if (e.kind != Element::Kind::slide) {
      give.chord = chordOf(factor * std::max(t.angle, elements.size() == 1 ? t.length : 0));
    } else if (!slid) {  // the slides of a joint are one vector
      give.slide = factor * std::max(t.length, elements.size() == 1 ? t.angle : 0);
      slid = true;
    }
    if (give.slide > 0 || give.chord > 0) gives.push_back(give);
  }
  return gives;
}

/// Adds the frames of a body with a motion of its own, and their variables with what these do.
/// @return the last one.
int addFrames(const std::string& name, const BodyMotion& motion, World& world) {
  int parent = 0;
  int count = 0;
  for (const MotionElement& step : motion.elements) {
    if (step.kind == MotionElement::Kind::bounded) {
      world.missing = "'" + name + "' moves as its BoundedMotion says, and only that knows how";
      return 0;
    }
    Frame frame;
    frame.name = name + "/" + std::to_string(count++);
    frame.parent = parent;
    frame.origin = step.before;
    const bool vector = step.kind == MotionElement::Kind::slide || step.kind == MotionElement::Kind::turn;
    const int rows = vector ? 3 : 1;
    Element element;
    element.kind = step.kind == MotionElement::Kind::turn       ? Element::Kind::rotate
                   : step.kind == MotionElement::Kind::revolute ? Element::Kind::turn
                                                                : Element::Kind::slide;
    for (int k = 0; k < rows; ++k) {
      element.variable = static_cast<int>(world.variables.size());
      element.axis = vector ? Eigen::Vector3d(Eigen::Vector3d::Unit(k)) : step.axis.vector();
      if (k == 0 || element.kind == Element::Kind::slide) frame.elements.push_back(element);
      world.variables.push_back(frame.name + "/" + std::to_string(k));
      const Eigen::Index row = world.moving.rows();
      world.moving.conservativeResize(row + 1, kMaxDegree + 1);
      world.moving.row(row) = step.coefficients.row(k);
    }
    parent = static_cast<int>(world.frames.size());
    world.frames.push_back(frame);
  }
  return parent;
}

// ---- geometries

/// Numbers of the tree's pieces in the order of its leaves, from the left.
void addLeaves(const TreeView& tree, std::int32_t node, Geometry& geometry) {
  const auto begin = static_cast<std::int32_t>(geometry.order.size());
  if (tree.nodes[node].isLeaf()) {
    geometry.order.push_back(tree.nodes[node].piece());
  } else {
    addLeaves(tree, tree.nodes[node].left(), geometry);
    addLeaves(tree, tree.nodes[node].right(), geometry);
  }
  geometry.below[static_cast<std::size_t>(node)] = {begin, static_cast<std::int32_t>(geometry.order.size())};
}

/// A list of points, each once, and the number of each.
class PointList {
 public:
  std::size_t add(const baseline::Vec3& p) {
    const std::array<double, 3> key = {p[0], p[1], p[2]};
    const auto [it, is_new] = numbers_.try_emplace(key, numbers_.size());
    if (is_new) text_ += vectorText(Eigen::Vector3d(p[0], p[1], p[2])) + "\n";
    return it->second;
  }
  std::string text() const { return "vertices " + std::to_string(numbers_.size()) + "\n" + text_; }

 private:
  std::map<std::array<double, 3>, std::size_t> numbers_;
  std::string text_;
};

std::string meshText(const Geometry& geometry) {
  const TreeView& tree = geometry.shape->view();
  PointList points;
  std::string triangles = "triangles " + std::to_string(geometry.order.size()) + "\n";
  for (const std::int32_t piece : geometry.order) {
    const Piece& triangle = tree.pieces[piece];
    FCL_ARTIC_ASSERT(triangle.kind == PieceKind::vertices && triangle.num_vertices == 3);
    const double* p = baseline::VerticesKind::points(tree, triangle);
    for (int k = 0; k < 3; ++k) {
      triangles += std::to_string(points.add(baseline::Vec3(p + 3 * k)));
      triangles += k < 2 ? ' ' : '\n';
    }
  }
  return std::string("mesh ") + (geometry.shape->space() ? "solid\n" : "surface\n") + points.text() + triangles;
}

std::string cellsText(const Geometry& geometry) {
  const TreeView& tree = geometry.shape->view();
  std::string text = "boxes\ncells " + std::to_string(geometry.order.size()) + "\n";
  for (const std::int32_t piece : geometry.order) {
    const Piece& box = tree.pieces[piece];
    FCL_ARTIC_ASSERT(box.kind == PieceKind::box && box.radius == 0);
    text += vectorText(Eigen::Vector3d::Map(box.center)) + " " + vectorText(Eigen::Vector3d::Map(box.size)) + "\n";
  }
  return text;
}

std::string hullText(const TreeView& tree, const Piece& hull) {
  PointList points;
  for (int i = 0; i < hull.num_vertices; ++i) points.add(baseline::HullKind::vertex(tree, hull, i));
  return "hull\n" + points.text();
}

std::string geometryText(const Geometry& geometry) {
  const TreeView& tree = geometry.shape->view();
  const Piece& piece = tree.pieces[0];
  const auto of = [](const char* name, std::initializer_list<double> numbers) {
    std::string text = name;
    for (const double x : numbers) text += " " + numberText(x);
    return text + "\n";
  };
  const double* e = piece.size;
  const bool centred = Eigen::Vector3d::Map(piece.center).isZero(0);
  // All other bounded shapes of FCL lie about their frames' origins. (The center of an unbounded piece is its offset.)
  FCL_ARTIC_ASSERT(centred || piece.kind == PieceKind::box || piece.kind == PieceKind::vertices ||
                   baseline::unbounded(piece));
  switch (piece.kind) {
    case PieceKind::vertices:
      return meshText(geometry);
    case PieceKind::hull:
      return hullText(tree, piece);
    case PieceKind::box:
      if (tree.num_pieces > 1 || !centred) return cellsText(geometry);
      return of("box", {2 * e[0], 2 * e[1], 2 * e[2]});
    case PieceKind::point:
      return of("sphere", {piece.radius});
    case PieceKind::segment:
      return of("capsule", {piece.radius, 2 * e[2]});
    case PieceKind::cylinder:
      return of("cylinder", {e[0], 2 * e[2]});
    case PieceKind::cone:
      return of("cone", {e[0], 2 * e[2]});
    case PieceKind::ellipsoid:
      return of("ellipsoid", {e[0], e[1], e[2]});
    case PieceKind::halfspace:
      return of("halfspace", {e[0], e[1], e[2], piece.center[0]});
    case PieceKind::plane:
      return of("plane", {e[0], e[1], e[2], piece.center[0]});
  }
  __builtin_unreachable();
}

// ---- bodies and pairs

const char* toText(Body::Role role) {
  return role == Body::Role::link ? "link" : role == Body::Role::carried ? "carried" : "obstacle";
}

/// Obstacles in the order of a tree over their boxes: near ones next to each other.
std::vector<std::size_t> inSpace(const std::vector<ManagedBody>& obstacles, const std::vector<std::size_t>& chosen) {
  std::vector<BoxBounds> boxes;
  for (const std::size_t i : chosen) {
    const ManagedBody& body = obstacles[i];
    const Eigen::Vector3d centre = 0.5 * (body.shape->lower() + body.shape->upper());
    const Eigen::Vector3d half = 0.5 * (body.shape->upper() - body.shape->lower());
    const Eigen::Vector3d at = body.offset * centre, around = body.offset.linear().cwiseAbs() * half;
    BoxBounds box;
    for (int k = 0; k < 3; ++k) {
      box.lo[k] = at[k] - around[k];
      box.hi[k] = at[k] + around[k];
    }
    boxes.push_back(box);
  }
  const std::vector<Node> nodes = buildBoxTree(boxes);
  std::vector<std::size_t> order;
  std::vector<std::int32_t> open;
  if (!nodes.empty()) open.push_back(0);
  while (!open.empty()) {
    const Node& node = nodes[static_cast<std::size_t>(open.back())];
    open.pop_back();
    if (node.isLeaf()) {
      order.push_back(chosen[static_cast<std::size_t>(node.piece())]);
    } else {
      open.push_back(node.right());
      open.push_back(node.left());
    }
  }
  return order;
}

/// Puts a world together; its text comes last.
class Builder {
 public:
  void addBody(Body::Role role, const std::string& name, std::shared_ptr<const ShapeTree> shape, int frame,
               const Eigen::Isometry3d& pose, std::size_t number) {
    const auto [it, is_new] = geometry_of_.try_emplace(shape.get(), static_cast<int>(world.geometries.size()));
    if (is_new) world.geometries.emplace_back(std::move(shape));
    world.bodies.push_back({role,
                            name,
                            frame,
                            it->second,
                            pose,
                            static_cast<std::int32_t>(number),
                            world.margins.ofBody(name),
                            {},
                            {},
                            {}});
  }
  /// Tolerances of objects, and lines of others.
  void tolerate(const WorldTolerances& tolerances, const std::string& lines) {
    of_object_ = tolerances.of_object;
    speeds_ = tolerances.speeds;
    tolerance_lines_ += lines;
  }
  void exclude(const char* reason, const std::string& a, const std::string& b) {
    unchecked_.insert({reason, std::min(a, b), std::max(a, b)});
  }
  void write();

  World world;

 private:
  std::map<const ShapeTree*, int> geometry_of_;
  std::map<std::string, PoseTolerance> of_object_;
  std::map<std::string, ObjectSpeed> speeds_;
  std::string tolerance_lines_;
  std::set<std::array<std::string, 3>> unchecked_;
};

std::string elementText(const Element& element) {
  if (element.kind == Element::Kind::rotate) return "rotate " + std::to_string(element.variable) + "\n";
  return std::string(element.kind == Element::Kind::turn ? "turn " : "slide ") + vectorText(element.axis) + " " +
         std::to_string(element.variable) + " " + numberText(element.multiplier) + " " + numberText(element.offset) +
         "\n";
}

/// Whether the geometry is a list of balls. Neither the text nor the verifier has such lists, so no world can state it.
bool isCloud(const Geometry& geometry) {
  const TreeView& tree = geometry.shape->view();
  return tree.num_pieces > 0 && tree.pieces[0].kind == PieceKind::point &&
         (tree.num_pieces > 1 || !Eigen::Vector3d::Map(tree.pieces[0].center).isZero(0));
}

void Builder::write() {
  for (const Geometry& geometry : world.geometries) {
    if (!isCloud(geometry)) continue;
    world.missing = "a body is a point cloud, which certificates cannot state";
    return;
  }
  std::string text = "fcl_artic world 1\n";
  for (const std::string& variable : world.variables) text += "variable " + word(variable) + "\n";
  for (std::size_t f = 1; f < world.frames.size(); ++f) {
    const Frame& frame = world.frames[f];
    text += "frame " + word(frame.name) + " " + std::to_string(frame.parent) + " " + poseText(frame.origin) + "\n";
    for (const Element& element : frame.elements) text += elementText(element);
  }
  for (const Geometry& geometry : world.geometries) text += "geometry " + geometryText(geometry);
  std::set<std::string> names;
  for (const Body& body : world.bodies) {
    text += std::string("body ") + toText(body.role) + " " + word(body.name) + " " + std::to_string(body.frame) + " " +
            std::to_string(body.geometry) + " " + poseText(body.pose) + "\n";
    names.insert(body.name);
  }
  for (const std::string& name : names) {
    const double margin = world.margins.ofBody(name);
    if (margin >= 0) text += "margin " + word(name) + " " + numberText(margin) + "\n";
  }
  for (const auto& [pair, margin] : world.margins.ofPairs()) {
    if (!names.count(pair.first) || !names.count(pair.second)) continue;
    text += "margin " + word(pair.first) + " " + word(pair.second) + " " + numberText(margin) + "\n";
  }
  text += tolerance_lines_;
  for (const auto& [name, tolerance] : of_object_) {
    if (tolerance.any() && names.count(name)) text += "tolerance body " + word(name) + toleranceText(tolerance);
  }
  for (const auto& [name, of] : speeds_) {
    if (!(of.speed > 0 && names.count(name))) continue;
    if (of.speed > kLargestNumber || std::abs(of.since) > kLargestNumber) {
      world.missing = "the speed of '" + name + "', or the time from which on it moves, is beyond 2^40";
      return;
    }
    text += "tolerance speed " + word(name) + " " + numberText(of.speed) + " " + numberText(of.since) + "\n";
  }
  for (Body& body : world.bodies) {
    const auto own = of_object_.find(body.name);
    if (own != of_object_.end() && own->second.any()) body.gives.push_back(giveOf(own->second));
    const auto speed = speeds_.find(body.name);
    if (speed != speeds_.end()) body.speed = speed->second;
    world.clocked = world.clocked || body.speed.speed > 0;
    world.tolerant = world.tolerant || world.clocked || !body.gives.empty();
  }
  for (const Frame& frame : world.frames) world.tolerant = world.tolerant || !frame.gives.empty();
  for (const auto& [reason, a, b] : unchecked_) text += "unchecked " + reason + " " + word(a) + " " + word(b) + "\n";
  world.hash = sha256Text(text);
  world.text = std::make_shared<const std::string>(std::move(text));
}

/// The world of a manager.
class ManagedWorld {
 public:
  ManagedWorld(const Registry& registry, const WorldTolerances& tolerances)
      : registry_(registry), tolerances_(tolerances), tree_(*registry.tree()) {}

  World run() {
    world_.margins = registry_.margins();
    addRobotFrames();
    addObstacles();
    addLinks();
    addPairs();
    addTolerances();
    builder_.write();
    return std::move(world_);
  }

 private:
  void addRobotFrames() {
    for (int v = 0; v < tree_.dof(); ++v) world_.variables.push_back(tree_.variableName(v));
    world_.first_moving = tree_.dof();
    world_.frames.emplace_back();
    frame_of_link_.assign(static_cast<std::size_t>(tree_.numLinks()), 0);
    const std::vector<LinkId>& links = tree_.topologicalOrder();
    const auto isRoot = [&](LinkId link) { return tree_.parentJoint(link) < 0; };
    int ground = 0;  // of roots
    // Several roots are off together: in a frame of their own.
    if (tolerances_.of_base.any() && std::count_if(links.begin(), links.end(), isRoot) > 1) {
      ground = static_cast<int>(world_.frames.size());
      world_.frames.emplace_back();
      world_.frames.back().name = "/base";
    }
    for (const LinkId link : links) {
      frame_of_link_[static_cast<std::size_t>(link)] = static_cast<int>(world_.frames.size());
      world_.frames.push_back(frameOf(tree_, link, frame_of_link_));
      if (isRoot(link)) world_.frames.back().parent = ground;
    }
    for (JointId j = 0; j < tree_.numJoints(); ++j) {
      if (tree_.quaternionVariable(j) >= 0) world_.orientations.push_back(tree_.quaternionVariable(j));
    }
  }

  void addBody(const ManagedBody& body, std::size_t number, int frame, const Eigen::Isometry3d& pose) {
    if (body.empty()) return;
    const Body::Role role = body.link < 0   ? Body::Role::obstacle
                            : body.attached ? Body::Role::carried
                                            : Body::Role::link;
    builder_.addBody(role, body.name, body.shape, frame, pose, number);
    managed_.push_back(&body);
  }

  void addObstacles() {
    const std::vector<ManagedBody>& obstacles = registry_.obstacles();
    std::vector<std::size_t> unbounded, bounded;
    for (std::size_t i = 0; i < obstacles.size(); ++i) {
      (baseline::unbounded(obstacles[i].shape->view().pieces[0]) ? unbounded : bounded).push_back(i);
    }
    const std::size_t first = registry_.links().size() + registry_.moving().size();
    for (const std::size_t i : unbounded) addBody(obstacles[i], first + i, 0, obstacles[i].offset);
    for (const std::size_t i : inSpace(obstacles, bounded)) addBody(obstacles[i], first + i, 0, obstacles[i].offset);
    const std::vector<ManagedBody>& moving = registry_.moving();
    for (std::size_t i = 0; i < moving.size(); ++i) {
      addBody(moving[i], registry_.links().size() + i, addFrames(moving[i].name, moving[i].motion, world_),
              moving[i].motion.after);
    }
  }

  void addLinks() {
    const std::vector<ManagedBody>& links = registry_.links();
    for (const LinkId link : tree_.topologicalOrder()) {
      for (std::size_t i = 0; i < links.size(); ++i) {
        if (links[i].link != link) continue;
        addBody(links[i], i, frame_of_link_[static_cast<std::size_t>(link)], links[i].offset);
      }
    }
  }

  /// Why the two are not checked; null: they are, empty: nobody asks.
  const char* excuse(const ManagedBody& a, const ManagedBody& b) const {
    if (a.link == b.link || (a.link < 0 && b.link < 0)) return "";
    if (a.link < 0 || b.link < 0) {
      return registry_.standStill(a, b) ? "still" : registry_.mayTouch(a, b) ? nullptr : "allowed";
    }
    switch (registry_.excuseOf(a, b)) {
      case Excuse::allowed:
        return "allowed";
      case Excuse::touch_link:
        return "touch-link";
      case Excuse::still:
        return "still";
      case Excuse::neighbours:
        return "neighbours";
      case Excuse::none:
        return isPartOfLeftOut(a, b) ? "neighbours" : nullptr;
    }
    return nullptr;
  }
  /// A world leaves out all bodies of two names. So if two links' housings overlap, it leaves out their other parts
  /// too, which the query checks.
  bool isPartOfLeftOut(const ManagedBody& a, const ManagedBody& b) const {
    if (a.attached || b.attached || !registry_.neighbours()) return false;
    const NeighbourFindings::Pair* const pair = registry_.neighbours()->find(a.link, b.link);
    return pair && pair->finding.leftOut();
  }

  void addTolerances() {
    std::string lines;
    for (JointId j = 0; j < tree_.numJoints() && !tolerances_.of_joint.empty(); ++j) {
      if (!tree_.joint(j).mimics) lines += toleranceText(tree_, j, tolerances_.of_joint[static_cast<std::size_t>(j)]);
    }
    for (const LinkId link : tree_.topologicalOrder()) {
      JointId j = tree_.parentJoint(link);
      if (j < 0 || tolerances_.of_joint.empty()) continue;
      Frame& frame = world_.frames[static_cast<std::size_t>(frame_of_link_[static_cast<std::size_t>(link)])];
      while (tree_.joint(j).mimics) j = tree_.jointId(tree_.joint(j).mimic.master);
      frame.gives = givesOf(frame.elements, tolerances_.of_joint[static_cast<std::size_t>(j)]);
    }
    const auto isOfRobot = [](const Body& body) { return body.role != Body::Role::obstacle; };
    if (tolerances_.of_base.any() && std::any_of(world_.bodies.begin(), world_.bodies.end(), isOfRobot)) {
      lines += "tolerance frame 1" + toleranceText(tolerances_.of_base);  // the root, or the frame of several
      std::vector<Give>& gives = world_.frames[1].gives;
      gives.insert(gives.begin(), giveOf(tolerances_.of_base));
    }
    builder_.tolerate(tolerances_, lines);
  }

  void addPairs() {
    for (std::size_t i = 0; i < managed_.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        const char* reason = excuse(*managed_[i], *managed_[j]);
        if (!reason) {
          world_.bodies[i].partners.push_back(static_cast<int>(j));
        } else if (*reason != '\0') {
          builder_.exclude(reason, managed_[i]->name, managed_[j]->name);
        }
      }
    }
  }

  const Registry& registry_;
  const WorldTolerances& tolerances_;
  const KinematicTree& tree_;
  Builder builder_;
  World& world_ = builder_.world;
  std::vector<int> frame_of_link_;
  std::vector<const ManagedBody*> managed_;  ///< of each body
};

}  // namespace

Geometry::Geometry(std::shared_ptr<const ShapeTree> shape_in) : shape(std::move(shape_in)) {
  const TreeView& tree = shape->view();
  if (tree.balls) return;  // World::missing: no certificate states a cloud
  below.resize(static_cast<std::size_t>(tree.num_nodes));
  addLeaves(tree, 0, *this);
  unbounded = baseline::unbounded(tree.pieces[0]);
  radius = unbounded ? 0 : tree.extent;
}

int World::bodyOf(std::int32_t number) const {
  const auto body = std::find_if(bodies.begin(), bodies.end(), [&](const Body& b) { return b.number == number; });
  FCL_ARTIC_ASSERT(body != bodies.end());
  return static_cast<int>(body - bodies.begin());
}

double World::marginOf(const Body& a, const Body& b, double margin, double added) const {
  if (!margins.ofPairs().empty()) {
    const auto pair = margins.ofPairs().find(std::minmax(a.name, b.name));
    if (pair != margins.ofPairs().end()) return pair->second + added;
  }
  const double own = std::max(a.own_margin, b.own_margin);
  return (own >= 0 ? own : margin) + added;
}

World makeWorld(const Registry& registry, const WorldTolerances& tolerances) {
  return ManagedWorld(registry, tolerances).run();
}

World makeWorld(const ShapeTree& shape1, const BodyMotion& motion1, const ShapeTree& shape2, const BodyMotion& motion2,
                const WorldTolerances& tolerances) {
  Builder builder;
  World& world = builder.world;
  world.frames.emplace_back();
  const auto add = [&](const char* name, const ShapeTree& shape, const BodyMotion& motion, std::size_t number) {
    const int frame = addFrames(name, motion, world);
    builder.addBody(Body::Role::carried, name, {std::shared_ptr<void>(), &shape}, frame, motion.after, number);
  };
  add("body1", shape1, motion1, 0);
  add("body2", shape2, motion2, 1);
  world.bodies[1].partners = {0};
  builder.tolerate(tolerances, "");
  builder.write();
  return std::move(world);
}

std::string numberText(double x) {
  char text[40];
  std::snprintf(text, sizeof text, "%a", x);
  return text;
}

std::string rotationText(const Eigen::Matrix3d& R) {
  std::string text;
  for (int i = 0; i < 3; ++i) text += (i ? " " : "") + vectorText(R.row(i));
  return text;
}

}  // namespace fcl_artic::certificate
