// SPDX-License-Identifier: BSD-3-Clause
#include "fcl_artic/manager.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>
#include <tuple>
#include <unordered_set>

#include "adapters/fcl/fcl_geometry.h"
#include "adapters/fcl/fcl_motion.h"
#include "geometry/shape_tree.h"
#include "motion/frame_sweep.h"
#include "narrowphase/problem.h"
#include "query/aspects.h"
#include "query/engine_query.h"
#include "query/motion_variables.h"
#include "query/pair_table.h"
#include "visibility/solve.h"

namespace fcl_artic {
namespace {

using engine::Placement;

using Geometry = std::shared_ptr<const fcl::CollisionGeometryd>;
using MovingObject = fcl::ContinuousCollisionObjectd;

/// A geometry of the manager, obstacle or link.
struct Item {
  fcl::CollisionObjectd* object = nullptr;
  MovingObject* moving = nullptr;  ///< instead of it, of an obstacle that moves
  std::string name;
  LinkId link = -1;  ///< -1: obstacle
  Eigen::Isometry3d offset = Eigen::Isometry3d::Identity();  ///< in the link's frame; of an obstacle: in the world
  Geometry geometry;
  std::shared_ptr<const ShapeTree> shape;
  std::array<double, 7> lss = {};  ///< of a link: line swept sphere in the geometry's frame
  bool attached = false;           ///< an obstacle that the link carries
  std::set<LinkId> touch_links;    ///< that it may touch then
  BodyMotion motion;               ///< of an obstacle that moves
  Eigen::Vector3d path_lower, path_upper;  ///< its box in the world over all of the motion

  bool mayTouchLink(const Item& other) const { return !other.attached && touch_links.count(other.link); }
  Eigen::Isometry3d pose(double t) const { return moving ? motion.pose(t) : offset; }  ///< of an obstacle
};

/// Reads the object's geometry, where it is another one than was read before.
void readShape(Item& item, const std::string& what) {
  const Geometry geometry = item.object ? item.object->collisionGeometry() : item.moving->collisionGeometry();
  if (!geometry) throw std::invalid_argument(what + ": the object has no geometry");
  if (geometry == item.geometry) return;
  try {
    item.shape = readGeometry(*geometry);
  } catch (const std::invalid_argument& e) {
    throw std::invalid_argument(what + ": " + e.what());
  }
  item.geometry = geometry;
}

/// Box in the world of a tree that stands at M.
/// @param placement  the same.
void worldBox(const ShapeTree& shape, const Eigen::Isometry3d& M, const Placement& placement, double* lo, double* hi) {
  const Eigen::Vector3d c = 0.5 * (shape.lower() + shape.upper()), h = 0.5 * (shape.upper() - shape.lower());
  const Eigen::Vector3d center = M * c, half = M.linear().cwiseAbs() * h;
  // The placement's own error and a dozen roundings of numbers no larger than these.
  const double pad = 0x1p-52 * (placement.ulps + 32) * (c.cwiseAbs().sum() + h.sum() + placement.length);
  for (int k = 0; k < 3; ++k) {
    lo[k] = center[k] - half[k] - pad;
    hi[k] = center[k] + half[k] + pad;
  }
}

/// The table of two links, and what it was made from.
struct TabledPair {
  std::shared_ptr<const ShapeTree> shape_a, shape_b;
  LinkId link_a, link_b;
  Eigen::Matrix4d offset_a, offset_b;
  double margin;
  std::shared_ptr<const PairTable> table;  ///< null: none to be had

  TabledPair(const Item& a, const Item& b, double margin)
      : shape_a(a.shape), shape_b(b.shape), link_a(a.link), link_b(b.link), offset_a(a.offset.matrix()),
        offset_b(b.offset.matrix()), margin(margin) {}
  bool sameMaking(const TabledPair& o) const {
    return shape_a == o.shape_a && shape_b == o.shape_b && link_a == o.link_a && link_b == o.link_b &&
           offset_a == o.offset_a && offset_b == o.offset_b && margin == o.margin;
  }
};

void requireMargin(double margin, const std::string& what) {
  if (std::isfinite(margin) && margin >= 0) return;
  throw std::invalid_argument(what + " is " + std::to_string(margin) + ", not a number >= 0");
}

FeatureKind swapped(FeatureKind kind) {
  switch (kind) {
    case FeatureKind::vertexEdge: return FeatureKind::edgeVertex;
    case FeatureKind::edgeVertex: return FeatureKind::vertexEdge;
    case FeatureKind::vertexFace: return FeatureKind::faceVertex;
    case FeatureKind::faceVertex: return FeatureKind::vertexFace;
    case FeatureKind::edgeFace: return FeatureKind::faceEdge;
    case FeatureKind::faceEdge: return FeatureKind::edgeFace;
    default: return kind;
  }
}

}  // namespace

struct ArticulatedCollisionManager::Impl {
  std::shared_ptr<const KinematicTree> tree;
  std::vector<Item> obstacles, links, moving;
  std::unordered_set<const void*> objects;  ///< of all of these
  std::unordered_set<std::string> obstacle_names;
  AllowedCollisionMatrix allowed;
  std::map<std::string, double> body_margins;  ///< by name
  std::map<std::pair<std::string, std::string>, double> pair_margins;  ///< by names, the lesser one first
  bool robot_ready = false;  ///< what buildRobot() makes is up to date
  bool tables_ready = false;  ///< so are the tables of two links
  bool ready = false;        ///< all is
  std::size_t named = 0;     ///< obstacles that were given a name so far

  // Made by buildRobot() and buildScene(), read by queries.
  std::vector<FrameSweep> sweeps;  ///< of the links first, then one from each moving obstacle
  std::vector<engine::SweepView> sweep_views;
  std::vector<engine::Body> bodies;  ///< links first, then moving obstacles, then the others
  std::vector<std::int32_t> movers, obstacle_bodies;
  std::vector<std::uint8_t> scene_allowed;  ///< empty when all pairs of link and obstacle are checked
  std::vector<engine::LinkPair> link_pairs;  ///< of two links first, then of moving obstacles and links
  std::vector<engine::Node> obstacle_tree;
  std::vector<engine::StillBounds> still_bounds;
  std::vector<TabledPair> tabled;  ///< of self pairs, of this set-up and of the one before where they are the same
  std::vector<std::pair<std::size_t, std::shared_ptr<const PairTable>>> tables;  ///< by link pair
  std::vector<double> scene_margins, link_margins;  ///< of pairs, -1: not their own; empty: none has its own
  double largest_margin = 0;
  std::size_t num_link_sweeps = 0, num_self_pairs = 0;
  std::vector<engine::BoundedSource> sources;  ///< of moving obstacles' bounded motions
  std::shared_ptr<const VisibilityCuller> visibility = std::make_shared<VisibilityCuller>();
  std::unique_ptr<visibility::Choice> choice =
      std::make_unique<visibility::Choice>(visibility::ExecutorLoan::firstUse(*visibility));  ///< measured times
  std::unique_ptr<visibility::Choice> redon_choice =
      std::make_unique<visibility::Choice>(visibility::ExecutorLoan::firstUse(*visibility));  ///< of the paper's method

