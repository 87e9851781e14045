// SPDX-License-Identifier: BSD-3-Clause
// glTF 2.0: the triangles that the scene shows, where its nodes have them.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <map>
#include <set>

#include "files/files.h"
#include "meshes/parts.h"
#include "meshes/readers.h"
#include "meshes/scalar.h"
#include "meshes/text.h"
#include "text/document.h"

namespace fcl_artic::meshes {
namespace {

using text::Json;
using Keys = std::initializer_list<std::string_view>;

/// Materials, textures, lights and texts: no part of the surface.
bool isPlainExtension(std::string_view name) {
  for (const std::string_view start :
       {"KHR_materials_", "KHR_texture_", "EXT_texture_", "MSFT_texture_", "KHR_lights_", "EXT_lights_", "KHR_xmp"}) {
    if (name.substr(0, start.size()) == start) return true;
  }
  return false;
}

std::uint32_t little32(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;  // of the little end, as this machine's are
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

class Gltf {
 public:
  Gltf(const Source& source, bool turn) : source_(source), yield_(source) {
    noteUpAxis('y', false, "glTF", turn, source);
    if (turn) world_.linear() = turnUp('y');
    std::string_view text = source.content;
    if (text.substr(0, 4) == "glTF") text = unpack(text);
    parse(text);
  }

  TriangleSoup read() {
    checkHead();
    const Json& scenes = listOf("scenes");
    const bool chosen = root_.contains("scene");
    if (scenes.empty() || (!chosen && scenes.size() > 1)) source_.refuse("does not say which scene of it is shown");
    const std::size_t number = chosen ? indexOf(root_, "scene", "scenes", "the file") : 0;
    if (scenes.size() > 1)
      source_.note("of its " + std::to_string(scenes.size()) + " scenes the one that it shows is read");
    const Json& scene = scenes[number];
    checkKeys(scene, {"name", "nodes"}, "scene " + std::to_string(number));
    checkTree();
    if (scene.contains("nodes")) {
      for (const std::size_t node : indicesOf(scene, "nodes", "nodes", "scene " + std::to_string(number))) {
        if (is_child_[node])
          source_.refuse("node " + std::to_string(node) + " is in the scene, and below another node");
        addNode(node, world_);
      }
    }
    const std::size_t all = listOf("meshes").size();
    if (parts_.size() < all) {
      source_.note(std::to_string(all - parts_.size()) + " of its meshes, " + std::to_string(all) +
                   ", are left out: the scene does not show them");
    }
    return std::move(soup_);
  }

 private:
  static constexpr std::size_t kMax = std::size_t{1} << 40;  // sums of them do not overflow

  /// The parts of a binary file: JSON, and bytes.
  std::string_view unpack(std::string_view file) {
    constexpr std::size_t kHead = 12, kChunkHead = 8;
    constexpr std::uint32_t kJson = 0x4E4F534A, kBytes = 0x004E4942;
    const auto cut = [&] { source_.refuse("is cut short or no binary glTF"); };
    if (file.size() < kHead) cut();
    if (little32(file, 4) != 2)
      source_.refuse("is a binary glTF of version " + std::to_string(little32(file, 4)) + "; 2 is read");
    if (little32(file, 8) != file.size()) cut();
    std::string_view json;
    for (std::size_t at = kHead, chunk = 0; at < file.size(); ++chunk) {
      if (file.size() - at < kChunkHead) cut();
      const std::size_t size = little32(file, at);
      const std::uint32_t kind = little32(file, at + 4);
      at += kChunkHead;
      if (file.size() - at < size) cut();
      if (kind != (chunk == 0 ? kJson : kBytes) || chunk > 1) source_.refuse("has a part of an unknown kind");
      (chunk == 0 ? json : bytes_) = file.substr(at, size);
      has_bytes_ = chunk == 1;
      at += size;
    }
    return json;
  }

  void parse(std::string_view json) {
    const std::size_t end = std::min(json.find_last_not_of('\0') + 1, json.size());  // some writers pad with zeros
    try {
      root_ = text::parseJson(json.substr(0, end));
    } catch (const std::invalid_argument& error) {
      source_.refuse(std::string("is no glTF: ") + error.what());
    }
    if (!root_.is_object()) source_.refuse("is no glTF: it is no JSON object");
  }

  void checkHead() {
    const Json* asset = find(root_, "asset");
    const Json* version = asset && asset->is_object() ? find(*asset, "version") : nullptr;
    if (!version || !version->is_string() || version->get<std::string>().substr(0, 2) != "2.") {
      source_.refuse("is no glTF of version 2");
    }
    checkKeys(*asset, {"version", "minVersion", "generator", "copyright"}, "asset");
    if (asset->contains("minVersion") && (*asset)["minVersion"] != "2.0")
      source_.refuse("needs glTF of version " + shown((*asset)["minVersion"].dump()) + "; 2.0 is read");
    checkKeys(
        root_,
        {"asset", "scene", "scenes", "nodes", "meshes", "accessors", "bufferViews", "buffers", "materials", "textures",
         "images", "samplers", "cameras", "skins", "animations", "extensionsUsed", "extensionsRequired"},
        "the file");
    for (const Json& name : listOf("extensionsRequired")) {
      if (!name.is_string()) source_.refuse("its extensionsRequired are not names");
      if (!isPlainExtension(name.get<std::string>())) {
        source_.refuse("needs the extension " + shown(name.get<std::string>()) +
                       ", which is not read: save it without");
      }
    }
    if (!listOf("animations").empty()) source_.refuse("has animations, which move what it holds: save it without");
  }

  static const Json* find(const Json& object, const char* key) {
    const auto found = object.find(key);
    return found == object.end() ? nullptr : &*found;
  }

  /// Refuses keys of other names, extensions that may be geometry, and values that are no object.
  void checkKeys(const Json& object, Keys known, const std::string& what) const {
    if (!object.is_object()) source_.refuse(what + " is no object");
    for (const auto& [key, value] : object.items()) {
      if (key == "extras") continue;
      if (key == "extensions") {
        if (!value.is_object()) source_.refuse("the extensions of " + what + " are no object");
        for (const auto& extension : value.items()) {
          if (!isPlainExtension(extension.key())) {
            source_.refuse(what + " has the extension " + shown(extension.key()) +
                           ", which is not read: save it without");
          }
        }
        continue;
      }
      if (!isOneOf(key, known)) source_.refuse(what + " has " + shown(key) + ", which is not read");
    }
  }

  /// A list of the file; empty where it has none.
  const Json& listOf(const char* key) const {
    static const Json none = Json::array();
    const Json* list = find(root_, key);
    if (!list) return none;
    if (!list->is_array()) source_.refuse("its " + std::string(key) + " are no list");
    return *list;
  }

  std::size_t countOf(const Json& value, const std::string& what) const {
    if (!value.is_number_unsigned() || value.get<std::uint64_t>() >= kMax) {
      source_.refuse(what + " is no whole number from 0");
    }
    return value.get<std::size_t>();
  }
  std::size_t countOf(const Json& object, const char* key, std::size_t otherwise, const std::string& what) const {
    const Json* value = find(object, key);
    return value ? countOf(*value, std::string(key) + " of " + what) : otherwise;
  }
  std::size_t countOf(const Json& object, const char* key, const std::string& what) const {
    if (!object.contains(key)) source_.refuse(what + " has no " + key);
    return countOf(object, key, 0, what);
  }
  /// The number of an entry of a list that is there.
  std::size_t indexOf(const Json& value, const char* list, const std::string& what) const {
    const std::size_t index = countOf(value, what);
    const std::size_t size = listOf(list).size();
    if (index >= size) source_.refuse(what + " is " + std::to_string(index) + " of " + std::to_string(size));
    return index;
  }
  std::size_t indexOf(const Json& object, const char* key, const char* list, const std::string& what) const {
    if (!object.contains(key)) source_.refuse(what + " has no " + key);
    return indexOf(object[key], list, std::string(key) + " of " + what);
  }
  std::vector<std::size_t> indicesOf(const Json& object, const char* key, const char* list,
                                     const std::string& what) const {
    if (!object[key].is_array()) source_.refuse(std::string(key) + " of " + what + " are no list");
    std::vector<std::size_t> indices;
    for (const Json& value : object[key]) indices.push_back(indexOf(value, list, std::string(key) + " of " + what));
    return indices;
  }
  std::vector<double> numbersOf(const Json& object, const char* key, std::vector<double> otherwise,
                                const std::string& what) const {
    const Json* list = find(object, key);
    if (!list) return otherwise;
    const bool good = list->is_array() && list->size() == otherwise.size() &&
                      std::all_of(list->begin(), list->end(),
                                  [](const Json& x) { return x.is_number() && std::isfinite(x.get<double>()); });
    if (!good)
      source_.refuse(std::string(key) + " of " + what + " is no list of " + std::to_string(otherwise.size()) +
                     " numbers");
    return list->get<std::vector<double>>();
  }

  /// Each node is below one other at most, and none below itself.
  void checkTree() {
    const Json& nodes = listOf("nodes");
    is_child_.assign(nodes.size(), false);
    std::vector<std::size_t> parents(nodes.size(), 0);
    std::vector<std::vector<std::size_t>> children(nodes.size());
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      const std::string what = "node " + std::to_string(n);
      if (!nodes[n].is_object()) source_.refuse(what + " is no object");
      if (!nodes[n].contains("children")) continue;
      children[n] = indicesOf(nodes[n], "children", "nodes", what);
      for (const std::size_t child : children[n]) {
        if (is_child_[child])
          source_.refuse("node " + std::to_string(child) + " is below two nodes, or twice below one");
        is_child_[child] = true;
      }
    }
    // From the roots down all nodes are reached, unless some are in a circle.
    std::vector<std::size_t> open;
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      if (!is_child_[n]) open.push_back(n);
    }
    std::size_t reached = 0;
    while (!open.empty()) {
      const std::size_t n = open.back();
      open.pop_back();
      ++reached;
      open.insert(open.end(), children[n].begin(), children[n].end());
    }
    if (reached < nodes.size()) source_.refuse("has nodes that are below themselves");
  }

