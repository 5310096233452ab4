// SPDX-License-Identifier: Apache-2.0
// Projects points through a lens and back. Needs airtruth::evaluation alone.
//
//   project_point [CALIBRATION WIDTH HEIGHT]
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include <airtruth/error.h>
#include <airtruth/lens.h>

int main(int argc, char** argv) try {
  // 1920 x 1080 pixels with a horizontal view of 60 degrees, or a calibration file.
  const airtruth::Lens lens =
      argc == 4 ? airtruth::Lens::from_file(argv[1], std::atoi(argv[2]), std::atoi(argv[3]))
                : airtruth::Lens::pinhole({1662.8, 1662.8}, {960, 540}, 1920, 1080);
  std::printf("%s, %d x %d, %.2f degrees wide\n",
              lens.model().c_str(),
              lens.width(),
              lens.height(),
              lens.horizontal_fov_deg());

  // The camera's axes: x right, y down, z forward; metres.
  for (const double right_m : {-100.0, 0.0, 10.0, 100.0}) {
    const std::array<double, 3> p_in_cam_m = {right_m, 0, 500};
    const auto pixel = lens.pixel_from_cam(p_in_cam_m);
    if (!pixel) {
      std::printf("(%g, 0, 500) m has no pixel\n", right_m);
      continue;
    }
    const auto ray = lens.ray_from_pixel(*pixel);  // the unit vector back
    const double range_m = std::hypot(right_m, 500);
    std::printf("(%g, 0, 500) m -> pixel (%.1f, %.1f) -> (%.3f, %.3f, %.3f) m\n",
                right_m,
                (*pixel)[0],
                (*pixel)[1],
                range_m * (*ray)[0],
                range_m * (*ray)[1],
                range_m * (*ray)[2]);
  }
} catch (const airtruth::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
