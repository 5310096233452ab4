// SPDX-License-Identifier: Apache-2.0
#include "comparison/judge/judge.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <map>
#include <numeric>
#include <sstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/ml.hpp>

#include "camera/opencv_plugin/opencv_plugin.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/median.h"
#include "foundation/base/seed.h"
#include "foundation/base/text.h"
#include "foundation/json/json_object.h"

namespace airtruth::judge {
namespace {

// Where a constant of this file states no origin, it is a choice.

constexpr int kDraws = 2000;           // of the bootstrap
constexpr std::size_t kMinOfFold = 4;  // pairs

cv::Mat rows_of(const Patches& clip) {
  cv::Mat rows(
      static_cast<int>(clip.features.size()), static_cast<int>(clip.features[0].size()), CV_32F);
  for (int i = 0; i < rows.rows; ++i)
    std::copy(clip.features[static_cast<std::size_t>(i)].begin(),
              clip.features[static_cast<std::size_t>(i)].end(),
              rows.ptr<float>(i));
  return rows;
}

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / double(values.size());
}

Interval interval_of(const std::vector<double>& values,
                     std::uint64_t seed,
                     const std::function<double(const std::vector<double>&)>& statistic) {
  if (values.empty()) return {};
  Random random = Seed(seed).stream("judge");
  std::vector<double> drawn(values.size()), results;
  for (int round = 0; round < kDraws; ++round) {
    for (double& v : drawn)
      v = values[static_cast<std::size_t>(random.uniform() * double(values.size()))];
    results.push_back(statistic(drawn));
  }
  std::sort(results.begin(), results.end());
  return {
      statistic(values), results[results.size() * 25 / 1000], results[results.size() * 975 / 1000]};
}

}  // namespace

double area_under_curve(const std::vector<double>& scores, const std::vector<int>& real) {
  double wins = 0, pairs = 0;
  for (std::size_t i = 0; i < scores.size(); ++i) {
    if (real[i] == 0) continue;
    for (std::size_t j = 0; j < scores.size(); ++j) {
      if (real[j] != 0) continue;
      pairs += 1;
      wins += scores[i] > scores[j] ? 1 : scores[i] == scores[j] ? 0.5 : 0;
    }
  }
  return pairs > 0 ? wins / pairs : 0.5;
}

double folded(double area) { return std::max(area, 1 - area); }

double area_of_judge(const std::vector<Patches>& train, const Patches& asked) {
  cv::Mat samples, answers;
  for (const Patches& clip : train) {
    samples.push_back(rows_of(clip));
    for (const int real : clip.real) answers.push_back(real);
  }
  const auto boost = opencv_plugin::functions().boost();
  boost->setBoostType(cv::ml::Boost::GENTLE);
  boost->setWeakCount(80);
  boost->setMaxDepth(2);
  boost->setWeightTrimRate(0);
  boost->train(samples, cv::ml::ROW_SAMPLE, answers);
  cv::Mat raw;
  // OpenCV's flags for the sum of the trees' answers.
  constexpr int kSumOfTrees = int{cv::ml::StatModel::RAW_OUTPUT} | int{cv::ml::DTrees::PREDICT_SUM};
  boost->predict(rows_of(asked), raw, kSumOfTrees);
  std::vector<double> scores;
  for (int i = 0; i < raw.rows; ++i) scores.push_back(double(raw.at<float>(i, 0)));
  return area_under_curve(scores, asked.real);
}

double area_within(const Patches& clip, int folds) {
  std::vector<std::int64_t> frames = clip.frame;
  std::sort(frames.begin(), frames.end());
  frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
  const auto count = static_cast<std::size_t>(folds);
  if (frames.size() < kMinOfFold * count) return 0.5;
  std::vector<double> areas;
  for (std::size_t fold = 0; fold < count; ++fold) {
    const std::size_t end = frames.size() * (fold + 1) / count;
    const std::int64_t first = frames[frames.size() * fold / count];
    const std::int64_t last = frames[end - 1];
    Patches train, asked;
    for (std::size_t i = 0; i < clip.frame.size(); ++i) {
      Patches& part = clip.frame[i] >= first && clip.frame[i] <= last ? asked : train;
      part.features.push_back(clip.features[i]);
      part.real.push_back(clip.real[i]);
    }
    areas.push_back(folded(area_of_judge({train}, asked)));
  }
  return mean_of(areas);
}

