// SPDX-License-Identifier: BSD-3-Clause
#include "certificate/emitter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "certificate/baseline_vectors.h"
#include "certificate/outside.h"
#include "certificate/proof_bytes.h"

#include "numerics/baseline_isa.h"

#include "convex/gjk.h"

namespace fcl_artic::certificate {
namespace {

using baseline::Vec3;
using Eigen::Vector3d;

// First bytes of nodes.
constexpr int kSep = 0x00, kSepFine = 0x03, kWall = 0x09, kWallOther = 0x0a, kTime = 0x10, kPartners = 0x11,
              kOwn = 0x12, kOther = 0x13, kSolid = 0x14;
/// In which frame a direction is constant, as a number to be added to kSep and kSepFine.
enum class DirectionFrame { world = 0, body = 1, partner = 2 };

constexpr int kMaxTimeCuts = 40;  ///< of one root: 1e-12 of the motion
constexpr int kMaxSearchSteps = 40;

/// The subject of a node, with the pieces below `partner_node` if there is a single partner: A's pieces below `node`,
/// partners [first, last) of its list, and times [begin, end].
struct ProofTask {
  int body;
  std::int32_t node = 0;
  std::size_t first, last;
  std::int32_t partner_node = 0;
  double begin, end;
  int cuts = 0;        ///< of time, so far
  bool solid = false;  ///< a SOLID node is above
  std::size_t size() const { return last - first; }
  double middle() const { return 0.5 * (begin + end); }
};

class Emitter {
 public:
  Emitter(const World& world, const Motion& motion, std::uint64_t work, std::string& proof)
      : moving_(world, motion), work_(work), out_(proof) {}

  std::string run() {
    const World& world = moving_.world();
    for (std::size_t i = 0; i < world.bodies.size() && missing_.empty(); ++i) {
      partners_.clear();
      for (const int j : world.bodies[i].partners) {
        if (isAsked(static_cast<int>(i), j)) partners_.push_back(j);
      }
      if (partners_.empty()) continue;
      ProofTask root;
      root.body = static_cast<int>(i);
      root.first = 0;
      root.last = partners_.size();
      root.begin = 0;
      root.end = moving_.motion().until;
      solve(root);
    }
    return missing_;
  }

 private:
  bool isAsked(int a, int b) const {
    const auto isObstacle = [&](int i) { return moving_.body(i).role == Body::Role::obstacle; };
    return isObstacle(a) || isObstacle(b) ? moving_.motion().scene : moving_.motion().self;
  }

  // ---- what a task's sets are, seen from a frame

  /// Whether a partner is checked somewhere in the task's time. (A pair that touched at the beginning is checked only
  /// after its own time.)
  bool counts(const ProofTask& task, int partner) const {
    for (const Motion::Ignored& pair : moving_.motion().ignored) {
      if (pair.a == std::min(task.body, partner) && pair.b == std::max(task.body, partner)) {
        return task.end > pair.until;
      }
    }
    return true;
  }
  int frameOf(const ProofTask& task, DirectionFrame seen) const {
    if (seen == DirectionFrame::world) return 0;
    return moving_.body(seen == DirectionFrame::body ? task.body : partners_[task.first]).frame;
  }

  static Vector3d farthestAt(const Geometry& geometry, std::int32_t node, const Pose& pose, const Vector3d& u,
                             bool exact) {
    return pose.R * farthest(geometry, node, pose.R.transpose() * u, exact) + pose.c;
  }

