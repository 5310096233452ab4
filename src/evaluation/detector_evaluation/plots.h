// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "evaluation/report/plots.h"
#include "evaluation/scores/detector_score.h"
#include "show/plot/plot.h"

namespace airtruth::detector_evaluation {

// The plots of an assessment for its page and for papers. A detector has the same style in all
// (style_of its place). Bands and whiskers are the 95 % intervals. Those without data are left out.
//
//   precision     precision by recall, at the distance of centres
//   precision_50  the same at an overlap of 0.5
//   froc          probability of detection by false alarms an image, logarithmic
//   froc_hour     by false alarms an hour
//   operating     mean declaration range by false tracks an hour (the system operating curve)
//   declared      share of encounters declared by false tracks an hour
//   by_KEY        probability of detection at the operating point, for each key of quantities()
//   false_alarms  false alarms at the operating point by what they are
//   mistaken      share of the frames of other objects that raise one, by class
std::vector<report::NamedPlot> detection_plots(const scores::Assessment& assessment);

// Average precision at the centre distance.
plot::Plot ranking_plot(const scores::Assessment& assessment);

}  // namespace airtruth::detector_evaluation
