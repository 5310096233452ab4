// SPDX-License-Identifier: Apache-2.0
#include "dataset/labelled/import.h"

#include <set>

#include <airtruth/version.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "foundation/base/error.h"
#include "foundation/base/file_state.h"
#include "foundation/base/files.h"
#include "foundation/base/names.h"
#include "labels/annotation/object_class.h"
#include "picture/video/numbered_images.h"
#include "picture/video/reader.h"
#include "picture/video/still.h"

namespace airtruth::labelled {
namespace {

using Json = nlohmann::ordered_json;

// The reader takes numbered pictures in the order of their numbers, beginning with the first.
// Labels match them only where every picture has its own label.
void match_pictures(exchange::Clip& clip, const Warn& warn) {
  if (clip.media.empty() || fs::is_regular_file(clip.media)) return;
  const auto images = video::numbered_images(clip.media);
  const std::size_t pictures = images ? images->files.size() : 0;
  if (pictures != clip.frames.size()) {
    airtruth::warn(warn,
                   clip.media.string() + ": holds " + std::to_string(pictures) +
                       " pictures, and there are labels for " + std::to_string(clip.frames.size()) +
                       " frames of " + clip.name + "; they are imported without the pictures");
    clip.media.clear();
    return;
  }
  for (std::size_t i = 0; i < clip.frames.size(); ++i)
    clip.frames[i].frame = static_cast<std::int64_t>(i);
}

// Fills in sizes, rates and times that the labels lack and the video states.
void ask_video(exchange::Clip& clip, const Warn& warn) {
  if (clip.media.empty()) return;
  const video::StreamInfo info = video::Reader(clip.media, {.threads = 1}, warn).info();
  if (clip.width == 0) {
    clip.width = info.width;
    clip.height = info.height;
  } else if (clip.width != info.width || clip.height != info.height) {
    throw Error("is " + std::to_string(info.width) + "x" + std::to_string(info.height) +
                    ", and the labels of " + clip.name + " are for " + std::to_string(clip.width) +
                    "x" + std::to_string(clip.height),
                {clip.media.string()});
  }
  const bool is_video = fs::is_regular_file(clip.media);
  if (!clip.frame_rate_hz && is_video) clip.frame_rate_hz = info.frame_rate.value();
  const std::int64_t labelled = clip.frames.empty() ? 0 : clip.frames.back().frame + 1;
  if (is_video && info.frame_count_estimate > 0 && labelled > info.frame_count_estimate)
    airtruth::warn(warn,
                   clip.media.string() + ": has about " +
                       std::to_string(info.frame_count_estimate) + " frames, and the labels of " +
                       clip.name + " go on to the " + std::to_string(labelled) + "th");
}

Json record_of(const exchange::Clip& clip, const ImportOptions& options) {
  std::set<std::string> categories, distractors;
  std::int64_t labels = 0;
  for (const exchange::LabelledFrame& frame : clip.frames)
    for (const exchange::Label& label : frame.labels) {
      categories.insert(label.category);
      if (!annotation::is_aircraft(label.object_class)) distractors.insert(label.category);
      ++labels;
    }
  Json record = {{"format", "airtruth labelled clip 1"},
                 {"version", kVersion},
                 {"name", clip.name},
                 {"imported_from", exchange::name(options.format)},
                 {"frames", clip.frames.size()},
                 {"labels", labels},
                 {"categories", categories}};
  if (!distractors.empty()) record["distractors"] = distractors;
  if (!clip.media.empty()) record["media"] = clip.media.string();
  return record;
}

void expect_rate(const exchange::Clip& clip, const fs::path& source) {
  constexpr double kHighestRate_hz = 1e6;  // the limit of labels.jsonl
  if (clip.frame_rate_hz && !(*clip.frame_rate_hz > 0 && *clip.frame_rate_hz <= kHighestRate_hz))
    throw Error(fmt::format("{}: the frame rate is {} Hz; expected a number above 0, up to {}",
                            clip.name,
                            *clip.frame_rate_hz,
                            kHighestRate_hz),
                {source.string()});
}

// Makes names that are valid for a folder, each unique.
std::string free_name(const std::string& wanted, std::set<std::string>& taken) {
  std::string name = wanted;
  // Labels, records and the files of other formats are UTF-8.
  const bool is_utf8 = utf8_fault(name) == std::string::npos;
  for (char& c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '/' || byte < 0x20 || (byte >= 0x80 && !is_utf8)) c = '-';
  }
  if (name.empty() || name == "." || name == "..") name = "clip";
  if (name.size() > 200) {
    std::size_t end = 200;
    while (is_utf8 && (static_cast<unsigned char>(name[end]) & 0xC0) == 0x80) --end;
    name.resize(end);
  }
  std::string unique = name;
  for (int i = 2; !taken.insert(unique).second; ++i) unique = name + "-" + std::to_string(i);
  return unique;
}

// Gives the objects of each clip their class.
void classify(std::vector<exchange::Clip>& clips, const ImportOptions& options) {
  for (const ImportOptions::ObjectClass& given : options.classes) {
    bool fits_any = false;
    for (exchange::Clip& clip : clips) {
      if (!matches(given.pattern, clip.name)) continue;
      fits_any = true;
      for (exchange::LabelledFrame& frame : clip.frames)
        for (exchange::Label& label : frame.labels) {
          label.object_class = given.name;
          if (label.category == options.read.category) label.category = given.name;
        }
    }
    if (!fits_any)
      throw Error("--class '" + given.pattern + "=" + given.name + "' fits no clip" +
                  (clips.empty() ? "" : " (one is '" + clips.front().name + "')"));
  }
}

// Gives each clip its video, its numbers of frames and a name of its own.
void complete(std::vector<exchange::Clip>& clips,
              const fs::path& source,
              const ImportOptions& options) {
  std::set<std::string> taken;
  for (exchange::Clip& clip : clips) {
    auto video = options.videos.find(clip.name);
    if (video == options.videos.end() && clips.size() == 1) video = options.videos.find("");
    if (video != options.videos.end()) clip.media = video->second;
    if (!clip.media.empty()) clip.media = fs::absolute(clip.media).lexically_normal();
    require_utf8(clip.media);
    match_pictures(clip, options.warn);
    ask_video(clip, options.warn);
    clip.name = free_name(clip.name, taken);
    expect_rate(clip, source);
  }
}

// Returns the record of the clip.
Json write_clip(const exchange::Clip& clip, const ImportOptions& options, const fs::path& folder) {
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed) throw Error("cannot create: " + failed.message(), {folder.string()});
  Json record = record_of(clip, options);
  write_file(folder / "labels.jsonl", exchange::labels_jsonl(clip), Flush::kLater);
  // Categories come unchanged from the labels and may be invalid UTF-8.
  write_file(folder / "sequence.json",
             record.dump(2, ' ', false, Json::error_handler_t::replace) + "\n",
             Flush::kLater);
  return record;
}

}  // namespace

