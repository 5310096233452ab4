// SPDX-License-Identifier: Apache-2.0
#include "comparison/comparison/measures.h"

#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "foundation/base/median.h"

namespace airtruth::comparison {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

double spread(std::vector<double> values) {
  return values.size() < 3 ? 0 : half_spread(std::move(values));
}

using Side = appearance::Looks Compared::*;

// `values_of`: those of the real or of the inserted aircraft.
Pair pair_from(const std::string& name, const auto& values_of) {
  const std::vector<double> real = values_of(&Compared::real);
  const std::vector<double> made = values_of(&Compared::made);
  if (real.empty() || made.empty()) return {name, kUnknown, 0, kUnknown, 0};
  return {name, median_between(real), spread(real), median_between(made), spread(made)};
}

// What has a value in one frame.
struct Measure {
  const char* name;
  double appearance::Looks::*value;
  bool of_edge = false;  // an edge that is nowhere clear has none
};
constexpr Measure kMeasures[] = {
    {"longest side, px", &appearance::Looks::longest_px},
    {"peak contrast above, code values", &appearance::Looks::peak_above},
    {"peak contrast below, code values", &appearance::Looks::peak_below},
    {"mean contrast above, code values", &appearance::Looks::mean_above},
    {"mean contrast below, code values", &appearance::Looks::mean_below},
    {"contrast to the surroundings, code values", &appearance::Looks::contrast},
    {"brightest decile, code values", &appearance::Looks::brightest_decile},
    {"edge, 10 to 90 %, px", &appearance::Looks::edge_width_px, true},
    {"halo, share of the step", &appearance::Looks::halo, true},
    {"noise inside, code values", &appearance::Looks::noise},
    {"noise around, code values", &appearance::Looks::background_noise},
    {"saturation", &appearance::Looks::saturation},
    {"strongest red (Cr), code values", &appearance::Looks::strongest_red},
    {"spectrum, share from 1/8 to 1/4 cycle/px", &appearance::Looks::middle_share},
    {"spectrum, share above 1/4 cycle/px", &appearance::Looks::fine_share},
    {"steps on the 8 px grid over others", &appearance::Looks::blockiness}};

Pair pair_of(const Measure& measure, const std::vector<Compared>& all) {
  return pair_from(measure.name, [&](Side one) {
    std::vector<double> values;
    for (const Compared& c : all)
      if (!measure.of_edge || (c.*one).edge_width_px > 0) values.push_back((c.*one).*measure.value);
    return values;
  });
}

bool in_a_row(const std::vector<Compared>& all, std::size_t i) {
  return all[i].frame == all[i - 1].frame + 1;
}

// How much the contrast changes from one compared frame to the next.
Pair flicker_of(const std::vector<Compared>& all) {
  return pair_from("flicker of contrast, frame to frame", [&](Side one) {
    std::vector<double> values;
    for (std::size_t i = 1; i < all.size(); ++i)
      if (in_a_row(all, i))
        values.push_back(std::abs((all[i].*one).contrast - (all[i - 1].*one).contrast));
    return values;
  });
}

Pair motion_of(const std::vector<Compared>& all) {
  return pair_from("motion against the background, px/frame", [&](Side one) {
    std::vector<double> values;
    for (std::size_t i = 1; i < all.size(); ++i)
      if (const auto& shift = all[i].background_shift_px; shift && in_a_row(all, i))
        values.push_back(((all[i].*one).centre_px - (all[i - 1].*one).centre_px - *shift).norm());
    return values;
  });
}

// How far a centre lies from the middle of those before and after it.
Pair unsteadiness_of(const std::vector<Compared>& all) {
  return pair_from("unsteadiness of the centre, px", [&](Side one) {
    std::vector<double> values;
    for (std::size_t i = 2; i < all.size(); ++i) {
      if (!in_a_row(all, i) || !in_a_row(all, i - 1)) continue;
      const Pixel around = ((all[i - 2].*one).centre_px + (all[i].*one).centre_px) / 2;
      values.push_back(((all[i - 1].*one).centre_px - around).norm());
    }
    return values;
  });
}

std::string shown(double value, double spread) {
  return std::isnan(value) ? "-" : fmt::format("{:.3g} +- {:.2g}", value, spread);
}

}  // namespace

