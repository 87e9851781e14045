// SPDX-License-Identifier: BSD-3-Clause
//
// Many motions over threads. Queries share nothing but the set-up, so this file only hands them out.
#include <stdexcept>
#include <string>

#include "fcl_artic/manager.h"
#include "query/claim_nothing.h"
#include "threads/parallel.h"

namespace fcl_artic {

void ArticulatedCollisionManager::continuousCollide(const std::vector<JointMotion>& motions,
                                                    const CertifiedRequest& request,
                                                    std::vector<CertifiedResult>& results, int threads) const {
  const auto reset = [&] {
    for (CertifiedResult& result : results) claimNothing(result);
  };
  for (CertifiedResult& result : results) withdrawClaims(result, 0, 1);
  resetUnlessAnswered(reset, [&] {
    if (threads < 0) {
      throw std::invalid_argument("continuousCollide: the number of threads is " + std::to_string(threads));
    }
    for (std::size_t i = 0; i < motions.size(); ++i) {
      if (!motions[i].isOf(tree())) motions[i].requireOf(tree(), ("motion " + std::to_string(i)).c_str());
    }
    CertifiedRequest alike = request;
    alike.progress = nullptr;
    results.resize(motions.size());
    parallelFor(motions.size(), threads, [&](std::size_t i) { collideMotion(motions[i], alike, results[i]); });
  });
}

}  // namespace fcl_artic
