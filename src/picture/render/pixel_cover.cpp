// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <type_traits>

#include "picture/render/marking.h"
#include "picture/render/nearest.h"
#include "picture/render/pencil.h"
#include "picture/render/pieces.h"
#include "picture/render/silhouette.h"
#include "picture/render/sorted_samples.h"

namespace airtruth::render {

class Silhouette::PixelCover {
 public:
  PixelCover(const Silhouette& silhouette, int x, int y)
      : silhouette_(silhouette),
        pixel_{x, y, 0},
        exposes_(silhouette.actor_.moves && silhouette.grid_.exposure_s() > 0) {
    if (silhouette.actor_.moves)
      pixel_.u = silhouette.grid_.span().u(silhouette.grid_.middle_s(x, y));
  }

  // Asks for the coverage by a number of samples.
  void cover(int samples, Cover& result) {
    result.marks.assign(static_cast<std::size_t>(samples), 0);
    result.order.clear();
    cover_ = &result;
    samples_ = samples;
    open_ = kAllStrips;
    // Sorting the samples costs as much as the tests that it saves in this number of triangles.
    constexpr std::size_t kWorthSorting = 32;
    is_dense_ = exposes_ && silhouette_.grid_.reads_rows() &&
                silhouette_.triangles_of(pixel_.x, pixel_.y).size() >= kWorthSorting;
  }

  // Asks for a depth buffer.
  void see(const SampleCounts& counts) {
    const int side = side_ = counts.visible_side;
    blocks_ = counts.blocks;
    const int samples = side * side;
    PixelSamples(pixel_.x, pixel_.y)
        .fill_cells(side, cells_.x.data(), cells_.y.data(), cells_.t.data());
    std::fill_n(nearest_.nearness.begin(), samples, 0.0F);
    std::fill_n(nearest_.triangle.begin(), samples, -1);
  }

  void look(bool only_opaque = false) {
    if (!silhouette_.is_known(pixel_.x, pixel_.y)) return;
    for (const Entry& entry : silhouette_.triangles_of(pixel_.x, pixel_.y)) {
      const Triangle& triangle = silhouette_.triangles_[entry.triangle];
      if (only_opaque && !triangle.opaque) continue;
      // All others are hidden too.
      if (open_ == 0 && (side_ == 0 || triangle.nearest < hidden_)) break;
      add(entry);
    }
  }

  // Covers the samples by the translucent triangles, one after the other.
  void cover_by_translucent(int samples, Cover& result) {
    const auto n = static_cast<std::size_t>(samples);
    result.marks.assign(n, 0);
    result.triangles.assign(n, 0);
    result.order.clear();
    result.covered = 0;
    if (!silhouette_.is_known(pixel_.x, pixel_.y)) return;
    thread_local Cover one;
    for (const Entry& entry : silhouette_.triangles_of(pixel_.x, pixel_.y)) {
      const Triangle& triangle = silhouette_.triangles_[entry.triangle];
      if (triangle.opaque) continue;
      cover(samples, one);
      is_dense_ = is_full_ = false;
      add(entry);
      finish(one);
      if (one.covered == 0) continue;
      // A sum of such numbers tells the sets of a pixel's few triangles apart (multiplicative
      // hashing: Knuth 1973, "The art of computer programming", volume 3, 6.4).
      const std::uint32_t name = (entry.triangle + 1) * 2654435769U << 1;
      const std::uint32_t differs = triangle.even ? 0 : 1;
      for (std::size_t i = 0; i < n; ++i) {
        const auto mark = static_cast<std::uint32_t>(one.marks[i]);
        result.marks[i] |= one.marks[i];
        result.triangles[i] = (result.triangles[i] + (name & mark)) | (differs & mark);
      }
    }
    result.covered = -std::accumulate(result.marks.begin(), result.marks.end(), 0);
  }

  // Counts the samples.
  void finish(Cover& result) const {
    if (is_full_) std::fill(result.marks.begin(), result.marks.end(), -1);
    result.covered = -std::accumulate(result.marks.begin(), result.marks.end(), 0);
  }

