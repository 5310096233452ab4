// SPDX-License-Identifier: Apache-2.0
#include "dataset/labelled/import.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include <airtruth/version.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "dataset/sequences/layout.h"
#include "foundation/base/error.h"
#include "foundation/base/file_state.h"
#include "foundation/base/files.h"
#include "foundation/base/names.h"
#include "foundation/base/text.h"
#include "foundation/run_files/run_files.h"
#include "labels/annotation/object_class.h"
#include "labels/exchange/pictures.h"
#include "labels/exchange/text.h"
#include "labels/label_file/label_file.h"
#include "picture/video/numbered_images.h"
#include "picture/video/reader.h"
#include "picture/video/still.h"

namespace airtruth::labelled {
namespace {

using Json = nlohmann::ordered_json;

// Whether the frames of a clip are pictures, and their folder is its media.
bool has_pictures(const exchange::Clip& clip) { return fs::is_directory(clip.media); }

// Gives a clip the pictures that the user names for it (a folder, a pattern or a list): in a folder
// those that the labels name, else one for each frame in their order. A video stays as it is.
void join_given_pictures(exchange::Clip& clip, const Warn& warn) {
  const fs::path given = clip.media;
  if (fs::is_directory(given)) {
    clip.media.clear();
    exchange::join_by_name(clip, given, {});
    if (!clip.media.empty()) return;
  }
  const auto images = video::numbered_images(given);
  if (!images) return;
  clip.media.clear();
  if (images->files.size() != clip.frames.size())
    return airtruth::warn(
        warn,
        fmt::format("{}: holds {} pictures, and there are labels for {} frames of "
                    "{}; they are imported without the pictures",
                    given.string(),
                    images->files.size(),
                    clip.frames.size(),
                    clip.name));
  clip.media = fs::is_directory(given) ? given : given.parent_path();
  for (std::size_t i = 0; i < clip.frames.size(); ++i)
    clip.frames[i].picture = images->files[i].lexically_relative(clip.media).string();
}

// Numbers in pictures' names do not state whether they count from the video's first frame, but for
// a 0: what they are taken for is said.
void say_first_frame(const exchange::Clip& clip, const Warn& warn) {
  if (clip.media.empty() || clip.frames.empty()) return;
  const exchange::LabelledFrame& first = clip.frames.front();
  const auto number = exchange::name_and_number(fs::path(first.picture).stem().string()).second;
  if (first.picture.empty() || (first.frame == 0 && number == 0)) return;
  airtruth::warn(warn,
                 fmt::format("{}: its frame {}, counted from 0, is taken for the picture {} of {}",
                             clip.media.string(),
                             first.frame,
                             first.picture,
                             clip.name));
}

void expect_size(exchange::Clip& clip, int width, int height, const fs::path& file) {
  if (clip.width == 0) {
    clip.width = width;
    clip.height = height;
  } else if (clip.width != width || clip.height != height) {
    throw Error(fmt::format("is {}x{}, and the labels of {} are for {}x{}",
                            width,
                            height,
                            clip.name,
                            clip.width,
                            clip.height),
                {file.string()});
  }
}

// Formats that state no size of the picture leave it to the video to say what lies outside.
void leave_out_outside(exchange::Clip& clip, exchange::LeftOut& left_out) {
  for (exchange::LabelledFrame& frame : clip.frames)
    std::erase_if(frame.labels, [&](const exchange::Label& label) {
      const bool is_outside = !exchange::is_in_picture(label.box_px, clip.width, clip.height);
      if (is_outside)
        left_out.add(exchange::kOutside, fmt::format("frame {} of {}", frame.frame, clip.name));
      return is_outside;
    });
}

// The numbers of a video's frames at the times of those of a clip, which ascend; empty where not
// all have one.
std::vector<std::int64_t> numbers_at_times(const exchange::Clip& clip, double video_rate_hz) {
  constexpr double kMostFrames = 1e9;  // a year of video at 30 Hz
  std::vector<std::int64_t> numbers;
  for (const exchange::LabelledFrame& frame : clip.frames) {
    const double place = frame.time_s.value_or(-1) * video_rate_hz;
    if (!(place >= 0 && place < kMostFrames)) return {};
    const std::int64_t number = std::llround(place);
    if (!numbers.empty() && number <= numbers.back()) return {};
    numbers.push_back(number);
  }
  return numbers;
}

// Labels at another rate than the video's number other frames. Those of every n-th frame (`dataset
// export --every n`) that state their times get the numbers of the frames at these; of others it is
// said what they are taken for.
void number_at_rate(exchange::Clip& clip, double video_rate_hz, const Warn& warn) {
  constexpr double kSameRate = 0.01;  // of a rate, as 29.97 is for 30: chosen
  const double ratio = video_rate_hz / clip.frame_rate_hz.value_or(video_rate_hz);
  if (std::abs(ratio - 1) <= kSameRate) return;
  const double every = std::round(ratio);
  std::vector<std::int64_t> numbers;
  if (every > 1 && std::abs(ratio - every) <= kSameRate * every)
    numbers = numbers_at_times(clip, video_rate_hz);
  airtruth::warn(
      warn,
      fmt::format("{}: has {:.6g} frames a second, and the labels of {} have {:.6g}: {}",
                  clip.media.string(),
                  video_rate_hz,
                  clip.name,
                  *clip.frame_rate_hz,
                  numbers.empty() ? "their frame k is taken for its frame k"
                                  : "they are taken for those of the frames at their times"));
  if (numbers.empty()) return;
  for (std::size_t i = 0; i < numbers.size(); ++i) clip.frames[i].frame = numbers[i];
  clip.frame_rate_hz = video_rate_hz;
}

// Fills in sizes, rates and times that the labels lack and the video states.
void ask_video(exchange::Clip& clip, const Warn& warn) {
  if (clip.media.empty() || clip.frames.empty()) return;
  if (has_pictures(clip)) {
    const fs::path first = clip.media / clip.frames.front().picture;
    const auto [width, height] = video::size_of_still(first);
    return expect_size(clip, width, height, first);
  }
  const video::StreamInfo info = video::Reader(clip.media, {.threads = 1}, warn).info();
  expect_size(clip, info.width, info.height, clip.media);
  if (info.is_rate_stated) {
    if (!clip.frame_rate_hz) clip.frame_rate_hz = info.frame_rate.value();
    number_at_rate(clip, info.frame_rate.value(), warn);
  }
  const std::int64_t labelled = clip.frames.back().frame + 1, all = info.frame_count_estimate;
  const auto say = [&](const char* labels_are) {
    airtruth::warn(warn,
                   fmt::format("{}: has about {} frames, and the labels of {} {} {}th",
                               clip.media.string(),
                               all,
                               clip.name,
                               labels_are,
                               labelled));
  };
  if (all > 0 && labelled > all) say("go on to the");
  // Labels of every n-th frame without a number would be taken for those of the first ones.
  constexpr double kMostOfAVideo = 0.9;
  const bool are_in_a_row = labelled == std::ssize(clip.frames);
  if (are_in_a_row && static_cast<double>(labelled) < kMostOfAVideo * static_cast<double>(all))
    say("are of the first to the");
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
  // Clips of one folder of pictures are known by their first pictures.
  if (!clip.media.empty())
    record["media"] =
        (has_pictures(clip) ? clip.media / clip.frames.front().picture : clip.media).string();
  return record;
}

void expect_rate(const exchange::Clip& clip, const fs::path& source) {
  if (clip.frame_rate_hz && !label_file::rate_of(clip.frame_rate_hz))
    throw Error(fmt::format("{}: the frame rate is {} Hz; expected a number above 0, up to {}",
                            clip.name,
                            *clip.frame_rate_hz,
                            label_file::kHighestRate_hz),
                {source.string()});
}

// Makes names that are valid for a folder, each unique.
std::string free_name(const std::string& wanted, std::set<std::string>& taken) {
  std::string name = wanted;
  // Labels, records and the files of other formats are UTF-8.
  const bool is_utf8 = utf8_fault(name) == std::string::npos;
  for (char& c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '/' || is_control(c) || (byte >= 0x80 && !is_utf8)) c = '-';
  }
  if (name.empty() || name == "." || name == "..") name = "clip";
  if (name.front() == '.') name.front() = '-';  // the folder would be hidden
  const auto with = [&](const std::string& ending) {
    std::size_t end = std::min(name.size(), kMostFileNameBytes - ending.size());
    while (is_utf8 && end < name.size() && (static_cast<unsigned char>(name[end]) & 0xC0) == 0x80)
      --end;
    return name.substr(0, end) + ending;
  };
  std::string unique = with("");
  for (int i = 2; !taken.insert(unique).second; ++i) unique = with("-" + std::to_string(i));
  return unique;
}

// For a message about an option that fits none: " (one is 'a')".
std::string words_of_one(const std::vector<exchange::Clip>& clips) {
  return clips.empty() ? "" : " (one is '" + clips.front().name + "')";
}

// The path of a video alone is for the only clip.
void expect_clips_of_videos(const std::vector<exchange::Clip>& clips,
                            const std::map<std::string, fs::path>& videos) {
  for (const auto& [name, video] : videos) {
    const auto fitting = std::ranges::count(clips, name, &exchange::Clip::name);
    if (fitting > 1)
      throw Error(fmt::format("--video '{}={}' fits {} clips; expected a name that one clip has",
                              name,
                              video.string(),
                              fitting));
    if (name.empty() ? clips.size() != 1 || videos.size() != 1 : fitting == 0)
      throw Error(fmt::format("--video '{}{}{}' fits no clip; expected CLIP=VIDEO{}",
                              name,
                              name.empty() ? "" : "=",
                              video.string(),
                              words_of_one(clips)));
  }
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
          // What its set marks as counting neither way is no object of the clip.
          if (label.object_class == label_file::kIgnore) continue;
          label.object_class = given.name;
          if (label.category == options.read.category) label.category = given.name;
        }
    }
    if (!fits_any)
      throw Error("--class '" + given.pattern + "=" + given.name + "' fits no clip" +
                  words_of_one(clips));
  }
}

