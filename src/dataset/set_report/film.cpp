// SPDX-License-Identifier: Apache-2.0
#include "dataset/set_report/film.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <set>

#include "foundation/base/error.h"
#include "foundation/geometry/box.h"
#include "foundation/image/contrast_to_noise.h"
#include "labels/annotation/object_class.h"
#include "picture/video/reader.h"
#include "picture/video/still.h"

namespace airtruth::set_report {
namespace {

constexpr std::size_t kLoopFrames = 10;  // chosen
// Display choices.
constexpr drawing::CutoutOptions kLoop = {
    .surroundings = 2.2, .least_px = 24, .side = 96, .quality = 5};
// A still takes about 10 kB.
constexpr drawing::CutoutOptions kStill = {
    .most_of_picture = std::numeric_limits<double>::infinity(), .side = 192, .whole_width = 640};

int longer_side(const PixelBox& box) { return std::max(box.width, box.height); }

// What a film is of: the aircraft, or all of a sequence that shows none.
enum class Subjects { kAircraft, kAll };

std::optional<PixelBox> subject_box(const annotation::Intruder& intruder, Subjects subjects) {
  const bool is_one = subjects == Subjects::kAll || annotation::is_aircraft(intruder.object_class);
  return is_one ? annotation::box_to_show(intruder) : std::nullopt;
}

std::optional<PixelBox> first_box(const annotation::Frame& frame, Subjects subjects) {
  for (const annotation::Intruder& intruder : frame.intruders)
    if (const auto box = subject_box(intruder, subjects)) return box;
  return std::nullopt;
}

// The frame whose intruder is largest, if possible one that the picture's edge does not cut.
std::optional<std::size_t> largest_frame(const std::vector<annotation::Frame>& frames,
                                         Subjects subjects) {
  std::optional<std::size_t> largest;
  std::pair<bool, int> most;
  for (std::size_t i = 0; i < frames.size(); ++i)
    for (const annotation::Intruder& intruder : frames[i].intruders) {
      const auto box = subject_box(intruder, subjects);
      if (!box) continue;
      const std::pair<bool, int> here{!(intruder.cut_by_frame > 0), longer_side(*box)};
      if (largest && here <= most) continue;
      largest = i;
      most = here;
    }
  return largest;
}

std::vector<Film::Marked> marked(const annotation::Frame& frame,
                                 const std::vector<std::string>& ids) {
  std::vector<Film::Marked> boxes;
  for (const annotation::Intruder& intruder : frame.intruders)
    if (const auto box = annotation::box_to_show(intruder)) {
      const auto place = std::ranges::find(ids, intruder.id) - ids.begin();
      boxes.push_back({static_cast<std::size_t>(place), *box});
    }
  return boxes;
}

Film::Still still_of(const image::Picture& picture,
                     std::size_t index,
                     const annotation::Frame& truth,
                     const std::vector<std::string>& ids,
                     Subjects subjects) {
  std::optional<PixelBox> largest;
  for (const annotation::Intruder& intruder : truth.intruders)
    if (const auto box = subject_box(intruder, subjects))
      if (!largest || longer_side(*box) > longer_side(*largest)) largest = box;
  const auto subject = largest ? std::optional(as_box(*largest)) : std::nullopt;
  return {drawing::still_of(picture, index, subject, kStill), truth.frame, marked(truth, ids)};
}

}  // namespace

Film film_of(const replay::Finished& finished, std::size_t most, const std::stop_token& stop) {
  const auto& frames = finished.truth.frames;
  const bool shows_aircraft = std::ranges::any_of(frames, [](const annotation::Frame& frame) {
    return first_box(frame, Subjects::kAircraft).has_value();
  });
  const Subjects subjects = shows_aircraft ? Subjects::kAircraft : Subjects::kAll;
  std::vector<std::size_t> seen;  // the frames with a box
  for (std::size_t i = 0; i < frames.size(); ++i)
    if (first_box(frames[i], subjects)) seen.push_back(i);
  std::set<std::size_t> in_loop;
  for (const std::size_t k : drawing::spread_over(seen.size(), kLoopFrames))
    in_loop.insert(seen[k]);
  std::set<std::size_t> shown = drawing::spread_over(frames.size(), most);
  const std::optional<std::size_t> poster = largest_frame(frames, subjects);
  if (poster) shown.insert(*poster);
  const std::vector<std::string> ids = replay::intruder_ids(finished.truth);
  Film film;
  std::vector<image::Rgb8> squares;
  video::Reader reader(finished.video, {.threads = 1});
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (stop.stop_requested()) throw Interrupted();
    const auto frame = reader.next();
    if (!frame) {
      if (seen.empty() || i > seen.back()) break;
      throw Error("holds fewer frames than its truth", {finished.video.string()});
    }
    if (shown.contains(i)) {
      if (i == poster) film.poster = film.stills.size();
      film.stills.push_back(still_of(frame->picture, i, frames[i], ids, subjects));
    }
    if (!in_loop.contains(i)) continue;
    const PixelBox box = *first_box(frames[i], subjects);
    if (shows_aircraft) film.contrasts.push_back(image::contrast(frame->picture, box));
    squares.push_back(drawing::enlarged(frame->picture, as_box(box), kLoop));
  }
  if (squares.empty()) return film;
  film.loop_frames = static_cast<int>(squares.size());
  film.loop_side = kLoop.side;
  film.loop_jpeg = video::jpeg_of(drawing::strip(squares), kLoop.quality);
  return film;
}

}  // namespace airtruth::set_report
