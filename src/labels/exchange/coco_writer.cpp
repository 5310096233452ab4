// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/unfinished.h"
#include "foundation/geometry/box.h"
#include "labels/exchange/parts.h"
#include "labels/exchange/python_json.h"
#include "labels/exchange/text.h"

// COCO (Lin et al. 2014; cocodataset.org, "Data format"): one JSON file with images, annotations
// and categories; ids from 1, boxes [x, y, width, height] from the top-left corner at (0, 0).
// pycocotools (PythonAPI/pycocotools/coco.py) reads id, bbox, area, iscrowd and segmentation of
// every annotation; without masks the segmentation is the box as a polygon, as loadRes()
// itself makes it from a box. An annotation with iscrowd = 1 is a region in which detections do not
// count, and not an object.
// Videos and tracks follow the video data sets that are derived from COCO: videos, video_id,
// frame_id, track_id.
namespace airtruth::exchange {
namespace {

using Json = nlohmann::ordered_json;

// The lists of one part, which grow clip by clip and become a JSON file at the end.
struct Lists {
  std::ofstream images;
  std::ofstream annotations;
  Json videos = Json::array();
  std::int64_t next_image = 1;
  std::int64_t next_annotation = 1;
  // Number of annotations that hold their object's pixels.
  std::int64_t masks = 0;
};

// Run lengths of the object's pixels; the box as a polygon where there is no mask.
Json segmentation_of(const Label& label) {
  if (label.mask)
    return {{"size", {label.mask->height, label.mask->width}}, {"counts", label.mask->counts}};
  const Box& b = label.box_px;
  return Json::array({{b.x, b.y, b.x, b.bottom(), b.right(), b.bottom(), b.right(), b.y}});
}

class CocoWriter : public IndexedWriter {
 public:
  CocoWriter(fs::path root, const WriteOptions& options)
      : root_(std::move(root)), options_(options) {
    fs::create_directories(folder());
    for (const std::string& part : options.parts) {
      Lists& lists = lists_[part];
      for (const char* what : {"images", "annotations"})
        lists_on_disk_.push_back(Unfinished::path(list(part, what)));
      lists.images.open(list(part, "images"), std::ios::binary);
      lists.annotations.open(list(part, "annotations"), std::ios::binary);
    }
  }

  // A failed run leaves no half-written file either.
  ~CocoWriter() override {
    std::error_code ignored;
    for (const auto& [part, lists] : lists_) {
      fs::remove(list(part, "images"), ignored);
      fs::remove(list(part, "annotations"), ignored);
      fs::remove(part_path(whole(part)), ignored);
    }
  }
  CocoWriter(const CocoWriter&) = delete;
  CocoWriter& operator=(const CocoWriter&) = delete;

  void add(const Clip& clip, const std::string& part) override {
    Lists& lists = lists_.at(part);
    const auto video = static_cast<std::int64_t>(lists.videos.size()) + 1;
    Json about = {{"id", video}, {"name", clip.name}};
    if (clip.width > 0) about["width"] = clip.width;
    if (clip.height > 0) about["height"] = clip.height;
    if (clip.frame_rate_hz) about["frame_rate_hz"] = *clip.frame_rate_hz;
    about["length"] = clip.frames.size();
    lists.videos.push_back(about);
    for (std::size_t i = 0; i < clip.frames.size(); ++i) add_frame(clip, i, video, lists);
    if (!lists.images || !lists.annotations)
      throw Error("cannot be written: is the disk full?", {folder().string()});
  }

  void finish() override {
    for (auto& [part, lists] : lists_) {
      lists.images.close();
      lists.annotations.close();
      if (!lists.images || !lists.annotations)
        throw Error("cannot be written: is the disk full?", {folder().string()});
      write(part, lists);
    }
  }

 private:
  fs::path image(const Clip& clip, const std::string& part, std::size_t i) const override {
    return fs::path("images") / part / file_name(clip, i);
  }

