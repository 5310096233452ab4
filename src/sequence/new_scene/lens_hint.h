// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "camera/lens/lens.h"

// What a video's own files state about its lens.
namespace airtruth::new_scene {

// The focal length in the text of DJI's subtitles, [focal_len: 240]: tenths of a millimetre where
// it is above 100, for a picture of 35 mm film. Empty where the text has none.
std::optional<double> equivalent_mm_in_subtitles(std::string_view text);

// The diagonal view in degrees that a GoPro's telemetry states (ZFOV); empty where it has none.
std::optional<double> diagonal_view_deg(std::span<const std::uint8_t> packet);

// The focal length of the tags of a phone's or a camera's video, in millimetres for a picture of 35
// mm film; empty where no tag states it.
std::optional<double> equivalent_mm_in_tags(const std::map<std::string, std::string>& tags);

// A pinhole with the focal length that gives the same diagonal view on 35 mm film, whose diagonal
// is 43.27 mm.
lens::Lens pinhole_from_equivalent(double equivalent_mm, lens::ImageSize size);

// An equidistant fisheye with a diagonal view.
lens::Lens fisheye_from_diagonal(double view_deg, lens::ImageSize size);

}  // namespace airtruth::new_scene
