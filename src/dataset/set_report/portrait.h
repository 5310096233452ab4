// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "dataset/labelled/labelled_set.h"
#include "dataset/set_report/film.h"
#include "picture/video/reader.h"
#include "scene/scene/scene.h"
#include "sequence/replay/finished.h"

namespace airtruth::set_report {

// What the report page and the data card count of one sequence, and its pictures.
struct Portrait {
  labelled::ClipFacts facts;
  video::StreamInfo info;
  std::optional<scene::Scene> scene;  // the effective scene; empty for an imported clip
  // In the order of the scene; empty for an imported clip.
  std::vector<pipeline::EncounterRecord> encounters;
  // Frames of aircraft with the state visible, hidden, outside, behind and ended, in this order.
  std::array<std::int64_t, 5> frames_by_state{};
  // Number of these visible states that have a covered box.
  std::int64_t covered_boxes = 0;
  // Number of states that are in view by geometry and have no box (labels/annotation/truth.h).
  std::int64_t without_box = 0;
  // Frames that show an aircraft, with a label or without.
  std::int64_t frames_with_intruder = 0;
  // The least and the greatest of all frames that show an aircraft: its range, and the longer side
  // of its box.
  using Ends = std::optional<std::pair<double, double>>;
  Ends range_m;
  Ends size_px;
  Film film;
};

// `finished`: the sequence of that name. `stills` is the highest number of pictures in its film; 0:
// no film, and no frame is decoded.
Portrait portrait_of(const labelled::LabelledSet& set,
                     const std::string& name,
                     const replay::Finished& finished,
                     std::size_t stills,
                     const std::stop_token& stop);

}  // namespace airtruth::set_report
