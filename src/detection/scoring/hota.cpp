// SPDX-License-Identifier: Apache-2.0
#include "detection/scoring/hota.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "detection/scoring/track_table.h"
#include "truth/evaluation/assignment.h"

namespace airtruth::detection {
namespace {

// As numpy.arange(0.05, 0.99, 0.05).
double threshold(std::size_t step) { return 0.05 + static_cast<double>(step) * 0.05; }

// How well each true track and each answer fit over the whole sequence: the Jaccard index of their
// boxes, where a pair of boxes counts as its share of the overlaps that either has.
Eigen::MatrixXd alignment_of(const TrackTable& table) {
  Eigen::MatrixXd shared = Eigen::MatrixXd::Zero(table.truth_tracks, table.answer_tracks);
  for (const TableFrame& frame : table.frames) {
    const Eigen::MatrixXd& overlap = frame.overlap;
    for (Eigen::Index t = 0; t < overlap.rows(); ++t)
      for (Eigen::Index a = 0; a < overlap.cols(); ++a) {
        const double all = overlap.col(a).sum() + overlap.row(t).sum() - overlap(t, a);
        if (all > kEpsilon) shared(frame.truth(t), frame.answer(a)) += overlap(t, a) / all;
      }
  }
  Eigen::MatrixXd alignment(shared.rows(), shared.cols());
  for (Eigen::Index t = 0; t < shared.rows(); ++t)
    for (Eigen::Index a = 0; a < shared.cols(); ++a)
      alignment(t, a) =
          shared(t, a) / (table.truth_counts(t) + table.answer_counts(a) - shared(t, a));
  return alignment;
}

// Matches of each pair of tracks at each threshold.
using Matches = std::array<Eigen::MatrixXd, kHotaSteps>;

void count_frame(const TableFrame& frame,
                 const Eigen::MatrixXd& alignment,
                 Hota& hota,
                 Matches& matches) {
  const Eigen::Index truths = frame.overlap.rows();
  const Eigen::Index answers = frame.overlap.cols();
  Eigen::MatrixXd cost(truths, answers);
  for (Eigen::Index t = 0; t < truths; ++t)
    for (Eigen::Index a = 0; a < answers; ++a)
      cost(t, a) = -alignment(frame.truth(t), frame.answer(a)) * frame.overlap(t, a);
  std::array<double, kHotaSteps> matched{};
  if (truths > 0 && answers > 0) {
    const auto answer_of = evaluation::least_cost_assignment(cost);
    for (Eigen::Index t = 0; t < truths; ++t) {
      const auto found = answer_of[static_cast<std::size_t>(t)];
      if (!found) continue;
      const auto a = static_cast<Eigen::Index>(*found);
      for (std::size_t k = 0; k < kHotaSteps; ++k) {
        if (frame.overlap(t, a) < threshold(k) - kEpsilon) break;
        matched[k] += 1;
        hota.loc_a[k] += frame.overlap(t, a);
        matches[k](frame.truth(t), frame.answer(a)) += 1;
      }
    }
  }
  for (std::size_t k = 0; k < kHotaSteps; ++k) {
    hota.true_positives[k] += matched[k];
    hota.false_negatives[k] += static_cast<double>(truths) - matched[k];
    hota.false_positives[k] += static_cast<double>(answers) - matched[k];
  }
}

void associate(const TrackTable& table, const Matches& matches, Hota& hota) {
  for (std::size_t k = 0; k < kHotaSteps; ++k) {
    const Eigen::MatrixXd& count = matches[k];
    const double hits = std::max(1.0, hota.true_positives[k]);
    for (Eigen::Index t = 0; t < count.rows(); ++t)
      for (Eigen::Index a = 0; a < count.cols(); ++a) {
        const double n = count(t, a);
        if (n == 0) continue;
        const double of_truth = table.truth_counts(t);
        const double of_answer = table.answer_counts(a);
        hota.ass_a[k] += n * n / std::max(1.0, of_truth + of_answer - n) / hits;
        hota.ass_re[k] += n * n / std::max(1.0, of_truth) / hits;
        hota.ass_pr[k] += n * n / std::max(1.0, of_answer) / hits;
      }
  }
}

// Fills in what follows from the counts, the associations and the sum of overlaps in loc_a.
void finish(Hota& hota) {
  for (std::size_t k = 0; k < kHotaSteps; ++k) {
    const double hits = hota.true_positives[k];
    const double misses = hota.false_negatives[k];
    const double alarms = hota.false_positives[k];
    // Without a match the toolkit's overlap is 1.
    hota.loc_a[k] = std::max(1e-10, hota.loc_a[k]) / std::max(1e-10, hits);
    hota.det_re[k] = hits / std::max(1.0, hits + misses);
    hota.det_pr[k] = hits / std::max(1.0, hits + alarms);
    hota.det_a[k] = hits / std::max(1.0, hits + misses + alarms);
    hota.hota[k] = std::sqrt(hota.det_a[k] * hota.ass_a[k]);
  }
}

}  // namespace

double Hota::mean(const Curve& curve) {
  return std::accumulate(curve.begin(), curve.end(), 0.0) / kHotaSteps;
}

Hota hota_of(const TrackFrames& frames) {
  const TrackTable table = table_of(frames);
  const Eigen::MatrixXd alignment = alignment_of(table);
  Hota hota;
  Matches matches;
  matches.fill(Eigen::MatrixXd::Zero(table.truth_tracks, table.answer_tracks));
  for (const TableFrame& frame : table.frames) count_frame(frame, alignment, hota, matches);
  associate(table, matches, hota);
  finish(hota);
  return hota;
}

Hota combined(std::span<const Hota> sequences) {
  Hota all;
  for (const Hota& one : sequences)
    for (std::size_t k = 0; k < kHotaSteps; ++k) {
      const double hits = one.true_positives[k];
      all.true_positives[k] += hits;
      all.false_negatives[k] += one.false_negatives[k];
      all.false_positives[k] += one.false_positives[k];
      all.ass_a[k] += one.ass_a[k] * hits;
      all.ass_re[k] += one.ass_re[k] * hits;
      all.ass_pr[k] += one.ass_pr[k] * hits;
      all.loc_a[k] += one.loc_a[k] * hits;
    }
  for (std::size_t k = 0; k < kHotaSteps; ++k) {
    const double hits = std::max(1.0, all.true_positives[k]);
    all.ass_a[k] /= hits;
    all.ass_re[k] /= hits;
    all.ass_pr[k] /= hits;
  }
  finish(all);
  return all;
}

}  // namespace airtruth::detection