  /// A task's sets seen from a frame. Partners that stand still in it are `still`: their ends are the same at all
  /// times. With tolerances they stand in the world: body A strays from all of them alike.
  struct Sets {
    const ProofTask& task;
    int frame;
    bool exact;  ///< false: hulls around whole bodies will do
    std::vector<int> still, moving;
  };
  Sets setsOf(const ProofTask& task, int frame, bool exact) {
    Sets sets{task, frame, exact, {}, {}};
    for (std::size_t p = task.first; p < task.last; ++p) {
      if (!counts(task, partners_[p])) continue;
      const Body& partner = moving_.body(partners_[p]);
      const bool still =
          partner.frame == frame && partner.speed.speed == 0 && (frame == 0 || !moving_.world().tolerant);
      (still ? sets.still : sets.moving).push_back(partners_[p]);
    }
    return sets;
  }
  /// How far tolerances let the task's body stray from what stands still in the world.
  double strayAt(const Sets& sets, double t) {
    return sets.still.empty() ? 0 : moving_.stray(sets.task.body, sets.task.node, t);
  }
  /// The partner's margin, with what tolerances add at time t; `still`: but for strayAt().
  double marginAt(const Sets& sets, int partner, bool still, double t) {
    const std::int32_t node = sets.task.size() == 1 ? sets.task.partner_node : 0;
    const double stray =
        still ? moving_.ownStray(partner, node) : moving_.stray(sets.task.body, sets.task.node, partner, node, t);
    return moving_.margin(sets.task.body, partner) + stray;
  }
  /// The greatest n.y + margin |n| over some partners at time t.
  double maxAlong(const Sets& sets, const std::vector<int>& partners, const Vector3d& n, double t) {
    double most = -std::numeric_limits<double>::infinity();
    const std::int32_t node = sets.task.size() == 1 ? sets.task.partner_node : 0;
    for (const int partner : partners) {
      const Pose& pose = moving_.pose(partner, sets.frame, t);
      const Vector3d far = farthestAt(moving_.geometry(partner), node, pose, n, sets.exact);
      const double margin = marginAt(sets, partner, &partners == &sets.still, t);
      most = std::max(most, n.dot(far) + margin * n.norm());
    }
    return most;
  }

  /// How a direction keeps a task's sets apart over time.
  class Separation {
   public:
    Separation(Emitter& emitter, const Sets& sets, const Vector3d& n)
        : emitter_(emitter), sets_(sets), n_(n), still_(emitter.maxAlong(sets, sets.still, n, 0)) {}

    /// Whether the gap stays open, by its values at some times and a bound on how far it bends in between. A part of it
    /// is kept for the verifier's rounding.
    bool holds() {
      const ProofTask& task = sets_.task;
      if (!isOpen(task.begin) || !isOpen(task.end) || !isOpen(task.middle())) return false;
      double bend = emitter_.moving_.acceleration(task.body, sets_.frame, task.middle());
      double other = 0;
      for (const int partner : sets_.moving) {
        other = std::max(other, emitter_.moving_.acceleration(partner, sets_.frame, task.middle()));
      }
      bend_ = (bend + other) * n_.norm() / 8;
      const double gap = last_;
      return staysOpen(task.begin, gapAt(task.begin), task.middle(), gap, 5) &&
             staysOpen(task.middle(), gap, task.end, gapAt(task.end), 5);
    }
    /// Where it was found closed.
    double closedAt() const { return closed_at_; }

   private:
    double gapAt(double t) {
      const ProofTask& task = sets_.task;
      const Pose& pose = emitter_.moving_.pose(task.body, sets_.frame, t);
      const Vector3d near = farthestAt(emitter_.moving_.geometry(task.body), task.node, pose, -n_, sets_.exact);
      const double still = still_ + emitter_.strayAt(sets_, t) * n_.norm();
      return n_.dot(near) - std::max(still, emitter_.maxAlong(sets_, sets_.moving, n_, t));
    }
    bool isOpen(double t) {
      last_ = gapAt(t);
      if (last_ > kSlack) return true;
      closed_at_ = t;
      return false;
    }
    bool staysOpen(double a, double gap_a, double b, double gap_b, int depth) {
      const double h = b - a;
      if (std::min(gap_a, gap_b) > bend_ * h * h + kSlack) return true;
      const double middle = 0.5 * (a + b);
      if (!isOpen(middle)) return false;
      if (depth == 0) {
        closed_at_ = middle;
        return false;
      }
      const double gap = last_;
      return staysOpen(a, gap_a, middle, gap, depth - 1) && staysOpen(middle, gap, b, gap_b, depth - 1);
    }
    static constexpr double kSlack = 2e-12;
    Emitter& emitter_;
    const Sets& sets_;
    const Vector3d n_;
    const double still_;
    double bend_ = 0, last_ = 0, closed_at_ = 0;
  };

  /// The union of partners - A over some times, as a convex body for GJK.
  struct Sweep {
    Emitter& emitter;
    const Sets& sets;
    const std::vector<double>& times;

