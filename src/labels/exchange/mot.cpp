// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string_view>

#include <fmt/format.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/text.h"
#include "labels/annotation/object_class.h"
#include "labels/exchange/parts.h"
#include "labels/exchange/pictures.h"
#include "labels/exchange/text.h"
#include "labels/label_file/label_file.h"

// MOTChallenge (Milan et al. 2016, "MOT16", table 4): one folder for each clip, with
// img1/000001.jpg ..., seqinfo.ini and gt/gt.txt. The lines are "frame, id, left, top, width,
// height, conf, class, visibility" with frames, ids and pixels from 1. A tenth column, which the
// readers of that format ignore, holds the range in metres (-1: unknown).
//
// The class of every object is 1 by default: TrackEval's MOT16, MOT17 and MOT20 keep
// only class 1 (trackeval/datasets/mot_challenge_2d_box.py, get_preprocessed_seq_data).
// tracks.txt, with a line "id,class" for each track, stores the class; other readers ignore it.
// seqinfo.ini has the seven keys of the published ones, with whole numbers, since datumaro refuses
// others (plugins/data_formats/mot.py); comments hold further properties of the clip.
// Unknown values are 0; the visibility is 1 where no label of the clip states one.
namespace airtruth::exchange {
namespace {

constexpr double kUnknown = -1;
// The comments of seqinfo.ini.
constexpr std::string_view kExactRate = "; exact frame rate: ";
constexpr std::string_view kNoVisibility = "; visibility: unknown, written as 1";

class MotWriter : public FolderWriter {
 public:
  using FolderWriter::FolderWriter;

  void add(const Clip& clip, const std::string& part) override {
    const fs::path folder = root_ / part / clip.name;
    fs::create_directories(folder / "gt");
    std::string text;
    const double unknown = knows_visibility(clip) ? kUnknown : 1;
    for (std::size_t i = 0; i < clip.frames.size(); ++i)
      for (const Label& label : clip.frames[i].labels) text += line_of(label, i, unknown);
    write_file(folder / "gt" / "gt.txt", text);
    write_file(folder / "gt" / "labels.txt", classes());
    write_file(folder / "seqinfo.ini", about(clip));
    write_file(folder / "tracks.txt", tracks(clip));
    lists_[part] += csv_cell(clip.name) + "\n";
  }

  void finish() override {
    fs::create_directories(root_ / "seqmaps");
    for (const std::string& part : options_.parts)
      write_file(root_ / "seqmaps" / (part + ".txt"), "name\n" + lists_[part]);
    write_file(root_ / "labels.txt", classes());
  }

 private:
  fs::path image(const Clip& clip, const std::string& part, std::size_t i) const override {
    return fs::path(part) / clip.name / "img1" /
           fmt::format("{:06}{}", i + 1, options_.image_extension);
  }

  // The names of the classes, one on each line.
  std::string classes() const {
    if (!options_.mot_classes && options_.categories.size() != 1) return "aircraft\n";
    std::string text;
    for (const std::string& category : options_.categories) text += one_line(category) + "\n";
    return text;
  }

  static std::string tracks(const Clip& clip) {
    std::map<std::int64_t, std::string> categories;
    for (const LabelledFrame& frame : clip.frames)
      for (const Label& label : frame.labels) categories.emplace(label.track, label.category);
    std::string text;
    for (const auto& [track, category] : categories)
      text += std::to_string(track) + "," + one_line(category) + "\n";
    return text;
  }

  static bool knows_visibility(const Clip& clip) {
    for (const LabelledFrame& frame : clip.frames)
      for (const Label& label : frame.labels)
        if (label.visible) return true;
    return false;
  }

  std::string line_of(const Label& label, std::size_t i, double unknown_visibility) const {
    const Box& b = label.box_px;
    // MOTChallenge's evaluation of one class passes over what is not to be considered.
    const bool is_considered = options_.mot_classes ? label.object_class != label_file::kIgnore
                                                    : annotation::is_aircraft(label.object_class);
    return fmt::format("{},{},{},{},{},{},{},{},{},{}\n",
                       i + 1,
                       label.track,
                       b.x + 1,
                       b.y + 1,
                       b.width,
                       b.height,
                       is_considered ? 1 : 0,
                       options_.mot_classes ? class_of(label.category) + 1 : 1,
                       label.visible.value_or(unknown_visibility),
                       label.range_m.value_or(kUnknown));
  }

