// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <airtruth/box.h>
#include <airtruth/error.h>
#include <airtruth/export.h>

// Labelled video in the terms that annotation formats share (boxes, tracks and classes by frame),
// and the formats themselves: COCO, YOLO, MOT, VOC, CVAT, AOT, OTB, GOT-10k, VOT, WebDataset and a
// table. A field without information is empty and never holds a placeholder number.
// docs/formats/exchange.md has the folders, origins and sources of each format.
//
// Example: a MOTChallenge set becomes a COCO set.
//   const Part train{"train", read_clips(Format::kMot, "mot", {}, {})};
//   write_clips(Format::kCoco, "coco", {&train, 1});
namespace airtruth::exchange {

// The pixels of an object in a picture, as COCO's compressed run lengths (Lin et al. 2014;
// cocodataset.org, "Data format").
struct PixelMask {
  int width = 0;  // of the picture
  int height = 0;
  std::string counts;
  std::int64_t area_px = 0;
  bool operator==(const PixelMask&) const = default;
};

// One object in one frame.
struct Label {
  // Number of the object's track, the same throughout a clip; from 0.
  std::int64_t track = 1;
  std::string category;
  // The first pixel covers [0, 1); docs/conventions.md.
  Box box_px;
  // Visible share of the object, 0..1.
  std::optional<double> visible;
  // True where something else hides a part.
  std::optional<bool> occluded;
  // True where the frame's edge cuts a part off.
  std::optional<bool> truncated;
  std::optional<double> range_m;
  std::optional<bool> above_horizon;
  // As IntruderTruth::contrast_to_noise in <airtruth/truth.h>.
  std::optional<double> contrast_to_noise;
  // Area of the object's pixels: those of the covered box with at least its coverage, or what the
  // set states (COCO's `area`). Where it is empty, an object's area is that of its box.
  std::optional<double> area_px;
  // The file labels.jsonl does not store it.
  std::optional<PixelMask> mask;
  // As IntruderTruth::object_class in <airtruth/truth.h>. "ignore" marks a region in which
  // detections count neither way.
  std::string object_class = "aircraft";
  bool operator==(const Label&) const = default;
};

// All labels of one frame.
struct LabelledFrame {
  // Number of the frame in the video.
  std::int64_t frame = 0;
  std::optional<double> time_s;
  std::vector<Label> labels;
  // The file of the frame's picture as its set names it, relative to the set's folder of pictures;
  // empty for a frame of a video.
  std::string picture = {};
  // The number of the picture in its set (COCO's image id).
  std::optional<std::int64_t> image_id = {};
  bool operator==(const LabelledFrame&) const = default;
};

// All labels of one video.
struct Clip {
  // A plain file name.
  std::string name;
  // A video, a list of pictures (.txt, a path on each line), or the folder below which
  // LabelledFrame::picture lies; empty: none.
  std::filesystem::path media;
  // 0: unknown.
  int width = 0;
  int height = 0;
  std::optional<double> frame_rate_hz;
  // The categories by their numbers in the clip's set (COCO's category ids).
  std::map<std::int64_t, std::string> category_ids;
  // In order, including the frames without an object.
  std::vector<LabelledFrame> frames;

