// SPDX-License-Identifier: BSD-3-Clause
// Formats that this library does not read itself, by assimp.
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/IOStream.hpp>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <cstring>
#include <filesystem>

#include "detail.h"
#include "files/files.h"

namespace fcl_artic::detail {
namespace {

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

/// Reads whole files for assimp, whose own streams take an error for the file's end. Keeps the first error. The mesh's
/// own content is the one that was read before, even if the file has changed since.
class CheckedFiles : public Assimp::IOSystem {
 public:
  CheckedFiles(std::string path, std::string_view content) : path_(std::move(path)), content_(content) {}
  bool Exists(const char* path) const override {
    std::error_code error;
    return std::filesystem::exists(path, error);
  }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* path, const char* mode) override {
    if (std::strchr(mode, 'r') == nullptr || !Exists(path)) return nullptr;
    try {
      if (path == path_) return new MemoryStream(content_);
      return new MemoryStream(files::read(path));
    } catch (const std::runtime_error& error) {
      if (error_.empty()) error_ = error.what();
      return nullptr;
    }
  }
  void Close(Assimp::IOStream* stream) override { delete stream; }
  const std::string& error() const { return error_; }

 private:
  const std::string path_;
  const std::string_view content_;
  std::string error_;
};

/// Parts of a file are in the frames of its nodes.
void collect(const aiScene& scene, const aiNode& node, const Eigen::Matrix4d& M_parent, const meshes::Source& source,
             meshes::TriangleSoup& soup) {
  const Eigen::Matrix4d M =
      M_parent *
      Eigen::Map<const Eigen::Matrix<ai_real, 4, 4, Eigen::RowMajor>>(&node.mTransformation.a1).cast<double>();
  std::vector<std::size_t> corners;
  for (unsigned m = 0; m < node.mNumMeshes; ++m) {
    const aiMesh& part = *scene.mMeshes[node.mMeshes[m]];
    const std::size_t first = soup.vertices.size();
    for (unsigned v = 0; v < part.mNumVertices; ++v) {
      const Eigen::Vector4d x(part.mVertices[v].x, part.mVertices[v].y, part.mVertices[v].z, 1);
      soup.vertices.push_back((M * x).head<3>());
    }
    // Polygons are cut here: assimp's own step ends the process for some of them, such as nine times one corner.
    for (unsigned f = 0; f < part.mNumFaces; ++f) {
      corners.clear();
      for (unsigned k = 0; k < part.mFaces[f].mNumIndices; ++k) corners.push_back(first + part.mFaces[f].mIndices[k]);
      soup.addFace(corners.data(), corners.size(), source);
    }
  }
  for (unsigned c = 0; c < node.mNumChildren; ++c) collect(scene, *node.mChildren[c], M, source, soup);
}

}  // namespace

meshes::TriangleSoup importMesh(const meshes::Source& source, const std::string& ending) {
  // Assimp leaves out units or parts of these formats without a message.
  for (const char* lossy : {".3mf", ".amf", ".x3d", ".x3db", ".x3dv"}) {
    if (ending == lossy)
      source.refuse("is of a format (" + ending + ") whose units or parts get lost: save it as STL, OBJ or PLY");
  }
  Assimp::Importer importer;
  auto* const read_by = new CheckedFiles(source.path, source.content);  // the importer's from now on
  importer.SetIOHandler(read_by);
  const aiScene* scene = importer.ReadFile(source.path, 0);
  if (!read_by->error().empty()) source.refuse(read_by->error());
  if (!scene || !scene->mRootNode) source.refuse(importer.GetErrorString());
  if (scene->mFlags & AI_SCENE_FLAGS_INCOMPLETE) source.refuse("is incomplete");
  if (scene->mNumAnimations > 0) source.refuse("has animations, which move what it holds: save it without");
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
    const aiMesh& mesh = *scene->mMeshes[m];
    if (mesh.mNumBones > 0) source.refuse("bends a mesh by bones: save it as it stands");
    if (mesh.mNumAnimMeshes > 0)
      source.refuse("has shapes that a mesh may take on (morph targets): save it as it stands");
  }
  meshes::TriangleSoup soup;
  collect(*scene, *scene->mRootNode, Eigen::Matrix4d::Identity(), source, soup);
  source.note(
      "was read by assimp, as asked for: what that leaves out or misreads is not known here, its numbers are of "
      "single precision, its units are taken for metres and its axes as they stand");
  return soup;
}

}  // namespace fcl_artic::detail
