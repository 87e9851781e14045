// SPDX-License-Identifier: BSD-3-Clause
//
// Two links and the joints between them, apart from the robot that they belong to. A chain holds the engine's problem
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

/// The values of a variable, as far as proofs for its whole range go. These are its limits and a little more, as
/// joints may stand at them; all values, where an angle has no limits. Nothing (lower > upper) for a variable without
/// bounds: a slide without limits, the variables of planar and floating joints.
ValueRange wholeRange(const KinematicTree& tree, int variable);

/// The kinematic chain from one link (A) to another one (B).
class LinkChain {
 public:
  /// Steps at both ends of the chain that are replaced, together with the links they carry, by a ball about the joint
  /// next to them. It holds the link for all values of these steps' variables (doc/NUMERICS.md, Lemma 10). Without them
  /// there is less to prove: fewer variables, of bodies that are larger.
  struct Cut {
    std::size_t steps_at_a, steps_at_b;
  };
  /// Points about a body and, of the last two, a radius. The body lies in the hull of the first eight, and in the hull
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
  /// can be proven, and nothing else may be asked for but variables(), which are none then.
  bool bounded() const { return bounded_; }
  /// The tree's variables in the chain, each once, from A on.
  const std::vector<int>& variables() const { return variables_; }
  /// Cuts that leave less to prove, the fewest variables first; none where a mesh is a solid.
  std::vector<Cut> cuts() const;

  /// From A on; SweepStep::variable counts in variables().
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
  /// m: rounding in any pose of the chain.
  double pad() const { return pad_; }
  /// m: the radii of both balls that stand for links, whose bodies are the balls' middles. It is added to each margin.
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
  engine::Body bodies_[2];  ///< where a ball stands for one of them: the problem's
  std::vector<int> variables_;
  std::vector<int> num_steps_;  ///< by variable: how many steps it drives
  std::vector<ValueRange> ranges_;
  bool bounded_ = true;
  double pad_ = 0, ball_radii_ = 0;
  Outline outline_a_, outline_b_;
};

}  // namespace fcl_artic
