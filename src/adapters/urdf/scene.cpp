// SPDX-License-Identifier: BSD-3-Clause
#include <fcl/geometry/shape/plane.h>
#include <octomap/ColorOcTree.h>
#include <octomap/OcTree.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <locale>
#include <map>
#include <set>
#include <sstream>
#include <string_view>

#include "detail.h"
#include "fcl_artic/urdf/urdf.h"
#include "files/files.h"
#include "meshes/readers.h"
#include "meshes/text.h"
#include "text/utf8.h"

namespace fcl_artic {
namespace {

namespace fs = std::filesystem;
using detail::fail;

/// Gives names once: those in use become NAME#2, NAME#3, ...
class UniqueNames {
 public:
  std::string take(const std::string& name) {
    int& number = numbers_[name];
    std::string free = name;
    do {
      if (++number > 1) free = name + "#" + std::to_string(number);
    } while (!taken_.insert(free).second);
    return free;
  }

 private:
  std::set<std::string> taken_;
  std::map<std::string, int> numbers_;  ///< given last
};

class SceneBuilder {
 public:
  explicit SceneBuilder(const SceneOptions& asked) : options(asked) {}
  /// @param geometry, M_0  in the file's units.
  void add(const std::string& name, const detail::GeometryPtr& geometry, const Eigen::Isometry3d& M_0) {
    detail::GeometryPtr& scaled = scaled_[geometry];
    if (!scaled) scaled = detail::scaledGeometry(geometry, options.scale, "obstacle '" + name + "'");
    Eigen::Isometry3d M_scaled = M_0;
    M_scaled.translation() *= options.scale;
    scene.obstacles.push_back({names_.take(name), std::make_shared<fcl::CollisionObjectd>(scaled, M_scaled), {}});
    const auto [first, is_new] = first_of_.try_emplace(name, scene.obstacles.size() - 1);
    if (is_new) return;
    Scene::Obstacle& first_shape = scene.obstacles[first->second];
    scene.obstacles.back().shape_of = first_shape.shape_of = first_shape.name;
  }
  Scene scene;
  const SceneOptions& options;

 private:
  UniqueNames names_;
  std::map<std::string, std::size_t> first_of_;                ///< number of each object's first shape
  std::map<detail::GeometryPtr, detail::GeometryPtr> scaled_;  ///< those that obstacles share stay shared
};

// MoveIt's scene text: objects of shapes, each with a pose (position, quaternion xyzw) and a colour.

class MoveItSceneReader {
 public:
  MoveItSceneReader(const std::string& path, SceneBuilder& builder)
      : where_("'" + path + "'"), in_(files::read(path)), builder_(builder) {
    in_.imbue(std::locale::classic());
  }

  void read() {
    std::string scene_name;
    std::getline(in_, scene_name);
    const bool has_poses = objectsHavePoses();
    for (;;) {
      std::string marker;
      if (!(in_ >> marker)) fail(where_, "ends before the '.' that closes a scene");
      if (marker == ".") {
        if (builder_.scene.obstacles.empty()) builder_.scene.notes.push_back(where_ + ": has no object with a shape");
        if (in_ >> marker) fail(where_, "goes on after the '.' that closes a scene: " + meshes::shown(marker));
        return;
      }
      if (marker != "*") fail(where_, "has '" + marker + "' where an object ('* name') or the end ('.') belongs");
      readObject(has_poses);
    }
  }

 private:
  /// Newer files give each object a pose before its shapes: the line after the name holds more than the shape count.
  bool objectsHavePoses() {
    const auto start = in_.tellg();
    std::string line;
    while (std::getline(in_, line) && (line.empty() || line[0] != '*')) {
    }
    std::getline(in_, line);
    in_.clear();
    in_.seekg(start);
    std::istringstream words(line);
    std::string word;
    return words >> word && words >> word;
  }

  /// The number of the line that was read last.
  std::size_t line() {
    in_.clear();
    const std::string read = in_.str().substr(0, static_cast<std::size_t>(in_.tellg()));
    return static_cast<std::size_t>(std::count(read.begin(), read.end() - 1, '\n')) + 1;
  }

