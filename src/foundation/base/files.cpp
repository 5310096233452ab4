// SPDX-License-Identifier: Apache-2.0
#include "foundation/base/files.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <climits>
#include <cstdlib>
#include <cstring>
#include <memory>

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <openssl/evp.h>
#include <sys/stat.h>
#include <unistd.h>

#include "foundation/base/descriptor.h"
#include "foundation/base/error.h"
#include "foundation/base/file_state.h"
#include "foundation/base/text.h"
#include "foundation/base/unfinished.h"

namespace airtruth {
namespace {

std::string reason() { return std::strerror(errno); }

// Calls take(bytes) for each block of the file.
template <typename Take>
void read_blocks(const fs::path& path, Take take) {
  Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (!file.is_open()) throw Error("cannot open: " + reason(), {path.string()});
  struct stat status {};
  if (::fstat(file.get(), &status) == 0 && S_ISDIR(status.st_mode))
    throw Error("is a folder; expected a file", {path.string()});
  std::array<char, 1 << 16> block;  // left as it is: clearing it costs more than a small file
  for (;;) {
    const ssize_t got = ::read(file.get(), block.data(), block.size());
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw Error("cannot read: " + reason(), {path.string()});
    if (got == 0) return;
    if (!take(std::string_view(block.data(), static_cast<std::size_t>(got)))) return;
  }
}

class Sha256 {
 public:
  Sha256() : context_(EVP_MD_CTX_new(), EVP_MD_CTX_free) {
    check(context_ && EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) == 1,
          "SHA-256 is there");
  }
  void add(std::string_view bytes) { EVP_DigestUpdate(context_.get(), bytes.data(), bytes.size()); }
  std::string hex() {
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
    unsigned int size = 0;
    EVP_DigestFinal_ex(context_.get(), digest.data(), &size);
    return fmt::format("{:02x}", fmt::join(digest.begin(), digest.begin() + size, ""));
  }

 private:
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
};

void write_all(const Descriptor& file, std::string_view bytes, const fs::path& path) {
  while (!bytes.empty()) {
    const ssize_t put = ::write(file.get(), bytes.data(), bytes.size());
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) throw Error("cannot write: " + reason(), {path.string()});
    bytes.remove_prefix(static_cast<std::size_t>(put));
  }
}

}  // namespace

std::string read_file(const fs::path& path, std::size_t max_bytes) {
  std::string bytes;
  read_blocks(path, [&](std::string_view block) {
    bytes += block;
    return bytes.size() <= max_bytes;
  });
  if (bytes.size() > max_bytes)
    throw Error("is larger than " + std::to_string(max_bytes) + " bytes; expected a smaller file",
                {path.string()});
  return bytes;
}

void refuse_device(const fs::path& path) {
  if (fs::is_other(path)) throw Error("is no regular file; expected one", {path.string()});
}

void refuse_existing(const fs::path& path, bool overwrite) {
  if (!overwrite && fs::exists(path))
    throw Error("exists already; give --overwrite to replace it", {path.string()});
}

void refuse_foreign(const fs::path& folder, std::initializer_list<const char*> records) {
  const bool is_own = std::any_of(
      records.begin(), records.end(), [&](const char* name) { return fs::exists(folder / name); });
  if (!is_own && !entries(folder).empty())
    throw Error(fmt::format("exists and is not empty{}{}; expected a new folder",
                            records.size() > 0 ? ", and holds no " : "",
                            fmt::join(records, " or ")),
                {folder.string()});
}

void make_folders(const fs::path& folder, const fs::path& named) {
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed)
    throw Error("cannot create: " + failed.message(), {(named.empty() ? folder : named).string()});
}

fs::path normal_path(const fs::path& path) {
  fs::path normal = path.lexically_normal();
  if (std::ranges::find(path, "..") == path.end()) return normal;
  std::error_code failed;
  fs::path meant = fs::weakly_canonical(fs::absolute(path), failed);
  return failed || fs::weakly_canonical(fs::absolute(normal), failed) == meant ? normal : meant;
}

fs::path absolute_path(const fs::path& path) {
  const fs::path whole = normal_path(fs::absolute(path));
  return whole.has_filename() ? whole : whole.parent_path();
}

fs::path first_missing(fs::path folder) {
  fs::path missing;
  while (!folder.empty() && !fs::exists(folder)) {
    missing = folder;
    if (!folder.has_relative_path()) break;
    folder = folder.parent_path();
  }
  return missing;
}

void remove_empty(fs::path folder, const fs::path& first) {
  std::error_code failed;
  while (!first.empty() && fs::remove(folder, failed) && folder != first)
    folder = folder.parent_path();
}

