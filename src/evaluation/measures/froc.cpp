// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <functional>

#include <airtruth/froc.h>

#include "evaluation/statistics/proportion.h"

namespace airtruth::evaluation {
namespace {

// All scores that occur, falling.
std::vector<double> scores_of(std::span<const FrocSequence> sequences) {
  std::vector<double> scores;
  for (const FrocSequence& sequence : sequences) {
    scores.insert(
        scores.end(), sequence.false_alarm_scores.begin(), sequence.false_alarm_scores.end());
    for (const auto& best : sequence.best_scores)
      if (best) scores.push_back(*best);
  }
  std::sort(scores.begin(), scores.end(), std::greater<>());
  scores.erase(std::unique(scores.begin(), scores.end()), scores.end());
  return scores;
}

// All scores of one kind, falling.
class Counter {
 public:
  void add(double score) { scores_.push_back(score); }
  void sort() { std::sort(scores_.begin(), scores_.end(), std::greater<>()); }
  // How many are `score` or more.
  double at(double score) const {
    return static_cast<double>(
        std::upper_bound(scores_.begin(), scores_.end(), score, std::greater<>()) -
        scores_.begin());
  }

 private:
  std::vector<double> scores_;
};

// The scores of a sequence, or of all.
struct Sorted {
  Counter found;
  Counter false_alarms;
  double trials = 0;
};

class Counts {
 public:
  explicit Counts(std::span<const FrocSequence> sequences) {
    for (const FrocSequence& sequence : sequences) {
      Sorted& sorted = sequences_.emplace_back();
      sorted.trials = static_cast<double>(sequence.best_scores.size());
      for (const auto& best : sequence.best_scores)
        if (best) {
          sorted.found.add(*best);
          all_.found.add(*best);
        }
      for (const double score : sequence.false_alarm_scores) {
        sorted.false_alarms.add(score);
        all_.false_alarms.add(score);
      }
      sorted.found.sort();
      sorted.false_alarms.sort();
      images_ += static_cast<double>(sequence.images);
      hours_ += sequence.duration_s / kSecondsPerHour;
      all_.trials += sorted.trials;
    }
    all_.found.sort();
    all_.false_alarms.sort();
  }

  FrocPoint at(double score) const {
    FrocPoint point;
    point.score = score;
    std::vector<statistics::Cluster> clusters;
    for (const Sorted& sequence : sequences_)
      clusters.push_back({sequence.found.at(score), sequence.trials});
    point.detection = statistics::proportion_of(clusters);
    const double alarms = false_alarms_at(score);
    const auto rate = [&](double per) { return per > 0 ? alarms / per : 0; };
    point.false_alarms_per_image = rate(images_);
    point.false_alarms_per_hour = rate(hours_);
    point.false_alarms_per_flight = rate(static_cast<double>(sequences_.size()));
    return point;
  }

  double false_alarms_at(double score) const { return all_.false_alarms.at(score); }
  double found_share_at(double score) const {
    return all_.trials > 0 ? all_.found.at(score) / all_.trials : 0;
  }
  double images() const { return images_; }
  double hours() const { return hours_; }

 private:
  std::vector<Sorted> sequences_;
  Sorted all_;
  double images_ = 0;
  double hours_ = 0;
};

// The scores at which the curve has moved on by a step: of log10 of the false alarms, or of the
// probability of detection.
std::vector<double> thinned(const std::vector<double>& scores,
                            const Counts& counts,
                            std::size_t most) {
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
  for (const FrocSequence& sequence : sequences) {
    froc.images += sequence.images;
    froc.aircraft += std::ssize(sequence.best_scores);
  }
  froc.flights = std::ssize(sequences);
  froc.hours = counts.hours();
  for (const double score : thinned(scores_of(sequences), counts, most))
    froc.points.push_back(counts.at(score));
  return froc;
}

FrocPoint froc_at(std::span<const FrocSequence> sequences, double score) {
  return Counts(sequences).at(score);
}

std::optional<double> score_at_false_alarms(std::span<const FrocSequence> sequences,
                                            double per_image) {
  const std::vector<double> scores = scores_of(sequences);
  const Counts counts(sequences);
  const double most = per_image * counts.images();
  // False alarms grow as the score falls.
  const auto beyond = std::partition_point(scores.begin(), scores.end(), [&](double score) {
    return counts.false_alarms_at(score) <= most;
  });
  if (beyond == scores.begin()) return std::nullopt;
  return *std::prev(beyond);
}

}  // namespace airtruth::evaluation
