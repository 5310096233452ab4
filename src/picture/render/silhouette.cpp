// SPDX-License-Identifier: Apache-2.0
#include "picture/render/silhouette.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <variant>

#include "picture/render/marking.h"

namespace airtruth::render {
namespace {

// Largest number of triangles over one pixel; with more, rays are faster.
constexpr std::size_t kMostTriangles = 192;
// Largest number of entries in the lists of a patch. An aircraft that encloses the eye exceeds it,
// and rays then do all the work.
constexpr std::uint64_t kMostEntries = std::uint64_t{1} << 25;
constexpr double kMarginPx = 0.02;
// A side shorter than this many pixels counts as straight under any lens.
constexpr double kStraightPx = 4;

std::optional<Pixel> frame_pixel(const View& view,
                                 const Homography& frame_from_nominal,
                                 const Quaternion& cam_from_world,
                                 const Vector3& from_eye_in_world) {
  const auto nominal = view.lens->pixel_from_cam(cam_from_world * from_eye_in_world);
  if (!nominal) return std::nullopt;
  const Vector3 h = frame_from_nominal * Vector3(nominal->x(), nominal->y(), 1);
  if (!(h.z() > 0)) return std::nullopt;
  return Pixel(h.x() / h.z(), h.y() / h.z());
}

}  // namespace

struct Silhouette::Pencil {
  bool known = true;
  bool moves = false;
  // Directions at a pixel's corners. At an instant: in world (moment 1). During a motion: in body,
  // with e x d, at the three moments of the pixel's exposure (or at moment 1 alone).
  Thrice<std::array<Vector3, 4>> direction;
  Thrice<std::array<Vector3, 4>> moment;
  bool exposes = false;

  double product(const Triangle& triangle,
                 std::size_t side,
                 std::size_t k,
                 std::size_t corner) const {
    const double still = triangle.side[side].dot(direction[k][corner]);
    return moves ? still + triangle.edge[side].dot(moment[k][corner]) : still;
  }
};

struct Silhouette::Eye {
  View view;
  Matrix3 world_from_body;
  Vector3 eye_in_body;
  Homography frame_from_nominal;
  Quaternion cam_from_world;