  std::string about(const Clip& clip) const {
    const double rate = clip.frame_rate_hz.value_or(0);
    std::string text = fmt::format(
        "[Sequence]\nname={}\nimDir=img1\nframeRate={}\nseqLength={}\nimWidth={}\nimHeight={}\n"
        "imExt={}\n",
        clip.name,
        rate > 0 ? std::max(1LL, std::llround(rate)) : 0,
        clip.frames.size(),
        clip.width,
        clip.height,
        options_.image_extension);
    if (rate != std::floor(rate)) text += fmt::format("{}{}\n", kExactRate, rate);
    if (!knows_visibility(clip)) text += std::string(kNoVisibility) + "\n";
    return text;
  }
};

class SequenceFolder {
 public:
  SequenceFolder(fs::path folder, const std::vector<std::string>& classes, const Reading& in)
      : folder_(std::move(folder)), classes_(classes), in_(in) {
    if (classes_.empty() && is_there(folder_ / "gt" / "labels.txt"))
      for (const Line& line : lines_of(folder_ / "gt" / "labels.txt"))
        classes_.push_back(line.text);
  }

  Clip read() {
    clip_.name = folder_.filename().string();
    if (is_there(folder_ / "seqinfo.ini")) about(folder_ / "seqinfo.ini");
    if (is_there(folder_ / "tracks.txt")) tracks(folder_ / "tracks.txt");
    const fs::path file = folder_ / "gt" / "gt.txt";
    Rows rows;
    for (const Line& line : lines_of(file))
      rows.emplace_back(numbers_of(line, file), Where{file.string(), line.number});
    expect_no_visdrone(rows);
    for (const auto& [numbers, where] : rows) look_at_columns(numbers, where);
    for (const auto& [numbers, where] : rows) add(numbers, where);
    bool are_counted = false;
    for (LabelledFrame& frame : clip_.frames)
      if (number_tracks(frame.labels)) are_counted = true;
    if (are_counted) warn(in_.warn, file.string() + kTracksCounted);
    if (!pictures_in(folder_ / "img1").empty())
      join_by_number(clip_, folder_ / "img1", 1, in_.warn);
    return clip_;
  }

 private:
  using Rows = std::vector<std::pair<std::vector<double>, Where>>;

  // VisDrone's lines end in score, category (1 to 11), truncation (0 or 1) and occlusion (0 to 2).
  // As MOTChallenge's the last two would be a visibility and a range of at most 2 m.
  static void expect_no_visdrone(const Rows& rows) {
    const auto is_visdrone = [](const auto& row) {
      const std::vector<double>& n = row.first;
      return n.size() == 10 && whole_in(n[7], 0, 11) && whole_in(n[8], 0, 1) &&
             whole_in(n[9], 0, 2);
    };
    const auto has_category = [](const auto& row) { return row.first.at(7) > 0; };
    if (!rows.empty() && std::ranges::all_of(rows, is_visdrone) &&
        std::ranges::any_of(rows, has_category))
      throw Error(
          "has VisDrone's columns (score, category, truncation, occlusion); expected those of "
          "MOTChallenge, in which the last ones are class, visibility and range in metres",
          rows.front().second);
  }

  void about(const fs::path& file) {
    const auto about = settings_of(file);
    if (const auto named = about.find("name"); named != about.end()) clip_.name = named->second;
    clip_.frame_rate_hz = label_file::rate_of(number_in(about, "frameRate"));
    clip_.width = side_of(number_in(about, "imWidth"));
    clip_.height = side_of(number_in(about, "imHeight"));
    const auto frames = whole_in(number_in(about, "seqLength").value_or(0), 0, kMaxFrames);
    if (!frames) throw Error("seqLength is no number of frames", {file.string()});
    if (*frames > 0) frame_at(clip_, static_cast<std::size_t>(*frames) - 1, in_);
    for (const Line& line : lines_of(file)) {
      if (line.text == kNoVisibility) knows_visibility_ = false;
      if (!line.text.starts_with(kExactRate)) continue;
      const auto rate = numbers_of({line.number, line.text.substr(kExactRate.size())}, file);
      if (rate.size() == 1 && label_file::rate_of(rate[0])) clip_.frame_rate_hz = rate[0];
    }
  }

