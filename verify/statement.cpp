// SPDX-License-Identifier: BSD-3-Clause
#include "statement.h"

#include <set>

namespace verify {
namespace {

/// The facts about each frame that count for neighbours, found once.
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
    std::set<int> slides;  // variables
    bool free = false;
    for (const Element& e : frame.elements) {
      if (e.kind == Element::slide) slides.insert(e.variable);
      free = free || slides.size() > 1 || (e.kind == Element::rotate && !slides.empty());
    }
    const bool moves = !frame.elements.empty();
    facts.push_back({moves, on_still && free, on_still && !moves, false});
  }
  for (const Body& body : world.bodies)
    if (body.role == Role::link) facts[static_cast<std::size_t>(body.frame)].link = true;
  return facts;
}

/// The fault of a reason, as far as it is not the user's word; empty: none. See "Pairs" in doc/CERTIFICATES.md.
std::string faultOf(const World& world, const std::vector<FrameFacts>& facts, Reason reason, const Body& a,
                    const Body& b, std::uint64_t& steps) {
  const auto isEither = [&](Role role) { return a.role == role || b.role == role; };
  if (reason == Reason::touch_link && (isEither(Role::obstacle) || !isEither(Role::carried)))
    return "the world calls them what a link carries and a link, and they are not: ";
  if (reason != Reason::still && reason != Reason::neighbours) return "";
  int moving = 0, f = a.frame, g = b.frame;
  bool free = false, between = false;  // a frame moves freely; one between the two carries a link
  const auto isBetween = [&](int frame) {
    return facts[static_cast<std::size_t>(frame)].link && frame != a.frame && frame != b.frame;
  };
  while (f != g) {  // a parent's number is below the frame's own: the larger one is not the common ancestor
    int& up = f > g ? f : g;
    ++steps;
    moving += facts[static_cast<std::size_t>(up)].moves;
    free = free || facts[static_cast<std::size_t>(up)].free;
    between = between || isBetween(up);
    up = world.frames[static_cast<std::size_t>(up)].parent;
  }
  if (reason == Reason::still)
    return moving == 0 ? "" : "the world has them stand still against each other, and they do not: ";
  const bool links = !isEither(Role::obstacle) && !isEither(Role::carried);
  if (links && moving <= 1 && !free && !between && !isBetween(f)) return "";
  return "the world calls them neighbours, and they are not: ";
}

}  // namespace

void derivePairs(World& world) {
  const std::size_t n = world.bodies.size();
  const std::vector<FrameFacts> facts = factsOf(world);
  world.partners.resize(n);
  std::vector<int> others;  // no obstacles
  std::uint64_t obstacles = 0, steps = 0;
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
        ++world.not_checked[static_cast<int>(listed->second.reason)];
        ++listed->second.pairs;
        if (!world.false_reason.empty()) return;
        const std::string fault = faultOf(world, facts, listed->second.reason, A, B, steps);
        if (!fault.empty())
          world.false_reason = fault + world.describe(static_cast<int>(a)) + " and " + world.describe(b);
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
}

bool isCoordinateAxis(const double axis[3]) {
  return (axis[0] != 0) + (axis[1] != 0) + (axis[2] != 0) == 1;
}

Mat statedRotation(const double numbers[9]) {
  Mat R;
  for (int k = 0; k < 9; ++k) {
    R[k] = exactly(numbers[k]);
    R[k].r += Fix{kOne >> 49};
  }
  return R;
}
Pose statedPose(const double numbers[12]) {
  return {statedRotation(numbers), {exactly(numbers[9]), exactly(numbers[10]), exactly(numbers[11])}};
}

double World::margin(int a, int b, double general) const {
  const int x = bodies[a].name_id, y = bodies[b].name_id;
  const auto pair = pair_margins.find(std::minmax(x, y));
  if (pair != pair_margins.end()) return pair->second;
  const auto p = margins.find(x), q = margins.find(y);
  if (p == margins.end()) return q == margins.end() ? general : q->second;
  return q == margins.end() ? p->second : std::max(p->second, q->second);
}

}  // namespace verify
