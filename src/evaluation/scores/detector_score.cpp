// SPDX-License-Identifier: Apache-2.0
#include "evaluation/scores/detector_score.h"

#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "foundation/base/median.h"
#include "foundation/geometry/box.h"
#include "foundation/geometry/transform.h"
#include "labels/annotation/object_class.h"

namespace airtruth::scores {
namespace {

// docs/formats/truth.md: azimuth = atan2(x, z), elevation = atan2(-y, hypot(x, z)).
std::optional<measures::BearingSample> sample_of(const lens::Lens& lens,
                                                 const TruthObject& object,
                                                 const Box& detection_px) {
  const auto ray = lens.ray_from_pixel(centre_of(detection_px));
  if (!ray || !object.azimuth_deg || !object.elevation_deg) return std::nullopt;
  const double azimuth_rad =
      std::remainder(std::atan2(ray->x(), ray->z()) - radians(*object.azimuth_deg), 2 * kPi);
  const double elevation_rad = std::atan2(-ray->y(), std::hypot(ray->x(), ray->z()));
  const double true_elevation_rad = radians(*object.elevation_deg);
  measures::BearingSample sample;
  sample.object = object.id;
  sample.azimuth_mrad = 1000 * azimuth_rad * std::cos(true_elevation_rad);
  sample.elevation_mrad = 1000 * (elevation_rad - true_elevation_rad);
  return sample;
}

// The functions below give a sequence's truth and detections in the form that each measure takes.
// Aircraft that count are truths; those that do not, and ignored regions, are regions. Detections
// that claim something else than an aircraft are left out, here and below.
std::vector<evaluation::ScoredImage> images_of(const TruthSequence& truth,
                                               const ScoredDetections& scored) {
  std::vector<evaluation::ScoredImage> images(scored.matches.size());
  for (std::size_t i = 0; i < images.size(); ++i) {
    images[i].image_id = truth.frames[i].image_id;
    for (const TruthObject& object : truth.frames[i].objects)
      if (object.is_aircraft())
        images[i].truths.push_back({object.box_px, !object.counts, false, object.area_px});
    for (const Box& region : truth.frames[i].ignored_px)
      images[i].truths.push_back({region, true, false});
    for (const results::Detection& detection : scored.detections.frames[i])
      if (claims_aircraft(detection.category, truth))
        images[i].detections.push_back({detection.box_px, detection.score});
  }
  return images;
}

// Aircraft, birds, multirotors and balloons are objects, the latter three without a range, as in
// the challenge's truth. Ignored detections are left out.
evaluation::AotFlight aot_flight_of(const TruthSequence& truth, const ScoredDetections& scored) {
  evaluation::AotFlight flight;
  for (std::size_t i = 0; i < scored.matches.size(); ++i) {
    evaluation::AotFrame& frame = flight.frames.emplace_back();
    frame.frame = static_cast<std::int64_t>(i);
    for (const TruthObject& object : truth.frames[i].objects) {
      if (!object.counts || annotation::is_on_lens(object.object_class)) continue;
      const int above = !object.above_horizon ? 0 : *object.above_horizon ? 1 : -1;
      frame.objects.push_back(
          {object.id, object.box_px, object.is_aircraft() ? object.range_m : std::nullopt, above});
    }
  }
  scored.each([&](std::size_t i, const results::Detection& detection, const Match& match) {
    if (match.kind != MatchKind::kIgnored)
      flight.frames[i].detections.push_back({detection.box_px, detection.score, detection.track});
  });
  return flight;
}

// Aircraft that count, and detections with a track that are not ignored, of this score or more.
evaluation::TrackFrames track_frames_of(const TruthSequence& truth,
                                        const ScoredDetections& scored,
                                        std::optional<double> score) {
  evaluation::TrackFrames frames(scored.matches.size());
  for (std::size_t i = 0; i < frames.size(); ++i)
    for (const TruthObject& object : truth.frames[i].objects)
      if (object.is_aircraft() && object.counts)
        frames[i].truths.push_back({object.id, object.box_px});
  scored.each([&](std::size_t i, const results::Detection& detection, const Match& match) {
    if (detection.track && match.kind != MatchKind::kIgnored &&
        (!score || detection.score >= *score))
      frames[i].answers.push_back({*detection.track, detection.box_px});
  });
  return frames;
}

// The measures at work, one function for each part of DetectorScore.
class Scoring {
 public:
  Scoring(DetectorScore& result,
          bool is_associated,
          std::span<const TruthSequence> truths,
          const ScoreOptions& options)
      : result_(result), truths_(truths), options_(options), has_tracks_(is_associated) {
    for (ScoredDetections& scored : result_.sequences) {
      scored.matches = matches_of(scored.detections, truth(scored), options.centre_px);
      hours_ += truth(scored).duration_s / evaluation::kSecondsPerHour;
      if (options.is_weighted) weights_.push_back(truth(scored).weight.value_or(1));
      backgrounds_.push_back(truth(scored).background_cut);
      for (const auto& frame : scored.detections.frames)
        for (const results::Detection& detection : frame) {
          ++result_.detections;
          has_tracks_ = has_tracks_ || detection.track;
        }
    }
    has_tracks_ = has_tracks_ || result_.detections == 0;
  }

