// SPDX-License-Identifier: Apache-2.0
#include "runners/runs/clip_frames.h"

#include <cmath>

#include "foundation/base/error.h"
#include "picture/video/still.h"

namespace airtruth::runs {
namespace {

video::ReaderOptions reader_options(const DetectionClip& clip, bool with_motion) {
  video::ReaderOptions options;
  options.first_frame = clip.first_frame;
  options.frame_count = clip.frame_count;
  options.threads = 1;
  options.with_cuts = with_motion;
  return options;
}

}  // namespace

ClipFrames::ClipFrames(const DetectionClip& clip, bool with_motion, const Warn& warn)
    : clip_(clip),
      reader_(clip.media, reader_options(clip, with_motion), warn),
      sequence_{
          clip.name,
          reader_.info().width,
          reader_.info().height,
          reader_.info().frame_rate.value(),
          clip.lens ? *clip.lens : guessed_lens(reader_.info().width, reader_.info().height)} {
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
  if (clip_.frame_count) return *clip_.frame_count;
  return all > clip_.first_frame ? all - clip_.first_frame : 0;
}

std::optional<detector::FrameInput> ClipFrames::next() {
  if (!clip_.frames.empty() && index_ == std::ssize(clip_.frames)) return std::nullopt;
  do {
    frame_ = reader_.next();
    if (!frame_) {
      if (clip_.frames.empty()) return std::nullopt;
      throw Error("ends before the labels of " + clip_.name + " do", {clip_.media.string()});
    }
  } while (!clip_.frames.empty() && frame_->index < clip_.frames[static_cast<std::size_t>(index_)]);
  detector::FrameInput input;
  input.index = index_++;
  input.time_s = frame_->time_s;
  input.picture = &frame_->picture;
  input.begins_shot = input.index == 0 || frame_->begins_shot;
  if (estimator_)
    input.turn = turn_of(
        estimator_->next(frame_->picture, frame_->time_s, frame_->damaged, frame_->begins_shot));
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
