// SPDX-License-Identifier: Apache-2.0
#include "dataset/catalogue/drawing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "aircraft/fleet/flight_limits.h"
#include "dataset/build/plan.h"
#include "dataset/catalogue/expand.h"
#include "foundation/base/error.h"
#include "foundation/geometry/units.h"
#include "scene/scene/camera_keys.h"
#include "sequence/setup/flyable.h"
#include "sequence/setup/from_scene.h"
#include "sequence/setup/world.h"
#include "support/error_of.h"
#include "support/small_catalogue.h"

namespace airtruth::catalogue {
namespace {

using testing::HasSubstr;

Catalogue with_random(const std::string& keys) {
  std::string text = test_support::kCatalogue;
  text.resize(text.find("[[product]]"));
  return parse_catalogue(text + "[output]\nvideo = \"mkv\"\n[[random]]\n" + keys, "c.toml");
}

std::string random_error(const std::string& keys) {
  return test_support::error_of([&] { with_random(keys); });
}

const Drawn& rule_of(const Catalogue& catalogue) {
  return std::get<Drawn>(catalogue.rules.front());
}

constexpr std::int64_t kMany = 4000;

// 80 liveries of one type and 12 of another: each type is half of what is drawn.
TEST(Drawing, TypesComeOutEvenAndSoDoTheirLiveries) {
  const Catalogue catalogue = with_random("count = 4000\naircraft = [\"738/*\", \"c172/*\"]\n");
  const Drawn& rule = rule_of(catalogue);
  ASSERT_EQ(rule.types.size(), 2u);
  ASSERT_GT(rule.types[0].liveries.size(), 4 * rule.types[1].liveries.size());
  std::map<std::string, int> liveries;
  int c172 = 0;
  for (std::int64_t i = 0; i < kMany; ++i) {
    const std::string name = draw(rule, catalogue.backgrounds, 1, i).encounters[0].aircraft;
    ++liveries[name];
    c172 += name.starts_with("c172/") ? 1 : 0;
  }
  EXPECT_EQ(c172, kMany / 2);
  for (const AircraftType& type : rule.types) {
    const double share = 0.5 / static_cast<double>(type.liveries.size());
    for (const std::string& livery : type.liveries)
      EXPECT_NEAR(liveries[livery], kMany * share, 5 * std::sqrt(kMany * share)) << livery;
  }
}

// Of the sequences that have an intruder each type has its n-th part, within one.
TEST(Drawing, TypesTakeTurns) {
  for (const std::string keys :
       {"count = 8\n", "count = 31\nnegatives = 0.4\n", "count = 10\nintruders = 3\n"}) {
    const Catalogue catalogue =
        with_random(keys + "aircraft = [\"738/*\", \"c172/*\", \"Cub/*\"]\n");
    const Drawn& rule = rule_of(catalogue);
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      std::map<std::string, int> types;
      int all = 0;
      for (std::int64_t i = 0; i < rule.count; ++i)
        for (const Encounter& one : draw(rule, catalogue.backgrounds, seed, i).encounters) {
          ++types[one.aircraft.substr(0, one.aircraft.find('/'))];
          ++all;
        }
      EXPECT_EQ(types.size(), 3u);
      for (const auto& [type, count] : types) {
        EXPECT_GE(count, all / 3) << keys << type;
        EXPECT_LE(count, (all + 2) / 3) << keys << type;
      }
    }
  }
}

Catalogue with_weather(const std::string& keys) {
  std::string text = test_support::kCatalogue;
  text.resize(text.find("[[aircraft]]"));
  const std::string lens = "lens = { vertical_fov_deg = 75 }\n";
  for (std::size_t at = text.find(lens); at != std::string::npos; at = text.find(lens, at + 200))
    text.insert(at,
                "optics = { point_spread_px = 0.8 }\nair = { extinction_per_km = \"auto\" }\n"
                "sensor = { noise_floor = 1e-5 }\n");
  return parse_catalogue(text + "[[random]]\naircraft = [\"c172/*\"]\n" + keys, "c.toml");
}

// A stream does not end with the count: types are even in each `count` samples, and every sample
// has a weather of its own.
TEST(Drawing, CountDoesNotBoundWhatAStreamDraws) {
  for (const std::int64_t count : {1, 2}) {
    const Catalogue catalogue = with_random(
        "count = " + std::to_string(count) +
        "\naircraft = [\"738/*\", \"c172/*\"]\n[random.weather]\nvisibility_m = [2000, 32000]\n");
    int c172 = 0;
    std::set<double> visibilities_m;
    for (std::int64_t i = 0; i < kMany; ++i) {
      const DrawnSequence drawn = draw(rule_of(catalogue), catalogue.backgrounds, 1, i);
      c172 += drawn.encounters[0].aircraft.starts_with("c172/") ? 1 : 0;
      visibilities_m.insert(*drawn.visibility_m);
      if (count == 2 && i % 2 == 1) {
        EXPECT_EQ(c172, (i + 1) / 2);
      }
    }
    EXPECT_NEAR(c172, kMany / 2.0, 5 * std::sqrt(kMany / 4.0));
    EXPECT_EQ(visibilities_m.size(), static_cast<std::size_t>(kMany));
  }
}

// Of n sequences each n-th of a range holds one: McKay's Latin hypercube. What cannot be 0 is cut
// in its logarithm. So it is of the sequences with an intruder, and of those without.
TEST(Drawing, WeatherIsStratified) {
  const Catalogue catalogue = with_weather(
      "count = 60\nnegatives = 0.25\n[random.weather]\nvisibility_m = [2000, 32000]\n"
      "exposure = [0.5, 2]\nwhite_balance = [0.8, 1.25]\nblur = [0, 3]\nnoise = [0.5, 2.5]\n"
      "sun_share = { any_of = [0, 0.5, 1] }\n");
  std::map<std::string, std::map<int, int>> strata;
  std::map<double, int> suns;
  for (std::int64_t i = 0; i < 60; ++i) {
    const Item item = Expansion(catalogue).at(i);
    const bool is_negative = item.scene.intruders.empty();
    const double n = is_negative ? 15 : 45;
    const scene::Weather& weather = item.scene.weather;
    const auto count = [&](const std::string& key, double share) {
      ++strata[key + (is_negative ? "-" : "+")][static_cast<int>(std::floor(share * n + 1e-9))];
    };
    const auto& air = *item.scene.camera_model.extinction_per_km;
    EXPECT_EQ(air[0], air[2]);
    // At Koschmieder's visibility the contrast has fallen to 2 %.
    const double visibility_m = scene::weather_facts(item.scene).at("visibility_m");
    EXPECT_NEAR(std::exp(-air[1] * visibility_m / 1000), 0.02, 1e-12);
    EXPECT_TRUE(item.scene.camera_model.automatic.empty());
    count("visibility", std::log(visibility_m / 2000) / std::log(16));
    count("exposure", std::log(*weather.exposure / 0.5) / std::log(4));
    count("white", std::log(*weather.white_balance / 0.8) / std::log(1.25 / 0.8));
    count("blur", *weather.blur / 3);
    count("noise", (*weather.noise - 0.5) / 2);
    if (!is_negative) ++suns[*weather.sun_share];
  }
  EXPECT_EQ(strata.size(), 10u);
  for (const auto& [key, counts] : strata) {
    EXPECT_EQ(counts.size(), key.back() == '-' ? 15u : 45u) << key;
    for (const auto& [stratum, number] : counts) EXPECT_EQ(number, 1) << key << stratum;
  }
  EXPECT_EQ(suns, (std::map<double, int>{{0, 15}, {0.5, 15}, {1, 15}}));
}

TEST(Drawing, WeatherLeavesAllElseAsItWas) {
  const auto drawn = [](const std::string& keys) {
    const Catalogue catalogue = with_weather("count = 4\n" + keys);
    return draw(rule_of(catalogue), catalogue.backgrounds, 1, 2);
  };
  const DrawnSequence without = drawn("");
  const DrawnSequence with = drawn("[random.weather]\nnoise = [1, 2]\n");
  EXPECT_FALSE(without.weather.noise);
  EXPECT_TRUE(with.weather.noise);
  EXPECT_EQ(with.encounters[0].aircraft, without.encounters[0].aircraft);
  EXPECT_EQ(with.encounters[0].range_m, without.encounters[0].range_m);
  EXPECT_EQ(with.background, without.background);
}

TEST(Drawing, WeatherThatMakesNoSenseIsOneLine) {
  const std::string rule = "aircraft = [\"c172/*\"]\n[random.weather]\n";
  EXPECT_THAT(random_error(rule + "blur = [1, 2]\n"),
              HasSubstr("blur is a factor on optics.point_spread_px, which background 'sky' has "
                        "not"));
  EXPECT_THAT(random_error(rule + "noise = [1, 2]\n"), HasSubstr("sensor.noise_gain"));
  EXPECT_THAT(random_error(rule + "noise = [1, 20]\n"), HasSubstr("a factor from 0 to 10"));
  EXPECT_THAT(random_error(rule + "exposure = [2, 1]\n"), HasSubstr("falls"));
  EXPECT_THAT(random_error(rule + "visibility = [2, 3]\n"), HasSubstr("visibility_m"));
  EXPECT_THAT(random_error(rule + "sun_share = 0.5\n"), HasSubstr("no error"));
}

// Each count has its limit, and so has what they come to together.
TEST(Drawing, ACatalogueHasAtMostAMillionSequences) {
  const std::string aircraft = "aircraft = [\"c172/*\"]\n";
  EXPECT_EQ(Expansion(with_random("count = 1000000\n" + aircraft)).size(), 1'000'000);
  EXPECT_THAT(random_error("count = 1000001\n" + aircraft), HasSubstr("c.toml:"));
  const Catalogue two =
      with_random("count = 1000000\n" + aircraft + "[[random]]\nname = \"s{index}\"\n" + aircraft);
  try {
    const Expansion expansion(two);
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("c.toml: makes more than 1000000 sequences"));
  }
  EXPECT_THAT(
      random_error(aircraft + "[[distractor]]\nkind = \"bird\"\ncount = 4\nflock = [1, 200]\n"),
      HasSubstr("no error"));
  EXPECT_THAT(
      random_error(aircraft + "[[distractor]]\nkind = \"bird\"\ncount = 5\nflock = [1, 200]\n"),
      HasSubstr("to 1000 things at most, with those before it; expected up to 900"));
}

