// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <airtruth/export.h>

namespace airtruth {

// A lens maps points in the camera frame (x right, y down, z forward; metres) to pixels, and pixels
// to rays. Pixel (0, 0) is the top-left corner of the image, and the centre of the first pixel is
// (0.5, 0.5): OpenCV's pixel coordinates are smaller by 0.5. A Lens is immutable; copies share
// their content, and threads may share a Lens.
//
// Example: a pinhole camera of 1920 x 1080 pixels with a horizontal field of view of 60 degrees has
// a focal length of 960 / tan(30 deg) = 1662.8 px.
//   const Lens lens = Lens::pinhole({1662.8, 1662.8}, {960, 540}, 1920, 1080);
//   lens.pixel_from_cam({0, 0, 500})   -> (960, 540)     a point 500 m straight ahead
//   lens.pixel_from_cam({10, 0, 500})  -> (993.3, 540)   a point 10 m to the right of it
//   lens.pixel_from_cam({0, 0, -500})  -> empty          a point behind the camera
class AIRTRUTH_API Lens {
 public:
  // All of these throw Error for a focal length that is not positive and finite.
  //
  // u = fx x/z + cx, v = fy y/z + cy; valid for z > 0.
  static Lens pinhole(const std::array<double, 2>& focal_px,
                      const std::array<double, 2>& principal_point_px,
                      int width,
                      int height);
  // Square pixels, with the axis through the centre of the image; 0 < field of view < 180 degrees.
  static Lens pinhole_from_vertical_fov(double vertical_fov_deg, int width, int height);
  // The radial and tangential model of Brown (1966) and Conrady (1919) with 4, 5 or 8 coefficients
  // in OpenCV's order: k1 k2 p1 p2 [k3 [k4 k5 k6]]. Throws Error for another number of them.
  static Lens brown_conrady(const std::array<double, 2>& focal_px,
                            const std::array<double, 2>& principal_point_px,
                            const std::vector<double>& distortion,
                            int width,
                            int height);
  // The model of Kannala and Brandt (2006), as OpenCV's fisheye module has it:
  // theta_d = theta (1 + k1 theta^2 + ... + k4 theta^8). At most 4 coefficients. It is valid up to
  // max_angle_rad from the axis, or to where theta_d stops rising.
  static Lens fisheye(const std::array<double, 2>& focal_px,
                      const std::array<double, 2>& principal_point_px,
                      const std::vector<double>& distortion,
                      int width,
                      int height,
                      double max_angle_rad = std::numbers::pi);
  // A calibration file (docs/lenses.md), scaled to this size of the image. Throws Error with file
  // and line.
  static Lens from_file(const std::filesystem::path& calibration, int width, int height);

  // The pixel that shows a point. Empty where the model has no image: behind a pinhole, beyond the
  // valid field, and at the origin. The result may lie outside the image.
  std::optional<std::array<double, 2>> pixel_from_cam(
      const std::array<double, 3>& p_in_cam_m) const;

  // The ray of a pixel as a unit vector in the camera frame. Empty where no direction of the valid
  // field reaches the pixel. Inverts pixel_from_cam() within 1e-9 rad.
  std::optional<std::array<double, 3>> ray_from_pixel(const std::array<double, 2>& pixel) const;

  int width() const;
  int height() const;
  // "pinhole", "brown_conrady" or "fisheye".
  std::string model() const;
  std::array<double, 2> focal_px() const;
  std::array<double, 2> principal_point_px() const;
  std::vector<double> distortion() const;
  // The largest angle from the axis for which the model is valid.
  double max_angle_rad() const;
  // The full field of view through the principal point, in degrees.
  double horizontal_fov_deg() const;
  double vertical_fov_deg() const;

  // For the library's own use.
  struct State;
  explicit Lens(std::shared_ptr<const State> state);
  const State& state() const { return *state_; }

 private:
  std::shared_ptr<const State> state_;
};

}  // namespace airtruth
