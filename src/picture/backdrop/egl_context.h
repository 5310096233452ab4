// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
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
