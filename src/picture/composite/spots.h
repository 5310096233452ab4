// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "foundation/geometry/within_frame.h"
#include "foundation/image/layer.h"
#include "foundation/image/spot.h"
#include "picture/composite/cover.h"

// What is on the lens, in front of every intruder and of the own aircraft.
namespace airtruth::composite {

// The alpha of a spot at a place of the picture, a time after the frame's.
double spot_alpha(const image::Spot& spot, const Pixel& at, double dt_s);

// The spots of one frame. An empty one is not there. Later spots are in front of earlier ones.
struct Spots {
  std::vector<std::optional<image::Spot>> spots;
  Shutter shutter;
  int frame_width = 0;
  int frame_height = 0;
};

// The mean alpha of a spot over a pixel's area and its exposure.
double pixel_alpha(const image::Spot& spot, int x, int y, const Spots& in);

// What each spot covers of the frame, by itself.
std::vector<image::Coverage> covers_of(const Spots& spots);
// True where no spot touches the frame.
bool are_out_of_view(const std::vector<image::Coverage>& covers);

// Takes what the spots hide from the layer's areas of seen, free and clear silhouettes. Call it
// before the layer's point spread and after find_areas() (cover.h).
void hide_behind(image::Layer& layer,
                 const std::vector<image::Coverage>& covers,
                 const Occlusion& occlusion);

// Puts the spots over a layer of `intruders` intruders: each becomes one more intruder of the
// layer, after the others. The patch grows to hold them with a margin, within the frame. The layer
// may be empty. Occluders are behind the lens: what is closed in the layer is taken out of it, and
// the result is open everywhere.
image::Layer with_spots(image::Layer layer,
                        std::size_t intruders,
                        const Spots& spots,
                        const std::vector<image::Coverage>& covers,
                        int margin_px);

}  // namespace airtruth::composite