  void readObject(bool has_pose) {
    std::string name;
    std::getline(in_ >> std::ws, name);
    name.erase(name.find_last_not_of(" \t\r") + 1);
    if (!text::isUtf8(name)) {
      fail(where_, "line " + std::to_string(line()) + ": the object's name '" + name +
                       "' has bytes that are no UTF-8; save the file as UTF-8");
    }
    const std::string part = where_ + ": object '" + name + "'";
    const Eigen::Isometry3d M_object = has_pose ? pose(part) : Eigen::Isometry3d::Identity();
    const auto shapes = count(part, "number of shapes");
    for (std::size_t i = 0; i < shapes; ++i) {
      const auto geometry = shape(part);
      const Eigen::Isometry3d M_shape = pose(part);
      for (int channel = 0; channel < 4; ++channel) number(part, "colour");
      builder_.add(name, geometry, M_object * M_shape);
    }
    if (!has_pose) return;
    const auto subframes = count(part, "number of subframes");
    for (std::size_t i = 0; i < subframes; ++i) {
      std::string subframe;
      in_ >> subframe;
      pose(part);
    }
  }

  detail::GeometryPtr shape(const std::string& part) {
    std::string kind;
    in_ >> kind;
    const auto length = [&] { return number(part, kind + "'s size"); };
    if (kind == "box") {
      const double x = length(), y = length(), z = length();
      return detail::makeBox({x, y, z}, part);
    }
    if (kind == "sphere") return detail::makeSphere(length(), part);
    if (kind == "cylinder" || kind == "cone") {
      const double radius = length(), height = length();
      return kind == "cone" ? detail::makeCone(radius, height, part) : detail::makeCylinder(radius, height, part);
    }
    if (kind == "plane") {  // a x + b y + c z + d = 0, as shape_msgs/Plane says; FCL's has its offset on the other side
      Eigen::Vector3d n;
      for (double& x : n) x = number(part, "plane");
      const double d = number(part, "plane");
      if (!(n.norm() > 1e-6)) fail(part, "has a plane whose normal is zero");
      return std::make_shared<fcl::Planed>(n / n.norm(), -d / n.norm());
    }
    if (kind == "mesh") {
      const auto num_vertices = count(part, "number of vertices"), num_triangles = count(part, "number of triangles");
      std::vector<Eigen::Vector3d> vertices;  // grow as they are read: a wrong count must not take all memory
      for (std::size_t i = 0; i < num_vertices; ++i) {
        const double x = number(part, "vertex"), y = number(part, "vertex"), z = number(part, "vertex");
        vertices.emplace_back(x, y, z);
      }
      std::vector<fcl::Triangle> triangles;
      for (std::size_t i = 0; i < num_triangles; ++i) {
        const auto a = count(part, "triangle"), b = count(part, "triangle"), c = count(part, "triangle");
        triangles.emplace_back(a, b, c);
      }
      return detail::makeMesh(std::move(vertices), std::move(triangles), part, &builder_.scene.notes,
                              builder_.options.solid_meshes);
    }
    fail(part, "has a shape '" + kind + "'; box, sphere, cylinder, cone, plane and mesh are read");
  }

  Eigen::Isometry3d pose(const std::string& part) {
    Eigen::Vector3d position;
    for (double& x : position) x = number(part, "position");
    Eigen::Quaterniond rotation;
    for (double& x : rotation.coeffs()) x = number(part, "quaternion");  // x y z w, as Eigen keeps it
    const double length = rotation.norm();
    if (!(length > 1e-6)) fail(part, "has a zero quaternion");
    if (!(length < 1e6)) fail(part, "has a quaternion that is far too long");
    return Eigen::Translation3d(position) * rotation.normalized();
  }

  double number(const std::string& part, const std::string& what) {
    std::string word;
    double value = 0;
    if (!(in_ >> word) || !meshes::toNumber(word, value)) fail(part, "its " + what + " is cut short or not a number");
    return value;
  }
  std::size_t count(const std::string& part, const std::string& what) {
    std::string word;
    std::uint64_t value = 0;
    if (!(in_ >> word) || !meshes::toCount(word, value)) fail(part, "its " + what + " is cut short or not a count");
    return value;
  }

  std::string where_;
  std::istringstream in_;
  SceneBuilder& builder_;
};

/// Cells of an OctoMap as boxes: the occupied ones and, if they are asked for, the unknown ones within the box of all
/// known cells.
template <class Tree>
class CellCollector {
 public:
  using Node = typename Tree::NodeType;
  CellCollector(const Tree& tree, const std::string& path, bool unknown, SceneBuilder& builder)
      : tree_(tree), path_(path), name_(fs::path(path).stem().string()), unknown_(unknown), builder_(builder) {
    tree.getMetricMin(lower_[0], lower_[1], lower_[2]);
    tree.getMetricMax(upper_[0], upper_[1], upper_[2]);
  }

