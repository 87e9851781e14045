// SPDX-License-Identifier: BSD-3-Clause
#include <assimp/config.h>
#include <assimp/scene.h>
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/cone.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>

#include <algorithm>
#include <assimp/IOStream.hpp>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <cctype>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <sstream>

#include "detail.h"
#include "fcl_artic/solid_mesh.h"
#include "fcl_artic/urdf/urdf.h"
#include "files/files.h"
#include "triangle_soup.h"

namespace fcl_artic {
namespace detail {
namespace {

void requireLength(double value, const std::string& what, const std::string& where) {
  if (!(value > 0 && std::isfinite(value))) fail(where, what + " " + text(value) + " is not a positive length");
}

/// No area beyond the rounding of its own edges.
bool isDegenerate(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const Eigen::Vector3d u = b - a, v = c - a;
  return !(u.cross(v).norm() > 8 * std::numeric_limits<double>::epsilon() * u.norm() * v.norm());
}

/// Drops the vertices that no triangle uses, as FCL takes all of them for the box around a mesh.
void keepUsed(std::vector<Eigen::Vector3d>& vertices, std::vector<fcl::Triangle>& triangles) {
  constexpr std::size_t kUnused = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> number(vertices.size(), kUnused);
  for (const fcl::Triangle& triangle : triangles) {
    for (int k = 0; k < 3; ++k) number[triangle[k]] = 0;
  }
  std::size_t used = 0;
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    if (number[v] == kUnused) continue;
    vertices[used] = vertices[v];
    number[v] = used++;
  }
  vertices.resize(used);
  for (fcl::Triangle& triangle : triangles) {
    triangle.set(number[triangle[0]], number[triangle[1]], number[triangle[2]]);
  }
}

}  // namespace

std::string text(double value) {
  std::ostringstream out;
  out << value;
  return out.str();
}

std::string endingOf(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  return ending;
}

GeometryPtr makeBox(const Eigen::Vector3d& size, const std::string& where) {
  for (const double length : size) requireLength(length, "box size", where);
  return std::make_shared<fcl::Boxd>(size);
}

GeometryPtr makeSphere(double radius, const std::string& where) {
  requireLength(radius, "sphere radius", where);
  return std::make_shared<fcl::Sphered>(radius);
}

GeometryPtr makeCylinder(double radius, double length, const std::string& where) {
  requireLength(radius, "cylinder radius", where);
  requireLength(length, "cylinder length", where);
  return std::make_shared<fcl::Cylinderd>(radius, length);
}

GeometryPtr makeCone(double radius, double length, const std::string& where) {
  requireLength(radius, "cone radius", where);
  requireLength(length, "cone length", where);
  return std::make_shared<fcl::Coned>(radius, length);
}

GeometryPtr makeMesh(std::vector<Eigen::Vector3d> vertices, std::vector<fcl::Triangle> triangles,
                     const std::string& where, std::vector<std::string>* notes, bool solid) {
  if (triangles.empty()) fail(where, "has no triangles");
  const auto hasNoArea = [&](const fcl::Triangle& triangle) {
    return isDegenerate(vertices[triangle[0]], vertices[triangle[1]], vertices[triangle[2]]);
  };
  std::size_t flat = 0;
  for (const fcl::Triangle& triangle : triangles) {
    for (int k = 0; k < 3; ++k) {
      if (triangle[k] >= vertices.size()) {
        fail(where,
             "has a triangle with vertex " + std::to_string(triangle[k]) + " of " + std::to_string(vertices.size()));
      }
      if (!vertices[triangle[k]].allFinite()) {
        fail(where, "vertex " + std::to_string(triangle[k]) + " is not finite");
      }
    }
    flat += hasNoArea(triangle);
  }
  if (flat == triangles.size()) fail(where, "has no triangle with an area");
  if (!solid && flat > 0) {
    if (notes) {
      notes->push_back(where + ": " + std::to_string(flat) + " of " + std::to_string(triangles.size()) +
                       " triangles have no area and were left out");
    }
    triangles.erase(std::remove_if(triangles.begin(), triangles.end(), hasNoArea), triangles.end());
  }
  keepUsed(vertices, triangles);
  auto model = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
  bool built =
      model->beginModel(static_cast<int>(triangles.size()), static_cast<int>(vertices.size())) == fcl::BVH_OK &&
      model->addSubModel(vertices, triangles) == fcl::BVH_OK;
  // FCL has copies, and needs much memory for its tree.
  vertices = {};
  triangles = {};
  built = built && model->endModel() == fcl::BVH_OK;
  if (!built) fail(where, "FCL cannot build its tree");
  model->computeLocalAABB();
  if (!solid) return model;
  try {
    return makeSolid(*model);
  } catch (const std::invalid_argument& error) {
    fail(where, error.what());
  }
}

}  // namespace detail

