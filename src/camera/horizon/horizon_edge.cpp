// SPDX-License-Identifier: Apache-2.0
#include "camera/horizon/horizon_edge.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

namespace airtruth::motion {
namespace {

// The number of azimuths at which the horizon is looked for.
constexpr int kColumns = 180;
// The least number of azimuths at which the line lies in the picture. Chosen by judgement.
constexpr int kMinColumns = 30;
// A step of luma beyond this many code values adds little, so that weak steps all along a line
// outweigh a strong step in one place.
constexpr float kLargestStep = 6;
constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();

struct Sweep {
  double low_deg, high_deg;  // the range of elevations above the guess
  double step_deg;
  double across_deg;     // the height of the band on either side of the line that is averaged
  double most_tilt_deg;  // the largest tilt of a plane against the guess
};
// The first guess lies below the horizon, because haze hides up to a dozen degrees of ground. The
// search therefore reaches higher than it reaches down.
constexpr Sweep kWide{-6, 16, 0.2, 0.6, 6};
constexpr Sweep kNarrow{-1.5, 1.5, 0.04, 0.2, 1};
// One line only, for its sharpness.
constexpr Sweep kLine{0, 0, 0.04, 0.2, 0};
// The band of sky whose slope is subtracted from a step, in degrees above the averaged band. The
// gap between the two leaves out the softness of the edge itself.
constexpr double kSkyFromDeg = 0.3, kSkyToDeg = 1.1;
// The least step of luma across the line, beyond the slope of the sky, in code values.
constexpr float kMinStepCodes = 1;

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

// The step of luma from below to above, by azimuth and elevation, and the step that the slope of
// the sky above makes over the same angle. The latter is 0 where that sky is outside the picture.
struct Unrolled {
  std::vector<double> cos_azimuth, sin_azimuth;
  std::vector<float> step, sky;  // [column][row]
  int rows = 0;
  std::size_t at(std::size_t column, int row) const {
    return column * static_cast<std::size_t>(rows) + static_cast<std::size_t>(row);
  }
};

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

// The mean of the steps in the band of sky above a row; 0 where none of them is in the picture.
float sky_at(const std::vector<float>& step, int row, const Rows& rows) {
  float sum = 0;
  int seen = 0;
  for (int r = row + rows.sky_from; r <= row + rows.sky_to; ++r) {
    const float s = step[static_cast<std::size_t>(r)];
    if (std::isnan(s)) continue;
    sum += s;
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

// The axes of level are x ahead along the optical axis, y right and z down.
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
  const Matrix3 cam_from_level_axes = cam_from_level.toRotationMatrix();
  std::vector<float> luma(static_cast<std::size_t>(result.rows + 2 * rows.across + rows.sky_to));
  std::vector<float> step(luma.size(), kNothing);
  std::vector<Eigen::Vector2d> elevation;  // cosine and sine
  for (std::size_t r = 0; r < luma.size(); ++r) {
    const double e = radians(sweep.low_deg + (static_cast<int>(r) - rows.across) * sweep.step_deg);
    elevation.emplace_back(std::cos(e), std::sin(e));
  }
  const int last_step = static_cast<int>(luma.size()) - rows.across;
  for (int i = 0; i < kColumns; ++i) {
    const double azimuth = half_rad * (2.0 * (i + 0.5) / kColumns - 1);
    const double cosine = std::cos(azimuth), sine = std::sin(azimuth);
    bool any = false;
    for (std::size_t r = 0; r < luma.size(); ++r) {
      const Vector3 direction(
          elevation[r].x() * cosine, elevation[r].x() * sine, -elevation[r].y());
      const auto pixel = lens.pixel_from_cam(cam_from_level_axes * direction);
      luma[r] = pixel ? luma_at(picture, own_aircraft, *pixel) : kNothing;
      any = any || !std::isnan(luma[r]);
    }
    if (!any) continue;
    for (int r = rows.across; r < last_step; ++r)
      step[static_cast<std::size_t>(r)] = step_at(luma, r, rows.across);
    result.cos_azimuth.push_back(cosine);
    result.sin_azimuth.push_back(sine);
    for (int r = rows.across; r < rows.across + result.rows; ++r) {
      result.step.push_back(step[static_cast<std::size_t>(r)]);
      result.sky.push_back(sky_at(step, r, rows));
    }
  }
  return result;
}

struct Line {
  double pitch_deg = 0, roll_deg = 0;  // elevation = pitch cos(azimuth) + roll sin(azimuth)
  float sum = 0;
};

// A step without the share that the slope of the sky explains. The result never has the opposite
// sign, because a strong edge would otherwise produce a second one below itself. The excess over
// kLargestStep has a small weight, which puts the line into the middle of a strong edge.
float edge_of(float step, float sky) {
  constexpr float kShareOfMore = 0.02f;
  if (std::isnan(step)) return kNothing;
  const float size = std::max(0.0f, std::abs(step) - std::abs(sky));
  const float more = std::max(0.0f, size - kLargestStep);
  return std::copysign(size - more + kShareOfMore * more, step);
}

Line best_line(const Unrolled& picture, const Sweep& sweep) {
  Line best;
  std::vector<float> edges;
  for (std::size_t i = 0; i < picture.step.size(); ++i)
    edges.push_back(edge_of(picture.step[i], picture.sky[i]));
  const std::size_t columns = picture.cos_azimuth.size();
  for (double pitch = sweep.low_deg; pitch <= sweep.high_deg; pitch += sweep.step_deg)
    for (double roll = -sweep.most_tilt_deg; roll <= sweep.most_tilt_deg; roll += sweep.step_deg) {
      float sum = 0;
      int seen = 0;
      for (std::size_t i = 0; i < columns; ++i) {
        const double e = pitch * picture.cos_azimuth[i] + roll * picture.sin_azimuth[i];
        const double position = (e - sweep.low_deg) / sweep.step_deg;
        if (position <= -0.5) continue;
        const int row = static_cast<int>(position + 0.5);
        if (row >= picture.rows) continue;
        const float edge = edges[picture.at(i, row)];
        if (std::isnan(edge)) continue;
        sum += edge;
        ++seen;
      }
      if (seen < kMinColumns || std::abs(sum) <= std::abs(best.sum)) continue;
      best = {pitch, roll, sum};
    }
  return best;
}

double sharpness_of(const Unrolled& line) {
  int seen = 0, up = 0, down = 0;
  for (std::size_t i = 0; i < line.cos_azimuth.size(); ++i) {
    if (std::isnan(line.step[i])) continue;
    const float least = std::abs(line.sky[i]) + kMinStepCodes;
    ++seen;
    up += line.step[i] > least ? 1 : 0;
    down += line.step[i] < -least ? 1 : 0;
  }
  return seen < kMinColumns ? 0 : double(std::max(up, down)) / seen;
}

// The level axes whose x axis is the horizontal part of the optical axis. The result is empty where
// the camera looks straight up or down.
std::optional<Quaternion> cam_from_level_axes(const Vector3& up_in_cam) {
  const Vector3 down = -up_in_cam.normalized();
  Vector3 ahead = Vector3::UnitZ() - down * down.z();
  if (ahead.norm() < 0.1) return std::nullopt;
  ahead.normalize();
  Matrix3 axes;
  axes << ahead, down.cross(ahead), down;
  return Quaternion(axes);
}

Vector3 swept(const image::Picture& picture,
              const lens::Lens& lens,
              const image::Mask* own_aircraft,
              const Vector3& up_in_cam,
              const Sweep& sweep) {
  const auto cam_from_level = cam_from_level_axes(up_in_cam);
  if (!cam_from_level) return up_in_cam;
  const Line line = best_line(unroll(picture, lens, own_aircraft, *cam_from_level, sweep), sweep);
  // The elevation of this plane is pitch cos(azimuth) + roll sin(azimuth).
  const Vector3 up =
      Vector3(-std::tan(radians(line.pitch_deg)), -std::tan(radians(line.roll_deg)), -1);
  return *cam_from_level * up.normalized();
}

HorizonEdge weighed(const image::Picture& picture,
                    const lens::Lens& lens,
                    const image::Mask* own_aircraft,
                    const Vector3& up_in_cam) {
  const auto cam_from_level = cam_from_level_axes(up_in_cam);
  if (!cam_from_level) return {up_in_cam, 0};
  return {up_in_cam, sharpness_of(unroll(picture, lens, own_aircraft, *cam_from_level, kLine))};
}

}  // namespace

HorizonEdge horizon_edge(const image::Picture& picture,
                         const lens::Lens& lens,
                         const image::Mask* own_aircraft,
                         const Vector3& guess_up_in_cam) {
  const Vector3 up = swept(picture, lens, own_aircraft, guess_up_in_cam, kWide);
  return horizon_edge_beside(picture, lens, own_aircraft, up);
}

HorizonEdge horizon_edge_beside(const image::Picture& picture,
                                const lens::Lens& lens,
                                const image::Mask* own_aircraft,
                                const Vector3& guess_up_in_cam) {
  return weighed(
      picture, lens, own_aircraft, swept(picture, lens, own_aircraft, guess_up_in_cam, kNarrow));
}

}  // namespace airtruth::motion
