// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "foundation/base/error.h"
#include "foundation/base/log.h"
#include "scene/scene/scene.h"
#include "studio/document/change.h"
#include "studio/document/journal.h"

// A scene file that is being edited: its text, the steps back to its beginning, and the file.
namespace airtruth::document {

// Line and column where a table begins, by which all that reads the scene names it: several inline
// tables can be on one line.
using Begin = std::pair<int, int>;
inline Begin begin_of(const Where& where) { return {where.line, where.column}; }
// The tables of arrays, ["intruder", 0] and so on.
using Tables = std::map<Begin, nlohmann::ordered_json>;

class Document {
 public:
  // Reads the file and takes up what an earlier process left in the journal, with a word to `warn`.
  // `begun` is the text where there is no file yet; it is written at the first save. Throws Error
  // where the file is larger than 16 MiB, is not UTF-8, is open in another studio, or there is
  // neither.
  Document(std::filesystem::path file, std::optional<std::string> begun, Warn warn);

  const std::filesystem::path& file() const { return file_; }
  const std::string& text() const { return history_.text(); }
  // Counts the texts.
  std::int64_t revision() const { return revision_; }
  // Empty where the text is no scene; problem() then says why.
  const std::optional<scene::Scene>& scene() const { return scene_; }
  const std::string& problem() const { return problem_; }

  // The tables of [[intruder]] and [[distractor]].
  const Tables& tables() const { return tables_; }

  // All changes or none. With the `merge` of the edit before, both are one step of undo. `upon`:
  // the SHA-256 of the text that they are made upon, since they name tables by their places; "":
  // any. False, and nothing is done, where the text is another one, unless these changes gave it:
  // an edit whose answer was lost can be sent again. Throws Error where a change cannot be made.
  bool edit(const std::vector<Change>& changes,
            const std::string& merge,
            const std::string& upon = "");
  // Throw Error where there is nothing to take back or to repeat.
  void undo();
  void redo();
  // Throws Error where the file was changed by others, and neither reload() nor keep() answered it.
  void save();
  // Takes the file's text, as a step that can be taken back.
  void reload();
  // Leaves what others made of the file aside: the next save replaces it.
  void keep();
  // Looks at the file; true where the state is another than before: others changed the file, which
  // is taken where all was saved and it is a text.
  bool look_at_disk();
  // Waits until the journal is on the disk.
  void flush() { journal_.flush(); }

  // {"revision", "text", "sha256", "scene", "notes", "problem", "saved", "undo", "redo",
  // "changed_on_disk"}
  nlohmann::ordered_json state() const;

 private:
  void recover();
  void take();
  void add(Edit edit);
  // Writes a step to the journal. Where that fails it says so once, and state() does.
  template <typename Write>
  void record(const Write& write);
  // Of the file's bytes, whatever they are; "" where they cannot be read.
  std::string sha256_on_disk() const;
  // The file's text; empty where it cannot be read or is none.
  std::optional<std::string> on_disk() const;

  std::filesystem::path file_;
  Warn warn_;
  Journal journal_;
  std::string journal_fault_;  // why the last step is not in it; empty: it is
  History history_;
  std::string sha256_;  // of the text
  std::string edited_;  // the text that the last edit was made upon
  std::int64_t revision_ = 0;
  bool saved_ = true;
  bool changed_on_disk_ = false;
  std::filesystem::file_time_type looked_at_{};
  std::optional<scene::Scene> scene_;
  std::string problem_;
  nlohmann::ordered_json values_;
  nlohmann::ordered_json notes_ = nlohmann::ordered_json::object();
  Tables tables_;
};

}  // namespace airtruth::document
