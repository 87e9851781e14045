// SPDX-License-Identifier: BSD-3-Clause
#include "visibility/volumes.h"

#include <algorithm>
#include <cmath>

namespace fcl_artic {
namespace visibility {
namespace {

using engine::Node;
using engine::Piece;
using engine::PieceKind;

/// Corners of a regular octagon around the unit circle: at 22.5 degrees and so on, 1 / cos(22.5 degrees) out.
constexpr double kOctagonLong = 1.0000000000001, kOctagonShort = 0.41421356237313;
constexpr double kOctagon[8][2] = {{kOctagonLong, kOctagonShort},   {kOctagonShort, kOctagonLong},
                                   {-kOctagonShort, kOctagonLong},  {-kOctagonLong, kOctagonShort},
                                   {-kOctagonLong, -kOctagonShort}, {-kOctagonShort, -kOctagonLong},
                                   {kOctagonShort, -kOctagonLong},  {kOctagonLong, -kOctagonShort}};
/// Corners of an icosahedron around the unit ball: (0, +-a, +-b) and its cyclic shifts, b / a the golden section. Its faces
/// are at a phi^2 / sqrt(3) from the middle.
constexpr double kIcosahedronA = 0.66158453886, kIcosahedronB = 1.07046626935;

}  // namespace

void Box::join(const Box& other) {
  for (int k = 0; k < 3; ++k) {
    lo[k] = std::min(lo[k], other.lo[k]);
    hi[k] = std::max(hi[k], other.hi[k]);
  }
}

Box boxOf(const engine::SweptLink& link) {
  Box box;
  for (int k = 0; k < 3; ++k) {
    double lo = link.points[0][k], hi = lo;
    for (int i = 1; i < 6; ++i) {
      lo = std::min(lo, link.points[i][k]);
      hi = std::max(hi, link.points[i][k]);
    }
    const double grow = link.radius + 0x1p-50 * (std::abs(lo) + std::abs(hi) + link.radius);
    box.lo[k] = lo - grow;
    box.hi[k] = hi + grow;
  }
  return box;
}

Volume addVolume(const engine::SweptLink& link, Batch& batch) {
  Volume volume;
  volume.first = static_cast<std::int32_t>(batch.points.size() / 3);
  volume.count = 6;
  volume.radius = link.radius;
  batch.points.insert(batch.points.end(), &link.points[0][0], &link.points[0][0] + 18);
  return volume;
}

BodyPieces::BodyPieces(const engine::Body& body, double margin)
    : body_(body),
      // The placement's own error and a dozen roundings of numbers no larger than these.
      pad_(margin + 0x1p-52 * (body.placement.ulps + 64) * (2 * body.tree->extent + body.placement.length + margin)) {}

void BodyPieces::toWorld(const double* p, double* x) const {
  const double *R = body_.placement.R, *t = body_.placement.t;
  for (int k = 0; k < 3; ++k) x[k] = R[3 * k] * p[0] + R[3 * k + 1] * p[1] + R[3 * k + 2] * p[2] + t[k];
}

Box BodyPieces::boxOf(const Node& node) const {
  double center[3], half[3], middle[3];
  for (int k = 0; k < 3; ++k) {
    center[k] = 0.5 * (static_cast<double>(node.lo[k]) + static_cast<double>(node.hi[k]));
    half[k] = 0.5 * (static_cast<double>(node.hi[k]) - static_cast<double>(node.lo[k]));
  }
  toWorld(center, middle);
  Box box;
  for (int k = 0; k < 3; ++k) {
    const double* R = body_.placement.R + 3 * k;
    const double reach = std::abs(R[0]) * half[0] + std::abs(R[1]) * half[1] + std::abs(R[2]) * half[2] + pad_;
    box.lo[k] = middle[k] - reach;
    box.hi[k] = middle[k] + reach;
  }
  return box;
}

Volume BodyPieces::ballAround(const Node& node, Batch& batch) const {
  double center[3], x[3];
  for (int k = 0; k < 3; ++k) center[k] = 0.5 * (static_cast<double>(node.lo[k]) + static_cast<double>(node.hi[k]));
  toWorld(center, x);
  Volume volume;
  volume.first = static_cast<std::int32_t>(batch.points.size() / 3);
  volume.count = 1;
  volume.radius = static_cast<double>(node.radius) + pad_;
  batch.points.insert(batch.points.end(), x, x + 3);
  return volume;
}

/// The piece as the hull of points: itself, or, where it is curved, a polyhedron around it.
Volume BodyPieces::volumeOf(const Piece& piece, Batch& batch) const {
  Volume volume;
  volume.first = static_cast<std::int32_t>(batch.points.size() / 3);
  volume.radius = piece.radius + pad_;
  const auto add = [&](double a, double b, double c) {
    const double p[3] = {piece.center[0] + a, piece.center[1] + b, piece.center[2] + c};
    double x[3];
    toWorld(p, x);
    batch.points.insert(batch.points.end(), x, x + 3);
    ++volume.count;
  };
  const double* e = piece.size;
  switch (piece.kind) {
    case PieceKind::vertices: {
      const double* p = body_.tree->vertices + 3 * static_cast<std::ptrdiff_t>(piece.first_vertex);
      for (int i = 0; i < piece.num_vertices; ++i) add(p[3 * i], p[3 * i + 1], p[3 * i + 2]);
      break;
    }
    case PieceKind::hull: {
      const double* p = body_.tree->hulls + piece.first_vertex;
      const int n = piece.num_vertices;
      for (int i = 0; i < n; ++i) add(p[i], p[n + i], p[2 * n + i]);
      break;
    }
    case PieceKind::point:
      add(0, 0, 0);
      break;
    case PieceKind::segment:
      add(0, 0, e[2]);
      add(0, 0, -e[2]);
      break;
    case PieceKind::box:
      for (int c = 0; c < 8; ++c) add(c & 1 ? e[0] : -e[0], c & 2 ? e[1] : -e[1], c & 4 ? e[2] : -e[2]);
      break;
    case PieceKind::cylinder:
      for (const double* corner : kOctagon) {
        add(e[0] * corner[0], e[0] * corner[1], e[2]);
        add(e[0] * corner[0], e[0] * corner[1], -e[2]);
      }
      break;
    case PieceKind::cone:
      add(0, 0, e[2]);
      for (const double* corner : kOctagon) add(e[0] * corner[0], e[0] * corner[1], -e[2]);
      break;
    case PieceKind::ellipsoid:
      for (int i = 0; i < 4; ++i) {
        const double a = i & 1 ? kIcosahedronA : -kIcosahedronA, b = i & 2 ? kIcosahedronB : -kIcosahedronB;
        add(0, a * e[1], b * e[2]);
        add(a * e[0], b * e[1], 0);
        add(b * e[0], 0, a * e[2]);
      }
      break;
    case PieceKind::halfspace:
    case PieceKind::plane:
      break;  // no points: the projector finds it unusable
  }
  return volume;
}

bool BodyPieces::add(const Box* parts, int num_parts, double least, std::size_t most, std::int32_t window,
                     std::int32_t group, Batch& batch) const {
  const engine::TreeView& tree = *body_.tree;
  if (!(tree.nodes[0].radius < engine::kUnbounded)) return false;
  std::int32_t stack[128];
  int open = 0;
  stack[open++] = 0;
  while (open) {
    const Node& node = tree.nodes[stack[--open]];
    const Box box = boxOf(node);
    if (std::none_of(parts, parts + num_parts, [&](const Box& part) { return part.meets(box); })) continue;
    const bool small = static_cast<double>(node.radius) < least;
    if (!node.isLeaf() && !small) {
      if (open + 2 > 128) return false;
      stack[open++] = node.right();
      stack[open++] = node.left();
      continue;
    }
    if (batch.objects.size() >= most) return false;
    batch.objects.push_back({small ? ballAround(node, batch) : volumeOf(tree.pieces[node.piece()], batch), window, group});
  }
  return true;
}

}  // namespace visibility
}  // namespace fcl_artic
