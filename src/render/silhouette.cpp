// SPDX-License-Identifier: Apache-2.0
#include "render/silhouette.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <variant>

namespace airtruth::render {
namespace {

// More triangles than this over one pixel, and rays are faster.
constexpr std::size_t kMostTriangles = 192;
// More entries than this in the lists of a patch (an aircraft that closes round the eye), and rays
// do all of it.
constexpr std::uint64_t kMostEntries = std::uint64_t{1} << 25;
constexpr double kMarginPx = 0.02;
// A side shorter than this is as good as straight under any lens.
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

// The value of a side's product over a pixel: a + b x + c y + d x y, in units of its largest
// corner.
struct Bilinear {
  float a = 0, b = 0, c = 0, d = 0;
};

Bilinear bilinear_of(const std::array<double, 4>& corner) {
  double largest = 0;
  for (const double value : corner) largest = std::max(largest, std::abs(value));
  const double scale = 1 / largest;
  return {static_cast<float>(corner[0] * scale),
          static_cast<float>((corner[1] - corner[0]) * scale),
          static_cast<float>((corner[2] - corner[0]) * scale),
          static_cast<float>((corner[0] - corner[1] - corner[2] + corner[3]) * scale)};
}

struct Places {
  alignas(32) std::array<float, PixelSamples::kMost> x;
  alignas(32) std::array<float, PixelSamples::kMost> y;
};

// The same instructions in vectors of 16, 8 or 4, as the machine has them. No product is fused with
// its sum (-ffp-contract=off), so that the answers are the same bits on all of them.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__)
#define AIRTRUTH_VECTORS __attribute__((target_clones("arch=x86-64-v4", "avx2", "default")))
#else
#define AIRTRUTH_VECTORS
#endif

// Marks the samples on the inner side of all three (an unused one is +1 everywhere); true where
// every sample is marked by now.
AIRTRUTH_VECTORS
bool mark(const Bilinear* sides, const float* px, const float* py, int n, std::int32_t* covered) {
  const Bilinear p = sides[0];
  const Bilinear q = sides[1];
  const Bilinear r = sides[2];
  std::int32_t all = -1;
  for (int i = 0; i < n; ++i) {
    const float x = px[i];
    const float y = py[i];
    const float u = (p.a + p.b * x) + y * (p.c + p.d * x);
    const float v = (q.a + q.b * x) + y * (q.c + q.d * x);
    const float w = (r.a + r.b * x) + y * (r.c + r.d * x);
    const std::int32_t inside = -static_cast<std::int32_t>((u >= 0) & (v >= 0) & (w >= 0));
    const std::int32_t now = covered[i] | inside;
    covered[i] = now;
    all &= now;
  }
  return all == -1;
}

// The same for the only side that crosses the pixel.
AIRTRUTH_VECTORS
bool mark_one(
    const Bilinear* side, const float* px, const float* py, int n, std::int32_t* covered) {
  const Bilinear p = *side;
  std::int32_t all = -1;
  for (int i = 0; i < n; ++i) {
    const float u = (p.a + p.b * px[i]) + py[i] * (p.c + p.d * px[i]);
    const std::int32_t now = covered[i] | -static_cast<std::int32_t>(u >= 0);
    covered[i] = now;
    all &= now;
  }
  return all == -1;
}

}  // namespace

struct Silhouette::Eye {
  const View& view;
  Homography frame_from_nominal;
  Quaternion cam_from_world;

