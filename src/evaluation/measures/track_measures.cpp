// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <vector>

#include <airtruth/track_measures.h>

#include "evaluation/matching/assignment.h"
#include "evaluation/matching/boxes.h"

namespace airtruth::evaluation {
namespace {

// Least overlap of a pair in CLEAR MOT and in the Identity measures, as TrackEval has it.
constexpr double kLeastOverlap = 0.5;
// The tolerance of comparisons.
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

// Numbers of tracks, from 0.
using Tracks = Eigen::VectorX<Eigen::Index>;

struct TableFrame {
  // Numbers of the tracks whose boxes are the rows and columns of `overlap`.
  Tracks truths;
  Tracks answers;
  Eigen::MatrixXd overlap;
};

struct TrackTable {
  // Number of boxes of each track.
  Eigen::VectorXd truth_counts;
  Eigen::VectorXd answer_counts;
  std::vector<TableFrame> frames;

  // A number for each pair of tracks.
  Eigen::MatrixXd zeros() const {
    return Eigen::MatrixXd::Zero(truth_counts.size(), answer_counts.size());
  }
};

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

// The tracks of a frame's boxes, which are counted.
Tracks tracks_of(const std::vector<TrackBox>& boxes,
                 const Numbers& numbers,
                 Eigen::VectorXd& counts) {
  Tracks tracks(std::ssize(boxes));
  for (Eigen::Index i = 0; i < tracks.size(); ++i) {
    tracks(i) = numbers.at(boxes[static_cast<std::size_t>(i)].id);
    counts(tracks(i)) += 1;
  }
  return tracks;
}

TrackTable table_of(const TrackFrames& frames) {
  const Numbers truths = numbers_of(frames, &TrackFrame::truths);
  const Numbers answers = numbers_of(frames, &TrackFrame::answers);
  TrackTable table{
      Eigen::VectorXd::Zero(std::ssize(truths)), Eigen::VectorXd::Zero(std::ssize(answers)), {}};
  for (const TrackFrame& frame : frames) {
    const auto overlap = [&](Eigen::Index t, Eigen::Index a) {
      return evaluation::overlap(frame.truths[static_cast<std::size_t>(t)].box_px,
                                 frame.answers[static_cast<std::size_t>(a)].box_px);
    };
    table.frames.push_back({tracks_of(frame.truths, truths, table.truth_counts),
                            tracks_of(frame.answers, answers, table.answer_counts),
                            Eigen::MatrixXd::NullaryExpr(
                                std::ssize(frame.truths), std::ssize(frame.answers), overlap)});
  }
  return table;
}

// As numpy.arange(0.05, 0.99, 0.05).
double threshold(std::size_t step) { return 0.05 + static_cast<double>(step) * 0.05; }

// How well each true track and each answer fit over the whole sequence: the Jaccard index of their
// boxes, where a pair of boxes counts as its share of the overlaps that either has.
Eigen::MatrixXd alignment_of(const TrackTable& table) {
  Eigen::MatrixXd shared = table.zeros();
  for (const TableFrame& frame : table.frames) {
    const Eigen::MatrixXd& overlap = frame.overlap;
    for (Eigen::Index t = 0; t < overlap.rows(); ++t)
      for (Eigen::Index a = 0; a < overlap.cols(); ++a) {
        const double all = overlap.col(a).sum() + overlap.row(t).sum() - overlap(t, a);
        if (all > kEpsilon) shared(frame.truths(t), frame.answers(a)) += overlap(t, a) / all;
      }
  }
  const Eigen::MatrixXd boxes = table.truth_counts.replicate(1, shared.cols()) +
                                table.answer_counts.transpose().replicate(shared.rows(), 1);
  return shared.cwiseQuotient(boxes - shared);
}

// Matches of each pair of tracks at each threshold.
using Matches = std::array<Eigen::MatrixXd, kHotaSteps>;

void count_frame(const TableFrame& frame,
                 const Eigen::MatrixXd& alignment,
                 Hota& hota,
                 Matches& matches) {
  const Eigen::MatrixXd cost = -alignment(frame.truths, frame.answers).cwiseProduct(frame.overlap);
  const auto answer_of = matching::least_cost_assignment(cost);
  std::array<double, kHotaSteps> matched{};
  for (Eigen::Index t = 0; t < cost.rows(); ++t) {
    const auto found = answer_of[static_cast<std::size_t>(t)];
    if (!found) continue;
    const auto a = static_cast<Eigen::Index>(*found);
    for (std::size_t k = 0; k < kHotaSteps; ++k) {
      if (frame.overlap(t, a) < threshold(k) - kEpsilon) break;
      matched[k] += 1;
      hota.loc_a[k] += frame.overlap(t, a);
      matches[k](frame.truths(t), frame.answers(a)) += 1;
    }
  }
  for (std::size_t k = 0; k < kHotaSteps; ++k) {
    hota.true_positives[k] += matched[k];
    hota.false_negatives[k] += static_cast<double>(cost.rows()) - matched[k];
    hota.false_positives[k] += static_cast<double>(cost.cols()) - matched[k];
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
  matches.fill(table.zeros());
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

namespace {

// A weight above any sum of overlaps: keeping a pair of the frame before comes first.
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
      : tracks_(static_cast<std::size_t>(table.truth_counts.size())) {
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
    const std::int64_t truths = frame.truths.size();
    const std::int64_t answers = frame.answers.size();
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
        score(t, a) = score(t, a) < kLeastOverlap - kEpsilon           ? 0
                      : of(frame.truths(t)).before == frame.answers(a) ? kKeptPair + score(t, a)
                                                                       : score(t, a);
    const auto answer_of = matching::least_cost_assignment(-score);
    std::vector<Eigen::Index> tracked_before;
    for (const Memory& track : tracks_) tracked_before.push_back(track.before);
    for (Memory& track : tracks_) track.before = kNone;
    std::int64_t matched = 0;
    for (Eigen::Index t = 0; t < score.rows(); ++t) {
      const auto found = answer_of[static_cast<std::size_t>(t)];
      if (!found || !(score(t, static_cast<Eigen::Index>(*found)) > kEpsilon)) continue;
      const auto a = static_cast<Eigen::Index>(*found);
      Memory& track = of(frame.truths(t));
      const Eigen::Index answer = frame.answers(a);
      if (track.last != kNone && track.last != answer) ++clear_.identity_switches;
      if (tracked_before[static_cast<std::size_t>(frame.truths(t))] == kNone) ++track.pieces;
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

// A share of nothing is 0.
double over(auto number, auto of) {
  return static_cast<double>(number) / std::max(1.0, static_cast<double>(of));
}

}  // namespace

double ClearMot::mota() const {
  return over(true_positives - false_positives - identity_switches,
              true_positives + false_negatives);
}
double ClearMot::motp() const { return over(overlap_sum, true_positives); }
double ClearMot::recall() const { return over(true_positives, true_positives + false_negatives); }
double ClearMot::precision() const {
  return over(true_positives, true_positives + false_positives);
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

namespace {

// Frames in which each pair of tracks agrees.
Eigen::MatrixXd agreements_of(const TrackTable& table) {
  Eigen::MatrixXd agreements = table.zeros();
  for (const TableFrame& frame : table.frames)
    for (Eigen::Index t = 0; t < frame.overlap.rows(); ++t)
      for (Eigen::Index a = 0; a < frame.overlap.cols(); ++a)
        if (frame.overlap(t, a) >= kLeastOverlap)
          agreements(frame.truths(t), frame.answers(a)) += 1;
  return agreements;
}

}  // namespace

double Identity::idf1() const {
  return over(true_positives,
              static_cast<double>(true_positives) + 0.5 * static_cast<double>(false_positives) +
                  0.5 * static_cast<double>(false_negatives));
}
double Identity::recall() const { return over(true_positives, true_positives + false_negatives); }
double Identity::precision() const {
  return over(true_positives, true_positives + false_positives);
}

Identity identity_of(const TrackFrames& frames) {
  const TrackTable table = table_of(frames);
  const Eigen::MatrixXd agreements = agreements_of(table);
  // Each pair saves two wrong boxes for each frame in which it agrees; a track that stays alone
  // saves none. So the fewest wrong boxes are the most agreements.
  double agreed = 0;
  const auto answer_of = matching::least_cost_assignment(-agreements);
  for (Eigen::Index t = 0; t < agreements.rows(); ++t)
    if (const auto a = answer_of[static_cast<std::size_t>(t)])
      agreed += agreements(t, static_cast<Eigen::Index>(*a));
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

}  // namespace airtruth::evaluation
