// SPDX-License-Identifier: Apache-2.0
// The truth of a rendered set as the measures of detections take it, against its truth.jsonl and
// against paths that are known.
#include "evaluation/detector_evaluation/set_truth.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "evaluation/detector_evaluation/assess.h"
#include "evaluation/detector_evaluation/tables.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "runners/results/results_folder.h"
#include "scene/scene/scene.h"
#include "sequence/demo/demo.h"
#include "sequence/pipeline/render.h"
#include "sequence/replay/finished.h"
#include "support/temporary_folder.h"

namespace airtruth::detector_evaluation {
namespace {

constexpr int kFrames = 12;
// The own aircraft flies north at 25 m/s, the intruder south at 55 m/s, 60 m to the right and 15 m
// higher at the closest approach after 8 s.
constexpr double kApproach_s = 8;
// The same with a path that ends after 1.8 s, 1100 m north of where the own aircraft begins: from
// there it flies straight on.
constexpr double kShortApproach_s = 1100 / 80.0;

class OfRenderedSet : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    root_ = fs::temp_directory_path() / ("airtruth_set_truth_test_" + std::to_string(::getpid()));
    fs::create_directories(root_);
    synthetic::FlightOptions options;
    options.width = 320;
    options.height = 240;
    options.frame_count = kFrames;
    options.own_aircraft = false;
    demo::VirtualFlightOptions how;
    how.format = video::Format::kMkv;
    demo::write_flight(synthetic::Flight(options), root_ / "flight.mkv", how);
    for (const char* set : {"set", "short"}) {
      render(set, "asked", "[truth]\nvolumes = [\"f3442\"]\n");
      render(set, "plain", "");
    }
  }
  static void TearDownTestSuite() { fs::remove_all(root_); }

  static void render(const std::string& set, const std::string& name, const std::string& tables) {
    const std::string path =
        set == "filed" ? "path_file = \"way.csv\"\n"
        : set == "short"
            ? "waypoints_ned_m = [[1100, 60, -165], [1000, 60, -165]]\nspeed_mps = 55\n"
            : "[intruder.encounter]\ncpa_time_s = 8\ncpa_right_m = 60\n"
              "cpa_above_m = 15\ncourse_deg = 180\nspeed_mps = 55\n";
    const std::string text = "name = \"" + name +
                             "\"\nweight = 3\n[background]\nvideo = \"flight.mkv\"\n" +
                             (set == "single" ? "frame_count = 1\n" : "") +
                             "[lens]\nmodel = \"pinhole\"\nvertical_fov_deg = 20\n"
                             "[camera]\nposition_ned_m = [0, 0, -150]\n"
                             "velocity_ned_mps = [25, 0, 0]\nattitude_yaw_pitch_roll_deg = [0, 0, "
                             "0]\n[motion]\nmodel = \"none\"\n" +
                             tables + "[[intruder]]\nid = \"him\"\naircraft = \"c172/g-boix\"\n" +
                             path + "[output]\nvideo = \"mkv\"\n";
    pipeline::Options options;
    options.use_cache = false;
    pipeline::render(scene::parse_scene(text, root_ / "scene.toml"), root_ / set, options);
  }

  static SetTruth truth(const std::string& volume = "", const std::string& set = "set") {
    return set_truth(root_ / set, volume, {});
  }

  // A folder of results that are the truth, shifted to the right, as one track.
  static fs::path answered(const std::string& name, double shift_px) {
    const fs::path folder = root_ / name;
    fs::create_directories(folder);
    for (const scores::TruthSequence& one : truth().sequences) {
      results::SequenceDetections detections{one.name, one.width, one.height, {}, {}};
      for (const scores::TruthFrame& frame : one.frames) {
        auto& list = detections.frames.emplace_back();
        for (const scores::TruthObject& object : frame.objects) {
          list.push_back({object.box_px, 1, "aircraft", 5});
          list.back().box_px.x += shift_px;
        }
      }
      write_sequence(folder, detections);
    }
    write_file(folder / "detector.json", "{}");
    return folder;
  }

  static inline fs::path root_;
};

