// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include <airtruth/vot.h>
#include <fmt/format.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/names.h"
#include "foundation/geometry/box.h"
#include "labels/exchange/parts.h"
#include "labels/exchange/pictures.h"
#include "labels/exchange/text.h"
#include "labels/label_file/label_file.h"

// Folders with one object each, and one line of x, y, width, height for each frame.
//
// OTB (Wu et al. 2013): groundtruth_rect.txt, img/0001.jpg; pixels from 1; "0,0,0,0" where the
// target is absent; the toolkit skips such frames.
// GOT-10k (Huang et al. 2019): groundtruth.txt, 00000001.jpg, absence.label, cut_by_image.label,
// cover.label (0 to 8 for the visible share), meta_info.ini, list.txt. Pixels from 1, as its
// toolkit's reference tracker takes them. The toolkit (got10k/datasets/got10k.py) reads all three
// labels of every sequence; pytracking's loader takes the lines of meta_info.ini by their position.
// Therefore all are written: an unknown value is "unknown" in meta_info.ini, cover 8 where there is
// a box, and cut where the box reaches the picture's edge. A last line of meta_info.ini names those
// labels. VOT (Kristan et al. 2013 on; vot-toolkit's vot/dataset/common.py): groundtruth.txt,
// color/00000001.jpg, a file `sequence` with a whole fps, list.txt, occlusion.tag, range_m.value,
// and anchor.value with the starts of the multi-start experiment (1 forward, -1 backward, 0 none;
// vot/experiment/multistart.py). Pixels from 0; "nan,nan,nan,nan" where the target is absent.
namespace airtruth::exchange {
namespace {

// The sequences of OTB-100 whose folders hold more pictures than boxes, and the picture of their
// first box (VOT's toolkit, vot/dataset/otb.py).
constexpr std::pair<std::string_view, std::int64_t> kStartFrames[] = {{"blurcar1", 247},
                                                                      {"blurcar3", 3},
                                                                      {"blurcar4", 18},
                                                                      {"david", 300},
                                                                      {"diving", 1},
                                                                      {"football1", 1},
                                                                      {"freeman3", 1},
                                                                      {"freeman4", 1}};

const char* boxes_in(Format format) {
  return format == Format::kOtb ? "groundtruth_rect.txt" : "groundtruth.txt";
}

// The files of a sequence's boxes. OTB has one for each target where there are several (Jogging,
// Skating2): groundtruth_rect.1.txt and so on.
std::vector<fs::path> files_of_boxes(Format format, const fs::path& folder) {
  if (const fs::path file = folder / boxes_in(format); is_there(file)) return {file};
  std::vector<fs::path> files;
  if (format != Format::kOtb) return files;
  for (int target = 1;; ++target) {
    const fs::path file = folder / fmt::format("groundtruth_rect.{}.txt", target);
    if (!is_there(file)) return files;
    files.push_back(file);
  }
}

fs::path pictures_of_sequence(Format format, const fs::path& folder) {
  return format == Format::kOtb   ? folder / "img"
         : format == Format::kVot ? folder / "color"
                                  : folder;
}

// The lines of a file with one for each frame: a blank one would move those behind it.
std::vector<Line> lines_of_frames(const fs::path& file) {
  std::vector<Line> lines = lines_of(file);
  for (const Line& line : lines)
    if (line.is_behind_blank)
      throw Error("is empty; expected the numbers of a frame, or nan",
                  {file.string(), line.number - 1});
  return lines;
}

// Columns beside the boxes; empty where the file does not exist.
std::vector<double> column(const fs::path& file) {
  std::vector<double> values;
  if (!is_there(file)) return values;
  for (const Line& line : lines_of_frames(file))
    for (const double value : numbers_of(line, file)) values.push_back(value);
  return values;
}

// VOT's mask, "mX,Y,W,H,ZEROS,ONES,ZEROS,...": run lengths of the rows of a W x H window at (X, Y),
// starting with the zeros (vot/region/io.py). Returns the bounds of its ones; an empty box where it
// has none.
Box box_of_mask(const Line& line, const fs::path& file) {
  const std::vector<double> n = numbers_of({line.number, line.text.substr(1)}, file);
  const Where where{file.string(), line.number};
  if (n.size() < 5) throw Error("is no mask: expected mX,Y,WIDTH,HEIGHT and run lengths", where);
  const auto left = whole_in(n[0], -label_file::kLongestSide_px, label_file::kLongestSide_px);
  const auto top = whole_in(n[1], -label_file::kLongestSide_px, label_file::kLongestSide_px);
  const auto width = whole_in(n[2], 0, label_file::kLongestSide_px);
  const auto height = whole_in(n[3], 0, label_file::kLongestSide_px);
  if (!left || !top || !width || !height)
    throw Error("is no mask: its window is no whole numbers of pixels", where);
  std::int64_t left_px = *width * *height;
  for (std::size_t i = 4; i < n.size(); ++i) {
    const auto run = whole_in(n[i], 0, left_px);
    if (!run) throw Error("is no mask: its run lengths do not fit its window", where);
    left_px -= *run;
  }
  return bounds_of_mask(n).value_or(Box{});
}

// "key: value" of meta_info.ini.
std::string got10k_value(const fs::path& file, const std::string& key) {
  if (is_there(file))
    for (const Line& line : lines_of(file))
      if (line.text.starts_with(key + ":")) {
        const std::size_t start = line.text.find_first_not_of(' ', key.size() + 1);
        return start == std::string::npos ? "" : line.text.substr(start);
      }
  return {};
}

class SequenceReader {
 public:
  SequenceReader(fs::path folder, const Reading& in)
      : format_(in.format), folder_(std::move(folder)), in_(in) {}

