// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "foundation/geometry/box.h"
#include "foundation/image/layer.h"

// The pixels of a frame that an intruder itself covers: its coverage after nearer intruders,
// exposure, point spread and occluders. The effects of sharpening, noise and the codec on
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

// `intruder` is an index of the layer's intruders.
AlphaMask alpha_mask(const image::Layer& layer, std::size_t intruder);

// The pixels with kCoveredAlpha or more: their bounds and their number.
struct Covered {
  PixelBox box;
  std::int64_t area_px = 0;
  bool operator==(const Covered&) const = default;
};

// Empty where there are none. `part` is the part of the frame to look at.
std::optional<Covered> covered(const AlphaMask& mask);
std::optional<Covered> covered(const AlphaMask& mask, const PixelBox& part);
std::optional<Covered> covered(const image::Layer& layer, std::size_t intruder);

// What stands in a frame's picture before its intruders. An occluder hides the intruders that are
// farther from the camera than it; the own aircraft is one at 0 m.
//
// Example: a hill at 800 m whose edge covers a quarter of a pixel. An aircraft at 900 m with an
// alpha of 0.8 there keeps 0.6; one at 700 m keeps 0.8.
struct Occluder {
  double range_m = 0;  // 0: the own aircraft
  // The share of a pixel that it covers, 0..1.
  std::function<float(int x, int y)> cover;
};

// Of one frame.
struct Occlusion {
  std::vector<Occluder> occluders;
  // From the camera, by intruder of the layer.
  std::vector<double> ranges_m;
};

// The occluder that an own aircraft's mask is. The mask must outlive it.
Occluder own_aircraft(const image::Mask& mask);

// The share of each pixel of a patch in which intruders show past the occluders before them. An
// empty vector is 1 everywhere. The occlusion must outlive it.
class Shares {
 public:
  Shares(const Occlusion& occlusion, const PixelBox& patch)
      : occlusion_(occlusion), patch_(patch) {}
  const std::vector<float>& past_own_aircraft();
  const std::vector<float>& past_all(std::size_t intruder);

 private:
  const std::vector<float>& past(double range_m);

  const Occlusion& occlusion_;
  PixelBox patch_;
  std::map<std::size_t, std::vector<float>> known_;  // by the number of occluders before it
};

inline double share_of(const std::vector<float>& shares, std::size_t i) {
  return shares.empty() ? 1 : double{shares[i]};
}

// Takes what is behind the own aircraft from free_px of the layer's areas, and what is behind any
// occluder from clear_px. Call it before the layer's point spread.
void find_areas(image::Layer& layer, const Occlusion& occlusion);

// Takes what the occluders hide out of a layer: each intruder's coverage is multiplied by the share
// that shows, alpha is their sum, and colour keeps its ratio to alpha, so that it is exact wherever
// one intruder alone covers a pixel. A pixel in which no intruder shows becomes closed and keeps
// its values (Layer::closed). Call it after the layer's point spread.
void hide(image::Layer& layer, const Occlusion& occlusion);

}  // namespace airtruth::composite
