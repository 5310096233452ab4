// SPDX-License-Identifier: Apache-2.0
#include "detection/scoring/identity.h"

#include <algorithm>
#include <cmath>

#include "detection/scoring/track_table.h"
#include "truth/evaluation/assignment.h"

namespace airtruth::detection {
namespace {

double over(double number, double of) { return number / std::max(1.0, of); }

// Frames in which each pair of tracks agrees.
Eigen::MatrixXd agreements_of(const TrackTable& table) {
  Eigen::MatrixXd agreements = Eigen::MatrixXd::Zero(table.truth_tracks, table.answer_tracks);
  for (const TableFrame& frame : table.frames)
    for (Eigen::Index t = 0; t < frame.overlap.rows(); ++t)
      for (Eigen::Index a = 0; a < frame.overlap.cols(); ++a)
        if (frame.overlap(t, a) >= kLeastOverlap) agreements(frame.truth(t), frame.answer(a)) += 1;
  return agreements;
}

}  // namespace

double Identity::idf1() const {
  return over(static_cast<double>(true_positives),
              static_cast<double>(true_positives) + 0.5 * static_cast<double>(false_positives) +
                  0.5 * static_cast<double>(false_negatives));
}
double Identity::recall() const {
  return over(static_cast<double>(true_positives),
              static_cast<double>(true_positives + false_negatives));
}
double Identity::precision() const {
  return over(static_cast<double>(true_positives),
              static_cast<double>(true_positives + false_positives));
}

Identity identity_of(const TrackFrames& frames) {
  const TrackTable table = table_of(frames);
  const Eigen::MatrixXd agreements = agreements_of(table);
  // Each pair saves two wrong boxes for each frame in which it agrees; a track that stays alone
  // saves none. So the fewest wrong boxes are the most agreements.
  double agreed = 0;
  if (agreements.size() > 0) {
    const auto answer_of = evaluation::least_cost_assignment(-agreements);
    for (Eigen::Index t = 0; t < agreements.rows(); ++t)
      if (const auto a = answer_of[static_cast<std::size_t>(t)])
        agreed += agreements(t, static_cast<Eigen::Index>(*a));
  }
  Identity identity;
  identity.true_positives = std::llround(agreed);
  identity.false_negatives = std::llround(table.truth_counts.sum() - agreed);
  identity.false_positives = std::llround(table.answer_counts.sum() - agreed);
  return identity;
}

Identity combined(std::span<const Identity> sequences) {
  Identity all;
  for (const Identity& one : sequences) {
    all.true_positives += one.true_positives;
    all.false_negatives += one.false_negatives;
    all.false_positives += one.false_positives;
  }
  return all;
}

}  // namespace airtruth::detection
