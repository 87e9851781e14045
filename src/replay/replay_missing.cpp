// SPDX-License-Identifier: BSD-3-Clause
#include <stdexcept>

#include "fcl_artic/query_text.h"

namespace fcl_artic {

static const char kMissing[] = "fcl_artic was built without nlohmann-json: it neither writes nor reads queries";

std::string ArticulatedCollisionManager::writeQuery(const JointMotion&, const CertifiedRequest&) const {
  throw std::runtime_error(kMissing);
}
std::string ArticulatedCollisionManager::writeQuery(const JointTrajectory&, const CertifiedRequest&) const {
  throw std::runtime_error(kMissing);
}
RecordedQuery readQuery(std::string_view) {
  throw std::runtime_error(kMissing);
}
CertifiedResult RecordedQuery::ask() const {
  throw std::runtime_error(kMissing);
}

}  // namespace fcl_artic
