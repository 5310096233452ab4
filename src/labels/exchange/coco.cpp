// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/unfinished.h"
#include "foundation/geometry/box.h"
#include "labels/exchange/parts.h"
#include "labels/exchange/python_json.h"
#include "labels/exchange/text.h"

// Reads COCO; the format is described in coco_writer.cpp.
namespace airtruth::exchange {
namespace {

// Reads one annotation file.
class CocoReader {
 public:
  CocoReader(const fs::path& file, const Warn& warn)
      : file_(file), json_(python_json(file)), left_out_(warn), warn_(warn) {}

  Clips read() {
    categories();
    images();
    annotations();
    Clips clips;
    for (auto& [key, video] : videos_) clips.push_back(clip_of(video));
    return clips;
  }

 private:
  struct Picture {
    std::string file_name;
    std::int64_t frame = 0;
    LabelledFrame labels;
    int width = 0, height = 0;
  };
  struct Video {
    std::string name;
    std::optional<double> frame_rate_hz;
    std::vector<std::int64_t> images;
  };

  void categories() {
    for (const JsonObject& category : json_.objects("categories"))
      categories_[category.whole("id")] = category.text("name");
    if (!json_.has("videos")) return;
    for (const JsonObject& video : json_.objects("videos")) {
      Video& about = videos_["#" + padded(video.whole("id"), 12)];
      about.name = video.has("name") ? video.text("name") : video.text("file_name");
      about.frame_rate_hz = video.maybe_number("frame_rate_hz");
    }
  }

  void images() {
    for (const JsonObject& image : json_.objects("images")) {
      const std::int64_t id = image.whole("id");
      Picture picture;
      picture.file_name = image.text("file_name");
      picture.width = side_of(image.number("width"));
      picture.height = side_of(image.number("height"));
      picture.labels.time_s = image.maybe_number("time_s");
      Video& video = video_of(image, picture.file_name);
      // The frame's number follows from its place in the video, its number, or its place in the
      // list.
      picture.frame = image.has("frame_id")
                          ? image.whole("frame_id")
                          : name_and_number(fs::path(picture.file_name).stem().string())
                                .second.value_or(std::ssize(video.images));
      if (!pictures_.emplace(id, picture).second)
        image.fail("id is " + std::to_string(id) + ", as an earlier image's");
      video.images.push_back(id);
    }
  }

  // Pictures without a video form one clip for each of their folders.
  Video& video_of(const JsonObject& image, const std::string& file_name) {
    if (image.has("video_id")) {
      const auto found = videos_.find("#" + padded(image.whole("video_id"), 12));
      if (found == videos_.end()) image.fail("video_id names no video");
      return found->second;
    }
    const std::string folder = fs::path(file_name).parent_path().string();
    Video& video = videos_[folder];
    std::string name = folder.empty() ? file_.stem().string() : folder;
    std::replace(name.begin(), name.end(), '/', '-');
    video.name = name;
    return video;
  }

  void annotations() {
    std::map<std::int64_t, std::int64_t> labels_without_track;
    for (const JsonObject& annotation : json_.objects("annotations")) {
      const std::int64_t image = annotation.whole("image_id");
      const auto found = pictures_.find(image);
      if (found == pictures_.end()) {
        left_out_.add("annotations of images that are not listed", annotation.place());
        continue;
      }
      Picture& picture = found->second;
      std::optional<Label> label = label_of(annotation, picture);
      if (!label) continue;
      label->track = annotation.has("track_id")      ? annotation.whole("track_id")
                     : annotation.has("instance_id") ? annotation.whole("instance_id")
                                                     : ++labels_without_track[image];
      get_known(annotation, *label, "visibility");
      picture.labels.labels.push_back(*std::move(label));
    }
    if (!labels_without_track.empty())
      warn(warn_,
           file_.string() +
               ": holds annotations without a track; the k-th of each image counts as "
               "track k");
  }

