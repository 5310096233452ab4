// SPDX-License-Identifier: Apache-2.0
#include "dataset/set_report/totals.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "dataset/set_report/encounters.h"
#include "labels/annotation/object_class.h"

namespace airtruth::set_report {
namespace {

// Bars over named places.
plot::Plot bars(const std::string& of,
                const std::vector<std::string>& names,
                const std::vector<std::int64_t>& counts) {
  plot::Plot plot{.x = {.names = names}, .y = {.label = of, .min = 0}};
  plot::Series series{.mark = plot::Mark::kBars};
  for (std::size_t i = 0; i < counts.size(); ++i)
    series.add(static_cast<double>(i), static_cast<double>(counts[i]));
  plot.series.push_back(std::move(series));
  return plot;
}

// The first and the last bin also count what lies beyond the edges.
plot::Plot bars(const std::string& of, const Histogram& histogram) {
  constexpr double kOpen = std::numeric_limits<double>::infinity();
  const std::vector<double>& edges = histogram.edges;
  const std::size_t last = histogram.counts.size() - 1;
  std::vector<std::string> names;
  for (std::size_t i = 0; i <= last; ++i)
    names.push_back(plot::name_of_bin(i == 0 && last > 0 ? -kOpen : edges[i],
                                      i == last ? kOpen : edges[i + 1]));
  return bars(of, names, histogram.counts);
}

// Every name of the enum in its order, and those that occur without a value.
template <typename Enum>
plot::Plot bars(const std::map<std::string, std::int64_t>& counts, const std::string& without) {
  std::vector<std::string> names = all_enum_names<Enum>();
  if (counts.contains(without)) names.push_back(without);
  std::vector<std::int64_t> heights;
  for (const std::string& name : names)
    heights.push_back(counts.contains(name) ? counts.at(name) : 0);
  return bars("encounters", names, heights);
}

// The box of the intruder's label: its covered box, of an imported clip its own. Empty where it has
// no label, as what is visible without covering a pixel.
std::optional<PixelBox> labelled_box(const replay::Finished& finished,
                                     const annotation::Intruder& intruder) {
  return finished.scene ? intruder.covered_box_px : intruder.visible_box_px;
}

// The cell of the picture that holds a box's centre.
std::size_t cell_of(const PixelBox& box, const video::StreamInfo& info) {
  const auto part = [](double at, double whole, int parts) {
    return static_cast<std::size_t>(std::clamp(std::floor(at / whole * parts), 0.0, parts - 1.0));
  };
  return part(box.y + box.height / 2.0, info.height, Totals::kCellRows) * Totals::kCellColumns +
         part(box.x + box.width / 2.0, info.width, Totals::kCellColumns);
}

constexpr const char* kNoMeeting = "hovering";
constexpr const char* kNeverSeen = "never seen";

void add_encounter(const pipeline::EncounterRecord& record, Totals& totals) {
  ++totals.encounters;
  ++totals.meetings[enum_name(record.meeting, kNoMeeting)];
  ++totals.horizons_when_first_seen[enum_name(record.horizon_when_first_seen, kNeverSeen)];
  if (record.closest) totals.closest_m.add(record.closest->distance_m);
  if (!record.first_seen) return;
  totals.first_seen_m.add(record.first_seen->range_m);
  if (record.closest) totals.first_seen_s.add(record.closest->time_s - record.first_seen->time_s);
}

}  // namespace

void Histogram::add(double value) {
  const auto above = std::upper_bound(edges.begin(), edges.end(), value) - edges.begin();
  ++counts[static_cast<std::size_t>(
      std::clamp<std::ptrdiff_t>(above - 1, 0, std::ssize(counts) - 1))];
}

void Totals::add(const replay::Finished& finished, const Portrait& portrait) {
  frames += portrait.facts.frames;
  for (std::size_t s = 0; s < by_state.size(); ++s) by_state[s] += portrait.frames_by_state[s];
  without_box += portrait.without_box;
  frames_with_intruder += portrait.frames_with_intruder;
  negative_sequences += portrait.frames_with_intruder == 0 ? 1 : 0;
  for (const annotation::Frame& frame : finished.truth.frames)
    for (const annotation::Intruder& intruder : frame.intruders) {
      const auto box = labelled_box(finished, intruder);
      if (!box) continue;
      ++boxes_by_class[sequences::category_of(intruder)];
      ++centres[cell_of(*box, portrait.info)];
      if (!annotation::is_aircraft(intruder.object_class)) continue;
      size_px.add(std::max(box->width, box->height));
      if (intruder.range_m) range_m.add(*intruder.range_m);
      if (intruder.azimuth_deg) azimuth_deg.add(*intruder.azimuth_deg);
      if (const auto closest = closest_s(finished, intruder.id))
        to_closest_s.add(*closest - frame.time_s);
    }
  for (const auto& record : portrait.encounters) add_encounter(record, *this);
  for (const double value : portrait.film.contrasts) contrast.add(value);
}

std::vector<std::pair<std::string, plot::Plot>> overview_plots(const Totals& totals) {
  std::vector<std::string> classes;
  std::vector<std::int64_t> boxes;
  for (const auto& [name, count] : totals.boxes_by_class) {
    classes.push_back(name);
    boxes.push_back(count);
  }
  const std::int64_t without = totals.frames - totals.frames_with_intruder;
  std::vector<std::pair<std::string, plot::Plot>> plots = {
      {"range_m", bars("boxes", totals.range_m)},
      {"size_px", bars("boxes", totals.size_px)},
      {"azimuth_deg", bars("boxes", totals.azimuth_deg)},
      {"contrast", bars("frames of the loops", totals.contrast)},
      {"classes", bars("boxes", classes, boxes)},
      {"negatives",
       bars("frames", {"with an intruder", "without"}, {totals.frames_with_intruder, without})},
      {"states",
       bars("intruders in frames",
            {"visible", "hidden", "outside", "behind", "ended"},
            {totals.by_state.begin(), totals.by_state.end()})}};
  if (totals.encounters == 0) return plots;
  plots.push_back({"to_closest_s", bars("boxes", totals.to_closest_s)});
  plots.push_back({"meetings", bars<passage::Meeting>(totals.meetings, kNoMeeting)});
  plots.push_back({"closest_m", bars("encounters", totals.closest_m)});
  plots.push_back({"first_seen_m", bars("encounters", totals.first_seen_m)});
  plots.push_back({"first_seen_s", bars("encounters", totals.first_seen_s)});
  plots.push_back(
      {"horizon", bars<passage::AgainstHorizon>(totals.horizons_when_first_seen, kNeverSeen)});
  return plots;
}

}  // namespace airtruth::set_report
