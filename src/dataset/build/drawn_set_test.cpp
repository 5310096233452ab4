// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dataset/build/build.h"
#include "dataset/build/plan.h"
#include "dataset/build/verify.h"
#include "foundation/base/files.h"
#include "labels/annotation/truth.h"
#include "support/temporary_folder.h"

// Data sets from random rules: the truth of the rendered sequences agrees with the random values.
namespace airtruth::build {
namespace {

using testing::HasSubstr;

class DrawnSet : public testing::Test {
 protected:
  static std::string text(const std::string& background, const std::string& random) {
    return "[[background]]\nname = \"sky\"\nflight = { seed = 3, frame_count = 16, width = 320, "
           "height = 240 }\nlens = { vertical_fov_deg = 60 }\ncamera = { position_ned_m = [0, 0, "
           "-300], velocity_ned_mps = [25, 0, 0] }\n" +
           background + "[output]\nvideo = \"mkv\"\n[[random]]\n" + random;
  }
  annotation::Truth truth(const std::string& name) const {
    return annotation::read_truth(root_ / "sequences" / name / "truth.jsonl");
  }

  test_support::TemporaryFolder temporary_;
  fs::path root_ = temporary_.path();
};

// In the frame of the meeting moment the exact box of the rendered truth has the requested size,
// within a hundredth of a pixel without camera motion.
TEST_F(DrawnSet, TheExactBoxHasTheSizeThatWasDrawn) {
  const catalogue::Catalogue catalogue = catalogue::parse_catalogue(
      text("motion = { model = \"none\" }\n",
           "count = 5\nframe_count = 10\naircraft = [\"738/738-Ryanair\", \"c172/*\", \"Cub/*\"]\n"
           "size_px = [6, 90]\nazimuth_deg = [-10, 10]\nelevation_deg = [-6, 6]\n"
           "bank_deg = \"type\"\n"),
      "c.toml");
  const BuildSummary summary = build_set(catalogue, root_, {});
  ASSERT_EQ(summary.made, 5) << (summary.failures.empty() ? "" : summary.failures[0].reason);
  const catalogue::Expansion expansion(catalogue);
  for (std::int64_t i = 0; i < 5; ++i) {
    const catalogue::Item item = expansion.at(i);
    const catalogue::Encounter& encounter = item.drawn.encounters[0];
    const auto frame = static_cast<std::size_t>(encounter.meeting_share * 10);
    const annotation::Intruder seen = truth(item.name).frames.at(frame).intruders.at(0);
    ASSERT_TRUE(seen.exact_box_px);
    EXPECT_NEAR(
        std::max(seen.exact_box_px->width, seen.exact_box_px->height), *encounter.size_px, 0.01)
        << item.name;
    EXPECT_NEAR(*seen.azimuth_deg, encounter.azimuth_deg, 1e-3);
    EXPECT_LT(seen.position_ned_m->at(2), -30 + 1e-6);
  }
}

TEST_F(DrawnSet, ADirectionThatTheLensDoesNotSeeIsOneFailureAndItsReason) {
  const catalogue::Catalogue catalogue =
      catalogue::parse_catalogue(text("",
                                      "frame_count = 4\naircraft = [\"c172/news\"]\nsize_px = [6, "
                                      "9]\nazimuth_deg = [170, 175]\n"),
                                 "c.toml");
  const BuildSummary summary = build_set(catalogue, root_, {});
  ASSERT_EQ(summary.failures.size(), 1u);
  EXPECT_THAT(summary.failures[0].reason, HasSubstr("c.toml:"));
  EXPECT_THAT(summary.failures[0].reason, HasSubstr("at no range in the direction azimuth 17"));
}

// Clips begin at random frames at which they fit. A sequence without an intruder is made, verified
// and recorded like any other.
TEST_F(DrawnSet, NegativesAndRandomStartsAreWholeSequences) {
  const catalogue::Catalogue catalogue = catalogue::parse_catalogue(
      text("",
           "count = 6\nframe_count = 6\naircraft = [\"c172/news\"]\nrange_m = [60, 90]\n"
           "azimuth_deg = [-5, 5]\nelevation_deg = [-5, 5]\nnegatives = 0.5\nstart = \"random\"\n"
           "intruders = [1, 2]\n"),
      "c.toml");
  const BuildSummary summary = build_set(catalogue, root_, {});
  ASSERT_EQ(summary.made, 6) << (summary.failures.empty() ? "" : summary.failures[0].reason);
  EXPECT_TRUE(summary.complete);
  int negatives = 0;
  std::set<std::string> starts;
  for (std::int64_t i = 0; i < 6; ++i) {
    const std::string name = catalogue::Expansion(catalogue).at(i).name;
    const annotation::Truth seen = truth(name);
    ASSERT_EQ(seen.frames.size(), 6u);
    negatives += seen.frames[0].intruders.empty() ? 1 : 0;
    const std::string record = read_file(root_ / "sequences" / name / "sequence.json");
    const auto at = record.find("first_frame = ") + 14;
    const int start = std::stoi(record.substr(at));
    EXPECT_GE(start, 0);
    EXPECT_LE(start, 10);
    starts.insert(std::to_string(start));
    if (seen.frames[0].intruders.empty()) {
      EXPECT_TRUE(fs::exists(root_ / "sequences" / name / (name + ".xml")));
    }
  }
  EXPECT_EQ(negatives, 3);
  EXPECT_GT(starts.size(), 2u);
  VerifyOptions deep;
  deep.deep_every = 2;
  EXPECT_THAT(verify(root_, deep).faults, testing::IsEmpty());
}

// What is said of a flight of 16 frames of 320x240, 1/16 of 1280x960, is the sum of
// docs/scaling.md.
TEST_F(DrawnSet, ThePlanAddsUpWhatScalingMdStates) {
  const auto said = [&](const std::string& background, const std::string& rule) {
    return plan_of(catalogue::parse_catalogue(
                       text(background,
                            "count = 3\nframe_count = 10\naircraft = [\"c172/news\"]\n" + rule),
                       "c.toml"),
                   {},
                   {})
        .core_s;
  };
  const double motion_s = 10 * (0.0025 + 0.005 / 16);
  const double plain_s = 0.8 + 16 * 0.069 / 16 + motion_s + 3 * (0.3 + 10 * 0.034 / 16);
  EXPECT_NEAR(said("", ""), plain_s, 1e-9);
  const std::string flock = "[[distractor]]\nkind = \"bird\"\nflock = 7\n";
  const double birds_s = 3 * 7 * (0.009 + 10 * (0.0002 + 0.005 / 16));
  EXPECT_NEAR(said("", flock), plain_s + birds_s, 1e-9);
  EXPECT_NEAR(said("optics = { point_spread_px = 1 }\n", flock),
              plain_s + birds_s + 3 * 10 * (0.002 + 7 * 0.5 * (0.0002 + 0.005 / 16)),
              1e-9);
  // Each is measured by itself, after half of the way between two key frames.
  EXPECT_NEAR(said("", "start = \"random\"\n"),
              plain_s - motion_s + 3 * (10 * 0.0025 + 125 * 0.005 / 16),
              1e-9);
  EXPECT_NEAR(
      said("realism = { auto = true }\n", ""), plain_s + 3 * 10 * 0.002 + 16 * 0.044 / 16, 1e-9);
}

TEST_F(DrawnSet, ThePlanCutsSequencesToTheirVideo) {
  const catalogue::Catalogue catalogue = catalogue::parse_catalogue(
      text("", "count = 2\nframe_count = 500\naircraft = [\"c172/news\"]\n"), "c.toml");
  std::vector<std::int64_t> frames;
  const Plan plan = plan_of(
      catalogue, [&](const catalogue::Item& item) { frames.push_back(item.frame_count); }, {});
  EXPECT_EQ(frames, (std::vector<std::int64_t>{16, 16}));
  EXPECT_EQ(plan.frames, 32);
}

// Two sequences over different parts of one clip share one camera, which is measured once.
TEST_F(DrawnSet, ABackgroundIsCalibratedOnceForAllItsSequences) {
  const catalogue::Catalogue catalogue = catalogue::parse_catalogue(
      text("realism = { auto = true, fallback = true }\n",
           "count = 2\nframe_count = 5\naircraft = [\"c172/news\"]\nrange_m = [60, 90]\nstart = "
           "\"random\"\n"),
      "c.toml");
  EXPECT_GT(plan_of(catalogue, {}, {}).calibration_s, 0);
  std::map<int, std::map<std::string, std::string>> bytes;
  for (const int jobs : {1, 2}) {
    const fs::path out = root_ / std::to_string(jobs);
    int passes = 0;
    BuildOptions options;
    options.jobs = jobs;
    options.progress = [&](const BuildProgress& p) {
      passes += p.stage == "measuring the camera of sky" && p.done == 1 ? 1 : 0;
    };
    const BuildSummary summary = build_set(catalogue, out, options);
    ASSERT_EQ(summary.made, 2) << (summary.failures.empty() ? "" : summary.failures[0].reason);
    EXPECT_EQ(passes, 1);
    std::size_t calibrations = 0;
    for (const auto& entry : fs::directory_iterator(out / ".cache" / "calibration"))
      calibrations += entry.path().filename().string().starts_with('.') ? 0 : 1;  // the lock
    EXPECT_EQ(calibrations, 1u);
    std::set<std::string> cameras;
    for (std::int64_t i = 0; i < 2; ++i) {
      const std::string name = catalogue::Expansion(catalogue).at(i).name;
      const std::string record = read_file(out / "sequences" / name / "sequence.json");
      const auto from = record.find("[shutter]");
      cameras.insert(record.substr(from, record.find("[realism]") - from));
      bytes[jobs][name] = sha256_of_file(out / "sequences" / name / "truth.jsonl") +
                          sha256_of_file(out / "sequences" / name / (name + ".mkv"));
    }
    EXPECT_EQ(cameras.size(), 1u);
    EXPECT_THAT(*cameras.begin(), HasSubstr("extinction_per_km"));
  }
  EXPECT_EQ(bytes[1], bytes[2]);
}

}  // namespace
}  // namespace airtruth::build
