// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "foundation/base/descriptor.h"
#include "foundation/base/log.h"

// What was done to a scene since it was saved, on the disk: a crash loses nothing.
namespace airtruth::document {

// A replacement in a text, which can be taken back.
struct Edit {
  std::size_t at = 0;
  std::string removed;
  std::string put;
  // Edits in a row with the same name are one step of undo; empty: a step of its own.
  std::string merge;
};
// The least replacement that turns one text into another.
Edit edit_between(std::string_view before, std::string_view after, std::string merge);

// The steps of a text from its first form on. Those that were taken back can be repeated until
// another is added.
class History {
 public:
  // `file_sha256`: of what the file holds, by which a later process sees that others changed it;
  // "": there is no file.
  History(std::string first, std::string file_sha256)
      : first(std::move(first)), file_sha256(std::move(file_sha256)), text_(this->first) {}

  const std::string& text() const { return text_; }
  std::size_t undo_count() const { return in_force_; }
  std::size_t redo_count() const { return edits_.size() - in_force_; }
  const std::vector<Edit>& edits() const { return edits_; }

  // Each throws Error where the step does not fit.
  void add(const Edit& edit);
  void undo();
  void redo();

  std::string first;
  std::string file_sha256;

 private:
  std::vector<Edit> edits_;
  std::size_t in_force_ = 0;
  std::string text_;
};

// A file of JSON lines: the first text, then a line for each step. It is there from the first
// change on. When it is larger than kMostBytes it begins anew with the text of that moment,
// and also where a step goes back beyond that text.
// One process at a time has the journal of a file: the lock is on ".NAME.studio-lock" beside it,
// which is removed at the end.
class Journal {
 public:
  static constexpr std::size_t kMostBytes = std::size_t{16} << 20;

  // ".NAME.studio-journal" beside the file. Throws Error where another studio has the file open.
  // Where the folder takes no lock the studio goes on without one, with a word to `warn`.
  Journal(const std::filesystem::path& file, const Warn& warn);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  // What an earlier process left; a last line that it had not finished is left out. Empty where
  // there is none. Throws Error where the file is no journal.
  std::optional<History> read() const;

  // Append a step to the file. `history` is that after the step, and begins the file where it is
  // not there. Throw Error where it cannot be written.
  void add(const Edit& edit, const History& history);
  void undo(const History& history);
  void redo(const History& history);
  // Writes the file anew.
  void begin(const History& history) { write_anew(history, true); }
  // Waits until all is on the disk.
  void flush();
  void remove();

 private:
  void append(const std::string& line, const History& history, bool is_known);
  void write_anew(const History& history, bool with_steps);
  void write(const std::string& line);

  std::filesystem::path path_;
  std::filesystem::path lock_path_;
  Descriptor lock_;
  Descriptor file_;
  std::size_t bytes_ = 0;
  std::size_t begun_at_ = 0;  // steps of the history before the file's first text
  std::size_t undone_ = 0;    // steps of the file that can be repeated
  bool is_flushed_ = true;
};

}  // namespace airtruth::document