  void score() {
    score_precision();
    score_froc();
    score_aot();
    if (has_tracks_) score_tracks();
    score_at_point(result_.point.score);
    score_speed();
  }

 private:
  const TruthSequence& truth(const ScoredDetections& scored) const { return truths_[scored.truth]; }

  void score_precision() {
    std::vector<std::vector<evaluation::ScoredImage>> images;
    for (const ScoredDetections& scored : result_.sequences)
      images.push_back(images_of(truth(scored), scored));
    result_.average_precision = average_precision(images, options_.centre_px);
  }

  void score_froc() {
    std::vector<evaluation::FrocSequence> sequences;
    for (const ScoredDetections& scored : result_.sequences)
      sequences.push_back(froc_sequence_of(truth(scored), scored));
    result_.froc = evaluation::froc_of(sequences);
    // Where the best detection is a false alarm and one is too many, the point is that of its
    // score. Without a detection all scores are alike.
    const auto& points = result_.froc.points;
    const double score = options_.score ? *options_.score
                                        : evaluation::score_at_false_alarms(
                                              sequences, options_.false_alarms_per_image)
                                              .value_or(points.empty() ? 0 : points.front().score);
    result_.point = evaluation::froc_at(sequences, score);
  }

  void score_aot() {
    std::vector<evaluation::AotFlight> flights;
    for (const ScoredDetections& scored : result_.sequences)
      flights.push_back(aot_flight_of(truth(scored), scored));
    result_.aot = evaluation::aot_score(flights, {{}, hours_, 0});
    result_.aot_ranks = evaluation::aot_ranks(flights, hours_);
  }

  void score_tracks() {
    TrackScores& tracks = result_.tracks.emplace();
    std::vector<evaluation::Hota> hotas;
    std::vector<evaluation::ClearMot> clears;
    std::vector<evaluation::Identity> identities;
    for (std::size_t i = 0; i < result_.sequences.size(); ++i) {
      const ScoredDetections& scored = result_.sequences[i];
      const evaluation::TrackFrames frames = track_frames_of(truth(scored), scored, options_.score);
      hotas.push_back(evaluation::hota_of(frames));
      clears.push_back(evaluation::clear_mot_of(frames));
      identities.push_back(evaluation::identity_of(frames));
      tracks.false_tracks += false_tracks(scored, options_.score);
      for (const EncounterScore& one :
           encounters_of(i, truth(scored), scored, options_.score, options_.manoeuvre_s))
        tracks.encounters.push_back(one);
    }
    tracks.hota = evaluation::combined(hotas);
    tracks.clear = evaluation::combined(clears);
    tracks.identity = evaluation::combined(identities);
    tracks.false_tracks_per_hour =
        hours_ > 0 ? static_cast<double>(tracks.false_tracks) / hours_ : 0;
    tracks.declarations = summarised(tracks.encounters, {});
    if (options_.is_weighted)
      tracks.weighted_declarations = summarised(tracks.encounters, weights_);
    tracks.operating_curve = operating_curve(result_.sequences, truths_);
  }

