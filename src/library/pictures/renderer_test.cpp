// SPDX-License-Identifier: Apache-2.0
#include <fstream>

#include <airtruth/dataset.h>
#include <airtruth/renderer.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include "foundation/base/files.h"
#include "foundation/image/colour.h"
#include "picture/video/reader.h"
#include "sequence/demo/demo.h"
#include "sequence/pipeline/render.h"

namespace airtruth {
namespace {

constexpr int kWidth = 160;
constexpr int kHeight = 120;
constexpr int kFrames = 8;

// One background for all tests.
class InMemory : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    root_ = fs::temp_directory_path() / ("airtruth_renderer_test_" + std::to_string(::getpid()));
    fs::create_directories(root_);
    synthetic::FlightOptions options;
    options.width = kWidth;
    options.height = kHeight;
    options.frame_count = kFrames;
    options.own_aircraft = false;
    demo::VirtualFlightOptions how;
    how.format = video::Format::kMkv;
    write_flight(synthetic::Flight(options), root_ / "flight.mkv", how);
  }
  static void TearDownTestSuite() { fs::remove_all(root_); }

  // FFV1 (mkv) keeps every sample.
  static std::string scene_text(const std::string& name,
                                const std::string& more,
                                const std::string& format = "mkv") {
    return "name = \"" + name +
           "\"\n[background]\nvideo = \"flight.mkv\"\n"
           "[lens]\nmodel = \"pinhole\"\nvertical_fov_deg = 75\n"
           "[camera]\nposition_ned_m = [0, 0, -150]\n"
           "attitude_yaw_pitch_roll_deg = [0, 0, 0]\n" +
           more +
           "[[intruder]]\nid = \"a\"\naircraft = \"738/738-Ryanair\"\n"
           "waypoints_ned_m = [[120, -8, -150], [120, 100, -150]]\nspeed_mps = 50\n"
           "[output]\nvideo = \"" +
           format + "\"\n";
  }

  static fs::path rendered(const std::string& scene) {
    pipeline::Options options;
    options.use_cache = false;
    return pipeline::render(scene::parse_scene(scene, root_ / "scene.toml"), root_, options).folder;
  }

  static RenderOptions without_cache(int threads) {
    RenderOptions options;
    options.threads = threads;
    options.use_cache = false;
    return options;
  }

  static inline fs::path root_;
};

void expect_the_same(Renderer renderer, const fs::path& folder, const std::string& name) {
  VideoReader video(folder / (name + ".mkv"));
  std::ifstream truth(folder / "truth.jsonl");
  int frames = 0;
  while (const auto made = renderer.next()) {
    const auto written = video.next();
    ASSERT_TRUE(written) << frames;
    EXPECT_EQ(made->picture, written->picture) << frames;
    std::string line;
    ASSERT_TRUE(std::getline(truth, line));
    EXPECT_EQ(truth_line(made->truth, renderer.lens()), line);
    EXPECT_EQ(made->truth.frame, frames);
    ++frames;
  }
  EXPECT_EQ(frames, kFrames);
  EXPECT_FALSE(video.next());
  EXPECT_FALSE(renderer.next());
}

// What the pipeline makes of a scene and writes losslessly is what the renderer hands out: with a
// motion that is known ahead (a shutter) or not, and with frames that follow from the one before
// (codec_step).
TEST_F(InMemory, FramesAndTruthAreThoseOfTheFiles) {
  const std::pair<const char*, const char*> scenes[] = {
      {"still", "[motion]\nmodel = \"none\"\n"},
      {"turning", ""},
      {"shutter", "[shutter]\nexposure_s = 0.01\nreadout_s = 0.02\n"},
      {"codec", "[motion]\nmodel = \"none\"\n[sensor]\ncodec_step = 6\n"},
      {"keyed", "[composite]\nmethod = \"chroma-key\"\n"},
  };
  for (const auto& [name, more] : scenes) {
    SCOPED_TRACE(name);
    const std::string scene = scene_text(name, more);
    const fs::path folder = rendered(scene);
    for (const int threads : {1, 3})
      expect_the_same(Renderer::from_text(scene, root_, without_cache(threads)), folder, name);
  }
}

TEST_F(InMemory, MoreThreadsThanThereAreAreNoWarningOnStandardError) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  testing::internal::CaptureStderr();
  auto renderer = Renderer::from_text(
      scene_text("many", "[motion]\nmodel = \"none\"\n"), root_, without_cache(3));
  int frames = 0;
  while (renderer.next()) ++frames;
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(frames, kFrames);
}

