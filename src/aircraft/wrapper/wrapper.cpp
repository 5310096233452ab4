// SPDX-License-Identifier: Apache-2.0
#include "aircraft/wrapper/wrapper.h"

#include <algorithm>
#include <utility>

#include "aircraft/wrapper/part_names.h"
#include "foundation/base/error.h"

namespace airtruth::wrapper {
namespace {

// Of files that include or nest each other; bounds the recursion over a hostile file.
constexpr int kMaxDepth = 12;

// The part of a path below the data root that lies below the folder of `files`; empty: none.
fs::path below_folder(const ModelFiles& files, const fs::path& in_data_root) {
  if (files.in_data_root().empty()) return in_data_root;
  const fs::path below = in_data_root.lexically_normal().lexically_relative(files.in_data_root());
  return below.empty() || *below.begin() == ".." ? fs::path() : below;
}

class WrapperReader {
 public:
  WrapperReader(ModelFiles& files, const Cruise& cruise, std::set<std::string>& missing)
      : files_(files), cruise_(cruise), missing_(missing) {}

  Wrapper read(const fs::path& file, int depth) {
    if (depth > kMaxDepth) throw Error("nests itself", {files_.shown(file).string()});
    Wrapper wrapper = read_text(file, 0);
    wrapper.file = file;
    const fs::path folder = file.parent_path();
    if (!wrapper.path.empty()) wrapper.model = find_named_file(files_, wrapper.path, folder);
    if (!wrapper.path.empty() && wrapper.model.empty())
      throw Error("names the model " + wrapper.path + ", which does not exist below the folder " +
                      files_.shown(".").lexically_normal().string(),
                  {files_.shown(file).string()});
    if (!wrapper.texture_path.empty())
      wrapper.texture_folder = find_named_file(files_, wrapper.texture_path, folder);
    for (const Wrapper& stated : std::exchange(wrapper.nested, {}))
      if (auto nested = nested_of(stated, folder, depth))
        wrapper.nested.push_back(*std::move(nested));
    return wrapper;
  }

 private:
  Wrapper read_text(const fs::path& file, int depth) {
    if (depth > kMaxDepth) throw Error("includes itself", {files_.shown(file).string()});
    const auto read_table = [&](const std::string& name) {
      const fs::path table = file.parent_path() / name;
      return parse_table(files_.read(table, kMaxWrapperBytes), files_.shown(table));
    };
    Wrapper own =
        parse_wrapper(files_.read(file, kMaxWrapperBytes), files_.shown(file), cruise_, read_table);
    if (own.include.empty()) return own;
    Wrapper base = read_text(file.parent_path() / own.include, depth + 1);
    if (!own.path.empty()) base.path = own.path;
    if (!own.texture_path.empty()) base.texture_path = own.texture_path;
    if (own.nested_from_model) base.nested_from_model = own.nested_from_model;
    base.animations.insert(base.animations.end(), own.animations.begin(), own.animations.end());
    base.nested.insert(base.nested.end(), own.nested.begin(), own.nested.end());
    return base;
  }

  std::optional<Wrapper> nested_of(const Wrapper& stated, const fs::path& folder, int depth) {
    if (stated.path.empty() || is_effect_path(stated.path)) return std::nullopt;
    const fs::path path = find_named_file(files_, stated.path, folder);
    if (path.empty()) {
      missing_.insert(stated.path);
      return std::nullopt;
    }
    Wrapper nested;
    if (path.extension() == ".xml")
      nested = read(path, depth + 1);
    else
      nested.file = nested.model = path;
    nested.name = stated.name;
    nested.parent_from_nested = stated.parent_from_nested;
    nested.condition = stated.condition;
    return nested;
  }

  ModelFiles& files_;
  const Cruise& cruise_;
  std::set<std::string>& missing_;
};

}  // namespace

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

Wrapper read_wrapper(ModelFiles& files,
                     const fs::path& file,
                     const Cruise& cruise,
                     std::set<std::string>& missing) {
  return WrapperReader(files, cruise, missing).read(file, 0);
}

}  // namespace airtruth::wrapper
