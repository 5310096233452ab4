// SPDX-License-Identifier: Apache-2.0
#include "picture/composite/matte.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <mutex>

#include "foundation/base/error.h"
#include "foundation/image/colour.h"
#include "picture/composite/codec_blocks.h"
#include "picture/composite/spread.h"

namespace airtruth::composite {
namespace {

// A tone curve in tables, continued beyond [0, 1]: f(-x) = -f(x), and the same power law above 1.
// Video can hold such values (blacker than black, colours outside of the RGB cube), and they must
// survive a blend unclamped. The table of sRGB is within 2e-5 of the exact curve, which is 1/200 of
// a code value.
class TransferCurve {
 public:
  explicit TransferCurve(const image::ToneCurve& tone) {
    const auto linear = [&](double coded) { return tone.linear_from_coded(coded); };
    const auto coded = [&](double light) { return tone.coded_from_linear(light); };
    // 8-bit Y'CbCr reaches from -1.3 to 2.3.
    decode_ = tabulate(2.5f, 2560, linear);
    // A higher exponent has a stronger curvature near black.
    encode_ = tabulate(1.0f, tone.gamma == 0 ? 4096 : 65536, coded);
    encode_bright_ = tabulate(10.0f, 2048, coded);
  }

  float linear_from_coded(float coded) const { return odd(decode_, coded); }
  float coded_from_linear(float linear) const {
    return odd(std::abs(linear) <= 1 ? encode_ : encode_bright_, linear);
  }

 private:
  struct Table {
    // Entries per unit.
    float scale = 0;
    std::vector<float> values;
  };
  template <typename Function>
  static Table tabulate(float high, int entries, Function function) {
    Table table;
    table.scale = static_cast<float>(entries) / high;
    for (int i = 0; i <= entries; ++i)
      table.values.push_back(static_cast<float>(function(static_cast<double>(high) * i / entries)));
    return table;
  }

  static float odd(const Table& table, float x) {
    const float place = std::abs(x) * table.scale;
    const auto i = std::min(static_cast<int>(place), static_cast<int>(table.values.size()) - 2);
    const float t = place - static_cast<float>(i);
    const float* value = table.values.data() + i;
    return std::copysign(value[0] + t * (value[1] - value[0]), x);
  }

  Table decode_, encode_, encode_bright_;
};

// Each curve's table is made once.
const TransferCurve& transfer_curve(const image::ToneCurve& tone) {
  static std::mutex mutex;
  static std::map<double, TransferCurve> curves;
  const std::lock_guard lock(mutex);
  return curves.try_emplace(tone.gamma, tone).first->second;
}

std::uint8_t code(float value) {
  return static_cast<std::uint8_t>(std::clamp(value + 0.5f, 0.0f, 255.0f));
}

// The pixels that a chroma sample represents along one axis: `count` pixels from block_size *
// sample + first.
struct Footprint {
  int block_size = 1;
  int first = 0;
  int count = 1;
  std::array<float, 3> weight = {1, 0, 0};
};

Footprint footprint(int log2_size, bool on_a_pixel) {
  if (log2_size == 0) return {};
  if (on_a_pixel) return {2, -1, 3, {0.25f, 0.5f, 0.25f}};
  return {2, 0, 2, {0.5f, 0.5f, 0}};
}

// The sum of a kernel's weights, centred at `place`, that lie on an axis of `count` samples. The
// scene continues beyond the rim of the picture.
float weight_inside(const std::vector<float>& kernel, int place, int count) {
  const int reach = static_cast<int>(kernel.size()) / 2;
  float sum = 0;
  for (int k = std::max(-reach, -place); k <= std::min(reach, count - 1 - place); ++k)
    sum += kernel[static_cast<std::size_t>(k + reach)];
  return sum;
}

// The state of one call of composite_matte(): what lies under the layer in its patch, and what has
// changed.
class Matte {
 public:
  Matte(image::Picture& picture, const image::Layer& layer, const MatteOptions& options)
      : picture_(picture),
        layer_(layer),
        options_(options),
        curve_(transfer_curve(options.sensor.tone)),
        colour_code_(picture.colour),
        log2_width_(image::log2_chroma_width(picture.colour.chroma)),
        log2_height_(image::log2_chroma_height(picture.colour.chroma)),
        across_(footprint(log2_width_, picture.colour.siting != image::Siting::kCenter)),
        down_(footprint(log2_height_, picture.colour.siting == image::Siting::kTopLeft)) {
    const std::size_t size = layer.pixels.size();
    free_.assign(size, 1);
    drawn_.assign(size, 0);
    changed_.assign(size, 0);
    first_.assign(size, 0);
    change_.assign(size, image::Ycc{0, 0, 0});
    for (int y = layer.patch.y; y < layer.patch.bottom(); ++y) {
      for (int x = layer.patch.x; x < layer.patch.right(); ++x) {
        const std::size_t i = layer.index(x, y);
        free_[i] = layer.is_open(i);
        drawn_[i] = free_[i] && layer.pixels[i].alpha > 0;
        first_[i] = picture.planes[0].row(y)[x];
      }
    }
  }

