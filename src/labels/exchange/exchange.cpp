// SPDX-License-Identifier: Apache-2.0
#include "labels/exchange/exchange.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include <airtruth/labels.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/names.h"
#include "labels/annotation/object_class.h"
#include "labels/exchange/parts.h"
#include "labels/label_file/coco_numbers.h"
#include "labels/label_file/label_file.h"

namespace airtruth::exchange {
namespace {

struct About {
  Format format;
  const char* name;
  const char* title;
  ReadFormat* read;   // null: the format can only be written
  MakeWriter* write;  // null: the format can only be read
  const char* kept = "";
  const char* lost = "";
};

constexpr const char* kPictures =
    "positions, velocities, attitudes, the camera's motion and lens, light, the boxes of the "
    "other two kinds, frames in which the aircraft is hidden or outside: see truth.jsonl";

// What the formats of single objects lose beside.
constexpr const char* kCutSequence =
    "; of a sequence all before the first frame that shows the object whole and after the last "
    "that shows it; where it begins in the video";

constexpr std::array<About, 13> kAll = {{
    {Format::kCoco,
     "coco",
     "COCO, with videos and tracks",
     read_coco,
     coco_writer,
     "box, class, track, area, frame and time; visibility, occluded, truncated, range_m, "
     "above_horizon and contrast_to_noise as further keys, which COCO's readers pass over",
     ""},
    {Format::kYolo,
     "yolo",
     "YOLO",
     read_yolo,
     yolo_writer,
     "box (as shares of the picture), class",
     "track, time, visibility, occlusion, range, contrast, area"},
    {Format::kMot,
     "mot",
     "MOTChallenge",
     read_mot,
     mot_writer,
     "box, track, visibility; range in metres as the tenth column, which its readers pass over; "
     "the class of a track in tracks.txt, and as the number of the class where that was asked "
     "for; otherwise what is no aircraft is marked as not to be considered",
     "time stamps (a frame rate alone), occlusion and truncation as such, contrast, area, which "
     "distractors count neither way"},
    {Format::kVoc,
     "voc",
     "Pascal VOC",
     read_voc,
     voc_writer,
     "box (the whole pixels that it touches), class, truncated, occluded, contrast_to_noise as a "
     "further element",
     "track, time, visibility, range, area"},
    {Format::kCvat,
     "cvat",
     "CVAT for video 1.1",
     read_cvat,
     cvat_writer,
     "box, class, track, occluded; visible, truncated, range_m, above_horizon and "
     "contrast_to_noise as attributes",
     "time stamps, frame rate, area"},
    {Format::kAot,
     "aot",
     "Airborne Object Tracking",
     read_aot,
     aot_writer,
     "box, track, time in nanoseconds, range, above or below the horizon; the class and the "
     "contrast to noise as further keys of `blob`",
     "visibility, occlusion, truncation, area; the id of every aircraft is an `Airplane`, that of "
     "a bird a `Bird`, of a multirotor a `Drone`, of a balloon an `Airborne`; the range of what is "
     "no aircraft (a range marks an aircraft as planned); what is on the lens"},
    {Format::kOtb,
     "otb",
     "OTB",
     read_single_object,
     single_object_writer,
     "box",
     "class, time, visibility, occlusion, range, contrast, area"},
    {Format::kGot10k,
     "got10k",
     "GOT-10k",
     read_single_object,
     single_object_writer,
     "box, class, absence, truncation, visibility in eighths (steps of 15 %)",
     "time stamps, occlusion, range, contrast, area"},
    {Format::kVot,
     "vot",
     "VOT",
     read_single_object,
     single_object_writer,
     "box, class, occlusion, range and contrast to noise by frame",
     "time stamps, visibility, truncation, area"},
    {Format::kEvision, "evision", "E-Vision", read_evision, nullptr},
    {Format::kCsv, "csv", "frame,x,y,w,h", read_csv, nullptr},
    {Format::kWebdataset,
     "webdataset",
     "WebDataset",
     read_webdataset,
     webdataset_writer,
     "box, category, class, track, area, time, visibility, occluded, truncated, range_m, "
     "above_horizon, contrast_to_noise; size and frame rate of the clip",
     ""},
    {Format::kTable,
     "table",
     "the table",
     nullptr,
     table_writer,
     "a row for each box: part, sequence, frame of the video and time, category, class, track, "
     "area, visibility, occluded, truncated, range_m, above_horizon, contrast_to_noise; the truth "
     "of the intruder in rendered sequences; their encounters in encounters.csv",
     "pictures"},
}};

const About& about(Format format) { return *std::ranges::find(kAll, format, &About::format); }

// Gives each label the class that its category states. `stated`: Reading::classes.
void classify(std::vector<Clip>& clips,
              const std::map<std::string, std::string>& stated,
              const ReadOptions& options,
              const Warn& warn) {
  // By category, its class; empty where it states none.
  std::map<std::string, std::string> classes;
  std::map<std::string, std::int64_t> unknown;
  std::int64_t labels = 0, marked = 0;
  for (Clip& clip : clips)
    for (LabelledFrame& frame : clip.frames)
      for (Label& label : frame.labels) {
        ++labels;
        if (label.object_class == label_file::kIgnore) ++marked;
        const auto [known, is_new] = classes.try_emplace(label.category);
        if (is_new) {
          known->second = stated_class(label.category, options);
          if (const auto found = stated.find(label.category);
              known->second.empty() && found != stated.end())
            known->second = found->second;
        }
        // A mark of the box itself stays; of another class that the format states, the options may
        // make a third.
        if (label.object_class == label_file::kIgnore ||
            (!annotation::is_aircraft(label.object_class) &&
             !options.class_of.contains(label.category)))
          continue;
        if (!known->second.empty())
          label.object_class = known->second;
        else if (label.category != options.category)
          ++unknown[label.category];
      }
  for (const auto& [category, object_class] : options.class_of)
    if (!classes.contains(category))
      throw Error("no label has the category '" + category + "', for which a class is given");
  std::vector<std::string> words;
  for (const auto& [category, count] : unknown)
    words.push_back(fmt::format("'{}' ({})", category, count));
  if (!words.empty())
    airtruth::warn(warn,
                   fmt::format("{} categories state no class and count as aircraft: {}",
                               words.size(),
                               fmt::join(words, ", ")));
  if (marked > 0 && marked == labels)
    airtruth::warn(
        warn,
        fmt::format("all {} boxes are marked as counting neither way (iscrowd, difficult, "
                    "or 0 in MOT's seventh column), so that none counts",
                    labels));
}

}  // namespace

Format format_from_name(std::string_view name) {
  std::vector<std::string> names;
  for (const About& a : kAll) {
    if (name == a.name) return a.format;
    names.emplace_back(a.name);
  }
  throw Error(
      "unknown format '" + std::string(name) + "'" +
      did_you_mean(name, names, fmt::format("; expected one of {}", fmt::join(names, ", "))));
}

const char* name(Format format) { return about(format).name; }

bool can_write(Format format) { return about(format).write != nullptr; }

bool is_single_object(Format format) { return about(format).read == read_single_object; }

bool has_ignore_mark(Format format) {
  return format == Format::kCoco || format == Format::kVoc || format == Format::kMot ||
         format == Format::kWebdataset || format == Format::kTable;
}

Pictures pictures_of(Format format) {
  if (format == Format::kAot) return Pictures::kPngAlone;
  if (format == Format::kOtb || format == Format::kGot10k) return Pictures::kJpgExpected;
  if (format == Format::kTable) return Pictures::kNone;
  return Pictures::kAny;
}

Clip aircraft_alone(Clip clip) {
  for (LabelledFrame& frame : clip.frames)
    std::erase_if(frame.labels,
                  [](const Label& label) { return !annotation::is_aircraft(label.object_class); });
  return clip;
}

std::vector<Clip> arranged(Format format, const Clip& clip) {
  if (has_ignore_mark(format)) return {clip};
  if (!is_single_object(format)) {
    Clip counted = clip;
    for (LabelledFrame& frame : counted.frames)
      std::erase_if(frame.labels,
                    [](const Label& label) { return label.object_class == label_file::kIgnore; });
    return {std::move(counted)};
  }
  std::vector<Clip> clips;
  const Clip aircraft = aircraft_alone(clip);
  const std::vector<std::int64_t> tracks = tracks_of(aircraft);
  for (const std::int64_t track : tracks) {
    Clip one = aircraft;
    if (tracks.size() > 1) one.name += "-" + std::to_string(track);
    for (LabelledFrame& frame : one.frames) {
      std::erase_if(frame.labels, [&](const Label& label) { return label.track != track; });
      if (frame.labels.size() > 1) frame.labels.resize(1);
    }
    const auto shows = [](const LabelledFrame& frame) { return !frame.labels.empty(); };
    // A tracker that starts on a wing tip at the frame's edge learns the wing tip.
    const auto shows_whole = [](const LabelledFrame& frame) {
      return !frame.labels.empty() && !frame.labels.front().truncated.value_or(false);
    };
    auto first = std::ranges::find_if(one.frames, shows_whole);
    if (first == one.frames.end()) first = std::ranges::find_if(one.frames, shows);
    const auto last = std::find_if(one.frames.rbegin(), one.frames.rend(), shows).base();
    one.frames = {first, last};
    clips.push_back(std::move(one));
  }
  return clips;
}

std::optional<std::int64_t> frame_step(const Clip& clip) {
  const std::vector<LabelledFrame>& frames = clip.frames;
  if (frames.size() < 2) return std::nullopt;
  const std::int64_t step = frames[1].frame - frames[0].frame;
  for (std::size_t i = 2; i < frames.size(); ++i)
    if (frames[i].frame - frames[i - 1].frame != step) return std::nullopt;
  return step;
}

void add_names(ArrangedNames& names, const std::string& clip, const std::vector<Clip>& arranged) {
  for (const Clip& one : arranged)
    if (const auto [other, is_new] = names.emplace(one.name, clip); !is_new)
      throw Error(
          fmt::format("both '{}' and '{}' hold what is named '{}', where the objects of a "
                      "sequence are named NAME-TRACK; expected another name of one of them",
                      other->second,
                      clip,
                      one.name));
}

void expect_written(Format format) {
  if (can_write(format)) return;
  std::vector<std::string> names;
  for (const About& a : kAll)
    if (a.write != nullptr) names.emplace_back(a.name);
  throw Error(fmt::format("{} is a format that is read alone; expected one of {}",
                          name(format),
                          fmt::join(names, ", ")));
}

void expect_held(Format format, const Clip& clip) {
  if (format == Format::kYolo && (clip.width <= 0 || clip.height <= 0))
    throw Error(clip.name + " has no known size, of which YOLO's boxes are shares");
}

std::unique_ptr<Writer> make_writer(Format format,
                                    const fs::path& root,
                                    const WriteOptions& options) {
  expect_written(format);
  return about(format).write({format, root, options});
}

std::string stated_class(const std::string& category, const ReadOptions& options) {
  const auto asked = options.class_of.find(category);
  if (asked != options.class_of.end()) return asked->second;
  return std::string(annotation::class_of_category(category).value_or(""));
}

std::string loss(Format format) {
  const About& a = about(format);
  std::string text = std::string("# What ") + a.title + " keeps\n\n";
  text += std::string("Kept: ") + a.kept + ".\n\nLost: ";
  if (format == Format::kTable)
    return text + a.lost +
           ", the camera's motion and lens, light, the volumes of each frame, frames in which the "
           "aircraft is hidden or outside: see truth.jsonl.\n";
  if (*a.lost != 0)
    text += std::string(a.lost) + (is_single_object(format) ? kCutSequence : "") + "; ";
  text += kPictures;
  if (!has_ignore_mark(format)) text += "; boxes that count neither way, which are left out";
  if (format == Format::kCoco || format == Format::kAot)
    text += "; a class other than the one that the category's name states";
  else if (format != Format::kWebdataset)
    text += "; a class that the category's name does not state";
  text += ".\n\nFrames are counted anew where only every n-th was taken.\n";
  return text;
}

std::vector<Clip> read_clips(Format format,
                             const fs::path& source,
                             const ReadOptions& options,
                             const Warn& warn) {
  if (!fs::exists(source)) throw Error("does not exist", {source.string()});
  if (about(format).read == nullptr)
    throw Error(std::string(name(format)) + " is a format that is written alone",
                {source.string()});
  LeftOut left_out(warn);
  std::map<std::string, std::string> classes;
  std::size_t filled = 0;
  std::vector<Clip> clips =
      about(format).read({format, source, options, warn, left_out, classes, filled});
  classify(clips, classes, options, warn);
  for (const Clip& clip : clips)
    for (const LabelledFrame& frame : clip.frames)
      if (const auto repeated = label_file::repeated_track_in(frame))
        throw Error(fmt::format("'{}' {}", clip.name, *repeated), {source.string()});
  return clips;
}

namespace {

// Names of files and folders below the set's folder are made of them. A clip that was read may lie
// in folders of its own: "night/pass".
void expect_names_below(const Part& part) {
  if (part.name.empty() || part.name == "." || part.name == ".." ||
      part.name.find('/') != std::string::npos)
    throw Error("'" + part.name + "' is no name of a part; expected a plain file name");
  for (const Clip& clip : part.clips)
    if (const fs::path name(clip.name);
        name.is_absolute() || std::find(name.begin(), name.end(), "..") != name.end())
      throw Error("the clip's name '" + clip.name +
                  "' leads out of the set's folder; expected a name below it");
}

}  // namespace

void write_clips(Format format, const fs::path& folder, std::span<const Part> parts) {
  for (const Part& part : parts) expect_names_below(part);
  if (fs::exists(folder) && (!fs::is_directory(folder) || !fs::is_empty(folder)))
    throw Error("exists and is not empty; expected a new folder", {folder.string()});
  make_folders(folder);
  label_file::CocoNumbers numbers;
  WriteOptions options;
  options.with_images = false;
  std::set<std::string> categories;
  for (const Part& part : parts) {
    options.parts.push_back(part.name);
    for (const Clip& clip : part.clips) {
      numbers.add(clip);
      for (const LabelledFrame& frame : clip.frames)
        for (const Label& label : frame.labels) categories.insert(label.category);
    }
  }
  options.categories = {categories.begin(), categories.end()};
  options.category_ids = numbers.category_ids(categories, {});
  const auto writer = make_writer(format, folder, options);
  std::size_t clip_number = 0;
  for (const Part& part : parts) {
    ArrangedNames names;
    for (const Clip& clip : part.clips) {
      std::vector<Clip> clips = arranged(format, clip);
      if (format == Format::kCoco) numbers.number(clips.front(), clip_number++);
      if (is_single_object(format)) add_names(names, clip.name, clips);
      for (const Clip& one : clips)
        // Single-object toolkits refuse a sequence of one frame: they read its truth as four
        // numbers and not as a table.
        if (!is_single_object(format) || one.frames.size() > 1) writer->add(one, part.name);
    }
  }
  writer->finish();
}

}  // namespace airtruth::exchange
