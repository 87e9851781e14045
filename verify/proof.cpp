// SPDX-License-Identifier: BSD-3-Clause
// The walk over a proof. Each node is about a task; TIME, PARTNERS, OWN and OTHER cut their task in two parts that
// cover it, and a leaf's claim is computed here. So when the walk has come through, every pair, piece and time is
// proven.
#include "proof.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <set>
#include <utility>

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
  for (const Partner& partner : world.partners[body]) {
    if (!inScope(motion, partner)) continue;
    const double own = world.margin(body, partner.body, motion.margin);
    list.push_back({partner.body, Fix{-kOne}, encloseUp(own) + encloseUp(motion.added)});
  }
  // An ignored pair is left out at and before its time, of which the lower end is taken; whether that is to the end of
  // the piece is decided in doubles. The list is in ascending order, as world.partners is.
  const double end = endOf(motion, piece);
  for (const Ignored& ignored : motion.pieces[piece].ignored) {
    if (ignored.b != body) continue;
    const auto at =
        std::lower_bound(list.begin(), list.end(), ignored.a, [](const Opponent& o, int b) { return o.body < b; });
    if (at == list.end() || at->body != ignored.a) continue;
    at->from = most(at->from, ignored.until >= end ? integer(2) : encloseDown(ignored.until));
  }
  return list;
}

namespace {

/// Says already which bodies, pieces and time it is about.
struct Located : NotProven {
  using NotProven::NotProven;
};

std::string spanText(const Span& span) {
  char text[80];
  std::snprintf(text, sizeof text, "[%.9g, %.9g]", toDouble(span.a), toDouble(span.b));
  return text;
}

class Walk {
 public:
  Walk(const World& world, const Motion& motion, std::size_t piece, Bytes& bytes, const Options& options,
       Budget& budget, Verdict& verdict)
      : world_(world),
        motion_(motion),
        piece_(piece),
        bytes_(bytes),
        options_(options),
        budget_(budget),
        verdict_(verdict),
        poses_(world, motion.pieces[piece], budget) {}

