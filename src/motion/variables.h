// SPDX-License-Identifier: BSD-3-Clause
//
// Body motions as a query's variables.
#pragma once

#include "model/sweep.h"
#include "motion/body_motion.h"

namespace fcl_artic {

/// Variables of an element: rows of its coefficients that count.
int numVariables(const MotionElement& element);
int numVariables(const BodyMotion& motion);
/// Highest power of t in any of the motion's variables.
int degreeOf(const BodyMotion& motion);

/// Writes an element's coefficients as engine::Query wants them.
/// @param variable  its first one, of num_variables.
/// @param degree  of the query, no less than the element's.
void writeCoefficients(const MotionElement& element, int variable, int num_variables, int degree, double* coefficients);

/// The author of a bounded element, as the engine asks it. The view keeps the pointer.
engine::BoundedSource boundedSource(const BoundedMotion& motion);

}  // namespace fcl_artic
