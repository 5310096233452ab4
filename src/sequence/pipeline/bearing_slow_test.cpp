// SPDX-License-Identifier: Apache-2.0
// Compares bearings on a real clip with large rotations with the positions of the pixels.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "foundation/base/files.h"
#include "foundation/geometry/transform.h"
#include "sequence/pipeline/render.h"
#include "sequence/replay/finished.h"
#include "sequence/setup/from_scene.h"
#include "sequence/setup/world.h"
#include "support/shared_folder.h"
#include "support/temporary_folder.h"

namespace airtruth::pipeline {
namespace {

double median_of(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + std::ssize(values) / 2, values.end());
  return values[values.size() / 2];
}

// The centre of what is covered is some pixels off the reference point: a fraction of the box.
TEST(BearingOnARealClip, AgreesWithThePixelAndNotWithTheNominalBoresight) {
  const char* shared = test_support::shared_folder();
  if (shared == nullptr) GTEST_SKIP() << "AIRTRUTH_SHARED is not set: the clip is not here";
  const fs::path clip = fs::path(shared) / "footage/fixed-wing/overcast_b4.mp4";
  if (!fs::exists(clip)) GTEST_SKIP() << clip << " is not there";
  const test_support::TemporaryFolder temporary;
  const fs::path root = temporary.path();
  for (const char* model : {"homography", "rotation"}) {
    const std::string text =
        std::string("name = \"") + model + "\"\n[background]\nvideo = \"" + clip.string() +
        "\"\nfirst_frame = 300\nframe_count = 240\n"
        "[lens]\nvertical_fov_deg = 50\n[camera]\nposition_ned_m = [0, 0, -150]\n"
        "velocity_ned_mps = [20, 0, 0]\nattitude_yaw_pitch_roll_deg = [0, 0, 0]\n[motion]\nmodel = "
        "\"" +
        model +
        "\"\nreference = \"smoothed\"\n[[intruder]]\naircraft = \"738/738-Ryanair\"\n"
        "waypoints_ned_m = [[500, -40, -160], [660, 60, -160]]\ntimes_s = [0, 8]\n"
        "[render]\nquality = 1\n";
    Options options;
    options.use_cache = false;
    const replay::Finished finished = replay::open_finished(
        render(scene::parse_scene(text, root / "scene.toml"), root, options).folder);
    const lens::Lens lens = setup::lens_of(finished.scene->lens,
                                           {finished.truth.lens.width, finished.truth.lens.height});
    std::vector<double> seen_px, nominal_deg;
    for (const annotation::Frame& frame : finished.truth.frames) {
      const annotation::Intruder& one = frame.intruders[0];
      if (!one.centroid_px || one.cut_by_frame > 0) continue;
      ASSERT_TRUE(one.azimuth_deg && one.nominal_azimuth_deg);
      const Vector3 seen = cam_from_body() * unit_vector(*one.azimuth_deg, *one.elevation_deg);
      const Vector3 nominal =
          cam_from_body() * unit_vector(*one.nominal_azimuth_deg, *one.nominal_elevation_deg);
      const Pixel centroid = pixel_of(*one.centroid_px);
      seen_px.push_back((*lens.pixel_from_cam(seen) - centroid).norm());
      const auto ray = lens.ray_from_pixel(centroid);
      nominal_deg.push_back(degrees(std::acos(std::clamp(ray->dot(nominal), -1.0, 1.0))));
      EXPECT_LT(seen_px.back(), 0.5 * std::hypot(one.exact_box_px->width, one.exact_box_px->height))
          << model << ' ' << frame.frame;
    }
    ASSERT_GT(seen_px.size(), 60u) << model;
    std::printf(
        "%s: %zu frames, centroid off the bearing's pixel %.2f px in the median; off the "
        "nominal bearing %.2f degrees in the median, %.2f at most\n",
        model,
        seen_px.size(),
        median_of(seen_px),
        median_of(nominal_deg),
        *std::max_element(nominal_deg.begin(), nominal_deg.end()));
    EXPECT_GT(*std::max_element(nominal_deg.begin(), nominal_deg.end()), 1) << model;
  }
}

}  // namespace
}  // namespace airtruth::pipeline
