// SPDX-License-Identifier: BSD-3-Clause
// Where frames and directions are over an interval of time.
#pragma once

#include <map>
#include <tuple>

#include "statement.h"

namespace verify {

/// An interval of time, a <= b, both exact.
struct Span {
  Fix a, b;
  Fix middle() const { return Fix{a.v + (b.v - a.v) / 2}; }
};

/// Each frame's pose in its parent, and each variable's value, over the intervals asked for, of one piece of a motion.
class Poses {
 public:
  Poses(const World& world, const Piece& piece, Budget& budget) : world_(world), piece_(piece), budget_(budget) {}

  Tm variable(int v, const Span& span) const;
  /// Valid until the next call.
  const Pose& local(int frame, const Span& span);
  /// The frame's pose seen from the place after that element of its own; -1: before all of them.
  Pose after(int frame, int element, const Span& span) const;
  Budget& budget() { return budget_; }
  void spend(std::uint64_t steps) { budget_.spend(steps); }

 private:
  /// The pose followed by the frame's elements from `first` on.
  Pose compute(int frame, std::size_t first, Pose pose, const Span& span) const;

  const World& world_;
  const Piece& piece_;
  Budget& budget_;
  std::map<std::tuple<Int, Int, int>, Pose> known_;  // by interval and frame
};

/// An affine function of points, f(x) = v.x + d: given in one frame, it is asked for in others. Only the frames on the
/// path between the two take part, so what both have above them cancels exactly.
class Functional {
 public:
  /// f(x) = v.x + d for x in `frame`'s coordinates.
  Functional(const World& world, Poses& poses, const Span& span, int frame, const Vec& v, const Tm& d);

  struct Value {
    Vec v;
    Tm d;
  };
  /// The same function for x in the coordinates of another frame, or of a body's geometry.
  const Value& in(int frame);
  Value inBody(int body);

 private:
  const World& world_;
  Poses& poses_;
  const Span span_;
  std::map<int, Value> known_;
  std::map<int, int> towards_;  // of each ancestor of the first frame: its child on the way there
};

/// f(x) = v.x + d for x in a parent's coordinates, where y = R^T (x - t) are the child's: and the other way.
Functional::Value toChild(const Functional::Value& f, const Pose& pose);
Functional::Value toParent(const Functional::Value& f, const Pose& pose);

}  // namespace verify
