// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "aircraft/fleet/fleet.h"
#include "labels/projection/exact_box.h"
#include "picture/composite/cover.h"
#include "picture/composite/spread.h"
#include "picture/render/renderer.h"

// Compares the renderer, with motion blur and rolling shutter, with brute force: each pixel has 64
// x 64 places and 256 times. For each place the lens gives the ray, and each triangle is
// intersected with the ray in doubles, without interpolation, BVH or edge planes.
namespace airtruth::render {
namespace {

// Places along each side of a pixel.
constexpr int kPlaces = 64;
constexpr int kTimes = 256;

struct Setting {
  const char* name;
  lens::Lens lens;
  Shutter shutter;
  Twist camera;
  Twist body;
  Homography frame_from_nominal_per_s = Homography::Zero();
};

class Oracle {
 public:
  Oracle(const model::Mesh& mesh, const View& view, const Instance& instance)
      : mesh_(mesh), view_(view), instance_(instance) {
    for (const model::Part& part : mesh.parts)
      if (!part.spins)
        for (const model::Triangle& t : part.triangles)
          triangles_.push_back({mesh.positions[t.vertex[0]].cast<double>(),
                                mesh.positions[t.vertex[1]].cast<double>(),
                                mesh.positions[t.vertex[2]].cast<double>()});
    // The moments of all rows serve for a first, coarse test.
    const double half_s = (view.shutter.exposure_s + view.shutter.readout_s) / 2;
    std::vector<Then> moments;
    for (int k = -4; k <= 4; ++k) moments.push_back(at(half_s * k / 4));
    for (const Triangle& t : triangles_) over_all_.push_back(bounds_of(t, moments));
  }

  double alpha(int x, int y) const {
    const std::vector<std::size_t> near = near_pixel(x, y);
    if (near.empty()) return 0;
    std::vector<Then> moments;
    for (int k = 0; k < kTimes; ++k)
      moments.push_back(at(row_s(x, y) + view_.shutter.exposure_s * ((k + 0.5) / kTimes - 0.5)));
    // Where a quarter of the places agree, each at its own moment, the others agree as well.
    const int few = hits(x, y, near, moments, 2);
    if (few == 0) return 0;
    if (few == kPlaces * kPlaces / 4) return 1;
    return double(hits(x, y, near, moments, 1)) / (kPlaces * kPlaces);
  }

 private:
  using Triangle = std::array<Vector3, 3>;
  struct Then {
    View view;
    Rigid body_from_world;
  };

  int hits(int x,
           int y,
           const std::vector<std::size_t>& near,
           const std::vector<Then>& moments,
           int step) const {
    int count = 0;
    for (int j = step / 2; j < kPlaces; j += step)
      for (int i = step / 2; i < kPlaces; i += step) {
        // The places of one moment, and the moments of one row of places, are evenly distributed.
        const int moment = 77 * (i / step) + 111 * (j / step);
        const Then& then = moments[static_cast<std::size_t>(moment % kTimes)];
        const Pixel place(x + (i + 0.5) / kPlaces, y + (j + 0.5) / kPlaces);
        count += hit(then, place, near) ? 1 : 0;
      }
    return count;
  }

  Then at(double dt_s) const {
    return {view_.at(dt_s), carried(instance_.world_from_body, instance_.twist, dt_s).inverse()};
  }

  double row_s(int x, int y) const {
    return view_.shutter.middle_s({double(x), double(y)}, view_.width, view_.height);
  }

  bool hit(const Then& then, const Pixel& place, const std::vector<std::size_t>& near) const {
    const Vector3 h = then.view.nominal_from_frame * Vector3(place.x(), place.y(), 1);
    const auto ray = view_.lens->ray_from_pixel({h.x() / h.z(), h.y() / h.z()});
    if (!ray) return false;
    const Vector3 eye = then.body_from_world * then.view.world_from_cam.translation;
    const Vector3 d = then.body_from_world.rotation * (then.view.world_from_cam.rotation * *ray);
    return std::any_of(
        near.begin(), near.end(), [&](std::size_t t) { return meets(triangles_[t], eye, d); });
  }

  // Intersection by Moeller and Trumbore (1997).
  static bool meets(const Triangle& t, const Vector3& eye, const Vector3& d) {
    const Vector3 ab = t[1] - t[0];
    const Vector3 ac = t[2] - t[0];
    const Vector3 p = d.cross(ac);
    const double det = ab.dot(p);
    if (det == 0) return false;
    const Vector3 s = eye - t[0];
    const double u = s.dot(p) / det;
    if (u < 0 || u > 1) return false;
    const Vector3 q = s.cross(ab);
    const double v = d.dot(q) / det;
    return v >= 0 && u + v <= 1 && ac.dot(q) / det > 0;
  }