  Clip read() {
    clip_.name = folder_.filename().string();
    category_ = in_.options.category;
    about();
    std::int64_t track = 1;
    for (const fs::path& file : files_of_boxes(format_, folder_)) boxes_of(file, track++);
    columns();
    join();
    return clip_;
  }

 private:
  // The first box belongs to the first picture, or to the one with the number of the start frame.
  void join() {
    const fs::path pictures = pictures_of_sequence(format_, folder_);
    if (const auto first = start_frame(std::ssize(pictures_in(pictures))))
      join_by_number(clip_, pictures, *first, in_.warn);
    else
      join_in_order(clip_, pictures, in_.warn);
  }

  // Empty where each picture has a box.
  std::optional<std::int64_t> start_frame(std::int64_t pictures) const {
    const auto& stated = in_.options.start_frames;
    for (const std::string& name : {clip_.name, std::string()})
      if (const auto found = stated.find(name); found != stated.end()) return found->second;
    if (pictures <= std::ssize(clip_.frames)) return std::nullopt;
    if (format_ == Format::kOtb)
      for (const auto& [name, first] : kStartFrames)
        if (lower_case(clip_.name) == name) return first;
    throw Error(
        fmt::format("holds {} pictures and {} lines of boxes; state the number of the first "
                    "box's picture: --start-frame {}=N",
                    pictures,
                    clip_.frames.size(),
                    clip_.name),
        {folder_.string()});
  }

  void about() {
    const fs::path pictures = pictures_of_sequence(format_, folder_);
    const ReadOptions& options = in_.options;
    const std::vector<std::string> names = pictures_in(pictures);
    if (options.size)
      std::tie(clip_.width, clip_.height) = *options.size;
    else if (!names.empty() && options.size_of_picture)
      std::tie(clip_.width, clip_.height) = options.size_of_picture(pictures / names.front());
    if (format_ == Format::kVot && is_there(folder_ / "sequence")) {
      const auto settings = settings_of(folder_ / "sequence");
      const auto exact = label_file::rate_of(number_in(settings, "exact_fps"));
      clip_.frame_rate_hz = exact ? exact : label_file::rate_of(number_in(settings, "fps"));
      clip_.width = side_of(number_in(settings, "width").value_or(clip_.width));
      clip_.height = side_of(number_in(settings, "height").value_or(clip_.height));
      if (const auto found = settings.find("category"); found != settings.end())
        category_ = found->second;
    }
    if (format_ == Format::kGot10k) about_got10k();
  }

