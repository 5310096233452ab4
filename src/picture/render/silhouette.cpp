// SPDX-License-Identifier: Apache-2.0
#include "picture/render/silhouette.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "picture/render/marking.h"
#include "picture/render/pixel_rays.h"

namespace airtruth::render {
namespace {

// Largest number of triangles over one pixel; with more, rays are faster.
constexpr std::size_t kMaxTriangles = 1024;
// Largest number of entries in the lists of a patch. An aircraft that encloses the eye exceeds it,
// and rays then do all the work.
constexpr std::uint64_t kMaxEntries = std::uint64_t{1} << 25;

// The triangles by the number of pixels that they reach, to a power of two: large ones cover a
// pixel early.
std::vector<std::uint32_t> largest_first(const std::vector<Reach>& reaches) {
  constexpr std::size_t kSizes = 65;
  const auto size = [](const Reach& reach) {
    return kSizes - 1 - static_cast<std::size_t>(std::bit_width(reach.pixels()));
  };
  std::array<std::uint32_t, kSizes + 1> first{};
  for (const Reach& reach : reaches) ++first[size(reach) + 1];
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<std::uint32_t> order(reaches.size());
  for (std::size_t i = 0; i < reaches.size(); ++i)
    order[first[size(reaches[i])]++] = static_cast<std::uint32_t>(i);
  return order;
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

  double product(const Planes& planes, std::size_t side, std::size_t k, std::size_t corner) const {
    const double still = planes.side[side].dot(direction[k][corner]);
    return moves ? still + planes.edge[side].dot(moment[k][corner]) : still;
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

std::optional<Silhouette::Planes> Silhouette::planes_of(const Vertices& vertices,
                                                        const aircraft::Triangle& source) const {
  const Vector3& a = vertices.middle()[0]->in_world;
  const Vector3& b = vertices.middle()[1]->in_world;
  const Vector3& c = vertices.middle()[2]->in_world;
  Planes planes{{a.cross(b), b.cross(c), c.cross(a)}, {}};
  const double turn = a.dot(planes.side[1]);
  if (turn == 0 && !actor_.moves) return std::nullopt;
  if (actor_.moves) {
    const std::array<Vector3, 3> p = {vertices.in_body(source.vertex[0]),
                                      vertices.in_body(source.vertex[1]),
                                      vertices.in_body(source.vertex[2])};
    for (std::size_t k = 0; k < 3; ++k) {
      planes.side[k] = p[k].cross(p[(k + 1) % 3]);
      planes.edge[k] = p[(k + 1) % 3] - p[k];
    }
  }
  if (turn < 0)
    for (std::size_t k = 0; k < 3; ++k) {
      planes.side[k] = -planes.side[k];
      planes.edge[k] = -planes.edge[k];
    }
  return planes;
}

void Silhouette::add_part(const TracedIntruder& actor,
                          std::size_t part,
                          const std::vector<Eye>& eyes,
                          std::vector<Reach>& reaches) {
  const Model::Impl& model = *actor.placed.model;
  const aircraft::Part& mesh_part = model.mesh.parts[part];
  // Rays handle a part that spins during the exposure.
  const bool spins = actor.moves && mesh_part.moves();
  const std::optional<Reach> disc =
      spins ? std::optional(reach_of_disc(patch_, model.mesh, mesh_part, eyes)) : std::nullopt;
  const Span& span = grid_.span();
  const double exposure_share = actor.moves ? grid_.exposure_s() / (span.end_s - span.begin_s) : 0;
  Vertices vertices(actor, part, eyes);
  for (std::size_t i = 0; i < mesh_part.triangles.size(); ++i) {
    const std::vector<Corners>& corners = vertices.look_at(mesh_part.triangles[i]);
    const Reach reach = spins             ? *disc
                        : eyes.size() > 1 ? reach_over_time(patch_, corners, eyes)
                                          : reach_of(patch_, corners[0], eyes[0]);
    if (reach.empty()) continue;
    Triangle triangle{
        model.opaque[part][i] != 0 && !spins, true, static_cast<std::uint32_t>(straight_.size())};
    if (const auto straight = StraightTriangle::of(corners, eyes, exposure_share)) {
      straight_.push_back(*straight);
    } else if (const auto planes = planes_of(vertices, mesh_part.triangles[i])) {
      triangle.is_straight = false;
      triangle.index = static_cast<std::uint32_t>(planes_.size());
      planes_.push_back(*planes);
    } else {
      continue;
    }
    triangles_.push_back(triangle);
    reaches.push_back(reach);
  }
}

void Silhouette::sort_by_pixel(const std::vector<Reach>& reaches) {
  const std::size_t pixels =
      static_cast<std::size_t>(patch_.width) * static_cast<std::size_t>(patch_.height);
  first_.assign(pixels + 1, 0);
  std::uint64_t entries = 0;
  for (const Reach& r : reaches) entries += r.pixels();
  if (entries > kMaxEntries) {
    touch_.assign(pixels, Touch::kRays);
    return;
  }
  touch_.assign(pixels, Touch::kNone);
  const std::vector<std::uint32_t> order = largest_first(reaches);
  const auto each = [&](const auto& body) {
    for (const std::uint32_t i : order) {
      const Reach& r = reaches[i];
      for (int y = r.y0; y < r.y1; ++y) {
        const std::size_t row = index(0, y);
        for (int x = r.x0; x < r.x1; ++x) body(row + static_cast<std::size_t>(x), i);
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
  if (!actor_.moves) {
    pencil.direction[1] = grid_.corners(x, y);
    pencil.known = finite(pencil.direction[1]);
    return pencil;
  }
  const Beam beam = beam_of(actor_, grid_, x, y);
  pencil.known = beam.known;
  pencil.exposes = beam.exposes;
  pencil.direction = beam.direction_in_body;
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t c = 0; c < 4; ++c)
      pencil.moment[k][c] = beam.eye_in_body[k].cross(pencil.direction[k][c]);
  return pencil;
}

bool Silhouette::is_known(int x, int y) const {
  for (int k = actor_.moves ? 0 : 1; k < (actor_.moves ? 3 : 2); ++k)
    if (!finite(grid_.corners(x, y, k))) return false;
  return true;
}

class Silhouette::PixelCover {
 public:
  PixelCover(const Silhouette& silhouette, int x, int y, int samples, Cover& result)
      : silhouette_(silhouette), x_(x), y_(y), samples_(samples), result_(result) {
    result.is_covered.assign(static_cast<std::size_t>(samples), 0);
    result.covered = 0;
    exposes_ = silhouette.actor_.moves && silhouette.grid_.exposure_s() > 0;
    if (silhouette.actor_.moves) u_ = silhouette.grid_.span().u(silhouette.grid_.middle_s(x, y));
  }

  void mark_all() {
    if (!silhouette_.is_known(x_, y_)) return;
    std::int32_t* covered = result_.is_covered.data();
    for (const std::uint32_t i : silhouette_.triangles_of(x_, y_)) {
      const Triangle& triangle = silhouette_.triangles_[i];
      const bool full = triangle.is_straight ? mark_straight(silhouette_.straight_[triangle.index])
                                             : mark_planes(silhouette_.planes_[triangle.index]);
      if (!full) continue;
      std::fill_n(covered, samples_, -1);
      break;
    }
    result_.covered = -std::accumulate(covered, covered + samples_, 0);
  }

 private:
  // The functions return true where every sample is covered.
  bool mark_straight(const StraightTriangle& triangle) {
    const PixelSides sides = triangle.over(x_, y_, u_);
    if (sides.is_outside) return false;
    if (sides.crossing == 0) return true;
    const unsigned strips = sides.strips & open_;
    if (strips == 0) return false;
    place();
    open_ &= ~mark(sides.side, exposes_, places_, samples_, strips, result_.is_covered.data());
    return open_ == 0;
  }

  bool mark_planes(const Planes& planes) {
    if (!pencil_) pencil_ = silhouette_.pencil_of(x_, y_);
    return exposes_ ? mark_planes_by<Swept, 3>(planes) : mark_planes_by<Bilinear, 1>(planes);
  }

  // Side: a type of marking.h. kMoments: the number of the moments that it is made from.
  template <typename Side, std::size_t kMoments>
  bool mark_planes_by(const Planes& planes) {
    std::array<Side, 3> sides;
    int crossing = 0;
    for (std::size_t side = 0; side < 3; ++side) {
      std::array<std::array<double, 4>, kMoments> products;
      int inner = 0;
      for (std::size_t k = 0; k < kMoments; ++k)
        for (std::size_t c = 0; c < 4; ++c) {
          products[k][c] = pencil_->product(planes, side, kMoments == 1 ? 1 : k, c);
          inner += products[k][c] >= 0;
        }
      if (inner == 4 * kMoments) continue;
      if (inner == 0) return false;
      if constexpr (kMoments == 1)
        sides[static_cast<std::size_t>(crossing++)] = bilinear_of(products[0]);
      else
        sides[static_cast<std::size_t>(crossing++)] = swept_of(products);
    }
    if (crossing == 0) return true;
    place();
    return mark(sides, crossing, places_, samples_, result_.is_covered.data());
  }

  void place() {
    if (is_placed_) return;
    is_placed_ = true;
    const PixelSamples here(x_, y_);
    here.fill(samples_, places_.x.data(), places_.y.data());
    if (exposes_) here.fill_times(samples_, places_.t.data());
  }

  const Silhouette& silhouette_;
  int x_;
  int y_;
  int samples_;
  Cover& result_;
  bool exposes_ = false;
  // The middle of the pixel's exposure in the span.
  double u_ = 0;
  std::optional<Pencil> pencil_;
  Places places_;
  bool is_placed_ = false;
  // The strips with samples that are not covered yet.
  unsigned open_ = kAllStrips;
};

void Silhouette::cover(int x, int y, int samples, Cover& result) const {
  PixelCover(*this, x, y, samples, result).mark_all();
}

}  // namespace airtruth::render
