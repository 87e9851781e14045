// SPDX-License-Identifier: BSD-3-Clause
#include <stdexcept>

#include "plans/zip.h"

namespace fcl_artic::plans {

std::vector<ZipEntry> unzip(std::string_view) {
  throw std::invalid_argument(
      "archives (.npz) are not read: this was built without zlib (Debian: zlib1g-dev); single arrays (.npy) are read");
}

}  // namespace fcl_artic::plans
