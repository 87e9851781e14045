// SPDX-License-Identifier: BSD-3-Clause
#include "query/report.h"

#include <utility>

#include "fcl/fcl_geometry.h"
#include "numerics/baseline_isa.h"

#include "convex/cloud.h"

namespace fcl_artic {
namespace {

/// FCL's own id of a piece, as in Contact::b1: a mesh's triangle, an OcTree's cell (OcTree::getNodeByQueryCellId), -1
/// for a shape.
/// @param geometry  that the tree was read from; null where FCL's double type is not at hand.
std::intptr_t primitiveId(const fcl::CollisionGeometryd* geometry, const ShapeTree& shape, std::int32_t piece) {
  if (piece < 0) return fcl::Contactd::NONE;
  baseline::PieceRoom room;
  const engine::Piece& p = baseline::pieceOf(shape.view(), piece, room);
#if FCL_HAVE_OCTOMAP
  if (geometry && geometry->getNodeType() == fcl::GEOM_OCTREE) {
    return ocTreeCellId(static_cast<const fcl::OcTreed&>(*geometry), Eigen::Vector3d::Map(p.center));
  }
#endif
  return p.primitive;
}

FeatureKind swapped(FeatureKind kind) {
  switch (kind) {
    case FeatureKind::vertexEdge:
      return FeatureKind::edgeVertex;
    case FeatureKind::edgeVertex:
      return FeatureKind::vertexEdge;
    case FeatureKind::vertexFace:
      return FeatureKind::faceVertex;
    case FeatureKind::faceVertex:
      return FeatureKind::vertexFace;
    case FeatureKind::edgeFace:
      return FeatureKind::faceEdge;
    case FeatureKind::faceEdge:
      return FeatureKind::edgeFace;
    case FeatureKind::vertexVertex:
    case FeatureKind::edgeEdge:
    case FeatureKind::faceFace:
    case FeatureKind::volume:
      return kind;
  }
  return kind;
}

}  // namespace

CertifiedContact reportContact(const engine::LeafContact& leaf, const ReportedBody& a, const ReportedBody& b,
                               const Eigen::Isometry3d& M_0a, const Eigen::Isometry3d& M_0a_nearest) {
  CertifiedContact contact;
  contact.body1 = a.reference;
  contact.body2 = b.reference;
  contact.o1 = a.geometry;
  contact.o2 = b.geometry;
  contact.b1 = primitiveId(a.geometry, a.shape, leaf.piece_a);
  contact.b2 = primitiveId(b.geometry, b.shape, leaf.piece_b);
  if (leaf.feature >= 0) contact.feature = static_cast<FeatureKind>(leaf.feature);
  contact.point = M_0a * Eigen::Vector3d::Map(leaf.point);
  contact.normal = (M_0a.linear() * Eigen::Vector3d::Map(leaf.normal)).normalized();
  contact.nearest1 = M_0a_nearest * Eigen::Vector3d::Map(leaf.nearest_a);
  contact.nearest2 = M_0a_nearest * Eigen::Vector3d::Map(leaf.nearest_b);
  contact.approach_speed = leaf.approach_speed;
  contact.t_lower = leaf.t_lower;
  contact.t_upper = leaf.t_upper;
  contact.certain = leaf.certain;
  return contact;
}

CertifiedContact swapBodies(CertifiedContact contact) {
  std::swap(contact.body1, contact.body2);
  std::swap(contact.o1, contact.o2);
  std::swap(contact.b1, contact.b2);
  std::swap(contact.nearest1, contact.nearest2);
  contact.feature = swapped(contact.feature);
  contact.normal = -contact.normal;
  return contact;
}

}  // namespace fcl_artic
