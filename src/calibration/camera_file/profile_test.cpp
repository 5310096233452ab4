// SPDX-License-Identifier: Apache-2.0
#include "calibration/camera_file/profile.h"

#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "foundation/base/error.h"
#include "scene/scene/camera_keys.h"

namespace airtruth::camera_file {
namespace {

std::string said_by(const std::function<void()>& what) {
  try {
    what();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

CameraProfile small_camera() {
  return parse_camera_profile(
      "# a camera\ncamera,a small one\nwidth,64\nheight,48\nclips,3\n"
      "key,value,error,clips\noptics.point_spread_px,0.4,0.1,3\nshutter.readout_s,-0.02,0.001,2\n",
      "small");
}

Calibration clip_of(int width, int height) {
  Calibration c;
  c.width = width, c.height = height;
  return c;
}

TEST(CameraProfile, IsReadAsItStands) {
  const CameraProfile profile = small_camera();
  EXPECT_EQ(profile.camera, "a small one");
  EXPECT_EQ(profile.width, 64);
  EXPECT_EQ(profile.clips, 3);
  EXPECT_EQ(profile.values.at("optics.point_spread_px").value, 0.4);
  EXPECT_EQ(profile.values.at("optics.point_spread_px").sigma, 0.1);
  EXPECT_NE(said_by([] { parse_camera_profile("optics.spread,1,2,3\n", "a"); }), "");
  EXPECT_NE(said_by([] {
              parse_camera_profile("optics.sharpening,1,x,3\n", "a");
            }).find("a.csv:1: 'x' is not a finite number"),
            std::string::npos);
}

TEST(CameraProfile, OfACameraIsRecognisedBySizeAndAllTags) {
  const std::map<std::string, std::string> tags = {
      {"encoder", "GoPro AVC encoder"}, {"firmware", "HD5.02.02.00.00"}, {"other", ""}};
  ASSERT_NE(recognised_profile(854, 480, tags), nullptr);
  EXPECT_EQ(recognised_profile(854, 480, tags)->name, "gopro-karma");
  EXPECT_EQ(recognised_profile(1920, 1080, tags), nullptr);
  EXPECT_EQ(recognised_profile(854, 480, {{"encoder", "GoPro AVC encoder"}}), nullptr);
  EXPECT_EQ(recognised_profile(
                854, 480, {{"encoder", "GoPro AVC encoder"}, {"firmware", "HD6.01.01.00.00"}}),
            nullptr);
  // A profile without tags is never chosen by size alone.
  EXPECT_EQ(recognised_profile(640, 480, {}), nullptr);
}

TEST(CameraProfile, TheLibraryHoldsWhatAProfileIsFor) {
  ASSERT_GE(camera_profiles().size(), 3u);
  for (const CameraProfile& profile : camera_profiles()) {
    EXPECT_FALSE(profile.camera.empty()) << profile.name;
    EXPECT_GT(profile.width, 0) << profile.name;
    EXPECT_GT(profile.clips, 0) << profile.name;
    for (const char* key :
         {"optics.point_spread_px", "optics.sharpening", "optics.sharpening_px"}) {
      ASSERT_TRUE(profile.values.contains(key)) << profile.name << " " << key;
      EXPECT_GE(profile.values.at(key).value, 0) << profile.name;
      EXPECT_GT(profile.values.at(key).sigma, 0) << profile.name;
    }
    EXPECT_EQ(&camera_profile(profile.name), &profile);
  }
  const std::string near = camera_profiles()[0].name + "x";
  EXPECT_NE(said_by([&] {
              camera_profile(near, {"s.toml", 3, 1});
            })
                .find("s.toml:3:1: there is no camera profile '" + near + "'; did you mean '" +
                      camera_profiles()[0].name + "'?"),
            std::string::npos);
}

TEST(CameraProfile, TheUsualCameraIsTheMedianWithTheSpreadBetweenCameras) {
  const CameraProfile usual = usual_camera();
  const Estimate spread = usual.values.at("optics.point_spread_px");
  std::vector<double> values;
  for (const CameraProfile& profile : camera_profiles())
    values.push_back(profile.values.at("optics.point_spread_px").value);
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  EXPECT_GE(spread.value, *least);
  EXPECT_LE(spread.value, *most);
  EXPECT_GT(spread.sigma, (*most - *least) / 4);
  // The usual camera has optical values only; a readout time belongs to one camera.
  EXPECT_FALSE(usual.values.contains("shutter.readout_s"));
  EXPECT_EQ(usual.words(),
            "the median over " + std::to_string(camera_profiles().size()) + " cameras");
}

// Two measurements of one quantity give the weighted mean and its error (Bevington 4.1).
TEST(CameraProfile, ClipAndProfileAreCombinedByInverseVariance) {
  const Estimate both = combined({0.9, 0.3}, {0.4, 0.1});
  EXPECT_NEAR(both.value, (0.9 / 0.09 + 0.4 / 0.01) / (1 / 0.09 + 1 / 0.01), 1e-12);
  EXPECT_NEAR(both.sigma, std::sqrt(1 / (1 / 0.09 + 1 / 0.01)), 1e-12);
  EXPECT_EQ(combined({0.9, 0}, {0.4, 0.1}).value, 0.9);
}

// -4 +- 4 ms is written as 0, and its weight is a sixteenth of the profile's -20 +- 1 ms.
TEST(CameraProfile, AReadoutGoesInAsItWasMeasured) {
  Calibration c = clip_of(64, 48);
  c.downwards_s = {-0.004, 0.004};
  c.quantities.readout.values = {{0, 0.004}};
  c = with_profile(std::move(c), small_camera());
  EXPECT_NEAR(c.quantities.readout.value().value, (0.004 + 16 * 0.02) / 17, 1e-12);
  EXPECT_EQ(c.readout_direction, "up");
}

TEST(CameraProfile, SaysWhoseAValueIs) {
  Calibration c = clip_of(64, 48);
  c.quantities.at("shutter.readout_s").missing = "too still";
  c.quantities.at("air.airlight").missing = "no sky";
  c.quantities.at("optics.point_spread_px").values = {{0.1, 1.0}};
  c = with_profile(std::move(c), small_camera());
  EXPECT_NEAR(c.quantities.at("optics.point_spread_px").value().value, 0.397, 0.001);
  EXPECT_EQ(c.quantities.at("optics.point_spread_px").source,
            "of the profile small; the clip's 0.1 +- 1 says next to nothing");
  EXPECT_EQ(c.quantities.at("shutter.readout_s").value().value, 0.02);
  EXPECT_EQ(model_of(c).readout, Readout::kUp);
  EXPECT_EQ(c.quantities.at("shutter.readout_s").source,
            "of the profile small; the clip does not show it");
  EXPECT_EQ(c.quantities.at("shutter.readout_s").missing, "");
  EXPECT_NE(c.quantities.at("air.airlight").missing, "");
  for (const QuantityKey& key : kQuantityKeys)
    EXPECT_EQ((c.quantities.*key.member).doubt, "") << key.name;
  const std::string file = toml_from(c);
  EXPECT_NE(file.find("of the profile small; the clip's 0.1"), std::string::npos) << file;
}

// The world is softer than a step, and a camera may be sharper than all edges that it shows.
TEST(CameraProfile, EdgesSofterThanTheProfileAreAnUpperBound) {
  Calibration c = clip_of(64, 48);
  c.quantities.at("optics.point_spread_px").values = {{0.6, 0.05}};
  c = with_profile(std::move(c), small_camera());
  EXPECT_EQ(c.quantities.at("optics.point_spread_px").value().value, 0.4);
  EXPECT_EQ(c.quantities.at("optics.point_spread_px").source,
            "of the profile small; the edges of the clip, 0.6 +- 0.05, are an upper bound");
}

// Footage that was enlarged or is out of focus.
TEST(CameraProfile, AClipFarFromAllCamerasKeepsItsOwnSpread) {
  Calibration c = clip_of(64, 48);
  c.quantities.at("optics.point_spread_px").values = {{1.4, 0.15}};
  c = with_profile(std::move(c), usual_camera());
  EXPECT_EQ(c.quantities.at("optics.point_spread_px").value().value, 1.4);
  EXPECT_EQ(c.quantities.at("optics.point_spread_px").source, "");
}

TEST(CameraProfile, ASureClipKeepsItsOwnAndWhatContradictsItIsNamed) {
  Calibration c = clip_of(64, 48);
  c.quantities.at("optics.point_spread_px").values = {{0.9, 0.01}};
  c = with_profile(std::move(c), small_camera());
  EXPECT_NEAR(c.quantities.at("optics.point_spread_px").value().value, 0.895, 0.001);
  EXPECT_EQ(c.quantities.at("optics.point_spread_px").source, "");
  EXPECT_NE(c.quantities.at("optics.point_spread_px").doubt, "");
  EXPECT_NE(toml_from(c).find("; the clip's own\n"), std::string::npos);
}

TEST(CameraProfile, IsRefusedForPicturesOfAnotherSize) {
  EXPECT_NE(said_by([] {
              with_profile(clip_of(64, 50), small_camera());
            }).find("was measured on clips of 64 x 48 px; the clip is 64 x 50"),
            std::string::npos);
}

}  // namespace
}  // namespace airtruth::camera_file
