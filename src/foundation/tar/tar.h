// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "foundation/base/files.h"
#include "foundation/base/unfinished.h"

// Tar archives (POSIX.1-2001, "ustar Interchange Format"; a name of more than 100 bytes stands in a
// pax header before its file). GNU tar and Python's tarfile read them.
namespace airtruth::tar {

// The bytes of a file in an archive: the same names and bytes give the same archive.
class Writer {
 public:
  // Throws Error where the file cannot be opened. An archive that is not finished is removed.
  explicit Writer(const fs::path& file);

  // `name`: a relative path. At most 8 GiB of bytes.
  void add(const std::string& name, std::string_view bytes);
  // Gives the whole archive its name. Throws Error where it could not be written.
  void finish();
  // Size of what was added, headers included.
  std::int64_t bytes() const { return bytes_; }

 private:
  void put(const std::string& name, std::string_view bytes, char type);

  PartFile file_;
  std::int64_t bytes_ = 0;
};

// Calls visit(name, bytes) for the files of an archive whose names end in `ending`, in their order.
// Skips all else. Throws Error for what is no whole tar archive, and for such a file of more than
// 256 MiB.
void each_file(const fs::path& archive,
               std::string_view ending,
               const std::function<void(const std::string& name, const std::string& bytes)>& visit);

}  // namespace airtruth::tar
