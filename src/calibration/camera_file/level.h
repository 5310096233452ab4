// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "camera/horizon/horizon.h"
#include "camera/lens/lens.h"
#include "foundation/geometry/transform.h"
#include "foundation/image/picture.h"

// The level of the world in a clip: the horizons of its sampled frames, and the attitude of the
// camera that they have in common.
namespace airtruth::camera_file {

// A frame that is used for horizon, sky and ground.
struct SampledFrame {
  image::Picture picture;
  std::int64_t frame = 0;
  // The rotation since the first frame of the clip. It is known if the lens is given, if the frame
  // was measured, and if no cut lies between.
  std::optional<Quaternion> cam_from_first;
};

using FoundHorizon = std::optional<horizon::HorizonEdge>;

struct Horizons {
  // One entry for each sampled frame, empty if its horizon is not accepted.
  std::vector<FoundHorizon> found;
  // The reason why no horizon is accepted; a remark about the frames that are left out.
  std::string why_none, note;
};

// A horizon is accepted if it is a sharp line. If most frames show a sky whose boundary is not a
// sharp line, the lines in the other frames are accidental too, and no horizon is accepted.
// `before_each` is called before each frame and may throw to end the search.
Horizons accepted_horizons(const horizon::HorizonFinder& finder,
                           const std::vector<SampledFrame>& frames,
                           const std::function<void()>& before_each);

// cam_from_world of the first frame: level by the median over the upward directions of all frames
// whose rotation is known, and with the given heading. Empty if there is no such frame.
// `horizon_dip_rad`: by how much the horizon that is seen lies below the horizontal.
std::optional<Quaternion> level_attitude(const std::vector<SampledFrame>& frames,
                                         const std::vector<FoundHorizon>& horizons,
                                         double heading_deg,
                                         double horizon_dip_rad);

// The middle one of the frames with a horizon, with its sky tinted red; empty without a horizon.
std::optional<image::Rgb8> tinted_sky(const lens::Lens& lens,
                                      const std::vector<SampledFrame>& frames,
                                      const std::vector<FoundHorizon>& horizons);

}  // namespace airtruth::camera_file
