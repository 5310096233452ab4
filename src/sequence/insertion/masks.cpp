// SPDX-License-Identifier: Apache-2.0
#include "sequence/insertion/masks.h"

#include <algorithm>

#include <fmt/format.h>

#include "foundation/base/error.h"
#include "picture/video/still.h"

namespace airtruth::insertion {
std::string mask_name(const std::string& intruder_id, std::int64_t frame) {
  return fmt::format("masks/{}/{:06}.png", intruder_id, frame);
}

std::vector<composite::AlphaMask> alpha_masks(const annotation::Frame& truth,
                                              const image::Layer& layer) {
  std::vector<composite::AlphaMask> masks(truth.intruders.size());
  for (std::size_t i = 0; i < masks.size(); ++i)
    if (truth.intruders[i].state == annotation::State::kVisible)
      masks[i] = composite::alpha_mask(layer, i);
  return masks;
}

std::vector<std::uint8_t> samples_in(const composite::AlphaMask& mask, const PixelBox& part) {
  std::vector<std::uint8_t> samples(pixels_in(part), 0);
  const auto both = mask.empty() ? std::nullopt : intersection(mask.patch, part);
  if (!both) return samples;
  for (int y = both->y; y < both->bottom(); ++y)
    std::copy_n(mask.alpha.data() + index_in(mask.patch, both->x, y),
                both->width,
                samples.data() + index_in(part, both->x, y));
  return samples;
}

std::vector<MaskFile> mask_files(const annotation::Frame& truth,
                                 const image::Layer& layer,
                                 const lens::ImageSize& size) {
  const std::vector<composite::AlphaMask> masks = alpha_masks(truth, layer);
  std::vector<MaskFile> files;
  for (std::size_t i = 0; i < masks.size(); ++i)
    if (!masks[i].empty())
      files.push_back(
          {mask_name(truth.intruders[i].id, truth.frame),
           video::png_of(
               {size.width, size.height, samples_in(masks[i], {0, 0, size.width, size.height})})});
  return files;
}

std::optional<composite::AlphaMask> read_alpha_mask(const std::filesystem::path& folder,
                                                    const lens::Facts& lens,
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
