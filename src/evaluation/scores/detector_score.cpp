// SPDX-License-Identifier: Apache-2.0
#include "evaluation/scores/detector_score.h"

#include <algorithm>
#include <set>
#include <utility>

#include "evaluation/scores/measure_inputs.h"
#include "foundation/base/median.h"

namespace airtruth::scores {
namespace {

// The measures at work, one function for each part of DetectorScore.
class Scoring {
 public:
  Scoring(DetectorScore& result, std::span<const TruthSequence> truths, const ScoreOptions& options)
      : result_(result), truths_(truths), options_(options) {
    for (ScoredDetections& scored : result_.sequences) {
      scored.matches = matches_of(scored.detections, truth(scored), options.centre_px);
      hours_ += truth(scored).duration_s / measures::kSecondsPerHour;
      for (const auto& frame : scored.detections.frames)
        for (const results::Detection& detection : frame) {
          ++result_.detections;
          has_tracks_ = has_tracks_ || detection.track;
        }
    }
  }

  void score() {
    score_precision();
    score_froc();
    score_aot();
    if (has_tracks_) score_tracks();
    if (result_.point) score_at_point(result_.point->score);
    score_speed();
  }

 private:
  const TruthSequence& truth(const ScoredDetections& scored) const { return truths_[scored.truth]; }

  void score_precision() {
    std::vector<std::vector<measures::ScoredImage>> images;
    for (const ScoredDetections& scored : result_.sequences)
      images.push_back(images_of(truth(scored), scored));
    result_.average_precision = average_precision(images, options_.centre_px);
  }

  void score_froc() {
    std::vector<measures::FrocSequence> sequences;
    for (const ScoredDetections& scored : result_.sequences)
      sequences.push_back(froc_sequence_of(truth(scored), scored));
    result_.froc = measures::froc_of(sequences);
    if (result_.froc.points.empty()) return;
    // Where the best detection is a false alarm and one is too many, the point is that of its
    // score.
    const double score =
        options_.point.score
            ? *options_.point.score
            : measures::score_at_false_alarms(sequences, options_.point.false_alarms_per_image)
                  .value_or(result_.froc.points.front().score);
    result_.point = measures::froc_at(sequences, score);
  }

  void score_aot() {
    std::vector<measures::AotFlight> flights;
    for (const ScoredDetections& scored : result_.sequences)
      flights.push_back(aot_flight_of(truth(scored), scored));
    result_.aot = measures::aot_score(flights, {{}, hours_, 0});
    result_.aot_ranks = measures::aot_ranks(flights, hours_);
  }

  void score_tracks() {
    TrackScores& tracks = result_.tracks.emplace();
    std::vector<measures::Hota> hotas;
    std::vector<measures::ClearMot> clears;
    std::vector<measures::Identity> identities;
    for (std::size_t i = 0; i < result_.sequences.size(); ++i) {
      const ScoredDetections& scored = result_.sequences[i];
      const measures::TrackFrames frames =
          track_frames_of(truth(scored), scored, options_.point.score);
      hotas.push_back(measures::hota_of(frames));
      clears.push_back(measures::clear_mot_of(frames));
      identities.push_back(measures::identity_of(frames));
      tracks.false_tracks += false_tracks(scored, options_.point.score);
      for (const EncounterScore& one :
           encounters_of(i, truth(scored), scored, options_.point.score, options_.manoeuvre_s))
        tracks.encounters.push_back(one);
    }
    tracks.hota = measures::combined(hotas);
    tracks.clear = measures::combined(clears);
    tracks.identity = measures::combined(identities);
    tracks.false_tracks_per_hour =
        hours_ > 0 ? static_cast<double>(tracks.false_tracks) / hours_ : 0;
    tracks.declarations = summarised(tracks.encounters, {});
    if (options_.is_weighted)
      tracks.weighted_declarations = summarised(tracks.encounters, weights_of_sequences());
    tracks.operating_curve = operating_curve(result_.sequences, truths_);
  }

