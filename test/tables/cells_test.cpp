// SPDX-License-Identifier: BSD-3-Clause
//
// Every proven cell of a table looked at again: motions over the cell by the engine, of the pair alone, with no table
// and in the robot's own variables. They run along the first variable at the corners of the others' cells, where a
// lever that was taken too short shows first. They also run along diagonals, and straight from anywhere in a cell to
// anywhere. Cells are taken from the tables, and nothing else is: no lever, no margin but the table's.
#include <cstdlib>
#include <filesystem>
#include <iostream>

#include <gtest/gtest.h>

#include "fcl_artic/urdf/urdf.h"
#include "narrowphase/engine_workspace.h"
#include "query/engine_query.h"
#include "random_links.h"
#include "setup/registry.h"
#include "setup/setup.h"
#include "tables/pair_table.h"

namespace cells_test {

using namespace fcl_artic;
using Eigen::VectorXd;

namespace {

constexpr double kNear = 0.01;

double asked(const char* name, double otherwise) {
  const char* text = std::getenv(name);
  return text ? std::strtod(text, nullptr) : otherwise;
}
std::uint64_t seed() {
  return static_cast<std::uint64_t>(asked("FCL_ARTIC_TABLE_SEED", 1));
}

struct Counts {
  std::uint64_t pairs = 0, tables = 0, cells = 0, proven = 0, looked_at = 0, motions = 0, near = 0, uncertain = 0,
                wrong = 0;
};

/// Rows of proven cells of a pair's table, and the motions over them.
class Looker {
 public:
  Looker(const KinematicTree& tree, const engine::Problem& problem, std::int32_t pair, const PairTable& table,
         pairs::Random& random, Counts& counts)
      : table_(table), random_(random), counts_(counts), dof_(tree.dof()) {
    problem_ = problem;
    problem_.link_pairs += pair;
    problem_.num_link_pairs = 1;
    problem_.num_movers = 0;  // no stage 1: the pair is looked at by itself
    problem_.num_scene_pairs = 0;
    query_.num_variables = dof_;
    query_.check_scene = false;
  }

  /// @param share  of the rows that are looked at.
  void run(double share) {
    const PairTable::Cells& cells = table_.cells();
    const PairTable::Axis &x = cells.axes[0], &y = cells.axes[1], &z = cells.axes[2];
    counts_.cells += static_cast<std::uint64_t>(x.cells) * static_cast<std::uint64_t>(y.cells * z.cells);
    for (int k = 0; k < z.cells; ++k) {
      for (int j = 0; j < y.cells; ++j) {
        std::vector<bool> proven;
        for (int i = 0; i < x.cells; ++i) proven.push_back(isProven(i, j, k));
        counts_.proven += static_cast<std::uint64_t>(std::count(proven.begin(), proven.end(), true));
        if (!random_.chance(share)) continue;
        for (int begin = 0, end = 0; begin < x.cells; begin = end + 1) {
          for (end = begin; end < x.cells && proven[static_cast<std::size_t>(end)];) ++end;
          if (end > begin) lookAt(begin, end, j, k);
        }
      }
    }
  }

 private:
  static double at(const PairTable::Axis& axis, double cell) { return axis.lower + cell * axis.width; }

  bool isProven(int i, int j, int k) const {
    double q[3];
    const int cell[3] = {i, j, k};
    for (int a = 0; a < table_.cells().count; ++a) q[a] = at(table_.cells().axes[a], cell[a] + 0.5);
    return table_.free(q, q);
  }

  /// Cells [begin, end) of the first variable, all of them proven.
  void lookAt(int begin, int end, int j, int k) {
    counts_.looked_at += static_cast<std::uint64_t>(end - begin);
    using Point = Eigen::Vector3d;  // in cells
    const Point low(begin, j, k), size(end - begin, 1, 1);
    const int corners = 1 << (table_.cells().count > 0 ? table_.cells().count - 1 : 0);
    for (int c = 0; c < corners; ++c) {
      const Point from = low + Point(0, c & 1, c >> 1), along = from + Point(end - begin, 0, 0);
      const Point across = low + Point(end - begin, 1 - (c & 1), table_.cells().count > 2 ? 1 - (c >> 1) : 0);
      look(from, along);
      if (corners > 1) look(from, across);
    }
    const auto anywhere = [&](const Point& l, const Point& s) {
      const double u = random_.unit(), v = random_.unit(), w = random_.unit();
      return Point(l + s.cwiseProduct(Point(u, v, w)));
    };
    look(anywhere(low, size), anywhere(low, size));
    for (int i = begin; i < end; ++i) {
      const int corner = random_.below(8);
      const Point cell(i, j, k), one(1, 1, 1);
      const Point off(corner & 1, corner >> 1 & 1, corner >> 2);
      if (random_.chance(0.5)) {
        look(cell + off, cell + one - off);
      } else {
        look(anywhere(cell, one), anywhere(cell, one));
      }
    }
  }

