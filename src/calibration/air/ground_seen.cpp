// SPDX-License-Identifier: Apache-2.0
#include "calibration/air/ground_seen.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "foundation/image/colour.h"

namespace airtruth::air {

std::vector<PixelRay> pixel_rays(const lens::Lens& lens,
                                 const image::Mask* own_aircraft,
                                 int first,
                                 int step) {
  std::vector<PixelRay> rays;
  for (int y = first; y < lens.size().height; y += step)
    for (int x = first; x < lens.size().width; x += step) {
      if (own_aircraft != nullptr && !own_aircraft->is_free(x, y)) continue;
      if (const auto ray = lens.ray_from_pixel({x + 0.5, y + 0.5})) rays.push_back({x, y, *ray});
    }
  return rays;
}

namespace {

// Where a constant of this file states no origin, it was chosen on the virtual flights of
// surroundings_slow_test.cpp, whose figures are in docs/realism.md.

// Least range of a square, heights.
constexpr double kMinSeenRange = 2.5;
// Least share of the pixels of a square that a view shows, and the least number
// of pixels of a square.
constexpr double kMinShareSeen = 0.6;
constexpr double kMinPixels = 3;
// Largest number of pixels that are sampled in a view: it bounds the time.
constexpr double kMaxSampledPixels = 1.5e6;

// Borders of the bands of far ground, degrees below the horizon. Bands within one pixel of the
// horizon are not used.
constexpr std::array kBordersDeg{0.15, 0.3, 0.45, 0.6, 0.8, 1.05, 1.35, 1.7, 2.1, 2.6, 3.2};
constexpr std::size_t kBands = kBordersDeg.size() - 1;
// Least number of pixels of a band, over all views.
constexpr double kMinPixelsInBand = 1000;

struct Sum {
  double count = 0, range = 0;
  Eigen::Vector2d way = Eigen::Vector2d::Zero();
  std::array<double, 3> light{};

  void add(const Eigen::Vector2d& to_pixel, double range_of_it, const image::Rgb& linear) {
    count += 1, range += range_of_it;
    way += to_pixel;
    for (std::size_t c = 0; c < 3; ++c) light[c] += double(linear[c]);
  }
  std::array<double, 3> mean_light() const {
    return {light[0] / count, light[1] / count, light[2] / count};
  }
};

// The pixels of a band, and the sum of their depressions.
struct BandSum : Sum {
  double depression_rad = 0;
};

int sector_of_way(const Eigen::Vector2d& way) {
  return air::sector_of(std::atan2(way.y(), way.x()));
}

// Collects the squares and bands, one view after the other.
class Gatherer {
 public:
  Gatherer(const Scenery& scenery, const image::ToneCurve& tone)
      : tone_(tone), bands_(kSectors * kBands) {
    const lens::Lens& lens = scenery.lens;
    const double pixels = double(lens.size().width) * lens.size().height;
    const int step =
        std::max(1, static_cast<int>(std::lround(std::sqrt(pixels / kMaxSampledPixels))));
    step_rad_ = step / lens.focal_px();
    rays_ = pixel_rays(lens, scenery.own_aircraft, step / 2, step);
    for (std::size_t i = 0; i <= kBands; ++i) {
      const double border_rad = radians(kBordersDeg[i]);
      borders_[i] = border_rad * lens.focal_px() < 1 ? 0 : 1 / std::sin(border_rad);
    }
  }

  void add(const GroundView& view, const Quaternion& level_from_world, const Eigen::Vector2d& at) {
    const double farthest = std::sqrt(1 / step_rad_);
    const image::ColourCode code(view.picture->colour);
    const Quaternion level_from_cam = level_from_world * view.cam_from_world.conjugate();
    std::map<Place, Sum> sums;
    auto last = sums.end();
    for (const PixelRay& ray : rays_) {
      const auto way = place_on_ground(level_from_cam * ray.in_cam);
      if (!way) continue;
      const double range = std::sqrt(way->squaredNorm() + 1);
      const auto band = band_of(range);
      const bool in_square = range >= kMinSeenRange && range <= farthest;
      if (!band && !in_square) continue;
      const image::Rgb linear = image::linear_at(*view.picture, code, ray.x, ray.y, tone_);
      if (band) {
        BandSum& sum = bands_[static_cast<std::size_t>(sector_of_way(*way)) * kBands + *band];
        sum.add(*way, range, linear);
        sum.depression_rad += std::asin(1 / range);
      }
      if (!in_square) continue;
      const Eigen::Vector2d place = at + *way;
      const Place square{static_cast<int>(std::floor(place.x())),
                         static_cast<int>(std::floor(place.y()))};
      // Neighbouring pixels mostly show the same square.
      if (last == sums.end() || last->first != square) last = sums.try_emplace(square).first;
      last->second.add(*way, range, linear);
    }
    add_squares(sums);
  }

