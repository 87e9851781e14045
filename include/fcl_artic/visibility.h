// SPDX-License-Identifier: BSD-3-Clause
//
// Stage 2: culling by visibility (doc/VISIBILITY.md). Everything that it removes is proven free. Answers do not depend
// on it, by construction: it shortens proofs that a motion is free, and any other answer is found without it.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "fcl_artic/export.h"

namespace fcl_artic {

/// Options of a VisibilityCuller.
struct VisibilityOptions {
  int resolution = 32;  ///< Pixels along a side of each view, 4 to 128.
};

class VisibilityCuller;

/// Culling by visibility, inside.
namespace visibility {
/// Draws what links sweep and the obstacles near it, and judges by the rule; internal.
class Executor;
/// The volumes that are drawn for one link; internal.
struct Drawing;
/// Has a culler's executor draw; internal.
std::string drawBy(const VisibilityCuller& culler, const Drawing& drawing, std::vector<std::uint8_t>& may);
/// Function that makes an executor, which one thread at a time uses. It throws std::runtime_error naming what is
/// missing.
using ExecutorFactory = std::function<std::unique_ptr<Executor>()>;
}  // namespace visibility

/// Culls by visibility, for ArticulatedCollisionManager::setVisibility(). May be used by many threads and managers at
/// once. An executor other than `cpu` is made when first needed; queries take turns with it.
class FCL_ARTIC_EXPORT VisibilityCuller {
 public:
  /// Creates a culler with the executor `cpu`: own scan conversion, without OpenGL.
  /// @throws std::invalid_argument for a resolution out of range.
  explicit VisibilityCuller(const VisibilityOptions& options = {});
  /// Creates a culler with another executor; makeOffscreenCuller() (fcl_artic/visibility/offscreen.h) does so. If one
  /// can't be made, fails its self-test or fails in a query, the executor `cpu` takes over for good.
  /// @param executor  its name, as reported.
  /// @param factory   called when a query first needs an executor; empty: `cpu`.
  /// @throws std::invalid_argument for a resolution out of range.
  VisibilityCuller(const VisibilityOptions& options, const std::string& executor, visibility::ExecutorFactory factory);
  /// Destroys the executors; no query may be at work.
  ~VisibilityCuller();
  /// Not copyable.
  VisibilityCuller(const VisibilityCuller&) = delete;
  /// Not copyable.
  VisibilityCuller& operator=(const VisibilityCuller&) = delete;

  /// The options that it was created with.
  const VisibilityOptions& options() const;
  /// Returns the name of the executor at work: "cpu", "osmesa" or "egl". Makes one if there is none yet.
  std::string executor() const;
  /// Returns why the executor `cpu` took over; empty if it has not.
  std::string fallbackReason() const;

 private:
  friend std::string visibility::drawBy(const VisibilityCuller& culler, const visibility::Drawing& drawing,
                                        std::vector<std::uint8_t>& may);
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fcl_artic
