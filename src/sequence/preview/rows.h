// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "sequence/preview/preview.h"
#include "sequence/setup/world.h"

namespace airtruth::sequence {

// Whole seconds of a clip, at most 60 of them: where the clip is longer they are further apart.
std::vector<double> whole_seconds(double duration_s);

// Every intruder at every one of the times at which it is in the world.
std::vector<PreviewRow> preview_rows(const World& world,
                                     const std::vector<double>& times_s,
                                     const std::function<Moment(double time_s)>& moment_at_time);

// "b737: closest 61 m (60 right, 11 above) at 8.00 s", and where it never comes into view how near
// it comes to it.
std::vector<std::string> approach_lines(const World& world,
                                        const std::vector<PreviewRow>& rows,
                                        double duration_s);

std::vector<std::string> table_heading();
std::vector<std::string> table_cells(const PreviewRow& row);

}  // namespace airtruth::sequence
