// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>

#include <Eigen/Core>

// Repeatable procedural noise: value noise on integer lattices, periodic so that textures can tile.
namespace airtruth::synthetic {

// Linear red, green and blue (sRGB primaries, 1 is a sunlit white wall), and a fourth number whose
// meaning each caller defines.
using LinearRgb = Eigen::Array4f;

inline LinearRgb linear_rgb(float red, float green, float blue) { return {red, green, blue, 0.0F}; }

inline std::uint32_t mix(std::uint32_t h) {
  h ^= h >> 16;
  h *= 0x7feb352dU;
  h ^= h >> 15;
  h *= 0x846ca68bU;
  return h ^ (h >> 16);
}

inline std::uint32_t hash(int x, int y, std::uint32_t seed) {
  return mix(static_cast<std::uint32_t>(x) * 0x9e3779b1U ^
             mix(static_cast<std::uint32_t>(y) + seed * 0x85ebca6bU));
}

// Maps a hash to [0, 1).
inline float unit(std::uint32_t h) {
  return static_cast<float>(static_cast<std::int32_t>(h >> 8)) * 0x1p-24F;
}

inline float clamp01(float x) { return x < 0 ? 0.0F : (x > 1 ? 1.0F : x); }

inline float smoothstep(float low, float high, float x) {
  const float t = clamp01((x - low) / (high - low));
  return t * t * (3 - 2 * t);
}

inline float lerp(float a, float b, float t) { return a + (b - a) * t; }

inline int floor_int(float x) {
  const int i = static_cast<int>(x);
  return i - (x < static_cast<float>(i) ? 1 : 0);
}

// Value noise in [0, 1). It repeats after `period` lattice cells; `period` is a power of two.
inline float value_noise(float x, float y, int period, std::uint32_t seed) {
  const int x0 = floor_int(x);
  const int y0 = floor_int(y);
  const float fx = x - static_cast<float>(x0);
  const float fy = y - static_cast<float>(y0);
  const float sx = fx * fx * (3 - 2 * fx);
  const float sy = fy * fy * (3 - 2 * fy);
  const int wrap = period - 1;
  const auto at = [&](int i, int j) { return unit(hash((x0 + i) & wrap, (y0 + j) & wrap, seed)); };
  return lerp(lerp(at(0, 0), at(1, 0), sx), lerp(at(0, 1), at(1, 1), sx), sy);
}

inline float value_noise(float x, float y, float z, int period, std::uint32_t seed) {
  const int z0 = floor_int(z);
  const float fz = z - static_cast<float>(z0);
  const auto layer = [&](int i) {
    return value_noise(
        x, y, period, seed + 977U * static_cast<std::uint32_t>((z0 + i) & (period - 1)));
  };
  return lerp(layer(0), layer(1), fz * fz * (3 - 2 * fz));
}

// Sum of octaves of noise(scale, period, seed), each half as strong and twice as fine as the one
// before; about [0, 1], with a mean of 0.5.
template <typename Noise>
inline float sum_of_octaves(int octaves, int period, std::uint32_t seed, const Noise& noise) {
  float sum = 0;
  float weight = 0.5F;
  float total = 0;
  float scale = 1;
  for (int i = 0; i < octaves; ++i) {
    sum += weight * noise(scale, period, seed + 131U * static_cast<std::uint32_t>(i));
    total += weight;
    weight *= 0.5F;
    scale *= 2;
    period *= 2;
  }
  return sum / total;
}

inline float fractal(float x, float y, int octaves, int period, std::uint32_t seed) {
  return sum_of_octaves(octaves, period, seed, [=](float scale, int cells, std::uint32_t id) {
    return value_noise(x * scale, y * scale, cells, id);
  });
}

inline float fractal(float x, float y, float z, int octaves, int period, std::uint32_t seed) {
  return sum_of_octaves(octaves, period, seed, [=](float scale, int cells, std::uint32_t id) {
    return value_noise(x * scale, y * scale, z * scale, cells, id);
  });
}

}  // namespace airtruth::synthetic
