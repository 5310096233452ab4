// SPDX-License-Identifier: Apache-2.0
#include "sequence/pipeline/render.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/image/colour.h"
#include "picture/video/reader.h"
#include "picture/video/still.h"
#include "picture/video/writer.h"
#include "sequence/demo/demo.h"
#include "sequence/replay/finished.h"
#include "support/error_of.h"
#include "support/temporary_folder.h"

namespace airtruth::pipeline {
namespace {

using annotation::State;

constexpr int kWidth = 160;
constexpr int kHeight = 120;
constexpr int kFrames = 12;

// One background for all tests, and a folder for each test. The camera stands level at (0, 0, -150)
// and looks north.
class Sequence : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    root_ = temporary_.emplace().path();
    synthetic::FlightOptions options;
    options.width = kWidth;
    options.height = kHeight;
    options.frame_count = kFrames;
    options.own_aircraft = false;
    demo::VirtualFlightOptions how;
    how.format = video::Format::kMkv;
    demo::write_flight(synthetic::Flight(options), root_ / "flight.mkv", how);
  }
  static void TearDownTestSuite() { temporary_.reset(); }

  void SetUp() override {
    out_ = root_ / testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::create_directories(out_);
  }

  // A scene over the background; `more` goes before the intruders, `intruders` after.
  scene::Scene scene_of(const std::string& name,
                        const std::string& intruders,
                        const std::string& background = "",
                        const std::string& more = "[motion]\nmodel = \"none\"\n") const {
    const std::string text = "name = \"" + name + "\"\n[background]\nvideo = \"flight.mkv\"\n" +
                             background +
                             "[lens]\nmodel = \"pinhole\"\nvertical_fov_deg = 75\n"
                             "[camera]\nposition_ned_m = [0, 0, -150]\n"
                             "attitude_yaw_pitch_roll_deg = [0, 0, 0]\n" +
                             more + intruders + "[output]\nvideo = \"mkv\"\n";
    return scene::parse_scene(text, root_ / "scene.toml");
  }

  replay::Finished rendered(const scene::Scene& scene, Options options = {}) const {
    options.use_cache = false;
    return replay::open_finished(render(scene, out_, options).folder);
  }

  std::set<std::string> left_in_out() const {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(out_)) names.insert(entry.path().filename());
    return names;
  }

  static inline std::optional<test_support::TemporaryFolder> temporary_;
  static inline fs::path root_;
  fs::path out_;
};

std::string intruder(const std::string& id,
                     const std::string& aircraft,
                     const std::string& waypoints,
                     const std::string& pace = "speed_mps = 50") {
  return "[[intruder]]\nid = \"" + id + "\"\naircraft = \"" + aircraft +
         "\"\nwaypoints_ned_m = " + waypoints + "\n" + pace + "\n";
}

// Crosses the view from left to right at `range_m`.
std::string crossing(const std::string& id, const std::string& aircraft, double range_m) {
  const std::string north = std::to_string(range_m);
  return intruder(id, aircraft, "[[" + north + ", -8, -150], [" + north + ", 100, -150]]");
}

std::vector<video::Frame> frames_of(const fs::path& video) {
  video::Reader reader(video);
  std::vector<video::Frame> frames;
  while (auto frame = reader.next()) frames.push_back(std::move(*frame));
  return frames;
}

// Does a sample of this plane stand for any pixel inside a visible box?
bool under_a_box(const annotation::Frame& truth, int x, int y, int halved) {
  const PixelBox block{x << halved, y << halved, 1 << halved, 1 << halved};
  for (const auto& one : truth.intruders)
    if (one.visible_box_px && intersection(*one.visible_box_px, block)) return true;
  return false;
}

