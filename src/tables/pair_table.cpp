// SPDX-License-Identifier: BSD-3-Clause
#include "tables/pair_table.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kinematics/angles.h"
#include "motion/variable_reach.h"
#include "narrowphase/engine_workspace.h"
#include "numerics/arc_tangent.h"
#include "numerics/assertion.h"
#include "numerics/constants.h"
#include "tables/value_range.h"

namespace fcl_artic {
namespace {

// The cells of a table and the work for them. A table has up to three axes, one for each variable, by how far the
// variable takes the link, the farthest first. Along the first one (columns) the engine proves motions over many cells.
// The second one (rows) and the third one (planes) stand in the middles of cells, and a margin pays for all other
// values of these cells (doc/NUMERICS.md, Lemma 7). Any values are sound: cells that are not proven are looked at by
// each query.

/// Number of columns. More columns: less of the range around a contact counts as not proven, in more memory.
constexpr int kColumns = 96;
/// The margin, m, that pays for half a row; the number of rows follows from it, up to kMaxRows. A larger margin: fewer
/// rows, which are proven sooner, and links that pass each other closely are not proven apart. Measured: the UR5, whose
/// base and upper arm pass each other at 16 mm, takes three times as long with 96 rows at most.
constexpr double kRowMargin = 0.002;
constexpr int kMaxRows = 192;
/// A third variable, such as that of a gripper's fingers, has three planes: its range, and as much below and above.
/// (More than one description of a scene holds fingers apart beyond their limits.) The margin that pays for half of its
/// range may be this, m. If the variable needs more there is no table. A larger value: more tables, of which less is
/// proven.
constexpr int kPlanes = 3;
constexpr double kMaxPlaneMargin = 0.03;
/// PairTable::free() counts the cells of a box, one turn at most, that are not proven, in 16 bits.
static_assert(kColumns * kMaxRows < 1 << 16);
/// A cell is proven, and looked up, as if it were wider on either side by this part of its width. It must be more than
/// all rounding of joint values, for which chooseCells() asks for 64 ulp of the largest one. A larger slack: motions
/// that end near a cell's border need its neighbour, too.
constexpr double kCellSlack = 1e-6;

/// The work that one motion over cells may take, in tests of nodes and leaves. Cells that take more count as not
/// proven. Measured on the Panda and the UR5: with 400 0.6 % more cells are proven, in three times the time.
constexpr std::uint64_t kMotionWork = 60;
/// The motions of a table of few rows share the work of kMaxRows motions. (The table of a gripper's fingers, which one
/// joint drives, has one row.) All motions together may take this many times that, beyond kMotionWork for each. Larger:
/// more cells of such tables are proven, in more time.
constexpr std::uint64_t kMaxTries = 4;
/// A row whose ends are not proven is searched from the middle of what is left, until fewer cells than this are. In a
/// table of few rows it is this number of cells for each of its rows. Smaller: shorter stretches of free cells between
/// contacts are found, in more time.
constexpr int kMinIsland = 40, kMinIslandPerRow = 4;
/// The tolerances of the engine's answers: as part of the motion, and m. The first one leaves up to 1/64 of a motion's
/// cells before a contact unproven.
constexpr double kToleranceTime = 1.0 / 64, kToleranceDistance = 1e-4;

/// The values for which a proof of some cells of an axis holds.
struct CellRange {
  double lower = 0, upper = 0;

  double middle() const { return 0.5 * (lower + upper); }
  double half() const { return std::max(upper - middle(), middle() - lower); }
};

/// Values that variables take together, a range each.
class Box {
 public:
  void set(int variable, const CellRange& range) {
    variables_[count_] = variable;
    ranges_[count_++] = range;
  }
  /// Largest absolute value of a variable; none is known of one that is not in the box.
  double maxAbsolute(int variable) const {
    for (int i = 0; i < count_; ++i) {
      if (variables_[i] == variable) return std::max(std::abs(ranges_[i].lower), std::abs(ranges_[i].upper));
    }
    return std::numeric_limits<double>::infinity();
  }

 private:
  int count_ = 0, variables_[3] = {};
  CellRange ranges_[3];
};

}  // namespace

/// Two links and the steps from the one to the other, each of them a turn about an axis or a slide along one.
struct PairTable::Links {
  const engine::SweepView& sweep;
  const engine::Body* bodies;
  const engine::LinkPair& pair;
  std::vector<engine::SweepStep> path;

