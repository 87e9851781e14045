// SPDX-License-Identifier: BSD-3-Clause
// The program bench_tables: tables of the documents, measured anew.
#include "program.h"
#include "tables.h"

int main(int argc, char** argv) {
  using namespace fcl_artic::app;
  return runProgram(argc, argv, [](CLI::App& program, int& exit_status) {
    addTable1(program, exit_status);
    addIdeas(program, exit_status);
    addCompare(program, exit_status);
#ifdef FCL_ARTIC_HAS_PLANS
    addPlanning(program, exit_status);
    addCertifyPlans(program, exit_status);
    addRigid(program, exit_status);
#endif
  });
}
