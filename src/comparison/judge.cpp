// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <sstream>

#include <fmt/format.h>
#include <opencv2/ml.hpp>

#include "base/csv.h"
#include "base/error.h"
#include "base/files.h"
#include "base/seed.h"
#include "comparison/comparison.h"

namespace airtruth::comparison {
namespace {

struct Clip {
  std::string name;
  std::vector<std::vector<float>> features;
  std::vector<int> real;
};

// What a float holds, with room for the sums of a classifier.
double feature(const std::string& cell, const Where& where) {
  constexpr double kLargest = 1e9;
  const double value = finite_number(cell, where);
  if (std::abs(value) > kLargest)
    throw Error("'" + cell.substr(0, 40) + "' is no feature; expected a number within 1e9", where);
  return value;
}

Clip read_clip(const fs::path& folder) {
  const fs::path file = folder / "patches.csv";
  if (!fs::is_regular_file(file))
    throw Error("is no comparison: it has no patches.csv", {folder.string()});
  Clip clip;
  clip.name = fs::absolute(folder).lexically_normal().filename().string();
  std::istringstream lines(read_file(file));
  std::string line;
  std::getline(lines, line);
  for (int row = 2; std::getline(lines, line); ++row) {
    std::vector<float> values;
    for (const std::string& cell : cells_of(line))
      values.push_back(static_cast<float>(feature(cell, {file.string(), row})));
    if (values.size() < 3) throw Error("has too few cells", {file.string(), row});
    if (!clip.features.empty() && values.size() != clip.features[0].size() + 2)
      throw Error(fmt::format("has {} cells; expected {}, as the line before",
                              values.size(),
                              clip.features[0].size() + 2),
                  {file.string(), row});
    clip.real.push_back(values[0] > 0.5F ? 1 : 0);
    clip.features.emplace_back(values.begin() + 2, values.end());
  }
  const auto real = std::count(clip.real.begin(), clip.real.end(), 1);
  if (real < 2 || std::ssize(clip.real) - real < 2)
    throw Error("holds fewer than two pairs", {file.string()});
  return clip;
}

// The probability that a real one is held more real than an inserted one (Mann and Whitney 1947).
double auc(const std::vector<double>& scores, const std::vector<int>& real) {
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

cv::Mat rows_of(const Clip& clip) {
  cv::Mat rows(
      static_cast<int>(clip.features.size()), static_cast<int>(clip.features[0].size()), CV_32F);
  for (int i = 0; i < rows.rows; ++i)
    std::copy(clip.features[static_cast<std::size_t>(i)].begin(),
              clip.features[static_cast<std::size_t>(i)].end(),
              rows.ptr<float>(i));
  return rows;
}

// Trained on all clips but one, asked about that one.
double auc_of(const std::vector<Clip>& clips, std::size_t left_out) {
  cv::Mat samples, answers;
  for (std::size_t i = 0; i < clips.size(); ++i) {
    if (i == left_out) continue;
    samples.push_back(rows_of(clips[i]));
    for (const int real : clips[i].real) answers.push_back(real);
  }
  const auto boost = cv::ml::Boost::create();
  boost->setBoostType(cv::ml::Boost::GENTLE);
  boost->setWeakCount(80);
  boost->setMaxDepth(2);
  boost->setWeightTrimRate(0);
  boost->train(samples, cv::ml::ROW_SAMPLE, answers);
  cv::Mat raw;
  boost->predict(
      rows_of(clips[left_out]), raw, cv::ml::StatModel::RAW_OUTPUT | cv::ml::DTrees::PREDICT_SUM);
  std::vector<double> scores;
  for (int i = 0; i < raw.rows; ++i) scores.push_back(double(raw.at<float>(i, 0)));
  return auc(scores, clips[left_out].real);
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

// What each feature alone tells: its mean area under the curve over the clips, whichever way round.
std::vector<std::pair<std::string, double>> telling_of(const std::vector<Clip>& clips) {
  const std::vector<std::string> names = feature_names();
  std::vector<std::pair<std::string, double>> telling;
  for (std::size_t f = 0; f < clips[0].features[0].size() && f < names.size(); ++f) {
    double sum = 0;
    for (const Clip& clip : clips) {
      std::vector<double> scores;
      for (const auto& row : clip.features) scores.push_back(double(row[f]));
      sum += auc(scores, clip.real);
    }
    const double mean = sum / double(clips.size());
    telling.push_back({names[f], std::max(mean, 1 - mean)});
  }
  std::sort(telling.begin(), telling.end(), [](const auto& a, const auto& b) {
    return a.second > b.second;
  });
  return telling;
}

}  // namespace

Verdict judge(const std::vector<fs::path>& comparisons, std::uint64_t seed) {
  if (comparisons.size() < 3)
    throw Error(
        "a judge is trained on other clips than it is asked about; expected three or more "
        "comparisons");
  std::vector<Clip> clips;
  for (const fs::path& folder : comparisons) {
    clips.push_back(read_clip(folder));
    if (clips.back().features[0].size() != clips[0].features[0].size())
      throw Error("has patches of another kind than the first comparison", {folder.string()});
  }
  Verdict verdict;
  std::vector<double> areas;
  for (std::size_t i = 0; i < clips.size(); ++i) {
    areas.push_back(auc_of(clips, i));
    verdict.by_clip.push_back({clips[i].name, areas.back()});
  }
  const auto mean = [](const std::vector<double>& values) {
    double sum = 0;
    for (const double v : values) sum += v;
    return sum / double(values.size());
  };
  verdict.auc = mean(areas);
  Random random = Seed(seed).stream("judge");
  std::vector<double> means;
  for (int round = 0; round < 2000; ++round) {
    std::vector<double> drawn;
    for (std::size_t i = 0; i < areas.size(); ++i)
      drawn.push_back(areas[static_cast<std::size_t>(random.uniform() * double(areas.size()))]);
    means.push_back(mean(drawn));
  }
  std::sort(means.begin(), means.end());
  verdict.low = means[means.size() * 25 / 1000];
  verdict.high = means[means.size() * 975 / 1000];
  verdict.telling = telling_of(clips);
  return verdict;
}

}  // namespace airtruth::comparison
