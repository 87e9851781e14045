// SPDX-License-Identifier: BSD-3-Clause
#include "setup/pair_making.h"

#include "fcl/fcl_geometry.h"

namespace fcl_artic {

PairMaking::PairMaking(const KinematicTree& tree, const ManagedBody& a, const ManagedBody& b)
    : shape_a(a.shape),
      shape_b(b.shape),
      content_a(a.content),
      content_b(b.content),
      link_a(a.link),
      link_b(b.link),
      offset_a(a.offset.matrix()),
      offset_b(b.offset.matrix()),
      tree(tree.content()) {}

bool PairMaking::sameAs(const PairMaking& other) const {
  return link_a == other.link_a && link_b == other.link_b && offset_a == other.offset_a && offset_b == other.offset_b &&
         tree.sameAs(other.tree) && (shape_a == other.shape_a || content_a->sameAs(*other.content_a)) &&
         (shape_b == other.shape_b || content_b->sameAs(*other.content_b));
}

}  // namespace fcl_artic
