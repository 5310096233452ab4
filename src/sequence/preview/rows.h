// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "encounter/separation/measures.h"
#include "foundation/geometry/box.h"
#include "scene/scene/scene.h"
#include "sequence/setup/moment.h"
#include "sequence/setup/world.h"

namespace airtruth::preview {

// What the preview shows as one: an intruder, or a flock, whose members one table [[distractor]]
// states.
struct Party {
  std::string name;  // "b737"; "bird-1 (40)"
  // Numbers of its actors in the world.
  std::vector<std::size_t> actors;
  // The one of them that is nearest to their middle: its path stands for all.
  std::size_t middle = 0;
};
std::vector<Party> parties_of(const scene::Scene& scene);

// A party at a whole second of the clip.
struct PreviewRow {
  double time_s = 0;
  std::size_t party = 0;
  std::string intruder;  // its name
  // The exact box, of a flock around those in view; empty where none is in view. Of what reaches
  // behind the camera's plane, which has no bounds, the place of its reference point.
  std::optional<Box> box_px;
  separation::Measures nearest;  // of the nearest one
};

// Whole seconds of a clip, at most 60 of them: where the clip is longer they are further apart.
std::vector<double> whole_seconds(double duration_s);

// Every party at every one of the times at which it is in the world.
std::vector<PreviewRow> preview_rows(
    const setup::World& world,
    const std::vector<Party>& parties,
    const std::vector<double>& times_s,
    const std::function<setup::Moment(double time_s)>& moment_at_time);

// "b737: closest 61 m (60 right, 11 above) at 8.00 s", and where it never comes into view how near
// it comes to it. Of a flock, the nearest member's. `seen`: the parties that are ever in view.
std::vector<std::string> approach_lines(const setup::World& world,
                                        const std::vector<Party>& parties,
                                        const std::set<std::size_t>& seen,
                                        double duration_s);

// The horizontal view between the middles of the left and the right edge.
double view_deg(const setup::World& world);

std::vector<std::string> table_heading();
std::vector<std::string> table_cells(const PreviewRow& row);

// The rows as lines of text with a heading.
std::string table_text(const std::vector<PreviewRow>& rows);

}  // namespace airtruth::preview
