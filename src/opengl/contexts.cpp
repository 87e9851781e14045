// SPDX-License-Identifier: BSD-3-Clause
//
// OpenGL without a window: contexts of OSMesa and EGL.
#include "fcl_artic/visibility/offscreen.h"

#include <dlfcn.h>

#include <cstring>
#include <initializer_list>
#include <stdexcept>
#include <string>

#include "opengl/functions.h"

#define EGL_NO_X11
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/osmesa.h>

namespace fcl_artic {
namespace {

/// Opens the first of some libraries that can be opened, for good. @throws std::runtime_error when none can be.
void* openLibrary(std::initializer_list<const char*> names) {
  for (const char* name : names) {
    if (void* const library = dlopen(name, RTLD_NOW | RTLD_LOCAL)) return library;
  }
  throw std::runtime_error(std::string(*names.begin()) + " is not found");
}

template <class F>
F load(void* library, const char* name) {
  void* const function = dlsym(library, name);
  if (!function) throw std::runtime_error(std::string("the library lacks ") + name);
  return reinterpret_cast<F>(function);
}

std::runtime_error noVersion(const char* library, int major, int minor) {
  return std::runtime_error(std::string(library) + " offers no OpenGL " + std::to_string(major) + "." +
                            std::to_string(minor));
}

struct Osmesa {
  void* const library = openLibrary({"libOSMesa.so.8", "libOSMesa.so"});
#define FCL_ARTIC_OSMESA(name) \
  const decltype(&::OSMesa##name) name = load<decltype(name)>(library, "OSMesa" #name)  // NOLINT
  FCL_ARTIC_OSMESA(CreateContextAttribs);
  FCL_ARTIC_OSMESA(DestroyContext);
  FCL_ARTIC_OSMESA(MakeCurrent);
  FCL_ARTIC_OSMESA(GetCurrentContext);
  FCL_ARTIC_OSMESA(GetProcAddress);
};

class OsmesaContext : public OffscreenContext {
 public:
  OsmesaContext(int major, int minor) {
    const int wanted[] = {OSMESA_PROFILE,
                          OSMESA_CORE_PROFILE,
                          OSMESA_CONTEXT_MAJOR_VERSION,
                          major,
                          OSMESA_CONTEXT_MINOR_VERSION,
                          minor,
                          0};
    context_ = osmesa().CreateContextAttribs(wanted, nullptr);
    if (!context_) throw noVersion("OSMesa", major, minor);
  }
  ~OsmesaContext() override {
    const std::lock_guard<std::mutex> turn(opengl::turns());
    osmesa().DestroyContext(context_);
  }
  void makeCurrent() override {
    // OSMesa can't be asked for a context's buffer, so another context could not be given back.
    if (osmesa().GetCurrentContext()) throw std::runtime_error("the thread has an OSMesa context of its own");
    if (!osmesa().MakeCurrent(context_, canvas_, GL_UNSIGNED_BYTE, kSide, kSide)) {
      throw std::runtime_error("OSMesa can't make its context current");
    }
  }
  void release() override { osmesa().MakeCurrent(nullptr, nullptr, GL_UNSIGNED_BYTE, 0, 0); }
  void* function(const char* name) const override { return reinterpret_cast<void*>(osmesa().GetProcAddress(name)); }

 private:
  static const Osmesa& osmesa() {
    static const Osmesa library;
    return library;
  }
  static constexpr int kSide = 4;
  OSMesaContext context_ = nullptr;
  unsigned char canvas_[4 * kSide * kSide];  // OSMesa wants one; all drawing goes to buffers of their own
};

struct Egl {
  void* const library = openLibrary({"libEGL.so.1", "libEGL.so"});
#define FCL_ARTIC_EGL(name) const decltype(&::egl##name) name = load<decltype(name)>(library, "egl" #name)  // NOLINT
  FCL_ARTIC_EGL(GetProcAddress);
  FCL_ARTIC_EGL(QueryString);
  FCL_ARTIC_EGL(Initialize);
  FCL_ARTIC_EGL(BindAPI);
  FCL_ARTIC_EGL(QueryAPI);
  FCL_ARTIC_EGL(CreateContext);
  FCL_ARTIC_EGL(DestroyContext);
  FCL_ARTIC_EGL(MakeCurrent);
  FCL_ARTIC_EGL(GetCurrentContext);
  FCL_ARTIC_EGL(GetCurrentDisplay);
  FCL_ARTIC_EGL(GetCurrentSurface);
  FCL_ARTIC_EGL(ReleaseThread);
  EGLDisplay display = EGL_NO_DISPLAY;
  bool mesa = false;