  void tracks(const fs::path& file) {
    for (const Line& line : lines_of(file)) {
      const std::size_t comma = line.text.find(',');
      const auto number = numbers_of({line.number, line.text.substr(0, comma)}, file);
      const auto track = number.size() == 1 ? whole_in(number[0], 0, kMaxTracks) : std::nullopt;
      if (!track || comma == std::string::npos)
        throw Error("is no 'id,class'", {file.string(), line.number});
      categories_[*track] = line.text.substr(comma + 1);
    }
  }

  // From MOT16 on the columns 8 and 9 are the class and the visibility. In MOT15 the columns 8 to
  // 10 are the object's place in the world, which these files show by values that are none of
  // those.
  void look_at_columns(const std::vector<double>& n, const Where& where) {
    const bool is_class = n.size() < 8 || whole_in(n[7], -1, kMaxTracks).has_value();
    const bool is_visibility =
        n.size() < 9 || n[8] == kUnknown || (n[8] >= 0 && n[8] <= 1) || std::isnan(n[8]);
    if (is_class && is_visibility) return;
    if (!has_world_columns_)
      in_.left_out.add(
          "files whose columns 8 to 10 are neither class nor visibility nor range; "
          "these columns are not read",
          to_string(where));
    has_world_columns_ = true;
  }

  void add(std::vector<double> n, const Where& where) {
    if (n.size() < 6 || n.size() > 10)
      throw Error(fmt::format("has {} columns; expected 6 to 10", n.size()), where);
    if (has_world_columns_ && n.size() > 7) n.resize(7);
    const auto frame = whole_in(n[0], 1, kMaxFrames);
    if (!frame) throw Error("the frame is no whole number from 1 on", where);
    const auto track = whole_in(n[1], kNoTrack, kMaxTracks);
    if (!track) throw Error("the id is no whole number", where);
    Label label;
    label.track = *track;
    label.box_px = {n[2] - 1, n[3] - 1, n[4], n[5]};
    label.category = category_of(label.track, n.size() > 7 ? n[7] : 0);
    if (n.size() > 6 && n[6] == 0 && !is_distractor(*track))
      label.object_class = label_file::kIgnore;
    if (n.size() > 8 && n[8] >= 0 && knows_visibility_) label.visible = n[8];
    if (n.size() > 9 && n[9] >= 0) label.range_m = n[9];
    if (!is_in_picture(label.box_px, clip_.width, clip_.height))
      return in_.left_out.add(kOutside, to_string(where));
    if (*track >= 0 && label.object_class != label_file::kIgnore &&
        !tracks_of_frames_.emplace(*frame, *track).second)
      throw Error(fmt::format("has the id {} a second time in frame {}", *track, *frame), where);
    frame_at(clip_, static_cast<std::size_t>(*frame) - 1, in_).labels.push_back(label);
  }

  // Whether tracks.txt says so. The writer above has no distractor considered.
  bool is_distractor(std::int64_t track) const {
    const auto found = categories_.find(track);
    if (found == categories_.end()) return false;
    const std::string object_class = stated_class(found->second, in_.options);
    return !object_class.empty() && !annotation::is_aircraft(object_class);
  }

  std::string category_of(std::int64_t track, double number) const {
    if (const auto found = categories_.find(track); found != categories_.end())
      return found->second;
    if (!(number >= 1)) return in_.options.category;
    return number <= static_cast<double>(classes_.size())
               ? classes_[static_cast<std::size_t>(number) - 1]
               : fmt::format("{}", number);
  }

  fs::path folder_;
  std::vector<std::string> classes_;
  const Reading& in_;
  std::map<std::int64_t, std::string> categories_;
  std::set<std::pair<std::int64_t, std::int64_t>> tracks_of_frames_;
  bool knows_visibility_ = true;
  bool has_world_columns_ = false;
  Clip clip_;
};

}  // namespace

std::unique_ptr<Writer> mot_writer(const Writing& to) { return std::make_unique<MotWriter>(to); }

Clips read_mot(const Reading& in) {
  std::vector<std::string> categories;
  if (is_there(in.source / "labels.txt"))
    for (const Line& line : lines_of(in.source / "labels.txt")) categories.push_back(line.text);
  Clips clips;
  for (const fs::path& folder : two_levels(in.source))
    if (is_there(folder / "gt" / "gt.txt"))
      clips.push_back(SequenceFolder(folder, categories, in).read());
  if (clips.empty()) throw Error("holds no gt/gt.txt", {in.source.string()});
  return clips;
}

}  // namespace airtruth::exchange
