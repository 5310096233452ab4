// SPDX-License-Identifier: Apache-2.0
#include "picture/render/refiner.h"

#include <algorithm>
#include <optional>

#include <tbb/parallel_for.h>

#include "picture/render/silhouette.h"

namespace airtruth::render {
namespace {

// Samples of a pixel beside an edge before it counts as fully covered or empty.
constexpr int kNeighbourSamples = 128;

void sample_pixel(const Tracer& tracer, Canvas& canvas, int x, int y, int from, int to) {
  const std::size_t i = canvas.index(x, y);
  double* coverage = canvas.coverage.data() + i * canvas.actors;
  double* alone = canvas.alone.data() + i * canvas.actors;
  tracer.sample(x, y, from, to, canvas.sums[i], coverage, alone);
}

// True where an outline of the aircraft, or of a translucent surface, passes through this pixel or
// a neighbour.
bool on_edge(const Canvas& canvas, const std::vector<std::uint8_t>& kind, int x, int y) {
  const std::uint8_t own = kind[canvas.index(x, y)];
  if (own == 2) return true;
  for (int j = std::max(y - 1, canvas.patch.y); j <= std::min(y + 1, canvas.patch.bottom() - 1);
       ++j) {
    for (int i = std::max(x - 1, canvas.patch.x); i <= std::min(x + 1, canvas.patch.right() - 1);
         ++i)
      if (kind[canvas.index(i, j)] != own) return true;
  }
  return false;
}

// Value 0: every sample missed. 1: every sample hit one actor, at nearly the same opacity. 2:
// mixed.
std::uint8_t kind_of(const Canvas& canvas, std::size_t i) {
  const Sum& sum = canvas.sums[i];
  if (sum.hits == 0) return 0;
  constexpr double kEven = 0.1;
  if (sum.hits != sum.count || sum.most - sum.least > kEven) return 2;
  for (std::size_t a = 0; a < canvas.actors; ++a)
    if (canvas.coverage[i * canvas.actors + a] == sum.alpha) return 1;
  return 2;
}

std::vector<std::uint8_t> kinds(const Canvas& canvas) {
  std::vector<std::uint8_t> result(canvas.sums.size());
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = kind_of(canvas, i);
  return result;
}

class Refiner {
 public:
  Refiner(const View& view,
          const std::vector<TracedIntruder>& actors,
          const Tracer& tracer,
          const RayGrid& grid,
          const SampleCounts& counts,
          Canvas& canvas)
      : actors_(actors), tracer_(tracer), counts_(counts), canvas_(canvas) {
    // Where every pixel takes as many samples as an edge (the reference quality), rays do all the
    // work.
    if (counts.edge == counts.base) return;
    for (const TracedIntruder& actor : actors)
      silhouettes_.push_back(actor.pixels
                                 ? std::optional<Silhouette>(
                                       std::in_place, actor, view, canvas.patch, grid, counts.sees)
                                 : std::nullopt);
  }

  void fill(const std::stop_token& stop) {
    each_pixel(stop, [&](int x, int y) { rough(x, y); });
    if (counts_.edge == counts_.base) return;
    const std::vector<std::uint8_t> kind = kinds(canvas_);
    each_pixel(stop, [&](int x, int y) { refine(x, y, kind); });
  }

 private:
  // Where fewer than one in this many samples of the depth buffer meet the aircraft, they do not
  // say which of its parts are how large in the pixel: rays through the many samples of the outline
  // do.
  static constexpr int kFewest = 8;
  static constexpr int kRays = -1;
  static constexpr int kNobody = -2;

  // The single opaque actor whose outline determines the pixel, or kRays, or kNobody.
  int only_actor(int x, int y) const {
    int only = kNobody;
    for (std::size_t a = 0; a < actors_.size(); ++a) {
      if (!actors_[a].pixels || !actors_[a].pixels->contains(x, y)) continue;
      if (silhouettes_.empty()) return kRays;
      const Silhouette::Touch touch = silhouettes_[a]->touch(x, y);
      if (touch == Silhouette::Touch::kNone) continue;
      if (touch == Silhouette::Touch::kRays || only != kNobody) return kRays;
      only = static_cast<int>(a);
    }
    return only;
  }

  template <typename Body>
  void each_pixel(const std::stop_token& stop, const Body& body) {
    tbb::parallel_for(canvas_.patch.y, canvas_.patch.bottom(), [&](int y) {
      for (int x = canvas_.patch.x; x < canvas_.patch.right() && !stop.stop_requested(); ++x)
        body(x, y);
    });
  }

  void rough(int x, int y) {
    const int only = only_actor(x, y);
    if (only == kNobody) return;
    if (only == kRays) {
      sample_pixel(tracer_, canvas_, x, y, 0, counts_.base);
      return;
    }
    const Silhouette& silhouette = *silhouettes_[static_cast<std::size_t>(only)];
    if (silhouette.touch(x, y) == Silhouette::Touch::kMixed) {
      mixed(x, y, only);
      return;
    }
    const bool sees = counts_.sees && silhouette.touch(x, y) == Silhouette::Touch::kOpaque;
    thread_local Visible visible;
    thread_local Cover found;
    int seen = 0;
    if (sees && counts_.at_once) {
      seen = silhouette.cover_and_see(x, y, counts_, found, visible);
      count(x, y, only, counts_.outline, found.covered);
    } else if (sees) {
      seen = silhouette.see(x, y, counts_, visible);
      count(x, y, only, visible.of_samples, seen);
    } else {
      found = cover(x, y, only, counts_.at_once ? counts_.outline : kRoughCover);
    }
    if (sees && seen * kFewest >= visible.of_samples)
      tracer_.shade_visible(x, y, only, visible, canvas_.sums[canvas_.index(x, y)]);
    if (counts_.at_once) outline(x, y, only, &found);
  }