  /// Variables of the moving obstacles' motions, column k for t^k. A query's own come before them.
  Eigen::MatrixXd moving_coefficients;

  const Item& item(std::int32_t body) const {
    std::size_t i = static_cast<std::size_t>(body);
    if (i < links.size()) return links[i];
    i -= links.size();
    return i < moving.size() ? moving[i] : obstacles[i - moving.size()];
  }
  void requireNew(const void* object, const std::string& what) const;
  Item makeItem(fcl::CollisionObjectd* object, const std::string& what) const;
  std::string obstacleName(const std::string& name) const;
  void addObstacle(std::vector<Item>& items, Item item);
  bool isFree(JointId joint) const;
  bool adjacent(LinkId a, LinkId b) const;
  bool linkAbove(LinkId above, LinkId below) const;
  void readObstacle(Item& item) const;
  bool mayTouch(const Item& a, const Item& b) const;
  const engine::TreeView& viewOf(const Item& obstacle) const;
  void buildRobot();
  void buildScene();
  void buildMoving();
  void buildMargins();
  void buildTables();
  const std::uint8_t* freeByTables(const engine::Problem& problem, const JointMotion& motion, double margin,
                                   std::vector<std::uint8_t>& memory) const;
  void requireBody(const std::string& name) const;
  engine::Problem problem() const;
  void setVariables(const JointMotion& motion, const TimePart& time, std::vector<double>& memory,
                    engine::Query& query) const;
  CertifiedContact report(void* workspace, const engine::Problem& problem, const JointMotion& motion,
                          const CertifiedRequest& request, const TimePart& time, engine::LeafContact leaf) const;
  void forget(std::vector<Item>& items, std::vector<Item>::iterator item) {
    objects.erase(item->object);
    objects.erase(item->moving);
    if (item->link < 0 || item->attached) obstacle_names.erase(item->name);
    items.erase(item);
  }
  BodyRef reference(const Item& item) const { return {item.link, item.object, item.name, item.moving}; }
};

void ArticulatedCollisionManager::Impl::requireNew(const void* object, const std::string& what) const {
  if (!object) throw std::invalid_argument(what + ": the object is null");
  if (!objects.count(object)) return;
  for (const std::vector<Item>* items : {&obstacles, &links, &moving}) {
    for (const Item& i : *items) {
      if (i.object == object || i.moving == object) {
        throw std::invalid_argument(what + ": the object is there already, as '" + i.name + "'");
      }
    }
  }
}

Item ArticulatedCollisionManager::Impl::makeItem(fcl::CollisionObjectd* object, const std::string& what) const {
  requireNew(object, what);
  Item item;
  item.object = object;
  readShape(item, what);
  return item;
}

/// The name as given or chosen. (Allowed pairs and margins go by name: a link's would excuse the obstacle too.)
std::string ArticulatedCollisionManager::Impl::obstacleName(const std::string& name) const {
  const std::string shown = name.empty() ? "obstacle" + std::to_string(named) : name;
  if (obstacle_names.count(shown)) throw std::invalid_argument("obstacle '" + shown + "': the name is taken");
  if (tree->hasLink(shown)) {
    throw std::invalid_argument("obstacle '" + shown + "': the name is that of a link of robot '" + tree->name() + "'");
  }
  return shown;
}

void ArticulatedCollisionManager::Impl::addObstacle(std::vector<Item>& items, Item item) {
  readObstacle(item);
  objects.insert(item.object ? static_cast<const void*>(item.object) : item.moving);
  obstacle_names.insert(item.name);
  items.push_back(std::move(item));
  ++named;
  ready = false;
}

/// Whether the joint lets its link go anywhere in the world: a planar or floating one, on what stands still.
bool ArticulatedCollisionManager::Impl::isFree(JointId joint) const {
  const JointType type = tree->joint(joint).type;
  if (type != JointType::planar && type != JointType::floating) return false;
  LinkId link = tree->link(tree->joint(joint).parent);
  while (tree->parentJoint(link) >= 0 && tree->joint(tree->parentJoint(link)).type == JointType::fixed) {
    link = tree->parentLink(link);
  }
  return tree->parentJoint(link) < 0;
}

/// Joined by one moving joint at most, which leaves none of them free, over links without geometry only.
bool ArticulatedCollisionManager::Impl::adjacent(LinkId a, LinkId b) const {
  const auto path = [&](LinkId link) {
    std::vector<LinkId> up{link};
    while (tree->parentLink(up.back()) >= 0) up.push_back(tree->parentLink(up.back()));
    return up;
  };
  std::vector<LinkId> x = path(a), y = path(b);
  if (x.back() != y.back()) return false;
  while (x.size() > 1 && y.size() > 1 && x[x.size() - 2] == y[y.size() - 2]) {
    x.pop_back();
    y.pop_back();
  }
  int moving = 0;
  bool bare = true;  // no link with geometry strictly between
  const auto hasGeometry = [&](LinkId link) {
    return std::any_of(links.begin(), links.end(), [&](const Item& i) { return i.link == link && !i.attached; });
  };
  for (const auto* side : {&x, &y}) {
    for (std::size_t i = 0; i + 1 < side->size(); ++i) {
      const JointId joint = tree->parentJoint((*side)[i]);
      if (isFree(joint)) return false;
      moving += tree->joint(joint).type != JointType::fixed;
    }
    for (std::size_t i = 1; i + 1 < side->size(); ++i) bare = bare && !hasGeometry((*side)[i]);
  }
  const LinkId ancestor = x.back();
  if (ancestor != a && ancestor != b) bare = bare && !hasGeometry(ancestor);
  return moving <= 1 && bare;
}

bool ArticulatedCollisionManager::Impl::linkAbove(LinkId above, LinkId below) const {
  while (below >= 0 && below != above) below = tree->parentLink(below);
  return below == above;
}

void ArticulatedCollisionManager::Impl::readObstacle(Item& item) const {
  const std::string what = "obstacle '" + item.name + "'";
  if (item.object) {
    const Eigen::Isometry3d M = requireRigid(item.object->getTransform(), what);
    readShape(item, what);
    item.offset = M;
    return;
  }
  readShape(item, what);
  const fcl::MotionBased* motion = item.moving->getMotion();
  if (!motion) throw std::invalid_argument(what + ": it has no motion");
  try {
    item.motion = readMotion(*motion);
  } catch (const std::invalid_argument& e) {
    throw std::invalid_argument(what + ": " + e.what());
  }
  const bool bounded = item.shape->view().nodes[0].radius < engine::kUnbounded;
  const Eigen::Vector3d far = Eigen::Vector3d::Constant(engine::kUnbounded);
  if (bounded) enclosePath(item.motion, item.shape->lower(), item.shape->upper(), item.path_lower, item.path_upper);
  item.path_lower = bounded ? item.path_lower.cwiseMax(-far) : Eigen::Vector3d(-far);
  item.path_upper = bounded ? item.path_upper.cwiseMin(far) : far;
}

/// Nothing touches an empty tree (an OcTree without an occupied cell).
bool ArticulatedCollisionManager::Impl::mayTouch(const Item& a, const Item& b) const {
  return a.shape->view().num_pieces && b.shape->view().num_pieces && !allowed.allowed(a.name, b.name);
}

/// An obstacle as the engine sees it: cut into parts like the links, unless it is so large that they move amid it.
const engine::TreeView& ArticulatedCollisionManager::Impl::viewOf(const Item& obstacle) const {
  const auto size = [](const Item& item) { return item.shape->view().nodes[0].radius; };
  const bool large = std::all_of(links.begin(), links.end(),
                                 [&](const Item& link) { return 2 * size(link) < size(obstacle); });
  return large ? obstacle.shape->view() : obstacle.shape->viewWithParts();
}

/// What depends on the links and what is allowed between them only.
void ArticulatedCollisionManager::Impl::buildRobot() {
  sweeps.clear();
  sweeps.push_back(FrameSweep::fromWorld(*tree));
  bodies.assign(links.size(), engine::Body());
  std::vector<int> depth(links.size(), 0);
  std::vector<Eigen::Isometry3d> in_step(links.size());
  std::vector<Carrier> carriers(links.size());
  for (std::size_t i = 0; i < links.size(); ++i) {
    const Item& item = links[i];
    engine::Body& body = bodies[i];
    const Carrier carrier = sweeps[0].carrier(item.link);
    carriers[i] = carrier;
    in_step[i] = carrier.offset * item.offset;
    body.tree = &item.shape->viewWithParts();
    body.step = carrier.step;
    body.placement = makePlacement(carrier, item.offset);
    const std::array<double, 7>& lss = item.lss;
    const Eigen::Vector3d p0 = in_step[i] * Eigen::Vector3d::Map(&lss[0]), p1 = in_step[i] * Eigen::Vector3d::Map(&lss[3]);
    for (int k = 0; k < 3; ++k) {
      body.lss[k] = p0[k];
      body.lss[3 + k] = p1[k];
    }
    const double reach = Eigen::Vector3d::Map(&lss[0]).norm() + Eigen::Vector3d::Map(&lss[3]).norm();
    body.lss[6] = lss[6] + 0x1p-52 * (body.placement.ulps + 16) * (lss[6] + reach + body.placement.length);
    worldBox(*item.shape, in_step[i], body.placement, body.lo, body.hi);  // right where step < 0, not used elsewhere
    for (int s = carrier.step; s >= 0; s = sweeps[0].view().steps[s].parent) ++depth[i];
  }
  movers.resize(links.size());
  for (std::size_t i = 0; i < links.size(); ++i) movers[i] = static_cast<std::int32_t>(i);
  // Distal links first: they move most and are the likeliest to touch, so that t_upper cuts the others' work.
  std::stable_sort(movers.begin(), movers.end(), [&](std::int32_t a, std::int32_t b) {
    return depth[static_cast<std::size_t>(a)] > depth[static_cast<std::size_t>(b)];
  });
  for (std::size_t m = 0; m < movers.size(); ++m) {
    bodies[static_cast<std::size_t>(movers[m])].mover = static_cast<std::int32_t>(m);
  }

  link_pairs.clear();
  std::map<LinkId, std::int32_t> sweep_of;  // base link to sweep
  for (std::size_t i = 0; i < links.size(); ++i) {
    for (std::size_t j = i + 1; j < links.size(); ++j) {
      if (links[i].link == links[j].link || !mayTouch(links[i], links[j])) continue;
      if (links[i].mayTouchLink(links[j]) || links[j].mayTouchLink(links[i])) continue;
      if (!links[i].attached && !links[j].attached && adjacent(links[i].link, links[j].link)) continue;
      // The shorter path first: an ancestor is the base.
      std::size_t a = i, b = j;
      if (linkAbove(links[j].link, links[i].link)) std::swap(a, b);
      engine::LinkPair pair;
      pair.a = static_cast<std::int32_t>(a);
      pair.b = static_cast<std::int32_t>(b);
      if (bodies[a].step < 0) {  // stands still: the world's sweep serves
        pair.inverse_a = makeInversePlacement(carriers[a], links[a].offset);
        pair.step_b = bodies[b].step;
        pair.placement_b = bodies[b].placement;
      } else {
        const auto known = sweep_of.find(links[a].link);
        if (known != sweep_of.end()) {
          pair.sweep = known->second;
        } else {
          pair.sweep = sweep_of[links[a].link] = static_cast<std::int32_t>(sweeps.size());
          sweeps.push_back(FrameSweep::fromLink(*tree, links[a].link));
        }
        const Carrier carrier = sweeps[static_cast<std::size_t>(pair.sweep)].carrier(links[b].link);
        pair.step_b = carrier.step;
        pair.inverse_a = makePlacement(links[a].offset.inverse());
        pair.placement_b = makePlacement(carrier, links[b].offset);
      }
      link_pairs.push_back(pair);
    }
  }
  num_link_sweeps = sweeps.size();
  num_self_pairs = link_pairs.size();
  tables_ready = false;
  robot_ready = true;
}

/// Pairs of links and moving obstacles. The link is seen from the obstacle: up the obstacle's motion, down the tree.
void ArticulatedCollisionManager::Impl::buildMoving() {
  int degree = 1, variables = 0;
  std::size_t bounded = 0;
  for (const Item& item : moving) {
    degree = std::max(degree, degreeOf(item.motion));
    variables += numVariables(item.motion);
    for (const MotionElement& element : item.motion.elements) bounded += element.bounded != nullptr;
  }
  moving_coefficients.setZero(variables, degree + 1);
  sources.clear();
  sources.reserve(bounded);  // steps point into it
  int variable = 0;
  for (std::size_t i = 0; i < moving.size(); ++i) {
    const Item& item = moving[i];
    const std::size_t index = links.size() + i;
    engine::Body& body = bodies[index];
    body.tree = &viewOf(item);
    body.mover = static_cast<std::int32_t>(movers.size());
    movers.push_back(static_cast<std::int32_t>(index));
    for (int k = 0; k < 3; ++k) {  // stage 1 knows the box of the whole path
      body.lo[k] = item.path_lower[k];
      body.hi[k] = item.path_upper[k];
    }
    FrameSweep sweep;
    Carrier at;
    int last = variable += numVariables(item.motion);
    const auto& elements = item.motion.elements;
    for (auto element = elements.rbegin(); element != elements.rend(); ++element) {
      const engine::BoundedSource* source = nullptr;
      if (element->bounded) {
        sources.push_back(boundedSource(*element->bounded));
        source = &sources.back();
      }
      last -= numVariables(*element);
      writeCoefficients(*element, last, variables, degree, moving_coefficients.data());
      at = sweep.cross(at, *element, tree->dof() + last, source, false);
      const PartError error = partError(*element);
      sweep.allowError(error.angle, error.length);
    }
    sweep.enterTree(*tree, at);
    for (std::size_t l = 0; l < links.size(); ++l) {
      if (!mayTouch(links[l], item)) continue;
      const Carrier carrier = sweep.carrier(links[l].link);
      engine::LinkPair pair;
      pair.a = static_cast<std::int32_t>(index);
      pair.b = static_cast<std::int32_t>(l);
      pair.sweep = static_cast<std::int32_t>(sweeps.size());
      pair.step_b = carrier.step;
      pair.inverse_a = makePlacement(item.motion.after.inverse());
      pair.placement_b = makePlacement(carrier, links[l].offset);
      link_pairs.push_back(pair);
    }
    sweeps.push_back(std::move(sweep));
  }
}

/// What depends on the obstacles.
void ArticulatedCollisionManager::Impl::buildScene() {
  if (!robot_ready) buildRobot();
  ready = false;
  sweeps.erase(sweeps.begin() + static_cast<std::ptrdiff_t>(num_link_sweeps), sweeps.end());
  link_pairs.resize(num_self_pairs);
  movers.resize(links.size());
  bodies.resize(links.size());
  bodies.resize(links.size() + moving.size() + obstacles.size());
  buildMoving();

  const std::size_t first = links.size() + moving.size();
  std::vector<BoxBounds> boxes(obstacles.size());
  obstacle_bodies.resize(obstacles.size());
  for (std::size_t o = 0; o < obstacles.size(); ++o) {
    const Item& item = obstacles[o];
    engine::Body& body = bodies[first + o];
    body.tree = &viewOf(item);
    body.placement = makePlacement(item.offset);
    body.inverse = makePlacement(item.offset.inverse());
    worldBox(*item.shape, item.offset, body.placement, body.lo, body.hi);
    for (int k = 0; k < 3; ++k) {
      boxes[o].lo[k] = body.lo[k];
      boxes[o].hi[k] = body.hi[k];
    }
    obstacle_bodies[o] = static_cast<std::int32_t>(first + o);
  }
  obstacle_tree = buildBoxTree(boxes);
  still_bounds.clear();
  for (std::size_t o = 0; o < obstacles.size(); ++o) {
    const engine::TreeView& tree = *bodies[first + o].tree;
    const engine::PieceKind kind = tree.pieces[0].kind;
    const bool solid = tree.num_pieces == 1 && kind != engine::PieceKind::vertices &&
                       kind != engine::PieceKind::halfspace && kind != engine::PieceKind::plane;
    still_bounds.push_back({bodies[first + o].inverse, obstacles[o].shape->coreBox(), &tree, solid});
  }

  scene_allowed.clear();
  const auto allow = [&](std::size_t m, std::size_t o) {
    scene_allowed.resize(links.size() * obstacles.size(), 0);
    scene_allowed[m * obstacles.size() + o] = 1;
  };
  std::map<std::string, std::size_t> obstacle_named;
  if (!allowed.pairs().empty()) {
    for (std::size_t o = 0; o < obstacles.size(); ++o) obstacle_named[obstacles[o].name] = o;
  }
  for (const auto& [one, other] : allowed.pairs()) {
    for (const auto& [obstacle, link] : {std::tie(one, other), std::tie(other, one)}) {
      const auto o = obstacle_named.find(obstacle);
      if (o == obstacle_named.end()) continue;
      for (std::size_t m = 0; m < links.size(); ++m) {
        if (item(movers[m]).name == link) allow(m, o->second);
      }
    }
  }
  buildMargins();
  const auto empty = [](const Item& item) { return item.shape->view().num_pieces == 0; };
  for (std::size_t o = 0; o < obstacles.size(); ++o) {
    for (std::size_t m = 0; m < links.size(); ++m) {
      if (empty(obstacles[o]) || empty(item(movers[m]))) allow(m, o);  // nothing touches an empty tree (mayTouch)
    }
  }

  sweep_views.clear();
  for (const FrameSweep& sweep : sweeps) sweep_views.push_back(sweep.view());
  buildTables();
  ready = true;
}

/// Margins of pairs: their own, else the larger one of those that their bodies have.
void ArticulatedCollisionManager::Impl::buildMargins() {
  scene_margins.clear();
  link_margins.clear();
  largest_margin = 0;
  if (body_margins.empty() && pair_margins.empty()) return;
  std::vector<double> of_body(bodies.size(), -1);
  std::map<std::string, std::vector<std::int32_t>> bodies_named;
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(bodies.size()); ++i) {
    const auto margin = body_margins.find(item(i).name);
    if (margin != body_margins.end()) of_body[static_cast<std::size_t>(i)] = margin->second;
    bodies_named[item(i).name].push_back(i);
  }
  const auto larger = [&](std::int32_t a, std::int32_t b) {
    return std::max(of_body[static_cast<std::size_t>(a)], of_body[static_cast<std::size_t>(b)]);
  };
  for (std::size_t m = 0; m < links.size(); ++m) {
    for (const std::int32_t obstacle : obstacle_bodies) scene_margins.push_back(larger(movers[m], obstacle));
  }
  for (const engine::LinkPair& pair : link_pairs) link_margins.push_back(larger(pair.a, pair.b));

