// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "encounter/track/track.h"
#include "encounter/tracks_file/formats.h"
#include "encounter/tracks_file/table_text.h"
#include "foundation/geometry/units.h"

namespace airtruth::tracks_file {
namespace {

constexpr std::array<std::string_view, 4> kColumnNames = {"time_s", "x_ft", "y_ft", "z_ft"};

// The place of each column of kColumnNames in a row.
std::array<std::size_t, kColumnNames.size()> places_of(
    const std::vector<std::string_view>& headings, const Where& where) {
  std::array<std::size_t, kColumnNames.size()> places{};
  for (std::size_t i = 0; i < kColumnNames.size(); ++i) {
    const auto found = std::ranges::find(headings, kColumnNames[i]);
    if (found == headings.end() || headings.size() != kColumnNames.size())
      throw Error(fmt::format("the header is '{}'; expected {}",
                              fmt::format("{}", fmt::join(headings, ",")).substr(0, 80),
                              fmt::join(kColumnNames, ",")),
                  where);
    places[i] = static_cast<std::size_t>(found - headings.begin());
  }
  return places;
}

}  // namespace

track::Encounter parse_track_csv(std::string_view text, const std::filesystem::path& file) {
  Lines lines(text, file.string());
  if (!lines.next()) throw Error("is empty; expected a header and rows", {file.string()});
  const auto places = places_of(lines.cells(), lines.where());
  TrackBuilder builder;
  while (lines.next()) {
    const std::vector<std::string_view>& cells = lines.cells();
    if (cells.size() != kColumnNames.size())
      throw Error(fmt::format("has {} cells; expected {}", cells.size(), kColumnNames.size()),
                  lines.where());
    std::array<double, kColumnNames.size()> values{};
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] = number_in(cells[places[i]], kColumnNames[i], lines.where());
    const Vector3 position_ned_ft(values[1], values[2], -values[3]);
    builder.add("track", values[0], kMetresOfFoot * position_ned_ft, nullptr, lines.where());
  }
  if (builder.is_empty()) throw Error("has no rows; expected one for each second", lines.where());
  return builder.take();
}

}  // namespace airtruth::tracks_file
