// SPDX-License-Identifier: Apache-2.0
#include "sequence/new_scene/new_scene.h"

#include <cmath>
#include <cstring>
#include <fstream>
#include <regex>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "camera/lens/calibration_file.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "picture/video/still.h"
#include "sequence/demo/demo.h"
#include "sequence/preview/preview.h"
#include "sequence/setup/from_scene.h"
#include "support/ffmpeg.h"
#include "support/flight_file.h"
#include "support/temporary_folder.h"

namespace airtruth::new_scene {
namespace {

TEST(LensHint, TheSubtitlesFocalLengthIsInTenthsAboveAHundred) {
  EXPECT_EQ(equivalent_mm_in_subtitles("[iso : 100] [focal_len : 280] [latitude: 1]"), 28);
  EXPECT_EQ(equivalent_mm_in_subtitles("[focal_len: 24.00]"), 24);
  EXPECT_EQ(equivalent_mm_in_subtitles("[fnum: 2.8]"), std::nullopt);
  EXPECT_EQ(equivalent_mm_in_subtitles("[focal_len: none]"), std::nullopt);
}

TEST(LensHint, ADiagonalOfFilmBecomesTheDiagonalOfThePicture) {
  // 43.27 mm of focal length see the diagonal at 2 atan(1/2).
  const lens::Lens lens = pinhole_from_equivalent(43.27, {400, 300});
  const auto ray = lens.ray_from_pixel({400, 300});
  ASSERT_TRUE(ray);
  EXPECT_NEAR(std::atan2(std::hypot(ray->x(), ray->y()), ray->z()), std::atan(0.5), 1e-9);
  const lens::Lens wide = fisheye_from_diagonal(140, {400, 300});
  const auto corner = wide.ray_from_pixel({400, 300});
  ASSERT_TRUE(corner);
  EXPECT_NEAR(degrees(std::atan2(std::hypot(corner->x(), corner->y()), corner->z())), 70, 1e-6);
}

// 300 columns of pixels that are 4/3 as wide as high make the same picture as 400 of square ones.
TEST(LensHint, ADiagonalIsThatOfThePixelsShape) {
  const lens::Lens film = pinhole_from_equivalent(43.27, {300, 300}, 4 / 3.0);
  const lens::Lens wide = fisheye_from_diagonal(140, {300, 300}, 4 / 3.0);
  EXPECT_TRUE(
      film.ray_from_pixel({300, 300})
          ->isApprox(*pinhole_from_equivalent(43.27, {400, 300}).ray_from_pixel({400, 300}), 1e-9));
  EXPECT_TRUE(
      wide.ray_from_pixel({300, 300})
          ->isApprox(*fisheye_from_diagonal(140, {400, 300}).ray_from_pixel({400, 300}), 1e-9));
}

TEST(LensHint, AGoProsViewIsReadFromItsTelemetry) {
  const float view = 121.5F;
  std::uint32_t bits = 0;
  std::memcpy(&bits, &view, 4);
  std::vector<std::uint8_t> element = {'Z', 'F', 'O', 'V', 'f', 4, 0, 1};
  for (int i = 3; i >= 0; --i) element.push_back(static_cast<std::uint8_t>(bits >> (8 * i)));
  std::vector<std::uint8_t> stream = {
      'S', 'T', 'R', 'M', 0, 1, 0, static_cast<std::uint8_t>(element.size())};
  stream.insert(stream.end(), element.begin(), element.end());
  std::vector<std::uint8_t> packet = {
      'D', 'E', 'V', 'C', 0, 1, 0, static_cast<std::uint8_t>(stream.size())};
  packet.insert(packet.end(), stream.begin(), stream.end());
  EXPECT_NEAR(diagonal_view_deg(packet).value(), 121.5, 1e-4);
  EXPECT_EQ(diagonal_view_deg(std::span(packet).first(20)), std::nullopt);
}

TEST(SteadyStretch, IsTheLongestWithinTheAngle) {
  std::vector<motion::FrameMotion> motion;
  for (int k = 0; k < 250; ++k) {
    motion::FrameMotion frame;
    frame.frame = k;
    const double turned_deg = std::min(k, 100) + std::max(0, k - 149);
    frame.rotation = rotation_from_vector({0, radians(turned_deg), 0});
    motion.push_back(frame);
  }
  const Stretch steady = steady_stretch(motion, radians(10.001), 1000);
  EXPECT_EQ(steady.first, 90u);
  EXPECT_EQ(steady.frames, 60u);
  EXPECT_EQ(steady_stretch(motion, radians(10.001), 30).frames, 30u);
  motion[120].state = motion::State::kCut;
  EXPECT_EQ(steady_stretch(motion, radians(10.001), 1000).first, 120u);
  EXPECT_EQ(steady_stretch({}, 1, 10).frames, 0u);
}

TEST(NewScene, ItParsesPreviewsAndItsEncounterIsInView) {
  const test_support::TemporaryFolder folder;
  const fs::path video = folder / "flight.mp4";
  synthetic::FlightOptions flight;
  flight.frame_count = 120;
  flight.width = 640;
  flight.height = 480;
  demo::write_flight(synthetic::Flight(flight), video, {});
  std::ofstream(folder / "flight.srt")
      << "1\n00:00:00,000 --> 00:00:01,000\n[focal_len: 240] [latitude: 47.0008] [longitude: 8.0] "
         "[rel_alt: 120 abs_alt: 500]\n\n"
         "2\n00:00:02,000 --> 00:00:03,000\n[latitude: 47.0004] [longitude: 8.0] [rel_alt: 120 "
         "abs_alt: 500]\n\n"
         "3\n00:00:04,000 --> 00:00:05,000\n[latitude: 47.0] [longitude: 8.0] [rel_alt: 120 "
         "abs_alt: 500]\n";
  const std::string text = scene_text(video, {});
  EXPECT_THAT(text, testing::HasSubstr("flight.srt states 24 mm"));
  EXPECT_THAT(text, testing::HasSubstr("log = "));
  // It flies south, and the camera looks there.
  EXPECT_THAT(text, testing::Not(testing::HasSubstr("attitude_yaw_pitch_roll_deg")));
  NewSceneOptions empty;
  empty.has_encounter = false;
  const std::string begun = scene_text(video, empty);
  EXPECT_EQ(begun + '\n', text.substr(0, begun.size() + 1));
  EXPECT_TRUE(scene::parse_scene(begun, folder / "flight.toml").intruders.empty());
  const scene::Scene scene = scene::parse_scene(text, folder / "flight.toml");
  const preview::Preview made = preview::preview_of(scene, {});
  const auto seen =
      std::count_if(made.rows.begin(), made.rows.end(), [](const preview::PreviewRow& row) {
        return row.box_px.has_value();
      });
  EXPECT_GE(2 * seen, std::ssize(made.rows));

  // A clip that begins 2 s into the video begins 2 s into the log.
  scene::Scene later = scene;
  later.background.first_frame = 60;
  later.camera.clip_start_s = video::time_of_first_frame_s(
      later.background.video, {.first_frame = later.background.first_frame});
  EXPECT_NEAR(later.camera.clip_start_s, 2, 1e-9);
  EXPECT_NEAR(
      setup::camera_path(later.camera).end_s(), setup::camera_path(scene.camera).end_s() - 2, 1e-9);
}

std::string fault_of(const fs::path& video, const NewSceneOptions& options) {
  try {
    scene_text(video, options);
  } catch (const Error& error) {
    return error.message();
  }
  return "";
}

TEST(NewScene, NamesOfFilesMayHoldQuotesAndNoControlCharacters) {
  const test_support::TemporaryFolder folder;
  const fs::path video = folder / "a \"b\" \\n \u00e9.mp4";
  synthetic::FlightOptions flight;
  flight.frame_count = 4;
  flight.width = 160;
  flight.height = 120;
  demo::write_flight(synthetic::Flight(flight), video, {});
  NewSceneOptions options;
  options.lens = fs::path(video).replace_extension(".yml");
  const lens::Lens lens = lens::pinhole_from_vertical_fov(60, {160, 120});
  std::ofstream(*options.lens) << lens::opencv_calibration(lens, "");
  const scene::Scene scene = scene::parse_scene(scene_text(video, options), folder / "s.toml");
  EXPECT_EQ(scene.background.video, video);
  EXPECT_EQ(scene.lens.file, options.lens);

  const fs::path in_two_lines = folder / "a\nb.mp4";
  fs::copy_file(video, in_two_lines);
  EXPECT_THAT(fault_of(in_two_lines, options), testing::HasSubstr("has a control character"));
  fs::copy_file(*options.lens, folder / "a\x7f.yml");
  options.lens = folder / "a\x7f.yml";
  EXPECT_THAT(fault_of(video, options), testing::HasSubstr("has a control character"));
}

// Matroska states no number of frames.
TEST(NewScene, ANumberOfFramesThatIsNotStatedIsAbout) {
  const test_support::TemporaryFolder folder;
  synthetic::FlightOptions options;
  options.frame_count = 4;
  options.width = 160;
  options.height = 120;
  for (const auto& [name, words] : {std::pair("a.mp4", "# a.mp4: 4 frames of "),
                                    std::pair("a.mkv", "# a.mkv: about 4 frames of ")}) {
    demo::VirtualFlightOptions how;
    how.format = video::format_of_file(folder / name);
    demo::write_flight(synthetic::Flight(options), folder / name, how);
    EXPECT_THAT(scene_text(folder / name, {}), testing::StartsWith(words));
  }
  // With 3 s of sound the clip still ends with its last frame, at 3/30 s.
  test_support::ffmpeg(folder.path(),
                       "-i a.mp4 -f lavfi -i sine=d=3 -c:v copy -c:a flac sound.mkv");
  const std::string text = scene_text(folder / "sound.mkv", {});
  EXPECT_THAT(text, testing::StartsWith("# sound.mkv: about 4 frames of "));
  EXPECT_THAT(text, testing::HasSubstr("the clip lasts 0.1 s"));
}

// As a render of a scene without an attitude has it.
TEST(NewScene, AHorizonThatStandsUpsideDownIsNone) {
  const test_support::TemporaryFolder folder;
  test_support::write_flight(folder / "a.mp4", 320, 240, 3);
  test_support::ffmpeg(folder.path(), "-i a.mp4 -vf hflip,vflip turned.mp4");
  EXPECT_THAT(scene_text(folder / "a.mp4", {}), testing::HasSubstr("are those of the horizon"));
  EXPECT_THAT(scene_text(folder / "turned.mp4", {}),
              testing::HasSubstr("[0, 0, 0]  # no horizon was found in the first frame"));
}

TEST(NewScene, PicturesAskForTheirRate) {
  const test_support::TemporaryFolder folder;
  synthetic::FlightOptions options;
  options.frame_count = 4;
  options.width = 160;
  options.height = 120;
  const synthetic::Flight flight(options);
  fs::create_directories(folder / "frames");
  for (int k = 0; k < options.frame_count; ++k)
    video::write_still(folder / "frames" / ("000" + std::to_string(k) + ".png"), flight.frame(k));
  EXPECT_THAT(fault_of(folder / "frames", {}), testing::HasSubstr("state no rate"));
  NewSceneOptions stated;
  stated.picture_rate_hz = 12.5;
  const std::string text = scene_text(folder / "frames", stated);
  EXPECT_THAT(text, testing::HasSubstr("frame_rate_hz = 12.5\n"));
  // The camera hardly turns in four frames: the lens is a guess, and the reason is there.
  EXPECT_THAT(text, testing::HasSubstr("A GUESS: no file states the lens, and the camera turns"));
  EXPECT_EQ(scene::parse_scene(text, folder / "s.toml").background.frame_rate_hz, 12.5);
  write_file(folder / "list.txt", "frames/0000.png\nframes/0001.png\n");
  EXPECT_THAT(scene_text(folder / "list.txt", stated), testing::HasSubstr("list.txt\"\n"));
  demo::write_flight(flight, folder / "flight.mp4", {});
  EXPECT_THAT(fault_of(folder / "flight.mp4", stated), testing::HasSubstr("states its own rate"));
}

// A camera in turns shows its lens: the scene has the interval of the estimate, which holds the
// true focal length.
TEST(NewScene, TheEstimatesIntervalIsInTheScene) {
  const test_support::TemporaryFolder folder;
  synthetic::FlightOptions options;
  options.lens = lens::pinhole_from_vertical_fov(60, {320, 240});
  options.frame_count = 200;
  options.width = 320;
  options.height = 240;
  options.roll_deg = 25;
  options.own_aircraft = false;
  demo::write_flight(synthetic::Flight(options), folder / "flight.mp4", {});
  const std::string text = scene_text(folder / "flight.mp4", {});
  std::smatch found;
  ASSERT_TRUE(std::regex_search(
      text, found, std::regex("focal length of ([0-9]+) px, ([0-9]+) to ([0-9]+) px at 95 %")))
      << text;
  EXPECT_LT(std::stod(found[2]), options.lens->focal_px());
  EXPECT_GT(std::stod(found[3]), options.lens->focal_px());
  EXPECT_NEAR(std::stod(found[1]), options.lens->focal_px(), 0.1 * options.lens->focal_px());
  // An estimate that was written into a calibration keeps its doubt, with Windows' line ends too.
  std::ofstream(folder / "lens.yml") << std::regex_replace(
      lens::opencv_calibration(
          *options.lens, "estimated by airtruth lens estimate: 9 to 10 px at 95 %; not certain"),
      std::regex("\n"),
      "\r\n");
  NewSceneOptions stated;
  stated.lens = folder / "lens.yml";
  EXPECT_THAT(scene_text(folder / "flight.mp4", stated),
              testing::HasSubstr("# the stated calibration, estimated by airtruth lens estimate: 9 "
                                 "to 10 px at 95 %; not certain."));
  // A folder can be moved with all that is in it.
  stated.folder = folder.path();
  EXPECT_THAT(scene_text(folder / "flight.mp4", stated),
              testing::HasSubstr("[lens]\nfile = \"lens.yml\"\n"));
  // A relative path of a linked folder leads elsewhere.
  const test_support::TemporaryFolder elsewhere;
  fs::create_directory_symlink(elsewhere.path(), folder / "scenes");
  stated.folder = folder / "scenes";
  EXPECT_THAT(scene_text(folder / "flight.mp4", stated),
              testing::HasSubstr("video = \"" + (folder / "flight.mp4").string() + "\"\n"));
}

}  // namespace
}  // namespace airtruth::new_scene
