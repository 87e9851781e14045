// SPDX-License-Identifier: BSD-3-Clause
//
// Questions of planners, in all four rounding modes.
#include <cmath>

#include <fcl/geometry/shape/box.h>
#include <gtest/gtest.h>
#include <ompl/base/spaces/SE2StateSpace.h>
#include <ompl/base/spaces/SE3StateSpace.h>
#include <ompl/base/spaces/SO2StateSpace.h>

#include "all_modes.h"
#include "fcl_artic/ompl/motion_validator.h"
#include "fcl_artic/ompl/planning_setup.h"
#include "slide.h"

namespace fcl_artic::planning {
namespace rounding_modes_test {
namespace {

using premises_test::Said;

/// The last valid state lies before the first contact by up to three times the tolerance of time.
void expectSameInAllModes(const std::string& name, const std::function<void(Said&)>& entry) {
  premises_test::expectSameInAllModes(name, entry, 3 * planningRequest().tolerance_time);
}

/// Motions between all of these states, whether each is valid, and how far those go that meet something.
void addAll(const ::ompl::base::SpaceInformationPtr& si, const std::vector<std::vector<double>>& states, Said& said) {
  const auto& space = si->getStateSpace();
  for (const auto& from : states) {
    const TestState s1(space, from), last(space, from);
    said.words << si->isValid(s1) << ": ";
    for (const auto& to : states) {
      const TestState s2(space, to);
      std::pair<::ompl::base::State*, double> until{last, 2};
      said.words << si->checkMotion(s1, s2) << si->checkMotion(s1, s2, until) << ' ';
      said.add(until.second);
    }
  }
}

void addWorld(const World& world, const ::ompl::base::StateSpacePtr& space,
              const std::vector<std::vector<double>>& states, Said& said) {
  for (const bool ignore : {false, true}) {
    CertifiedRequest request = planningRequest();
    request.ignore_initial_contact = ignore;
    const auto si = std::make_shared<::ompl::base::SpaceInformation>(space);
    si->setMotionValidator(std::make_shared<ContinuousMotionValidator>(si, world.manager(), request));
    si->setStateValidityChecker(std::make_shared<CollisionStateValidityChecker>(si, world.manager(), request));
    si->setup();
    addAll(si, states, said);
  }
}

TEST(RoundingModesOfPlanners, ASlideAndAWheel) {
  expectSameInAllModes("a slide", [](Said& said) {
    addWorld(slideWorld(), reals(1), {{0}, {1.9}, {3.1}, {5}, {9.7}}, said);
  });
  expectSameInAllModes("a wheel", [](Said& said) {
    addWorld(turnWorld(JointType::continuous, 3), std::make_shared<::ompl::base::SO2StateSpace>(),
             {{-3.1}, {-2.5}, {0}, {0.6}, {2.7}, {3}}, said);
  });
}

TEST(RoundingModesOfPlanners, ABodyInThePlaneAndInSpace) {
  const auto body = std::make_shared<fcl::Boxd>(0.7, 0.2, 0.1);
  Scene scene;
  scene.obstacles.push_back(
      {"post", std::make_shared<fcl::CollisionObjectd>(std::make_shared<fcl::Boxd>(0.2, 0.3, 2), at(1, 0.1))});
  SetupOptions options;
  options.position_lower = {-3, -3, -3};
  options.position_upper = {3, 3, 3};
  expectSameInAllModes("in the plane", [&](Said& said) {
    const PlanningSetup setup = setUpRigidBody(body, scene, options, JointType::planar);
    addAll(setup.si, {{0, 0, 0.1}, {2, 0.3, 3.1}, {0.1, 1, -3.1}, {1, 0.1, 0}}, said);
  });
  expectSameInAllModes("in space", [&](Said& said) {
    const PlanningSetup setup = setUpRigidBody(body, scene, options);
    const std::vector<double> values = {0.3, 0.1, 0.2, 0.1, 0.7, -0.1, 0.7};
    const TestState state(setup.space, values);
    setup.setState(state, values);
    for (const double x : setup.values(state)) said.add(x);
    addAll(setup.si,
           {{0, 0, 0, 0, 0, 0, 1}, {2, 0.3, 0, 0, 0, 1, 0}, {0, 1, 0, 0.6, 0, 0.8, 0}, {1, 0.1, 0, 0, 0, 0, 1}}, said);
  });
}

}  // namespace
}  // namespace rounding_modes_test
}  // namespace fcl_artic::planning
