// SPDX-License-Identifier: BSD-3-Clause
#include "fcl_artic/urdf/urdf.h"

#include <console_bridge/console.h>
#include <tinyxml2.h>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <optional>
#include <set>
#include <sstream>
#include <tuple>

#include "detail.h"
#include "files/files.h"
#include "text/percent.h"
#include "threads/parallel.h"
#include "urdf_elements.h"

namespace fcl_artic {
namespace {

namespace fs = std::filesystem;
using detail::fail;

/// Catches urdfdom's messages while it lives: urdfdom prints its reasons, and returns only null.
class ParserMessages : public console_bridge::OutputHandler {
 public:
  ParserMessages() : lock_(mutex()) { console_bridge::useOutputHandler(this); }
  ~ParserMessages() override { console_bridge::restorePreviousOutputHandler(); }
  void log(const std::string& message, console_bridge::LogLevel level, const char*, int) override {
    if (level == console_bridge::CONSOLE_BRIDGE_LOG_WARN) warnings_.push_back(message);
    if (level == console_bridge::CONSOLE_BRIDGE_LOG_ERROR) errors_.push_back(message);
  }
  const std::vector<std::string>& warnings() const { return warnings_; }
  const std::vector<std::string>& errors() const { return errors_; }
  std::string reason() const {
    std::string all;
    for (const std::string& error : errors_) all += (all.empty() ? "" : "; ") + error;
    return all.empty() ? "urdfdom gives no reason" : all;
  }