  void about_got10k() {
    const fs::path file = folder_ / "meta_info.ini";
    if (const std::string kind = got10k_value(file, "object_class"); !kind.empty())
      category_ = kind;
    std::string rate = got10k_value(file, "anno_fps");
    if (rate.ends_with("Hz")) rate.resize(rate.size() - 2);
    const std::vector<double> rates = known_numbers(rate, file);
    if (rates.size() == 1) clip_.frame_rate_hz = label_file::rate_of(rates[0]);
    std::string size = got10k_value(file, "resolution");
    std::ranges::replace_if(
        size, [](char c) { return c == '(' || c == ')'; }, ' ');
    const std::vector<double> numbers = known_numbers(size, file);
    const std::string unknown = " " + got10k_value(file, "labels_unknown") + " ";
    knows_cut_ = unknown.find(" cut_by_image ") == std::string::npos;
    knows_cover_ = unknown.find(" cover ") == std::string::npos;
    if (numbers.size() == 2) {
      clip_.width = side_of(numbers[0]);
      clip_.height = side_of(numbers[1]);
    }
  }

  static std::vector<double> known_numbers(const std::string& text, const fs::path& file) {
    return text == "unknown" ? std::vector<double>() : numbers_of({0, text}, file);
  }

  void boxes_of(const fs::path& file, std::int64_t track) {
    std::size_t frame_number = 0;
    const double from = format_ == Format::kVot ? 0 : 1;
    for (const Line& line : lines_of_frames(file)) {
      LabelledFrame& frame = frame_at(clip_, frame_number++, in_);
      const auto box = format_ == Format::kVot && line.text.starts_with('m')
                           ? box_of_mask(line, file)
                           : box_of(numbers_of(line, file), from);
      if (!box)
        throw Error("is no box: expected x, y, width, height", {file.string(), line.number});
      const bool is_stated = std::isfinite(box->x) && (box->width != 0 || box->height != 0);
      if (!is_stated) continue;
      Label label;
      label.track = track;
      label.category = category_;
      label.box_px = *box;
      add_label(
          frame.labels, label, clip_, in_.left_out, to_string(Where{file.string(), line.number}));
    }
  }

  // A rectangle, or the bounds of a polygon. A single number means that there is no region (VOT).
  static std::optional<Box> box_of(const std::vector<double>& n, double from) {
    if (n.size() == 1) return Box{0, 0, 0, 0};
    if (n.size() == 4) return Box{n[0] - from, n[1] - from, n[2], n[3]};
    if (n.size() < 6 || n.size() % 2 != 0) return std::nullopt;
    BoxBounds bounds;
    for (std::size_t i = 0; i < n.size(); i += 2) bounds.add({n[i] - from, n[i + 1] - from});
    return bounds.box();
  }

  void columns() {
    const auto each = [&](const char* name, const auto& set) {
      const std::vector<double> values = column(folder_ / name);
      for (std::size_t i = 0; i < std::min(values.size(), clip_.frames.size()); ++i)
        for (Label& label : clip_.frames[i].labels) set(label, values[i]);
    };
    if (format_ == Format::kGot10k) {
      const std::vector<double> absent = column(folder_ / "absence.label");
      for (std::size_t i = 0; i < std::min(absent.size(), clip_.frames.size()); ++i)
        if (absent[i] != 0) clip_.frames[i].labels.clear();
      if (knows_cut_)
        each("cut_by_image.label", [](Label& label, double v) { label.truncated = v != 0; });
      // A value stands for the middle of its step; the whole is exact.
      if (knows_cover_)
        each("cover.label", [](Label& label, double v) {
          label.visible = v >= 8 ? 1.0 : std::clamp(0.15 * v - 0.075, 0.0, 1.0);
        });
    }
    if (format_ == Format::kVot) {
      each("occlusion.tag", [](Label& label, double v) { label.occluded = v != 0; });
      each("range_m.value", [](Label& label, double v) {
        if (std::isfinite(v)) label.range_m = v;
      });
      each("contrast_to_noise.value", [](Label& label, double v) {
        if (std::isfinite(v)) label.contrast_to_noise = v;
      });
    }
  }

