// SPDX-License-Identifier: Apache-2.0
#include "evaluation/scores/measure_inputs.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "foundation/geometry/transform.h"
#include "labels/annotation/object_class.h"

namespace airtruth::scores {
namespace {

// Calls each(frame, detection, match) for every detection that has a match.
template <typename Each>
void for_each_detection(const ScoredDetections& scored, Each each) {
  for (std::size_t i = 0; i < scored.matches.size(); ++i)
    for (std::size_t k = 0; k < scored.matches[i].size(); ++k)
      each(i, scored.detections.frames[i][k], scored.matches[i][k]);
}

// The detection of the highest score that finds each aircraft of a frame.
std::map<std::int64_t, const results::Detection*> best_of(const ScoredDetections& scored,
                                                          std::size_t frame) {
  std::map<std::int64_t, const results::Detection*> best;
  for (std::size_t k = 0; k < scored.matches[frame].size(); ++k) {
    const Match& match = scored.matches[frame][k];
    if (match.kind != MatchKind::kTruePositive) continue;
    const results::Detection*& found = best[*match.object];
    const results::Detection& detection = scored.detections.frames[frame][k];
    if (found == nullptr || detection.score > found->score) found = &detection;
  }
  return best;
}

struct Bearing {
  double azimuth_rad = 0;
  double elevation_rad = 0;
};

// docs/formats/truth.md: azimuth = atan2(x, z), elevation = atan2(-y, hypot(x, z)).
std::optional<Bearing> bearing_of(const lens::Lens& lens, const Box& box) {
  const auto ray = lens.ray_from_pixel({box.x + box.width / 2, box.y + box.height / 2});
  if (!ray) return std::nullopt;
  return Bearing{std::atan2(ray->x(), ray->z()),
                 std::atan2(-ray->y(), std::hypot(ray->x(), ray->z()))};
}

std::optional<measures::BearingSample> sample_of(const lens::Lens& lens,
                                                 const TruthObject& object,
                                                 const Box& detection_px) {
  if (!object.azimuth_deg || !object.elevation_deg) return std::nullopt;
  const auto bearing = bearing_of(lens, detection_px);
  if (!bearing) return std::nullopt;
  const double elevation_rad = radians(*object.elevation_deg);
  const double azimuth_rad =
      std::remainder(bearing->azimuth_rad - radians(*object.azimuth_deg), 2 * kPi);
  measures::BearingSample sample;
  sample.object = object.id;
  sample.azimuth_mrad = 1000 * azimuth_rad * std::cos(elevation_rad);
  sample.elevation_mrad = 1000 * (bearing->elevation_rad - elevation_rad);
  return sample;
}

bool is_in_the_air(const TruthObject& object) {
  return !annotation::is_on_lens(object.object_class);
}

}  // namespace

std::vector<measures::ScoredImage> images_of(const TruthSequence& truth,
                                             const ScoredDetections& scored) {
  std::vector<measures::ScoredImage> images(scored.matches.size());
  for (std::size_t i = 0; i < images.size(); ++i) {
    for (const TruthObject& object : truth.frames[i].objects)
      if (object.is_aircraft()) images[i].truths.push_back({object.box_px, !object.counts, false});
    for (const Box& region : truth.frames[i].ignored_px)
      images[i].truths.push_back({region, true, false});
    for (const results::Detection& detection : scored.detections.frames[i])
      if (claims_aircraft(detection.category))
        images[i].detections.push_back({detection.box_px, detection.score});
  }
  return images;
}

measures::FrocSequence froc_sequence_of(const TruthSequence& truth,
                                        const ScoredDetections& scored) {
  measures::FrocSequence sequence;
  sequence.images = std::ssize(scored.matches);
  sequence.duration_s = truth.duration_s;
  for (std::size_t i = 0; i < scored.matches.size(); ++i) {
    const auto best = best_of(scored, i);
    for (const TruthObject& object : truth.frames[i].objects) {
      if (!object.is_aircraft() || !object.counts) continue;
      const auto found = best.find(object.id);
      sequence.best_scores.push_back(found == best.end() ? std::nullopt
                                                         : std::optional(found->second->score));
    }
  }
  for_each_detection(scored,
                     [&](std::size_t, const results::Detection& detection, const Match& match) {
                       if (match.kind == MatchKind::kFalseAlarm)
                         sequence.false_alarm_scores.push_back(detection.score);
                     });
  return sequence;
}

std::vector<AircraftInFrame> sightings_of(std::size_t sequence,
                                          const TruthSequence& truth,
                                          const ScoredDetections& scored,
                                          double score) {
  std::vector<AircraftInFrame> sightings;
  for (std::size_t i = 0; i < scored.matches.size(); ++i) {
    const auto best = best_of(scored, i);
    for (std::size_t k = 0; k < truth.frames[i].objects.size(); ++k) {
      const TruthObject& object = truth.frames[i].objects[k];
      if (!object.is_aircraft() || !object.counts) continue;
      const auto found = best.find(object.id);
      sightings.push_back({sequence, i, k, found != best.end() && found->second->score >= score});
    }
  }
  return sightings;
}

std::vector<measures::BearingSample> bearing_samples_of(std::size_t sequence,
                                                        const TruthSequence& truth,
                                                        const ScoredDetections& scored,
                                                        double score) {
  std::vector<measures::BearingSample> samples;
  if (!truth.lens) return samples;
  for (std::size_t i = 0; i < scored.matches.size(); ++i) {
    const auto best = best_of(scored, i);
    for (const TruthObject& object : truth.frames[i].objects) {
      const auto found = best.find(object.id);
      if (found == best.end() || found->second->score < score) continue;
      auto sample = sample_of(*truth.lens, object, found->second->box_px);
      if (!sample) continue;
      sample->sequence = sequence;
      sample->time_s = truth.frames[i].time_s;
      samples.push_back(*sample);
    }
  }
  return samples;
}

measures::AotFlight aot_flight_of(const TruthSequence& truth, const ScoredDetections& scored) {
  measures::AotFlight flight;
  for (std::size_t i = 0; i < scored.matches.size(); ++i) {
    measures::AotFrame& frame = flight.frames.emplace_back();
    frame.frame = static_cast<std::int64_t>(i);
    for (const TruthObject& object : truth.frames[i].objects) {
      if (!object.counts || !is_in_the_air(object)) continue;
      const int above = !object.above_horizon ? 0 : *object.above_horizon ? 1 : -1;
      frame.objects.push_back(
          {object.id, object.box_px, object.is_aircraft() ? object.range_m : std::nullopt, above});
    }
  }
  for_each_detection(scored,
                     [&](std::size_t i, const results::Detection& detection, const Match& match) {
                       if (match.kind != MatchKind::kIgnored)
                         flight.frames[i].detections.push_back(
                             {detection.box_px, detection.score, detection.track});
                     });
  return flight;
}

measures::TrackFrames track_frames_of(const TruthSequence& truth,
                                      const ScoredDetections& scored,
                                      std::optional<double> score) {
  measures::TrackFrames frames(scored.matches.size());
  for (std::size_t i = 0; i < frames.size(); ++i)
    for (const TruthObject& object : truth.frames[i].objects)
      if (object.is_aircraft() && object.counts)
        frames[i].truths.push_back({object.id, object.box_px});
  for_each_detection(scored,
                     [&](std::size_t i, const results::Detection& detection, const Match& match) {
                       if (detection.track && match.kind != MatchKind::kIgnored &&
                           (!score || detection.score >= *score))
                         frames[i].answers.push_back({*detection.track, detection.box_px});
                     });
  return frames;
}

}  // namespace airtruth::scores