// The list of pictures has a path on each line, and labels.jsonl refuses other names.
void expect_one_line(const exchange::Clip& clip) {
  for (const exchange::LabelledFrame& frame : clip.frames)
    if (const std::string path = (clip.media / frame.picture).string();
        !frame.picture.empty() && (path.find_first_of("\n\r") != std::string::npos ||
                                   std::ranges::any_of(frame.picture, is_control)))
      throw Error("the picture " + Json(path).dump(-1, ' ', false, Json::error_handler_t::replace) +
                  " of " + clip.name +
                  " has a control character in its name; expected a name without");
}

// Gives each clip its video, its numbers of frames and a name of its own.
void complete(std::vector<exchange::Clip>& clips,
              const fs::path& source,
              const ImportOptions& options) {
  expect_clips_of_videos(clips, options.videos);
  exchange::LeftOut left_out(options.warn);
  std::set<std::string> taken;
  for (exchange::Clip& clip : clips) {
    auto video = options.videos.find(clip.name);
    if (video == options.videos.end() && clips.size() == 1) video = options.videos.find("");
    if (video != options.videos.end()) clip.media = video->second;
    if (!clip.media.empty()) clip.media = absolute_path(clip.media);
    require_utf8(clip.media);
    if (video != options.videos.end()) join_given_pictures(clip, options.warn);
    if (has_pictures(clip)) {
      // The frames of pictures are numbered by their places.
      for (std::int64_t i = 0; exchange::LabelledFrame & frame : clip.frames) frame.frame = i++;
    } else if (video != options.videos.end()) {
      say_first_frame(clip, options.warn);
    }
    expect_one_line(clip);
    ask_video(clip, options.warn);
    leave_out_outside(clip, left_out);
    if (!clip.frame_rate_hz) clip.frame_rate_hz = options.frame_rate_hz;
    clip.name = free_name(clip.name, taken);
    expect_rate(clip, source);
  }
}