 private:
  static std::mutex& mutex() {  // console_bridge has one handler for the process
    static std::mutex instance;
    return instance;
  }
  std::lock_guard<std::mutex> lock_;
  std::vector<std::string> warnings_, errors_;
};

/// Facts about the file that urdfdom does not report. One is the order of its elements: urdfdom sorts them by name. The
/// other is the collision geometry: urdfdom goes on without an element that it cannot read, and a robot without that
/// geometry would pass as free.
struct Document {
  struct Link {
    std::string name;
    std::size_t collisions = 0;
    bool has_visual = false;
  };
  std::vector<Link> links;
  std::vector<std::string> joints, notes;
  std::string xml;  ///< the file without visual and inertial elements, whose errors are of no concern here
};

std::size_t numChildren(const tinyxml2::XMLElement* parent, const char* name = nullptr) {
  std::size_t count = 0;
  for (auto* e = parent ? parent->FirstChildElement(name) : nullptr; e; e = e->NextSiblingElement(name)) ++count;
  return count;
}

void removeChildren(tinyxml2::XMLElement& parent, const char* name) {
  for (auto* e = parent.FirstChildElement(name); e;) {
    tinyxml2::XMLElement* const next = e->NextSiblingElement(name);
    parent.DeleteChild(e);
    e = next;
  }
}

Document::Link readLink(const std::string& name, tinyxml2::XMLElement& element) {
  Document::Link link{name, numChildren(&element, "collision"), numChildren(&element, "visual") > 0};
  for (const char* unused : {"visual", "inertial"}) removeChildren(element, unused);
  return link;
}

/// Notes a limit with one end missing: urdfdom takes that end for 0, by URDF's rules, which is seldom meant.
void noteLimit(const tinyxml2::XMLElement& joint, std::vector<std::string>& notes) {
  const char* const type = joint.Attribute("type");
  const tinyxml2::XMLElement* const limit = joint.FirstChildElement("limit");
  if (!type || !limit || (std::strcmp(type, "revolute") != 0 && std::strcmp(type, "prismatic") != 0)) return;
  const bool lower = limit->Attribute("lower"), upper = limit->Attribute("upper");
  if (lower == upper) return;
  notes.push_back("joint '" + std::string(joint.Attribute("name")) + "' has a limit with '" +
                  (lower ? "lower" : "upper") + "' and no '" + (lower ? "upper" : "lower") +
                  "', which is 0 then by the rules of URDF");
}

Document readDocument(const std::string& where, const std::string& file) {
  tinyxml2::XMLDocument xml;
  tinyxml2::XMLElement& robot = detail::parseUnderstood(where, file, detail::Vocabulary::urdf, xml);
  Document document;
  for (auto* e = robot.FirstChildElement(); e; e = e->NextSiblingElement()) {
    const std::string kind = e->Name();
    const char* name = e->Attribute("name");
    if (kind == "link" && name) document.links.push_back(readLink(name, *e));
    if (kind == "joint" && name) {
      document.joints.push_back(name);
      noteLimit(*e, document.notes);
    }
  }
  removeChildren(robot, "material");  // a material belongs to visual elements only
  tinyxml2::XMLPrinter printer;
  xml.Print(&printer);
  document.xml = printer.CStr();
  return document;
}

urdf::ModelInterfaceSharedPtr parse(const std::string& where, const std::string& xml, std::vector<std::string>& notes) {
  ParserMessages messages;
  urdf::ModelInterfaceSharedPtr model;
  try {
    model = urdf::parseURDF(xml);
  } catch (const std::exception& error) {
    fail(where, error.what());
  }
  if (!model || !messages.errors().empty()) fail(where, messages.reason());
  for (const std::string& warning : messages.warnings()) notes.push_back(where + ": " + warning);
  return model;
}

Eigen::Isometry3d toEigen(const urdf::Pose& pose) {
  const Eigen::Quaterniond rotation(pose.rotation.w, pose.rotation.x, pose.rotation.y, pose.rotation.z);
  return Eigen::Translation3d(pose.position.x, pose.position.y, pose.position.z) * rotation.normalized();
}

Joint toJoint(const std::string& where, const urdf::Joint& in) {
  Joint out;
  out.name = in.name;
  out.parent = in.parent_link_name;
  out.child = in.child_link_name;
  out.origin = toEigen(in.parent_to_joint_origin_transform);
  out.axis = {in.axis.x, in.axis.y, in.axis.z};
  switch (in.type) {
    case urdf::Joint::FIXED:
      out.type = JointType::fixed;
      break;
    case urdf::Joint::REVOLUTE:
      out.type = JointType::revolute;
      break;
    case urdf::Joint::CONTINUOUS:
      out.type = JointType::continuous;
      break;
    case urdf::Joint::PRISMATIC:
      out.type = JointType::prismatic;
      break;
    case urdf::Joint::FLOATING:
      out.type = JointType::floating;
      break;
    case urdf::Joint::PLANAR:
      out.type = JointType::planar;
      break;
    default:
      fail(where, "joint '" + in.name + "' is of an unknown type");
  }
  if (in.limits && KinematicTree::numVariables(out.type) == 1 && out.type != JointType::continuous) {
    out.lower = in.limits->lower;
    out.upper = in.limits->upper;
  }
  if (in.mimic && out.type != JointType::fixed) {
    out.mimics = true;
    out.mimic = {in.mimic->joint_name, in.mimic->multiplier, in.mimic->offset};
  }
  return out;
}

/// The direction of an axis of any length. The axis is scaled near 1 before it is squared; 0 stays 0.
Eigen::Vector3d directionOf(const Eigen::Vector3d& axis) {
  const double largest = axis.cwiseAbs().maxCoeff();
  return largest > 0 ? Eigen::Vector3d((axis / largest).normalized()) : axis;
}

/// A joint that follows one that stands still at `value` stands still too.
void freeze(Joint& joint, double value) {
  const double q = joint.mimic.multiplier * value + joint.mimic.offset;
  if (joint.type == JointType::prismatic) {
    joint.origin.translate(q * directionOf(joint.axis));
  } else {
    joint.origin.rotate(Eigen::AngleAxisd(q, directionOf(joint.axis)));
  }
  joint.type = JointType::fixed;
  joint.mimics = false;
}

/// Mimic joints in an order in which masters come before those that follow them; the file has them in any.
/// @throws std::invalid_argument naming the joints of a circle.
std::vector<Joint> mastersFirst(const std::vector<Joint>& mimics) {
  std::map<std::string, std::size_t> index;
  for (std::size_t i = 0; i < mimics.size(); ++i) index[mimics[i].name] = i;
  std::vector<Joint> sorted;
  enum class State { open, on_chain, placed };
  std::vector<State> state(mimics.size(), State::open);
  for (std::size_t start = 0; start < mimics.size(); ++start) {
    std::vector<std::size_t> chain;  // from a follower to its masters that are not placed yet
    for (std::size_t i = start; state[i] != State::placed;) {
      if (state[i] == State::on_chain) {
        std::string names = "'" + mimics[i].name + "'";
        for (auto it = std::find(chain.begin(), chain.end(), i) + 1; it != chain.end(); ++it) {
          names += " mimics '" + mimics[*it].name + "', which";
        }
        throw std::invalid_argument("joints mimic each other in a circle: " + names + " mimics '" + mimics[i].name +
                                    "'");
      }
      state[i] = State::on_chain;
      chain.push_back(i);
      const auto master = index.find(mimics[i].mimic.master);
      if (master == index.end()) break;
      i = master->second;
    }
    for (auto it = chain.rbegin(); it != chain.rend(); ++it) {
      sorted.push_back(mimics[*it]);
      state[*it] = State::placed;
    }
  }
  return sorted;
}

/// Joins the root link to one that stands for the world, where the options ask for that.
void placeBase(KinematicTree& tree, const std::string& root, const UrdfOptions& options) {
  const std::optional<VirtualJoint>& moving = options.virtual_joint;
  if (moving && options.floating_base) {
    throw std::invalid_argument("the SRDF's virtual joint '" + moving->name +
                                "' moves the root already: leave floating_base out");
  }
  if (moving && moving->child_link != root) {
    throw std::invalid_argument("the SRDF's virtual joint '" + moving->name + "' moves link '" + moving->child_link +
                                "', and the root is '" + root + "'");
  }
  if (!moving && !options.floating_base && options.base.matrix() == Eigen::Matrix4d::Identity()) return;
  std::string world = moving ? moving->parent_frame : "world";
  while (tree.hasLink(world)) world += "_";
  tree.addLink(world);
  Joint joint = Joint::fixed("base_mount", world, root, options.base);
  if (moving) {
    joint.name = moving->name;
    joint.type = moving->type;
    joint.axis = Eigen::Vector3d::UnitZ();
  }
  if (options.floating_base) {
    joint.name = "floating_base";
    joint.type = JointType::floating;
  }
  tree.addJoint(joint);
}

std::shared_ptr<const KinematicTree> makeTree(const std::string& where, const urdf::ModelInterface& model,
                                              const Document& document, const UrdfOptions& options,
                                              std::vector<std::string>& notes) {
  auto tree = std::make_shared<KinematicTree>(model.getName());
  try {
    for (const Document::Link& link : document.links) tree->addLink(link.name);
    placeBase(*tree, model.getRoot()->name, options);
    std::vector<Joint> joints, mimics;  // the latter may stand before their masters in the file, and take no variable
    for (const std::string& name : document.joints) {
      const Joint joint = toJoint(where, *model.getJoint(name));
      if (joint.type == JointType::planar && !directionOf(joint.axis).isApprox(Eigen::Vector3d::UnitZ())) {
        notes.push_back("joint '" + name + "' is planar across its axis, which is not z; some tools ignore the axis");
      }
      const bool limitable = KinematicTree::numVariables(joint.type) == 1 && joint.type != JointType::continuous;
      if (limitable && !joint.mimics && joint.lower == 0 && joint.upper == 0) {
        notes.push_back("joint '" + name + "' has limits that are both 0, and is taken to have none");
      } else if (limitable && !joint.mimics && joint.lower > joint.upper) {
        notes.push_back("joint '" + name + "' has its lower limit above its upper one, and is taken to have none");
      }
      (joint.mimics ? mimics : joints).push_back(joint);
    }
    tree->addJoints(joints);
    std::map<std::string, double> still;  // mimics that stand still, and where
    mimics = mastersFirst(mimics);
    for (Joint& joint : mimics) {
      const auto found = still.find(joint.mimic.master);
      const urdf::JointConstSharedPtr master = model.getJoint(joint.mimic.master);
      const bool can_follow = KinematicTree::numVariables(joint.type) == 1 && !joint.axis.isZero(0);
      if (can_follow && (found != still.end() || (master && master->type == urdf::Joint::FIXED))) {
        const double value = found != still.end() ? found->second : 0;
        still[joint.name] = joint.mimic.multiplier * value + joint.mimic.offset;
        notes.push_back("joint '" + joint.name + "' mimics the fixed joint '" + joint.mimic.master +
                        "' and is fixed too");
        freeze(joint, value);
      }
    }
    tree->addJoints(mimics);
  } catch (const std::invalid_argument& error) {
    fail(where, error.what());
  }
  return tree;
}

/// Folders that an environment variable lists, separated by colons.
std::vector<fs::path> foldersOf(const char* variable) {
  const char* value = std::getenv(variable);
  std::istringstream list(value ? value : "");
  std::vector<fs::path> folders;
  for (std::string folder; std::getline(list, folder, ':');) {
    if (!folder.empty()) folders.push_back(folder);
  }
  return folders;
}

/// The folder from which a URDF's relative paths begin: its own, or the present one if a shell passes the file on, as
/// `<(xacro ...)`.
fs::path folderOf(const std::string& urdf_path) {
  const auto begins = [&](const char* with) { return urdf_path.rfind(with, 0) == 0; };
  const bool passed_on = urdf_path == "/dev/stdin" || begins("/dev/fd/") || begins("/proc/");
  return passed_on ? fs::current_path() : fs::absolute(urdf_path).parent_path();
}

/// The same folder, by a path whose parents can be read off it: only the disk knows the folder above a symbolic link.
fs::path withoutDots(const fs::path& folder) {
  if (std::find(folder.begin(), folder.end(), "..") == folder.end()) return folder.lexically_normal();
  std::error_code error;
  const fs::path there = fs::canonical(folder, error);
  return error ? folder : there;
}

/// The name that a folder's package.xml gives; empty if it has none that can be read.
std::string packageName(const fs::path& folder) {
  std::error_code error;
  const fs::path file = folder / "package.xml";
  if (!fs::is_regular_file(file, error)) return {};
  tinyxml2::XMLDocument xml;
  if (xml.LoadFile(file.c_str()) != tinyxml2::XML_SUCCESS || !xml.RootElement()) return {};
  const tinyxml2::XMLElement* name = xml.RootElement()->FirstChildElement("name");
  const char* text = name ? name->GetText() : nullptr;
  std::istringstream word(text ? text : "");  // without blanks around it
  std::string out;
  word >> out;
  return out;
}

/// Turns the paths of a URDF into paths of files.
class MeshFinder {
 public:
  MeshFinder(const std::string& urdf_path, const UrdfOptions& options)
      : folder_(folderOf(urdf_path)), packages_(options.packages) {}

