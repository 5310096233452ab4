// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "foundation/geometry/box.h"
#include "foundation/image/picture.h"
#include "scene/scene/scene.h"
#include "sequence/sequence/sequence.h"

// A look at a scene before it is rendered: where the intruders will be, how large and how far, on a
// few frames of the clip.
namespace airtruth::sequence {

// An intruder at a whole second of the clip.
struct PreviewRow {
  double time_s = 0;
  std::string intruder;
  // The exact box; empty where the intruder is not in view.
  std::optional<Box> box_px;
  double range_m = 0;
  // From the own course, right positive; empty where the own aircraft hovers.
  std::optional<double> bearing_deg;
  double above_m = 0;
  std::optional<double> closing_mps;
  std::optional<double> tcpa_s;
};

struct Preview {
  // The paths over one frame with the intruder drawn at each whole second; beside it plan, height,
  // frames of single moments, and the rows as a table.
  image::Rgb8 picture;
  std::vector<PreviewRow> rows;
  // The closest approach of each intruder in words, one line each.
  std::vector<std::string> approaches;
  // True where each moment has the camera's measured motion.
  bool has_motion = false;
};

// Decodes only the frames that are shown. Where an earlier run has measured the camera's motion and
// the cache of `options` has it (render(), measure_ahead()), each moment is shown as it will be
// rendered. Else the camera stands at its nominal, unshaken pose, since the motion would take a
// pass over the clip: an intruder is rendered as far from where it is shown as the camera has
// turned from its first frame. Values of the camera model that would be measured are left out.
// Throws Error as render() does for faults of the scene, and Interrupted on options.stop. A path
// that its aircraft cannot fly is a warning.
Preview preview(const scene::Scene& scene, const Options& options);

// The rows as lines of text with a heading.
std::string table_text(const std::vector<PreviewRow>& rows);

}  // namespace airtruth::sequence
