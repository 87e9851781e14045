// SPDX-License-Identifier: BSD-3-Clause
//
// Component `visibility`: OpenGL without a window, for culling (and for pictures). Drivers are looked for when they are
// asked for, not when the program is linked.
#pragma once

#include <memory>
#include <string>

#include "fcl_artic/visibility.h"

namespace fcl_artic {

/// Libraries that provide OpenGL without a window. They are opened at run time.
enum class OffscreenBackend {
  osmesa,  ///< OSMesa, Mesa's off-screen library (up to Mesa 25.0): in software.
  egl,     ///< A surfaceless EGL display: Mesa in software or on a graphics processor; else the first EGL device.
};

/// An OpenGL core context that draws to buffers of its own. It is made on one thread and may be used by another one;
/// one thread at a time.
class FCL_ARTIC_EXPORT OffscreenContext {
 public:
  /// Creates a context of OpenGL version major.minor, core profile. It is not current yet.
  /// @throws std::runtime_error saying what is missing: the library, the version.
  static std::unique_ptr<OffscreenContext> create(OffscreenBackend backend, int major, int minor);
  /// Destroys the context.
  virtual ~OffscreenContext() = default;
  /// Not copyable.
  OffscreenContext(const OffscreenContext&) = delete;
  /// Not copyable.
  OffscreenContext& operator=(const OffscreenContext&) = delete;

  /// Makes the context current on the calling thread. release() gives the thread back what it had before.
  /// @throws std::runtime_error if that fails, or if the thread has a context that could not be given back.
  virtual void makeCurrent() = 0;
  /// Ends what makeCurrent() began, on the same thread, and makes its earlier context current again, if it had one.
  virtual void release() = 0;
  /// Returns the address of an OpenGL function; null if there is none. The context must be current.
  virtual void* function(const char* name) const = 0;

 protected:
  OffscreenContext() = default;
};

/// Makes a culler that draws with OpenGL 4.3, for one query at a time in a process (doc/VISIBILITY.md, "Contexts").
/// Nothing is opened before the first query. If the driver is missing or fails its self-test, the executor `cpu` takes
/// over, and VisibilityCuller::fallbackReason() says why.
/// @throws std::invalid_argument for a resolution out of range.
FCL_ARTIC_EXPORT std::shared_ptr<const VisibilityCuller> makeOffscreenCuller(OffscreenBackend backend,
                                                                             const VisibilityOptions& options = {});

}  // namespace fcl_artic
