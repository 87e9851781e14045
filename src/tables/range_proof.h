// SPDX-License-Identifier: BSD-3-Clause
//
// Two links over the whole ranges of all joint variables between them, however many: proven apart, or where they touch.
// The ranges are cut into boxes, as finely as it takes; the engine proves one box at a time (doc/NUMERICS.md,
// section 10, Lemmas 8 and 10).
#pragma once

#include <cstdint>
#include <vector>

#include "fcl_artic/kinematic_tree.h"
#include "model/problem.h"
#include "narrowphase/engine_workspace.h"
#include "tables/value_range.h"

namespace fcl_artic {

/// The values of a variable, as far as proofs for its whole range go. These are its limits and a little more, as
/// joints may stand at them; all values, where an angle has no limits. Nothing (lower > upper) for a variable without
/// bounds: a slide without limits, the variables of planar and floating joints.
ValueRange wholeRange(const KinematicTree& tree, int variable);

/// Two links and the joint variables between them.
class RangeProof {
 public:
  /// Steps at both ends of the path that are replaced, together with the links they carry, by a ball about the joint
  /// next to them. It holds the link for all values of these steps' variables (Lemma 10). Without them there is less to
  /// prove: fewer variables, of bodies that are larger.
  struct Cut {
    std::size_t of_a, of_b;
  };

  /// @param problem, pair  must stay as they are as long as this lives.
  /// @param margin  m, that the links are proven to keep.
  /// @param workspace  of this thread.
  /// @param cut  one of cuts(): all below is of the balls then. If the balls are proven apart, so are the links.
  RangeProof(const KinematicTree& tree, const engine::Problem& problem, const engine::LinkPair& pair, double margin,
             engine::EngineWorkspace& workspace, const Cut& cut = {0, 0});
  RangeProof(const RangeProof&) = delete;
  RangeProof& operator=(const RangeProof&) = delete;

  /// Whether the ranges of all variables between the links are bounded, and their joints turn about or slide along an
  /// axis. If not, nothing can be proven.
  bool bounded() const { return bounded_; }
  /// The variables between the links, each once, from the first link on.
  const std::vector<int>& variables() const { return variables_; }
  /// Cuts that leave less to prove, the fewest variables first; none where a mesh is a solid.
  std::vector<Cut> cuts() const;

  /// The certain state of the links where the variables have given values.
  enum class Contact : std::uint8_t {
    none,     ///< more than the margin apart
    touch,    ///< in contact, or nearer than the margin
    unknown,  ///< too near to decide
  };
  /// @param margin  m, in place of the one that is proven.
  Contact at(const std::vector<double>& values, double margin);

  /// Goes from one configuration to others in which the links are nearer, as long as that gets on.
  /// @param within  what each variable may be; finite.
  /// @param margin  m: links that come nearer count as touching.
  /// @param[in,out] values  of each variable.
  /// @return at the new values: the margin, if the links certainly touch; else an upper bound of their distance, m,
  /// more than the margin; infinite, where none is known.
  double comeNearer(const std::vector<ValueRange>& within, double margin, std::vector<double>& values);

  struct Finding {
    bool apart = false;          ///< proven, for all values in the ranges
    std::uint64_t work = 0;      ///< tests of nodes and leaves, and kQueryWork for each query
    std::vector<double> values;  ///< not apart: where the proof failed, a value of each variable
  };
  /// Proves the links apart over the whole ranges, with `work` at most; or gives up.
  Finding prove(std::uint64_t work);

  /// Work of a query before its first test, in tests of nodes and leaves.
  static constexpr std::uint64_t kQueryWork = 40;

 private:
  /// Points about a body and, of the last two, a radius. The body lies in the hull of the first eight, and in the hull
  /// of the last two grown by the radius.
  struct Outline {
    Eigen::Matrix<double, 3, 10> points;
    double radius;
  };
  /// Ranges of all variables between the links. A proof of a box is one for all values in it.
  using Box = std::vector<ValueRange>;
  /// The outcome of trying a box.
  struct Tried {
    bool apart = false, give_up = false, out_of_work = false;
    std::size_t split = 0;      ///< else: the variable to halve
    std::vector<double> where;  ///< not apart: where on the engine's way, if it was asked
  };

  /// A step's own motion, along and about z: of points after it, as seen from before it.
  struct Joint {
    double sine = 0, cosine = 1, slide = 0;

    void set(const engine::SweepStep& step, double variable);
    Joint inverse() const { return {-sine, cosine, -slide}; }
    template <class Points>
    void apply(Points& points) const;
  };

  /// Points of both bodies, A's in the base frame and B's in the last step's, that were found near each other: they
  /// show at once that a box can't be proven. (A guess only spares work: nothing is proven with them.)
  struct Witness {
    Eigen::Vector3d a, b;
    Eigen::Vector3d normal;  ///< from b to a where they were found, in the base frame; of length 0 or 1
    double distance;         ///< of the two, there, less the balls' radii
  };

  static Outline outlineOf(const engine::Body& body);
  static double farthestFromAxis(const Outline& outline);
  static double farthestFromOrigin(const Outline& outline);
  void standIn(const Cut& cut);
  double mostOf(const engine::SweepStep& step) const;
  void measureWays(const Box& box);
  Tried tryBox(const Box& box, std::uint64_t work);
  void solve();
  /// The value of a variable in the motion asked last.
  double valueAt(std::size_t variable, double t) const {
    return coefficients_[variable] + t * coefficients_[variables_.size() + variable];
  }
  bool findWitness(Witness& witness);
  void addWitness();
  bool mustFail(const Box& box, std::size_t moved, double margin) const;

  engine::EngineWorkspace& workspace_;
  std::vector<engine::SweepStep> path_;  ///< from the first link on; the variables are numbers among variables_
  engine::SweepView sweep_;
  engine::LinkPair pair_;
  engine::Problem problem_;
  engine::Body bodies_[2];  ///< where a ball stands for one of them: the problem's
  engine::Query query_;
  engine::Answer answer_;
  std::vector<int> variables_;
  std::vector<int> steps_of_;  ///< by variable: how many steps it drives
  Box whole_;
  bool bounded_ = true;
  double margin_, pad_ = 0;
  double balls_ = 0;           ///< radii of both balls that stand for links; the bodies are their middles
  Outline of_a_, of_b_;        ///< in the base frame, and in the last step's
  std::vector<Joint> middle_;  ///< per step, of the box measured last: where it stands in the middle
  /// Per step, of the box measured last: how far a point goes at most when the step leaves the middle of its range.
  /// One is of A as seen from B, one of B as seen from A.
  std::vector<double> way_of_a_, way_of_b_;
  std::vector<double> coefficients_;
  std::uint64_t work_ = 0;
  static constexpr std::size_t kMostWitnesses = 8;
  std::vector<Witness> witnesses_;
  std::size_t next_witness_ = 0;
};

}  // namespace fcl_artic
