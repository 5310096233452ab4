// SPDX-License-Identifier: Apache-2.0
// The files that describe a camera: a camera.toml reads back from its own text, the lens of a
// calibration maps its rays to the pixels that they come from, and a path has a first place. All
// else is an Error.
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "camera/lens/calibration_file.h"
#include "foundation/base/error.h"
#include "scene/scene/scene.h"
#include "scene/trajectory/path.h"

namespace {

using namespace airtruth;

void read_camera(std::string_view text) {
  const scene::CameraFile camera = scene::parse_camera_file(text, "/fuzz/camera.toml");
  if (camera.width < 1 || camera.height < 1) std::abort();
  const std::string written = scene::toml_from_camera_model(camera.model);
  const std::string whole = "[clip]\nwidth = 1\nheight = 1\n" + written;
  if (toml_from_camera_model(scene::parse_camera_file(whole, "/fuzz/again.toml").model) != written)
    std::abort();
}

void read_lens(std::string_view text, const char* name) {
  constexpr lens::ImageSize kSize{640, 480};
  // The lens inverts its map within 1e-9 rad; one hundred times that leaves room for the rounding
  // of pixels far from the axis.
  constexpr double kMaxApart = 1e-7;
  const lens::Lens lens = lens::parse_calibration(text, name, kSize);
  if (lens.size() != kSize || !(lens.focal_px() > 0)) std::abort();
  for (const Pixel& pixel : {Pixel(320, 240), Pixel(1, 1), Pixel(639, 200)}) {
    const auto ray = lens.ray_from_pixel(pixel);
    if (!ray) continue;
    if (!(std::abs(ray->norm() - 1) < kMaxApart)) std::abort();
    const auto back = lens.pixel_from_cam(*ray);
    const auto again = back ? lens.ray_from_pixel(*back) : std::nullopt;
    if (again && !((*again - *ray).norm() < kMaxApart)) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  try {
    read_camera(text);
  } catch (const Error&) {
  }
  for (const char* name : {"a.yml", "a.json", "a.xml"}) {
    try {
      read_lens(text, name);
    } catch (const Error&) {
    }
  }
  try {
    const trajectory::Path path = trajectory::parse_path_csv(text, "a.csv");
    (void)path.at(path.start_s());
  } catch (const Error&) {
  }
  return 0;
}