  const auto first_obstacle = static_cast<std::int32_t>(links.size() + moving.size());
  std::map<std::pair<std::int32_t, std::int32_t>, double> own;  // of two that move, the lesser one first
  for (const auto& [names, margin] : pair_margins) {
    for (const std::int32_t a : bodies_named[names.first]) {
      for (const std::int32_t b : bodies_named[names.second]) {
        const auto [link, other] = std::minmax(a, b);
        if (other < first_obstacle) {
          own[{link, other}] = margin;
        } else if (link < static_cast<std::int32_t>(links.size())) {
          const auto m = static_cast<std::size_t>(bodies[static_cast<std::size_t>(link)].mover);
          scene_margins[m * obstacles.size() + static_cast<std::size_t>(other - first_obstacle)] = margin;
        }
      }
    }
  }
  for (std::size_t i = 0; i < link_pairs.size(); ++i) {
    const auto margin = own.find(std::minmax(link_pairs[i].a, link_pairs[i].b));
    if (margin != own.end()) link_margins[i] = margin->second;
  }
  for (const std::vector<double>* margins : {&scene_margins, &link_margins}) {
    for (const double margin : *margins) largest_margin = std::max(largest_margin, margin);
  }
}

/// Tables of self pairs, for their own margins or none. (An attached object comes and goes: it gets none.)
void ArticulatedCollisionManager::Impl::buildTables() {
  if (tables_ready) return;
  std::vector<TabledPair> before;
  std::swap(tabled, before);
  tables.clear();
  for (std::size_t i = 0; i < num_self_pairs; ++i) {
    const engine::LinkPair& pair = link_pairs[i];
    const Item &a = item(pair.a), &b = item(pair.b);
    if (a.attached || b.attached) continue;
    TabledPair made(a, b, link_margins.empty() ? 0 : std::max(0.0, link_margins[i]));
    const auto known =
        std::find_if(before.begin(), before.end(), [&](const TabledPair& t) { return t.sameMaking(made); });
    made.table = known != before.end() ? known->table
                                       : PairTable::build(*tree, sweep_views[static_cast<std::size_t>(pair.sweep)],
                                                          bodies.data(), pair, made.margin);
    if (made.table) tables.emplace_back(i, made.table);
    tabled.push_back(std::move(made));
  }
  tables_ready = true;
}

