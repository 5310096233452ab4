// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "foundation/image/picture.h"
#include "scene/synthetic/flight.h"
#include "scene/synthetic/noise.h"

namespace airtruth::synthetic {

// Light that reaches each pixel of a row through the lens.
using LightRow = std::vector<LinearRgb>;

// Converts light to the samples of a cheap camera: a fixed exposure with a soft shoulder, noise,
// sharpening and 4:2:0.
class Sensor {
 public:
  Sensor(const FlightOptions& options, std::uint32_t seed);

  // Luma before sharpening, in 1/64 of a code value; each row goes on by two pixels at both ends.
  using Exposure = std::vector<std::uint16_t>;
  Exposure start() const;

  // Exposes rows y and y + 1, with an even y; at the bottom of a picture of odd height both are the
  // same row. Rows can come in any order and on any thread.
  void expose(int frame,
              int y,
              LightRow upper,
              LightRow lower,
              Exposure& exposure,
              image::Picture& picture) const;

  // Applies the lens's blur to a row, then the camera's unsharp mask. All rows must be exposed
  // before.
  void sharpen(const Exposure& exposure, int y, image::Picture& picture) const;

 private:
  // A row of normally distributed numbers.
  struct Grain {
    const float* tile;
    int first;
    float at(int x) const { return tile[(first + x) & (kGrain - 1)]; }
  };
  static constexpr int kGrain = 256;
  Grain grain(int frame, int y, std::size_t channel) const;
  void develop(LightRow& row) const;
  void expose_luma(const LightRow& codes, const Grain& grain, std::uint16_t* luma) const;
  std::size_t stride() const { return static_cast<std::size_t>(width_) + 4; }

  int width_;
  int height_;
  float noise_;
  bool ideal_;
  std::uint32_t seed_;
  std::vector<float> curve_;
  // Of mean 0 and standard deviation 1: square tiles, one for each use.
  std::array<std::vector<float>, 3> grain_;
};

}  // namespace airtruth::synthetic