  void blend() {
    std::vector<CodedWindow> windows;
    if (options_.coder != nullptr)
      windows = coded_windows(picture_, layer_, options_.sensor.reach_px());
    find_changes();
    pass_sensor();
    if (is_rgb() && options_.sensor.chroma_spread_px > 0) soften_rgb();
    write_first();
    if (picture_.plane_count == 3) blend_chroma();
    if (options_.coder != nullptr) pass_codec(windows);
  }

  std::vector<Visible> visible() const {
    std::vector<Visible> result(layer_.coverage.size());
    for (std::size_t i = 0; i < result.size(); ++i) add_pixels(i, result[i]);
    return result;
  }

 private:
  bool drawn(int x, int y) const {
    return layer_.patch.contains(x, y) && drawn_[layer_.index(x, y)] != 0;
  }
  // The change that the layer causes in a pixel whose background has this chroma.
  image::Ycc change(std::size_t index, float cb, float cr) const {
    const image::LayerPixel& over = layer_.pixels[index];
    const auto luma = static_cast<float>(first_[index]);
    const image::Rgb background = colour_code_.rgb_from_ycc({luma, cb, cr});
    const std::array<float, 3> add = {over.red, over.green, over.blue};
    image::Rgb blend;
    for (std::size_t c = 0; c < 3; ++c) {
      const float under = curve_.linear_from_coded(background[c]);
      const float brightest =
          std::max(1.0f, under);  // A highlight of the layer saturates as in a sensor.
      blend[c] = curve_.coded_from_linear(std::min(add[c] + (1 - over.alpha) * under, brightest));
    }
    const image::Ycc ycc = colour_code_.ycc_from_rgb(blend);
    return {ycc.y - luma, ycc.cb - cb, ycc.cr - cr};
  }

  image::Ycc chroma_at(int cx, int cy) const {
    if (picture_.plane_count == 1) return {};
    return {0,
            static_cast<float>(picture_.planes[1].row(cy)[cx]),
            static_cast<float>(picture_.planes[2].row(cy)[cx])};
  }

  // True where `holds` is true for any pixel of a chroma sample's block.
  template <typename Holds>
  bool any_of_block(int cx, int cy, const Holds& holds) const {
    for (int y = cy << log2_height_; y < (cy + 1) << log2_height_; ++y) {
      for (int x = cx << log2_width_; x < (cx + 1) << log2_width_; ++x)
        if (holds(x, y)) return true;
    }
    return false;
  }

  bool block_is_drawn(int cx, int cy) const {
    return any_of_block(cx, cy, [&](int x, int y) { return drawn(x, y); });
  }

  bool block_is_free(int cx, int cy) const {
    return !any_of_block(cx, cy, [&](int x, int y) {
      return !layer_.patch.contains(x, y) || free_[layer_.index(x, y)] == 0;
    });
  }