TEST(Drawing, NegativesAreTheShareThatWasAskedFor) {
  for (const double share : {0.2, 1.0 / 3, 0.0, 1.0}) {
    Catalogue catalogue = with_random("aircraft = [\"c172/*\"]\n");
    Drawn rule = rule_of(catalogue);
    rule.negatives = share;
    int negatives = 0;
    for (std::int64_t i = 0; i < 1000; ++i) {
      negatives += draw(rule, catalogue.backgrounds, 7, i).encounters.empty() ? 1 : 0;
      EXPECT_NEAR(negatives, share * static_cast<double>(i + 1), 1) << share;
    }
  }
}

// Of a log-uniform size u = log(size / low) / log(high / low) is uniform: in each of eight equal
// bins 500 of 4,000, with a standard deviation of 20.9.
TEST(Drawing, SizesAreEvenInTheirLogarithm) {
  const Catalogue catalogue =
      with_random("aircraft = [\"c172/*\", \"738/*\"]\nsize_px = [8, 128]\n");
  std::array<int, 8> bins{};
  for (std::int64_t i = 0; i < kMany; ++i) {
    const double size =
        *draw(rule_of(catalogue), catalogue.backgrounds, 1, i).encounters[0].size_px;
    ASSERT_GE(size, 8);
    ASSERT_LT(size, 128);
    ++bins[static_cast<std::size_t>(8 * std::log(size / 8) / std::log(16.0))];
  }
  for (const int count : bins) EXPECT_NEAR(count, kMany / 8.0, 4 * 20.9);
}

