// SPDX-License-Identifier: BSD-3-Clause
#include "query/pair_table.h"

#include <algorithm>
#include <cmath>

#include "kinematics/angles.h"
#include "motion/variable_reach.h"
#include "query/engine_query.h"

namespace fcl_artic {
namespace {

constexpr double kUlp = 0x1p-52;
/// Cells along the variable that the engine moves; and at most along the one that is paid for by a margin, where they
/// are cut so fine that this margin is kRowMargin. Measured: 96 rows take three times as long for the UR5, whose base
/// and upper arm pass each other at 16 mm.
constexpr int kColumns = 96, kMostRows = 192;
constexpr double kRowMargin = 0.002;
/// A third variable (a gripper's fingers) has three cells, its range and as much below and above, where that takes no
/// larger margin. (Fingers are held apart beyond their limits in more than one description of a scene.)
constexpr double kMostMargin = 0.03;
constexpr int kPlanes = 3;
/// Joints may stand at their limits: cells go on behind them by this part of the range.
constexpr double kBeyondLimits = 1e-3;
/// Cells are proven, and looked up, wider than they are by this part of their width: more than all rounding of joint
/// values.
constexpr double kCellSlack = 1e-6;
/// Tests of nodes and leaves for one box of cells; what needs more counts as not proven. Measured on the Panda and the
/// UR5: 400 prove 0.6 % of the cells more in three times the time.
constexpr std::uint64_t kWork = 60;
/// Joints with limits beyond, rad or m, or that follow others by larger factors, are left alone.
constexpr double kMostValue = 100;
/// Of a row's cells neither of whose ends is proven, fewer than these are not looked into.
constexpr int kIsland = 40;
constexpr double kToleranceTime = 1.0 / 64, kToleranceDistance = 1e-4;

}  // namespace

/// Proves cells: the first axis's by motions, the second one's by margins.
class PairTable::Builder {
 public:
  /// @param path  steps from the one link to the other.
  Builder(const std::vector<engine::SweepStep>& path, const engine::Body* bodies, const engine::LinkPair& pair,
          PairTable& table)
      : table_(table), moved_(table.axes_[0]), paid_(table.axes_[1]), path_(path), pair_(pair) {
    for (std::size_t i = 0; i < path_.size(); ++i) {
      path_[i].parent = static_cast<std::int32_t>(i) - 1;
      for (int a = 0; a < table.num_axes_; ++a) {
        if (path[i].variable == table.axes_[a].variable) path_[i].variable = a;
      }
    }
    sweep_.steps = path_.data();
    sweep_.num_steps = static_cast<std::int32_t>(path_.size());
    pair_.sweep = 0;
    pair_.step_b = sweep_.num_steps - 1;
    problem_.bodies = bodies;
    problem_.num_bodies = std::max(pair.a, pair.b) + 1;
    problem_.sweeps = &sweep_;
    problem_.num_sweeps = 1;
    problem_.link_pairs = &pair_;
    problem_.num_link_pairs = 1;
    query_.coefficients = variables_.data();
    query_.num_variables = 3;
    query_.check_scene = false;
    query_.work_budget = kWork;
    query_.tolerance_time = kToleranceTime;
    query_.tolerance_distance = kToleranceDistance;
  }

  /// @param reach  as reachPerUnit() says, of the axes' variables.
  /// @return 1 for each cell that is proven, by the third axis's index, then the first one's, then the second one's.
  std::vector<std::uint8_t> run(const double* reach) {
    reach_ = reach;
    proven_.assign(static_cast<std::size_t>(moved_.cells * paid_.cells * table_.axes_[2].cells), 0);
    for (plane_ = 0; plane_ < table_.axes_[2].cells; ++plane_) proveRows(0, paid_.cells);
    return std::move(proven_);
  }

