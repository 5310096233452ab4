// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
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

// Value noise in [0, 1) on a plane. It repeats after `period` lattice cells; `period` is a power of
// two. The corners of the last lattice cell are kept: a row of near places costs few hashes.
class PlaneNoise {
 public:
  PlaneNoise() = default;
  PlaneNoise(int period, std::uint32_t seed) : wrap_(period - 1), seed_(seed) {}

  float at(float x, float y) {
    const int x0 = floor_int(x);
    const int y0 = floor_int(y);
    if (!has_corners_ || x0 != x0_ || y0 != y0_) take_corners(x0, y0);
    const float fx = x - static_cast<float>(x0);
    const float fy = y - static_cast<float>(y0);
    const float sx = fx * fx * (3 - 2 * fx);
    const float sy = fy * fy * (3 - 2 * fy);
    return lerp(lerp(corners_[0], corners_[1], sx), lerp(corners_[2], corners_[3], sx), sy);
  }

 private:
  void take_corners(int x0, int y0) {
    const auto corner = [&](int i, int j) {
      return unit(hash((x0 + i) & wrap_, (y0 + j) & wrap_, seed_));
    };
    corners_ = {corner(0, 0), corner(1, 0), corner(0, 1), corner(1, 1)};
    x0_ = x0;
    y0_ = y0;
    has_corners_ = true;
  }

  int wrap_ = 0;
  std::uint32_t seed_ = 0;
  bool has_corners_ = false;
  int x0_ = 0, y0_ = 0;
  std::array<float, 4> corners_{};
};

// Value noise in space, on its plane at z.
class SpaceNoise {
 public:
  SpaceNoise() = default;
  SpaceNoise(float z, int period, std::uint32_t seed) {
    const int z0 = floor_int(z);
    const float fz = z - static_cast<float>(z0);
    const auto layer = [&](int i) {
      return PlaneNoise(period, seed + 977U * static_cast<std::uint32_t>((z0 + i) & (period - 1)));
    };
    below_ = layer(0);
    above_ = layer(1);
    share_ = fz * fz * (3 - 2 * fz);
  }
  float at(float x, float y) { return lerp(below_.at(x, y), above_.at(x, y), share_); }

 private:
  PlaneNoise below_, above_;
  float share_ = 0;
};

// Octaves of noise, each half as strong and twice as fine as the one before; about [0, 1], with a
// mean of 0.5.
template <typename Noise, int kOctaves>
class Fractal {
 public:
  // make(i): the noise of an octave.
  template <typename Make>
  explicit Fractal(const Make& make) {
    for (int i = 0; i < kOctaves; ++i) octaves_[static_cast<std::size_t>(i)] = make(i);
  }
  float at(float x, float y) {
    float sum = 0;
    float weight = 0.5F;
    float total = 0;
    float scale = 1;
    for (Noise& octave : octaves_) {
      sum += weight * octave.at(x * scale, y * scale);
      total += weight;
      weight *= 0.5F;
      scale *= 2;
    }
    return sum / total;
  }

 private:
  std::array<Noise, kOctaves> octaves_;
};

inline std::uint32_t seed_of_octave(std::uint32_t seed, int octave) {
  return seed + 131U * static_cast<std::uint32_t>(octave);
}

// On a plane.
template <int kOctaves>
Fractal<PlaneNoise, kOctaves> fractal(int period, std::uint32_t seed) {
  return Fractal<PlaneNoise, kOctaves>(
      [=](int i) { return PlaneNoise(period << i, seed_of_octave(seed, i)); });
}

// In space, at z.
template <int kOctaves>
Fractal<SpaceNoise, kOctaves> fractal(float z, int period, std::uint32_t seed) {
  return Fractal<SpaceNoise, kOctaves>([=](int i) {
    return SpaceNoise(z * static_cast<float>(1 << i), period << i, seed_of_octave(seed, i));
  });
}

}  // namespace airtruth::synthetic
