// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace fcl_artic {

/// How far each joint variable may be from the motion's, for those who look at ranges of variables.
struct VariableStrays {
  const double* of_variable = nullptr;  ///< rad or m; infinity: not known by variables; null: none strays
  double factor = 1;                    ///< engine::TubeAsked::factor

  double of(int variable) const { return of_variable ? factor * of_variable[variable] : 0; }
};

}  // namespace fcl_artic
