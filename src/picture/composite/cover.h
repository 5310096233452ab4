// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "foundation/geometry/box.h"
#include "foundation/image/layer.h"

// The pixels of a frame that an intruder itself covers: its coverage after nearer intruders,
// exposure, point spread and the own aircraft. The effects of sharpening, noise and the codec on
// the samples around it do not count.
namespace airtruth::composite {

// Least coverage of a covered pixel, in 1/255 after rounding to 8 bits: an alpha of 0.08.
// docs/formats/truth.md compares other values.
inline constexpr std::uint8_t kCoveredAlpha = 20;

// The coverage 0..1 rounded to 8 bits.
std::uint8_t alpha_code(float coverage);

// An intruder's alpha on the layer's patch, in 8 bits. Empty where no pixel reaches 1/255.
struct AlphaMask {
  // Position in the frame.
  PixelBox patch{};
  // patch.height rows of patch.width.
  std::vector<std::uint8_t> alpha;

  bool empty() const { return alpha.empty(); }
};

// `own_aircraft` may be null. `intruder` is an index of the layer's intruders.
AlphaMask alpha_mask(const image::Layer& layer,
                     std::size_t intruder,
                     const image::Mask* own_aircraft);

// The pixels with kCoveredAlpha or more: their bounds and their number.
struct Covered {
  PixelBox box;
  std::int64_t area_px = 0;
  bool operator==(const Covered&) const = default;
};

// Empty where there are none.
std::optional<Covered> covered(const AlphaMask& mask);
std::optional<Covered> covered(const image::Layer& layer,
                               std::size_t intruder,
                               const image::Mask* own_aircraft);

// Removes the area behind the own aircraft from layer.area_free_px. Call it before the layer's
// point spread.
void find_free_area(image::Layer& layer, const image::Mask& own_aircraft);

}  // namespace airtruth::composite