 private:
  /// Rows [j, j_end) together, else in halves, else one row in parts.
  void proveRows(int j, int j_end) {
    query_.margin = table_.margin_;
    for (int a = 1; a < table_.num_axes_; ++a) {
      const Axis& paid = table_.axes_[a];
      const int begin = a == 1 ? j : plane_, end = a == 1 ? j_end : plane_ + 1;
      variables_(a, 0) = paid.lower + 0.5 * (begin + end) * paid.width;
      query_.margin += reach_[a] * (0.5 * (end - begin) + 2 * kCellSlack) * paid.width;
    }
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
    if (i_end - i < kIsland) return;
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
    if (table_.num_axes_ > 0) {
      const double slack = end > begin ? kCellSlack : -kCellSlack;
      const double from = moved_.lower + (begin - slack) * moved_.width;
      variables_(0, 0) = from;
      variables_(0, 1) = moved_.lower + (end + slack) * moved_.width - from;
    }
    engine::Answer answer;
    engine::engine().solve(workspace_->engine(), problem_, query_, answer);
    if (answer.verdict == engine::Verdict::free) return cells;
    if (query_.any) return 0;
    // Apart before t_lower: the cells' own slack behind the last of them is in it.
    return std::max(0, static_cast<int>(answer.t_lower * (cells + 2 * kCellSlack) - 3 * kCellSlack));
  }

