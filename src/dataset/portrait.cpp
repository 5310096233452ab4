// SPDX-License-Identifier: Apache-2.0
#include "dataset/portrait.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/error.h"
#include "dataset/in_view.h"
#include "report/pictures.h"
#include "report/thumbnails.h"
#include "sequence/finished.h"
#include "sequence/world.h"
#include "video/reader.h"
#include "video/still.h"

namespace airtruth::dataset {
namespace {

constexpr int kPreviewWidth = 400;
constexpr int kLoopSide = 96;
constexpr std::size_t kLoopFrames = 10;
constexpr int kJpegQuality = 5;

std::array<double, 3> numbers(const Vector3& v) { return {v.x(), v.y(), v.z()}; }

// Indices of n things, thinned to at most `most`, the last among them.
std::vector<std::size_t> thinned(std::size_t n, std::size_t most) {
  std::vector<std::size_t> chosen;
  const std::size_t count = std::min(n, most);
  for (std::size_t k = 0; k < count; ++k)
    chosen.push_back(count == 1 ? 0 : k * (n - 1) / (count - 1));
  return chosen;
}

Portrait::Point point_of(const annotation::Frame& frame, const annotation::Intruder& intruder) {
  Portrait::Point point;
  point.frame = frame.frame;
  point.time_s = frame.time_s;
  point.range_m = intruder.range_m;
  point.azimuth_deg = intruder.azimuth_deg;
  point.elevation_deg = intruder.elevation_deg;
  if (intruder.position_ned_m) point.position_ned_m = numbers(*intruder.position_ned_m);
  if (const auto box = annotation::box_to_show(intruder)) {
    point.width_px = box->width;
    point.height_px = box->height;
  }
  point.state = annotation::name(intruder.state);
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

void count(const sequence::Finished& finished, Portrait& portrait) {
  std::optional<lens::Lens> lens;
  if (finished.scene) lens = lens_from(finished.truth.lens);
  for (const annotation::Frame& frame : finished.truth.frames)
    for (const annotation::Intruder& intruder : frame.intruders) {
      ++portrait.frames_by_state[static_cast<std::size_t>(intruder.state)];
      portrait.covered_boxes += intruder.covered_box_px ? 1 : 0;
      portrait.without_box += lens && lacks_box(frame, intruder, *lens) ? 1 : 0;
    }
}

void add_series(const sequence::Finished& finished, Portrait& portrait) {
  const auto& frames = finished.truth.frames;
  std::map<std::string, std::size_t> places;
  for (const std::size_t i : thinned(frames.size(), Portrait::kMostPoints)) {
    for (const annotation::Intruder& intruder : frames[i].intruders) {
      const auto [place, is_new] = places.emplace(intruder.id, portrait.intruders.size());
      if (is_new) portrait.intruders.push_back({intruder.id, intruder.aircraft, {}});
      portrait.intruders[place->second].points.push_back(point_of(frames[i], intruder));
    }
    if (finished.scene)
      portrait.camera.push_back(camera_of(frames[i], portrait.width, portrait.height));
  }
}

const annotation::Intruder* first_visible(const annotation::Frame& frame) {
  for (const annotation::Intruder& intruder : frame.intruders)
    if (intruder.visible_box_px) return &intruder;
  return nullptr;
}

// Of the frames that show an intruder: the loop's, and the one where it is largest for the preview.
void add_pictures(const sequence::Finished& finished,
                  const std::stop_token& stop,
                  Portrait& portrait) {
  std::vector<std::size_t> seen;
  std::size_t largest = 0;
  int largest_px = -1;
  const auto& frames = finished.truth.frames;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const annotation::Intruder* intruder = first_visible(frames[i]);
    if (intruder == nullptr) continue;
    seen.push_back(i);
    const PixelBox box = *annotation::box_to_show(*intruder);
    const int size = std::max(box.width, box.height);
    if (intruder->cut_by_frame > 0 && largest_px >= 0) continue;
    if (size > largest_px) {
      largest_px = size;
      largest = i;
    }
  }
  if (seen.empty()) return;
  const std::vector<std::string> ids = sequence::intruder_ids(finished.truth);
  std::vector<bool> in_loop(frames.size(), false);
  for (const std::size_t k : thinned(seen.size(), kLoopFrames)) in_loop[seen[k]] = true;
  std::vector<image::Rgb8> squares;
  video::Reader reader(finished.video, {.threads = 1});
  for (std::size_t i = 0; i <= seen.back(); ++i) {
    if (stop.stop_requested()) throw Interrupted();
    const auto frame = reader.next();
    if (!frame) throw Error("holds fewer frames than its truth", {finished.video.string()});
    if (!in_loop[i] && i != largest) continue;
    const PixelBox box = *annotation::box_to_show(*first_visible(frames[i]));
    if (i == largest)
      portrait.preview_jpeg = video::jpeg_of(
          report::small_copy(report::overlay(frame->picture, frames[i], ids), kPreviewWidth),
          kJpegQuality);
    if (!in_loop[i]) continue;
    portrait.contrasts.push_back(report::contrast(frame->picture, box));
    squares.push_back(
        report::enlarged(frame->picture,
                         {double(box.x), double(box.y), double(box.width), double(box.height)},
                         kLoopSide));
  }
  portrait.loop_frames = static_cast<int>(squares.size());
  portrait.loop_side = kLoopSide;
  portrait.loop_jpeg = video::jpeg_of(report::strip(squares), kJpegQuality);
}

}  // namespace

Portrait portrait_of(const LabelledSet& set, const std::string& name, const std::stop_token& stop) {
  const sequence::Finished finished = sequence::open_finished(set.folder(name));
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
        sequence::lens_of(scene.lens, {info.width, info.height}).horizontal_fov_deg();
    portrait.sun_azimuth_deg = scene.light.sun_azimuth_deg;
    portrait.sun_elevation_deg = scene.light.sun_elevation_deg;
    portrait.motion_model = scene.motion.model;
    portrait.scene = scene;
  }
  count(finished, portrait);
  add_series(finished, portrait);
  add_pictures(finished, stop, portrait);
  return portrait;
}

}  // namespace airtruth::dataset