  GroundSeen seen() {
    std::ranges::stable_sort(seen_.squares, {}, &SquareSeen::square);
    for (std::size_t i = 0; i < bands_.size(); ++i)
      if (const BandSum& band = bands_[i]; band.count >= kMinPixelsInBand)
        seen_.far.push_back({static_cast<int>(i / kBands),
                             1 / std::sin(band.depression_rad / band.count),
                             band.mean_light()});
    return std::move(seen_);
  }

 private:
  using Place = std::pair<int, int>;

  // Adds the squares of one view of which enough is seen.
  void add_squares(const std::map<Place, Sum>& sums) {
    for (const auto& [place, sum] : sums) {
      const double range = sum.range / sum.count;
      const double whole = 1 / (range * range * range * step_rad_ * step_rad_);
      if (sum.count < std::max(kMinPixels, kMinShareSeen * whole)) continue;
      const int square = numbers_.emplace(place, static_cast<int>(numbers_.size())).first->second;
      seen_.squares.push_back({square, sector_of_way(sum.way), range, sum.mean_light()});
    }
  }

  std::optional<std::size_t> band_of(double range) const {
    for (std::size_t i = kBands; i > 0 && range >= borders_[i]; --i)
      if (range < borders_[i - 1]) return i - 1;
    return std::nullopt;
  }

  image::ToneCurve tone_;
  double step_rad_ = 0;
  std::vector<PixelRay> rays_;
  std::map<Place, int> numbers_;
  // Ranges of the borders, heights; 0 for a border within a pixel of the horizon.
  std::array<double, kBands + 1> borders_{};
  // The bands of one sector after those of the other.
  std::vector<BandSum> bands_;
  GroundSeen seen_;
};

}  // namespace

GroundSeen ground_seen(const Scenery& scenery,
                       const GroundTrack& track,
                       const image::ToneCurve& tone) {
  Gatherer gatherer(scenery, tone);
  for (std::size_t k = 0; k < track.places.size(); ++k)
    gatherer.add(scenery.views[track.first + k], track.level_from_world, track.places[k]);
  return gatherer.seen();
}

namespace {

// Spacing of the samples, pixels.
constexpr int kGroundStep = 2;
// Height of a patch, degrees of depression. Chosen by judgement.
constexpr double kPatchDepressionDeg = 2;

std::vector<SeenLight> ground_of(const GroundView& view,
                                 const std::vector<PixelRay>& rays,
                                 const image::ToneCurve& tone) {
  const image::ColourCode code(view.picture->colour);
  const Quaternion world_from_cam = view.cam_from_world.conjugate();
  std::vector<SeenLight> ground;
  for (const PixelRay& ray : rays) {
    const Vector3 direction = world_from_cam * ray.in_cam;
    if (direction.z() < 0) continue;
    ground.push_back(
        seen_under(direction, image::linear_at(*view.picture, code, ray.x, ray.y, tone)));
  }
  return ground;
}

struct Patch {
  int count = 0;
  SeenLight mean;

  void add(const SeenLight& ground) {
    ++count;
    const double share = 1.0 / count;
    mean.azimuth_rad += share * (ground.azimuth_rad - mean.azimuth_rad);
    mean.elevation_rad += share * (ground.elevation_rad - mean.elevation_rad);
    for (std::size_t c = 0; c < 3; ++c)
      mean.linear[c] += static_cast<float>(share) * (ground.linear[c] - mean.linear[c]);
  }
};

void append_patches(std::vector<SeenLight>& all,
                    const std::vector<SeenLight>& ground,
                    double altitude_m,
                    double pixel_rad) {
  const double farthest_m = altitude_m / std::sin(radians(kPatchDepressionDeg));
  const double across_m = farthest_m * pixel_rad;
  const double along_m = across_m / std::sin(radians(kPatchDepressionDeg));
  std::map<std::pair<int, int>, Patch> patches;
  auto last = patches.end();
  for (const SeenLight& g : ground) {
    const double range_m = altitude_m / std::sin(-g.elevation_rad);
    if (range_m > farthest_m) {
      all.push_back(g);
      continue;
    }
    const int ring = static_cast<int>(range_m / along_m);
    const double middle_m = (ring + 0.5) * along_m;
    const int place = static_cast<int>(std::floor(g.azimuth_rad * middle_m / across_m));
    const std::pair<int, int> at{ring, place};
    // Neighbouring pixels of near ground mostly show the same patch.
    if (last == patches.end() || last->first != at) last = patches.try_emplace(at).first;
    last->second.add(g);
  }
  for (const auto& [place, patch] : patches) all.push_back(patch.mean);
}

}  // namespace

std::vector<SeenLight> ground_patches(const Scenery& scenery,
                                      double altitude_m,
                                      const image::ToneCurve& tone) {
  const std::vector<PixelRay> rays =
      pixel_rays(scenery.lens, scenery.own_aircraft, kGroundStep / 2, kGroundStep);
  std::vector<SeenLight> all;
  for (const GroundView& view : scenery.views)
    append_patches(all, ground_of(view, rays, tone), altitude_m, 1 / scenery.lens.focal_px());
  return all;
}

}  // namespace airtruth::air
