// SPDX-License-Identifier: Apache-2.0
#include "sequence/replay/finished.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include <airtruth/labels.h>
#include <fmt/format.h>

#include "foundation/base/error.h"
#include "foundation/base/file_state.h"
#include "foundation/geometry/box.h"
#include "foundation/image/colour.h"
#include "foundation/json/json_object.h"
#include "picture/video/reader.h"
#include "picture/video/writer.h"
#include "sequence/insertion/masks.h"
#include "sequence/insertion/paint.h"
#include "sequence/pipeline/frame_maker.h"
#include "sequence/pipeline/resolved_scene.h"
#include "sequence/replay/recorded_inputs.h"
#include "sequence/setup/moment.h"
#include "sequence/setup/shared_inputs.h"
#include "show/drawing/pictures.h"

namespace airtruth::replay {
namespace {

// Every frame up to the last that is labelled is held, and numbers in the names of pictures can be
// anything: 9 hours at 30 frames/s.
constexpr std::int64_t kMaxFrames = 1'000'000;

video::Frame frame_at(const fs::path& path, std::int64_t index) {
  auto frame = video::Reader(path, {.first_frame = index, .frame_count = 1}).next();
  if (!frame) throw Error("holds no frame " + std::to_string(index), {path.string()});
  return std::move(*frame);
}

std::size_t intruder_index(const annotation::Frame& truth, const std::string& id) {
  for (std::size_t i = 0; i < truth.intruders.size(); ++i) {
    const annotation::Intruder& intruder = truth.intruders[i];
    const bool drawn = intruder.visible_box_px || intruder.state == annotation::State::kHidden;
    if (intruder.exact_box_px && (id.empty() ? drawn : intruder.id == id)) return i;
  }
  throw Error("frame " + std::to_string(truth.frame) + " shows no intruder" +
              (id.empty() ? "" : " '" + id + "'") +
              "; expected a frame in which one is in view (see truth.jsonl)");
}

PixelBox area_around(const Box& box, const lens::Facts& lens) {
  // What passes near by has a box of any size, of which the frame is what can be seen.
  const double seen_px = std::min(std::max(box.width, box.height),
                                  static_cast<double>(std::max(lens.width, lens.height)));
  const double margin = std::max(4.0, 0.25 * seen_px);
  const double x0 = std::max(box.x, -8.0) - margin;
  const double y0 = std::max(box.y, -8.0) - margin;
  const double x1 = std::min(box.right(), lens.width + 8.0) + margin;
  const double y1 = std::min(box.bottom(), lens.height + 8.0) + margin;
  PixelBox area = pixels_of({x0, y0, x1 - x0, y1 - y0});
  area.width = std::max(1, area.width);
  area.height = std::max(1, area.height);
  return area;
}

// Boxes of an imported clip, in the form of a rendered sequence's truth.
annotation::Frame frame_of(const exchange::Clip& clip, const exchange::LabelledFrame& labelled) {
  annotation::Frame frame;
  frame.frame = labelled.frame;
  frame.time_s = clip.time_s_of(labelled).value_or(0);
  for (const exchange::Label& label : labelled.labels) {
    annotation::Intruder& intruder = frame.intruders.emplace_back();
    intruder.id = label.category + " " + std::to_string(label.track);
    intruder.aircraft = label.category;
    intruder.object_class = label.object_class;
    intruder.state = annotation::State::kVisible;
    intruder.exact_box_px = label.box_px;
    intruder.visible_box_px = pixels_of(label.box_px);
    intruder.range_m = label.range_m;
  }
  return frame;
}

// The mean rate of the frames' times.
std::optional<double> rate_of(const std::vector<annotation::Frame>& frames) {
  if (frames.size() < 2 || !(frames.back().time_s > frames.front().time_s)) return std::nullopt;
  return static_cast<double>(frames.back().frame - frames.front().frame) /
         (frames.back().time_s - frames.front().time_s);
}

Finished open_labelled(const fs::path& folder) {
  const exchange::Clip clip = exchange::read_labels(folder / "labels.jsonl");
  Finished finished{.folder = folder,
                    .name = clip.name,
                    .video = clip.media,
                    .picture_rate_hz = clip.frame_rate_hz};
  if (clip.media.empty()) throw Error("names no video", {(folder / "labels.jsonl").string()});
  for (const exchange::LabelledFrame& frame : clip.frames) {
    if (frame.frame >= kMaxFrames)
      throw Error(fmt::format("labels frame {}; expected frames below {}", frame.frame, kMaxFrames),
                  {(folder / "labels.jsonl").string()});
    while (std::ssize(finished.truth.frames) < frame.frame)
      finished.truth.frames.push_back(frame_of(clip, {.frame = std::ssize(finished.truth.frames)}));
    finished.truth.frames.push_back(frame_of(clip, frame));
  }
  return finished;
}

}  // namespace

Finished open_finished(const fs::path& folder) {
  if (fs::exists(folder / "labels.jsonl")) return open_labelled(folder);
  const fs::path record_file = folder / "sequence.json";
  if (!fs::exists(record_file))
    throw Error("holds no sequence.json; expected a folder that `airtruth render` has finished",
                {folder.string()});
  Finished finished{.folder = folder};
  const JsonDocument record(record_file);
  finished.name = record.text("name");
  // A manipulated record must not name files outside its folder.
  if (!is_plain_file_name(finished.name))
    throw Error("name is '" + finished.name.substr(0, 80) + "'; expected " + kPlainFileName,
                {record_file.string()});
  finished.encounters = pipeline::read_encounter_records(record);
  finished.scene = scene::parse_scene(record.text("scene_toml"), record_file);
  const auto format = finished.scene->output.video;
  finished.video = folder / (finished.name + video::extension(format));
  if (!fs::exists(finished.video))
    throw Error("is missing; the folder is not whole", {finished.video.string()});
  const fs::path truth_file = folder / "truth.jsonl";
  finished.truth = annotation::read_truth(truth_file);
  const std::int64_t frames = record.object("summary").count("frames");
  if (std::ssize(finished.truth.frames) != frames)
    throw Error(fmt::format("has {} lines; expected {}, one for each frame of the video",
                            finished.truth.frames.size(),
                            frames),
                {truth_file.string()});
  finished.picture_rate_hz = rate_of(finished.truth.frames);
  return finished;
}

std::vector<std::string> intruder_ids(const annotation::Truth& truth) {
  std::vector<std::string> ids;
  for (const annotation::Frame& frame : truth.frames)
    for (const annotation::Intruder& intruder : frame.intruders)
      if (std::find(ids.begin(), ids.end(), intruder.id) == ids.end()) ids.push_back(intruder.id);
  return ids;
}

void write_overlay(const Finished& sequence, const fs::path& out, const OverlayOptions& options) {
  check_output_file(out, options.overwrite);
  video::WriterOptions writer_options;
  writer_options.format = video::format_of_file(out);
  if (sequence.scene) writer_options.quality = sequence.scene->output.quality;
  video::Reader reader(sequence.video, {.picture_rate_hz = sequence.picture_rate_hz});
  video::StreamInfo info = reader.info();
  video::Writer writer(out, info, writer_options);
  const auto total = static_cast<std::int64_t>(sequence.truth.frames.size());
  const std::vector<std::string> ids = intruder_ids(sequence.truth);
  std::int64_t shown = 0;
  while (auto frame = reader.next()) {
    if (options.stop.stop_requested()) throw Interrupted();
    if (frame->index >= total) {
      // An imported clip may end before its video.
      if (!sequence.scene) break;
      throw Error("holds more frames than truth.jsonl", {sequence.video.string()});
    }
    const auto& truth = sequence.truth.frames[static_cast<std::size_t>(frame->index)];
    frame->picture = image::picture_from_rgb8(drawing::overlay(frame->picture, truth, ids),
                                              frame->picture.colour);
    writer.write(*frame);
    shown = frame->index + 1;
    if (options.progress) options.progress(shown, total);
  }
  if (sequence.scene && shown < total)
    throw Error(
        fmt::format("holds {} frames; expected {}, one for each line of truth.jsonl", shown, total),
        {sequence.video.string()});
  writer.finish();
}

image::Rgb8 inspect(const Finished& sequence,
                    std::int64_t frame,
                    const std::string& intruder_id,
                    int zoom) {
  if (!sequence.scene)
    throw Error("was imported, so that its background is not known", {sequence.folder.string()});
  const auto count = static_cast<std::int64_t>(sequence.truth.frames.size());
  if (frame < 0 || frame >= count)
    throw Error("frame " + std::to_string(frame) + " does not exist; expected 0 to " +
                    std::to_string(count - 1),
                {sequence.folder.string()});
  const annotation::Frame& truth = sequence.truth.frames[static_cast<std::size_t>(frame)];
  const std::size_t i = intruder_index(truth, intruder_id);
  setup::SharedInputs inputs;
  const scene::Scene scene = scene_as_made(sequence, inputs);
  const video::Frame before =
      frame_at(scene.background.video, scene.background.first_frame + frame);
  const video::Frame after = frame_at(sequence.video, frame);
  // Of the chroma-key method, whose layer is not shown, no OpenGL is opened.
  const pipeline::ResolvedScene resolved = pipeline::resolved_by_truth(
      pipeline::open_scene(scene, {.use_cache = false, .is_preview = true}));
  const setup::Moment moment =
      setup::moment_at(resolved.world, truth.frame, truth.time_s, annotation::shake_of(truth));
  const bool matte = scene.composite.method == scene::CompositeMethod::kMatte;
  const image::Layer layer =
      insertion::render_layer(resolved.scene,
                              resolved.world,
                              moment,
                              insertion::Ambient{},
                              resolved.occluders.in_frame(moment, before.picture).occlusion);
  return drawing::closeup({&before.picture, &after.picture, matte ? &layer : nullptr},
                          truth,
                          area_around(*truth.intruders[i].exact_box_px, sequence.truth.lens),
                          zoom);
}

namespace {

// Mean difference of luma over a part of two pictures.
double difference(const image::Picture& a, const image::Picture& b, const PixelBox& area) {
  std::int64_t sum = 0;
  for (int y = area.y; y < area.bottom(); ++y)
    for (int x = area.x; x < area.right(); ++x)
      sum += std::abs(int{image::luma_at(a, x, y)} - int{image::luma_at(b, x, y)});
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
    maker.locate(*again, annotation::shake_of(truth));
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