TEST_F(Sequence, EverySampleOutsideTheVisibleBoxesIsTheBackgrounds) {
  const replay::Finished finished = rendered(
      scene_of("two", crossing("a", "738/738-Ryanair", 120) + crossing("b", "c172/news", 60)));
  const auto before = frames_of(root_ / "flight.mkv");
  const auto after = frames_of(finished.video);
  ASSERT_EQ(before.size(), std::size_t{kFrames});
  ASSERT_EQ(after.size(), std::size_t{kFrames});
  ASSERT_EQ(finished.truth.frames.size(), std::size_t{kFrames});
  std::int64_t outside_changed = 0;
  std::int64_t inside_changed = 0;
  for (std::size_t k = 0; k < before.size(); ++k) {
    EXPECT_NEAR(after[k].time_s, before[k].time_s, 1e-3);
    ASSERT_EQ(before[k].picture.plane_count, 3);
    ASSERT_EQ(after[k].picture.colour, before[k].picture.colour);
    for (std::size_t p = 0; p < 3; ++p) {
      const image::Plane& was = before[k].picture.planes[p];
      const image::Plane& is = after[k].picture.planes[p];
      ASSERT_EQ(is.width, was.width);
      for (int y = 0; y < was.height; ++y)
        for (int x = 0; x < was.width; ++x) {
          if (is.row(y)[x] == was.row(y)[x]) continue;
          ++(under_a_box(finished.truth.frames[k], x, y, p == 0 ? 0 : 1) ? inside_changed
                                                                         : outside_changed);
        }
    }
  }
  EXPECT_EQ(outside_changed, 0);
  EXPECT_GT(inside_changed, 50 * kFrames);  // something was drawn
}

TEST_F(Sequence, TruthSaysWhereEachIntruderIs) {
  image::Rgb8 mask =
      image::make_rgb8(kWidth, kHeight);  // black: the own aircraft fills the left half
  for (int y = 0; y < kHeight; ++y)
    for (int x = kWidth / 2; x < kWidth; ++x) std::fill_n(mask.at(x, y), 3, std::uint8_t{255});
  video::write_still(root_ / "left_half.png", mask);
  const std::string all =
      intruder("seen", "c172/news", "[[60, 20, -150], [60, 60, -150]]") +
      intruder("aside", "c172/news", "[[60, 900, -150], [60, 960, -150]]") +
      intruder("behind", "c172/news", "[[-60, 0, -150], [-90, 0, -150]]") +
      intruder("masked", "c172/news", "[[60, -40, -150], [60, -20, -150]]") +
      intruder("brief", "c172/news", "[[60, 20, -170], [60, 30, -170]]", "times_s = [0, 0.2]");
  const replay::Finished finished = rendered(scene_of("states", all, "mask = \"left_half.png\"\n"));
  for (const annotation::Frame& frame : finished.truth.frames) {
    std::map<std::string, annotation::Intruder> by_id;
    for (const auto& one : frame.intruders) by_id[one.id] = one;
    ASSERT_EQ(by_id.size(), 5u);
    EXPECT_EQ(by_id["seen"].state, State::kVisible);
    EXPECT_EQ(by_id["seen"].hidden_by_own_aircraft, 0);
    EXPECT_EQ(by_id["aside"].state, State::kOutside);
    EXPECT_EQ(by_id["behind"].state, State::kBehind);
    EXPECT_FALSE(by_id["behind"].exact_box_px);
    EXPECT_EQ(by_id["masked"].state, State::kHidden);
    EXPECT_NEAR(by_id["masked"].hidden_by_own_aircraft, 1, 1e-6);
    EXPECT_FALSE(by_id["masked"].visible_box_px);
    EXPECT_TRUE(by_id["masked"].exact_box_px);
    EXPECT_EQ(by_id["brief"].state, frame.time_s <= 0.2 ? State::kVisible : State::kEnded)
        << frame.time_s;
    EXPECT_EQ(by_id["brief"].position_ned_m.has_value(), frame.time_s <= 0.2) << frame.time_s;
    // Straight lines at a stated speed: where it is follows from the clock.
    ASSERT_TRUE(by_id["seen"].range_m);
    const Vector3 expected(60, 20 + 50 * frame.time_s, 0);
    EXPECT_NEAR(*by_id["seen"].range_m, expected.norm(), 1e-6);
    EXPECT_NEAR(*by_id["seen"].range_rate_mps, 50 * expected.y() / expected.norm(), 1e-6);
    EXPECT_NEAR(*by_id["seen"].azimuth_deg, std::atan2(expected.y(), 60) * 180 / kPi, 1e-6);
  }
}