TEST(Drawing, TheNumberOfIntrudersIsEvenOverItsRange) {
  const Catalogue catalogue = with_random("aircraft = [\"c172/*\"]\nintruders = [1, 3]\n");
  std::array<int, 4> counts{};
  std::set<double> speeds;
  for (std::int64_t i = 0; i < kMany; ++i) {
    const DrawnSequence drawn = draw(rule_of(catalogue), catalogue.backgrounds, 1, i);
    ASSERT_GE(drawn.encounters.size(), 1u);
    ASSERT_LE(drawn.encounters.size(), 3u);
    ++counts[drawn.encounters.size()];
    for (const Encounter& encounter : drawn.encounters) speeds.insert(encounter.speed_mps);
  }
  for (int n = 1; n <= 3; ++n) EXPECT_NEAR(counts[n], kMany / 3.0, 4 * std::sqrt(kMany * 2.0 / 9));
  EXPECT_GT(speeds.size(), 2u * kMany - 200);  // each intruder is drawn for itself
  const Catalogue two = with_random("aircraft = [\"c172/*\"]\nintruders = 2\n");
  const Item item = Expansion(two).at(0);
  ASSERT_EQ(item.scene.intruders.size(), 2u);
  EXPECT_EQ(item.scene.intruders[0].id, "intruder-1");
  EXPECT_EQ(item.scene.intruders[1].id, "intruder-2");
}