  void look(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    Eigen::MatrixXd motion = Eigen::MatrixXd::Zero(dof_, 2);
    for (int a = 0; a < table_.cells().count; ++a) {
      const PairTable::Axis& axis = table_.cells().axes[a];
      motion(axis.variable, 0) = at(axis, from[a]);
      motion(axis.variable, 1) = at(axis, to[a]) - at(axis, from[a]);
    }
    query_.coefficients = motion.data();
    ++counts_.motions;
    const engine::Answer answer = solve(table_.margin());
    const bool wrong = answer.status == Status::contact && answer.certain;
    counts_.wrong += wrong;
    counts_.uncertain += !wrong && !answer.isFree();
    if (wrong && counts_.wrong < 10) {
      ADD_FAILURE() << "a proven cell has a contact in it, cells " << from.transpose() << " to " << to.transpose()
                    << ", t <= " << answer.t_upper;
    }
    if (random_.chance(0.1)) counts_.near += 10 * (solve(table_.margin() + kNear).status != Status::free);
  }

  engine::Answer solve(double margin) {
    engine::Answer answer;
    query_.margins = engine::Margins(margin);
    query_.any = random_.chance(0.5);
    workspace_.solve(problem_, query_, answer);
    return answer;
  }

  const PairTable& table_;
  pairs::Random& random_;
  Counts& counts_;
  const std::int32_t dof_;
  engine::Problem problem_;
  engine::Query query_;
  engine::EngineWorkspace workspace_;
};

/// All tables of a robot.
void lookAtTables(const Registry& registry, double margin, double share, pairs::Random& random, Counts& counts) {
  Setup setup;
  setup.build(registry);
  const engine::Problem problem = setup.problem();
  for (std::int32_t i = 0; i < setup.numSelfPairs(); ++i) {
    ++counts.pairs;
    const engine::LinkPair& pair = problem.link_pairs[i];
    const auto table = PairTable::build(*registry.tree(), problem.sweeps[pair.sweep], problem.bodies, pair, margin);
    if (!table) continue;
    ++counts.tables;
    Looker(*registry.tree(), problem, i, *table, random, counts).run(share);
  }
}

void report(const std::string& name, const Counts& c) {
  std::cout << name << ": " << c.pairs << " pairs, " << c.tables << " tables, " << c.proven << " of " << c.cells
            << " cells proven; looked at " << c.looked_at << " by " << c.motions << " motions, within 10 mm about "
            << c.near << ", too near to say " << c.uncertain << ", wrong " << c.wrong << std::endl;
}

/// @param near, looked_at  of the counts, summed up.
void lookAtRobot(const std::filesystem::path& urdf, std::uint64_t& near, std::uint64_t& looked_at) {
  const Robot robot = loadUrdf(urdf.string());
  Registry registry(robot.tree);
  for (const LinkGeometry& g : robot.geometry) registry.bind(g.link, g.object.get(), g.offset);
  registry.setAllowed(robot.allowed);  // of the SRDF's pairs none: those that never touch have tables, too
  pairs::Random random(seed());
  for (const double margin : {0.0, 0.02}) {
    Counts counts;
    lookAtTables(registry, margin, asked("FCL_ARTIC_TABLE_SHARE", 0.1), random, counts);
    report(urdf.stem().string() + ", margin " + std::to_string(margin), counts);
    EXPECT_EQ(counts.wrong, 0u);
    near += counts.near;
    looked_at += counts.looked_at;
  }
}

}  // namespace

TEST(TableCells, OfTheBundledRobot) {
  std::uint64_t near = 0, looked_at = 0;
  lookAtRobot(FCL_ARTIC_BUNDLED_ROBOT, near, looked_at);
  EXPECT_GT(looked_at, 5000u);
  EXPECT_GT(near, 0u) << "the cells say little";
}

TEST(TableCells, OfRealRobots) {
  const char* data = std::getenv("FCL_ARTIC_DATA");
  if (!data) GTEST_SKIP() << "FCL_ARTIC_DATA does not name a folder with robots";
  const char* one = std::getenv("FCL_ARTIC_TABLE_ROBOT");
  std::uint64_t near = 0, looked_at = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(std::filesystem::path(data) / "robots")) {
    if (entry.path().extension() != ".urdf" || (one && entry.path().stem() != one)) continue;
    lookAtRobot(entry.path(), near, looked_at);
  }
  EXPECT_GT(looked_at, 1000u);
  EXPECT_GT(near, 0u) << "the cells say little";
}

TEST(TableCells, OfRandomLinks) {
  Counts counts;
  const auto pairs = static_cast<std::uint64_t>(asked("FCL_ARTIC_TABLE_PAIRS", 100));
  for (std::uint64_t i = 0; i < pairs; ++i) {
    pairs::Random random(pairs::Random::mix(seed() + 1000, i));
    const tables::RandomLinks links(random);
    Registry registry(links.tree);
    registry.bind(links.tree->linkId("a"), links.a.get(), links.on_a);
    registry.bind(links.tree->linkId("b"), links.b.get(), links.on_b);
    const std::uint64_t wrong = counts.wrong;
    lookAtTables(registry, links.margin, asked("FCL_ARTIC_TABLE_SHARE", 0.1), random, counts);
    if (counts.wrong > wrong) ADD_FAILURE() << "seed " << seed() << ", pair " << i;
  }
  report("random links, seed " + std::to_string(seed()), counts);
  EXPECT_EQ(counts.wrong, 0u);
  EXPECT_GT(static_cast<double>(counts.tables), 0.3 * static_cast<double>(pairs));
  EXPECT_GT(counts.near, counts.motions / 200) << "the cells say little";
}

}  // namespace cells_test