// The exact box comes from projected vertices, the visible box from the samples that changed:
// two independent answers.
TEST_F(Sequence, TheExactAndTheVisibleBoxMeet) {
  int compared = 0;
  for (const char* aircraft : {"738/738-Ryanair", "c172/news", "A320/A320-Lufthansa"}) {
    for (const double range_m : {70.0, 250.0}) {
      scene::Scene scene =
          scene_of("boxes", crossing("one", aircraft, range_m), "frame_count = 3\n");
      Options options;
      options.overwrite = true;
      const replay::Finished finished = rendered(scene, options);
      for (const annotation::Frame& frame : finished.truth.frames) {
        const annotation::Intruder& one = frame.intruders.at(0);
        ASSERT_EQ(one.state, State::kVisible) << aircraft << " at " << range_m;
        const Box& exact = *one.exact_box_px;
        const PixelBox& visible = *one.visible_box_px;
        const std::string where = std::string(aircraft) + " at " + std::to_string(range_m) + " m";
        EXPECT_NEAR(visible.x, exact.x, 1.5) << where;
        EXPECT_NEAR(visible.y, exact.y, 1.5) << where;
        EXPECT_NEAR(visible.right(), exact.right(), 1.5) << where;
        EXPECT_NEAR(visible.bottom(), exact.bottom(), 1.5) << where;
        ++compared;
      }
    }
  }
  EXPECT_EQ(compared, 18);
}

std::map<std::string, std::string> file_bytes(const fs::path& folder) {
  std::map<std::string, std::string> bytes;
  for (const auto& entry : fs::directory_iterator(folder))
    bytes[entry.path().filename()] = read_file(entry.path());
  return bytes;
}

TEST_F(Sequence, OneThreadAndThreeWriteTheSameFiles) {
  scene::Scene scene =
      scene_of("threads",
               crossing("a", "738/738-Ryanair", 120) + crossing("b", "c172/news", 60),
               "",
               "[motion]\nmodel = \"homography\"\n");
  scene.output.video = video::Format::kMp4;
  Options options;
  options.threads = 1;
  const auto with_one = file_bytes(rendered(scene, options).folder);
  options.threads = 3;
  options.overwrite = true;
  const auto with_three = file_bytes(rendered(scene, options).folder);
  ASSERT_EQ(with_one.size(), 6u);  // video, truth, an XML for each intruder, preview, record
  for (const auto& [name, bytes] : with_one) EXPECT_TRUE(with_three.at(name) == bytes) << name;
}

TEST_F(Sequence, AFolderThatExistsIsRefusedAndUntouched) {
  const scene::Scene scene = scene_of("kept", crossing("a", "c172/news", 60), "frame_count = 2\n");
  const replay::Finished first = rendered(scene);
  const auto stamp = fs::last_write_time(first.folder / "sequence.json");
  const std::string record = read_file(first.folder / "sequence.json");
  try {
    render(scene, out_, {});
    FAIL() << "an existing folder was not refused";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("--overwrite"));
  }
  EXPECT_EQ(fs::last_write_time(first.folder / "sequence.json"), stamp);
  EXPECT_EQ(read_file(first.folder / "sequence.json"), record);
  EXPECT_EQ(left_in_out(), std::set<std::string>{"kept"});
}

TEST_F(Sequence, WhatAirtruthDidNotMakeIsNeverReplaced) {
  fs::create_directories(out_ / "mine");
  write_file(out_ / "mine" / "letter.txt", "dear");
  Options options;
  options.overwrite = true;
  EXPECT_THROW(render(scene_of("mine", crossing("a", "c172/news", 60)), out_, options), Error);
  EXPECT_EQ(read_file(out_ / "mine" / "letter.txt"), "dear");
  EXPECT_EQ(left_in_out(), std::set<std::string>{"mine"});
}