  /// Notes on unusual paths that were found, one line each.
  const std::vector<std::string>& notes() const { return notes_; }

  std::string find(const std::string& where, const std::string& uri) {
    const auto after = [&](const std::string& scheme) { return uri.substr(scheme.size()); };
    const auto starts = [&](const std::string& scheme) { return uri.rfind(scheme, 0) == 0; };
    if (starts("package://")) return inPackage(where, uri, after("package://"));
    if (starts("file://")) return existing(where, inFileUrl(where, uri));
    if (uri.find("://") != std::string::npos) fail(where, "mesh '" + uri + "': only file:// and package:// are read");
    return existing(where, folder_ / uri);  // an absolute path stays as it is
  }

 private:
  static bool isThere(const fs::path& path) {
    std::error_code error;
    return fs::exists(path, error);
  }
  static std::string existing(const std::string& where, const fs::path& path) {
    if (!isThere(path)) fail(where, "mesh '" + path.string() + "': no such file");
    return path.string();  // as it stands: a ".." after a link is another folder than the text without both
  }
  /// file:///PATH or file://localhost/PATH, %20 and the like decoded.
  static std::string inFileUrl(const std::string& where, const std::string& uri) {
    std::string path = uri.substr(std::string("file://").size());
    if (path.rfind("localhost/", 0) == 0) path.erase(0, std::string("localhost").size());
    const std::optional<std::string> decoded = text::percentDecoded(path);
    if (!decoded) fail(where, "mesh '" + uri + "': a % without two hexadecimal digits after it; write %25");
    if (decoded->empty() || decoded->front() != '/') {
      fail(where, "mesh '" + uri + "': a file: URL needs an absolute path, file:///PATH");
    }
    return *decoded;
  }

