// SPDX-License-Identifier: Apache-2.0
#include "dataset/stream/stream.h"

#include <algorithm>
#include <cmath>
#include <future>
#include <map>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dataset/stream/plan.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/image/contrast_to_noise.h"
#include "labels/annotation/truth.h"
#include "picture/composite/cover.h"
#include "picture/video/reader.h"
#include "sequence/demo/demo.h"
#include "sequence/insertion/masks.h"
#include "sequence/pipeline/render.h"
#include "support/error_of.h"
#include "support/temporary_folder.h"

namespace airtruth::stream {
namespace {

using testing::HasSubstr;
TEST(Places, LanesTakeTurnsAndAFrameIsUsedOftenBeforeTheNext) {
  const Place later = place_of(8 * kRunFrames * 8 + 3, 8);  // the lanes' first runs are over
  EXPECT_EQ(place_of(9, 8).run, 1);
  EXPECT_EQ(place_of(9, 8).step, 0);
  EXPECT_EQ(place_of(9, 8).sample_of_run, 1);
  EXPECT_EQ(place_of(64, 8).run, 0);
  EXPECT_EQ(place_of(64, 8).step, 1);
  EXPECT_EQ(later.run, 8 + 3);
  EXPECT_EQ(later.step, 0);
}

TEST(Places, EverySampleOfARunHasANumberOfItsOwn) {
  std::set<std::pair<std::int64_t, std::int64_t>> seen;
  for (std::int64_t i = 0; i < 5000; ++i) {
    const Place place = place_of(i, 3);
    EXPECT_LT(place.step, kRunFrames);
    EXPECT_LT(place.sample_of_run, kRunFrames * 3);
    seen.insert({place.run, place.sample_of_run});
  }
  EXPECT_EQ(seen.size(), 5000u);
}

class StreamOfFlights : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test_support::TemporaryFolder();
    for (const int seed : {3, 4}) {
      synthetic::FlightOptions options;
      options.seed = static_cast<std::uint64_t>(seed);
      options.width = 320;
      options.height = 240;
      options.frame_count = 24;
      options.own_aircraft = false;
      demo::write_flight(synthetic::Flight(options),
                         folder_->path() / ("flight" + std::to_string(seed) + ".mp4"),
                         {});
    }
  }
  static void TearDownTestSuite() { delete folder_; }

  static std::string background(const std::string& name, const std::string& more = "") {
    return "[[background]]\nname = \"" + name + "\"\nvideo = \"" + name +
           ".mp4\"\nlens = { vertical_fov_deg = 60 }\ncamera = { position_ned_m = [0, 0, -300], "
           "velocity_ned_mps = [25, 0, 0] }\n" +
           more;
  }
  static constexpr const char* kRule =
      "[[random]]\ncount = 100\naircraft = [\"738/738-Ryanair\", \"c172/news\"]\n"
      "size_px = [10, 60]\nazimuth_deg = [-25, 25]\nelevation_deg = [-15, 15]\nnegatives = 0.2\n";

  static catalogue::Catalogue catalogue_of(const std::string& text) {
    return catalogue::parse_catalogue(text, folder_->path() / "c.toml");
  }
  static pipeline::Options options() {
    pipeline::Options options;
    options.use_cache = false;
    options.threads = 1;
    return options;
  }
  static Stream stream_of(const std::string& text, std::uint64_t seed = 7) {
    return {catalogue_of(text), seed, options()};
  }

  static inline test_support::TemporaryFolder* folder_ = nullptr;
};

TEST_F(StreamOfFlights, ABackgroundsPartIsAllThatItsSamplesShow) {
  const std::string small = "[stream]\nsize_px = [64, 64]\n";
  const Stream part =
      stream_of(small + background("flight3", "first_frame = 5\nframe_count = 3\n") + kRule);
  std::set<std::int64_t> seen;
  for (int i = 0; i < 40; ++i) seen.insert(part.sample(i * 16).first_frame);
  EXPECT_EQ(seen, (std::set<std::int64_t>{5, 6, 7}));
  EXPECT_EQ(stream_of(small + background("flight3", "first_frame = 23\nframe_count = 1\n") + kRule)
                .sample(0)
                .first_frame,
            23);
  const Stream longer =
      stream_of(small + "frames = 4\n" + background("flight3", "frame_count = 3\n") + kRule);
  EXPECT_THAT([&] { longer.sample(0); },
              testing::ThrowsMessage<Error>(
                  testing::HasSubstr("has a frame_count of 3; expected the 4 frames")));
}

