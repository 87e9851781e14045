// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <mutex>

#include "fcl_artic/visibility/offscreen.h"
#include "visibility/executor.h"

namespace fcl_artic {
namespace visibility {

/// Held while an OpenGL context is made, used or destroyed: one of the library's contexts is at work at a time. (Mesa's
/// software rasteriser reads, without a lock, what other contexts of a display are drawing; doc/VISIBILITY.md,
/// "Contexts".)
std::mutex& openGlMutex();

/// The rule in OpenGL 4.3: the views side by side, one draw of what is swept, one of the pieces, one read.
/// @throws std::runtime_error when a shader or buffer can't be had.
std::unique_ptr<Executor> makeGlExecutor(std::unique_ptr<OffscreenContext> context);

}  // namespace visibility
}  // namespace fcl_artic
