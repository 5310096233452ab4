// SPDX-License-Identifier: Apache-2.0
#include "camera/horizon/horizon_edge.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "camera/horizon/unrolled.h"

namespace airtruth::motion {
namespace {

// The least number of azimuths at which the line lies in the picture. Chosen by judgement.
constexpr int kMinColumns = 30;
// A step of luma beyond this many code values adds little, so that weak steps all along a line
// outweigh a strong step in one place.
constexpr float kLargestStep = 6;

// The first guess lies below the horizon, because haze hides up to a dozen degrees of ground. The
// search therefore reaches higher than it reaches down.
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
