// SPDX-License-Identifier: BSD-3-Clause
#include <cstring>
#include <stdexcept>
#include <string>

#define EGL_NO_X11
#include <EGL/egl.h>
#include <EGL/eglext.h>

#include "visibility/offscreen_context.h"

namespace fcl_artic {
namespace visibility {
namespace {

struct Egl {
  decltype(&eglGetProcAddress) function = nullptr;
  decltype(&eglQueryString) queryString = nullptr;
  decltype(&eglInitialize) initialize = nullptr;
  decltype(&eglBindAPI) bindApi = nullptr;
  decltype(&eglQueryAPI) queryApi = nullptr;
  decltype(&eglCreateContext) createContext = nullptr;
  decltype(&eglDestroyContext) destroyContext = nullptr;
  decltype(&eglMakeCurrent) makeCurrent = nullptr;
  decltype(&eglGetCurrentContext) currentContext = nullptr;
  decltype(&eglGetCurrentDisplay) currentDisplay = nullptr;
  decltype(&eglGetCurrentSurface) currentSurface = nullptr;
  decltype(&eglReleaseThread) releaseThread = nullptr;
  EGLDisplay display = EGL_NO_DISPLAY;

  static const Egl& instance() {
    static const Egl library;
    return library;
  }

  /// Gives back what EGL keeps of this thread, unless the thread uses EGL for itself. A thread of a pool may end while
  /// the process ends; EGL's own clean-up at exit (Mesa 22.3 with libglvnd 1.6) then frees its state a second time.
  void leaveThread() const {
    if (currentContext() == EGL_NO_CONTEXT && queryApi() == EGL_OPENGL_ES_API) releaseThread();
  }

 private:
  Egl() {
    const SharedLibrary library({"libEGL.so.1", "libEGL.so"});
    library.load("eglGetProcAddress", function);
    library.load("eglQueryString", queryString);
    library.load("eglInitialize", initialize);
    library.load("eglBindAPI", bindApi);
    library.load("eglQueryAPI", queryApi);
    library.load("eglCreateContext", createContext);
    library.load("eglDestroyContext", destroyContext);
    library.load("eglMakeCurrent", makeCurrent);
    library.load("eglGetCurrentContext", currentContext);
    library.load("eglGetCurrentDisplay", currentDisplay);
    library.load("eglGetCurrentSurface", currentSurface);
    library.load("eglReleaseThread", releaseThread);
    const char* extensions = queryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    const auto offers = [&](const char* name) { return extensions && std::strstr(extensions, name); };
    const auto platformDisplay =
        reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(function("eglGetPlatformDisplayEXT"));
    if (!platformDisplay) throw std::runtime_error("EGL offers no platform displays");
    const auto use = [&](EGLenum platform, void* native) {
      display = platformDisplay(platform, native, nullptr);
      if (display != EGL_NO_DISPLAY && initialize(display, nullptr, nullptr)) return true;
      display = EGL_NO_DISPLAY;
      return false;
    };
    if (offers("EGL_MESA_platform_surfaceless") && use(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY)) return;
    const auto devices = reinterpret_cast<PFNEGLQUERYDEVICESEXTPROC>(function("eglQueryDevicesEXT"));
    EGLDeviceEXT device = nullptr;
    EGLint count = 0;
    if (offers("EGL_EXT_platform_device") && devices && devices(1, &device, &count) && count > 0 &&
        use(EGL_PLATFORM_DEVICE_EXT, device)) {
      return;
    }
    throw std::runtime_error("EGL offers neither a surfaceless display nor a device");
  }
};

class EglContext : public OffscreenContext {
 public:
  EglContext(int major, int minor) {
    const EGLenum api = egl_.queryApi();
    egl_.bindApi(EGL_OPENGL_API);
    const EGLint wanted[] = {
        EGL_CONTEXT_MAJOR_VERSION,           major,   EGL_CONTEXT_MINOR_VERSION, minor, EGL_CONTEXT_OPENGL_PROFILE_MASK,
        EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
    context_ = egl_.createContext(egl_.display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, wanted);
    egl_.bindApi(api);
    egl_.leaveThread();
    if (context_ == EGL_NO_CONTEXT) {
      throw std::runtime_error("EGL offers no OpenGL " + std::to_string(major) + "." + std::to_string(minor));
    }
  }
  ~EglContext() override {
    const std::lock_guard<std::mutex> turn(openGlMutex());
    egl_.destroyContext(egl_.display, context_);
    egl_.leaveThread();
  }

  void makeCurrent() override {
    before_.api = egl_.queryApi();
    egl_.bindApi(EGL_OPENGL_API);
    before_.context = egl_.currentContext();
    before_.display = egl_.currentDisplay();
    before_.draw = egl_.currentSurface(EGL_DRAW);
    before_.read = egl_.currentSurface(EGL_READ);
    if (egl_.makeCurrent(egl_.display, EGL_NO_SURFACE, EGL_NO_SURFACE, context_)) return;
    egl_.bindApi(before_.api);
    egl_.leaveThread();
    throw std::runtime_error("EGL can't make its context current");
  }
  void release() override {
    if (before_.context != EGL_NO_CONTEXT) {
      egl_.makeCurrent(before_.display, before_.draw, before_.read, before_.context);
    } else {
      egl_.makeCurrent(egl_.display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    }
    egl_.bindApi(before_.api);
    egl_.leaveThread();
  }
  void* function(const char* name) const override { return reinterpret_cast<void*>(egl_.function(name)); }

 private:
  const Egl& egl_ = Egl::instance();
  EGLContext context_ = EGL_NO_CONTEXT;
  struct {
    EGLenum api = 0;
    EGLContext context = EGL_NO_CONTEXT;
    EGLDisplay display = EGL_NO_DISPLAY;
    EGLSurface draw = EGL_NO_SURFACE, read = EGL_NO_SURFACE;
  } before_;  ///< what the thread had
};

}  // namespace

std::unique_ptr<OffscreenContext> createEglContext(int major, int minor) {
  return std::make_unique<EglContext>(major, minor);
}

}  // namespace visibility
}  // namespace fcl_artic
