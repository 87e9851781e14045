// SPDX-License-Identifier: BSD-3-Clause
#include "visibility/stage.h"

#include <exception>

#include "model/add_fields.h"

namespace fcl_artic {
namespace visibility {

void beginBatch(const VisibilityCuller& culler, Batch& batch) {
  batch.clear();
  batch.resolution = culler.options().resolution;
  batch.rule = culler.options().rule;
  batch.groups_only = true;
  batch.growth = Growth();
}

void Stage::run(const engine::Problem& problem, const engine::SweptLink* links, engine::CullCandidate* candidates,
                std::int32_t n, ExecutorLoan& loan) {
  Batch& batch = loan->batch;
  beginBatch(culler_, batch);
  QueryVolumes& volumes = volumes_.emplace_back();
  volumes.add(problem, links, candidates, n, tolerance_distance_, culler_.options().every_link_pair, batch);
  if (volumes.work().pairs == 0) return;
  executor = loan->name;
  loan->executor->run(batch, loan->may);
  volumes.conclude(batch, loan->may);
  volumes.apply(candidates);  // from here on nothing fails
  engine::addFields(volumes.work(), work);
}

void Stage::clear(void* context, const engine::Problem& problem, const engine::SweptLink* links,
                  engine::CullCandidate* pairs, std::int32_t num_pairs) {
  Stage& stage = *static_cast<Stage*>(context);
  const double begin = stage.now_();
  ExecutorLoan loan(stage.culler_, stage.kind_);
  const double made = loan.made() ? stage.now_() : begin;
  stage.making_us += made - begin;
  try {
    stage.run(problem, links, pairs, num_pairs, loan);
  } catch (const std::exception& e) {  // nothing was taken out yet
    loan.giveUp(e.what());
  }
  stage.work.us += stage.now_() - made;
}

}  // namespace visibility
}  // namespace fcl_artic