    /// The partners' point least along n, margins included.
    void takeLeast(const std::vector<int>& partners, const Vector3d& n, double t, double& least,
                   Vector3d& point) const {
      const std::int32_t node = sets.task.size() == 1 ? sets.task.partner_node : 0;
      for (const int partner : partners) {
        const Pose& pose = emitter.moving_.pose(partner, sets.frame, t);
        const double margin = emitter.marginAt(sets, partner, &partners == &sets.still, t);
        const Vector3d x =
            farthestAt(emitter.moving_.geometry(partner), node, pose, -n, sets.exact) - n * (margin / n.norm());
        const double value = n.dot(x);
        if (value >= least) continue;
        least = value;
        point = x;
      }
    }
    void support(const Vec3& n, baseline::DifferencePoint& p) const {
      const Vector3d along = toEigen(n);
      double still = std::numeric_limits<double>::infinity(), least = still;
      Vector3d still_point = Vector3d::Zero();
      takeLeast(sets.still, along, 0, still, still_point);
      for (const double t : times) {
        const ProofTask& task = sets.task;
        const Pose& pose = emitter.moving_.pose(task.body, sets.frame, t);
        const Vector3d own = farthestAt(emitter.moving_.geometry(task.body), task.node, pose, along, sets.exact);
        const double stray = emitter.strayAt(sets, t);
        double other = still - stray * along.norm();
        Vector3d other_point = still_point - along * (stray / along.norm());
        takeLeast(sets.moving, along, t, other, other_point);
        const double value = other - along.dot(own);
        if (value >= least) continue;
        least = value;
        p.w = fromEigen(other_point - own);
      }
      p.a = p.b = p.w;
    }
    void subtract(baseline::DifferencePoint&) const {}
  };

  /// A direction along which the sets are apart at all of these times: A before, the partners after it.
  bool findDirection(const Sets& sets, const std::vector<double>& times, Vector3d& n) {
    const int partner = sets.still.empty() ? sets.moving.front() : sets.still.front();
    const double middle = sets.task.middle();
    Vector3d guess = moving_.pose(partner, sets.frame, middle).c - moving_.pose(sets.task.body, sets.frame, middle).c;
    if (!(guess.norm() > 1e-9)) guess = Vector3d::UnitX();
    baseline::GjkResult found;
    baseline::searchNearest(Sweep{*this, sets, times}, fromEigen(guess), {0.2, 0.0, kMaxSearchSteps}, found);
    n = -toEigen(found.n);
    return found.lower > 0;
  }

  // ---- hints

  /// Writes the direction with as few bits as do.
  bool put(const Sets& sets, DirectionFrame seen, const Vector3d& n, double& closed_at) {
    for (const bool fine : {false, true}) {
      const double most = fine ? 2147483647.0 : 32767.0;
      const double scale = most / n.cwiseAbs().maxCoeff();
      Vector3d rounded;
      for (int k = 0; k < 3; ++k) rounded[k] = std::round(n[k] * scale);
      Separation separation(*this, sets, rounded / most);
      if (!separation.holds()) {
        closed_at = separation.closedAt();
        continue;
      }
      out_.byte((fine ? kSepFine : kSep) + static_cast<int>(seen));
      for (int k = 0; k < 3; ++k) out_.fixed(static_cast<std::int64_t>(rounded[k]), fine ? 4 : 2);
      return true;
    }
    return false;
  }

  bool separate(const ProofTask& task) {
    for (const DirectionFrame seen : {DirectionFrame::world, DirectionFrame::partner, DirectionFrame::body}) {
      // A frame in which the partners stand still: the world's for obstacles, a link's own for one link.
      const bool scene = moving_.body(partners_[task.first]).frame == 0;
      if (seen == (scene ? DirectionFrame::partner : DirectionFrame::world)) continue;
      for (const bool exact : {false, true}) {
        if (exact && task.size() > 1) break;  // the partners one by one then
        const Sets sets = setsOf(task, frameOf(task, seen), exact);
        std::vector<double> times = {task.begin, task.middle(), task.end};
        for (int round = 0; round < 4; ++round) {
          Vector3d n;
          if (!findDirection(sets, times, n)) break;
          double closed_at;
          if (put(sets, seen, n, closed_at)) return true;
          if (std::find(times.begin(), times.end(), closed_at) != times.end()) break;
          times.push_back(closed_at);
        }
      }
    }
    return false;
  }
  /// Whether no pair of the task is checked at these times: then any direction will do.
  bool isEmpty(const ProofTask& task) const {
    for (std::size_t p = task.first; p < task.last; ++p) {
      if (counts(task, partners_[p])) return false;
    }
    return true;
  }
  void putEmpty() {
    out_.byte(kSep);
    for (const int x : {1, 0, 0}) out_.fixed(x, 2);
  }