  void collect() {
    const double half = std::ldexp(tree_.getResolution(), static_cast<int>(tree_.getTreeDepth()) - 1);
    if (tree_.getRoot()) visit(tree_.getRoot(), Eigen::Vector3d::Zero(), half);
  }

 private:
  /// Children as octomap orders them. Centres and sizes are exact multiples of the resolution's power of two.
  void visit(const Node* node, const Eigen::Vector3d& center, double half) {
    if (node && !tree_.nodeHasChildren(node)) {
      if (tree_.isNodeOccupied(node)) add(name_, center, Eigen::Vector3d::Constant(2 * half));
      return;
    }
    if (!node) return addUnknown(center, half);
    for (unsigned i = 0; i < 8; ++i) {
      const Eigen::Vector3d out(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
      const bool known = node && tree_.nodeChildExists(node, i);
      visit(known ? tree_.getNodeChild(node, i) : nullptr, center + 0.5 * half * out, 0.5 * half);
    }
  }

  /// Adds the part of an unknown cell that lies within the map's box. It is one box, however finely the map's edge
  /// would divide it.
  void addUnknown(const Eigen::Vector3d& center, double half) {
    if (!unknown_) return;
    const Eigen::Vector3d lower = (center.array() - half).max(lower_), upper = (center.array() + half).min(upper_);
    const double rounding = 1e-6 * tree_.getResolution();  // of the map's box
    if ((upper - lower).minCoeff() <= rounding) return;
    add(name_ + "/unknown", 0.5 * (lower + upper), upper - lower);
  }

  void add(const std::string& name, const Eigen::Vector3d& center, const Eigen::Vector3d& size) {
    auto& box = boxes_[{size[0], size[1], size[2]}];
    if (!box) box = detail::makeBox(size, "'" + path_ + "'");
    builder_.add(name, box, Eigen::Isometry3d(Eigen::Translation3d(center)));
  }

  const Tree& tree_;
  const std::string& path_;
  const std::string name_;
  const bool unknown_;
  SceneBuilder& builder_;
  Eigen::Array3d lower_, upper_;
  std::map<std::array<double, 3>, detail::GeometryPtr> boxes_;  ///< cells of one size share their box
};

constexpr std::string_view kOctoMapKeys[] = {"id", "size", "res"};

struct OctoMapHeader {
  std::string id;
  std::size_t size = 0;  ///< nodes
  double resolution = 0;
};

/// Reads up to the line "data", after which the nodes begin.
OctoMapHeader readOctoMapHeader(std::istream& in, const std::string& title, const std::string& where) {
  OctoMapHeader header;
  std::string line;
  std::getline(in, line);
  if (line.rfind(title, 0) != 0) return header;
  std::set<std::string_view> keys;
  std::uint64_t size = 0;
  while (std::getline(in, line) && line != "data") {
    meshes::Words words(line);
    const std::string_view key = words.next(), value = words.next();
    if (key.empty() || key[0] == '#') continue;
    const std::string_view* known = std::find(std::begin(kOctoMapKeys), std::end(kOctoMapKeys), key);
    const bool good = known != std::end(kOctoMapKeys) && words.next().empty() &&
                      (key != "res" || meshes::toNumber(value, header.resolution)) &&
                      (key != "size" || meshes::toCount(value, size));
    if (!good) fail(where, "has a line " + meshes::shown(line) + " in its head that OctoMap files have not");
    if (!keys.insert(*known).second) fail(where, "has two lines '" + std::string(key) + "' in its head");
    if (key == "id") header.id = value;
  }
  header.size = size;
  return header;
}

/// Walks over the bytes of an OctoMap's nodes. OctoMap's own readers go as deep as the file says, though a tree has 16
/// levels, and do not check that the file ends there.
class OctoMapNodes {
 public:
  /// @param node_bytes  of a full tree: those of a node but for its children's; 0: a binary tree.
  OctoMapNodes(std::string_view bytes, std::size_t node_bytes, const std::string& where)
      : bytes_(bytes), node_bytes_(node_bytes), where_(where) {}

