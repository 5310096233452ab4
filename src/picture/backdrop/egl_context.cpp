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

std::vector<EGLDeviceEXT> find_devices(bool software) {
  const auto query_devices = egl_function<PFNEGLQUERYDEVICESEXTPROC>("eglQueryDevicesEXT");
  const auto query_string = egl_function<PFNEGLQUERYDEVICESTRINGEXTPROC>("eglQueryDeviceStringEXT");
  if (query_devices == nullptr || query_string == nullptr) return {};
  std::vector<EGLDeviceEXT> found(64);
  EGLint count = 0;
  if (query_devices(static_cast<EGLint>(found.size()), found.data(), &count) != EGL_TRUE) return {};
  found.resize(static_cast<std::size_t>(count));
  std::erase_if(found, [&](EGLDeviceEXT device) {
    const char* extensions = query_string(device, EGL_EXTENSIONS);
    const bool is_software =
        extensions != nullptr &&
        std::string_view(extensions).find("EGL_MESA_device_software") != std::string_view::npos;
    return is_software != software;
  });
  return found;
}

EGLDisplay display_of(EGLenum platform, void* device) {
  const auto get_display =
      egl_function<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
  return get_display == nullptr ? EGL_NO_DISPLAY : get_display(platform, device, nullptr);
}

// The candidate displays, best first.
std::vector<EGLDisplay> candidates(std::optional<int> gpu, bool software) {
  std::vector<EGLDisplay> displays;
  if (!software) {
    const std::vector<EGLDeviceEXT> gpus = find_devices(false);
    if (gpu && (*gpu < 0 || *gpu >= std::ssize(gpus)))
      throw Error("GPU " + std::to_string(*gpu) + " is not there: EGL has " +
                  std::to_string(gpus.size()) +
                  " GPU(s), counted from 0; use --gpu none for software");
    if (gpu) return {display_of(EGL_PLATFORM_DEVICE_EXT, gpus[static_cast<std::size_t>(*gpu)])};
    for (EGLDeviceEXT device : gpus)
      displays.push_back(display_of(EGL_PLATFORM_DEVICE_EXT, device));
  }
  for (EGLDeviceEXT device : find_devices(true))
    displays.push_back(display_of(EGL_PLATFORM_DEVICE_EXT, device));
  displays.push_back(display_of(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY));
  return displays;
}

}  // namespace

bool EglContext::open(EGLDisplay candidate) {
  display_ = candidate;
  if (display_ == EGL_NO_DISPLAY || eglInitialize(display_, nullptr, nullptr) != EGL_TRUE)
    return false;
  if (eglBindAPI(EGL_OPENGL_API) != EGL_TRUE) return false;
  constexpr std::array<EGLint, 5> kConfig = {
      EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
  constexpr std::array<EGLint, 5> kSurface = {EGL_WIDTH, 16, EGL_HEIGHT, 16, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  if (eglChooseConfig(display_, kConfig.data(), &config, 1, &count) != EGL_TRUE || count < 1)
    return false;
  surface_ = eglCreatePbufferSurface(display_, config, kSurface.data());
  context_ = eglCreateContext(display_, config, EGL_NO_CONTEXT, nullptr);
  if (surface_ != EGL_NO_SURFACE && context_ != EGL_NO_CONTEXT) return true;
  close();
  return false;
}

void EglContext::close() {
  if (context_ != EGL_NO_CONTEXT) eglDestroyContext(display_, context_);
  if (surface_ != EGL_NO_SURFACE) eglDestroySurface(display_, surface_);
}

EglContext::EglContext(std::optional<int> gpu, bool software) {
  for (EGLDisplay display : candidates(gpu, software))
    if (open(display)) return;
  throw Error(
      "no EGL device can draw with OpenGL; expected a GPU driver or Mesa's llvmpipe (install "
      "libegl-mesa0 and "
      "libgl1-mesa-dri)");
}

EglContext::~EglContext() { close(); }

EglContext::Current::Current(const EglContext& egl) : egl_(egl) {
  check(eglBindAPI(EGL_OPENGL_API) == EGL_TRUE &&
            eglMakeCurrent(egl.display_, egl.surface_, egl.surface_, egl.context_) == EGL_TRUE,
        "an EGL context can be made current (is it current on another thread?)");
}

EglContext::Current::~Current() {
  eglMakeCurrent(egl_.display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
}

}  // namespace airtruth::backdrop
