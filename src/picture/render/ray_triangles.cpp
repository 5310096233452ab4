// SPDX-License-Identifier: Apache-2.0
#include "picture/render/ray_triangles.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <variant>

#include "picture/shade/outer_sides.h"

namespace airtruth::render {
namespace {

// A part turns by this much within one of its spans: a parabola through three points of an arc of
// angle a is within (a / 2)^3 / (9 sqrt 3) of it, 1/8000 of the radius.
constexpr double kTurnOfSpanRad = 0.25;
// Most spans of a part: ten turns in a frame's time, where all that remains is a disc.
constexpr int kMostSpans = 256;

// A bound in pixels that contains every point.
constexpr float kEverywhere = std::numeric_limits<float>::infinity();
const ScreenBounds kWholeFrame{-kEverywhere, -kEverywhere, kEverywhere, kEverywhere};

ScreenBounds mixed(const ScreenBounds& a, const ScreenBounds& b, float share) {
  const auto mean = [&](float p, float q) { return p == q ? p : p + share * (q - p); };
  return {
      mean(a.left, b.left), mean(a.top, b.top), mean(a.right, b.right), mean(a.bottom, b.bottom)};
}

ScreenBounds united(const ScreenBounds& a, const ScreenBounds& b) {
  return {std::min(a.left, b.left),
          std::min(a.top, b.top),
          std::max(a.right, b.right),
          std::max(a.bottom, b.bottom)};
}

void include(ScreenBounds& bounds, const Pixel& pixel) {
  const Eigen::Vector2f p = pixel.cast<float>();
  bounds = united(bounds, {p.x(), p.y(), p.x(), p.y()});
}

ScreenBounds wider(const ScreenBounds& bounds, float margin) {
  return {bounds.left - margin, bounds.top - margin, bounds.right + margin, bounds.bottom + margin};
}

int spans_of_part(const model::Part& part, const Span& span) {
  const double turn_rad = 2 * kPi * model::fastest_turn_per_s(part) * (span.end_s - span.begin_s);
  return std::clamp(static_cast<int>(std::ceil(turn_rad / kTurnOfSpanRad)), 1, kMostSpans);
}

// The view at one moment, as points are projected.
struct Projection {
  const lens::Lens* lens;
  Homography frame_from_nominal;
  bool is_pinhole;

  explicit Projection(const View& view)
      : lens(view.lens),
        frame_from_nominal(view.nominal_from_frame.inverse()),
        is_pinhole(std::holds_alternative<lens::Pinhole>(view.lens->model())) {}

  std::optional<Pixel> pixel(const Vector3& in_cam) const {
    const auto nominal = lens->pixel_from_cam(in_cam);
    if (!nominal) return std::nullopt;
    const Vector3 h = frame_from_nominal * Vector3(nominal->x(), nominal->y(), 1);
    if (!(h.z() > 0)) return std::nullopt;
    return Pixel(h.x() / h.z(), h.y() / h.z());
  }
};

using Corners = std::array<Vector3, 3>;

// An angle from the lens's axis within which the rays of a patch lie at all times of the span.
double angle_of_rays(const View& view, const PixelBox& patch, const Span& span) {
  // The border is looked at from pixel to pixel, since near the end of a lens's field the angle
  // rises by degrees within a few; what lies between two is within the margin.
  constexpr double kMarginRad = 0.02;
  double angle_rad = 0;
  const auto look = [&](const View& then, int x, int y) {
    const Vector3 ray = ray_in_cam(then, Pixel(x, y));
    angle_rad =
        std::max(angle_rad, ray.allFinite() ? std::acos(ray.z()) : view.lens->max_angle_rad());
  };
  for (int k = 0; k < 3; ++k) {
    const View then = view.at(span.at(k));
    for (int x = patch.x; x <= patch.right(); ++x)
      for (const int y : {patch.y, patch.bottom()}) look(then, x, y);
    for (int y = patch.y; y <= patch.bottom(); ++y)
      for (const int x : {patch.x, patch.right()}) look(then, x, y);
  }
  return angle_rad + kMarginRad;
}

// Of the part of a triangle in front of a pinhole's plane; everywhere where a point of it has no
// pixel.
ScreenBounds bounds_before_plane(const Corners& corners, const Projection& projection) {
  double size = 0;
  for (const Vector3& corner : corners) size = std::max(size, corner.norm());
  const double near = 1e-7 * size;
  ScreenBounds bounds;
  bool all_have_pixels = true;
  const auto add = [&](const Vector3& point) {
    const auto pixel = projection.pixel(point);
    if (pixel) include(bounds, *pixel);
    all_have_pixels = all_have_pixels && pixel;
  };
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector3& from = corners[k];
    const Vector3& to = corners[(k + 1) % 3];
    const double from_depth = from.z() - near;
    const double to_depth = to.z() - near;
    if (from_depth >= 0) add(from);
    if ((from_depth < 0) != (to_depth < 0))
      add(from + from_depth / (from_depth - to_depth) * (to - from));
  }
  return all_have_pixels ? bounds : kWholeFrame;
}

// How far the picture of a side may be from the line between its ends: twice the deviation
// of the middle of its picture. Negative where that has no pixel.
double bend_px(const Vector3& from,
               const Vector3& to,
               const Pixel& a,
               const Pixel& b,
               const Projection& projection) {
  const auto middle = projection.pixel(from.normalized() + to.normalized());
  if (!middle) return -1;
  const Pixel along = b - a;
  const Pixel off = *middle - a;
  const double length = along.norm();
  return length > 0 ? 2 * std::abs(along.x() * off.y() - along.y() * off.x()) / length : 0;
}

// A triangle at one moment.
struct Moment {
  // The four functions by axis.
  Eigen::Matrix<double, 3, 4> functions;
  double determinant = 0;
  double nearest = 0;
  double farthest = 0;
};

}  // namespace