// A run goes on over other backgrounds where one frame of its first is all that is used.
TEST_F(StreamOfFlights, AShortPartDoesNotStayForAWholeRun) {
  std::string frames_of_two = "[stream]\nsize_px = [64, 64]\n";
  for (const std::string frame : {"1", "5", "9", "13", "17"})
    for (const std::string flight : {"flight3", "flight4"}) {
      std::string one = background(flight, "first_frame = " + frame + "\nframe_count = 1\n");
      frames_of_two += one.replace(one.find(flight), flight.size(), flight + "-" + frame);
    }
  const Stream frames = stream_of(frames_of_two + kRule);
  std::set<std::string> shown;
  for (int step = 0; step < 24; ++step) {
    const Sample sample = frames.sample(step * kLanes * 8);  // one lane's next frames
    EXPECT_THAT(sample.background, testing::EndsWith("-" + std::to_string(sample.first_frame)));
    shown.insert(sample.background);
  }
  EXPECT_GE(shown.size(), 6u);
}

void expect_same(const Sample& a, const Sample& b) {
  EXPECT_EQ(a.background, b.background);
  EXPECT_EQ(a.first_frame, b.first_frame);
  EXPECT_EQ(a.crop, b.crop);
  ASSERT_EQ(a.frames.size(), b.frames.size());
  for (std::size_t k = 0; k < a.frames.size(); ++k) {
    EXPECT_TRUE(image::identical(a.frames[k].picture, b.frames[k].picture));
    EXPECT_EQ(a.frames[k].masks, b.frames[k].masks);
    EXPECT_EQ(a.frames[k].covered, b.frames[k].covered);
    EXPECT_EQ(annotation::jsonl_line(a.frames[k].truth, {}),
              annotation::jsonl_line(b.frames[k].truth, {}));
  }
}

// What is covered of the picture are the pixels of the masks with an alpha of 0.08 or more; where
// the crop holds all of it, it is what is covered of the frame.
void expect_covered(const Sample::Frame& frame, const PixelBox& crop) {
  ASSERT_EQ(frame.covered.size(), frame.truth.intruders.size());
  for (std::size_t i = 0; i < frame.masks.size(); ++i) {
    std::optional<PixelBox> seen;
    for (int y = 0; y < crop.height; ++y)
      for (int x = 0; x < crop.width; ++x)
        if (frame.masks[i][static_cast<std::size_t>(y * crop.width + x)] >= 0.08 * 255 - 0.5)
          seen = seen ? bounds(*seen, {x, y, 1, 1}) : PixelBox{x, y, 1, 1};
    EXPECT_EQ(frame.covered[i], seen);
    const auto& whole = frame.truth.intruders[i].covered_box_px;
    if (!whole || intersection(*whole, crop) != *whole) continue;
    EXPECT_EQ(frame.covered[i],
              (PixelBox{whole->x - crop.x, whole->y - crop.y, whole->width, whole->height}));
  }
}

// The masks are those in a folder that render() made.
void expect_masks(const Sample::Frame& frame,
                  const PixelBox& crop,
                  const annotation::Truth& truth,
                  const fs::path& made) {
  for (std::size_t i = 0; i < frame.masks.size(); ++i) {
    const auto whole = insertion::read_alpha_mask(
        made, truth.lens, frame.truth.intruders[i].id, frame.truth.frame);
    EXPECT_EQ(frame.masks[i], insertion::samples_in(whole.value_or(composite::AlphaMask{}), crop));
  }
}

// The folder of a scene that render() made.
fs::path rendered(const scene::Scene& scene, const fs::path& out) {
  pipeline::Options how;
  how.use_cache = false;
  return pipeline::render(scene, out, how).folder;
}

