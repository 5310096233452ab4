// SPDX-License-Identifier: Apache-2.0
#include "camera/horizon/horizon_edge.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "foundation/image/colour.h"

namespace airtruth::horizon {
namespace {

// The planes near the guess among which a horizon is sought.
struct Sweep {
  double low_deg, high_deg;  // the range of elevations above the guess
  double step_deg;
  double across_deg;     // the height of the band on either side of the line that is averaged
  double most_tilt_deg;  // the largest tilt of a plane against the guess
};

// The step of luma from below to above, by azimuth and elevation, and the step that the slope of
// the sky above makes over the same angle. The latter is 0 where that sky is outside the picture.
struct Unrolled {
  std::vector<double> azimuth_rad;
  std::vector<float> step, sky;  // [column][row]
  int rows = 0;
  std::size_t at(std::size_t column, int row) const {
    return column * static_cast<std::size_t>(rows) + static_cast<std::size_t>(row);
  }
};

// The number of azimuths at which the horizon is looked for, over 1.1 times the larger field of
// view: one in 0.6 degrees for 90. Chosen by judgement; twice as many take twice as long.
constexpr int kColumns = 180;
// The band of sky whose slope is subtracted from a step, in degrees above the averaged band. The
// gap between the two leaves out the softness of the edge itself.
constexpr double kSkyFromDeg = 0.3, kSkyToDeg = 1.1;
// The luma of what is not seen.
constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();

// Bilinear interpolation; NaN outside the picture and on the own aircraft.
float luma_at(const Sight& sight, const Pixel& p) {
  const image::Picture& picture = sight.picture;
  const double x = p.x() - 0.5;
  const double y = p.y() - 0.5;
  const int ix = static_cast<int>(std::floor(x));
  const int iy = static_cast<int>(std::floor(y));
  if (ix < 0 || iy < 0 || ix + 1 >= picture.width || iy + 1 >= picture.height) return kNothing;
  if (sight.own_aircraft != nullptr && !sight.own_aircraft->is_free(ix, iy)) return kNothing;
  const auto fx = static_cast<float>(x - ix);
  const auto fy = static_cast<float>(y - iy);
  const auto along = [&](int row) {
    return static_cast<float>(image::luma_at(picture, ix, row)) * (1 - fx) +
           static_cast<float>(image::luma_at(picture, ix + 1, row)) * fx;
  };
  return along(iy) * (1 - fy) + along(iy + 1) * fy;
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

// Resamples a picture. The axes of level are x ahead along the optical axis, y right and z down.
// Azimuths at which nothing is seen are left out.
Unrolled unroll(const Sight& sight, const Quaternion& cam_from_level, const Sweep& sweep) {
  Unrolled result;
  const lens::Lens& lens = sight.lens;
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
      luma[r] = pixel ? luma_at(sight, *pixel) : kNothing;
      any = any || !std::isnan(luma[r]);
    }
    if (!any) continue;
    result.azimuth_rad.push_back(azimuth);
    append_steps(luma, rows, steps, result);
  }
  return result;
}

// The least number of azimuths at which the line lies in the picture. Chosen by judgement.
constexpr int kMinColumns = 30;
// A step of luma beyond this many code values adds little, so that weak steps all along a line
// outweigh a strong step in one place.
constexpr float kLargestStep = 6;

// It reaches higher than down, because haze hides up to a dozen degrees of ground.
constexpr Sweep kWide{-6, 16, 0.2, 0.6, 6};
constexpr Sweep kNarrow{-1.5, 1.5, 0.04, 0.2, 1};
// One line only, for its sharpness.
constexpr Sweep kLine{0, 0, 0.04, 0.2, 0};
// The least step of luma across the line, beyond the slope of the sky, in code values.
constexpr float kMinStepCodes = 1;

struct Line {
  double pitch_deg = 0, roll_deg = 0;  // elevation = pitch cos(azimuth) + roll sin(azimuth)
  float sum = 0;
};

// The edges along a line, or a single one: their sum, and the number of those that are seen.
struct EdgeSum {
  float sum = 0, seen = 0;
};

// A step without the share that the slope of the sky explains. The result never has the opposite
// sign, because a strong edge would otherwise produce a second one below itself. The excess over
// kLargestStep has a small weight, which puts the line into the middle of a strong edge. A step
// that is not seen (NaN) is no edge.
EdgeSum edge_of(float step, float sky) {
  // Chosen: larger than nothing, and small beside kLargestStep for every step up to 255 codes.
  constexpr float kShareOfMore = 0.02f;
  if (std::isnan(step)) return {};
  const float size = std::max(0.0f, std::abs(step) - std::abs(sky));
  const float more = std::max(0.0f, size - kLargestStep);
  return {std::copysign(size - more + kShareOfMore * more, step), 1};
}

// The edges by azimuth and elevation, with an empty row below and above for lines that leave the
// range of elevations.
class Edges {
 public:
  Edges(const Unrolled& picture, const Sweep& sweep) : rows_(picture.rows + 2) {
    for (std::size_t i = 0; i < picture.azimuth_rad.size(); ++i) {
      const double azimuth = picture.azimuth_rad[i];
      columns_.push_back({std::cos(azimuth) / sweep.step_deg, std::sin(azimuth) / sweep.step_deg});
      edges_.emplace_back();
      for (int row = 0; row < picture.rows; ++row) {
        const std::size_t at = picture.at(i, row);
        edges_.push_back(edge_of(picture.step[at], picture.sky[at]));
      }
      edges_.emplace_back();
    }
    // Rounds to the nearest row; the first row is the empty one.
    first_row_ = 1.5 - sweep.low_deg / sweep.step_deg;
  }

