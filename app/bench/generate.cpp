// SPDX-License-Identifier: BSD-3-Clause
#include "bench/generate.h"

#include <cstdint>
#include <memory>
#include <string>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "edges/generate_edges.h"
#include "exit_status.h"
#include "generator.h"

namespace fcl_artic::app {

void addGenerate(CLI::App& program, int& exit_status) {
  CLI::App* generate = program.add_subcommand("generate", "Write a robot or a scene to try things on");
  generate->require_subcommand(1);
  generate->footer("Exit status: 0 it is written, 2 error.");

  auto folder = std::make_shared<std::string>();
  CLI::App* puma = generate->add_subcommand("puma560", "A PUMA 560 arm: URDF and link meshes");
  puma->add_option("DIR", *folder, "Folder to write to; made when it is not there")->required();
  puma->callback([folder, &exit_status] {
    generator::writePuma560(*folder);
    fmt::print("puma560 written to {}\n", *folder);
    exit_status = kExitFree;
  });

  struct Pipes {
    std::size_t triangles = 10000;
    std::uint64_t seed = 1;
    std::string path;
  };
  auto pipes = std::make_shared<Pipes>();
  CLI::App* verb = generate->add_subcommand("pipes", "A scene of pipes, as a triangle mesh");
  verb->add_option("--triangles", pipes->triangles, "Triangles wanted")->capture_default_str();
  verb->add_option("--seed", pipes->seed, "The same seed gives the same scene")->capture_default_str();
  verb->add_option("OUT.obj", pipes->path, "File to write")->required();
  verb->callback([pipes, &exit_status] {
    generator::writePipes(pipes->triangles, pipes->seed, pipes->path);
    fmt::print("pipes written to {}\n", pipes->path);
    exit_status = kExitFree;
  });
  addGenerateEdges(*generate, exit_status);
}

}  // namespace fcl_artic::app
