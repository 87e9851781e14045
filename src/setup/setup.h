// SPDX-License-Identifier: BSD-3-Clause
//
// All that queries read: the engine's problem, made from the registry by build(), constant and shared by threads until
// the next one. The part that depends on the robot alone stays when only obstacles change.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "model/problem.h"
#include "motion/frame_sweep.h"
#include "setup/link_proofs.h"
#include "setup/link_tables.h"
#include "setup/margins.h"
#include "setup/mover_rows.h"
#include "setup/registry.h"
#include "setup/tube.h"

namespace fcl_artic {

class Setup {
 public:
  void robotChanged() { robot_ready_ = ready_ = false; }  ///< links, or what is allowed
  void obstaclesChanged() { ready_ = false; }
  void tolerancesChanged() { ready_ = false; }
  void marginsChanged() { tables_ready_ = ready_ = false; }
  /// From now on build() makes trees of oriented boxes, which else come when they are first asked for.
  void prepareObbTrees() {
    obb_trees_ = true;
    ready_ = false;
  }
  bool ready() const { return ready_; }
  /// Whether it was made for the tree as the tree is now: its owner may have added a joint.
  bool isOf(const KinematicTree& tree) const { return tree_.sameAs(tree.content()); }

  /// Makes all of the registry's changes effective.
  void build(const Registry& registry);
  using IsChecked = std::function<bool(const ManagedBody&, const ManagedBody&)>;
  /// Makes the robot's links only, and the pairs of two links that are asked for, allowed ones too: for those who look
  /// at pairs of links. Attached objects and empty geometries make no pair.
  /// @param asked  of two geometries on different links.
  void buildPairs(const Registry& registry, const IsChecked& asked);
  /// Whether what depends on the robot alone is up to date.
  bool robotReady(const KinematicTree& tree) const { return robot_ready_ && isOf(tree); }

  /// The problem as the engine sees it.
  engine::Problem problem() const;
  /// Margins of all of the problem's pairs.
  const PairMargins& margins() const { return margins_; }
  /// Margins of neighbours that the rule has checked for touching; of no other pairs.
  const PairMargins& marginsOfNeighbours() const { return margins_of_neighbours_; }
  /// Number of the problem's link pairs, from the first on, that are two links; the others are moving obstacles and
  /// links.
  std::int32_t numSelfPairs() const { return static_cast<std::int32_t>(num_self_pairs_); }
  /// The same of its rows of movers.
  std::int32_t numSelfRows() const { return static_cast<std::int32_t>(link_movers_.num_self_rows); }
  /// How far variables stray, for those who look at ranges of them.
  /// @param factor  times which tolerances count; 0: nothing strays.
  VariableStrays variableStrays(double factor) const {
    const std::vector<double>& of = strays_.of_robot.of_variable;
    return {of.empty() || factor == 0 ? nullptr : of.data(), factor};
  }
  /// Tolerances of the joints, in the tree's order; empty: none strays.
  const std::vector<JointTolerance>& jointTolerances() const { return strays_.of_robot.of_joint; }
  /// Whether the robot or an obstacle strays.
  bool strays() const { return strays_.any; }
  /// Whether an obstacle with a motion, or with a speed, may be earlier or later.
  bool lags() const { return strays_.lags; }
  /// Whether an object moves by itself (ObjectSpeed).
  bool moves() const { return strays_.moves; }
  const LinkTables& tables() const { return *tables_; }
  const ProvenPairs& proven() const { return proven_; }
  /// Variables of the moving obstacles' motions, column k for t^k. A query's own come before them.
  const Eigen::MatrixXd& movingCoefficients() const { return moving_coefficients_; }

 private:
  // setup_robot.cpp: what depends on the links, and on what is allowed between them.
  void buildRobot(const Registry& registry);
  std::vector<Carrier> buildLinks(const Registry& registry);
  void buildSelfPairs(const Registry& registry, const std::vector<Carrier>& carriers, const IsChecked& checked);
  void listMovers();
  void setStrays(const Registry& registry);
  double strayOf(const engine::LinkPair& pair) const;
  void readSolids(const Registry& registry);
  // setup_scene.cpp: what depends on the obstacles.
  void buildScene(const Registry& registry);
  void buildMoving(const Registry& registry);
  void buildObstacles(const Registry& registry);
  void allowScenePairs(const Registry& registry);

  /// The obstacles that stand still.
  struct StillObstacles {
    std::vector<std::int32_t> bodies;
    std::vector<engine::WideNode> tree;
    std::vector<engine::StillBounds> bounds;
    std::vector<std::uint8_t> allowed;  ///< empty when all pairs of link and obstacle are checked
    std::int32_t num_allowed = 0;
  };

  bool obb_trees_ = false;
  std::vector<FrameSweep> sweeps_;  ///< of the links first, then one from each moving obstacle
  std::vector<engine::SweepView> sweep_views_;
  std::vector<engine::Body> bodies_;  ///< as the registry's: links, moving obstacles, the others
  std::vector<std::int32_t> movers_;
  std::vector<engine::LinkPair> link_pairs_;  ///< of two links first, then of moving obstacles and links
  PairMovers link_movers_;
  std::size_t num_links_ = 0, num_link_sweeps_ = 0, num_self_pairs_ = 0;
  StillObstacles still_;
  std::vector<engine::BoundedSource> sources_;  ///< of moving obstacles' bounded motions
  Eigen::MatrixXd moving_coefficients_;
  struct Strays {
    TreeStrays of_robot;
    engine::BaseStray base;
    engine::LargestStrays largest;
    bool any = false, moves = false, lags = false;
  };
  Strays strays_;
  PairMargins margins_, margins_of_neighbours_;
  ProvenPairs proven_;
  std::shared_ptr<const LinkTables> tables_ =
      std::make_shared<LinkTables>();  ///< constant: set-ups of one robot share them
  Fingerprint tree_;                   ///< of what buildRobot() was made for
  bool solids_ = false;                ///< a mesh that is a solid is among the bodies
  bool robot_ready_ = false;           ///< what buildRobot() makes is up to date
  bool tables_ready_ = false;          ///< so are the tables of two links
  bool ready_ = false;                 ///< all is
};

}  // namespace fcl_artic
