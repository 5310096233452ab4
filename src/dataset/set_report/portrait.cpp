// SPDX-License-Identifier: Apache-2.0
#include "dataset/set_report/portrait.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "labels/annotation/lens_facts.h"
#include "labels/annotation/object_class.h"
#include "picture/video/reader.h"
#include "sequence/replay/finished.h"
#include "sequence/setup/from_scene.h"
#include "sequence/setup/world.h"

namespace airtruth::set_report {
namespace {

std::optional<double> closest_s(const std::vector<Encountered>& encounters, const std::string& id) {
  for (const Encountered& one : encounters)
    if (one.record.id == id && one.record.closest) return one.record.closest->time_s;
  return std::nullopt;
}

Portrait::Point point_of(const annotation::Frame& frame, const annotation::Intruder& intruder) {
  Portrait::Point point;
  point.frame = frame.frame;
  point.time_s = frame.time_s;
  point.range_m = intruder.range_m;
  point.azimuth_deg = intruder.azimuth_deg;
  if (intruder.position_ned_m) point.position_ned_m = numbers(*intruder.position_ned_m);
  if (const auto box = annotation::box_to_show(intruder)) {
    point.width_px = box->width;
    point.height_px = box->height;
  }
  point.state = enum_name(intruder.state);
  return point;
}

Portrait::Camera camera_of(const annotation::Frame& frame, int width, int height) {
  const Vector3 middle(width / 2.0, height / 2.0, 1);
  const Vector3 moved = frame.shake.frame_from_reference * middle;
  const Homography& h = frame.shake.frame_from_reference;
  const double degrees = 180 / std::numbers::pi;
  return {frame.frame,
          numbers(frame.camera_position_ned_m),
          frame.camera_attitude_yaw_pitch_roll_deg.yaw_deg,
          (moved.head<2>() / moved.z() - middle.head<2>()).norm(),
          std::atan2(h(1, 0), h(0, 0)) * degrees};
}

// The cell of the picture that holds a box's centre.
std::size_t cell_of(const PixelBox& box, int width, int height) {
  const auto part = [](double at, double whole, int parts) {
    return static_cast<std::size_t>(std::clamp(std::floor(at / whole * parts), 0.0, parts - 1.0));
  };
  return part(box.y + box.height / 2.0, height, Portrait::kCellRows) * Portrait::kCellColumns +
         part(box.x + box.width / 2.0, width, Portrait::kCellColumns);
}

void count(const replay::Finished& finished, Portrait& portrait) {
  std::optional<lens::Lens> lens;
  if (finished.scene) lens = annotation::lens_of(finished.truth.lens);
  portrait.centres.assign(Portrait::kCellColumns * Portrait::kCellRows, 0);
  for (const annotation::Frame& frame : finished.truth.frames) {
    bool is_seen = false;
    for (const annotation::Intruder& intruder : frame.intruders) {
      const bool is_aircraft = annotation::is_aircraft(intruder.object_class);
      if (is_aircraft) ++portrait.frames_by_state[static_cast<std::size_t>(intruder.state)];
      portrait.covered_boxes += is_aircraft && intruder.covered_box_px ? 1 : 0;
      portrait.without_box += lens && annotation::lacks_box(frame, intruder, *lens) ? 1 : 0;
      const auto box = annotation::box_to_show(intruder);
      if (!box) continue;
      is_seen = is_seen || is_aircraft;
      ++portrait.boxes_by_class[sequences::category_of(intruder)];
      ++portrait.centres[cell_of(*box, portrait.width, portrait.height)];
    }
    portrait.frames_with_intruder += is_seen ? 1 : 0;
  }
}

void add_series(const replay::Finished& finished, Portrait& portrait) {
  const auto& frames = finished.truth.frames;
  std::map<std::string, std::size_t> places;
  for (const std::size_t i : thinned(frames.size(), Portrait::kMaxPoints)) {
    for (const annotation::Intruder& intruder : frames[i].intruders) {
      const auto [place, is_new] = places.emplace(intruder.id, portrait.intruders.size());
      if (is_new)
        portrait.intruders.push_back({intruder.id, intruder.aircraft, intruder.object_class, {}});
      Portrait::Point point = point_of(frames[i], intruder);
      if (const auto closest = closest_s(portrait.encounters, intruder.id))
        point.to_closest_s = *closest - point.time_s;
      portrait.intruders[place->second].points.push_back(point);
    }
    if (finished.scene)
      portrait.camera.push_back(camera_of(frames[i], portrait.width, portrait.height));
  }
}

}  // namespace

Portrait portrait_of(const labelled::LabelledSet& set,
                     const std::string& name,
                     std::size_t stills,
                     const std::stop_token& stop) {
  const replay::Finished finished = replay::open_finished(set.folder(name));
  Portrait portrait;
  portrait.facts = set.facts(name);
  portrait.folder = set.folder(name).string();
  for (const auto& entry : fs::directory_iterator(set.folder(name)))
    if (entry.is_regular_file() && !entry.path().filename().string().starts_with("."))
      portrait.files.push_back(entry.path().filename().string());
  std::sort(portrait.files.begin(), portrait.files.end());
  const video::StreamInfo info = video::Reader(finished.video, {.threads = 1}).info();
  portrait.width = info.width;
  portrait.height = info.height;
  portrait.duration_s =
      static_cast<double>(finished.truth.frames.size()) / std::max(1e-9, info.frame_rate.value());
  if (finished.scene) {
    const scene::Scene& scene = *finished.scene;
    portrait.horizontal_fov_deg =
        setup::lens_of(scene.lens, {info.width, info.height}).horizontal_fov_deg();
    portrait.scene = scene;
  }
  portrait.encounters = encounters_of(finished);
  count(finished, portrait);
  add_series(finished, portrait);
  portrait.ids = replay::intruder_ids(finished.truth);
  if (stills > 0) portrait.film = film_of(finished, stills, stop);
  if (fs::is_regular_file(finished.video)) portrait.video = finished.video;
  return portrait;
}

}  // namespace airtruth::set_report
