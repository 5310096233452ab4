// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "aircraft/mesh.h"
#include "comparison/comparison.h"
#include "lens/lens.h"

namespace airtruth::comparison {

// A path file (trajectory::read_path_file) on which an aircraft of that mesh keeps beside the real
// one, as large as it, in the view of a camera that stands at the origin and looks north. Rows
// begin at the first box's frame, time 0. Error where there is no room beside it.
std::string path_beside(const RealBoxes& boxes,
                        const aircraft::Mesh& mesh,
                        const YawPitchRoll& attitude,
                        const lens::Lens& lens,
                        double frame_rate_hz);

}  // namespace airtruth::comparison
