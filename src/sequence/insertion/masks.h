// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "camera/lens/lens.h"
#include "foundation/geometry/box.h"
#include "foundation/image/layer.h"
#include "foundation/image/picture.h"
#include "labels/annotation/truth.h"
#include "picture/composite/cover.h"

// The pixels of each intruder, for a scene with `[output] masks = true`: masks/ID/000000.png, a
// grey picture of the frame's size, 8 bits, whose samples are 255 alpha, rounded
// (picture/composite/cover.h). A frame in which the intruder is not visible, or no sample would
// reach 1, has none.
namespace airtruth::insertion {

struct MaskFile {
  std::string name;  // relative to the sequence's folder
  std::string png;
};

std::string mask_name(const std::string& intruder_id, std::int64_t frame);

// The alpha of each intruder of a frame; empty where it is not visible. The layer's intruders are
// in the truth's order.
std::vector<composite::AlphaMask> alpha_masks(const annotation::Frame& truth,
                                              const image::Layer& layer);

// The samples of a part of the frame, row by row; 0 outside of the mask.
std::vector<std::uint8_t> samples_in(const composite::AlphaMask& mask, const PixelBox& part);

// Returns the masks of all intruders of one frame. The layer's intruders are in the truth's order.
std::vector<MaskFile> mask_files(const annotation::Frame& truth,
                                 const image::Layer& layer,
                                 const lens::ImageSize& size);

// Reads the mask of an intruder back, over the whole frame; returns empty where the file does not
// exist. Throws Error where the file is not a grey picture of the frame's size.
std::optional<composite::AlphaMask> read_alpha_mask(const std::filesystem::path& folder,
                                                    const lens::Facts& lens,
                                                    const std::string& intruder_id,
                                                    std::int64_t frame);

// The mask of the own aircraft as a picture: black = own aircraft, white = free.
image::Rgb8 picture_of(const image::Mask& mask);

}  // namespace airtruth::insertion
