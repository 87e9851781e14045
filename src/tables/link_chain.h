// SPDX-License-Identifier: BSD-3-Clause
//
// Two links and the joints between them, without the rest of their robot. A chain holds the engine's problem
// of this one pair, the whole ranges of its variables, and points that bound both bodies. RangeProof searches these
// ranges.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "fcl_artic/kinematic_tree.h"
#include "model/problem.h"
#include "tables/value_range.h"

namespace fcl_artic {

/// The values of a variable that proofs for its whole range cover:
/// - its limits and a little more, as a joint may stand at a limit;
/// - for an angle without limits, all values;
/// - for a slide without limits, and for the variables of planar and floating joints, none (lower > upper).
ValueRange wholeRange(const KinematicTree& tree, int variable);

/// The kinematic chain from one link (A) to another one (B).
class LinkChain {
 public:
  /// The numbers of steps that are cut off at the ends of the chain. At each end a ball takes the place of these steps
  /// and of the link. Its middle is the origin of the cut step that is next to the rest. It holds the link for all
  /// values of these steps' variables (doc/NUMERICS.md, Lemma 10). A proof of the rest is easier: the bodies are
  /// larger, but the variables are fewer.
  struct Cut {
    std::size_t steps_at_a, steps_at_b;
  };
  /// Points and a radius that bound a body. The body lies in the hull of the first eight, and in the hull
  /// of the last two grown by the radius.
  struct Outline {
    Eigen::Matrix<double, 3, 10> points;
    double radius;

    /// Upper bounds, but for rounding, of the body's distance from the z axis of the frame that the points are in, and
    /// from the origin of that frame.
    double farthestFromAxis() const;
    double farthestFromOrigin() const;
  };

  /// @param problem, pair  must stay as they are as long as this lives.
  /// @param cut  one of cuts(); {0, 0}: the links themselves.
  LinkChain(const KinematicTree& tree, const engine::Problem& problem, const engine::LinkPair& pair, const Cut& cut);
  LinkChain(const LinkChain&) = delete;
  LinkChain& operator=(const LinkChain&) = delete;

  /// Whether the ranges of all variables are bounded, and all joints turn about or slide along an axis. If not, nothing
  /// can be proven, and nothing else but variables() may be asked for.
  bool bounded() const { return bounded_; }
  /// The tree's variables in the chain, each once, from A on.
  const std::vector<int>& variables() const { return variables_; }
  /// Cuts that leave less to prove, the fewest variables first; none where a mesh is a solid.
  std::vector<Cut> cuts() const;

  /// The steps from A on. SweepStep::variable is an index into variables().
  const std::vector<engine::SweepStep>& path() const { return path_; }
  /// Whether no other step is driven by this step's variable.
  bool drivesOneStep(const engine::SweepStep& step) const {
    return num_steps_[static_cast<std::size_t>(step.variable)] == 1;
  }
  /// The range of each variable.
  const std::vector<ValueRange>& ranges() const { return ranges_; }

  /// The engine's problem: one sweep and one pair.
  const engine::Problem& problem() const { return problem_; }
  const engine::LinkPair& pair() const { return pair_; }
  /// A in the base frame, before the first step; B in the last step's frame.
  const Outline& outlineA() const { return outline_a_; }
  const Outline& outlineB() const { return outline_b_; }
  /// m: bound on rounding in any pose of the chain.
  double pad() const { return pad_; }
  /// m: sum of the radii of the balls that stand for links. In problem() such a body is the ball's middle alone, so the
  /// caller adds this to each margin.
  double ballRadii() const { return ball_radii_; }

 private:
  static Outline outlineOf(const engine::Body& body);
  template <class RangeOf>
  void numberVariables(const RangeOf& rangeOf);
  void replaceByBalls(const Cut& cut);
  double maxStepValue(const engine::SweepStep& step) const;

  std::vector<engine::SweepStep> path_;
  engine::SweepView sweep_;
  engine::LinkPair pair_;
  engine::Problem problem_;
  engine::Body bodies_[2];  ///< the problem's, if a ball stands for one of them
  std::vector<int> variables_;
  std::vector<int> num_steps_;  ///< by variable: how many steps it drives
  std::vector<ValueRange> ranges_;
  bool bounded_ = true;
  double pad_ = 0, ball_radii_ = 0;
  Outline outline_a_, outline_b_;
};

}  // namespace fcl_artic
