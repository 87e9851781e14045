// SPDX-License-Identifier: BSD-3-Clause
#include "request_json.h"

#include <type_traits>

#include "query/request_options.h"

namespace fcl_artic::app {

nlohmann::ordered_json requestJson(const CertifiedRequest& request) {
  nlohmann::ordered_json out;
  forEachRequestOption([&](const RequestOption& option, auto member) {
    using Value = std::decay_t<decltype(request.*member)>;
    if constexpr (std::is_arithmetic_v<Value>) out[option.name] = request.*member;
    if constexpr (std::is_same_v<Value, ContactMode> || std::is_same_v<Value, Method>) {
      out[option.name] = nameOf(request.*member);
    }
  });
  return out;
}

}  // namespace fcl_artic::app
