// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>

#include <Eigen/Core>

#include "fcl_artic/kinematic_tree.h"
#include "setup/managed_body.h"

namespace fcl_artic {

/// All that the distance of two links' geometries depends on, but for the joint values. A thing that was made from it
/// serves as long as it is the same.
struct PairMaking {
  std::shared_ptr<const ShapeTree> shape_a, shape_b;
  std::shared_ptr<const GeometryContent> content_a, content_b;
  LinkId link_a, link_b;
  Eigen::Matrix4d offset_a, offset_b;
  Fingerprint tree;

  PairMaking(const KinematicTree& tree, const ManagedBody& a, const ManagedBody& b);
  /// As proofs and findings of two links' geometries are kept: the one of the link with the lower number first.
  static PairMaking inOrder(const KinematicTree& tree, const ManagedBody& a, const ManagedBody& b) {
    return a.link < b.link ? PairMaking(tree, a, b) : PairMaking(tree, b, a);
  }
  /// Trees are the same as numbers, geometries by their content, whoever holds them.
  bool sameAs(const PairMaking& other) const;
  /// The hash of links and offsets: equal for those that are the same.
  std::size_t hash() const;
};

}  // namespace fcl_artic