/// What tables tell of a motion, as engine::Query::link_free.
/// @param margin  the query's, of pairs that have none of their own.
const std::uint8_t* ArticulatedCollisionManager::Impl::freeByTables(const engine::Problem& problem,
                                                                    const JointMotion& motion, double margin,
                                                                    std::vector<std::uint8_t>& memory) const {
  memory.assign(link_pairs.size(), 0);
  for (const auto& [pair, table] : tables) {
    const auto number = problem.num_scene_pairs + static_cast<std::int32_t>(pair);
    if (engine::marginOf(problem, margin, number) > table->margin()) continue;
    memory[pair] = static_cast<std::uint8_t>(table->freeParts(motion.variables()));
  }
  return memory.data();
}

/// The motion's variables, then those of the moving obstacles.
/// @param time  of the obstacles' motions.
/// @param memory  for them, when there are both.
void ArticulatedCollisionManager::Impl::setVariables(const JointMotion& motion, const TimePart& time,
                                                     std::vector<double>& memory, engine::Query& query) const {
  const Eigen::MatrixXd& own = motion.variables();
  const Eigen::MatrixXd part = time.whole() ? Eigen::MatrixXd() : partOf(moving_coefficients, time);
  const Eigen::MatrixXd& others = time.whole() ? moving_coefficients : part;
  query.coefficients = own.data();
  query.num_variables = static_cast<std::int32_t>(own.rows());
  query.degree = static_cast<std::int32_t>(own.cols()) - 1;
  query.orientations = motion.orientations().data();
  if (others.rows() == 0) return;
  const Eigen::Index columns = std::max(own.cols(), others.cols());
  memory.assign(static_cast<std::size_t>((own.rows() + others.rows()) * columns), 0);
  Eigen::Map<Eigen::MatrixXd> all(memory.data(), own.rows() + others.rows(), columns);
  all.topLeftCorner(own.rows(), own.cols()) = own;
  all.bottomLeftCorner(others.rows(), others.cols()) = others;
  query.coefficients = memory.data();
  query.num_variables = static_cast<std::int32_t>(all.rows());
  query.degree = static_cast<std::int32_t>(columns) - 1;
}