TEST_F(Sequence, InterruptedLeavesNothing) {
  const scene::Scene scene = scene_of("stopped", crossing("a", "c172/news", 60));
  std::stop_source before;
  before.request_stop();
  Options options;
  options.use_cache = false;
  options.stop = before.get_token();
  EXPECT_THROW(render(scene, out_, options), Interrupted);
  EXPECT_EQ(left_in_out(), std::set<std::string>{});

  std::stop_source during;
  options.stop = during.get_token();
  options.threads = 1;
  std::int64_t written = 0;
  options.progress = [&](const Progress& progress) {
    written = progress.frames_done;
    if (written == 2) during.request_stop();
  };
  EXPECT_THROW(render(scene, out_, options), Interrupted);
  EXPECT_GE(written, 2);
  EXPECT_EQ(left_in_out(), std::set<std::string>{});
}

TEST_F(Sequence, AnErrorOnTheWayLeavesNothing) {
  const scene::Scene scene = scene_of("bad", crossing("a", "no/such-aircraft", 60));
  EXPECT_THROW(render(scene, out_, {}), Error);
  EXPECT_EQ(left_in_out(), std::set<std::string>{});
  // After some frames are written.
  Options options;
  std::int64_t done = 0;
  options.progress = [&](const Progress& progress) {
    done = progress.frames_done;
    if (done >= 3) throw Error("enough");
  };
  EXPECT_THROW(render(scene_of("broken", crossing("a", "c172/news", 60)), out_, options), Error);
  EXPECT_GE(done, 3);
  EXPECT_EQ(left_in_out(), std::set<std::string>{});
}

TEST_F(Sequence, AVirtualFlightHasTheClockOfItsRate) {
  const std::vector<std::pair<double, double>> rates = {{24, 24},
                                                        {12.5, 12.5},
                                                        {7.5, 7.5},
                                                        {1.5, 1.5},
                                                        {29.971, 29.971},
                                                        {29.97, 30000 / 1001.0},
                                                        {59.94, 60000 / 1001.0},
                                                        {23.976, 24000 / 1001.0}};
  for (const auto& [stated_hz, clock_hz] : rates) {
    synthetic::FlightOptions options;
    options.width = options.height = 64;
    options.frame_count = 3;
    options.frame_rate_hz = stated_hz;
    const fs::path file = out_ / fmt::format("{}.mp4", stated_hz);
    demo::write_flight(synthetic::Flight(options), file, {.format = video::Format::kMp4});
    EXPECT_NEAR(frames_of(file).back().time_s, 2 / clock_hz, 1e-9) << stated_hz;
  }
}

TEST_F(Sequence, WhatCouldNotBeReadAgainIsAnErrorBeforeTheFirstFrame) {
  scene::Scene scene = scene_of("s", crossing("a", "c172/news", 60));
  scene.weight = 2e9;
  Options options;
  options.progress = [](const Progress&) { FAIL() << "a frame was made"; };
  EXPECT_THAT(test_support::error_of([&] { render(scene, out_, options); }),
              testing::HasSubstr("expected a number from 1e-9 to 1e9"));
  EXPECT_EQ(left_in_out(), std::set<std::string>{});
}

