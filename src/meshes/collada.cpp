// SPDX-License-Identifier: BSD-3-Clause
// COLLADA 1.4 and 1.5: the polygons that the scene shows, where its nodes have them.
#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <set>

#include "meshes/parts.h"
#include "meshes/readers.h"
#include "meshes/text.h"
#include "text/xml_root.h"

namespace fcl_artic::meshes {
namespace {

using Xml = tinyxml2::XMLElement;

class Collada {
 public:
  Collada(const Source& source, bool turn) : source_(source), yield_(source) {
    const std::string wrong = text::parseXml(withoutMark(source), "COLLADA", "a COLLADA file", xml_);
    if (!wrong.empty()) source.refuse(wrong);
    root_ = xml_.RootElement();
    keepIds(*root_);
    const Asset asset = assetOf(*root_, {});
    if (asset.up != 'z') noteUpAxis(asset.up, asset.says_up, "COLLADA", turn, source);
    world_.linear() = asset.metre * (turn ? turnUp(asset.up) : Eigen::Matrix3d(Eigen::Matrix3d::Identity()));
    asset_ = asset;
  }

  TriangleSoup read() {
    const Xml* scene = nullptr;
    for (const Xml* e = root_->FirstChildElement(); e; e = e->NextSiblingElement()) {
      const std::string_view name = e->Name();
      if (name == "scene") {
        if (scene) refuse(*e, "is there twice");
        scene = e;
      } else if (name == "library_animations") {
        if (hasBelow(*e, "channel")) refuse(*e, "moves what it holds: save it without animations");
      } else if (!isOneOf(name, {"asset", "library_geometries", "library_visual_scenes", "library_nodes", "extra"}) &&
                 !isPlainLibrary(name)) {
        refuseUnknown(*e);
      }
      if (isOneOf(name, {"library_geometries", "library_visual_scenes", "library_nodes"})) assetOf(*e, asset_);
    }
    if (!scene) source_.refuse("has no <scene>, which says what of it is shown and where");
    const Xml* shown_scene =
        only(*scene, "instance_visual_scene", {"instance_physics_scene", "instance_kinematics_scene", "extra"});
    const Xml& visual = target(*shown_scene, "url", {"visual_scene"});
    eachChild(visual, {"asset", "node", "evaluate_scene", "extra"}, [&](const Xml& e) {
      if (is(e, "asset")) assetOf(visual, asset_);
      if (is(e, "node")) addNode(e, world_, nullptr, 0);
    });
    const std::size_t all = countBelow(*root_, "geometry");
    if (parts_.size() < all) {
      source_.note(counted(all - parts_.size(), "geometry element") + " of " + std::to_string(all) +
                   " left out: the scene does not show them");
    }
    return std::move(soup_);
  }

 private:
  struct Asset {
    double metre = 1;  ///< length of the unit, m
    char up = 'y';
    bool says_up = false;
  };
  using Names = std::initializer_list<std::string_view>;

  static bool is(const Xml& e, const char* name) { return std::strcmp(e.Name(), name) == 0; }
  static bool isPlainLibrary(std::string_view name) {
    return isOneOf(
        name, {"library_animation_clips", "library_cameras", "library_controllers", "library_effects", "library_images",
               "library_lights", "library_materials", "library_force_fields", "library_physics_materials",
               "library_physics_models", "library_physics_scenes", "library_formulas", "library_joints",
               "library_kinematics_models", "library_kinematics_scenes", "library_articulated_systems"});
  }

  [[noreturn]] void refuse(const Xml& e, const std::string& reason) const {
    source_.refuse("line " + std::to_string(e.GetLineNum()) + ": <" + e.Name() + "> " + reason);
  }
  [[noreturn]] void refuseUnknown(const Xml& e) const { refuse(e, "is not read"); }

  /// Calls for each child; refuses those of other names.
  template <class F>
  void eachChild(const Xml& parent, Names names, const F& call) const {
    for (const Xml* e = parent.FirstChildElement(); e; e = e->NextSiblingElement()) {
      if (!isOneOf(e->Name(), names)) refuseUnknown(*e);
      call(*e);
    }
  }
  /// The one child of this name; others may have the other names only.
  const Xml* only(const Xml& parent, std::string_view name, Names others) const {
    const Xml* found = nullptr;
    for (const Xml* e = parent.FirstChildElement(); e; e = e->NextSiblingElement()) {
      if (e->Name() != name) {
        if (!isOneOf(e->Name(), others)) refuseUnknown(*e);
        continue;
      }
      if (found) refuse(*e, "is there twice");
      found = e;
    }
    if (!found) refuse(parent, "has no <" + std::string(name) + ">");
    return found;
  }