// render() of the sample's scene, read back from its text, gives the same pictures and truth.
void expect_as_rendered(const Stream& stream, std::int64_t index, const fs::path& out) {
  const Sample sample = stream.sample(index);
  scene::Scene scene =
      scene::parse_scene(scene::toml_from_scene(stream.scene(index)), out / "scene.toml");
  scene.output.masks = stream.has_masks();
  const fs::path made = rendered(scene, out);
  video::Reader video(made / (scene.name + ".mkv"));
  const annotation::Truth truth = annotation::read_truth(made / "truth.jsonl");
  ASSERT_EQ(sample.frames.size(), truth.frames.size());
  for (std::size_t k = 0; k < sample.frames.size(); ++k) {
    const auto frame = video.next();
    ASSERT_TRUE(frame);
    EXPECT_TRUE(
        image::identical(sample.frames[k].picture, image::crop(frame->picture, sample.crop)))
        << "sample " << index << ", frame " << k;
    EXPECT_EQ(annotation::jsonl_line(sample.frames[k].truth, truth.lens),
              annotation::jsonl_line(truth.frames[k], truth.lens));
    expect_masks(sample.frames[k], sample.crop, truth, made);
    expect_covered(sample.frames[k], sample.crop);
  }
}

TEST_F(StreamOfFlights, WorkersThatNeedTheSameFlightAtOnceMakeItOnce) {
  const std::string text =
      "[[background]]\nname = \"made\"\nflight = { seed = 5, frame_count = 24, width = 160, "
      "height = 120 }\nlens = { vertical_fov_deg = 60 }\n"
      "camera = { position_ned_m = [0, 0, -300], velocity_ned_mps = [25, 0, 0] }\n";
  pipeline::Options how = options();
  how.use_cache = true;
  how.cache = folder_->path() / "flights_cache";
  const auto catalogue = catalogue_of(text + kRule + "[stream]\npicture = \"frame\"\nframes = 1\n");
  std::vector<std::future<Sample>> samples;
  for (int worker = 0; worker < 4; ++worker)
    samples.push_back(
        std::async(std::launch::async, [&] { return Stream(catalogue, 7, how).sample(0); }));
  const Sample first = samples.front().get();
  for (std::size_t k = 1; k < samples.size(); ++k) expect_same(samples[k].get(), first);
}

// The text of the catalogue is the same with another lens in its file.
TEST_F(StreamOfFlights, AFlightIsThatOfItsLensFile) {
  const std::string text =
      "[[background]]\nname = \"made\"\nflight = { seed = 5, frame_count = 24, width = 160, "
      "height = 120 }\nlens = { file = \"lens.json\" }\n";
  const auto catalogue = catalogue_of(text + kRule + "[stream]\npicture = \"frame\"\n");
  const auto sample = [&](const std::string& focal_px, const char* cache) {
    write_file(folder_->path() / "lens.json",
               "{\"calib_dimension\": {\"w\": 160, \"h\": 120}, \"fisheye_params\": {"
               "\"camera_matrix\": [[" +
                   focal_px + ",0,80],[0," + focal_px +
                   ",60],[0,0,1]], \"radial_distortion_limit\": 2.5, \"distortion_coeffs\": "
                   "[0.06, 0.01, -0.01, 0.004]}}");
    pipeline::Options how = options();
    how.use_cache = true;
    how.cache = folder_->path() / cache;
    return Stream(catalogue, 7, how).sample(0);
  };
  const Sample wide = sample("80", "lens_cache");
  const Sample narrow = sample("160", "lens_cache");
  EXPECT_FALSE(image::identical(narrow.frames[0].picture, wide.frames[0].picture));
  expect_same(narrow, sample("160", "empty_cache"));
}

TEST_F(StreamOfFlights, AShareOfSamplesIsAsOtherCamerasShowThem) {
  const std::string text = background("flight3") + kRule + "[stream]\nsize_px = [64, 64]\n";
  const Stream own = stream_of(text);
  const Stream mixed = stream_of(text + "other_cameras = 0.5\n");
  int as_own = 0;
  for (int i = 0; i < 20; ++i) {
    const Sample plain = own.sample(i);
    const Sample sample = mixed.sample(i);
    EXPECT_EQ(sample.crop, plain.crop);
    if (image::identical(sample.frames[0].picture, plain.frames[0].picture)) {
      ++as_own;
      expect_same(sample, plain);
      continue;
    }
    expect_same(sample, mixed.sample(i));
    for (std::size_t k = 0; k < plain.frames[0].truth.intruders.size(); ++k) {
      const annotation::Intruder& intruder = sample.frames[0].truth.intruders[k];
      EXPECT_EQ(intruder.covered_box_px, plain.frames[0].truth.intruders[k].covered_box_px);
      EXPECT_EQ(intruder.visible_box_px, plain.frames[0].truth.intruders[k].visible_box_px);
      if (!intruder.contrast_to_noise) continue;
      PixelBox box = *annotation::box_to_show(intruder);
      box.x -= sample.crop.x;
      box.y -= sample.crop.y;
      EXPECT_EQ(intruder.contrast_to_noise,
                image::contrast_to_noise(sample.frames[0].picture, box));
    }
  }
  EXPECT_NEAR(as_own, 10, 6);
}

