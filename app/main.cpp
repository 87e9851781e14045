// SPDX-License-Identifier: BSD-3-Clause
// The program fcl_artic: verbs in files of their own, errors in one place.
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "bench.h"
#include "certify.h"
#include "check.h"
#include "compare.h"
#include "exit_status.h"
#include "fcl_artic/instruction_set.h"
#include "files/files.h"
#include "generate.h"
#include "info.h"
#include "link_pairs.h"
#include "roadmap/roadmap_verb.h"
#include "usage.h"

int main(int argc, char** argv) {
  using namespace fcl_artic::app;
  CLI::App program("Certified continuous collision detection for articulated robots.", "fcl_artic");
  program.set_version_flag(
      "--version", fmt::format("fcl_artic {}\ninstruction set: {}", FCL_ARTIC_VERSION, fcl_artic::instructionSet()));
  program.require_subcommand(1);
  program.get_formatter()->column_width(34);
  int exit_status = kExitError;
  addBench(program, exit_status);
  addCertify(program, exit_status);
  addCheck(program, exit_status);
  addCompare(program, exit_status);
  addGenerate(program, exit_status);
  addSrdf(program, exit_status);
  addInfo(program, exit_status);
  addRoadmap(program, exit_status);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    exit_status = error.get_exit_code() == 0 ? program.exit(error) : kExitError;  // help and version are no errors
    if (exit_status) {
      fmt::print(stderr, "fcl_artic: error: {}\nRun with --help for more information.\n", usageError(program, error));
    }
  } catch (const std::exception& error) {
    // (What can't be printed is reported below.)
    if (!std::ferror(stdout)) fmt::print(stderr, "fcl_artic: error: {}\n", error.what());
    exit_status = kExitError;
  }
  try {
    fcl_artic::files::flushStandardOutput();
  } catch (const std::exception& error) {
    fmt::print(stderr, "fcl_artic: error: {}\n", error.what());
    exit_status = kExitError;
  }
  return exit_status;
}
