// SPDX-License-Identifier: Apache-2.0
#include "camera/horizon/unrolled.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace airtruth::motion {
namespace {

// The number of azimuths at which the horizon is looked for.
constexpr int kColumns = 180;
// The band of sky whose slope is subtracted from a step, in degrees above the averaged band. The
// gap between the two leaves out the softness of the edge itself.
constexpr double kSkyFromDeg = 0.3, kSkyToDeg = 1.1;
// The luma of what is not seen.
constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();

// Bilinear interpolation; NaN outside the picture and on the own aircraft.
float luma_at(const image::Picture& picture, const image::Mask* own_aircraft, const Pixel& p) {
  const double x = p.x() - 0.5;
  const double y = p.y() - 0.5;
  const int ix = static_cast<int>(std::floor(x));
  const int iy = static_cast<int>(std::floor(y));
  if (ix < 0 || iy < 0 || ix + 1 >= picture.width || iy + 1 >= picture.height) return kNothing;
  if (own_aircraft != nullptr && !own_aircraft->is_free(ix, iy)) return kNothing;
  const auto fx = static_cast<float>(x - ix);
  const auto fy = static_cast<float>(y - iy);
  const std::uint8_t* upper = picture.planes[0].row(iy) + ix;
  const std::uint8_t* lower = picture.planes[0].row(iy + 1) + ix;
  const float a = static_cast<float>(upper[0]) * (1 - fx) + static_cast<float>(upper[1]) * fx;
  const float b = static_cast<float>(lower[0]) * (1 - fx) + static_cast<float>(lower[1]) * fx;
  return a * (1 - fy) + b * fy;
}

// The mean of `across` rows above a row less the mean of as many rows below it.
float step_at(const std::vector<float>& luma, int row, int across) {
  float sum = 0;
  for (int k = 1; k <= across; ++k)
    sum += luma[static_cast<std::size_t>(row + k)] - luma[static_cast<std::size_t>(row - k)];
  return sum / static_cast<float>(across);
}

struct Rows {
  int across, sky_from, sky_to;
};

// The mean of the steps above a row that are seen; 0 if none is.
float sky_at(const std::vector<float>& steps, int row, const Rows& rows) {
  float sum = 0;
  int seen = 0;
  for (int r = row + rows.sky_from; r <= row + rows.sky_to; ++r) {
    const float step = steps[static_cast<std::size_t>(r)];
    if (std::isnan(step)) continue;
    sum += step;
    ++seen;
  }
  return seen > 0 ? sum / static_cast<float>(seen) : 0;
}

Rows rows_of(const Sweep& sweep) {
  const auto rows = [&](double deg) { return static_cast<int>(std::lround(deg / sweep.step_deg)); };
  return {std::max(1, rows(sweep.across_deg)),
          rows(sweep.across_deg + kSkyFromDeg),
          rows(sweep.across_deg + kSkyToDeg)};
}

// A direction is `level` times a horizontal direction plus `up` times the upward one.
struct Elevation {
  double level, up;
};

// The elevations of a sweep's rows, with the rows below and above that their steps take.
std::vector<Elevation> elevations_of(const Sweep& sweep, const Rows& rows, int count) {
  std::vector<Elevation> elevations;
  for (int r = -rows.across; r < count + rows.across + rows.sky_to; ++r) {
    const double e = radians(sweep.low_deg + r * sweep.step_deg);
    elevations.push_back({std::cos(e), std::sin(e)});
  }
  return elevations;
}

// Appends the steps of one azimuth, whose luma by row is given. `steps` is scratch.
void append_steps(const std::vector<float>& luma,
                  const Rows& rows,
                  std::vector<float>& steps,
                  Unrolled& unrolled) {
  steps.assign(luma.size(), kNothing);
  for (std::size_t r = static_cast<std::size_t>(rows.across);
       r + static_cast<std::size_t>(rows.across) < luma.size();
       ++r)
    steps[r] = step_at(luma, static_cast<int>(r), rows.across);
  for (int r = rows.across; r < rows.across + unrolled.rows; ++r) {
    unrolled.step.push_back(steps[static_cast<std::size_t>(r)]);
    unrolled.sky.push_back(sky_at(steps, r, rows));
  }
}

}  // namespace

Unrolled unroll(const image::Picture& picture,
                const lens::Lens& lens,
                const image::Mask* own_aircraft,
                const Quaternion& cam_from_level,
                const Sweep& sweep) {
  Unrolled result;
  const Rows rows = rows_of(sweep);
  result.rows =
      static_cast<int>(std::lround((sweep.high_deg - sweep.low_deg) / sweep.step_deg)) + 1;
  const double half_rad = std::min(
      kPi, radians(std::max(lens.horizontal_fov_deg(), lens.vertical_fov_deg())) / 2 * 1.1);
  const std::vector<Elevation> elevations = elevations_of(sweep, rows, result.rows);
  const Vector3 up_in_cam = cam_from_level * Vector3(0, 0, -1);
  std::vector<float> luma(elevations.size()), steps;
  for (int i = 0; i < kColumns; ++i) {
    const double azimuth = half_rad * (2.0 * (i + 0.5) / kColumns - 1);
    const Vector3 level_in_cam = cam_from_level * Vector3(std::cos(azimuth), std::sin(azimuth), 0);
    bool any = false;
    for (std::size_t r = 0; r < luma.size(); ++r) {
      const auto pixel =
          lens.pixel_from_cam(elevations[r].level * level_in_cam + elevations[r].up * up_in_cam);
      luma[r] = pixel ? luma_at(picture, own_aircraft, *pixel) : kNothing;
      any = any || !std::isnan(luma[r]);
    }
    if (!any) continue;
    result.azimuth_rad.push_back(azimuth);
    append_steps(luma, rows, steps, result);
  }
  return result;
}

}  // namespace airtruth::motion
