// SPDX-License-Identifier: BSD-3-Clause
// The program fcl_artic: check, certify, srdf, info. It runs other verbs as programs of their own.
#include "certify.h"
#include "check.h"
#include "info.h"
#include "link_pairs.h"
#include "other_programs.h"
#include "program.h"

int main(int argc, char** argv) {
  using namespace fcl_artic::app;
  if (const auto exit_status = runOtherProgram(argc, argv)) return *exit_status;
  return runProgram(argc, argv, [](CLI::App& program, int& exit_status) {
    addCheck(program, exit_status);
    addCertify(program, exit_status);
    addSrdf(program, exit_status);
    addInfo(program, exit_status);
    describeOtherPrograms(program);
  });
}
