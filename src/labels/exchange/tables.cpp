// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <fstream>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/names.h"
#include "foundation/base/text.h"
#include "foundation/base/unfinished.h"
#include "foundation/geometry/box.h"
#include "labels/annotation/evision.h"
#include "labels/exchange/parts.h"
#include "labels/exchange/text.h"
#include "labels/label_file/label_file.h"

namespace airtruth::exchange {
namespace {

// The clip of an annotation. Its video has the same name beside it.
Clip clip_without_frames(const fs::path& file, const ReadOptions& options) {
  Clip clip;
  clip.name = file.stem().string();
  for (const char* extension : {".mp4", ".mkv", ".avi", ".mov", ".webm"})
    if (const fs::path video = fs::path(file).replace_extension(extension);
        clip.media.empty() && is_there(video))
      clip.media = video;
  if (options.size) std::tie(clip.width, clip.height) = *options.size;
  return clip;
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
  for (const fs::path& file : files_of(in.source, files_with(in.source, ".xml"), "*.xml")) {
    const annotation::Evision evision = annotation::read_evision(file);
    Clip clip = clip_without_frames(file, in.options);
    for (std::size_t i = 0; i < evision.frames.size(); ++i) {
      const auto& frame = evision.frames[i];
      const auto number =
          static_cast<std::int64_t>(frame ? frame->number - 1 : static_cast<int>(i));
      if (number > kMaxFrames)
        throw Error("frame_" + std::to_string(number + 1) + " is beyond any clip", {file.string()});
      // Numbers that the file skips are frames without any information.
      if (number > 0) frame_at(clip, static_cast<std::size_t>(number) - 1, in);
      LabelledFrame labelled{std::ssize(clip.frames), std::nullopt, {}};
      if (frame && frame->rect_px.width > 0 && frame->rect_px.height > 0) {
        Label label;
        label.category = category_of(clip.name, in.options.category);
        label.box_px = as_box(frame->rect_px);
        if (frame->distance_m > 0) label.range_m = frame->distance_m;
        labelled.labels.push_back(label);
      }
      clip.frames.push_back(labelled);
    }
    clips.push_back(std::move(clip));
  }
  return clips;
}

// Where the columns of a table stand, and what its third and fourth numbers of a box are.
struct Columns {
  std::size_t frame = 0, x = 1, y = 2, third = 3, fourth = 4;
  // False: width and height. True: the right and the bottom edge.
  bool are_corners = false;
  std::string text = "frame,x,y,w,h";
  std::size_t count = 5;
  std::optional<std::size_t> track = std::nullopt;
  // True: the column of the tracks is called `id`, and may number the lines.
  bool is_track_id = false;
};

Columns columns_of(const Line& header, const fs::path& file) {
  const std::vector<std::string> cells = cells_of(header.text);
  const auto find = [&](std::initializer_list<const char*> names) {
    for (std::size_t i = 0; i < cells.size(); ++i)
      for (const char* name : names)
        if (lower_case(cells[i]) == name) return std::optional(i);
    return std::optional<std::size_t>();
  };
  const auto frame = find({"frame", "frame_id", "frame_number", "frame_index"});
  const auto x = find({"x", "left", "xmin", "x_min", "x1", "xtl", "bb_left"});
  const auto y = find({"y", "top", "ymin", "y_min", "y1", "ytl", "bb_top"});
  const auto width = find({"w", "width", "bb_width"});
  const auto height = find({"h", "height", "bb_height"});
  const auto right = find({"right", "xmax", "x_max", "x2", "xbr"});
  const auto bottom = find({"bottom", "ymax", "y_max", "y2", "ybr"});
  const auto track = find({"track", "track_id", "object_id"});
  const auto id = find({"id"});
  const bool has_size = width && height;
  if (!frame || !x || !y || (!has_size && !(right && bottom)))
    throw Error(
        "names columns that state no box of a frame; expected frame,x,y,w,h or "
        "frame,xmin,ymin,xmax,ymax",
        {file.string(), header.number});
  return {*frame,
          *x,
          *y,
          has_size ? *width : *right,
          has_size ? *height : *bottom,
          !has_size,
          header.text,
          cells.size(),
          track ? track : id,
          !track && id};
}

// The track that a line states; kNoTrack where it states none.
std::int64_t track_in(const std::vector<double>& n, const Columns& columns, const Where& where) {
  if (!columns.track) return kNoTrack;
  const auto track = whole_in(n[*columns.track], kNoTrack, kMaxTracks);
  if (!track) throw Error("the track is no whole number from 0 on", where);
  return *track;
}

// True where several frames have boxes, and no two boxes have one track.
bool is_each_track_new(const Clip& clip) {
  std::set<std::int64_t> seen;
  std::size_t boxes = 0, frames = 0;
  for (const LabelledFrame& frame : clip.frames) {
    boxes += frame.labels.size();
    if (!frame.labels.empty()) ++frames;
    for (const Label& label : frame.labels) seen.insert(label.track);
  }
  return frames > 1 && seen.size() == boxes;
}

// Numbers the boxes of which the table states no track.
void count_tracks(Clip& clip, const Columns& columns, const fs::path& file, const Warn& warn) {
  if (columns.is_track_id && is_each_track_new(clip)) {
    airtruth::warn(warn, file.string() + ": the column id numbers the boxes and no tracks");
    for (LabelledFrame& frame : clip.frames)
      for (Label& label : frame.labels) label.track = kNoTrack;
  }
  bool are_counted = false;
  for (LabelledFrame& frame : clip.frames) {
    const bool is_one_of_several = columns.track || frame.labels.size() > 1;
    if (number_tracks(frame.labels) && is_one_of_several) are_counted = true;
  }
  if (are_counted) airtruth::warn(warn, file.string() + kTracksCounted);
}

Clips read_csv(const Reading& in) {
  Clips clips;
  for (const fs::path& file : files_of(in.source, files_with(in.source, ".csv"), "*.csv")) {
    Clip clip = clip_without_frames(file, in.options);
    std::vector<Line> lines = lines_of(file);
    const bool has_header = !lines.empty() && lines.front().text.find_first_of("0123456789") != 0;
    const Columns columns = has_header ? columns_of(lines.front(), file) : Columns();
    if (has_header) lines.erase(lines.begin());
    std::set<std::pair<std::int64_t, std::int64_t>> tracks_of_frames;
    for (const Line& line : lines) {
      const Where where{file.string(), line.number};
      const std::vector<double> n = numbers_of(line, file);
      if (!has_header && n.size() > columns.count)
        throw Error(fmt::format("has {} columns, which no header names; expected frame,x,y,w,h, or "
                                "a first line with the columns' names",
                                n.size()),
                    where);
      if (n.size() != columns.count)
        throw Error(fmt::format("has {} columns; expected {}", n.size(), columns.text), where);
      const auto i = whole_in(n[columns.frame], 0, kMaxFrames);
      if (!i) throw Error("the frame is no whole number from 0 on", where);
      LabelledFrame& frame = frame_at(clip, static_cast<std::size_t>(*i), in);
      Box box{n[columns.x], n[columns.y], n[columns.third], n[columns.fourth]};
      if (columns.are_corners) {
        box.width -= box.x;
        box.height -= box.y;
      }
      box.x -= in.options.origin_px;
      box.y -= in.options.origin_px;
      // "0,0,0,0" and "nan" mean no box.
      const bool is_stated = std::isfinite(box.x + box.y + box.width + box.height) &&
                             (box.width != 0 || box.height != 0);
      if (!is_stated) continue;
      Label label;
      label.track = track_in(n, columns, where);
      if (label.track != kNoTrack && is_in_picture(box, clip.width, clip.height) &&
          !tracks_of_frames.emplace(*i, label.track).second)
        throw Error(fmt::format("has the track {} a second time in frame {}", label.track, *i),
                    where);
      label.category = in.options.category;
      label.box_px = box;
      add_label(frame.labels, label, clip, in.left_out, to_string(where));
    }
    if (clip.frames.empty()) throw Error("holds no line of frame,x,y,w,h", {file.string()});
    count_tracks(clip, columns, file, in.warn);
    clips.push_back(std::move(clip));
  }
  return clips;
}

namespace {

std::string cell(const std::optional<double>& value) { return value ? number(*value) : ""; }
std::string cell(const std::optional<bool>& value) { return !value ? "" : *value ? "1" : "0"; }

// frames.csv: one row for each label, in the order of the clips and their frames. What is not known
// is an empty cell; truths are 1 and 0.
class TableWriter : public FolderWriter {
 public:
  explicit TableWriter(const Writing& to)
      : FolderWriter(to), file_(root_ / "frames.csv"), out_(file_.out()) {
    out_ << "part,sequence,frame,time_s,track,category,class,box_px_x,box_px_y,box_px_width,"
            "box_px_height,visible,occluded,truncated,range_m,above_horizon,contrast_to_noise,"
            "area_px";
    for (const std::string& column : options_.columns) out_ << ',' << csv_cell(column);
    out_ << "\n";
  }

  void add(const Clip& clip, const std::string& part) override {
    for (const LabelledFrame& frame : clip.frames)
      for (const Label& label : frame.labels) {
        out_ << csv_cell(part) << ',' << csv_cell(clip.name) << ',' << frame.frame << ','
             << cell(frame.time_s) << ',' << label.track << ',' << csv_cell(label.category) << ','
             << label.object_class << ',' << number(label.box_px.x) << ',' << number(label.box_px.y)
             << ',' << number(label.box_px.width) << ',' << number(label.box_px.height);
        label_file::each_known(
            label, "visible", [&](const char*, const auto& value) { out_ << ',' << cell(value); });
        out_ << ',' << cell(label.area_px);
        if (options_.cells)
          for (const std::string& text : options_.cells(frame.frame, label))
            out_ << ',' << csv_cell(text);
        out_ << "\n";
      }
  }

  void finish() override { file_.finish(); }

 private:
  fs::path image(const Clip&, const std::string&, std::size_t) const override { return {}; }

  PartFile file_;
  std::ofstream& out_;
};

}  // namespace

std::unique_ptr<Writer> table_writer(const Writing& to) {
  return std::make_unique<TableWriter>(to);
}

}  // namespace airtruth::exchange
