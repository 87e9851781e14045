// SPDX-License-Identifier: BSD-3-Clause
#include <assimp/config.h>
#include <assimp/postprocess.h>
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

GeometryPtr makeMesh(const std::vector<Eigen::Vector3d>& vertices, const std::vector<fcl::Triangle>& triangles,
                     const std::string& where, std::vector<std::string>* notes, bool solid) {
  if (triangles.empty()) fail(where, "has no triangles");
  std::vector<fcl::Triangle> kept;
  kept.reserve(triangles.size());
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
    if (!isDegenerate(vertices[triangle[0]], vertices[triangle[1]], vertices[triangle[2]])) kept.push_back(triangle);
  }
  if (kept.empty()) fail(where, "has no triangle with an area");
  if (solid) kept = triangles;
  if (notes && kept.size() < triangles.size()) {
    notes->push_back(where + ": " + std::to_string(triangles.size() - kept.size()) + " of " +
                     std::to_string(triangles.size()) + " triangles have no area and were left out");
  }
  auto model = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
  if (model->beginModel(static_cast<int>(kept.size()), static_cast<int>(vertices.size())) != fcl::BVH_OK ||
      model->addSubModel(vertices, kept) != fcl::BVH_OK || model->endModel() != fcl::BVH_OK) {
    fail(where, "FCL cannot build its tree");
  }
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

struct TriangleSoup {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<fcl::Triangle> triangles;
};

/// assimp keeps the parts of a file in the frames of its nodes.
void collect(const aiScene& scene, const aiNode& node, const Eigen::Matrix4d& M_parent, TriangleSoup& soup) {
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
    for (unsigned f = 0; f < part.mNumFaces; ++f) {
      const aiFace& face = part.mFaces[f];
      if (face.mNumIndices != 3) continue;  // points and lines
      soup.triangles.emplace_back(first + face.mIndices[0], first + face.mIndices[1], first + face.mIndices[2]);
    }
  }
  for (unsigned c = 0; c < node.mNumChildren; ++c) collect(scene, *node.mChildren[c], M, soup);
}

/// assimp's step that cuts polygons into triangles reads vertices that aren't there, and ends the process for a mesh
/// that it takes for one of polygons though it has none: a face without a corner is enough.
/// @return whether there is a polygon of more than three corners. @throws std::runtime_error naming `where`.
bool requireFaces(const aiScene& scene, const std::string& where) {
  bool all = false;
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
    const aiMesh& mesh = *scene.mMeshes[m];
    bool polygons = false;
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices == 0) detail::fail(where, "has a face without a corner");
      polygons = polygons || face.mNumIndices > 3;
      for (unsigned k = 0; k < face.mNumIndices; ++k) {
        if (face.mIndices[k] < mesh.mNumVertices) continue;
        detail::fail(where, "has a face with vertex " + std::to_string(face.mIndices[k]) + " of " +
                                std::to_string(mesh.mNumVertices));
      }
    }
    if (!polygons && (mesh.mPrimitiveTypes & aiPrimitiveType_POLYGON)) {
      detail::fail(where, "says that it has polygons, and has none");
    }
    all = all || polygons;
  }
  return all;
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
  explicit MemoryStream(std::string content) : content_(std::move(content)) {}
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
  std::string content_;
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
      return new MemoryStream(path == path_ ? content_ : files::read(path));
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

}  // namespace

std::shared_ptr<fcl::CollisionGeometryd> loadMesh(const std::string& path, const Eigen::Vector3d& scale,
                                                  std::vector<std::string>* notes, bool solid, bool collada_up_axis) {
  const std::string where = "mesh '" + path + "'";
  if (!scale.allFinite() || (scale.array() == 0).any()) {
    detail::fail(where, "its scale has an entry that is zero or not finite");
  }
  if (std::error_code error; !std::filesystem::is_regular_file(path, error)) detail::fail(where, "no such file");

  const std::string ending = detail::endingOf(path), content = files::read(path);
  detail::requireWholeMesh(content, ending, where);
  if (notes && ending == ".obj" && !content.empty() && content.back() != '\n') {
    notes->push_back(where + ": its last line has no line end: the file may be cut short");
  }

  Assimp::Importer importer;
  auto* const read_by = new CheckedFiles(path, content);  // the importer's from now on
  importer.SetIOHandler(read_by);
  // A COLLADA file's unit counts; its up axis if it is asked for: assimp then turns what is up to y.
  const bool turn = ending == ".dae" && collada_up_axis;
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, !turn);
  if (ending == ".dae" && notes) noteUpAxis(content, where, turn, *notes);
  const aiScene* scene = importer.ReadFile(path, 0);
  if (scene && requireFaces(*scene, where)) scene = importer.ApplyPostProcessing(aiProcess_Triangulate);
  if (!read_by->error().empty()) detail::fail(where, read_by->error());
  if (!scene || !scene->mRootNode) detail::fail(where, importer.GetErrorString());

  TriangleSoup soup;
  Eigen::Matrix4d M_world = Eigen::Matrix4d::Identity();
  if (turn) M_world.topLeftCorner<3, 3>() << 1, 0, 0, 0, 0, -1, 0, 1, 0;  // y is up in assimp's world, z in ours
  collect(*scene, *scene->mRootNode, M_world, soup);
  for (Eigen::Vector3d& x : soup.vertices) x = x.cwiseProduct(scale);
  return detail::makeMesh(soup.vertices, soup.triangles, where, notes, solid);
}

}  // namespace fcl_artic
