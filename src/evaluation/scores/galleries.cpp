// SPDX-License-Identifier: Apache-2.0
#include "evaluation/scores/galleries.h"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "evaluation/matching/boxes.h"

namespace airtruth::scores {
namespace {

// A group of false alarms that may go on.
struct Group {
  FalseAlarm alarm;
  std::size_t last_frame = 0;
  Box last_px;
};

std::optional<double> nearest_aircraft_px(const Box& box, const TruthFrame& frame) {
  std::optional<double> least;
  for (const TruthObject& object : frame.objects)
    if (object.is_aircraft())
      least = std::min(least.value_or(1e9), matching::centre_distance_px(box, object.box_px));
  return least;
}

// The group that this one goes on with.
Group* group_of(std::vector<Group>& open, std::size_t frame, const Box& box) {
  Group* best = nullptr;
  double least = 0;
  for (Group& group : open) {
    const double reach = std::max(kGalleryReach_px, std::max(box.width, box.height));
    const double distance = matching::centre_distance_px(box, group.last_px);
    if (frame - group.last_frame > kGalleryGap || distance > reach) continue;
    if (best != nullptr && distance >= least) continue;
    best = &group;
    least = distance;
  }
  return best;
}

bool is_stronger(const FalseAlarm& a, const FalseAlarm& b) {
  return std::tuple(-a.score, a.sequence, a.frame, a.detection) <
         std::tuple(-b.score, b.sequence, b.frame, b.detection);
}

// Whether two sequences over one background have the same false alarm: on nothing known, at the
// same time and place.
bool is_repeated(const FalseAlarm& a,
                 const FalseAlarm& b,
                 std::span<const std::string> backgrounds) {
  const std::string& background = backgrounds[a.sequence];
  if (background.empty() || background != backgrounds[b.sequence] || a.sequence == b.sequence)
    return false;
  if (a.object || b.object) return false;
  const std::size_t frames = a.frame > b.frame ? a.frame - b.frame : b.frame - a.frame;
  const double reach = std::max(kGalleryReach_px, std::max(a.box_px.width, a.box_px.height));
  return frames <= kGalleryGap && matching::centre_distance_px(a.box_px, b.box_px) <= reach;
}

bool is_easier(const Miss& a, const Miss& b) {
  const auto ease = [](const Miss& miss) {
    return std::tuple(-miss.contrast_to_noise.value_or(0),
                      -miss.size_px,
                      miss.sequence,
                      miss.first_frame,
                      miss.object);
  };
  return ease(a) < ease(b);
}

}  // namespace

std::vector<FalseAlarm> false_alarms_of(std::size_t sequence,
                                        const TruthSequence& truth,
                                        const ScoredDetections& scored,
                                        double score) {
  std::vector<FalseAlarm> alarms;
  std::vector<Group> open;
  for (std::size_t i = 0; i < scored.matches.size(); ++i) {
    std::erase_if(open, [&](const Group& group) {
      if (i - group.last_frame <= kGalleryGap) return false;
      alarms.push_back(group.alarm);
      return true;
    });
    for (std::size_t k = 0; k < scored.matches[i].size(); ++k) {
      const results::Detection& detection = scored.detections.frames[i][k];
      const Match& match = scored.matches[i][k];
      if (match.kind != MatchKind::kFalseAlarm || detection.score < score) continue;
      Group* group = group_of(open, i, detection.box_px);
      const bool is_new = group == nullptr;
      if (is_new) group = &open.emplace_back();
      FalseAlarm& alarm = group->alarm;
      alarm.frames += is_new || group->last_frame != i ? 1 : 0;
      if (is_new || detection.score > alarm.score) {
        const std::int64_t frames = alarm.frames;
        alarm = {sequence,
                 i,
                 k,
                 detection.score,
                 match.what,
                 match.object,
                 nearest_aircraft_px(detection.box_px, truth.frames[i]),
                 frames,
                 1,
                 detection.box_px};
      }
      group->last_frame = i;
      group->last_px = detection.box_px;
    }
  }
  for (const Group& group : open) alarms.push_back(group.alarm);
  std::sort(alarms.begin(), alarms.end(), is_stronger);
  return alarms;
}

std::vector<Miss> misses_of(std::size_t sequence,
                            const TruthSequence& truth,
                            const ScoredDetections& scored,
                            double score) {
  std::map<std::int64_t, Miss> open;  // that may go on
  std::vector<Miss> misses;
  for (std::size_t i = 0; i < scored.matches.size(); ++i) {
    const auto best = best_of(scored, i);
    const auto is_detected = [&](std::int64_t id) {
      const auto found = best.find(id);
      return found != best.end() && found->second->score >= score;
    };
    std::map<std::int64_t, Miss> going_on;
    for (const TruthObject& object : truth.frames[i].objects) {
      if (!object.is_aircraft() || !object.counts || is_detected(object.id)) continue;
      const auto before = open.extract(object.id);
      const Miss begun{.sequence = sequence, .object = object.id, .first_frame = i};
      Miss& miss = going_on.try_emplace(object.id, before ? before.mapped() : begun).first->second;
      const bool is_better =
          miss.frames == 0 || std::tuple(object.contrast_to_noise.value_or(0), object.size_px()) >
                                  std::tuple(miss.contrast_to_noise.value_or(0), miss.size_px);
      ++miss.frames;
      if (!is_better) continue;
      miss.frame = i;
      miss.box_px = object.box_px;
      miss.range_m = object.range_m;
      miss.contrast_to_noise = object.contrast_to_noise;
      miss.size_px = object.size_px();
    }
    for (const auto& [id, miss] : open) misses.push_back(miss);
    open = std::move(going_on);
  }
  for (const auto& [id, miss] : open) misses.push_back(miss);
  return easiest(std::move(misses));
}

std::vector<FalseAlarm> strongest(std::vector<FalseAlarm> alarms,
                                  std::span<const std::string> backgrounds) {
  std::sort(alarms.begin(), alarms.end(), is_stronger);
  std::vector<FalseAlarm> kept;
  std::vector<std::set<std::size_t>> sequences;
  for (const FalseAlarm& alarm : alarms) {
    const auto same = std::find_if(kept.begin(), kept.end(), [&](const FalseAlarm& other) {
      return is_repeated(alarm, other, backgrounds);
    });
    if (same != kept.end()) {
      sequences[static_cast<std::size_t>(same - kept.begin())].insert(alarm.sequence);
    } else if (kept.size() < kGallerySize) {
      kept.push_back(alarm);
      sequences.push_back({alarm.sequence});
    }
  }
  for (std::size_t i = 0; i < kept.size(); ++i) kept[i].sequences = std::ssize(sequences[i]);
  return kept;
}

std::vector<Miss> easiest(std::vector<Miss> misses) {
  std::sort(misses.begin(), misses.end(), is_easier);
  if (misses.size() > kGallerySize) misses.resize(kGallerySize);
  return misses;
}

}  // namespace airtruth::scores