TEST_F(Sequence, ThePapersMethodAgreesWithTheMatte) {
  const std::string one = crossing("one", "738/738-Ryanair", 70);
  const std::string none = "[motion]\nmodel = \"none\"\n";
  const replay::Finished matte = rendered(scene_of("matte", one, "frame_count = 3\n"));
  Options software;
  software.software_gl = true;
  const replay::Finished keyed = rendered(
      scene_of("keyed", one, "frame_count = 3\n", none + "[composite]\nmethod = \"chroma-key\"\n"),
      software);
  const auto ours = frames_of(matte.video);
  const auto theirs = frames_of(keyed.video);
  const auto background = frames_of(root_ / "flight.mkv");
  ASSERT_EQ(ours.size(), 3u);
  ASSERT_EQ(theirs.size(), 3u);
  for (std::size_t k = 0; k < ours.size(); ++k) {
    const annotation::Intruder& truth = matte.truth.frames[k].intruders.at(0);
    EXPECT_EQ(keyed.truth.frames[k].intruders.at(0).exact_box_px, truth.exact_box_px);
    const PixelBox box = *truth.visible_box_px;
    double between = 0;
    double drawn = 0;
    for (int y = box.y; y < box.bottom(); ++y)
      for (int x = box.x; x < box.right(); ++x) {
        const double mine = ours[k].picture.luma().row(y)[x];
        between += std::abs(mine - theirs[k].picture.luma().row(y)[x]);
        drawn += std::abs(mine - background[k].picture.luma().row(y)[x]);
      }
    const double area = static_cast<double>(box.width) * box.height;
    // The light differs slightly: OpenGL has one colour from above and one from below.
    EXPECT_LT(between / area, 12) << "mean luma difference, frame " << k;
    EXPECT_LT(between, drawn / 2) << "no nearer to the matte than the bare background is, frame "
                                  << k;
  }
}

constexpr const char* kEverything =
    "[motion]\nmodel = \"rotation\"\n[shutter]\nangle_deg = 180\nreadout_s = 0.02\n"
    "[air]\nextinction_per_km = [0.2, 0.25, 0.3]\n[optics]\npoint_spread_px = 0.8\nsharpening = "
    "0.5\n"
    "[sensor]\nnoise_gain = 4e-4\nnoise_floor = 2e-5\nnoise_correlation_px = 0.5\nchroma_spread_px "
    "= 1.5\n"
    "codec_step = 6\n";

TEST_F(Sequence, WithEverythingOnTheBackgroundKeepsItsSamplesAndTruthItsWord) {
  const scene::Scene scene =
      scene_of("all", crossing("a", "738/738-Ryanair", 120), "", kEverything);
  Options one;
  one.threads = 1;
  const replay::Finished finished = rendered(scene, one);
  const auto before = frames_of(root_ / "flight.mkv");
  const auto after = frames_of(finished.video);
  ASSERT_EQ(before.size(), after.size());
  int visible = 0;
  for (std::size_t k = 0; k < after.size(); ++k) {
    const annotation::Frame& truth = finished.truth.frames[k];
    for (int p = 0; p < 3; ++p) {
      const image::Plane& a = before[k].picture.planes[static_cast<std::size_t>(p)];
      const image::Plane& b = after[k].picture.planes[static_cast<std::size_t>(p)];
      for (int y = 0; y < a.height; ++y)
        for (int x = 0; x < a.width; ++x)
          ASSERT_TRUE(a.row(y)[x] == b.row(y)[x] || under_a_box(truth, x, y, p > 0 ? 1 : 0))
              << "frame " << k << " plane " << p << " at " << x << ',' << y;
    }
    const annotation::Intruder& seen = truth.intruders[0];
    if (!seen.visible_box_px || seen.cut_by_frame > 0) continue;
    ++visible;
    // The box from pixels holds the one from geometry, and goes beyond it by blur (3 px), halo (3
    // px) and the rest of a codec's block (7 px) alone.
    const Box& exact = *seen.exact_box_px;
    EXPECT_GE(exact.x, seen.visible_box_px->x - 1) << k;
    EXPECT_LE(exact.right(), seen.visible_box_px->right() + 1) << k;
    EXPECT_LT(exact.x - seen.visible_box_px->x, 14) << k;
    ASSERT_TRUE(seen.centroid_px);
    EXPECT_TRUE(seen.visible_box_px->contains(static_cast<int>((*seen.centroid_px)[0]),
                                              static_cast<int>((*seen.centroid_px)[1])));
    EXPECT_TRUE(truth.rotation);
  }
  EXPECT_GT(visible, 3);
  // The record alone reproduces the frames, and the bytes do not depend on the number of threads.
  const replay::Recomposition again = replay::recompose(finished, 3, {});
  EXPECT_TRUE(again.faults.empty()) << (again.faults.empty() ? "" : again.faults.front());
  const std::string truth_of_one = read_file(finished.folder / "truth.jsonl");
  Options two;
  two.threads = 2;
  two.overwrite = true;
  EXPECT_EQ(read_file(rendered(scene, two).folder / "truth.jsonl"), truth_of_one);
}