  // The triangles that come within two pixels of this pixel while its row is exposed.
  std::vector<std::size_t> near_pixel(int x, int y) const {
    std::vector<std::size_t> near;
    std::vector<Then> moments;
    for (int k = 0; k <= 4; ++k)
      moments.push_back(at(row_s(x, y) + view_.shutter.exposure_s * (k / 4.0 - 0.5)));
    for (std::size_t t = 0; t < triangles_.size(); ++t)
      if (reaches(over_all_[t], x, y, 6) && reaches(bounds_of(triangles_[t], moments), x, y, 2))
        near.push_back(t);
    return near;
  }

  static bool reaches(const std::optional<Box>& box, int x, int y, double margin_px) {
    return box && box->x - margin_px < x + 1 && box->right() + margin_px > x &&
           box->y - margin_px < y + 1 && box->bottom() + margin_px > y;
  }

  std::optional<Box> bounds_of(const Triangle& triangle, const std::vector<Then>& moments) const {
    BoxBounds bounds;
    for (const Then& then : moments)
      for (const Vector3& corner : triangle) {
        const Vector3 in_world = then.body_from_world.inverse() * corner;
        const auto p = view_.lens->pixel_from_cam(then.view.world_from_cam.inverse() * in_world);
        if (p) bounds.add(apply(then.view.nominal_from_frame.inverse(), *p));
      }
    return bounds.box();
  }

