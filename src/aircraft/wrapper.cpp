// SPDX-License-Identifier: Apache-2.0
#include "aircraft/wrapper.h"

#include <algorithm>
#include <array>
#include <cctype>

#include "base/error.h"
#include "base/files.h"

namespace airtruth::aircraft {
namespace {

constexpr std::size_t kMaxWrapperBytes = 8u << 20;
constexpr int kMaxDepth = 12;
constexpr std::size_t kMaxFiles = 2000;

bool is_there(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

// The folder above `folder` that holds AI/Aircraft; empty: none does.
fs::path data_root_of(const fs::path& folder) {
  for (fs::path at = fs::absolute(folder).lexically_normal();; at = at.parent_path()) {
    if (is_there(at / "AI" / "Aircraft")) return at;
    if (at == at.parent_path()) return {};
  }
}

WrapperText read_text(const fs::path& file, std::vector<fs::path>& sources, int depth) {
  if (depth > kMaxDepth) throw Error("includes itself", {file.string()});
  if (sources.size() > kMaxFiles) throw Error("takes in over 2000 files", {file.string()});
  sources.push_back(file);
  WrapperText own = parse_wrapper(read_file(file, kMaxWrapperBytes), file);
  for (Animation& animation : own.animations) {
    if (animation.table_file.empty()) continue;
    const fs::path table = file.parent_path() / animation.table_file;
    sources.push_back(table);
    animation.value.table = parse_table(read_file(table, kMaxWrapperBytes), table);
  }
  if (own.include.empty()) return own;
  WrapperText base = read_text(file.parent_path() / own.include, sources, depth + 1);
  if (!own.path.empty()) base.path = own.path;
  if (!own.texture_path.empty()) base.texture_path = own.texture_path;
  if (own.parent_from_model) base.parent_from_model = own.parent_from_model;
  base.animations.insert(base.animations.end(), own.animations.begin(), own.animations.end());
  base.nested.insert(base.nested.end(), own.nested.begin(), own.nested.end());
  return base;
}

Wrapper read_at(const fs::path& file,
                std::vector<fs::path>& sources,
                std::set<std::string>& missing,
                int depth);

void add_nested(const WrapperText::Nested& text,
                Wrapper& wrapper,
                std::vector<fs::path>& sources,
                std::set<std::string>& missing,
                int depth) {
  if (text.path.empty() || is_effect_path(text.path)) return;
  const fs::path path = find_named_file(text.path, wrapper.file.parent_path());
  if (path.empty()) {
    missing.insert(text.path);
    return;
  }
  Wrapper nested;
  if (path.extension() == ".xml") {
    nested = read_at(path, sources, missing, depth + 1);
  } else {
    nested.file = path;
    nested.model = path;
  }
  nested.name = text.name;
  nested.parent_from_nested = text.parent_from_model;
  if (text.condition) nested.conditions.push_back(*text.condition);
  wrapper.nested.push_back(std::move(nested));
}

Wrapper read_at(const fs::path& file,
                std::vector<fs::path>& sources,
                std::set<std::string>& missing,
                int depth) {
  if (depth > kMaxDepth) throw Error("nests itself", {file.string()});
  const WrapperText text = read_text(file, sources, 0);
  Wrapper wrapper;
  wrapper.file = file;
  if (!text.path.empty()) {
    wrapper.model = find_named_file(text.path, file.parent_path());
    if (wrapper.model.empty())
      throw Error("names the model " + text.path + ", which does not exist", {file.string()});
  }
  if (!text.texture_path.empty())
    wrapper.texture_folder = find_named_file(text.texture_path, file.parent_path());
  if (text.parent_from_model) wrapper.nested_from_model = *text.parent_from_model;
  wrapper.animations = text.animations;
  for (const WrapperText::Nested& nested : text.nested)
    add_nested(nested, wrapper, sources, missing, depth);
  return wrapper;
}

}  // namespace

bool is_effect_path(const std::string& path) {
  static const std::array<const char*, 12> kWords = {"light",
                                                     "beacon",
                                                     "strobe",
                                                     "halo",
                                                     "flare",
                                                     "/effects/",
                                                     "smoke",
                                                     "contrail",
                                                     "rain",
                                                     "/sounds/",
                                                     "/sound/",
                                                     "exhaust"};
  std::string text = lower(path);
  std::replace(text.begin(), text.end(), '\\', '/');
  const auto lightning = text.find("lightning");  // an aircraft
  if (lightning != std::string::npos) text.erase(lightning, 9);
  const auto train = text.find("train");  // and "trainer"
  if (train != std::string::npos) text.erase(train, 5);
  return std::any_of(kWords.begin(), kWords.end(), [&](const char* word) {
    return text.find(word) != std::string::npos;
  });
}

fs::path find_named_file(const std::string& path, const fs::path& folder) {
  std::string clean = path;
  std::replace(clean.begin(), clean.end(), '\\', '/');
  if (is_there(folder / clean)) return folder / clean;
  while (!clean.empty() && clean.front() == '/') clean.erase(0, 1);  // of the data root
  const fs::path root = data_root_of(folder);
  if (root.empty() || clean.empty()) return {};
  for (const fs::path& candidate : {root / clean, root / "AI" / clean})
    if (is_there(candidate)) return candidate;
  return {};
}

WrapperText read_with_includes(const fs::path& file, std::vector<fs::path>& sources) {
  return read_text(file, sources, 0);
}

Wrapper read_wrapper(const fs::path& file,
                     std::vector<fs::path>& sources,
                     std::set<std::string>& missing) {
  return read_at(file, sources, missing, 0);
}

}  // namespace airtruth::aircraft