std::optional<PixelBox> pixels_to_search(const std::optional<Box>& search, const View& view) {
  if (!search) return std::nullopt;
  return intersection(pixels_of(*search), {0, 0, view.width, view.height});
}

PlacedInstance place(const Instance& instance,
                     const View& view,
                     const shade::Light& light,
                     const std::optional<Box>& search,
                     const Span& span) {
  const shade::Model::Impl& model = instance.model->impl();
  PlacedInstance result{instance, {}, {}, true, pixels_to_search(search, view)};
  Thrice<Vector3> eyes;
  for (std::size_t k = 0; k < 3; ++k) {
    const double dt_s = span.at(static_cast<int>(k));
    const Rigid body_from_world = carried(instance.world_from_body, instance.twist, dt_s).inverse();
    eyes[k] = body_from_world * view.at(dt_s).world_from_cam.translation;
    if ((eyes[k] - model.centre_in_body).norm() <= model.radius_m) result.is_outside = false;
  }
  result.eye_in_body = parabola(eyes);
  shade::Placed& placed = result.placed;
  placed.model = &model;
  const Matrix3 body_from_world = carried(instance.world_from_body, instance.twist, span.middle_s())
                                      .rotation.conjugate()
                                      .toRotationMatrix();
  placed.to_sun_in_body = (body_from_world * light.to_sun_in_world).normalized().cast<float>();
  placed.up_in_body = (body_from_world * Vector3(0, 0, -1)).cast<float>();
  if (light.surroundings)
    placed.surroundings = light.surroundings->turned(body_from_world.transpose().cast<float>());
  for (const model::Part& part : model.mesh.parts)
    placed.body_from_part.push_back(model::body_from_part(part, instance.time_s + span.middle_s()));
  return result;
}

ScreenBounds bounds_between(const RayTriangle& triangle, float from_u, float to_u) {
  const auto at = [&](float u) {
    return u < 0 ? mixed(triangle.bounds[1], triangle.bounds[0], std::min(-u, 1.0f))
                 : mixed(triangle.bounds[1], triangle.bounds[2], std::min(u, 1.0f));
  };
  ScreenBounds bounds = united(at(from_u), at(to_u));
  if (from_u < 0 && to_u > 0) bounds = united(bounds, triangle.bounds[1]);
  return wider(bounds, triangle.margin_px);
}

// A part at the beginning, the middle and the end of a span, or at an instant.
class RayTriangles::Projected {
 public:
  Projected(const View& view, const Span& span, const Instance& instance, std::size_t part)
      : part_(instance.model->impl().geometry[part]) {
    const model::Part& source = instance.model->impl().mesh.parts[part];
    for (std::size_t k = 0; k < (span.is_instant() ? 1U : 3U); ++k) {
      const double dt_s = span.is_instant() ? span.begin_s : span.at(static_cast<int>(k));
      const View then = view.at(dt_s);
      const Rigid cam_from_body =
          then.world_from_cam.inverse() * carried(instance.world_from_body, instance.twist, dt_s);
      Eigen::Affine3d cam_from_part = cam_from_body.affine();
      if (source.moves())
        cam_from_part =
            cam_from_part * model::body_from_part(source, instance.time_s + dt_s).cast<double>();
      views_.emplace_back(then);
      eyes_in_part_.push_back(cam_from_part.inverse(Eigen::Isometry).translation());
      std::vector<Vector3>& in_cam = in_cam_.emplace_back();
      in_cam.reserve(part_.positions.size());
      for (const Eigen::Vector3f& position : part_.positions)
        in_cam.push_back(cam_from_part * position.cast<double>());
    }
    vertices_.resize(part_.positions.size());
  }

