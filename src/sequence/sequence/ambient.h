// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "foundation/image/layer.h"
#include "foundation/image/picture.h"
#include "foundation/image/tone_curve.h"
#include "sequence/sequence/sky.h"
#include "truth/annotation/exact_box.h"
#include "world/scene/scene.h"

// What light falls on the intruder, taken from the background where the scene does not state it.
//
// The picture is read as a grid of small blocks in linear light, without the own aircraft. Blocks
// are ground where they lie below the horizon and are much darker than the brighter half, else sky;
// sky is blue, cloud, or between. How bright the sky is there says how bright this exposure makes a
// sky of known luminance (sky.h), and with it the sun: by day the sun, the blue sky and clouds have
// ratios that depend on the sun's elevation alone. Where no ground is seen, a level ground under
// that very light stands for it. One unknown, the exposure, and two shares (how clear the sky is,
// how much of it is cloud) are measured; a sky that clips makes all of it too dark.
// Blocks near the intruder count four times. Smoothed over time; a jump of the camera's exposure or
// white balance (the median over the blocks of what each becomes from one frame to the next) is
// followed at once.
namespace airtruth::sequence {

struct Ambient {
  std::array<float, 3> sun{};        // irradiance over pi on a surface square to it
  std::array<float, 3> blue{};       // the clear part of the sky: the same on a level surface
  std::array<float, 3> cloud{};      // its cloudy part
  std::array<float, 3> ground{};     // radiance from below
  std::array<float, 3> airlight{};   // the background around the intruder: where haze leads to
  render::Environment surroundings;  // sky and ground by direction

  std::array<float, 3> sky() const {
    return {blue[0] + cloud[0], blue[1] + cloud[1], blue[2] + cloud[2]};
  }
};

class AmbientEstimator {
 public:
  AmbientEstimator(const scene::Light& light,
                   const image::ToneCurve& tone,
                   const image::Mask* own_aircraft);

  // Frames in order. `near`: the intruders' box, where one is in view. `begins_shot`: the light is
  // another than before, and is not smoothed across.
  Ambient next(const image::Picture& picture,
               const annotation::Sight& sight,
               const std::optional<PixelBox>& near,
               bool begins_shot = false);

 private:
  Ambient with_scene(Ambient measured) const;
  void follow_exposure(const std::vector<std::array<float, 3>>& blocks);

  scene::Light light_;
  image::ToneCurve tone_;
  const image::Mask* own_aircraft_;
  Skies skies_;
  std::optional<Ambient> smooth_;
  std::vector<std::array<float, 3>> blocks_before_;
};

}  // namespace airtruth::sequence