  std::optional<Pixel> pixel(const Vector3& in_world) const {
    return frame_pixel(view, frame_from_nominal, cam_from_world, in_world);
  }
  bool is_pinhole() const { return std::holds_alternative<lens::Pinhole>(view.lens->model()); }
  double depth(const Vector3& in_world) const { return (cam_from_world * in_world).z(); }
};

Silhouette::Silhouette(const TracedIntruder& actor,
                       const View& view,
                       const PixelBox& patch,
                       const RayGrid& grid)
    : patch_(patch), grid_(grid), actor_(actor) {
  std::vector<Eye> eyes;
  for (int k = actor.moves ? 0 : 1; k < (actor.moves ? 3 : 2); ++k) {
    const View then = view.at(grid.span().at(k));
    const auto i = static_cast<std::size_t>(k);
    eyes.push_back({then,
                    actor.body_from_world_at[i].transpose(),
                    actor.eye_in_body_at[i],
                    then.nominal_from_frame.inverse(),
                    then.world_from_cam.rotation.conjugate()});
  }
  std::vector<Reach> reaches;
  for (std::size_t part = 0; part < actor.placed.model->mesh.parts.size(); ++part)
    add_part(actor, part, eyes, reaches);
  sort_by_pixel(reaches);
}

void Silhouette::add_part(const TracedIntruder& actor,
                          std::size_t part,
                          const std::vector<Eye>& eyes,
                          std::vector<Reach>& reaches) {
  const Model::Impl& model = *actor.placed.model;
  const aircraft::Mesh& mesh = model.mesh;
  const Vector3 nowhere = Vector3::Constant(std::numeric_limits<double>::quiet_NaN());
  std::vector<std::vector<Seen>> seen(eyes.size(), std::vector<Seen>(mesh.positions.size()));
  std::vector<bool> known(mesh.positions.size(), false);
  const auto in_body = [&](std::uint32_t vertex) {
    return Vector3((actor.placed.body_from_part[part] * mesh.positions[vertex]).cast<double>());
  };
  const auto look_at = [&](std::uint32_t vertex) {
    if (known[vertex]) return;
    known[vertex] = true;
    for (std::size_t e = 0; e < eyes.size(); ++e) {
      Seen& result = seen[e][vertex];
      result.in_world = eyes[e].world_from_body * (in_body(vertex) - eyes[e].eye_in_body);
      const auto pixel = eyes[e].pixel(result.in_world);
      result.pixel = pixel ? *pixel : Pixel(nowhere.head<2>());
    }
  };
  // Rays handle a part that spins during the exposure.
  const bool spins = actor.moves && mesh.parts[part].spins;
  const std::optional<Reach> disc =
      spins ? std::optional(reach_of_disc(mesh, mesh.parts[part], eyes)) : std::nullopt;
  const auto& source = mesh.parts[part].triangles;
  std::vector<std::array<const Seen*, 3>> corners(eyes.size());
  for (std::size_t i = 0; i < source.size(); ++i) {
    const auto& vertex = source[i].vertex;
    for (const std::uint32_t v : vertex) look_at(v);
    for (std::size_t e = 0; e < eyes.size(); ++e)
      corners[e] = {&seen[e][vertex[0]], &seen[e][vertex[1]], &seen[e][vertex[2]]};
    const Reach reach = spins             ? *disc
                        : eyes.size() > 1 ? reach_over_time(corners, eyes)
                                          : reach_of(corners[0], eyes[0]);
    if (reach.x0 >= reach.x1 || reach.y0 >= reach.y1) continue;
    const auto& middle = corners[eyes.size() / 2];
    const Vector3& a = middle[0]->in_world;
    const Vector3& b = middle[1]->in_world;
    const Vector3& c = middle[2]->in_world;
    Triangle triangle{
        {a.cross(b), b.cross(c), c.cross(a)}, {}, model.opaque[part][i] != 0 && !spins};
    const double turn = a.dot(triangle.side[1]);
    // The triangle is seen edge-on.
    if (turn == 0 && !actor.moves) continue;
    if (actor.moves) {
      const std::array<Vector3, 3> p = {in_body(vertex[0]), in_body(vertex[1]), in_body(vertex[2])};
      for (std::size_t k = 0; k < 3; ++k) {
        triangle.side[k] = p[k].cross(p[(k + 1) % 3]);
        triangle.edge[k] = p[(k + 1) % 3] - p[k];
      }
    }
    if (turn < 0)
      for (std::size_t k = 0; k < 3; ++k) {
        triangle.side[k] = -triangle.side[k];
        triangle.edge[k] = -triangle.edge[k];
      }
    triangles_.push_back(triangle);
    reaches.push_back(reach);
  }
}

// The reach of a spinning part at any angle: that of an octahedron about a sphere about its hub.
Silhouette::Reach Silhouette::reach_of_disc(const aircraft::Mesh& mesh,
                                            const aircraft::Part& part,
                                            const std::vector<Eye>& eyes) const {
  float radius_m = 0;
  for (const aircraft::Triangle& triangle : part.triangles)
    for (const std::uint32_t v : triangle.vertex)
      radius_m = std::max(radius_m, (mesh.positions[v] - part.centre_in_body).norm());
  const double reach_m = std::sqrt(3.0) * static_cast<double>(radius_m);
  BoxBounds bounds;
  for (const Eye& eye : eyes)
    for (int axis = 0; axis < 3; ++axis)
      for (const double side : {-1.0, 1.0}) {
        Vector3 in_body = part.centre_in_body.cast<double>();
        in_body[axis] += side * reach_m;
        const auto pixel = eye.pixel(eye.world_from_body * (in_body - eye.eye_in_body));
        if (!pixel) return {patch_.x, patch_.y, patch_.right(), patch_.bottom()};
        bounds.add(*pixel);
      }
  const Box box = *bounds.box();
  return reach_within(patch_, {box.x, box.y}, {box.right(), box.bottom()}, 1);
}

// The union of the reaches at each moment. Between moments the corners follow parabolas, which
// deviate from their chords by an eighth of the second difference.
Silhouette::Reach Silhouette::reach_over_time(
    const std::vector<std::array<const Seen*, 3>>& corners, const std::vector<Eye>& eyes) const {
  Reach all{patch_.right(), patch_.bottom(), patch_.x, patch_.y};
  for (std::size_t e = 0; e < eyes.size(); ++e) {
    const Reach r = reach_of(corners[e], eyes[e]);
    if (r.x0 >= r.x1 || r.y0 >= r.y1) {
      // The triangle is outside the patch at this moment, but its path may cross the patch.
      for (const Seen* corner : corners[e]) {
        if (!corner->pixel.allFinite()) continue;
        const Reach point = reach_within(patch_, corner->pixel, corner->pixel, 1);
        all = {std::min(all.x0, point.x0),
               std::min(all.y0, point.y0),
               std::max(all.x1, point.x1),
               std::max(all.y1, point.y1)};
      }
      continue;
    }
    all = {std::min(all.x0, r.x0),
           std::min(all.y0, r.y0),
           std::max(all.x1, r.x1),
           std::max(all.y1, r.y1)};
  }
  double bulge = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Pixel second = corners[0][k]->pixel - 2 * corners[1][k]->pixel + corners[2][k]->pixel;
    if (second.allFinite()) bulge = std::max(bulge, second.cwiseAbs().maxCoeff() / 8);
  }
  if (all.x0 >= all.x1 || all.y0 >= all.y1) return {};
  const int more = static_cast<int>(std::ceil(std::min(bulge, 1e4)));
  return {std::max(all.x0 - more, patch_.x),
          std::max(all.y0 - more, patch_.y),
          std::min(all.x1 + more, patch_.right()),
          std::min(all.y1 + more, patch_.bottom())};
}