  fs::path folder() const { return root_ / "annotations"; }
  fs::path whole(const std::string& part) const {
    return folder() / ("instances_" + part + ".json");
  }
  fs::path list(const std::string& part, const std::string& what) const {
    return folder() / ("." + part + "." + what + ".part");
  }
  std::string file_name(const Clip& clip, std::size_t i) const {
    return clip.name + "/" + padded(static_cast<std::int64_t>(i), 6) + options_.image_extension;
  }
  std::int64_t category_id(const std::string& category) const {
    const auto& all = options_.categories;
    return std::find(all.begin(), all.end(), category) - all.begin() + 1;
  }

  void add_frame(const Clip& clip, std::size_t i, std::int64_t video, Lists& lists) {
    const LabelledFrame& frame = clip.frames[i];
    const std::int64_t id = lists.next_image++;
    Json image = {{"id", id},
                  {"file_name", file_name(clip, i)},
                  {"width", clip.width},
                  {"height", clip.height},
                  {"video_id", video},
                  {"frame_id", i}};
    if (frame.time_s) image["time_s"] = *frame.time_s;
    lists.images << (id > 1 ? ",\n" : "") << image.dump();
    for (const Label& label : frame.labels) {
      const Box& b = label.box_px;
      const std::int64_t number = lists.next_annotation++;
      lists.masks += label.mask ? 1 : 0;
      Json json = {{"id", number},
                   {"image_id", id},
                   {"video_id", video},
                   {"category_id", category_id(label.category)},
                   {"track_id", label.track},
                   {"bbox", {b.x, b.y, b.width, b.height}},
                   {"area", label.mask ? double(label.mask->area_px) : b.area()},
                   {"segmentation", segmentation_of(label)},
                   {"iscrowd", 0}};
      if (label.visible) json["visibility"] = *label.visible;
      if (label.occluded) json["occluded"] = *label.occluded;
      if (label.truncated) json["truncated"] = *label.truncated;
      if (label.range_m) json["range_m"] = *label.range_m;
      if (label.above_horizon) json["above_horizon"] = *label.above_horizon;
      lists.annotations << (number > 1 ? ",\n" : "") << json.dump();
    }
  }

  void write(const std::string& part, const Lists& lists) const {
    Json categories = Json::array();
    for (const std::string& category : options_.categories)
      categories.push_back(
          {{"id", category_id(category)}, {"name", category}, {"supercategory", "aircraft"}});
    const fs::path file = whole(part);
    Unfinished unfinished = Unfinished::path(part_path(file));
    {
      std::ofstream out(part_path(file), std::ios::binary);
      out << "{\"info\":{\"description\":\"made by airtruth; segmentations are "
          << segmentations(lists)
          << "\"},"
             "\n\"licenses\":[],\n\"categories\":"
          << categories.dump() << ",\n\"videos\":" << lists.videos.dump() << ",\n\"images\":[";
      append(out, list(part, "images"));
      out << "],\n\"annotations\":[";
      append(out, list(part, "annotations"));
      out << "]}\n";
      if (!out.flush()) throw Error("cannot be written: is the disk full?", {file.string()});
    }
    unfinished.finish([&] { fs::rename(part_path(file), file); });
    // The file is flushed at once: an export must be complete before its writer ends, and nothing
    // clears a killed one later.
    fs::remove(list(part, "images"));
    fs::remove(list(part, "annotations"));
  }

  static const char* segmentations(const Lists& lists) {
    return lists.masks == 0 ? "the boxes as polygons"
           : lists.masks + 1 == lists.next_annotation
               ? "run lengths of the objects' pixels"
               : "run lengths of the objects' pixels where they "
                 "are known, else the boxes as polygons";
  }

  static void append(std::ofstream& out, const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    if (in.peek() != std::ifstream::traits_type::eof()) out << in.rdbuf();
  }

  fs::path root_;
  WriteOptions options_;
  std::map<std::string, Lists> lists_;
  std::vector<Unfinished> lists_on_disk_;
};

}  // namespace

std::unique_ptr<Writer> coco_writer(const fs::path& root, const WriteOptions& options) {
  return std::make_unique<CocoWriter>(root, options);
}

}  // namespace airtruth::exchange
