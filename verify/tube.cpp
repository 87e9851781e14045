// SPDX-License-Identifier: BSD-3-Clause
// How much nearer two bodies can be than on the motion itself, as joints and poses may be off by their tolerances.
// The derivation is in doc/TUBES.md.
#include "tube.h"

#include "places.h"

namespace verify {
namespace {

/// Above 2 sin(min(x, pi) / 2), x >= 0. Up to 3.14 the sine of half of it grows.
Fix chordOf(Fix x) {
  if (x <= Fix{0}) return {};
  if (x > Fix{kOne / 50 * 157}) return integer(2);
  Fix sine, cosine;
  sineCosine(shifted(x, 1) + ulps(1), sine, cosine);
  return sine + sine + ulps(4);
}

Give giveOf(const PoseTolerance& t) {
  Give give;
  give.at = pointOf(t.pivot);
  give.slide = encloseUp(t.length);
  give.chord = chordOf(encloseUp(t.angle));
  return give;
}

double of(const std::map<int, double>& list, int key) {
  const auto at = list.find(key);
  return at == list.end() ? 0 : at->second;
}

/// An upper bound of |multiplier| tolerance.
Fix product(double multiplier, double tolerance) {
  if (tolerance == 0) return {};
  return mulUp(encloseUp(std::fabs(multiplier)), encloseUp(tolerance));
}

/// Whether slides by `count` variables from v on stand one after the other from this element on. All have the same
/// multiplier but for its sign.
bool isVector(const std::vector<Element>& elements, std::size_t at, int v, int count) {
  for (int k = 0; k < count; ++k, ++at)
    if (at >= elements.size() || elements[at].kind != Element::slide || elements[at].variable != v + k ||
        std::fabs(elements[at].multiplier) != std::fabs(elements[at - static_cast<std::size_t>(k)].multiplier))
      return false;
  return true;
}

class Gives {
 public:
  explicit Gives(World& world) : world_(world) {}

  void run() {
    for (std::size_t f = 1; f < world_.frames.size(); ++f) ofFrame(world_.frames[f], static_cast<int>(f));
    ofBodies();
    for (const auto& [v, d] : world_.variable_tolerances) needs(used_, v, "variable", "slides or turns");
    for (const auto& [v, d] : world_.vector_tolerances) needs(vectors_, v, "vector", "is the first of such slides");
    for (const auto& [v, d] : world_.rotation_tolerances) needs(rotations_, v, "rotation", "rotates");
  }

 private:
  static void needs(const std::vector<int>& there, int v, const std::string& what, const std::string& does) {
    if (std::find(there.begin(), there.end(), v) == there.end())
      throw BadInput("world: 'tolerance " + what + " " + std::to_string(v) + "': no element " + does + " by it");
  }

  void ofFrame(Frame& frame, int number) {
    if (const auto t = world_.frame_tolerances.find(number); t != world_.frame_tolerances.end()) {
      frame.gives.push_back(giveOf(t->second));
      refuseWithoutBodies(number);
    }
    for (std::size_t k = 0; k < frame.elements.size(); ++k) {
      const Element& e = frame.elements[k];
      Give give;
      give.element = static_cast<int>(k);
      if (e.kind == Element::rotate) {
        give.chord = chordOf(encloseUp(of(world_.rotation_tolerances, e.variable)));
        rotations_.push_back(e.variable);
        for (int v = e.variable; v < e.variable + 3; ++v)
          if (world_.variable_tolerances.count(v) > 0)
            throw BadInput("world: 'tolerance variable " + std::to_string(v) + "': it is one of a 'rotate'");
      } else {
        used_.push_back(e.variable);
        give.axis = e.kind == Element::turn;
        if (give.axis) give.at = e.unit;
        // A joint that mimics takes |multiplier| of the variable's tolerance.
        const Fix most = product(e.multiplier, of(world_.variable_tolerances, e.variable));
        (give.axis ? give.chord : give.slide) = give.axis ? chordOf(most) : most;
        ofVector(frame, k, give);
      }
      if (give.chord > Fix{0} || give.slide > Fix{0}) frame.gives.push_back(give);
    }
    world_.gives = world_.gives || !frame.gives.empty();
  }

  /// The first of a vector's slides takes its tolerance.
  void ofVector(const Frame& frame, std::size_t k, Give& give) {
    const Element& e = frame.elements[k];
    for (const auto& [v, vector] : world_.vector_tolerances) {
      if (e.variable < v || e.variable >= v + vector.count) continue;
      const auto place = static_cast<std::size_t>(e.variable - v);
      if (place > k || !isVector(frame.elements, k - place, v, vector.count) || give.slide > Fix{0} || give.axis)
        throw BadInput("world: 'tolerance vector " + std::to_string(v) +
                       "': its variables do more than slide one after the other, or have tolerances of their own");
      if (place > 0) {
        give.slide = Fix{};
        return;
      }
      vectors_.push_back(v);
      give.slide = product(e.multiplier, vector.length);
      return;
    }
  }

  void ofBodies() {
    for (Body& body : world_.bodies) {
      const auto t = world_.body_tolerances.find(body.name_id);
      if (t == world_.body_tolerances.end()) continue;
      body.gives.push_back(giveOf(t->second));
      world_.gives = true;
    }
  }

  /// A line without a meaning: nothing is below the frame.
  void refuseWithoutBodies(int number) const {
    for (const Body& body : world_.bodies)
      for (int f = body.frame; f >= number; f = world_.frames[static_cast<std::size_t>(f)].parent)
        if (f == number) return;
    throw BadInput("world: 'tolerance frame " + std::to_string(number) + "': no body is in it or below it");
  }

