// SPDX-License-Identifier: BSD-3-Clause
#include <stdexcept>

#include "plans/document.h"

namespace fcl_artic::plans {

std::vector<Json> parseYaml(std::string_view) {
  throw std::invalid_argument(
      "YAML is not read: this was built without yaml-cpp (Debian: libyaml-cpp-dev); JSON is read");
}

}  // namespace fcl_artic::plans
