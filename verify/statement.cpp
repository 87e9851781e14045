// SPDX-License-Identifier: BSD-3-Clause
#include "statement.h"

#include <algorithm>
#include <set>

namespace verify {
namespace {

/// What of each frame counts for neighbours, found once.
struct FrameFacts {
  bool moves;  // has elements
  bool free;   // and moves freely on what stands still
  bool still;  // neither this frame nor one above it moves
  bool link;   // a body of role link is in it
};

std::vector<FrameFacts> factsOf(const World& world) {
  std::vector<FrameFacts> facts;
  for (const Frame& frame : world.frames) {  // parents first
    const bool on_still = facts.empty() || facts[static_cast<std::size_t>(frame.parent)].still;
    int slides = 0, first = -1;
    bool after = false;
    for (const Element& e : frame.elements) {
      if (e.kind == Element::slide) {
        if (first < 0 || e.variable != first) ++slides;
        first = e.variable;
      }
      after = after || (e.kind == Element::rotate && slides > 0);
    }
    const bool moves = !frame.elements.empty();
    facts.push_back({moves, on_still && (slides > 1 || after), on_still && !moves, false});
  }
  for (const Body& body : world.bodies)
    if (body.role == Role::link) facts[static_cast<std::size_t>(body.frame)].link = true;
  return facts;
}

/// Whether nothing on the path between the two frames moves.
bool standStill(const World& world, const std::vector<FrameFacts>& facts, int f, int g, std::uint64_t& steps) {
  while (f != g) {
    int& up = f > g ? f : g;
    ++steps;
    if (facts[static_cast<std::size_t>(up)].moves) return false;
    up = world.frames[static_cast<std::size_t>(up)].parent;
  }
  return true;
}

/// See "Pairs" in doc/CERTIFICATES.md.
bool areNeighbours(const World& world, const std::vector<FrameFacts>& facts, const Body& a, const Body& b,
                   std::uint64_t& steps) {
  if (a.role != Role::link || b.role != Role::link) return false;
  int moving = 0, f = a.frame, g = b.frame;
  while (f != g) {  // a parent's number is below the frame's own: the larger one is not the common ancestor
    int& up = f > g ? f : g;
    const FrameFacts& at = facts[static_cast<std::size_t>(up)];
    ++steps;
    if (at.moves && ++moving > 1) return false;
    if (at.free) return false;
    if (at.link && up != a.frame && up != b.frame) return false;
    up = world.frames[static_cast<std::size_t>(up)].parent;
  }
  return !facts[static_cast<std::size_t>(f)].link || f == a.frame || f == b.frame;
}

/// Lines that say nothing: who wrote them meant something else.
void refuseUnused(const World& world, const std::set<std::pair<int, int>>& used_pairs) {
  std::vector<char> there(world.names.size(), 0), used(world.geometries.size(), 0);
  for (const Body& body : world.bodies) {
    there[static_cast<std::size_t>(body.name_id)] = 1;
    used[static_cast<std::size_t>(body.geometry)] = 1;
  }
  for (std::size_t k = 0; k < there.size(); ++k)
    if (!there[k])
      throw BadInput("world: 'margin' or 'unchecked' names " + inQuotes(world.names[k]) + ": no body is called so");
  for (std::size_t k = 0; k < used.size(); ++k)
    if (!used[k]) throw BadInput("world: no body has the geometry " + std::to_string(k));
  for (const auto& [pair, reason] : world.unchecked)
    if (used_pairs.count(pair) == 0)
      throw BadInput("world: 'unchecked' of " + inQuotes(world.names[static_cast<std::size_t>(pair.first)]) + " and " +
                     inQuotes(world.names[static_cast<std::size_t>(pair.second)]) +
                     ": no two bodies of these names would be checked");
}

}  // namespace

void derivePairs(World& world) {
  const std::size_t n = world.bodies.size();
  const std::vector<FrameFacts> facts = factsOf(world);
  world.partners.resize(n);
  std::vector<int> others;  // no obstacles
  std::uint64_t obstacles = 0, steps = 0;
  std::set<std::pair<int, int>> used;  // pairs of names that are listed as unchecked
  for (std::size_t a = 0; a < n; ++a) {
    const Body& A = world.bodies[a];
    const bool obstacle = A.role == Role::obstacle;
    const auto look = [&](int b) {
      if (++steps > 20000000) throw BadInput("world: there are more than 20 million pairs to look at");
      const Body& B = world.bodies[b];
      const auto listed = world.unchecked.find(std::minmax(A.name_id, B.name_id));
      if (A.frame == B.frame) {
        ++world.not_checked[static_cast<int>(Reason::same_frame)];
      } else if (listed != world.unchecked.end()) {
        ++world.not_checked[static_cast<int>(listed->second)];
        used.insert(listed->first);
        const auto refuse = [&](const char* why) {
          world.false_reason = why + world.describe(static_cast<int>(a)) + " and " + world.describe(b);
        };
        if (listed->second == Reason::neighbours && world.false_reason.empty() &&
            !areNeighbours(world, facts, A, B, steps))
          refuse("the world calls them neighbours, and they are not: ");
        if (listed->second == Reason::still && world.false_reason.empty() &&
            !standStill(world, facts, A.frame, B.frame, steps))
          refuse("the world has them stand still against each other, and they do not: ");
        if (listed->second == Reason::touch_link &&
            (obstacle || B.role == Role::obstacle || (A.role != Role::carried && B.role != Role::carried)))
          throw BadInput("world: 'touch-link' of " + inQuotes(A.name) + " and " + inQuotes(B.name) +
                         ": it is for what a link carries, and a link");
      } else {
        world.partners[a].push_back({b, !obstacle && B.role != Role::obstacle});
      }
    };
    if (obstacle) {
      world.not_checked[static_cast<int>(Reason::obstacles)] += obstacles++;
      for (const int b : others) look(b);
    } else {
      for (std::size_t b = 0; b < a; ++b) look(static_cast<int>(b));
      others.push_back(static_cast<int>(a));
    }
  }
  refuseUnused(world, used);
}

const char* nameOf(Reason reason) {
  static const char* const kNames[kReasons] = {"same frame", "two obstacles", "still against each other",
                                               "neighbours", "allowed",       "touch-link",
                                               "scope",      "ignored"};
  return kNames[static_cast<int>(reason)];
}
const char* nameOf(Role role) {
  static const char* const kNames[] = {"link", "carried", "obstacle"};
  return kNames[static_cast<int>(role)];
}

std::string inQuotes(std::string_view name) {
  std::string text = "'";
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 32 || byte > 126 || c == '\'' || c == '\\') {
      const char* const digits = "0123456789abcdef";
      text += {'\\', 'x', digits[byte >> 4], digits[byte & 15]};
    } else {
      text += c;
    }
  }
  return text + "'";
}

