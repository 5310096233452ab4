// SPDX-License-Identifier: Apache-2.0
#include "dataset/set_report/portrait.h"

#include <algorithm>

#include "camera/lens/lens.h"
#include "labels/annotation/object_class.h"
#include "labels/annotation/truth.h"

namespace airtruth::set_report {
namespace {

void widen(Portrait::Ends& ends, double value) {
  if (!ends) ends = {value, value};
  ends = {std::min(ends->first, value), std::max(ends->second, value)};
}

void count(const replay::Finished& finished, Portrait& portrait) {
  std::optional<lens::Lens> lens;
  if (finished.scene) lens = lens::lens_of(finished.truth.lens);
  for (const annotation::Frame& frame : finished.truth.frames) {
    bool is_seen = false;
    for (const annotation::Intruder& intruder : frame.intruders) {
      const bool is_aircraft = annotation::is_aircraft(intruder.object_class);
      if (is_aircraft) ++portrait.frames_by_state[static_cast<std::size_t>(intruder.state)];
      portrait.covered_boxes += is_aircraft && intruder.covered_box_px ? 1 : 0;
      portrait.without_box += lens && annotation::lacks_box(frame, intruder, *lens) ? 1 : 0;
      const auto shown = annotation::box_to_show(intruder);
      if (is_aircraft && shown) {
        is_seen = true;
        widen(portrait.size_px, std::max(shown->width, shown->height));
        if (intruder.range_m) widen(portrait.range_m, *intruder.range_m);
      }
    }
    portrait.frames_with_intruder += is_seen ? 1 : 0;
  }
}

}  // namespace

Portrait portrait_of(const labelled::LabelledSet& set,
                     const std::string& name,
                     const replay::Finished& finished,
                     std::size_t stills,
                     const std::stop_token& stop) {
  Portrait portrait;
  portrait.facts = set.facts(name);
  portrait.info =
      video::Reader(finished.video, {.picture_rate_hz = finished.picture_rate_hz, .threads = 1})
          .info();
  portrait.scene = finished.scene;
  portrait.encounters = finished.encounters;
  count(finished, portrait);
  if (stills > 0) portrait.film = film_of(finished, stills, stop);
  return portrait;
}

}  // namespace airtruth::set_report
