// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

namespace airtruth::backdrop {

// An OpenGL context without a screen, on one of EGL's devices.
class EglContext {
 public:
  // gpu: the n-th device that is not software. Empty: the first that works, else llvmpipe. Throws
  // Error.
  EglContext(std::optional<int> gpu, bool software);
  ~EglContext();

  // Current on this thread for as long as it lives.
  class Current {
   public:
    explicit Current(const EglContext& context);
    ~Current();
    Current(const Current&) = delete;
    Current& operator=(const Current&) = delete;

   private:
    const EglContext& context_;
  };

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace airtruth::backdrop