  std::size_t moments() const { return views_.size(); }
  std::size_t triangles() const { return part_.triangles.size(); }
  Corners corners(std::size_t triangle, std::size_t moment) const {
    const auto& [a, b, c] = part_.triangles[triangle].vertex;
    return {in_cam_[moment][a], in_cam_[moment][b], in_cam_[moment][c]};
  }

  Moment moment(std::size_t triangle, std::size_t k) const {
    const shade::PartGeometry::Triangle& of = part_.triangles[triangle];
    const auto [a, b, c] = corners(triangle, k);
    Moment result;
    result.functions << b.cross(c), c.cross(a), a.cross(b), Vector3::Zero();
    result.determinant = a.dot(result.functions.col(0));
    result.functions.col(3) =
        (result.functions.col(0) + result.functions.col(1) + result.functions.col(2)) /
        result.determinant;
    const auto [least_m, most_m] = std::minmax({vertex(of.vertex[0]).distance_m[k],
                                                vertex(of.vertex[1]).distance_m[k],
                                                vertex(of.vertex[2]).distance_m[k]});
    // No point is nearer than the plane, nor farther from a corner than the longest side.
    const double plane_m =
        of.front_length_m2 > 0 ? std::abs(result.determinant) / of.front_length_m2 : 0;
    result.nearest = 1 / std::max({plane_m, least_m - of.longest_m, 1e-6});
    result.farthest = 1 / std::max(most_m, 1e-6);
    return result;
  }

  bool is_hidden(std::size_t triangle, shade::OuterSides outer) const {
    if (outer == shade::kBothSides || outer == shade::kNoSide) return outer == shade::kNoSide;
    Thrice<double> front_to_eye;
    double scale = 0;
    const shade::PartGeometry::Triangle& of = part_.triangles[triangle];
    const Vector3 corner = part_.positions[of.vertex[0]].cast<double>();
    for (std::size_t k = 0; k < moments(); ++k) {
      const Vector3 to_eye = eyes_in_part_[k] - corner;
      front_to_eye[k] = of.front_m2.dot(to_eye);
      scale = std::max(scale, of.front_length_m2 * to_eye.norm());
    }
    return shade::is_hidden(outer, std::span(front_to_eye).first(moments()), scale);
  }

  // True where no ray within an angle from the axis meets the triangle: a plane that touches this
  // cone has all corners on its other side, or, of a cone wider than half of space, all corners are
  // in the rest of space, which is convex.
  bool is_beyond(std::size_t triangle, double angle_rad) const {
    if (!(angle_rad < kPi)) return false;
    const bool is_wide = angle_rad >= kPi / 2;
    const Corners middle = corners(triangle, moments() / 2);
    const Pixel aside = (middle[0] + middle[1] + middle[2]).head<2>();
    const Pixel side = aside.isZero(0) ? Pixel(1, 0) : Pixel(aside.normalized());
    const Vector3 outwards(
        std::cos(angle_rad) * side.x(), std::cos(angle_rad) * side.y(), -std::sin(angle_rad));
    const auto is_outside = [&](const Vector3& point) {
      return is_wide ? point.z() < std::cos(angle_rad) * point.norm() : outwards.dot(point) > 0;
    };
    for (std::size_t k = 0; k < moments(); ++k)
      if (!std::ranges::all_of(corners(triangle, k), is_outside)) return false;
    if (moments() == 1) return true;
    // A corner's parabola lies in the triangle of its ends and this point.
    const Corners first = corners(triangle, 0), last = corners(triangle, 2);
    for (std::size_t i = 0; i < 3; ++i)
      if (!is_outside(2 * middle[i] - 0.5 * (first[i] + last[i]))) return false;
    return true;
  }

  // Sets the bounds and their margin.
  void find_bounds(std::size_t triangle, RayTriangle& result) const {
    // Covers the rounding of the rays.
    constexpr float kMarginPx = 0.02f;
    const auto& vertices = part_.triangles[triangle].vertex;
    result.margin_px = kMarginPx;
    for (std::size_t k = 0; k < moments(); ++k)
      result.bounds[k] = bounds_at(triangle, k, result.margin_px);
    if (moments() == 1) {
      result.bounds[1] = result.bounds[2] = result.bounds[0];
      return;
    }
    double second_px = 0;
    for (const std::uint32_t v : vertices) {
      const Thrice<Pixel>& at = vertex(v).pixel;
      const Pixel second = at[0] - 2 * at[1] + at[2];
      if (second.allFinite()) second_px = std::max(second_px, second.cwiseAbs().maxCoeff());
    }
    // A parabola is within an eighth of its second difference of its chords.
    result.margin_px += static_cast<float>(second_px / 8);
  }

