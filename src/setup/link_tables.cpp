// SPDX-License-Identifier: BSD-3-Clause
#include "setup/link_tables.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "motion/half_angles.h"
#include "numerics/arc_tangent.h"
#include "threads/parallel.h"

namespace fcl_artic {

void LinkTables::build(const Registry& registry, const engine::Problem& problem, const PairMargins& margins,
                       std::size_t num_self_pairs, const ProvenPairs& proven) {
  std::unordered_multimap<std::size_t, Made> before;  // by hash
  for (Made& made : made_) {
    const std::size_t hash = made.made.hash();
    before.emplace(hash, std::move(made));
  }
  made_.clear();
  tables_.assign(num_self_pairs, nullptr);
  num_tables_ = 0;
  grids_.clear();
  ranges_.clear();
  likely_.clear();
  most_cells_ = 0;
  const KinematicTree& tree = *registry.tree();
  std::vector<std::size_t> pairs, unknown;  // unknown: into both
  std::size_t next = 0;
  while (next < num_self_pairs && num_tables_ < kMax) {
    // Takes a block of pairs, then makes their tables on all cores. So the same pairs get tables, whatever was known
    // before.
    const std::size_t begin = made_.size();
    unknown.clear();
    for (; next < num_self_pairs && made_.size() < begin + kBlock; ++next) {
      const engine::LinkPair& pair = problem.link_pairs[next];
      const ManagedBody &a = registry.body(pair.a), &b = registry.body(pair.b);
      if (a.attached || b.attached || proven.proven(next)) continue;
      Made made{PairMaking(tree, a, b), margins.ofLinkPair(next), nullptr, nullptr};
      const auto [first, last] = before.equal_range(made.made.hash());
      const auto known = std::find_if(first, last, [&](const auto& entry) {
        return entry.second.margin == made.margin && entry.second.made.sameAs(made.made);
      });
      if (known != last) {
        made.table = known->second.table;
        made.grid = known->second.grid;
      } else {
        unknown.push_back(made_.size());
      }
      pairs.push_back(next);
      made_.push_back(std::move(made));
    }
    parallelFor(unknown.size(), 0, [&](std::size_t k) {
      Made& made = made_[unknown[k]];
      const engine::LinkPair& pair = problem.link_pairs[pairs[unknown[k]]];
      const engine::SweepView& sweep = problem.sweeps[pair.sweep];
      made.table = PairTable::build(tree, sweep, problem.bodies, pair, made.margin);
      made.grid = ContactGrid::build(tree, sweep, pair, problem.bodies);
    });
    for (std::size_t k = begin; k < made_.size(); ++k) num_tables_ += made_[k].table != nullptr;
  }
  for (std::size_t k = 0; k < made_.size(); ++k) {
    tables_[pairs[k]] = made_[k].table;
    if (made_[k].grid) addGrid(tree, static_cast<std::int32_t>(pairs[k]), *made_[k].grid);
  }
}

void LinkTables::addGrid(const KinematicTree& tree, std::int32_t link_pair, const ContactGrid& grid) {
  grids_.push_back({link_pair, grid.axes(), likely_.size()});
  most_cells_ = std::max(most_cells_, grid.axes().cells);
  likely_.insert(likely_.end(), grid.touching().begin(), grid.touching().end());
  for (int i = 0; i < grid.axes().count; ++i) {
    const int v = grid.axes().variables[i];
    const bool known = std::any_of(ranges_.begin(), ranges_.end(), [&](const auto& r) { return r.first == v; });
    if (!known) ranges_.emplace_back(v, VariableRange(tree, v));
  }
}

unsigned LinkTables::freeParts(const engine::Problem& problem, const JointMotion& motion, const VariableStrays& strays,
                               const engine::Margins& margins, std::int32_t link_pair) const {
  const auto pair = static_cast<std::size_t>(link_pair);
  if (pair >= tables_.size() || !tables_[pair]) return 0;
  const PairTable& table = *tables_[pair];
  if (margins.of(problem.linkPair(link_pair)) > table.margin()) return 0;
  return table.freeParts(motion.variables(), halfAnglesOf(motion), strays);
}

void LinkTables::likelyContacts(const JointMotion& motion, std::vector<engine::LikelyContact>& found) const {
  found.clear();
  const Eigen::MatrixXd& variables = motion.variables();
  const engine::HalfAngles half_angles = halfAnglesOf(motion);
  constexpr int kMax = 64, kLast = 7;
  double parts[2][kMax];
  if (grids_.empty() || variables.rows() > kMax) return;
  const auto evaluate = [&](int part, double* of_ranges) {
    const double t = (part + 0.5) / (kLast + 1);
    for (const auto& [v, range] : ranges_) {
      double q = variables(v, variables.cols() - 1);
      for (Eigen::Index k = variables.cols() - 2; k >= 0; --k) q = q * t + variables(v, k);
      if (half_angles.has(v)) q = half_angles.reference[v] + 2 * arcTangent(q);
      of_ranges[v] = range.part(q);
    }
  };
  const auto addLikely = [&](int part, const double* of_ranges) {
    for (const Grid& grid : grids_) {
      if (likely_[grid.first + grid.axes.cell(of_ranges)]) found.push_back({grid.link_pair, part});
    }
  };
  // Most motions that meet something still touch it at their end.
  evaluate(kLast, parts[0]);
  addLikely(kLast, parts[0]);
  evaluate(0, parts[1]);
  // About as many poses between the ends as the motion goes through cells.
  double cells = 0;
  for (const auto& [v, range] : ranges_) cells = std::max(cells, most_cells_ * std::abs(parts[0][v] - parts[1][v]));
  const int between = static_cast<int>(std::min<double>(cells, kLast - 1));
  for (int i = between; i > 0; --i) {
    const int part = (kLast * i + (between + 1) / 2) / (between + 1);
    evaluate(part, parts[0]);
    addLikely(part, parts[0]);
  }
  addLikely(0, parts[1]);
}

}  // namespace fcl_artic