  Format format_;
  fs::path folder_;
  const Reading& in_;
  std::string category_;
  bool knows_cut_ = true;
  bool knows_cover_ = true;
  Clip clip_;
};

}  // namespace

Clips read_single_object(const Reading& in) {
  Clips clips;
  for (const fs::path& folder : two_levels(in.source))
    if (!files_of_boxes(in.format, folder).empty())
      clips.push_back(SequenceReader(folder, in).read());
  for (const auto& start : in.options.start_frames) {
    const std::string& name = start.first;
    const auto count = std::ranges::count(clips, name, &Clip::name);
    if (!name.empty() && count != 1)
      throw Error(fmt::format("{} named '{}', for which a start frame is given",
                              count == 0 ? "no sequence is" : "more than one sequence is",
                              name),
                  {in.source.string()});
  }
  if (clips.empty())
    throw Error(std::string("holds no sequence of ") + name(in.format), {in.source.string()});
  return clips;
}

namespace {

// Frames between the starts of VOT's multi-start experiment (Kristan et al. 2020, VOT2020).
constexpr int kAnchorStep = 50;

// The visible share of an object in eighths: 0 for none, 8 for all (GOT-10k, section 3).
int cover_of(double visible) {
  if (visible <= 0) return 0;
  if (visible >= 1) return 8;
  return std::min(7, static_cast<int>(std::ceil(visible / 0.15)));
}

class SingleObjectWriter : public FolderWriter {
 public:
  using FolderWriter::FolderWriter;

  void add(const Clip& clip, const std::string& part) override {
    const fs::path folder = root_ / part / clip.name;
    fs::create_directories(folder);
    lists_[part] += clip.name + "\n";
    std::string boxes;
    for (const LabelledFrame& frame : clip.frames) boxes += line_of(frame);
    write_file(folder / boxes_in(format_), boxes);
    if (format_ == Format::kGot10k) add_got10k(clip, folder);
    if (format_ == Format::kVot) add_vot(clip, folder);
  }

  void finish() override {
    for (const auto& [part, list] : lists_) write_file(root_ / part / "list.txt", list);
  }

 private:
  fs::path image(const Clip& clip, const std::string& part, std::size_t i) const override {
    // Toolkits sort by name, so all names have the same number of digits.
    const auto longest = static_cast<int>(std::to_string(clip.frames.size()).size());
    const int digits = format_ == Format::kOtb ? std::max(4, longest) : 8;
    const std::string name = fmt::format("{:0{}}{}", i + 1, digits, options_.image_extension);
    return pictures_of_sequence(format_, fs::path(part) / clip.name) / name;
  }

  std::string line_of(const LabelledFrame& frame) const {
    const bool vot = format_ == Format::kVot;
    if (frame.labels.empty()) return vot ? "nan,nan,nan,nan\n" : "0,0,0,0\n";
    const Box& b = frame.labels.front().box_px;
    const int from = vot ? 0 : 1;
    return fmt::format("{},{},{},{}\n", b.x + from, b.y + from, b.width, b.height);
  }

  template <typename Value>
  static void write_column(const fs::path& file, const Clip& clip, const Value& value) {
    std::string text;
    for (const LabelledFrame& frame : clip.frames)
      text += value(frame.labels.empty() ? nullptr : &frame.labels.front()) + "\n";
    write_file(file, text);
  }

  static bool knows(const Clip& clip, const auto& member) {
    return std::ranges::all_of(clip.frames, [&](const LabelledFrame& frame) {
      return frame.labels.empty() || (frame.labels.front().*member).has_value();
    });
  }

  static void add_got10k(const Clip& clip, const fs::path& folder) {
    write_column(folder / "absence.label", clip, [](const Label* label) {
      return std::string(label == nullptr ? "1" : "0");
    });
    write_column(folder / "cut_by_image.label", clip, [&](const Label* label) {
      return std::string(label != nullptr && is_cut(*label, clip) ? "1" : "0");
    });
    write_column(folder / "cover.label", clip, [](const Label* label) {
      return std::to_string(label == nullptr ? 0 : cover_of(label->visible.value_or(1)));
    });
    write_file(folder / "meta_info.ini", got10k_about(clip));
  }