  void requireWhole(std::size_t count) {
    if (count > 0) {
      count_ = 1;
      walk(0);
    }
    if (count_ != count) {
      fail(where_, "holds " + std::to_string(count_) + " nodes, its head says " + std::to_string(count));
    }
    if (at_ < bytes_.size()) fail(where_, "goes on after its last node");
  }

 private:
  static constexpr int kLevels = 16;

  unsigned byte() {
    if (at_ >= bytes_.size()) fail(where_, "is cut short");
    return static_cast<unsigned char>(bytes_[at_++]);
  }
  void walk(int level) {
    for (std::size_t k = 0; k < node_bytes_; ++k) byte();
    const unsigned first = byte(), children = node_bytes_ > 0 ? first : first | byte() << 8;
    int inner = 0;
    for (int i = 0; i < 8; ++i) {
      // Two bits a child in a binary tree: 0 none, 3 one with children, else a leaf. One bit in a full one.
      const unsigned child = node_bytes_ > 0 ? 3 * (children >> i & 1) : children >> 2 * i & 3;
      if (child == 0) continue;
      if (level == kLevels) fail(where_, "has a node below the 16 levels of an OctoMap");
      ++count_;
      inner += child == 3;
    }
    if (node_bytes_ == 0 && children == 0) {
      fail(where_, "has a node with neither children nor a word on whether it is occupied");
    }
    for (; inner > 0; --inner) walk(level + 1);
  }

