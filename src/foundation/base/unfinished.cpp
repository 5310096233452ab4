// SPDX-License-Identifier: Apache-2.0
#include "foundation/base/unfinished.h"

#include <chrono>
#include <exception>
#include <map>
#include <mutex>
#include <system_error>
#include <utility>

#include "foundation/base/error.h"
#include "foundation/base/files.h"

namespace airtruth {
namespace {

struct Registry {
  std::timed_mutex mutex;
  std::map<std::uint64_t, std::function<void()>> undo;
  std::uint64_t last = 0;
};

// The registry is never destroyed: other threads may still use it while static objects are
// destroyed.
Registry& registry() {
  static auto* const all = new Registry;
  return *all;
}

}  // namespace

Unfinished::Unfinished(std::function<void()> undo) {
  Registry& all = registry();
  const std::lock_guard lock(all.mutex);
  number_ = ++all.last;
  all.undo.emplace(number_, std::move(undo));
}

Unfinished Unfinished::path(const std::filesystem::path& path) {
  return Unfinished([path] {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  });
}

Unfinished::Unfinished(Unfinished&& other) noexcept : number_(std::exchange(other.number_, 0)) {}

Unfinished::~Unfinished() {
  if (number_ == 0) return;
  Registry& all = registry();
  const std::lock_guard lock(all.mutex);
  all.undo.erase(number_);
}

void Unfinished::finish(const std::function<void()>& step) {
  Registry& all = registry();
  const std::lock_guard lock(all.mutex);
  step();
  all.undo.erase(number_);
  number_ = 0;
}

PartFile::PartFile(std::filesystem::path file)
    : file_(std::move(file)),
      part_(part_path(file_)),
      out_(part_, std::ios::binary),
      unfinished_(Unfinished::path(part_)) {}

PartFile::~PartFile() {
  std::error_code ignored;
  if (!is_finished_) std::filesystem::remove(part_, ignored);
}

void PartFile::check_written() const {
  if (!out_) throw Error("cannot be written: is the disk full?", {file_.string()});
}

void PartFile::finish() {
  out_.close();
  check_written();
  unfinished_.finish([&] { std::filesystem::rename(part_, file_); });
  is_finished_ = true;
}

void undo_unfinished() {
  // A step that hangs, for example on a disk that does not answer, must not keep the process alive.
  // 0.3 s is chosen: a rename takes far less, and a user who pressed Ctrl-C does not notice it.
  constexpr std::chrono::milliseconds kLongestStep{300};
  Registry& all = registry();
  if (!all.mutex.try_lock_for(kLongestStep)) return;
  for (auto at = all.undo.rbegin(); at != all.undo.rend(); ++at) {
    try {
      at->second();
    } catch (const std::exception&) {  // a failure must not keep the others from being undone
    }
  }
}

}  // namespace airtruth
