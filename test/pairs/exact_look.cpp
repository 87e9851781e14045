// SPDX-License-Identifier: BSD-3-Clause
#include "exact_look.h"

#include "geometry.h"

namespace pair_campaign {
namespace {

campaign::GeometryPtr exactMesh(const pairs::Body& body) {
  return campaign::Geometry::mesh("mesh", body.vertices, body.triangles);
}

campaign::Pose rounded(const pairs::Pose& M) {
  const pairs::PoseOf<double> m = M.cast<double>();
  return {m.rotation, m.position};
}

}  // namespace

pairs::Judge::Look exactLook(const pairs::PairQuery& query) {
  if (query.body1->kind != pairs::Kind::mesh || query.body2->kind != pairs::Kind::mesh) return {};
  return [a = exactMesh(*query.body1), b = exactMesh(*query.body2)](const pairs::Pose& M_1, const pairs::Pose& M_2,
                                                                    double wanted, const pairs::Nearness& hint) {
    campaign::Proximity guess;
    guess.piece_a = hint.piece1, guess.piece_b = hint.piece2;
    const campaign::Proximity p = campaign::proximity(*a, rounded(M_1), *b, rounded(M_2), 0, wanted, guess);
    return pairs::Nearness{p.gap, p.upper, p.clear, p.piece_a, p.piece_b, p.direction};
  };
}

}  // namespace pair_campaign
