// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <initializer_list>
#include <memory>
#include <mutex>

#include "fcl_artic/visibility/offscreen.h"

namespace fcl_artic {
namespace visibility {

std::unique_ptr<OffscreenContext> createOsmesaContext(int major, int minor);
std::unique_ptr<OffscreenContext> createEglContext(int major, int minor);

/// Held while an OpenGL context is made, used or destroyed: one of the library's contexts is at work at a time. (Mesa's
/// software rasteriser reads, without a lock, what other contexts of a display are drawing; doc/VISIBILITY.md,
/// "Contexts".)
std::mutex& openGlMutex();

/// A library that is opened at run time, and stays open.
class SharedLibrary {
 public:
  /// Opens the first of these that can be opened. @throws std::runtime_error when none can be.
  explicit SharedLibrary(std::initializer_list<const char*> names);
  /// @throws std::runtime_error when there is no such function.
  template <class F>
  void load(const char* name, F& function) const {
    function = reinterpret_cast<F>(address(name));
  }

 private:
  void* address(const char* name) const;
  void* library_ = nullptr;
};

}  // namespace visibility
}  // namespace fcl_artic
