// SPDX-License-Identifier: BSD-3-Clause
//
// Random URDF trees, read by loadUrdf() and asked by the manager, against dense sampling with FCL's static test.
#pragma once

#include <functional>

#include "../campaign/harness.h"
#include "fcl_artic/result.h"

namespace urdf_trees {

/// Faults are
///   missed      said to be free where a sample touches
///   untrue      said to touch where nothing does
///   differing   the verdict of mode `any` contradicts that of mode `first`
/// Its mutant takes the geometry of the link that touches first out of a second manager, whose answer is judged by the
/// whole tree.
/// @param certificates  gets the answer for the first contact of each tree, with its certificate, and may find faults
/// of
///   the case; may be empty. Called by all threads.
campaign::Campaign campaignOfTrees(
    std::function<void(campaign::Case& c, const fcl_artic::CertifiedResult&)> certificates = {});

}  // namespace urdf_trees
