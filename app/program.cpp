// SPDX-License-Identifier: BSD-3-Clause
#include "program.h"

#include <csignal>
#include <cstdio>
#include <exception>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "exit_status.h"
#include "fcl_artic/instruction_set.h"
#include "files/files.h"
#include "usage.h"

namespace fcl_artic::app {

int runProgram(int argc, char** argv, const std::function<void(CLI::App& program, int& exit_status)>& add_verbs) {
  CLI::App program("Certified continuous collision detection for articulated robots.", "fcl_artic");
  program.set_version_flag("--version",
                           fmt::format("fcl_artic {}\ninstruction set: {}", FCL_ARTIC_VERSION, instructionSet()));
  program.require_subcommand(1);
  program.get_formatter()->column_width(34);
  int exit_status = kExitError;
  std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is an error that names it
  add_verbs(program, exit_status);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    exit_status = error.get_exit_code() == 0 ? program.exit(error) : kExitError;  // help and version are no errors
    if (exit_status) {
      fmt::print(stderr, "fcl_artic: error: {}\nRun with --help for more information.\n", usageError(program, error));
    }
  } catch (const std::exception& error) {
    // (An error of printing is reported below.)
    if (!std::ferror(stdout)) fmt::print(stderr, "fcl_artic: error: {}\n", error.what());
    exit_status = kExitError;
  }
  try {
    files::flushStandardOutput();
  } catch (const std::exception& error) {
    fmt::print(stderr, "fcl_artic: error: {}\n", error.what());
    exit_status = kExitError;
  }
  return exit_status;
}

}  // namespace fcl_artic::app
