// SPDX-License-Identifier: BSD-3-Clause
#include "edges/certify_verb.h"

#include <memory>

#include <CLI/CLI.hpp>

#include "edges/certify_edges.h"
#include "outputs.h"
#include "plan_variables.h"
#include "query_options.h"
#include "usage.h"

namespace fcl_artic::app {
namespace {

struct EdgesVerb {
  WorldOptions world;
  EdgesOptions edges;
  PlanVariables variables;
  bool merge = false, any = false, json = false;
};

int runCertifyEdges(EdgesVerb& o) {
  if (o.edges.out.empty()) throw CLI::RequiredError("--out DIR, the folder of the run's blocks,");
  if (o.merge) return mergeEdges(o.edges.out, o.edges.partial, o.json);
  if (o.edges.edges.empty()) throw CLI::RequiredError("--edges or --merge");
  if (o.world.robot.robot.empty()) throw CLI::RequiredError("--robot");
  o.edges.columns.joints = o.variables.joints;
  o.edges.columns.turns = turnsOf(o.variables);
  o.edges.columns.ignore_limits = o.variables.ignore_limits;
  o.edges.columns.limit_tolerance = o.variables.limit_tolerance;
  o.edges.state = o.variables.state;
  o.edges.request.mode = o.any ? ContactMode::any : ContactMode::first;
  o.edges.request.certificate = o.edges.certificates;
  removeEarlierOutputs({{"--auto-srdf", &o.world.auto_srdf}}, inputsOf(o.world));
  return certifyEdges(o.world, o.edges);
}

}  // namespace

void addCertifyEdges(CLI::App& program, int& exit_status) {
  auto options = std::make_shared<EdgesVerb>();
  EdgesVerb& o = *options;
  CLI::App* certify =
      program.add_subcommand("certify", "Many edges or trajectories, HDF5, each in many scenes: what is free");
  certify->footer(
      "Answers go to the folder --out, block by block: what is there is not computed again. (Without --edges and\n"
      "--merge, fcl_artic certify certifies plans of files.)\n"
      "Exit status: 0 all is computed, whatever the answers; 2 error.");
  CLI::Option* edges = certify->add_option("--edges", o.edges.edges, "Edges or trajectories, HDF5, each in each scene")
                           ->check(requireInput)
                           ->group("Edges")
                           ->type_name("FILE.h5");
  CLI::Option* merge =
      certify->add_flag("--merge", o.merge, "Merge the blocks of the folder --out: table.h5, summary.json")
          ->excludes(edges)
          ->group("Edges");
  certify->add_option("--out", o.edges.out, "The run's folder")->group("Edges")->type_name("DIR");
  certify
      ->add_option("--scenes", o.edges.scenes,
                   "Scenes, one after the other: files as --scene takes them, folders of them, HDF5; what --scene "
                   "names stands in all of them")
      ->needs(edges)
      ->allow_extra_args(false)
      ->group("Edges")
      ->type_name("PATH");
  certify->add_option("--shard", o.edges.shard, "Only the blocks I, I + N, I + 2 N ... of a job array; I from 1 to N")
      ->needs(edges)
      ->group("Edges")
      ->type_name("I/N");
  certify->add_option("--block-rows", o.edges.block_rows, "Edges of a block: what is lost where a process is killed")
      ->check(CLI::Range(std::size_t{1}, std::size_t{1} << 24))
      ->needs(edges)
      ->group("Edges")
      ->capture_default_str();
  certify->add_flag("--any", o.any, "Any contact, not the first: cheaper where only the verdict matters")
      ->needs(edges)
      ->group("Edges");
  certify->add_flag("--certificates", o.edges.certificates, "Proofs of all answers, in the run's folder")
      ->needs(edges)
      ->group("Edges");
  certify->add_flag("--partial", o.edges.partial, "Merge what is there: rows of blocks that are missing say so")
      ->needs(merge)
      ->group("Edges");
  certify->add_flag("--quiet", o.edges.quiet, "No progress, no notes")->needs(edges)->group("Edges");

  addWorldOptions(*certify, o.world, "--robot,--urdf");
  certify->get_option("--robot")->required(false);  // --merge needs none
  addPlanVariables(*certify, o.variables);
  addQueryOptions(*certify, o.edges.request);
  certify->add_option("--threads", o.edges.threads, "Threads at most; 0: as many as the machine runs at once")
      ->check(CLI::NonNegativeNumber)
      ->group("Query")
      ->capture_default_str();
  certify->add_flag("--json", o.json, "The summary of --merge in JSON")->needs(merge)->group("Output");
  certify->callback([options, &exit_status] { exit_status = runCertifyEdges(*options); });
}

}  // namespace fcl_artic::app
