// SPDX-License-Identifier: BSD-3-Clause
//
// With tolerances of joints and poses the engine's contacts say only that nothing keeps two bodies apart in the tube. A
// contact is proven by a witness: joints, base and objects are at a place within their tolerances, and there the bodies
// certainly touch.
#pragma once

#include "fcl_artic/joint_motion.h"
#include "fcl_artic/result.h"
#include "model/answer.h"
#include "motion/part_of_motion.h"
#include "query/engine_query.h"
#include "query/query_context.h"
#include "setup/registry.h"
#include "setup/setup.h"

namespace fcl_artic {

/// A query that was answered.
struct AnsweredQuery {
  const engine::Problem& problem;
  const engine::Query& query;
  const JointMotion& motion;
  const TimePart& time;  ///< of the obstacles' motions
};

/// Looks for witnesses of the contacts of an answer. Contacts that get none are not certain any more; nor is the answer
/// then, if none of its contacts is proven in time.
/// @param[in,out] result  its contacts in the order of the answer's.
void findWitnesses(const AnsweredQuery& asked, const Registry& registry, const VariableStrays& strays,
                   const engine::Answer& answer, QueryWorkspace& workspace, CertifiedResult& result);

}  // namespace fcl_artic