  std::string inPackage(const std::string& where, const std::string& uri, const std::string& path) {
    const auto begin = std::min(path.find_first_not_of('/'), path.size()), slash = path.find('/', begin);
    const auto file = path.find_first_not_of('/', slash);
    if (file == std::string::npos) fail(where, "mesh '" + uri + "': names no file");
    const std::string name = path.substr(begin, slash - begin), rest = path.substr(file);
    const std::vector<fs::path>& folders = foldersOfPackage(name);
    std::vector<std::string> there;
    for (const fs::path& folder : folders) {
      if (isThere(folder / rest)) there.push_back((folder / rest).string());
    }
    if (!there.empty()) {
      noteOther(uri, there);
      return there.front();
    }
    std::string reason = "mesh '" + uri + "': ";
    if (packages_.count(name)) fail(where, reason + "no such file in '" + folders.front().string() + "'");
    if (folders.empty()) {
      reason += "there is no package '" + name + "': ";
    } else {
      reason += "no such file in";
      for (const fs::path& folder : folders)
        reason += (&folder == &folders.front() ? " '" : ", '") + folder.string() + "'";
      reason += "; also ";
    }
    fail(where, reason + "searched for '" + name + "' by folder name and by package.xml at and above '" +
                    folder_.string() + "', below " + listed("ROS_PACKAGE_PATH") + ", in share/ of " +
                    listed("AMENT_PREFIX_PATH") + ". Say where it is: --package " + name +
                    "=DIR (C++: UrdfOptions::packages, Python: packages={'" + name + "': 'DIR'})");
  }
  /// Notes a package that stands in several folders, if the folders' files differ: it is not known which one is meant.
  void noteOther(const std::string& uri, const std::vector<std::string>& there) {
    if (!noted_.insert(uri).second) return;
    const std::string first = contentOf(there.front());
    const auto other =
        std::find_if(there.begin() + 1, there.end(), [&](const std::string& path) { return contentOf(path) != first; });
    if (other == there.end()) return;
    notes_.push_back("mesh '" + uri + "' is taken from '" + there.front() + "'; '" + *other +
                     "' is another file, which other programs may take (--package NAME=DIR says which is meant)");
  }
  static std::string contentOf(const std::string& path) {
    try {
      return files::read(path);
    } catch (const std::runtime_error&) {
      return {};  // a folder, or one that may not be read
    }
  }
  static std::string listed(const char* variable) {
    const char* value = std::getenv(variable);
    return std::string(variable) + (value && *value ? " '" + std::string(value) + "'" : " (which is not set)");
  }

