// SPDX-License-Identifier: Apache-2.0
#include "camera/lens/lens.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "camera/lens/models.h"
#include "foundation/base/error.h"

namespace airtruth::lens {
namespace {

std::string number(double x) { return fmt::format("{:g}", x); }

bool finite(const Pixel& p) { return std::isfinite(p.x()) && std::isfinite(p.y()); }

void validate(const Pixel& focal_px, const Pixel& centre_px, ImageSize size) {
  if (size.width <= 0 || size.height <= 0) throw Error("the lens has no image size");
  if (!finite(focal_px) || focal_px.x() <= 0 || focal_px.y() <= 0)
    throw Error("focal_px is [" + number(focal_px.x()) + ", " + number(focal_px.y()) +
                "]; expected two positive numbers");
  if (!finite(centre_px)) throw Error("principal_point_px is not finite; expected two numbers");
}

void validate_distortion(const std::vector<double>& distortion,
                         bool allowed,
                         const char* expected) {
  if (!allowed)
    throw Error("distortion has " + std::to_string(distortion.size()) + " numbers; expected " +
                expected);
  for (double k : distortion)
    if (!std::isfinite(k)) throw Error("distortion holds a number that is not finite");
}

template <typename AModel>
Field checked_field(const AModel& lens) {
  const Field field = field_of(lens);
  if (!(field.max_angle_rad >= radians(0.5)))
    throw Error("distortion makes the radial curve fall from the axis on; expected one that rises");
  return field;
}

struct Validate {
  ImageSize size;
  Field operator()(const Pinhole& lens) const {
    validate(lens.focal_px, lens.principal_point_px, size);
    return field_of(lens);
  }
  Field operator()(const BrownConrady& lens) const {
    validate(lens.focal_px, lens.principal_point_px, size);
    const std::size_t n = lens.distortion.size();
    validate_distortion(lens.distortion, n == 4 || n == 5 || n == 8, "4, 5 or 8");
    return checked_field(lens);
  }
  Field operator()(const Fisheye& lens) const {
    validate(lens.focal_px, lens.principal_point_px, size);
    validate_distortion(lens.distortion, lens.distortion.size() == 4, "4");
    return checked_field(lens);
  }
};

void check_fov(double fov_deg, double limit_deg, const char* model, bool limit_allowed) {
  if (!(fov_deg > 0) || fov_deg > limit_deg || (fov_deg == limit_deg && !limit_allowed))
    throw Error("vertical_fov_deg is " + number(fov_deg) + "; expected above 0 and " +
                (limit_allowed ? "at most " : "below ") + number(limit_deg) + " for a " + model);
}

double angle_between_pixels(const Lens& lens, const Pixel& a, const Pixel& b, const Pixel& centre) {
  const auto angle_to = [&](const Pixel& p) {
    const auto ray = lens.ray_from_pixel(p);
    const auto axis = lens.ray_from_pixel(centre);
    return ray && axis ? std::acos(std::clamp(ray->dot(*axis), -1.0, 1.0)) : lens.max_angle_rad();
  };
  return degrees(angle_to(a) + angle_to(b));
}

}  // namespace

Lens::Lens(Model model, ImageSize size) : model_(std::move(model)), size_(size) {
  if (auto* fisheye = std::get_if<Fisheye>(&model_);
      fisheye != nullptr && fisheye->distortion.size() < 4)
    fisheye->distortion.resize(4, 0.0);
  const Field field = std::visit(Validate{size}, model_);
  max_angle_rad_ = field.max_angle_rad;
  max_radius_ = field.max_radius;
}

std::optional<Pixel> Lens::pixel_from_cam(const Vector3& p_in_cam) const {
  const Field field{max_angle_rad_, max_radius_};
  return std::visit([&](const auto& lens) { return project(lens, p_in_cam, field); }, model_);
}

std::optional<Vector3> Lens::ray_from_pixel(const Pixel& pixel) const {
  if (!finite(pixel)) return std::nullopt;
  const Field field{max_angle_rad_, max_radius_};
  return std::visit([&](const auto& lens) { return unproject(lens, pixel, field); }, model_);
}

double Lens::focal_px() const {
  return std::visit([](const auto& lens) { return 0.5 * (lens.focal_px.x() + lens.focal_px.y()); },
                    model_);
}

const char* Lens::name() const { return enum_name(static_cast<ModelKind>(model_.index())); }

double Lens::horizontal_fov_deg() const {
  const Pixel c = numbers_of(*this).principal_point_px;
  return angle_between_pixels(*this, {0, c.y()}, {double(size_.width), c.y()}, c);
}

double Lens::vertical_fov_deg() const {
  const Pixel c = numbers_of(*this).principal_point_px;
  return angle_between_pixels(*this, {c.x(), 0}, {c.x(), double(size_.height)}, c);
}

Numbers numbers_of(const Lens& lens) {
  return std::visit(
      [](const auto& model) {
        Numbers numbers{model.focal_px, model.principal_point_px, {}};
        if constexpr (requires { model.distortion; }) numbers.distortion = model.distortion;
        return numbers;
      },
      lens.model());
}

Lens undistorted(bool fisheye, double focal_px, ImageSize size) {
  const Pixel focal(focal_px, focal_px);
  const Pixel centre(size.width / 2.0, size.height / 2.0);
  if (fisheye) return Lens(Fisheye{focal, centre, {0, 0, 0, 0}}, size);
  return Lens(Pinhole{focal, centre}, size);
}

Lens pinhole_from_vertical_fov(double vertical_fov_deg, ImageSize size) {
  check_fov(vertical_fov_deg, 180, "pinhole", false);
  return undistorted(false, 0.5 * size.height / std::tan(radians(vertical_fov_deg) / 2), size);
}

Lens fisheye_from_vertical_fov(double vertical_fov_deg, ImageSize size) {
  check_fov(vertical_fov_deg, 360, "fisheye", true);
  return undistorted(true, 0.5 * size.height / (radians(vertical_fov_deg) / 2), size);
}

}  // namespace airtruth::lens
