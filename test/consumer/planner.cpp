// SPDX-License-Identifier: BSD-3-Clause
// A motion of the installed robot through OMPL's SpaceInformation: exit status 0 when the answers are right.
#include <exception>
#include <iostream>
#include <string>

#include <fcl_artic/ompl/planning_setup.h>
#include <ompl/base/ScopedState.h>

int main(int, char** argv) try {
  using namespace fcl_artic;
  const std::string data = argv[1];
  const Robot robot = loadUrdf(data + "/puma560/puma560.urdf");
  const Scene scene = loadScene(data + "/pipes.obj");
  const auto manager = std::make_shared<ArticulatedCollisionManager>(robot.tree);
  robot.addTo(*manager);
  scene.addTo(*manager);
  manager->setup();
  const planning::PlanningSetup setup = planning::setUpPlanning(manager, {});

  ompl::base::ScopedState<> from(setup.space), free(setup.space), hit(setup.space);
  setup.setState(from.get(), {-2.1, 1, -1, -0.1, -0.1, 0});
  setup.setState(free.get(), {0.9, 0.4, -2, 0, 0.2, 0});
  setup.setState(hit.get(), {-0.1, 0.3, -2.3, -1, 1.1, 0});
  const bool right = setup.si->isValid(from.get()) && setup.si->checkMotion(from.get(), free.get()) &&
                     !setup.si->checkMotion(from.get(), hit.get());
  std::cout << (right ? "right" : "wrong") << '\n';
  return right ? 0 : 1;
} catch (const std::exception& e) {
  std::cerr << e.what() << '\n';
  return 2;
}
