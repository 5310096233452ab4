// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>

namespace airtruth {

// Registers something that must not stay when the process ends in the middle of a step: a
// half-written file or folder, or a child process. A process that stops on a signal runs no
// destructors, so it calls undo_unfinished() first. The class is thread-safe.
//
//   Unfinished part = Unfinished::path("dir/.a.part.mp4");
//   ...                                                  // write the file
//   part.finish([] { rename("dir/.a.part.mp4", "dir/a.mp4"); });
class Unfinished {
 public:
  // `undo` must not throw, and it must be safe while the owner still works, because
  // undo_unfinished() calls it on another thread. The destructor forgets `undo` without calling it:
  // in a process that goes on, the owner itself cleans up.
  explicit Unfinished(std::function<void()> undo);
  // `undo` removes the file, or the folder with everything below it.
  static Unfinished path(const std::filesystem::path& path);

  Unfinished(Unfinished&& other) noexcept;
  Unfinished& operator=(Unfinished&&) = delete;
  ~Unfinished();

  // Runs the step that completes the work (a rename) and forgets `undo`. undo_unfinished() runs
  // before the step or after it, never during it. Where the step throws, the exception passes
  // through and the work stays unfinished.
  void finish(const std::function<void()>& step);

 private:
  std::uint64_t number_ = 0;
};

// A file that is written piece by piece: it grows under part_path(file) (files.h), and finish()
// gives it its name. One that is destroyed before is removed.
class PartFile {
 public:
  explicit PartFile(std::filesystem::path file);
  ~PartFile();
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;

  std::ofstream& out() { return out_; }
  // The name under which it grows.
  const std::filesystem::path& part() const { return part_; }
  // Throw Error where it could not be written.
  void check_written() const;
  void finish();

 private:
  std::filesystem::path file_, part_;
  std::ofstream out_;
  Unfinished unfinished_;
  bool is_finished_ = false;
};

// Undoes everything that is unfinished, the newest first. It gives up after 0.3 s where another
// thread is in a step that does not end. The caller must end the process straight after it: other
// threads that begin or finish a step wait for ever.
void undo_unfinished();

}  // namespace airtruth