Interval mean_over_clips(const std::vector<double>& values, std::uint64_t seed) {
  return interval_of(values, seed, mean_of);
}

Interval median_over_clips(const std::vector<double>& values, std::uint64_t seed) {
  return interval_of(values, seed, median_between);
}

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

namespace {

nlohmann::ordered_json json_of_interval(const Interval& interval) {
  return {{"value", interval.value}, {"low", interval.low}, {"high", interval.high}};
}

std::string text_of(const Interval& interval) {
  return fmt::format("{:.3f} ({:.3f} to {:.3f})", interval.value, interval.low, interval.high);
}

std::string table_of_clips(const Verdict& v) {
  std::string text =
      "| clip | pairs | from other clips, not folded | within, folded |\n|---|---:|---:|---:|\n";
  for (const Verdict::Clip& clip : v.clips)
    text += fmt::format(
        "| {} | {} | {:.3f} | {:.3f} |\n", clip.name, clip.pairs, clip.across, clip.within);
  text += "\n| what alone tells | folded area |\n|---|---:|\n";
  for (std::size_t i = 0; i < std::min<std::size_t>(6, v.telling.size()); ++i)
    text += fmt::format("| {} | {:.3f} |\n", v.telling[i].first, v.telling[i].second);
  return text;
}

std::string table_of_gaps(const std::vector<Gap>& gaps) {
  std::string text =
      "\n| medians over clips | clips | real | inserted | inserted - real (95 %) |\n"
      "|---|---:|---:|---:|---|\n";
  for (const Gap& gap : gaps) {
    if (gap.clips == 0) continue;
    text += fmt::format("| {} | {} | {:.3g} | {:.3g} | {:+.3g} ({:+.3g} to {:+.3g}) |\n",
                        gap.name,
                        gap.clips,
                        gap.real,
                        gap.made,
                        gap.difference.value,
                        gap.difference.low,
                        gap.difference.high);
  }
  return text;
}

}  // namespace

std::string text_of(const Verdict& v) {
  std::string text = fmt::format(
      "folded area under the curve, mean of max(A, 1 - A) over {} clips; 0.5 is chance\n"
      "| | mean (95 % interval over clips) |\n|---|---|\n"
      "| trained on the other clips | {} |\n| trained and asked within each clip | {} |\n\n",
      v.clips.size(),
      text_of(v.across),
      text_of(v.within));
  if (v.by_chance)
    text += fmt::format(
        "With the names of the two aircraft drawn for each clip, the mean trained on the other "
        "clips "
        "is {:.3f} ({:.3f} to {:.3f}; {} draws, {} as high as the one found).\n\n",
        v.by_chance->mean,
        v.by_chance->least,
        v.by_chance->most,
        v.by_chance->draws,
        v.by_chance->as_high);
  return text + table_of_clips(v) + table_of_gaps(v.gaps);
}

std::string json_of(const Verdict& v) {
  nlohmann::ordered_json json;
  json["across"] = json_of_interval(v.across);
  json["within"] = json_of_interval(v.within);
  if (v.by_chance)
    json["by_chance"] = {{"draws", v.by_chance->draws},
                         {"mean", v.by_chance->mean},
                         {"least", v.by_chance->least},
                         {"most", v.by_chance->most},
                         {"as_high", v.by_chance->as_high}};
  for (const Verdict::Clip& clip : v.clips)
    json["clips"].push_back({{"name", clip.name},
                             {"pairs", clip.pairs},
                             {"across", clip.across},
                             {"within", clip.within}});
  for (const auto& [name, area] : v.telling)
    json["telling"].push_back({{"name", name}, {"area", area}});
  for (const Gap& gap : v.gaps)
    json["gaps"].push_back({{"name", gap.name},
                            {"clips", gap.clips},
                            {"real", gap.real},
                            {"inserted", gap.made},
                            {"difference", json_of_interval(gap.difference)}});
  return json.dump(1) + "\n";
}

}  // namespace airtruth::judge