// Bounds of the picture of the part of a triangle in front of a pinhole's plane. Empty where no
// part is, or where a point of it has no pixel.
BoxBounds Silhouette::bounds_before_plane(const std::array<const Seen*, 3>& corners,
                                          const Eye& eye,
                                          bool& all_have_pictures) {
  double size = 0;
  for (const Seen* corner : corners) size = std::max(size, corner->in_world.norm());
  const double near = 1e-7 * size;
  BoxBounds bounds;
  const auto add = [&](const Vector3& point) {
    const auto pixel = eye.pixel(point);
    if (pixel) bounds.add(*pixel);
    all_have_pictures = all_have_pictures && pixel;
  };
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector3& from = corners[k]->in_world;
    const Vector3& to = corners[(k + 1) % 3]->in_world;
    const double from_depth = eye.depth(from) - near;
    const double to_depth = eye.depth(to) - near;
    if (from_depth >= 0) add(from);
    if ((from_depth < 0) != (to_depth < 0))
      add(from + from_depth / (from_depth - to_depth) * (to - from));
  }
  return bounds;
}

// A box about the triangle's picture. Under a wide lens the sides may bend by at most twice the
// deviation of their middles.
Silhouette::Reach Silhouette::reach_of(const std::array<const Seen*, 3>& corners,
                                       const Eye& eye) const {
  const Reach whole{patch_.x, patch_.y, patch_.right(), patch_.bottom()};
  Pixel low = corners[0]->pixel;
  Pixel high = low;
  for (const Seen* corner : corners) {
    if (!corner->pixel.allFinite()) {
      if (!eye.is_pinhole()) return whole;
      bool all_have_pictures = true;
      const auto box = bounds_before_plane(corners, eye, all_have_pictures).box();
      if (!all_have_pictures) return whole;
      return box ? reach_within(patch_, {box->x, box->y}, {box->right(), box->bottom()}, kMarginPx)
                 : Reach{};
    }
    low = low.cwiseMin(corner->pixel);
    high = high.cwiseMax(corner->pixel);
  }
  double margin = kMarginPx;
  if ((high - low).maxCoeff() > kStraightPx) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Seen& from = *corners[k];
      const Seen& to = *corners[(k + 1) % 3];
      // The middle of the side's picture, which differs from the picture of the side's middle: each
      // point is weighted by its nearness.
      const Vector3 middle = from.in_world.normalized() + to.in_world.normalized();
      const auto pixel = eye.pixel(middle);
      if (!pixel) return whole;
      const Pixel along = to.pixel - from.pixel;
      const Pixel off = *pixel - from.pixel;
      const double length = along.norm();
      const double bend =
          length > 0 ? std::abs(along.x() * off.y() - along.y() * off.x()) / length : 0;
      margin = std::max(margin, 2 * bend + kMarginPx);
    }
  }
  return reach_within(patch_, low, high, margin);
}

