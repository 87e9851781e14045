// SPDX-License-Identifier: BSD-3-Clause
#include "load_scene.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fcl_artic::fuzz::loadAndQuery("input.scene", std::string(reinterpret_cast<const char*>(data), size));
  return 0;
}
