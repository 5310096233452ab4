// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include <Eigen/Core>

#include "detection/scoring/track_frames.h"

// Tracks numbered from 0, with their overlaps, for the measures of tracks; only this module
// includes it.
namespace airtruth::detection {

// Least overlap of a pair in CLEAR MOT and in the Identity measures, as TrackEval has it.
inline constexpr double kLeastOverlap = 0.5;
inline constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

struct TableFrame {
  // Numbers of the tracks whose boxes are the rows and columns of `overlap`.
  std::vector<Eigen::Index> truths;
  std::vector<Eigen::Index> answers;
  Eigen::MatrixXd overlap;

  Eigen::Index truth(Eigen::Index row) const { return truths[static_cast<std::size_t>(row)]; }
  Eigen::Index answer(Eigen::Index column) const {
    return answers[static_cast<std::size_t>(column)];
  }
};

struct TrackTable {
  Eigen::Index truth_tracks = 0;
  Eigen::Index answer_tracks = 0;
  // Number of boxes of each track.
  Eigen::VectorXd truth_counts;
  Eigen::VectorXd answer_counts;
  std::vector<TableFrame> frames;
};

TrackTable table_of(const TrackFrames& frames);

}  // namespace airtruth::detection