TEST_F(OfRenderedSet, HoldsWhatTruthJsonlStates) {
  const SetTruth set = truth();
  ASSERT_EQ(set.sequences.size(), 2u);
  EXPECT_TRUE(set.is_weighted);
  const scores::TruthSequence& one = set.sequences[0];
  EXPECT_EQ(one.name, "asked");
  EXPECT_EQ(one.weight, 3);
  EXPECT_EQ(one.background, "flight.mkv");
  EXPECT_EQ(one.width, 320);
  const replay::Finished finished = replay::open_finished(root_ / "set" / "asked");
  ASSERT_EQ(one.frames.size(), finished.truth.frames.size());
  EXPECT_NEAR(one.duration_s, kFrames / 30.0, 1e-3);  // Matroska counts milliseconds
  std::size_t counting = 0;
  for (std::size_t i = 0; i < one.frames.size(); ++i) {
    const annotation::Intruder& him = finished.truth.frames[i].intruders[0];
    ASSERT_EQ(one.frames[i].objects.size(), him.visible_box_px ? 1u : 0u);
    if (!him.visible_box_px) continue;
    const scores::TruthObject& object = one.frames[i].objects[0];
    EXPECT_EQ(object.counts, him.covered_box_px.has_value());
    const PixelBox box = him.covered_box_px.value_or(*him.visible_box_px);
    EXPECT_EQ(object.box_px,
              (Box{double(box.x), double(box.y), double(box.width), double(box.height)}));
    EXPECT_EQ(object.range_m, him.range_m);
    EXPECT_EQ(object.azimuth_deg, him.azimuth_deg);
    EXPECT_TRUE(*object.above_horizon);
    EXPECT_NEAR(*object.to_closest_approach_s, kApproach_s - one.frames[i].time_s, 1e-3);
    counting += object.counts ? 1 : 0;
  }
  EXPECT_GT(counting, 0u);
  ASSERT_EQ(one.encounters.size(), 1u);
  EXPECT_EQ(one.encounters[0].name, "him");
  EXPECT_NEAR(*one.encounters[0].closest_approach_m, std::hypot(60, 15), 0.1);
  EXPECT_FALSE(one.encounters[0].has_volume);
}

// By hand: the horizontal distance is 2000 ft where 80 (8 - t) = sqrt(609.6^2 - 60^2); 15 m of
// height are within 250 ft. One sequence states it in its record, of the other it follows from the
// paths, and beyond the end of one that ends after the clip.
TEST_F(OfRenderedSet, KnowsTheViolationFromTheRecordAndFromThePaths) {
  for (const auto& [set, approach_s] :
       {std::pair("set", kApproach_s), std::pair("short", kShortApproach_s)})
    for (const scores::TruthSequence& one : truth("f3442", set).sequences) {
      ASSERT_TRUE(one.encounters.at(0).has_volume) << one.name;
      EXPECT_NEAR(*one.encounters[0].violation_s,
                  approach_s - std::sqrt(609.6 * 609.6 - 60 * 60) / 80,
                  1e-6)
          << one.name;
    }
}

TEST_F(OfRenderedSet, OfAnotherPathThanThatOfTheRecordNoViolationIsKnown) {
  const fs::path file = root_ / "way.csv";
  write_file(file, "time_s,north_m,east_m,down_m\n0,640,60,-165\n9,145,60,-165\n");
  render("filed", "plain", "");
  EXPECT_TRUE(truth("f3442", "filed").sequences.at(0).encounters.at(0).has_volume);
  write_file(file, "time_s,north_m,east_m,down_m\n0,640,60,-165\n8,145,60,-165\n");
  EXPECT_FALSE(truth("f3442", "filed").sequences.at(0).encounters.at(0).has_volume);
}

TEST_F(OfRenderedSet, OneWhosePathEndsAfterTheClipFliesStraightOn) {
  for (const scores::TruthSequence& one : truth("", "short").sequences)
    EXPECT_NEAR(*one.encounters.at(0).closest_approach_s, kShortApproach_s, 1e-6) << one.name;
}

// The time of one frame tells no rate, and its video states 30 frames/s.
TEST_F(OfRenderedSet, OneFrameLastsAsLongAsItsVideoSays) {
  render("single", "frame", "");
  EXPECT_NEAR(truth("", "single").sequences.at(0).duration_s, 1 / 30.0, 1e-6);
}

TEST_F(OfRenderedSet, RefusesAnUnknownVolume) {
  try {
    truth("f344");
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.message(), testing::HasSubstr("did you mean 'f3442'?"));
  }
}