  /// How far the links' distance changes at most, per unit of one variable while the others stand still, all of them in
  /// the box: the s of Lemma 7 (doc/NUMERICS.md). It holds in this box only.
  double lever(int variable, const Box& box) const {
    const double of_b = reachPerUnit(sweep, pair.step_b, pair.placement_b, *bodies[pair.b].tree, variable,
                                     [&](int v) { return box.maxAbsolute(v); });
    const bool first_only = std::all_of(path.begin(), path.end(), [&](const engine::SweepStep& step) {
      return (step.variable == variable) == (&step == path.data());
    });
    return first_only ? std::min(of_b, reachOfBase(path[0], pair.inverse_a, *bodies[pair.a].tree)) : of_b;
  }
};

/// Proves cells: the first axis's by motions, the second one's by margins.
class PairTable::Builder {
 public:
  Builder(const Links& links, const Cells& cells, double margin)
      : links_(links), cells_(cells), margin_(margin), path_(links.path), pair_(links.pair) {
    for (std::size_t i = 0; i < path_.size(); ++i) {
      path_[i].parent = static_cast<std::int32_t>(i) - 1;
      for (int a = 0; a < cells.count; ++a) {
        if (links.path[i].variable == cells.axes[a].variable) path_[i].variable = a;
      }
    }
    sweep_.steps = path_.data();
    sweep_.num_steps = static_cast<std::int32_t>(path_.size());
    pair_.sweep = 0;
    pair_.step_b = sweep_.num_steps - 1;
    problem_.bodies = links.bodies;
    problem_.num_bodies = std::max(pair_.a, pair_.b) + 1;
    problem_.sweeps = &sweep_;
    problem_.num_sweeps = 1;
    problem_.link_pairs = &pair_;
    problem_.num_link_pairs = 1;
    query_.coefficients = variables_.data();
    query_.num_variables = 3;
    query_.check_scene = false;
    query_.describe_contacts = false;
    const int rows = paid_.cells * cells.axes[2].cells;
    motion_work_ = std::max(kMotionWork, kMotionWork * kMaxRows / static_cast<std::uint64_t>(rows));
    work_left_ = kMaxTries * kMotionWork * kMaxRows;
    min_island_ = std::min(kMinIsland, kMinIslandPerRow * rows);
    query_.tolerance_time = kToleranceTime;
    query_.tolerance_distance = kToleranceDistance;
  }

  /// @return 1 for each cell that is proven, by the third axis's index, then the first one's, then the second one's.
  std::vector<std::uint8_t> run() {
    proven_.assign(static_cast<std::size_t>(moved_.cells * paid_.cells * cells_.axes[2].cells), 0);
    for (plane_ = 0; plane_ < cells_.axes[2].cells; ++plane_) proveRows(0, paid_.cells);
    return std::move(proven_);
  }

 private:
  /// Lemma 7: all variables but the first one stand in the middle of their cells, rows [j, j_end) of the plane. The
  /// margin pays for the way from there to all other values in these cells. The levers are those of this very box.
  void fixRows(int j, int j_end) {
    const int begin[3] = {0, j, plane_}, end[3] = {moved_.cells, j_end, plane_ + 1};
    CellRange ranges[3];
    Box box;
    for (int a = 0; a < cells_.count; ++a) {
      const Axis& axis = cells_.axes[a];
      ranges[a] = {axis.lower + (begin[a] - 2 * kCellSlack) * axis.width,
                   axis.lower + (end[a] + 2 * kCellSlack) * axis.width};
      box.set(axis.variable, ranges[a]);
    }
    double margin = margin_;
    for (int a = 1; a < cells_.count; ++a) {
      variables_(a, 0) = ranges[a].middle();
      margin += links_.lever(cells_.axes[a].variable, box) * ranges[a].half();
    }
    query_.margins = engine::Margins(margin);
  }

  /// Rows [j, j_end) together, else in halves, else one row in parts.
  void proveRows(int j, int j_end) {
    fixRows(j, j_end);
    if (j_end - j == 1) return proveRow(j, 0, moved_.cells);
    query_.any = true;
    if (provenFrom(0, moved_.cells) == moved_.cells) {
      for (int row = j; row < j_end; ++row) mark(row, 0, moved_.cells);
      return;
    }
    const int middle = (j + j_end) / 2;
    proveRows(j, middle);
    proveRows(middle, j_end);
  }