  // When a frame is shown: as it is stated, else by the frame rate; empty where neither is known.
  std::optional<double> time_s_of(const LabelledFrame& frame) const {
    if (frame.time_s || !(frame_rate_hz.value_or(0) > 0)) return frame.time_s;
    return static_cast<double>(frame.frame) / *frame_rate_hz;
  }
};

// The text of labels.jsonl (docs/formats/labels.md): one line for the clip, then one for each
// frame.
AIRTRUTH_API std::string labels_jsonl(const Clip& clip);
// Reads labels.jsonl. Errors carry file and line.
AIRTRUTH_API Clip read_labels(const std::filesystem::path& file);

// The track numbers of a clip, ascending.
AIRTRUTH_API std::vector<std::int64_t> tracks_of(const Clip& clip);

enum class Format {
  kCoco,
  kYolo,
  kMot,
  kVoc,
  kCvat,
  kAot,
  kOtb,
  kGot10k,
  kVot,
  // Read only: `airtruth render` writes it.
  kEvision,
  // Read only: "frame,x,y,w,h".
  kCsv,
  // Its shards are read without their pictures.
  kWebdataset,
  // Written only: frames.csv, a row for each label.
  kTable,
};

// "coco", "yolo", "mot", "voc", "cvat", "aot", "otb", "got10k", "vot", "evision", "csv",
// "webdataset" or "table". For any other name it throws an Error that offers the nearest.
AIRTRUTH_API Format format_from_name(std::string_view name);
AIRTRUTH_API const char* name(Format format);
AIRTRUTH_API bool can_write(Format format);

// True for OTB, GOT-10k and VOT, which store one object for each sequence. A sequence begins with
// the first frame that shows the object whole (or shows it, where no frame does or the labels lack
// that information) and ends with the last that shows it.
AIRTRUTH_API bool is_single_object(Format format);

// The clips that a format stores for one clip: the clip itself, without labels of the class
// "ignore" where the format cannot mark them, or, for the formats of one object, one clip for each
// track of an aircraft. A distractor is no tracking target.
// The sequences on which `airtruth track` and `airtruth evaluate` work are arranged(Format::kOtb).
//
// Example: a clip named "pass" with the tracks 1 and 2 has the sequences "pass-1" and "pass-2";
// with one track, its sequence is named "pass".
AIRTRUTH_API std::vector<Clip> arranged(Format format, const Clip& clip);

struct ReadOptions {
  // Width and height of the pictures, for sets whose labels and pictures do not state them.
  std::optional<std::pair<int, int>> size;
  // The category of objects where the format has none.
  std::string category = "aircraft";
  // Label::object_class by category, for categories whose word states no class or another one.
  // "Airplane", "helicopter", "Bird", "Flock", "Drone", "UAV", "Balloon" and the like state it, and
  // the classes' own names; where a name states none, COCO's supercategory does; what states none
  // is an aircraft. Boxes that the set marks as counting neither way have the class "ignore"
  // whatever their category.
  std::map<std::string, std::string> class_of = {};
  // CSV only: the coordinate of the first pixel, 0 or 1.
  int origin_px = 0;
  // Returns width and height of a JPEG or PNG file, for formats whose labels do not state them
  // (YOLO, GOT-10k, OTB, VOT). Without this function and without `size`, the labels of YOLO cannot
  // be read, and boxes of the others are not clipped.
  std::function<std::pair<int, int>(const std::filesystem::path& picture)> size_of_picture = {};
  // OTB, GOT-10k and VOT: the number of the picture that the first box belongs to, by the name of
  // the sequence; "" stands for every other one. Without it, a sequence with more pictures than
  // boxes is an Error, but for those of OTB-100 whose start is known (David: 300).
  std::map<std::string, std::int64_t> start_frames = {};
};

// Reads every clip of a set. `source` is the folder that write_clips() or `airtruth dataset export`
// filled, or one of the same form. For COCO, CVAT and AOT it may also be the annotation file; for
// E-Vision it is an XML file or a folder of them; for CSV (`frame,x,y,w,h`) it is a file or a
// folder. Frames without an object are present and empty. Throws Error with file and line, and for
// a format that can only be written; warns of what it left out.
AIRTRUTH_API std::vector<Clip> read_clips(Format format,
                                          const std::filesystem::path& source,
                                          const ReadOptions& options,
                                          const Warn& warn);

// A part of a set, for example "train".
struct Part {
  // A plain file name.
  std::string name;
  std::vector<Clip> clips;
};

// Writes a set of labels, without pictures, into a new folder. Classes are the categories of the
// labels, sorted. Throws Error where the folder exists and is not empty, for a format that can only
// be read, for a name of a part that is no plain file name and one of a clip that leads out of the
// folder, and where a file cannot be written.
AIRTRUTH_API void write_clips(Format format,
                              const std::filesystem::path& folder,
                              std::span<const Part> parts);

}  // namespace airtruth::exchange
