// SPDX-License-Identifier: BSD-3-Clause
#include <stdexcept>
#include <string>

#include <GL/osmesa.h>

#include "visibility/offscreen_context.h"

namespace fcl_artic {
namespace visibility {
namespace {

struct Osmesa {
  decltype(&OSMesaCreateContextAttribs) create = nullptr;
  decltype(&OSMesaDestroyContext) destroy = nullptr;
  decltype(&OSMesaMakeCurrent) makeCurrent = nullptr;
  decltype(&OSMesaGetCurrentContext) current = nullptr;
  decltype(&OSMesaGetProcAddress) function = nullptr;

  static const Osmesa& instance() {
    static const Osmesa library;
    return library;
  }

 private:
  Osmesa() {
    const SharedLibrary library({"libOSMesa.so.8", "libOSMesa.so"});
    library.load("OSMesaCreateContextAttribs", create);
    library.load("OSMesaDestroyContext", destroy);
    library.load("OSMesaMakeCurrent", makeCurrent);
    library.load("OSMesaGetCurrentContext", current);
    library.load("OSMesaGetProcAddress", function);
  }
};

class OsmesaContext : public OffscreenContext {
 public:
  OsmesaContext(int major, int minor) {
    const int wanted[] = {OSMESA_FORMAT,
                          OSMESA_RGBA,
                          OSMESA_DEPTH_BITS,
                          0,
                          OSMESA_PROFILE,
                          OSMESA_CORE_PROFILE,
                          OSMESA_CONTEXT_MAJOR_VERSION,
                          major,
                          OSMESA_CONTEXT_MINOR_VERSION,
                          minor,
                          0};
    context_ = osmesa_.create(wanted, nullptr);
    if (!context_) {
      throw std::runtime_error("OSMesa offers no OpenGL " + std::to_string(major) + "." + std::to_string(minor));
    }
  }
  ~OsmesaContext() override {
    const std::lock_guard<std::mutex> turn(openGlMutex());
    osmesa_.destroy(context_);
  }

  void makeCurrent() override {
    // OSMesa can't be asked for a context's buffer, so another context could not be given back.
    if (osmesa_.current()) throw std::runtime_error("the thread has an OSMesa context of its own");
    if (!osmesa_.makeCurrent(context_, canvas_, GL_UNSIGNED_BYTE, kSide, kSide)) {
      throw std::runtime_error("OSMesa can't make its context current");
    }
  }
  void release() override { osmesa_.makeCurrent(nullptr, nullptr, GL_UNSIGNED_BYTE, 0, 0); }
  void* function(const char* name) const override { return reinterpret_cast<void*>(osmesa_.function(name)); }

 private:
  static constexpr int kSide = 4;
  const Osmesa& osmesa_ = Osmesa::instance();
  OSMesaContext context_ = nullptr;
  unsigned char canvas_[4 * kSide * kSide];  // OSMesa wants one; all drawing goes to buffers of their own
};

}  // namespace

std::unique_ptr<OffscreenContext> createOsmesaContext(int major, int minor) {
  return std::make_unique<OsmesaContext>(major, minor);
}

}  // namespace visibility
}  // namespace fcl_artic
