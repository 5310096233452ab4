// SPDX-License-Identifier: Apache-2.0
#include "scene/synthetic/own_aircraft.h"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

// Shapes are distance fields in the camera's body frame (x forward, y right, z down, metres), drawn
// by sphere tracing (Hart 1996). The coverage at an edge follows from the smallest distance
// relative to the width of the pixel's cone.
namespace airtruth::synthetic {
namespace {

using Point = Eigen::Array3f;

enum class Part { kWing, kBody, kBoom, kNose, kWheel };

struct NearestPart {
  float distance_m = 1e9F;
  Part part = Part::kWing;
};

// Where a constant of this file states no origin, it is a choice: the world is invented.

// Half of the wing's span, the wing's distance ahead of the camera, and a distance beyond all
// parts.
constexpr float kHalfSpan_m = 2.45F;
constexpr float kWingAhead_m = 2.35F;
constexpr float kFarthestPart_m = 6;

float length(float x, float y, float z) { return std::sqrt(x * x + y * y + z * z); }

// A lower bound of the distance to an ellipsoid.
float ellipsoid(const Point& p, const Point& radii) {
  const Point a = p / radii;
  const Point b = a / radii;
  const float k0 = length(a[0], a[1], a[2]);
  const float k1 = length(b[0], b[1], b[2]);
  return k1 < 1e-6F ? -radii.minCoeff() : k0 * (k0 - 1) / k1;
}

float cone(const Point& p, const Point& from, const Point& to, float radius_from, float radius_to) {
  const Point along = to - from;
  const float t = clamp01(((p - from) * along).sum() / (along * along).sum());
  const Point d = p - from - along * t;
  return length(d[0], d[1], d[2]) - lerp(radius_from, radius_to, t);
}

struct WingPlace {
  // 0 at the root, 1 at the tip.
  float span;
  float chord_m;
  // 0 at the leading edge, 1 at the trailing edge.
  float behind;
};

WingPlace wing_place(const Point& p) {
  const float span = std::min(std::abs(p[1]) / kHalfSpan_m, 1.0F);
  const float chord = lerp(0.52F, 0.30F, span * span);
  const float leading = kWingAhead_m + 0.22F - 0.10F * span;
  return {span, chord, (leading - p[0]) / chord};
}

float wing(const Point& p) {
  const WingPlace w = wing_place(p);
  const float centre_x = kWingAhead_m + 0.22F - 0.10F * w.span - 0.5F * w.chord_m;
  const float y = std::abs(p[1]);
  const float lift = 0.045F * w.span + 0.10F * w.span * w.span;
  const float dx = p[0] - centre_x;
  // Camber lowers the trailing edge.
  const float dz = p[2] - (0.66F - lift) - 0.05F * (dx < 0 ? -dx : 0.4F * dx);
  const float beyond = std::max(y - kHalfSpan_m, 0.0F);
  const Point local(dx, beyond, dz);
  return 0.8F * ellipsoid(local, Point(0.5F * w.chord_m, 0.06F, 0.058F * w.chord_m));
}

NearestPart nearest(const Point& p) {
  NearestPart best;
  const auto add = [&](float d, Part part) {
    if (d < best.distance_m) best = {d, part};
  };
  add(wing(p), Part::kWing);
  add(ellipsoid(p - Point(2.55F, 0, 0.72F), Point(0.98F, 0.235F, 0.225F)), Part::kBody);
  add(ellipsoid(p - Point(2.15F, 0, 0.60F), Point(0.42F, 0.13F, 0.10F)), Part::kBody);
  add(cone(p, Point(-0.4F, 0, 0.62F), Point(2.0F, 0, 0.74F), 0.07F, 0.15F), Part::kBoom);
  add(cone(p, Point(3.30F, 0, 0.72F), Point(3.55F, 0, 0.73F), 0.135F, 0.05F), Part::kNose);
  const Point q(p[0], std::abs(p[1]), p[2]);
  add(cone(q, Point(2.25F, 0.12F, 0.86F), Point(2.15F, 0.48F, 1.08F), 0.025F, 0.018F), Part::kBoom);
  add(ellipsoid(q - Point(2.15F, 0.50F, 1.10F), Point(0.13F, 0.05F, 0.12F)), Part::kWheel);
  add(cone(p, Point(1.75F, 0, 0.62F), Point(1.68F, 0, 0.47F), 0.010F, 0.006F), Part::kWheel);
  return best;
}

Point normal(const Point& p) {
  constexpr float h = 0.0015F;
  const auto d = [&](float x, float y, float z) { return nearest(p + Point(x, y, z)).distance_m; };
  const Point n(d(h, 0, 0) - d(-h, 0, 0), d(0, h, 0) - d(0, -h, 0), d(0, 0, h) - d(0, 0, -h));
  const float size = length(n[0], n[1], n[2]);
  return size > 0 ? Point(n / size) : Point(0, 0, -1);
}

// The paint: white wings with orange tips and dark hinge lines, a grey body, a black nose and black
// wheels.
LinearRgb paint(const Point& p, Part part) {
  const float grime = 0.90F + 0.14F * fractal<4>(256, 99).at(p[0] * 9 + 40, p[1] * 9 + 40);
  if (part == Part::kWheel) return linear_rgb(0.03F, 0.03F, 0.032F);
  if (part == Part::kNose) return linear_rgb(0.07F, 0.07F, 0.075F);
  if (part == Part::kBoom) return grime * linear_rgb(0.50F, 0.51F, 0.52F);
  if (part == Part::kBody) {
    const float seam = std::min(std::abs(p[0] - 2.95F), std::abs(p[0] - 1.95F));
    const float dark = lerp(0.55F, 1.0F, smoothstep(0.004F, 0.010F, seam));
    return grime * dark * linear_rgb(0.64F, 0.645F, 0.65F);
  }
  const WingPlace w = wing_place(p);
  LinearRgb colour = linear_rgb(0.74F, 0.74F, 0.72F);
  if (w.span > 0.86F) colour = linear_rgb(0.72F, 0.20F, 0.05F);
  float seam = 1;
  if (w.span > 0.22F && w.span < 0.93F) seam = std::abs(w.behind - 0.74F) * w.chord_m;
  for (const float at : {0.22F, 0.56F, 0.93F})
    if (w.behind > 0.74F) seam = std::min(seam, std::abs(w.span - at) * kHalfSpan_m);
  seam = std::min(seam, std::abs(w.span - 0.38F) * kHalfSpan_m + 0.003F);
  return grime * lerp(0.35F, 1.0F, smoothstep(0.003F, 0.010F, seam)) * colour;
}

float shadow(const Point& from, const Point& sun) {
  float lit = 1;
  float t = 0.03F;
  for (int i = 0; i < 24 && t < 1.5F; ++i) {
    const float d = nearest(from + sun * t).distance_m;
    if (d < 0.001F) return 0;
    lit = std::min(lit, 14 * d / t);
    t += std::max(d, 0.02F);
  }
  return clamp01(lit);
}

struct Scene {
  Point sun;
  LinearRgb sunlight;
};

LinearRgb shaded(const Point& p, Part part, const Point& ray, const Scene& scene) {
  const Point n = normal(p);
  const float facing = std::max((n * scene.sun).sum(), 0.0F);
  const float lit = facing > 0 ? facing * shadow(p + n * 0.015F, scene.sun) : 0.0F;
  const float up = 0.5F - 0.5F * n[2];
  const LinearRgb ambient =
      linear_rgb(0.26F, 0.34F, 0.46F) * up + linear_rgb(0.20F, 0.17F, 0.12F) * (1 - up);
  const Point half = (scene.sun - ray).matrix().normalized().array();
  const float gleam =
      0.30F * std::pow(std::max((n * half).sum(), 0.0F), 60.0F) * (lit > 0 ? 1.0F : 0.0F);
  const float rim = std::pow(1 - clamp01(-(n * ray).sum()), 4.0F);
  return paint(p, part) * (scene.sunlight * lit + ambient) + scene.sunlight * gleam +
         linear_rgb(0.30F, 0.36F, 0.42F) * (0.25F * rim);
}

// Premultiplied colour and coverage of one ray from the camera.
LinearRgb trace(const Point& ray, float pixel_rad, const Scene& scene) {
  float t = 0.45F;
  float closest = 1e9F;
  float closest_t = t;
  Part part = Part::kWing;
  for (int i = 0; i < 140 && t < kFarthestPart_m; ++i) {
    const NearestPart here = nearest(ray * t);
    const float relative = here.distance_m / (t * pixel_rad);
    if (relative < closest) {
      closest = relative;
      closest_t = t;
      part = here.part;
    }
    if (here.distance_m < 0.0002F) break;
    t += std::max(here.distance_m, 0.0004F);
  }
  const float covered = clamp01(1.1F * (1 - closest));
  if (covered <= 0) return LinearRgb::Zero();
  LinearRgb colour = shaded(ray * closest_t, part, ray, scene) * covered;
  colour[3] = covered;
  return colour;
}

// True where a ray of the block may touch the aircraft: one ray tests whether the distance relative
// to the block's cone becomes small enough. Blocks without a touch are skipped.
bool may_touch(const Point& ray, float block_rad) {
  float t = 0.45F;
  for (int i = 0; i < 60 && t < kFarthestPart_m; ++i) {
    const float d = nearest(ray * t).distance_m;
    if (d < t * block_rad) return true;
    t += std::max(d - t * block_rad, 0.01F);
  }
  return false;
}

// Side of a block of pixels, for which one ray tests whether the aircraft may be there.
constexpr int kBlock = 8;

// Marks the pixels of the layer in the mask, and where each row begins and ends.
void mark_layer(OwnAircraft& own, int width, int height) {
  const auto w = static_cast<std::size_t>(width);
  for (std::size_t y = 0; y < static_cast<std::size_t>(height); ++y)
    for (std::size_t x = 0; x < w; ++x) {
      if (own.layer[y * w + x][3] <= 0) continue;
      own.mask.free[y * w + x] = 0;
      own.first[y] = std::min(own.first[y], static_cast<int>(x));
      own.last[y] = static_cast<int>(x) + 1;
    }
}

}  // namespace

OwnAircraft draw_own_aircraft(const lens::Lens& lens,
                              const Vector3& sun_in_body,
                              const Sky& sky,
                              bool visible) {
  const int width = lens.size().width;
  const int height = lens.size().height;
  const auto w = static_cast<std::size_t>(width);
  const auto h = static_cast<std::size_t>(height);
  OwnAircraft own{std::vector<LinearRgb>(w * h, LinearRgb::Zero()),
                  std::vector<int>(h, width),
                  std::vector<int>(h, 0),
                  {width, height, std::vector<unsigned char>(w * h, 255)}};
  const Scene scene{sun_in_body.cast<float>().array(), sky.sunlight()};
  const auto pixel_rad = static_cast<float>(1 / lens.focal_px());
  const Quaternion body_from_cam = cam_from_body().conjugate();
  const auto ray_in_body = [&](double x, double y) -> std::optional<Point> {
    const auto ray = lens.ray_from_pixel({x, y});
    if (!ray) return std::nullopt;
    return Point((body_from_cam * *ray).cast<float>().array());
  };
  const int columns = (width + kBlock - 1) / kBlock;
  tbb::parallel_for(0, (height + kBlock - 1) / kBlock, [&](int block_y) {
    for (int block_x = 0; block_x < columns; ++block_x) {
      const auto middle =
          ray_in_body(block_x * kBlock + 0.5 * kBlock, block_y * kBlock + 0.5 * kBlock);
      const bool near = visible && middle && may_touch(*middle, 9 * pixel_rad);
      for (int y = block_y * kBlock; y < std::min((block_y + 1) * kBlock, height); ++y)
        for (int x = block_x * kBlock; x < std::min((block_x + 1) * kBlock, width); ++x) {
          const std::size_t i = static_cast<std::size_t>(y) * w + static_cast<std::size_t>(x);
          if (middle && !near) continue;
          const auto ray = ray_in_body(x + 0.5, y + 0.5);
          own.layer[i] = !ray   ? LinearRgb(0, 0, 0, 1)
                         : near ? trace(*ray, pixel_rad, scene)
                                : LinearRgb::Zero();
        }
    }
  });
  mark_layer(own, width, height);
  return own;
}

}  // namespace airtruth::synthetic