 private:
  struct Vertex {
    bool known = false;
    Thrice<double> distance_m;
    // NaN where it has none.
    Thrice<Pixel> pixel;
  };

  // A vertex is projected when the first triangle asks for it.
  const Vertex& vertex(std::uint32_t index) const {
    Vertex& result = vertices_[index];
    if (result.known) return result;
    result.known = true;
    for (std::size_t k = 0; k < moments(); ++k) {
      const Vector3& in_cam = in_cam_[k][index];
      result.distance_m[k] = in_cam.norm();
      result.pixel[k] = views_[k].pixel(in_cam).value_or(
          Pixel::Constant(std::numeric_limits<double>::quiet_NaN()));
    }
    return result;
  }

  ScreenBounds bounds_at(std::size_t triangle, std::size_t k, float& margin_px) const {
    // A side shorter than this many pixels stays unbent under any lens.
    constexpr float kUnbentPx = 4;
    const auto& vertices = part_.triangles[triangle].vertex;
    const Projection& projection = views_[k];
    ScreenBounds bounds;
    for (const std::uint32_t v : vertices) {
      const Pixel& pixel = vertex(v).pixel[k];
      if (!pixel.allFinite())
        return projection.is_pinhole ? bounds_before_plane(corners(triangle, k), projection)
                                     : kWholeFrame;
      include(bounds, pixel);
    }
    if (projection.is_pinhole ||
        std::max(bounds.right - bounds.left, bounds.bottom - bounds.top) <= kUnbentPx)
      return bounds;
    const Corners in_cam = corners(triangle, k);
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t j = (i + 1) % 3;
      const double bend = bend_px(in_cam[i],
                                  in_cam[j],
                                  vertex(vertices[i]).pixel[k],
                                  vertex(vertices[j]).pixel[k],
                                  projection);
      if (bend < 0) return kWholeFrame;
      margin_px = std::max(margin_px, static_cast<float>(bend));
    }
    return bounds;
  }

  const shade::PartGeometry& part_;
  std::vector<Projection> views_;
  std::vector<std::vector<Vector3>> in_cam_;
  std::vector<Vector3> eyes_in_part_;
  mutable std::vector<Vertex> vertices_;
};

RayTriangles::RayTriangles(const View& view,
                           const PixelBox& patch,
                           const Span& span,
                           std::vector<PlacedInstance>& instances)
    : patch_(patch) {
  std::size_t most = 0;
  for (const PlacedInstance& instance : instances)
    if (instance.pixels) most += instance.placed.model->mesh.triangle_count();
  all_.reserve(most);
  std::optional<double> angle_rad;  // few triangles ask for it
  const auto angle = [&] {
    if (!angle_rad) angle_rad = angle_of_rays(view, patch, span);
    return *angle_rad;
  };
  for (std::uint32_t i = 0; i < instances.size(); ++i) {
    if (!instances[i].pixels) continue;
    const std::size_t parts = instances[i].placed.model->mesh.parts.size();
    for (std::uint32_t part = 0; part < parts; ++part)
      add_part(view, span, angle, instances[i], i, part);
  }
  sort_into_rows();
}

void RayTriangles::add_part(const View& view,
                            const Span& span,
                            const AngleOfRays& angle_of_rays,
                            PlacedInstance& placed,
                            std::uint32_t instance,
                            std::uint32_t part) {
  const shade::Model::Impl& model = *placed.placed.model;
  const model::Part& source = model.mesh.parts[part];
  if (source.triangles.empty()) return;
  const int count = spans_of_part(source, span);
  const double each_s = (span.end_s - span.begin_s) / count;
  for (int i = 0; i < count; ++i) {
    const Span now{span.begin_s + i * each_s, span.begin_s + (i + 1) * each_s};
    RayTriangle triangle;
    triangle.span = static_cast<std::uint32_t>(spans_.size());
    triangle.instance = instance;
    triangle.part = part;
    triangle.pose = part;
    spans_.push_back(now);
    if (count > 1) {
      triangle.pose = static_cast<std::uint32_t>(placed.placed.body_from_part.size());
      placed.placed.body_from_part.push_back(
          model::body_from_part(source, placed.instance.time_s + now.middle_s()));
    }
    const Projected projected(view, now, placed.instance, part);
    for (std::size_t t = 0; t < projected.triangles(); ++t) {
      if (placed.is_outside && projected.is_hidden(t, model.outer_sides[part][t])) continue;
      triangle.in_part = static_cast<std::uint32_t>(t);
      triangle.is_opaque = model.opaque[part][t] != 0;
      add(projected, angle_of_rays, t, triangle);
    }
  }
}

