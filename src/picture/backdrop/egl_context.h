// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

namespace airtruth::backdrop {

// An OpenGL context without a screen, on one of EGL's devices.
class EglContext {
 public:
  // gpu: the index among the devices that are not software. Empty: the first that works, else
  // llvmpipe. Throws Error.
  EglContext(std::optional<int> gpu, bool software);
  ~EglContext();

  // Makes the context current on this thread during its own lifetime.
  class Current {
   public:
    explicit Current(const EglContext& egl);
    ~Current();
    Current(const Current&) = delete;
    Current& operator=(const Current&) = delete;

   private:
    const EglContext& egl_;
  };

 private:
  bool open(void* candidate);
  // The process shares displays, so none is ever terminated.
  void close();

  // EGL's handles; its headers declare them as pointers to void, and bring those of X11 along.
  void* display_ = nullptr;
  void* surface_ = nullptr;
  void* context_ = nullptr;
};

}  // namespace airtruth::backdrop
