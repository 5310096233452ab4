// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <variant>
#include <vector>

#include "foundation/geometry/transform.h"

// Lenses map directions in the camera frame (x right, y down, z forward) to pixels and back.
// Conventions: docs/conventions.md. Pixel (0, 0) is the corner of the image; a calibration made
// with OpenCV's integer-centred pixels is moved by half a pixel where it is read
// (calibration_file.h).
//
// Example: 1920 x 1080 with a horizontal view of 60 degrees is a focal length of 960 / tan(30 deg)
// = 1662.8 px; an aircraft 10 m long, side-on and 500 m ahead, spans 33.3 px.
namespace airtruth::lens {

struct ImageSize {
  int width = 0;
  int height = 0;
  bool operator==(const ImageSize&) const = default;
};

// u = fx x/z + cx, v = fy y/z + cy. Valid for z > 0.
struct Pinhole {
  Pixel focal_px{0, 0};
  Pixel principal_point_px{0, 0};
};

// Brown (1966) and Conrady (1919), as OpenCV's calib3d: k1 k2 p1 p2 [k3 [k4 k5 k6]] (rational).
// Valid up to the largest field angle to which the radial curve still rises.
struct BrownConrady {
  Pixel focal_px{0, 0};
  Pixel principal_point_px{0, 0};
  std::vector<double> distortion;  // 4, 5 or 8 numbers, in OpenCV's order
};

// Kannala and Brandt (2006), as OpenCV's fisheye: theta_d = theta (1 + k1 theta^2 + ... + k4
// theta^8). Valid up to the largest angle from the axis to which theta_d still rises, at most 180
// degrees.
struct Fisheye {
  Pixel focal_px{0, 0};
  Pixel principal_point_px{0, 0};
  std::vector<double> distortion;     // 4 numbers (missing ones are 0)
  double stated_max_angle_rad = kPi;  // a calibration may know that its curve ends earlier
};

using Model = std::variant<Pinhole, BrownConrady, Fisheye>;

// A lens with the size of the image it was calibrated for. Immutable; safe to share between
// threads.
class Lens {
 public:
  // Throws Error where the parameters are nonsense (focal length not positive or not finite, wrong
  // number of distortion coefficients, a radial curve that falls from the axis on).
  Lens(Model model, ImageSize size);

  // Empty where the model has no image: behind a pinhole, beyond the valid field, at the origin.
  // Not clipped to the image: pixels outside it are answers too. Continuous over the valid field.
  std::optional<Pixel> pixel_from_cam(const Vector3& p_in_cam) const;

  // Unit vector in cam; empty where no direction of the valid field reaches the pixel. Inverse of
  // pixel_from_cam within 1e-9 rad over the valid field.
  std::optional<Vector3> ray_from_pixel(const Pixel& pixel) const;

  const Model& model() const { return model_; }
  ImageSize size() const { return size_; }
  // The largest angle between a ray and the axis for which the model is valid.
  double max_angle_rad() const { return max_angle_rad_; }
  // Pixels per radian on the axis: the mean of fx and fy.
  double focal_px() const;
  // "pinhole", "brown_conrady" or "fisheye".
  const char* name() const;
  // Full view angles through the principal point along rows and columns, degrees.
  double horizontal_fov_deg() const;
  double vertical_fov_deg() const;

 private:
  Model model_;
  ImageSize size_;
  double max_angle_rad_ = 0;
  double max_radius_ = 0;  // bound on the distorted radius, for a quick "no" outside it
};

// A pinhole with the axis through the image's centre and square pixels. 0 < fov < 180, else Error.
Lens pinhole_from_vertical_fov(double vertical_fov_deg, ImageSize size);

// The equidistant fisheye (all distortion 0) with this vertical view. 0 < fov <= 360, else Error.
Lens fisheye_from_vertical_fov(double vertical_fov_deg, ImageSize size);

}  // namespace airtruth::lens
