// SPDX-License-Identifier: Apache-2.0
#include "benchmark/judge/areas.h"

#include <algorithm>
#include <functional>
#include <numeric>

#include <opencv2/ml.hpp>

#include "camera/opencv_plugin/opencv_plugin.h"
#include "foundation/base/median.h"
#include "foundation/base/seed.h"

namespace airtruth::judge {
namespace {

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

}  // namespace airtruth::judge
