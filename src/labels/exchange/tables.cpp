// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "foundation/base/error.h"
#include "labels/annotation/evision.h"
#include "labels/exchange/parts.h"
#include "labels/exchange/text.h"

namespace airtruth::exchange {
namespace {

std::vector<fs::path> files_of(const fs::path& source, std::string_view extension) {
  if (!fs::is_directory(source)) return {source};
  std::vector<fs::path> files = files_with(source, extension);
  if (files.empty()) throw Error(fmt::format("holds no *{}", extension), {source.string()});
  return files;
}

// The video of the same name beside an annotation.
fs::path video_beside(fs::path file) {
  for (const char* extension : {".mp4", ".mkv", ".avi", ".mov", ".webm"})
    if (file.replace_extension(extension); fs::exists(file)) return file;
  return {};
}

// The names of the E-Vision paper end in the aircraft: "1LRB737".
std::string category_of(const std::string& name, const std::string& otherwise) {
  for (const char* aircraft : {"B737", "C172"})
    if (name.ends_with(aircraft)) return aircraft;
  return otherwise;
}

}  // namespace

Clips read_evision(const Reading& in) {
  Clips clips;
  for (const fs::path& file : files_of(in.source, ".xml")) {
    const annotation::Evision evision = annotation::read_evision(file);
    Clip clip;
    clip.name = file.stem().string();
    clip.media = video_beside(file);
    if (in.options.size) std::tie(clip.width, clip.height) = *in.options.size;
    for (std::size_t i = 0; i < evision.frames.size(); ++i) {
      const auto& frame = evision.frames[i];
      const auto number =
          static_cast<std::int64_t>(frame ? frame->number - 1 : static_cast<int>(i));
      if (number > kMaxFrames)
        throw Error("frame_" + std::to_string(number + 1) + " is beyond any clip", {file.string()});
      // Numbers that the file skips are frames without any information.
      while (std::ssize(clip.frames) < number)
        clip.frames.push_back({std::ssize(clip.frames), std::nullopt, {}});
      LabelledFrame labelled{std::ssize(clip.frames), std::nullopt, {}};
      if (frame && frame->rect_px.width > 0 && frame->rect_px.height > 0) {
        const PixelBox& r = frame->rect_px;
        Label label;
        label.category = category_of(clip.name, in.options.category);
        label.box_px = {double(r.x), double(r.y), double(r.width), double(r.height)};
        if (frame->distance_m > 0) label.range_m = frame->distance_m;
        labelled.labels.push_back(label);
      }
      clip.frames.push_back(labelled);
    }
    clips.push_back(std::move(clip));
  }
  return clips;
}

Clips read_csv(const Reading& in) {
  Clips clips;
  for (const fs::path& file : files_of(in.source, ".csv")) {
    Clip clip;
    clip.name = file.stem().string();
    clip.media = video_beside(file);
    if (in.options.size) std::tie(clip.width, clip.height) = *in.options.size;
    bool first = true;
    for (const Line& line : lines_of(file)) {
      const bool is_header = first && line.text.find_first_of("0123456789") != 0;
      first = false;
      if (is_header) continue;
      const Where where{file.string(), line.number};
      const std::vector<double> n = numbers_of(line, file);
      if (n.size() < 5)
        throw Error(fmt::format("has {} columns; expected frame,x,y,w,h", n.size()), where);
      const auto i = whole_in(n[0], 0, kMaxFrames);
      if (!i) throw Error("the frame is no whole number from 0 on", where);
      while (std::ssize(clip.frames) <= *i)
        clip.frames.push_back({std::ssize(clip.frames), std::nullopt, {}});
      LabelledFrame& frame = clip.frames[static_cast<std::size_t>(*i)];
      const Box box{n[1] - in.options.origin_px, n[2] - in.options.origin_px, n[3], n[4]};
      // "0,0,0,0" and "nan" mean no box.
      if (!is_in_picture(box, clip.width, clip.height)) continue;
      Label label;
      label.track = std::ssize(frame.labels) + 1;
      label.category = in.options.category;
      label.box_px = box;
      frame.labels.push_back(label);
    }
    if (clip.frames.empty()) throw Error("holds no line of frame,x,y,w,h", {file.string()});
    clips.push_back(std::move(clip));
  }
  return clips;
}

}  // namespace airtruth::exchange