  static bool is_cut(const Label& label, const Clip& clip) {
    if (label.truncated) return *label.truncated;
    const Box& b = label.box_px;
    return clip.width > 0 && clip.height > 0 &&
           (b.x <= 0 || b.y <= 0 || b.right() >= clip.width || b.bottom() >= clip.height);
  }

  static std::string got10k_about(const Clip& clip) {
    const std::string category = category_of(clip);
    std::string about = "[METAINFO]\nurl: unknown\nbegin: unknown\nend: unknown\n";
    about += clip.frame_rate_hz ? fmt::format("anno_fps: {}Hz\n", *clip.frame_rate_hz)
                                : "anno_fps: unknown\n";
    about += "object_class: " + (category.empty() ? "unknown" : category) + "\n";
    for (const char* key : {"motion_class", "major_class", "root_class", "motion_adverb"})
      about += std::string(key) + ": unknown\n";
    about += clip.width > 0 ? fmt::format("resolution: ({}, {})\n", clip.width, clip.height)
                            : "resolution: unknown\n";
    std::string unknown;
    if (!knows(clip, &Label::truncated)) unknown += " cut_by_image";
    if (!knows(clip, &Label::visible)) unknown += " cover";
    return unknown.empty() ? about : about + "labels_unknown:" + unknown + "\n";
  }

  void add_vot(const Clip& clip, const fs::path& folder) const {
    std::string about = "name=" + clip.name + "\n";
    if (clip.frame_rate_hz) {
      const double rate = *clip.frame_rate_hz;
      about += fmt::format("fps={}\n", std::max(1LL, std::llround(rate)));
      if (rate != std::floor(rate)) about += fmt::format("exact_fps={}\n", rate);
    }
    if (clip.width > 0) about += fmt::format("width={}\nheight={}\n", clip.width, clip.height);
    about += "length=" + std::to_string(clip.frames.size()) + "\nformat=default\n";
    about += "category=" + category_of(clip) + "\n";
    about += "channels.color=color/%08d" + options_.image_extension + "\n";
    write_file(folder / "sequence", about);
    write_file(folder / "anchor.value", anchors(clip));
    if (knows(clip, &Label::occluded))
      write_column(folder / "occlusion.tag", clip, [](const Label* label) {
        return std::string(label != nullptr && *label->occluded ? "1" : "0");
      });
    for (const auto& [name, value] :
         {std::pair("range_m.value", &Label::range_m),
          std::pair("contrast_to_noise.value", &Label::contrast_to_noise)}) {
      const auto knows_it = [value = value](const LabelledFrame& frame) {
        return !frame.labels.empty() && frame.labels.front().*value;
      };
      if (std::ranges::any_of(clip.frames, knows_it))
        write_column(folder / name, clip, [value = value](const Label* label) {
          const auto known = label == nullptr ? std::nullopt : label->*value;
          return known ? number(*known) : std::string("nan");
        });
    }
  }

  // The starts of this program's own multi-start runs (<airtruth/vot.h>).
  static std::string anchors(const Clip& clip) {
    evaluation::VotTruth truth{{}, clip.width, clip.height};
    for (const LabelledFrame& frame : clip.frames)
      truth.boxes.push_back(frame.labels.empty() ? std::nullopt
                                                 : std::optional(frame.labels.front().box_px));
    std::vector<int> values(clip.frames.size(), 0);
    for (const evaluation::Anchor& anchor : evaluation::anchors_of(truth, kAnchorStep))
      values[static_cast<std::size_t>(anchor.frame)] = anchor.is_backward ? -1 : 1;
    std::string text;
    for (const int value : values) text += std::to_string(value) + "\n";
    return text;
  }

  static std::string category_of(const Clip& clip) {
    for (const LabelledFrame& frame : clip.frames)
      if (!frame.labels.empty()) return one_line(frame.labels.front().category);
    return {};
  }
};

}  // namespace

std::unique_ptr<Writer> single_object_writer(const Writing& to) {
  return std::make_unique<SingleObjectWriter>(to);
}

}  // namespace airtruth::exchange
