// SPDX-License-Identifier: Apache-2.0
#include <airtruth/renderer.h>

#include "library/pictures/public_forms.h"
#include "library/records/public_forms.h"
#include "scene/scene/scene.h"
#include "sequence/pipeline/frame_by_frame.h"

namespace airtruth {
namespace {

pipeline::Options options_from(const RenderOptions& wanted) {
  pipeline::Options options = run_options(wanted);
  if (wanted.progress)
    options.progress = [progress = wanted.progress](const pipeline::Progress& now) {
      progress(now.frames_done, now.frames_total);
    };
  return options;
}

}  // namespace

struct Renderer::State {
  pipeline::FrameByFrame frames;
};

Renderer::Renderer(std::unique_ptr<State> state) : state_(std::move(state)) {}

Renderer::Renderer(const std::filesystem::path& scene_file, const RenderOptions& options)
    : Renderer(std::unique_ptr<State>(new State{
          pipeline::FrameByFrame(scene::read_scene(scene_file), options_from(options))})) {}

Renderer Renderer::from_text(std::string_view scene,
                             const std::filesystem::path& folder,
                             const RenderOptions& options) {
  return Renderer(std::unique_ptr<State>(new State{
      pipeline::FrameByFrame(scene::parse_scene(scene, folder / "scene"), options_from(options))}));
}

Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

std::optional<RenderedFrame> Renderer::next() {
  auto made = state_->frames.next();
  if (!made) return std::nullopt;
  return RenderedFrame{public_picture(made->frame.picture), std::move(made->truth)};
}

VideoInfo Renderer::info() const { return public_info(state_->frames.info()); }
Lens Renderer::lens() const { return public_lens(state_->frames.lens()); }

}  // namespace airtruth