// What is drawn where nothing is stated is flyable for its type: speed, climb and bank.
trajectory::Path path_of_first(const scene::Scene& scene) {
  return setup::path_of(scene.intruders[0], setup::camera_path(scene.camera));
}

TEST(Drawing, WhatSuitsTheTypeIsFlyable) {
  const Catalogue catalogue = with_random(
      "count = 300\nframe_count = 90\nbank_deg = \"type\"\naircraft = [\"738/*\", \"c172/*\", "
      "\"Cub/*\", \"f16/*\", \"centrair-101/*\", \"DH4/*\"]\n");
  const Expansion expansion(catalogue);
  for (std::int64_t i = 0; i < expansion.size(); ++i) {
    const Item item = expansion.at(i);
    const scene::Intruder& intruder = item.scene.intruders[0];
    const fleet::FlightLimits& limits = *fleet::flight_limits(intruder.aircraft);
    EXPECT_GE(*intruder.speed_mps, limits.usual_low_mps);
    EXPECT_LE(*intruder.speed_mps, limits.usual_high_mps);
    EXPECT_EQ(setup::words_beyond_limits(intruder.aircraft, path_of_first(item.scene), 0, 3), "")
        << item.name;
  }
  const build::Plan plan = build::plan_of(catalogue, {}, {});
  EXPECT_EQ(plan.not_flyable, 0);
  EXPECT_EQ(plan.aircraft.size(), 6u);
  EXPECT_EQ(plan.ranges_m.size(), 300u);
}

TEST(Drawing, ThePlanNamesPathsThatAreNotFlyable) {
  const Catalogue catalogue =
      with_random("count = 20\naircraft = [\"c172/*\"]\nspeed_mps = [131, 131]\n");
  const build::Plan plan = build::plan_of(catalogue, {}, {});
  EXPECT_EQ(plan.not_flyable, 20);
  ASSERT_EQ(plan.not_flyable_words.size(), build::Plan::kMaxNamed);
  EXPECT_THAT(plan.not_flyable_words[0],
              testing::MatchesRegex("r000000: c172/.*light piston.*131.0 m/s.*92 m/s"));
}

// A level turn of bank b at speed v has the radius v^2 / (g tan b), and its bank is b throughout.
TEST(Drawing, ABankedPathIsACoordinatedTurn) {
  const Catalogue catalogue = with_random(
      "count = 20\nframe_count = 90\naircraft = [\"c172/*\"]\nspeed_mps = [55, 55]\n"
      "climb_deg = [0, 0]\nbank_deg = [30, 30]\nrange_m = [400, 500]\n");
  for (std::int64_t i = 0; i < 20; ++i) {
    const auto path = path_of_first(Expansion(catalogue).at(i).scene);
    const double radius_m = 55.0 * 55 / (kStandardGravityMps2 * std::tan(radians(30)));
    const auto begin = path.at(0);
    const auto end = path.at(3);
    ASSERT_TRUE(begin && end);
    // Over an angle of 55 x 3 / radius the chord is 2 radius sin(angle / 2).
    const double chord = (end->position_in_world - begin->position_in_world).norm();
    EXPECT_NEAR(chord, 2 * radius_m * std::sin(55 * 3 / radius_m / 2), 1e-3);
    EXPECT_NEAR(end->position_in_world.z(), begin->position_in_world.z(), 1e-9);
    for (double t = 0; t <= 3; t += 0.25) {
      EXPECT_NEAR(yaw_pitch_roll(path.at(t)->world_from_body).roll_deg, 30, 0.05) << t;
      EXPECT_NEAR(path.at(t)->velocity_in_world_mps.norm(), 55, 1e-6);
    }
  }
}