Silhouette::Reach Silhouette::reach_within(const PixelBox& patch,
                                           const Pixel& low,
                                           const Pixel& high,
                                           double margin) {
  const auto bounded = [](double value, int from, int to) {
    return static_cast<int>(std::clamp(value, double(from), double(to)));
  };
  return {bounded(std::floor(low.x() - margin), patch.x, patch.right()),
          bounded(std::floor(low.y() - margin), patch.y, patch.bottom()),
          bounded(std::ceil(high.x() + margin), patch.x, patch.right()),
          bounded(std::ceil(high.y() + margin), patch.y, patch.bottom())};
}

void Silhouette::sort_by_pixel(const std::vector<Reach>& reaches) {
  const std::size_t pixels =
      static_cast<std::size_t>(patch_.width) * static_cast<std::size_t>(patch_.height);
  first_.assign(pixels + 1, 0);
  std::uint64_t entries = 0;
  for (const Reach& r : reaches)
    entries += static_cast<std::uint64_t>(r.x1 - r.x0) * static_cast<std::uint64_t>(r.y1 - r.y0);
  if (entries > kMostEntries) {
    touch_.assign(pixels, Touch::kRays);
    return;
  }
  touch_.assign(pixels, Touch::kNone);
  const auto each = [&](const auto& body) {
    for (std::size_t i = 0; i < reaches.size(); ++i) {
      const Reach& r = reaches[i];
      for (int y = r.y0; y < r.y1; ++y) {
        const std::size_t row = index(0, y);
        for (int x = r.x0; x < r.x1; ++x)
          body(row + static_cast<std::size_t>(x), static_cast<std::uint32_t>(i));
      }
    }
  };
  each([&](std::size_t pixel, std::uint32_t i) {
    ++first_[pixel + 1];
    if (!triangles_[i].opaque) touch_[pixel] = Touch::kRays;
  });
  for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
    const std::uint32_t count = first_[pixel + 1];
    if (touch_[pixel] == Touch::kNone && count > 0)
      touch_[pixel] = count > kMostTriangles ? Touch::kRays : Touch::kOpaque;
    first_[pixel + 1] += first_[pixel];
  }
  by_pixel_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  each([&](std::size_t pixel, std::uint32_t i) { by_pixel_[next[pixel]++] = i; });
}

std::span<const std::uint32_t> Silhouette::triangles_of(int x, int y) const {
  const std::size_t i = index(x, y);
  return {by_pixel_.data() + first_[i], by_pixel_.data() + first_[i + 1]};
}

Silhouette::Touch Silhouette::touch(int x, int y) const { return touch_[index(x, y)]; }

