// SPDX-License-Identifier: Apache-2.0
#include "picture/render/visibility.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "foundation/base/vectors.h"

namespace airtruth::render {
namespace {

// Samples of a pixel whose textures are read.
constexpr int kReads = 16;

// Calls use(i, is_inside, inverse distance) for the samples [from, to). kTerms: 3 at an instant, 4
// for a uniform motion, 7 for all.
template <int kTerms, typename Use>
[[gnu::always_inline]] inline void each_sample(const PixelFunctions& k,
                                               float farthest,
                                               float nearest,
                                               const Samples& samples,
                                               int from,
                                               int to,
                                               const Use& use) {
  const float* px = samples.x.data();
  const float* py = samples.y.data();
  const float* pt = samples.t.data();
  const auto value_of = [&](int f, float x, float y, float t) {
    if constexpr (kTerms == 3) return (k.at[f] + k.per_x[f] * x) + k.per_y[f] * y;
    if constexpr (kTerms == 4)
      return (k.at[f] + k.per_x[f] * x) + (k.per_y[f] * y + k.per_t[f] * t);
    return (k.at[f] + t * (k.per_t[f] + k.per_tt[f] * t)) + x * (k.per_x[f] + k.per_xt[f] * t) +
           y * (k.per_y[f] + k.per_yt[f] * t);
  };
  for (int i = from; i < to; ++i) {
    const float x = px[i];
    const float y = py[i];
    const float t = kTerms == 3 ? 0 : pt[i];
    const float e0 = value_of(0, x, y, t);
    const float e1 = value_of(1, x, y, t);
    const float e2 = value_of(2, x, y, t);
    const float depth = value_of(3, x, y, t);
    const bool inside = (e0 >= 0) & (e1 >= 0) & (e2 >= 0);
    const float above = depth < farthest ? farthest : depth;
    use(i, inside, above > nearest ? nearest : above);
  }
}

// What a kernel reads and writes.
struct Buffer {
  const Samples& samples;
  // The strata that are looked at.
  int from;
  int to;
  float* __restrict depth;
  std::int32_t* __restrict nearest;
  // By stratum.
  float* __restrict hidden;
};

template <int kTerms>
[[gnu::always_inline]] inline void keep_nearest_of(const PixelFunctions& functions_of_triangle,
                                                   float farthest,
                                                   float nearest,
                                                   std::int32_t who,
                                                   const Buffer& buffer) {
  const PixelFunctions functions = functions_of_triangle;
  const int each = buffer.samples.of_stratum();
  float* __restrict const depth = buffer.depth;
  std::int32_t* __restrict const nearest_of = buffer.nearest;
  for (int s = buffer.from; s < buffer.to; ++s) {
    if (nearest < buffer.hidden[s]) continue;
    // Floats that are not negative have the order of their bits, and the least of whole numbers may
    // be found by vectors.
    std::int32_t least = 0x7f800000;
    each_sample<kTerms>(functions,
                        farthest,
                        nearest,
                        buffer.samples,
                        s * each,
                        (s + 1) * each,
                        [&](int i, bool inside, float here) {
                          const bool in_front = inside & (here > depth[i]);
                          const float now = in_front ? here : depth[i];
                          depth[i] = now;
                          nearest_of[i] = in_front ? who : nearest_of[i];
                          const auto bits = std::bit_cast<std::int32_t>(now);
                          least = bits < least ? bits : least;
                        });
    buffer.hidden[s] = std::bit_cast<float>(least);
  }
}

AIRTRUTH_FOR_SHORT_VECTORS
void keep_nearest_still(const PixelFunctions& functions,
                        float farthest,
                        float nearest,
                        std::int32_t who,
                        const Buffer& buffer) {
  keep_nearest_of<3>(functions, farthest, nearest, who, buffer);
}
AIRTRUTH_FOR_SHORT_VECTORS
void keep_nearest_uniform(const PixelFunctions& functions,
                          float farthest,
                          float nearest,
                          std::int32_t who,
                          const Buffer& buffer) {
  keep_nearest_of<4>(functions, farthest, nearest, who, buffer);
}
AIRTRUTH_FOR_SHORT_VECTORS
void keep_nearest_moving(const PixelFunctions& functions,
                         float farthest,
                         float nearest,
                         std::int32_t who,
                         const Buffer& buffer) {
  keep_nearest_of<7>(functions, farthest, nearest, who, buffer);
}

// The inverse distance of a translucent triangle where it is before the nearest opaque one, else 0.
AIRTRUTH_FOR_SHORT_VECTORS
void find_fragments(const PixelFunctions& functions_of_triangle,
                    float farthest,
                    float nearest,
                    const Samples& samples,
                    int from,
                    int to,
                    const float* __restrict depth,
                    float* __restrict fragment) {
  const PixelFunctions functions = functions_of_triangle;
  each_sample<7>(
      functions, farthest, nearest, samples, from, to, [&](int i, bool inside, float here) {
        fragment[i] = inside & (here > depth[i]) ? here : 0.0f;
      });
}

// True where a pixel's motion is uniform to within a fiftieth of a pixel, so that the terms of
// rotation and of acceleration change alpha by less than the samples leave: at an edge a deviation
// that is uniform between -e and e adds e / 4 to the mean.
bool is_uniform(const PixelFunctions& f) {
  constexpr float kLeftOutPx = 0.02f;
  const Eigen::Array4f left_out = 0.5f * (f.per_xt.abs() + f.per_yt.abs()) + 0.5f * f.per_tt.abs();
  const Eigen::Array4f slope = f.per_x.abs().max(f.per_y.abs());
  return (left_out <= kLeftOutPx * slope).head<3>().all();
}

}  // namespace

PixelFunctions functions_over(const RayTriangle& triangle,
                              const PixelRay& ray,
                              float u,
                              float half_u) {
  PixelFunctions f;
  std::array<Eigen::Array4f, 3> now;
  for (std::size_t c = 0; c < 3; ++c)
    now[c] = triangle.of(0, c) + u * (triangle.of(1, c) + u * triangle.of(2, c));
  const auto dot = [](const Eigen::Vector3f& d, const std::array<Eigen::Array4f, 3>& n) {
    return Eigen::Array4f(d[0] * n[0] + d[1] * n[1] + d[2] * n[2]);
  };
  f.at = dot(ray.middle, now);
  f.per_x = dot(ray.per_x, now);
  f.per_y = dot(ray.per_y, now);
  f.per_t = f.per_xt = f.per_yt = f.per_tt = Eigen::Array4f::Zero();
  if (!(half_u > 0)) return f;
  std::array<Eigen::Array4f, 3> per_t;
  std::array<Eigen::Array4f, 3> per_tt;
  for (std::size_t c = 0; c < 3; ++c) {
    per_t[c] = half_u * (triangle.of(1, c) + (2 * u) * triangle.of(2, c));
    per_tt[c] = (half_u * half_u) * triangle.of(2, c);
  }
  f.per_t = dot(ray.middle, per_t);
  f.per_xt = dot(ray.per_x, per_t);
  f.per_yt = dot(ray.per_y, per_t);
  f.per_tt = dot(ray.middle, per_tt);
  if (!ray.moves) return f;
  f.per_t += dot(ray.per_t, now);
  f.per_tt += dot(ray.per_t, per_t) + dot(ray.per_tt, now);
  return f;
}

void Visibility::begin_row(int y, int x0, int x1) {
  y_ = y;
  x0_ = x0;
  spans_.resize(triangles_.spans().size());
  const auto width = static_cast<std::size_t>(x1 - x0);
  first_.assign(width + 1, 0);
  struct Columns {
    std::uint32_t triangle;
    int from;
    int to;
  };
  thread_local std::vector<Columns> columns;
  columns.clear();
  const bool by_row = rays_.reads_rows();
  by_time_ = rays_.exposure_s() > 0;
  if (by_row) find_spans(x0);
  x_ = kNoPixel;
  const auto row = static_cast<float>(y);
  for (const std::uint32_t i : triangles_.in_row(y)) {
    const RayTriangle& triangle = triangles_.all()[i];
    const PixelSpan& span = spans_[triangle.span];
    if (by_row && !(span.from < span.to)) continue;
    const bool moves = by_row && span.to_u > span.from_u;
    const ScreenBounds bounds =
        moves ? bounds_between(triangle, span.from_u, span.to_u) : triangle.over_all;
    if (bounds.top > row + 1 || bounds.bottom < row) continue;
    const auto column = [&](float x) {
      return static_cast<int>(
          std::clamp(x - static_cast<float>(x0), 0.0f, static_cast<float>(width)));
    };
    const int from = column(std::floor(bounds.left));
    const int to = column(std::ceil(bounds.right));
    if (from >= to) continue;
    columns.push_back({i, from, to});
    for (int x = from; x < to; ++x) ++first_[static_cast<std::size_t>(x) + 1];
  }
  for (std::size_t x = 0; x < width; ++x) first_[x + 1] += first_[x];
  list_.resize(first_.back());
  thread_local std::vector<std::uint32_t> next;
  next.assign(first_.begin(), first_.end() - 1);
  for (const Columns& of : columns)
    for (int x = of.from; x < of.to; ++x) list_[next[static_cast<std::size_t>(x)]++] = of.triangle;
}

bool Visibility::has_several(int x) const {
  const auto list = triangles_of(x);
  return std::any_of(list.begin(), list.end(), [&](std::uint32_t i) {
    return triangles_.all()[i].instance != triangles_.all()[list[0]].instance;
  });
}

void Visibility::begin_pixel(int x) {
  x_ = x;
  ray_ = rays_.at(x, y_);
  if (!rays_.reads_rows()) find_spans(x);
  const std::size_t count = triangles_of(x).size();
  candidates_.assign(count, {});
  functions_.resize(count);
}

void Visibility::look(int x, int n, std::uint32_t only) {
  result_.samples = n;
  result_.alpha = 0;
  result_.surfaces.clear();
  result_.reads.clear();
  is_full_ = false;
  const auto list = triangles_of(x);
  if (list.empty()) return;
  if (x != x_) begin_pixel(x);
  if (!ray_.known) return;
  PixelSamples(x, y_).fill(n, by_time_, samples_);
  std::fill_n(inverse_depth_.begin(), n, 0.0f);
  std::fill_n(nearest_.begin(), n, -1);
  hidden_.fill(0);
  layer_count_ = 0;
  float hidden_everywhere = 0;
  for (const bool opaque : {true, false})
    for (std::size_t i = 0; i < list.size(); ++i) {
      const RayTriangle& triangle = triangles_.all()[list[i]];
      // All others are hidden too.
      if (triangle.nearest < hidden_everywhere) break;
      if (triangle.is_opaque != opaque || (only != kAll && triangle.instance != only)) continue;
      const Candidate& over = candidate(i, triangle);
      if (over.is_outside) continue;
      if (opaque) {
        keep_nearest(i, triangle, over);
        hidden_everywhere = *std::min_element(hidden_.begin(), hidden_.begin() + samples_.strata);
      } else {
        add_fragments(i, triangle, over);
      }
    }
  resolve(list);
}

void Visibility::find_spans(int x) {
  const double exposure_s = std::max(0.0, rays_.exposure_s());
  const double middle_s = rays_.middle_s(x, y_);
  const double begin_s = middle_s - 0.5 * exposure_s;
  for (std::size_t i = 0; i < spans_.size(); ++i) {
    const Span& span = triangles_.spans()[i];
    PixelSpan& over = spans_[i] = {};
    if (span.is_instant()) continue;
    over.u = static_cast<float>(span.u(middle_s));
    over.from_u = static_cast<float>(span.u(begin_s));
    over.to_u = static_cast<float>(span.u(begin_s + exposure_s));
    if (!by_time_) {
      // A moment belongs to one of the spans.
      const bool is_last = i + 1 == spans_.size() || triangles_.spans()[i + 1].begin_s < span.end_s;
      if (!(middle_s >= span.begin_s && (middle_s < span.end_s || is_last))) over.to = 0;
      continue;
    }
    over.half_u = static_cast<float>(0.5 * exposure_s / span.half_s());
    const auto share = [&](double s) {
      return static_cast<float>(std::clamp((s - begin_s) / exposure_s, 0.0, 1.0));
    };
    over.from = share(span.begin_s);
    over.to = share(span.end_s);
  }
}

const Visibility::Candidate& Visibility::candidate(std::size_t in_pixel,
                                                   const RayTriangle& triangle) {
  Candidate& result = candidates_[in_pixel];
  if (result.known) return result;
  result.known = true;
  const PixelSpan& span = spans_[triangle.span];
  if (by_time_)
    clip_time(triangle, span, result);
  else
    clip_place(triangle, result);
  if (!(result.from < result.to) || !(span.from < span.to)) return result;
  const PixelFunctions& f = functions_[in_pixel] =
      functions_over(triangle, ray_, span.u, span.half_u);
  const Eigen::Array4f most = f.at + 0.5f * (f.per_x.abs() + f.per_y.abs()) + f.per_t.abs() +
                              0.5f * (f.per_xt.abs() + f.per_yt.abs()) + f.per_tt.abs();
  result.is_outside = !(most.head<3>() >= 0).all();
  result.is_uniform = is_uniform(f);
  return result;
}

// The places across the pixel at which a triangle can be.
void Visibility::clip_place(const RayTriangle& triangle, Candidate& candidate) const {
  const PixelSpan& span = spans_[triangle.span];
  const ScreenBounds bounds = triangles_.spans()[triangle.span].is_instant()
                                  ? triangle.over_all
                                  : bounds_between(triangle, span.u, span.u);
  const auto x = static_cast<float>(x_);
  candidate.from = bounds.left - x;
  candidate.to = bounds.right - x;
}

// The times at which a triangle can be over the pixel: its bounds are linear over the exposure.
void Visibility::clip_time(const RayTriangle& triangle,
                           const PixelSpan& span,
                           Candidate& candidate) const {
  const ScreenBounds first = bounds_between(triangle, span.from_u, span.from_u);
  const ScreenBounds last = bounds_between(triangle, span.to_u, span.to_u);
  // Where the exposure has parts of both chords, how far the bounds bend between its ends.
  float bend = 0;
  if (span.from_u < 0 && span.to_u > 0) {
    const ScreenBounds middle = bounds_between(triangle, 0, 0);
    const float share = span.from_u / (span.from_u - span.to_u);
    const auto off = [&](float a, float b, float m) {
      bend = std::max(bend, std::abs(a + share * (b - a) - m));
    };
    off(first.left, last.left, middle.left);
    off(first.right, last.right, middle.right);
    off(first.top, last.top, middle.top);
    off(first.bottom, last.bottom, middle.bottom);
  }
  // Bounds without a limit have no bend.
  if (!std::isfinite(bend)) return;
  // `a` and `b`: what a bound is at the ends; it must be above `limit`.
  const auto clip = [&](float a, float b, float limit) {
    if (a < limit && b < limit) candidate.to = -1;
    if (a < limit && b >= limit) candidate.from = std::max(candidate.from, (limit - a) / (b - a));
    if (a >= limit && b < limit) candidate.to = std::min(candidate.to, (limit - a) / (b - a));
  };
  const auto x = static_cast<float>(x_);
  const auto y = static_cast<float>(y_);
  clip(first.right, last.right, x - bend);
  clip(-first.left, -last.left, -(x + 1) - bend);
  clip(first.bottom, last.bottom, y - bend);
  clip(-first.top, -last.top, -(y + 1) - bend);
}

namespace {

// The strata [from, to) of a candidate in those of its span. Those of a span are the ones whose
// middle it holds.
template <typename Shares, typename Of>
std::array<int, 2> strata_of(const Shares& span, const Of& candidate, int strata) {
  const auto all = static_cast<float>(strata);
  const auto whole = [&](float at) { return static_cast<int>(std::clamp(at, 0.0f, all)); };
  return {
      std::max(whole(std::ceil(span.from * all - 0.5f)), whole(std::floor(candidate.from * all))),
      std::min(whole(std::ceil(span.to * all - 0.5f)), whole(std::ceil(candidate.to * all)))};
}

}  // namespace

void Visibility::keep_nearest(std::size_t in_pixel,
                              const RayTriangle& triangle,
                              const Candidate& candidate) {
  const auto [from, to] = strata_of(spans_[triangle.span], candidate, samples_.strata);
  const auto keep = !by_time_              ? keep_nearest_still
                    : candidate.is_uniform ? keep_nearest_uniform
                                           : keep_nearest_moving;
  keep(functions_[in_pixel],
       triangle.farthest,
       triangle.nearest,
       static_cast<std::int32_t>(in_pixel),
       {samples_, from, to, inverse_depth_.data(), nearest_.data(), hidden_.data()});
}

void Visibility::add_fragments(std::size_t in_pixel,
                               const RayTriangle& triangle,
                               const Candidate& candidate) {
  const auto [from, to] = strata_of(spans_[triangle.span], candidate, samples_.strata);
  if (from >= to) return;
  if (layer_count_ == layers_.size()) layers_.emplace_back();
  FragmentLayer& layer = layers_[layer_count_++];
  layer.in_pixel = in_pixel;
  const int each = samples_.of_stratum();
  std::fill_n(layer.inverse_depth.begin(), samples_.count, 0.0f);
  find_fragments(functions_[in_pixel],
                 triangle.farthest,
                 triangle.nearest,
                 samples_,
                 from * each,
                 to * each,
                 inverse_depth_.data(),
                 layer.inverse_depth.data());
}

void Visibility::resolve(std::span<const std::uint32_t> list) {
  sums_.assign(list.size(), {});
  read_.clear();
  if (layer_count_ == 0)
    resolve_opaque();
  else
    resolve_fragments(list);
  finish(list);
}

// The samples that see one triangle are read at even steps.
void Visibility::add(std::size_t in_pixel, float weight, float light, std::size_t sample) {
  Sum& sum = sums_[in_pixel];
  const int stride = std::max(1, samples_.count / kReads);
  sum.weight += static_cast<double>(weight);
  sum.light += static_cast<double>(light);
  sum.one = static_cast<std::uint32_t>(sample);
  if (sum.samples++ % stride == stride / 2)
    read_.push_back({static_cast<std::uint32_t>(in_pixel), static_cast<std::uint32_t>(sample)});
}

void Visibility::resolve_opaque() {
  const int stride = std::max(1, samples_.count / kReads);
  const int count = samples_.count;
  for (int i = 0; i < count; ++i) {
    const std::int32_t who = nearest_[static_cast<std::size_t>(i)];
    if (who < 0) continue;
    Sum& sum = sums_[static_cast<std::size_t>(who)];
    sum.one = static_cast<std::uint32_t>(i);
    // A power of two.
    if ((sum.samples++ & (stride - 1)) == stride / 2)
      read_.push_back({static_cast<std::uint32_t>(who), static_cast<std::uint32_t>(i)});
  }
  for (Sum& sum : sums_) sum.weight = sum.light = sum.samples;
}

float Visibility::opacity_of(const RayTriangle& triangle,
                             std::size_t in_pixel,
                             std::size_t sample) const {
  const PlacedInstance& placed = instances_[triangle.instance];
  const Facet& facet = placed.placed.model->facets[triangle.part][triangle.in_part];
  const aircraft::Material& material = placed.placed.material(facet);
  if (facet.is_even) return facet.even_opacity;
  const Eigen::Array4f f =
      functions_[in_pixel](samples_.x[sample], samples_.y[sample], samples_.t[sample]);
  const float sum = f[0] + f[1] + f[2];
  const float distance_m = 1 / std::clamp(f[3], triangle.farthest, triangle.nearest);
  // Footprint of one of the many samples, as a share of the pixel's side.
  constexpr float kSampleShare = 0.25f;
  return opacity_at(placed.placed.model->mesh,
                    facet,
                    material,
                    f[1] / sum,
                    f[2] / sum,
                    kSampleShare * distance_m * ray_.pixel_rad());
}

void Visibility::resolve_fragments(std::span<const std::uint32_t> list) {
  thread_local std::vector<std::pair<float, std::size_t>> fragments;
  for (std::size_t i = 0; i < static_cast<std::size_t>(samples_.count); ++i) {
    fragments.clear();
    for (std::size_t k = 0; k < layer_count_; ++k)
      if (layers_[k].inverse_depth[i] > 0)
        fragments.emplace_back(layers_[k].inverse_depth[i], layers_[k].in_pixel);
    std::sort(fragments.begin(), fragments.end(), std::greater<>());
    float light = 1;
    for (const auto& [depth, in_pixel] : fragments) {
      const float opacity = opacity_of(triangles_.all()[list[in_pixel]], in_pixel, i);
      if (!(opacity > 0)) continue;
      add(in_pixel, light * opacity, light, i);
      light *= 1 - opacity;
      if (!(light > 0)) break;
    }
    if (light > 0 && nearest_[i] >= 0) add(static_cast<std::size_t>(nearest_[i]), light, light, i);
  }
}

void Visibility::finish(std::span<const std::uint32_t> list) {
  bool is_one = true;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const Sum& sum = sums_[i];
    if (!(sum.light > 0)) continue;
    VisibleSurface surface;
    surface.triangle = list[i];
    surface.in_pixel = static_cast<std::uint32_t>(i);
    surface.weight = static_cast<float>(sum.weight);
    surface.light = static_cast<float>(sum.light);
    result_.alpha += sum.weight;
    const std::uint32_t instance = triangles_.all()[list[i]].instance;
    if (result_.surfaces.empty()) full_of_ = instance;
    is_one = is_one && instance == full_of_ && layer_count_ == 0;
    surface.first_read = static_cast<std::uint32_t>(result_.reads.size());
    const auto read = [&](std::uint32_t sample) {
      result_.reads.push_back({samples_.x[sample], samples_.y[sample], samples_.t[sample]});
      surface.middle.x += samples_.x[sample];
      surface.middle.y += samples_.y[sample];
      surface.middle.t += samples_.t[sample];
    };
    for (const Read& of : read_)
      if (of.in_pixel == i) read(of.sample);
    if (result_.reads.size() == surface.first_read) read(sum.one);
    surface.end_read = static_cast<std::uint32_t>(result_.reads.size());
    const auto reads = static_cast<float>(surface.end_read - surface.first_read);
    surface.middle = {surface.middle.x / reads, surface.middle.y / reads, surface.middle.t / reads};
    result_.surfaces.push_back(surface);
  }
  is_full_ = is_one && result_.alpha == static_cast<double>(samples_.count);
}

}  // namespace airtruth::render
