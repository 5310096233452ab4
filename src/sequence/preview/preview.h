// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "foundation/image/picture.h"
#include "scene/scene/scene.h"
#include "sequence/pipeline/options.h"
#include "sequence/preview/rows.h"

// A look at a scene before it is rendered: where the intruders will be, how large and how far, on a
// few frames of the clip.
namespace airtruth::preview {

struct Preview {
  // The paths over one frame with the intruder drawn at each whole second; beside it plan, height,
  // frames of single moments, and the rows as a table.
  image::Rgb8 picture;
  std::vector<PreviewRow> rows;
  // The closest approach of each intruder or flock in words, one line each.
  std::vector<std::string> approaches;
  // As those of the resolved scene (sequence/pipeline/resolved_scene.h).
  std::vector<std::string> notes;
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
Preview preview_of(const scene::Scene& scene, const pipeline::Options& options);

}  // namespace airtruth::preview
