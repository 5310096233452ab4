// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "foundation/geometry/box.h"
#include "foundation/image/layer.h"

// Haze and point spread of a layer. The cost grows with the layer's size.
namespace airtruth::composite {

// Haze by Koschmieder (1924): over a range r the light L becomes L t + A (1 - t), t =
// exp(-extinction r), channel by channel. `airlight` is A, linear: the light of an infinitely long
// path through the air.
void add_haze(image::Layer& layer,
              const std::array<double, 3>& extinction_per_km,
              const std::array<double, 3>& airlight);

// The standard deviations of a Gaussian point spread along the rows and along the columns, px.
struct PointSpread {
  double across_px = 0, down_px = 0;
};

// The layer after a point spread. Its patch grows by the reach of the Gaussian (three deviations)
// and by `margin_px`, and is clipped to the frame. Coverage is blurred with the colour, so that the
// labels agree with the picture. What the frame cuts continues beyond it as it is at the frame's
// edge.
image::Layer spread(const image::Layer& layer,
                    const PointSpread& point_spread,
                    int margin_px,
                    int frame_width,
                    int frame_height);

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

// The values of the pixels of a box after such a blur, for the pixels of another box. Both boxes
// are inside the frame. Values outside `from` count as 0, but beyond the edge of the frame they are
// those at the edge.
std::vector<float> blurred(const std::vector<float>& values,
                           const PixelBox& from,
                           const PixelBox& to,
                           const PixelBox& frame,
                           const std::vector<float>& across,
                           const std::vector<float>& down);

}  // namespace airtruth::composite
