// SPDX-License-Identifier: BSD-3-Clause
// Which pieces of a body are drawn; and when a query is solved again without the stage, by a solver that says what it
// is told to say.
#include "visibility/stage.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "geometry/shape_tree.h"
#include "pairs/random.h"
#include "visibility/volumes.h"

namespace stage_test {

namespace {

using namespace fcl_artic;
using Eigen::Vector3d;
using visibility::Bounds;

/// The tree leaves no piece out: what it comes to is what a look at each piece finds.
TEST(Pieces, AreThoseThatMeetTheParts) {
  pairs::Random random(1);
  const auto inCube = [&] { return Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)); };
  std::vector<Vector3d> vertices;
  std::vector<std::array<int, 3>> triangles;
  for (int i = 0; i < 2000; ++i) {
    const Vector3d at = inCube();
    for (int k = 0; k < 3; ++k) vertices.push_back(at + 0.05 * random.direction());
    triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  const auto tree = ShapeTree::fromTriangles(vertices, triangles);
  std::size_t found = 0, too_many = 0, balls = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Eigen::Matrix3d turn = random.rotation();
    const Vector3d at = 2 * random.direction();
    engine::Placement placement;
    Eigen::Matrix<double, 3, 3, Eigen::RowMajor>::Map(placement.R) = turn;
    Vector3d::Map(placement.t) = at;
    placement.length = at.norm() + 1e-9;
    placement.ulps = 8;
    visibility::SweptParts swept;
    for (Bounds& part : swept.parts) {
      const Vector3d middle = at + random.direction();
      const Vector3d segment[2] = {middle, middle + 0.5 * random.direction()};
      part = visibility::boundsOf(segment[0].data(), 2, trial % 4 ? 0.05 : 0.4);
    }
    const double margin = trial % 2 ? 0.01 : 0;
    const std::uint32_t asked = trial % 3 ? 0xff : 0x05;
    std::size_t expected = 0;
    std::uint32_t met = 0;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      Vector3d corners[3];
      for (std::size_t k = 0; k < 3; ++k) corners[k] = turn * vertices[3 * i + k] + at;
      const Bounds bounds = visibility::boundsOf(corners[0].data(), 3, margin);
      std::uint32_t lanes = 0;
      for (int lane = 0; lane < 8; ++lane) {
        bool apart = !(asked >> lane & 1);
        for (int d = 0; d < Bounds::kDirections; ++d)
          apart = apart || swept.parts[lane].lo[d] > bounds.hi[d] || bounds.lo[d] > swept.parts[lane].hi[d];
        if (!apart) lanes |= 1u << lane;
      }
      met |= lanes;
      expected += lanes != 0;
    }
    visibility::Drawing drawing;
    Bounds reach;
    std::uint32_t lanes = asked;
    constexpr std::size_t kMost = 40;
    const bool added = visibility::addPieces(tree->view(), 0, placement, margin, swept, kMost, lanes, reach, drawing);
    EXPECT_EQ(added, expected <= kMost) << trial;
    EXPECT_EQ(drawing.pieces.size(), added ? expected : 0) << trial;
    EXPECT_EQ(lanes, added ? met : asked) << trial;
    found += drawing.pieces.size();
    too_many += !added;
    // With balls around nodes: each of these pieces lies in what is drawn.
    visibility::Drawing coarse;
    swept.least = 0.2;
    lanes = asked;
    if (!visibility::addPieces(tree->view(), 0, placement, margin, swept, 2 * kMost, lanes, reach, coarse)) continue;
    for (const visibility::Drawing::Piece& piece : drawing.pieces) {
      for (int i = 0; i < piece.volume.count; ++i) {
        const auto x = Vector3d::Map(drawing.points.data() + 3 * (piece.volume.first + i));
        const bool held = std::any_of(coarse.pieces.begin(), coarse.pieces.end(), [&](const auto& other) {
          double nearest = HUGE_VAL;
          for (int k = 0; k < other.volume.count; ++k)
            nearest =
                std::min(nearest, (x - Vector3d::Map(coarse.points.data() + 3 * (other.volume.first + k))).norm());
          return nearest + piece.volume.radius <= other.volume.radius + 1e-12;
        });
        EXPECT_TRUE(held) << trial;
      }
    }
    for (const visibility::Drawing::Piece& piece : coarse.pieces) balls += piece.volume.count == 1;
  }
  EXPECT_GT(balls, 1000u);
  EXPECT_GT(found, 1000u);
  EXPECT_GT(too_many, 5u);
  EXPECT_LT(too_many, 80u);
}

