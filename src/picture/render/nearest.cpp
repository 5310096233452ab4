// SPDX-License-Identifier: Apache-2.0
#include "picture/render/nearest.h"

#include <bit>
#include <limits>

#include "foundation/base/vectors.h"

namespace airtruth::render {
namespace {

// A plane may leave the range of its triangle's corners between the samples of a pixel; `here` does
// not.
template <typename Inside, typename Plane>
[[gnu::always_inline]] inline void keep_where(int from,
                                              int to,
                                              const PixelDepth& depth,
                                              std::int32_t triangle,
                                              float* __restrict nearness,
                                              std::int32_t* __restrict who,
                                              const Inside& inside,
                                              const Plane& plane) {
  const float low = depth.farthest;
  const float high = depth.nearest;
  for (int i = from; i < to; ++i) {
    const float there = plane(i);
    const float above = there < low ? low : there;
    const float here = above > high ? high : above;
    const bool in_front = inside(i) & (here > nearness[i]);
    nearness[i] = in_front ? here : nearness[i];
    who[i] = in_front ? triangle : who[i];
  }
}

AIRTRUTH_FOR_SHORT_VECTORS
void nearest_still(const Straight* sides,
                   const PixelDepth& depth,
                   std::int32_t triangle,
                   const float* px,
                   const float* py,
                   int from,
                   int to,
                   float* __restrict nearness,
                   std::int32_t* __restrict who) {
  const Straight p = sides[0];
  const Straight q = sides[1];
  const Straight r = sides[2];
  const Straight n = depth.nearness;
  const auto at = [=](const Straight& form, int i) {
    return form.a + form.b * px[i] + form.c * py[i];
  };
  keep_where(
      from,
      to,
      depth,
      triangle,
      nearness,
      who,
      [=](int i) {
        const float u = at(p, i);
        const float v = at(q, i);
        const float w = at(r, i);
        return (u >= 0) & (v >= 0) & (w >= 0);
      },
      [=](int i) { return at(n, i); });
}

AIRTRUTH_FOR_SHORT_VECTORS
void nearest_moving(const Straight* sides,
                    const PixelDepth& depth,
                    std::int32_t triangle,
                    const float* px,
                    const float* py,
                    const float* pt,
                    int from,
                    int to,
                    float* __restrict nearness,
                    std::int32_t* __restrict who) {
  const Straight p = sides[0];
  const Straight q = sides[1];
  const Straight r = sides[2];
  const Straight n = depth.nearness;
  const auto at = [=](const Straight& form, int i) {
    return (form.a + form.b * px[i]) + (form.c * py[i] + form.d * pt[i]);
  };
  keep_where(
      from,
      to,
      depth,
      triangle,
      nearness,
      who,
      [=](int i) {
        const float u = at(p, i);
        const float v = at(q, i);
        const float w = at(r, i);
        return (u >= 0) & (v >= 0) & (w >= 0);
      },
      [=](int i) { return at(n, i); });
}

AIRTRUTH_FOR_SHORT_VECTORS
void nearest_inside(const std::int32_t* inside,
                    const PixelDepth& depth,
                    float per_time,
                    std::int32_t triangle,
                    const float* px,
                    const float* py,
                    const float* pt,
                    int n,
                    float* __restrict nearness,
                    std::int32_t* __restrict who) {
  const Straight plane = depth.nearness;
  keep_where(
      0,
      n,
      depth,
      triangle,
      nearness,
      who,
      [=](int i) { return inside[i] != 0; },
      [=](int i) { return (plane.a + plane.b * px[i]) + (plane.c * py[i] + per_time * pt[i]); });
}

// Floats that are not negative have the order of their bits. The least of whole numbers, unlike
// that of floats, may be found in any order, and so by vectors.
AIRTRUTH_FOR_SHORT_VECTORS
std::int32_t least_bits(const float* nearness, int n) {
  std::int32_t least = std::numeric_limits<std::int32_t>::max();
  for (int i = 0; i < n; ++i) {
    const auto bits = std::bit_cast<std::int32_t>(nearness[i]);
    least = bits < least ? bits : least;
  }
  return least;
}

}  // namespace

void keep_nearest(const std::array<Straight, 3>& sides,
                  const PixelDepth& depth,
                  std::uint32_t triangle,
                  bool moves,
                  const Places& places,
                  int samples,
                  unsigned strips,
                  Nearest& nearest) {
  const int width = samples / PixelSamples::kStrips;
  const int from = std::countr_zero(strips) * width;
  const int to = std::bit_width(strips) * width;
  const auto who = static_cast<std::int32_t>(triangle);
  float* nearness = nearest.nearness.data();
  std::int32_t* triangles = nearest.triangle.data();
  const float* x = places.x.data();
  const float* y = places.y.data();
  if (moves)
    nearest_moving(sides.data(), depth, who, x, y, places.t.data(), from, to, nearness, triangles);
  else
    nearest_still(sides.data(), depth, who, x, y, from, to, nearness, triangles);
}

void keep_nearest(const std::int32_t* inside,
                  const PixelDepth& depth,
                  std::uint32_t triangle,
                  bool moves,
                  const Places& places,
                  int samples,
                  Nearest& nearest) {
  nearest_inside(inside,
                 depth,
                 moves ? depth.nearness.d : 0,
                 static_cast<std::int32_t>(triangle),
                 places.x.data(),
                 places.y.data(),
                 places.t.data(),
                 samples,
                 nearest.nearness.data(),
                 nearest.triangle.data());
}

float least_nearness(const Nearest& nearest, int samples) {
  return std::bit_cast<float>(least_bits(nearest.nearness.data(), samples));
}

}  // namespace airtruth::render
