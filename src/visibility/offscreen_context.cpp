// SPDX-License-Identifier: BSD-3-Clause
#include "visibility/offscreen_context.h"

#include <dlfcn.h>

#include <stdexcept>
#include <string>

namespace fcl_artic {
namespace visibility {

std::mutex& openGlMutex() {
  static std::mutex mutex;
  return mutex;
}

SharedLibrary::SharedLibrary(std::initializer_list<const char*> names) {
  for (const char* name : names) {
    library_ = dlopen(name, RTLD_NOW | RTLD_LOCAL);
    if (library_) return;
  }
  throw std::runtime_error(std::string(*names.begin()) + " is not found");
}

void* SharedLibrary::address(const char* name) const {
  void* found = dlsym(library_, name);
  if (!found) throw std::runtime_error(std::string("the library lacks ") + name);
  return found;
}

}  // namespace visibility

std::unique_ptr<OffscreenContext> OffscreenContext::create(OffscreenBackend backend, int major, int minor) {
  const std::lock_guard<std::mutex> turn(visibility::openGlMutex());
  return backend == OffscreenBackend::osmesa ? visibility::createOsmesaContext(major, minor)
                                             : visibility::createEglContext(major, minor);
}

}  // namespace fcl_artic