  bool separateWall(const ProofTask& task) {
    const bool own = moving_.geometry(task.body).unbounded;
    const int wall = own ? task.body : partners_[task.first];
    const engine::Piece& piece = moving_.geometry(wall).shape->view().pieces[0];
    const int frame = moving_.body(wall).frame;
    for (const bool other : {false, true}) {
      if (other && piece.kind != engine::PieceKind::plane) break;
      const Vector3d n = Vector3d::Map(piece.size) * (other ? -1 : 1);
      if (!wallSeparates(task, wall, own, frame, n, other ? -piece.center[0] : piece.center[0])) continue;
      out_.byte(other ? kWallOther : kWall);
      return true;
    }
    return false;
  }
  bool wallSeparates(const ProofTask& task, int wall, bool own, int frame, const Vector3d& normal, double offset) {
    const int body = own ? partners_[task.first] : task.body;
    const std::int32_t node = own ? task.partner_node : task.node;
    const double margin = moving_.margin(task.body, partners_[task.first]);
    const auto gapAt = [&](double t) {
      const double stray = moving_.stray(task.body, task.node, partners_[task.first], task.partner_node, t);
      const Pose at = moving_.pose(wall, frame, t);
      const Vector3d n = at.R * normal;
      return n.dot(farthestAt(moving_.geometry(body), node, moving_.pose(body, frame, t), -n, true)) -
             (offset + n.dot(at.c)) - margin - stray;
    };
    const double bend = moving_.acceleration(body, frame, task.middle());
    const std::function<bool(double, double, double, double, int)> open = [&](double a, double gap_a, double b,
                                                                              double gap_b, int depth) {
      if (!(std::min(gap_a, gap_b) > 1e-13)) return false;
      if (std::min(gap_a, gap_b) > bend * (b - a) * (b - a) / 8 + 1e-13) return true;
      if (depth == 0) return false;
      const double m = 0.5 * (a + b), gap_m = gapAt(m);
      return open(a, gap_a, m, gap_m, depth - 1) && open(m, gap_m, b, gap_b, depth - 1);
    };
    return open(task.begin, gapAt(task.begin), task.end, gapAt(task.end), 6);
  }

  // ---- the tree

  void solve(const ProofTask& task) {
    if (!missing_.empty()) return;
    if (++nodes_ > work_) {
      missing_ = "more than " + std::to_string(work_) + " nodes would be needed";
      return;
    }
    if (isEmpty(task)) return putEmpty();
    // Partners that are not mixed are all unbounded, or none of them is.
    const bool wall = moving_.geometry(task.body).unbounded || moving_.geometry(partners_[task.first]).unbounded;
    if (wall && task.size() == 1) {
      if (separateWall(task)) return;
      return cutTimeOrPieces(task);
    }
    if (!wall && !isMixed(task) && separate(task)) return;
    if (task.size() > 1) return cutPartners(task);
    cutTimeOrPieces(task);
  }

  /// Still obstacles, moving ones, and links are not tried together.
  int groupOf(int body) const {
    if (moving_.geometry(body).unbounded) return 0;
    if (moving_.body(body).role != Body::Role::obstacle) return 3;
    return moving_.body(body).frame == 0 ? 1 : 2;
  }
  /// Number of the first partners that are of one group.
  std::size_t ofOneGroup(const ProofTask& task) const {
    std::size_t n = 1;
    while (n < task.size() && groupOf(partners_[task.first]) == groupOf(partners_[task.first + n])) ++n;
    return n;
  }
  bool isMixed(const ProofTask& task) const { return ofOneGroup(task) < task.size(); }

  void cutPartners(const ProofTask& task) {
    const std::size_t same = ofOneGroup(task), half = same < task.size() ? same : task.size() / 2;
    out_.byte(kPartners);
    out_.number(half);
    ProofTask left = task, right = task;
    left.last = right.first = task.first + half;
    solve(left);
    solve(right);
  }