TEST_F(StreamOfFlights, SamplesAreWhatRenderMakesOfTheirScenes) {
  const Stream stream =
      stream_of(background("flight3") + background("flight4") + kRule +
                "[stream]\nsize_px = [128, 96]\nintruders = [1, 3]\nmasks = true\n");
  const Sample one = stream.sample(1);
  EXPECT_EQ(one.frames[0].masks.size(), one.frames[0].truth.intruders.size());
  for (const std::int64_t index : {0, 1, 65, 4099})
    expect_as_rendered(stream, index, folder_->path() / "plain");
}

TEST_F(StreamOfFlights, WhatACropCutsIsBoundedByWhatItCoversThere) {
  const Stream stream =
      stream_of(background("flight3") + kRule +
                "[stream]\nsize_px = [32, 32]\nintruders = [3, 3]\nmasks = true\n");
  int tighter = 0;
  for (std::int64_t index = 0; index < 60 && tighter == 0; ++index) {
    const Sample sample = stream.sample(index);
    const Sample::Frame& frame = sample.frames[0];
    expect_covered(frame, sample.crop);
    for (std::size_t i = 0; i < frame.covered.size(); ++i) {
      const auto& whole = frame.truth.intruders[i].covered_box_px;
      const auto cut = whole ? intersection(*whole, sample.crop) : std::nullopt;
      if (!cut) continue;
      const auto& seen = frame.covered[i];
      tighter += !seen || seen->width < cut->width || seen->height < cut->height ? 1 : 0;
    }
  }
  EXPECT_GT(tighter, 0);
}

TEST_F(StreamOfFlights, SoAreSeveralFramesWithACameraAndDistractors) {
  const Stream stream = stream_of(
      background("flight3",
                 "shutter = { exposure_s = 0.01 }\noptics = { point_spread_px = 0.6 }\n"
                 "sensor = { noise_gain = 1e-4, noise_floor = 1e-5, codec_step = 6 }\n") +
      background("flight4", "motion = { reference = \"smoothed\" }\n") + kRule +
      "[[distractor]]\nkind = \"bird\"\n[stream]\npicture = \"frame\"\nframes = 3\nreuse = 2\n");
  for (const std::int64_t index : {0, 1, 17, 1030})
    expect_as_rendered(stream, index, folder_->path() / "frames");
}

TEST_F(StreamOfFlights, SoAreEncountersFromWhereTheyAreInView) {
  const std::string encounters =
      "[[encounter_model]]\nname = \"e{index}\"\nkind = \"geometric\"\ncount = 50\n"
      "frame_count = 120\naircraft = [\"c172/news\", \"738/738-Ryanair\"]\nhmd_m = [0, 100]\n"
      "vmd_m = [0, 50]\ncpa_time_s = [2, 4]\n"
      "[[random]]\nname = \"r{index}\"\ncount = 50\nframe_count = 60\naircraft = "
      "[\"c172/news\"]\n[random.encounter]\ncpa_right_m = [-40, 40]\ncpa_above_m = [-10, 10]\n";
  const Stream stream = stream_of(background("flight3") + encounters +
                                  "[stream]\nsize_px = [128, 96]\nframes = 2\nreuse = 2\n");
  int of_the_model = 0, passages = 0, passages_seen = 0;
  for (std::int64_t index = 0; index < 24; ++index) {
    const Sample sample = stream.sample(index);
    const bool is_seen = std::ranges::any_of(
        sample.frames[0].truth.intruders,
        [](const annotation::Intruder& one) { return one.state == annotation::State::kVisible; });
    if (stream.scene(index).intruders.at(0).encounter) {
      ++passages;
      passages_seen += is_seen ? 1 : 0;
    } else {
      ++of_the_model;
      EXPECT_TRUE(is_seen) << index;
    }
  }
  EXPECT_GE(of_the_model, 8);
  // They come from any side.
  EXPECT_GE(5 * passages_seen, 2 * passages);
  for (const std::int64_t index : {0, 2})
    expect_as_rendered(stream, index, folder_->path() / "encounters");
}