  /// Cells [i, i_end) of a row: from the one end, from the other, and what is left in halves.
  void proveRow(int j, int i, int i_end) {
    query_.any = false;
    const int from_begin = provenFrom(i, i_end);
    mark(j, i, i + from_begin);
    if (from_begin == i_end - i) return;
    const int from_end = provenFrom(i_end, i);
    mark(j, i_end - from_end, i_end);
    i += from_begin;
    i_end -= from_end;
    if (i_end - i < min_island_) return;
    const int middle = (i + i_end) / 2;
    proveRow(j, i, middle);
    proveRow(j, middle, i_end);
  }

  void mark(int j, int i, int i_end) {
    for (; i < i_end; ++i) proven_[static_cast<std::size_t>((plane_ * moved_.cells + i) * paid_.cells + j)] = 1;
  }

  /// Moves the first axis's variable from one border of cells to another one, upwards or downwards.
  /// @return number of cells from the beginning over which the links are proven apart.
  int provenFrom(int begin, int end) {
    const int cells = std::abs(end - begin);
    if (cells_.count > 0) {
      const double slack = end > begin ? kCellSlack : -kCellSlack;
      const double from = moved_.lower + (begin - slack) * moved_.width;
      variables_(0, 0) = from;
      variables_(0, 1) = moved_.lower + (end + slack) * moved_.width - from;
    }
    query_.work_budget = std::max(kMotionWork, std::min(motion_work_, work_left_));
    engine::Answer answer;
    workspace_.solve(problem_, query_, answer);
    work_left_ -= std::min(work_left_, answer.statistics.node_tests + answer.statistics.leaf_tests);
    FCL_ARTIC_ASSERT(cells > 0 && answer.t_lower >= 0 && answer.t_lower <= 1);
    if (answer.isFree()) return cells;
    if (query_.any) return 0;
    // Apart before t_lower, which includes the slack after the last cell.
    return std::max(0, static_cast<int>(answer.t_lower * (cells + 2 * kCellSlack) - 3 * kCellSlack));
  }

