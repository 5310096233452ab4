// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "foundation/geometry/box.h"
#include "foundation/image/layer.h"

// What an intruder itself covers of a frame: its coverage after nearer intruders, exposure and
// point spread, and behind no part of the own aircraft. What sharpening, noise and the codec do to
// the samples around it is not in it.
namespace airtruth::composite {

// A pixel is covered where the coverage, rounded to 8 bits, is this much of 255: an alpha of 0.08.
// docs/formats/truth.md tells what other values would give.
inline constexpr std::uint8_t kCoveredAlpha = 20;

// Coverage 0..1 as 8 bits, rounded.
std::uint8_t alpha_code(float coverage);

// An intruder's alpha on the layer's patch, in 8 bits. Empty: none reaches 1 of 255.
struct AlphaMask {
  PixelBox patch{};                 // where in the frame
  std::vector<std::uint8_t> alpha;  // patch.height rows of patch.width

  bool empty() const { return alpha.empty(); }
};

// `own_aircraft` may be null. The intruder is one of the layer's.
AlphaMask alpha_mask(const image::Layer& layer,
                     std::size_t intruder,
                     const image::Mask* own_aircraft);

// The bounds of its pixels of kCoveredAlpha or more; empty where there is none.
std::optional<PixelBox> covered_box(const AlphaMask& mask);
std::optional<PixelBox> covered_box(const image::Layer& layer,
                                    std::size_t intruder,
                                    const image::Mask* own_aircraft);

// Takes what lies behind the own aircraft out of layer.area_free_px. For a layer before its point
// spread.
void find_free_area(image::Layer& layer, const image::Mask& own_aircraft);

}  // namespace airtruth::composite
