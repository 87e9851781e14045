// SPDX-License-Identifier: BSD-3-Clause
// The walk over a proof. Each node is about a task; TIME, PARTNERS, OWN and OTHER cut their task in two parts that
// cover it, and a leaf's claim is computed here. So when the walk has come through, every pair, piece and time is
// proven.
#include "proof.h"

#include <cstdio>

#include "places.h"
#include "tube.h"

namespace verify {

// When a piece's part of the claim ends.
static double endOf(const Motion& motion, std::size_t piece) {
  return piece + 1 == motion.pieces.size() ? motion.until : 1;
}

static bool inScope(const Motion& motion, const Partner& partner) {
  return partner.self ? motion.self : motion.scene;
}

std::vector<Opponent> opponents(const World& world, const Motion& motion, std::size_t piece, int body) {
  std::vector<Opponent> list;
  const auto& ignored = motion.pieces[piece].ignored;
  for (const Partner& partner : world.partners[body]) {
    if (!inScope(motion, partner)) continue;
    const double own = world.margin(body, partner.body, motion.margin);
    // An ignored pair is left out at and before its time, whose lower end is taken. Doubles decide whether it is left
    // out to the end of the piece.
    const auto pair = ignored.find({partner.body, body});
    const Fix from = pair == ignored.end()                  ? Fix{-kOne}
                     : pair->second >= endOf(motion, piece) ? integer(2)
                                                            : encloseDown(pair->second);
    list.push_back({partner.body, from, encloseUp(own) + encloseUp(motion.added)});
  }
  return list;
}

namespace {

std::string shown(Fix x) {
  char text[40];
  std::snprintf(text, sizeof text, "%.9g", toDouble(x));
  return text;
}

class Walk {
 public:
  Walk(const World& world, const Motion& motion, std::size_t piece, Bytes& bytes, Budget& budget)
      : world_(world), motion_(motion), piece_(piece), bytes_(bytes), poses_(world, motion.pieces[piece], budget) {}

  void run() {
    for (std::size_t a = 0; a < world_.bodies.size(); ++a) {
      a_ = static_cast<int>(a);
      poses_.spend(1 + world_.partners[a].size() + motion_.pieces[piece_].ignored.size());
      partners_ = opponents(world_, motion_, piece_, a_);
      if (partners_.empty()) continue;
      Task task;
      task.to = geometryOf(world_, a_).pieces();
      task.q = static_cast<std::uint32_t>(partners_.size());
      task.span = {Fix{0}, encloseUp(endOf(motion_, piece_))};
      choose(task);
      try {
        node(task);
      } catch (const NotProven& error) {
        throw NotProven(error.what() + where());
      }
    }
  }

 private:
  struct Task {
    std::uint32_t from = 0, to = 0;  // pieces of A
    std::uint32_t p = 0, q = 0;      // partners
    std::uint32_t k = 0, l = 0;      // pieces of the partner, where there is one
    Span span;
    int depth = 0, time_depth = 0;
    bool outside = false;  // SOLID has shown that neither is in the other
  };

  const Geometry& partner(const Task& task) const { return geometryOf(world_, partners_[task.p].body); }
  void choose(Task& task) const {
    if (task.q - task.p == 1) task.l = partner(task).pieces();
  }

  /// Where the walk was last, for people.
  std::string where() const {
    const std::string more = at_.q - at_.p == 2 ? " body after it" : " bodies after it",
                      others = at_.q - at_.p > 1 ? " and " + std::to_string(at_.q - at_.p - 1) + more : "";
    return ": " + world_.describe(a_) + " and " + world_.describe(partners_[at_.p].body) + others + ", time [" +
           shown(at_.span.a) + ", " + shown(at_.span.b) + "] of piece " + std::to_string(piece_);
  }

  std::uint32_t cut(std::uint32_t size) {
    const std::uint32_t c = bytes_.varint();
    if (c == 0 || c >= size) throw NotProven("a cut is not inside its task");
    return c;
  }

