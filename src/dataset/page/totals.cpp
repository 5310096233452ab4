// SPDX-License-Identifier: Apache-2.0
#include "dataset/page/totals.h"

#include <algorithm>

#include <fmt/format.h>

#include "truth/annotation/object_class.h"

namespace airtruth::dataset {
namespace {

// Bars over named places.
plot::Plot bars(const std::vector<std::string>& names, const std::vector<std::int64_t>& counts) {
  plot::Plot plot{.x = {.names = names}, .y = {.min = 0}};
  plot::Series series{.mark = plot::Mark::kBars};
  for (std::size_t i = 0; i < counts.size(); ++i) {
    series.x.push_back(static_cast<double>(i));
    series.y.push_back(static_cast<double>(counts[i]));
  }
  plot.series.push_back(std::move(series));
  return plot;
}

// The first and the last bin also count what lies beyond the edges.
plot::Plot bars(const Histogram& histogram) {
  const std::vector<double>& edges = histogram.edges;
  const std::size_t last = histogram.counts.size() - 1;
  std::vector<std::string> names;
  for (std::size_t i = 0; i <= last; ++i)
    names.push_back(i == last ? fmt::format("≥ {}", edges[i])
                    : i == 0  ? fmt::format("< {}", edges[1])
                              : fmt::format("{}–{}", edges[i], edges[i + 1]));
  return bars(names, histogram.counts);
}

}  // namespace

void Histogram::add(double value) {
  const auto above = std::upper_bound(edges.begin(), edges.end(), value) - edges.begin();
  ++counts[static_cast<std::size_t>(
      std::clamp<std::ptrdiff_t>(above - 1, 0, std::ssize(counts) - 1))];
}

void Totals::add(const Portrait& portrait) {
  frames += portrait.facts.frames;
  for (std::size_t s = 0; s < by_state.size(); ++s) by_state[s] += portrait.frames_by_state[s];
  without_box += portrait.without_box;
  frames_with_intruder += portrait.frames_with_intruder;
  negative_sequences += portrait.frames_with_intruder == 0 ? 1 : 0;
  for (const auto& [name, boxes] : portrait.boxes_by_class) boxes_by_class[name] += boxes;
  for (std::size_t i = 0; i < centres.size(); ++i) centres[i] += portrait.centres[i];
  for (const Portrait::Intruder& intruder : portrait.intruders) {
    if (!annotation::is_aircraft(intruder.object_class)) continue;
    for (const Portrait::Point& point : intruder.points) {
      if (!point.width_px) continue;
      size_px.add(std::max(*point.width_px, *point.height_px));
      if (point.range_m) range_m.add(*point.range_m);
      if (point.azimuth_deg) azimuth_deg.add(*point.azimuth_deg);
    }
  }
  for (const double value : portrait.film.contrasts) contrast.add(value);
}

std::vector<OverviewPlot> overview_plots(const Totals& totals) {
  std::vector<std::string> classes;
  std::vector<std::int64_t> boxes;
  for (const auto& [name, count] : totals.boxes_by_class) {
    classes.push_back(name);
    boxes.push_back(count);
  }
  const std::int64_t without = totals.frames - totals.frames_with_intruder;
  return {
      {"range_m", bars(totals.range_m)},
      {"size_px", bars(totals.size_px)},
      {"azimuth_deg", bars(totals.azimuth_deg)},
      {"contrast", bars(totals.contrast)},
      {"classes", bars(classes, boxes)},
      {"negatives", bars({"with an intruder", "without"}, {totals.frames_with_intruder, without})},
      {"states",
       bars({"visible", "hidden", "outside", "behind", "ended"},
            {totals.by_state.begin(), totals.by_state.end()})}};
}

}  // namespace airtruth::dataset
