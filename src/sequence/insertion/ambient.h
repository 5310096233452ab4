// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "foundation/image/layer.h"
#include "foundation/image/picture.h"
#include "foundation/image/tone_curve.h"
#include "labels/projection/exact_box.h"
#include "scene/scene/scene.h"
#include "sequence/insertion/sky.h"

// Estimates the light that falls on the intruder from the background, where the scene does not
// state it.
//
// The picture is read as a grid of small blocks in linear light, without the own aircraft. Blocks
// below the horizon that are much darker than the brighter half are ground; all others are sky. Sky
// is blue, cloud, or a mixture; blue is what is bluer than the greyest part, within what a camera's
// white balance does to an overcast sky. The brightness of the sky gives the exposure, because the
// luminance of such a sky is known (sky.h). The exposure gives the sun: by day the ratios between
// the sun, the blue sky and clouds depend on the sun's elevation alone. Where no ground is visible,
// a level ground under the same light takes its place. Where the whole picture is black, the light
// is that of an overcast sky. Three quantities are measured: the exposure, the clearness of the
// sky, and the share of cloud in it. A clipped sky bounds the light from below; where ground is in
// view, its brightness says how much more there is.
//
// Blocks near the intruder have four times the weight. The result is smoothed over time. A jump of
// the camera's exposure or white balance is followed at once; the jump is the median over the
// blocks of their change from one frame to the next.
namespace airtruth::insertion {

struct Ambient {
  // Irradiance over pi on a surface perpendicular to the sun's rays.
  std::array<float, 3> sun{};
  // The clear part of the sky: irradiance over pi on a level surface.
  std::array<float, 3> blue{};
  // The cloudy part of the sky, likewise.
  std::array<float, 3> cloud{};
  std::array<float, 3> ground{};  // radiance from below
  // Radiance of the background around the intruder, which haze approaches.
  std::array<float, 3> airlight{};
  shade::Environment surroundings;  // radiance of sky and ground by direction
  // True where the picture is black: nothing could be measured, and what the scene does not state
  // is the light of an overcast sky.
  bool is_assumed = false;

  std::array<float, 3> sky() const {
    return {blue[0] + cloud[0], blue[1] + cloud[1], blue[2] + cloud[2]};
  }
};

// All that the estimator reads of a picture: the linear light in the middle of each of its blocks.
struct Glance {
  lens::ImageSize size;
  std::vector<std::array<float, 3>> linear;
};
Glance glance_at(const image::Picture& picture, const image::ToneCurve& tone);

class AmbientEstimator {
 public:
  AmbientEstimator(const scene::Light& light,
                   const scene::CameraModel& camera,
                   const image::Mask* own_aircraft);

  // Takes the frames in order, all of one size and through one lens. `near` is the box of the
  // intruders, where one is in view. `begins_shot` is true where the light differs from the
  // previous frame's; the result is then not smoothed across the two.
  Ambient next(const image::Picture& picture,
               const projection::Sight& sight,
               const std::optional<PixelBox>& near,
               bool begins_shot = false);
  // The same for one who keeps what was read of the pictures.
  Ambient next(const Glance& glance,
               const projection::Sight& sight,
               const std::optional<PixelBox>& near,
               bool begins_shot = false);
  // False where the scene states all of the light, that of haze included, so that no picture is
  // read.
  bool reads_pictures() const;

 private:
  Ambient with_scene(Ambient measured) const;
  void follow_rays(const lens::ImageSize& size, const projection::Sight& sight);
  void follow_exposure(const std::vector<std::array<float, 3>>& blocks);

  scene::Light light_;
  image::ToneCurve tone_;
  bool has_measured_haze_ = false;  // extinction without a stated airlight
  const image::Mask* own_aircraft_;
  Skies skies_;
  std::optional<Ambient> smooth_;
  std::vector<std::array<float, 3>> blocks_before_;
  // The rays of the blocks in the nominal camera, which stay as long as the homography does.
  std::vector<std::optional<Vector3>> rays_;
  Homography rays_nominal_from_frame_ = Homography::Identity();
  lens::ImageSize rays_size_;
};

}  // namespace airtruth::insertion