std::string list_of_pictures(const exchange::Clip& clip) {
  std::string text;
  for (const exchange::LabelledFrame& frame : clip.frames)
    text += normal_path(clip.media / frame.picture).string() + "\n";
  return text;
}

// Returns the record of the clip.
Json write_clip(exchange::Clip clip, const ImportOptions& options, const fs::path& folder) {
  make_folders(folder);
  Json record = record_of(clip, options);
  if (has_pictures(clip)) {
    write_file(folder / sequences::kPictureList, list_of_pictures(clip), Flush::kLater);
    clip.media = sequences::kPictureList;
  }
  write_file(folder / sequences::kLabels, exchange::labels_jsonl(clip), Flush::kLater);
  // Categories come unchanged from the labels and may be invalid UTF-8.
  write_file(folder / "sequence.json",
             record.dump(2, ' ', false, Json::error_handler_t::replace) + "\n",
             Flush::kLater);
  return record;
}

void expect_class(const std::string& word,
                  const char* option,
                  const std::string& text,
                  const char* form) {
  if (!annotation::is_object_class(word) && word != "ignore")
    throw Error(
        fmt::format("{} is '{}'; expected aircraft, bird, multirotor, balloon, glint, dirt, "
                    "insect or ignore, {}",
                    option,
                    text,
                    form));
}

}  // namespace

