// SPDX-License-Identifier: Apache-2.0
#include "picture/backdrop/egl_context.h"

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include <EGL/egl.h>
#include <EGL/eglext.h>

#include "foundation/base/error.h"

namespace airtruth::backdrop {
namespace {

template <typename Function>
Function egl_function(const char* name) {
  return reinterpret_cast<Function>(eglGetProcAddress(name));
}

struct Devices {
  std::vector<EGLDeviceEXT> gpus;
  std::vector<EGLDeviceEXT> software;
};

Devices find_devices() {
  const auto query_devices = egl_function<PFNEGLQUERYDEVICESEXTPROC>("eglQueryDevicesEXT");
  const auto query_string = egl_function<PFNEGLQUERYDEVICESTRINGEXTPROC>("eglQueryDeviceStringEXT");
  Devices devices;
  if (query_devices == nullptr || query_string == nullptr) return devices;
  std::array<EGLDeviceEXT, 64> found{};
  EGLint count = 0;
  if (query_devices(static_cast<EGLint>(found.size()), found.data(), &count) != EGL_TRUE)
    return devices;
  for (EGLint i = 0; i < count; ++i) {
    const EGLDeviceEXT device = found[static_cast<std::size_t>(i)];
    const char* extensions = query_string(device, EGL_EXTENSIONS);
    const bool software =
        extensions != nullptr &&
        std::string_view(extensions).find("EGL_MESA_device_software") != std::string_view::npos;
    (software ? devices.software : devices.gpus).push_back(device);
  }
  return devices;
}

EGLDisplay display_of(EGLenum platform, void* device) {
  const auto get_display =
      egl_function<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
  return get_display == nullptr ? EGL_NO_DISPLAY : get_display(platform, device, nullptr);
}

// The candidate displays, best first.
std::vector<EGLDisplay> candidates(std::optional<int> gpu, bool software) {
  const Devices devices = find_devices();
  std::vector<EGLDisplay> displays;
  if (!software && gpu) {
    const std::size_t count = devices.gpus.size();
    if (*gpu < 0 || static_cast<std::size_t>(*gpu) >= count)
      throw Error("GPU " + std::to_string(*gpu) + " is not there: EGL has " +
                  std::to_string(count) + " GPU(s), counted from 0; use --gpu none for software");
    return {display_of(EGL_PLATFORM_DEVICE_EXT, devices.gpus[static_cast<std::size_t>(*gpu)])};
  }
  if (!software) {
    for (EGLDeviceEXT device : devices.gpus)
      displays.push_back(display_of(EGL_PLATFORM_DEVICE_EXT, device));
  }
  for (EGLDeviceEXT device : devices.software)
    displays.push_back(display_of(EGL_PLATFORM_DEVICE_EXT, device));
  displays.push_back(display_of(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY));
  return displays;
}

}  // namespace

struct EglContext::Impl {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLSurface surface = EGL_NO_SURFACE;
  EGLContext context = EGL_NO_CONTEXT;

  // The process shares displays, so none is ever terminated.
  void close() {
    if (context != EGL_NO_CONTEXT) eglDestroyContext(display, context);
    if (surface != EGL_NO_SURFACE) eglDestroySurface(display, surface);
    context = EGL_NO_CONTEXT;
    surface = EGL_NO_SURFACE;
  }

  bool open(EGLDisplay candidate) {
    display = candidate;
    if (display == EGL_NO_DISPLAY || eglInitialize(display, nullptr, nullptr) != EGL_TRUE)
      return false;
    if (eglBindAPI(EGL_OPENGL_API) != EGL_TRUE) return false;
    constexpr std::array<EGLint, 5> kConfig = {
        EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
    constexpr std::array<EGLint, 5> kSurface = {EGL_WIDTH, 16, EGL_HEIGHT, 16, EGL_NONE};
    EGLConfig config = nullptr;
    EGLint count = 0;
    if (eglChooseConfig(display, kConfig.data(), &config, 1, &count) != EGL_TRUE || count < 1)
      return false;
    surface = eglCreatePbufferSurface(display, config, kSurface.data());
    context = eglCreateContext(display, config, EGL_NO_CONTEXT, nullptr);
    if (surface != EGL_NO_SURFACE && context != EGL_NO_CONTEXT) return true;
    close();
    return false;
  }
};

EglContext::EglContext(std::optional<int> gpu, bool software) : impl_(std::make_unique<Impl>()) {
  for (EGLDisplay display : candidates(gpu, software))
    if (impl_->open(display)) return;
  throw Error(
      "no EGL device can draw with OpenGL; expected a GPU driver or Mesa's llvmpipe (install "
      "libegl-mesa0 and "
      "libgl1-mesa-dri)");
}

EglContext::~EglContext() { impl_->close(); }

EglContext::Current::Current(const EglContext& context) : context_(context) {
  const Impl& impl = *context.impl_;
  check(eglBindAPI(EGL_OPENGL_API) == EGL_TRUE &&
            eglMakeCurrent(impl.display, impl.surface, impl.surface, impl.context) == EGL_TRUE,
        "an EGL context can be made current (is it current on another thread?)");
}

EglContext::Current::~Current() {
  eglMakeCurrent(context_.impl_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
}

}  // namespace airtruth::backdrop
