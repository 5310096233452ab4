// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "foundation/base/names.h"
#include "foundation/geometry/transform.h"

// A lens maps points in the camera frame (x right, y down, z forward; metres) to pixels, and pixels
// to rays. docs/conventions.md defines the frames. Pixel (0, 0) is the top-left corner of the
// image. A calibration with OpenCV's integer-centred pixels is shifted by half a pixel when it is
// read (calibration_file.h).
//
// Example: a pinhole camera of 1920 x 1080 pixels with a horizontal field of view of 60 degrees has
// a focal length of 960 / tan(30 deg) = 1662.8 px.
//   const Lens lens(Pinhole{{1662.8, 1662.8}, {960, 540}}, {1920, 1080});
//   lens.pixel_from_cam({0, 0, 500})   -> (960, 540)     a point 500 m straight ahead
//   lens.pixel_from_cam({10, 0, 500})  -> (993.3, 540)   a point 10 m to the right of it
//   lens.pixel_from_cam({0, 0, -500})  -> empty          a point behind the camera
// An aircraft 10 m long that is seen side-on at 500 m therefore spans 33.3 px.
namespace airtruth::lens {

struct ImageSize {
  int width = 0;
  int height = 0;
  // True where the position lies in the picture.
  bool holds(const Pixel& p) const {
    return p.x() >= 0 && p.y() >= 0 && p.x() < width && p.y() < height;
  }
  bool operator==(const ImageSize&) const = default;
};

// The pinhole model: u = fx x/z + cx, v = fy y/z + cy. It is valid for z > 0.
struct Pinhole {
  Pixel focal_px{0, 0};
  Pixel principal_point_px{0, 0};
};

// The radial and tangential model of Brown (1966) and Conrady (1919) with the coefficients of
// OpenCV's calib3d: k1 k2 p1 p2 [k3 [k4 k5 k6]]. Eight coefficients form the rational model. The
// model is valid up to the largest field angle at which the radial curve still rises.
struct BrownConrady {
  Pixel focal_px{0, 0};
  Pixel principal_point_px{0, 0};
  // 4, 5 or 8 coefficients in OpenCV's order.
  std::vector<double> distortion;
};

// The fisheye model of Kannala and Brandt (2006) with the coefficients of OpenCV's fisheye module:
// theta_d = theta (1 + k1 theta^2 + ... + k4 theta^8), theta in radians from the axis. The model is
// valid up to the largest angle at which theta_d still rises, at most 180 degrees.
struct Fisheye {
  Pixel focal_px{0, 0};
  Pixel principal_point_px{0, 0};
  // k1 to k4; missing coefficients are 0.
  std::vector<double> distortion;
  // The angle at which the calibration states that its curve ends. A Lens has kPi here where the
  // curve stops rising no later.
  double stated_max_angle_rad = kPi;
};

using Model = std::variant<Pinhole, BrownConrady, Fisheye>;

// The models in the order of Model. Scenes and truth.jsonl use these names.
enum class ModelKind { kPinhole, kBrownConrady, kFisheye };

constexpr auto enum_names(ModelKind) {
  return std::to_array<EnumName<ModelKind>>({{ModelKind::kPinhole, "pinhole"},
                                             {ModelKind::kBrownConrady, "brown_conrady"},
                                             {ModelKind::kFisheye, "fisheye"}});
}

// The valid field of a model: the largest angle from the axis, and an upper bound on the distorted
// radius (distance from the principal point in pixels over the focal length) of any ray within that
// angle.
struct Field {
  double max_angle_rad = 0;
  double max_radius = 0;
};

// A lens with the size of the image for which it was calibrated. A Lens is immutable, and threads
// may share it.
class Lens {
 public:
  // Throws Error for a focal length that is not positive or not finite, a wrong number of
  // distortion coefficients, or a radial curve that falls from the axis on.
  Lens(Model model, ImageSize size);

  // The pixel that shows a point. It is empty where the model has no image: behind a pinhole,
  // beyond the valid field, and at the origin. The result is not clipped: it may lie outside the
  // image. It is continuous over the valid field.
  std::optional<Pixel> pixel_from_cam(const Vector3& p_in_cam) const;

  // The ray of a pixel as a unit vector in cam. It is empty where no direction of the valid field
  // reaches the pixel. The function inverts pixel_from_cam within 1e-9 rad over the valid field.
  std::optional<Vector3> ray_from_pixel(const Pixel& pixel) const;

  const Model& model() const { return model_; }
  ImageSize size() const { return size_; }
  // The largest angle between a ray and the axis for which the model is valid.
  double max_angle_rad() const { return field_.max_angle_rad; }
  // Pixels per radian on the axis: the mean of fx and fy.
  double focal_px() const;
  // That of its ModelKind.
  const char* name() const;
  // The full field of view through the principal point along rows and along columns, in degrees.
  double horizontal_fov_deg() const;
  double vertical_fov_deg() const;

 private:
  Model model_;
  ImageSize size_;
  Field field_;
};

// A lens as files state it: lens_of(facts_of(lens)) maps each ray to the same pixel as the lens
// does.
struct Facts {
  std::string model;  // the name of a ModelKind
  std::array<double, 2> focal_px{};
  std::array<double, 2> principal_point_px{};
  // A pinhole's is empty.
  std::vector<double> distortion;
  int width = 0;
  int height = 0;
  // Of a fisheye whose calibration ends before its curve; else kPi.
  double max_angle_rad = kPi;
};
Facts facts_of(const Lens& lens);
Lens lens_of(const Facts& facts);

// A pinhole, or an equidistant fisheye (all distortion coefficients are 0), whose axis passes
// through the centre of the image. The focal length counts heights of pixels, of which each is
// `width_of_height` wide.
Lens undistorted(bool fisheye, double focal_px, ImageSize size, double width_of_height = 1);

// The undistorted pinhole with this vertical field of view. Throws Error unless 0 < fov < 180
// degrees.
Lens pinhole_from_vertical_fov(double vertical_fov_deg, ImageSize size, double width_of_height = 1);

// The undistorted fisheye with this vertical field of view. Throws Error unless 0 < fov <= 360
// degrees.
Lens fisheye_from_vertical_fov(double vertical_fov_deg, ImageSize size);

}  // namespace airtruth::lens