  // A pixel in which an aircraft has translucent surfaces, too.
  void mixed(int x, int y, int only) {
    thread_local Cover opaque;
    thread_local Cover translucent;
    const Silhouette& silhouette = *silhouettes_[static_cast<std::size_t>(only)];
    int samples = counts_.at_once ? counts_.outline : kRoughCover;
    silhouette.cover_mixed(x, y, samples, opaque, translucent);
    const bool is_even =
        opaque.covered == samples || (opaque.covered == 0 && translucent.covered == 0);
    // Each sample that only a translucent surface covers costs a ray.
    const int edge = std::min(counts_.outline / 2, 2 * counts_.edge);
    if (!is_even && samples < edge) {
      samples = edge;
      silhouette.cover_mixed(x, y, samples, opaque, translucent);
    }
    const std::size_t i = canvas_.index(x, y);
    if (!tracer_.sample_mixed(x, y, only, opaque, translucent, canvas_.sums[i])) {
      forget(x, y, only);
      sample_pixel(tracer_, canvas_, x, y, 0, counts_.edge);
      return;
    }
    const std::size_t of_actor = i * canvas_.actors + static_cast<std::size_t>(only);
    canvas_.coverage[of_actor] = canvas_.alone[of_actor] = canvas_.sums[i].alpha;
  }

  void refine(int x, int y, const std::vector<std::uint8_t>& kind) {
    const int only = only_actor(x, y);
    if (only == kNobody) return;
    const bool edge = on_edge(canvas_, kind, x, y);
    if (only != kRays &&
        silhouettes_[static_cast<std::size_t>(only)]->touch(x, y) == Silhouette::Touch::kMixed)
      return;
    if (only == kRays) {
      if (edge) refine_by_rays(x, y, kind[canvas_.index(x, y)]);
      return;
    }
    if (!counts_.at_once) outline(x, y, only, edge ? &cover(x, y, only, counts_.outline) : nullptr);
  }

  // Shades a pixel whose surfaces are not known yet. `found`: of the pixel; null: every sample is
  // covered, or none.
  void outline(int x, int y, int only, const Cover* found) {
    static const Cover kEverySample{kRoughCover, std::vector<std::int32_t>(kRoughCover, -1), {}};
    Sum& sum = canvas_.sums[canvas_.index(x, y)];
    if (sum.hits == 0 || sum.opaque_shaded > 0 ||
        tracer_.shade_covered(x, y, only, found ? *found : kEverySample, sum))
      return;
    // The outline covers a sample, but no ray hits.
    forget(x, y, only);
    sample_pixel(tracer_, canvas_, x, y, 0, counts_.edge);
  }

  void refine_by_rays(int x, int y, std::uint8_t kind) {
    const std::size_t i = canvas_.index(x, y);
    int done = canvas_.sums[i].count;
    if (kind != 2 && counts_.edge > kNeighbourSamples && done < kNeighbourSamples) {
      sample_pixel(tracer_, canvas_, x, y, done, kNeighbourSamples);
      done = kNeighbourSamples;
      if (kind_of(canvas_, i) == kind) return;
    }
    sample_pixel(tracer_, canvas_, x, y, done, counts_.edge);
  }

  // Covers a pixel by the outline of its single actor, without its light. The result is valid until
  // the next call on this thread.
  const Cover& cover(int x, int y, int actor, int samples) {
    thread_local Cover found;
    found.covered = 0;
    silhouettes_[static_cast<std::size_t>(actor)]->cover(x, y, samples, found);
    count(x, y, actor, samples, found.covered);
    return found;
  }

  // Sets the coverage of a pixel by its single actor, and keeps its light.
  void count(int x, int y, int actor, int samples, int covered) {
    const std::size_t i = canvas_.index(x, y);
    Sum& sum = canvas_.sums[i];
    if (sum.alpha > 0) sum.depth *= covered / sum.alpha;
    sum.count = samples;
    sum.hits = covered;
    sum.least = sum.most = 1;
    sum.alpha = sum.opaque = covered;
    const std::size_t of_actor = i * canvas_.actors + static_cast<std::size_t>(actor);
    canvas_.coverage[of_actor] = canvas_.alone[of_actor] = covered;
  }

  void forget(int x, int y, int actor) {
    const std::size_t i = canvas_.index(x, y);
    const std::size_t of_actor = i * canvas_.actors + static_cast<std::size_t>(actor);
    canvas_.sums[i] = {};
    canvas_.coverage[of_actor] = canvas_.alone[of_actor] = 0;
  }

  static constexpr int kRoughCover = 64;

  const std::vector<TracedIntruder>& actors_;
  const Tracer& tracer_;
  SampleCounts counts_;
  Canvas& canvas_;
  std::vector<std::optional<Silhouette>> silhouettes_;
};

}  // namespace

void fill(const View& view,
          const std::vector<TracedIntruder>& actors,
          const Tracer& tracer,
          const RayGrid& grid,
          const SampleCounts& counts,
          const std::stop_token& stop,
          Canvas& canvas) {
  Refiner(view, actors, tracer, grid, counts, canvas).fill(stop);
}

}  // namespace airtruth::render
