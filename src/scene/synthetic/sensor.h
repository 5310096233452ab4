// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "foundation/image/picture.h"
#include "scene/synthetic/flight.h"
#include "scene/synthetic/rays.h"

namespace airtruth::synthetic {

// Converts light to the samples of a cheap camera: a fixed exposure with a soft shoulder, noise,
// sharpening and 4:2:0.
class Sensor {
 public:
  Sensor(const FlightOptions& options, std::uint32_t seed);

  // Luma of a picture before sharpening, in 1/64 of a code value.
  using Exposure = std::vector<std::uint16_t>;

  // Exposes rows y and y + 1, with an even y; at the bottom of a picture of odd height both are the
  // same row. Rows can come in any order and on any thread.
  void expose(int frame,
              int y,
              const Row& upper,
              const Row& lower,
              Exposure& exposure,
              image::Picture& picture) const;

  // Sharpens a row. All rows must be exposed before.
  void sharpen(const Exposure& exposure, int y, image::Picture& picture) const;

 private:
  void copy_grain(int frame, int y, int channel, float* grain) const;

  int width_;
  int height_;
  float noise_;
  bool ideal_;
  std::uint32_t seed_;
  std::vector<float> curve_;
  // Normally distributed, of mean 0 and standard deviation 1: square tiles, one for each use.
  std::array<std::vector<float>, 3> grain_;
};

}  // namespace airtruth::synthetic