  void score_at_point(double score) {
    std::vector<AircraftInFrame> sightings;
    std::vector<measures::BearingSample> samples;
    for (std::size_t i = 0; i < result_.sequences.size(); ++i) {
      const ScoredDetections& scored = result_.sequences[i];
      const TruthSequence& of = truth(scored);
      each_aircraft(of, scored, [&](std::size_t f, std::size_t k, const results::Detection* best) {
        const bool is_found = best != nullptr && best->score >= score;
        sightings.push_back({i, f, k, is_found});
        if (!is_found || !of.lens) return;
        auto sample = sample_of(*of.lens, of.frames[f].objects[k], best->box_px);
        if (!sample) return;
        sample->sequence = i;
        sample->time_s = of.frames[f].time_s;
        samples.push_back(*sample);
      });
      append(result_.false_alarms, false_alarms_of(i, of, scored, score));
      append(result_.misses, misses_of(i, of, scored, score));
    }
    result_.bearing = measures::bearing_error(samples);
    if (!weights_.empty()) {
      statistics::TrialsBySequence trials;
      for (const AircraftInFrame& one : sightings) trials.add(one.sequence, one.is_detected);
      result_.weighted_detection = trials.proportion(weights_);
    }
    result_.false_alarms = strongest(std::move(result_.false_alarms), backgrounds_);
    result_.misses = easiest(std::move(result_.misses));
    break_down(sightings);
    count_false_alarms(score);
  }

  template <typename T>
  static void append(std::vector<T>& to, std::vector<T> from) {
    to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
  }

  void break_down(const std::vector<AircraftInFrame>& sightings) {
    for (const Quantity& quantity : quantities()) {
      std::vector<std::optional<Place>> places;
      for (const AircraftInFrame& sighting : sightings) {
        const TruthSequence& of = truth(result_.sequences[sighting.sequence]);
        places.push_back(quantity.place_of(of, of.frames[sighting.frame].objects[sighting.object]));
      }
      std::vector<DetectionBin> bins = detection_by(sightings, places, weights_);
      if (!bins.empty()) result_.by[quantity.key] = std::move(bins);
    }
  }

  void count_false_alarms(double score) {
    std::map<std::string, statistics::TrialsBySequence> mistaken;
    for (std::size_t s = 0; s < result_.sequences.size(); ++s) {
      const ScoredDetections& scored = result_.sequences[s];
      std::set<std::pair<std::size_t, std::int64_t>> hit;  // frame and object
      scored.each([&](std::size_t i, const results::Detection& detection, const Match& match) {
        if (match.kind != MatchKind::kFalseAlarm || detection.score < score) return;
        ++result_.false_alarms_by[match.what];
        if (match.object) hit.emplace(i, *match.object);
      });
      for (std::size_t i = 0; i < scored.matches.size(); ++i)
        for (const TruthObject& object : truth(scored).frames[i].objects)
          if (!object.is_aircraft())
            mistaken[object.object_class].add(s, hit.contains({i, object.id}));
    }
    for (const auto& [what, trials] : mistaken) result_.mistaken_by[what] = trials.proportion();
  }

  void score_speed() {
    std::vector<double> rates;
    for (const ScoredDetections& scored : result_.sequences)
      for (const double seconds : scored.detections.seconds)
        if (seconds > 0) rates.push_back(1 / seconds);
    if (!rates.empty()) result_.frames_per_second_median = median_between(std::move(rates));
  }

  DetectorScore& result_;
  std::span<const TruthSequence> truths_;
  const ScoreOptions& options_;
  double hours_ = 0;
  // Of the sequences, as `weighted` measures take them; empty: they have none.
  std::vector<double> weights_;
  std::vector<std::string> backgrounds_;
  bool has_tracks_;
};

}  // namespace

evaluation::FrocSequence froc_sequence_of(const TruthSequence& truth,
                                          const ScoredDetections& scored) {
  evaluation::FrocSequence sequence;
  sequence.images = std::ssize(scored.matches);
  sequence.duration_s = truth.duration_s;
  each_aircraft(truth, scored, [&](std::size_t, std::size_t, const results::Detection* best) {
    sequence.best_scores.push_back(best == nullptr ? std::nullopt : std::optional(best->score));
  });
  scored.each([&](std::size_t, const results::Detection& detection, const Match& match) {
    if (match.kind == MatchKind::kFalseAlarm)
      sequence.false_alarm_scores.push_back(detection.score);
  });
  return sequence;
}

DetectorScore score_detector(std::string name,
                             std::vector<ScoredDetections> sequences,
                             bool is_associated,
                             std::span<const TruthSequence> truths,
                             const ScoreOptions& options) {
  DetectorScore result;
  result.name = std::move(name);
  result.sequences = std::move(sequences);
  Scoring(result, is_associated, truths, options).score();
  return result;
}

}  // namespace airtruth::scores
