// SPDX-License-Identifier: Apache-2.0
#include "scene/synthetic/relief.h"

#include <algorithm>

namespace airtruth::synthetic {
namespace {

// Where a constant of this file states no origin, it is a choice: the world is invented.

// Number of steps through the height field.
constexpr int kMarch = 7;
// The range of near rays, and bisections of the step that meets the field, for near rays and for
// others.
constexpr float kNear_m = 600;
constexpr int kNearBisections = 4;
constexpr int kFarBisections = 2;
// No ray of a search is longer.
constexpr float kFarthestRelief_m = 1e9F;

// A ray on its way: it is outside of everything at `clear_m`, and it is known to be inside of
// something at `inside_m` once it has met it.
struct March {
  int count = 0;
  alignas(64) Integers level;
  alignas(64) Integers first;
  alignas(64) Integers wrap;
  alignas(64) Floats scale;
  alignas(64) Floats north;
  alignas(64) Floats east;
  alignas(64) Floats down;
  alignas(64) Floats far_m;
  alignas(64) Floats peak_m;
  alignas(64) Floats step_m;
  alignas(64) Floats clear_m;
  alignas(64) Floats inside_m;
};

// The field seen by one batch: reciprocal of a texel's side, and metres of one step of a height
// byte and of an interpolated one.
struct View {
  const std::uint32_t* texels;
  Eye eye;
  float texel_m;
  float per_texel;
  float byte_m;
  float sum_m;
};

inline float smooth_height_m(const View& view, const March& m, int i, float s) {
  const float x = (view.eye.north_m + s * m.north[i]) * view.per_texel;
  const float y = (view.eye.east_m + s * m.east[i]) * view.per_texel;
  const Neighbours n =
      neighbours(x * m.scale[i] - 0.5F, y * m.scale[i] - 0.5F, m.first[i], m.wrap[i]);
  return interpolated_height(view.texels, n) * view.sum_m;
}

AIRTRUTH_FOR_VECTORS
void start(const HeightField& field, const Search& search, March& __restrict m) {
  const MipMap& map = *field.map;
  const float per_texel = 1 / field.texel_m;
  const std::int32_t* first = map.first.data();
  const std::int32_t* wrap = map.wrap.data();
  const float* scale = map.scale.data();
  const int top = map.levels - 2;
  const int count = search.count;
  for (int i = 0; i < count; ++i) {
    const float step = search.peak_m[i] / search.down[i] / kMarch;
    const float level = std::max(search.across[i], fast_log2(step * 0.4F * per_texel));
    m.level[i] = std::clamp(static_cast<int>(level), 0, top);
    m.step_m[i] = step;
    m.clear_m[i] = search.far_m[i] - search.peak_m[i] / search.down[i];
    m.north[i] = search.north[i];
    m.east[i] = search.east[i];
    m.down[i] = search.down[i];
    m.far_m[i] = search.far_m[i];
    m.peak_m[i] = search.peak_m[i];
  }
  for (int i = 0; i < count; ++i) {
    m.first[i] = first[m.level[i]];
    m.wrap[i] = wrap[m.level[i]];
    m.scale[i] = scale[m.level[i]];
  }
  m.count = count;
}

// One step of every ray that has met nothing.
AIRTRUTH_FOR_VECTORS
void step(const View& view, March& __restrict m) {
  const std::uint32_t* texels = view.texels;
  const int count = m.count;
  for (int i = 0; i < count; ++i) {
    const float inside = m.clear_m[i] + m.step_m[i];
    const float x = (view.eye.north_m + inside * m.north[i]) * view.per_texel;
    const float y = (view.eye.east_m + inside * m.east[i]) * view.per_texel;
    const std::int32_t ix = floor_int(x * m.scale[i]) & m.wrap[i];
    const std::int32_t iy = floor_int(y * m.scale[i]) & m.wrap[i];
    const std::uint32_t texel = texels[m.first[i] + index_of_row(iy, m.wrap[i]) + index_in_row(ix)];
    const float height_m = static_cast<float>(static_cast<std::int32_t>(texel >> 24)) * view.byte_m;
    const bool free = (m.far_m[i] - inside) * m.down[i] >= height_m;
    m.clear_m[i] = free ? inside : m.clear_m[i];
    m.inside_m[i] = free ? -1.0F : inside;
  }
}

// Copies the chosen rays.
AIRTRUTH_FOR_VECTORS
void select_rays(const March& from, const Integers& chosen, int count, March& __restrict to) {
  select(from.first, chosen, count, to.first);
  select(from.wrap, chosen, count, to.wrap);
  select(from.scale, chosen, count, to.scale);
  select(from.north, chosen, count, to.north);
  select(from.east, chosen, count, to.east);
  select(from.down, chosen, count, to.down);
  select(from.far_m, chosen, count, to.far_m);
  select(from.peak_m, chosen, count, to.peak_m);
  select(from.clear_m, chosen, count, to.clear_m);
  select(from.inside_m, chosen, count, to.inside_m);
  to.count = count;
}

// Halves the interval of the rays that reach the ground before `end_m`.
AIRTRUTH_FOR_VECTORS
void bisect(const View& view, float end_m, March& __restrict m) {
  const int count = m.count;
  for (int i = 0; i < count; ++i) {
    const float s = 0.5F * (m.clear_m[i] + m.inside_m[i]);
    const bool below = (m.far_m[i] - s) * m.down[i] < smooth_height_m(view, m, i, s);
    const bool wanted = m.far_m[i] < end_m;
    m.inside_m[i] = (wanted & below) ? s : m.inside_m[i];
    m.clear_m[i] = (wanted & !below) ? s : m.clear_m[i];
  }
}

// Steep slopes are darker.
AIRTRUTH_FOR_VECTORS
void shade(const View& view, March& m, float* factor) {
  const int count = m.count;
  for (int i = 0; i < count; ++i) {
    const float ray_m = (m.far_m[i] - m.inside_m[i]) * m.down[i];
    const float behind = m.inside_m[i] + 0.8F * view.texel_m;
    const float top_m = smooth_height_m(view, m, i, behind);
    factor[i] = 1 - 0.5F * clamp01((top_m - ray_m) / (0.6F * m.peak_m[i]));
  }
}

}  // namespace

void meet(const HeightField& field, const Eye& eye, Search& search) {
  const View view{field.map->texels.data(),
                  eye,
                  field.texel_m,
                  1 / field.texel_m,
                  field.highest_m / 255,
                  field.highest_m / 65280};
  March all;
  start(field, search, all);
  for (int i = 0; i < kMarch; ++i) step(view, all);
  // The rays that met something.
  March met;
  alignas(64) Integers chosen;
  int count = 0;
  bool near = false;
  for (int i = 0; i < all.count; ++i) {
    search.distance_m[i] = -1;
    chosen[count] = i;
    count += all.inside_m[i] >= 0 ? 1 : 0;
    near |= all.far_m[i] < kNear_m;
  }
  select_rays(all, chosen, count, met);
  for (int i = 0; i < kFarBisections; ++i) bisect(view, kFarthestRelief_m, met);
  for (int i = kFarBisections; near && i < kNearBisections; ++i) bisect(view, kNear_m, met);
  alignas(64) Floats factor;
  shade(view, met, factor);
  for (int i = 0; i < met.count; ++i) {
    search.distance_m[chosen[i]] = met.inside_m[i];
    search.shade[chosen[i]] = factor[i];
  }
}

}  // namespace airtruth::synthetic