  void keepIds(const Xml& e) {
    if (const char* id = e.Attribute("id")) {
      const auto [entry, is_new] = ids_.try_emplace(id, &e);
      if (!is_new) entry->second = nullptr;
    }
    for (const Xml* child = e.FirstChildElement(); child; child = child->NextSiblingElement()) keepIds(*child);
  }
  static bool hasBelow(const Xml& e, const char* name) { return countBelow(e, name) > 0; }
  static std::size_t countBelow(const Xml& e, const char* name) {
    std::size_t count = is(e, name);
    for (const Xml* child = e.FirstChildElement(); child; child = child->NextSiblingElement())
      count += countBelow(*child, name);
    return count;
  }

  /// The element that an attribute such as url="#id" names.
  const Xml& target(const Xml& e, const char* attribute, Names kinds) const {
    const char* url = e.Attribute(attribute);
    if (!url) refuse(e, std::string("has no ") + attribute);
    if (url[0] != '#') refuse(e, "refers to another file, " + shown(url) + ": put all in one file");
    const auto found = ids_.find(std::string_view(url + 1));
    if (found == ids_.end()) refuse(e, "refers to " + shown(url) + ", which isn't there");
    if (!found->second) refuse(e, "refers to " + shown(url) + ", which is there twice");
    if (!isOneOf(found->second->Name(), kinds)) {
      refuse(e, "refers to " + shown(url) + ", which is a <" + found->second->Name() + ">");
    }
    return *found->second;
  }

  /// All text of an element without children.
  std::string textOf(const Xml& e) const {
    std::string text;
    for (const tinyxml2::XMLNode* n = e.FirstChild(); n; n = n->NextSibling()) {
      if (n->ToElement()) refuseUnknown(*n->ToElement());
      if (n->ToText()) text += n->Value();
    }
    return text;
  }
  std::vector<double> numbersOf(const Xml& e) const {
    const std::string text = textOf(e);
    Words words(text);
    std::vector<double> numbers;
    for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
      if (!toNumber(word, numbers.emplace_back())) refuse(e, "has " + shown(word) + " in place of a finite number");
    }
    return numbers;
  }
  std::vector<double> numbersOf(const Xml& e, std::size_t count) const {
    std::vector<double> numbers = numbersOf(e);
    if (numbers.size() == count) return numbers;
    refuse(e, "has " + std::to_string(numbers.size()) + " numbers, not " + std::to_string(count));
  }
  std::vector<std::size_t> countsOf(const Xml& e) const {
    const std::string text = textOf(e);
    Words words(text);
    std::vector<std::size_t> counts;
    std::uint64_t value = 0;
    for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
      if (!toCount(word, value)) refuse(e, "has " + shown(word) + " in place of a whole number from 0");
      counts.push_back(value);
    }
    return counts;
  }
  std::size_t countOf(const Xml& e, const char* attribute, std::size_t otherwise) const {
    const char* text = e.Attribute(attribute);
    std::uint64_t value = 0;
    if (!text) return otherwise;
    if (!toCount(text, value))
      refuse(e, std::string("has ") + attribute + "=" + shown(text) + ", which is no whole number from 0");
    return value;
  }
  std::size_t countOf(const Xml& e, const char* attribute) const {
    if (!e.Attribute(attribute)) refuse(e, std::string("has no ") + attribute);
    return countOf(e, attribute, 0);
  }

  /// The unit and the axis that is up. @param outer  those around it, which it must not change.
  Asset assetOf(const Xml& parent, const Asset& outer) const {
    const bool is_root = &parent == root_;
    Asset out = outer;
    const Xml* asset = parent.FirstChildElement("asset");
    if (asset && asset->NextSiblingElement("asset")) refuse(*asset, "is there twice");
    const Xml *unit = asset ? asset->FirstChildElement("unit") : nullptr,
              *up = asset ? asset->FirstChildElement("up_axis") : nullptr;
    for (const Xml* e : {unit, up}) {
      if (e && e->NextSiblingElement(e->Name())) refuse(*e, "is there twice");
    }
    if (unit) {
      const char* metre = unit->Attribute("meter");
      if (metre && (!toNumber(metre, out.metre) || !(out.metre > 0))) {
        refuse(*unit, "has meter=" + shown(metre) + ", which is no length");
      }
      const char* name = unit->Attribute("name");
      if (!metre && name && !isOneOf(name, {"meter", "metre", "m"})) {
        refuse(*unit, "is called " + shown(name) + ", and does not say how many metres (meter=) that is");
      }
    }
    if (up) {
      const std::string text = textOf(*up);
      const std::string_view axis = Words(text).next();
      if (!isOneOf(axis, {"X_UP", "Y_UP", "Z_UP"})) refuse(*up, "is " + shown(axis) + ", not X_UP, Y_UP or Z_UP");
      out.up = static_cast<char>(axis[0] - 'X' + 'x');
      out.says_up = true;
    }
    if (!is_root && (out.metre != outer.metre || out.up != outer.up)) {
      refuse(*asset, "has another unit or axis that is up than the file's: save it with one");
    }
    return out;
  }