/// What the engine sees of the set-up.
engine::Problem ArticulatedCollisionManager::Impl::problem() const {
  engine::Problem p;
  p.bodies = bodies.data();
  p.num_bodies = static_cast<std::int32_t>(bodies.size());
  p.movers = movers.data();
  p.num_movers = static_cast<std::int32_t>(movers.size());
  p.num_scene_movers = static_cast<std::int32_t>(links.size());
  p.sweeps = sweep_views.data();
  p.num_sweeps = static_cast<std::int32_t>(sweep_views.size());
  p.link_pairs = link_pairs.data();
  p.num_link_pairs = static_cast<std::int32_t>(link_pairs.size());
  p.num_scene_pairs = static_cast<std::int32_t>(links.size() * obstacles.size());
  p.scene_allowed = scene_allowed.empty() ? nullptr : scene_allowed.data();
  p.obstacles = obstacle_bodies.data();
  p.num_obstacles = static_cast<std::int32_t>(obstacles.size());
  p.obstacle_tree = obstacle_tree.empty() ? nullptr : obstacle_tree.data();
  p.still_bounds = still_bounds.data();
  p.scene_margins = scene_margins.empty() ? nullptr : scene_margins.data();
  p.link_margins = link_margins.empty() ? nullptr : link_margins.data();
  p.largest_margin = largest_margin;
  return p;
}

