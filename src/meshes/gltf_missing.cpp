// SPDX-License-Identifier: BSD-3-Clause
// In place of gltf.cpp, where nlohmann-json is not found.
#include "meshes/readers.h"

namespace fcl_artic::meshes {

TriangleSoup readGltf(const Source& source, bool) {
  source.refuse("is glTF, which this build does not read: it was made without nlohmann-json");
}

}  // namespace fcl_artic::meshes