// A bank of 20 degrees at 25 m/s, the slowest usual speed of a helicopter, turns by g tan(bank) /
// speed.
TEST(Drawing, ABankThatSuitsTheTypeSpinsNothingAtWalkingSpeed) {
  const Catalogue catalogue = with_random(
      "count = 40\nframe_count = 90\naircraft = [\"helicopter-*\"]\nspeed_mps = [1, 2]\n"
      "climb_deg = [0, 0]\nbank_deg = \"type\"\n");
  const double most_radps = kStandardGravityMps2 * std::tan(radians(20)) / 25;
  for (std::int64_t i = 0; i < 40; ++i) {
    const auto path = path_of_first(Expansion(catalogue).at(i).scene);
    const auto velocity = [&](double t) { return path.at(t)->velocity_in_world_mps; };
    const double turned =
        std::acos(std::clamp(velocity(0).normalized().dot(velocity(1).normalized()), -1.0, 1.0));
    EXPECT_LE(turned, 1.01 * most_radps) << i;
  }
}

// At an equinox the sun is up for half of the day; at noon it stands 90 - latitude degrees high in
// the south, and rises due east. At the summer solstice it stands 23.45 degrees higher.
TEST(Drawing, TheSunStandsWhereAstronomyHasIt) {
  const SunPosition noon = sun_position(12, 45, 81);
  EXPECT_NEAR(noon.elevation_deg, 45, 0.5);
  EXPECT_NEAR(noon.azimuth_deg, 180, 1e-6);
  const SunPosition six = sun_position(6, 45, 81);
  EXPECT_NEAR(six.elevation_deg, 0, 0.5);
  EXPECT_NEAR(six.azimuth_deg, 90, 0.5);
  EXPECT_NEAR(sun_position(12, 45, 172).elevation_deg, 68.45, 0.1);
  EXPECT_NEAR(sun_position(12, -45, 172).azimuth_deg, 0, 1e-6);
  EXPECT_GT(sun_position(15, 45, 81).azimuth_deg, 180);
  const auto light = daylight_hours(0, 81);
  ASSERT_TRUE(light);
  EXPECT_NEAR(light->high - light->low, 12 - 2 * kLowestSunDeg / 15, 0.05);
  EXPECT_FALSE(daylight_hours(85, 355));
}

TEST(Drawing, TheTimeOfDaySuitsTheTypeAndIsLight) {
  const Catalogue catalogue = with_random(
      "aircraft = [\"centrair-101/*\", \"738/*\"]\ntime_of_day_h = \"type\"\nlatitude_deg = 50\n"
      "day_of_year = 172\n");
  const double lowest_of_a_glider = sun_position(18, 50, 172).elevation_deg;
  for (std::int64_t i = 0; i < 500; ++i) {
    const DrawnSequence drawn = draw(rule_of(catalogue), catalogue.backgrounds, 1, i);
    EXPECT_GE(*drawn.sun_elevation_deg, kLowestSunDeg - 1e-9);
    if (drawn.encounters[0].aircraft.starts_with("centrair")) {
      EXPECT_GE(*drawn.sun_elevation_deg, lowest_of_a_glider - 1e-9);
    }
  }
}

// Of a video the sun may be measured; a drawn one is not replaced by that, nor is a flight's.
TEST(Drawing, ADrawnSunAndAFlightsAreStated) {
  const std::string clip = "[[background]]\nname = \"clip\"\nvideo = \"clip.mp4\"\n";
  const std::string flight = "[[background]]\nname = \"sky\"\nflight = { seed = 3 }\n";
  const std::string rest =
      "lens = { vertical_fov_deg = 60 }\n[[random]]\naircraft = [\"c172/*\"]\n";
  const auto light = [&](const std::string& text) {
    return Expansion(parse_catalogue(text, "c.toml")).at(0).scene.light;
  };
  EXPECT_FALSE(light(clip + rest).sun_is_stated);
  EXPECT_TRUE(light(flight + rest).sun_is_stated);
  const scene::Light drawn = light(clip + rest + "sun_elevation_deg = [20, 20]\n");
  EXPECT_TRUE(drawn.sun_is_stated);
  EXPECT_EQ(drawn.sun_elevation_deg, 20);
  EXPECT_EQ(drawn.sun_azimuth_deg, scene::Light().sun_azimuth_deg);
}