  // Category and box of an annotation; empty if it is left out.
  std::optional<Label> label_of(const JsonObject& annotation, const Picture& picture) {
    if (annotation.maybe_truth("iscrowd").value_or(false)) {
      left_out_.add("crowds (iscrowd = 1), which are regions and no objects", annotation.place());
      return std::nullopt;
    }
    Label label;
    const auto category = categories_.find(annotation.whole("category_id"));
    if (category == categories_.end()) annotation.fail("category_id names no category");
    label.category = category->second;
    const auto box = box_of(annotation);
    if (!box) {
      left_out_.add("annotations with neither bbox nor polygons", annotation.place());
      return std::nullopt;
    }
    label.box_px = *box;
    if (!is_in_picture(*box, picture.width, picture.height)) {
      left_out_.add(kOutside, annotation.place());
      return std::nullopt;
    }
    return label;
  }

  // The box is bbox, or the bounds of the polygons.
  static std::optional<Box> box_of(const JsonObject& annotation) {
    if (annotation.has("bbox")) {
      const auto b = annotation.numbers("bbox", 4);
      return Box{b[0], b[1], b[2], b[3]};
    }
    BoxBounds bounds;
    for (const std::vector<double>& polygon : annotation.lists_of_numbers("segmentation"))
      for (std::size_t i = 0; i + 1 < polygon.size(); i += 2)
        bounds.add({polygon[i], polygon[i + 1]});
    return bounds.box();
  }

  Clip clip_of(Video& video) {
    std::stable_sort(video.images.begin(), video.images.end(), [&](std::int64_t a, std::int64_t b) {
      return pictures_.at(a).frame < pictures_.at(b).frame;
    });
    Clip clip;
    clip.name = fs::path(video.name).filename().string();
    clip.frame_rate_hz = video.frame_rate_hz;
    bool same_size = true;
    for (const std::int64_t id : video.images) {
      Picture& picture = pictures_.at(id);
      same_size = same_size && (clip.frames.empty() ||
                                (picture.width == clip.width && picture.height == clip.height));
      clip.width = picture.width;
      clip.height = picture.height;
      picture.labels.frame = picture.frame;
      clip.frames.push_back(picture.labels);
    }
    if (!same_size) {
      warn(warn_,
           file_.string() + ": the pictures of " + clip.name +
               " differ in size, as those of no video do; they are imported without size and "
               "pictures");
      clip.width = clip.height = 0;
      return clip;
    }
    if (!video.images.empty()) clip.media = media_of(pictures_.at(video.images.front()).file_name);
    return clip;
  }

  // The folder of a clip's pictures, where it can be found near the annotations.
  fs::path media_of(const std::string& file_name) const {
    const std::string stem = file_.stem().string();
    const std::string part = stem.substr(stem.rfind('_') + 1);
    const fs::path root = file_.parent_path().parent_path();
    for (const fs::path& base :
         {root / "images" / part, root / "images", root / part, root, file_.parent_path()})
      if (fs::exists(base / file_name)) return (base / file_name).parent_path();
    return {};
  }

  fs::path file_;
  JsonDocument json_;
  LeftOut left_out_;
  const Warn& warn_;
  std::map<std::int64_t, std::string> categories_;
  std::map<std::int64_t, Picture> pictures_;
  std::map<std::string, Video> videos_;
};

}  // namespace

Clips read_coco(const Reading& in) {
  std::vector<fs::path> files = {in.source};
  if (fs::is_directory(in.source)) {
    files = files_with(in.source / "annotations", ".json");
    if (files.empty()) files = files_with(in.source, ".json");
  }
  if (files.empty()) throw Error("holds no annotation file (*.json)", {in.source.string()});
  Clips clips;
  for (const fs::path& file : files) {
    Clips more = CocoReader(file, in.warn).read();
    std::move(more.begin(), more.end(), std::back_inserter(clips));
  }
  return clips;
}

// COCO (Lin et al. 2014; cocodataset.org, "Data format"): one JSON file with images, annotations
// and categories; ids from 1, boxes [x, y, width, height] from the top-left corner at (0, 0).
// pycocotools (PythonAPI/pycocotools/coco.py) reads id, bbox, area, iscrowd and segmentation of
// every annotation; without masks the segmentation is the box as a polygon, as loadRes()
// itself makes it from a box. An annotation with iscrowd = 1 is a region in which detections do not
// count, and not an object.
// Videos and tracks follow the video data sets that are derived from COCO: videos, video_id,
// frame_id, track_id.

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

class CocoWriter : public FolderWriter {
 public:
  CocoWriter(const fs::path& root, const WriteOptions& options) : FolderWriter(root, options) {
    fs::create_directories(folder());
    for (const std::string& part : options.parts) {
      Lists& lists = parts_[part];
      for (const char* what : {"images", "annotations"})
        lists_on_disk_.push_back(Unfinished::path(list(part, what)));
      lists.images.open(list(part, "images"), std::ios::binary);
      lists.annotations.open(list(part, "annotations"), std::ios::binary);
    }
  }

