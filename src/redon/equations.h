// SPDX-License-Identifier: BSD-3-Clause
//
// The elementary equations of triangles (Redon 2004, eqs. 13 and 14) as functions of time, in A's frame, bounded over
// time intervals. Runs under RoundUpward.
//
// Symbols: a, e_a, n_a: a vertex, an edge (the vector from its first vertex to its second), a face's normal e x e' of
// A, which stand still; x, e_x, n_x: those of B, x(t) = R(t) x + c(t), e_x(t) = R(t) e_x.
//   face of A, vertex of B    f = n_a . (x - a)               f' = n_a . x'
//   vertex of A, face of B    f = n_x . (a - x)               f' = n_x' . (a - x) - n_x . x'
//   edge, edge                f = (x - a) . (e_a x e_x)       f' = x' . (e_a x e_x) + (x - a) . (e_a x e_x')
// Vertices, edges and normals ("elements") are bounded once per interval, whatever number of equations they are in.
#pragma once

#include <vector>

#include "redon/culling.h"

namespace fcl_artic {
namespace redon {

enum class EquationKind : std::uint8_t { faceVertex, vertexFace, edgeEdge };  ///< A's feature first

struct Equation {
  std::int32_t pair;  ///< index into the list of body pairs
  EquationKind kind;
  std::int32_t triangle_a, triangle_b;  ///< that the features belong to
  /// Elements. faceVertex: A's normal and three vertices, B's vertex. vertexFace: A's vertex, B's normal and three
  /// vertices. edgeEdge: A's edge and its ends, B's edge and its ends.
  std::int32_t element[6];
  double from;  ///< no root before
};

/// B in A over an interval T, in the middle m of it, and its derivative over T.
struct PairBounds {
  IntervalTransform over, middle, rate;
};

struct Element {
  std::int32_t pair;
  bool moves;                       ///< B's
  bool direction;                   ///< an edge or a normal
  IntervalVec3 own;                 ///< in its body's frame
  IntervalVec3 over, middle, rate;  ///< in A's frame: over T, at m, derivative over T
  std::int32_t stamp = -1;          ///< of the interval that it was bounded for
};

/// The equations of a set of leaf pairs, each pair of features once.
class EquationSet {
 public:
  void clear();
  void add(const std::vector<BodyPair>& pairs, const LeafPair* begin, const LeafPair* end);
  const std::vector<Equation>& equations() const { return equations_; }
  std::vector<Element>& elements() { return elements_; }

 private:
  std::vector<Equation> equations_;
  std::vector<Element> elements_;
  std::vector<std::int32_t> numbers_[2][3];  ///< element of a body's vertex, edge, face; -1: none yet
};

/// Bounds a moving element.
void bound(Element& element, const PairBounds& motion);

/// Which of an element's bounds: &Element::over or &Element::middle.
using Bounds = IntervalVec3 Element::*;
/// Function over T or in the middle, derivative over T. The elements must have been bounded.
Interval value(const Equation& equation, const Element* elements, Bounds when);
Interval derivativeOver(const Equation& equation, const Element* elements);

/// A direction keeps the two features apart all over T: no root there is a contact. Where the function vanishes for
/// good (parallel edges, coplanar features, edges and faces without extent) this decides instead of it.
/// @param h  T - m.
/// @param[out] gap  about the gap between the features in the middle.
bool certainlyApart(const Equation& equation, const Element* elements, Interval h, double& gap);

/// The features themselves meet wherever the function has a root in T: the vertex is inside the face, the edges cross.
bool certainlyInside(const Equation& equation, const Element* elements);

/// Where the features are in the middle of T, about: a point between them, and the unit normal of their contact, from A
/// to B.
/// @param before  value of the function before the contact, for the side.
void describe(const Equation& equation, const Element* elements, double before, double* point, double* normal);

}  // namespace redon
}  // namespace fcl_artic
