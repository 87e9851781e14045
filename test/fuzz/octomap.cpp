// SPDX-License-Identifier: BSD-3-Clause
// The first byte says: 1 a full tree (.ot), 2 unknown cells are obstacles.
#include "load_scene.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  fcl_artic::SceneOptions options;
  options.unknown_cells = data[0] & 2;
  fcl_artic::fuzz::loadAndQuery(data[0] & 1 ? "input.ot" : "input.bt",
                                std::string(reinterpret_cast<const char*>(data + 1), size - 1), options);
  return 0;
}