  void score_at_point(double score) {
    std::vector<AircraftInFrame> sightings;
    std::vector<measures::BearingSample> samples;
    for (std::size_t i = 0; i < result_.sequences.size(); ++i) {
      const ScoredDetections& scored = result_.sequences[i];
      const TruthSequence& of = truth(scored);
      append(sightings, sightings_of(i, of, scored, score));
      append(samples, bearing_samples_of(i, of, scored, score));
      append(result_.false_alarms, false_alarms_of(i, of, scored, score));
      append(result_.misses, misses_of(i, of, scored, score));
    }
    result_.bearing = measures::bearing_error(samples);
    const std::vector<double> weights =
        options_.is_weighted ? weights_of_sequences() : std::vector<double>{};
    if (!weights.empty()) {
      statistics::TrialsBySequence trials;
      for (const AircraftInFrame& one : sightings) trials.add(one.sequence, one.is_detected);
      result_.weighted_detection = trials.proportion(weights);
    }
    result_.false_alarms = strongest(std::move(result_.false_alarms), backgrounds());
    result_.misses = easiest(std::move(result_.misses));
    break_down(sightings, weights);
    count_false_alarms(score);
  }

  std::vector<double> weights_of_sequences() const {
    std::vector<double> weights;
    for (const ScoredDetections& scored : result_.sequences)
      weights.push_back(truth(scored).weight);
    return weights;
  }

  std::vector<std::string> backgrounds() const {
    std::vector<std::string> names;
    for (const ScoredDetections& scored : result_.sequences)
      names.push_back(truth(scored).background_cut);
    return names;
  }

  template <typename T>
  static void append(std::vector<T>& to, std::vector<T> from) {
    to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
  }

  void break_down(const std::vector<AircraftInFrame>& sightings, std::span<const double> weights) {
    for (const Quantity& quantity : quantities()) {
      std::vector<std::optional<double>> values;
      std::vector<std::optional<std::string>> names;
      for (const AircraftInFrame& sighting : sightings) {
        const TruthSequence& of = truth(result_.sequences[sighting.sequence]);
        const TruthObject& object = of.frames[sighting.frame].objects[sighting.object];
        if (quantity.edges.empty())
          names.push_back(quantity.name_of(of, object));
        else
          values.push_back(quantity.value_of(object));
      }
      std::vector<DetectionBin> bins =
          quantity.edges.empty() ? detection_by_name(sightings, names, weights)
                                 : detection_by(sightings, values, quantity.edges, weights);
      if (!bins.empty()) result_.by[quantity.key] = std::move(bins);
    }
  }

  void count_false_alarms(double score) {
    std::map<std::string, statistics::TrialsBySequence> mistaken;
    for (std::size_t s = 0; s < result_.sequences.size(); ++s) {
      const ScoredDetections& scored = result_.sequences[s];
      for (std::size_t i = 0; i < scored.matches.size(); ++i) {
        std::set<std::int64_t> hit;
        for (std::size_t k = 0; k < scored.matches[i].size(); ++k) {
          const Match& match = scored.matches[i][k];
          if (match.kind != MatchKind::kFalseAlarm || scored.detections.frames[i][k].score < score)
            continue;
          ++result_.false_alarms_by[match.what];
          if (match.object) hit.insert(*match.object);
        }
        for (const TruthObject& object : truth(scored).frames[i].objects) {
          if (object.is_aircraft()) continue;
          mistaken[object.object_class].add(s, hit.contains(object.id));
        }
      }
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
  bool has_tracks_ = false;
};

}  // namespace

DetectorScore score_detector(std::string name,
                             std::vector<ScoredDetections> sequences,
                             std::span<const TruthSequence> truths,
                             const ScoreOptions& options) {
  DetectorScore result;
  result.name = std::move(name);
  result.sequences = std::move(sequences);
  Scoring(result, truths, options).score();
  return result;
}

}  // namespace airtruth::scores
