// SPDX-License-Identifier: Apache-2.0
#include "aircraft/wrapper/wrapper.h"

#include <algorithm>
#include <array>
#include <cctype>

#include "foundation/base/error.h"
#include "foundation/base/files.h"

namespace airtruth::aircraft {
namespace {

constexpr std::size_t kMaxWrapperBytes = 8u << 20;
constexpr int kMaxDepth = 12;

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

WrapperText read_text(ModelFiles& files, const fs::path& file, int depth) {
  if (depth > kMaxDepth) throw Error("includes itself", {files.shown(file).string()});
  WrapperText own = parse_wrapper(files.read(file, kMaxWrapperBytes), files.shown(file));
  for (Animation& animation : own.animations) {
    if (animation.table_file.empty()) continue;
    const fs::path table = file.parent_path() / animation.table_file;
    animation.value.table = parse_table(files.read(table, kMaxWrapperBytes), files.shown(table));
  }
  if (own.include.empty()) return own;
  WrapperText base = read_text(files, file.parent_path() / own.include, depth + 1);
  if (!own.path.empty()) base.path = own.path;
  if (!own.texture_path.empty()) base.texture_path = own.texture_path;
  if (own.parent_from_model) base.parent_from_model = own.parent_from_model;
  base.animations.insert(base.animations.end(), own.animations.begin(), own.animations.end());
  base.nested.insert(base.nested.end(), own.nested.begin(), own.nested.end());
  return base;
}

Wrapper read_at(ModelFiles& files, const fs::path& file, std::set<std::string>& missing, int depth);

void add_nested(const WrapperText::Nested& text,
                Wrapper& wrapper,
                ModelFiles& files,
                std::set<std::string>& missing,
                int depth) {
  if (text.path.empty() || is_effect_path(text.path)) return;
  const fs::path path = find_named_file(files, text.path, wrapper.file.parent_path());
  if (path.empty()) {
    missing.insert(text.path);
    return;
  }
  Wrapper nested;
  if (path.extension() == ".xml") {
    nested = read_at(files, path, missing, depth + 1);
  } else {
    nested.file = path;
    nested.model = path;
  }
  nested.name = text.name;
  nested.parent_from_nested = text.parent_from_model;
  if (text.condition) nested.conditions.push_back(*text.condition);
  wrapper.nested.push_back(std::move(nested));
}

Wrapper read_at(ModelFiles& files,
                const fs::path& file,
                std::set<std::string>& missing,
                int depth) {
  if (depth > kMaxDepth) throw Error("nests itself", {files.shown(file).string()});
  const WrapperText text = read_text(files, file, 0);
  Wrapper wrapper;
  wrapper.file = file;
  if (!text.path.empty()) {
    wrapper.model = find_named_file(files, text.path, file.parent_path());
    if (wrapper.model.empty())
      throw Error("names the model " + text.path + ", which does not exist below the folder " +
                      files.shown(".").lexically_normal().string(),
                  {files.shown(file).string()});
  }
  if (!text.texture_path.empty())
    wrapper.texture_folder = find_named_file(files, text.texture_path, file.parent_path());
  if (text.parent_from_model) wrapper.nested_from_model = *text.parent_from_model;
  wrapper.animations = text.animations;
  for (const WrapperText::Nested& nested : text.nested)
    add_nested(nested, wrapper, files, missing, depth);
  return wrapper;
}

// The part of a path below the data root that lies below the folder of `files`; empty: none.
fs::path below_folder(const ModelFiles& files, const fs::path& in_data_root) {
  if (files.in_data_root().empty()) return in_data_root;
  const fs::path below = in_data_root.lexically_normal().lexically_relative(files.in_data_root());
  return below.empty() || *below.begin() == ".." ? fs::path() : below;
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

fs::path find_named_file(ModelFiles& files, const std::string& path, const fs::path& folder) {
  const auto is_there = [&](const fs::path& at) {
    return files.kind(at) != ModelFiles::Kind::kNone;
  };
  std::string clean = path;
  std::replace(clean.begin(), clean.end(), '\\', '/');
  if (is_there(folder / clean)) return (folder / clean).lexically_normal();
  while (!clean.empty() && clean.front() == '/') clean.erase(0, 1);  // of the data root
  if (clean.empty()) return {};
  for (const fs::path& candidate : {fs::path(clean), "AI" / fs::path(clean)}) {
    const fs::path below = below_folder(files, candidate);
    if (!below.empty() && is_there(below)) return below.lexically_normal();
  }
  return {};
}

Wrapper read_wrapper(ModelFiles& files, const fs::path& file, std::set<std::string>& missing) {
  return read_at(files, file, missing, 0);
}

}  // namespace airtruth::aircraft
