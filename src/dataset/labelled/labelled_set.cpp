// SPDX-License-Identifier: Apache-2.0
#include "dataset/labelled/labelled_set.h"

#include "dataset/catalogue/expand.h"
#include "dataset/catalogue/folder.h"
#include "foundation/base/files.h"
#include "foundation/json/json_object.h"
#include "labels/pixel_mask/pixel_mask.h"
#include "picture/composite/cover.h"
#include "picture/video/reader.h"
#include "scene/scene/camera_keys.h"
#include "sequence/insertion/masks.h"
#include "sequence/replay/finished.h"

namespace airtruth::labelled {
namespace {

// The pixels whose alpha is kCoveredAlpha or more; covered_box_px bounds them.
std::optional<exchange::PixelMask> pixels_of_mask(const replay::Finished& finished,
                                                  const std::string& id,
                                                  std::int64_t frame) {
  const auto mask = insertion::read_alpha_mask(finished.folder, finished.truth.lens, id, frame);
  const auto covered = mask ? composite::covered(*mask) : std::nullopt;
  if (!covered) return std::nullopt;
  const PixelBox& patch = mask->patch;
  const auto width = static_cast<std::size_t>(patch.width);
  return pixel_mask::pixel_mask_of(patch.width, patch.height, covered->box, [&](int x, int y) {
    return mask->alpha[static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)] >=
           composite::kCoveredAlpha;
  });
}

std::optional<double> rate_of(const replay::Finished& finished) {
  const video::StreamInfo info = video::Reader(finished.video, {.threads = 1}).info();
  return info.is_rate_stated ? info.frame_rate.value() : finished.picture_rate_hz;
}

exchange::Clip clip_of(const replay::Finished& finished, dataset::Boxes boxes, bool with_masks) {
  exchange::Clip clip;
  clip.name = finished.name;
  clip.media = finished.video;
  clip.width = finished.truth.lens.width;
  clip.height = finished.truth.lens.height;
  clip.frame_rate_hz = rate_of(finished);
  for (const annotation::Frame& truth : finished.truth.frames) {
    clip.frames.push_back(sequences::labels_of(truth, boxes, clip.width, clip.height));
    if (!with_masks) continue;
    for (exchange::Label& label : clip.frames.back().labels) {
      const auto& intruder = truth.intruders[static_cast<std::size_t>(label.track) - 1];
      label.mask = pixels_of_mask(finished, intruder.id, truth.frame);
    }
  }
  return clip;
}

}  // namespace

LabelledSet::LabelledSet(const fs::path& root) : folders_(sequences::sequence_folders(root)) {
  if (fs::exists(root / "sequence.json")) return;  // a single sequence
  const catalogue::Folder folder{root};
  if (fs::exists(folder.catalogue())) {
    const catalogue::Catalogue catalogue = catalogue::read_catalogue(folder.catalogue());
    missing_ = catalogue::Expansion(catalogue).size() - std::ssize(names());
  }
  if (names().empty()) throw sequences::no_sequence_in(root);
}

fs::path LabelledSet::folder(const std::string& name) const { return folders_.folder(name); }

bool LabelledSet::is_imported(const std::string& name) const {
  return fs::exists(folder(name) / sequences::kLabels);
}

std::string LabelledSet::sha256_of(const std::string& name) const {
  return sha256_of_file(folder(name) / (is_imported(name) ? sequences::kLabels : "sequence.json"));
}

exchange::Clip LabelledSet::clip(const std::string& name,
                                 dataset::Boxes boxes,
                                 bool with_masks) const {
  if (is_imported(name)) return exchange::read_labels(folder(name) / sequences::kLabels);
  const replay::Finished finished = replay::open_finished(folder(name));
  return clip_of(finished, boxes, with_masks && finished.scene && finished.scene->output.masks);
}

ClipFacts LabelledSet::facts(const std::string& name) const {
  ClipFacts facts;
  facts.name = name;
  const fs::path file = folder(name) / "sequence.json";
  const JsonDocument record(file);
  if (record.has("scene_toml")) {
    const scene::Scene scene = scene::parse_scene(record.text("scene_toml"), file);
    facts.background = scene.background.video.string();
    facts.background_name = scene.background.name;
    facts.weather = scene::weather_facts(scene);
    facts.frames = record.object("summary").count("frames");
    for (const scene::Intruder& intruder : scene.intruders)
      if (is_aircraft(intruder))
        facts.categories.insert(sequences::category_of(intruder.aircraft));
      else
        facts.distractors.insert(enum_name(intruder.distractor->kind));
    for (const scene::LensMark& mark : scene.lens_marks)
      facts.distractors.insert(enum_name(mark.kind));
    facts.categories.insert(facts.distractors.begin(), facts.distractors.end());
  } else {
    facts.background = record.maybe_text("media").value_or(name);
    if (fs::exists(folder(name) / sequences::kPictureList)) facts.background_name = name;
    facts.frames = record.count("frames");
    for (const std::string& category : record.texts("categories"))
      facts.categories.insert(category);
  }
  if (facts.background_name.empty())
    facts.background_name = fs::path(facts.background).filename().string();
  if (record.has("distractors"))
    for (const std::string& kind : record.texts("distractors")) facts.distractors.insert(kind);
  return facts;
}

}  // namespace airtruth::labelled
