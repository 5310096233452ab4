// SPDX-License-Identifier: Apache-2.0
#include "picture/render/silhouette.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "picture/render/outer_sides.h"

namespace airtruth::render {
namespace {

// Largest number of triangles over one pixel; with more, rays are faster.
constexpr std::size_t kMaxTriangles = 1024;
// Largest number of entries in the lists of a patch. An aircraft that encloses the eye exceeds it,
// and rays then do all the work.
constexpr std::uint64_t kMaxEntries = std::uint64_t{1} << 25;

// Empty where the eye may be inside the aircraft.
std::optional<HiddenTriangles> hidden_triangles(const TracedIntruder& actor,
                                                std::size_t part,
                                                const std::vector<Eye>& eyes) {
  if (!(actor.start_m > 0)) return std::nullopt;
  const Model::Impl& model = *actor.placed.model;
  const Eigen::Affine3d part_from_body = actor.placed.part_from_body[part].cast<double>();
  std::vector<Vector3> eye_in_part;
  for (const Eye& eye : eyes) eye_in_part.push_back(part_from_body * eye.eye_in_body);
  return HiddenTriangles(
      model.mesh, model.mesh.parts[part], model.outer_sides[part], std::move(eye_in_part));
}

}  // namespace

Silhouette::Silhouette(const TracedIntruder& actor,
                       const View& view,
                       const PixelBox& patch,
                       const RayGrid& grid,
                       bool sees)
    : patch_(patch), grid_(grid), actor_(actor), sees_(sees) {
  const std::vector<Eye> eyes = eyes_of(actor, view, grid);
  std::vector<Reach> reaches;
  // Memory that grows by doubling is copied, and its pages are cleared, for each frame anew.
  if (!actor.moves) still_.reserve(actor.placed.model->mesh.triangle_count());
  for (std::size_t part = 0; part < actor.placed.model->mesh.parts.size(); ++part)
    add_part(actor, part, eyes, reaches);
  sort_by_pixel(reaches);
}

// A vertex is projected when the first triangle asks for it.
class Silhouette::Vertices {
 public:
  // `body_from_part`: one for each eye, where the part moves; else one.
  Vertices(const TracedIntruder& actor,
           std::vector<Eigen::Affine3f> body_from_part,
           const std::vector<Eye>& eyes)
      : mesh_(actor.placed.model->mesh),
        body_from_part_(std::move(body_from_part)),
        eyes_(eyes),
        seen_(eyes.size(), std::vector<Seen>(mesh_.positions.size())),
        known_(mesh_.positions.size(), false),
        corners_(eyes.size()) {}

  Vector3 in_body(std::uint32_t vertex, std::size_t eye = 0) const {
    const Eigen::Affine3f& pose = body_from_part_[std::min(eye, body_from_part_.size() - 1)];
    return Vector3((pose * mesh_.positions[vertex]).cast<double>());
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
      result =
          eyes_[e].look_at(eyes_[e].world_from_body * (in_body(vertex, e) - eyes_[e].eye_in_body));
    }
  }

  const aircraft::Mesh& mesh_;
  std::vector<Eigen::Affine3f> body_from_part_;
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
  if (actor.moves && mesh_part.moves()) {
    if (!mesh_part.triangles.empty()) add_moving_part(actor, mesh_part, eyes, reaches);
    return;
  }
  const Span& span = grid_.span();
  const double exposure_share = actor.moves ? grid_.exposure_s() / (span.end_s - span.begin_s) : 0;
  Vertices vertices(actor, {actor.placed.body_from_part[part]}, eyes);
  const std::optional<HiddenTriangles> is_hidden = hidden_triangles(actor, part, eyes);
  for (std::size_t i = 0; i < mesh_part.triangles.size(); ++i) {
    if (is_hidden && (*is_hidden)(i)) continue;
    const std::vector<Corners>& corners = vertices.look_at(mesh_part.triangles[i]);
    const Reach reach = eyes.size() > 1 ? reach_over_time(patch_, corners, eyes)
                                        : reach_of(patch_, corners[0], eyes[0]);
    if (reach.empty()) continue;
    Triangle triangle{static_cast<std::uint32_t>(part), static_cast<std::uint32_t>(i)};
    triangle.opaque = model.opaque[part][i] != 0;
    triangle.even = model.even[part][i] != 0;
    if (!place(corners, eyes, exposure_share, kStraight, triangle)) {
      const auto planes = planes_of(vertices, mesh_part.triangles[i]);
      if (!planes) continue;
      triangle.planes = static_cast<std::uint32_t>(planes_.size());
      planes_.push_back(*planes);
      if (sees_) place(corners, eyes, exposure_share, kNearlyStraight, triangle);
    }
    triangles_.push_back(triangle);
    reaches.push_back(reach);
  }
}