  Eigen::Affine3d poseOf(const Json& node, const std::string& what) const {
    Eigen::Affine3d M = Eigen::Affine3d::Identity();
    if (node.contains("matrix")) {
      for (const char* other : {"translation", "rotation", "scale"}) {
        if (node.contains(other)) source_.refuse(what + " has both a matrix and a " + other);
      }
      const std::vector<double> x = numbersOf(node, "matrix", std::vector<double>(16, 0), what);
      M.matrix() = Eigen::Map<const Eigen::Matrix4d>(x.data());
      if (M.matrix().row(3) != Eigen::RowVector4d(0, 0, 0, 1))
        source_.refuse(what + " has a matrix whose last row is not 0 0 0 1");
      return M;
    }
    const std::vector<double> x = numbersOf(node, "translation", {0, 0, 0}, what),
                              q = numbersOf(node, "rotation", {0, 0, 0, 1}, what),
                              s = numbersOf(node, "scale", {1, 1, 1}, what);
    const Eigen::Quaterniond rotation(q[3], q[0], q[1], q[2]);
    // Every program writes three decimals or more, so the length is that near to 1.
    if (!(std::abs(rotation.norm() - 1) <= 1e-3))
      source_.refuse(what + " has a rotation that is no quaternion of length 1");
    M.translate(Eigen::Vector3d(x[0], x[1], x[2]));
    M.rotate(rotation.normalized());
    M.scale(Eigen::Vector3d(s[0], s[1], s[2]));
    return M;
  }