  void run() {
    const bool last = piece_ + 1 == motion_.pieces.size();
    const Span all{Fix{0}, last ? encloseUp(motion_.until) : Fix{kOne}};
    for (std::size_t a = 0; a < world_.bodies.size(); ++a) {
      a_ = static_cast<int>(a);
      budget_.spend(1 + world_.partners[a].size() + motion_.pieces[piece_].ignored.size());
      partners_ = opponents(world_, motion_, piece_, a_);
      if (partners_.empty()) continue;
      Task task;
      task.to = geometry(a_).pieces();
      task.q = static_cast<std::uint32_t>(partners_.size());
      task.span = all;
      choose(task);
      node(task);
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

  const Geometry& geometry(int body) const { return world_.geometries[world_.bodies[body].geometry]; }
  void choose(Task& task) const {
    if (task.q - task.p != 1) return;
    task.k = 0;
    task.l = geometry(partners_[task.p].body).pieces();
  }
  bool wholeOther(const Task& task) const { return task.k == 0 && task.l == geometry(partners_[task.p].body).pieces(); }
  bool wholeOwn(const Task& task) const { return task.from == 0 && task.to == geometry(a_).pieces(); }

  [[noreturn]] void fail(const Task& task, const std::string& why) const {
    std::string text = why + ": " + world_.describe(a_);
    if (!wholeOwn(task)) text += " pieces " + std::to_string(task.from) + "-" + std::to_string(task.to - 1);
    text += " and ";
    if (task.q - task.p == 1) {
      text += world_.describe(partners_[task.p].body);
      if (!wholeOther(task)) text += " pieces " + std::to_string(task.k) + "-" + std::to_string(task.l - 1);
    } else {
      text += std::to_string(task.q - task.p) + " bodies from " + world_.describe(partners_[task.p].body) + " on";
    }
    text += ", time " + spanText(task.span);
    if (motion_.pieces.size() > 1) text += " of piece " + std::to_string(piece_);
    throw Located(text);
  }

  std::uint32_t cut(std::uint32_t size, const Task& task) {
    const std::uint32_t c = bytes_.varint();
    if (c == 0 || c >= size) fail(task, "a cut is not inside its task");
    return c;
  }

  void node(const Task& task) {
    if (task.depth > kMostDepth) fail(task, "the proof is more than " + std::to_string(kMostDepth) + " nodes deep");
    budget_.spend(10);
    const std::uint8_t kind = bytes_.byte();
    Task first = task, second = task;
    ++first.depth;
    ++second.depth;
    switch (kind) {
      case kTime:
        if (task.time_depth == kMostTimeDepth) fail(task, "time is cut more than 60 times");
        first.time_depth = second.time_depth = task.time_depth + 1;
        first.span.b = second.span.a = task.span.middle();
        break;
      case kPartners:
        first.q = second.p = task.p + cut(task.q - task.p, task);
        choose(first);
        choose(second);
        break;
      case kOwn:
        if (geometry(a_).solid && !task.outside) fail(task, "a solid is cut without SOLID");
        first.to = second.from = task.from + cut(task.to - task.from, task);
        break;
      case kOther:
        if (task.q - task.p != 1) fail(task, "OTHER has more than one partner");
        if (geometry(partners_[task.p].body).solid && !task.outside) fail(task, "a solid is cut without SOLID");
        first.l = second.k = task.k + cut(task.l - task.k, task);
        break;
      case kSolid:
        solid(first);
        node(first);
        return;
      default:
        leaf(task, kind);
        return;
    }
    node(first);
    node(second);
  }

  void solid(Task& task) {
    if (task.q - task.p != 1 || !wholeOwn(task) || !wholeOther(task)) fail(task, "SOLID is about two whole bodies");
    const std::vector<OutsidePoint> points = bytes_.outsidePoints();
    const Opponent& other = partners_[task.p];
    try {
      if (other.from < task.span.b)
        checkSolid(world_, poses_, a_, other.body, most(task.span.a, other.from), points, budget_);
      else if (!points.empty())  // ignored for all of the task's time
        throw NotProven("SOLID names points of an ignored pair");
    } catch (const NotProven& error) {
      fail(task, error.what());
    }
    task.outside = true;
  }

  /// f(x) = v.x + d in the coordinates of a frame, by which the task's bodies are told apart: v is linear in s, d is
  /// constant.
  struct Line {
    int frame = 0, wall = -1;  // wall: the one body without bounds, on all of which f or -f is at most 0
    Vec v{};
    Tm d{};
    /// The same over the part [u, w] of its interval, 0 <= u <= w <= 1. (Where v changes it is rounded, and is another
    /// direction then, the same one for both sides.)
    Line part(Fix u, Fix w) const {
      Line line = *this;
      for (Tm& x : line.v) {
        x.c0 += x.c1 * (u + w - Fix{kOne});
        x.c1 = x.c1 * (w - u);
      }
      return line;
    }
  };

  void leaf(const Task& task, std::uint8_t kind) {
    ++verdict_.leaves;
    if (kind > kWallOther) fail(task, "there is no node of kind " + std::to_string(kind));
    const Line line = kind < kWall ? direction(task, kind) : wall(task, kind == kWallOther);
    budget_.spend(task.q - task.p);
    std::vector<std::uint32_t> all;
    for (std::uint32_t k = task.p; k < task.q; ++k) {
      const Fix from = partners_[k].from, a = task.span.a, b = task.span.b;
      if (from >= b) continue;  // ignored all the time
      if (from <= a) {
        all.push_back(k);
      } else {  // from then on; the direction of a TURN moves along
        const double part = static_cast<double>((from - a).v) / static_cast<double>((b - a).v);  // a hint
        separated(task, {k}, line.part(enclose(std::min(1.0, part)).x, Fix{kOne}), {from, b}, 0);
      }
    }
    separated(task, all, line, task.span, 0);
  }

  Line direction(const Task& task, std::uint8_t kind) {
    const int where = kind % 3, width = kind < kSepFine ? 2 : 4, n = kind < kTurn ? 3 : 6;
    // A power of two scales n to about 1; which n it is has no influence on what is proven.
    std::int64_t integers[6] = {}, largest = 0;
    for (int k = 0; k < n; ++k) {
      integers[k] = bytes_.signedLittle(width);
      largest = std::max(largest, std::abs(integers[k]));
    }
    int shift = 1;
    while (largest >> (shift - 1) > 0) ++shift;
    Line line;
    if (where > 0) line.frame = world_.bodies[where == 1 ? a_ : partners_[task.p].body].frame;
    for (std::size_t k = 0; k < 3; ++k) {  // n(s) = (n0 + n1)/2 + s (n1 - n0)/2, exactly
      const std::int64_t n0 = integers[k], n1 = n == 3 ? n0 : integers[3 + k];
      line.v[k].c0 = Fix{static_cast<Int>(n0 + n1) * (kOne >> shift)};
      line.v[k].c1 = Fix{static_cast<Int>(n1 - n0) * (kOne >> shift)};
    }
    return line;
  }

  // f = d - n.x of the halfspace n.x <= d, or of either side of a plane: it is not below 0 where the wall is, and is to
  // be below it where the other body is. Where the wall is the partner, -f.
  Line wall(const Task& task, bool turned) const {
    if (task.q - task.p != 1) fail(task, "WALL has more than one partner");
    const int partner = partners_[task.p].body;
    const bool own = geometry(a_).unbounded();
    if (own == geometry(partner).unbounded()) fail(task, "WALL of two bodies with bounds, or two without");
    Line line;
    line.wall = own ? a_ : partner;
    line.frame = world_.bodies[line.wall].frame;
    const Geometry& g = geometry(line.wall);
    if (turned && g.kind != Geometry::plane) fail(task, "WALL from the other side of a halfspace");
    int exponent = 0;
    std::frexp(std::max({std::fabs(g.numbers[0]), std::fabs(g.numbers[1]), std::fabs(g.numbers[2])}), &exponent);
    const double sign = own != turned ? 1 : -1;
    const auto scaled = [&](std::size_t k) { return constant(enclose(std::ldexp(sign * g.numbers[k], -exponent))); };
    const Functional::Value f =
        toParent({{-scaled(0), -scaled(1), -scaled(2)}, scaled(3)}, world_.bodies[line.wall].pose);
    line.v = f.v;
    line.d = f.d;
    return line;
  }

  /// Above |v(s)| for all s, of a v that is linear in s: each entry is at most |l| + r with l linear, so this is a
  /// convex length, and at most that at one of both ends.
  static Fix lengthUp(const Vec& v) {
    Fix squares[2];
    for (const Tm& x : v)
      for (int end = 0; end < 2; ++end) {
        const Fix most = abs(end == 0 ? x.c0 - x.c1 : x.c0 + x.c1) + x.r;
        squares[end] += mulUp(most, most);
      }
    return sqrtUp(most(squares[0], squares[1]));
  }

  // For all t in the span: max over A of -f + max over a partner of f + margin |v| < 0, by the Bernstein coefficients
  // of each sum (support.cpp). Partners that are not shown to be apart over the whole span are looked at again over its
  // halves.
  void separated(const Task& task, const std::vector<std::uint32_t>& partners, const Line& line, const Span& span,
                 int halvings) {
    if (partners.empty()) return;
    std::vector<std::uint32_t> again;
    try {
      Functional f(world_, poses_, span, line.frame, line.v, line.d);
      const Fix length = lengthUp(line.v);
      const auto reach = [&](int body, std::uint32_t i, std::uint32_t j, bool negative) {
        if (body == line.wall) return Geometry::Reach{};
        if (geometry(body).unbounded()) fail(task, "SEP of a body without bounds");
        Functional::Value value = f.inBody(body);
        if (negative) value = {{-value.v[0], -value.v[1], -value.v[2]}, -value.d};
        budget_.spend(50);
        return geometry(body).reach(i, j, value.v, value.d, length, budget_);
      };
      const Geometry::Reach a = reach(a_, task.from, task.to, true);
      const bool single = task.q - task.p == 1;
      for (const std::uint32_t k : partners) {
        const int body = partners_[k].body;
        const Geometry::Reach b = reach(body, single ? task.k : 0, single ? task.l : geometry(body).pieces(), false);
        if (!apart(task, a, b, mulUp(partners_[k].margin, length))) again.push_back(k);
      }
    } catch (const Located&) {
      throw;
    } catch (const OutOfRange& error) {
      if (halvings == options_.halvings) fail(task, error.what());
      again = partners;
    } catch (const NotProven& error) {
      fail(task, error.what());
    }
    if (again.empty()) return;
    if (halvings == options_.halvings || span.b.v - span.a.v < 4) fail(task, "not shown to be apart");
    constexpr Fix kHalf{kOne / 2};
    separated(task, again, line.part(Fix{0}, kHalf), {span.a, span.middle()}, halvings + 1);
    separated(task, again, line.part(kHalf, Fix{kOne}), {span.middle(), span.b}, halvings + 1);
  }

  /// @throws where halving the time can't help: in its middle the two are not apart even without the remainder.
  bool apart(const Task& task, const Geometry::Reach& a, const Geometry::Reach& b, Fix margin) const {
    bool all = true;
    for (int i = 0; i < 3; ++i) all = all && a.b[i] + b.b[i] + margin < Fix{0};
    if (!all && a.centre + b.centre + margin - a.slack - a.slack - b.slack - b.slack > Fix{0})
      fail(task, "not apart along the direction");
    return all;
  }

  const World& world_;
  const Motion& motion_;
  const std::size_t piece_;
  Bytes& bytes_;
  const Options& options_;
  Budget& budget_;
  Verdict& verdict_;
  Poses poses_;
  int a_ = 0;
  std::vector<Opponent> partners_;
};

Fix valueAt(const Piece& piece, int variable, bool end) {
  Fix sum;
  for (const Polynomial& q : piece.polynomials)
    if (q.variable == variable)
      for (const double c : q.coefficients) {
        sum += enclose(c).x;
        if (!end) break;
      }
  return sum;
}

// A motion goes on in each piece where it was at the end of the one before. Coefficients are rounded: 2^-29 rad or m,
// and 2^-39 of a value, are no jump. Of `rotate` the orientations are compared, each entry of their matrices.
double largestJump(const World& world, const Motion& motion, Budget& budget) {
  Fix largest;
  for (std::size_t k = 1; k < motion.pieces.size(); ++k) {
    const Piece &before = motion.pieces[k - 1], &after = motion.pieces[k];
    const auto jumps = [&](const std::string& what, Fix jump, Fix most) {
      largest = verify::most(largest, jump);
      if (jump <= most) return;
      char text[60];
      std::snprintf(text, sizeof text, " by %.9g", toDouble(jump));
      throw NotProven("the motion jumps: " + what + " is elsewhere at the beginning of piece " + std::to_string(k) +
                      " than at the end of the one before," + text);
    };
    Poses end(world, before, budget), begin(world, after, budget);
    for (std::size_t f = 1; f < world.frames.size(); ++f) {
      const int frame = static_cast<int>(f);
      bool rotates = false;
      for (const Element& e : world.frames[f].elements) {
        budget.spend(10 + before.polynomials.size() + after.polynomials.size());
        rotates = rotates || e.kind == Element::rotate;
        if (e.kind == Element::rotate) continue;
        const Fix x = valueAt(before, e.variable, true), y = valueAt(after, e.variable, false);
        jumps("the variable " + inQuotes(world.variables[static_cast<std::size_t>(e.variable)]), abs(x - y),
              Fix{kOne >> 29} + shifted(verify::most(abs(x), abs(y)), 39));
      }
      if (!rotates) continue;
      const Mat R = end.local(frame, {Fix{kOne}, Fix{kOne}}).R, S = begin.local(frame, {Fix{0}, Fix{0}}).R;
      for (std::size_t c = 0; c < 9; ++c)
        jumps("the frame " + inQuotes(world.frames[f].name), bound(R[c] - S[c]), Fix{kOne >> 27});
    }
  }
  return toDouble(largest);
}

// How many pairs the claim is about, and how many not. A pair that every piece ignores to its end is not.
void countPairs(const World& world, const Motion& motion, Verdict& verdict) {
  std::copy(std::begin(world.not_checked), std::end(world.not_checked), std::begin(verdict.not_checked));
  for (std::size_t a = 0; a < world.bodies.size(); ++a)
    for (const Partner& partner : world.partners[a])
      ++(inScope(motion, partner) ? verdict.checked : verdict.not_checked[static_cast<int>(Reason::scope)]);
  std::map<std::pair<int, int>, std::size_t> all_the_time;  // by pair that some piece ignores: in how many to the end
  for (std::size_t piece = 0; piece < motion.pieces.size(); ++piece) {
    std::set<std::pair<int, int>> to_the_end;
    for (const Ignored& ignored : motion.pieces[piece].ignored) {
      const std::vector<Partner>& list = world.partners[static_cast<std::size_t>(ignored.b)];
      const auto at =
          std::lower_bound(list.begin(), list.end(), ignored.a, [](const Partner& p, int b) { return p.body < b; });
      if (at == list.end() || at->body != ignored.a || !inScope(motion, *at)) continue;
      all_the_time.emplace(std::pair(ignored.a, ignored.b), 0);
      if (ignored.until >= endOf(motion, piece)) to_the_end.emplace(ignored.a, ignored.b);
    }
    for (const std::pair<int, int>& pair : to_the_end) ++all_the_time[pair];
  }
  for (const auto& [pair, pieces] : all_the_time) {
    if (pieces < motion.pieces.size()) {
      ++verdict.late;
    } else {
      --verdict.checked;
      ++verdict.not_checked[static_cast<int>(Reason::ignored)];
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
    for (const std::vector<Partner>& partners : world.partners) budget.spend(1 + partners.size() / 8);
    countPairs(world, motion, verdict);
    if (verdict.checked == 0) throw NotProven("nothing is checked: the claim is about no pair of bodies");
    verdict.jump = largestJump(world, motion, budget);
    Bytes bytes(record.proof);
    const std::string_view hash = bytes.take(32);
    if (!std::equal(hash.begin(), hash.end(), motion.hash.begin(),
                    [](char a, std::uint8_t b) { return static_cast<std::uint8_t>(a) == b; }))
      throw NotProven("the proof is about another motion");
    for (std::size_t piece = 0; piece < motion.pieces.size(); ++piece)
      Walk(world, motion, piece, bytes, options, budget, verdict).run();
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