TEST_F(Sequence, ACameraFileOfAnotherClipIsRefusedAndWhatCannotBeMeasuredIsSaid) {
  write_file(root_ / "small.toml",
             "[clip]\nwidth = 64\nheight = 48\n[optics]\npoint_spread_px = 1\n");
  write_file(root_ / "lens.toml",
             std::string("[clip]\nwidth = ") + std::to_string(kWidth) +
                 "\nheight = " + std::to_string(kHeight) +
                 "\nlens = \"fisheye 99.0 "
                 "px\"\n[optics]\npoint_spread_px = 1\n");
  const auto said = [&](const std::string& more) {
    try {
      render(scene_of("s", crossing("a", "738/738-Ryanair", 120), "", more), out_, {});
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("nothing");
  };
  EXPECT_NE(said("[realism]\nfile = \"small.toml\"\n").find("was measured on a clip of 64 x 48 px"),
            std::string::npos);
  EXPECT_NE(said("[realism]\nfile = \"lens.toml\"\n").find("through the lens 'fisheye 99.0 px'"),
            std::string::npos);
  write_file(root_ / "tone.toml",
             std::string("[clip]\nwidth = ") + std::to_string(kWidth) +
                 "\nheight = " + std::to_string(kHeight) + "\n[optics]\npoint_spread_px = 1\n");
  EXPECT_NE(said("[sensor]\ngamma = 2\n[realism]\nfile = \"tone.toml\"\n")
                .find("was measured with sRGB's tone curve; the scene's is 2"),
            std::string::npos);
  // FFV1 reports no quantiser.
  const std::string why = said("[sensor]\ncodec_step = \"auto\"\n");
  EXPECT_NE(why.find("sensor.codec_step cannot be measured"), std::string::npos) << why;
  EXPECT_NE(why.find("fallback"), std::string::npos) << why;
  EXPECT_TRUE(left_in_out().empty());
  Options options;
  std::vector<std::string> warnings;
  options.warn = [&](const std::string& w) { warnings.push_back(w); };
  options.use_cache = false;
  const Summary summary =
      render(scene_of("s",
                      crossing("a", "738/738-Ryanair", 120),
                      "",
                      "[sensor]\ncodec_step = \"auto\"\n[realism]\nfallback = true\n"),
             out_,
             options);
  EXPECT_GT(summary.frames_visible, 0);
  EXPECT_FALSE(warnings.empty());
}

// The frame of a cut is counted from the clip's first, as the truth counts.
TEST_F(Sequence, AClipThatRunsAcrossACutIsNamed) {
  constexpr int kCut = 8;
  fs::create_directories(out_ / "shots");
  for (int i = 0; i < 2 * kCut; ++i) {
    image::Rgb8 grey = image::make_rgb8(kWidth, kHeight);
    std::fill_n(grey.samples.get(), grey.bytes().size(), std::uint8_t(i < kCut ? 60 : 200));
    video::write_still(out_ / "shots" / fmt::format("{:02}.png", i), grey);
  }
  scene::Scene scene =
      scene_of("cut", crossing("a", "c172/news", 60), "first_frame = 2\nframe_rate_hz = 30\n");
  scene.background.video = out_ / "shots";
  Options options;
  std::vector<std::string> warnings;
  options.warn = [&](const std::string& w) { warnings.push_back(w); };
  rendered(scene, options);
  EXPECT_THAT(warnings, testing::Contains(testing::HasSubstr("the clip is cut at its frame 6:")));
}

// Matroska states no number of frames: of twelve with a tenth of the rate that it states, more than
// a hundred are expected.
TEST_F(Sequence, AMaskForEachFrameServesAClipThatStatesNoNumberOfFrames) {
  video::Reader reader(root_ / "flight.mkv");
  video::Writer writer(out_ / "slow.mkv", reader.info(), {.format = video::Format::kMkv});
  while (auto frame = reader.next()) {
    frame->pts *= 10;
    writer.write(*frame);
  }
  writer.finish();
  const std::string half(std::size_t{kWidth} * kHeight / 2, '\0');
  for (int k = 0; k < kFrames; ++k)
    write_file(
        out_ / fmt::format("hill{:02}.pgm", k),
        fmt::format("P5\n{} {}\n255\n", kWidth, kHeight) + half + std::string(half.size(), '\xff'));
  scene::Scene scene = scene_of("slow", crossing("a", "c172/news", 60));
  scene.background.video = out_ / "slow.mkv";
  scene.occluders = {{50, out_ / "hill%02d.pgm", false, {}}};
  EXPECT_GT(video::Reader(scene.background.video).info().frame_count_estimate, kFrames + 2);
  EXPECT_EQ(rendered(scene).truth.frames.size(), std::size_t{kFrames});
}

TEST_F(Sequence, ARateOfAVideoIsRefused) {
  EXPECT_THAT(
      test_support::error_of([&] {
        rendered(scene_of("rate", crossing("a", "c172/news", 60), "frame_rate_hz = 60\n"));
      }),
      testing::AllOf(testing::HasSubstr("scene.toml:2:"),
                     testing::HasSubstr("frame_rate_hz is 60, and the background is a video")));
  EXPECT_FALSE(fs::exists(out_ / "rate"));
}

// A virtual flight states its attitude; its first frame is banked by more than 10 degrees.
TEST_F(Sequence, AnAttitudeThatIsNotStatedIsThatOfTheHorizon) {
  synthetic::FlightOptions options;
  options.width = 320;
  options.height = 240;
  options.frame_count = 24;
  options.own_aircraft = false;
  options.hills_deg = 0;
  options.roll_deg = 30;
  options.altitude_m = 900;
  options.seed = 2;
  const synthetic::Flight flight(options);
  demo::VirtualFlightOptions how;
  how.format = video::Format::kMkv;
  demo::write_flight(flight, out_ / "banked.mkv", how);
  const YawPitchRoll expected = yaw_pitch_roll(flight.camera(0).world_from_body);
  EXPECT_GT(std::abs(expected.roll_deg), 10);
  const std::string text =
      "name = \"banked\"\n[background]\nvideo = \"banked.mkv\"\nframe_count = 3\n[lens]\n"
      "vertical_fov_deg = 75\n[motion]\nmodel = \"none\"\n[output]\nvideo = \"mkv\"\n" +
      crossing("a", "c172/news", 60) + "[camera]\nposition_ned_m = [0, 0, -900]\n";
  const Summary summary = render(scene::parse_scene(text, out_ / "s.toml"), out_, {});
  EXPECT_THAT(summary.notes,
              testing::ElementsAre(
                  testing::StartsWith("[camera] has no attitude_yaw_pitch_roll_deg: pitch ")));
  const replay::Finished finished = replay::open_finished(summary.folder);
  const auto [yaw_deg, pitch_deg, roll_deg] =
      finished.truth.frames[0].camera_attitude_yaw_pitch_roll_deg;
  // A pixel is 0.37 degrees, and the visible horizon lies 1.0 degree below level at 900 m.
  EXPECT_NEAR(pitch_deg, expected.pitch_deg, 0.3);
  EXPECT_NEAR(roll_deg, expected.roll_deg, 0.3);
  EXPECT_NEAR(yaw_deg, 0, 1e-9);
  // What sequence.json holds is stated: the same frames are made from it.
  EXPECT_TRUE(finished.scene->camera.attitude_yaw_pitch_roll_deg.has_value());
  EXPECT_TRUE(replay::recompose(finished, 1, {}).faults.empty());
  const Summary stated = render(
      scene::parse_scene(text + "attitude_yaw_pitch_roll_deg = [0, 0, 0]\n", out_ / "s.toml"),
      out_,
      {.overwrite = true});
  EXPECT_THAT(stated.notes, testing::IsEmpty());
  EXPECT_EQ(
      replay::open_finished(stated.folder).truth.frames[0].camera_attitude_yaw_pitch_roll_deg[2],
      0);
}

// The pictures f0.png, f1.png ... of the folder as a clip, seen by a camera without an attitude.
Summary render_pictures(const fs::path& folder, const std::string& intruder, const Warn& to = {}) {
  return render(scene::parse_scene("name = \"pictures\"\n[background]\nvideo = \"f%d.png\"\n"
                                   "frame_rate_hz = 30\n[lens]\nvertical_fov_deg = 75\n[motion]\n"
                                   "model = \"none\"\n" +
                                       intruder,
                                   folder / "s.toml"),
                folder,
                {.use_cache = false, .warn = to});
}

// A camera that nothing states to be upside down is not: what looks like it is no horizon.
TEST_F(Sequence, AHorizonThatStandsUpsideDownIsNone) {
  synthetic::FlightOptions options;
  options.width = 320;
  options.height = 240;
  options.frame_count = 3;
  options.own_aircraft = false;
  options.hills_deg = 0;
  demo::VirtualFlightOptions how;
  how.format = video::Format::kMkv;
  demo::write_flight(synthetic::Flight(options), out_ / "level.mkv", how);
  video::Reader reader(out_ / "level.mkv");
  for (int k = 0; k < 3; ++k) {
    image::Rgb8 picture = image::rgb8_from_picture(reader.next()->picture);
    image::Rgb8 turned = image::make_rgb8(picture.width, picture.height);
    const std::size_t pixels = std::size_t{320} * 240;
    for (std::size_t i = 0; i < pixels; ++i)
      std::copy_n(&picture.samples[3 * i], 3, &turned.samples[3 * (pixels - 1 - i)]);
    video::write_still(out_ / ("f" + std::to_string(k) + ".png"), turned);
  }
  const Summary summary = render_pictures(out_, crossing("a", "c172/news", 60));
  EXPECT_THAT(summary.notes, testing::Contains(testing::HasSubstr("stands upside down")));
  EXPECT_EQ(
      replay::open_finished(summary.folder).truth.frames[0].camera_attitude_yaw_pitch_roll_deg[2],
      0);
}

TEST_F(Sequence, WithoutAHorizonTheCameraIsLevelAndItIsSaid) {
  image::Rgb8 grey = image::make_rgb8(kWidth, kHeight);
  std::fill_n(grey.samples.get(), std::size_t{kWidth} * kHeight * 3, std::uint8_t{120});
  for (const char* name : {"f0.png", "f1.png", "f3.png"}) video::write_still(out_ / name, grey);
  std::vector<std::string> warnings;
  const Summary summary = render_pictures(
      out_, crossing("a", "c172/news", 60), [&](const auto& text) { warnings.push_back(text); });
  // Two readers of the clip say once what is to be said of it.
  EXPECT_EQ(std::ranges::count_if(
                warnings, [](const auto& text) { return text.find("gaps between") != text.npos; }),
            1);
  EXPECT_THAT(summary.notes, testing::Contains(testing::HasSubstr("it is level, since ")));
  const auto attitude =
      replay::open_finished(summary.folder).truth.frames[0].camera_attitude_yaw_pitch_roll_deg;
  EXPECT_EQ(attitude[1], 0);
  EXPECT_EQ(attitude[2], 0);
}

}  // namespace
}  // namespace airtruth::pipeline
