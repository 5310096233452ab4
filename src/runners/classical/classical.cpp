// SPDX-License-Identifier: Apache-2.0
#include "runners/classical/classical.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace airtruth::classical {
namespace {

struct Kind {
  const char* name;
  std::unique_ptr<detector::Detector> (*make)();
};

constexpr Kind kKinds[] = {{"cmo", make_close_minus_open},
                           {"cmo-hmm", make_hidden_markov},
                           {"frame-difference", make_frame_difference}};

}  // namespace

results::Detection detection_of(const Box& box_px, double score) {
  return {.box_px = box_px, .score = std::round(score * 1000) / 1000};
}

std::vector<results::Detection> detections_of(std::vector<Blob> blobs, double least) {
  std::ranges::stable_sort(blobs, std::greater(), &Blob::contrast_to_noise);
  std::vector<results::Detection> detections;
  std::vector<double> against_ring;  // of the blobs whose boxes the detections have
  for (const Blob& blob : blobs) {
    if (blob.contrast_to_noise < least) break;
    const auto same =
        std::find_if(detections.begin(), detections.end(), [&](const results::Detection& stronger) {
          return is_same_object(stronger.box_px, blob.box_px);
        });
    if (same != detections.end()) {
      double& best = against_ring[static_cast<std::size_t>(same - detections.begin())];
      if (blob.against_ring <= best) continue;
      best = blob.against_ring;
      same->box_px = blob.box_px;
      continue;
    }
    detections.push_back(detection_of(blob.box_px, blob.contrast_to_noise));
    against_ring.push_back(blob.against_ring);
  }
  return detections;
}

double confident_deviations(double samples_per_frame, double frame_rate_hz) {
  const double rate = frame_rate_hz > 0 ? frame_rate_hz : kUsualRateHz;
  const double expected = kNoiseAlarmsPerHour / (3600 * rate);
  double low = 0, high = 40;
  for (int halving = 0; halving < 60; ++halving) {
    const double z = (low + high) / 2;
    // 2 Q(z) = erfc(z / sqrt(2))
    (samples_per_frame * std::erfc(z / std::sqrt(2.0)) > expected ? low : high) = z;
  }
  return high;
}

double confident_log_ratio(double cells_per_frame, double frame_rate_hz) {
  const double rate = frame_rate_hz > 0 ? frame_rate_hz : kUsualRateHz;
  return std::log(std::max(1.0, cells_per_frame) * 3600 * rate / kNoiseAlarmsPerHour);
}

std::vector<std::string> classical_names() {
  std::vector<std::string> names;
  for (const Kind& kind : kKinds) names.emplace_back(kind.name);
  return names;
}

std::unique_ptr<detector::Detector> make_classical(std::string_view name) {
  for (const Kind& kind : kKinds)
    if (kind.name == name) return kind.make();
  return nullptr;
}

}  // namespace airtruth::classical
