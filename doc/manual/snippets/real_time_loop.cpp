// SPDX-License-Identifier: BSD-3-Clause
// A loop that asks 1,000 times without allocating: status 0 if that is so and the answers are right.
#include <atomic>
#include <cstdlib>
#include <iostream>
#include <new>

#include <fcl_artic/fcl_artic.h>
#include <fcl_artic/urdf/urdf.h>

static std::atomic<long> allocations{0};

void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}

int main() {
  using namespace fcl_artic;
  const Robot robot = loadUrdf("data/puma560/puma560.urdf");
  ArticulatedCollisionManager manager(robot.tree);
  robot.addTo(manager);
  loadScene("data/pipes.obj").addTo(manager);
  manager.setup();
  Eigen::VectorXd start(6), towards(6);
  start << -2.1, 1.0, -1.0, -0.1, -0.1, 0.0;
  towards << -0.1, 0.3, -2.3, -1.0, 1.1, 0.0;

  // [before]
  CertifiedRequest request;
  request.mode = ContactMode::any;  // the verdict is enough
  request.work_budget = 20000;      // tests; a query that needs more is undecided
  CertifiedResult result;           // its memory is used again
  const JointMotion motion = JointMotion::linear(*robot.tree, start, towards);
  manager.continuousCollide(motion, request, result);  // warms up, with a contact
  // [before ends]

  int stops = 0;
  const long before = allocations;
  for (int cycle = 0; cycle < 1000; ++cycle) {
    // [cycle]
    manager.continuousCollide(motion, request, result);
    if (!result.isFree()) ++stops;  // contact or undecided: stop before result.t_lower
    // [cycle ends]
  }
  const long made = allocations - before;
  std::cout << made << " allocations, " << stops << " of 1000 cycles stop\n";
  return made == 0 && before > 0 && stops == 1000 ? 0 : 1;
}
