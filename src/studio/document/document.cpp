// SPDX-License-Identifier: Apache-2.0
#include "studio/document/document.h"

#include <utility>

#include <fmt/format.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "scene/scene/tables.h"
#include "studio/document/splice.h"
#include "studio/document/tree.h"

namespace airtruth::document {
namespace {

History history_of(const fs::path& file, std::optional<std::string> begun) {
  if (!fs::exists(file) && begun) return {std::move(*begun), ""};
  std::string text = read_file(file, scene::kLargestToml);
  std::string sha256 = sha256_of(text);
  if (utf8_fault(text) != std::string::npos)
    throw Error("is not UTF-8; expected a text file in UTF-8", {file.string()});
  return {std::move(text), std::move(sha256)};
}

fs::file_time_type time_of(const fs::path& file) {
  std::error_code error;
  const auto time = fs::last_write_time(file, error);
  return error ? fs::file_time_type{} : time;
}

Tables tables_in(const Node& root) {
  Tables tables;
  for (const char* array : {"intruder", "distractor"}) {
    const Node* node = root.member(array);
    for (std::size_t i = 0; node != nullptr && i < node->elements.size(); ++i)
      tables.emplace(Begin{node->elements[i].line, node->elements[i].column},
                     nlohmann::ordered_json{array, i});
  }
  return tables;
}

}  // namespace

Document::Document(fs::path file, std::optional<std::string> begun, Warn warn)
    : file_(fs::is_symlink(file) ? fs::canonical(file) : std::move(file)),
      warn_(std::move(warn)),
      journal_(file_, warn_),
      history_(history_of(file_, std::move(begun))),
      saved_(!history_.file_sha256.empty()),
      looked_at_(time_of(file_)) {
  recover();
  take();
}

void Document::recover() {
  std::optional<History> left = journal_.read();
  if (!left) return;
  if (left->text() == history_.text()) return journal_.remove();
  changed_on_disk_ = left->file_sha256 != history_.file_sha256;
  history_ = std::move(*left);
  saved_ = false;
  warn(warn_,
       fmt::format("{}: {} steps that were not saved are taken up{}",
                   file_.string(),
                   history_.undo_count(),
                   changed_on_disk_ ? "; another program has changed the file since" : ""));
}

// Reads the present text.
void Document::take() {
  ++revision_;
  sha256_ = sha256_of(text());
  try {
    Tree tree = tree_of(text(), file_.string());
    tables_ = tables_in(tree.root);
    notes_ = notes_of(tree.root, text());
    values_ = std::move(tree.values);
  } catch (const Error&) {
    values_ = nullptr;  // the page keeps what it had
  }
  try {
    scene_ = scene::parse_scene(text(), file_);
    problem_.clear();
  } catch (const Error& error) {
    scene_.reset();
    problem_ = error.what();
  }
}

template <typename Write>
void Document::record(const Write& write) {
  const bool is_said = !journal_fault_.empty();
  journal_fault_.clear();
  try {
    write();
  } catch (const Error& error) {
    journal_fault_ = std::string(
                         "what is not saved is lost when the studio ends, since its journal "
                         "cannot be written: ") +
                     error.what();
    if (!is_said) warn(warn_, journal_fault_);
  }
}

void Document::add(Edit edit) {
  if (edit.removed == edit.put) return;
  history_.add(edit);
  saved_ = false;
  record([&] { journal_.add(edit, history_); });
  take();
}

bool Document::edit(const std::vector<Change>& changes,
                    const std::string& merge,
                    const std::string& upon) {
  const bool is_upon_present = upon.empty() || upon == sha256_;
  if (!is_upon_present && upon != sha256_of(edited_)) return false;
  std::string next = is_upon_present ? text() : edited_;
  for (const Change& change : changes) next = changed(next, change, file_.string());
  if (!is_upon_present) return next == text();
  if (next.size() > scene::kLargestToml)
    throw Error("would be larger than 16 MiB", {file_.string()});
  edited_ = text();
  add(edit_between(text(), next, merge));
  return true;
}

void Document::undo() {
  history_.undo();
  saved_ = sha256_of(text()) == history_.file_sha256;
  record([&] { journal_.undo(history_); });
  take();
}

void Document::redo() {
  history_.redo();
  saved_ = sha256_of(text()) == history_.file_sha256;
  record([&] { journal_.redo(history_); });
  take();
}

void Document::save() {
  look_at_disk();
  if (changed_on_disk_)
    throw Error("was changed by another program; expected to take its text, or to keep yours",
                {file_.string()});
  write_file(file_, text());
  history_.file_sha256 = sha256_of(text());
  looked_at_ = {};  // another program may write at once: the next look reads the file
  saved_ = true;
  changed_on_disk_ = false;
  journal_.remove();
}

void Document::reload() {
  const std::optional<std::string> text_there = on_disk();
  if (!text_there) throw Error("cannot be read; expected a text file in UTF-8", {file_.string()});
  history_.file_sha256 = sha256_of(*text_there);
  add(edit_between(text(), *text_there, ""));
  saved_ = true;
  changed_on_disk_ = false;
  journal_.remove();
}

void Document::keep() {
  looked_at_ = time_of(file_);
  if (const std::string there = sha256_on_disk(); !there.empty()) history_.file_sha256 = there;
  saved_ = sha256_ == history_.file_sha256;
  changed_on_disk_ = false;
  record([&] { journal_.begin(history_); });
}

bool Document::look_at_disk() {
  const fs::file_time_type time = time_of(file_);
  if (time == looked_at_) return false;
  const std::string there = sha256_on_disk();
  if (there.empty() && !fs::exists(file_)) return false;  // an editor is replacing it
  if (!there.empty()) looked_at_ = time;
  if (there == history_.file_sha256) return false;
  if (!saved_ || !on_disk()) return !std::exchange(changed_on_disk_, true);
  reload();
  return true;
}

std::string Document::sha256_on_disk() const {
  try {
    return sha256_of_file(file_);
  } catch (const Error&) {
    return "";
  }
}

std::optional<std::string> Document::on_disk() const {
  try {
    std::string text = read_file(file_, scene::kLargestToml);
    if (utf8_fault(text) != std::string::npos) return std::nullopt;
    return text;
  } catch (const Error&) {
    return std::nullopt;
  }
}

nlohmann::ordered_json Document::state() const {
  const auto text_or_null = [](const std::string& text) {
    return text.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(text);
  };
  return {{"revision", revision_},
          {"text", text()},
          {"sha256", sha256_},
          {"scene", values_},
          {"notes", notes_},
          {"problem", text_or_null(problem_)},
          {"saved", saved_ && !changed_on_disk_},
          {"undo", history_.undo_count()},
          {"redo", history_.redo_count()},
          {"changed_on_disk", changed_on_disk_},
          {"journal_fault", text_or_null(journal_fault_)}};
}

}  // namespace airtruth::document
