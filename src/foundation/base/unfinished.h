// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>

namespace airtruth {

// Owns something that must not outlive a process that ends in the middle of a step: a half-written
// file or folder, or a child process. The destructor undoes it; where the process ends without
// destructors, undo_unfinished() does. The class is thread-safe.
class Unfinished {
 public:
  // `undo` runs on another thread than the owner's, while the owner may still be at work; it must
  // not throw. It is called at most once, and not after the destructor or finish() began.
  explicit Unfinished(std::function<void()> undo);
  // Removes the file, or the folder with all below it.
  static Unfinished path(const std::filesystem::path& path);

  Unfinished(Unfinished&& other) noexcept;
  Unfinished& operator=(Unfinished&&) = delete;
  ~Unfinished();

  // Runs the step that makes it whole (a rename) and forgets it. undo_unfinished() comes before the
  // step or after, never in its midst. What the step throws passes through, and it stays
  // unfinished.
  void finish(const std::function<void()>& step);

 private:
  std::uint64_t number_ = 0;
};

// Undoes everything that is unfinished. The process must end straight after it: every other thread
// that begins or finishes a step from now on waits for ever.
void undo_unfinished();

}  // namespace airtruth