  void node(const Task& task) {
    at_ = task;
    if (task.depth > kMostDepth)
      throw NotProven("the proof is more than " + std::to_string(kMostDepth) + " nodes deep");
    poses_.spend(10);
    const bool single = task.q - task.p == 1;
    const std::uint8_t kind = bytes_.byte();
    Task first = task, second = task;
    ++first.depth;
    ++second.depth;
    switch (kind) {
      case kTime:
        if (task.time_depth == kMostTimeDepth) throw NotProven("time is cut more than 60 times");
        first.time_depth = second.time_depth = task.time_depth + 1;
        first.span.b = second.span.a = task.span.middle();
        break;
      case kPartners:
        first.q = second.p = task.p + cut(task.q - task.p);
        choose(first);
        choose(second);
        break;
      case kOwn:
        if (geometryOf(world_, a_).solid && !task.outside) throw NotProven("a solid is cut without SOLID");
        first.to = second.from = task.from + cut(task.to - task.from);
        break;
      case kOther:
        if (!single) throw NotProven("OTHER has more than one partner");
        if (partner(task).solid && !task.outside) throw NotProven("a solid is cut without SOLID");
        first.l = second.k = task.k + cut(task.l - task.k);
        break;
      case kSolid:
        if (!single || task.to - task.from != geometryOf(world_, a_).pieces() ||
            task.l - task.k != partner(task).pieces())
          throw NotProven("SOLID is about two whole bodies");
        solid(task);
        first.outside = true;
        return node(first);
      default:
        return leaf(task, kind);
    }
    node(first);
    node(second);
  }

  void solid(const Task& task) {
    const std::vector<OutsidePoint> points = bytes_.outsidePoints();
    const Opponent& other = partners_[task.p];
    if (other.from < task.span.b)
      checkSolid(world_, poses_, a_, other.body, std::max(task.span.a, other.from), points);
    else if (!points.empty())  // ignored for all of the task's time
      throw NotProven("SOLID names points of an ignored pair");
  }

  /// f(x) = v.x + d in the coordinates of a frame, with constant v and d. It keeps the task's bodies apart.
  struct Line {
    int frame = 0, wall = -1;  // wall: the one body without bounds, on all of which f or -f is at most 0
    Vec v{};
    Tm d{};
  };

  void leaf(const Task& task, std::uint8_t kind) {
    const bool sep = kind < kSepFine + 3;
    if (!sep && kind != kWall && kind != kWallOther)
      throw NotProven("there is no node of kind " + std::to_string(kind));
    const Line line = sep ? direction(task, kind) : wall(task, kind == kWallOther);
    poses_.spend(task.q - task.p);
    std::vector<std::uint32_t> all;
    for (std::uint32_t k = task.p; k < task.q; ++k) {
      const Fix from = partners_[k].from;
      if (from <= task.span.a)
        all.push_back(k);
      else if (from < task.span.b)  // from then on; after it, it is ignored all the time
        separated(task, {k}, line, {from, task.span.b}, 0);
    }
    separated(task, all, line, task.span, 0);
  }

  /// A power of two scales n to 1 at most. The choice of n does not matter to the proof.
  Line direction(const Task& task, std::uint8_t kind) {
    const int where = kind % 3, bytes = kind < kSepFine ? 2 : 4;
    Line line;
    if (where > 0) line.frame = world_.bodies[where == 1 ? a_ : partners_[task.p].body].frame;
    for (Tm& x : line.v) x.c0 = Fix{bytes_.signedLittle(bytes) * (kOne >> (8 * bytes - 1))};
    return line;
  }

  // f = d - n.x of the halfspace n.x <= d, or of either side of a plane. It is at least 0 on the wall, and must be
  // below 0 on the other body. If the wall is the partner, -f.
  Line wall(const Task& task, bool turned) const {
    if (task.q - task.p != 1) throw NotProven("WALL has more than one partner");
    const bool own = geometryOf(world_, a_).unbounded();
    if (own == partner(task).unbounded()) throw NotProven("WALL of two bodies with bounds, or two without");
    const int wall = own ? a_ : partners_[task.p].body;
    const Geometry& g = geometryOf(world_, wall);
    if (turned && g.kind != Geometry::plane) throw NotProven("WALL from the other side of a halfspace");
    const double sign = own != turned ? 1 : -1;
    const auto& n = g.numbers;
    const Functional::Value f =
        toParent({{exactly(-sign * n[0]), exactly(-sign * n[1]), exactly(-sign * n[2])}, exactly(sign * n[3])},
                 world_.bodies[wall].pose);
    return {world_.bodies[wall].frame, wall, f.v, f.d};
  }

