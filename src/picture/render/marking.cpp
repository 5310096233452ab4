// SPDX-License-Identifier: Apache-2.0
#include "picture/render/marking.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "foundation/base/vectors.h"

namespace airtruth::render {
namespace {

double largest_of(const std::array<double, 4>& corner, double largest = 0) {
  for (const double value : corner) largest = std::max(largest, std::abs(value));
  return largest;
}

Bilinear scaled(const std::array<double, 4>& corner, double scale) {
  return {static_cast<float>(corner[0] * scale),
          static_cast<float>((corner[1] - corner[0]) * scale),
          static_cast<float>((corner[2] - corner[0]) * scale),
          static_cast<float>((corner[0] - corner[1] - corner[2] + corner[3]) * scale)};
}

// Marks the samples that are inside. Returns true where every sample is marked.
template <typename Inside>
[[gnu::always_inline]] inline bool mark_where(int n, std::int32_t* covered, const Inside& inside) {
  std::int32_t all = -1;
  for (int i = 0; i < n; ++i) {
    const std::int32_t now = covered[i] | -static_cast<std::int32_t>(inside(i));
    covered[i] = now;
    all &= now;
  }
  return all == -1;
}

// A sample is inside where it is on the inner side of all three sides; an unused side is +1
// everywhere.
AIRTRUTH_FOR_SHORT_VECTORS
bool mark_all(
    const Bilinear* sides, const float* px, const float* py, int n, std::int32_t* covered) {
  const Bilinear p = sides[0];
  const Bilinear q = sides[1];
  const Bilinear r = sides[2];
  return mark_where(n, covered, [=](int i) {
    const float x = px[i];
    const float y = py[i];
    const float u = (p.a + p.b * x) + y * (p.c + p.d * x);
    const float v = (q.a + q.b * x) + y * (q.c + q.d * x);
    const float w = (r.a + r.b * x) + y * (r.c + r.d * x);
    return (u >= 0) & (v >= 0) & (w >= 0);
  });
}

// The same for a single side that crosses the pixel.
AIRTRUTH_FOR_SHORT_VECTORS
bool mark_one(
    const Bilinear* side, const float* px, const float* py, int n, std::int32_t* covered) {
  const Bilinear p = *side;
  return mark_where(
      n, covered, [=](int i) { return (p.a + p.b * px[i]) + py[i] * (p.c + p.d * px[i]) >= 0; });
}

// The linear form a + b x + c y + d t of a side, where the side is straight over the pixel and
// moves uniformly during its exposure. Sides of distant objects are of this form to within a
// fraction of the distance between samples.
std::optional<Bilinear> even_side(const Swept& side) {
  constexpr float kNegligiblePx = 0.004F;
  const Bilinear& p = side.steady;
  const Bilinear& q = side.first;
  const Bilinear& r = side.second;
  const float left_out = std::abs(p.d) / 4 + (std::abs(q.b) + std::abs(q.c) + std::abs(q.d)) / 2 +
                         std::abs(r.a) + std::abs(r.b) + std::abs(r.c) + std::abs(r.d);
  const float slope = std::hypot(p.b + p.d / 2, p.c + p.d / 2);
  if (!(left_out < kNegligiblePx * slope)) return std::nullopt;
  // Linearised about the pixel's middle: x y is approximately (x + y) / 2 - 1/4 and u (b x + c y)
  // is u (b + c) / 2.
  const float drift = q.a + (q.b + q.c) / 2 + q.d / 4;
  const float bend = (r.a + (r.b + r.c) / 2 + r.d / 4) / 3;
  return Bilinear{p.a - p.d / 4 - drift + bend, p.b + p.d / 2, p.c + p.d / 2, 2 * drift};
}

AIRTRUTH_FOR_SHORT_VECTORS
bool mark_even(const Bilinear* sides,
               const float* px,
               const float* py,
               const float* pt,
               int n,
               std::int32_t* covered) {
  const Bilinear p = sides[0];
  const Bilinear q = sides[1];
  const Bilinear r = sides[2];
  return mark_where(n, covered, [=](int i) {
    const float x = px[i];
    const float y = py[i];
    const float t = pt[i];
    const float u = (p.a + p.b * x) + (p.c * y + p.d * t);
    const float v = (q.a + q.b * x) + (q.c * y + q.d * t);
    const float w = (r.a + r.b * x) + (r.c * y + r.d * t);
    return (u >= 0) & (v >= 0) & (w >= 0);
  });
}

AIRTRUTH_FOR_SHORT_VECTORS
bool mark_one_even(const Bilinear* side,
                   const float* px,
                   const float* py,
                   const float* pt,
                   int n,
                   std::int32_t* covered) {
  const Bilinear p = *side;
  return mark_where(
      n, covered, [=](int i) { return (p.a + p.b * px[i]) + (p.c * py[i] + p.d * pt[i]) >= 0; });
}

// The same for sides without a linear form; an unused one is 1 everywhere.
AIRTRUTH_FOR_SHORT_VECTORS
void side_values(
    const Swept* side, const float* px, const float* py, const float* pt, int n, float* least) {
  const Bilinear p = side->steady;
  const Bilinear q = side->first;
  const Bilinear r = side->second;
  for (int i = 0; i < n; ++i) {
    const float u = 2 * pt[i] - 1;
    const float a = p.a + u * (q.a + u * r.a);
    const float b = p.b + u * (q.b + u * r.b);
    const float c = p.c + u * (q.c + u * r.c);
    const float d = p.d + u * (q.d + u * r.d);
    const float value = (a + b * px[i]) + py[i] * (c + d * px[i]);
    least[i] = value < least[i] ? value : least[i];
  }
}

// Marks the samples of the strips that are the bits of `strips`, of `width` samples each.
// value(side, i): of a side at sample i. kCrossing: how many sides are tested.
template <std::size_t kCrossing, typename Value>
[[gnu::always_inline]] inline unsigned mark_strips(
    const Straight* sides, int width, unsigned strips, std::int32_t* covered, const Value& value) {
  const Straight p = sides[0];
  const Straight q = sides[1];
  const Straight r = sides[2];
  unsigned full = 0;
  for (unsigned left = strips; left != 0; left &= left - 1) {
    const int first = __builtin_ctz(left) * width;
    const bool all = mark_where(width, covered + first, [=](int i) {
      bool inside = value(p, first + i) >= 0;
      if constexpr (kCrossing > 1) inside &= value(q, first + i) >= 0;
      if constexpr (kCrossing > 2) inside &= value(r, first + i) >= 0;
      return inside;
    });
    full |= static_cast<unsigned>(all) << __builtin_ctz(left);
  }
  return full;
}

template <typename Value>
[[gnu::always_inline]] inline unsigned mark_strips(const Straight* sides,
                                                   int crossing,
                                                   int width,
                                                   unsigned strips,
                                                   std::int32_t* covered,
                                                   const Value& value) {
  if (crossing == 1) return mark_strips<1>(sides, width, strips, covered, value);
  if (crossing == 2) return mark_strips<2>(sides, width, strips, covered, value);
  return mark_strips<3>(sides, width, strips, covered, value);
}

AIRTRUTH_FOR_SHORT_VECTORS
unsigned mark_straight(const Straight* sides,
                       int crossing,
                       const float* px,
                       const float* py,
                       int width,
                       unsigned strips,
                       std::int32_t* covered) {
  return mark_strips(sides, crossing, width, strips, covered, [=](const Straight& side, int i) {
    return side.a + side.b * px[i] + side.c * py[i];
  });
}

// The same during an exposure.
AIRTRUTH_FOR_SHORT_VECTORS
unsigned mark_straight_moving(const Straight* sides,
                              int crossing,
                              const float* px,
                              const float* py,
                              const float* pt,
                              int width,
                              unsigned strips,
                              std::int32_t* covered) {
  return mark_strips(sides, crossing, width, strips, covered, [=](const Straight& side, int i) {
    return (side.a + side.b * px[i]) + (side.c * py[i] + side.d * pt[i]);
  });
}

bool mark_swept(const Swept* sides,
                int count,
                const float* px,
                const float* py,
                const float* pt,
                int n,
                std::int32_t* covered) {
  alignas(64) std::array<float, PixelSamples::kMost> least;
  std::fill_n(least.begin(), n, 1.0F);
  for (int k = 0; k < count; ++k) side_values(sides + k, px, py, pt, n, least.data());
  return mark_where(n, covered, [&](int i) { return least[static_cast<std::size_t>(i)] >= 0; });
}

}  // namespace

Bilinear bilinear_of(const std::array<double, 4>& corner) {
  return scaled(corner, 1 / largest_of(corner));
}

Swept swept_of(const Thrice<std::array<double, 4>>& at) {
  double largest = 0;
  for (const auto& corner : at) largest = largest_of(corner, largest);
  std::array<double, 4> first;
  std::array<double, 4> second;
  for (std::size_t i = 0; i < 4; ++i) {
    first[i] = 0.5 * (at[2][i] - at[0][i]);
    second[i] = 0.5 * (at[2][i] - 2 * at[1][i] + at[0][i]);
  }
  const double scale = 1 / largest;
  return {scaled(at[1], scale), scaled(first, scale), scaled(second, scale)};
}

bool mark(const std::array<Bilinear, 3>& sides,
          int crossing,
          const Places& places,
          int samples,
          std::int32_t* covered) {
  const auto mark_them = crossing == 1 ? mark_one : mark_all;
  return mark_them(sides.data(), places.x.data(), places.y.data(), samples, covered);
}

unsigned mark(const std::array<Straight, 3>& sides,
              int crossing,
              bool moves,
              const Places& places,
              int samples,
              unsigned strips,
              std::int32_t* covered) {
  const float* x = places.x.data();
  const float* y = places.y.data();
  const float* t = places.t.data();
  const int width = samples / PixelSamples::kStrips;
  return moves ? mark_straight_moving(sides.data(), crossing, x, y, t, width, strips, covered)
               : mark_straight(sides.data(), crossing, x, y, width, strips, covered);
}

// Chooses the cheapest method that is accurate enough.
bool mark(const std::array<Swept, 3>& sides,
          int crossing,
          const Places& places,
          int samples,
          std::int32_t* covered) {
  std::array<Bilinear, 3> even;
  for (int k = 0; k < crossing; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const auto side = even_side(sides[i]);
    if (!side)
      return mark_swept(sides.data(),
                        crossing,
                        places.x.data(),
                        places.y.data(),
                        places.t.data(),
                        samples,
                        covered);
    even[i] = *side;
  }
  const auto mark_them = crossing == 1 ? mark_one_even : mark_even;
  return mark_them(
      even.data(), places.x.data(), places.y.data(), places.t.data(), samples, covered);
}

}  // namespace airtruth::render
