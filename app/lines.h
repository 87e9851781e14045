// SPDX-License-Identifier: BSD-3-Clause
//
// Many motions, one a line in JSON, and an answer a line.
#pragma once

#include <functional>
#include <string>

#include "certificate_file.h"
#include "fcl_artic/manager.h"
#include "plans/motion.h"

namespace fcl_artic::app {

struct LinesOptions {
  std::string path;  ///< "-": standard input
  plans::MotionOptions motion;
};

/// Asks the manager about every line of a file, in order, and prints an answer for each at once. A line that is wrong
/// gets an answer that says so, and the others are asked all the same.
/// @param[in,out] certificates  written at the end, where they are wanted.
/// @return exit status: that of the worst answer, an error before a contact before undecided before free.
/// @throws std::runtime_error for a file that can't be read, std::invalid_argument for one without a question.
int checkLines(const ArticulatedCollisionManager& manager, const CertifiedRequest& request, const LinesOptions& options,
               CertificateFile& certificates);

}  // namespace fcl_artic::app