// The background lasts 0.8 s and the passages 10 s. Head-on at 25 + 50 m/s and 40 m to the right,
// an aircraft leaves the lens's 75 degrees 40 m / (tan(30 degrees) * 4/3) = 52 m ahead, 0.693 s
// before its closest approach.
TEST_F(StreamOfFlights, APassageIsNoShorterOverAShortBackground) {
  const Stream stream = stream_of(
      background("flight3") +
      "[[random]]\ncount = 50\nframe_count = 300\naircraft = [\"c172/news\"]\n[random.encounter]\n"
      "cpa_right_m = 40\ncourse_deg = 180\nspeed_mps = 50\n[stream]\n");
  double latest_s = 0;
  for (std::int64_t index = 0; index < 24; ++index) {
    const double left_s = stream.scene(index).intruders.at(0).encounter->cpa_time_s;
    EXPECT_GT(left_s, 0.69) << index;
    latest_s = std::max(latest_s, left_s);
  }
  EXPECT_GT(latest_s, 2);
}

TEST_F(StreamOfFlights, WhatIsPutOverARunIsDrawnForEachSampleByTheCountsOfTheRules) {
  const auto rule = [](const std::string& name, int count, const std::string& more) {
    return "[[random]]\nname = \"" + name + "{index}\"\ncount = " + std::to_string(count) +
           "\naircraft = [\"" + name + "/*\"]\n" + more;
  };
  const Stream stream = stream_of(
      background("flight3") + background("flight4", "weight = 3\n") + rule("738", 30, "") +
      rule("c172", 10, "backgrounds = [\"flight3\"]\n") + "[stream]\nreuse = 1\n");
  constexpr int kSamples = 4096;  // of 256 whole runs
  int of_c172 = 0;
  int over_3 = 0;
  std::map<std::int64_t, std::set<bool>> of_run_over_3;
  for (std::int64_t index = 0; index < kSamples; ++index) {
    const scene::Scene scene = stream.scene(index);
    const bool is_c172 = scene.intruders.at(0).aircraft.starts_with("c172/");
    const bool is_over_3 = scene.background.video.filename() == "flight3.mp4";
    EXPECT_TRUE(is_over_3 || !is_c172);
    of_c172 += is_c172 ? 1 : 0;
    over_3 += is_over_3 ? 1 : 0;
    if (is_over_3) of_run_over_3[place_of(index, 1).run].insert(is_c172);
  }
  // Four standard deviations of independent runs, and of independent samples.
  EXPECT_NEAR(over_3, (0.25 + 0.75 / 4) * kSamples, 4 * 0.5 * std::sqrt(256.0) * 16);
  EXPECT_NEAR(of_c172, over_3 * 0.25 / (0.25 + 0.75 / 4), 4 * std::sqrt(0.25 * over_3));
  for (const auto& [run, kinds] : of_run_over_3) EXPECT_EQ(kinds.size(), 2u) << run;
}

// Of the types' many liveries; 64 / 5 = 12 in each of five fleets, and two rules share one.
TEST_F(StreamOfFlights, RulesOfTheSameTypesFlyTheSameFewAircraft) {
  std::string rules;
  for (const char* type : {"738", "738", "A320", "A319", "757", "777"})
    rules += "[[random]]\nname = \"" + std::to_string(rules.size()) +
             "-{index}\"\ncount = 10\naircraft = [\"" + type + "/*\"]\n";
  const Stream stream = stream_of(background("flight3") + rules + "[stream]\n");
  std::map<std::string, std::set<std::string>> of_type;
  for (std::int64_t index = 0; index < 1024; ++index) {
    const std::string aircraft = stream.scene(index).intruders.at(0).aircraft;
    of_type[aircraft.substr(0, aircraft.find('/'))].insert(aircraft);
  }
  EXPECT_EQ(of_type.size(), 5u);
  std::size_t all = 0;
  for (const auto& [type, aircraft] : of_type) {
    EXPECT_LE(aircraft.size(), 15u) << type;  // and what changed: one in 512 samples
    all += aircraft.size();
  }
  EXPECT_LE(all, 62u);
  EXPECT_GT(of_type.at("738").size(), 8u);
}

