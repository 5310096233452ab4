// SPDX-License-Identifier: Apache-2.0
#include "camera/lens/lens.h"

#include <airtruth/lens.h>

#include "camera/lens/calibration_file.h"
#include "library/records/public_forms.h"

namespace airtruth {

Lens public_lens(const lens::Lens& lens) {
  return Lens(std::make_shared<const Lens::State>(Lens::State{lens}));
}

Lens::Lens(std::shared_ptr<const State> state) : state_(std::move(state)) {}

Lens Lens::pinhole(const std::array<double, 2>& focal_px,
                   const std::array<double, 2>& principal_point_px,
                   int width,
                   int height) {
  return public_lens(lens::lens_of({"pinhole", focal_px, principal_point_px, {}, width, height}));
}

Lens Lens::pinhole_from_vertical_fov(double vertical_fov_deg, int width, int height) {
  return public_lens(lens::pinhole_from_vertical_fov(vertical_fov_deg, {width, height}));
}

Lens Lens::brown_conrady(const std::array<double, 2>& focal_px,
                         const std::array<double, 2>& principal_point_px,
                         const std::vector<double>& distortion,
                         int width,
                         int height) {
  return public_lens(
      lens::lens_of({"brown_conrady", focal_px, principal_point_px, distortion, width, height}));
}

Lens Lens::fisheye(const std::array<double, 2>& focal_px,
                   const std::array<double, 2>& principal_point_px,
                   const std::vector<double>& distortion,
                   int width,
                   int height,
                   double max_angle_rad) {
  return public_lens(lens::lens_of(
      {"fisheye", focal_px, principal_point_px, distortion, width, height, max_angle_rad}));
}

Lens Lens::from_file(const std::filesystem::path& calibration, int width, int height) {
  return public_lens(lens::read_calibration(calibration, {width, height}));
}

std::optional<std::array<double, 2>> Lens::pixel_from_cam(
    const std::array<double, 3>& p_in_cam_m) const {
  const auto pixel = state_->lens.pixel_from_cam(vector_of(p_in_cam_m));
  if (!pixel) return std::nullopt;
  return std::array<double, 2>{pixel->x(), pixel->y()};
}

std::optional<std::array<double, 3>> Lens::ray_from_pixel(
    const std::array<double, 2>& pixel) const {
  const auto ray = state_->lens.ray_from_pixel(pixel_of(pixel));
  return ray ? std::optional(numbers_of(*ray)) : std::nullopt;
}

int Lens::width() const { return state_->lens.size().width; }
int Lens::height() const { return state_->lens.size().height; }
std::string Lens::model() const { return state_->lens.name(); }

std::array<double, 2> Lens::focal_px() const { return lens::facts_of(state_->lens).focal_px; }
std::array<double, 2> Lens::principal_point_px() const {
  return lens::facts_of(state_->lens).principal_point_px;
}
std::vector<double> Lens::distortion() const { return lens::facts_of(state_->lens).distortion; }

double Lens::max_angle_rad() const { return state_->lens.max_angle_rad(); }
double Lens::horizontal_fov_deg() const { return state_->lens.horizontal_fov_deg(); }
double Lens::vertical_fov_deg() const { return state_->lens.vertical_fov_deg(); }

}  // namespace airtruth
