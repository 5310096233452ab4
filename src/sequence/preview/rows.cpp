// SPDX-License-Identifier: Apache-2.0
#include "sequence/preview/rows.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "encounter/passage/passage.h"
#include "encounter/separation/measures.h"

namespace airtruth::preview {
namespace {

constexpr int kMaxTimes = 60;  // rows that fit a screen

std::string cell(const std::optional<double>& value, const char* format) {
  return value ? fmt::format(fmt::runtime(format), *value) : "-";
}

PreviewRow row_of(const setup::World& world, const setup::Moment& moment, std::size_t actor) {
  const trajectory::State& state = *moment.states[actor];
  const separation::Measures m =
      separation::measures(passage::mover_of(moment.camera), passage::mover_of(state));
  PreviewRow row;
  row.time_s = moment.time_s;
  row.intruder = world.actors[actor].id;
  const auto& box = moment.boxes[actor].box;
  if (box && setup::meets_frame(*box, world.lens.size())) row.box_px = box;
  row.range_m = m.range_m;
  row.bearing_deg = m.relative_bearing_deg;
  row.above_m = m.above_m;
  row.closing_mps = m.closing_speed_mps;
  row.tcpa_s = m.tcpa_s;
  return row;
}

}  // namespace

std::vector<double> whole_seconds(double duration_s) {
  const double last_s = std::floor(duration_s + 1e-6);
  const double step_s = std::max(1.0, std::ceil((last_s + 1) / kMaxTimes));
  std::vector<double> times;
  for (double t = 0; t <= last_s; t += step_s) times.push_back(t);
  return times;
}

std::vector<PreviewRow> preview_rows(
    const setup::World& world,
    const std::vector<double>& times_s,
    const std::function<setup::Moment(double time_s)>& moment_at_time) {
  std::vector<PreviewRow> rows;
  for (const double time_s : times_s) {
    const setup::Moment moment = moment_at_time(time_s);
    for (std::size_t actor = 0; actor < world.actors.size(); ++actor)
      if (moment.states[actor]) rows.push_back(row_of(world, moment, actor));
  }
  return rows;
}

std::vector<std::string> approach_lines(const setup::World& world,
                                        const std::vector<PreviewRow>& rows,
                                        double duration_s) {
  std::vector<std::string> lines;
  for (std::size_t actor = 0; actor < world.actors.size(); ++actor) {
    const setup::Actor& intruder = world.actors[actor];
    const auto closest = passage::closest_approach(world.camera, intruder.path, 0, duration_s);
    if (!closest) {
      lines.push_back(fmt::format("{}: not in the world while the clip lasts", intruder.id));
      continue;
    }
    std::string line =
        fmt::format("{}: closest {:.1f} m at {:.2f} s ({:.1f} ahead, {:.1f} right, {:.1f} above)",
                    intruder.id,
                    closest->distance_m,
                    closest->time_s,
                    closest->offset.ahead_m,
                    closest->offset.right_m,
                    closest->offset.above_m);
    const bool is_seen = std::any_of(rows.begin(), rows.end(), [&](const PreviewRow& row) {
      return row.intruder == intruder.id && row.box_px;
    });
    if (!is_seen)
      if (const auto nearest = setup::nearest_approach(world, actor, duration_s))
        line += nearest->off_view_deg > 0
                    ? fmt::format("; never in view, nearest at {:.2f} s, {:.1f} degrees outside",
                                  nearest->time_s,
                                  nearest->off_view_deg)
                    : fmt::format("; in view at no whole second, but at {:.2f} s", nearest->time_s);
    lines.push_back(line);
  }
  return lines;
}

std::vector<std::string> table_heading() {
  return {"intruder",
          "time s",
          "pixel x",
          "y",
          "width px",
          "range m",
          "bearing deg",
          "above m",
          "closing m/s",
          "to CPA s"};
}

std::vector<std::string> table_cells(const PreviewRow& row) {
  const auto centre = [&](double at, double size) { return fmt::format("{:.0f}", at + size / 2); };
  return {row.intruder,
          fmt::format("{:.0f}", row.time_s),
          row.box_px ? centre(row.box_px->x, row.box_px->width) : "out of view",
          row.box_px ? centre(row.box_px->y, row.box_px->height) : "-",
          row.box_px ? fmt::format("{:.1f}", row.box_px->width) : "-",
          fmt::format("{:.0f}", row.range_m),
          cell(row.bearing_deg, "{:.1f}"),
          fmt::format("{:.0f}", row.above_m),
          cell(row.closing_mps, "{:.1f}"),
          cell(row.tcpa_s, "{:.1f}")};
}

std::string table_text(const std::vector<PreviewRow>& rows) {
  std::vector<std::vector<std::string>> lines = {table_heading()};
  for (const PreviewRow& row : rows) lines.push_back(table_cells(row));
  std::vector<std::size_t> widths(lines[0].size(), 0);
  for (const auto& line : lines)
    for (std::size_t c = 0; c < line.size(); ++c) widths[c] = std::max(widths[c], line[c].size());
  std::string text;
  for (const auto& line : lines) {
    text += fmt::format("{:<{}}", line[0], widths[0]);
    for (std::size_t c = 1; c < line.size(); ++c)
      text += fmt::format("  {:>{}}", line[c], widths[c]);
    text += '\n';
  }
  return text;
}

}  // namespace airtruth::preview
