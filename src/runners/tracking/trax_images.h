// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "foundation/base/unfinished.h"
#include "foundation/image/picture.h"

namespace airtruth::tracking {

namespace fs = std::filesystem;

// How pictures reach a tracker: as a PNG's path; as samples in the message, "image:W;H;rgb;BASE64";
// or as a PNG's bytes in the message, "data:image/png;BASE64".
enum class ImageKind { kPath, kMemory, kBuffer };

// Pictures for one tracker. Files lie in memory (/dev/shm) where that exists. The last two files
// are kept, and the destructor removes the folder.
class Images {
 public:
  explicit Images(ImageKind kind);
  Images(const Images&) = delete;
  Images& operator=(const Images&) = delete;
  ~Images();

  // Returns the text by which a message refers to the picture.
  std::string hand_over(const image::Picture& picture);

 private:
  ImageKind kind_;
  fs::path folder_;
  std::optional<Unfinished> unfinished_;
  std::int64_t count_ = 0;
};

}  // namespace airtruth::tracking
