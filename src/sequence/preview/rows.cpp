// SPDX-License-Identifier: Apache-2.0
#include "sequence/preview/rows.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "encounter/passage/passage.h"
#include "labels/projection/exact_box.h"

namespace airtruth::preview {
namespace {

constexpr int kMaxTimes = 60;  // rows that fit a screen

std::string cell(const std::optional<double>& value, const char* format) {
  return value ? fmt::format(fmt::runtime(format), *value) : "-";
}

// "12.0 right", or "12.0 left" of a number below 0; what is 0.0 is right.
std::string to_side(double value, const char* positive, const char* negative) {
  return fmt::format("{:.1f} {}", std::abs(value), value <= -0.05 ? negative : positive);
}

// Empty where none of the party is in the world.
std::optional<PreviewRow> row_of(const setup::World& world,
                                 const setup::Moment& moment,
                                 const Party& party) {
  PreviewRow row{.time_s = moment.time_s, .intruder = party.name};
  bool is_there = false;
  for (const std::size_t actor : party.actors) {
    if (!moment.states[actor]) continue;
    const separation::Measures m = separation::measures(passage::mover_of(moment.camera),
                                                        passage::mover_of(*moment.states[actor]));
    if (!is_there || m.range_m < row.nearest.range_m) row.nearest = m;
    is_there = true;
    std::optional<Box> box = moment.boxes[actor].whole();
    if (moment.boxes[actor].partly_unseen)
      if (const auto pixel =
              projection::pixel_from_world(moment.sight, moment.states[actor]->position_in_world))
        box = Box{pixel->x(), pixel->y(), 0, 0};
    if (box && setup::meets_frame(*box, world.lens.size()))
      row.box_px = row.box_px ? bounds(*row.box_px, *box) : *box;
  }
  return is_there ? std::optional(row) : std::nullopt;
}

// A flock's members are "ID-1", "ID-2", ... of one table.
std::string flock_name(const std::string& id) { return id.substr(0, id.rfind('-')); }

bool are_of_one_flock(const scene::Intruder& a, const scene::Intruder& b) {
  return a.distractor && b.distractor && a.where.line == b.where.line &&
         a.where.column == b.where.column && flock_name(a.id) == flock_name(b.id);
}

std::size_t middle_of(const scene::Scene& scene, const std::vector<std::size_t>& actors) {
  Vector3 mean = Vector3::Zero();
  for (const std::size_t actor : actors) mean += scene.intruders[actor].offset_ned_m;
  mean /= static_cast<double>(actors.size());
  return *std::ranges::min_element(actors, {}, [&](std::size_t actor) {
    return (scene.intruders[actor].offset_ned_m - mean).norm();
  });
}

std::optional<passage::Approach> nearest_of(const setup::World& world,
                                            const Party& party,
                                            double duration_s) {
  std::optional<passage::Approach> nearest;
  for (const std::size_t actor : party.actors) {
    const auto one =
        passage::closest_approach(world.camera, world.actors[actor].path, 0, duration_s);
    if (one && (!nearest || one->distance_m < nearest->distance_m)) nearest = one;
  }
  return nearest;
}

}  // namespace

std::vector<Party> parties_of(const scene::Scene& scene) {
  std::vector<Party> parties;
  for (std::size_t i = 0; i < scene.intruders.size(); ++i) {
    if (i == 0 || !are_of_one_flock(scene.intruders[i - 1], scene.intruders[i]))
      parties.emplace_back();
    parties.back().actors.push_back(i);
  }
  for (Party& party : parties) {
    const std::string& id = scene.intruders[party.actors.front()].id;
    const std::size_t count = party.actors.size();
    party.name = count == 1 ? id : fmt::format("{} ({})", flock_name(id), count);
    party.middle = middle_of(scene, party.actors);
  }
  return parties;
}

std::vector<double> whole_seconds(double duration_s) {
  const double last_s = std::floor(duration_s + 1e-6);
  const double step_s = std::max(1.0, std::ceil((last_s + 1) / kMaxTimes));
  std::vector<double> times;
  for (double t = 0; t <= last_s; t += step_s) times.push_back(t);
  return times;
}

std::vector<PreviewRow> preview_rows(
    const setup::World& world,
    const std::vector<Party>& parties,
    const std::vector<double>& times_s,
    const std::function<setup::Moment(double time_s)>& moment_at_time) {
  std::vector<PreviewRow> rows;
  for (const double time_s : times_s) {
    const setup::Moment moment = moment_at_time(time_s);
    for (std::size_t i = 0; i < parties.size(); ++i)
      if (auto row = row_of(world, moment, parties[i])) {
        row->party = i;
        rows.push_back(std::move(*row));
      }
  }
  return rows;
}

std::vector<std::string> approach_lines(const setup::World& world,
                                        const std::vector<Party>& parties,
                                        const std::set<std::size_t>& seen,
                                        double duration_s) {
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < parties.size(); ++i) {
    const Party& party = parties[i];
    const auto closest = nearest_of(world, party, duration_s);
    if (!closest) {
      lines.push_back(fmt::format("{}: not in the world while the clip lasts", party.name));
      continue;
    }
    std::string line = fmt::format("{}: closest {:.1f} m at {:.2f} s ({}, {}, {})",
                                   party.name,
                                   closest->distance_m,
                                   closest->time_s,
                                   to_side(closest->offset.ahead_m, "ahead", "behind"),
                                   to_side(closest->offset.right_m, "right", "left"),
                                   to_side(closest->offset.above_m, "above", "below"));
    if (!seen.contains(i))
      if (const auto nearest = setup::nearest_approach(world, party.middle, duration_s))
        line += nearest->off_view_deg > 0
                    ? fmt::format("; never in view, nearest at {:.2f} s, {:.1f} degrees outside",
                                  nearest->time_s,
                                  nearest->off_view_deg)
                    : fmt::format("; in view at no whole second, but at {:.2f} s", nearest->time_s);
    lines.push_back(line);
  }
  return lines;
}

double view_deg(const setup::World& world) {
  const lens::Lens& lens = world.lens;
  const auto ray = [&](double x) { return lens.ray_from_pixel({x, lens.size().height / 2.0}); };
  const auto left = ray(0.5), right = ray(lens.size().width - 0.5);
  if (!left || !right) return 180;
  return degrees(std::acos(std::clamp(left->normalized().dot(right->normalized()), -1.0, 1.0)));
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
          row.box_px && row.box_px->width > 0 ? fmt::format("{:.1f}", row.box_px->width) : "-",
          fmt::format("{:.0f}", row.nearest.range_m),
          cell(row.nearest.relative_bearing_deg, "{:.1f}"),
          fmt::format("{:.0f}", row.nearest.above_m),
          cell(row.nearest.closing_speed_mps, "{:.1f}"),
          cell(row.nearest.tcpa_s, "{:.1f}")};
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