  // For all t in the span: max over A of -f + max over a partner of f + (margin + M) |v| < 0, by the Bernstein
  // coefficients of each sum (support.cpp). M is what tolerances add (tube.cpp). Partners that are not shown to be
  // apart over the whole span are looked at again over its halves. (If they are not apart, the first such time ends the
  // search.)
  void separated(const Task& task, const std::vector<std::uint32_t>& partners, const Line& line, const Span& span,
                 int halvings) {
    if (partners.empty()) return;
    at_.span = span;
    std::vector<std::uint32_t> again;
    const Piece& piece = motion_.pieces[piece_];
    try {
      Functional f(world_, poses_, span, line.frame, line.v, line.d);
      Fix squares;
      for (const Tm& x : line.v) squares += mulUp(bound(x), bound(x));
      const Fix length = sqrtUp(squares);  // not below |v|
      const auto reach = [&](int body, std::uint32_t i, std::uint32_t j, bool negative) {
        if (body == line.wall) return std::array<Fix, 3>{};
        Functional::Value value = f.inBody(body);
        if (negative) value = {{-value.v[0], -value.v[1], -value.v[2]}, -value.d};
        poses_.spend(50);
        return geometryOf(world_, body).reach(i, j, value.v, value.d, length, poses_.budget());
      };
      const std::array<Fix, 3> a = reach(a_, task.from, task.to, true);
      Tube tube(world_, poses_, span, {a_, task.from, task.to});
      const bool single = task.q - task.p == 1;
      for (const std::uint32_t k : partners) {
        const int body = partners_[k].body;
        const auto b = reach(body, single ? task.k : 0, single ? task.l : geometryOf(world_, body).pieces(), false);
        const Lengths way = wayOf(world_, piece, span, a_), other = wayOf(world_, piece, span, body);
        Lengths closed;
        bool apart = true;
        for (std::size_t i = 0; i < 3; ++i) {
          closed[i] = a[i] + b[i] + mulUp(partners_[k].margin + way[i] + other[i], length);
          apart = apart && closed[i] < Fix{0};
        }
        if (apart && world_.gives) {
          const Part partner{body, single ? task.k : 0, single ? task.l : geometryOf(world_, body).pieces()};
          apart = tube.covers(closed, length, partner);
        }
        if (!apart) again.push_back(k);
      }
    } catch (const OutOfRange&) {
      again = partners;
    }
    if (again.empty()) return;
    if (halvings == kMostHalvings || span.b.v - span.a.v < 4) throw NotProven("not shown to be apart");
    separated(task, again, line, {span.a, span.middle()}, halvings + 1);
    separated(task, again, line, {span.middle(), span.b}, halvings + 1);
  }

