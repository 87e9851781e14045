// SPDX-License-Identifier: BSD-3-Clause
#include "other_programs.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "exit_status.h"

namespace fcl_artic::app {
namespace {

constexpr const char* kBench = "fcl_artic-bench";
constexpr const char* kEdges = "fcl_artic-edges";

struct OtherVerb {
  const char* name;
  const char* program;
  const char* description;
};
constexpr OtherVerb kOtherVerbs[] = {
    {"roadmap", kEdges, "A probabilistic roadmap of a robot: made once, proven free again in each new scene"},
    {"bench", kBench, "Benchmarks on one's own machine"},
    {"generate", kBench, "Write a robot or a scene to try things on"},
};

/// The program that has the verb, nullptr: this one. `certify` is in two: of plans here, of many edges there.
const char* programOf(int argc, char** argv) {
  if (argc < 2) return nullptr;
  const std::string_view verb = argv[1];
  for (const OtherVerb& other : kOtherVerbs) {
    if (verb == other.name) return other.program;
  }
  if (verb != "certify") return nullptr;
  for (int i = 2; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (word == "--edges" || word == "--merge" || word.substr(0, 8) == "--edges=") return kEdges;
  }
  return nullptr;
}

}  // namespace

std::optional<int> runOtherProgram(int argc, char** argv) {
  const char* name = programOf(argc, argv);
  if (!name) return std::nullopt;
  std::error_code error;
  const std::string program = (std::filesystem::read_symlink("/proc/self/exe", error).parent_path() / name).string();
  execv(program.c_str(), argv);
  fmt::print(stderr, "fcl_artic: error: '{}' needs the program {}, which can't be run: {}: {}\n", argv[1], name,
             program, std::strerror(errno));
  return kExitError;
}

void describeOtherPrograms(CLI::App& program) {
  for (const OtherVerb& other : kOtherVerbs) program.add_subcommand(other.name, other.description);
}

}  // namespace fcl_artic::app