std::vector<Pair> pairs_of(const std::vector<Compared>& all) {
  std::vector<Pair> pairs;
  for (const Measure& m : kMeasures) pairs.push_back(pair_of(m, all));
  pairs.push_back(motion_of(all));
  pairs.push_back(unsteadiness_of(all));
  pairs.push_back(flicker_of(all));
  return pairs;
}

std::string patches_csv(const std::vector<Compared>& all) {
  std::string text = "frame,real,centre x px,centre y px";
  for (const Measure& m : kMeasures) text += fmt::format(",\"{}\"", m.name);
  for (const Compared& c : all)
    for (const appearance::Looks* looks : {&c.real, &c.made}) {
      text += fmt::format("\n{},{},{:.3f},{:.3f}",
                          c.frame,
                          looks == &c.real ? 1 : 0,
                          looks->centre_px.x(),
                          looks->centre_px.y());
      for (const Measure& m : kMeasures) text += fmt::format(",{:.6g}", looks->*m.value);
    }
  return text + "\n";
}

std::string table_of(const Comparison& c) {
  std::string text =
      fmt::format("{} frames compared; median, +- half the middle 68 %\n\n", c.frames);
  if (c.pose)
    text += fmt::format(
        "{}, yaw {:.0f}, pitch {:.0f}, roll {:.0f} degrees: silhouettes overlap by {:.2f}, aspect "
        "over aspect {:.2f}\n\n",
        c.pose->aircraft,
        c.pose->attitude.yaw_deg,
        c.pose->attitude.pitch_deg,
        c.pose->attitude.roll_deg,
        c.pose->overlap,
        c.pose->aspect_ratio);
  if (c.sun)
    text += fmt::format(
        "the sun from {:.0f} degrees, {:.0f} above the horizon (the camera looks to 0): light and "
        "dark correlate by {:.2f}, {:.0f} code values apart\n\n",
        c.sun->azimuth_deg,
        c.sun->elevation_deg,
        c.sun->correlation,
        c.sun->difference_codes);
  text += "| | real | inserted |\n|---|---:|---:|\n";
  for (const Pair& p : c.pairs)
    text += fmt::format(
        "| {} | {} | {} |\n", p.name, shown(p.real, p.real_spread), shown(p.made, p.made_spread));
  text +=
      fmt::format("| colour histogram distance | {:.3f} (to itself) | {:.3f} (to the real one) |\n",
                  c.colour_distance_within,
                  c.colour_distance);
  return text;
}

std::string json_of(const Comparison& c, const fs::path& real) {
  nlohmann::ordered_json json;
  json["video"] = real.string();
  json["frames"] = c.frames;
  if (c.pose)
    json["pose"] = {{"aircraft", c.pose->aircraft},
                    {"yaw_deg", c.pose->attitude.yaw_deg},
                    {"pitch_deg", c.pose->attitude.pitch_deg},
                    {"roll_deg", c.pose->attitude.roll_deg},
                    {"overlap", c.pose->overlap},
                    {"aspect_ratio", c.pose->aspect_ratio}};
  if (c.sun)
    json["pose"]["sun"] = {{"azimuth_deg", c.sun->azimuth_deg},
                           {"elevation_deg", c.sun->elevation_deg},
                           {"correlation", c.sun->correlation},
                           {"difference_codes", c.sun->difference_codes}};
  // A NaN is written as null.
  for (const Pair& p : c.pairs)
    json["measures"].push_back({{"name", p.name},
                                {"real", p.real},
                                {"real_spread", p.real_spread},
                                {"inserted", p.made},
                                {"inserted_spread", p.made_spread}});
  json["colour_distance"] = c.colour_distance;
  json["colour_distance_within_real"] = c.colour_distance_within;
  return json.dump(1) + "\n";
}

}  // namespace airtruth::comparison
