// SPDX-License-Identifier: Apache-2.0
#include "aircraft/model_reader/assimp_files.h"

#include <algorithm>
#include <cstring>

#include "aircraft/ac3d/ac_file.h"
#include "foundation/base/error.h"

namespace airtruth::model_reader {
namespace {

namespace fs = std::filesystem;
using aircraft::ModelFiles;

class MemoryStream : public Assimp::IOStream {
 public:
  explicit MemoryStream(std::string bytes) : bytes_(std::move(bytes)) {}

  std::size_t Read(void* target, std::size_t size, std::size_t count) override {
    if (size == 0) return 0;
    const std::size_t whole = std::min(count, (bytes_.size() - at_) / size);
    if (whole > 0) std::memcpy(target, bytes_.data() + at_, whole * size);
    at_ += whole * size;
    return whole;
  }
  std::size_t Write(const void*, std::size_t, std::size_t) override { return 0; }
  aiReturn Seek(std::size_t offset, aiOrigin origin) override {
    const std::size_t from = origin == aiOrigin_SET   ? 0
                             : origin == aiOrigin_CUR ? at_
                                                      : bytes_.size();
    const std::size_t to = from + offset;  // modulo 2^64: an offset may be negative
    if (to > bytes_.size()) return aiReturn_FAILURE;
    at_ = to;
    return aiReturn_SUCCESS;
  }
  std::size_t Tell() const override { return at_; }
  std::size_t FileSize() const override { return bytes_.size(); }
  void Flush() override {}

 private:
  std::string bytes_;
  std::size_t at_ = 0;
};

// Normalises a path as models spell it: "..\x.mtl", "./x.mtl".
fs::path plain_path(const char* path) {
  std::string text = path;
  std::replace(text.begin(), text.end(), '\\', '/');
  return fs::path(text).lexically_normal();
}

}  // namespace

bool AssimpFiles::Exists(const char* path) const {
  return files_.kind(plain_path(path)) == ModelFiles::Kind::kFile;
}

Assimp::IOStream* AssimpFiles::Open(const char* path, const char* mode) {
  const std::filesystem::path plain = plain_path(path);
  if (std::strpbrk(mode, "wa+") != nullptr) return nullptr;
  if (files_.kind(plain) != ModelFiles::Kind::kFile) {
    missing_.insert(plain.string());
    return nullptr;
  }
  return new MemoryStream(files_.read(plain, aircraft::kMaxModelBytes));
}

void AssimpFiles::Close(Assimp::IOStream* stream) { delete stream; }

}  // namespace airtruth::model_reader
