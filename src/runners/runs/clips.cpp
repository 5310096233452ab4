// SPDX-License-Identifier: Apache-2.0
#include "runners/runs/clips.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "foundation/base/error.h"
#include "foundation/json/json_object.h"
#include "labels/annotation/truth.h"
#include "labels/exchange/exchange.h"
#include "picture/video/numbered_images.h"
#include "picture/video/still.h"
#include "scene/scene/scene.h"
#include "sequence/replay/finished.h"
#include "sequence/replay/recorded_inputs.h"

namespace airtruth::runs {
namespace {

video::ReaderOptions with_cuts(video::ReaderOptions options, bool wanted) {
  options.with_cuts = wanted;
  return options;
}

}  // namespace

DetectionClip clip_of(const labelled::LabelledSet& set, const std::string& name) {
  DetectionClip clip;
  clip.name = name;
  if (set.is_imported(name)) {
    const exchange::Clip labelled = set.clip(name);
    if (labelled.media.empty()) throw Error("'" + name + "' has no video");
    clip.media = labelled.media;
    clip.reading.picture_rate_hz = labelled.frame_rate_hz;
    clip.frame_step = exchange::frame_step(labelled).value_or(1);
    for (const exchange::LabelledFrame& frame : labelled.frames) clip.frames.push_back(frame.frame);
    return clip;
  }
  const replay::Finished finished = replay::open_finished(set.folder(name));
  clip.media = finished.video;
  clip.frames_of_truth = std::ssize(finished.truth.frames);
  clip.reading.picture_rate_hz = finished.picture_rate_hz;
  clip.lens = lens::lens_of(finished.truth.lens);
  if (finished.scene) clip.own_aircraft = finished.scene->background.mask;
  clip.sequence = finished.folder;
  return clip;
}

DetectionClip clip_of(const fs::path& video) {
  DetectionClip clip;
  clip.name = video::clip_name(video);
  clip.media = video;
  return clip;
}

std::vector<DetectionClip> backgrounds_of(const labelled::LabelledSet& set,
                                          const std::vector<std::string>& names,
                                          setup::SharedInputs& inputs,
                                          const Warn& warn) {
  using Part = std::tuple<fs::path, bool, std::int64_t, std::int64_t>;
  std::set<Part> seen;
  std::set<std::string> taken;
  std::vector<DetectionClip> clips;
  for (const std::string& name : names) {
    if (set.is_imported(name)) continue;
    const fs::path file = set.folder(name) / "sequence.json";
    scene::Background background =
        scene::parse_scene(JsonDocument(file).text("scene_toml"), file).background;
    const auto found = replay::find_input(background.video, set.folder(name), inputs);
    if (found) background.video = *found;
    const Part part{background.video,
                    found.has_value(),
                    background.first_frame,
                    background.frame_count.value_or(-1)};
    if (!seen.insert(part).second) continue;
    const std::string video = background.video.string();
    if (!found || (!fs::exists(background.video) && video.find('%') == std::string::npos)) {
      const std::string why = found ? "not there" : "another file now (its SHA-256 differs)";
      airtruth::warn(warn,
                     video + ": the background of '" + name + "' is " + why + "; it is left out");
      continue;
    }
    DetectionClip clip = clip_of(background.video);
    if (background.first_frame > 0 || background.frame_count)
      clip.name += fmt::format(".{}", background.first_frame);
    if (background.frame_count) clip.name += fmt::format("-{}", *background.frame_count);
    const std::string part_name = clip.name;
    for (int k = 2; !taken.insert(clip.name).second; ++k)
      clip.name = fmt::format("{}-{}", part_name, k);
    clip.own_aircraft = background.mask;
    clip.sequence = set.folder(name);
    clip.reading.first_frame = background.first_frame;
    clip.reading.picture_rate_hz = background.frame_rate_hz;
    clip.reading.frame_count = background.frame_count;
    clip.lens = lens::lens_of(annotation::read_truth(set.folder(name) / "truth.jsonl").lens);
    clips.push_back(std::move(clip));
  }
  return clips;
}

std::vector<results::ExpectedSequence> sequences_of(const labelled::LabelledSet& set) {
  std::vector<results::ExpectedSequence> sequences;
  for (const std::string& name : set.names()) {
    const labelled::ClipFacts facts = set.facts(name);
    results::ExpectedSequence& sequence =
        sequences.emplace_back(results::ExpectedSequence{name, 0, 0, facts.frames});
    sequence.categories = facts.categories;
    sequence.distractors = facts.distractors;
    if (!set.is_imported(name)) continue;
    const exchange::Clip clip = set.clip(name);
    sequence.category_ids = clip.category_ids;
    for (const exchange::LabelledFrame& frame : clip.frames) {
      sequence.pictures.push_back(frame.picture);
      sequence.image_ids.push_back(frame.image_id);
    }
  }
  return sequences;
}

lens::Lens guessed_lens(const video::StreamInfo& info) {
  const double width_of_height = info.sample_aspect.value();
  const double half_across = std::tan(radians(30.0)) / width_of_height;
  const double vertical_deg = degrees(2 * std::atan(half_across * info.height / info.width));
  return lens::pinhole_from_vertical_fov(vertical_deg, {info.width, info.height}, width_of_height);
}

ClipFrames::ClipFrames(const DetectionClip& clip, bool with_motion, const Warn& warn)
    : clip_(clip),
      reader_(clip.media, with_cuts(clip.reading, with_motion), warn),
      sequence_{clip.name,
                reader_.info().width,
                reader_.info().height,
                reader_.info().frame_rate.value() / static_cast<double>(clip.frame_step),
                clip.lens ? *clip.lens : guessed_lens(reader_.info())} {
  if (!reader_.info().is_rate_stated)
    throw Error(
        "is of numbered pictures, which state no rate; expected --frame-rate, or a set that "
        "was imported with it",
        {clip.media.string()});
  const lens::ImageSize size = sequence_.lens.size();
  if (size != lens::ImageSize{sequence_.width, sequence_.height})
    throw Error("has pictures of another size than its lens states", {clip.media.string()});
  if (clip.own_aircraft)
    sequence_.own_aircraft = std::make_shared<image::Mask>(
        video::read_mask(*clip.own_aircraft, sequence_.width, sequence_.height));
  if (with_motion)
    estimator_.emplace(sequence_.lens, motion::Options{}, sequence_.own_aircraft.get());
}

std::int64_t ClipFrames::count_estimate() const {
  if (!clip_.frames.empty()) return std::ssize(clip_.frames);
  const std::int64_t all = reader_.info().frame_count_estimate;
  if (clip_.reading.frame_count) return *clip_.reading.frame_count;
  return std::max<std::int64_t>(0, all - clip_.reading.first_frame);
}

std::optional<detector::FrameInput> ClipFrames::next() {
  if (!clip_.frames.empty() && index_ == std::ssize(clip_.frames)) return std::nullopt;
  // A cut among the frames without labels parts the labelled ones.
  bool begins_shot = false;
  do {
    frame_ = reader_.next();
    if (!frame_) {
      if (clip_.frames.empty() && index_ >= clip_.frames_of_truth) return std::nullopt;
      throw Error("ends before the labels of " + clip_.name + " do", {clip_.media.string()});
    }
    begins_shot = begins_shot || frame_->begins_shot;
  } while (!clip_.frames.empty() && frame_->index < clip_.frames[static_cast<std::size_t>(index_)]);
  detector::FrameInput input;
  input.index = index_++;
  input.time_s = frame_->time_s;
  input.picture = &frame_->picture;
  input.begins_shot = input.index == 0 || begins_shot;
  if (estimator_)
    input.turn =
        turn_of(estimator_->next(frame_->picture, frame_->time_s, frame_->damaged, begins_shot));
  return input;
}

// A fit of n corners with residuals of rms_px leaves the shift of a pixel uncertain by
// rms_px sqrt(3 / (2 n)): three unknowns from 2 n equations. A turn is the difference of two such
// rotations.
std::optional<detector::CameraTurn> ClipFrames::turn_of(const motion::FrameMotion& motion) {
  const auto before = std::exchange(before_, motion);
  if (!before || !motion::is_known(motion.state) || !motion::is_known(before->state) ||
      !motion.rotation || !before->rotation)
    return std::nullopt;
  detector::CameraTurn turn;
  turn.this_from_previous = (*motion.rotation * before->rotation->conjugate()).normalized();
  turn.error_px = motion.rms_px * std::sqrt(3.0 / std::max(1, motion.inliers));
  return turn;
}

}  // namespace airtruth::runs