Silhouette::Pencil Silhouette::pencil_of(int x, int y) const {
  Pencil pencil;
  pencil.moves = actor_.moves;
  Thrice<std::array<Vector3, 4>> in_world;
  for (int k = actor_.moves ? 0 : 1; k < (actor_.moves ? 3 : 2); ++k) {
    in_world[static_cast<std::size_t>(k)] = grid_.corners(x, y, k);
    pencil.known = pencil.known && finite(in_world[static_cast<std::size_t>(k)]);
  }
  if (!pencil.known) return pencil;
  if (!actor_.moves) {
    pencil.direction[1] = in_world[1];
    return pencil;
  }
  const double exposure_s = grid_.exposure_s();
  pencil.exposes = exposure_s > 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double dt_s = grid_.middle_s(x, y) + 0.5 * (static_cast<double>(k) - 1) * exposure_s;
    const double u = grid_.span().u(dt_s);
    const Matrix3 body_from_world = between(actor_.body_from_world_at, u);
    const Vector3 eye = between(actor_.eye_in_body_at, u);
    for (std::size_t c = 0; c < 4; ++c) {
      const Thrice<Vector3> corner = {in_world[0][c], in_world[1][c], in_world[2][c]};
      pencil.direction[k][c] = body_from_world * between(corner, u);
      pencil.moment[k][c] = eye.cross(pencil.direction[k][c]);
    }
  }
  return pencil;
}

// Side: a type of marking.h. side_of(triangle, side): the products at its four corners, at one
// moment or three.
template <typename Side, typename ProductsOf, typename SideOf, typename Place>
void Silhouette::cover_by(int x,
                          int y,
                          int samples,
                          const ProductsOf& products_of,
                          const SideOf& side_of,
                          const Place& place,
                          Cover& result) const {
  std::int32_t* covered = result.is_covered.data();
  Places places;
  bool placed = false;
  bool full = false;
  for (const std::uint32_t index : triangles_of(x, y)) {
    std::array<Side, 3> sides;
    int crossing = 0;
    bool outside = false;
    for (std::size_t side = 0; side < 3 && !outside; ++side) {
      const auto products = products_of(triangles_[index], side);
      const std::ptrdiff_t inner =
          std::count_if(products.begin(), products.end(), [](double p) { return p >= 0; });
      if (inner == std::ssize(products)) continue;
      outside = inner == 0;
      if (!outside) sides[static_cast<std::size_t>(crossing++)] = side_of(products);
    }
    if (outside) continue;
    if (!placed && crossing > 0) place(PixelSamples(x, y), places);
    placed = placed || crossing > 0;
    full = crossing == 0 || mark(sides, crossing, places, samples, covered);
    if (full) break;
  }
  if (full) std::fill_n(covered, samples, -1);
  result.covered = -std::accumulate(covered, covered + samples, 0);
}

void Silhouette::cover(int x, int y, int samples, Cover& result) const {
  result.is_covered.assign(static_cast<std::size_t>(samples), 0);
  result.covered = 0;
  const Pencil pencil = pencil_of(x, y);
  if (!pencil.known) return;
  if (pencil.exposes)
    cover_moving(x, y, pencil, samples, result);
  else
    cover_still(x, y, pencil, samples, result);
}

void Silhouette::cover_still(int x, int y, const Pencil& pencil, int samples, Cover& result) const {
  using Products = std::array<double, 4>;
  cover_by<Bilinear>(
      x,
      y,
      samples,
      [&](const Triangle& triangle, std::size_t side) {
        Products at;
        for (std::size_t c = 0; c < 4; ++c) at[c] = pencil.product(triangle, side, 1, c);
        return at;
      },
      bilinear_of,
      [&](const PixelSamples& here, Places& places) {
        here.fill(samples, places.x.data(), places.y.data());
      },
      result);
}

void Silhouette::cover_moving(
    int x, int y, const Pencil& pencil, int samples, Cover& result) const {
  // Four products for each moment.
  using Products = std::array<double, 12>;
  cover_by<Swept>(
      x,
      y,
      samples,
      [&](const Triangle& triangle, std::size_t side) {
        Products at;
        for (std::size_t i = 0; i < 12; ++i) at[i] = pencil.product(triangle, side, i / 4, i % 4);
        return at;
      },
      [](const Products& p) {
        return swept_of(
            {{{p[0], p[1], p[2], p[3]}, {p[4], p[5], p[6], p[7]}, {p[8], p[9], p[10], p[11]}}});
      },
      [&](const PixelSamples& here, Places& places) {
        here.fill(samples, places.x.data(), places.y.data());
        here.fill_times(samples, places.t.data());
      },
      result);
}

}  // namespace airtruth::render