  struct Pose {
    Eigen::Affine3d M = Eigen::Affine3d::Identity();
    const Xml* unread = nullptr;  ///< a transform that is not read
  };

  /// The product of a node's transforms, in their order.
  Pose poseOf(const Xml& node) const {
    Pose pose;
    Eigen::Affine3d& M = pose.M;
    for (const Xml* e = node.FirstChildElement(); e; e = e->NextSiblingElement()) {
      if (is(*e, "translate")) {
        const std::vector<double> x = numbersOf(*e, 3);
        M.translate(Eigen::Vector3d(x[0], x[1], x[2]));
      } else if (is(*e, "scale")) {
        const std::vector<double> x = numbersOf(*e, 3);
        M.scale(Eigen::Vector3d(x[0], x[1], x[2]));
      } else if (is(*e, "rotate")) {
        const std::vector<double> x = numbersOf(*e, 4);
        const Eigen::Vector3d axis(x[0], x[1], x[2]);
        if (x[3] == 0) continue;
        const double size = axis.cwiseAbs().maxCoeff();
        if (!(size > 0)) refuse(*e, "has an axis of length 0");
        constexpr double kDegree = 0.017453292519943295;
        M.rotate(Eigen::AngleAxisd(x[3] * kDegree, (axis / size).normalized()));
      } else if (is(*e, "matrix")) {
        const std::vector<double> x = numbersOf(*e, 16);
        if (x[12] != 0 || x[13] != 0 || x[14] != 0 || x[15] != 1) refuse(*e, "has a last row that is not 0 0 0 1");
        Eigen::Affine3d own;
        own.matrix() = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(x.data());
        M = M * own;
      } else if (is(*e, "skew") || is(*e, "lookat")) {
        pose.unread = e;
      }
    }
    return pose;
  }

  /// @param unread  a transform above that is not read; null: none. It is an error only if there is geometry below:
  /// cameras have such transforms.
  void addNode(const Xml& node, const Eigen::Affine3d& M_parent, const Xml* unread, int depth) {
    constexpr int kDeepest = 100;
    if (depth > kDeepest) refuse(node, "is one of too many: nodes may refer to each other in a circle");
    const auto [pose, is_new] = poses_.try_emplace(&node);  // once: places may refer to it
    if (is_new) pose->second = poseOf(node);
    if (pose->second.unread) unread = pose->second.unread;
    const Eigen::Affine3d M = M_parent * pose->second.M;
    eachChild(node,
              {"asset", "translate", "scale", "rotate", "matrix", "skew", "lookat", "node", "instance_node",
               "instance_geometry", "instance_controller", "instance_camera", "instance_light", "extra"},
              [&](const Xml& e) {
                yield_.add(16);  // to go through a node takes as long, and it has 4 bytes or more
                if (is(e, "asset")) assetOf(node, asset_);
                if (is(e, "node")) addNode(e, M, unread, depth + 1);
                if (is(e, "instance_node")) addNode(target(e, "url", {"node"}), M, unread, depth + 1);
                if (is(e, "instance_controller")) refuse(e, "bends a mesh by bones or shapes: save it as it stands");
                if (!is(e, "instance_geometry")) return;
                eachChild(e, {"bind_material", "extra"}, [](const Xml&) {});
                if (unread) refuse(*unread, "is not read: save it with a matrix");
                const Xml& geometry = target(e, "url", {"geometry"});
                const auto [part, is_new] = parts_.try_emplace(&geometry);
                if (is_new) readGeometry(geometry, part->second);
                addPart(part->second, M, source_, yield_, soup_);
              });
  }