bool isCoordinateAxis(const double axis[3]) {
  return (axis[0] != 0) + (axis[1] != 0) + (axis[2] != 0) == 1;
}

Mat statedRotation(const double numbers[9]) {
  Mat R;
  for (int k = 0; k < 9; ++k) {
    R[k] = constant(enclose(numbers[k]));
    R[k].r += Fix{static_cast<Int>(1) << (64 - 49)};
  }
  return R;
}
Pose statedPose(const double numbers[12]) {
  Pose pose;
  pose.R = statedRotation(numbers);
  for (int k = 0; k < 3; ++k) pose.t[k] = constant(enclose(numbers[9 + k]));
  return pose;
}

double World::margin(int a, int b, double general) const {
  const int x = bodies[a].name_id, y = bodies[b].name_id;
  const auto pair = pair_margins.find(std::minmax(x, y));
  if (pair != pair_margins.end()) return pair->second;
  const auto p = margins.find(x), q = margins.find(y);
  if (p == margins.end() && q == margins.end()) return general;
  if (p == margins.end() || q == margins.end()) return p == margins.end() ? q->second : p->second;
  return std::max(p->second, q->second);
}

std::string World::describe(int body) const {
  return std::string(nameOf(bodies[body].role)) + " " + inQuotes(bodies[body].name) + " (body " + std::to_string(body) +
         ")";
}

}  // namespace verify