  const World& world_;
  const Motion& motion_;
  const std::size_t piece_;
  Bytes& bytes_;
  Poses poses_;
  int a_ = 0;
  std::vector<Opponent> partners_;
  Task at_;
};

// In each piece a motion goes on where it was at the end of the piece before. Coefficients are rounded: 2^-29 rad or m,
// and 2^-39 of a joint's value but 2^-20 at most, are no jump. (A joint's offset is the same on both sides.) For
// `rotate` the orientations are compared, each entry of their matrices.
double largestJump(const World& world, const Motion& motion, Budget& budget) {
  Fix largest;
  for (std::size_t k = 1; k < motion.pieces.size(); ++k) {
    const auto jumps = [&](const std::string& what, Fix jump, Fix most) {
      largest = std::max(largest, jump);
      if (jump <= most) return;
      throw NotProven("the motion jumps: " + what + " is elsewhere at the beginning of piece " + std::to_string(k) +
                      " than at the end of the one before, by " + shown(jump));
    };
    Poses before(world, motion.pieces[k - 1], budget), after(world, motion.pieces[k], budget);
    const Span end{Fix{kOne}, Fix{kOne}}, begin{};
    for (std::size_t f = 1; f < world.frames.size(); ++f) {
      const int frame = static_cast<int>(f);
      budget.spend(1);
      bool rotates = false;
      for (const Element& e : world.frames[f].elements) {
        budget.spend(50);
        rotates = rotates || e.kind == Element::rotate;
        if (e.kind == Element::rotate) continue;
        const Tm m = exactly(e.multiplier), x = m * before.variable(e.variable, end),
                 y = m * after.variable(e.variable, begin);
        jumps("the variable " + inQuotes(world.variables[static_cast<std::size_t>(e.variable)]), bound(x - y),
              Fix{kOne >> 29} + std::min(shifted(bound(x), 39), Fix{kOne >> 20}));
      }
      if (!rotates) continue;
      const Mat R = before.local(frame, end).R, S = after.local(frame, begin).R;
      for (std::size_t c = 0; c < 9; ++c)
        jumps("the frame " + inQuotes(world.frames[f].name), bound(R[c] - S[c]), Fix{kOne >> 27});
    }
  }
  return toDouble(largest);
}

// How many pairs the claim is about, and how many not. A pair that every piece ignores to its end is not.
void countPairs(const World& world, const Motion& motion, Budget& budget, Verdict& verdict) {
  std::copy(std::begin(world.not_checked), std::end(world.not_checked), std::begin(verdict.not_checked));
  for (std::size_t a = 0; a < world.bodies.size(); ++a) {
    budget.spend(1 + world.partners[a].size() * motion.pieces.size());
    for (const Partner& partner : world.partners[a]) {
      std::size_t some = 0, whole = 0;  // pieces that ignore the pair, and that ignore it to their end
      for (std::size_t piece = 0; piece < motion.pieces.size(); ++piece) {
        const auto& ignored = motion.pieces[piece].ignored;
        const auto pair = ignored.find({partner.body, static_cast<int>(a)});
        if (pair == ignored.end()) continue;
        ++some;
        whole += pair->second >= endOf(motion, piece);
      }
      const bool checked = inScope(motion, partner) && whole < motion.pieces.size();
      verdict.checked += checked;
      verdict.late += checked && some > 0;
      if (checked) continue;
      ++verdict.not_checked[static_cast<int>(inScope(motion, partner) ? Reason::ignored : Reason::scope)];
    }
  }
}

}  // namespace

Verdict verifyRecord(const World& world, const Record& record, const Options& options) {
  Verdict verdict;
  Budget budget{options.work};
  try {
    const Motion motion = readMotion(record.motion, world);
    verdict.pieces = motion.pieces.size();
    verdict.until = motion.until;
    if (motion.world != hexOf(world.hash)) throw NotProven("the motion is about another world: " + motion.world);
    if (!world.false_reason.empty()) throw NotProven(world.false_reason);
    countPairs(world, motion, budget, verdict);
    if (verdict.checked == 0) throw NotProven("nothing is checked: the claim is about no pair of bodies");
    verdict.jump = largestJump(world, motion, budget);
    Bytes bytes(record.proof);
    if (bytes.take(motion.hash.size()) != motion.hash) throw NotProven("the proof is about another motion");
    for (std::size_t piece = 0; piece < motion.pieces.size(); ++piece) Walk(world, motion, piece, bytes, budget).run();
    if (!bytes.empty() && bytes.peek() == kContact) {
      const Meeting meeting = checkContact(world, motion, bytes, budget);
      verdict.contact_text = meeting.text;
      verdict.contact = true;
      verdict.near = meeting.near;
    }
    if (!bytes.empty()) throw BadInput("the proof has " + std::to_string(bytes.left()) + " bytes after its end");
    verdict.verified = true;
  } catch (const BadInput& error) {
    verdict.bad_input = true;
    verdict.reason = error.what();
  } catch (const NotProven& error) {
    verdict.reason = error.what();
  }
  verdict.steps = options.work - budget.left;
  return verdict;
}

}  // namespace verify