TEST_F(InMemory, NumbersOutOfRangeAreErrorsOfTheArgument) {
  for (const int threads : {-1, 257})
    EXPECT_THROW(Renderer::from_text(scene_text("none", ""), root_, without_cache(threads)), Error);
  EXPECT_THROW(VideoReader(root_ / "flight.mkv", -1), Error);
}

TEST_F(InMemory, AReadSequenceHasTheTruthAndTheBoxesOfItsFiles) {
  const fs::path folder = rendered(scene_text("read", "[motion]\nmodel = \"none\"\n"));
  const DataSet set(folder);
  ASSERT_EQ(set.names(), std::vector<std::string>{"read"});
  const Sequence sequence = set.sequence("read");
  EXPECT_EQ(sequence.video, folder / "read.mkv");
  ASSERT_TRUE(sequence.truth);
  std::ifstream file(folder / "truth.jsonl");
  int visible = 0;
  for (std::size_t i = 0; i < std::size_t{kFrames}; ++i) {
    const FrameTruth& frame = sequence.truth->frames.at(i);
    std::string line;
    std::getline(file, line);
    EXPECT_EQ(truth_line(frame, sequence.truth->lens), line);
    const auto& labels = sequence.labels.frames.at(i).labels;
    const auto& box = frame.intruders.at(0).covered_box_px;
    ASSERT_EQ(labels.size(), box ? 1u : 0u);
    if (!box) continue;
    ++visible;
    EXPECT_EQ(labels[0].box_px,
              (Box{double(box->x), double(box->y), double(box->width), double(box->height)}));
    EXPECT_EQ(labels[0].category, "738");
  }
  EXPECT_GT(visible, kFrames / 2);
  EXPECT_THROW(set.sequence("other"), Error);
}

TEST_F(InMemory, ASequenceOfNumberedPicturesIsRead) {
  const fs::path folder = rendered(scene_text("numbered", "[motion]\nmodel = \"none\"\n", "png"));
  const Sequence sequence = DataSet(folder).sequence("numbered");
  EXPECT_EQ(sequence.video, folder / "numbered");
  VideoReader video(sequence.video);
  int frames = 0;
  while (video.next()) ++frames;
  EXPECT_EQ(frames, kFrames);
}

TEST_F(InMemory, FaultsOfTheSceneNameTheirPlace) {
  try {
    Renderer::from_text("name = \"x\"\n[backgroud]\n", root_);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.where().line, 2);
    EXPECT_NE(error.message().find("background"), std::string::npos) << error.what();
  }
}

TEST_F(InMemory, AStopEndsIt) {
  std::stop_source source;
  RenderOptions options = without_cache(1);
  options.stop = source.get_token();
  Renderer renderer =
      Renderer::from_text(scene_text("stop", "[motion]\nmodel = \"none\"\n"), root_, options);
  EXPECT_TRUE(renderer.next());
  source.request_stop();
  EXPECT_THROW(renderer.next(), Interrupted);
}

TEST_F(InMemory, RgbIsThatOfThePicture) {
  VideoReader ours(root_ / "flight.mkv");
  video::Reader theirs(root_ / "flight.mkv");
  const FramePicture picture = ours.next()->picture;
  const image::Rgb8 expected = image::rgb8_from_picture(theirs.next()->picture);
  const std::vector<std::uint8_t> rgb = rgb_of(picture);
  ASSERT_EQ(rgb.size(), std::size_t{3 * kWidth * kHeight});
  EXPECT_TRUE(std::equal(rgb.begin(), rgb.end(), expected.samples.get()));
}

TEST(RgbOf, APictureThatIsNotWholeIsAnError) {
  FramePicture picture{2, 2, "gray", "bt601", true, {{2, 2, {0, 1, 128, 255}}}};
  EXPECT_EQ(rgb_of(picture),
            (std::vector<std::uint8_t>{0, 0, 0, 1, 1, 1, 128, 128, 128, 255, 255, 255}));
  const auto refused = [](FramePicture wrong) { EXPECT_THROW(rgb_of(wrong), Error); };
  refused({2, 2, "grey", "bt601", true, picture.planes});
  refused({2, 2, "gbrp", "bt601", true, picture.planes});
  refused({2, 2, "yuv420p", "bt601", true, picture.planes});
  refused({2, 3, "gray", "bt601", true, picture.planes});
  refused({0, 0, "gray", "bt601", true, picture.planes});
}

}  // namespace
}  // namespace airtruth
