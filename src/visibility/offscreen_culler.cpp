// SPDX-License-Identifier: BSD-3-Clause
#include "fcl_artic/visibility/offscreen.h"
#include "visibility/gl_executor.h"

namespace fcl_artic {

std::shared_ptr<const VisibilityCuller> makeOffscreenCuller(OffscreenBackend backend,
                                                            const VisibilityOptions& options) {
  const std::string name = backend == OffscreenBackend::osmesa ? "osmesa" : "egl";
  return std::make_shared<VisibilityCuller>(options, name, [backend] {
    return std::unique_ptr<visibility::Executor>(
        std::make_unique<visibility::GlExecutor>(OffscreenContext::create(backend, 4, 3)));
  });
}

}  // namespace fcl_artic
