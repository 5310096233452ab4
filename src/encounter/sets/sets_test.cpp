// SPDX-License-Identifier: Apache-2.0
#include "encounter/sets/sets.h"

#include <filesystem>
#include <iterator>

#include <gtest/gtest.h>

#include "encounter/tracks_file/tracks_file.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "support/small_encounter_model.h"

namespace airtruth::sets {
namespace {

class Sets : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::temp_directory_path() / (std::string("airtruth-sets-") + test->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  fs::path folder_;
};

std::shared_ptr<const encounter_model::Sampler> small_sampler(int duration_s = 20) {
  encounter_model::SampleOptions options;
  options.duration_s = duration_s;
  return std::make_shared<const encounter_model::Sampler>(
      encounter_model::parse_model(test_support::kSmallModel, "small.txt"), options);
}

// Flies east at 55 m/s and climbs at 1 m/s, from 100 s to 120 s.
track::Track own_track() { return {"anyone", {100, 120}, {{0, 0, -300}, {0, 1100, -320}}, {}}; }

pairing::PairingOptions at_110_s() {
  pairing::PairingOptions options;
  options.cpa_time_s = 110;
  return options;
}

EncounterOptions of(std::int64_t count, int jobs) {
  EncounterOptions options;
  options.count = count;
  options.jobs = jobs;
  return options;
}

TEST_F(Sets, TheFileDoesNotDependOnTheNumberOfThreads) {
  const DrawEncounter draw = model_pairs(small_sampler(), own_track(), at_110_s(), 3);
  // More than one window of blocks.
  const SetSummary one = write_set(folder_ / "1.csv", draw, of(2500, 1));
  const SetSummary four = write_set(folder_ / "4.csv", draw, of(2500, 4));
  EXPECT_EQ(read_file(folder_ / "1.csv"), read_file(folder_ / "4.csv"));
  EXPECT_EQ(one.weight_sum, four.weight_sum);
  EXPECT_EQ(one.encounters, 2500u);
  EXPECT_GE(one.draws, 2500u);
  EXPECT_LE(one.effective_count(), 2500);
}

TEST_F(Sets, PairsHoldTheOwnTrackAndAnIntruderWithItsWeight) {
  write_set(folder_ / "a.csv", model_pairs(small_sampler(), own_track(), at_110_s(), 3), of(50, 0));
  const auto encounters = tracks_file::read_encounters(folder_ / "a.csv");
  ASSERT_EQ(encounters.size(), 50u);
  for (const track::Encounter& encounter : encounters) {
    ASSERT_EQ(encounter.aircraft.size(), 2u);
    EXPECT_EQ(encounter.aircraft[0].name, "own");
    EXPECT_EQ(encounter.aircraft[0].positions_ned_m.back(), Vector3(0, 1100, -320));
    EXPECT_EQ(encounter.aircraft[0].times_s, encounter.aircraft[1].times_s);
    EXPECT_EQ(encounter.aircraft[1].times_s.front(), 100);
    EXPECT_EQ(encounter.aircraft[1].times_s.back(), 120);
    EXPECT_GT(encounter.weight, 0);
    EXPECT_LE(pairing::least_distance_m(encounter.aircraft[0], encounter.aircraft[1]), 500.001);
  }
  EXPECT_NE(encounters[0].weight, encounters[1].weight);
}

TEST_F(Sets, GeometricPairsPassTheOwnTrack) {
  pairing::GeometricOptions options;
  options.cpa_time_s = pairing::Distribution({105, 115});
  const pairing::GeometricSampler sampler(options, 2, 30);
  write_set(folder_ / "a.csv", geometric_pairs(sampler, own_track()), of(30, 0));
  const auto encounters = tracks_file::read_encounters(folder_ / "a.csv");
  ASSERT_EQ(encounters.size(), 30u);
  for (std::size_t i = 0; i < 30; ++i)
    EXPECT_NEAR(pairing::least_distance_m(encounters[i].aircraft[0], encounters[i].aircraft[1]),
                std::abs(sampler.draw(i).approach.hmd_m),
                0.01);
}

TEST_F(Sets, EveryFormatHoldsTracks) {
  const DrawEncounter draw = model_tracks(small_sampler());
  for (const std::string& extension : all_enum_names<tracks_file::TracksFormat>()) {
    write_set(folder_ / ("a." + extension), draw, of(70, 0));
    const auto encounters = tracks_file::read_encounters(folder_ / ("a." + extension));
    const bool is_one = extension == "daa" || extension == "txt";
    ASSERT_EQ(encounters.size(), is_one ? 1u : 70u);
    const track::Track& last = is_one ? encounters[0].aircraft[69] : encounters[69].aircraft[0];
    EXPECT_LT(
        (last.positions_ned_m[20] - draw(69).encounter.aircraft[0].positions_ned_m[20]).norm(),
        1e-6)
        << extension;
  }
}

TEST_F(Sets, AFaultOrAStopLeavesNoFile) {
  const DrawEncounter fails = [](std::uint64_t index) -> DrawnEncounter {
    if (index == 100) throw Error("no");
    return {{{own_track()}, 1}, 1};
  };
  EXPECT_THROW(write_set(folder_ / "a.csv", fails, of(200, 2)), Error);
  std::stop_source source;
  source.request_stop();
  EncounterOptions stopped = of(200, 2);
  stopped.stop = source.get_token();
  EXPECT_THROW(write_set(folder_ / "a.dat", model_tracks(small_sampler()), stopped), Interrupted);
  EXPECT_THROW(write_set(folder_ / "a.csv", model_tracks(small_sampler()), of(0, 1)), Error);
  EXPECT_THROW(write_set(folder_ / "a.daa", model_tracks(small_sampler()), of(1001, 1)), Error);
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(Sets, ProgressEndsAtTheCount) {
  EncounterOptions options = of(3000, 1);
  std::int64_t last = 0;
  options.progress = [&](std::int64_t done, std::int64_t total) {
    EXPECT_GT(done, last);
    EXPECT_EQ(total, 3000);
    last = done;
  };
  write_set(folder_ / "a.dat", model_tracks(small_sampler(5)), options);
  EXPECT_EQ(last, 3000);
}

}  // namespace
}  // namespace airtruth::sets
