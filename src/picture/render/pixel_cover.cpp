// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <numeric>
#include <optional>

#include "picture/render/marking.h"
#include "picture/render/nearest.h"
#include "picture/render/pieces.h"
#include "picture/render/pixel_rays.h"
#include "picture/render/silhouette.h"

namespace airtruth::render {

struct Silhouette::Pencil {
  bool known = true;
  bool moves = false;
  // Directions at a pixel's corners. At an instant: in world (moment 1). During a motion: in body,
  // with e x d, at the three moments of the pixel's exposure (or at moment 1 alone).
  Thrice<std::array<Vector3, 4>> direction;
  Thrice<std::array<Vector3, 4>> moment;
  bool exposes = false;

  double product(const Planes& planes, std::size_t side, std::size_t k, std::size_t corner) const {
    const double still = planes.side[side].dot(direction[k][corner]);
    return moves ? still + planes.edge[side].dot(moment[k][corner]) : still;
  }
};

Silhouette::Pencil Silhouette::pencil_of(int x, int y) const {
  Pencil pencil;
  pencil.moves = actor_.moves;
  if (!actor_.moves) {
    pencil.direction[1] = grid_.corners(x, y);
    pencil.known = finite(pencil.direction[1]);
    return pencil;
  }
  const Beam beam = beam_of(actor_, grid_, x, y);
  pencil.known = beam.known;
  pencil.exposes = beam.exposes;
  pencil.direction = beam.direction_in_body;
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t c = 0; c < 4; ++c)
      pencil.moment[k][c] = beam.eye_in_body[k].cross(pencil.direction[k][c]);
  return pencil;
}

bool Silhouette::is_known(int x, int y) const {
  for (int k = actor_.moves ? 0 : 1; k < (actor_.moves ? 3 : 2); ++k)
    if (!finite(grid_.corners(x, y, k))) return false;
  return true;
}

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
    result.is_covered.assign(static_cast<std::size_t>(samples), 0);
    covered_ = result.is_covered.data();
    samples_ = samples;
    open_ = kAllStrips;
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

  void look() {
    if (!silhouette_.is_known(pixel_.x, pixel_.y)) return;
    for (const std::uint32_t i : silhouette_.triangles_of(pixel_.x, pixel_.y)) {
      const Triangle& triangle = silhouette_.triangles_[i];
      // All others are hidden too.
      if (open_ == 0 && (side_ == 0 || triangle.nearest < hidden_)) break;
      if (triangle.planes != kNone)
        add_planes(triangle, i);
      else if (silhouette_.actor_.moves)
        add(silhouette_.moving_[triangle.picture], i);
      else
        add(silhouette_.still_[triangle.picture], i);
    }
  }

  // Counts the samples.
  void finish(Cover& result) const {
    if (is_full_) std::fill_n(covered_, samples_, -1);
    result.covered = -std::accumulate(covered_, covered_ + samples_, 0);
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
  template <typename Straight>
  void add(const Straight& triangle, std::uint32_t i) {
    const bool sees = side_ > 0 && triangle.nearest() >= hidden_;
    if (!sees && open_ == 0) return;
    PixelDepth depth;
    const PixelSides sides = triangle.over(pixel_, sees ? &depth : nullptr);
    if (sides.is_outside) return;
    if (sees) {
      keep_nearest(sides.side, depth, i, exposes_, cells_, side_ * side_, sides.strips, nearest_);
      hide_behind();
    }
    if (open_ != 0) mark_straight(sides);
  }

  // Everything behind all samples is hidden.
  void hide_behind() {
    // The look at all samples costs as much as a triangle.
    constexpr int kEvery = 4;
    if (++kept_ % kEvery != 0) return;
    const auto end = nearest_.nearness.begin() + side_ * side_;
    hidden_ = *std::min_element(nearest_.nearness.begin(), end);
  }

  void mark_straight(const PixelSides& sides) {
    if (sides.crossing == 0) {
      is_full_ = true;
      open_ = 0;
      return;
    }
    const unsigned strips = sides.strips & open_;
    if (strips == 0) return;
    place();
    open_ &= ~mark(sides.side, exposes_, places_, samples_, strips, covered_);
  }

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
    if (crossing > 0 && !mark(sides, crossing, places_, samples_, covered_)) return;
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
    here.fill(samples_, places_.x.data(), places_.y.data());
    if (exposes_) here.fill_times(samples_, places_.t.data());
  }

  const Silhouette& silhouette_;
  PixelPlace pixel_;
  bool exposes_ = false;

  // Coverage.
  std::int32_t* covered_ = nullptr;
  int samples_ = 0;
  std::optional<Pencil> pencil_;
  Places places_;
  bool is_placed_ = false;
  bool is_full_ = false;
  // The strips with samples that are not covered yet.
  unsigned open_ = 0;

  // Depth.
  int side_ = 0;
  int blocks_ = 1;
  Places cells_;
  Nearest nearest_;
  // What is less near than this is hidden in the whole pixel.
  float hidden_ = 0;
  int kept_ = 0;
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