TEST(Drawing, KeysThatMakeNoSenseAreOneLineAtTheirPlace) {
  const std::string aircraft = "aircraft = [\"c172/*\"]\n";
  const auto error = [&](const std::string& keys) { return random_error(aircraft + keys); };
  EXPECT_THAT(error("size_px = [8, 30]\nrange_m = [80, 90]\n"), HasSubstr("exclude each other"));
  EXPECT_THAT(error("size_px = [0, 30]\n"),
              HasSubstr("size_px[0] is 0; expected pixels from 0.1 to 1e5"));
  EXPECT_THAT(error("size_px = [30, 8]\n"), HasSubstr("size_px falls"));
  EXPECT_THAT(error("negatives = 1.2\n"), HasSubstr("negatives is 1.2; expected a share"));
  EXPECT_THAT(error("intruders = 0\n"), HasSubstr("intruders is 0"));
  EXPECT_THAT(error("intruders = [1.5, 2]\n"), HasSubstr("whole number"));
  EXPECT_THAT(error("start = \"anywhere\"\n"), HasSubstr("first or random"));
  EXPECT_THAT(error("bank_deg = [0, 90]\n"), HasSubstr("bank_deg[1] is 90"));
  EXPECT_THAT(error("speed_mps = \"fast\"\n"), HasSubstr("speed_mps"));
  EXPECT_THAT(error("latitude_deg = 3\n"), HasSubstr("latitude_deg is for time_of_day_h"));
  EXPECT_THAT(error("time_of_day_h = [0, 2]\n"), HasSubstr("is dark"));
  EXPECT_THAT(error("time_of_day_h = [8, 9]\nsun_azimuth_deg = [0, 9]\n"), HasSubstr("exclude"));
}

// A rule that states its ranges and one type draws what it drew before there were sizes, banks and
// negatives: the numbers are those that the program wrote into sequence.json then.
TEST(Drawing, WhatHasNoNewKeysIsDrawnAsBefore) {
  const Catalogue catalogue = parse_catalogue(
      "[[background]]\nname = \"sky\"\nflight = { seed = 3, frame_count = 6, width = 160, height = "
      "120 }\nlens = { vertical_fov_deg = 75 }\ncamera = { position_ned_m = [0, 0, -150], "
      "velocity_ned_mps = [25, 0, 0] }\n[[random]]\ncount = 3\nframe_count = 6\naircraft = "
      "[\"c172/*\"]\nrange_m = [100, 200]\nspeed_mps = [40, 60]\nclimb_deg = [-3, 3]\n"
      "sun_azimuth_deg = [0, 360]\n",
      "c.toml");
  const Item item = Expansion(catalogue).at(1);
  const scene::Intruder& intruder = item.scene.intruders[0];
  EXPECT_EQ(intruder.id, "intruder");
  EXPECT_EQ(intruder.aircraft, "c172/ph-gys");
  ASSERT_EQ(intruder.waypoints_ned_m.size(), 2u);
  const Vector3 first(167.18549031737757, -51.29709173656602, -161.91030249687864);
  const Vector3 last(107.54466705727401, -38.99562924996266, -160.19214303256965);
  EXPECT_LT((intruder.waypoints_ned_m[0] - first).norm(), 1e-9);
  EXPECT_LT((intruder.waypoints_ned_m[1] - last).norm(), 1e-9);
  EXPECT_EQ(intruder.start_s, 0);
}

// A turn so long or so tight that its path would hold millions of points is refused.
TEST(Drawing, AnEndlessTurnIsOneLine) {
  const Catalogue catalogue = with_random(
      "frame_count = 1000000\naircraft = [\"c172/*\"]\nspeed_mps = [55, 55]\nbank_deg = [80, "
      "80]\n");
  try {
    Expansion(catalogue).at(0);
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("c.toml:"));
    EXPECT_THAT(error.what(), HasSubstr("bank_deg"));
  }
}

}  // namespace
}  // namespace airtruth::catalogue
