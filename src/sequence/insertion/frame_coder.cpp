// SPDX-License-Identifier: Apache-2.0
#include "sequence/insertion/frame_coder.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace airtruth::insertion {
namespace {

int quantiser_of(double codec_step) {
  // H.264's quantiser step, in code values, at a QP of 0; it doubles with every 6.
  constexpr double kStepAtQp0 = 0.625;
  return static_cast<int>(std::clamp(std::lround(6 * std::log2(codec_step / kStepAtQp0)), 1L, 51L));
}

// How far beyond a window the last frame's samples are kept: what moves faster, in pixels a frame,
// finds this frame's background there. libx264 searches 16 px around its prediction.
constexpr int kKeptAroundPx = 32;

}  // namespace

FrameCoder::FrameCoder(double codec_step) : codec_(quantiser_of(codec_step)) {}

image::Picture FrameCoder::reference(const PixelBox& box,
                                     const image::Picture& now,
                                     image::Picture Part::*samples) const {
  image::Picture result = now.clone();
  for (const Part& past : past_)
    image::paste(result, past.*samples, past.box.x - box.x, past.box.y - box.y);
  return result;
}

composite::Coded FrameCoder::code(const PixelBox& box,
                                  const image::Picture& with_layer,
                                  const image::Picture& background) {
  windows_.push_back({box, background.clone(), {}});
  return {codec_.coded(with_layer, reference(box, background, &Part::painted)),
          codec_.coded(background, reference(box, background, &Part::background))};
}

void FrameCoder::finish_frame(const image::Picture& painted) {
  past_.clear();
  for (const Part& window : windows_) {
    const PixelBox box =
        *intersection(wider(window.box, kKeptAroundPx), {0, 0, painted.width, painted.height});
    image::Picture background = image::crop(painted, box);
    for (const Part& other : windows_)
      image::paste(background, other.background, other.box.x - box.x, other.box.y - box.y);
    past_.push_back({box, std::move(background), image::crop(painted, box)});
  }
  windows_.clear();
}

}  // namespace airtruth::insertion
