// SPDX-License-Identifier: Apache-2.0
#include "sequence/insertion/masks.h"

#include <algorithm>

#include <fmt/format.h>

#include "foundation/base/error.h"
#include "picture/video/still.h"

namespace airtruth::insertion {
namespace {

video::Grey whole_frame(const composite::AlphaMask& mask, const lens::ImageSize& size) {
  const auto width = static_cast<std::size_t>(size.width);
  video::Grey grey{size.width, size.height, {}};
  grey.samples.assign(width * static_cast<std::size_t>(size.height), 0);
  const auto step = static_cast<std::size_t>(mask.patch.width);
  for (int y = 0; y < mask.patch.height; ++y)
    std::copy_n(
        mask.alpha.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(y) * step),
        mask.patch.width,
        grey.samples.begin() +
            static_cast<std::ptrdiff_t>(static_cast<std::size_t>(mask.patch.y + y) * width +
                                        static_cast<std::size_t>(mask.patch.x)));
  return grey;
}

}  // namespace

std::string mask_name(const std::string& intruder_id, std::int64_t frame) {
  return fmt::format("masks/{}/{:06}.png", intruder_id, frame);
}

std::vector<MaskFile> mask_files(const annotation::Frame& truth,
                                 const image::Layer& layer,
                                 const lens::ImageSize& size) {
  std::vector<MaskFile> files;
  for (std::size_t i = 0; i < truth.intruders.size(); ++i) {
    const annotation::Intruder& intruder = truth.intruders[i];
    if (intruder.state != annotation::State::kVisible) continue;
    const composite::AlphaMask mask = composite::alpha_mask(layer, i);
    if (!mask.empty())
      files.push_back(
          {mask_name(intruder.id, truth.frame), video::png_of(whole_frame(mask, size))});
  }
  return files;
}

std::optional<composite::AlphaMask> read_alpha_mask(const std::filesystem::path& folder,
                                                    const annotation::LensFacts& lens,
                                                    const std::string& intruder_id,
                                                    std::int64_t frame) {
  // A manipulated truth.jsonl must not name files outside its folder.
  if (intruder_id.find('/') != std::string::npos || intruder_id == "..")
    throw Error("has an intruder '" + intruder_id.substr(0, 80) + "'; expected a plain file name",
                {(folder / "truth.jsonl").string()});
  const std::filesystem::path file = folder / mask_name(intruder_id, frame);
  if (!std::filesystem::exists(file)) return std::nullopt;
  video::Grey grey = video::read_grey(file);
  if (grey.width != lens.width || grey.height != lens.height)
    throw Error(fmt::format("is {} x {} px; expected the frame's {} x {}",
                            grey.width,
                            grey.height,
                            lens.width,
                            lens.height),
                {file.string()});
  return composite::AlphaMask{{0, 0, grey.width, grey.height}, std::move(grey.samples)};
}

image::Rgb8 picture_of(const image::Mask& mask) {
  image::Rgb8 picture = image::make_rgb8(mask.width, mask.height);
  for (std::size_t i = 0; i < mask.free.size(); ++i)
    std::fill_n(picture.samples.get() + 3 * i,
                3,
                mask.free[i] >= 128 ? std::uint8_t{255} : std::uint8_t{0});
  return picture;
}

}  // namespace airtruth::insertion
