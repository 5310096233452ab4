// SPDX-License-Identifier: Apache-2.0
#include "foundation/disk_cache/disk_cache.h"

#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <mutex>

#include <elf.h>
#include <link.h>
#include <sys/stat.h>
#include <unistd.h>

#include "foundation/base/files.h"

namespace airtruth::disk_cache {
namespace {

// Number of hexadecimal digits of a SHA-256, the name of an entry and its first bytes.
constexpr std::size_t kHashDigits = 64;
// Chosen: a project that rests over a season keeps its entries.
constexpr std::chrono::days kKeptUnused{90};

// The build id that the linker writes into a program or a library, as bytes.
struct BuildId {
  std::uintptr_t address;  // within the wanted object
  std::string bytes;
};

bool holds(const dl_phdr_info& object, std::uintptr_t address) {
  for (int i = 0; i < object.dlpi_phnum; ++i) {
    const ElfW(Phdr)& part = object.dlpi_phdr[i];
    const std::uintptr_t begin = object.dlpi_addr + part.p_vaddr;
    if (part.p_type == PT_LOAD && begin <= address && address < begin + part.p_memsz) return true;
  }
  return false;
}

constexpr std::size_t padded(std::size_t bytes) { return (bytes + 3) / 4 * 4; }

std::string build_id_among(std::string_view notes) {
  ElfW(Nhdr) note;
  while (notes.size() >= sizeof(note)) {
    std::memcpy(&note, notes.data(), sizeof(note));
    const std::size_t content = sizeof(note) + padded(note.n_namesz);
    const std::size_t whole = content + padded(note.n_descsz);
    if (whole > notes.size()) break;
    if (note.n_type == NT_GNU_BUILD_ID) return std::string(notes.substr(content, note.n_descsz));
    notes.remove_prefix(whole);
  }
  return {};
}

int look_for_build_id(dl_phdr_info* object, std::size_t, void* result) {
  auto& wanted = *static_cast<BuildId*>(result);
  if (!holds(*object, wanted.address)) return 0;
  for (int i = 0; i < object->dlpi_phnum && wanted.bytes.empty(); ++i) {
    const ElfW(Phdr)& part = object->dlpi_phdr[i];
    if (part.p_type == PT_NOTE)
      wanted.bytes = build_id_among(
          {reinterpret_cast<const char*>(object->dlpi_addr + part.p_vaddr), part.p_memsz});
  }
  return 1;
}

const std::string& build_id() {
  static const std::string id = [] {
    BuildId found{reinterpret_cast<std::uintptr_t>(&look_for_build_id), {}};
    ::dl_iterate_phdr(look_for_build_id, &found);
    check(!found.bytes.empty(), "the linker has written a build id");
    return found.bytes;
  }();
  return id;
}

bool is_entry(const fs::path& file) {
  const std::string name = file.filename().string();
  return name.size() == kHashDigits &&
         name.find_first_not_of("0123456789abcdef") == std::string::npos;
}

void remove_unused(const fs::path& folder) {
  const auto oldest = fs::file_time_type::clock::now() - kKeptUnused;
  for (const fs::directory_entry& file : fs::directory_iterator(folder)) {
    std::error_code ignored;
    if (is_entry(file) && file.last_write_time(ignored) < oldest && !ignored)
      fs::remove(file, ignored);
  }
}

std::mutex refused_mutex;
fs::path refused;  // guarded by refused_mutex

}  // namespace

fs::path user_folder(const char* kind) {
  if (const char* xdg = std::getenv("XDG_CACHE_HOME"); xdg != nullptr && *xdg == '/')
    return fs::path(xdg) / "airtruth" / kind;
  if (const char* home = std::getenv("HOME"); home != nullptr && *home == '/')
    return fs::path(home) / ".cache" / "airtruth" / kind;
  return {};
}

fs::path refused_folder() {
  const std::lock_guard lock(refused_mutex);
  return refused;
}

// Entries are believed, since their checksum is their own. Only the user may have written them.
bool Cache::is_own() const {
  struct stat folder {};
  if (!keeps() || ::lstat(folder_.c_str(), &folder) != 0) return false;
  if (S_ISDIR(folder.st_mode) && folder.st_uid == ::geteuid() &&
      (folder.st_mode & (S_IWGRP | S_IWOTH)) == 0)
    return true;
  const std::lock_guard lock(refused_mutex);
  refused = folder_;
  return false;
}

void Cache::make() const {
  if (!keeps()) return;
  std::error_code ignored;
  if (folder_.has_parent_path()) fs::create_directories(folder_.parent_path(), ignored);
  ::mkdir(folder_.c_str(), S_IRWXU);
}

Key::Key(std::string_view kind) { add(build_id()).add(kind); }

Key& Key::add(std::string_view text) {
  const std::uint64_t size = text.size();
  bytes_.append(reinterpret_cast<const char*>(&size), sizeof(size));
  bytes_ += text;
  return *this;
}

std::string Key::name() const { return sha256_of(bytes_); }

std::optional<std::string> Cache::find(const Key& key) const {
  if (!is_own()) return std::nullopt;
  const fs::path file = folder_ / key.name();
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) return std::nullopt;
  try {
    std::string bytes = read_file(file, kHashDigits + kMaxEntryBytes);
    if (bytes.size() < kHashDigits) return std::nullopt;
    const std::string hash = bytes.substr(0, kHashDigits);
    bytes.erase(0, kHashDigits);
    if (sha256_of(bytes) != hash) return std::nullopt;
    fs::last_write_time(file, fs::file_time_type::clock::now(), ignored);
    return bytes;
  } catch (const Error&) {
    return std::nullopt;
  }
}

void Cache::keep(const Key& key, std::string_view body) const {
  if (!keeps() || body.size() > kMaxEntryBytes) return;
  make();
  if (!is_own()) return;
  try {
    const auto write = [&](const AddBytes& add) {
      add(sha256_of(body));
      add(body);
    };
    write_file(folder_ / key.name(), write, Flush::kLater);
    remove_unused(folder_);
  } catch (const std::exception&) {  // a read-only folder or a full disk
  }
}

std::unique_ptr<WaitingLock> Cache::lock(const Key& key, const std::stop_token& stop) const {
  make();
  if (!is_own()) return nullptr;
  try {
    return std::make_unique<WaitingLock>(folder_ / ("." + key.name() + ".lock"), stop);
  } catch (const Error&) {  // a read-only folder
    return nullptr;
  }
}

}  // namespace airtruth::disk_cache