  World& world_;
  std::vector<int> used_, vectors_, rotations_;  // variables of elements that may have such a tolerance
};

const Pose kIdentity{
    {constant(integer(1)), Tm{}, Tm{}, Tm{}, constant(integer(1)), Tm{}, Tm{}, Tm{}, constant(integer(1))}, {}};

Pose operator*(const Pose& a, const Pose& b) {
  return {a.R * b.R, a.R * b.t + a.t};
}
/// R is proper, so R^T is its inverse.
Pose inverse(const Pose& pose) {
  Mat R;
  for (std::size_t k = 0; k < 9; ++k) R[k] = pose.R[3 * (k % 3) + k / 3];
  const Vec t = R * pose.t;
  return {R, {-t[0], -t[1], -t[2]}};
}

}  // namespace

void deriveGives(World& world) {
  Gives(world).run();
}

// The way v max(0, T(t) - since) is convex in t, as the clock T is a line: the chord from one end of the span to the
// other is not below it. T(t) = begin + t (end - begin) and t is in [0, 1], so bounds of both ends bound it.
Lengths wayOf(const World& world, const Piece& piece, const Span& span, int body) {
  const auto own = world.speeds.find(world.bodies[static_cast<std::size_t>(body)].name_id);
  if (own == world.speeds.end()) return {};
  const Fix begin = encloseUp(piece.clock[0]), most = encloseUp(piece.clock[1]) - encloseDown(piece.clock[0]);
  const auto at = [&](Fix t) {
    const Fix since = begin + mulUp(std::max(t, Fix{0}), most) - encloseDown(own->second.since);
    return since > Fix{0} ? mulUp(encloseUp(own->second.speed), since) : Fix{0};
  };
  const Fix first = at(span.a), last = at(span.b);
  return {first, shifted(first + last, 1) + ulps(1), last};
}

// The distance of x = R p + t from the axis through 0 along the unit vector k is |k x x|; from a point c it is |x - c|.
std::optional<Lengths> Tube::move(const Part& part, const Give& give, const Pose& pose) {
  Lengths lengths{give.slide, give.slide, give.slide};
  if (give.chord <= Fix{0}) return lengths;
  const Geometry& geometry = geometryOf(world_, part.body);
  if (geometry.unbounded()) return std::nullopt;
  poses_.spend(50);
  Mat W = pose.R;
  Vec o = pose.t - give.at;
  if (give.axis) {
    const Vec& k = give.at;
    const Mat cross{Tm{}, -k[2], k[1], k[2], Tm{}, -k[0], -k[1], k[0], Tm{}};
    W = cross * pose.R;
    o = cross * pose.t;
  }
  const Lengths far = geometry.distance(part.from, part.to, W, o, poses_.budget());
  for (std::size_t i = 0; i < 3; ++i) lengths[i] += mulUp(give.chord, far[i]);
  return lengths;
}

Tube::Moves Tube::movesOf(const Part& part, int other) {
  const std::vector<Frame>& frames = world_.frames;
  const Body &own = world_.bodies[part.body], &end = world_.bodies[other];
  Moves moves;
  for (const Give& give : own.gives) moves.push_back(move(part, give, kIdentity));
  Pose pose = own.pose;  // of the part's geometry, in the coordinates of frame f
  const auto ofFrame = [&](int f, std::size_t k) {
    const Give& give = frames[f].gives[k];
    const bool last = give.element + 1 == static_cast<int>(frames[f].elements.size());
    moves.push_back(move(part, give, last ? pose : poses_.after(f, give.element, span_) * pose));
  };
  int f = own.frame, g = end.frame;
  std::vector<int> down;  // frames from the other one up to the common ancestor
  while (f != g) {        // a parent's number is below the frame's own
    poses_.spend(50);
    if (f < g) {
      down.push_back(g);
      g = frames[g].parent;
      continue;
    }
    for (std::size_t k = frames[f].gives.size(); k-- > 0;) ofFrame(f, k);
    pose = poses_.local(f, span_) * pose;
    f = frames[f].parent;
  }
  for (auto at = down.rbegin(); at != down.rend(); ++at) {
    poses_.spend(50);
    pose = inverse(poses_.local(*at, span_)) * pose;
    for (std::size_t k = 0; k < frames[*at].gives.size(); ++k) ofFrame(*at, k);
  }
  for (const Give& give : end.gives) moves.push_back(move(part, give, inverse(end.pose) * pose));
  return moves;
}

// Seen from a place between the two, B's points move by the sum of B's moves at the places before it, and A's by the
// sum of A's at those after it. The first place of all is B itself, the last one A.
bool Tube::covers(const Lengths& closed, Fix length, const Part& b) {
  if (!world_.gives) return true;
  const int frame = world_.bodies[b.body].frame;
  if (known_frame_ != frame || !world_.bodies[b.body].gives.empty()) {
    known_ = movesOf(a_, b.body);
    known_frame_ = world_.bodies[b.body].gives.empty() ? frame : -1;
  }
  const auto holds = [&](const Moves& as, std::size_t of_a, const Moves& bs, std::size_t of_b) {
    Lengths sum{};
    for (std::size_t k = 0; k < of_a + of_b; ++k) {
      const std::optional<Lengths>& one = k < of_a ? as[k] : bs[k - of_a];
      if (!one) return false;
      for (std::size_t i = 0; i < 3; ++i) sum[i] += (*one)[i];
    }
    for (std::size_t i = 0; i < 3; ++i)
      if (!(closed[i] + mulUp(sum[i], length) < Fix{0})) return false;
    return true;
  };
  const std::size_t all = known_.size();
  if (holds(known_, all, {}, 0)) return true;
  const Moves of_b = movesOf(b, a_.body);
  for (std::size_t k = 0; k < all; ++k)
    if (holds(known_, k, of_b, all - k)) return true;
  return false;
}

}  // namespace verify