  std::optional<Pixel> pixel(const Vector3& in_world) const {
    return frame_pixel(view, frame_from_nominal, cam_from_world, in_world);
  }
  bool is_pinhole() const { return std::holds_alternative<lens::Pinhole>(view.lens->model()); }
  double depth(const Vector3& in_world) const { return (cam_from_world * in_world).z(); }
};

Silhouette::Silhouette(const Actor& actor, const View& view, const PixelBox& patch)
    : patch_(patch) {
  std::vector<Reach> reaches;
  for (std::size_t part = 0; part < actor.placed.model->mesh.parts.size(); ++part)
    add_part(actor, part, view, reaches);
  sort_by_pixel(reaches);
}

void Silhouette::add_part(const Actor& actor,
                          std::size_t part,
                          const View& view,
                          std::vector<Reach>& reaches) {
  const Model::Impl& model = *actor.placed.model;
  const aircraft::Mesh& mesh = model.mesh;
  const Matrix3 world_from_body = actor.body_from_world.transpose();
  const Eye eye{view, view.nominal_from_frame.inverse(), view.world_from_cam.rotation.conjugate()};
  const Vector3 nowhere = Vector3::Constant(std::numeric_limits<double>::quiet_NaN());
  std::vector<Seen> seen(mesh.positions.size());
  std::vector<bool> known(mesh.positions.size(), false);
  const auto at = [&](std::uint32_t vertex) -> const Seen& {
    Seen& result = seen[vertex];
    if (known[vertex]) return result;
    known[vertex] = true;
    const Eigen::Vector3f in_body = actor.placed.body_from_part[part] * mesh.positions[vertex];
    result.in_world = world_from_body * (in_body.cast<double>() - actor.eye_in_body);
    const auto pixel = eye.pixel(result.in_world);
    result.pixel = pixel ? *pixel : Pixel(nowhere.head<2>());
    return result;
  };
  const auto& source = mesh.parts[part].triangles;
  for (std::size_t i = 0; i < source.size(); ++i) {
    const std::array<const Seen*, 3> corners = {
        &at(source[i].vertex[0]), &at(source[i].vertex[1]), &at(source[i].vertex[2])};
    const Reach reach = reach_of(corners, eye);
    if (reach.x0 >= reach.x1 || reach.y0 >= reach.y1) continue;
    const Vector3& a = corners[0]->in_world;
    const Vector3& b = corners[1]->in_world;
    const Vector3& c = corners[2]->in_world;
    Triangle triangle{{a.cross(b), b.cross(c), c.cross(a)}, model.opaque[part][i] != 0};
    const double turn = a.dot(triangle.side[1]);
    if (turn == 0) continue;  // seen from its edge
    if (turn < 0)
      for (Vector3& side : triangle.side) side = -side;
    triangles_.push_back(triangle);
    reaches.push_back(reach);
  }
}

// The picture of the part of a triangle that lies before a pinhole's plane; empty where none does,
// or where a point of it has no picture.
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

// A box about the triangle's picture. Its sides may bend under a wide lens: by twice what their
// middles do, at most.
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
      // The middle of the side's picture, not of the side: the point's weight is its nearness.
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

void Silhouette::cover(
    int x, int y, const std::array<Vector3, 4>& corners, int samples, Cover& result) const {
  result.is_covered.assign(static_cast<std::size_t>(samples), 0);
  std::int32_t* covered = result.is_covered.data();
  Places places;
  bool placed = false;
  bool full = false;
  for (const std::uint32_t index : triangles_of(x, y)) {
    std::array<Bilinear, 3> sides = {{{1, 0, 0, 0}, {1, 0, 0, 0}, {1, 0, 0, 0}}};
    std::size_t crossing = 0;
    bool outside = false;
    for (const Vector3& side : triangles_[index].side) {
      std::array<double, 4> at;
      int inner = 0;
      for (std::size_t k = 0; k < 4; ++k) {
        at[k] = side.dot(corners[k]);
        inner += at[k] >= 0 ? 1 : 0;
      }
      if (inner == 4) continue;
      outside = outside || inner == 0;
      sides[crossing++] = bilinear_of(at);
    }
    if (outside) continue;
    if (!placed && crossing > 0) PixelSamples(x, y).fill(samples, places.x.data(), places.y.data());
    placed = placed || crossing > 0;
    if (crossing == 0)
      full = true;
    else if (crossing == 1)
      full = mark_one(sides.data(), places.x.data(), places.y.data(), samples, covered);
    else
      full = mark(sides.data(), places.x.data(), places.y.data(), samples, covered);
    if (full) break;
  }
  if (full) std::fill_n(covered, samples, -1);
  result.covered = -std::accumulate(covered, covered + samples, 0);
}

}  // namespace airtruth::render
