// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <airtruth/metrics.h>

#include "camera/lens/lens.h"
#include "evaluation/statistics/bins.h"

// The quality of a tracker's answer frame by frame, and the frame where it lost its target.
namespace airtruth::measures {

// The result of one frame that shows the target, after the first frame.
struct Outcome {
  // Index of the frame's pair.
  std::size_t frame = 0;
  // 0 where there is no answer.
  double overlap = 0;
  // Distance of the answer's centre from the truth's, and the same with X divided by the truth's
  // width and Y by its height; empty where there is no answer.
  std::optional<double> centre_px;
  std::optional<double> normalised;
  // Angle between the rays to the two centres; empty without an answer or a lens.
  std::optional<double> angle_mrad;
};

// `lens` may be null.
std::vector<Outcome> outcomes(std::span<const evaluation::FramePair> frames,
                              const lens::Lens* lens);

// Mean values of the outcomes in one bin; errors are those of the frames that have one.
struct Bin {
  statistics::Place place;
  std::int64_t frames = 0;
  double overlap = 0;
  // Share of frames with an overlap of more than 0.5.
  double success_50 = 0;
  // Share of frames with a centre error of at most 20 px.
  double precision_20px = 0;
  std::optional<double> centre_px;
  std::optional<double> normalised;
  std::optional<double> angle_mrad;
};

// Groups the outcomes. places[i] belongs to outcomes[i]; one without a place is in no bin. Bins are
// in the order of their places; those without frames are omitted.
std::vector<Bin> breakdown(std::span<const Outcome> outcomes,
                           std::span<const std::optional<statistics::Place>> places);
Bin mean_of(std::span<const Outcome> outcomes);

}  // namespace airtruth::measures
