// SPDX-License-Identifier: Apache-2.0
#include "studio/document/journal.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "foundation/base/error.h"
#include "foundation/base/file_state.h"
#include "foundation/base/files.h"

namespace airtruth::document {
namespace {

using Json = nlohmann::ordered_json;

Json json_of_edit(const Edit& edit) {
  return {{"at", edit.at}, {"removed", edit.removed}, {"put", edit.put}, {"merge", edit.merge}};
}

void replace(std::string& text, std::size_t at, const std::string& from, const std::string& to) {
  if (at > text.size() || text.compare(at, from.size(), from) != 0)
    throw Error("a step does not fit the text before it");
  text.replace(at, from.size(), to);
}

void take_line(History& history, const Json& line) {
  if (line.contains("undo")) return history.undo();
  if (line.contains("redo")) return history.redo();
  history.add({line.at("at").get<std::size_t>(),
               line.at("removed").get<std::string>(),
               line.at("put").get<std::string>(),
               line.at("merge").get<std::string>()});
}

std::filesystem::path beside(const std::filesystem::path& file, const char* ending) {
  return std::filesystem::absolute(file).parent_path() / ("." + file.filename().string() + ending);
}

// Not open where the folder cannot be written: then nor can the journal, which is said.
Descriptor lock_on(const std::filesystem::path& path,
                   const std::filesystem::path& file,
                   const Warn& warn) {
  for (;;) {
    Descriptor lock(::open(path.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0644));
    if (!lock.is_open()) return lock;
    const Lock state = try_lock(lock.get(), path);
    if (state == Lock::kBusy)
      throw Error("is open in another studio; expected to end that one first", {file.string()});
    if (state == Lock::kUnsupported) warn_of_no_locks(file, warn);
    // One that ends may have removed the file before it was locked.
    if (is_open_as(lock.get(), path)) return lock;
  }
}

}  // namespace

Edit edit_between(std::string_view before, std::string_view after, std::string merge) {
  const std::size_t shorter = std::min(before.size(), after.size());
  std::size_t same = 0;
  while (same < shorter && before[same] == after[same]) ++same;
  std::size_t tail = 0;
  while (tail < shorter - same &&
         before[before.size() - 1 - tail] == after[after.size() - 1 - tail])
    ++tail;
  // Journal lines are UTF-8: a character is replaced whole.
  const auto is_inside = [](std::string_view text, std::size_t at) {
    return at < text.size() && (static_cast<unsigned char>(text[at]) & 0xC0U) == 0x80U;
  };
  while (same > 0 && (is_inside(before, same) || is_inside(after, same))) --same;
  while (tail > 0 &&
         (is_inside(before, before.size() - tail) || is_inside(after, after.size() - tail)))
    --tail;
  return {same,
          std::string(before.substr(same, before.size() - tail - same)),
          std::string(after.substr(same, after.size() - tail - same)),
          std::move(merge)};
}

void History::add(const Edit& edit) {
  std::string after = text_;
  replace(after, edit.at, edit.removed, edit.put);
  edits_.resize(in_force_);
  Edit whole = edit;
  if (!edits_.empty() && !edit.merge.empty() && edits_.back().merge == edit.merge) {
    const Edit last = edits_.back();
    std::string before = text_;
    replace(before, last.at, last.put, last.removed);
    whole = edit_between(before, after, edit.merge);
    edits_.pop_back();
  }
  edits_.push_back(std::move(whole));
  in_force_ = edits_.size();
  text_ = std::move(after);
}

void History::undo() {
  if (in_force_ == 0) throw Error("there is nothing to undo");
  const Edit& edit = edits_[in_force_ - 1];
  replace(text_, edit.at, edit.put, edit.removed);
  --in_force_;
}

void History::redo() {
  if (in_force_ == edits_.size()) throw Error("there is nothing to redo");
  const Edit& edit = edits_[in_force_];
  replace(text_, edit.at, edit.removed, edit.put);
  ++in_force_;
}

Journal::Journal(const std::filesystem::path& file, const Warn& warn)
    : path_(beside(file, ".studio-journal")),
      lock_path_(beside(file, ".studio-lock")),
      lock_(lock_on(lock_path_, file, warn)) {}

Journal::~Journal() {
  std::error_code ignored;
  if (lock_.is_open()) std::filesystem::remove(lock_path_, ignored);
}

std::optional<History> Journal::read() const {
  if (!std::filesystem::exists(path_)) return std::nullopt;
  const std::string bytes = read_file(path_, 2 * kMostBytes);
  std::optional<History> history;
  int line = 0;
  try {
    for (std::size_t begin = 0, end = 0; (end = bytes.find('\n', begin)) != std::string::npos;
         begin = end + 1) {
      ++line;
      const Json json = Json::parse(bytes.begin() + static_cast<std::ptrdiff_t>(begin),
                                    bytes.begin() + static_cast<std::ptrdiff_t>(end));
      if (history)
        take_line(*history, json);
      else
        history.emplace(json.at("first").get<std::string>(), json.at("file").get<std::string>());
    }
  } catch (const Error& error) {
    throw Error("is no journal of a studio: " + error.message(), {path_.string(), line});
  } catch (const Json::exception&) {
    throw Error("is no journal of a studio; move it away to begin anew", {path_.string(), line});
  }
  return history;
}

void Journal::add(const Edit& edit, const History& history) {
  undone_ = 0;
  append(json_of_edit(edit).dump() + "\n", history, true);
}
void Journal::undo(const History& history) {
  ++undone_;
  append("{\"undo\":1}\n", history, history.undo_count() >= begun_at_);
}
void Journal::redo(const History& history) {
  const bool is_known = undone_ > 0;
  if (is_known) --undone_;
  append("{\"redo\":1}\n", history, is_known);
}

// `is_known`: the step is within what the file holds.
void Journal::append(const std::string& line, const History& history, bool is_known) {
  if (!file_.is_open() || !is_known || bytes_ + line.size() > kMostBytes)
    return write_anew(history, !file_.is_open());
  write(line);
}

// The file as the history has it, or with the present text alone, also where the steps are too
// large.
void Journal::write_anew(const History& history, bool with_steps) {
  std::string text =
      Json{{"first", with_steps ? history.first : history.text()}, {"file", history.file_sha256}}
          .dump() +
      "\n";
  if (with_steps) {
    for (const Edit& edit : history.edits()) text += json_of_edit(edit).dump() + "\n";
    for (std::size_t i = 0; i < history.redo_count(); ++i) text += "{\"undo\":1}\n";
  }
  if (with_steps && text.size() > kMostBytes) return write_anew(history, false);
  write_file(path_, text);
  file_.reset(::open(path_.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC));
  if (!file_.is_open()) throw Error(std::generic_category().message(errno), {path_.string()});
  bytes_ = text.size();
  begun_at_ = with_steps ? 0 : history.undo_count();
  undone_ = with_steps ? history.redo_count() : 0;
}

void Journal::write(const std::string& line) {
  std::size_t done = 0;
  while (done < line.size()) {
    const ssize_t wrote = ::write(file_.get(), line.data() + done, line.size() - done);
    if (wrote < 0 && errno == EINTR) continue;
    if (wrote <= 0) {
      const int reason = errno;
      file_.reset();  // the next step writes the file anew, without the part of this line
      throw Error(std::generic_category().message(reason), {path_.string()});
    }
    done += static_cast<std::size_t>(wrote);
  }
  bytes_ += line.size();
  is_flushed_ = false;
}

void Journal::flush() {
  if (file_.is_open() && !std::exchange(is_flushed_, true)) ::fdatasync(file_.get());
}

void Journal::remove() {
  file_.reset();
  bytes_ = 0;
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
}

}  // namespace airtruth::document
