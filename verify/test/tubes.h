// SPDX-License-Identifier: BSD-3-Clause
// Tolerances for tests: paths within them by samples, and how far they let bodies move, in plain doubles. None of it is
// part of the verifier.
#pragma once

#include <cstdio>
#include <functional>
#include <map>

#include "cases.h"

namespace verify::test {

constexpr double kPi = 3.14159265358979323846;

/// A rotation by `angle` about a random axis.
inline M anyTurn(Rng& rng, double angle) {
  return rotationAbout({uniform(rng, -1, 1), uniform(rng, -1, 1), uniform(rng, -1, 1)}, angle);
}
inline V anyVector(Rng& rng, double length) {
  V v{uniform(rng, -1, 1), uniform(rng, -1, 1), uniform(rng, -1, 1)};
  return (length / std::max(norm(v), 1e-9)) * v;
}

/// Draws from what the world's tolerances allow: an end of each, or what lies between.
inline Errors anyErrors(Rng& rng, const World& world) {
  const bool corner = rng() % 3 > 0;
  const auto part = [&]() { return corner || rng() % 2 ? 1.0 : uniform(rng, 0, 1); };
  const auto poseOf = [&](const PoseTolerance& t) {
    M m = anyTurn(rng, part() * std::min(t.angle, kPi));
    const V pivot{t.pivot[0], t.pivot[1], t.pivot[2]};
    m.t = pivot - turn(m, pivot) + anyVector(rng, part() * t.length);
    return m;
  };
  Errors errors;
  errors.of_variable.assign(world.variables.size(), 0);
  for (const auto& [v, d] : world.variable_tolerances)
    errors.of_variable[static_cast<std::size_t>(v)] = (rng() % 2 ? d : -d) * part();
  for (const auto& [v, d] : world.vector_tolerances) {  // (of three slides along x, y and z here)
    const V e = anyVector(rng, d.length * part());
    for (std::size_t k = 0; k < 3; ++k) errors.of_variable[static_cast<std::size_t>(v) + k] = e[k];
  }
  for (const auto& [v, d] : world.rotation_tolerances) errors.of_rotation[v] = anyTurn(rng, part() * std::min(d, kPi));
  for (const auto& [f, t] : world.frame_tolerances) errors.of_frame[f] = poseOf(t);
  for (const Body& body : world.bodies) {
    const auto t = world.body_tolerances.find(body.name_id);
    errors.of_body.push_back(t == world.body_tolerances.end() ? M{} : poseOf(t->second));
  }
  return errors;
}

/// The bodies of a motion where they are at a time, with errors.
inline std::vector<M> bodiesWith(const World& world, const Motion& motion, std::size_t piece, double t,
                                 const Errors& errors) {
  return Sampler(world, motion, &errors).bodies(piece, t);
}

/// How far a body can have come by itself.
inline double wayAt(const World& world, const Motion& motion, std::size_t piece, double t, std::size_t body) {
  const auto own = world.speeds.find(world.bodies[body].name_id);
  if (own == world.speeds.end()) return 0;
  const double* const clock = motion.pieces[piece].clock;
  return own->second.speed * std::max(0.0, clock[0] + t * (clock[1] - clock[0]) - own->second.since);
}

/// Moves bodies by all of their ways, or a part: anywhere, or straight to another body.
inline void moveByThemselves(Rng& rng, const World& world, const Motion& motion, std::size_t piece, double t,
                             std::vector<M>& poses) {
  if (world.speeds.empty()) return;
  for (std::size_t b = 0; b < poses.size(); ++b) {
    const double way = wayAt(world, motion, piece, t, b) * (rng() % 3 ? 1 : uniform(rng, 0, 1));
    if (way == 0) continue;
    const V to = poses[rng() % poses.size()].t - poses[b].t;
    const double far = norm(to);
    poses[b].t = poses[b].t + (far > 0 && rng() % 4 ? (std::min(way, far) / far) * to : anyVector(rng, way));
  }
}

/// A ball around the geometry's own origin that holds it; of one without bounds 1e9.
inline double radiusOf(const Geometry& g) {
  if (g.unbounded()) return 1e9;
  double radius = 0;
  for (std::size_t k = 0; k + 2 < g.vertices.size(); k += 3)
    radius = std::max(radius, norm({g.vertices[k], g.vertices[k + 1], g.vertices[k + 2]}));
  for (std::size_t k = 0; k + 5 < g.cells.size(); k += 6)
    radius = std::max(radius, norm({std::fabs(g.cells[k]) + g.cells[k + 3], std::fabs(g.cells[k + 1]) + g.cells[k + 4],
                                    std::fabs(g.cells[k + 2]) + g.cells[k + 5]}));
  double sum = 0;
  for (const double x : g.numbers) sum += std::fabs(x);
  return std::max(radius, sum);
}

/// Whether a sample of the tube is certainly nearer than its margin, which is above 0: then the claim is false.
inline bool tubeIsFalse(Rng& rng, const World& world, const Motion& motion, int samples, int steps = 60) {
  std::vector<double> radii;
  for (const Body& body : world.bodies)
    radii.push_back(radiusOf(world.geometries[static_cast<std::size_t>(body.geometry)]));
  const auto mayBeNear = [&](const std::vector<M>& poses, std::size_t a, std::size_t b, double margin) {
    return norm(poses[a].t - poses[b].t) <= radii[a] + radii[b] + margin;
  };
  for (int n = 0; n < samples; ++n) {
    const std::size_t piece = static_cast<std::size_t>(rng()) % motion.pieces.size();
    const double t = (piece + 1 == motion.pieces.size() ? motion.until : 1) * uniform(rng, 0, 1);
    std::vector<M> poses = bodiesWith(world, motion, piece, t, anyErrors(rng, world));
    moveByThemselves(rng, world, motion, piece, t, poses);
    for (std::size_t a = 0; a < world.bodies.size(); ++a)
      for (const Opponent& o : opponents(world, motion, piece, static_cast<int>(a)))
        if (t >= toDouble(o.from) && mayBeNear(poses, a, static_cast<std::size_t>(o.body), toDouble(o.margin)) &&
            upperDistance(world, poses, static_cast<int>(a), o.body, steps) < toDouble(o.margin) - 1e-9)
          return true;
  }
  return false;
}

/// About how far tolerances let two bodies move against each other, from samples: seen from whichever body is better.
inline double movesBetween(const World& world, const Motion& motion, std::size_t piece, int a, int b) {
  const Sampler sampler(world, motion);
  double most = 0;
  for (int n = 0; n <= 8; ++n) {
    const std::vector<M> frames = sampler.frames(piece, n / 8.0), bodies = sampler.bodies(piece, n / 8.0);
    double sum[2] = {0, 0};
    const auto add = [&](const V& at, double slide, double chord) {
      for (const int side : {0, 1}) {
        const auto body = static_cast<std::size_t>(side == 0 ? a : b);
        sum[side] += slide;
        if (chord > 0)
          sum[side] += chord * (norm(bodies[body].t - at) +
                                radiusOf(world.geometries[static_cast<std::size_t>(world.bodies[body].geometry)]));
      }
    };
    const auto of = [](const auto& list, int key) {
      const auto at = list.find(key);
      return at == list.end() ? typename std::decay_t<decltype(list)>::mapped_type{} : at->second;
    };
    const auto chord = [](double angle) { return 2 * std::sin(std::min(angle, kPi) / 2); };
    int f = world.bodies[static_cast<std::size_t>(a)].frame, g = world.bodies[static_cast<std::size_t>(b)].frame;
    while (f != g) {
      int& up = f > g ? f : g;
      const Frame& frame = world.frames[static_cast<std::size_t>(up)];
      const V at = frames[static_cast<std::size_t>(up)].t;  // (a frame's slides come before its turns in these tests)
      const PoseTolerance base = of(world.frame_tolerances, up);
      add(frames[static_cast<std::size_t>(frame.parent)] * Sampler::stated(frame.numbers) *
              V{base.pivot[0], base.pivot[1], base.pivot[2]},
          base.length, chord(base.angle));
      for (const Element& e : frame.elements) {
        const double d = std::fabs(e.multiplier) * of(world.variable_tolerances, e.variable);
        if (e.kind == Element::rotate)
          add(at, 0, chord(of(world.rotation_tolerances, e.variable)));
        else
          add(at, e.kind == Element::slide ? d + of(world.vector_tolerances, e.variable).length : 0,
              e.kind == Element::turn ? chord(d) : 0);
      }
      up = frame.parent;
    }
    for (const int body : {a, b}) {
      const Body& own = world.bodies[static_cast<std::size_t>(body)];
      const PoseTolerance t = of(world.body_tolerances, own.name_id);
      const V pivot = bodies[static_cast<std::size_t>(body)] * V{t.pivot[0], t.pivot[1], t.pivot[2]};
      add(pivot, t.length, chord(t.angle));
      const double way = wayAt(world, motion, piece, n / 8.0, static_cast<std::size_t>(body));
      for (double& of_side : sum) of_side += way;
    }
    most = std::max(most, std::min(sum[0], sum[1]));
  }
  return 1.01 * most;
}

/// The lines of a world's tolerances, all of them multiplied.
struct ToleranceLines {
  struct Line {
    std::string begin;
    std::vector<double> numbers;
    std::string end;
  };
  std::vector<Line> lines;
  std::string write(double factor) const {
    std::string s;
    for (const Line& line : lines) {
      s += "tolerance " + line.begin;
      for (const double x : line.numbers) s += " " + hex(factor * x);
      s += line.end + "\n";
    }
    return s;
  }
};

/// Tolerances at random for a world of anyCase().
/// @param speeds  obstacles may have some.
inline ToleranceLines anyTolerances(Rng& rng, const World& world, bool speeds) {
  ToleranceLines t;
  const double size = std::pow(10, uniform(rng, -4, -1.5));
  const auto d = [&]() { return size * uniform(rng, 0.2, 1); };
  const auto pivot = [&](double far) { return " " + hex(anyVector(rng, far)); };
  for (const Frame& frame : world.frames)
    for (const Element& e : frame.elements) {
      const std::string v = std::to_string(e.variable);
      if (e.kind == Element::rotate)
        t.lines.push_back({"rotation " + v, {d()}, ""});
      else if (frame.elements.size() == 1 && rng() % 5)
        t.lines.push_back({"variable " + v, {d()}, ""});
      else if (frame.elements.size() > 1 && &e == &frame.elements[0])
        t.lines.push_back({"vector " + v + " 3", {d()}, ""});
    }
  if (rng() % 2) t.lines.push_back({"frame 1", {d(), d()}, pivot(0.3)});
  for (const Body& body : world.bodies)
    if (body.role == Role::obstacle && rng() % 3 == 0 &&
        !world.geometries[static_cast<std::size_t>(body.geometry)].unbounded())
      t.lines.push_back({"body " + body.name, {d(), d()}, pivot(0.2)});
  for (const Body& body : world.bodies)
    if (speeds && body.role == Role::obstacle && rng() % 2) {
      t.lines.push_back({"speed " + body.name, {d()}, " " + hex(rng() % 2 ? 0 : uniform(rng, -1, 2))});
      if (rng() % 2) t.lines.erase(t.lines.begin(), t.lines.end() - 1);  // and nothing else
      break;
    }
  if (t.lines.empty()) t.lines.push_back({"frame 1", {d(), d()}, pivot(0.3)});
  return t;
}

struct TubeCounts {
  int verified = 0, refused = 0, falsified = 0, forged = 0, accepted = 0;
  int with_speeds = 0;  ///< of those that are verified
};

/// The motion, with a clock in each piece where the world has speeds.
inline MotionText withClock(MotionText motion, const World& world, double step) {
  for (std::size_t k = 0; k < motion.pieces.size() && !world.speeds.empty(); ++k)
    motion.pieces[k] = "clock " + hex(static_cast<double>(k) * step) + " " + hex(static_cast<double>(k + 1) * step) +
                       "\n" + motion.pieces[k];
  return motion;
}

/// Random tubes with proofs by samples. No sample of a verified one may be nearer than its margin. Then all
/// tolerances grow until a sample shows the claim to be false: with the same proof, and one made for it, it is refused.
/// @param verified, forged  ends when there are as many of both.
/// @param speeds  bodies move by themselves, too: then speeds, not clocks, grow with the tolerances.
/// @param keep  is given the world and the record of each that is verified.
inline TubeCounts tubeCampaign(std::uint64_t seed, int verified, int forged, int samples, bool speeds,
                               const std::function<void(const std::string&, const std::string&)>& keep = {}) {
  Rng rng(seed);
  TubeCounts counts;
  Options options;
  options.work = 20000000;
  const auto provenWith = [&](const World& world, const Motion& motion) {
    Prover prover(world, motion);
    prover.most_time_depth = 5;
    std::map<std::pair<int, int>, double> known;
    prover.more = [&](int a, int b) {
      double& more = known[{a, b}];
      for (std::size_t piece = 0; more == 0 && piece < motion.pieces.size(); ++piece)
        more = std::max(more, movesBetween(world, motion, piece, a, b) + 1e-12);
      return more;
    };
    return prover.roots();
  };
  while (counts.verified < verified || counts.forged < forged) {
    const Case c = anyCase(rng);
    const World bare = readWorld(c.world_text);
    if (Motion m = readMotion(c.motion.write(bare), bare); tubeIsFalse(rng, bare, m, 20)) continue;
    const ToleranceLines lines = anyTolerances(rng, bare, speeds);
    const double step = speeds ? uniform(rng, 0.2, 2) : 0;
    const World world = readWorld(c.world_text + lines.write(1));
    const std::string claim = withClock(c.motion, world, step).write(world);
    const Motion motion = readMotion(claim, world);
    const std::string nodes = provenWith(world, motion);
    if (!judge(world, record(claim, nodes), options).verified) {
      ++counts.refused;
      continue;
    }
    ++counts.verified;
    counts.with_speeds += !world.speeds.empty();
    if (keep) keep(c.world_text + lines.write(1), record(claim, nodes));
    if (tubeIsFalse(rng, world, motion, samples)) ++counts.falsified;
    // The least factor of a few that a sample shows to be too large.
    for (double factor = 1.25; factor < 1e4; factor *= 1.25) {
      const World larger = readWorld(c.world_text + lines.write(factor));
      const std::string lie = withClock(c.motion, larger, step).write(larger);
      const Motion moved = readMotion(lie, larger);
      if (!tubeIsFalse(rng, larger, moved, 40)) continue;
      ++counts.forged;
      counts.accepted += judge(larger, record(lie, nodes), options).verified;
      Prover prover(larger, moved);  // which knows nothing of tolerances
      prover.most_time_depth = 3;
      counts.accepted += judge(larger, record(lie, prover.roots()), options).verified;
      break;
    }
  }
  return counts;
}

}  // namespace verify::test
