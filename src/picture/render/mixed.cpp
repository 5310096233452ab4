// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdint>

#include "picture/render/tracer.h"

// The pixels in which an aircraft has translucent surfaces (Tracer::sample_mixed).
namespace airtruth::render {
namespace {

// How many samples that are opaque as a whole are traced, for the mean distance.
constexpr int kTraced = 64;
// How many samples are traced where the same panes of even opacity cover them: the rays meet the
// same surfaces, and only the distance differs.
constexpr int kTracedAlike = 16;

// Samples of one kind.
struct Pool {
  // Of all samples.
  double alpha = 0;
  // Of the samples that only translucent surfaces cover: those are traced, or like others that are.
  double alone_alpha = 0;
  double alone_depth = 0;
  // Sums over the traced samples that an opaque surface covers, and over all shaded ones.
  double traced_alpha = 0;
  double depth = 0;
  double shaded_alpha = 0;
  std::array<double, 3> rgb{};
  int shaded = 0;
  int traced = 0;

  // The mean distance where an opaque surface is; of a pool in which a ray met something.
  double covered_m() const {
    return traced_alpha > 0 ? depth / traced_alpha : alone_depth / alone_alpha;
  }
};

// Samples that the same panes of even opacity cover, and nothing else.
struct Alike {
  std::uint32_t triangles = 0;
  // The samples that are traced, and the sums over those.
  int traced = 0;
  double alpha = 0;
  double depth = 0;
  // The others.
  int left = 0;
};

// A sample that is to be traced.
struct Asked {
  int sample;
  bool is_translucent;
  bool is_covered;  // by an opaque surface
  bool shades;
  Alike* alike;  // null where there is none
};

}  // namespace

class MixedPixel {
 public:
  MixedPixel(const Tracer& tracer, const PixelShots& shots, int actor, int shaded)
      : tracer_(tracer), shots_(shots), actor_(actor), shaded_(shaded) {}

  // triangles: of Cover.
  void add(int sample, bool is_covered, bool is_translucent, std::uint32_t triangles) {
    Pool& pool = is_translucent ? translucent_ : opaque_;
    const bool shades =
        pool.shaded < (is_translucent ? Tracer::kTranslucentShaded * shaded_ : shaded_);
    if (is_covered) pool.alpha += 1;
    if (shades) ++pool.shaded;
    if (is_covered && !shades && pool.traced >= kTraced) return;
    Alike* const alike = is_covered ? nullptr : alike_of(triangles);
    if (alike != nullptr && !shades && alike->traced >= kTracedAlike) {
      ++alike->left;
      return;
    }
    if (alike != nullptr) ++alike->traced;
    ++pool.traced;
    asked_[count_++] = {sample, is_translucent, is_covered, shades, alike};
    if (count_ == asked_.size()) trace();
  }

  // Returns false where no ray meets what the outlines cover.
  bool finish(Sum& sum) {
    trace();
    add_left();
    sum.alpha = opaque_.alpha + translucent_.alpha;
    if (sum.alpha > 0 && !(opaque_.shaded_alpha + translucent_.shaded_alpha > 0)) return false;
    for (const Pool* kind : {&opaque_, &translucent_}) {
      const Pool& pool = *kind;
      if (!(pool.alpha > 0)) continue;
      // So close to an edge the outlines and the rays may disagree on all of a few samples.
      const Pool& seen = pool.shaded_alpha > 0 ? pool : kind == &opaque_ ? translucent_ : opaque_;
      sum.depth += pool.alone_depth + seen.covered_m() * (pool.alpha - pool.alone_alpha);
      for (std::size_t c = 0; c < 3; ++c)
        sum.translucent_rgb[c] += seen.rgb[c] / seen.shaded_alpha * pool.alpha;
    }
    // The colours are weighted already.
    sum.translucent_shaded = sum.translucent = 1;
    return true;
  }