/// A contact as users see it: features named, in world axes, links before obstacles.
CertifiedContact ArticulatedCollisionManager::Impl::report(void* workspace, const engine::Problem& problem,
                                                           const JointMotion& motion, const CertifiedRequest& request,
                                                           const TimePart& time, engine::LeafContact leaf) const {
  const Item &a = item(leaf.body_a), &b = item(leaf.body_b);
  CertifiedContact contact;
  if (engine::marginOf(problem, request.margin, leaf.pair) == 0) {
    refineContact(workspace, a.shape->view(), b.shape->view(), request.tolerance_time, leaf, contact.feature);
  }
  const auto carried = [&] {
    std::vector<Eigen::Isometry3d> M_0;
    tree->forwardKinematics(motion.configuration(leaf.t), M_0);
    return M_0[static_cast<std::size_t>(a.link)] * a.offset;
  };
  const Eigen::Isometry3d M_0a = a.link >= 0 ? carried() : a.pose(time.at(leaf.t));
  contact.point = M_0a * Eigen::Vector3d::Map(leaf.point);
  contact.normal = (M_0a.linear() * Eigen::Vector3d::Map(leaf.normal)).normalized();
  contact.body1 = reference(a);
  contact.body2 = reference(b);
  contact.o1 = a.geometry.get();
  contact.o2 = b.geometry.get();
  contact.b1 = primitiveId(a.geometry.get(), *a.shape, leaf.piece_a);
  contact.b2 = primitiveId(b.geometry.get(), *b.shape, leaf.piece_b);
  if (a.link < 0) {
    contact.feature = swapped(contact.feature);
    std::swap(contact.body1, contact.body2);
    std::swap(contact.o1, contact.o2);
    std::swap(contact.b1, contact.b2);
    contact.normal = -contact.normal;
  }
  contact.t_lower = leaf.t_lower;
  contact.t_upper = leaf.t_upper;
  contact.certain = leaf.certain;
  return contact;
}

ArticulatedCollisionManager::ArticulatedCollisionManager(std::shared_ptr<const KinematicTree> tree)
    : impl_(std::make_unique<Impl>()) {
  if (!tree) throw std::invalid_argument("ArticulatedCollisionManager: the kinematic tree is null");
  impl_->tree = std::move(tree);
}
ArticulatedCollisionManager::~ArticulatedCollisionManager() = default;
ArticulatedCollisionManager::ArticulatedCollisionManager(ArticulatedCollisionManager&&) noexcept = default;
ArticulatedCollisionManager& ArticulatedCollisionManager::operator=(ArticulatedCollisionManager&&) noexcept = default;

const KinematicTree& ArticulatedCollisionManager::tree() const { return *impl_->tree; }
std::shared_ptr<const KinematicTree> ArticulatedCollisionManager::sharedTree() const { return impl_->tree; }

void ArticulatedCollisionManager::registerObject(fcl::CollisionObjectd* object, const std::string& name) {
  const std::string shown = impl_->obstacleName(name);
  Item item = impl_->makeItem(object, "obstacle '" + shown + "'");
  item.name = shown;
  impl_->addObstacle(impl_->obstacles, std::move(item));
}

void ArticulatedCollisionManager::registerObject(fcl::ContinuousCollisionObjectd* object, const std::string& name) {
  Item item;
  item.name = impl_->obstacleName(name);
  impl_->requireNew(object, "obstacle '" + item.name + "'");
  item.moving = object;
  impl_->addObstacle(impl_->moving, std::move(item));
}

void ArticulatedCollisionManager::registerObjects(const std::vector<fcl::CollisionObjectd*>& objects) {
  const std::size_t before = impl_->obstacles.size(), named = impl_->named;
  const bool ready = impl_->ready;
  try {
    for (fcl::CollisionObjectd* object : objects) registerObject(object);
  } catch (...) {
    while (impl_->obstacles.size() > before) impl_->forget(impl_->obstacles, impl_->obstacles.end() - 1);
    impl_->named = named;
    impl_->ready = ready;
    throw;
  }
}

void ArticulatedCollisionManager::unregisterObject(fcl::CollisionObjectd* object) {
  const auto is_it = [&](const Item& i) { return i.object == object && (i.link < 0 || i.attached); };
  auto& items = impl_->obstacles;
  const auto it = std::find_if(items.begin(), items.end(), is_it);
  if (it != items.end()) {
    impl_->forget(items, it);
  } else {
    const auto attached = std::find_if(impl_->links.begin(), impl_->links.end(), is_it);
    if (attached == impl_->links.end()) throw std::invalid_argument("unregisterObject: the object is not registered");
    impl_->forget(impl_->links, attached);
    impl_->robot_ready = false;
  }
  impl_->ready = false;
}

void ArticulatedCollisionManager::unregisterObject(fcl::ContinuousCollisionObjectd* object) {
  auto& items = impl_->moving;
  const auto it = std::find_if(items.begin(), items.end(), [&](const Item& i) { return i.moving == object; });
  if (it == items.end()) throw std::invalid_argument("unregisterObject: the object is not registered");
  impl_->forget(items, it);
  impl_->ready = false;
}

void ArticulatedCollisionManager::bind(LinkId link, fcl::CollisionObjectd* object, const Eigen::Isometry3d& offset) {
  if (link < 0 || link >= impl_->tree->numLinks()) {
    throw std::invalid_argument("bind: robot '" + impl_->tree->name() + "' has no link " + std::to_string(link));
  }
  const std::string what = "geometry of link '" + impl_->tree->linkName(link) + "'";
  Item item = impl_->makeItem(object, what);
  item.link = link;
  item.name = impl_->tree->linkName(link);
  item.offset = requireRigid(offset, what);
  item.lss = item.shape->lineSweptSphere();
  impl_->objects.insert(object);
  impl_->links.push_back(std::move(item));
  impl_->robot_ready = impl_->ready = false;
}

void ArticulatedCollisionManager::bind(const std::string& link, fcl::CollisionObjectd* object,
                                       const Eigen::Isometry3d& offset) {
  if (!impl_->tree->hasLink(link)) {
    throw std::invalid_argument("bind: robot '" + impl_->tree->name() + "' has no link '" + link + "'");
  }
  bind(impl_->tree->link(link), object, offset);
}

void ArticulatedCollisionManager::unbind(fcl::CollisionObjectd* object) {
  auto& items = impl_->links;
  const auto it = std::find_if(items.begin(), items.end(), [&](const Item& i) { return i.object == object; });
  if (it == items.end()) throw std::invalid_argument("unbind: the object is bound to no link");
  if (it->attached) throw std::invalid_argument("unbind: '" + it->name + "' is attached; detach it");
  impl_->forget(items, it);
  impl_->robot_ready = impl_->ready = false;
}

