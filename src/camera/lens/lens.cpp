// SPDX-License-Identifier: Apache-2.0
#include "camera/lens/lens.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "foundation/base/error.h"

namespace airtruth::lens {
namespace {

// The arithmetic of the three lens models.

// The least slope, per radian, of a curve that still rises. At a lower slope an angle cannot be
// recovered from its pixel within 1e-9 rad in double precision.
constexpr double kFlat = 1e-4;

// The largest angle up to `limit_rad` before the first at which `ends` is true. That one is looked
// for in equal steps, and then by bisection.
template <typename Ends>
double last_before(double limit_rad, int steps, int halvings, const Ends& ends) {
  for (int i = 1; i <= steps; ++i) {
    if (!ends(limit_rad * i / steps)) continue;
    double low = limit_rad * (i - 1) / steps;
    double high = limit_rad * i / steps;
    for (int n = 0; n < halvings; ++n) {
      const double middle = 0.5 * (low + high);
      (ends(middle) ? high : low) = middle;
    }
    return low;
  }
  return limit_rad;
}

Field field_of(const Pinhole&) { return {kPi / 2, std::numeric_limits<double>::infinity()}; }

std::optional<Pixel> project(const Pinhole& lens, const Vector3& p, const Field&) {
  if (!(p.z() > 0)) return std::nullopt;
  const Pixel pixel(lens.focal_px.x() * p.x() / p.z() + lens.principal_point_px.x(),
                    lens.focal_px.y() * p.y() / p.z() + lens.principal_point_px.y());
  if (!pixel.allFinite()) return std::nullopt;
  return pixel;
}

std::optional<Vector3> unproject(const Pinhole& lens, const Pixel& pixel, const Field&) {
  const Pixel n = (pixel - lens.principal_point_px).cwiseQuotient(lens.focal_px);
  return Vector3(n.x(), n.y(), 1).normalized();
}

using Coefficients = std::array<double, 8>;  // OpenCV's order: k1 k2 p1 p2 k3 k4 k5 k6

Coefficients coefficients(const BrownConrady& lens) {
  Coefficients k{};
  std::copy_n(lens.distortion.begin(), std::min<std::size_t>(lens.distortion.size(), 8), k.begin());
  return k;
}

// The distorted point of an undistorted point (x/z, y/z) and the derivative of the map there. The
// derivative is symmetric, because the map is a gradient.
struct Distorted {
  Pixel value;
  double xx, xy, yy;
  double denominator;