  bool is_rgb() const { return picture_.colour.matrix == image::Matrix::kRgb; }

  void find_changes() {
    for (int y = layer_.patch.y; y < layer_.patch.bottom(); ++y)
      for (int x = layer_.patch.x; x < layer_.patch.right(); ++x) {
        const std::size_t i = layer_.index(x, y);
        if (!drawn_[i]) continue;
        const image::Ycc under = chroma_at(x >> log2_width_, y >> log2_height_);
        change_[i] = change(i, under.cb, under.cr);
      }
  }

  // A smaller change, in code values, does not alter a sample.
  static constexpr float kLeastChange = 0.5F;

  // Sharpening reaches beyond the layer; noise stays within the drawn pixels. What both add to luma
  // is added to red, green and blue alike where these are the planes.
  void pass_sensor() {
    const Sensor& sensor = options_.sensor;
    if (!(sensor.sharpening > 0) && !sensor.has_noise()) return;
    const PixelBox& patch = layer_.patch;
    std::vector<float> luma(change_.size());
    for (std::size_t i = 0; i < luma.size(); ++i) luma[i] = colour_code_.luma(change_[i]);
    sharpen(luma, patch, {0, 0, picture_.width, picture_.height}, sensor);
    for (std::size_t i = 0; i < luma.size(); ++i)
      drawn_[i] = free_[i] && (drawn_[i] || std::abs(luma[i]) >= kLeastChange);
    if (sensor.has_noise()) {
      const std::vector<float> field =
          noise_field(patch, options_.seed, options_.frame, sensor.noise_correlation_px);
      const float dark = colour_code_.ycc_from_rgb({0, 0, 0}).y;
      const float codes_per_unit = colour_code_.ycc_from_rgb({1, 1, 1}).y - dark;
      const auto sigma_at = [&](float code_value) {
        return noise_sigma((code_value - dark) / codes_per_unit, codes_per_unit, sensor);
      };
      for (int y = patch.y; y < patch.bottom(); ++y)
        for (int x = patch.x; x < patch.right(); ++x) {
          const std::size_t i = layer_.index(x, y);
          if (!drawn_[i]) continue;
          const auto under =
              static_cast<float>(image::luma_at(picture_, x, y));  // not drawn on yet
          const float wanted = sigma_at(under + luma[i]);
          const float left = (1 - layer_.pixels[i].alpha) * sigma_at(under);
          luma[i] += field[i] * std::sqrt(std::max(0.0F, wanted * wanted - left * left));
        }
    }
    for (std::size_t i = 0; i < luma.size(); ++i) {
      if (!drawn_[i]) continue;
      image::Ycc& change = change_[i];
      const float added = luma[i] - colour_code_.luma(change);
      change = is_rgb() ? image::Ycc{change.y + added, change.cb + added, change.cr + added}
                        : image::Ycc{luma[i], change.cb, change.cr};
    }
  }

  // Blurs what the layer changes of blue and red less luma, and keeps its change of luma.
  void soften_rgb() {
    std::vector<float> blue, red;
    for (const image::Ycc& change : change_) {
      const float luma = colour_code_.luma(change);
      blue.push_back(change.cb - luma), red.push_back(change.cr - luma);
    }
    soften(blue, layer_.patch), soften(red, layer_.patch);
    const float weight_of_green = colour_code_.luma({1, 0, 0});
    for (std::size_t i = 0; i < change_.size(); ++i) {
      image::Ycc& change = change_[i];
      const float luma = colour_code_.luma(change);
      change = {luma - colour_code_.luma({0, blue[i], red[i]}) / weight_of_green,
                luma + blue[i],
                luma + red[i]};
      const float most = std::max({std::abs(change.y), std::abs(change.cb), std::abs(change.cr)});
      drawn_[i] = free_[i] && (drawn_[i] || most >= kLeastChange);
    }
  }