/// `most` counts what is drawn already. If one piece more would be drawn, all stays as it was.
TEST(Pieces, AreAllOrNone) {
  constexpr std::size_t kPieces = 8;
  std::vector<Vector3d> vertices;
  std::vector<std::array<int, 3>> triangles;
  for (int i = 0; i < static_cast<int>(kPieces); ++i) {
    for (const Vector3d& corner : {Vector3d(0, 0, 0), Vector3d(0.5, 0, 0), Vector3d(0, 0.5, 0)})
      vertices.push_back(Vector3d(i, 0, 0) + corner);
    triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  const auto tree = ShapeTree::fromTriangles(vertices, triangles);
  visibility::SweptParts swept;  // the second part holds no point
  const Vector3d segment[2] = {{-1, 0, 0.1}, {9, 0, 0.1}};
  swept.parts[0] = visibility::boundsOf(segment[0].data(), 2, 0.2);
  visibility::Drawing drawing;
  Bounds reach;
  const auto add = [&](std::size_t most) {
    std::uint32_t lanes = 3;
    const bool added = visibility::addPieces(tree->view(), 0, {}, 0, swept, most, lanes, reach, drawing);
    EXPECT_EQ(lanes, added ? 1u : 3u);
    return added;
  };
  for (const std::size_t before : {std::size_t{0}, kPieces}) {
    EXPECT_FALSE(add(before + kPieces - 1));
    EXPECT_EQ(drawing.pieces.size(), before);
    EXPECT_EQ(drawing.points.size(), 9 * before);
    EXPECT_EQ(reach.hi[0] > reach.lo[0], before > 0);
    EXPECT_TRUE(add(before + kPieces));
  }
  EXPECT_EQ(drawing.points.size(), 9 * drawing.pieces.size()) << "inner nodes leave no points";
}

/// One pair of a ball that sweeps along x and a triangle, `away` above it.
class SolveTwice : public testing::Test {
 protected:
  SolveTwice() : tree_(ShapeTree::fromTriangles({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}})) {
    body_.tree = &tree_->view();
    problem_.bodies = &body_;
    problem_.num_bodies = problem_.num_obstacles = problem_.num_scene_pairs = 1;
    query_.progress = [](void* self, double t) {
      auto& told = static_cast<SolveTwice*>(self)->told_;
      told.push_back(t);
      return static_cast<SolveTwice*>(self)->goes_on_;
    };
    query_.progress_context = this;
  }
  /// Asks the stage, tells times and answers.
  void answer(const engine::Query& query, engine::Answer& answer) {
    advised_.push_back(query.num_advisors > 0);
    if (query.num_advisors) {
      engine::SweptLink links[8];
      for (int k = 0; k < 8; ++k) {
        for (int i = 0; i < 6; ++i) {
          const double point[3] = {(k + i % 3 / 2.0) / 8, 0.1, away_};
          std::copy(point, point + 3, links[k].points[i]);
        }
        links[k].radius = 0.05;
      }
      engine::CullCandidate pair = {{}, 0, 0, 0, &body_.placement, 0xff, query.margins.of({})};
      query.advisors[0].clear(query.advisors[0].self, problem_, links, &pair, 1);
    }
    for (const double t : {0.1, query.num_advisors ? 0.5 : 0.4}) query.progress(query.progress_context, t);
    answer.status = status_;
    answer.num_ignored = ignored_;
    answer.statistics.node_tests = 10;
  }
  using Calls = std::vector<bool>;  ///< of the solver: with the stage?
  Calls solve() {
    advised_.clear();
    told_.clear();
    report_ = visibility::Report();
    answer_ = engine::Answer();
    visibility::solve(
        culler_, [this](const engine::Query& asked, engine::Answer& out) { answer(asked, out); }, query_, answer_,
        report_);
    return advised_;
  }

  std::shared_ptr<const ShapeTree> tree_;
  engine::Body body_;
  engine::Problem problem_;
  engine::Query query_;
  const VisibilityCuller culler_;
  double away_ = 0.5;
  Status status_ = Status::free;
  int ignored_ = 0;
  bool goes_on_ = true;
  Calls advised_;
  std::vector<double> told_;
  visibility::Report report_;
  engine::Answer answer_;
};

TEST_F(SolveTwice, FreeStands) {
  EXPECT_EQ(solve(), Calls({true}));
  EXPECT_EQ(report_.work.culled, 1u);
  EXPECT_EQ(report_.work.repeated, 0u);
  EXPECT_EQ(report_.executor, "cpu");
}

/// From when on an ignored pair is watched is part of the answer.
TEST_F(SolveTwice, ContactAndIgnoredContactAreSolvedAgain) {
  for (const bool contact : {false, true}) {
    status_ = contact ? Status::contact : Status::free;
    ignored_ = !contact;
    EXPECT_EQ(solve(), Calls({true, false}));
    EXPECT_EQ(report_.work.culled, 1u);
    EXPECT_EQ(report_.work.repeated, 1u);
    EXPECT_EQ(told_, std::vector<double>({0.1, 0.5, 0.5, 0.5})) << "what is proven stays proven";
    EXPECT_EQ(answer_.statistics.node_tests, 20u);
  }
}

TEST_F(SolveTwice, ContactOfWhichNothingWasTakenOutStands) {
  status_ = Status::contact;
  away_ = 0.04;
  EXPECT_EQ(solve(), Calls({true}));
  EXPECT_EQ(report_.work.culled, 0u);
}

TEST_F(SolveTwice, EndedIsEnded) {
  status_ = Status::undecided;
  goes_on_ = false;
  EXPECT_EQ(solve(), Calls({true})) << "asked again after it had said no";
}

TEST_F(SolveTwice, BudgetIsSpentWithoutTheStage) {
  query_.work_budget = 1000;
  EXPECT_EQ(solve(), Calls({false}));
}

/// What is nearer than the tolerance may be a contact to the solver alone.
TEST_F(SolveTwice, PairWithinTheToleranceIsNotCulled) {
  for (const double gap : {0.5e-6, 2e-6}) {
    away_ = 0.05 + gap;
    solve();
    EXPECT_EQ(report_.work.culled, gap > query_.tolerance_distance ? 1u : 0u);
  }
}

}  // namespace

}  // namespace stage_test
