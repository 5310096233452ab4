// SPDX-License-Identifier: Apache-2.0
#include "runners/tracking/trax_images.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include <fmt/format.h>

#include "foundation/base/base64.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/image/colour.h"
#include "picture/video/still.h"

namespace airtruth::tracking {
namespace {

fs::path new_folder() {
  std::error_code unknown;
  const fs::path shared = "/dev/shm";
  std::string name = ((fs::is_directory(shared, unknown) ? shared : fs::temp_directory_path()) /
                      "airtruth-trax-XXXXXX")
                         .string();
  if (::mkdtemp(name.data()) == nullptr)
    throw Error(
        std::string("cannot create a folder for a tracker's pictures: ") + std::strerror(errno),
        {name});
  return name;
}

}  // namespace

Images::Images(ImageKind kind) : kind_(kind) {
  if (kind_ == ImageKind::kMemory) return;
  folder_ = new_folder();
  unfinished_.emplace(Unfinished::path(folder_));
}

Images::~Images() {
  std::error_code ignored;
  if (!folder_.empty()) fs::remove_all(folder_, ignored);
}

std::string Images::hand_over(const image::Picture& picture) {
  const image::Rgb8 rgb = image::rgb8_from_picture(picture);
  if (kind_ == ImageKind::kMemory) {
    const std::string_view samples(
        reinterpret_cast<const char*>(rgb.samples.get()),
        3 * static_cast<std::size_t>(rgb.width) * static_cast<std::size_t>(rgb.height));
    return fmt::format("image:{};{};rgb;{}", rgb.width, rgb.height, base64_of(samples));
  }
  const auto path = [this](std::int64_t number) {
    return folder_ / fmt::format("{:08d}.png", number);
  };
  const fs::path file = path(count_);
  video::write_still(file, rgb, Flush::kLater);
  std::error_code ignored;
  if (count_ >= 2) fs::remove(path(count_ - 2), ignored);
  ++count_;
  if (kind_ == ImageKind::kPath) return "file://" + file.string();
  return "data:image/png;" + base64_of(read_file(file));
}

}  // namespace airtruth::tracking