ImportOptions::ObjectClass object_class_from(const std::string& text) {
  const std::size_t equals = text.rfind('=');
  ImportOptions::ObjectClass given =
      equals == std::string::npos
          ? ImportOptions::ObjectClass{"*", text}
          : ImportOptions::ObjectClass{text.substr(0, equals), text.substr(equals + 1)};
  expect_class(given.name, "--class", text, "or CLIP=CLASS");
  return given;
}

std::pair<std::string, std::string> class_of_category_from(const std::string& text) {
  const std::size_t equals = text.rfind('=');
  if (equals == std::string::npos || equals == 0)
    throw Error("--class-of is '" + text + "'; expected CATEGORY=CLASS");
  expect_class(text.substr(equals + 1), "--class-of", text, "as in CATEGORY=CLASS");
  return {text.substr(0, equals), text.substr(equals + 1)};
}

ImportSummary import_set(const fs::path& source,
                         const fs::path& out,
                         const ImportOptions& options) {
  RunFiles files;
  files.reads(source).writes_into(out);
  exchange::ReadOptions read = options.read;
  read.size_of_picture = video::size_of_still;
  std::vector<exchange::Clip> clips =
      exchange::read_clips(options.format, source, read, options.warn);
  complete(clips, source, options);
  classify(clips, options);
  // All input is read before the first file is written.
  files.begin();
  const RunLock lock(out, out, options.warn);
  const sequences::Layout layout = sequences::layout_for(std::ssize(clips));
  ImportSummary summary;
  files.write(out, [&](const fs::path& at) {
    const fs::path sequences = at / "sequences";
    std::error_code reported_below;
    fs::create_directories(sequences, reported_below);
    write_layout(sequences, layout);
    for (const exchange::Clip& clip : clips) {
      const Json record =
          write_clip(clip, options, sequences / layout.folder_of(summary.clips) / clip.name);
      ++summary.clips;
      summary.frames += std::ssize(clip.frames);
      summary.labels += record.at("labels").get<std::int64_t>();
    }
    flush_files(at);
  });
  // Another run may have come first.
  refuse_foreign(out);
  files.commit();
  flush_files(out);
  return summary;
}

}  // namespace airtruth::labelled