  void write_first() {
    for (int y = layer_.patch.y; y < layer_.patch.bottom(); ++y) {
      std::uint8_t* row = picture_.planes[0].row(y);
      for (int x = layer_.patch.x; x < layer_.patch.right(); ++x) {
        const std::size_t i = layer_.index(x, y);
        if (!drawn_[i]) continue;
        row[x] = code(static_cast<float>(first_[i]) + change_[i].y);
        changed_[i] = row[x] != first_[i];
      }
    }
  }

  void blend_chroma() {
    const PixelBox& patch = layer_.patch;
    const int left = patch.x >> log2_width_, top = patch.y >> log2_height_;
    const PixelBox samples{left,
                           top,
                           ((patch.right() - 1) >> log2_width_) - left + 1,
                           ((patch.bottom() - 1) >> log2_height_) - top + 1};
    std::vector<float> cb, cr;
    for (int cy = top; cy < samples.bottom(); ++cy)
      for (int cx = left; cx < samples.right(); ++cx) {
        const image::Ycc change =
            block_is_drawn(cx, cy) ? chroma_change(cx, cy) : image::Ycc{0, 0, 0};
        cb.push_back(change.cb), cr.push_back(change.cr);
      }
    const bool is_soft = chroma_is_soft();
    if (is_soft) soften(cb, samples), soften(cr, samples);
    std::size_t i = 0;
    for (int cy = top; cy < samples.bottom(); ++cy)
      for (int cx = left; cx < samples.right(); ++cx, ++i)
        if ((block_is_drawn(cx, cy) || (is_soft && block_is_free(cx, cy))) &&
            move_chroma(cx, cy, {0, cb[i], cr[i]}))
          mark_block(cx, cy);
  }

  void pass_codec(const std::vector<CodedWindow>& windows) {
    for (std::size_t i = 0; i < drawn_.size(); ++i) drawn_[i] = drawn_[i] || changed_[i];
    drawn_ = in_marked_blocks(layer_.patch, drawn_);
    for (std::size_t i = 0; i < drawn_.size(); ++i) drawn_[i] = drawn_[i] && free_[i];
    for (const CodedWindow& window : windows) {
      const Coded coded =
          options_.coder->code(window.box, image::crop(picture_, window.box), window.background);
      take_coded_first(window, coded);
      if (picture_.plane_count == 3) take_coded_chroma(window, coded);
    }
  }

  // The sum of the coded layer and of the part of the background's grain that remains.
  void take_coded_first(const CodedWindow& window, const Coded& coded) {
    const PixelBox& box = window.box;
    for (int y = box.y; y < box.bottom(); ++y) {
      std::uint8_t* row = picture_.planes[0].row(y);
      const std::uint8_t* with_layer = coded.with_layer.planes[0].row(y - box.y);
      const std::uint8_t* without = coded.background.planes[0].row(y - box.y);
      for (int x = box.x; x < box.right(); ++x) {
        if (!drawn(x, y)) continue;
        const std::size_t i = layer_.index(x, y);
        const auto lost = static_cast<float>(int{first_[i]} - int{without[x - box.x]});
        row[x] = code(static_cast<float>(with_layer[x - box.x]) +
                      (1 - std::min(1.0F, layer_.pixels[i].alpha)) * lost);
        changed_[i] = row[x] != first_[i];
      }
    }
  }

  void take_coded_chroma(const CodedWindow& window, const Coded& coded) {
    const int left = window.box.x >> log2_width_, top = window.box.y >> log2_height_;
    const image::Plane& size = coded.background.planes[1];
    for (int v = 0; v < size.height; ++v)
      for (int u = 0; u < size.width; ++u) {
        if (!block_is_drawn(left + u, top + v)) continue;
        const float shows = 1 - chroma_alpha(left + u, top + v);
        bool moved = false;
        for (const std::size_t p : {1u, 2u}) {
          const std::uint8_t before = window.background.planes[p].row(v)[u];
          const auto lost =
              static_cast<float>(int{before} - int{coded.background.planes[p].row(v)[u]});
          std::uint8_t& sample = picture_.planes[p].row(top + v)[left + u];
          sample = code(static_cast<float>(coded.with_layer.planes[p].row(v)[u]) + shows * lost);
          moved = moved || sample != before;
        }
        if (moved) mark_block(left + u, top + v);
      }
  }

