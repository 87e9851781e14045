// SPDX-License-Identifier: BSD-3-Clause
#include "visibility/offscreen_context.h"

#include <dlfcn.h>

#include <stdexcept>
#include <string>

namespace fcl_artic {
namespace visibility {

void* openLibrary(std::initializer_list<const char*> names) {
  for (const char* name : names) {
    if (void* library = dlopen(name, RTLD_NOW | RTLD_LOCAL)) return library;
  }
  return nullptr;
}

void* functionOf(void* library, const char* name) {
  void* found = dlsym(library, name);
  if (!found) throw std::runtime_error(std::string("the library lacks ") + name);
  return found;
}

}  // namespace visibility

std::unique_ptr<OffscreenContext> OffscreenContext::create(OffscreenBackend backend, int major, int minor) {
  return backend == OffscreenBackend::osmesa ? visibility::createOsmesaContext(major, minor)
                                             : visibility::createEglContext(major, minor);
}

}  // namespace fcl_artic
