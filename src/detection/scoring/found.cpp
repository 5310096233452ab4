// SPDX-License-Identifier: Apache-2.0
#include "detection/scoring/found.h"

#include <algorithm>
#include <cmath>

#include "labels/annotation/object_class.h"

namespace airtruth::detection {
namespace {

// The nearest object within its radius, of those that `which` selects.
template <typename Which>
const TruthObject* nearest(const Box& detection_px,
                           const TruthFrame& truth,
                           double centre_px,
                           Which which) {
  const TruthObject* best = nullptr;
  double least = 0;
  for (const TruthObject& object : truth.objects) {
    if (!which(object)) continue;
    const double distance = centre_distance_px(detection_px, object.box_px);
    if (distance > found_radius_px(object.box_px, centre_px)) continue;
    if (best != nullptr && distance >= least) continue;
    best = &object;
    least = distance;
  }
  return best;
}

}  // namespace

double centre_distance_px(const Box& a, const Box& b) {
  return std::hypot(a.x + a.width / 2 - b.x - b.width / 2, a.y + a.height / 2 - b.y - b.height / 2);
}

double found_radius_px(const Box& truth_px, double centre_px) {
  return std::max(centre_px, std::max(truth_px.width, truth_px.height) / 2);
}

bool centre_is_in(const Box& detection_px, const Box& region_px) {
  const double x = detection_px.x + detection_px.width / 2;
  const double y = detection_px.y + detection_px.height / 2;
  return x >= region_px.x && y >= region_px.y && x < region_px.right() && y < region_px.bottom();
}

Verdict verdict_of(const Box& detection_px, const TruthFrame& truth, double centre_px) {
  const auto found = [&](auto which) { return nearest(detection_px, truth, centre_px, which); };
  if (const auto* object = found([](const auto& o) { return o.is_aircraft() && o.counts; }))
    return {Fate::kFound, object->id, object->object_class};
  if (const auto* object = found([](const auto& o) { return o.is_aircraft() && !o.counts; }))
    return {Fate::kIgnored, object->id, object->object_class};
  for (const Box& region : truth.ignored_px)
    if (centre_is_in(detection_px, region)) return {Fate::kIgnored, {}, "ignore"};
  if (const auto* object = found([](const auto& o) { return !o.is_aircraft(); }))
    return {Fate::kFalseAlarm, object->id, object->object_class};
  return {Fate::kFalseAlarm, {}, kBackground};
}

bool claims_aircraft(const std::string& category) {
  return annotation::is_aircraft(category) ||
         (!annotation::is_object_class(category) && category != "ignore");
}

std::vector<std::vector<Verdict>> verdicts_of(const SequenceDetections& detections,
                                              const TruthSequence& truth,
                                              double centre_px) {
  std::vector<std::vector<Verdict>> verdicts;
  const std::size_t frames = std::min(detections.frames.size(), truth.frames.size());
  for (std::size_t i = 0; i < frames; ++i) {
    std::vector<Verdict>& of_frame = verdicts.emplace_back();
    for (const Detection& detection : detections.frames[i])
      of_frame.push_back(claims_aircraft(detection.category)
                             ? verdict_of(detection.box_px, truth.frames[i], centre_px)
                             : Verdict{Fate::kIgnored, {}, detection.category});
  }
  return verdicts;
}

}  // namespace airtruth::detection
