// SPDX-License-Identifier: BSD-3-Clause
#include "setup/pair_making.h"

#include <functional>

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

std::size_t PairMaking::hash() const {
  std::size_t mixed = 0;
  const auto mix = [&](std::size_t h) { mixed = (mixed ^ h) * 0x9e3779b97f4a7c15; };
  mix(std::hash<LinkId>()(link_a));
  mix(std::hash<LinkId>()(link_b));
  for (const Eigen::Matrix4d* offset : {&offset_a, &offset_b}) {
    for (Eigen::Index k = 0; k < offset->size(); ++k) mix(std::hash<double>()(offset->data()[k]));
  }
  return mixed;
}

}  // namespace fcl_artic
