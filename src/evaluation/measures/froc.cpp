// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>

#include <airtruth/froc.h>

#include "evaluation/statistics/proportion.h"

namespace airtruth::evaluation {
namespace {

// How many of scores that fall are `score` or more.
double count_at(const std::vector<double>& falling, double score) {
  return static_cast<double>(std::ranges::upper_bound(falling, score, std::greater<>()) -
                             falling.begin());
}

// The scores of a sequence, or of all, falling.
struct Sorted {
  std::vector<double> found;
  std::vector<double> false_alarms;
  double trials = 0;

  explicit Sorted(std::span<const FrocSequence> sequences) {
    for (const FrocSequence& sequence : sequences) {
      trials += static_cast<double>(sequence.best_scores.size());
      for (const auto& best : sequence.best_scores)
        if (best) found.push_back(*best);
      const std::vector<double>& alarms = sequence.false_alarm_scores;
      false_alarms.insert(false_alarms.end(), alarms.begin(), alarms.end());
    }
    std::ranges::sort(found, std::greater<>());
    std::ranges::sort(false_alarms, std::greater<>());
  }
};

// 0 where there is nothing to count by.
double per(double count, double of) { return of > 0 ? count / of : 0; }

struct Counts {
  Sorted all;
  std::vector<Sorted> sequences;
  double images = 0;
  double hours = 0;

  explicit Counts(std::span<const FrocSequence> of) : all(of) {
    for (const FrocSequence& sequence : of) {
      sequences.emplace_back(std::span(&sequence, 1));
      images += static_cast<double>(sequence.images);
      hours += sequence.duration_s / kSecondsPerHour;
    }
  }

  FrocPoint at(double score) const {
    FrocPoint point;
    point.score = score;
    std::vector<statistics::Cluster> clusters;
    for (const Sorted& sequence : sequences)
      clusters.push_back({count_at(sequence.found, score), sequence.trials});
    point.detection = statistics::proportion_of(clusters);
    const double alarms = false_alarms_at(score);
    point.false_alarms_per_image = per(alarms, images);
    point.false_alarms_per_hour = per(alarms, hours);
    point.false_alarms_per_flight = per(alarms, static_cast<double>(sequences.size()));
    return point;
  }

  // All scores that occur, falling.
  std::vector<double> scores() const {
    std::vector<double> scores;
    std::ranges::merge(all.found, all.false_alarms, std::back_inserter(scores), std::greater<>());
    scores.erase(std::unique(scores.begin(), scores.end()), scores.end());
    return scores;
  }
  double false_alarms_at(double score) const { return count_at(all.false_alarms, score); }
  double found_share_at(double score) const { return per(count_at(all.found, score), all.trials); }
};

// The scores at which the curve has moved on by a step: of log10 of the false alarms, or of the
// probability of detection.
std::vector<double> thinned(const Counts& counts, std::size_t most) {
  std::vector<double> scores = counts.scores();
  if (scores.size() <= most) return scores;
  const double steps = static_cast<double>(most) / 2 - 1;
  const auto decade = [&](double score) {
    return std::log10(std::max(0.5, counts.false_alarms_at(score)));
  };
  const double decades = std::max(1e-9, decade(scores.back()) - decade(scores.front()));
  std::vector<double> kept = {scores.front()};
  double alarms = decade(scores.front());
  double found = counts.found_share_at(scores.front());
  for (std::size_t i = 1; i + 1 < scores.size(); ++i) {
    const double alarms_here = decade(scores[i]);
    const double found_here = counts.found_share_at(scores[i]);
    if (alarms_here - alarms < decades / steps && found_here - found < 1 / steps) continue;
    kept.push_back(scores[i]);
    alarms = alarms_here;
    found = found_here;
  }
  kept.push_back(scores.back());
  return kept;
}

}  // namespace

Froc froc_of(std::span<const FrocSequence> sequences, std::size_t most) {
  const Counts counts(sequences);
  Froc froc;
  froc.images = static_cast<std::int64_t>(counts.images);
  froc.flights = std::ssize(sequences);
  froc.hours = counts.hours;
  froc.aircraft = static_cast<std::int64_t>(counts.all.trials);
  for (const double score : thinned(counts, most)) froc.points.push_back(counts.at(score));
  return froc;
}

FrocPoint froc_at(std::span<const FrocSequence> sequences, double score) {
  return Counts(sequences).at(score);
}

std::optional<double> score_at_false_alarms(std::span<const FrocSequence> sequences,
                                            double per_image) {
  const Counts counts(sequences);
  const std::vector<double> scores = counts.scores();
  // False alarms grow as the score falls.
  const auto beyond = std::partition_point(scores.begin(), scores.end(), [&](double score) {
    return per(counts.false_alarms_at(score), counts.images) <= per_image;
  });
  if (beyond == scores.begin()) return std::nullopt;
  return *std::prev(beyond);
}

}  // namespace airtruth::evaluation