void Silhouette::add_moving_part(const TracedIntruder& actor,
                                 const aircraft::Part& part,
                                 const std::vector<Eye>& eyes,
                                 std::vector<Reach>& reaches) {
  const aircraft::Mesh& mesh = actor.placed.model->mesh;
  const Span& span = grid_.span();
  const auto margin_px = swing_margin_px(mesh, part, eyes, span.end_s - span.begin_s);
  if (!margin_px) {
    add_disc(reach_of_disc(patch_, mesh, part, eyes), reaches);
    return;
  }
  std::vector<Eigen::Affine3f> poses;
  for (int k = 0; k < 3; ++k)
    poses.push_back(aircraft::body_from_part(part, actor.placed.time_s + span.at(k)));
  Vertices vertices(actor, std::move(poses), eyes);
  for (const aircraft::Triangle& triangle : part.triangles) {
    const Reach reach = reach_over_time(patch_, vertices.look_at(triangle), eyes);
    if (!reach.empty()) add_disc(wider(reach, *margin_px, patch_), reaches);
  }
}

bool Silhouette::place(const std::vector<Corners>& corners,
                       const std::vector<Eye>& eyes,
                       double exposure_share,
                       const Tolerance& tolerance,
                       Triangle& triangle) {
  if (actor_.moves) {
    const auto moving = MovingTriangle::of(corners, eyes, exposure_share, tolerance);
    if (!moving) return false;
    triangle.picture = static_cast<std::uint32_t>(moving_.size());
    triangle.has_depth = moving->has_depth();
    if (triangle.has_depth) triangle.nearest = moving->nearest();
    moving_.push_back(*moving);
    return true;
  }
  const auto still = StillTriangle::of(corners[0], eyes[0], tolerance);
  if (!still) return false;
  triangle.picture = static_cast<std::uint32_t>(still_.size());
  triangle.has_depth = still->has_depth();
  if (triangle.has_depth) triangle.nearest = still->nearest();
  still_.push_back(*still);
  return true;
}

void Silhouette::add_disc(const Reach& reach, std::vector<Reach>& reaches) {
  if (reach.empty()) return;
  Triangle triangle;
  triangle.is_disc = true;
  triangles_.push_back(triangle);
  reaches.push_back(reach);
}

std::vector<std::uint32_t> Silhouette::nearest_first() {
  constexpr std::size_t kLayers = 256;
  float least = std::numeric_limits<float>::infinity();
  float most = 0;
  for (const Triangle& triangle : triangles_) {
    if (!triangle.has_depth) continue;
    least = std::min(least, triangle.nearest);
    most = std::max(most, triangle.nearest);
  }
  const float thickness = (most - least) / static_cast<float>(kLayers - 1);
  // Layer 0 holds the triangles whose depth is not known.
  const auto layer_of = [&](const Triangle& triangle) {
    if (!triangle.has_depth) return std::size_t{0};
    const float behind = thickness > 0 ? (most - triangle.nearest) / thickness : 0;
    return std::min(static_cast<std::size_t>(behind), kLayers - 1) + 1;
  };
  std::array<std::uint32_t, kLayers + 2> first{};
  for (const Triangle& triangle : triangles_) ++first[layer_of(triangle) + 1];
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<std::uint32_t> order(triangles_.size());
  for (std::size_t i = 0; i < triangles_.size(); ++i)
    order[first[layer_of(triangles_[i])]++] = static_cast<std::uint32_t>(i);
  float nearest = 0;
  for (auto i = order.rbegin(); i != order.rend(); ++i) {
    Triangle& triangle = triangles_[*i];
    nearest = triangle.nearest = std::max(nearest, triangle.nearest);
  }
  return order;
}