namespace {

/// assimp keeps the parts of a file in the frames of its nodes.
void collect(const aiScene& scene, const aiNode& node, const Eigen::Matrix4d& M_parent, const std::string& where,
             detail::TriangleSoup& soup) {
  const Eigen::Matrix4d M =
      M_parent *
      Eigen::Map<const Eigen::Matrix<ai_real, 4, 4, Eigen::RowMajor>>(&node.mTransformation.a1).cast<double>();
  for (unsigned m = 0; m < node.mNumMeshes; ++m) {
    const aiMesh& part = *scene.mMeshes[node.mMeshes[m]];
    const std::size_t first = soup.vertices.size();
    for (unsigned v = 0; v < part.mNumVertices; ++v) {
      const Eigen::Vector4d x(part.mVertices[v].x, part.mVertices[v].y, part.mVertices[v].z, 1);
      soup.vertices.push_back((M * x).head<3>());
    }
    // assimp's own step that cuts polygons ends the process for some of them, as of nine times one corner.
    std::vector<std::size_t> corners;
    for (unsigned f = 0; f < part.mNumFaces; ++f) {
      corners.clear();
      for (unsigned k = 0; k < part.mFaces[f].mNumIndices; ++k) corners.push_back(first + part.mFaces[f].mIndices[k]);
      soup.addFace(corners.data(), corners.size(), where);
    }
  }
  for (unsigned c = 0; c < node.mNumChildren; ++c) collect(scene, *node.mChildren[c], M, where, soup);
}

/// Refuses faces that name vertices that aren't there, or none. @throws std::runtime_error naming `where`.
void requireFaces(const aiScene& scene, const std::string& where) {
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
    const aiMesh& mesh = *scene.mMeshes[m];
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices == 0) detail::fail(where, "has a face without a corner");
      for (unsigned k = 0; k < face.mNumIndices; ++k) {
        if (face.mIndices[k] < mesh.mNumVertices) continue;
        detail::fail(where, "has a face with vertex " + std::to_string(face.mIndices[k]) + " of " +
                                std::to_string(mesh.mNumVertices));
      }
    }
  }
}

/// Tells of a COLLADA file that says that x or y is up: of the first such file only, as a robot may have many.
void noteUpAxis(const std::string& content, const std::string& where, bool turned, std::vector<std::string>& notes) {
  static const std::string kNotes[] = {
      "is up: taken as it stands, as RViz and MoveIt do, and so for all such files (option collada_up_axis turns them)",
      "is up: turned so that z is, and so for all such files (option collada_up_axis)"};
  const std::string& text = kNotes[turned];
  const std::size_t tag = content.find("<up_axis>");
  if (tag == std::string::npos) return;
  const std::size_t at = content.find_first_not_of(" \t\r\n", tag + 9);
  if (at == std::string::npos || (content[at] != 'X' && content[at] != 'Y')) return;
  for (const std::string& note : notes) {
    if (note.find(text) != std::string::npos) return;
  }
  notes.push_back(where + ": says that " + (content[at] == 'X' ? "x " : "y ") + text);
}

/// A file in memory, as assimp reads.
class MemoryStream : public Assimp::IOStream {
 public:
  explicit MemoryStream(std::string content) : owned_(std::move(content)), content_(owned_) {}
  /// @param content  must outlive the stream.
  explicit MemoryStream(std::string_view content) : content_(content) {}
  std::size_t Read(void* to, std::size_t size, std::size_t count) override {
    if (size == 0) return 0;
    const std::size_t whole = std::min(count, (content_.size() - at_) / size);
    std::memcpy(to, content_.data() + at_, whole * size);
    at_ += whole * size;
    return whole;
  }
  std::size_t Write(const void*, std::size_t, std::size_t) override { return 0; }
  aiReturn Seek(std::size_t offset, aiOrigin from) override {
    const std::size_t base = from == aiOrigin_SET ? 0 : from == aiOrigin_CUR ? at_ : content_.size();
    const std::size_t to = from == aiOrigin_END ? base - offset : base + offset;  // as assimp's own memory stream
    if (to > content_.size()) return aiReturn_FAILURE;
    at_ = to;
    return aiReturn_SUCCESS;
  }
  std::size_t Tell() const override { return at_; }
  std::size_t FileSize() const override { return content_.size(); }
  void Flush() override {}

