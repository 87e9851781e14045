// SPDX-License-Identifier: BSD-3-Clause
// The first byte is the format.
#include "load_scene.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  static const char* const kNames[] = {"input.stl", "input.obj",  "input.ply", "input.off",
                                       "input.dae", "input.gltf", "input.glb"};
  fcl_artic::fuzz::loadAndQuery(kNames[data[0] % 7], std::string(reinterpret_cast<const char*>(data + 1), size - 1));
  return 0;
}
