// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "foundation/image/layer.h"

// Haze and point spread of a layer. The cost grows with the layer's size.
namespace airtruth::composite {

// Haze by Koschmieder (1924): over a range r the light L becomes L t + A (1 - t), t =
// exp(-extinction r), channel by channel. `airlight` is A, linear: the light of an infinitely long
// path through the air.
void add_haze(image::Layer& layer,
              const std::array<double, 3>& extinction_per_km,
              const std::array<double, 3>& airlight);

// The layer after a Gaussian point spread of this standard deviation. Its patch grows by the reach
// of the Gaussian (three deviations) and by `margin_px`, and is clipped to the frame. Coverage is
// blurred with the colour, so that the labels agree with the picture.
image::Layer spread(
    const image::Layer& layer, double sigma_px, int margin_px, int frame_width, int frame_height);

// A Gaussian integrated over each pixel, with a sum of 1. The length is odd; {1} for a deviation of
// 0.
std::vector<float> gaussian(double sigma_px);

// Convolves one plane of values, rows of `width`, with symmetric kernels along its rows and its
// columns. Values outside the plane count as 0.
void blur(std::vector<float>& values,
          int width,
          int height,
          const std::vector<float>& across,
          const std::vector<float>& down);
// The same kernel along both axes.
void blur(std::vector<float>& values, int width, int height, const std::vector<float>& kernel);

}  // namespace airtruth::composite
