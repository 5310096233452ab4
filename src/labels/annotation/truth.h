// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <airtruth/truth.h>

#include "camera/lens/lens.h"
#include "foundation/base/names.h"
#include "foundation/geometry/within_frame.h"

namespace airtruth {

constexpr auto enum_names(IntruderState) {
  return std::to_array<EnumName<IntruderState>>({{IntruderState::kVisible, "visible"},
                                                 {IntruderState::kHidden, "hidden"},
                                                 {IntruderState::kOutside, "outside"},
                                                 {IntruderState::kBehind, "behind"},
                                                 {IntruderState::kEnded, "ended"}});
}

}  // namespace airtruth

// The file truth.jsonl (docs/formats/truth.md, docs/formats/truth.schema.json) of the truth of
// <airtruth/truth.h>.
namespace airtruth::annotation {

using State = IntruderState;
using airtruth::EncounterTruth;
using airtruth::VolumeTruth;
using Intruder = IntruderTruth;
using Frame = FrameTruth;

// The box that marks an intruder for a viewer: its covered box, or the visible box where no pixel
// reaches the covered box's alpha. Empty where the intruder is not visible.
inline std::optional<PixelBox> box_to_show(const Intruder& intruder) {
  return intruder.covered_box_px ? intruder.covered_box_px : intruder.visible_box_px;
}

// The measured shake of a frame.
Shake shake_of(const Frame& frame);
void take_shake(const Shake& shake, Frame& frame);

// True where the intruder's reference point lies in the picture. The answer follows from its
// position through the stated lens and motion alone, without any pixel or box.
bool is_in_view(const Frame& frame, const Intruder& intruder, const lens::Lens& lens);

// True where the intruder is in view, nothing hides it, and the truth holds no box for it.
bool lacks_box(const Frame& frame, const Intruder& intruder, const lens::Lens& lens);

// One line of truth.jsonl, without the newline. Each number is the shortest text that parses to the
// same double. NaN and infinity fail a check().
std::string jsonl_line(const Frame& frame, const lens::Facts& lens);

// Parses such a line. Errors carry file and line.
Frame parse_jsonl_line(std::string_view line, const std::filesystem::path& file, int line_number);
// Line n of the file is frame n - 1.
struct Truth {
  lens::Facts lens;
  std::vector<Frame> frames;
};
Truth read_truth(const std::filesystem::path& file);

// Describes the first inconsistency of a frame's truth; empty where it is consistent. The rules
// are: a visible box is present exactly where the intruder is visible, a position is present
// exactly where it is in the world, and fractions lie within 0..1.
std::optional<std::string> fault(const Frame& frame);

}  // namespace airtruth::annotation
