// SPDX-License-Identifier: Apache-2.0
#include "sequence/pipeline/frame_maker.h"

#include <algorithm>

#include <fmt/format.h>
#include <tbb/global_control.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/names.h"
#include "sequence/insertion/frame_truth.h"

namespace airtruth::pipeline {

FrameMaker::FrameMaker(ResolvedScene resolved, const std::stop_token& stop)
    : resolved_(std::move(resolved)),
      stop_(stop),
      painter_(resolved_.scene,
               resolved_.world,
               resolved_.occluders,
               std::move(resolved_.backdrop),
               stop),
      ambient_(resolved_.scene.light, resolved_.scene.camera_model, resolved_.mask.get()) {}

WorkPtr FrameMaker::decode() {
  if (stop_.stop_requested()) return nullptr;
  auto frame = resolved_.background->next();
  if (!frame) return nullptr;
  auto work = std::make_shared<Work>();
  work->frame = std::move(*frame);
  return work;
}

void FrameMaker::locate(Work& work) {
  work.moved = resolved_.motion->next(work.frame);
  locate(work, work.moved.shake);
}

void FrameMaker::locate(Work& work, const Shake& shake) {
  work.moved.shake = shake;
  work.moment = setup::moment_at(resolved_.world, work.frame.index, work.frame.time_s, shake);
  work.ambient = ambient_.next(work.frame.picture,
                               work.moment.sight,
                               setup::search_bounds(work.moment),
                               work.frame.begins_shot);
}

void FrameMaker::draw(Work& work) const {
  work.painted = painter_.draw(work.frame.picture, work.moment, work.ambient);
}

void FrameMaker::compose(Work& work) {
  painter_.compose(work.frame.picture, work.moment, work.ambient, work.painted);
}

void FrameMaker::describe(Work& work) const {
  const bool has_motion = resolved_.scene.motion.model != scene::MotionModel::kNone;
  const char* state = has_motion ? enum_name(work.moved.motion.state) : "none";
  work.truth = insertion::frame_truth(
      resolved_.world, work.frame, state, work.moved.shake, work.moment, work.painted);
  if (resolved_.scene.output.masks)
    work.masks = insertion::mask_files(work.truth, work.painted.layer, resolved_.world.lens.size());
  work.painted.layer = {};
  work.painted.visible = {};
}

int arena_threads(int wanted) {
  const auto most = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  return std::min(wanted, static_cast<int>(most));
}

}  // namespace airtruth::pipeline
