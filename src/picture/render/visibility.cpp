// SPDX-License-Identifier: Apache-2.0
#include "picture/render/visibility.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "foundation/base/vectors.h"

namespace airtruth::render {
namespace {

// The samples of a surface that are read: this number, if so many see it, and a share of the other
// number. More change no pixel of small liveries by as much as 4 code values rms
// (texture_oracle_test.cpp); of half as many, some by 6.
constexpr std::uint32_t kReadsOfSurface = 8;
constexpr double kReadsOfPixel = 16;
// Samples where one triangle covers the pixel: no outline needs more.
constexpr int kSamplesOfOneTriangle = 16;

// Calls use(i, is_inside, inverse distance) for the samples of a block. kTerms: 4 for a uniform
// motion and at an instant, 7 for all.
template <int kTerms, typename Use>
[[gnu::always_inline]] inline void each_sample(const PixelFunctions& k,
                                               float farthest,
                                               float nearest,
                                               const Samples& samples,
                                               int block,
                                               const Use& use) {
  const int begin = block * Samples::kBlock;
  const float* px = samples.x.data() + begin;
  const float* py = samples.y.data() + begin;
  const float* pt = samples.t.data() + begin;
  const auto value_of = [&](int f, float x, float y, float t) {
    if constexpr (kTerms == 4)
      return (k.at[f] + k.per_x[f] * x) + (k.per_y[f] * y + k.per_t[f] * t);
    return (k.at[f] + t * (k.per_t[f] + k.per_tt[f] * t)) + x * (k.per_x[f] + k.per_xt[f] * t) +
           y * (k.per_y[f] + k.per_yt[f] * t);
  };
  for (int i = 0; i < Samples::kBlock; ++i) {
    const float e0 = value_of(0, px[i], py[i], pt[i]);
    const float e1 = value_of(1, px[i], py[i], pt[i]);
    const float e2 = value_of(2, px[i], py[i], pt[i]);
    const float depth = value_of(3, px[i], py[i], pt[i]);
    const bool holds = kTerms == 4 || ((pt[i] >= k.begin_t) & (pt[i] < k.end_t));
    const bool inside = (e0 >= 0) & (e1 >= 0) & (e2 >= 0) & holds;
    const float above = depth < farthest ? farthest : depth;
    use(begin + i, inside, above > nearest ? nearest : above);
  }
}

// What a kernel reads and writes.
struct SampleBuffer {
  const Samples& samples;
  // The blocks that are tested.
  int from;
  int to;
  float* __restrict depth;
  std::int32_t* __restrict nearest;
  // By block.
  float* __restrict hidden;
};

template <int kTerms>
[[gnu::always_inline]] inline void keep_nearest_of(const PixelFunctions& functions_of_triangle,
                                                   float farthest,
                                                   float nearest,
                                                   std::int32_t who,
                                                   const SampleBuffer& buffer) {
  // A copy, which no write to the samples can change.
  // NOLINTNEXTLINE(performance-unnecessary-copy-initialization)
  const PixelFunctions functions = functions_of_triangle;
  float* __restrict const depth = buffer.depth;
  std::int32_t* __restrict const nearest_of = buffer.nearest;
  for (int block = buffer.from; block < buffer.to; ++block) {
    if (nearest < buffer.hidden[block]) continue;
    // Floats that are not negative have the order of their bits, and the least of whole numbers may
    // be found by vectors.
    std::int32_t least = 0x7f800000;
    each_sample<kTerms>(
        functions, farthest, nearest, buffer.samples, block, [&](int i, bool inside, float here) {
          const bool in_front = inside & (here > depth[i]);
          const float now = in_front ? here : depth[i];
          depth[i] = now;
          nearest_of[i] = in_front ? who : nearest_of[i];
          const auto bits = std::bit_cast<std::int32_t>(now);
          least = bits < least ? bits : least;
        });
    buffer.hidden[block] = std::bit_cast<float>(least);
  }
}

AIRTRUTH_FOR_SHORT_VECTORS
void keep_nearest_uniform(const PixelFunctions& functions,
                          float farthest,
                          float nearest,
                          std::int32_t who,
                          const SampleBuffer& buffer) {
  keep_nearest_of<4>(functions, farthest, nearest, who, buffer);
}
AIRTRUTH_FOR_SHORT_VECTORS
void keep_nearest_moving(const PixelFunctions& functions,
                         float farthest,
                         float nearest,
                         std::int32_t who,
                         const SampleBuffer& buffer) {
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
  // A copy, which no write to the samples can change.
  // NOLINTNEXTLINE(performance-unnecessary-copy-initialization)
  const PixelFunctions functions = functions_of_triangle;
  for (int block = from; block < to; ++block)
    each_sample<7>(
        functions, farthest, nearest, samples, block, [&](int i, bool inside, float here) {
          fragment[i] = (inside & (here > depth[i])) ? here : 0.0f;
        });
}

// The blocks that hold the samples of a range.
template <typename Range>
std::array<int, 2> blocks_of(const Range& range, const Samples& samples) {
  const int blocks = samples.count / Samples::kBlock;
  const auto all = static_cast<float>(blocks);
  return {static_cast<int>(std::clamp(range.from * all, 0.0f, all)),
          static_cast<int>(std::ceil(std::clamp(range.to * all, 0.0f, all)))};
}

}  // namespace

Visibility::Visibility(const RayTriangles& triangles,
                       const std::vector<PlacedInstance>& instances,
                       const PixelRays& rays,
                       const SampleCounts& counts)
    : triangles_(triangles),
      instances_(instances),
      rays_(rays),
      counts_(counts),
      lines_(counts.lines, rays.exposure_s() > 0),
      by_time_(rays.exposure_s() > 0) {}

void Visibility::begin_row(int y, int x0, int x1) {
  y_ = y;
  x0_ = x0;
  spans_.resize(triangles_.spans().size());
  const auto width = static_cast<std::size_t>(x1 - x0);
  first_.assign(width + 1, 0);
  columns_.clear();
  const bool by_row = rays_.reads_rows();
  if (by_row) find_spans(x0);
  const auto row = static_cast<float>(y);
  for (const std::uint32_t i : triangles_.in_row(y)) {
    const RayTriangle& triangle = triangles_.all()[i];
    const PixelSpan& span = spans_[triangle.span];
    if (by_row && !(span.from < span.to)) continue;
    const bool moves = by_row && span.to_u > span.from_u;
    const ScreenBounds bounds =
        moves ? bounds_between(triangle, span.from_u, span.to_u) : triangle.over_all;
    const PixelBox& pixels = *instances_[triangle.instance].pixels;
    if (bounds.top > row + 1 || bounds.bottom < row || y < pixels.y || y >= pixels.bottom())
      continue;
    const auto column = [&](float x) {
      return static_cast<int>(
                 std::clamp(x, static_cast<float>(pixels.x), static_cast<float>(pixels.right()))) -
             x0;
    };
    const int from = column(std::floor(bounds.left));
    const int to = column(std::ceil(bounds.right));
    if (from >= to) continue;
    columns_.push_back({i, from, to});
    for (int x = from; x < to; ++x) ++first_[static_cast<std::size_t>(x) + 1];
  }
  for (std::size_t x = 0; x < width; ++x) first_[x + 1] += first_[x];
  list_.resize(first_.back());
  next_.assign(first_.begin(), first_.end() - 1);
  for (const Columns& of : columns_)
    for (int x = of.from; x < of.to; ++x) list_[next_[static_cast<std::size_t>(x)]++] = of.triangle;
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
    over.from_u = static_cast<float>(std::clamp(span.u(begin_s), -1.0, 1.0));
    over.to_u = static_cast<float>(std::clamp(span.u(begin_s + exposure_s), -1.0, 1.0));
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

void Visibility::begin_pixel(int x) {
  x_ = x;
  has_several_ = false;
  hidden_ = 0;
  moves_down_px_ = 0;
  candidates_.clear();
  const auto pixel = static_cast<std::size_t>(x - x0_);
  if (first_[pixel] == first_[pixel + 1]) return;
  ray_ = rays_.at(x, y_);
  if (!ray_.known) return;
  if (!rays_.reads_rows()) find_spans(x);
  for (std::uint32_t i = first_[pixel]; i < first_[pixel + 1]; ++i) add_candidate(list_[i]);
}

void Visibility::add_candidate(std::uint32_t triangle) {
  const RayTriangle& of = triangles_.all()[triangle];
  const PixelSpan& span = spans_[of.span];
  if (!(span.from < span.to)) return;
  if (of.nearest < hidden_ && of.instance == hidden_instance_) return;
  Candidate& candidate = candidates_.emplace_back();
  candidate.of = &of;
  const float part_t = span.from > 0 || span.to < 1 ? span.from + span.to - 1 : 0;
  candidate.functions = functions_about(of, ray_, span.u, span.half_u, part_t);
  if (span.from > 0) candidate.functions.begin_t = 2 * span.from - 1;
  if (span.to < 1) candidate.functions.end_t = 2 * span.to - 1;
  const Eigen::Array4f half_range = candidate.functions.half_range();
  const Eigen::Array4f& at = candidate.functions.at;
  if (!(at + half_range >= 0).head<3>().all() ||
      !(by_time_ ? clip_time(of, span, candidate) : clip_place(of, candidate))) {
    candidates_.pop_back();
    return;
  }
  candidate.is_everywhere = candidate.functions.hold_always() && (at >= half_range).head<3>().all();
  has_several_ = has_several_ || of.instance != candidates_[0].of->instance;
  if (!candidate.is_everywhere || !of.is_opaque) return;
  const float behind = std::clamp(at[3] - half_range[3], of.farthest, of.nearest);
  if (behind > hidden_) hidden_ = behind, hidden_instance_ = of.instance;
}

bool Visibility::clip_place(const RayTriangle& triangle, Candidate& candidate) const {
  const PixelSpan& span = spans_[triangle.span];
  const ScreenBounds bounds = triangles_.spans()[triangle.span].is_instant()
                                  ? triangle.over_all
                                  : bounds_between(triangle, span.u, span.u);
  const auto x = static_cast<float>(x_);
  const auto y = static_cast<float>(y_);
  candidate.of_samples = {bounds.left - x, bounds.right - x};
  candidate.of_lines = {bounds.top - y, bounds.bottom - y};
  return bounds.left < x + 1 && bounds.right > x && bounds.top < y + 1 && bounds.bottom > y;
}

// The bounds are linear over the exposure.
bool Visibility::clip_time(const RayTriangle& triangle,
                           const PixelSpan& span,
                           Candidate& candidate) {
  const ScreenBounds first = bounds_between(triangle, span.from_u, span.from_u);
  const ScreenBounds last = bounds_between(triangle, span.to_u, span.to_u);
  // Where the span's part of the exposure has parts of both chords, how far the bounds bend between
  // its ends.
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
  Range range{span.from, span.to};
  // Bounds without a limit have no bend.
  if (std::isfinite(bend)) {
    // `a` and `b`: what a bound is at the ends of that part; it must be above `limit`.
    const auto clip = [&](float a, float b, float limit) {
      const auto crossing = [&] {
        return span.from + (limit - a) / (b - a) * (span.to - span.from);
      };
      if (a < limit && b < limit) range.to = -1;
      if (a < limit && b >= limit) range.from = std::max(range.from, crossing());
      if (a >= limit && b < limit) range.to = std::min(range.to, crossing());
    };
    const auto x = static_cast<float>(x_);
    const auto y = static_cast<float>(y_);
    clip(first.right, last.right, x - bend);
    clip(-first.left, -last.left, -(x + 1) - bend);
    clip(first.bottom, last.bottom, y - bend);
    clip(-first.top, -last.top, -(y + 1) - bend);
    const float down_px = std::abs(first.top - last.top) - std::abs(first.left - last.left);
    if (std::isfinite(down_px)) moves_down_px_ += down_px;
  }
  candidate.of_samples = candidate.of_lines = range;
  return range.from < range.to;
}

void Visibility::look(int x) {
  begin_pixel(x);
  look_at(kAll);
}

double Visibility::alpha_of(std::uint32_t instance) {
  look_at(instance);
  return alpha_;
}

void Visibility::look_at(std::uint32_t only) {
  alpha_ = 0;
  surfaces_.clear();
  reads_.clear();
  if (candidates_.empty()) return;
  alpha_ = opaque_alpha(only);
  bool is_translucent = false;
  // Whether an outline of a translucent triangle crosses the pixel.
  bool has_outline = false;
  for (const Candidate& candidate : candidates_)
    if (counts(candidate, only) && !candidate.of->is_opaque) {
      is_translucent = true;
      has_outline = has_outline || !candidate.is_everywhere;
    }
  // Samples tell what masks do not.
  const bool by_samples =
      (is_translucent && alpha_ < 1) || (has_several_ && only == kAll && alpha_ > 0);
  if (!by_samples && (only != kAll || alpha_ == 0)) return;
  const bool is_even = alpha_ == 0 && !has_outline;
  const bool is_one = candidates_.size() == 1 && hidden_ > 0;
  sample(is_one                   ? kSamplesOfOneTriangle
         : by_samples && !is_even ? counts_.on_outline
                                  : counts_.where_even,
         only);
  double sum = 0;
  for (const Sum& of : sums_) sum += static_cast<double>(of.weight);
  if (by_samples) {
    // Samples add to the masks what translucent surfaces contribute where no opaque one is.
    const auto opaque = std::count_if(nearest_.begin(),
                                      nearest_.begin() + samples_.count,
                                      [](std::int32_t who) { return who >= 0; });
    alpha_ = std::clamp(alpha_ + (sum - static_cast<double>(opaque)) / samples_.count, 0.0, 1.0);
  }
  if (sum == 0 && alpha_ > 0) {
    // No sample meets what the lines do: the nearest triangle stands for it.
    const auto nearest =
        std::find_if(candidates_.begin(), candidates_.end(), [&](const Candidate& candidate) {
          return candidate.of->is_opaque && counts(candidate, only);
        });
    add(static_cast<std::size_t>(nearest - candidates_.begin()), 1, 1, 0);
    sum = 1;
  }
  if (only == kAll && alpha_ > 0) list_surfaces(alpha_ / sum);
}

// The share that opaque triangles cover.
double Visibility::opaque_alpha(std::uint32_t only) {
  if (hidden_ > 0 && (only == kAll || only == hidden_instance_)) return 1;
  masks_.begin(lines_, moves_down_px_ > 0);
  for (const Candidate& candidate : candidates_)
    if (candidate.of->is_opaque && counts(candidate, only) && !masks_.is_full())
      masks_.add(candidate.functions, candidate.of_lines.from, candidate.of_lines.to);
  return masks_.share();
}

void Visibility::sample(int n, std::uint32_t only) {
  PixelSamples(x_, y_).fill(n, by_time_, samples_);
  const int blocks = n / Samples::kBlock;
  std::fill_n(inverse_depth_.begin(), n, 0.0f);
  std::fill_n(nearest_.begin(), n, -1);
  std::fill_n(hidden_of_block_.begin(), blocks, 0.0f);
  layer_count_ = 0;
  sums_.assign(candidates_.size(), {});
  visible_.clear();
  float hidden_everywhere = 0;
  for (const bool opaque : {true, false})
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      const Candidate& candidate = candidates_[i];
      // All others are hidden too.
      if (candidate.of->nearest < hidden_everywhere) break;
      if (candidate.of->is_opaque != opaque || !counts(candidate, only)) continue;
      if (opaque) {
        keep_nearest(i);
        hidden_everywhere =
            *std::min_element(hidden_of_block_.begin(), hidden_of_block_.begin() + blocks);
      } else {
        add_fragments(i);
      }
    }
  if (layer_count_ == 0)
    resolve_opaque();
  else
    resolve_fragments();
}

void Visibility::keep_nearest(std::size_t candidate) {
  const Candidate& of = candidates_[candidate];
  const auto [from, to] = blocks_of(of.of_samples, samples_);
  const auto keep = of.functions.is_uniform() ? keep_nearest_uniform : keep_nearest_moving;
  keep(of.functions,
       of.of->farthest,
       of.of->nearest,
       static_cast<std::int32_t>(candidate),
       {samples_, from, to, inverse_depth_.data(), nearest_.data(), hidden_of_block_.data()});
}

void Visibility::add_fragments(std::size_t candidate) {
  const Candidate& of = candidates_[candidate];
  const auto [from, to] = blocks_of(of.of_samples, samples_);
  if (from >= to) return;
  if (layer_count_ == layers_.size()) layers_.emplace_back();
  FragmentLayer& layer = layers_[layer_count_++];
  layer.candidate = candidate;
  std::fill_n(layer.inverse_depth.begin(), samples_.count, 0.0f);
  find_fragments(of.functions,
                 of.of->farthest,
                 of.of->nearest,
                 samples_,
                 from,
                 to,
                 inverse_depth_.data(),
                 layer.inverse_depth.data());
}

void Visibility::add(std::size_t candidate, float weight, float light, int sample) {
  Sum& sum = sums_[candidate];
  sum.weight += weight;
  sum.light += light;
  ++sum.samples;
  visible_.push_back({static_cast<std::uint32_t>(candidate), static_cast<std::uint32_t>(sample)});
}

void Visibility::resolve_opaque() {
  for (int i = 0; i < samples_.count; ++i) {
    const std::int32_t who = nearest_[static_cast<std::size_t>(i)];
    if (who >= 0) add(static_cast<std::size_t>(who), 1, 1, i);
  }
}

float Visibility::opacity_of(const Candidate& candidate, std::size_t sample) const {
  const RayTriangle& triangle = *candidate.of;
  const PlacedInstance& placed = instances_[triangle.instance];
  const shade::Facet& facet = placed.placed.model->facets[triangle.part][triangle.in_part];
  if (facet.is_even) return facet.even_opacity;
  const Eigen::Array4f f =
      candidate.functions(samples_.x[sample], samples_.y[sample], samples_.t[sample]);
  const float sum = f[0] + f[1] + f[2];
  const float distance_m = 1 / std::clamp(f[3], triangle.farthest, triangle.nearest);
  // Footprint of one of the many samples, as a share of the pixel's side.
  constexpr float kSampleShare = 0.25f;
  return shade::opacity_at(placed.placed.model->mesh,
                           facet,
                           placed.placed.material(facet),
                           f[1] / sum,
                           f[2] / sum,
                           kSampleShare * distance_m * ray_.pixel_rad());
}

void Visibility::resolve_fragments() {
  for (int i = 0; i < samples_.count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    fragments_.clear();
    for (std::size_t k = 0; k < layer_count_; ++k)
      if (layers_[k].inverse_depth[at] > 0)
        fragments_.emplace_back(layers_[k].inverse_depth[at], layers_[k].candidate);
    std::sort(fragments_.begin(), fragments_.end(), std::greater<>());
    float light = 1;
    for (const auto& [depth, candidate] : fragments_) {
      const float opacity = opacity_of(candidates_[candidate], at);
      if (!(opacity > 0)) continue;
      add(candidate, light * opacity, light, i);
      light *= 1 - opacity;
      if (!(light > 0)) break;
    }
    if (light > 0 && nearest_[at] >= 0)
      add(static_cast<std::size_t>(nearest_[at]), light, light, i);
  }
}

void Visibility::list_surfaces(double scale) {
  std::uint32_t reads = 0;
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    Sum& sum = sums_[i];
    if (sum.samples == 0) continue;
    sum.surface = static_cast<std::uint32_t>(surfaces_.size());
    VisibleSurface& surface = surfaces_.emplace_back();
    surface.candidate = static_cast<std::uint32_t>(i);
    surface.weight = static_cast<float>(scale * static_cast<double>(sum.weight));
    surface.light = static_cast<float>(scale * static_cast<double>(sum.light));
    surface.first_read = surface.end_read = reads;
    const auto share = static_cast<double>(sum.samples) / samples_.count;
    sum.reads =
        std::min(sum.samples, kReadsOfSurface + static_cast<std::uint32_t>(kReadsOfPixel * share));
    sum.phase = sum.samples / 2;
    reads += sum.reads;
  }
  reads_.resize(reads);
  for (const VisibleSample& visible : visible_) {
    Sum& sum = sums_[visible.candidate];
    sum.phase += sum.reads;
    if (sum.phase < sum.samples) continue;
    sum.phase -= sum.samples;
    VisibleSurface& surface = surfaces_[sum.surface];
    const PixelPlace at{
        samples_.x[visible.sample], samples_.y[visible.sample], samples_.t[visible.sample]};
    reads_[surface.end_read++] = at;
    surface.middle = {surface.middle.x + at.x, surface.middle.y + at.y, surface.middle.t + at.t};
  }
  for (VisibleSurface& surface : surfaces_) {
    const auto count = static_cast<float>(surface.end_read - surface.first_read);
    surface.middle = {surface.middle.x / count, surface.middle.y / count, surface.middle.t / count};
  }
}

}  // namespace airtruth::render