TEST_F(StreamOfFlights, PropellersOfEachIntruderStandAtAPlaceOfTheirOwn) {
  const Stream stream = stream_of(
      background("flight3") +
      "[[random]]\ncount = 100\naircraft = [\"FK9MK2/*\"]\nsize_px = [60, 75]\nazimuth_deg = "
      "[-5, 5]\nelevation_deg = [-5, 5]\n[stream]\npicture = \"frame\"\nintruders = [2, 2]\n");
  std::set<double> times;
  for (std::int64_t index = 0; index < 8; ++index)
    for (const scene::Intruder& intruder : stream.scene(index).intruders)
      times.insert(intruder.spin_time_s);
  EXPECT_EQ(times.size(), 16u);
  scene::Scene scene = stream.scene(0);
  for (scene::Intruder& intruder : scene.intruders) intruder.spin_time_s = 0;
  video::Reader video(rendered(scene, folder_->path() / "at rest") / (scene.name + ".mkv"));
  EXPECT_FALSE(image::identical(video.next()->picture, stream.sample(0).frames[0].picture));
}

TEST_F(StreamOfFlights, ASampleDependsOnItsIndexAndTheSeedAlone) {
  const std::string text = background("flight3") + background("flight4") + kRule +
                           "[stream]\nsize_px = [128, 128]\nreuse = 2\nframes = 2\n";
  const Stream forwards = stream_of(text);
  const Stream backwards = stream_of(text);
  std::vector<Sample> samples;
  for (std::int64_t i = 0; i < 24; ++i) samples.push_back(forwards.sample(i));
  for (std::int64_t i = 23; i >= 0; --i)
    expect_same(backwards.sample(i), samples[static_cast<std::size_t>(i)]);
  const Sample other = stream_of(text, 8).sample(0);
  EXPECT_FALSE(other.first_frame == samples[0].first_frame && other.crop == samples[0].crop &&
               image::identical(other.frames[0].picture, samples[0].frames[0].picture));
}

TEST_F(StreamOfFlights, ACropShowsOneAircraftWholeAndAShareOfSamplesHasNone) {
  const Stream stream = stream_of(background("flight3") + kRule + "[stream]\nsize_px = [96, 80]\n");
  int without = 0;
  for (std::int64_t i = 0; i < 25; ++i) {
    const Sample sample = stream.sample(i);
    EXPECT_EQ(sample.frames[0].picture.width, 96);
    EXPECT_EQ(sample.frames[0].picture.height, 80);
    EXPECT_GE(sample.crop.x, 0);
    EXPECT_LE(sample.crop.right(), 320);
    EXPECT_LE(sample.crop.bottom(), 240);
    const auto& intruders = sample.frames[0].truth.intruders;
    if (intruders.empty()) {
      ++without;
      continue;
    }
    const auto& box = intruders[0].covered_box_px;
    if (!box) continue;
    EXPECT_EQ(bounds(*box, sample.crop), sample.crop) << i;
  }
  EXPECT_NEAR(without, 5, 2);
}

TEST_F(StreamOfFlights, WhatAStreamCannotUseIsSaidAtOnce) {
  const auto message = [&](const std::string& text) -> std::string {
    return test_support::error_of([&] { stream_of(text).sample(0); });
  };
  EXPECT_THAT(message(background("flight3") + kRule + "[stream]\nsize_px = [400, 96]\n"),
              HasSubstr("size_px is 400 x 96; the frames of background 'flight3' are 320 x 240"));
  EXPECT_THAT(message(background("flight3") + kRule + "[stream]\npicture = \"frame\"\n" +
                      "size_px = [64, 64]\n"),
              HasSubstr("size_px is for picture = \"crop\""));
  EXPECT_THAT(message(background("flight3") +
                      "[[aircraft]]\nname = \"a\"\naircraft = \"c172\"\n"
                      "[[trajectory]]\nname = \"t\"\nwaypoints_ned_m = [[100, 0, -300], [100, 9, "
                      "-300]]\nspeed_mps = 40\n[[product]]\n"),
              HasSubstr("a stream draws from [[random]] and [[encounter_model]]"));
  EXPECT_THAT(message(background("nowhere") + kRule), HasSubstr("nowhere.mp4"));
  const Stream stream = stream_of(background("flight3") + kRule);
  EXPECT_THROW(stream.sample(-1), Error);
  EXPECT_THROW(stream.scene((std::int64_t{1} << 40) + 1), Error);
}

}  // namespace
}  // namespace airtruth::stream
