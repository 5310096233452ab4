// SPDX-License-Identifier: Apache-2.0
#include "dataset/set_report/encounters.h"

#include <algorithm>

#include <fmt/format.h>

#include "foundation/base/median.h"

namespace airtruth::set_report {
namespace {

using pipeline::EncounterRecord;
using Records = std::vector<EncounterRecord>;

const annotation::Intruder* intruder_of(const annotation::Frame& frame, const std::string& id) {
  for (const annotation::Intruder& intruder : frame.intruders)
    if (intruder.id == id && intruder.position_ned_m) return &intruder;
  return nullptr;
}

// "head-on 3, overtaking 1": the values in the order of their table, those without one at the end.
template <typename Enum>
std::string counts_of(const Records& records,
                      std::optional<Enum> EncounterRecord::*of,
                      const std::string& without) {
  std::vector<std::string> parts;
  const auto add = [&](const std::optional<Enum>& value, const std::string& name) {
    const auto count = std::ranges::count(records, value, of);
    if (count > 0) parts.push_back(fmt::format("{} {}", name, count));
  };
  for (const EnumName<Enum>& known : enum_names(Enum{})) add(known.value, known.name);
  add(std::nullopt, without);
  return fmt::format("{}", fmt::join(parts, ", "));
}

// "median 12 m (4 to 60 m)"
std::string spread(const std::vector<double>& values, const char* unit) {
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  return fmt::format(
      "median {:.0f} {} ({:.0f} to {:.0f} {})", median_between(values), unit, *least, *most, unit);
}

template <typename Of>
std::vector<double> values_of(const Records& records, Of of) {
  std::vector<double> values;
  for (const EncounterRecord& record : records)
    if (const std::optional<double> value = of(record)) values.push_back(*value);
  return values;
}

std::string first_seen_text(const Records& records) {
  const auto ranges_m = values_of(records, [](const EncounterRecord& r) {
    return r.first_seen ? std::optional(r.first_seen->range_m) : std::nullopt;
  });
  if (ranges_m.empty()) return "never seen";
  const auto ahead_s = values_of(records, [](const EncounterRecord& r) {
    return r.first_seen && r.closest ? std::optional(r.closest->time_s - r.first_seen->time_s)
                                     : std::nullopt;
  });
  std::string text = "first seen at " + spread(ranges_m, "m");
  if (!ahead_s.empty()) text += ", " + spread(ahead_s, "s") + " before the closest approach";
  text += ", then against the horizon: " +
          counts_of(records, &EncounterRecord::horizon_when_first_seen, "never seen");
  return text;
}

std::string violations_text(const Records& records, const std::vector<std::string>& volumes) {
  std::vector<std::string> parts;
  for (const std::string& volume : volumes) {
    const auto count = std::ranges::count_if(records, [&](const EncounterRecord& r) {
      return std::ranges::count(r.violations, volume, &pipeline::NamedInterval::volume) > 0;
    });
    parts.push_back(fmt::format("{} in {}", volume, count));
  }
  return "volumes violated: " + fmt::format("{}", fmt::join(parts, ", "));
}

}  // namespace

std::optional<double> closest_s(const replay::Finished& finished, const std::string& id) {
  for (const EncounterRecord& record : finished.encounters)
    if (record.id == id && record.closest) return record.closest->time_s;
  return std::nullopt;
}

std::optional<ClosestPlaces> closest_places(const std::vector<annotation::Frame>& frames,
                                            const EncounterRecord& record) {
  if (!record.closest) return std::nullopt;
  const double time_s = record.closest->time_s;
  const auto after = std::ranges::find_if(
      frames, [&](double at_s) { return at_s >= time_s; }, &annotation::Frame::time_s);
  if (after == frames.end()) return std::nullopt;
  const auto before = after == frames.begin() ? after : after - 1;
  const annotation::Intruder* from = intruder_of(*before, record.id);
  const annotation::Intruder* to = intruder_of(*after, record.id);
  if (from == nullptr || to == nullptr) return std::nullopt;
  const double span_s = after->time_s - before->time_s;
  const double share = span_s > 0 ? (time_s - before->time_s) / span_s : 0;
  const auto between = [&](const auto& a, const auto& b) {
    return numbers_of(Vector3(vector_of(a) + share * (vector_of(b) - vector_of(a))));
  };
  return ClosestPlaces{between(before->camera_position_ned_m, after->camera_position_ned_m),
                       between(*from->position_ned_m, *to->position_ned_m)};
}

std::string encounters_text(const Records& records, const std::vector<std::string>& volumes) {
  if (records.empty()) return "";
  std::vector<std::string> parts = {
      fmt::format("{}, seen from the own aircraft: {}",
                  records.size(),
                  counts_of(records,
                            &EncounterRecord::meeting,
                            "of no course (one of the two hovers, or both fly alike)")),
      counts_of(records, &EncounterRecord::vertical_motion, "of no height")};
  const auto distances_m = values_of(records, [](const EncounterRecord& r) {
    return r.closest ? std::optional(r.closest->distance_m) : std::nullopt;
  });
  if (!distances_m.empty()) parts.push_back("closest approach " + spread(distances_m, "m"));
  parts.push_back(first_seen_text(records));
  if (!volumes.empty()) parts.push_back(violations_text(records, volumes));
  return fmt::format("{}", fmt::join(parts, "; "));
}

}  // namespace airtruth::set_report
