// SPDX-License-Identifier: BSD-3-Clause
//
// Stage 2: culling by visibility (doc/VISIBILITY.md). What it takes out is proven free. Answers do not depend on it, by
// construction: it shortens proofs that a motion is free, and any other answer is found without it.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "fcl_artic/export.h"

namespace fcl_artic {

/// How a pair is judged.
enum class VisibilityRule {
  intervals,  ///< each convex piece of an obstacle against the swept volume's interval of depth, pixel by pixel
  occlusion,  ///< CULLIDE: an obstacle is free that is as a whole visible in front of the swept volume, or behind it
};

struct VisibilityOptions {
  VisibilityRule rule = VisibilityRule::intervals;
  int resolution = 32;  ///< pixels along a view's side, 4 to 128
};

namespace visibility {
class Executor;
class ExecutorLoan;
/// Makes an executor for one thread at a time. @throws std::runtime_error naming what is missing.
using ExecutorFactory = std::function<std::unique_ptr<Executor>()>;
}  // namespace visibility

/// Culls by visibility. Safe to use from many threads and by many managers: each query at work has an executor of its
/// own, made when first needed and kept.
class FCL_ARTIC_EXPORT VisibilityCuller {
 public:
  /// The executor `cpu`: own scan conversion, without OpenGL.
  /// @throws std::invalid_argument for a resolution out of range.
  explicit VisibilityCuller(const VisibilityOptions& options = {});
  /// Another executor, as the component `visibility` makes them (fcl_artic/visibility/offscreen.h). Where one can't be
  /// made or fails its self-test, the executor `cpu` takes over.
  VisibilityCuller(const VisibilityOptions& options, const std::string& executor, visibility::ExecutorFactory factory);
  ~VisibilityCuller();
  VisibilityCuller(const VisibilityCuller&) = delete;
  VisibilityCuller& operator=(const VisibilityCuller&) = delete;

  const VisibilityOptions& options() const;
  /// Executor at work: "cpu", "osmesa" or "egl". Makes one, when there is none yet.
  std::string executor() const;
  /// Why "cpu" took over; empty while it has not.
  std::string fallbackReason() const;

 private:
  friend class visibility::ExecutorLoan;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fcl_artic