  void addNode(std::size_t root, const Eigen::Affine3d& M_root) {
    std::vector<std::pair<std::size_t, Eigen::Affine3d>> open{{root, M_root}};  // a chain may be as long as the file
    while (!open.empty()) {
      const auto [number, M_parent] = open.back();
      open.pop_back();
      const Json& node = listOf("nodes")[number];
      const std::string what = "node " + std::to_string(number);
      if (node.contains("skin")) source_.refuse(what + " bends its mesh by bones ('skin'): save it as it stands");
      if (node.contains("weights"))
        source_.refuse(what + " has weights of morph targets, which are not read: save it as it stands");
      checkKeys(node, {"name", "children", "matrix", "translation", "rotation", "scale", "mesh", "camera"}, what);
      const Eigen::Affine3d M = M_parent * poseOf(node, what);
      if (node.contains("mesh")) {
        const std::size_t mesh = indexOf(node, "mesh", "meshes", what);
        const auto [part, is_new] = parts_.try_emplace(mesh);
        if (is_new) readMesh(mesh, part->second);
        addPart(part->second, M, source_, yield_, soup_);
      }
      if (!node.contains("children")) continue;
      for (const std::size_t child : indicesOf(node, "children", "nodes", what)) open.emplace_back(child, M);
    }
  }

