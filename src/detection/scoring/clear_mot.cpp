// SPDX-License-Identifier: Apache-2.0
#include "detection/scoring/clear_mot.h"

#include <algorithm>
#include <vector>

#include "detection/scoring/track_table.h"
#include "truth/evaluation/assignment.h"

namespace airtruth::detection {
namespace {

// Above any sum of overlaps: keeping a pair of the frame before comes first.
constexpr double kKeptPair = 1000;
constexpr Eigen::Index kNone = -1;

// What is remembered of a true track.
struct Memory {
  Eigen::Index last = kNone;    // the answer that matched last, however long ago
  Eigen::Index before = kNone;  // that of the frame before
  std::int64_t frames = 0;
  std::int64_t matched = 0;
  std::int64_t pieces = 0;  // runs of matched frames
};

class TrackWalk {
 public:
  explicit TrackWalk(const TrackTable& table)
      : tracks_(static_cast<std::size_t>(table.truth_tracks)) {
    for (const TableFrame& frame : table.frames) count(frame);
    clear_.frames = std::ssize(table.frames);
    for (const Memory& track : tracks_) {
      const double share = static_cast<double>(track.matched) / static_cast<double>(track.frames);
      (share > 0.8    ? clear_.mostly_tracked
       : share >= 0.2 ? clear_.partly_tracked
                      : clear_.mostly_lost) += 1;
      clear_.fragmentations += std::max<std::int64_t>(0, track.pieces - 1);
    }
  }
  const ClearMot& result() const { return clear_; }

 private:
  Memory& of(Eigen::Index track) { return tracks_[static_cast<std::size_t>(track)]; }

  void count(const TableFrame& frame) {
    const std::int64_t truths = std::ssize(frame.truths);
    const std::int64_t answers = std::ssize(frame.answers);
    for (const Eigen::Index track : frame.truths) ++of(track).frames;
    // A frame without truths or without answers leaves the pairs of the frame before as they are,
    // as in the toolkit.
    const std::int64_t matched = truths > 0 && answers > 0 ? match(frame) : 0;
    clear_.true_positives += matched;
    clear_.false_negatives += truths - matched;
    clear_.false_positives += answers - matched;
  }

  std::int64_t match(const TableFrame& frame) {
    Eigen::MatrixXd score = frame.overlap;
    for (Eigen::Index t = 0; t < score.rows(); ++t)
      for (Eigen::Index a = 0; a < score.cols(); ++a)
        score(t, a) = score(t, a) < kLeastOverlap - kEpsilon         ? 0
                      : of(frame.truth(t)).before == frame.answer(a) ? kKeptPair + score(t, a)
                                                                     : score(t, a);
    const auto answer_of = evaluation::least_cost_assignment(-score);
    std::vector<Eigen::Index> tracked_before;
    for (const Memory& track : tracks_) tracked_before.push_back(track.before);
    for (Memory& track : tracks_) track.before = kNone;
    std::int64_t matched = 0;
    for (Eigen::Index t = 0; t < score.rows(); ++t) {
      const auto found = answer_of[static_cast<std::size_t>(t)];
      if (!found || !(score(t, static_cast<Eigen::Index>(*found)) > kEpsilon)) continue;
      const auto a = static_cast<Eigen::Index>(*found);
      Memory& track = of(frame.truth(t));
      const Eigen::Index answer = frame.answer(a);
      if (track.last != kNone && track.last != answer) ++clear_.identity_switches;
      if (tracked_before[static_cast<std::size_t>(frame.truth(t))] == kNone) ++track.pieces;
      track.last = track.before = answer;
      ++track.matched;
      ++matched;
      clear_.overlap_sum += frame.overlap(t, a);
    }
    return matched;
  }

  std::vector<Memory> tracks_;
  ClearMot clear_;
};

double over(double number, std::int64_t of) {
  return number / static_cast<double>(std::max<std::int64_t>(1, of));
}

}  // namespace

double ClearMot::mota() const {
  return over(static_cast<double>(true_positives - false_positives - identity_switches),
              true_positives + false_negatives);
}
double ClearMot::motp() const { return over(overlap_sum, true_positives); }
double ClearMot::recall() const {
  return over(static_cast<double>(true_positives), true_positives + false_negatives);
}
double ClearMot::precision() const {
  return over(static_cast<double>(true_positives), true_positives + false_positives);
}

ClearMot clear_mot_of(const TrackFrames& frames) { return TrackWalk(table_of(frames)).result(); }

ClearMot combined(std::span<const ClearMot> sequences) {
  ClearMot all;
  for (const ClearMot& one : sequences) {
    all.true_positives += one.true_positives;
    all.false_negatives += one.false_negatives;
    all.false_positives += one.false_positives;
    all.identity_switches += one.identity_switches;
    all.fragmentations += one.fragmentations;
    all.mostly_tracked += one.mostly_tracked;
    all.partly_tracked += one.partly_tracked;
    all.mostly_lost += one.mostly_lost;
    all.frames += one.frames;
    all.overlap_sum += one.overlap_sum;
  }
  return all;
}

}  // namespace airtruth::detection