  // Mean coverage of the pixels of a chroma sample's block.
  float chroma_alpha(int cx, int cy) const {
    float sum = 0;
    for (int y = cy << log2_height_; y < (cy + 1) << log2_height_; ++y)
      for (int x = cx << log2_width_; x < (cx + 1) << log2_width_; ++x)
        if (layer_.patch.contains(x, y)) sum += layer_.pixels[layer_.index(x, y)].alpha;
    return std::min(1.0F, sum / static_cast<float>(1 << (log2_width_ + log2_height_)));
  }

  // The weighted mean over the sample's footprint. Every pixel of the footprint is computed over
  // this one chroma sample, so that an opaque layer leaves nothing of the background's chroma, even
  // where the footprint reaches into the next block.
  image::Ycc chroma_change(int cx, int cy) const {
    const image::Ycc under = chroma_at(cx, cy);
    image::Ycc sum{0, 0, 0};
    float total = 0;
    for (int j = 0; j < down_.count; ++j) {
      const int y = cy * down_.block_size + down_.first + j;
      for (int i = 0; i < across_.count; ++i) {
        const int x = cx * across_.block_size + across_.first + i;
        if (x < 0 || y < 0 || x >= picture_.width || y >= picture_.height) continue;
        const float weight =
            across_.weight[static_cast<std::size_t>(i)] * down_.weight[static_cast<std::size_t>(j)];
        total += weight;
        if (!drawn(x, y)) continue;
        const bool own_block = x >> log2_width_ == cx && y >> log2_height_ == cy;
        const std::size_t index = layer_.index(x, y);
        const image::Ycc here = own_block ? change_[index] : change(index, under.cb, under.cr);
        sum.cb += weight * here.cb;
        sum.cr += weight * here.cr;
      }
    }
    return {0, sum.cb / total, sum.cr / total};
  }

  // Whether the planes are blurred as they are; soften_rgb() does it for R'G'B'.
  bool chroma_is_soft() const { return options_.sensor.chroma_spread_px > 0 && !is_rgb(); }

  void soften(std::vector<float>& plane, const PixelBox& samples) const {
    const double spread_px = options_.sensor.chroma_spread_px;
    const std::vector<float> across = gaussian(spread_px / (1 << log2_width_));
    const std::vector<float> down = gaussian(spread_px / (1 << log2_height_));
    blur(plane, samples.width, samples.height, across, down);
    const image::Plane& frame = picture_.planes[1];
    std::size_t i = 0;
    for (int cy = samples.y; cy < samples.bottom(); ++cy)
      for (int cx = samples.x; cx < samples.right(); ++cx)
        plane[i++] /=
            weight_inside(across, cx, frame.width) * weight_inside(down, cy, frame.height);
  }

  bool move_chroma(int cx, int cy, const image::Ycc& change) {
    const image::Ycc before = chroma_at(cx, cy);
    picture_.planes[1].row(cy)[cx] = code(before.cb + change.cb);
    picture_.planes[2].row(cy)[cx] = code(before.cr + change.cr);
    const image::Ycc after = chroma_at(cx, cy);
    return after.cb != before.cb || after.cr != before.cr;
  }

  // Where chroma is blurred, the pixels that the blur reaches belong to the intruder, as does a
  // halo of sharpening.
  void mark_block(int cx, int cy) {
    const bool reaches = chroma_is_soft();
    any_of_block(cx, cy, [&](int x, int y) {
      if (drawn(x, y) || (reaches && layer_.patch.contains(x, y) && free_[layer_.index(x, y)] != 0))
        changed_[layer_.index(x, y)] = 1;
      return false;
    });
  }

