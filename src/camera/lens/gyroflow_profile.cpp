// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <string>

#include "camera/lens/calibration.h"
#include "foundation/json/json_object.h"

namespace airtruth::lens {
namespace {

// Refuses properties that change the position of a ray and that no lens model here has.
void refuse_what_cannot_be_honoured(const JsonObject& profile) {
  for (const char* key : {"input_horizontal_stretch", "input_vertical_stretch"})
    if (profile.maybe_number(key).value_or(1) != 1)
      profile.fail(key, "1; an anamorphic stretch cannot be honoured");
  const std::string model = profile.maybe_text("distortion_model").value_or("");
  if (!model.empty() && model != "opencv_fisheye")
    profile.fail("distortion_model",
                 "opencv_fisheye; no other model of Gyroflow's can be honoured");
  for (const char* key : {"digital_lens", "digital_lens_params"})
    if (!profile.maybe_text(key).value_or("").empty())
      profile.fail(key, "none; a digital lens cannot be honoured");
  if (profile.has("interpolations") && !profile.is_empty("interpolations"))
    profile.fail("interpolations", "none; a lens that changes with its zoom cannot be honoured");
  if (profile.maybe_truth("use_opencv_standard").value_or(false))
    profile.fail("use_opencv_standard", "false; no other model than the fisheye can be honoured");
  if (profile.maybe_number("crop").value_or(1) != 1)
    profile.fail("crop", "1; a crop cannot be honoured");
}

// The limit in a Gyroflow profile is a radius on the plane at distance 1, tan(angle); 0 means that
// there is none.
double stated_max_angle(const JsonObject& fisheye) {
  const char* key = "radial_distortion_limit";
  const double limit = fisheye.maybe_number(key).value_or(0);
  if (limit < 0) fisheye.fail(key, "the tangent of an angle, from 0");
  return limit == 0 ? kPi : std::atan(limit);
}

// The brand and the model, without characters that would break a message's line.
std::string camera_of(const JsonObject& profile) {
  std::string camera;
  for (const char* key : {"camera_brand", "camera_model"}) {
    const std::string text = profile.maybe_text(key).value_or("");
    if (!text.empty()) camera += (camera.empty() ? "" : " ") + text;
  }
  std::erase_if(camera, [](unsigned char c) { return c < 0x20 || c == 0x7f; });
  return camera;
}

}  // namespace

Calibration parse_gyroflow_profile(std::string_view text, const std::filesystem::path& name) {
  const JsonDocument document(text, {name.string()});
  const JsonObject profile = document.with_lines_of(text);
  refuse_what_cannot_be_honoured(profile);
  if (!profile.has("fisheye_params"))
    profile.fail("has no fisheye_params; expected a Gyroflow lens profile");
  const JsonObject fisheye = profile.object("fisheye_params");
  const JsonObject size = profile.object("calib_dimension");
  Calibration c;
  c.fisheye = true;
  const std::vector<double> matrix = fisheye.matrix("camera_matrix", 3, 3);
  std::copy(matrix.begin(), matrix.end(), c.camera_matrix.begin());
  c.distortion = fisheye.numbers("distortion_coeffs", 4);
  c.max_angle_rad = stated_max_angle(fisheye);
  c.size = {static_cast<int>(size.whole("w", 1, 65536)),
            static_cast<int>(size.whole("h", 1, 65536))};
  c.camera = camera_of(profile);
  return c;
}

}  // namespace airtruth::lens
