// SPDX-License-Identifier: Apache-2.0
#include "dataset/set_report/card.h"

#include <gtest/gtest.h>

namespace airtruth::set_report {
namespace {

scene::Scene plain(scene::MotionModel motion) {
  scene::Scene scene;
  scene.motion.model = motion;
  return scene;
}

TEST(Card, SaysOfTheIntrudersLightWhatWasDone) {
  const scene::Scene without = plain(scene::MotionModel::kHomography);
  EXPECT_EQ(
      camera_sentence({without}),
      "none of what a camera and the air do. Not on the intruder: motion blur of the exposure, "
      "rolling shutter, haze, point spread, sharpening, sensor noise, soft chroma, the codec's "
      "quantiser, a tone curve other than sRGB's");
  scene::Scene with = without;
  with.camera_model.exposure_s = 0.01;
  with.camera_model.readout_s = 0.02;
  with.camera_model.extinction_per_km = {{0, 0.1, 0}};
  with.camera_model.point_spread_px = 0.7;
  with.camera_model.sharpening = 0.5;
  with.camera_model.noise_floor = 1e-5;
  with.camera_model.chroma_spread_px = 3;
  with.camera_model.codec_step = 6;
  with.camera_model.gamma = 2.2;
  const std::string all = camera_sentence({with, with});
  EXPECT_EQ(all,
            "motion blur of the exposure, rolling shutter, haze, point spread, sharpening, sensor "
            "noise, soft chroma, the codec's quantiser, a tone curve other than sRGB's");
  with.camera_model.readout_s = 0;  // a global shutter
  EXPECT_EQ(
      camera_sentence({with, without, without}),
      "motion blur of the exposure (in 1 of 3 sequences), haze (in 1 of 3 sequences), point "
      "spread (in 1 of 3 sequences), sharpening (in 1 of 3 sequences), sensor noise (in 1 of 3 "
      "sequences), soft chroma (in 1 of 3 sequences), the codec's quantiser (in 1 of 3 "
      "sequences), a tone curve other than sRGB's "
      "(in 1 of 3 sequences). Not on the intruder: rolling shutter");
}

TEST(Card, SaysOfTheMotionWhatWasMeasured) {
  EXPECT_EQ(motion_sentence({plain(scene::MotionModel::kRotation)}),
            "a rotation through the lens, measured in the video, exact for what is far");
  EXPECT_EQ(
      motion_sentence({plain(scene::MotionModel::kHomography), plain(scene::MotionModel::kNone)}),
      "a homography, measured in the video, exact for what is far through a pinhole (in 1 of 2 "
      "sequences); none is looked for: the camera moves along its stated path alone (in 1 of 2 "
      "sequences)");
}

}  // namespace
}  // namespace airtruth::set_report