  double least_stretch() const {
    return 0.5 * (xx + yy - std::sqrt((xx - yy) * (xx - yy) + 4 * xy * xy));
  }
  Pixel solve(const Pixel& right) const {
    const double d = xx * yy - xy * xy;
    return {(yy * right.x() - xy * right.y()) / d, (xx * right.y() - xy * right.x()) / d};
  }
};

Distorted distort(const Coefficients& k, const Pixel& n) {
  const double x = n.x();
  const double y = n.y();
  const double r2 = x * x + y * y;
  const double up = 1 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
  const double down = 1 + r2 * (k[5] + r2 * (k[6] + r2 * k[7]));
  const double up_slope = k[0] + r2 * (2 * k[1] + r2 * 3 * k[4]);
  const double down_slope = k[5] + r2 * (2 * k[6] + r2 * 3 * k[7]);
  const double radial = up / down;
  const double bend = 2 * (up_slope - radial * down_slope) / down;  // twice d radial / d r2
  return {{x * radial + 2 * k[2] * x * y + k[3] * (r2 + 2 * x * x),
           y * radial + k[2] * (r2 + 2 * y * y) + 2 * k[3] * x * y},
          radial + x * x * bend + 2 * k[2] * y + 6 * k[3] * x,
          x * y * bend + 2 * k[2] * x + 2 * k[3] * y,
          radial + y * y * bend + 6 * k[2] * y + 2 * k[3] * x,
          down};
}

Coefficients radial_part(const Coefficients& k) {
  return {k[0], k[1], 0, 0, k[4], k[5], k[6], k[7]};
}

// The directions from the axis in which the map is looked at: every 11 degrees. Between them the
// map changes by the tangential terms alone, which vary as the cosine of the direction.
constexpr int kDirections = 32;

Pixel in_direction(int i, double radius) {
  const double angle = 2 * kPi * i / kDirections;
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

// The tangential terms make the curve depend on the direction: the valid field ends where the map
// folds in any direction.
bool folds(const Coefficients& k, double angle_rad) {
  const double radius = std::tan(angle_rad);
  const double flat = kFlat / (1 + radius * radius);  // per radian, where the map is per tangent
  const Distorted along = distort(radial_part(k), {radius, 0});
  constexpr double kMinDenominator = 1e-3;  // chosen; a smaller one is near a pole of the curve
  if (!(along.denominator > kMinDenominator) || !(along.least_stretch() > flat)) return true;
  const Pixel tilt(k[3], k[2]);
  if (tilt.isZero(0)) return false;
  // The map folds first in the direction against the tangential terms.
  if (!(distort(k, -radius * tilt.normalized()).least_stretch() > flat)) return true;
  for (int i = 0; i < kDirections; ++i)
    if (!(distort(k, in_direction(i, radius)).least_stretch() > flat)) return true;
  return false;
}

double max_angle(const Coefficients& k) {
  constexpr double kLimit = kPi / 2 - 1e-3;  // chosen: no image reaches a larger angle
  // Steps of 0.4 mrad.
  return last_before(kLimit, 4000, 50, [&](double angle_rad) { return folds(k, angle_rad); });
}

// The undistorted radius from which the radial terms alone reach `target`: bisection.
double radial_guess(const Coefficients& k, double target, double limit) {
  const Coefficients radial = radial_part(k);
  double low = 0;
  double high = limit;
  for (int i = 0; i < 20; ++i) {
    const double middle = 0.5 * (low + high);
    (distort(radial, {middle, 0}).value.x() < target ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

struct Guess {
  Pixel n;
  double miss;
};

double small(const Pixel& target) { return 1e-12 * (1 + target.norm()); }

// Newton's method. Each step is shortened until the residual decreases, and stays in the valid
// field.
Guess newton(const Coefficients& k, const Pixel& target, Pixel n, double limit, int steps) {
  Distorted at = distort(k, n);
  double miss = (at.value - target).norm();
  for (int i = 0; i < steps && miss > 0; ++i) {
    Pixel step = at.solve(target - at.value);
    const double tried = miss;
    for (int half = 0; half < 30 && miss == tried; ++half, step *= 0.5) {
      Pixel next = n + step;
      if (const double radius = next.norm(); radius > limit) next *= limit / radius;
      const Distorted there = distort(k, next);
      const double left = (there.value - target).norm();
      if (left < miss) {
        n = next;
        at = there;
        miss = left;
      } else if (miss <= small(target)) {
        break;  // rounding allows no further decrease
      }
    }
    if (miss == tried) break;
  }
  return {n, miss};
}

// Follows the straight line from the axis to the target in the image, which stays within the field.
Guess walk(const Coefficients& k, const Pixel& target, double limit) {
  // The number of parts of the way. Chosen by judgement; more parts take longer, and fewer leave
  // Newton's method a longer way.
  constexpr int kParts = 16;
  Guess guess{Pixel::Zero(), 0};
  for (int part = 1; part <= kParts; ++part)
    guess = newton(k, target * part / kParts, guess.n, limit, part < kParts ? 10 : 60);
  return guess;
}

Field field_of(const BrownConrady& lens) {
  const Coefficients k = coefficients(lens);
  Field field{max_angle(k), 0};
  const double limit = std::tan(field.max_angle_rad);
  for (int i = 0; i < kDirections; ++i)
    field.max_radius = std::max(field.max_radius, distort(k, in_direction(i, limit)).value.norm());
  field.max_radius *= 1.01;  // a margin for the directions between those that are tried
  return field;
}

std::optional<Pixel> project(const BrownConrady& lens, const Vector3& p, const Field& field) {
  if (!(p.z() > 0)) return std::nullopt;
  if (!(std::atan2(std::hypot(p.x(), p.y()), p.z()) <= field.max_angle_rad)) return std::nullopt;
  const Pixel d = distort(coefficients(lens), {p.x() / p.z(), p.y() / p.z()}).value;
  return Pixel(d.cwiseProduct(lens.focal_px) + lens.principal_point_px);
}

std::optional<Vector3> unproject(const BrownConrady& lens, const Pixel& pixel, const Field& field) {
  const Coefficients k = coefficients(lens);
  const Pixel target = (pixel - lens.principal_point_px).cwiseQuotient(lens.focal_px);
  const double radius = target.norm();
  if (!(radius <= field.max_radius)) return std::nullopt;
  const double limit = std::tan(field.max_angle_rad);
  Guess guess{target, HUGE_VAL};
  if (radius <= limit) guess = newton(k, target, target, limit, 8);
  if (guess.miss > small(target)) {
    const Pixel start = target * (radial_guess(k, radius, limit) / radius);
    guess = newton(k, target, start, limit, 30);
  }
  if (guess.miss > small(target)) guess = walk(k, target, limit);
  if (guess.miss > small(target)) return std::nullopt;
  return Vector3(guess.n.x(), guess.n.y(), 1).normalized();
}

double curve(const Fisheye& lens, double theta) {
  const double t2 = theta * theta;
  const auto& k = lens.distortion;
  return theta * (1 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3]))));
}

double slope(const Fisheye& lens, double theta) {
  const double t2 = theta * theta;
  const auto& k = lens.distortion;
  return 1 + t2 * (3 * k[0] + t2 * (5 * k[1] + t2 * (7 * k[2] + t2 * 9 * k[3])));
}

// The theta in [0, limit] with curve(theta) = radius. Newton's method runs within a shrinking
// bracket. Bisection replaces a step that does not halve the bracket, because Newton's method may
// circle around a bend of the curve.
double inverse(const Fisheye& lens, double radius, double limit) {
  double low = 0;
  double high = limit;
  double theta = std::min(radius, limit);
  double last_step = HUGE_VAL;
  for (int i = 0; i < 100; ++i) {
    const double miss = curve(lens, theta) - radius;
    if (miss == 0) return theta;
    (miss > 0 ? high : low) = theta;
    double next = theta - miss / slope(lens, theta);
    if (!(next >= low && next <= high) || std::abs(next - theta) > 0.5 * last_step)
      next = 0.5 * (low + high);
    last_step = std::abs(next - theta);
    if (last_step < 1e-15 * (1 + theta)) return next;
    theta = next;
  }
  return theta;
}

// The largest angle up to which the curve rises everywhere.
double max_angle(const Fisheye& lens) {
  // Steps of 0.16 mrad.
  return last_before(kPi, 20000, 60, [&](double theta) { return !(slope(lens, theta) > kFlat); });
}

Field field_of(const Fisheye& lens) {
  const double angle = std::min(max_angle(lens), lens.stated_max_angle_rad);
  return {angle, curve(lens, angle) * (1 + 1e-12)};
}

std::optional<Pixel> project(const Fisheye& lens, const Vector3& p, const Field& field) {
  const double side = std::hypot(p.x(), p.y());
  const double theta = std::atan2(side, p.z());
  if (!(p.squaredNorm() > 0) || !(theta <= field.max_angle_rad)) return std::nullopt;
  if (side == 0) {
    // A point straight behind the camera has no direction from the axis, and so no unique pixel.
    if (p.z() < 0) return std::nullopt;
    return lens.principal_point_px;
  }
  const double scale = curve(lens, theta) / side;
  return Pixel(lens.focal_px.x() * scale * p.x() + lens.principal_point_px.x(),
               lens.focal_px.y() * scale * p.y() + lens.principal_point_px.y());
}

std::optional<Vector3> unproject(const Fisheye& lens, const Pixel& pixel, const Field& field) {
  const Pixel d = (pixel - lens.principal_point_px).cwiseQuotient(lens.focal_px);
  const double radius = d.norm();
  if (radius == 0) return Vector3(0, 0, 1);
  if (!(radius <= field.max_radius)) return std::nullopt;
  const double theta = inverse(lens, radius, field.max_angle_rad);
  const double scale = std::sin(theta) / radius;
  return Vector3(scale * d.x(), scale * d.y(), std::cos(theta));
}

// What the numbers of a lens must be.

constexpr double kLeastField_rad = radians(0.5);  // chosen: far below that of any lens

std::string number(double x) { return fmt::format("{:g}", x); }

void validate(const Pixel& focal_px, const Pixel& centre_px, ImageSize size) {
  if (size.width <= 0 || size.height <= 0) throw Error("the lens has no image size");
  if (!focal_px.allFinite() || focal_px.x() <= 0 || focal_px.y() <= 0)
    throw Error("focal_px is [" + number(focal_px.x()) + ", " + number(focal_px.y()) +
                "]; expected two positive numbers");
  if (!centre_px.allFinite()) throw Error("principal_point_px is not finite; expected two numbers");
}

template <typename Distorting>
Field checked_field(const Distorting& lens, bool has_right_number, const char* expected) {
  if (!has_right_number)
    throw Error("distortion has " + std::to_string(lens.distortion.size()) + " numbers; expected " +
                expected);
  for (double k : lens.distortion)
    if (!std::isfinite(k)) throw Error("distortion holds a number that is not finite");
  const Field field = field_of(lens);
  if (!(field.max_angle_rad >= kLeastField_rad))
    throw Error("distortion makes the radial curve fall from the axis on; expected one that rises");
  return field;
}

Field validated(const Pinhole& lens) { return field_of(lens); }
Field validated(const BrownConrady& lens) {
  const std::size_t n = lens.distortion.size();
  return checked_field(lens, n == 4 || n == 5 || n == 8, "4, 5 or 8");
}
Field validated(const Fisheye& lens) {
  if (!(lens.stated_max_angle_rad >= kLeastField_rad))
    throw Error("max_angle_rad is " + number(lens.stated_max_angle_rad) +
                "; expected half a degree or more");
  return checked_field(lens, lens.distortion.size() == 4, "4");
}

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
  field_ = std::visit(
      [&](const auto& lens) {
        validate(lens.focal_px, lens.principal_point_px, size);
        return validated(lens);
      },
      model_);
  if (auto* fisheye = std::get_if<Fisheye>(&model_);
      fisheye != nullptr && fisheye->stated_max_angle_rad < kPi &&
      !(fisheye->stated_max_angle_rad < max_angle(*fisheye)))
    fisheye->stated_max_angle_rad = kPi;
}

std::optional<Pixel> Lens::pixel_from_cam(const Vector3& p_in_cam) const {
  return std::visit([&](const auto& lens) { return project(lens, p_in_cam, field_); }, model_);
}

std::optional<Vector3> Lens::ray_from_pixel(const Pixel& pixel) const {
  if (!pixel.allFinite()) return std::nullopt;
  return std::visit([&](const auto& lens) { return unproject(lens, pixel, field_); }, model_);
}

double Lens::focal_px() const {
  return std::visit([](const auto& lens) { return 0.5 * (lens.focal_px.x() + lens.focal_px.y()); },
                    model_);
}

const char* Lens::name() const { return enum_name(static_cast<ModelKind>(model_.index())); }

double Lens::horizontal_fov_deg() const {
  const Pixel c = pixel_of(facts_of(*this).principal_point_px);
  return angle_between_pixels(*this, {0, c.y()}, {double(size_.width), c.y()}, c);
}

double Lens::vertical_fov_deg() const {
  const Pixel c = pixel_of(facts_of(*this).principal_point_px);
  return angle_between_pixels(*this, {c.x(), 0}, {c.x(), double(size_.height)}, c);
}

Facts facts_of(const Lens& lens) {
  Facts facts{.model = lens.name(), .width = lens.size().width, .height = lens.size().height};
  std::visit(
      [&](const auto& model) {
        facts.focal_px = {model.focal_px.x(), model.focal_px.y()};
        facts.principal_point_px = {model.principal_point_px.x(), model.principal_point_px.y()};
        if constexpr (requires { model.distortion; }) facts.distortion = model.distortion;
        if constexpr (requires { model.stated_max_angle_rad; })
          facts.max_angle_rad = model.stated_max_angle_rad;
      },
      lens.model());
  return facts;
}

Lens lens_of(const Facts& facts) {
  const Pixel focal = pixel_of(facts.focal_px);
  const Pixel principal = pixel_of(facts.principal_point_px);
  const ImageSize size{facts.width, facts.height};
  const auto kind = enum_named<ModelKind>(facts.model);
  if (kind == ModelKind::kFisheye)
    return Lens(Fisheye{focal, principal, facts.distortion, facts.max_angle_rad}, size);
  if (kind == ModelKind::kBrownConrady)
    return Lens(BrownConrady{focal, principal, facts.distortion}, size);
  return Lens(Pinhole{focal, principal}, size);
}

Lens undistorted(bool fisheye, double focal_px, ImageSize size, double width_of_height) {
  const Pixel focal(focal_px / width_of_height, focal_px);
  const Pixel centre(size.width / 2.0, size.height / 2.0);
  if (fisheye) return Lens(Fisheye{focal, centre, {0, 0, 0, 0}}, size);
  return Lens(Pinhole{focal, centre}, size);
}

Lens pinhole_from_vertical_fov(double vertical_fov_deg, ImageSize size, double width_of_height) {
  check_fov(vertical_fov_deg, 180, "pinhole", false);
  const double focal_px = 0.5 * size.height / std::tan(radians(vertical_fov_deg) / 2);
  return undistorted(false, focal_px, size, width_of_height);
}

Lens fisheye_from_vertical_fov(double vertical_fov_deg, ImageSize size) {
  check_fov(vertical_fov_deg, 360, "fisheye", true);
  return undistorted(true, 0.5 * size.height / (radians(vertical_fov_deg) / 2), size);
}

}  // namespace airtruth::lens