  // A failed run leaves no half-written file either.
  ~CocoWriter() override {
    std::error_code ignored;
    for (const auto& [part, lists] : parts_) {
      fs::remove(list(part, "images"), ignored);
      fs::remove(list(part, "annotations"), ignored);
      fs::remove(part_path(whole(part)), ignored);
    }
  }
  CocoWriter(const CocoWriter&) = delete;
  CocoWriter& operator=(const CocoWriter&) = delete;

  void add(const Clip& clip, const std::string& part) override {
    Lists& lists = parts_.at(part);
    const auto video = static_cast<std::int64_t>(lists.videos.size()) + 1;
    Json about = {{"id", video}, {"name", clip.name}};
    if (clip.width > 0) about["width"] = clip.width;
    if (clip.height > 0) about["height"] = clip.height;
    put(about, "frame_rate_hz", clip.frame_rate_hz);
    about["length"] = clip.frames.size();
    lists.videos.push_back(about);
    for (std::size_t i = 0; i < clip.frames.size(); ++i) add_frame(clip, i, video, lists);
    if (!lists.images || !lists.annotations)
      throw Error("cannot be written: is the disk full?", {folder().string()});
  }

  void finish() override {
    for (auto& [part, lists] : parts_) {
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
  void add_frame(const Clip& clip, std::size_t i, std::int64_t video, Lists& lists) {
    const LabelledFrame& frame = clip.frames[i];
    const std::int64_t id = lists.next_image++;
    Json image = {{"id", id},
                  {"file_name", file_name(clip, i)},
                  {"width", clip.width},
                  {"height", clip.height},
                  {"video_id", video},
                  {"frame_id", i}};
    put(image, "time_s", frame.time_s);
    lists.images << (id > 1 ? ",\n" : "") << image.dump();
    for (const Label& label : frame.labels) {
      const Box& b = label.box_px;
      const std::int64_t number = lists.next_annotation++;
      lists.masks += label.mask ? 1 : 0;
      Json json = {{"id", number},
                   {"image_id", id},
                   {"video_id", video},
                   {"category_id", class_of(label.category) + 1},
                   {"track_id", label.track},
                   {"bbox", {b.x, b.y, b.width, b.height}},
                   {"area", label.mask ? double(label.mask->area_px) : b.area()},
                   {"segmentation", segmentation_of(label)},
                   {"iscrowd", 0}};
      put_known(json, label, "visibility");
      lists.annotations << (number > 1 ? ",\n" : "") << json.dump();
    }
  }

  void write(const std::string& part, const Lists& lists) const {
    Json categories = Json::array();
    for (const std::string& category : options_.categories)
      categories.push_back(
          {{"id", class_of(category) + 1}, {"name", category}, {"supercategory", "aircraft"}});
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

  std::map<std::string, Lists> parts_;
  std::vector<Unfinished> lists_on_disk_;
};

}  // namespace

std::unique_ptr<Writer> coco_writer(Format, const fs::path& root, const WriteOptions& options) {
  return std::make_unique<CocoWriter>(root, options);
}

}  // namespace airtruth::exchange
