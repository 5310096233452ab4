// SPDX-License-Identifier: Apache-2.0
#include "calibration/readout.h"

#include <algorithm>
#include <cmath>

namespace airtruth::calibration {
namespace {

struct Step {
  Pixel moved;     // of the centre
  double shear;    // what a turn does not explain
  double stretch;  // what a zoom does not explain
};

std::optional<Step> step_of(const std::optional<Homography>& h, const Pixel& centre) {
  if (!h) return std::nullopt;
  const double d = centre.norm() / 8;
  const Pixel middle = apply(*h, centre);
  const Pixel right = (apply(*h, centre + Pixel(d, 0)) - apply(*h, centre - Pixel(d, 0))) / (2 * d);
  const Pixel down = (apply(*h, centre + Pixel(0, d)) - apply(*h, centre - Pixel(0, d))) / (2 * d);
  return Step{middle - centre, down.x() + right.y(), down.y() - right.x()};
}

}  // namespace

std::optional<Estimate> readout_share(const std::vector<std::optional<Homography>>& steps,
                                      int width,
                                      int height,
                                      std::string& why) {
  const Pixel centre(width / 2.0, height / 2.0);
  std::vector<std::pair<double, double>> pairs;  // change of speed over height, shear or stretch
  for (std::size_t k = 1; k + 1 < steps.size(); ++k) {
    const auto before = step_of(steps[k - 1], centre);
    const auto here = step_of(steps[k], centre);
    const auto after = step_of(steps[k + 1], centre);
    if (!before || !here || !after) continue;
    const Pixel change = (after->moved - before->moved) / 2 / height;
    pairs.push_back({change.x(), here->shear});
    pairs.push_back({change.y(), here->stretch});
  }
  if (pairs.size() < 60) {
    why = "the motion of too few frames is known";
    return std::nullopt;
  }
  // Robust line through the origin: least squares, weights of Geman and McClure.
  double slope = 0, error = 0, scale = 1e9;
  for (int round = 0; round < 12; ++round) {
    double sxx = 0, sxy = 0, rest = 0, n = 0;
    std::vector<double> off;
    for (const auto& [x, y] : pairs) {
      const double e = (y - slope * x) / scale;
      const double w = 1 / ((1 + e * e) * (1 + e * e));
      sxx += w * x * x, sxy += w * x * y;
      rest += w * (y - slope * x) * (y - slope * x), n += w;
      off.push_back(std::abs(y - slope * x));
    }
    if (!(sxx > 0)) break;
    slope = sxy / sxx;
    error = std::sqrt(rest / n / sxx);
    std::nth_element(
        off.begin(), off.begin() + static_cast<std::ptrdiff_t>(off.size() / 2), off.end());
    scale = std::max(3 * off[off.size() / 2], 1e-6);
  }
  if (!(error > 0) || error > 0.15) {
    why = "the picture's speed changes too little from frame to frame";
    return std::nullopt;
  }
  if (std::abs(slope) > 1.2) {
    why = "the picture's shear follows its speed by more than a whole frame would";
    return std::nullopt;
  }
  return Estimate{slope, error};
}

}  // namespace airtruth::calibration