std::vector<Silhouette::RowSpan> Silhouette::rows_of(const std::vector<Reach>& reaches,
                                                     const std::vector<std::uint32_t>& order) {
  // With any other readout the pixels of a row have different times.
  const bool row_by_row = actor_.moves && grid_.reads_rows();
  std::vector<double> u;
  if (row_by_row)
    for (int y = patch_.y; y < patch_.bottom(); ++y)
      u.push_back(grid_.span().u(grid_.middle_s(patch_.x, y)));
  std::vector<RowSpan> rows;
  std::size_t most = 0;
  for (const Reach& r : reaches) most += static_cast<std::size_t>(r.y1 - r.y0);
  rows.reserve(most);
  if (row_by_row) in_row_.reserve(most);
  for (const std::uint32_t i : order) {
    const Reach& r = reaches[i];
    const bool follows =
        row_by_row && triangles_[i].planes == kNone && triangles_[i].picture != kNone;
    for (int y = r.y0; y < r.y1; ++y) {
      if (!follows) {
        rows.push_back({i, y, r.x0, r.x1});
        continue;
      }
      const RowTriangle row =
          moving_[triangles_[i].picture].over_row(y, u[static_cast<std::size_t>(y - patch_.y)]);
      const auto [first, last] = row.columns();
      const int x0 = std::max(r.x0, first);
      const int x1 = std::min(r.x1, last);
      if (x0 >= x1) continue;
      rows.push_back({i, y, x0, x1, static_cast<std::uint32_t>(in_row_.size())});
      in_row_.push_back(row);
    }
  }
  return rows;
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
  const std::vector<RowSpan> rows =
      rows_of(reaches, sees_ ? nearest_first() : largest_first(reaches));
  const auto each = [&](const auto& body) {
    for (const RowSpan& row : rows) {
      const std::size_t start = index(0, row.y);
      for (int x = row.x0; x < row.x1; ++x) body(start + static_cast<std::size_t>(x), row);
    }
  };
  each([&](std::size_t pixel, const RowSpan& row) {
    ++first_[pixel + 1];
    const Triangle& triangle = triangles_[row.triangle];
    if (triangle.is_disc)
      touch_[pixel] = Touch::kRays;
    else if (!triangle.opaque && touch_[pixel] != Touch::kRays)
      touch_[pixel] = Touch::kMixed;
    else if (!triangle.has_depth && touch_[pixel] == Touch::kNone)
      touch_[pixel] = Touch::kOpaqueByRays;
  });
  for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
    const std::uint32_t count = first_[pixel + 1];
    if (count > kMaxTriangles)
      touch_[pixel] = Touch::kRays;
    else if (touch_[pixel] == Touch::kNone && count > 0)
      touch_[pixel] = Touch::kOpaque;
    first_[pixel + 1] += first_[pixel];
  }
  by_pixel_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  each([&](std::size_t pixel, const RowSpan& row) {
    by_pixel_[next[pixel]++] = {row.triangle, row.in_row};
  });
}

std::span<const Silhouette::Entry> Silhouette::triangles_of(int x, int y) const {
  const std::size_t i = index(x, y);
  return {by_pixel_.data() + first_[i], by_pixel_.data() + first_[i + 1]};
}

Silhouette::Touch Silhouette::touch(int x, int y) const { return touch_[index(x, y)]; }

}  // namespace airtruth::render
