// SPDX-License-Identifier: Apache-2.0
#include "sequence/replay/recompose.h"

#include <algorithm>
#include <cstdlib>

#include <fmt/format.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/geometry/box.h"
#include "picture/video/reader.h"
#include "picture/video/writer.h"
#include "sequence/insertion/masks.h"
#include "sequence/pipeline/frame_maker.h"
#include "sequence/pipeline/resolved_scene.h"

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

// A codec's error near the aircraft's edges is at most a few times its error in smooth sky, and a
// few code values more.
constexpr double kTimesElsewhere = 4;
constexpr double kLevels = 4;
// Border of a box: as far as the aircraft's edges change a codec's block of 8 x 8 pixels.
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
    const auto around = intersection(wider(*intruder.visible_box_px, kAroundPx), whole);
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
    intruder.covered_area_px.reset();
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
std::vector<std::string> mask_faults(const Finished& sequence, const pipeline::Work& again) {
  std::vector<std::string> faults;
  for (const annotation::Intruder& intruder : again.truth.intruders) {
    const std::string name = insertion::mask_name(intruder.id, again.truth.frame);
    const auto made = std::ranges::find(again.masks, name, &insertion::MaskFile::name);
    const bool is_there = fs::exists(sequence.folder / name);
    if (is_there != (made != again.masks.end()) ||
        (is_there && read_file(sequence.folder / name) != made->png))
      faults.push_back("has another " + name + " when it is drawn again");
  }
  return faults;
}

// What differs between a stored frame and the one that is made again: masks, truth, picture.
std::vector<std::string> frame_faults(const Finished& sequence,
                                      const annotation::Frame& truth,
                                      const image::Picture& stored,
                                      pipeline::Work& again) {
  // The measured motion is the input of both; all else is computed again.
  again.truth.motion_state = truth.motion_state;
  if (!sequence.has_covered_boxes) as_older_truth(again.truth);
  for (annotation::Intruder& intruder : again.truth.intruders) {
    if (!sequence.has_encounters) intruder.encounter.reset();
    if (!sequence.has_contrast) intruder.contrast_to_noise.reset();
  }
  std::vector<std::string> faults;
  if (sequence.scene->output.masks) faults = mask_faults(sequence, again);
  if (annotation::jsonl_line(again.truth, sequence.truth.lens) !=
      annotation::jsonl_line(truth, sequence.truth.lens))
    faults.push_back("has another truth when it is computed again");
  const video::Format format = sequence.scene->output.video;
  if (format == video::Format::kPng) return faults;  // sRGB, rounded on the way
  const std::string found =
      picture_fault(again.frame.picture, stored, truth, format == video::Format::kMkv);
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
  pipeline::FrameMaker maker(
      pipeline::resolved_by_truth(pipeline::open_scene(*sequence.scene, options)), stop);
  video::Reader stored(sequence.video);
  Recomposition result;
  const auto fault = [&](const annotation::Frame& truth, const std::string& what) {
    result.faults.push_back("frame " + std::to_string(truth.frame) + " " + what);
  };
  for (const annotation::Frame& truth : sequence.truth.frames) {
    const pipeline::WorkPtr again = maker.decode();
    if (stop.stop_requested()) throw Interrupted();
    const auto after = stored.next();
    if (!again || !after) {
      fault(truth, again ? "is not in the video" : "is not in the background");
      break;
    }
    maker.locate(*again, truth.shake);
    const bool is_compared = truth.frame % every == 0;
    if (!is_compared && !maker.composes_in_order()) continue;
    maker.draw(*again);
    maker.compose(*again);
    if (!is_compared) continue;
    maker.describe(*again);
    if (stop.stop_requested()) throw Interrupted();
    ++result.compared;
    for (const std::string& what : frame_faults(sequence, truth, after->picture, *again))
      fault(truth, what);
  }
  return result;
}

}  // namespace airtruth::replay
