// SPDX-License-Identifier: Apache-2.0
#include "picture/render/nearest.h"

#include <bit>

#include "picture/render/vectors.h"

namespace airtruth::render {
namespace {

AIRTRUTH_VECTORS
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
  const float low = depth.farthest;
  const float high = depth.nearest;
  for (int i = from; i < to; ++i) {
    const float x = px[i];
    const float y = py[i];
    const float u = p.a + p.b * x + p.c * y;
    const float v = q.a + q.b * x + q.c * y;
    const float w = r.a + r.b * x + r.c * y;
    const float plane = n.a + n.b * x + n.c * y;
    const float above = plane < low ? low : plane;
    const float here = above > high ? high : above;
    const bool in_front = (u >= 0) & (v >= 0) & (w >= 0) & (here > nearness[i]);
    nearness[i] = in_front ? here : nearness[i];
    who[i] = in_front ? triangle : who[i];
  }
}

AIRTRUTH_VECTORS
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
  const float low = depth.farthest;
  const float high = depth.nearest;
  for (int i = from; i < to; ++i) {
    const float x = px[i];
    const float y = py[i];
    const float t = pt[i];
    const float u = (p.a + p.b * x) + (p.c * y + p.d * t);
    const float v = (q.a + q.b * x) + (q.c * y + q.d * t);
    const float w = (r.a + r.b * x) + (r.c * y + r.d * t);
    const float plane = (n.a + n.b * x) + (n.c * y + n.d * t);
    const float above = plane < low ? low : plane;
    const float here = above > high ? high : above;
    const bool in_front = (u >= 0) & (v >= 0) & (w >= 0) & (here > nearness[i]);
    nearness[i] = in_front ? here : nearness[i];
    who[i] = in_front ? triangle : who[i];
  }
}

AIRTRUTH_VECTORS
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
  const float low = depth.farthest;
  const float high = depth.nearest;
  for (int i = 0; i < n; ++i) {
    const float there = (plane.a + plane.b * px[i]) + (plane.c * py[i] + per_time * pt[i]);
    const float above = there < low ? low : there;
    const float here = above > high ? high : above;
    const bool in_front = (inside[i] != 0) & (here > nearness[i]);
    nearness[i] = in_front ? here : nearness[i];
    who[i] = in_front ? triangle : who[i];
  }
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

}  // namespace airtruth::render
