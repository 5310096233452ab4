// SPDX-License-Identifier: Apache-2.0
#include "sequence/pipeline/frame_by_frame.h"

#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "foundation/base/error.h"
#include "sequence/pipeline/frame_maker.h"

namespace airtruth::pipeline {

struct FrameByFrame::State {
  State(const scene::Scene& scene, const Options& wanted)
      : options(wanted),
        threads(options.threads > 0 ? options.threads : tbb::info::default_concurrency()) {
    OpenedScene opened = open_scene(scene, options);
    if (opened.backdrop) threads = 1;  // OpenGL's context belongs to one thread
    arena.initialize(arena_threads(threads));
    arena.execute([&] { maker.emplace(resolve(std::move(opened), options), options.stop); });
  }

  // The next frames through the stages up to `locate`, in order.
  std::vector<WorkPtr> located() {
    std::vector<WorkPtr> batch;
    while (!is_over && std::ssize(batch) < threads) {
      WorkPtr work = maker->decode();
      is_over = work == nullptr;
      if (is_over) break;
      maker->locate(*work);
      batch.push_back(std::move(work));
    }
    if (is_over && !options.stop.stop_requested()) maker->store_motion();
    return batch;
  }

  void finish(Work& work) {
    maker->compose(work);
    maker->describe(work);
  }

  void fill() {
    std::vector<WorkPtr> batch = located();
    tbb::parallel_for(std::size_t{0}, batch.size(), [&](std::size_t i) {
      maker->draw(*batch[i]);
      if (!maker->composes_in_order()) finish(*batch[i]);
    });
    if (options.stop.stop_requested()) throw Interrupted();
    for (WorkPtr& work : batch) {
      if (maker->composes_in_order()) finish(*work);
      ready.push_back(std::move(work));
    }
  }

  Options options;
  int threads = 1;
  tbb::task_arena arena;
  std::optional<FrameMaker> maker;
  bool is_over = false;
  std::deque<WorkPtr> ready;
};

FrameByFrame::FrameByFrame(const scene::Scene& scene, const Options& options)
    : state_(std::make_unique<State>(scene, options)) {}
FrameByFrame::~FrameByFrame() = default;

std::optional<FrameByFrame::Made> FrameByFrame::next() {
  State& state = *state_;
  if (state.options.stop.stop_requested()) throw Interrupted();
  if (state.ready.empty() && !state.is_over) state.arena.execute([&] { state.fill(); });
  if (state.ready.empty()) return std::nullopt;
  const WorkPtr work = std::move(state.ready.front());
  state.ready.pop_front();
  if (state.options.progress)
    state.options.progress(
        {work->frame.index + 1, state.maker->resolved().info.frame_count_estimate});
  return Made{std::move(work->frame), std::move(work->truth)};
}

const video::StreamInfo& FrameByFrame::info() const { return state_->maker->resolved().info; }
const lens::Lens& FrameByFrame::lens() const { return state_->maker->resolved().world.lens; }

}  // namespace airtruth::pipeline
