// SPDX-License-Identifier: Apache-2.0
#include "dataset/labelled/labelled_set.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "dataset/catalogue/expand.h"
#include "dataset/catalogue/folder.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/json/json_object.h"
#include "picture/composite/cover.h"
#include "picture/video/reader.h"
#include "sequence/frame/masks.h"
#include "sequence/replay/finished.h"
#include "truth/exchange/pixel_mask.h"

namespace airtruth::dataset {
namespace {

constexpr const char* kLabels = "labels.jsonl";
constexpr double kEarthRadiusM = 6'371'000;

// The visible horizon lies below the horizontal by its dip, sqrt(2 h / R), at the height h.
bool is_above_horizon(const Vector3& position_ned_m, const Vector3& camera_ned_m) {
  const Vector3 way = position_ned_m - camera_ned_m;
  const double elevation = std::atan2(-way.z(), std::hypot(way.x(), way.y()));
  const double dip = std::sqrt(2 * std::max(0.0, -camera_ned_m.z()) / kEarthRadiusM);
  return elevation > -dip;
}

std::optional<Box> box_of(const annotation::Intruder& intruder, Boxes boxes, const Box& frame) {
  if (intruder.state != annotation::State::kVisible) return std::nullopt;
  if (boxes != Boxes::kExact) {
    const auto& box = boxes == Boxes::kVisible ? intruder.visible_box_px : intruder.covered_box_px;
    return box ? std::optional(
                     Box{double(box->x), double(box->y), double(box->width), double(box->height)})
               : std::nullopt;
  }
  if (!intruder.exact_box_px) return std::nullopt;
  const Box& e = *intruder.exact_box_px;
  const double x = std::max(e.x, 0.0), y = std::max(e.y, 0.0);
  const Box cut{x, y, std::min(e.right(), frame.width) - x, std::min(e.bottom(), frame.height) - y};
  return cut.width > 0 && cut.height > 0 ? std::optional(cut) : std::nullopt;
}

exchange::Label label_of(const annotation::Intruder& intruder,
                         const annotation::Frame& frame,
                         std::int64_t track,
                         const Box& box) {
  exchange::Label label;
  label.track = track;
  label.category = category_of(intruder.aircraft);
  label.box_px = box;
  const double hidden = intruder.hidden_by_own_aircraft + intruder.hidden_by_intruder;
  label.visible = std::clamp(1 - hidden - intruder.cut_by_frame, 0.0, 1.0);
  label.occluded = hidden > 0;
  label.truncated = intruder.cut_by_frame > 0;
  label.range_m = intruder.range_m;
  if (intruder.position_ned_m)
    label.above_horizon = is_above_horizon(*intruder.position_ned_m, frame.camera_position_ned_m);
  return label;
}

// The pixels whose alpha is kCoveredAlpha or more; covered_box_px bounds them.
std::optional<exchange::PixelMask> pixels_of_mask(const sequence::Finished& finished,
                                                  const std::string& id,
                                                  std::int64_t frame) {
  const auto mask = sequence::read_alpha_mask(finished.folder, finished.truth.lens, id, frame);
  const auto box = mask ? composite::covered_box(*mask) : std::nullopt;
  if (!box) return std::nullopt;
  const auto width = static_cast<std::size_t>(mask->patch.width);
  return exchange::pixel_mask_of(mask->patch.width, mask->patch.height, *box, [&](int x, int y) {
    return mask->alpha[static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)] >=
           composite::kCoveredAlpha;
  });
}

exchange::Clip clip_of(const sequence::Finished& finished, Boxes boxes, bool with_masks) {
  exchange::Clip clip;
  clip.name = finished.name;
  clip.media = finished.video;
  clip.width = finished.truth.lens.width;
  clip.height = finished.truth.lens.height;
  clip.frame_rate_hz = video::Reader(finished.video, {.threads = 1}).info().frame_rate.value();
  const Box whole{0, 0, double(clip.width), double(clip.height)};
  for (const annotation::Frame& truth : finished.truth.frames) {
    exchange::LabelledFrame frame{truth.frame, truth.time_s, {}};
    for (std::size_t i = 0; i < truth.intruders.size(); ++i) {
      const annotation::Intruder& intruder = truth.intruders[i];
      const auto box = box_of(intruder, boxes, whole);
      if (!box) continue;
      frame.labels.push_back(label_of(intruder, truth, static_cast<std::int64_t>(i) + 1, *box));
      if (with_masks) frame.labels.back().mask = pixels_of_mask(finished, intruder.id, truth.frame);
    }
    clip.frames.push_back(std::move(frame));
  }
  return clip;
}

bool is_sequence(const fs::path& folder) { return fs::exists(folder / "sequence.json"); }

std::vector<std::string> sequences_in(const fs::path& folder) {
  std::vector<std::string> names;
  if (fs::is_directory(folder))
    for (const auto& entry : fs::directory_iterator(folder))
      // Hidden folders belong to runs that are under way or were killed.
      if (entry.is_directory() && !entry.path().filename().string().starts_with(".") &&
          is_sequence(entry.path()))
        names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace

const char* name(Boxes boxes) {
  return boxes == Boxes::kCovered ? "covered" : boxes == Boxes::kExact ? "exact" : "visible";
}

Boxes boxes_from_name(const std::string& name) {
  for (const Boxes boxes : {Boxes::kCovered, Boxes::kExact, Boxes::kVisible})
    if (name == dataset::name(boxes)) return boxes;
  throw Error("--boxes is '" + name + "'; expected covered, exact or visible");
}

std::string category_of(const std::string& aircraft) {
  const fs::path path(aircraft);
  if (path.has_extension()) return path.stem().string();
  return aircraft.substr(0, aircraft.find('/'));
}

LabelledSet::LabelledSet(const fs::path& root) : root_(root) {
  if (!fs::is_directory(root)) throw Error("is no folder", {root.string()});
  if (is_sequence(root)) {
    root_ = fs::absolute(root).lexically_normal();
    if (!root_.has_filename()) root_ = root_.parent_path();
    names_ = {root_.filename().string()};
    root_ = root_.parent_path();
    return;
  }
  const Folder folder{root};
  if (fs::is_directory(folder.sequences())) root_ = folder.sequences();
  names_ = sequences_in(root_);
  if (fs::exists(folder.catalogue())) {
    const Catalogue catalogue = read_catalogue(folder.catalogue());
    missing_ = Expansion(catalogue).size() - std::ssize(names_);
  }
  if (names_.empty())
    throw Error(
        "holds no finished sequence; expected what `airtruth dataset build`, `dataset import` "
        "or `render` has made",
        {root.string()});
}

fs::path LabelledSet::folder(const std::string& name) const { return root_ / name; }

bool LabelledSet::is_imported(const std::string& name) const {
  return fs::exists(folder(name) / kLabels);
}

exchange::Clip LabelledSet::clip(const std::string& name, Boxes boxes, bool with_masks) const {
  if (is_imported(name)) return exchange::read_labels(folder(name) / kLabels);
  if (boxes == Boxes::kCovered) expect_covered_boxes(name);
  const sequence::Finished finished = sequence::open_finished(folder(name));
  return clip_of(finished, boxes, with_masks && finished.scene && finished.scene->output.masks);
}

bool LabelledSet::has_covered_boxes(const std::string& name) const {
  if (is_imported(name)) return true;
  return JsonDocument(folder(name) / "sequence.json").has("covered_alpha");
}

void LabelledSet::expect_covered_boxes(const std::string& name) const {
  if (!has_covered_boxes(name))
    throw Error(
        "was made before truth had covered boxes (covered_box_px); expected --boxes visible or "
        "--boxes exact, or a sequence that is rendered again",
        {folder(name).string()});
}

Boxes LabelledSet::usual_boxes(const Warn& warn) const {
  for (const std::string& name : names_) {
    if (has_covered_boxes(name)) continue;
    airtruth::warn(warn,
                   folder(name).string() +
                       ": was made before truth had covered boxes (covered_box_px); the visible "
                       "boxes are taken");
    return Boxes::kVisible;
  }
  return Boxes::kCovered;
}

bool LabelledSet::has_masks(const std::string& name) const {
  return fs::is_directory(folder(name) / "masks");
}

ClipFacts LabelledSet::facts(const std::string& name) const {
  ClipFacts facts;
  facts.name = name;
  const fs::path file = folder(name) / "sequence.json";
  const JsonDocument record(file);
  std::set<std::string> categories;
  if (record.has("scene_toml")) {
    const scene::Scene scene = scene::parse_scene(record.text("scene_toml"), file);
    facts.background = scene.background.video.string();
    facts.frames = record.object("summary").count("frames");
    for (const scene::Intruder& intruder : scene.intruders)
      categories.insert(category_of(intruder.aircraft));
  } else {
    facts.background = record.maybe_text("media").value_or(name);
    facts.frames = record.count("frames");
    for (const std::string& category : record.texts("categories")) categories.insert(category);
  }
  facts.categories = {categories.begin(), categories.end()};
  return facts;
}

}  // namespace airtruth::dataset
