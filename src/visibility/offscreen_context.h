// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <initializer_list>
#include <memory>

#include "fcl_artic/visibility/offscreen.h"

namespace fcl_artic {
namespace visibility {

std::unique_ptr<OffscreenContext> createOsmesaContext(int major, int minor);
std::unique_ptr<OffscreenContext> createEglContext(int major, int minor);

/// The first of the libraries that can be opened; it stays open. Null: none.
void* openLibrary(std::initializer_list<const char*> names);
/// @throws std::runtime_error when the library has no such function.
void* functionOf(void* library, const char* name);

}  // namespace visibility
}  // namespace fcl_artic