  void readGeometry(const Xml& geometry, Part& part) {
    for (const char* other : {"convex_mesh", "spline", "brep"}) {
      if (const Xml* e = geometry.FirstChildElement(other)) refuse(*e, "is not read: save it as a mesh");
    }
    if (geometry.FirstChildElement("asset")) assetOf(geometry, asset_);
    const Xml& mesh = *only(geometry, "mesh", {"asset", "extra"});
    // Several primitives may refer to several lists of vertices; mostly it is one.
    std::map<const Xml*, std::size_t> first;
    eachChild(mesh,
              {"source", "vertices", "triangles", "polylist", "polygons", "trifans", "tristrips", "lines", "linestrips",
               "extra"},
              [&](const Xml& e) {
                if (is(e, "source") || is(e, "vertices") || is(e, "extra")) return;
                readPrimitive(e, first, part);
              });
  }

  void readPrimitive(const Xml& e, std::map<const Xml*, std::size_t>& first, Part& part) {
    eachChild(e, {"input", "p", "ph", "vcount", "extra"}, [&](const Xml& child) {
      if (is(child, "ph")) refuse(child, "is a polygon with holes, which is not read: cut it into triangles");
      if (is(child, "vcount") && !is(e, "polylist")) refuseUnknown(child);
    });
    const std::size_t count = countOf(e, "count");
    const Xml* vertices = nullptr;
    std::size_t offset = 0, stride = 1;
    for (const Xml* input = e.FirstChildElement("input"); input; input = input->NextSiblingElement("input")) {
      const std::size_t at = countOf(*input, "offset");
      if (at > 1000) refuse(*input, "has an offset of more than 1000");
      stride = std::max(stride, at + 1);
      const char* semantic = input->Attribute("semantic");
      if (!semantic) refuse(*input, "has no semantic");
      if (std::strcmp(semantic, "VERTEX") != 0) continue;
      if (vertices) refuse(*input, "is the second one of vertices");
      vertices = &target(*input, "source", {"vertices"});
      offset = at;
    }
    std::vector<std::vector<std::size_t>> lists;  // of each <p>, numbers of vertices
    std::size_t all = 0;
    for (const Xml* p = e.FirstChildElement("p"); p; p = p->NextSiblingElement("p")) {
      const std::vector<std::size_t> numbers = countsOf(*p);
      if (numbers.size() % stride != 0)
        refuse(*p, "has " + std::to_string(numbers.size()) + " numbers, " + std::to_string(stride) +
                       " for each corner are needed");
      std::vector<std::size_t>& list = lists.emplace_back();
      for (std::size_t k = offset; k < numbers.size(); k += stride) list.push_back(numbers[k]);
      all += list.size();
    }
    if (lists.empty() && count == 0) return;
    if (!vertices) refuse(e, "has no input of vertices");
    const std::size_t begin = firstOf(*vertices, first, part);
    for (std::vector<std::size_t>& list : lists) {
      for (std::size_t& corner : list) {
        if (corner >= lengths_[vertices])
          refuse(e, "has a face with vertex " + std::to_string(corner) + " of " + std::to_string(lengths_[vertices]));
        corner += begin;
      }
    }
    const auto requireLists = [&](std::size_t wanted) {
      if (lists.size() != wanted)
        refuse(e, "says that it has " + std::to_string(wanted) + ", it has " + std::to_string(lists.size()));
    };
    const auto requireCorners = [&](std::size_t wanted) {
      if (lists.size() > 1) refuse(e, "has more than one <p>");
      if (all != wanted)
        refuse(e, "needs " + std::to_string(wanted) + " corners by what it says, it has " + std::to_string(all));
    };
    if (is(e, "triangles")) {
      requireCorners(3 * count);
      for (std::size_t k = 0; k < all; k += 3) part.addFace({lists[0][k], lists[0][k + 1], lists[0][k + 2]});
    } else if (is(e, "lines")) {
      requireCorners(2 * count);
      part.lines += count;
    } else if (is(e, "polylist")) {
      const Xml* vcount = e.FirstChildElement("vcount");
      if (!vcount || vcount->NextSiblingElement("vcount")) refuse(e, "is to have one <vcount>");
      const std::vector<std::size_t> counts = countsOf(*vcount);
      if (counts.size() != count)
        refuse(*vcount, "has " + std::to_string(counts.size()) + " numbers, not " + std::to_string(count));
      std::size_t sum = 0;
      for (const std::size_t n : counts) sum += n;
      requireCorners(sum);
      if (!lists.empty()) part.corners.insert(part.corners.end(), lists[0].begin(), lists[0].end());
      sum = part.corners.size() - sum;
      for (const std::size_t n : counts) part.ends.push_back(sum += n);
    } else {
      requireLists(count);
      for (const std::vector<std::size_t>& list : lists) addList(e, list, part);
    }
  }