  PairTable& table_;
  const Axis &moved_, &paid_;
  Eigen::Matrix<double, 3, 2> variables_ = Eigen::Matrix<double, 3, 2>::Zero();  ///< a row for each axis
  std::vector<engine::SweepStep> path_;
  engine::SweepView sweep_;
  engine::LinkPair pair_;
  engine::Problem problem_;
  engine::Query query_;
  const WorkspaceLoan workspace_;
  const double* reach_ = nullptr;
  int plane_ = 0;  ///< cell of the third axis
  std::vector<std::uint8_t> proven_;
};

std::shared_ptr<const PairTable> PairTable::build(const KinematicTree& tree, const engine::SweepView& sweep,
                                                  const engine::Body* bodies, const engine::LinkPair& pair,
                                                  double margin) {
  std::vector<engine::SweepStep> path;
  for (int s = pair.step_b; s >= 0; s = sweep.steps[s].parent) path.push_back(sweep.steps[s]);
  std::reverse(path.begin(), path.end());
  auto table = std::make_shared<PairTable>();
  table->margin_ = margin;
  for (const engine::SweepStep& step : path) {
    if (step.kind != engine::StepKind::revolute && step.kind != engine::StepKind::prismatic) return nullptr;
    const auto end = table->axes_ + table->num_axes_;
    if (!(std::abs(step.multiplier) <= kMostValue && std::abs(step.offset) <= kMostValue)) return nullptr;
    if (std::any_of(table->axes_, end, [&](const Axis& a) { return a.variable == step.variable; })) continue;
    if (table->num_axes_ == 3) return nullptr;
    table->axes_[table->num_axes_++].variable = step.variable;
  }
  for (int a = 0; a < table->num_axes_; ++a) {
    Axis& axis = table->axes_[a];
    const bool whole_turns = std::all_of(path.begin(), path.end(), [&](const engine::SweepStep& step) {
      return step.variable != axis.variable ||
             (step.kind == engine::StepKind::revolute && step.multiplier == std::round(step.multiplier));
    });
    const Joint& joint = tree.joint(tree.variableJoint(axis.variable));
    const bool limited = hasLimits(joint) && std::max(std::abs(joint.lower), std::abs(joint.upper)) <= kMostValue;
    axis.wraps = whole_turns && !(limited && joint.upper - joint.lower < kTwoPi);
    if (!axis.wraps && !limited) return nullptr;
    const double range = axis.wraps ? kTwoPi : joint.upper - joint.lower;
    axis.cells = kColumns;
    axis.lower = axis.wraps ? -kTwoPi / 2 : joint.lower - kBeyondLimits * range;
    axis.width = (axis.wraps ? range : (1 + 2 * kBeyondLimits) * range) / axis.cells;
    // Rounding of values near the cells' is far below the slack.
    if (!(axis.width * kCellSlack > 64 * kUlp * std::max(std::abs(axis.lower), std::abs(axis.upper())))) return nullptr;
  }
  // The engine moves the variable that takes the link farthest, rows are of the next one, and a third one must be of
  // little effect.
  Axis* const axes = table->axes_;
  const auto size = [&](int variable) {
    const Axis& axis =
        *std::find_if(axes, axes + table->num_axes_, [&](const Axis& a) { return a.variable == variable; });
    return std::max(std::abs(axis.lower), std::abs(axis.upper())) + axis.width;
  };
  const auto reachOf = [&](const Axis& axis) {
    const double of_b = reachPerUnit(sweep, pair.step_b, pair.placement_b, *bodies[pair.b].tree, axis.variable, size);
    const bool first_only = std::all_of(path.begin(), path.end(), [&](const engine::SweepStep& step) {
      return (step.variable == axis.variable) == (&step == path.data());
    });
    return first_only ? std::min(of_b, reachOfBase(path[0], pair.inverse_a, *bodies[pair.a].tree)) : of_b;
  };
  const auto way = [&](const Axis& axis) { return reachOf(axis) * axis.width * axis.cells; };
  std::stable_sort(axes, axes + table->num_axes_, [&](const Axis& a, const Axis& b) { return way(a) > way(b); });
  double reach[3] = {0, 0, 0};
  for (int a = 1; a < table->num_axes_; ++a) {
    Axis& axis = axes[a];
    const double range = axis.width * axis.cells, margin = 0.5 * way(axis);
    reach[a] = reachOf(axis);
    if (a == 1) {
      axis.cells = static_cast<int>(std::clamp(std::ceil(margin / kRowMargin), 1.0, 1.0 * kMostRows));
      axis.width = range / axis.cells;
    } else {
      if (axis.wraps || margin > kMostMargin) return nullptr;
      axis.cells = kPlanes;
      axis.width = range;
      axis.lower -= (kPlanes - 1) / 2 * range;
    }
  }
  const std::vector<std::uint8_t> proven = Builder(path, bodies, pair, *table).run(reach);
  if (std::none_of(proven.begin(), proven.end(), [](std::uint8_t cell) { return cell != 0; })) return nullptr;
  table->sum(proven);
  return table;
}

void PairTable::sum(const std::vector<std::uint8_t>& proven) {
  const Axis &x = axes_[0], &y = axes_[1];
  const int rows = x.wraps ? 2 * x.cells : x.cells, columns = y.wraps ? 2 * y.cells : y.cells;
  stride_ = static_cast<std::size_t>(columns) + 1;
  plane_ = (static_cast<std::size_t>(rows) + 1) * stride_;
  sums_.assign(plane_ * static_cast<std::size_t>(axes_[2].cells), 0);
  for (int p = 0; p < axes_[2].cells; ++p) {
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
  // Behind the shift by full turns, rounding can leave `begin` a cell outside.
  const double shift = !axis.wraps ? 0 : begin < 0 ? axis.cells : begin >= axis.cells ? -axis.cells : 0;
  if (!(begin + shift >= 0 && end + shift < (axis.wraps ? 2 : 1) * axis.cells)) return false;
  first = static_cast<int>(begin + shift);
  last = static_cast<int>(end + shift);
  return true;
}

bool PairTable::free(const double* lower, const double* upper) const {
  int first[3] = {0, 0, 0}, last[3] = {0, 0, 0};
  for (int a = 0; a < num_axes_; ++a) {
    if (!cellsOf(axes_[a], lower[a], upper[a], first[a], last[a])) return false;
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

unsigned PairTable::freeParts(const Eigen::MatrixXd& variables) const {
  constexpr int kParts = 8;
  const Eigen::Index degree = variables.cols() - 1;
  // Taylor's polynomial about the middle; its coefficients' terms, and with them all rounding, are within a few dozen
  // ulp of `size` (doc/NUMERICS.md, "Parts of a motion").
  const auto freeOver = [&](double middle, double half) {
    double lower[3], upper[3];
    for (int a = 0; a < num_axes_; ++a) {
      double c[engine::kMaxDegree + 1], size = 0;
      for (Eigen::Index k = 0; k <= degree; ++k) size += std::abs(c[k] = variables(axes_[a].variable, k));
      for (Eigen::Index i = 0; i < degree; ++i) {
        for (Eigen::Index k = degree - 1; k >= i; --k) c[k] += middle * c[k + 1];
      }
      double way = 64 * kUlp * size, power = 1;
      for (Eigen::Index k = 1; k <= degree; ++k) way += std::abs(c[k]) * (power *= half);
      lower[a] = c[0] - way;
      upper[a] = c[0] + way;
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