void RayTriangles::add(const Projected& projected,
                       const AngleOfRays& angle_of_rays,
                       std::size_t t,
                       RayTriangle result) {
  Thrice<Moment> of_moment;
  const auto moments = std::span(of_moment).first(projected.moments());
  for (std::size_t k = 0; k < moments.size(); ++k) moments[k] = projected.moment(t, k);
  const auto [least, most] =
      std::minmax_element(moments.begin(), moments.end(), [](const Moment& a, const Moment& b) {
        return a.determinant < b.determinant;
      });
  // A triangle edge-on to the eye covers nothing.
  if (least->determinant == 0 && most->determinant == 0) return;
  projected.find_bounds(t, result);
  const ScreenBounds over_all = result.over_all = bounds_between(result, -1, 1);
  if (!(over_all.left < static_cast<float>(patch_.right()) &&
        over_all.right > static_cast<float>(patch_.x) &&
        over_all.top < static_cast<float>(patch_.bottom()) &&
        over_all.bottom > static_cast<float>(patch_.y)))
    return;
  // Without bounds every pixel would look at it.
  if (!std::isfinite(over_all.left) && projected.is_beyond(t, angle_of_rays())) return;
  result.nearest = 0;
  result.farthest = std::numeric_limits<float>::infinity();
  for (const Moment& moment : moments) {
    result.nearest = std::max(result.nearest, static_cast<float>(moment.nearest));
    result.farthest = std::min(result.farthest, static_cast<float>(moment.farthest));
  }
  // Where a triangle turns its other side to the eye meanwhile, each side has its own; the inverse
  // distance is then that of the moment at which the triangle is the least edge-on, within its
  // bounds.
  const bool turns = !(least->determinant > 0 || most->determinant < 0);
  const Moment& flattest = most->determinant > -least->determinant ? *most : *least;
  for (const double side : {1.0, -1.0}) {
    if (side > 0 ? !(most->determinant > 0) : !(least->determinant < 0)) continue;
    for (int c = 0; c < 3; ++c) {
      if (moments.size() == 1) {
        Eigen::Map<Eigen::Array4f> to(result.functions[0][static_cast<std::size_t>(c)].data());
        to = (side * moments[0].functions.row(c).transpose().array()).cast<float>();
        to[3] = static_cast<float>(moments[0].functions(c, 3));
        continue;
      }
      Thrice<Eigen::Array4d> at;
      for (std::size_t k = 0; k < 3; ++k) {
        const Moment& moment = moments[k];
        at[k] = side * moment.functions.row(c).transpose().array();
        at[k][3] = (turns ? flattest : moment).functions(c, 3);
      }
      const Thrice<Eigen::Array4d> by_u = parabola(at);
      for (std::size_t k = 0; k < 3; ++k)
        Eigen::Map<Eigen::Array4f>{result.functions[k][static_cast<std::size_t>(c)].data()} =
            by_u[k].cast<float>();
    }
    all_.push_back(result);
  }
}

void RayTriangles::sort_into_rows() {
  // By the inverse distance, whose bits have its order, and then by the index.
  std::vector<std::uint64_t> keys(all_.size());
  for (std::size_t i = 0; i < keys.size(); ++i)
    keys[i] = std::uint64_t{~std::bit_cast<std::uint32_t>(all_[i].nearest)} << 32 | i;
  std::sort(keys.begin(), keys.end());
  const auto each = [&](const auto& use) {
    for (const std::uint64_t key : keys) {
      const auto i = static_cast<std::uint32_t>(key);
      const ScreenBounds& bounds = all_[i].over_all;
      const auto row = [&](float y, int most) {
        return static_cast<int>(
            std::clamp(y - static_cast<float>(patch_.y), 0.0f, static_cast<float>(most)));
      };
      const int last = row(std::floor(bounds.bottom), patch_.height - 1);
      for (int y = row(std::floor(bounds.top), patch_.height - 1); y <= last; ++y)
        use(static_cast<std::size_t>(y), i);
    }
  };
  first_.assign(static_cast<std::size_t>(patch_.height) + 1, 0);
  each([&](std::size_t y, std::uint32_t) { ++first_[y + 1]; });
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  rows_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  each([&](std::size_t y, std::uint32_t i) { rows_[next[y]++] = i; });
}

}  // namespace airtruth::render