  void readMesh(std::size_t number, Part& part) {
    const Json& mesh = listOf("meshes")[number];
    const std::string what = "mesh " + std::to_string(number);
    if (mesh.is_object() && mesh.contains("weights"))
      source_.refuse(what + " has weights of morph targets, which are not read: save it as it stands");
    checkKeys(mesh, {"name", "primitives"}, what);
    if (!mesh.contains("primitives") || !mesh["primitives"].is_array())
      source_.refuse(what + " has no list of primitives");
    std::map<std::size_t, std::size_t> first;  // of each accessor of places: primitives may share one
    for (std::size_t p = 0; p < mesh["primitives"].size(); ++p) {
      readPrimitive(mesh["primitives"][p], what + ", primitive " + std::to_string(p), first, part);
    }
  }

  void readPrimitive(const Json& primitive, const std::string& what, std::map<std::size_t, std::size_t>& first,
                     Part& part) {
    if (primitive.is_object() && primitive.contains("targets"))
      source_.refuse(what + " has morph targets, which are not read: save it as it stands");
    checkKeys(primitive, {"attributes", "indices", "mode", "material"}, what);
    const Json* attributes = find(primitive, "attributes");
    if (!attributes || !attributes->is_object()) source_.refuse(what + " has no attributes");
    for (const auto& [name, value] : attributes->items()) {
      const std::string start = name.substr(0, name.find('_'));
      if (!isOneOf(start, {"POSITION", "NORMAL", "TANGENT", "TEXCOORD", "COLOR", "JOINTS", "WEIGHTS", ""})) {
        source_.refuse(what + " has the attribute " + shown(name) + ", which is not read");
      }
    }
    const std::size_t accessor = indexOf(*attributes, "POSITION", "accessors", what);
    const auto [entry, is_new] = first.try_emplace(accessor, part.vertices.size());
    const std::size_t begin = entry->second;
    std::vector<double> values;
    if (is_new) {
      readAccessor(accessor, "VEC3", {5126}, values);
      for (std::size_t k = 0; k < values.size(); k += 3)
        part.vertices.emplace_back(values[k], values[k + 1], values[k + 2]);
    }
    const std::size_t size = countOf(listOf("accessors")[accessor], "count", what);
    std::vector<std::size_t> corners;
    if (primitive.contains("indices")) {
      readAccessor(indexOf(primitive, "indices", "accessors", what), "SCALAR", {5121, 5123, 5125}, values);
      for (const double value : values) {
        const auto index = static_cast<std::size_t>(value);
        if (index >= size)
          source_.refuse(what + " has a face with vertex " + std::to_string(index) + " of " + std::to_string(size));
        corners.push_back(begin + index);
      }
    } else {
      for (std::size_t k = 0; k < size; ++k) corners.push_back(begin + k);
    }
    addPrimitive(countOf(primitive, "mode", 4, what), corners, what, part);
  }