  void addList(const Xml& e, const std::vector<std::size_t>& list, Part& part) const {
    if (is(e, "polygons")) {
      part.corners.insert(part.corners.end(), list.begin(), list.end());
      part.ends.push_back(part.corners.size());
      return;
    }
    if (is(e, "linestrips")) {
      ++part.lines;
      return;
    }
    if (list.size() < 3) refuse(e, "has a strip or fan of less than 3 corners");
    for (std::size_t k = 0; k + 2 < list.size(); ++k) {
      if (is(e, "trifans")) {
        part.addFace({list[0], list[k + 1], list[k + 2]});
      } else {
        part.addFace({list[k + k % 2], list[k + 1 - k % 2], list[k + 2]});  // every second one is turned round
      }
    }
  }

  /// Reads the places of a list of vertices, once. @return the number of the first one in the part.
  std::size_t firstOf(const Xml& vertices, std::map<const Xml*, std::size_t>& first, Part& part) {
    const auto [entry, is_new] = first.try_emplace(&vertices, part.vertices.size());
    if (!is_new) return entry->second;
    const Xml* position = nullptr;
    eachChild(vertices, {"input", "extra"}, [&](const Xml& input) {
      const char* semantic = input.Attribute("semantic");
      if (!semantic || std::strcmp(semantic, "POSITION") != 0) return;
      if (position) refuse(input, "is the second one of places");
      position = &input;
    });
    if (!position) refuse(vertices, "has no input POSITION");
    const Xml& source = target(*position, "source", {"source"});
    if (source.FirstChildElement("asset")) assetOf(source, asset_);
    const Xml* common = source.FirstChildElement("technique_common");
    if (!common) refuse(source, "has no <technique_common>");
    if (common->NextSiblingElement("technique_common")) refuse(source, "has more than one <technique_common>");
    const Xml& accessor = *only(*common, "accessor", {});
    const std::vector<double>& values = valuesOf(target(accessor, "source", {"float_array", "int_array"}));
    const std::size_t count = countOf(accessor, "count"), offset = countOf(accessor, "offset", 0),
                      stride = countOf(accessor, "stride", 1);
    std::size_t columns[3], column = 0;
    std::string names;
    eachChild(accessor, {"param"}, [&](const Xml& param) {
      const char* name = param.Attribute("name");
      if (name && name[0]) {
        const std::string_view all = "XYZ";
        const std::size_t k = all.find(name[0]);
        if (name[1] || k == all.npos) refuse(param, "is " + shown(name) + ", not X, Y or Z");
        columns[k] = column;
        names += name;
      }
      ++column;
    });
    std::sort(names.begin(), names.end());
    if (names != "XYZ") refuse(accessor, "does not have X, Y and Z, each once");
    if (column > stride) refuse(accessor, "has a stride below the number of its params");
    if (offset > values.size() || (count > 0 && (values.size() - offset) / stride < count)) {
      refuse(accessor, "has more entries than its array");
    }
    yield_.add(count);
    for (std::size_t i = 0; i < count; ++i) {
      const double* at = values.data() + offset + i * stride;
      part.vertices.emplace_back(at[columns[0]], at[columns[1]], at[columns[2]]);
    }
    lengths_[&vertices] = count;
    return entry->second;
  }

  /// Read once: many sources may refer to it.
  const std::vector<double>& valuesOf(const Xml& array) {
    const auto [entry, is_new] = values_.try_emplace(&array);
    std::vector<double>& values = entry->second;
    if (is_new) values = numbersOf(array);
    const std::size_t count = countOf(array, "count");
    if (values.size() != count)
      refuse(array, "says that it has " + std::to_string(count) + " numbers, it has " + std::to_string(values.size()));
    return values;
  }

  const Source& source_;
  tinyxml2::XMLDocument xml_;
  const Xml* root_ = nullptr;
  std::map<std::string_view, const Xml*> ids_;  ///< null: there twice
  Asset asset_;
  Eigen::Affine3d world_ = Eigen::Affine3d::Identity();
  std::map<const Xml*, Part> parts_;
  std::map<const Xml*, std::size_t> lengths_;         ///< of lists of vertices
  std::map<const Xml*, std::vector<double>> values_;  ///< of arrays
  std::map<const Xml*, Pose> poses_;                  ///< of nodes
  Yield yield_;
  TriangleSoup soup_;
};

}  // namespace

TriangleSoup readCollada(const Source& source, bool turn) {
  return Collada(source, turn).read();
}

}  // namespace fcl_artic::meshes
