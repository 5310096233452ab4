// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include <fmt/format.h>

#include "base/error.h"
#include "base/files.h"
#include "exchange/parts.h"
#include "exchange/text.h"

// MOTChallenge (Milan et al. 2016, "MOT16", table 4): a folder a clip with img1/000001.jpg ...,
// seqinfo.ini and gt/gt.txt. Lines of "frame, id, left, top, width, height, conf, class,
// visibility" with frames, ids and pixels from 1. A tenth column, which the readers of that format
// pass over, holds the range in metres (-1: unknown).
namespace airtruth::exchange {
namespace {

class MotWriter : public Writer {
 public:
  MotWriter(fs::path root, const WriteOptions& options)
      : root_(std::move(root)), options_(options) {}

  fs::path image(const Clip& clip, const std::string& part, std::size_t i) const override {
    return fs::path(part) / clip.name / "img1" /
           (padded(static_cast<std::int64_t>(i) + 1, 6) + options_.image_extension);
  }

  void add(const Clip& clip, const std::string& part) override {
    const fs::path folder = root_ / part / clip.name;
    fs::create_directories(folder / "gt");
    std::string text;
    for (std::size_t i = 0; i < clip.frames.size(); ++i)
      for (const Label& label : clip.frames[i].labels) text += line_of(label, i);
    write_file(folder / "gt" / "gt.txt", text);
    write_file(folder / "seqinfo.ini", about(clip));
    maps_[part] += clip.name + "\n";
  }

  void finish() override {
    fs::create_directories(root_ / "seqmaps");
    for (const std::string& part : options_.parts)
      write_file(root_ / "seqmaps" / (part + ".txt"), "name\n" + maps_[part]);
    std::string text;
    for (const std::string& category : options_.categories) text += category + "\n";
    write_file(root_ / "labels.txt", text);
  }

 private:
  std::string line_of(const Label& label, std::size_t i) const {
    const auto& all = options_.categories;
    const Box& b = label.box_px;
    return fmt::format("{},{},{},{},{},{},1,{},{},{}\n",
                       i + 1,
                       label.track,
                       b.x + 1,
                       b.y + 1,
                       b.width,
                       b.height,
                       std::find(all.begin(), all.end(), label.category) - all.begin() + 1,
                       label.visible.value_or(-1),
                       label.range_m.value_or(-1));
  }

  std::string about(const Clip& clip) const {
    std::string text = "[Sequence]\nname=" + clip.name + "\nimDir=img1\n";
    if (clip.frame_rate_hz) text += fmt::format("frameRate={}\n", *clip.frame_rate_hz);
    text += fmt::format("seqLength={}\n", clip.frames.size());
    if (clip.width > 0) text += fmt::format("imWidth={}\nimHeight={}\n", clip.width, clip.height);
    return text + "imExt=" + options_.image_extension + "\n";
  }

  fs::path root_;
  WriteOptions options_;
  std::map<std::string, std::string> maps_;
};

constexpr std::int64_t kMostTracks = 1'000'000'000;

Clip read_clip(const fs::path& folder,
               const std::vector<std::string>& categories,
               const ReadOptions& options,
               LeftOut& left_out) {
  Clip clip;
  clip.name = folder.filename().string();
  double length = 0;
  if (fs::exists(folder / "seqinfo.ini")) {
    const auto about = settings_of(folder / "seqinfo.ini");
    if (const auto named = about.find("name"); named != about.end()) clip.name = named->second;
    clip.frame_rate_hz = number_in(about, "frameRate");
    clip.width = side_of(number_in(about, "imWidth"));
    clip.height = side_of(number_in(about, "imHeight"));
    length = number_in(about, "seqLength").value_or(0);
  }
  if (!entries(folder / "img1").empty()) clip.media = folder / "img1";
  const auto frames = whole_in(length, 0, kMostFrames);
  if (!frames) throw Error("seqLength is no number of frames", {(folder / "seqinfo.ini").string()});
  clip.frames.resize(static_cast<std::size_t>(*frames));
  const fs::path file = folder / "gt" / "gt.txt";
  for (const Line& line : lines_of(file)) {
    const std::vector<double> n = numbers_of(line, file);
    const Where where{file.string(), line.number};
    if (n.size() < 6) throw Error(fmt::format("has {} columns; expected 6 to 10", n.size()), where);
    const auto frame = whole_in(n[0], 1, kMostFrames);
    if (!frame) throw Error("the frame is no whole number from 1 on", where);
    const auto track = whole_in(n[1], -1, kMostTracks);
    if (!track) throw Error("the id is no whole number", where);
    if (n.size() > 6 && n[6] == 0) {
      left_out.add("lines that are not to be considered (conf 0)", to_string(where));
      continue;
    }
    Label label;
    label.track = *track;
    label.box_px = {n[2] - 1, n[3] - 1, n[4], n[5]};
    const double category = n.size() > 7 ? n[7] : 0;
    label.category = category >= 1 && category <= static_cast<double>(categories.size())
                         ? categories[static_cast<std::size_t>(category) - 1]
                     : category >= 1 ? fmt::format("{}", category)
                                     : options.category;
    if (n.size() > 8 && n[8] >= 0) label.visible = n[8];
    if (n.size() > 9 && n[9] >= 0) label.range_m = n[9];
    if (!is_in_picture(label.box_px, clip.width, clip.height)) {
      left_out.add("boxes that are empty or outside their image", to_string(where));
      continue;
    }
    const auto i = static_cast<std::size_t>(*frame) - 1;
    if (i >= clip.frames.size()) clip.frames.resize(i + 1);
    clip.frames[i].labels.push_back(label);
  }
  for (std::size_t i = 0; i < clip.frames.size(); ++i)
    clip.frames[i].frame = static_cast<std::int64_t>(i);
  return clip;
}

}  // namespace

std::unique_ptr<Writer> mot_writer(const fs::path& root, const WriteOptions& options) {
  return std::make_unique<MotWriter>(root, options);
}

Clips read_mot(const fs::path& source, const ReadOptions& options, const Warn& warn) {
  std::vector<std::string> categories;
  if (fs::exists(source / "labels.txt"))
    for (const Line& line : lines_of(source / "labels.txt")) categories.push_back(line.text);
  LeftOut left_out(warn);
  Clips clips;
  const auto look = [&](const fs::path& folder) {
    if (fs::exists(folder / "gt" / "gt.txt"))
      clips.push_back(read_clip(folder, categories, options, left_out));
  };
  look(source);
  for (const fs::path& folder : entries(source)) {
    look(folder);
    for (const fs::path& inner : entries(folder)) look(inner);
  }
  if (clips.empty()) throw Error("holds no gt/gt.txt", {source.string()});
  return clips;
}

}  // namespace airtruth::exchange
