// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

namespace airtruth {

// Every module names files and paths by it.
namespace fs = std::filesystem;

// The whole file as bytes. Throws Error when it is missing, a folder, unreadable, or larger than
// max_bytes.
std::string read_file(const fs::path& path, std::size_t max_bytes = std::size_t{1} << 30);

// Writes a temporary file beside `path`, flushes it to disk and renames it, so that `path` holds
// either its previous content or all of `bytes`. Throws Error where that fails (folder missing, no
// permission, disk full); no temporary file is left. Of several writers at once the last one's
// bytes stay, whole. kLater is for many small files: they survive a power failure only after
// flush_files().
enum class Flush { kNow, kLater };
void write_file(const fs::path& path, std::string_view bytes, Flush flush = Flush::kNow);
// The same where the bytes come part by part: `write` calls `add` with each part, in order.
using AddBytes = std::function<void(std::string_view bytes)>;
void write_file(const fs::path& path,
                const std::function<void(const AddBytes& add)>& write,
                Flush flush = Flush::kNow);

// Throws Error where the path is a pipe, a socket or a device. A set of others may hold such, and
// reading one need not end.
void refuse_device(const fs::path& path);

// Throws Error where the path exists and may not be replaced.
void refuse_existing(const fs::path& path, bool overwrite);

// Throws Error where a folder is there, is not empty, and holds none of `records`, the files by
// which airtruth knows what it made. Names that begin with a dot do not count: runs that have not
// finished leave such.
void refuse_foreign(const fs::path& folder, std::initializer_list<const char*> records = {});

// Everything that was written to the file system of `folder` is on the disk when this returns.
void flush_files(const fs::path& folder);

// The name under which a file is written before it is renamed: "dir/a.mp4" -> "dir/.a.part.mp4"
// (the extension stays, since encoders choose by it). A long name is cut to what Linux takes.
fs::path part_path(const fs::path& path);

// Makes a folder and those above it that are not there yet. Throws Error where that fails; it is
// about `named`, or the folder where that is empty.
void make_folders(const fs::path& folder, const fs::path& named = {});

// The uppermost folder of a path that is not there yet; empty where all are.
fs::path first_missing(fs::path folder);
// Removes the folders from `folder` up to `first`, as long as they are empty. Nothing where `first`
// is empty.
void remove_empty(fs::path folder, const fs::path& first);

// The path without "." and "..": by its text where that names the same file, else with its links
// followed, since "link/.." is the folder above the one that the link leads to.
fs::path normal_path(const fs::path& path);
// The same as an absolute path, without a slash at its end, so that its file name is that of a
// folder, too.
fs::path absolute_path(const fs::path& path);

// The folders and files of a folder, sorted by name, without hidden ones; none where it is no
// folder.
std::vector<fs::path> entries(const fs::path& folder);
// Its files with this extension, such as ".xml".
std::vector<fs::path> files_with(const fs::path& folder, std::string_view extension);

// SHA-256 of a file's content or of bytes, 64 lower-case hex digits (as sha256sum prints it).
std::string sha256_of_file(const fs::path& path);
std::string sha256_of(std::string_view bytes);

// True where a file in any folder could have this name and be seen there: it is not empty, does not
// begin with a dot (entries() leaves out such files), has at most kMostFileNameBytes, and holds no
// slash and no control character.
bool is_plain_file_name(std::string_view name);
// Below the 255 bytes of Linux's file systems (NAME_MAX), so that endings such as ".truth.jsonl"
// fit.
inline constexpr std::size_t kMostFileNameBytes = 200;
inline constexpr const char* kPlainFileName =
    "a plain file name: no slash, no dot in front, at most 200 bytes";

// Is the text well-formed UTF-8? Returns the byte offset of the first fault, or npos.
std::size_t utf8_fault(std::string_view text);

// Throws Error where a path is not UTF-8: records are JSON and TOML, which hold UTF-8 only.
void require_utf8(const fs::path& path);

}  // namespace airtruth
