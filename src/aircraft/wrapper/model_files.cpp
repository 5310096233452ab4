// SPDX-License-Identifier: Apache-2.0
#include "aircraft/wrapper/model_files.h"

#include <algorithm>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/names.h"
#include "foundation/base/text.h"

namespace airtruth::wrapper {
namespace {

// Number of files: a bound for untrusted files, far above those of any aircraft.
constexpr std::size_t kMaxModelReads = 2000;
constexpr std::size_t kMaxPathBytes = 4096;  // PATH_MAX
// Number of files of a folder among which a name is searched whatever its case.
constexpr std::size_t kMaxListed = 10'000;

// The path in normal form; empty where it leaves the folder.
fs::path inside(const fs::path& path) {
  const std::string& text = path.native();
  if (text.empty() || text.size() > kMaxPathBytes || text.find('\0') != std::string::npos ||
      path.is_absolute())
    return {};
  const fs::path normal = path.lexically_normal();
  if (*normal.begin() == "..") return {};
  return normal;
}

}  // namespace

ModelFiles::ModelFiles(fs::path shown_folder, fs::path in_data_root)
    : shown_folder_(std::move(shown_folder)), in_data_root_(std::move(in_data_root)) {}

ModelFiles::Kind ModelFiles::kind(const fs::path& path) {
  const fs::path normal = inside(path);
  return normal.empty() ? Kind::kNone : kind_below(normal);
}

std::string ModelFiles::read(const fs::path& path, std::size_t max_bytes) {
  const fs::path normal = inside(path);
  if (normal.empty())
    throw Error("lies outside the folder " +
                    (shown_folder_.empty() ? "." : shown_folder_.string()) +
                    "; expected a file in it or below",
                {shown(path).string()});
  if (++reads_ > kMaxModelReads)
    throw Error("takes in over " + std::to_string(kMaxModelReads) + " files",
                {shown(path).string()});
  return read_below(normal, max_bytes);
}

fs::path ModelFiles::shown(const fs::path& path) const {
  return shown_folder_.empty() ? path : shown_folder_ / path;
}

DiskFiles::DiskFiles(const fs::path& folder,
                     const fs::path& in_data_root,
                     bool hashes,
                     LetterCase letter_case)
    : ModelFiles(folder, in_data_root), hashes_(hashes), letter_case_(letter_case) {
  std::error_code ignored;
  folder_ = fs::canonical(folder.empty() ? fs::path(".") : folder, ignored);
}

// The file of that name, whatever the case of its letters where that is asked for: names from DOS
// and Windows have none. The path itself where there is no such file, or several.
fs::path DiskFiles::whatever_case(const fs::path& path) const {
  std::error_code failed;
  if (letter_case_ == LetterCase::kMatters ||
      fs::exists(fs::symlink_status(folder_ / path, failed)))
    return path;
  const fs::path folder = path.parent_path();
  const std::string wanted = lower_case(path.filename().string());
  fs::path found;
  std::size_t seen = 0;
  for (fs::directory_iterator at(folder_ / folder, failed), end; !failed && at != end;
       at.increment(failed)) {
    if (++seen > kMaxListed) return path;
    const fs::path name = at->path().filename();
    if (lower_case(name.string()) != wanted) continue;
    if (!found.empty()) return path;
    found = folder / name;
  }
  return found.empty() ? path : found;
}

// The path without symbolic links; empty where nothing is there or it leads out of the folder.
fs::path DiskFiles::resolved(const fs::path& path) const {
  std::error_code missing;
  const fs::path real = fs::canonical(folder_ / whatever_case(path), missing);
  if (missing || folder_.empty()) return {};
  const auto differ = std::mismatch(folder_.begin(), folder_.end(), real.begin(), real.end()).first;
  return differ == folder_.end() ? real : fs::path();
}

ModelFiles::Kind DiskFiles::kind_below(const fs::path& path) {
  const fs::path real = resolved(path);
  std::error_code ignored;
  const Kind kind = fs::is_regular_file(real, ignored) ? Kind::kFile
                    : fs::is_directory(real, ignored)  ? Kind::kFolder
                                                       : Kind::kNone;
  if (hashes_) asked_.push_back({path.string(), std::to_string(static_cast<int>(kind))});
  return kind;
}

std::string DiskFiles::read_below(const fs::path& path, std::size_t max_bytes) {
  const fs::path real = resolved(path);
  const std::string name = shown(path).string();
  std::error_code ignored;
  if (real.empty()) {
    if (fs::exists(fs::symlink_status(folder_ / path, ignored)))
      throw Error("leads out of its model's folder through a symbolic link", {name});
    throw Error("does not exist; expected a file of a 3D model", {name});
  }
  if (!fs::is_regular_file(real, ignored))
    throw Error("is no regular file; expected a file of a 3D model", {name});
  std::string bytes;
  try {
    bytes = read_file(real, max_bytes);
  } catch (const Error& error) {
    throw Error(error.message(), {name});
  }
  sources_.push_back(shown(whatever_case(path)));
  if (hashes_) asked_.push_back({path.string(), sha256_of(bytes)});
  return bytes;
}

fs::path place_in_data_root(const fs::path& folder) {
  const fs::path whole = absolute_path(folder.empty() ? "." : folder);
  for (fs::path at = whole; at.has_relative_path(); at = at.parent_path())
    if (at.filename() == "Aircraft" && at.parent_path().filename() == "AI")
      return whole.lexically_relative(at.parent_path().parent_path());
  return {};
}

fs::path folder_of_model(const fs::path& file) {
  const fs::path folder = file.parent_path();
  const fs::path whole = absolute_path(folder.empty() ? "." : folder);
  std::error_code ignored;
  const bool is_gazebo =
      whole.filename() == "meshes" && fs::is_directory(whole.parent_path() / "materials", ignored);
  return is_gazebo ? (folder.has_parent_path() ? folder.parent_path() : whole.parent_path())
                   : folder;
}

fs::path find_texture(ModelFiles& files,
                      const std::string& name,
                      const std::vector<fs::path>& folders) {
  std::string clean = name;
  std::replace(clean.begin(), clean.end(), '\\', '/');
  const fs::path file = fs::path(clean).filename();
  for (const fs::path& folder : folders)
    for (const fs::path& candidate :
         {folder / clean, folder / file, folder.parent_path() / "materials" / "textures" / file})
      if (files.kind(candidate) == ModelFiles::Kind::kFile) return candidate.lexically_normal();
  // As a URI spells it.
  const auto decoded = percent_decoded(clean);
  return decoded && *decoded != clean ? find_texture(files, *decoded, folders) : fs::path();
}

}  // namespace airtruth::wrapper