  /// All folders that may be the package, the likeliest first.
  const std::vector<fs::path>& foldersOfPackage(const std::string& name) {
    const auto [entry, is_new] = found_.try_emplace(name);
    std::vector<fs::path>& folders = entry->second;
    if (!is_new) return folders;
    if (const auto it = packages_.find(name); it != packages_.end()) {
      folders.push_back(it->second);
      return folders;
    }
    const auto add = [&](const fs::path& folder) {
      std::error_code error;
      if (fs::is_directory(folder, error) && std::find(folders.begin(), folders.end(), folder) == folders.end()) {
        folders.push_back(folder);
      }
    };
    for (fs::path dir = withoutDots(folder_);; dir = dir.parent_path()) {
      if (dir.filename() == name || packageName(dir) == name) add(dir);
      add(dir / name);
      if (dir == dir.parent_path()) break;
    }
    for (const fs::path& folder : foldersOf("ROS_PACKAGE_PATH")) {
      int left = kMaxFolders;
      searchBelow(folder, name, kDeepest, left, add);
    }
    for (const fs::path& prefix : foldersOf("AMENT_PREFIX_PATH")) add(prefix / "share" / name);
    return folders;
  }

  /// Looks for a package in a folder and those below it, as rospack does: not within packages, nor where a file says
  /// that there are none.
  /// @param[in,out] left number of folders that may yet be looked at: a path may lead to all of a disk.
  template <typename Add>
  static void searchBelow(const fs::path& folder, const std::string& name, int depth, int& left, const Add& add) {
    if (--left < 0) return;
    const std::string package = packageName(folder);
    if (package == name || (package.empty() && folder.filename() == name)) add(folder);
    if (!package.empty() || depth == 0) return;
    for (const char* stop : {"CATKIN_IGNORE", "COLCON_IGNORE", "AMENT_IGNORE", "rospack_nosubdirs"}) {
      if (isThere(folder / stop)) return;
    }
    std::error_code error;
    std::vector<fs::path> below;
    for (fs::directory_iterator it(folder, fs::directory_options::skip_permission_denied, error), end;
         !error && it != end; it.increment(error)) {
      std::error_code ignored;
      if (it->path().filename().string()[0] != '.' && it->is_directory(ignored)) below.push_back(it->path());
    }
    std::sort(below.begin(), below.end());  // a folder lists its files in any order
    for (const fs::path& next : below) searchBelow(next, name, depth - 1, left, add);
  }

