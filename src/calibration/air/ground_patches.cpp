// SPDX-License-Identifier: Apache-2.0
#include "calibration/air/ground_patches.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "calibration/air/rays.h"
#include "foundation/image/colour.h"

namespace airtruth::calibration {
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

std::vector<SeenLight> ground_patches(const std::vector<GroundView>& views,
                                      const lens::Lens& lens,
                                      const image::Mask* own_aircraft,
                                      double altitude_m,
                                      const image::ToneCurve& tone) {
  const std::vector<PixelRay> rays = pixel_rays(lens, own_aircraft, kGroundStep / 2, kGroundStep);
  std::vector<SeenLight> all;
  for (const GroundView& view : views)
    append_patches(all, ground_of(view, rays, tone), altitude_m, 1 / lens.focal_px());
  return all;
}

}  // namespace airtruth::calibration