  void addPrimitive(std::size_t mode, const std::vector<std::size_t>& c, const std::string& what, Part& part) {
    enum { points, lines, loop, strip, triangles, triangle_strip, triangle_fan };
    const std::size_t n = c.size(), least = mode == points ? 1 : mode <= strip ? 2 : 3;
    if (mode > triangle_fan) source_.refuse(what + " has the unknown mode " + std::to_string(mode));
    if (n < least || (mode == lines && n % 2 != 0) || (mode == triangles && n % 3 != 0)) {
      source_.refuse(what + " has " + std::to_string(n) + " corners, which make no whole number of its parts");
    }
    yield_.add(mode == triangle_strip || mode == triangle_fan ? 3 * n : n);
    if (mode == points) part.points += n;
    if (mode == lines) part.lines += n / 2;
    if (mode == loop || mode == strip) ++part.lines;
    if (mode == triangles) {
      for (std::size_t k = 0; k < n; k += 3) part.addFace({c[k], c[k + 1], c[k + 2]});
    }
    for (std::size_t k = 0; k + 2 < n; ++k) {
      if (mode == triangle_strip)
        part.addFace({c[k + k % 2], c[k + 1 - k % 2], c[k + 2]});  // every second one is turned round
      if (mode == triangle_fan) part.addFace({c[0], c[k + 1], c[k + 2]});
    }
  }