void ArticulatedCollisionManager::attach(LinkId link, fcl::CollisionObjectd* object, const Eigen::Isometry3d& offset,
                                         const std::vector<std::string>& touch_links) {
  const KinematicTree& tree = *impl_->tree;
  if (link < 0 || link >= tree.numLinks()) {
    throw std::invalid_argument("attach: robot '" + tree.name() + "' has no link " + std::to_string(link));
  }
  auto& items = impl_->obstacles;
  const auto it = std::find_if(items.begin(), items.end(), [&](const Item& i) { return object && i.object == object; });
  if (it == items.end()) throw std::invalid_argument("attach: the object is not registered as an obstacle");
  const std::string what = "attach: '" + it->name + "'";
  Item item = *it;
  item.link = link;
  item.attached = true;
  item.offset = requireRigid(offset, what);
  for (const std::string& name : touch_links) {
    if (!tree.hasLink(name)) throw std::invalid_argument(what + ": robot '" + tree.name() + "' has no link '" + name + "'");
    item.touch_links.insert(tree.link(name));
  }
  try {
    item.lss = item.shape->lineSweptSphere();
  } catch (const std::invalid_argument& e) {
    throw std::invalid_argument(what + ": " + e.what());
  }
  impl_->links.push_back(std::move(item));
  items.erase(it);
  impl_->robot_ready = impl_->ready = false;
}

void ArticulatedCollisionManager::attach(const std::string& link, fcl::CollisionObjectd* object,
                                         const Eigen::Isometry3d& offset, const std::vector<std::string>& touch_links) {
  if (!impl_->tree->hasLink(link)) {
    throw std::invalid_argument("attach: robot '" + impl_->tree->name() + "' has no link '" + link + "'");
  }
  attach(impl_->tree->link(link), object, offset, touch_links);
}

void ArticulatedCollisionManager::detach(fcl::CollisionObjectd* object) {
  auto& links = impl_->links;
  const auto it = std::find_if(links.begin(), links.end(), [&](const Item& i) { return i.object == object && i.attached; });
  if (it == links.end()) throw std::invalid_argument("detach: the object is not attached");
  Item item = *it;
  item.link = -1;
  item.attached = false;
  item.touch_links.clear();
  impl_->readObstacle(item);
  impl_->obstacles.push_back(std::move(item));
  links.erase(it);
  impl_->robot_ready = impl_->ready = false;
}

void ArticulatedCollisionManager::setAllowedCollisions(AllowedCollisionMatrix matrix) {
  impl_->allowed = std::move(matrix);
  impl_->robot_ready = impl_->ready = false;
}
const AllowedCollisionMatrix& ArticulatedCollisionManager::allowedCollisions() const { return impl_->allowed; }

void ArticulatedCollisionManager::Impl::requireBody(const std::string& name) const {
  if (tree->hasLink(name) || obstacle_names.count(name)) return;
  throw std::invalid_argument("setMargin: '" + name + "' is no link of robot '" + tree->name() + "' and no obstacle");
}

void ArticulatedCollisionManager::setMargin(const std::string& body, double margin) {
  impl_->requireBody(body);
  requireMargin(margin, "setMargin: the margin of '" + body + "'");
  impl_->body_margins[body] = margin;
  impl_->tables_ready = impl_->ready = false;
}

void ArticulatedCollisionManager::setMargin(const std::string& a, const std::string& b, double margin) {
  impl_->requireBody(a);
  impl_->requireBody(b);
  requireMargin(margin, "setMargin: the margin of '" + a + "' and '" + b + "'");
  impl_->pair_margins[std::minmax(a, b)] = margin;
  impl_->tables_ready = impl_->ready = false;
}

void ArticulatedCollisionManager::resetMargins() {
  impl_->body_margins.clear();
  impl_->pair_margins.clear();
  impl_->tables_ready = impl_->ready = false;
}

void ArticulatedCollisionManager::setVisibility(std::shared_ptr<const VisibilityCuller> culler) {
  impl_->visibility = culler ? std::move(culler) : std::make_shared<VisibilityCuller>();
  for (auto* choice : {&impl_->choice, &impl_->redon_choice}) {
    *choice = std::make_unique<visibility::Choice>(visibility::ExecutorLoan::firstUse(*impl_->visibility));
  }
}

void ArticulatedCollisionManager::setup() {
  if (!impl_->ready) impl_->buildScene();
}

void ArticulatedCollisionManager::update() {
  std::vector<Item> obstacles = impl_->obstacles, moving = impl_->moving;  // all or nothing
  for (std::vector<Item>* items : {&obstacles, &moving}) {
    for (Item& item : *items) impl_->readObstacle(item);
  }
  impl_->obstacles = std::move(obstacles);
  impl_->moving = std::move(moving);
  impl_->buildScene();
}

void ArticulatedCollisionManager::update(fcl::CollisionObjectd* object) {
  update(std::vector<fcl::CollisionObjectd*>{object});
}

void ArticulatedCollisionManager::update(const std::vector<fcl::CollisionObjectd*>& objects) {
  std::vector<Item> items = impl_->obstacles;
  for (fcl::CollisionObjectd* object : objects) {
    const auto it = std::find_if(items.begin(), items.end(), [&](const Item& i) { return i.object == object; });
    if (it == items.end()) throw std::invalid_argument("update: the object is not registered");
    impl_->readObstacle(*it);
  }
  impl_->obstacles = std::move(items);
  impl_->buildScene();
}

void ArticulatedCollisionManager::update(fcl::ContinuousCollisionObjectd* object) {
  auto& items = impl_->moving;
  const auto it = std::find_if(items.begin(), items.end(), [&](const Item& i) { return i.moving == object; });
  if (it == items.end()) throw std::invalid_argument("update: the object is not registered");
  Item item = *it;
  impl_->readObstacle(item);
  *it = std::move(item);
  impl_->buildScene();
}

void ArticulatedCollisionManager::clear() {
  impl_->obstacles.clear();
  impl_->links.clear();
  impl_->moving.clear();
  impl_->objects.clear();
  impl_->obstacle_names.clear();
  impl_->named = 0;
  impl_->robot_ready = impl_->ready = false;
}

void ArticulatedCollisionManager::getObjects(std::vector<fcl::CollisionObjectd*>& objects) const {
  objects.clear();
  for (const Item& i : impl_->obstacles) objects.push_back(i.object);
}

void ArticulatedCollisionManager::getObjects(std::vector<fcl::ContinuousCollisionObjectd*>& objects) const {
  objects.clear();
  for (const Item& i : impl_->moving) objects.push_back(i.moving);
}