  static constexpr int kDeepest = 12, kMaxFolders = 100000;  // a link may lead in a circle
  fs::path folder_;
  std::vector<std::string> notes_;
  std::set<std::string> noted_;  ///< URLs
  std::map<std::string, std::string> packages_;
  std::map<std::string, std::vector<fs::path>> found_;
};

/// Makes geometries of a robot, each mesh file and scale once.
class GeometryFactory {
 public:
  GeometryFactory(MeshFinder finder, const UrdfOptions& options, std::vector<std::string>& notes)
      : finder_(std::move(finder)), options_(options), notes_(notes) {}

  /// Reads all meshes, over threads: most of the time of loading a robot is FCL's for its trees. If a mesh has a fault,
  /// the exception comes when the mesh is asked for.
  void readMeshes(const urdf::ModelInterface& model) {
    for (const auto& [name, link] : model.links_) {
      for (const urdf::CollisionSharedPtr& collision : link->collision_array) {
        if (!collision->geometry || collision->geometry->type != urdf::Geometry::MESH) continue;
        const auto& mesh = static_cast<const urdf::Mesh&>(*collision->geometry);
        try {
          meshes_.try_emplace(keyOf(finder_.find("", mesh.filename), mesh));
        } catch (const std::runtime_error&) {
          // make() says that it is not found
        }
      }
    }
    std::vector<decltype(meshes_)::value_type*> unread;
    for (auto& entry : meshes_) unread.push_back(&entry);
    parallelFor(unread.size(), 0, [&](std::size_t k) { read(unread[k]->first, unread[k]->second); });
    notes_.insert(notes_.end(), finder_.notes().begin(), finder_.notes().end());
  }

  struct Made {
    detail::GeometryPtr geometry;
    std::string source;
  };
  /// After readMeshes().
  Made make(const std::string& where, const urdf::Geometry& in) {
    switch (in.type) {
      case urdf::Geometry::BOX: {
        const urdf::Vector3& size = static_cast<const urdf::Box&>(in).dim;
        return {detail::makeBox({size.x, size.y, size.z}, where), "box"};
      }
      case urdf::Geometry::SPHERE:
        return {detail::makeSphere(static_cast<const urdf::Sphere&>(in).radius, where), "sphere"};
      case urdf::Geometry::CYLINDER: {
        const auto& cylinder = static_cast<const urdf::Cylinder&>(in);
        return {detail::makeCylinder(cylinder.radius, cylinder.length, where), "cylinder"};
      }
      case urdf::Geometry::MESH:
        return mesh(where, static_cast<const urdf::Mesh&>(in));
    }
    fail(where, "has a geometry of an unknown kind");
  }

 private:
  using Key = std::tuple<std::string, double, double, double>;  ///< path and scale
  struct Mesh {
    detail::GeometryPtr geometry;
    std::vector<std::string> notes;
    std::string error;
    bool used = false;
  };

  static Key keyOf(const std::string& path, const urdf::Mesh& in) { return {path, in.scale.x, in.scale.y, in.scale.z}; }

