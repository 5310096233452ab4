// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>

#include <airtruth/dataset.h>
#include <airtruth/labels.h>

#include "foundation/base/names.h"
#include "labels/annotation/truth.h"

namespace airtruth::dataset {

constexpr auto enum_names(Boxes) {
  return std::to_array<EnumName<Boxes>>(
      {{Boxes::kCovered, "covered"}, {Boxes::kExact, "exact"}, {Boxes::kVisible, "visible"}});
}

}  // namespace airtruth::dataset

// The truth of a rendered sequence as labels. Needs neither the scene nor the video.
namespace airtruth::sequences {

// The type of an aircraft of the list ("738/738-Ryanair" gives "738"), or the name of a model file
// without its extension.
std::string category_of(const std::string& aircraft);

// The category of an intruder's labels: that of its aircraft, and for a distractor its class.
std::string category_of(const annotation::Intruder& intruder);

// The labels of one frame of a picture of this size: one for each intruder that is visible and has
// the requested box. The track is the intruder's number in the scene, from 1.
exchange::LabelledFrame labels_of(const annotation::Frame& truth,
                                  dataset::Boxes boxes,
                                  int width,
                                  int height);

}  // namespace airtruth::sequences
