// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "dataset/set_report/portrait.h"
#include "show/plot/plot.h"

namespace airtruth::set_report {

// A histogram over stated edges; values beyond them count in the first and the last bin.
struct Histogram {
  std::vector<double> edges;
  std::vector<std::int64_t> counts;

  explicit Histogram(std::vector<double> e) : edges(std::move(e)), counts(edges.size() - 1) {}
  void add(double value);
};

// Counts over a whole data set, made from its portraits and from every frame of its truth. Contrast
// alone is of the frames of the films' loops, which are decoded.
struct Totals {
  // The grid of cells over the picture in which the centres of boxes are counted.
  static constexpr int kCellColumns = 32;
  static constexpr int kCellRows = 24;

  std::int64_t frames = 0;
  // Aircraft, one count a frame, by state: visible, hidden, outside, behind, ended.
  std::array<std::int64_t, 5> by_state{};
  // Intruders that are in view by geometry and have no box.
  std::int64_t without_box = 0;
  std::int64_t frames_with_intruder = 0;
  // Sequences that show no aircraft in any frame.
  std::int64_t negative_sequences = 0;
  std::map<std::string, std::int64_t> boxes_by_class;
  // Centres of boxes by cell of the picture, row by row.
  std::vector<std::int64_t> centres = std::vector<std::int64_t>(kCellColumns * kCellRows);
  Histogram range_m{
      {0, 50, 100, 150, 200, 300, 400, 600, 800, 1000, 1500, 2000, 3000, 5000, 10000}};
  Histogram size_px{{0, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 192, 256, 384, 512, 1024}};
  Histogram azimuth_deg{
      {-90, -80, -70, -60, -50, -40, -30, -20, -10, 0, 10, 20, 30, 40, 50, 60, 70, 80, 90}};
  // Of encounters; each intruder of a sequence is one.
  std::int64_t encounters = 0;
  std::map<std::string, std::int64_t> meetings, horizons_when_first_seen;
  Histogram closest_m{{0, 15, 30, 60, 100, 150, 250, 400, 600, 1000, 2000, 5000}};
  Histogram first_seen_m{
      {0, 50, 100, 150, 200, 300, 400, 600, 800, 1000, 1500, 2000, 3000, 5000, 10000}};
  // From the first frame that shows an intruder to its closest approach.
  Histogram first_seen_s{{-10, 0, 1, 2, 3, 4, 6, 8, 10, 15, 20, 30, 60, 120}};
  // Of the boxes that range_m counts.
  Histogram to_closest_s{{-20, -10, -5, -2, 0, 2, 4, 6, 8, 10, 15, 20, 30, 60, 120}};
  Histogram contrast{{0, 2, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 256}};

  void add(const replay::Finished& finished, const Portrait& portrait);
};

// The bar charts at the head of a data set's page: range_m, size_px, azimuth_deg, contrast,
// classes, negatives and states; where sequences have encounters, also meetings, closest_m,
// first_seen_m, first_seen_s, to_closest_s and horizon.
std::vector<std::pair<std::string, plot::Plot>> overview_plots(const Totals& totals);

}  // namespace airtruth::set_report
