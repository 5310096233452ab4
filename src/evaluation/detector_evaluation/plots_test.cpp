// SPDX-License-Identifier: Apache-2.0
#include "evaluation/detector_evaluation/plots.h"

#include <gtest/gtest.h>

namespace airtruth::detector_evaluation {
namespace {

const plot::Plot* plot_named(const std::vector<report::NamedPlot>& plots, const std::string& name) {
  for (const report::NamedPlot& one : plots)
    if (one.name == name) return &one.plot;
  return nullptr;
}

statistics::Proportion share(double value, double low, double high) {
  return {value, low, high, 1, 2, 3};
}

// Two detectors: one with a FROC of two points in 100 images, the other without a detection.
scores::Assessment two_detectors() {
  scores::Assessment assessment;
  assessment.detectors.resize(2);
  scores::DetectorScore& first = assessment.detectors[0];
  first.name = "first";
  first.froc.images = 100;
  first.froc.points = {{9, share(0.4, 0.3, 0.5), 0, 0, 0}, {5, share(0.8, 0.7, 0.9), 0.2, 0, 0}};
  scores::DetectionBin near, far;
  near.place = {0, 100}, near.detection = share(0.9, 0.8, 1);
  far.place.from = 200, far.detection = share(0.1, 0, 0.2);  // 200 and more
  first.by["range_m"] = {near, far};
  first.false_alarms_by = {{"background", 7}, {"bird", 2}};
  assessment.detectors[1].name = "second";
  scores::DetectionBin middle;
  middle.place = {100, 200}, middle.detection = share(0.5, 0.4, 0.6);
  assessment.detectors[1].by["range_m"] = {middle};
  assessment.detectors[1].false_alarms_by = {{"balloon", 1}};
  return assessment;
}

TEST(DetectionPlots, NoFalseAlarmIsDrawnAtHalfOfOne) {
  const auto plots = detection_plots(two_detectors());
  const plot::Plot* froc = plot_named(plots, "froc");
  ASSERT_NE(froc, nullptr);
  EXPECT_TRUE(froc->x.is_logarithmic);
  ASSERT_EQ(froc->series.size(), 1u);
  EXPECT_EQ(froc->series[0].x, (std::vector<double>{0.005, 0.2}));
  EXPECT_EQ(froc->series[0].y, (std::vector<double>{0.4, 0.8}));
  EXPECT_EQ(froc->series[0].low, (std::vector<double>{0.3, 0.7}));
  EXPECT_EQ(froc->series[0].high, (std::vector<double>{0.5, 0.9}));
  // Without hours and tracks there is nothing by the hour.
  for (const char* name : {"froc_hour", "operating", "declared", "precision", "mistaken"})
    EXPECT_EQ(plot_named(plots, name), nullptr) << name;
}

TEST(DetectionPlots, BinsOfAllDetectorsShareTheirPlaces) {
  const auto plots = detection_plots(two_detectors());
  const plot::Plot* by_range = plot_named(plots, "by_range_m");
  ASSERT_NE(by_range, nullptr);
  EXPECT_EQ(by_range->x.names, (std::vector<std::string>{"0–100 (2)", "100–200 (2)", "≥ 200 (2)"}));
  ASSERT_EQ(by_range->series.size(), 2u);
  EXPECT_EQ(by_range->series[0].x, (std::vector<double>{0, 2}));
  EXPECT_EQ(by_range->series[1].x, (std::vector<double>{1}));
  const plot::Plot* alarms = plot_named(plots, "false_alarms");
  ASSERT_NE(alarms, nullptr);
  EXPECT_EQ(alarms->x.names, (std::vector<std::string>{"background", "balloon", "bird"}));
  EXPECT_EQ(alarms->series[0].y, (std::vector<double>{7, 2}));
  EXPECT_EQ(alarms->series[1].x, (std::vector<double>{1}));
}

TEST(DetectionPlots, BoundsBelowZeroAreNotJoinedByADash) {
  scores::Assessment assessment = two_detectors();
  scores::DetectionBin left;
  left.place = {-20, -10}, left.detection = share(0.5, 0.4, 0.6);
  assessment.detectors[0].by["azimuth_deg"] = {left};
  const auto plots = detection_plots(assessment);
  const plot::Plot* by_bearing = plot_named(plots, "by_azimuth_deg");
  ASSERT_NE(by_bearing, nullptr);
  EXPECT_EQ(by_bearing->x.names, (std::vector<std::string>{"-20 to -10 (2)"}));
}

// Rings of weighted shares stand beside the dots of their detector, where there are any.
TEST(DetectionPlots, WeightedSharesAreRingsBesideThePlainOnes) {
  scores::Assessment assessment = two_detectors();
  assessment.detectors[0].by["range_m"][1].weighted = share(0.3, 0.2, 0.4);
  const auto plots = detection_plots(assessment);
  const plot::Plot& plot = *plot_named(plots, "by_range_m");
  ASSERT_EQ(plot.series.size(), 3u);
  EXPECT_EQ(plot.series[1].name, "first, weighted");
  EXPECT_EQ(plot.series[1].x, (std::vector<double>{2}));
  EXPECT_EQ(plot.series[1].y, (std::vector<double>{0.3}));
  EXPECT_EQ(plot.series[1].low, (std::vector<double>{0.2}));
  EXPECT_EQ(plot.series[1].style.colour, plot.series[0].style.colour);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(plot.series[k].mark, plot::Mark::kDots);
    EXPECT_EQ(plot.series[k].is_hollow, k == 1);
  }
  EXPECT_EQ(plot.series[2].name, "second");
}

}  // namespace
}  // namespace airtruth::detector_evaluation
