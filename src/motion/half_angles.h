// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fcl_artic/joint_motion.h"
#include "model/query.h"

namespace fcl_artic {

/// The motion's variables that go by a tangent half-angle law, as a query names them. Keeps the motion's memory.
inline engine::HalfAngles halfAnglesOf(const JointMotion& motion) {
  return {motion.halfAngles().data(), motion.references().data(),
          static_cast<std::int32_t>(motion.halfAngles().size())};
}

}  // namespace fcl_artic
