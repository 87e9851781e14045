// SPDX-License-Identifier: BSD-3-Clause
//
// Proves two links apart for all values of the joint variables between them, however many, or finds values at which the
// proof fails. The variables' ranges are cut into boxes, as finely as the proof needs; the engine proves one box at a
// time (doc/NUMERICS.md, section 10, Lemmas 8 and 10).
#pragma once

#include <cstdint>
#include <vector>

#include "model/answer.h"
#include "model/query.h"
#include "narrowphase/engine_workspace.h"
#include "tables/link_chain.h"

namespace fcl_artic {

/// The search over boxes of joint values, of two links.
class RangeProof {
 public:
  using Cut = LinkChain::Cut;

  /// @param problem, pair  must stay as they are as long as this lives.
  /// @param margin  m, that the links are proven to keep.
  /// @param workspace  of this thread.
  /// @param cut  one of cuts(): all functions below are about the links as it leaves them, of which balls replace one
  /// or both. If these are proven apart, so are the links.
  RangeProof(const KinematicTree& tree, const engine::Problem& problem, const engine::LinkPair& pair, double margin,
             engine::EngineWorkspace& workspace, const Cut& cut = {0, 0});
  RangeProof(const RangeProof&) = delete;
  RangeProof& operator=(const RangeProof&) = delete;

  // As LinkChain's.
  bool bounded() const { return chain_.bounded(); }
  const std::vector<int>& variables() const { return chain_.variables(); }
  std::vector<Cut> cuts() const { return chain_.cuts(); }

  /// The state of the links at given values of the variables, as far as it is proven.
  enum class Contact : std::uint8_t {
    none,     ///< more than the margin apart
    touch,    ///< in contact, or nearer than the margin
    unknown,  ///< too near to decide
  };
  /// @param margin  m, in place of the constructor's.
  Contact at(const std::vector<double>& values, double margin);

  /// Goes from one configuration to others in which the links are nearer, until a step gains little.
  /// @param within  the range in which each variable stays; finite.
  /// @param margin  m: links that come nearer count as touching.
  /// @param[in,out] values  of each variable.
  /// @return m, at the new values: `margin`, if the links certainly touch; else an upper bound of their distance, more
  /// than `margin`, or infinity if none is known.
  double comeNearer(const std::vector<ValueRange>& within, double margin, std::vector<double>& values);

  struct Result {
    bool apart = false;          ///< proven, for all values in the ranges
    std::uint64_t work = 0;      ///< tests of nodes and leaves, and kQueryWork for each query
    std::vector<double> values;  ///< not apart: a value of each variable, where the proof failed
  };
  /// Proves the links apart over the whole ranges, with `work` at most; or gives up.
  Result prove(std::uint64_t work);

  /// Work of a query before its first test, in tests of nodes and leaves.
  static constexpr std::uint64_t kQueryWork = 40;

 private:
  /// Ranges of all variables between the links. A proof of a box is one for all values in it.
  using Box = std::vector<ValueRange>;
  struct BoxResult {
    bool apart = false, give_up = false, out_of_work = false;
    std::size_t split = 0;      ///< none of these: the variable to halve
    std::vector<double> where;  ///< not apart: values on the engine's motion, if the engine was asked
  };

  /// A step's own motion, along and about z. It takes coordinates in the frame after the motion to those before it.
  struct StepPose {
    double sine = 0, cosine = 1, slide = 0;

    void set(const engine::SweepStep& step, double variable);
    StepPose inverse() const { return {-sine, cosine, -slide}; }
    template <class Points>
    void apply(Points& points) const;
  };

  /// A point of each body, A's in the base frame and B's in the last step's. They were found near each other. If they
  /// come as near in a box, it likely can't be proven, and the engine is not asked. (That is a guess, which only spares
  /// work: nothing is proven with them.)
  struct Witness {
    Eigen::Vector3d a, b;
    Eigen::Vector3d normal;  ///< from b to a where they were found, in the base frame; of length 0 or 1
    double distance;         ///< m, of the two where they were found, less the balls' radii
  };

  void boundDisplacements(const Box& box);
  BoxResult tryBox(const Box& box, std::uint64_t work);
  void solve();
  /// The value of a variable at time t of the motion that the engine was asked about last.
  double valueAt(std::size_t variable, double t) const {
    return coefficients_[variable] + t * coefficients_[variables().size() + variable];
  }
  bool findWitness(Witness& witness);
  void addWitness();
  bool likelyFails(const Box& box, std::size_t moved, double margin) const;

  engine::EngineWorkspace& workspace_;
  const LinkChain chain_;
  const double margin_;
  engine::Query query_;
  engine::Answer answer_;
  std::vector<double> coefficients_;    ///< of the motion asked for
  std::uint64_t work_ = 0;              ///< so far, as Result::work
  std::vector<StepPose> middle_poses_;  ///< by step: in the middle of the box measured last
  /// By step, of the box measured last, m: how far a point goes at most when the step leaves the middle of its range.
  /// displacement_a_ is of points of A as seen from B, displacement_b_ of points of B as seen from A.
  std::vector<double> displacement_a_, displacement_b_;
  static constexpr std::size_t kMaxWitnesses = 8;  ///< the newest are kept
  std::vector<Witness> witnesses_;
  std::size_t next_witness_ = 0;
};

}  // namespace fcl_artic
