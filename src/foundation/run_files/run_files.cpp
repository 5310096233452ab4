// SPDX-License-Identifier: Apache-2.0
#include "foundation/run_files/run_files.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include "foundation/base/descriptor.h"
#include "foundation/base/error.h"
#include "foundation/base/file_state.h"
#include "foundation/base/files.h"
#include "foundation/base/unfinished.h"

namespace airtruth {
namespace {

// Names of the hidden folders begin so. They do not depend on the output's name, so that any later
// run that writes beside it finds what a killed one left.
constexpr const char* kHiddenBegins = ".airtruth.part-";
// Held while a set of files is moved into place.
constexpr const char* kCommitLock = ".airtruth.lock";

// The path without links and dots, as far as it exists.
fs::path plain(const fs::path& path) {
  std::error_code failed;
  const fs::path result = fs::weakly_canonical(fs::absolute(path), failed);
  return failed ? fs::absolute(path).lexically_normal() : result;
}

bool is_same(const fs::path& a, const fs::path& b) {
  std::error_code failed;
  return plain(a) == plain(b) || (fs::equivalent(a, b, failed) && !failed);
}

// True where `path` is `folder` or lies below it.
bool is_within(const fs::path& path, const fs::path& folder) {
  const fs::path inner = plain(path);
  const fs::path outer = plain(folder);
  return std::mismatch(outer.begin(), outer.end(), inner.begin(), inner.end()).first == outer.end();
}

fs::path folder_of(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

void refuse_input(const fs::path& output, const std::vector<fs::path>& inputs) {
  for (const fs::path& input : inputs) {
    if (is_same(output, input))
      throw Error("is read and written by the same run; expected another name for what is written",
                  {output.string()});
    if (fs::is_directory(input) && fs::exists(output) && !fs::is_directory(output) &&
        is_within(output, input))
      throw Error("exists, and lies in " + input.string() +
                      ", which the run reads; expected a new name, or another folder",
                  {output.string()});
  }
}

// One set at a time is moved into the places of a folder. The file is removed afterwards; where the
// file system has no locks, sets are moved without.
class CommitLock {
 public:
  explicit CommitLock(const fs::path& folder) : name_(folder / kCommitLock) {
    for (;;) {
      file_.reset(::open(name_.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0644));
      if (!file_.is_open())
        return;  // another user's, or no permission: the moves fail by themselves
      const Lock lock = try_lock(file_.get(), name_);
      if (lock == Lock::kUnsupported || (lock == Lock::kTaken && is_open_as(file_.get(), name_)))
        return;
      file_.reset();
      std::this_thread::sleep_for(std::chrono::milliseconds(lock == Lock::kBusy ? 2 : 0));
    }
  }
  CommitLock(const CommitLock&) = delete;
  CommitLock& operator=(const CommitLock&) = delete;
  ~CommitLock() {
    if (file_.is_open()) ::unlink(name_.c_str());
  }

 private:
  fs::path name_;
  Descriptor file_;
};

// A folder is moved in one step where there is none of its name, so that a run that is killed
// leaves no part of it there.
void move_all(const fs::path& from, const fs::path& to) {
  std::vector<fs::path> all;
  for (const fs::directory_entry& entry : fs::directory_iterator(from)) all.push_back(entry.path());
  std::sort(all.begin(), all.end());
  for (const fs::path& each : all) {
    const fs::path place = to / each.filename();
    if (fs::is_directory(each) && fs::is_directory(place)) {
      move_all(each, place);
      continue;
    }
    std::error_code failed;
    fs::rename(each, place, failed);
    if (failed) throw Error("cannot create: " + failed.message(), {place.string()});
  }
}

}  // namespace

void refuse_twice(const std::vector<fs::path>& inputs) {
  for (std::size_t i = 0; i < inputs.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (is_same(inputs[i], inputs[k]))
        throw Error("is given twice, first as " + inputs[k].string() + "; expected it once",
                    {inputs[i].string()});
}

// A hidden folder of this run, locked as long as the run lives.
class RunFiles::Hidden {
 public:
  explicit Hidden(const fs::path& parent) : parent_(parent), first_made_(first_missing(parent)) {
    make_folders(parent_);
    remove_dead_places(parent_, kHiddenBegins);
    unfinished_.emplace([this] { remove(); });
    try {
      make();
    } catch (...) {
      unfinished_.reset();
      remove();
      throw;
    }
  }
  Hidden(const Hidden&) = delete;
  Hidden& operator=(const Hidden&) = delete;
  ~Hidden() {
    unfinished_.reset();
    remove();
  }

  const fs::path& path() const { return path_; }
  const fs::path& parent() const { return parent_; }

  // Every file, as it will be named.
  std::vector<fs::path> places() const {
    std::vector<fs::path> all;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(path_))
      if (!entry.is_directory()) all.push_back(parent_ / entry.path().lexically_relative(path_));
    return all;
  }

  void move() {
    unfinished_->finish([this] {
      first_made_.clear();
      move_all(path_, parent_);
    });
  }

 private:
  void make() {
    auto made = make_locked_place(PlaceKind::kFolder, parent_, kHiddenBegins);
    if (!made)
      throw Error(std::string("cannot create: ") + std::strerror(errno), {parent_.string()});
    path_ = made->path;
    lock_ = std::move(made->descriptor);
  }

  void remove() const {
    std::error_code ignored;
    if (!path_.empty()) fs::remove_all(path_, ignored);
    remove_empty(parent_, first_made_);
  }

  fs::path parent_;
  fs::path first_made_;
  fs::path path_;
  Descriptor lock_;
  std::optional<Unfinished> unfinished_;
};

RunFiles::RunFiles() = default;
RunFiles::~RunFiles() = default;

RunFiles& RunFiles::reads(const fs::path& input) {
  if (!input.empty()) inputs_.push_back(input);
  const std::string name = input.filename().string();
  const std::size_t percent = name.find('%');
  std::error_code missing;
  if (percent == std::string::npos || fs::exists(input, missing)) return *this;
  for (const fs::directory_entry& entry :
       fs::directory_iterator(fs::absolute(input).parent_path(), missing))
    if (entry.path().extension() == input.extension() &&
        entry.path().filename().string().starts_with(name.substr(0, percent)))
      inputs_.push_back(entry.path());
  return *this;
}

RunFiles& RunFiles::writes(const fs::path& output,
                           bool overwrite,
                           std::initializer_list<const char*> endings) {
  check_output_file(output, overwrite, endings);
  if (!output.empty()) outputs_.push_back({output, false});
  return *this;
}

RunFiles& RunFiles::writes_into(const fs::path& folder,
                                std::initializer_list<const char*> records) {
  check_output_folder(folder);
  // A run that is killed while it moves files into place leaves its hidden folder.
  std::error_code missing;
  const bool has_begun =
      std::any_of(fs::directory_iterator(folder, missing),
                  fs::directory_iterator(),
                  [](const fs::directory_entry& entry) {
                    return entry.path().filename().string().starts_with(kHiddenBegins);
                  });
  if (!has_begun || records.size() == 0) refuse_foreign(folder, records);
  outputs_.push_back({folder, true});
  return *this;
}

RunFiles& RunFiles::replaces(const fs::path& folder) {
  replaced_.push_back(folder);
  return *this;
}

void RunFiles::check() const {
  for (std::size_t i = 0; i < outputs_.size(); ++i) {
    if (!outputs_[i].is_folder) refuse_input(outputs_[i].given, inputs_);
    for (std::size_t k = 0; k < i; ++k)
      if (is_same(outputs_[i].given, outputs_[k].given))
        throw Error("is written twice by the same run; expected a name for each output",
                    {outputs_[i].given.string()});
  }
  for (const fs::path& folder : replaced_)
    for (const fs::path& input : inputs_)
      if (is_within(input, folder))
        throw Error("would be replaced, and holds " + input.string() +
                        ", which the run reads; expected another folder",
                    {folder.string()});
}

RunFiles::Hidden& RunFiles::hidden_for(const Output& output) const {
  return *hidden_.at(plain(output.is_folder ? output.given : folder_of(output.given)));
}

void RunFiles::begin() {
  check();
  for (const Output& output : outputs_) {
    const fs::path parent = output.is_folder ? output.given : folder_of(output.given);
    std::unique_ptr<Hidden>& hidden = hidden_[plain(parent)];
    if (!hidden) hidden = std::make_unique<Hidden>(parent);
  }
}

void RunFiles::write(const fs::path& output,
                     const std::function<void(const fs::path&)>& write) const {
  const auto found = std::find_if(
      outputs_.begin(), outputs_.end(), [&](const Output& one) { return one.given == output; });
  if (found == outputs_.end()) return;
  const Hidden& hidden = hidden_for(*found);
  try {
    write(found->is_folder ? hidden.path() : hidden.path() / output.filename());
  } catch (const Error& error) {
    const fs::path at = error.where().file;
    if (at.empty() || !is_within(at, hidden.path())) throw;
    throw Error(
        error.message(),
        {(hidden.parent() / at.lexically_relative(hidden.path())).lexically_normal().string()});
  }
}

void RunFiles::commit() {
  for (const auto& [folder, hidden] : hidden_)
    for (const fs::path& place : hidden->places()) refuse_input(place, inputs_);
  // In the order of their names, as every other run takes them.
  std::vector<std::unique_ptr<CommitLock>> locks;
  for (const auto& [folder, hidden] : hidden_)
    locks.push_back(std::make_unique<CommitLock>(folder));
  for (const auto& [folder, hidden] : hidden_) hidden->move();
  hidden_.clear();
}

}  // namespace airtruth