  /// @param kinds  types of numbers that are allowed. @param[out] values  of all entries, one after another.
  void readAccessor(std::size_t number, const char* type, std::initializer_list<std::size_t> kinds,
                    std::vector<double>& values) {
    const Json& accessor = listOf("accessors")[number];
    const std::string what = "accessor " + std::to_string(number);
    if (accessor.is_object() && accessor.contains("sparse"))
      source_.refuse(what + " is sparse, which is not read: save it whole");
    checkKeys(accessor,
              {"name", "bufferView", "byteOffset", "componentType", "normalized", "count", "type", "max", "min"}, what);
    if (!accessor.contains("type") || accessor["type"] != type) source_.refuse(what + " is not of type " + type);
    const Json* normalized = find(accessor, "normalized");
    if (normalized && *normalized != false) source_.refuse(what + " is normalized, which is not read here");
    const std::size_t kind = countOf(accessor, "componentType", what), count = countOf(accessor, "count", what),
                      offset = countOf(accessor, "byteOffset", 0, what);
    if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end())
      source_.refuse(what + " has numbers of type " + std::to_string(kind) + ", which are not read here");
    const Scalar scalar = kind == 5126 ? Scalar{'F', 4} : Scalar{'U', kind == 5121 ? 1u : kind == 5123 ? 2u : 4u};
    const std::size_t columns = std::strcmp(type, "VEC3") == 0 ? 3 : 1, width = columns * scalar.bytes;
    std::size_t stride = 0;
    const std::string_view bytes = viewOf(indexOf(accessor, "bufferView", "bufferViews", what), stride);
    if (stride == 0) stride = width;
    if (stride < width || offset > bytes.size() || count > bytes.size() ||
        (count > 0 && (bytes.size() - offset < width || (bytes.size() - offset - width) / stride < count - 1))) {
      source_.refuse(what + " goes beyond its bufferView");
    }
    yield_.add(count * columns);
    values.clear();
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t k = 0; k < columns; ++k) {
        values.push_back(scalar.read(bytes.data() + offset + i * stride + k * scalar.bytes, false));
      }
    }
  }

  std::string_view viewOf(std::size_t number, std::size_t& stride) {
    const Json& view = listOf("bufferViews")[number];
    const std::string what = "bufferView " + std::to_string(number);
    checkKeys(view, {"name", "buffer", "byteOffset", "byteLength", "byteStride", "target"}, what);
    const std::string_view bytes = bufferOf(indexOf(view, "buffer", "buffers", what));
    const std::size_t offset = countOf(view, "byteOffset", 0, what), length = countOf(view, "byteLength", what);
    stride = countOf(view, "byteStride", 0, what);
    if (view.contains("byteStride") && (stride < 4 || stride > 252))
      source_.refuse(what + " has a byteStride that is not 4 to 252");
    if (offset > bytes.size() || length > bytes.size() - offset) source_.refuse(what + " goes beyond its buffer");
    return bytes.substr(offset, length);
  }

  std::string_view bufferOf(std::size_t number) {
    const Json& buffer = listOf("buffers")[number];
    const std::string what = "buffer " + std::to_string(number);
    checkKeys(buffer, {"name", "uri", "byteLength"}, what);
    const auto [entry, is_new] = buffers_.try_emplace(number);
    std::string& own = entry->second;
    std::string_view bytes;
    if (!buffer.contains("uri")) {
      if (number > 0 || !has_bytes_) source_.refuse(what + " has no uri");
      bytes = bytes_;
    } else {
      if (!buffer["uri"].is_string()) source_.refuse("uri of " + what + " is no text");
      if (is_new) {
        own = contentOf(buffer["uri"].get<std::string>(), what);
        yield_.addBytes(own.size());
      }
      bytes = own;
    }
    const std::size_t length = countOf(buffer, "byteLength", what);
    if (length > bytes.size())
      source_.refuse(what + " is cut short: it has " + std::to_string(bytes.size()) + " bytes of " +
                     std::to_string(length));
    return bytes.substr(0, length);
  }

  std::string contentOf(const std::string& uri, const std::string& what) const {
    if (uri.substr(0, 5) == "data:") {
      const std::size_t comma = uri.find(',');
      const std::string mark = ";base64";
      const bool base64 =
          comma != uri.npos && comma >= mark.size() && uri.compare(comma - mark.size(), mark.size(), mark) == 0;
      if (!base64) source_.refuse("uri of " + what + " is not in base64");
      return decodeBase64(std::string_view(uri).substr(comma + 1), what);
    }
    const std::size_t colon = uri.find(':');
    if (uri.empty() || uri[0] == '/' || colon < uri.find('/'))
      source_.refuse("uri of " + what + " is " + shown(uri) + ", which is no path from here");
    std::string path;
    for (std::size_t k = 0; k < uri.size(); ++k) {
      const auto digit = [&](std::size_t at) {
        const char c = at < uri.size() ? uri[at] : ' ';
        const int value = c >= '0' && c <= '9'   ? c - '0'
                          : c >= 'A' && c <= 'F' ? c - 'A' + 10
                          : c >= 'a' && c <= 'f' ? c - 'a' + 10
                                                 : -1;
        if (value < 0) source_.refuse("uri of " + what + " has a broken '%'");
        return value;
      };
      if (uri[k] == '%') {
        path += static_cast<char>(16 * digit(k + 1) + digit(k + 2));
        k += 2;
      } else {
        path += uri[k];
      }
    }
    try {
      return files::read((std::filesystem::path(source_.path).parent_path() / path).string());
    } catch (const std::runtime_error& error) {
      source_.refuse(error.what());
    }
  }

  std::string decodeBase64(std::string_view text, const std::string& what) const {
    static constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const std::size_t size = text.size();
    while (!text.empty() && text.back() == '=' && size - text.size() < 2) text.remove_suffix(1);
    std::string bytes;
    std::uint32_t bits = 0;
    int count = 0;
    for (const char c : text) {
      const std::size_t digit = kDigits.find(c);
      if (digit == kDigits.npos) source_.refuse(what + " is broken: " + shown({&c, 1}) + " is no digit of base64");
      bits = bits << 6 | static_cast<std::uint32_t>(digit);
      count += 6;
      if (count < 8) continue;
      count -= 8;
      bytes += static_cast<char>(bits >> count & 0xFF);
    }
    return bytes;
  }

  const Source& source_;
  Json root_;
  std::string_view bytes_;  ///< of a binary file
  bool has_bytes_ = false;
  Eigen::Affine3d world_ = Eigen::Affine3d::Identity();
  std::vector<bool> is_child_;
  std::map<std::size_t, Part> parts_;
  std::map<std::size_t, std::string> buffers_;
  Yield yield_;
  TriangleSoup soup_;
};

}  // namespace

TriangleSoup readGltf(const Source& source, bool turn) {
  return Gltf(source, turn).read();
}

}  // namespace fcl_artic::meshes
