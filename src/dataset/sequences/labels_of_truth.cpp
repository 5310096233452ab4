// SPDX-License-Identifier: Apache-2.0
#include "dataset/sequences/labels_of_truth.h"

#include <algorithm>
#include <filesystem>

#include "foundation/geometry/box.h"
#include "foundation/geometry/horizon_dip.h"
#include "foundation/geometry/transform.h"
#include "labels/annotation/object_class.h"

namespace airtruth::sequences {
namespace {

std::optional<Box> box_of(const annotation::Intruder& intruder,
                          dataset::Boxes boxes,
                          const Box& frame) {
  if (intruder.state != annotation::State::kVisible) return std::nullopt;
  if (boxes != dataset::Boxes::kExact) {
    const auto& box =
        boxes == dataset::Boxes::kVisible ? intruder.visible_box_px : intruder.covered_box_px;
    return box ? std::optional(as_box(*box)) : std::nullopt;
  }
  return intruder.exact_box_px ? intersection(*intruder.exact_box_px, frame) : std::nullopt;
}

exchange::Label label_of(const annotation::Intruder& intruder,
                         const annotation::Frame& frame,
                         std::int64_t track,
                         const Box& box) {
  exchange::Label label;
  label.track = track;
  label.category = category_of(intruder);
  label.object_class = intruder.object_class;
  label.box_px = box;
  const double hidden = intruder.hidden_by_own_aircraft + intruder.hidden_by_occluder.value_or(0) +
                        intruder.hidden_by_intruder;
  label.visible = std::clamp(1 - hidden - intruder.cut_by_frame, 0.0, 1.0);
  label.occluded = hidden > 0;
  label.truncated = intruder.cut_by_frame > 0;
  label.range_m = intruder.range_m;
  label.contrast_to_noise = intruder.contrast_to_noise;
  if (intruder.covered_area_px) label.area_px = static_cast<double>(*intruder.covered_area_px);
  if (intruder.position_ned_m)
    label.above_horizon = above_horizon_rad(vector_of(*intruder.position_ned_m),
                                            vector_of(frame.camera_position_ned_m)) > 0;
  return label;
}

}  // namespace

std::string category_of(const std::string& aircraft) {
  const std::filesystem::path path(aircraft);
  if (path.has_extension()) return path.stem().string();
  return aircraft.substr(0, aircraft.find('/'));
}

std::string category_of(const annotation::Intruder& intruder) {
  return annotation::is_aircraft(intruder.object_class) ? category_of(intruder.aircraft)
                                                        : intruder.object_class;
}

exchange::LabelledFrame labels_of(const annotation::Frame& truth,
                                  dataset::Boxes boxes,
                                  int width,
                                  int height) {
  const Box picture{0, 0, double(width), double(height)};
  exchange::LabelledFrame frame{truth.frame, truth.time_s, {}};
  for (std::size_t i = 0; i < truth.intruders.size(); ++i) {
    const annotation::Intruder& intruder = truth.intruders[i];
    if (const auto box = box_of(intruder, boxes, picture))
      frame.labels.push_back(label_of(intruder, truth, static_cast<std::int64_t>(i) + 1, *box));
  }
  return frame;
}

}  // namespace airtruth::sequences
