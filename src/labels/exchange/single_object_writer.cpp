// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <airtruth/vot.h>
#include <fmt/format.h>

#include "foundation/base/files.h"
#include "foundation/geometry/box.h"
#include "labels/exchange/parts.h"
#include "labels/exchange/text.h"

// Writes the formats of single_object_reader.cpp, where their files are described.
namespace airtruth::exchange {
namespace {

// Frames between the starts of VOT's multi-start experiment (Kristan et al. 2020, VOT2020).
constexpr int kAnchorStep = 50;

// The visible share of an object in eighths: 0 for none, 8 for all (GOT-10k, section 3).
int cover_of(double visible) {
  if (visible <= 0) return 0;
  if (visible >= 1) return 8;
  return std::min(7, static_cast<int>(std::ceil(visible / 0.15)));
}

class SingleObjectWriter : public IndexedWriter {
 public:
  SingleObjectWriter(Format format, fs::path root, const WriteOptions& options)
      : format_(format), root_(std::move(root)), options_(options) {}

  void add(const Clip& clip, const std::string& part) override {
    const fs::path folder = root_ / part / clip.name;
    fs::create_directories(folder);
    lists_[part] += clip.name + "\n";
    std::string boxes;
    for (const LabelledFrame& frame : clip.frames) boxes += line_of(frame);
    write_file(folder / (format_ == Format::kOtb ? "groundtruth_rect.txt" : "groundtruth.txt"),
               boxes);
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
    const std::string name =
        padded(static_cast<std::int64_t>(i) + 1, digits) + options_.image_extension;
    const fs::path folder = fs::path(part) / clip.name;
    if (format_ == Format::kOtb) return folder / "img" / name;
    return format_ == Format::kVot ? folder / "color" / name : folder / name;
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
    return std::all_of(clip.frames.begin(), clip.frames.end(), [&](const LabelledFrame& frame) {
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
    if (knows(clip, &Label::range_m))
      write_column(folder / "range_m.value", clip, [](const Label* label) {
        return label == nullptr ? std::string("nan") : fmt::format("{}", *label->range_m);
      });
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
      if (!frame.labels.empty()) return frame.labels.front().category;
    return {};
  }

  Format format_;
  fs::path root_;
  WriteOptions options_;
  std::map<std::string, std::string> lists_;
};

}  // namespace

std::unique_ptr<Writer> single_object_writer(Format format,
                                             const fs::path& root,
                                             const WriteOptions& options) {
  return std::make_unique<SingleObjectWriter>(format, root, options);
}

}  // namespace airtruth::exchange
