// SPDX-License-Identifier: Apache-2.0
#include "detection/scoring/track_table.h"

#include <map>

#include "truth/evaluation/metrics.h"

namespace airtruth::detection {
namespace {

// Numbers by order of the ids.
using Numbers = std::map<std::int64_t, Eigen::Index>;

Numbers numbers_of(const TrackFrames& frames, std::vector<TrackBox> TrackFrame::*boxes) {
  Numbers numbers;
  for (const TrackFrame& frame : frames)
    for (const TrackBox& box : frame.*boxes) numbers[box.id] = 0;
  Eigen::Index next = 0;
  for (auto& [id, number] : numbers) number = next++;
  return numbers;
}

}  // namespace

TrackTable table_of(const TrackFrames& frames) {
  const Numbers truths = numbers_of(frames, &TrackFrame::truths);
  const Numbers answers = numbers_of(frames, &TrackFrame::answers);
  TrackTable table;
  table.truth_tracks = std::ssize(truths);
  table.answer_tracks = std::ssize(answers);
  table.truth_counts = Eigen::VectorXd::Zero(table.truth_tracks);
  table.answer_counts = Eigen::VectorXd::Zero(table.answer_tracks);
  for (const TrackFrame& frame : frames) {
    TableFrame& row = table.frames.emplace_back();
    for (const TrackBox& box : frame.truths) {
      row.truths.push_back(truths.at(box.id));
      table.truth_counts(row.truths.back()) += 1;
    }
    for (const TrackBox& box : frame.answers) {
      row.answers.push_back(answers.at(box.id));
      table.answer_counts(row.answers.back()) += 1;
    }
    row.overlap.resize(std::ssize(row.truths), std::ssize(row.answers));
    for (Eigen::Index t = 0; t < row.overlap.rows(); ++t)
      for (Eigen::Index a = 0; a < row.overlap.cols(); ++a)
        row.overlap(t, a) = evaluation::overlap(frame.truths[static_cast<std::size_t>(t)].box_px,
                                                frame.answers[static_cast<std::size_t>(a)].box_px);
  }
  return table;
}

}  // namespace airtruth::detection
