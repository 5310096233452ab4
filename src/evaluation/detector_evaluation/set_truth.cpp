// SPDX-License-Identifier: Apache-2.0
#include "evaluation/detector_evaluation/set_truth.h"

#include <algorithm>
#include <functional>
#include <map>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "encounter/separation/violation.h"
#include "evaluation/detector_evaluation/contrast_to_noise.h"
#include "evaluation/detector_evaluation/rendered_truth.h"
#include "evaluation/scores/ignored_regions.h"
#include "foundation/base/error.h"
#include "foundation/base/pattern.h"
#include "foundation/base/suggest.h"
#include "picture/video/numbered_frames.h"

namespace airtruth::detector_evaluation {
namespace {

constexpr const char* kIgnore = "ignore";
constexpr const char* kIgnoreFile = "ignore.csv";

scores::TruthObject object_of(const exchange::Label& label) {
  scores::TruthObject object;
  object.id = label.track;
  object.object_class = label.object_class;
  object.category = label.category;
  object.box_px = label.box_px;
  object.range_m = label.range_m;
  object.above_horizon = label.above_horizon;
  return object;
}

void add_encounters(scores::TruthSequence& truth) {
  std::map<std::int64_t, std::string> aircraft;
  for (const scores::TruthFrame& frame : truth.frames)
    for (const scores::TruthObject& object : frame.objects)
      if (object.is_aircraft()) aircraft.try_emplace(object.id, object.category);
  for (const auto& [id, category] : aircraft) {
    scores::TruthEncounter& encounter = truth.encounters.emplace_back();
    encounter.id = id;
    encounter.name = fmt::format("{} {}", category, id);
  }
}

scores::TruthSequence imported_truth(const labelled::LabelledSet& set, const std::string& name) {
  exchange::Clip clip = set.clip(name);
  scores::TruthSequence truth;
  truth.name = name;
  truth.media = clip.media;
  truth.background = clip.media.filename().string();
  truth.width = clip.width;
  truth.height = clip.height;
  truth.frame_rate_hz = clip.frame_rate_hz.value_or(0);
  for (const exchange::LabelledFrame& labelled : clip.frames) {
    scores::TruthFrame& frame = truth.frames.emplace_back();
    frame.frame = labelled.frame;
    frame.time_s = labelled.time_s.value_or(
        truth.frame_rate_hz > 0 ? static_cast<double>(labelled.frame) / truth.frame_rate_hz : 0);
    for (const exchange::Label& label : labelled.labels)
      if (label.object_class == kIgnore)
        frame.ignored_px.push_back(label.box_px);
      else
        frame.objects.push_back(object_of(label));
  }
  add_encounters(truth);
  return truth;
}

// Frames over the rate. Clips may hold every n-th frame of a video, so the span of the times comes
// first where they are known.
double duration_s(const scores::TruthSequence& truth) {
  const std::size_t frames = truth.frames.size();
  if (frames == 0) return 0;
  const double span_s = truth.frames.back().time_s - truth.frames.front().time_s;
  if (frames > 1 && span_s > 0)
    return span_s * static_cast<double>(frames) / static_cast<double>(frames - 1);
  return truth.frame_rate_hz > 0 ? static_cast<double>(frames) / truth.frame_rate_hz : 0;
}

void start_at_0(scores::TruthSequence& truth) {
  if (truth.frames.empty()) return;
  const double first_s = truth.frames.front().time_s;
  for (scores::TruthFrame& frame : truth.frames) frame.time_s -= first_s;
}

// Whether a region is for this sequence; then the number that its background's frames have more
// than the sequence's.
std::optional<std::int64_t> offset_of(const scores::IgnoredRegion& region,
                                      const scores::TruthSequence& truth,
                                      std::int64_t first_of_background) {
  if (matches(region.sequence, truth.name)) return 0;
  if (!truth.background.empty() && region.sequence == truth.background) return first_of_background;
  return std::nullopt;
}

void ignore_regions(const fs::path& file,
                    const std::vector<std::int64_t>& first_frames,
                    std::vector<scores::TruthSequence>& sequences) {
  for (const scores::IgnoredRegion& region : scores::read_ignored_regions(file)) {
    bool fits_any = false;
    for (std::size_t s = 0; s < sequences.size(); ++s) {
      const auto offset = offset_of(region, sequences[s], first_frames[s]);
      if (!offset) continue;
      fits_any = true;
      for (scores::TruthFrame& frame : sequences[s].frames) {
        const std::int64_t number = frame.frame + *offset;
        if (number >= region.first_frame && number <= region.last_frame.value_or(number))
          frame.ignored_px.push_back(region.box_px);
      }
    }
    if (!fits_any)
      throw Error("'" + region.sequence +
                      "' is neither a sequence of the set nor the file name of "
                      "a background",
                  {file.string(), region.line});
  }
}

// Sequences of which something is known, in words: "3 of 8 sequences".
using Known = std::function<bool(const scores::TruthSequence&)>;
bool any_object(const scores::TruthSequence& truth,
                const std::function<bool(const scores::TruthObject&)>& known) {
  for (const scores::TruthFrame& frame : truth.frames)
    for (const scores::TruthObject& object : frame.objects)
      if (object.is_aircraft() && known(object)) return true;
  return false;
}

void leave_out(SetTruth& set,
               const Known& is_known,
               const std::string& what,
               const std::string& where) {
  std::size_t shown = 0;
  std::size_t unknown = 0;
  for (const scores::TruthSequence& truth : set.sequences) {
    if (truth.encounters.empty()) continue;
    ++shown;
    unknown += is_known(truth) ? 0 : 1;
  }
  if (unknown > 0)
    set.left_out.push_back(fmt::format(
        "{} unknown for {} of {} sequences with an aircraft; {}", what, unknown, shown, where));
}

void say_what_is_missing(SetTruth& set, const std::string& volume) {
  std::int64_t never_seen = 0;
  for (const scores::TruthSequence& truth : set.sequences) never_seen += truth.never_seen;
  if (never_seen > 0)
    set.left_out.push_back(fmt::format(
        "{} intruders are never in view; shares of encounters leave them out", never_seen));
  leave_out(
      set,
      [](const scores::TruthSequence& truth) {
        return any_object(truth,
                          [](const scores::TruthObject& o) { return o.range_m.has_value(); });
      },
      "the range is",
      "detection by range, declaration ranges and AOT's measures leave them out");
  leave_out(
      set,
      [](const scores::TruthSequence& truth) { return truth.lens.has_value(); },
      "the lens is",
      "bearing errors and detection by azimuth leave them out");
  leave_out(
      set,
      [](const scores::TruthSequence& truth) {
        return std::any_of(truth.encounters.begin(), truth.encounters.end(), [](const auto& one) {
          return one.closest_approach_s.has_value();
        });
      },
      "the closest approach is",
      "times to it leave them out");
  if (!volume.empty())
    leave_out(
        set,
        [](const scores::TruthSequence& truth) {
          return std::any_of(truth.encounters.begin(), truth.encounters.end(), [](const auto& one) {
            return one.has_volume;
          });
        },
        "whether '" + volume + "' is violated is",
        "declarations in time leave them out");
}

void drop_hours_unless_all_known(SetTruth& set) {
  const auto unknown = std::count_if(set.sequences.begin(), set.sequences.end(), [](const auto& t) {
    return !(t.duration_s > 0);
  });
  if (unknown == 0) return;
  for (scores::TruthSequence& truth : set.sequences) truth.duration_s = 0;
  set.left_out.push_back(fmt::format(
      "the frame rate is unknown for {} of {} sequences; there are no false alarms an hour",
      unknown,
      set.sequences.size()));
}

void expect_volume(const SetTruth& set, const std::string& volume) {
  if (volume.empty() || encounter::named_volume(volume) != nullptr) return;
  for (const scores::TruthSequence& truth : set.sequences)
    for (const scores::TruthEncounter& one : truth.encounters)
      if (one.has_volume) return;
  const std::vector<std::string> names = encounter::volume_names();
  const auto nearest = nearest_spelling(volume, names);
  throw Error(fmt::format("--volume is '{}'{}; expected {}, or a volume of the scenes' own",
                          volume,
                          nearest ? " (did you mean '" + *nearest + "'?)" : "",
                          fmt::join(names, ", ")));
}

}  // namespace

SetTruth set_truth(const fs::path& folder, const SetTruthOptions& options) {
  const labelled::LabelledSet set(folder);
  const dataset::Boxes boxes = set.usual_boxes(options.warn);
  SetTruth result;
  std::vector<std::int64_t> first_frames;
  std::size_t weighted = 0;
  for (const std::string& name : set.names()) {
    if (set.is_imported(name)) {
      result.sequences.push_back(imported_truth(set, name));
      first_frames.push_back(0);
    } else {
      RenderedTruth rendered = rendered_truth(set.folder(name), boxes, options.volume);
      result.sequences.push_back(std::move(rendered.truth));
      first_frames.push_back(rendered.first_background_frame);
      weighted += rendered.has_weight ? 1 : 0;
    }
    scores::TruthSequence& truth = result.sequences.back();
    truth.name = name;
    start_at_0(truth);
    truth.duration_s = duration_s(truth);
  }
  result.is_weighted = weighted > 0;
  if (result.is_weighted && weighted < result.sequences.size())
    result.left_out.push_back(
        fmt::format("{} of {} sequences have no encounter weight; weighted shares count them with "
                    "a weight of 1",
                    result.sequences.size() - weighted,
                    result.sequences.size()));
  expect_volume(result, options.volume);
  fs::path ignore = options.ignore;
  if (ignore.empty() && fs::exists(folder / kIgnoreFile)) ignore = folder / kIgnoreFile;
  if (!ignore.empty()) ignore_regions(ignore, first_frames, result.sequences);
  drop_hours_unless_all_known(result);
  say_what_is_missing(result, options.volume);
  return result;
}

void measure_contrast(scores::TruthSequence& truth, const std::stop_token& stop) {
  if (truth.media.empty()) return;
  video::NumberedFrames frames(truth.media, {});
  for (scores::TruthFrame& frame : truth.frames) {
    if (stop.stop_requested()) throw Interrupted();
    if (frame.objects.empty()) continue;
    const image::Picture* picture = frames.at(frame.frame);
    if (picture == nullptr)
      throw Error("ends before the labels of " + truth.name + " do", {truth.media.string()});
    for (scores::TruthObject& object : frame.objects)
      object.contrast_to_noise = contrast_to_noise(*picture, pixels_of(object.box_px));
  }
}

}  // namespace airtruth::detector_evaluation
