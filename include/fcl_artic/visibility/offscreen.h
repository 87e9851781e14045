// SPDX-License-Identifier: BSD-3-Clause
//
// Component `visibility`: OpenGL without a window, for culling (and for pictures). Drivers are looked for when they are
// asked for, not when the program is linked.
#pragma once

#include <memory>
#include <string>

#include "fcl_artic/visibility.h"

namespace fcl_artic {

enum class OffscreenBackend {
  osmesa,  ///< Mesa's off-screen library (up to Mesa 25.0): in software
  egl,     ///< a surfaceless EGL context: Mesa in software or on a graphics processor, else the first EGL device
};

/// An OpenGL core context that draws to buffers of its own. It is made on one thread and may be used by another, one at
/// a time.
class FCL_ARTIC_EXPORT OffscreenContext {
 public:
  /// @throws std::runtime_error saying what is missing: the library, the version.
  static std::unique_ptr<OffscreenContext> create(OffscreenBackend backend, int major, int minor);
  virtual ~OffscreenContext() = default;
  OffscreenContext(const OffscreenContext&) = delete;
  OffscreenContext& operator=(const OffscreenContext&) = delete;

  /// Makes it the calling thread's own; release() gives the thread back what it had.
  /// @throws std::runtime_error when that fails, or when the thread has a context that could not be given back.
  virtual void makeCurrent() = 0;
  virtual void release() = 0;
  /// Address of an OpenGL function, null when there is none. The context is current.
  virtual void* function(const char* name) const = 0;

 protected:
  OffscreenContext() = default;
};

/// A culler that draws with OpenGL 4.3, one query at a time in a process (doc/VISIBILITY.md, "Contexts"). Nothing is
/// opened before the first query; where the driver is missing or fails its self-test, the executor cpu takes over, and
/// VisibilityCuller::fallbackReason() says why.
FCL_ARTIC_EXPORT std::shared_ptr<const VisibilityCuller> makeOffscreenCuller(OffscreenBackend backend,
                                                                             const VisibilityOptions& options = {});

}  // namespace fcl_artic