  // Adds the edges along each line of this pitch to the sums of its roll.
  void add_along(double pitch_deg,
                 const std::vector<double>& rolls_deg,
                 std::vector<EdgeSum>& sums) const {
    const double last_row = rows_ - 1;
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      const EdgeSum* edges = edges_.data() + i * static_cast<std::size_t>(rows_);
      const double row_without_roll = pitch_deg * columns_[i].cosine + first_row_;
      for (std::size_t j = 0; j < rolls_deg.size(); ++j) {
        const double row = row_without_roll + rolls_deg[j] * columns_[i].sine;
        const EdgeSum& here = edges[static_cast<int>(std::min(std::max(row, 0.0), last_row))];
        sums[j].sum += here.sum, sums[j].seen += here.seen;
      }
    }
  }

 private:
  // Rows per degree of pitch and of roll.
  struct Column {
    double cosine, sine;
  };
  int rows_;
  double first_row_ = 0;
  std::vector<Column> columns_;
  std::vector<EdgeSum> edges_;  // [column][row]
};

Line best_line(const Unrolled& picture, const Sweep& sweep) {
  Line best;
  const Edges edges(picture, sweep);
  std::vector<double> rolls_deg;
  for (double roll = -sweep.most_tilt_deg; roll <= sweep.most_tilt_deg; roll += sweep.step_deg)
    rolls_deg.push_back(roll);
  std::vector<EdgeSum> sums;
  for (double pitch = sweep.low_deg; pitch <= sweep.high_deg; pitch += sweep.step_deg) {
    sums.assign(rolls_deg.size(), {});
    edges.add_along(pitch, rolls_deg, sums);
    for (std::size_t j = 0; j < rolls_deg.size(); ++j)
      if (sums[j].seen >= kMinColumns && std::abs(sums[j].sum) > std::abs(best.sum))
        best = {pitch, rolls_deg[j], sums[j].sum};
  }
  return best;
}

double sharpness_of(const Unrolled& line) {
  int seen = 0, up = 0, down = 0;
  for (std::size_t i = 0; i < line.azimuth_rad.size(); ++i) {
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

Vector3 swept(const Sight& sight, const Vector3& up_in_cam, const Sweep& sweep) {
  const auto cam_from_level = cam_from_level_axes(up_in_cam);
  if (!cam_from_level) return up_in_cam;
  const Line line = best_line(unroll(sight, *cam_from_level, sweep), sweep);
  // The elevation of this plane is pitch cos(azimuth) + roll sin(azimuth).
  const Vector3 up =
      Vector3(-std::tan(radians(line.pitch_deg)), -std::tan(radians(line.roll_deg)), -1);
  return *cam_from_level * up.normalized();
}

}  // namespace

HorizonEdge horizon_edge(const Sight& sight, const Vector3& guess_up_in_cam) {
  return horizon_edge_beside(sight, swept(sight, guess_up_in_cam, kWide));
}

HorizonEdge horizon_edge_beside(const Sight& sight, const Vector3& guess_up_in_cam) {
  const Vector3 up = swept(sight, guess_up_in_cam, kNarrow);
  const auto cam_from_level = cam_from_level_axes(up);
  return {up, cam_from_level ? sharpness_of(unroll(sight, *cam_from_level, kLine)) : 0};
}

}  // namespace airtruth::horizon