std::vector<std::pair<LinkId, fcl::CollisionObjectd*>> ArticulatedCollisionManager::boundObjects() const {
  std::vector<std::pair<LinkId, fcl::CollisionObjectd*>> bound;
  for (const Item& i : impl_->links) bound.emplace_back(i.link, i.object);
  return bound;
}

Eigen::Isometry3d ArticulatedCollisionManager::boundOffset(const fcl::CollisionObjectd* object) const {
  for (const Item& i : impl_->links) {
    if (i.object == object) return i.offset;
  }
  throw std::invalid_argument("boundOffset: the object is bound to no link");
}

std::size_t ArticulatedCollisionManager::size() const { return impl_->obstacles.size() + impl_->moving.size(); }

void ArticulatedCollisionManager::continuousCollide(const JointMotion& motion, const CertifiedRequest& request,
                                                    CertifiedResult& result) const {
  collideMotion(motion, request, Aspects(), result);
}

void ArticulatedCollisionManager::collideMotion(const JointMotion& motion, const CertifiedRequest& request,
                                                const Aspects& aspects, CertifiedResult& result) const {
  const Impl& m = *impl_;
  if (!m.ready) {
    throw std::logic_error(
        "ArticulatedCollisionManager: call setup() after changing objects, links, margins or allowed pairs");
  }
  if (motion.size() != m.tree->dof()) {
    throw std::invalid_argument("the motion has " + std::to_string(motion.size()) + " joint values, robot '" +
                                m.tree->name() + "' has " + std::to_string(m.tree->dof()));
  }
  engine::Query query = makeQuery(request);

  using Clock = std::chrono::steady_clock;
  const auto since = [](Clock::time_point t) { return std::chrono::duration<double, std::micro>(Clock::now() - t).count(); };
  const Clock::time_point begin = request.measure_times ? Clock::now() : Clock::time_point();
  const WorkspaceLoan workspace;
  m.setVariables(motion, aspects.time, workspace->coefficients, query);
  engine::Problem problem = m.problem();
  const BoundedParts parts(aspects.time, problem);
  if (!aspects.own_margins) {
    problem.scene_margins = problem.link_margins = nullptr;
    problem.largest_margin = 0;
  }
  // Pairs with moving obstacles are the scene's, though they stand with those of two links.
  const auto self_pairs = static_cast<std::int32_t>(m.num_self_pairs);
  if (!request.check_scene) problem.num_link_pairs = self_pairs;
  if (!request.check_self) {
    problem.link_pairs += self_pairs;
    if (problem.link_margins) problem.link_margins += self_pairs;
    problem.num_link_pairs -= self_pairs;
  }
  const auto byTables = [&] { return m.freeByTables(problem, motion, request.margin, workspace->link_free); };
  if (request.check_self && request.method == Method::standard && !m.tables.empty()) {
    query.link_free = [](const void* context) { return (*static_cast<decltype(byTables)*>(context))(); };
    query.link_free_context = &byTables;
  }
  query.check_self = problem.num_link_pairs > 0;
  engine::Answer answer;
  visibility::Report stage;
  RedonStatistics redon_work;
  if (request.method == Method::Redon2004) {
    const auto treeOf = [&m](std::int32_t body) { return m.item(body).shape->obbTree(); };
    const auto method = [&](const engine::Query& asked, engine::Answer& out) {
      RedonStatistics work;
      redon::solve(workspace->redon(), workspace->engine(), problem, asked, request.redon, treeOf, out, work);
      addWork(work, redon_work);  // of both solves, where there are two
      redon_work.pairs_by_standard = work.pairs_by_standard;
    };
    visibility::solve(*m.visibility, *m.redon_choice, request.visibility, method, problem, query, answer, stage);
  } else {
    const auto method = [&workspace, &problem](const engine::Query& asked, engine::Answer& out) {
      engine::engine().solve(workspace->engine(), problem, asked, out);
    };
    visibility::solve(*m.visibility, *m.choice, request.visibility, method, problem, query, answer, stage);
  }
  const Clock::time_point solved = request.measure_times ? Clock::now() : Clock::time_point();

  result.status = statusOf(answer.verdict);
  result.t_lower = answer.t_lower;
  result.t_upper = answer.t_upper;
  result.certain = answer.certain;
  result.contacts.clear();
  for (std::int32_t i = 0; i < answer.num_contacts; ++i) {
    result.contacts.push_back(m.report(workspace->engine(), problem, motion, request, aspects.time, answer.contacts[i]));
    const CertifiedContact& contact = result.contacts.back();
    if (contact.certain && contact.t_upper < result.t_upper) {
      result.t_upper = contact.t_upper;
      result.certain = result.certain || result.t_upper - result.t_lower <= request.tolerance_time;
    }
  }
  result.M_0_at_lower.clear();
  if (!result.isFree()) m.tree->forwardKinematics(motion.configuration(answer.t_lower), result.M_0_at_lower);
  result.ignored_initial_contacts.clear();
  for (std::int32_t i = 0; i < answer.num_ignored; ++i) {
    result.ignored_initial_contacts.emplace_back(m.reference(m.item(answer.ignored[i].body_a)),
                                                 m.reference(m.item(answer.ignored[i].body_b)));
  }
  if (aspects.never_apart) {
    aspects.never_apart->clear();
    for (std::int32_t i = 0; i < answer.num_ignored; ++i) {
      aspects.never_apart->push_back(answer.ignored[i].watch_from > 1);
    }
  }
  result.statistics = statisticsOf(answer.statistics);
  result.statistics.visibility_pairs = stage.pairs;
  result.statistics.visibility_culled = stage.culled;
  result.statistics.visibility_nodes = stage.nodes;
  result.statistics.visibility_pieces = stage.pieces;
  result.statistics.visibility_trials = stage.trials;
  result.statistics.visibility_repeated = stage.repeated;
  result.statistics.visibility_us = stage.elapsed_us;
  result.statistics.visibility_executor = stage.executor;
  result.statistics.visibility_fallback = stage.fallback;
  result.statistics.redon = redon_work;
  if (request.measure_times) {
    result.statistics.report_us = since(solved);
    result.statistics.total_us = since(begin);
  }
}

void ArticulatedCollisionManager::collide(const Eigen::VectorXd& q, const CertifiedRequest& request,
                                          CertifiedResult& result) const {
  continuousCollide(JointMotion::linear(*impl_->tree, q, q), request, result);
}

}  // namespace fcl_artic
