// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "foundation/image/layer.h"

// What happens to a layer's light on its way to the sample. Cost follows the layer's size.
namespace airtruth::composite {

// Koschmieder (1924): over a range r the light L becomes L t + A (1 - t), t = exp(-extinction r),
// channel by channel. `airlight` is A, linear: what an endless way through the air looks like.
void add_haze(image::Layer& layer,
              const std::array<double, 3>& extinction_per_km,
              const std::array<double, 3>& airlight);

// The same layer through a Gaussian point spread of this standard deviation, on a patch that has
// grown by its reach (three deviations) and by `margin_px`, clipped to the frame. Coverage goes
// along, so that what is seen is still what is labelled.
image::Layer spread(
    const image::Layer& layer, double sigma_px, int margin_px, int frame_width, int frame_height);

// A Gaussian on pixels: the integral over each, so that it adds up to 1. Odd length; {1} for 0.
std::vector<float> gaussian(double sigma_px);

// Convolves one plane of values, rows of `width`, with symmetric kernels along its rows and its
// columns; values outside count as 0.
void blur(std::vector<float>& values,
          int width,
          int height,
          const std::vector<float>& across,
          const std::vector<float>& down);
// The same along both axes.
void blur(std::vector<float>& values, int width, int height, const std::vector<float>& kernel);

}  // namespace airtruth::composite
