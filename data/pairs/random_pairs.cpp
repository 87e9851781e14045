// SPDX-License-Identifier: BSD-3-Clause
#include "pairs/random_pairs.h"

#include <algorithm>

#include "pairs/constants.h"

namespace pairs {
namespace {

constexpr Kind kBounded[] = {Kind::box,  Kind::sphere,    Kind::capsule, Kind::cylinder,
                             Kind::cone, Kind::ellipsoid, Kind::convex,  Kind::triangle};

PathPtr randomPath(const PairOptions& options, bool moves, double from_origin, double scale, Random& random) {
  Ends ends;
  ends.R1 = random.rotation();
  ends.T1 = from_origin * scale * random.vector(0.6, 1.6);
  if (!moves) {
    ends.R2 = ends.R1, ends.T2 = ends.T1;
    return options.moves == Moves::interp ? interpPath(ends, Vec3::Zero()) : translationPath(ends);
  }
  if (options.moves == Moves::spline) {
    std::array<Vec3, 4> positions, rotations;
    Vec3 turn = random.vector(0, kPi);
    for (std::size_t k = 0; k < 4; ++k) {
      positions[k] = scale * random.vector(0, 2.5);
      rotations[k] = turn;
      turn += random.vector(0, 1.5);
    }
    if (from_origin > 0.5) positions[0] *= 2;
    return splinePath(positions, rotations);
  }
  const Vec3 axis = random.direction();
  ends.R2 = Eigen::AngleAxisd(random.uniform(options.moves == Moves::screw ? 0.01 : 0, kPi), axis).toRotationMatrix() *
            ends.R1;
  ends.T2 = scale * random.vector(0, 1.6);
  if (options.moves == Moves::translation) return translationPath(ends);
  if (options.moves == Moves::screw) return screwPath(ends);
  const bool about_origin = random.chance(0.5);
  return interpPath(ends, about_origin ? Vec3::Zero() : Vec3(scale * random.vector(0, 0.5)));
}

BodyPtr randomBody(const PairOptions& options, bool mesh, bool unbounded, Random& random) {
  if (mesh)
    return randomMesh(options.any_volume ? static_cast<Volume>(random.below(kVolumes)) : options.volume, random);
  if (unbounded) return randomShape(random.chance(0.5) ? Kind::halfspace : Kind::plane, random);
  if (options.kinds.empty()) return randomShape(kBounded[random.below(8)], random);
  return randomShape(options.kinds[static_cast<std::size_t>(random.below(static_cast<int>(options.kinds.size())))],
                     random);
}

PairQuery drawPair(const PairOptions& options, Random& random) {
  PairQuery q;
  // Meshes are smaller than the shapes, and so are their ways.
  const double scale = options.bodies == Bodies::shapes ? 1 : 0.65;
  bool mesh1 = options.bodies == Bodies::meshes, mesh2 = mesh1, wall1 = false, wall2 = false;
  if (options.bodies == Bodies::mixed) (random.chance(0.5) ? mesh1 : mesh2) = true;
  if (options.unbounded && options.bodies != Bodies::meshes && random.chance(0.15)) {
    (!mesh1 && (mesh2 || random.chance(0.5)) ? wall1 : wall2) = true;
  }
  q.body1 = randomBody(options, mesh1, wall1, random);
  q.body2 = randomBody(options, mesh2, wall2, random);
  q.path1 = randomPath(options, true, 1, scale, random);
  q.path2 = randomPath(options, options.both_move, 0.3, scale, random);
  if (random.chance(0.5)) std::swap(q.path1, q.path2);
  return q;
}

}  // namespace

PairQuery makePair(const PairOptions& options, std::uint64_t seed) {
  static constexpr const char* kBodies[] = {"mesh-mesh", "shape-shape", "mesh-shape"};
  static constexpr const char* kMoves[] = {"interp", "translation", "screw", "spline"};
  Random random(seed);
  PairQuery q = drawPair(options, random);
  for (int tries = 0; options.graze && tries < 30; ++tries, q = drawPair(options, random)) {
    const Truth truth = Judge(q).leastGap();
    if (truth.hit || !(truth.gap > 0)) continue;
    double depth = random.logUniform(1e-8, 1e-3);
    if (random.chance(0.5)) depth = -depth;
    q.path2 = q.path2->shifted(-(truth.gap + depth) * truth.direction);
    break;
  }
  q.family = std::string(kBodies[static_cast<int>(options.bodies)]) + (options.graze ? "/graze/" : "/random/") +
             kMoves[static_cast<int>(options.moves)];
  q.seed = seed;
  return q;
}

PairQuery referencePair(Bodies bodies, std::uint64_t seed, std::uint64_t index) {
  PairOptions options;
  options.bodies = bodies;
  options.both_move = index % 2 == 1;
  options.graze = index % 8 >= 6;
  return makePair(options, Random::mix(seed, index));
}

PairQuery withVolume(const PairQuery& query, Volume volume) {
  const auto rebuilt = [&](const BodyPtr& b) {
    return b->kind == Kind::mesh ? makeMesh(b->vertices, b->triangles, volume) : b;
  };
  PairQuery q = query;
  q.body1 = rebuilt(q.body1);
  q.body2 = rebuilt(q.body2);
  return q;
}

}  // namespace pairs
