// SPDX-License-Identifier: Apache-2.0
#include "runners/process/memory_place.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>
#include <system_error>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "foundation/base/error.h"
#include "foundation/base/file_state.h"

namespace airtruth::process {
namespace {

namespace fs = std::filesystem;

constexpr const char* kBegins = "airtruth-run-";

fs::path memory_folder() {
  std::error_code unknown;
  const fs::path shared = "/dev/shm";
  return fs::is_directory(shared, unknown) ? shared : fs::temp_directory_path();
}

// Nobody else's: other users' places cannot be opened, or not removed.
void remove_dead_places() {
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(memory_folder(), ignored)) {
    if (!entry.path().filename().string().starts_with(kBegins)) continue;
    const int file = ::open(entry.path().c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (file < 0) continue;
    if (try_lock(file, entry.path()) == Lock::kTaken) fs::remove_all(entry.path(), ignored);
    ::close(file);
  }
}

// Locked, and not removed by another run before it was.
bool is_held(int file, const fs::path& path) {
  struct stat facts {};
  return try_lock(file, path) != Lock::kBusy && ::fstat(file, &facts) == 0 && facts.st_nlink > 0;
}

}  // namespace

MemoryPlace::MemoryPlace(Kind kind, const char* what_for) {
  remove_dead_places();
  do {
    if (descriptor_ >= 0) ::close(descriptor_);
    std::string name = (memory_folder() / (std::string(kBegins) + "XXXXXX")).string();
    if (kind == Kind::kFile)
      descriptor_ = ::mkostemp(name.data(), O_CLOEXEC);
    else if (::mkdtemp(name.data()) != nullptr)
      descriptor_ = ::open(name.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (descriptor_ < 0)
      throw Error(std::string("cannot create memory for ") + what_for + ": " + std::strerror(errno),
                  {name});
    path_ = name;
  } while (!is_held(descriptor_, path_));
  unfinished_.emplace(Unfinished::path(path_));
}

MemoryPlace::~MemoryPlace() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
  ::close(descriptor_);
}

}  // namespace airtruth::process