  void read(const Key& key, Mesh& mesh) const {
    const auto& [path, x, y, z] = key;
    try {
      mesh.geometry = loadMesh(path, {x, y, z}, &mesh.notes, options_.solid_meshes, options_.collada_up_axis,
                               options_.import_meshes);
    } catch (const std::runtime_error& error) {
      mesh.error = error.what();
    }
  }

  Made mesh(const std::string& where, const urdf::Mesh& in) {
    const std::string path = finder_.find(where, in.filename);
    Mesh& mesh = meshes_.at(keyOf(path, in));
    if (!mesh.geometry) fail(where, mesh.error);
    if (!mesh.used) notes_.insert(notes_.end(), mesh.notes.begin(), mesh.notes.end());
    mesh.used = true;
    return {mesh.geometry, path};
  }

  MeshFinder finder_;
  const UrdfOptions& options_;
  std::vector<std::string>& notes_;
  std::map<Key, Mesh> meshes_;
};

/// Whether it is a sphere of radius 0, by which makers of robots give simulators a point of contact.
bool isPoint(const urdf::Geometry& geometry) {
  return geometry.type == urdf::Geometry::SPHERE && static_cast<const urdf::Sphere&>(geometry).radius == 0;
}

}  // namespace

void Robot::addTo(ArticulatedCollisionManager& manager) const {
  if (!tree) throw std::invalid_argument("Robot::addTo: the robot has no tree");
  // Geometries go by numbers of links, which mean other links in another robot.
  const KinematicTree& other = manager.tree();
  for (LinkId link = 0; link < tree->numLinks(); ++link) {
    if (link < other.numLinks() && tree->linkName(link) == other.linkName(link)) continue;
    throw std::invalid_argument("Robot::addTo: the manager is one of robot '" + other.name() + "', not of '" +
                                tree->name() + "': its link " + std::to_string(link) + " is " +
                                (link < other.numLinks() ? "'" + other.linkName(link) + "'" : "missing") + ", not '" +
                                tree->linkName(link) + "'");
  }
  auto bound = geometry.begin();
  try {
    for (; bound != geometry.end(); ++bound) manager.bind(bound->link, bound->object, bound->offset);
    manager.setAllowedCollisions(allowed);
    manager.setLinkPairProofs(proofs);
  } catch (...) {
    while (bound != geometry.begin()) manager.unbind((--bound)->object.get());
    throw;
  }
}

Robot loadUrdf(const std::string& path, const UrdfOptions& options) {
  const std::string where = "'" + path + "'";
  const Document document = readDocument(where, files::read(path));
  Robot robot;
  robot.notes = document.notes;
  const urdf::ModelInterfaceSharedPtr model = parse(where, document.xml, robot.notes);
  robot.tree = makeTree(where, *model, document, options, robot.notes);

  GeometryFactory factory(MeshFinder(path, options), options, robot.notes);
  factory.readMeshes(*model);
  for (std::size_t i = 0; i < document.links.size(); ++i) {
    const LinkId id = static_cast<LinkId>(i);  // the tree's links are those of the file, in its order
    const Document::Link& in_file = document.links[i];
    const urdf::Link& link = *model->getLink(in_file.name);
    const std::string part = where + ": link '" + link.name + "'";
    if (link.collision_array.size() != in_file.collisions) fail(part, "has a collision element that cannot be read");
    for (const urdf::CollisionSharedPtr& collision : link.collision_array) {
      if (isPoint(*collision->geometry)) {
        robot.notes.push_back("link '" + link.name + "' has a sphere of radius 0: it is no body, and is not checked");
        continue;
      }
      const auto made = factory.make(part, *collision->geometry);
      robot.geometry.push_back(
          {id, toEigen(collision->origin), std::make_shared<fcl::CollisionObjectd>(made.geometry), made.source});
    }
    if (in_file.collisions == 0 && in_file.has_visual) {
      robot.notes.push_back("link '" + link.name + "' has a visual but no collision geometry: it is not checked");
    }
  }
  if (robot.geometry.empty()) robot.notes.push_back("robot '" + robot.tree->name() + "' has no collision geometry");
  return robot;
}

}  // namespace fcl_artic
