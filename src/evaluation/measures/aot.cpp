// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <tuple>

#include <airtruth/aot.h>

#include "evaluation/matching/boxes.h"

namespace airtruth::evaluation {
namespace {

// All are of the challenge's code; the header says what they decide.
constexpr double kMatch = 0.2;             // overlap
constexpr double kNoMatch = 0.02;          // overlap
constexpr double kLeastArea_px = 100;      // px^2
constexpr double kAreaRounding_px = 1e-6;  // px^2
constexpr double kEncounterRange_m = 700;
constexpr double kEncounterLeastRange_m = 330;
constexpr std::int64_t kEncounterFrames = 30;
constexpr std::int64_t kEncounterGap = 3;  // frames
constexpr std::size_t kWindow = 30;        // frames
constexpr double kWindowShare = 0.5;
constexpr double kDetectedRange_m = 300;
constexpr std::int64_t kDetectedFast = 30;  // frames

Box enlarged(const Box& box) {
  const double width = std::sqrt(kLeastArea_px * box.width / box.height);
  const double height = kLeastArea_px / width;
  return {box.x - (width - box.width) / 2, box.y - (height - box.height) / 2, width, height};
}

double extended_overlap(const Box& object, const Box& detection) {
  if (!(object.area() < kLeastArea_px)) return evaluation::overlap(object, detection);
  const bool is_small = detection.area() < kLeastArea_px - kAreaRounding_px;
  return evaluation::overlap(enlarged(object), is_small ? enlarged(detection) : detection);
}

// An object in a frame, with the detections that match it.
struct Match {
  double score = 0;
  std::int64_t track = 0;
};
struct Row {
  std::size_t flight = 0;
  std::int64_t frame = 0;
  std::int64_t id = 0;
  std::optional<double> range_m;
  int above_horizon = 0;
  std::vector<Match> matches;
};
struct False {
  std::size_t flight = 0;
  std::int64_t track = 0;
  double score = 0;
};

// Everything that does not depend on the threshold.
struct Matched {
  std::vector<Row> rows;
  std::vector<False> false_detections;
  std::vector<double> scores;  // of all detections, falling, each once
  std::int64_t images = 0;
  // Indices of rows in range, in encounters that are valid.
  std::vector<std::vector<std::size_t>> encounters;
  std::optional<double> max_range_m;
};

void match_frame(std::size_t flight,
                 const AotFrame& frame,
                 const std::vector<std::pair<const AotDetection*, std::int64_t>>& detections,
                 Matched& matched) {
  const std::size_t first_row = matched.rows.size();
  for (const AotObject& object : frame.objects)
    matched.rows.push_back(
        {flight, frame.frame, object.id, object.range_m, object.above_horizon, {}});
  for (const auto& [detection, track] : detections) {
    bool is_away = true;
    for (std::size_t i = 0; i < frame.objects.size(); ++i) {
      const double overlap = extended_overlap(frame.objects[i].box_px, detection->box_px);
      is_away = is_away && overlap < kNoMatch;
      if (overlap >= kMatch)
        matched.rows[first_row + i].matches.push_back({detection->score, track});
    }
    if (is_away) matched.false_detections.push_back({flight, track, detection->score});
    matched.scores.push_back(detection->score);
  }
}

void find_encounters(Matched& matched) {
  std::vector<std::size_t> in_range;
  for (std::size_t i = 0; i < matched.rows.size(); ++i)
    if (matched.rows[i].range_m && *matched.rows[i].range_m <= kEncounterRange_m)
      in_range.push_back(i);
  const auto place = [&](std::size_t i) {
    const Row& row = matched.rows[i];
    return std::tuple(row.flight, row.id, row.frame);
  };
  std::ranges::stable_sort(in_range, {}, place);
  std::vector<std::vector<std::size_t>> encounters;
  for (std::size_t i = 0; i < in_range.size(); ++i) {
    const Row& row = matched.rows[in_range[i]];
    bool is_new = i == 0;
    if (i > 0) {
      const Row& before = matched.rows[in_range[i - 1]];
      const std::int64_t step = row.frame - before.frame;
      is_new = step < 0 || step > kEncounterGap || row.flight != before.flight;
    }
    if (is_new) encounters.emplace_back();
    encounters.back().push_back(in_range[i]);
  }
  for (std::vector<std::size_t>& encounter : encounters) {
    const auto range_of = [&](std::size_t i) { return *matched.rows[i].range_m; };
    const auto [nearest, farthest] = std::ranges::minmax_element(encounter, {}, range_of);
    const double least = range_of(*nearest);
    const double most = range_of(*farthest);
    if (std::ssize(encounter) < kEncounterFrames || least > kEncounterLeastRange_m) continue;
    matched.max_range_m = std::max(matched.max_range_m.value_or(most), most);
    matched.encounters.push_back(std::move(encounter));
  }
}

Matched matched_of(std::span<const AotFlight> flights, int min_track_frames) {
  Matched matched;
  for (std::size_t f = 0; f < flights.size(); ++f) {
    std::map<std::int64_t, std::int64_t> first_frame;
    // A detection without a track is one of its own, below all numbers of tracks that files hold.
    std::int64_t next_own = -2;
    for (const AotFrame& frame : flights[f].frames) {
      std::vector<std::pair<const AotDetection*, std::int64_t>> detections;
      for (const AotDetection& detection : frame.detections) {
        const std::int64_t track = detection.track ? *detection.track : next_own--;
        const std::int64_t first = first_frame.try_emplace(track, frame.frame).first->second;
        if (1 + frame.frame - first >= min_track_frames) detections.emplace_back(&detection, track);
      }
      match_frame(f, frame, detections, matched);
      ++matched.images;
    }
  }
  std::ranges::sort(matched.scores, std::greater<>());
  matched.scores.erase(std::unique(matched.scores.begin(), matched.scores.end()),
                       matched.scores.end());
  find_encounters(matched);
  return matched;
}

// Whether an encounter is detected; `is_by_track`: by one track, else by any.
bool is_detected(const Matched& matched,
                 const std::vector<std::size_t>& encounter,
                 double score,
                 bool is_by_track) {
  // Objects of one frame are one step of the window, as in the code, which groups by frame.
  std::map<std::int64_t, std::vector<std::size_t>> frames;
  for (const std::size_t i : encounter) frames[matched.rows[i].frame].push_back(i);
  std::vector<std::vector<std::int64_t>> tracks;  // that match in each frame
  std::vector<std::size_t> first_rows;
  for (const auto& [frame, rows] : frames) {
    std::vector<std::int64_t>& of_frame = tracks.emplace_back();
    for (const std::size_t i : rows)
      for (const Match& match : matched.rows[i].matches)
        if (match.score >= score) of_frame.push_back(match.track);
    first_rows.push_back(rows.front());
  }
  std::map<std::int64_t, int> counts;
  int any = 0;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    for (const std::int64_t track : tracks[i]) ++counts[track];
    any += tracks[i].empty() ? 0 : 1;
    if (i >= kWindow) {
      for (const std::int64_t track : tracks[i - kWindow]) --counts[track];
      any -= tracks[i - kWindow].empty() ? 0 : 1;
    }
    if (i + 1 < kWindow) continue;
    int most = 0;
    for (const auto& [track, count] : counts) most = std::max(most, count);
    if ((is_by_track ? most : any) < kWindowShare * kWindow) continue;
    const Row& row = matched.rows[first_rows[i]];
    return *row.range_m >= kDetectedRange_m || row.frame - frames.begin()->first < kDetectedFast;
  }
  return false;
}

double hfar_at(const Matched& matched, double score, double hours) {
  std::set<std::pair<std::size_t, std::int64_t>> tracks;
  for (const False& one : matched.false_detections)
    if (one.score >= score) tracks.emplace(one.flight, one.track);
  return hours > 0 ? static_cast<double>(tracks.size()) / hours : 0;
}

double fppi_at(const Matched& matched, double score) {
  const auto alarms = std::ranges::count_if(matched.false_detections,
                                            [&](const False& one) { return one.score >= score; });
  return matched.images > 0 ? static_cast<double>(alarms) / static_cast<double>(matched.images) : 0;
}

void add(AotRate& rate, bool success) {
  ++rate.total;
  rate.detected += success ? 1 : 0;
}

AotScore score_at(const Matched& matched, double score, double hours) {
  AotScore result;
  result.score = score;
  result.max_range_m = matched.max_range_m;
  result.hfar = hfar_at(matched, score, hours);
  result.fppi = fppi_at(matched, score);
  for (const std::vector<std::size_t>& encounter : matched.encounters) {
    const bool success = is_detected(matched, encounter, score, true);
    std::int64_t above = 0;
    for (const std::size_t i : encounter) above += matched.rows[i].above_horizon;
    const std::int64_t frames = std::ssize(encounter);
    add(result.edr_all, success);
    add(above == frames    ? result.edr_above
        : above == -frames ? result.edr_below
                           : result.edr_mixed,
        success);
    add(result.edr_frames_all, is_detected(matched, encounter, score, false));
  }
  for (const Row& row : matched.rows)
    if (row.range_m && matched.max_range_m && *row.range_m >= 0 &&
        *row.range_m <= *matched.max_range_m)
      add(result.afdr,
          std::ranges::any_of(
              row.matches, [&](double s) { return s >= score; }, &Match::score));
  return result;
}

// The least score at which a rate that grows as the score falls is at most `most`.
template <typename Rate>
std::optional<double> least_score(const Matched& matched, double most, Rate rate) {
  const auto beyond = std::ranges::partition_point(
      matched.scores, [&](double score) { return rate(score) <= most; });
  if (beyond == matched.scores.begin()) return std::nullopt;
  return *std::prev(beyond);
}

}  // namespace

AotScore aot_score(std::span<const AotFlight> flights, const AotOptions& options) {
  const Matched matched = matched_of(flights, options.min_track_frames);
  const double least = matched.scores.empty() ? 0 : matched.scores.back();
  return score_at(matched, options.min_score.value_or(least), options.hours);
}

AotRanks aot_ranks(std::span<const AotFlight> flights, double hours) {
  const Matched matched = matched_of(flights, 0);
  AotRanks ranks;
  if (const auto score =
          least_score(matched, kRankedHfar, [&](double s) { return hfar_at(matched, s, hours); }))
    ranks.by_hfar = score_at(matched, *score, hours);
  if (const auto score =
          least_score(matched, kRankedFppi, [&](double s) { return fppi_at(matched, s); }))
    ranks.by_fppi = score_at(matched, *score, hours);
  return ranks;
}

}  // namespace airtruth::evaluation
