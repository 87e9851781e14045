// SPDX-License-Identifier: BSD-3-Clause
// The program fcl_artic-edges, for many motions in many scenes: certify --edges, certify --merge, roadmap.
#include "edges/certify_verb.h"
#include "program.h"
#include "roadmap/roadmap_verb.h"

int main(int argc, char** argv) {
  using namespace fcl_artic::app;
  return runProgram(argc, argv, [](CLI::App& program, int& exit_status) {
    addCertifyEdges(program, exit_status);
    addRoadmap(program, exit_status);
  });
}