 private:
  const std::string owned_;
  const std::string_view content_;
  std::size_t at_ = 0;
};

/// Reads whole files for assimp, whose own streams take an error for the file's end. Keeps the first error. The mesh
/// itself is what was looked at before, even when the file has changed since.
class CheckedFiles : public Assimp::IOSystem {
 public:
  CheckedFiles(std::string path, const std::string& content) : path_(std::move(path)), content_(content) {}
  bool Exists(const char* path) const override {
    std::error_code error;
    return std::filesystem::exists(path, error);
  }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* path, const char* mode) override {
    if (std::strchr(mode, 'r') == nullptr || !Exists(path)) return nullptr;
    try {
      if (path == path_) return new MemoryStream(std::string_view(content_));
      return new MemoryStream(files::read(path));
    } catch (const std::runtime_error& error) {
      if (error_.empty()) error_ = error.what();
      return nullptr;
    }
  }
  void Close(Assimp::IOStream* stream) override { delete stream; }
  const std::string& error() const { return error_; }

 private:
  const std::string path_, &content_;
  std::string error_;
};

/// @param turn  turns what a COLLADA file says is up to z.
detail::TriangleSoup readByAssimp(const std::string& path, const std::string& content, const std::string& where,
                                  bool turn) {
  Assimp::Importer importer;
  auto* const read_by = new CheckedFiles(path, content);  // the importer's from now on
  importer.SetIOHandler(read_by);
  // A COLLADA file's unit counts; its up axis if it is asked for: assimp then turns what is up to y.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, !turn);
  const aiScene* scene = importer.ReadFile(path, 0);
  if (!read_by->error().empty()) detail::fail(where, read_by->error());
  if (!scene || !scene->mRootNode) detail::fail(where, importer.GetErrorString());
  requireFaces(*scene, where);

  detail::TriangleSoup soup;
  Eigen::Matrix4d M_world = Eigen::Matrix4d::Identity();
  if (turn) M_world.topLeftCorner<3, 3>() << 1, 0, 0, 0, 0, -1, 0, 1, 0;  // y is up in assimp's world, z in ours
  collect(*scene, *scene->mRootNode, M_world, where, soup);
  return soup;
}

/// @param notes  may be null. @throws std::runtime_error naming `where`.
detail::TriangleSoup readMesh(const std::string& path, const std::string& where, bool collada_up_axis,
                              std::vector<std::string>* notes) {
  const std::string ending = detail::endingOf(path), content = files::read(path);
  detail::requireWholeMesh(content, ending, where);
  if (notes && ending == ".obj" && !content.empty() && content.back() != '\n') {
    notes->push_back(where + ": its last line has no line end: the file may be cut short");
  }

  if (ending == ".obj") return detail::readObj(content, where, notes);
  if (ending == ".stl" && detail::isBinaryStl(content)) return detail::readBinaryStl(content);
  if (ending == ".dae" && notes) noteUpAxis(content, where, collada_up_axis, *notes);
  return readByAssimp(path, content, where, ending == ".dae" && collada_up_axis);
}

}  // namespace

std::shared_ptr<fcl::CollisionGeometryd> loadMesh(const std::string& path, const Eigen::Vector3d& scale,
                                                  std::vector<std::string>* notes, bool solid, bool collada_up_axis) {
  const std::string where = "mesh '" + path + "'";
  if (!scale.allFinite() || (scale.array() == 0).any()) {
    detail::fail(where, "its scale has an entry that is zero or not finite");
  }
  if (std::error_code error; !std::filesystem::exists(path, error)) detail::fail(where, "no such file");

  detail::TriangleSoup soup = readMesh(path, where, collada_up_axis, notes);
  for (Eigen::Vector3d& x : soup.vertices) x = x.cwiseProduct(scale);
  return detail::makeMesh(std::move(soup.vertices), std::move(soup.triangles), where, notes, solid);
}

}  // namespace fcl_artic
