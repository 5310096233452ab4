// SPDX-License-Identifier: Apache-2.0
#include "sequence/replay/recompose.h"

#include <algorithm>
#include <cstdlib>

#include <fmt/format.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "picture/video/reader.h"
#include "sequence/insertion/frame_truth.h"
#include "sequence/insertion/masks.h"
#include "sequence/insertion/paint.h"
#include "sequence/pipeline/resolved_scene.h"
#include "sequence/setup/from_scene.h"
#include "sequence/setup/moment.h"
#include "sequence/setup/world.h"

namespace airtruth::replay {
namespace {

// Mean difference of luma over a part of two pictures.
double difference(const image::Picture& a, const image::Picture& b, const PixelBox& area) {
  std::int64_t sum = 0;
  for (int y = area.y; y < area.bottom(); ++y)
    for (int x = area.x; x < area.right(); ++x)
      sum += std::abs(int{a.luma().row(y)[x]} - int{b.luma().row(y)[x]});
  return static_cast<double>(sum) / (static_cast<double>(area.width) * area.height);
}

// A codec's error near the aircraft's edges is at most a few times its error in smooth sky.
constexpr double kTimesElsewhere = 4;
constexpr double kLevels = 4;
constexpr int kAroundPx = 8;

std::string picture_fault(const image::Picture& made,
                          const image::Picture& stored,
                          const annotation::Frame& truth,
                          bool lossless) {
  if (made.width != stored.width || made.height != stored.height) return "is of another size";
  if (lossless) return image::identical(made, stored) ? "" : "is not what it would be made as";
  if (made.colour.range != stored.colour.range || made.colour.matrix != stored.colour.matrix)
    return "";
  const PixelBox whole{0, 0, made.width, made.height};
  const double elsewhere = difference(made, stored, whole);
  for (const annotation::Intruder& intruder : truth.intruders) {
    if (!intruder.visible_box_px) continue;
    const PixelBox& v = *intruder.visible_box_px;
    const auto around = intersection(
        {v.x - kAroundPx, v.y - kAroundPx, v.width + 2 * kAroundPx, v.height + 2 * kAroundPx},
        whole);
    const double here = difference(made, stored, *around);
    if (here > kTimesElsewhere * elsewhere + kLevels)
      return fmt::format(
          "differs around {} by {:.1f} levels ({:.1f} elsewhere)", intruder.id, here, elsewhere);
  }
  return "";
}

// Removes from a recomputed truth the fields that older sequences lack.
void as_older_truth(annotation::Frame& truth) {
  for (annotation::Intruder& intruder : truth.intruders) {
    intruder.covered_box_px.reset();
    if (!truth.shake.rotation && truth.shake.frame_from_reference != Homography::Identity()) {
      intruder.azimuth_deg.reset();
      intruder.elevation_deg.reset();
    }
    if (truth.shake.rotation) {
      intruder.nominal_azimuth_deg.reset();
      intruder.nominal_elevation_deg.reset();
    }
  }
}

// Masks whose bytes are not those of the frame drawn again, and masks that should not be there.
std::vector<std::string> mask_faults(const Finished& sequence,
                                     const annotation::Frame& truth,
                                     const image::Layer& layer,
                                     const image::Mask* own_aircraft) {
  const lens::ImageSize size{sequence.truth.lens.width, sequence.truth.lens.height};
  const std::vector<insertion::MaskFile> made =
      insertion::mask_files(truth, layer, own_aircraft, size);
  std::vector<std::string> faults;
  for (const annotation::Intruder& intruder : truth.intruders) {
    const std::string name = insertion::mask_name(intruder.id, truth.frame);
    const auto again =
        std::find_if(made.begin(), made.end(), [&](const auto& m) { return m.name == name; });
    const bool is_there = fs::exists(sequence.folder / name);
    if (is_there != (again != made.end()) ||
        (is_there && read_file(sequence.folder / name) != again->png))
      faults.push_back("has another " + name + " when it is drawn again");
  }
  return faults;
}

// Differences between a frame's stored truth and masks and those that are computed again.
std::vector<std::string> truth_faults(const Finished& sequence,
                                      const annotation::Frame& truth,
                                      const annotation::Frame& again,
                                      const image::Layer& layer,
                                      const image::Mask* own_aircraft) {
  std::vector<std::string> faults;
  if (sequence.scene->output.masks) faults = mask_faults(sequence, again, layer, own_aircraft);
  if (annotation::jsonl_line(again, sequence.truth.lens) !=
      annotation::jsonl_line(truth, sequence.truth.lens))
    faults.push_back("has another truth when it is computed again");
  return faults;
}

// What is computed again for one frame.
struct PaintedAgain {
  const video::Frame& background;
  const setup::Moment& moment;
  const insertion::Painted& painted;
};

// What differs between a stored frame and the one that is computed again: truth, masks, picture.
std::vector<std::string> frame_faults(const Finished& sequence,
                                      const setup::World& world,
                                      const annotation::Frame& truth,
                                      const PaintedAgain& frame,
                                      const image::Picture& stored,
                                      const image::Mask* own_aircraft) {
  // The measured motion is the input of both; all else is computed again.
  annotation::Frame again = insertion::frame_truth(
      world, frame.background, {truth.motion_state, truth.shake}, frame.moment, frame.painted);
  if (!sequence.has_covered_boxes) as_older_truth(again);
  if (!sequence.has_encounters)
    for (annotation::Intruder& intruder : again.intruders) intruder.encounter.reset();
  std::vector<std::string> faults =
      truth_faults(sequence, truth, again, frame.painted.layer, own_aircraft);
  const scene::OutputVideo format = sequence.scene->output.video;
  if (format == scene::OutputVideo::kPng) return faults;  // sRGB, rounded on the way
  const std::string found =
      picture_fault(frame.background.picture, stored, truth, format == scene::OutputVideo::kMkv);
  if (!found.empty()) faults.push_back(found);
  return faults;
}

}  // namespace

Recomposition recompose(const Finished& sequence, std::int64_t every, const std::stop_token& stop) {
  check(every > 0, "every n-th frame");
  if (!sequence.scene) throw Error("was imported, not rendered", {sequence.folder.string()});
  pipeline::Options options;
  options.use_cache = false;
  options.stop = stop;
  pipeline::OpenedScene opened = pipeline::open_scene(*sequence.scene, options);
  const scene::Scene& scene = opened.stated.scene;
  const image::Mask* mask = opened.mask.get();
  video::Reader stored(sequence.video);
  const auto painter =
      insertion::make_painter(scene, opened.world, mask, std::move(opened.backdrop));
  insertion::AmbientEstimator ambient(scene.light, setup::tone_of(scene.camera_model), mask);
  Recomposition result;
  const auto fault = [&](const annotation::Frame& truth, const std::string& what) {
    result.faults.push_back("frame " + std::to_string(truth.frame) + " " + what);
  };
  for (const annotation::Frame& truth : sequence.truth.frames) {
    if (stop.stop_requested()) throw Interrupted();
    auto before = opened.background.next();
    const auto after = stored.next();
    if (!before || !after) {
      fault(truth, before ? "is not in the video" : "is not in the background");
      break;
    }
    const setup::Moment moment =
        setup::moment_at(opened.world, truth.frame, before->time_s, truth.shake);
    const insertion::Ambient light = ambient.next(
        before->picture, moment.sight, setup::search_bounds(moment), before->begins_shot);
    const bool is_compared = truth.frame % every == 0;
    if (!is_compared && !painter->is_in_order()) continue;
    const insertion::Painted painted = painter->paint(before->picture, moment, light);
    if (!is_compared) continue;
    ++result.compared;
    for (const std::string& what : frame_faults(
             sequence, opened.world, truth, {*before, moment, painted}, after->picture, mask))
      fault(truth, what);
  }
  return result;
}

}  // namespace airtruth::replay