  Egl() {
    const auto devices = reinterpret_cast<PFNEGLQUERYDEVICESEXTPROC>(GetProcAddress("eglQueryDevicesEXT"));
    EGLDeviceEXT device = nullptr;
    EGLint count = 0;
    if (!open("EGL_MESA_platform_surfaceless", EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY) &&
        !(devices && devices(1, &device, &count) && count > 0 &&
          open("EGL_EXT_platform_device", EGL_PLATFORM_DEVICE_EXT, device))) {
      throw std::runtime_error("EGL offers neither a surfaceless display nor a device");
    }
    const char* const vendor = QueryString(display, EGL_VENDOR);
    mesa = vendor && std::strstr(vendor, "Mesa");
  }
  /// Gives back what Mesa keeps of this thread, unless the thread uses EGL for itself. A thread of a pool may end while
  /// the process ends; EGL's own clean-up at exit (Mesa 22.3 with libglvnd 1.6) then frees its state a second time.
  /// (NVIDIA's driver takes tens of milliseconds to set a thread up again.)
  void leaveThread() const {
    if (mesa && GetCurrentContext() == EGL_NO_CONTEXT && QueryAPI() == EGL_OPENGL_ES_API) ReleaseThread();
  }

 private:
  bool open(const char* extension, EGLenum platform, void* native) {
    const char* const offered = QueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    const auto find = reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(GetProcAddress("eglGetPlatformDisplayEXT"));
    if (!find || !offered || !std::strstr(offered, extension)) return false;
    display = find(platform, native, nullptr);
    return display != EGL_NO_DISPLAY && Initialize(display, nullptr, nullptr);
  }
};

class EglContext : public OffscreenContext {
 public:
  EglContext(int major, int minor) {
    const EGLint wanted[] = {
        EGL_CONTEXT_MAJOR_VERSION,           major,   EGL_CONTEXT_MINOR_VERSION, minor, EGL_CONTEXT_OPENGL_PROFILE_MASK,
        EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
    const EGLenum api = egl_.QueryAPI();
    egl_.BindAPI(EGL_OPENGL_API);
    context_ = egl_.CreateContext(egl_.display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, wanted);
    egl_.BindAPI(api);
    egl_.leaveThread();
    if (context_ == EGL_NO_CONTEXT) throw noVersion("EGL", major, minor);
  }
  ~EglContext() override {
    const std::lock_guard<std::mutex> turn(opengl::turns());
    egl_.DestroyContext(egl_.display, context_);
    egl_.leaveThread();
  }
  void makeCurrent() override {
    const EGLenum api = egl_.QueryAPI();
    egl_.BindAPI(EGL_OPENGL_API);
    before_ = {api, egl_.GetCurrentContext(), egl_.GetCurrentDisplay(), egl_.GetCurrentSurface(EGL_DRAW),
               egl_.GetCurrentSurface(EGL_READ)};
    if (egl_.MakeCurrent(egl_.display, EGL_NO_SURFACE, EGL_NO_SURFACE, context_)) return;
    egl_.BindAPI(api);
    egl_.leaveThread();
    throw std::runtime_error("EGL can't make its context current");
  }
  void release() override {
    const bool had = before_.context != EGL_NO_CONTEXT;
    egl_.MakeCurrent(had ? before_.display : egl_.display, before_.draw, before_.read, before_.context);
    egl_.BindAPI(before_.api);
    egl_.leaveThread();
  }
  void* function(const char* name) const override { return reinterpret_cast<void*>(egl_.GetProcAddress(name)); }

 private:
  static const Egl& egl() {
    static const Egl library;
    return library;
  }
  const Egl& egl_ = egl();
  EGLContext context_ = EGL_NO_CONTEXT;
  struct {
    EGLenum api;
    EGLContext context;
    EGLDisplay display;
    EGLSurface draw, read;
  } before_ = {};  ///< what the thread had
};

}  // namespace

std::mutex& opengl::turns() {
  static std::mutex mutex;
  return mutex;
}

std::unique_ptr<OffscreenContext> OffscreenContext::create(OffscreenBackend backend, int major, int minor) {
  const std::lock_guard<std::mutex> turn(opengl::turns());
  if (backend == OffscreenBackend::osmesa) return std::make_unique<OsmesaContext>(major, minor);
  return std::make_unique<EglContext>(major, minor);
}

}  // namespace fcl_artic
