// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdlib>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "encounter/encounter_model/sampler.h"
#include "encounter/track/track.h"
#include "foundation/base/error.h"
#include "foundation/geometry/units.h"
#include "support/chi_square.h"
#include "support/shared_folder.h"
#include "support/small_encounter_model.h"

namespace airtruth::encounter_model {
namespace {

using Bins = std::vector<std::size_t>;
constexpr int kSamples = 100'000;

BayesModel small_model() { return parse_model(test_support::kSmallModel, "small.txt"); }

std::vector<double> probabilities_of(const Node& node, std::size_t column) {
  std::vector<double> probabilities;
  for (std::size_t k = 0; k < node.bins; ++k)
    probabilities.push_back(
        (node.sums[column * node.bins + k] - (k == 0 ? 0 : node.sums[column * node.bins + k - 1])) /
        node.total(column));
  return probabilities;
}

// The column by the definition of the file: 1 + sum of (bin - 1) times the product of the sizes of
// earlier parents, with bins from 1.
std::size_t column_by_definition(const Node& node, const Bins& sizes, const Bins& bins) {
  std::size_t column = 0, stride = 1;
  for (const std::size_t parent : node.parents) {
    column += bins[parent] * stride;
    stride *= sizes[parent];
  }
  return column;
}

struct Tested {
  test_support::ChiSquare initial, transition, within;
  std::int64_t stayed = 0;
};

// Draws the networks alone, and compares every column of every table with what was drawn from it.
Tested test_networks(const Sampler& sampler, int samples, int steps) {
  const BayesModel& model = sampler.model();
  Bins sizes;
  std::vector<std::vector<std::vector<double>>> counts;  // by variable and column
  std::vector<const Node*> nodes;
  for (const auto* network : {&model.initial, &model.transition})
    for (const Node& node : *network) {
      sizes.push_back(node.bins);
      nodes.push_back(&node);
      counts.emplace_back(node.columns(), std::vector<double>(node.bins, 0.0));
    }
  Tested tested;
  Random random(7);
  Bins bins(sampler.variable_count());
  for (int i = 0; i < samples; ++i) {
    EXPECT_TRUE(sampler.draw_initial(random, bins.data()));
    for (std::size_t v = 0; v < model.labels.size(); ++v)
      ++counts[v][column_by_definition(*nodes[v], sizes, bins)][bins[v]];
    for (int s = 0; s < steps; ++s) {
      Bins before = bins;
      sampler.step(random, bins.data());
      // The parents at (t) are those before the step, the parents at (t+1) those after it.
      std::copy(
          bins.begin() + model.labels.size(), bins.end(), before.begin() + model.labels.size());
      for (const DynamicVariable& variable : model.dynamic) {
        const Node& node = *nodes[variable.next];
        const std::size_t column = column_by_definition(node, sizes, before);
        EXPECT_EQ(bins[variable.now], bins[variable.next]);
        if (node.total(column) > 0) {
          ++counts[variable.next][column][bins[variable.next]];
        } else {
          EXPECT_EQ(bins[variable.now], before[variable.now]);
          ++tested.stayed;
        }
      }
    }
  }
  for (std::size_t v = 0; v < nodes.size(); ++v)
    for (std::size_t column = 0; column < nodes[v]->columns(); ++column)
      if (nodes[v]->total(column) > 0)
        (v < model.labels.size() ? tested.initial : tested.transition)
            .add(counts[v][column], probabilities_of(*nodes[v], column));
  return tested;
}

TEST(ModelSampler, DrawsWhatTheTablesSay) {
  const Tested tested = test_networks(Sampler(small_model(), {}), kSamples, 20);
  // The bins of each column that have counts, less one.
  EXPECT_EQ(tested.initial.degrees, 16);
  EXPECT_EQ(tested.transition.degrees, 27);
  EXPECT_LT(tested.initial.normal_deviate(), test_support::kLevel0001);
  EXPECT_LT(tested.transition.normal_deviate(), test_support::kLevel0001);
  EXPECT_GT(tested.stayed, 1000);
}

// Marginals by summing the joint distribution: domain and altitude of the small model by hand.
TEST(ModelSampler, MarginalsAreThoseOfTheJointDistribution) {
  const Sampler sampler(small_model(), {});
  Random random(11);
  Bins bins(sampler.variable_count());
  std::vector<double> altitude(2), speed(3), turn(3);
  for (int i = 0; i < kSamples; ++i) {
    ASSERT_TRUE(sampler.draw_initial(random, bins.data()));
    ++altitude[bins[1]];
    ++speed[bins[2]];
    ++turn[bins[5]];
  }
  test_support::ChiSquare chi;
  // P(L = 1) = 0.75 0.8 + 0.25 0.25.
  const double low = 0.6625;
  chi.add(altitude, {low, 1 - low});
  chi.add(speed, {0.1 * low, 0.6 * low + 0.5 * (1 - low), 0.3 * low + 0.5 * (1 - low)});
  chi.add(turn,
          {0.2 * 0.1 + 0.6 * 0.25 + 0.2 * 0.05,
           0.2 * 0.8 + 0.6 * 0.5 + 0.2 * 0.05,
           0.2 * 0.1 + 0.6 * 0.25 + 0.2 * 0.9});
  EXPECT_EQ(chi.degrees, 5);
  EXPECT_LT(chi.normal_deviate(), test_support::kLevel0001);
}

TEST(ModelSampler, PublishedModelsAreDrawnAsTheirTablesSay) {
  const char* shared = test_support::shared_folder();
  if (shared == nullptr) GTEST_SKIP() << "AIRTRUTH_SHARED is unset";
  for (const char* name : {"uncor_1200code_v2p1.txt",
                           "balloon_v1.txt",
                           "blimp_v1.txt",
                           "uncor_1200only_fwme_v1p2.txt",
                           "uncor_1200only_fwse_v1p2.txt",
                           "uncor_1200only_rotorcraft_v1p2.txt"}) {
    const Sampler sampler(read_model(fs::path(shared) / "encounters/models" / name), {});
    const Tested tested = test_networks(sampler, kSamples, 10);
    EXPECT_LT(tested.initial.normal_deviate(), test_support::kLevel0001) << name;
    EXPECT_LT(tested.transition.normal_deviate(), test_support::kLevel0001) << name;
    const SampledTrack first = sampler.sample(0);
    EXPECT_EQ(first.track.size(), 61u) << name;
  }
}

TEST(ModelSampler, TheCutIsTheConditionalDistribution) {
  SampleOptions options;
  options.cut.domains = {2};
  options.cut.altitude_ft = {1000, 2000};
  const Sampler sampler(small_model(), options);
  // P(G = 2) (P(L = 1 | 2) 500 / 1000 + P(L = 2 | 2) 500 / 3500).
  const double low = 0.25 * 0.5, high = 0.75 * 500 / 3500;
  EXPECT_NEAR(sampler.share(), 0.25 * (low + high), 1e-12);
  std::vector<double> layers(2);
  Random random(3);
  Bins bins(sampler.variable_count());
  for (int i = 0; i < kSamples; ++i) {
    ASSERT_TRUE(sampler.draw_initial(random, bins.data()));
    ASSERT_EQ(bins[0], 1u);
    ++layers[bins[1]];
  }
  test_support::ChiSquare chi;
  chi.add(layers, {low / (low + high), high / (low + high)});
  EXPECT_LT(chi.normal_deviate(), test_support::kLevel0001);
  for (std::uint64_t i = 0; i < 2000; ++i) {
    const double start_ft = -sampler.sample(i).track.positions_ned_m[0].z() / kMetresOfFoot;
    EXPECT_GE(start_ft, 1000 - 1e-9);
    EXPECT_LE(start_ft, 2000 + 1e-9);
  }
}

TEST(ModelSampler, ACutThatHoldsNothingIsAnError) {
  const auto with = [](Cut cut) {
    SampleOptions options;
    options.cut = std::move(cut);
    Sampler(small_model(), options);
  };
  EXPECT_THROW(with({{3}, {}, {}}), Error);
  EXPECT_THROW(with({{0}, {}, {}}), Error);
  EXPECT_THROW(with({{}, {1}, {}}), Error);  // the model has no airspace classes
  EXPECT_THROW(with({{}, {}, {{6000, 7000}}}), Error);
  EXPECT_THROW(with({{}, {}, {{2000, 1000}}}), Error);
}

TEST(ModelSampler, TracksMoveAsTheirVelocitiesSay) {
  SampleOptions options;
  options.duration_s = 120;
  const Sampler sampler(small_model(), options);
  double longest_m = 0;
  for (std::uint64_t i = 0; i < 500; ++i) {
    const track::Track track = sampler.sample(i).track;
    ASSERT_EQ(track.size(), 121u);
    for (std::size_t s = 0; s + 1 < track.size(); ++s) {
      const Vector3 step = track.positions_ned_m[s + 1] - track.positions_ned_m[s];
      // The vertical rate holds during the second; the horizontal speed changes by 1 kt and the
      // course by 4 degrees at most, and a new vertical rate up to 1000 ft/min changes what is left
      // of an airspeed of 60 kt by 0.5 m/s.
      EXPECT_NEAR(step.z(), track.velocities_ned_mps[s].z(), 1e-9);
      const double speed = step.head<2>().norm();
      EXPECT_NEAR(speed, track.velocities_ned_mps[s].head<2>().norm(), 0.3);
      const double cross =
          step.x() * track.velocities_ned_mps[s].y() - step.y() * track.velocities_ned_mps[s].x();
      EXPECT_LT(std::abs(cross) / (speed * speed), std::sin(radians(2.01)) * 1.01);
    }
    EXPECT_EQ(track.positions_ned_m[0].head<2>().norm(), 0);
    EXPECT_EQ(track.velocities_ned_mps[0].y(), 0);
    longest_m = std::max(longest_m, track.positions_ned_m.back().head<2>().norm());
  }
  EXPECT_LT(longest_m, 120 * 150 * kMpsOfKnot);
  EXPECT_GT(longest_m, 120 * 100 * kMpsOfKnot);
}

// Aircraft that all fly at 100 kt, level, and turn right at 3 to 3.0001 degrees a second.
constexpr const char* kTurningModel = R"model(# labels_initial
"L", "v", "\dot \psi"
# G_initial
0 0 0
0 0 0
0 0 0
# r_initial
1 1 1
# N_initial
1 1 1
# labels_transition
"L", "v", "\dot \psi(t)", "\dot \psi(t+1)"
# G_transition
0 0 0 0
0 0 0 0
0 0 0 0
0 0 0 0
# r_transition
1 1 1 1
# N_transition
1
# boundaries
1000 1001
100 100.0001
3 3.0001
# resample_rates
0 0 0
)model";

TEST(ModelSampler, ASteadyTurnIsACircle) {
  const BayesModel model = parse_model(kTurningModel, "turn.txt");
  SampleOptions options;
  options.duration_s = 120;  // once round
  const track::Track track = Sampler(model, options).sample(0).track;
  const double radius_m = 100 * kMpsOfKnot / radians(3);
  for (const Vector3& position : track.positions_ned_m) {
    EXPECT_NEAR((position.head<2>() - Eigen::Vector2d(0, radius_m)).norm(), radius_m, 0.1);
    EXPECT_EQ(position.z(), track.positions_ned_m[0].z());
  }
  EXPECT_LT((track.positions_ned_m[120] - track.positions_ned_m[0]).norm(), 0.3);
  EXPECT_GT(track.positions_ned_m[30].y(), 0);  // right is east of north
}

TEST(ModelSampler, ResampleRatesChangeValuesWithinABin) {
  const Sampler sampler(small_model(), {});
  // A turn to the right goes on in its bin with probability 0.9, and is then drawn anew in 30 %.
  std::int64_t anew = 0, kept = 0;
  const auto turn_of = [](const track::Track& track, std::size_t s) {
    const Vector3 &a = track.velocities_ned_mps[s], &b = track.velocities_ned_mps[s + 1];
    return std::atan2(a.x() * b.y() - a.y() * b.x(), a.x() * b.x() + a.y() * b.y());
  };
  for (std::uint64_t i = 0; i < 3000; ++i) {
    const track::Track track = sampler.sample(i).track;
    for (std::size_t s = 0; s + 2 < track.size(); ++s) {
      const double first = turn_of(track, s), second = turn_of(track, s + 1);
      if (first < radians(0.5) || second < radians(0.5)) continue;  // both in the right bin
      ++(std::abs(first - second) < 1e-9 ? kept : anew);
    }
  }
  const double share = static_cast<double>(anew) / static_cast<double>(anew + kept);
  EXPECT_NEAR(share, 0.3, 4 * std::sqrt(0.3 * 0.7 / static_cast<double>(anew + kept)));
}

TEST(ModelSampler, ATrackDependsOnSeedAndIndexAlone) {
  SampleOptions options;
  options.seed = 5;
  const Sampler sampler(small_model(), options);
  std::vector<SampledTrack> forward(64), backward(64);
  for (std::size_t i = 0; i < 64; ++i) forward[i] = sampler.sample(i);
  {
    std::vector<std::jthread> threads;
    for (std::size_t t = 0; t < 4; ++t)
      threads.emplace_back([&, t] {
        for (std::size_t i = 64; i-- > 0;)
          if (i % 4 == t) backward[i] = sampler.sample(i);
      });
  }
  for (std::size_t i = 0; i < 64; ++i) {
    EXPECT_EQ(forward[i].track.positions_ned_m, backward[i].track.positions_ned_m);
    EXPECT_EQ(forward[i].initial_bins, backward[i].initial_bins);
  }
  EXPECT_NE(forward[0].track.positions_ned_m, forward[1].track.positions_ned_m);
  options.seed = 6;
  EXPECT_NE(Sampler(small_model(), options).sample(0).track.positions_ned_m,
            forward[0].track.positions_ned_m);
}

TEST(ModelSampler, LengthsOutOfRangeAreErrors) {
  for (const int duration_s : {0, -5, kMaxDuration_s + 1}) {
    SampleOptions options;
    options.duration_s = duration_s;
    EXPECT_THROW(Sampler(small_model(), options), Error);
  }
}

}  // namespace
}  // namespace airtruth::encounter_model
