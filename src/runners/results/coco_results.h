// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "runners/results/results_folder.h"

// COCO's results format (cocodataset.org, "TrackerResults format"): a list of {image_id,
// category_id, bbox, score}; bbox is [x, y, width, height] with the first pixel at 0. Or a whole
// COCO file whose annotations each have a score.
namespace airtruth::results {

// Writes COCO results of `sequences` to a file. Categories are numbered from 1 in alphabetical
// order; `set` gives the image ids, as read_detections() takes them. The sequences are read from
// `folder` one at a time; a sequence of the set that is not in the folder has no results.
void write_coco_results(const fs::path& file,
                        const fs::path& folder,
                        std::span<const ExpectedSequence> set);

// Throws Error as read_detections does.
std::vector<SequenceDetections> read_coco_results(const fs::path& file,
                                                  std::span<const ExpectedSequence> set);

}  // namespace airtruth::results