  // The pixels of `box` where the intruder can have changed samples: those that it covers, those
  // that sharpening and chroma blur reach from there, and all others of a codec's blocks.
  std::vector<std::uint8_t> reached_by(const image::Coverage& coverage, const PixelBox& box) const {
    const int halo = options_.sensor.reach_px();
    std::vector<std::uint8_t> reached(pixels_in(box), 0);
    each_pixel(coverage, [&](int x, int y, float alpha) {
      if (!(alpha > 0)) return;
      const PixelBox around = *intersection(wider({x, y, 1, 1}, halo), box);
      for (int v = around.y; v < around.bottom(); ++v)
        std::fill_n(&reached[index_in(box, around.x, v)], around.width, std::uint8_t{1});
    });
    return options_.coder == nullptr ? reached : in_marked_blocks(box, reached);
  }

  void add_pixels(std::size_t intruder, Visible& visible) const {
    const image::Coverage& coverage = layer_.coverage[intruder];
    if (coverage.empty()) return;
    add_coverage(layer_, intruder, visible);
    const int farthest_px = options_.sensor.reach_px() + (options_.coder ? kCodecBlockPx : 0);
    const PixelBox box = *intersection(wider(coverage.box, farthest_px), layer_.patch);
    const std::vector<std::uint8_t> reached = reached_by(coverage, box);
    std::size_t i = 0;
    for (int y = box.y; y < box.bottom(); ++y)
      for (int x = box.x; x < box.right(); ++x)
        if (reached[i++] != 0 && changed_[layer_.index(x, y)] != 0) visible.add(x, y);
  }

  image::Picture& picture_;
  const image::Layer& layer_;
  const MatteOptions& options_;
  const TransferCurve& curve_;
  image::ColourCode colour_code_;
  int log2_width_;
  int log2_height_;
  Footprint across_;
  Footprint down_;
  // 1: the layer is open.
  std::vector<std::uint8_t> free_;
  // 1: free, and changed by the layer, its blur or its halo.
  std::vector<std::uint8_t> drawn_;
  // 1: drawn, and a sample differs.
  std::vector<std::uint8_t> changed_;
  // The first plane of the background, luma or green, before the blend.
  std::vector<std::uint8_t> first_;
  // Computed with the chroma of the pixel's own block.
  std::vector<image::Ycc> change_;
};

void check_fits(const image::Picture& picture, const image::Layer& layer) {
  const PixelBox& patch = layer.patch;
  check(patch.width > 0 && patch.height > 0, "a layer's patch has a size");
  check(patch.x >= 0 && patch.y >= 0 && patch.right() <= picture.width &&
            patch.bottom() <= picture.height,
        "a layer's patch lies inside the frame");
  const std::size_t size = pixels_in(patch);
  check(layer.pixels.size() == size, "a layer has a pixel for each of its patch");
  for (const image::Coverage& coverage : layer.coverage)
    check(coverage.empty() || intersection(coverage.box, patch) == coverage.box,
          "coverage lies inside the patch");
  check(layer.closed.empty() || layer.closed.size() == size, "what is closed is of the patch");
}

}  // namespace

void add_coverage(const image::Layer& layer, std::size_t intruder, Visible& visible) {
  Pixel sum = Pixel::Zero();
  each_pixel(layer.coverage[intruder], [&](int x, int y, double alpha) {
    if (!layer.is_open(layer.index(x, y))) return;
    visible.alpha_sum_px += alpha;
    sum += alpha * Pixel(x + 0.5, y + 0.5);
  });
  visible.covered = covered(layer, intruder);
  if (visible.alpha_sum_px > 0) visible.centroid = sum / visible.alpha_sum_px;
}

std::vector<Visible> composite_matte(image::Picture& picture,
                                     const image::Layer& layer,
                                     const MatteOptions& options) {
  if (layer.empty()) return std::vector<Visible>(layer.coverage.size());
  check_fits(picture, layer);
  Matte matte(picture, layer, options);
  matte.blend();
  return matte.visible();
}

}  // namespace airtruth::composite