ImportOptions::ObjectClass object_class_from(const std::string& text) {
  const std::size_t equals = text.rfind('=');
  ImportOptions::ObjectClass given =
      equals == std::string::npos
          ? ImportOptions::ObjectClass{"*", text}
          : ImportOptions::ObjectClass{text.substr(0, equals), text.substr(equals + 1)};
  if (!annotation::is_object_class(given.name) && given.name != "ignore")
    throw Error(
        "--class is '" + text +
        "'; expected aircraft, bird, multirotor, balloon, glint, dirt, insect or ignore, or "
        "CLIP=CLASS");
  return given;
}

ImportSummary import_set(const fs::path& source,
                         const fs::path& out,
                         const ImportOptions& options) {
  if (fs::exists(out) && (!fs::is_directory(out) || !fs::is_empty(out)))
    throw Error("exists and is not empty; expected a new folder", {out.string()});
  check_output_folder(out);
  exchange::ReadOptions read = options.read;
  read.size_of_picture = [](const fs::path& file) {
    const image::Rgb8 picture = video::read_still(file);
    return std::pair(picture.width, picture.height);
  };
  std::vector<exchange::Clip> clips =
      exchange::read_clips(options.format, source, read, options.warn);
  complete(clips, source, options);
  classify(clips, options);
  // All input is read before the first file is written.
  const fs::path sequences = out / "sequences";
  const sequences::Layout layout =
      sequences::layout_for(std::ssize(clips), options.max_in_a_folder);
  std::error_code reported_below;
  fs::create_directories(sequences, reported_below);
  write_layout(sequences, layout);
  ImportSummary summary;
  for (const exchange::Clip& clip : clips) {
    const Json record =
        write_clip(clip, options, sequences / layout.folder_of(summary.clips) / clip.name);
    ++summary.clips;
    summary.frames += std::ssize(clip.frames);
    summary.labels += record.at("labels").get<std::int64_t>();
  }
  flush_files(out);
  return summary;
}

}  // namespace airtruth::labelled
