// SPDX-License-Identifier: Apache-2.0
#include "benchmark/judge/judge.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <sstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "benchmark/judge/areas.h"
#include "foundation/base/csv.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/seed.h"
#include "foundation/json/json_object.h"

namespace airtruth::judge {
namespace {

constexpr int kFolds = 4;  // stretches of time of a clip, for what a judge makes of it by itself

std::string name_of(const fs::path& folder) {
  return fs::absolute(folder).lexically_normal().filename().string();
}

// What a float holds, with room for the sums of a classifier.
double feature(const std::string& cell, const Where& where) {
  constexpr double kLargest = 1e9;
  const double value = finite_number(cell, where);
  if (std::abs(value) > kLargest)
    throw Error("'" + cell.substr(0, 40) + "' is no feature; expected a number within 1e9", where);
  return value;
}

Patches read_patches(const fs::path& folder) {
  const fs::path file = folder / "patches.csv";
  if (!fs::is_regular_file(file))
    throw Error("is no comparison: it has no patches.csv", {folder.string()});
  Patches clip;
  clip.name = name_of(folder);
  std::istringstream lines(read_file(file));
  std::string line;
  std::getline(lines, line);
  for (int row = 2; std::getline(lines, line); ++row) {
    std::vector<double> values;
    for (const std::string& cell : cells_of(line))
      values.push_back(feature(cell, {file.string(), row}));
    if (values.size() < 3) throw Error("has too few cells", {file.string(), row});
    if (!(values[1] >= 0)) throw Error("has no frame in its second cell", {file.string(), row});
    clip.real.push_back(values[0] > 0.5 ? 1 : 0);
    clip.frame.push_back(static_cast<std::int64_t>(values[1]));
    clip.features.emplace_back(values.begin() + 2, values.end());
    if (clip.features.back().size() != clip.features[0].size())
      throw Error(fmt::format("has {} cells; expected {}, as the line before",
                              values.size(),
                              clip.features[0].size() + 2),
                  {file.string(), row});
  }
  const auto real = std::count(clip.real.begin(), clip.real.end(), 1);
  if (real < 2 || std::ssize(clip.real) - real < 2)
    throw Error("holds fewer than two pairs", {file.string()});
  return clip;
}

std::vector<std::string> feature_names() {
  std::vector<std::string> names;
  for (const char* ring : {"inner", "outer"})
    for (int i = 0; i < 8; ++i) names.push_back(fmt::format("{} gradient {}", ring, i));
  for (const char* name : {"edge width",
                           "noise inside",
                           "noise inside over around",
                           "noise over contrast",
                           "fine detail",
                           "saturation",
                           "shading inside",
                           "sharpest dark corner",
                           "sharpest bright corner"})
    names.push_back(name);
  return names;
}

// How well each feature alone separates the two: its mean area under the curve over the clips,
// folded, so that the sign of the difference does not matter.
std::vector<std::pair<std::string, double>> telling_of(const std::vector<Patches>& clips) {
  const std::vector<std::string> names = feature_names();
  std::vector<std::pair<std::string, double>> telling;
  for (std::size_t f = 0; f < clips[0].features[0].size() && f < names.size(); ++f) {
    double sum = 0;
    for (const Patches& clip : clips) {
      std::vector<double> scores;
      for (const auto& row : clip.features) scores.push_back(double(row[f]));
      sum += area_under_curve(scores, clip.real);
    }
    telling.push_back({names[f], folded(sum / double(clips.size()))});
  }
  std::sort(telling.begin(), telling.end(), [](const auto& a, const auto& b) {
    return a.second > b.second;
  });
  return telling;
}

// Measures of all comparisons by name, in the order in which the first one has them.
struct Measured {
  std::vector<std::string> names;
  std::map<std::string, std::vector<std::pair<double, double>>> values;  // real, inserted; a clip
};

void add_measures(const fs::path& folder, Measured& measured) {
  const fs::path file = folder / "comparison.json";
  if (!fs::is_regular_file(file)) return;  // the patches alone are enough for the areas
  const JsonDocument comparison(file);
  for (const JsonObject& measure : comparison.objects("measures")) {
    const std::string name = measure.text("name");
    auto& values = measured.values[name];
    if (std::find(measured.names.begin(), measured.names.end(), name) == measured.names.end())
      measured.names.push_back(name);
    const auto real = measure.maybe_number("real");  // null where it could not be measured
    const auto inserted = measure.maybe_number("inserted");
    if (real && inserted) values.push_back({*real, *inserted});
  }
}

std::vector<Gap> gaps_of(const std::vector<fs::path>& comparisons, std::uint64_t seed) {
  Measured measured;
  for (const fs::path& folder : comparisons) add_measures(folder, measured);
  std::vector<Gap> gaps;
  for (const std::string& name : measured.names) {
    std::vector<double> real, made, difference;
    for (const auto& [r, m] : measured.values[name])
      real.push_back(r), made.push_back(m), difference.push_back(m - r);
    gaps.push_back({name,
                    real.size(),
                    median_over_clips(real, seed).value,
                    median_over_clips(made, seed).value,
                    median_over_clips(difference, seed)});
  }
  return gaps;
}

// Of each clip, by a judge that is trained on the others.
std::vector<double> areas_across(const std::vector<Patches>& clips, const std::stop_token& stop) {
  std::vector<double> areas;
  for (std::size_t i = 0; i < clips.size(); ++i) {
    if (stop.stop_requested()) throw Interrupted();
    std::vector<Patches> others = clips;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    areas.push_back(area_of_judge(others, clips[i]));
  }
  return areas;
}

double mean_folded(const std::vector<double>& areas) {
  double sum = 0;
  for (const double area : areas) sum += folded(area);
  return sum / double(areas.size());
}

// A permutation test over clips (Fisher 1935): under the hypothesis that nothing is common to the
// inserted aircraft, calling the two of a clip by each other's names changes nothing.
Verdict::ByChance by_chance(const std::vector<Patches>& clips,
                            double found,
                            int draws,
                            std::uint64_t seed,
                            const std::stop_token& stop) {
  Verdict::ByChance chance{draws, 0, 1, 0, 0};
  for (int draw = 0; draw < draws; ++draw) {
    Random random = Seed(seed).stream("judge by chance", static_cast<std::uint64_t>(draw));
    std::vector<Patches> drawn = clips;
    for (Patches& clip : drawn)
      if (random.uniform() < 0.5)
        for (int& real : clip.real) real = 1 - real;
    const double area = mean_folded(areas_across(drawn, stop));
    chance.mean += area / draws;
    chance.least = std::min(chance.least, area);
    chance.most = std::max(chance.most, area);
    chance.as_high += area >= found ? 1 : 0;
  }
  return chance;
}

}  // namespace

Verdict verdict_on(const std::vector<fs::path>& comparisons,
                   std::uint64_t seed,
                   int chance_draws,
                   const std::stop_token& stop) {
  if (comparisons.size() < 3)
    throw Error(
        "a judge is trained on other clips than it is asked about; expected three or more "
        "comparisons");
  std::vector<Patches> clips;
  for (const fs::path& folder : comparisons) {
    clips.push_back(read_patches(folder));
    if (clips.back().features[0].size() != clips[0].features[0].size())
      throw Error("has patches of another kind than the first comparison", {folder.string()});
  }
  Verdict verdict;
  const std::vector<double> areas = areas_across(clips, stop);
  std::vector<double> across, within;
  for (std::size_t i = 0; i < clips.size(); ++i) {
    across.push_back(folded(areas[i]));
    within.push_back(area_within(clips[i], kFolds));
    verdict.clips.push_back({clips[i].name, clips[i].real.size() / 2, areas[i], within.back()});
  }
  verdict.across = mean_over_clips(across, seed);
  verdict.within = mean_over_clips(within, seed);
  if (chance_draws > 0)
    verdict.by_chance = by_chance(clips, verdict.across.value, chance_draws, seed, stop);
  verdict.telling = telling_of(clips);
  verdict.gaps = gaps_of(comparisons, seed);
  return verdict;
}

}  // namespace airtruth::judge