  std::string_view bytes_;
  const std::size_t node_bytes_;
  const std::string& where_;
  std::size_t at_ = 0, count_ = 0;
};

template <class Tree>
void readTree(std::istream& in, const OctoMapHeader& header, bool binary, const std::string& path, bool unknown_cells,
              SceneBuilder& builder) {
  Tree tree(header.resolution);
  if (header.size > 0) binary ? tree.readBinaryData(in) : tree.readData(in);
  if (tree.size() != header.size) {
    fail("'" + path + "'",
         "holds " + std::to_string(tree.size()) + " nodes, its head says " + std::to_string(header.size));
  }
  CellCollector<Tree>(tree, path, unknown_cells, builder).collect();
}

void readOctoMap(const std::string& path, bool binary, bool unknown_cells, SceneBuilder& builder) {
  const std::string where = "'" + path + "'";
  const std::string content = files::read(path);
  std::istringstream in(content, std::ios::binary);
  // OctoMap's readers go on past the end of a file that is cut short; an exception stops them.
  in.exceptions(std::ios::failbit | std::ios::badbit | std::ios::eofbit);
  try {
    const auto header = readOctoMapHeader(in, binary ? "# Octomap OcTree binary file" : "# Octomap OcTree file", where);
    if (header.id.empty() || !(header.resolution > 0)) {
      fail(where, std::string("is not an OctoMap file of the kind ") + (binary ? ".bt" : ".ot"));
    }
    // A colour is three bytes more.
    const std::size_t node_bytes = binary ? 0 : header.id == "ColorOcTree" ? 7 : 4;
    if (header.id == "OcTree" || header.id == "ColorOcTree") {
      const std::string_view nodes = std::string_view(content).substr(static_cast<std::size_t>(in.tellg()));
      OctoMapNodes(nodes, node_bytes, where).requireWhole(header.size);
    }
    if (header.id == "OcTree") {
      readTree<octomap::OcTree>(in, header, binary, path, unknown_cells, builder);
    } else if (header.id == "ColorOcTree" && !binary) {
      readTree<octomap::ColorOcTree>(in, header, binary, path, unknown_cells, builder);
    } else {
      fail(where, "holds a tree of type '" + header.id + "', which is not read");
    }
  } catch (const std::ios::failure&) {
    fail(where, "is not an OctoMap file or is cut short");
  }
  if (builder.scene.obstacles.empty()) builder.scene.notes.push_back(where + ": no cell is an obstacle");
}

/// Says where the joints of a scene's robot stand, and which may not stand there.
void noteJoints(const std::string& path, const KinematicTree& tree, std::vector<std::string>& notes) {
  if (tree.dof() == 0) return;
  std::string beyond;
  for (JointId j = 0; j < tree.numJoints(); ++j) {
    const Joint& joint = tree.joint(j);
    const bool excluded = !joint.mimics && hasLimits(joint) && (joint.lower > 0 || joint.upper < 0);
    if (excluded) beyond += (beyond.empty() ? "" : ", ") + ("'" + joint.name + "'");
  }
  notes.push_back("'" + path + "': its joints stand at 0" +
                  (beyond.empty() ? "" : ", which the limits of these exclude: " + beyond));
}

bool hasFaces(const std::string& path) {
  const std::string content = files::read(path);
  return meshes::plyHasFaces({path, content, "'" + path + "'", nullptr});
}

void readRobot(const std::string& path, SceneBuilder& builder) {
  UrdfOptions options;
  options.solid_meshes = builder.options.solid_meshes;
  options.collada_up_axis = builder.options.collada_up_axis;
  options.packages = builder.options.packages;
  options.import_meshes = builder.options.import_meshes;
  const Robot robot = loadUrdf(path, options);
  std::vector<Eigen::Isometry3d> M_0;
  robot.tree->forwardKinematics(robot.tree->neutralConfiguration(), M_0);
  for (const LinkGeometry& g : robot.geometry) {
    builder.add(robot.tree->linkName(g.link),
                std::const_pointer_cast<fcl::CollisionGeometryd>(g.object->collisionGeometry()),
                M_0[g.link] * g.offset);
  }
  builder.scene.notes.insert(builder.scene.notes.end(), robot.notes.begin(), robot.notes.end());
  noteJoints(path, *robot.tree, builder.scene.notes);
}

}  // namespace

std::vector<std::string> Scene::namesOf(const std::string& object) const {
  std::vector<std::string> names;
  for (const Obstacle& obstacle : obstacles) {
    if (obstacle.name == object || obstacle.shape_of == object) names.push_back(obstacle.name);
  }
  return names;
}

void Scene::addTo(ArticulatedCollisionManager& manager) const {
  auto added = obstacles.begin();
  try {
    for (; added != obstacles.end(); ++added) manager.registerObject(added->object, added->name);
  } catch (...) {
    while (added != obstacles.begin()) manager.unregisterObject((--added)->object.get());
    throw;
  }
}

Scene combineScenes(const std::vector<Scene>& scenes, const KinematicTree& tree) {
  Scene all;
  UniqueNames names;
  for (LinkId link = 0; link < tree.numLinks(); ++link) names.take(tree.linkName(link));
  for (const Scene& scene : scenes) {
    all.notes.insert(all.notes.end(), scene.notes.begin(), scene.notes.end());
    std::map<std::string, std::string> called;  // objects of several shapes, by their first one's name
    for (const Scene::Obstacle& obstacle : scene.obstacles) {
      all.obstacles.push_back({names.take(obstacle.name), obstacle.object, {}});
      if (!obstacle.shape_of.empty())
        all.obstacles.back().shape_of = called.try_emplace(obstacle.shape_of, all.obstacles.back().name).first->second;
      const std::string& name = all.obstacles.back().name;
      if (name == obstacle.name) continue;
      all.notes.push_back("obstacle '" + obstacle.name + "' is called '" + name + "' here, the name is taken");
    }
  }
  return all;
}

Scene loadScene(const std::string& path, const SceneOptions& options) {
  if (!(options.scale > 0 && std::isfinite(options.scale))) {
    throw std::invalid_argument("loadScene: a scale of " + detail::text(options.scale) + " is not above 0 and finite");
  }
  const std::string ending = detail::endingOf(path), stem = fs::path(path).stem().string();
  if (!text::isUtf8(stem)) {
    fail("'" + path + "'", "the file's name, which its obstacles have, has bytes that are no UTF-8; rename the file");
  }
  SceneBuilder builder(options);
  if (ending == ".urdf") {
    readRobot(path, builder);
  } else if (ending == ".scene") {
    MoveItSceneReader(path, builder).read();
  } else if (ending == ".bt" || ending == ".ot") {
    readOctoMap(path, ending == ".bt", options.unknown_cells, builder);
  } else if (ending == ".pcd" || ending == ".xyz" || (ending == ".ply" && !hasFaces(path))) {
    if (!(options.point_radius > 0)) {
      fail("'" + path + "'",
           "is a point cloud: say how large its points are (--point-radius, SceneOptions::point_radius)");
    }
    builder.add(stem, loadPointCloud(path, options.point_radius, &builder.scene.notes), Eigen::Isometry3d::Identity());
  } else {
    builder.add(stem,
                loadMesh(path, Eigen::Vector3d::Ones(), &builder.scene.notes, options.solid_meshes,
                         options.collada_up_axis, options.import_meshes),
                Eigen::Isometry3d::Identity());
  }
  return std::move(builder.scene);
}

}  // namespace fcl_artic
