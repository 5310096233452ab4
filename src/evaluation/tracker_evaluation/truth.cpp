// SPDX-License-Identifier: Apache-2.0
#include "evaluation/tracker_evaluation/truth.h"

#include <algorithm>
#include <set>

#include "camera/lens/lens.h"
#include "foundation/image/contrast_to_noise.h"
#include "labels/exchange/exchange.h"
#include "picture/video/numbered_frames.h"
#include "runners/results/trajectories.h"
#include "sequence/replay/finished.h"

namespace airtruth::tracker_evaluation {
namespace {

std::optional<lens::Lens> lens_of(const labelled::LabelledSet& set, const std::string& name) {
  if (set.is_imported(name)) return std::nullopt;
  return lens::lens_of(replay::open_finished(set.folder(name)).truth.lens);
}

PixelBox covered(const Box& box) {
  const PixelBox touched = pixels_of(box);
  return {touched.x, touched.y, std::max(1, touched.width), std::max(1, touched.height)};
}

}  // namespace

std::vector<TruthClip> truths_of(const labelled::LabelledSet& set) {
  std::vector<TruthClip> truths;
  exchange::ArrangedNames names;
  for (const std::string& name : set.names()) {
    const auto lens = lens_of(set, name);
    const labelled::ClipFacts facts = set.facts(name);
    const std::string sha256 = set.sha256_of(name);
    const exchange::Clip whole = set.clip(name);
    std::vector<exchange::Clip> clips = exchange::arranged(exchange::Format::kOtb, whole);
    exchange::add_names(names, name, clips);
    for (exchange::Clip& clip : clips) {
      TruthClip& truth = truths.emplace_back();
      truth.contrast.resize(clip.frames.size());
      truth.first_place = std::ranges::count_if(
          whole.frames, [&](const auto& frame) { return frame.frame < clip.frames.front().frame; });
      truth.clip = std::move(clip);
      truth.lens = lens;
      truth.background = facts.background_name;
      truth.weather = facts.weather;
      truth.sha256 = sha256;
    }
  }
  results::expect_own_files(names);
  std::ranges::sort(
      truths, {}, [](const TruthClip& one) -> auto& { return one.clip.name; });
  return truths;
}

void add_film(TruthClip& truth, std::size_t stills, const std::stop_token& stop) {
  if (truth.clip.media.empty()) return;
  const std::size_t count = truth.clip.frames.size();
  const std::set<std::size_t> wanted = drawing::spread_over(count, stills);
  video::NumberedFrames pictures(truth.clip.media, {});
  for (std::size_t i = 0; i < count; ++i) {
    const image::Picture& picture =
        pictures.labelled(truth.clip.frames[i].frame, truth.clip.name, stop);
    const std::optional<Box> box = truth.box(i);
    if (box) truth.contrast[i] = image::contrast(picture, covered(*box));
    if (wanted.contains(i)) truth.stills.push_back(drawing::still_of(picture, i, box, kClose));
  }
}

}  // namespace airtruth::tracker_evaluation