  // Returns the number of the samples in which a surface is visible.
  int finish(Visible& visible) const {
    visible.spots.clear();
    visible.of_samples = side_ * side_;
    const Pieces pieces(nearest_, cells_, side_, blocks_, motion_px());
    for (const Piece& piece : pieces.all()) {
      const Triangle& triangle = silhouette_.triangles_[static_cast<std::size_t>(piece.triangle)];
      const auto [u, v] =
          silhouette_.actor_.moves
              ? silhouette_.moving_[triangle.picture].weights_at(pixel_, piece.middle)
              : silhouette_.still_[triangle.picture].weights_at(pixel_, piece.middle);
      visible.spots.push_back({{0, static_cast<int>(triangle.part), triangle.in_part, u, v},
                               piece.middle[2],
                               piece.samples,
                               piece.leads});
    }
    return pieces.covered();
  }

 private:
  void add(const Entry& entry) {
    const std::uint32_t i = entry.triangle;
    const Triangle& triangle = silhouette_.triangles_[i];
    if (triangle.planes != kNone)
      add_planes(triangle, i);
    else if (entry.in_row != kNone)
      add(i, silhouette_.in_row_[entry.in_row], pixel_.x);
    else if (silhouette_.actor_.moves)
      add(i, silhouette_.moving_[triangle.picture], pixel_);
    else
      add(i, silhouette_.still_[triangle.picture], pixel_);
  }

  // picture, place: a StillTriangle, a MovingTriangle or a RowTriangle, and what its over() takes.
  template <typename Picture, typename Place>
  void add(std::uint32_t i, const Picture& picture, const Place& place) {
    const bool sees = side_ > 0 && picture.nearest() >= hidden_;
    if (!sees && open_ == 0) return;
    PixelDepth depth;
    const PixelSides sides = picture.over(place, sees ? &depth : nullptr);
    if (sides.is_outside) return;
    if (sees) {
      keep_nearest(sides.side, depth, i, exposes_, cells_, side_ * side_, sides.strips, nearest_);
      hide_behind();
    }
    if (open_ == 0) return;
    if (sides.crossing == 0) {
      is_full_ = true;
      open_ = 0;
      return;
    }
    if constexpr (std::is_same_v<Picture, RowTriangle>) {
      if (is_dense_) return mark_sorted(sides, picture);
    }
    mark_straight(sides);
  }

  // Everything behind all samples is hidden.
  void hide_behind() { hidden_ = least_nearness(nearest_, side_ * side_); }

  void mark_straight(const PixelSides& sides) {
    const unsigned strips = sides.strips & open_;
    if (strips == 0) return;
    place();
    open_ &= ~mark(
        sides.side, sides.crossing, exposes_, places(), samples_, strips, cover_->marks.data());
  }

  // The same where the samples are sorted.
  void mark_sorted(const PixelSides& sides, const RowTriangle& triangle) {
    place();
    sorted_.mark(triangle, pixel_.x, sides.side, cover_->marks.data());
    if (sorted_.open() == 0) open_ = 0;
  }

  const Places& places() const { return is_dense_ ? sorted_.places() : places_; }

  // Of the first surface that is visible.
  Pixel motion_px() const {
    if (!exposes_) return Pixel::Zero();
    const auto end = nearest_.triangle.begin() + side_ * side_;
    const auto first =
        std::find_if(nearest_.triangle.begin(), end, [](std::int32_t i) { return i >= 0; });
    if (first == end) return Pixel::Zero();
    const Triangle& triangle = silhouette_.triangles_[static_cast<std::size_t>(*first)];
    return silhouette_.moving_[triangle.picture].motion_px(pixel_);
  }

  void add_planes(const Triangle& triangle, std::uint32_t i) {
    const bool sees = side_ > 0 && triangle.picture != kNone;
    if (!sees && open_ == 0) return;
    if (!pencil_) pencil_ = silhouette_.pencil_of(pixel_.x, pixel_.y);
    const Planes& planes = silhouette_.planes_[triangle.planes];
    const std::optional<PixelDepth> depth =
        !sees ? std::nullopt
        : silhouette_.actor_.moves
            ? std::optional(silhouette_.moving_[triangle.picture].depth_over(pixel_))
            : std::optional(silhouette_.still_[triangle.picture].depth_over(pixel_));
    if (exposes_)
      add_planes_by<Swept, 3>(planes, depth, i);
    else
      add_planes_by<Bilinear, 1>(planes, depth, i);
  }