namespace {

// Removes a part whose writer is dead: nobody holds its lock.
void remove_dead_part(const fs::path& part) {
  const Descriptor file(::open(part.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  if (file.is_open() && try_lock(file.get(), part) == Lock::kTaken && is_open_as(file.get(), part))
    ::unlink(part.c_str());
}

std::string random_digits() {
  std::array<unsigned char, 8> bytes{};
  if (::getentropy(bytes.data(), bytes.size()) != 0) check(false, "random numbers can be had");
  return sha256_of({reinterpret_cast<const char*>(bytes.data()), bytes.size()}).substr(0, 12);
}

// A new file of the writer's own, locked while it is open: under part_path(), or with random digits
// where that name is another writer's.
Descriptor new_part(const fs::path& path, fs::path& part) {
  // The system takes a name as ended there: another file, and one for all parts.
  if (path.native().find('\0') != std::string::npos)
    throw Error("cannot create: the name holds a NUL", {printable(path.native(), 200)});
  part = part_path(path);
  remove_dead_part(part);
  for (;;) {
    Descriptor file(::open(part.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644));
    if (!file.is_open() && errno != EEXIST)
      throw Error("cannot create: " + reason(), {path.string()});
    // Another writer may have taken the new file for a dead one before it was locked.
    if (file.is_open() && try_lock(file.get(), part) != Lock::kBusy && is_open_as(file.get(), part))
      return file;
    part.replace_filename(std::string(".").append(random_digits()).append(".part"));
  }
}

}  // namespace

void write_file(const fs::path& path, std::string_view bytes, Flush flush) {
  write_file(
      path, [&](const AddBytes& add) { add(bytes); }, flush);
}

void write_file(const fs::path& path,
                const std::function<void(const AddBytes& add)>& write,
                Flush flush) {
  fs::path part;
  Descriptor file = new_part(path, part);
  Unfinished unfinished = Unfinished::path(part);
  try {
    write([&](std::string_view bytes) { write_all(file, bytes, path); });
    if (flush == Flush::kNow && ::fsync(file.get()) != 0 && errno != EINVAL && errno != EROFS)
      throw Error("cannot write: " + reason(), {path.string()});
    // A network's file system tells of a full disk when a descriptor is closed. The lock is held on
    // the other one until the file has its name, so that nobody takes it for a dead writer's.
    const int other = ::dup(file.get());
    if (other < 0 || ::close(other) != 0) throw Error("cannot write: " + reason(), {path.string()});
    unfinished.finish([&] {
      if (::rename(part.c_str(), path.c_str()) != 0)
        throw Error("cannot create: " + reason(), {path.string()});
    });
  } catch (...) {
    ::unlink(part.c_str());
    throw;
  }
}

void flush_files(const fs::path& folder) {
  const Descriptor file(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!file.is_open() || ::syncfs(file.get()) != 0)
    throw Error("cannot write: " + reason(), {folder.string()});
}

fs::path part_path(const fs::path& path) {
  const std::string ending = ".part" + path.extension().string();
  const std::size_t room = NAME_MAX - std::min<std::size_t>(NAME_MAX, 1 + ending.size());
  fs::path part = path;
  part.replace_filename("." + path.stem().string().substr(0, room) + ending);
  return part;
}

std::vector<fs::path> entries(const fs::path& folder) {
  std::vector<fs::path> found;
  if (fs::is_directory(folder))
    for (const auto& entry : fs::directory_iterator(folder))
      if (!entry.path().filename().string().starts_with(".")) found.push_back(entry.path());
  std::ranges::sort(found);
  return found;
}

std::vector<fs::path> files_with(const fs::path& folder, std::string_view extension) {
  std::vector<fs::path> found = entries(folder);
  std::erase_if(found, [&](const fs::path& path) {
    return path.extension() != extension || !fs::is_regular_file(path);
  });
  return found;
}

std::string sha256_of_file(const fs::path& path) {
  Sha256 sha;
  read_blocks(path, [&](std::string_view block) {
    sha.add(block);
    return true;
  });
  return sha.hex();
}

std::string sha256_of(std::string_view bytes) {
  Sha256 sha;
  sha.add(bytes);
  return sha.hex();
}

bool is_plain_file_name(std::string_view name) {
  return !name.empty() && name.size() <= kMostFileNameBytes && name.front() != '.' &&
         name.find('/') == std::string_view::npos && std::ranges::none_of(name, is_control);
}

std::size_t utf8_fault(std::string_view text) {
  std::size_t i = 0;
  while (i < text.size()) {
    const auto lead = static_cast<unsigned char>(text[i]);
    const std::size_t length = lead < 0x80                   ? 1
                               : lead >= 0xc2 && lead < 0xe0 ? 2
                               : (lead & 0xf0) == 0xe0       ? 3
                               : lead >= 0xf0 && lead < 0xf5 ? 4
                                                             : 0;
    if (length == 0 || i + length > text.size()) return i;
    std::uint32_t code = length == 1 ? lead : lead & (0x7fu >> length);
    for (std::size_t k = 1; k < length; ++k) {
      const auto next = static_cast<unsigned char>(text[i + k]);
      if ((next & 0xc0) != 0x80) return i;
      code = (code << 6) | (next & 0x3fu);
    }
    const bool overlong = (length == 3 && code < 0x800) || (length == 4 && code < 0x10000);
    if (overlong || code > 0x10ffff || (code >= 0xd800 && code < 0xe000)) return i;
    i += length;
  }
  return std::string_view::npos;
}

void require_utf8(const fs::path& path) {
  if (utf8_fault(path.string()) != std::string_view::npos)
    throw Error(
        "is no UTF-8 name, which records and the files of other formats cannot hold; rename it",
        {path.string()});
}

}  // namespace airtruth
