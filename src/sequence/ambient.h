// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "image/layer.h"
#include "image/picture.h"
#include "image/tone_curve.h"
#include "scene/scene.h"

// What light falls on the intruder, taken from the background where the scene does not state it.
//
// The picture is read as a grid of small blocks in linear light, without the own aircraft. Its
// brighter half stands for the sky and its darkest quarter for the ground, whatever the bank of the
// camera; the 98th percentile of brightness is what this exposure makes of a bright white thing
// (cloud, haze). Where some of the sky is blue the sun shines, and a white surface square to it is
// given that much or 3.5 times the sky's, whichever is more; under an even grey sky a little.
// Blocks near the intruder count four times. Smoothed over time; a jump of the camera's exposure or
// white balance (the median over the blocks of what each becomes from one frame to the next) is
// followed at once.
namespace airtruth::sequence {

struct Ambient {
  std::array<float, 3> sun{};
  std::array<float, 3> sky{};
  std::array<float, 3> ground{};
  std::array<float, 3> airlight{};  // the background around the intruder: where haze leads to
};

inline image::ToneCurve tone_of(const scene::CameraModel& model) {
  return {model.gamma.value_or(0)};
}

class AmbientEstimator {
 public:
  AmbientEstimator(const scene::Light& light,
                   const image::ToneCurve& tone,
                   const image::Mask* own_aircraft)
      : light_(light), tone_(tone), own_aircraft_(own_aircraft) {}

  // Frames in order. `near`: the intruders' box, where one is in view.
  Ambient next(const image::Picture& picture, const std::optional<PixelBox>& near);

 private:
  Ambient with_scene(Ambient measured) const;
  void follow_exposure(const std::vector<std::array<float, 3>>& blocks);

  scene::Light light_;
  image::ToneCurve tone_;
  const image::Mask* own_aircraft_;
  std::optional<Ambient> smooth_;
  std::vector<std::array<float, 3>> blocks_before_;
};

}  // namespace airtruth::sequence
