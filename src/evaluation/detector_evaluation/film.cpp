// SPDX-License-Identifier: Apache-2.0
#include "evaluation/detector_evaluation/film.h"

#include <algorithm>
#include <map>
#include <set>

#include "foundation/base/in_parallel.h"

namespace airtruth::detector_evaluation {
namespace {

// Stills of all sequences together, some 25 kB each, and of one sequence.
constexpr std::size_t kMaxStills = 1000;
constexpr std::size_t kLeastStills = 2;
constexpr std::size_t kMostStills = 60;

// A cutout to be made, and where it goes.
struct Wanted {
  Box box;
  report::Cutout* place = nullptr;
};

// What is shown of each frame of one sequence.
struct Plan {
  std::set<std::size_t> stills;
  std::map<std::size_t, std::vector<Wanted>> cutouts;

  std::size_t last() const {
    std::size_t last = 0;
    if (!stills.empty()) last = *stills.rbegin();
    if (!cutouts.empty()) last = std::max(last, cutouts.rbegin()->first);
    return last;
  }
  bool is_empty() const { return stills.empty() && cutouts.empty(); }
};

// The cutouts of both galleries, and the stills.
std::vector<Plan> plans_of(const scores::Assessment& assessment, Film& film) {
  std::vector<Plan> plans(assessment.truths.size());
  film.false_alarms.resize(assessment.detectors.size());
  film.misses.resize(assessment.detectors.size());
  for (std::size_t k = 0; k < assessment.detectors.size(); ++k) {
    const scores::DetectorScore& detector = assessment.detectors[k];
    film.false_alarms[k].resize(detector.false_alarms.size());
    film.misses[k].resize(detector.misses.size());
    for (std::size_t i = 0; i < detector.false_alarms.size(); ++i) {
      const scores::FalseAlarm& alarm = detector.false_alarms[i];
      const scores::ScoredDetections& scored = detector.sequences[alarm.sequence];
      plans[scored.truth].cutouts[alarm.frame].push_back(
          {scored.detections.frames[alarm.frame][alarm.detection].box_px,
           &film.false_alarms[k][i]});
    }
    for (std::size_t i = 0; i < detector.misses.size(); ++i) {
      const scores::Miss& miss = detector.misses[i];
      const std::size_t truth = detector.sequences[miss.sequence].truth;
      plans[truth].cutouts[miss.frame].push_back(
          {assessment.truths[truth].frames[miss.frame].objects[miss.index].box_px,
           &film.misses[k][i]});
    }
  }
  // Sequences without results are not shown.
  std::set<std::size_t> with_results;
  for (const scores::DetectorScore& detector : assessment.detectors)
    for (const scores::ScoredDetections& scored : detector.sequences)
      with_results.insert(scored.truth);
  const std::size_t of_one = std::clamp(
      kMaxStills / std::max<std::size_t>(1, with_results.size()), kLeastStills, kMostStills);
  for (const std::size_t i : with_results) {
    const std::size_t frames = assessment.truths[i].frames.size();
    plans[i].stills = report::spread_over(frames, of_one);
    for (const auto& [frame, cutouts] : plans[i].cutouts)
      if (plans[i].stills.size() < 2 * of_one) plans[i].stills.insert(frame);
  }
  return plans;
}

// What the close-up of a still is around.
std::optional<Box> subject_of(const scores::Assessment& assessment,
                              std::size_t truth,
                              std::size_t frame) {
  std::optional<Box> subject;
  double largest = 0;
  for (const scores::TruthObject& object : assessment.truths[truth].frames[frame].objects)
    if (object.is_aircraft() && object.counts && object.size_px() > largest) {
      largest = object.size_px();
      subject = object.box_px;
    }
  if (subject) return subject;
  for (const scores::DetectorScore& detector : assessment.detectors)
    for (const scores::ScoredDetections& scored : detector.sequences) {
      if (scored.truth != truth || frame >= scored.detections.frames.size()) continue;
      const auto& found = scored.detections.frames[frame];
      const auto strongest = std::ranges::max_element(found, {}, &results::Detection::score);
      if (strongest != found.end()) return strongest->box_px;
    }
  return std::nullopt;
}

std::vector<report::Still> read_film(const scores::Assessment& assessment,
                                     std::size_t truth,
                                     const Plan& plan,
                                     const std::stop_token& stop) {
  const scores::TruthSequence& sequence = assessment.truths[truth];
  std::vector<report::Still> stills;
  if (sequence.media.empty()) return stills;
  report::ClipPictures pictures(sequence.media, sequence.name, stop);
  for (std::size_t i = 0; i <= plan.last(); ++i) {
    const bool is_still = plan.stills.contains(i);
    const auto cutouts = plan.cutouts.find(i);
    if (!is_still && cutouts == plan.cutouts.end()) continue;
    const image::Picture& picture = pictures.at(sequence.frames[i].frame);
    if (is_still)
      stills.push_back(report::still_of(picture, i, subject_of(assessment, truth, i), {}));
    if (cutouts != plan.cutouts.end())
      for (const Wanted& wanted : cutouts->second)
        *wanted.place = report::cutout_of(picture, wanted.box, {});
  }
  return stills;
}

}  // namespace

Film film_of(const scores::Assessment& assessment, const report::RunOptions& run) {
  Film film;
  film.sequences.resize(assessment.truths.size());
  const std::vector<Plan> plans = plans_of(assessment, film);
  std::vector<std::size_t> wanted;
  for (std::size_t i = 0; i < plans.size(); ++i)
    if (!plans[i].is_empty()) wanted.push_back(i);
  in_parallel(
      wanted.size(),
      run.jobs,
      [&](std::size_t i) {
        film.sequences[wanted[i]] = read_film(assessment, wanted[i], plans[wanted[i]], run.stop);
      },
      run.progress,
      run.stop);
  return film;
}

}  // namespace airtruth::detector_evaluation