// Exact answers with one track: everything is found, declared at once, and without a bearing error
// but for the box's own centre.
TEST_F(OfRenderedSet, ExactAnswersScoreExactly) {
  const fs::path folder = answered("exact", 0);
  ASSERT_TRUE(holds_detections(folder));
  AssessOptions options;
  options.manoeuvre_s = 0;
  options.volume = "f3442";
  const scores::Assessment assessment = assess(root_ / "set", {folder}, options);
  const scores::DetectorScore& score = assessment.detectors.at(0);
  EXPECT_NEAR(*score.average_precision.ap, 1, 1e-9);
  EXPECT_NEAR(*score.average_precision.ap_centre, 1, 1e-9);
  EXPECT_EQ(score.point.detection.value, 1);
  EXPECT_EQ(score.point.false_alarms_per_image, 0);
  EXPECT_NEAR(evaluation::Hota::mean(score.tracks->hota.hota), 1, 1e-9);
  EXPECT_EQ(score.tracks->clear.mota(), 1);
  EXPECT_EQ(score.tracks->declarations.declared.value, 1);
  EXPECT_EQ(score.tracks->declarations.in_time->value, 1);
  EXPECT_EQ(score.tracks->weighted_declarations->declared.trials, 6);
  EXPECT_EQ(score.tracks->encounters[0].declaration->frame, score.tracks->encounters[0].first_seen);
  ASSERT_TRUE(score.bearing);
  // A pixel is 1.5 mrad; the box is of whole pixels.
  EXPECT_LT(score.bearing->azimuth.rms, 2);
  EXPECT_LT(score.bearing->elevation.rms, 2);
  EXPECT_FALSE(score.by.at("contrast_to_noise").empty());
  // Both sequences have a weight of 3.
  ASSERT_TRUE(score.weighted_detection);
  EXPECT_EQ(score.weighted_detection->value, 1);
  EXPECT_EQ(score.weighted_detection->trials, 3 * score.point.detection.trials);
  const nlohmann::ordered_json json = json_of_detector(score, assessment);
  EXPECT_EQ(json["point"]["weighted_detection"]["share"], 1);
  for (const auto& bin : json["by"]["range_m"]) {
    EXPECT_EQ(bin["share"], 1);
    EXPECT_EQ(bin["weighted"]["share"], 1);
    EXPECT_EQ(bin["weighted"]["trials"], 3 * bin["trials"].get<double>());
    EXPECT_NEAR(bin["weighted"]["effective_sequences"].get<double>(), bin["sequences"], 1e-9);
  }
  EXPECT_EQ(json["bearing"]["azimuth_mrad"]["deviation_interval_95"].size(), 2u);
}

// Whatever a detector that associates finds has tracks, and to find nothing is a result.
TEST_F(OfRenderedSet, NothingFoundIsMeasured) {
  const auto score_of = [&](const std::string& record, const auto& change) {
    const fs::path folder = answered("changed", 0);
    for (const scores::TruthSequence& one : truth().sequences) {
      auto detections = results::read_sequence(folder, one.name);
      for (std::vector<results::Detection>& frame : detections.frames) change(frame);
      write_sequence(folder, detections);
    }
    write_file(folder / "detector.json", record);
    return assess(root_ / "set", {folder}, {}).detectors.at(0);
  };
  const scores::DetectorScore blind = score_of("{}", [](auto& frame) { frame.clear(); });
  EXPECT_EQ(blind.point.detection.value, 0);
  EXPECT_GT(blind.point.detection.trials, 0);
  EXPECT_EQ(blind.point.false_alarms_per_image, 0);
  EXPECT_EQ(blind.by.at("range_m").at(0).detection.value, 0);
  ASSERT_TRUE(blind.tracks);
  EXPECT_EQ(blind.tracks->declarations.declared.value, 0);
  EXPECT_EQ(blind.tracks->declarations.declared.trials, 2);
  const auto forget_tracks = [](auto& frame) {
    for (results::Detection& one : frame) one.track.reset();
  };
  EXPECT_FALSE(score_of(R"({"association": null})", forget_tracks).tracks);
  EXPECT_TRUE(score_of(R"({"association": {"declare": "9/9"}})", forget_tracks).tracks);
}

// A pixel to the right is 1000 / f mrad near the axis; the focal length of 240 px over 20 degrees
// is 680.6 px. The aircraft is 8 degrees off the axis at the most, where it is 2 % less.
TEST_F(OfRenderedSet, AShiftOfAPixelIsItsAngle) {
  const scores::Assessment assessment =
      assess(root_ / "set", {answered("straight", 0), answered("shifted", 1)}, {});
  const auto error = [&](const std::string& name) {
    for (const scores::DetectorScore& detector : assessment.detectors)
      if (detector.name == name) return detector.bearing->azimuth.mean;
    return 0.0;
  };
  EXPECT_NEAR(error("shifted") - error("straight"), 1000 / 680.6, 0.02 * 1000 / 680.6);
}

// A tracker's polygon may begin above the picture.
TEST(HoldsDetections, WhereTheSecondCellIsTheIdOfNoTrack) {
  const test_support::TemporaryFolder folder;
  const auto holds = [&](const char* line) {
    write_file(folder / "a.txt", line);
    return holds_detections(folder.path());
  };
  for (const char* line : {"1,-1,5,5,9,9,0.5,-1,-1,-1\n",
                           "1 -1 5 5 9 9 0.5 -1 -1 -1\n",
                           "1\t-1\t5\t5\t9\t9\t0.5\t-1\t-1\t-1\r\n"})
    EXPECT_TRUE(holds(line)) << line;
  EXPECT_TRUE(holds("1, -1.0 ,5,5,9,9,0.5\n"));
  EXPECT_FALSE(holds("50,-12.5,60,-12.5,60,4,50,4\n"));
  EXPECT_FALSE(holds("50,-1.5,60,-1.5,60,4,50,4\n"));
  EXPECT_FALSE(holds("1,7,5,5,9,9,0.5\n"));
}

}  // namespace
}  // namespace airtruth::detector_evaluation