  const Links& links_;
  const Cells& cells_;
  const double margin_;
  const Axis &moved_ = cells_.axes[0], &paid_ = cells_.axes[1];
  Eigen::Matrix<double, 3, 2> variables_ = Eigen::Matrix<double, 3, 2>::Zero();  ///< a row for each axis
  std::vector<engine::SweepStep> path_;
  engine::SweepView sweep_;
  engine::LinkPair pair_;
  engine::Problem problem_;
  engine::Query query_;
  engine::EngineWorkspace workspace_;
  std::uint64_t motion_work_ = 0;  ///< tests for one motion
  std::uint64_t work_left_ = 0;    ///< tests for all motions, beyond kMotionWork for each
  int min_island_ = 0;             ///< fewest cells that are looked into
  int plane_ = 0;                  ///< cell of the third axis
  std::vector<std::uint8_t> proven_;
};

std::shared_ptr<const PairTable> PairTable::build(const KinematicTree& tree, const engine::SweepView& sweep,
                                                  const engine::Body* bodies, const engine::LinkPair& pair,
                                                  double margin) {
  Links links{sweep, bodies, pair, {}};
  for (int s = pair.step_b; s >= 0; s = sweep.steps[s].parent) links.path.push_back(sweep.steps[s]);
  std::reverse(links.path.begin(), links.path.end());
  const std::optional<const Cells> cells = chooseCells(tree, links);
  if (!cells) return nullptr;
  const std::vector<std::uint8_t> proven = Builder(links, *cells, margin).run();
  if (std::none_of(proven.begin(), proven.end(), [](std::uint8_t cell) { return cell != 0; })) return nullptr;
  const std::shared_ptr<PairTable> table(new PairTable(*cells, margin));
  table->sum(proven);
  return table;
}

/// Which variables the table is over, and their cells. (No proof rests on the choice: any cells will do that are much
/// wider than rounding. The levers in here are of the joints' own ranges, and go no farther.)
/// @return nothing where there is no table to be had.
std::optional<const PairTable::Cells> PairTable::chooseCells(const KinematicTree& tree, const Links& links) {
  const std::vector<engine::SweepStep>& path = links.path;
  Cells cells;
  Axis* const axes = cells.axes;
  for (const engine::SweepStep& step : path) {
    if (step.kind != engine::StepKind::revolute && step.kind != engine::StepKind::prismatic) return std::nullopt;
    if (!(std::abs(step.multiplier) <= kMaxValue && std::abs(step.offset) <= kMaxValue)) return std::nullopt;
    if (std::any_of(axes, axes + cells.count, [&](const Axis& a) { return a.variable == step.variable; })) continue;
    if (cells.count == 3) return std::nullopt;
    axes[cells.count++].variable = step.variable;
  }
  struct Guess {
    Axis axis;
    double range, margin;  ///< that half of the range costs
  };
  std::vector<Guess> guesses;
  Box box;
  for (int a = 0; a < cells.count; ++a) {
    Axis& axis = axes[a];
    const bool whole_turns = std::all_of(path.begin(), path.end(), [&](const engine::SweepStep& step) {
      return step.variable != axis.variable ||
             (step.kind == engine::StepKind::revolute && step.multiplier == std::round(step.multiplier));
    });
    const Joint& joint = tree.joint(tree.variableJoint(axis.variable));
    const bool limited = hasLimits(joint) && std::max(std::abs(joint.lower), std::abs(joint.upper)) <= kMaxValue;
    axis.wraps = whole_turns && !(limited && joint.upper - joint.lower < kTwoPi);
    if (!axis.wraps && !limited) return std::nullopt;
    const double limits = axis.wraps ? kTwoPi : joint.upper - joint.lower;
    const double range = axis.wraps ? kTwoPi : (1 + 2 * kBeyondLimits) * limits;
    axis.lower = axis.wraps ? -kTwoPi / 2 : joint.lower - kBeyondLimits * limits;
    box.set(axis.variable, {axis.lower, axis.lower + range});
    guesses.push_back({axis, range, 0});
  }
  for (Guess& guess : guesses) guess.margin = 0.5 * guess.range * links.lever(guess.axis.variable, box);
  // The engine moves the variable that takes the link farthest, rows are of the next one, and a third one must be of
  // little effect.
  std::stable_sort(guesses.begin(), guesses.end(), [](const Guess& a, const Guess& b) { return a.margin > b.margin; });
  for (int a = 0; a < cells.count; ++a) {
    const auto& [axis, range, margin] = guesses[static_cast<std::size_t>(a)];
    axes[a] = axis;
    if (a == 2) {
      if (axis.wraps || margin > kMaxPlaneMargin) return std::nullopt;
      axes[a].cells = kPlanes;
      constexpr int kPlanesBelow = (kPlanes - 1) / 2;
      axes[a].lower -= kPlanesBelow * range;
      axes[a].width = range;
    } else {
      axes[a].cells =
          a == 0 ? kColumns : static_cast<int>(std::clamp(std::ceil(margin / kRowMargin), 1.0, 1.0 * kMaxRows));
      axes[a].width = range / axes[a].cells;
    }
    // Rounding of values near the cells' is far below the slack.
    const double most = std::max(std::abs(axes[a].lower), std::abs(axes[a].upper()));
    if (!(axes[a].width * kCellSlack > 64 * kUlp * most)) return std::nullopt;
  }
  return cells;
}

void PairTable::sum(const std::vector<std::uint8_t>& proven) {
  const Axis &x = cells_.axes[0], &y = cells_.axes[1];
  const int rows = x.wraps ? 2 * x.cells : x.cells, columns = y.wraps ? 2 * y.cells : y.cells;
  stride_ = static_cast<std::size_t>(columns) + 1;
  plane_ = (static_cast<std::size_t>(rows) + 1) * stride_;
  sums_.assign(plane_ * static_cast<std::size_t>(cells_.axes[2].cells), 0);
  for (int p = 0; p < cells_.axes[2].cells; ++p) {
    for (int i = 0; i < rows; ++i) {
      std::uint16_t row = 0;
      for (int j = 0; j < columns; ++j) {
        row = static_cast<std::uint16_t>(
            row + !proven[static_cast<std::size_t>((p * x.cells + i % x.cells) * y.cells + j % y.cells)]);
        const std::size_t at = static_cast<std::size_t>(p) * plane_ + (static_cast<std::size_t>(i) + 1) * stride_ +
                               static_cast<std::size_t>(j) + 1;
        sums_[at] = static_cast<std::uint16_t>(sums_[at - stride_] + row);
      }
    }
  }
}

/// Cells that hold [lower, upper], as many as the axis has at most.
/// @return false where there are none.
bool PairTable::cellsOf(const Axis& axis, double lower, double upper, int& first, int& last) {
  if (axis.wraps) {
    const double turns = kTwoPi * std::floor((lower - axis.lower) / kTwoPi);
    lower -= turns;
    upper -= turns;
  }
  const double begin = std::floor((lower - axis.lower) / axis.width - kCellSlack);
  const double end = std::floor((upper - axis.lower) / axis.width + kCellSlack);
  if (axis.wraps && end - begin >= axis.cells) {
    first = 0;
    last = axis.cells - 1;
    return true;
  }
  // After the shift by full turns, rounding can leave `begin` a cell outside.
  const double shift = !axis.wraps ? 0 : begin < 0 ? axis.cells : begin >= axis.cells ? -axis.cells : 0;
  if (!(begin + shift >= 0 && end + shift < (axis.wraps ? 2 : 1) * axis.cells)) return false;
  first = static_cast<int>(begin + shift);
  last = static_cast<int>(end + shift);
  return true;
}

bool PairTable::free(const double* lower, const double* upper) const {
  int first[3] = {0, 0, 0}, last[3] = {0, 0, 0};
  for (int a = 0; a < cells_.count; ++a) {
    if (!cellsOf(cells_.axes[a], lower[a], upper[a], first[a], last[a])) return false;
  }
  for (int p = first[2]; p <= last[2]; ++p) {
    const std::uint16_t* plane = sums_.data() + static_cast<std::size_t>(p) * plane_;
    const std::uint16_t* top = plane + static_cast<std::size_t>(first[0]) * stride_;
    const std::uint16_t* bottom = plane + (static_cast<std::size_t>(last[0]) + 1) * stride_;
    const int open = bottom[last[1] + 1] - bottom[first[1]] - top[last[1] + 1] + top[first[1]];
    if (static_cast<std::uint16_t>(open) != 0) return false;
  }
  return true;
}

unsigned PairTable::freeParts(const Eigen::MatrixXd& variables, const engine::HalfAngles& half_angles,
                              const VariableStrays& strays) const {
  constexpr int kParts = 8;
  const Eigen::Index degree = variables.cols() - 1;
  // Taylor's polynomial about the middle; its coefficients' terms, and with them all rounding, are within a few dozen
  // ulp of `size` (doc/NUMERICS.md, "Parts of a motion").
  const auto freeOver = [&](double middle, double half) {
    double lower[3], upper[3];
    for (int a = 0; a < cells_.count; ++a) {
      double c[engine::kMaxDegree + 1] = {}, size = 0;
      for (Eigen::Index k = 0; k <= degree; ++k) size += std::abs(c[k] = variables(cells_.axes[a].variable, k));
      for (Eigen::Index i = 0; i < degree; ++i) {
        for (Eigen::Index k = degree - 1; k >= i; --k) c[k] += middle * c[k + 1];
      }
      double way = 64 * kUlp * size, power = 1;
      for (Eigen::Index k = 1; k <= degree; ++k) way += std::abs(c[k]) * (power *= half);
      lower[a] = c[0] - way;
      upper[a] = c[0] + way;
      const int v = cells_.axes[a].variable;
      if (half_angles.has(v)) turnIntoAngles(half_angles.reference[v], lower[a], upper[a]);
      const double stray = strays.of(v);
      if (!std::isfinite(stray)) return false;
      lower[a] -= stray;
      upper[a] += stray;
    }
    return free(lower, upper);
  };
  if (freeOver(0.5, 0.5)) return (1u << kParts) - 1;
  unsigned parts = 0;
  for (int part = 0; part < kParts; ++part) {
    parts |= static_cast<unsigned>(freeOver((part + 0.5) / kParts, 0.5 / kParts)) << part;
  }
  return parts;
}

}  // namespace fcl_artic