 private:
  // Null where the opacity differs from place to place, or where the sets are too many.
  Alike* alike_of(std::uint32_t triangles) {
    if ((triangles & 1) != 0) return nullptr;
    for (std::size_t i = 0; i < alike_count_; ++i)
      if (alike_[i].triangles == triangles) return &alike_[i];
    if (alike_count_ == alike_.size()) return nullptr;
    alike_[alike_count_] = {triangles};
    return &alike_[alike_count_++];
  }

  // The samples that are not traced have the means of those like them.
  void add_left() {
    for (std::size_t i = 0; i < alike_count_; ++i) {
      const Alike& alike = alike_[i];
      const double share = static_cast<double>(alike.left) / alike.traced;
      translucent_.alone_alpha += share * alike.alpha;
      translucent_.alpha += share * alike.alpha;
      translucent_.alone_depth += share * alike.depth;
    }
  }

  void trace() {
    const std::size_t n = count_;
    count_ = 0;
    std::array<Shot, Tracer::kTogether> shots;
    for (std::size_t i = 0; i < n; ++i) {
      shots[i] = shots_(asked_[i].sample);
      fragments_[i].clear();
    }
    tracer_.collect(
        actor_, std::span(shots).first(n), shots_.pixel_rad(), std::span(fragments_).first(n));
    for (std::size_t i = 0; i < n; ++i)
      if (!fragments_[i].empty()) blend(asked_[i], shots[i], fragments_[i]);
  }

  void blend(const Asked& asked, const Shot& shot, const std::vector<Fragment>& fragments) {
    Pool& pool = asked.is_translucent ? translucent_ : opaque_;
    double depth = 0;
    double through = 1;
    for (const Fragment& fragment : fragments) {
      depth += through * fragment.alpha * fragment.distance_m;
      if (asked.shades) {
        const std::array<float, 3> rgb = tracer_.colour(shot, shots_.pixel_rad(), fragment);
        for (std::size_t c = 0; c < 3; ++c) pool.rgb[c] += through * rgb[c];
      }
      through *= 1.0 - fragment.alpha;
      if (through <= 0) break;
    }
    const double alpha = 1 - through;
    if (asked.shades) pool.shaded_alpha += alpha;
    if (asked.is_covered) {
      pool.traced_alpha += alpha;
      pool.depth += depth;
    } else {
      pool.alone_alpha += alpha;
      pool.alpha += alpha;
      pool.alone_depth += depth;
    }
    if (asked.alike != nullptr) {
      asked.alike->alpha += alpha;
      asked.alike->depth += depth;
    }
  }

  const Tracer& tracer_;
  const PixelShots& shots_;
  int actor_;
  int shaded_;
  Pool opaque_;
  Pool translucent_;
  std::array<Alike, 16> alike_;
  std::size_t alike_count_ = 0;
  std::array<Asked, Tracer::kTogether> asked_;
  std::size_t count_ = 0;
  std::array<std::vector<Fragment>, Tracer::kTogether> fragments_;
};

bool Tracer::sample_mixed(
    int x, int y, int actor, const Cover& opaque, const Cover& translucent, Sum& sum) const {
  const PixelSamples order(x, y);
  const PixelShots shots(grid_, x, y);
  sum.count = opaque.samples();
  if (!shots.known()) return true;
  MixedPixel pixel(*this, shots, actor, counts_.shaded);
  for (int i = 0; i < sum.count; ++i) {
    const bool is_covered = opaque.covered > 0 && opaque.covers(order, i);
    const std::size_t place = translucent.place(order, i);
    const bool is_translucent = translucent.marks[place] != 0;
    if (!is_covered && !is_translucent) continue;
    ++sum.hits;
    pixel.add(i, is_covered, is_translucent, translucent.triangles[place]);
  }
  sum.most = 1;
  sum.least = opaque.covered == sum.count ? 1 : 0;
  return pixel.finish(sum);
}

}  // namespace airtruth::render
