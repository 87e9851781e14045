// SPDX-License-Identifier: BSD-3-Clause
//
// Plans by OMPL's RRTConnect with one motion validator or another, and a close look at them. (Needs OMPL.)
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include <ompl/base/MotionValidator.h>
#include <ompl/base/SpaceInformation.h>

#include "fcl_artic/ompl/planning_setup.h"
#include "planning/problems.h"

namespace fcl_artic::planning_data {

/// A path as joint values, in the order of PlanningSetup::joints.
using Way = std::vector<std::vector<double>>;

struct Plans {
  bool solved = false;
  Way raw, simplified;
  double plan_ms = 0, simplify_ms = 0;
};

/// RRTConnect, then simplification, with OMPL's defaults.
/// @param setup  of the space that `si` is made for, or of one just like it.
/// @param seconds  at most, for each of the two.
/// @param range  longest motion that the planner tries, in the space's distance; 0: OMPL's default, a fifth of its
///   extent.
Plans plan(const ompl::base::SpaceInformationPtr& si, const planning::PlanningSetup& setup,
           const std::vector<double>& start, const std::vector<double>& goal, unsigned seed, double seconds,
           double range = 0);

/// Looks at a way in steps of 1/100 of OMPL's default resolution (1 % of the space's extent).
/// @return number of the first sample that collides, -1 for none.
long firstSample(const planning::PlanningSetup& setup, const Way& way,
                 const std::function<bool(const std::vector<double>&)>& collides);

/// A problem with our validator and state check.
planning::PlanningSetup setUp(const Robot& robot, const Environment& environment, const Problem& problem);

/// The same problem for OMPL's own discrete validator over FCL's check of a state. One thread at a time. Robot and
/// environment must outlive it.
/// @param resolution  part of the space's extent; OMPL's default is 0.01.
ompl::base::SpaceInformationPtr discreteOverFcl(const Robot& robot, const Environment& environment,
                                                const Problem& problem, double resolution);

/// Passes every question on, and takes its time. One thread at a time.
class TimedMotionValidator : public ompl::base::MotionValidator {
 public:
  /// Takes the place of the space's own validator.
  static std::shared_ptr<TimedMotionValidator> wrap(const ompl::base::SpaceInformationPtr& si);

  bool checkMotion(const ompl::base::State* s1, const ompl::base::State* s2) const override;
  bool checkMotion(const ompl::base::State* s1, const ompl::base::State* s2,
                   std::pair<ompl::base::State*, double>& lastValid) const override;

  /// Times of the motions called valid, and of the others, us.
  mutable std::vector<double> valid_us, invalid_us;

 private:
  explicit TimedMotionValidator(const ompl::base::SpaceInformationPtr& si)
      : MotionValidator(si.get()), inner_(si->getMotionValidator()) {}
  template <class Ask>
  bool timed(const Ask& ask) const;
  ompl::base::MotionValidatorPtr inner_;
};

}  // namespace fcl_artic::planning_data