  const model::Mesh& mesh_;
  View view_;
  Instance instance_;
  std::vector<Triangle> triangles_;
  std::vector<std::optional<Box>> over_all_;
};

// A small aircraft of boxes and a slanted fin: opaque, with few triangles and thin parts.
model::Mesh toy() {
  model::Mesh mesh;
  mesh.materials.emplace_back();
  mesh.parts.push_back({.name = "airframe"});
  const auto box = [&](const Eigen::Vector3f& low, const Eigen::Vector3f& high) {
    const auto base = static_cast<std::uint32_t>(mesh.positions.size());
    for (int i = 0; i < 8; ++i) {
      mesh.positions.emplace_back(
          i & 1 ? high.x() : low.x(), i & 2 ? high.y() : low.y(), i & 4 ? high.z() : low.z());
      mesh.normals.emplace_back(0, 0, -1);
      mesh.uvs.emplace_back(0, 0);
    }
    constexpr std::array<std::array<std::uint32_t, 4>, 6> kFaces = {
        {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}}};
    for (const auto& f : kFaces) {
      mesh.parts[0].triangles.push_back({{base + f[0], base + f[1], base + f[2]}, 0});
      mesh.parts[0].triangles.push_back({{base + f[0], base + f[2], base + f[3]}, 0});
    }
  };
  box({-6, -0.7F, -0.8F}, {6, 0.7F, 0.8F});                                    // fuselage
  box({-1, -8, -0.15F}, {1.4F, 8, 0.1F});                                      // wing
  box({-6, -3, -0.1F}, {-4.8F, 3, 0.05F});                                     // tail
  box({-6, -0.08F, -3}, {-4.6F, 0.08F, -0.6F});                                // fin
  for (Eigen::Vector3f& p : mesh.positions) p.z() -= 0.12F * std::abs(p.y());  // dihedral
  return mesh;
}

std::vector<Setting> settings() {
  const lens::ImageSize size{640, 480};
  const lens::Lens pinhole = lens::pinhole_from_vertical_fov(40, size);
  const lens::Lens fisheye(lens::Fisheye{{300, 301}, {322, 238}, {0.06, 0.016, -0.01, 0.004}},
                           size);
  const lens::Lens bent(lens::BrownConrady{{500, 500}, {318, 242}, {-0.25, 0.08, 1e-3, -5e-4}},
                        size);
  const Twist shake{{25, 0, 0}, {0.25, -0.4, 0.6}};
  const Twist flight{{60, 35, -8}, {0.5, 0.1, 0.2}};
  Homography drift;
  drift << 0.02, -0.4, 160, 0.4, 0.02, -90, 1e-5, -2e-5, 0;
  return {
      {"pinhole, blur", pinhole, {0.02, 0, Readout::kDown}, shake, flight},
      {"pinhole, plane shake, rolling", pinhole, {0.01, 0.025, Readout::kDown}, {}, flight, drift},
      {"fisheye, blur and rolling", fisheye, {0.015, 0.02, Readout::kUp}, shake, flight},
      {"fisheye, rolling alone", fisheye, {0, 0.03, Readout::kRight}, shake, flight},
      {"brown_conrady, blur", bent, {0.02, 0.01, Readout::kLeft}, shake, flight}};
}

struct Scene {
  View view;
  Instance instance;
  Box search;
  std::optional<Box> exact;
};

Scene scene_of(const Setting& setting,
               const model::Mesh& mesh,
               const shade::Model& model,
               double size_px) {
  Scene scene;
  scene.view = {&setting.lens,
                Rigid{cam_from_body().conjugate(), Vector3::Zero()},
                Homography::Identity(),
                setting.lens.size().width,
                setting.lens.size().height,
                setting.shutter,
                setting.camera,
                setting.frame_from_nominal_per_s};
  const double range_m = 16 * setting.lens.focal_px() / size_px;
  const Vector3 place = range_m * Vector3(0.97, 0.2, -0.12).normalized();
  // Speeds grow with the range, so that the blur is a few pixels at any range.
  Twist body = setting.body;
  body.velocity_mps *= std::max(1.0, range_m / 300);
  scene.instance = {&model, {airtruth::world_from_body({70, 8, 20}), place}, 0, body};
  const projection::SilhouettePoints silhouette{&mesh, model::silhouette_points(mesh)};
  const projection::Sight sight{&setting.lens,
                                scene.view.world_from_cam.inverse(),
                                Homography::Identity(),
                                setting.shutter,
                                setting.camera,
                                setting.frame_from_nominal_per_s};
  scene.exact =
      projection::exact_box(sight, silhouette, scene.instance.world_from_body, 0, body).box;
  scene.search = {
      scene.exact->x - 1.5, scene.exact->y - 1.5, scene.exact->width + 3, scene.exact->height + 3};
  return scene;
}

// The alpha of brute force after a Gaussian blur, pixel by pixel in doubles. The share of a pixel's
// light that reaches another pixel is the product of two integrals of the normal distribution.
double alpha_through(
    const std::vector<double>& alpha, const PixelBox& patch, double sigma_px, int x, int y) {
  const auto landed = [&](int from, int to) {
    const double unit = sigma_px * std::sqrt(2.0);
    return 0.5 * (std::erf((to - from + 0.5) / unit) - std::erf((to - from - 0.5) / unit));
  };
  double sum = 0;
  std::size_t i = 0;
  for (int v = patch.y; v < patch.bottom(); ++v)
    for (int u = patch.x; u < patch.right(); ++u, ++i)
      if (alpha[i] > 0 && std::abs(u - x) < 9 && std::abs(v - y) < 9)
        sum += alpha[i] * landed(u, x) * landed(v, y);
  return sum;
}

// Compares the covered box of the layer after a point spread with that of brute force.
void compare_covered(const image::Layer& layer,
                     const std::vector<double>& oracle,
                     const View& view,
                     const std::string& where) {
  constexpr double kSigmaPx = 0.8;
  constexpr double kLimit = (composite::kCoveredAlpha - 0.5) / 255;
  // Within this distance from the limit, either answer is correct.
  constexpr double kOff = 0.01;
  const auto covered = composite::covered(
      composite::spread(layer, {kSigmaPx, kSigmaPx}, 0, view.width, view.height), 0);
  std::optional<PixelBox> surely, perhaps;
  const PixelBox& p = layer.patch;
  const PixelBox frame{0, 0, view.width, view.height};
  const PixelBox all = *intersection({p.x - 4, p.y - 4, p.width + 8, p.height + 8}, frame);
  for (int y = all.y; y < all.bottom(); ++y)
    for (int x = all.x; x < all.right(); ++x) {
      const double alpha = alpha_through(oracle, p, kSigmaPx, x, y);
      const PixelBox one{x, y, 1, 1};
      if (alpha > kLimit + kOff) surely = surely ? bounds(*surely, one) : one;
      if (alpha > kLimit - kOff) perhaps = perhaps ? bounds(*perhaps, one) : one;
    }
  ASSERT_TRUE(covered && surely && perhaps) << where;
  EXPECT_EQ(bounds(covered->box, *surely), covered->box) << where;
  EXPECT_EQ(bounds(*perhaps, covered->box), *perhaps) << where;
}

// Compares every pixel of the patch, the box of the visible pixels and the centroid. Returns the
// largest alpha error.
double compare_all(const Setting& setting,
                   const model::Mesh& mesh,
                   const shade::Model& model,
                   double size_px) {
  const std::string where = fmt::format("{} at {} px", setting.name, size_px);
  const Scene scene = scene_of(setting, mesh, model, size_px);
  const image::Layer layer = render(scene.view, {}, {scene.instance}, {scene.search});
  const Oracle oracle(mesh, scene.view, scene.instance);
  std::vector<double> oracle_alpha;
  double worst = 0, sum = 0, oracle_sum = 0;
  Pixel centroid(0, 0), oracle_centroid(0, 0);
  std::optional<PixelBox> box, oracle_box, surely, perhaps;
  for (int y = layer.patch.y; y < layer.patch.bottom(); ++y)
    for (int x = layer.patch.x; x < layer.patch.right(); ++x) {
      const double alpha = layer.pixels[layer.index(x, y)].alpha;
      const double truth = oracle.alpha(x, y);
      oracle_alpha.push_back(truth);
      worst = std::max(worst, std::abs(alpha - truth));
      sum += alpha, centroid += alpha * Pixel(x + 0.5, y + 0.5);
      oracle_sum += truth, oracle_centroid += truth * Pixel(x + 0.5, y + 0.5);
      // Least alpha that changes a code value; a smaller one is not visible.
      constexpr double kSeen = 1.0 / 64;
      const PixelBox one{x, y, 1, 1};
      if (alpha > kSeen) box = box ? bounds(*box, one) : one;
      if (truth > kSeen) oracle_box = oracle_box ? bounds(*oracle_box, one) : one;
      // Where brute force itself is this close to the limit, either answer is correct.
      if (truth > 1.5 * kSeen) surely = surely ? bounds(*surely, one) : one;
      if (truth > 0.5 * kSeen) perhaps = perhaps ? bounds(*perhaps, one) : one;
    }
  if (size_px < 100) compare_covered(layer, oracle_alpha, scene.view, where);
  const double off = (centroid / sum - oracle_centroid / oracle_sum).norm();
  std::printf("%s: alpha within %.4f, centroid within %.4f px\n", where.c_str(), worst, off);
  EXPECT_LT(off, 0.05) << where;
  EXPECT_TRUE(box && oracle_box && surely && perhaps) << where;
  if (!box || !oracle_box || !surely || !perhaps) return worst;
  EXPECT_EQ(bounds(*box, *surely), *box) << where;
  EXPECT_EQ(bounds(*box, *perhaps), *perhaps) << where;
  // The exact box is an independent result.
  const auto frame = [&](double v, int most) { return std::clamp(v, 0.0, double(most)); };
  EXPECT_LE(frame(scene.exact->x, scene.view.width), oracle_box->x + 1) << where;
  EXPECT_GE(frame(scene.exact->x, scene.view.width), oracle_box->x - 1.05) << where;
  EXPECT_LE(frame(scene.exact->y, scene.view.height), oracle_box->y + 1) << where;
  EXPECT_GE(frame(scene.exact->y, scene.view.height), oracle_box->y - 1.05) << where;
  EXPECT_GE(frame(scene.exact->right(), scene.view.width), oracle_box->right() - 1) << where;
  EXPECT_LE(frame(scene.exact->right(), scene.view.width), oracle_box->right() + 1.05) << where;
  EXPECT_GE(frame(scene.exact->bottom(), scene.view.height), oracle_box->bottom() - 1) << where;
  EXPECT_LE(frame(scene.exact->bottom(), scene.view.height), oracle_box->bottom() + 1.05) << where;
  return worst;
}

TEST(Exposure, AlphaBoxAndCentroidAgreeWithBruteForceThroughEveryLens) {
  const model::Mesh mesh = toy();
  const shade::Model model(mesh);
  const std::vector<Setting> all = settings();
  for (const Setting& setting : all) {
    for (const double size_px : {5.0, 20.0, 60.0})
      EXPECT_LT(compare_all(setting, mesh, model, size_px), 1.0 / 64) << setting.name;
    // This comparison is slow, so each lens has it once, with blur and rolling shutter.
    if (setting.shutter.exposure_s > 0 && setting.shutter.readout_s > 0) {
      EXPECT_LT(compare_all(setting, mesh, model, 400), 1.0 / 64) << setting.name;
    }
  }
}

// An airliner from FlightGear with engines and fins.
TEST(Exposure, ARealAircraftAgreesWithBruteForce) {
  const fleet::Aircraft airliner = fleet::load_aircraft("738/738-Ryanair");
  const shade::Model model(airliner.mesh);
  const std::vector<Setting> all = settings();
  EXPECT_LT(compare_all(all[2], airliner.mesh, model, 20), 1.0 / 64);
  // The tolerance is 64 of the 4,096 places of brute force, the largest permitted error.
  EXPECT_LE(compare_all(all[4], airliner.mesh, model, 60), 1.0 / 64);
}

}  // namespace
}  // namespace airtruth::render