  // Side: a type of marking.h. kMoments: the number of the moments that it is made from.
  template <typename Side, std::size_t kMoments>
  void add_planes_by(const Planes& planes,
                     const std::optional<PixelDepth>& depth,
                     std::uint32_t i) {
    std::array<Side, 3> sides;
    int crossing = 0;
    for (std::size_t side = 0; side < 3; ++side) {
      std::array<std::array<double, 4>, kMoments> products;
      int inner = 0;
      for (std::size_t k = 0; k < kMoments; ++k)
        for (std::size_t c = 0; c < 4; ++c) {
          products[k][c] = pencil_->product(planes, side, kMoments == 1 ? 1 : k, c);
          inner += products[k][c] >= 0;
        }
      if (inner == 4 * kMoments) continue;
      if (inner == 0) return;
      if constexpr (kMoments == 1)
        sides[static_cast<std::size_t>(crossing++)] = bilinear_of(products[0]);
      else
        sides[static_cast<std::size_t>(crossing++)] = swept_of(products);
    }
    if (depth) keep_where(sides, crossing, *depth, i);
    if (open_ != 0) mark_planes(sides, crossing);
  }

  template <typename Side>
  void mark_planes(const std::array<Side, 3>& sides, int crossing) {
    if (crossing > 0) place();
    if (crossing > 0 && !mark(sides, crossing, places(), samples_, cover_->marks.data())) return;
    is_full_ = true;
    open_ = 0;
  }

  template <typename Side>
  void keep_where(const std::array<Side, 3>& sides,
                  int crossing,
                  const PixelDepth& depth,
                  std::uint32_t i) {
    const int samples = side_ * side_;
    alignas(64) std::array<std::int32_t, Nearest::kMost> inside;
    std::fill_n(inside.begin(), samples, crossing > 0 ? 0 : -1);
    if (crossing > 0) mark(sides, crossing, cells_, samples, inside.data());
    keep_nearest(inside.data(), depth, i, exposes_, cells_, samples, nearest_);
    hide_behind();
  }

  void place() {
    if (is_placed_) return;
    is_placed_ = true;
    const PixelSamples here(pixel_.x, pixel_.y);
    if (is_dense_) {
      sorted_.fill(here, samples_, drift_px(), cover_->order);
      return;
    }
    here.fill(samples_, places_.x.data(), places_.y.data());
    if (exposes_) here.fill_times(samples_, places_.t.data());
  }

  // Of the first triangle whose motion is known: those of others differ little.
  Pixel drift_px() const {
    for (const Entry& entry : silhouette_.triangles_of(pixel_.x, pixel_.y)) {
      const Triangle& triangle = silhouette_.triangles_[entry.triangle];
      if (triangle.picture != kNone)
        return silhouette_.moving_[triangle.picture].motion_px(pixel_) / 2;
    }
    return Pixel::Zero();
  }

  const Silhouette& silhouette_;
  PixelPlace pixel_;
  bool exposes_ = false;

  // Coverage.
  Cover* cover_ = nullptr;
  int samples_ = 0;
  std::optional<Pencil> pencil_;
  // True where many triangles touch the pixel during an exposure; the samples are then in sorted_
  // and else in places_.
  bool is_dense_ = false;
  SortedSamples sorted_;
  Places places_;
  bool is_placed_ = false;
  bool is_full_ = false;
  // The strips with samples that are not covered yet; in sorted_ all until nothing is open.
  unsigned open_ = 0;

  // Depth.
  int side_ = 0;
  int blocks_ = 1;
  Places cells_;
  Nearest nearest_;
  // What is less near than this is hidden in the whole pixel.
  float hidden_ = 0;
};

int Silhouette::see(int x, int y, const SampleCounts& counts, Visible& visible) const {
  PixelCover pixel(*this, x, y);
  pixel.see(counts);
  pixel.look();
  return pixel.finish(visible);
}

void Silhouette::cover(int x, int y, int samples, Cover& result) const {
  PixelCover pixel(*this, x, y);
  pixel.cover(samples, result);
  pixel.look();
  pixel.finish(result);
}

void Silhouette::cover_mixed(int x, int y, int samples, Cover& opaque, Cover& translucent) const {
  PixelCover by_opaque(*this, x, y);
  by_opaque.cover(samples, opaque);
  by_opaque.look(true);
  by_opaque.finish(opaque);
  PixelCover(*this, x, y).cover_by_translucent(samples, translucent);
}

int Silhouette::cover_and_see(
    int x, int y, const SampleCounts& counts, Cover& result, Visible& visible) const {
  PixelCover pixel(*this, x, y);
  pixel.cover(counts.outline, result);
  pixel.see(counts);
  pixel.look();
  pixel.finish(result);
  return pixel.finish(visible);
}

}  // namespace airtruth::render
