// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include <fmt/format.h>

#include "encounter/track/units.h"
#include "encounter/tracks_file/state_table.h"
#include "foundation/base/error.h"

namespace airtruth::encounter {
namespace {

std::vector<Track> whole_tracks(const Encounter& encounter, const char* format) {
  if (encounter.aircraft.size() < 2)
    throw Error(
        fmt::format("a {} file holds the own aircraft and another; one aircraft is given", format));
  std::vector<Track> tracks;
  for (const Track& track : encounter.aircraft) tracks.push_back(with_velocities(track));
  return tracks;
}

// Numbers are written so that reading gives the same ones; -0 becomes 0.
double plain(double number) { return number + 0.0; }

}  // namespace

std::string daa_of(const Encounter& encounter) {
  const std::vector<Track> tracks = whole_tracks(encounter, ".daa");
  std::string text =
      "NAME sx sy sz vx vy vz time\n"
      "[none] [m] [m] [m] [m/s] [m/s] [m/s] [s]\n";
  std::vector<std::size_t> next(tracks.size(), 0);
  for (;;) {
    double time_s = HUGE_VAL;
    for (std::size_t a = 0; a < tracks.size(); ++a)
      if (next[a] < tracks[a].size()) time_s = std::min(time_s, tracks[a].times_s[next[a]]);
    if (time_s == HUGE_VAL) return text;
    for (std::size_t a = 0; a < tracks.size(); ++a) {
      if (next[a] >= tracks[a].size() || tracks[a].times_s[next[a]] != time_s) continue;
      const Vector3& p = tracks[a].positions_ned_m[next[a]];
      const Vector3& v = tracks[a].velocities_ned_mps[next[a]];
      fmt::format_to(std::back_inserter(text),
                     "{} {} {} {} {} {} {} {}\n",
                     tracks[a].name,
                     plain(p.y()),
                     plain(p.x()),
                     plain(-p.z()),
                     plain(v.y()),
                     plain(v.x()),
                     plain(-v.z()),
                     time_s);
      ++next[a];
    }
  }
}

std::string state_table_of(const Encounter& encounter) {
  std::string text =
      "NAME, east, north, alt, trk, gs, vs, time\n"
      "unitless, [ft], [ft], [ft], [rad], [ftps], [ftps], [s]\n";
  for (const Track& track : whole_tracks(encounter, ".txt"))
    for (std::size_t i = 0; i < track.size(); ++i) {
      const Vector3 p = track.positions_ned_m[i] / kMetresOfFoot;
      const Vector3 v = track.velocities_ned_mps[i] / kMetresOfFoot;
      const double course = std::atan2(v.y(), v.x());
      fmt::format_to(std::back_inserter(text),
                     "{}, {}, {}, {}, {}, {}, {}, {}\n",
                     track.name,
                     plain(p.y()),
                     plain(p.x()),
                     plain(-p.z()),
                     plain(course < 0 ? course + 2 * kPi : course),
                     v.head<2>().norm(),
                     plain(-v.z()),
                     track.times_s[i]);
    }
  return text;
}

}  // namespace airtruth::encounter
