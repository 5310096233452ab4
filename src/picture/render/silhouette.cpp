// SPDX-License-Identifier: Apache-2.0
#include "picture/render/silhouette.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "picture/render/marking.h"

namespace airtruth::render {
namespace {

// Largest number of triangles over one pixel; with more, rays are faster.
constexpr std::size_t kMaxTriangles = 192;
// Largest number of entries in the lists of a patch. An aircraft that encloses the eye exceeds it,
// and rays then do all the work.
constexpr std::uint64_t kMaxEntries = std::uint64_t{1} << 25;

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

// A vertex is projected when the first triangle asks for it.
class Silhouette::Vertices {
 public:
  Vertices(const TracedIntruder& actor, std::size_t part, const std::vector<Eye>& eyes)
      : mesh_(actor.placed.model->mesh),
        body_from_part_(actor.placed.body_from_part[part]),
        eyes_(eyes),
        seen_(eyes.size(), std::vector<Seen>(mesh_.positions.size())),
        known_(mesh_.positions.size(), false),
        corners_(eyes.size()) {}

  Vector3 in_body(std::uint32_t vertex) const {
    return Vector3((body_from_part_ * mesh_.positions[vertex]).cast<double>());
  }

  // The triangle's corners at each moment.
  const std::vector<Corners>& look_at(const aircraft::Triangle& triangle) {
    const auto& vertex = triangle.vertex;
    for (const std::uint32_t v : vertex) project(v);
    for (std::size_t e = 0; e < eyes_.size(); ++e)
      corners_[e] = {&seen_[e][vertex[0]], &seen_[e][vertex[1]], &seen_[e][vertex[2]]};
    return corners_;
  }

  // The corners of the triangle that was looked at last, at the middle moment.
  const Corners& middle() const { return corners_[eyes_.size() / 2]; }

 private:
  void project(std::uint32_t vertex) {
    if (known_[vertex]) return;
    known_[vertex] = true;
    for (std::size_t e = 0; e < eyes_.size(); ++e) {
      Seen& result = seen_[e][vertex];
      result.in_world = eyes_[e].world_from_body * (in_body(vertex) - eyes_[e].eye_in_body);
      const auto pixel = eyes_[e].pixel(result.in_world);
      result.pixel =
          pixel ? *pixel : Pixel(Pixel::Constant(std::numeric_limits<double>::quiet_NaN()));
    }
  }

  const aircraft::Mesh& mesh_;
  const Eigen::Affine3f& body_from_part_;
  const std::vector<Eye>& eyes_;
  std::vector<std::vector<Seen>> seen_;
  std::vector<bool> known_;
  std::vector<Corners> corners_;
};

std::optional<Silhouette::Triangle> Silhouette::triangle_of(
    const Vertices& vertices, const aircraft::Triangle& source) const {
  const Vector3& a = vertices.middle()[0]->in_world;
  const Vector3& b = vertices.middle()[1]->in_world;
  const Vector3& c = vertices.middle()[2]->in_world;
  Triangle triangle{{a.cross(b), b.cross(c), c.cross(a)}, {}, true};
  const double turn = a.dot(triangle.side[1]);
  if (turn == 0 && !actor_.moves) return std::nullopt;
  if (actor_.moves) {
    const std::array<Vector3, 3> p = {vertices.in_body(source.vertex[0]),
                                      vertices.in_body(source.vertex[1]),
                                      vertices.in_body(source.vertex[2])};
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
  return triangle;
}

void Silhouette::add_part(const TracedIntruder& actor,
                          std::size_t part,
                          const std::vector<Eye>& eyes,
                          std::vector<Reach>& reaches) {
  const Model::Impl& model = *actor.placed.model;
  const aircraft::Part& mesh_part = model.mesh.parts[part];
  // Rays handle a part that spins during the exposure.
  const bool spins = actor.moves && mesh_part.spins;
  const std::optional<Reach> disc =
      spins ? std::optional(reach_of_disc(patch_, model.mesh, mesh_part, eyes)) : std::nullopt;
  Vertices vertices(actor, part, eyes);
  for (std::size_t i = 0; i < mesh_part.triangles.size(); ++i) {
    const std::vector<Corners>& corners = vertices.look_at(mesh_part.triangles[i]);
    const Reach reach = spins             ? *disc
                        : eyes.size() > 1 ? reach_over_time(patch_, corners, eyes)
                                          : reach_of(patch_, corners[0], eyes[0]);
    if (reach.empty()) continue;
    auto triangle = triangle_of(vertices, mesh_part.triangles[i]);
    if (!triangle) continue;
    triangle->opaque = model.opaque[part][i] != 0 && !spins;
    triangles_.push_back(*triangle);
    reaches.push_back(reach);
  }
}

void Silhouette::sort_by_pixel(const std::vector<Reach>& reaches) {
  const std::size_t pixels =
      static_cast<std::size_t>(patch_.width) * static_cast<std::size_t>(patch_.height);
  first_.assign(pixels + 1, 0);
  std::uint64_t entries = 0;
  for (const Reach& r : reaches)
    entries += static_cast<std::uint64_t>(r.x1 - r.x0) * static_cast<std::uint64_t>(r.y1 - r.y0);
  if (entries > kMaxEntries) {
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
      touch_[pixel] = count > kMaxTriangles ? Touch::kRays : Touch::kOpaque;
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
