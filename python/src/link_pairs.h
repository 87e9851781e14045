// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "fcl_artic/link_pairs.h"

namespace fcl_artic::python {

/// Proofs of pairs of links, as Python holds them; nothing can be asked of them.
struct Proofs {
  std::shared_ptr<const LinkPairProofs> proofs;
};

}  // namespace fcl_artic::python
