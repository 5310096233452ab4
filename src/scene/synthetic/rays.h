// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "foundation/base/vectors.h"

namespace airtruth::synthetic {

// Place of the camera, and the sine of the dip of its horizon.
struct Eye {
  float north_m = 0;
  float east_m = 0;
  float height_m = 0;
  float dip = 0;
};

// The rays of a row of pixels and the light that reaches them: unit directions in the world
// (north-east-down), linear red, green and blue before the lens's fall-off, and that fall-off, 0 to
// 1. One array for each quantity, so that the compiler emits loops over vectors. The arrays have
// room for `width` rounded up to a multiple of 8.
struct Row {
  // Pixels side by side.
  struct Run {
    int count;
    const float *north, *east, *down;
    float *red, *green, *blue;
  };
  // The largest number of pixels of a run, whose numbers fit in the first-level cache.
  static constexpr int kRun = 128;

  explicit Row(int width) {
    for (std::vector<float>* part : {&north, &east, &down, &red, &green, &blue, &fall_off})
      part->resize((static_cast<std::size_t>(width) + 7) & ~std::size_t{7});
  }
  Run run(std::size_t first, std::size_t count) {
    return {static_cast<int>(count),
            &north[first],
            &east[first],
            &down[first],
            &red[first],
            &green[first],
            &blue[first]};
  }
  std::vector<float> north, east, down;
  std::vector<float> red, green, blue;
  std::vector<float> fall_off;
};

// Base-2 logarithm of a positive number with an error below 0.09, which suffices to choose a mip
// level.
inline float fast_log2(float x) {
  return static_cast<float>(std::bit_cast<std::int32_t>(x)) * 0x1p-23F - 126.94F;
}

// e^x for x from -80 to 0, rounded to a float: Taylor's series in double precision, with an error
// below 1e-12 before rounding. It gives the same bits everywhere, unlike std::exp.
inline float exp_of_negative(float x) {
  constexpr double kLog2E = 1.4426950408889634;
  constexpr double kLn2 = 0.6931471805599453;
  const double power = kLog2E * static_cast<double>(x);
  const auto whole = static_cast<std::int32_t>(power - 0.5);
  const double r = kLn2 * (power - whole);
  double sum = 1;
  for (int n = 10; n >= 1; --n) sum = 1 + r * (1.0 / n) * sum;
  const auto scale = std::bit_cast<double>((static_cast<std::int64_t>(whole) + 1023) << 52);
  return static_cast<float>(sum * scale);
}

// The cosine of an angle up to some thousand radians, rounded to a float: 1 - 2 sin^2 of the half
// angle by Taylor's series in double precision, with an error below 1e-11 before rounding. It gives
// the same bits everywhere, unlike std::cos.
inline float cosine_of(float angle_rad) {
  constexpr double kPerTurn = 0.15915494309189535;
  constexpr double kHalfTurn = 3.141592653589793;
  const double turns = kPerTurn * static_cast<double>(angle_rad);
  const auto whole = static_cast<std::int32_t>(turns + (turns < 0 ? -0.5 : 0.5));
  const double half = kHalfTurn * (turns - whole);
  const double square = half * half;
  double sum = 1;
  for (int n = 16; n >= 2; n -= 2) sum = 1 - square * (1.0 / (n * (n + 1))) * sum;
  const double sine = half * sum;
  return static_cast<float>(1 - 2 * sine * sine);
}

}  // namespace airtruth::synthetic