  /// Whether a direction is found for these two at one time.
  bool apartAt(const ProofTask& task, double t) {
    Vector3d n;
    return findDirection(setsOf(task, frameOf(task, DirectionFrame::partner), true), {t}, n);
  }
  double sizeOf(int body, std::int32_t node) const {
    const Geometry& geometry = moving_.geometry(body);
    const engine::Node& n = geometry.shape->view().nodes[node];
    return geometry.unbounded || n.isLeaf() ? 0 : static_cast<double>(n.radius);
  }

  void cutTimeOrPieces(ProofTask task) {
    const int partner = partners_[task.first];
    const double own = sizeOf(task.body, task.node), other = sizeOf(partner, task.partner_node);
    const bool leaves = own == 0 && other == 0;
    if (isEmpty(task)) return putEmpty();
    const bool wall = moving_.geometry(task.body).unbounded || moving_.geometry(partner).unbounded;
    const bool time_left = task.cuts < kMaxTimeCuts;
    if (leaves && !time_left) return fail(task);
    if (time_left && beginsWithin(task, partner)) return cutTime(task);
    const bool apart = !wall && apartAt(task, task.middle()) && apartAt(task, task.begin) && apartAt(task, task.end);
    if (time_left && (leaves || apart)) return cutTime(task);
    if (leaves) return fail(task);
    if (!task.solid && (isSolid(task.body) || isSolid(partner))) {
      if (!putOutside(task)) return;
      task.solid = true;
    }
    const bool cut_own = own >= other;
    out_.byte(cut_own ? kOwn : kOther);
    const Geometry& geometry = moving_.geometry(cut_own ? task.body : partner);
    std::int32_t& node = cut_own ? task.node : task.partner_node;
    const engine::Node& n = geometry.shape->view().nodes[node];
    const Geometry::Interval left = geometry.below[static_cast<std::size_t>(n.left())];
    out_.number(static_cast<std::size_t>(left.end - left.begin));
    node = n.left();
    ProofTask second = task;
    (cut_own ? second.node : second.partner_node) = n.right();
    solve(task);
    solve(second);
  }
  /// SOLID, with the points that show it.
  bool putOutside(const ProofTask& task) {
    const int partner = partners_[task.first];
    double t = task.begin;
    for (const Motion::Ignored& pair : moving_.motion().ignored) {
      if (pair.a == std::min(task.body, partner) && pair.b == std::max(task.body, partner)) t = std::max(t, pair.until);
    }
    const auto points = findOutside(moving_, task.body, partner, t);
    if (!points) {
      missing_ = "no points were found that show that neither of '" + moving_.body(task.body).name + "' and '" +
                 moving_.body(partner).name + "' is in the other at t = " + std::to_string(t);
      return false;
    }
    out_.byte(kSolid);
    out_.number(points->size());
    for (const OutsidePoint& point : *points) {
      out_.number(point.piece);
      out_.byte(point.side);
    }
    return true;
  }
  void cutTime(const ProofTask& task) {
    out_.byte(kTime);
    ProofTask before = task, after = task;
    before.end = after.begin = task.middle();
    ++before.cuts;
    ++after.cuts;
    solve(before);
    solve(after);
  }
  /// Whether the pair is ignored in a part of the task's time.
  bool beginsWithin(const ProofTask& task, int partner) const {
    for (const Motion::Ignored& pair : moving_.motion().ignored) {
      if (pair.a == std::min(task.body, partner) && pair.b == std::max(task.body, partner)) {
        return task.begin < pair.until && pair.until < task.end;
      }
    }
    return false;
  }
  bool isSolid(int body) const { return moving_.geometry(body).shape->space() != nullptr; }

  void fail(const ProofTask& task) {
    missing_ = "no hint was found that keeps '" + moving_.body(task.body).name + "' and '" +
               moving_.body(partners_[task.first]).name + "' apart around t = " + std::to_string(task.middle());
  }

  MovingWorld moving_;
  std::uint64_t work_, nodes_ = 0;
  ProofBytes out_;
  std::string missing_;
  std::vector<int> partners_;  ///< of the body at hand
};

}  // namespace

std::string findProof(const World& world, const Motion& motion, std::uint64_t work, std::string& proof) {
  proof.clear();
  return Emitter(world, motion, work, proof).run();
}

}  // namespace fcl_artic::certificate
