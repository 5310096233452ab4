// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <fstream>
#include <map>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/unfinished.h"
#include "foundation/geometry/box.h"
#include "labels/annotation/object_class.h"
#include "labels/exchange/parts.h"
#include "labels/exchange/pictures.h"
#include "labels/exchange/python_json.h"
#include "labels/exchange/text.h"
#include "labels/label_file/label_file.h"

// Reads COCO; the writer below describes the format.
namespace airtruth::exchange {
namespace {

class CocoReader {
 public:
  CocoReader(const fs::path& file, const Reading& in)
      : file_(file), in_(in), json_(python_json(file)), left_out_(in.warn) {}

  Clips read() {
    categories();
    images();
    annotations();
    std::vector<LabelledPicture> of_no_video;
    for (auto& [id, image] : images_)
      (image.video ? videos_.at(*image.video).pictures : of_no_video)
          .push_back(std::move(image.picture));
    Clips clips = clips_of_pictures(std::move(of_no_video), file_.stem().string(), file_, in_.warn);
    for (auto& [id, video] : videos_) {
      clips.push_back(clip_of_pictures(
          fs::path(video.name).filename().string(), std::move(video.pictures), file_, in_.warn));
      clips.back().frame_rate_hz = video.frame_rate_hz;
    }
    for (Clip& clip : clips) clip.category_ids = categories_;
    return clips;
  }

 private:
  struct Image {
    LabelledPicture picture;
    std::optional<std::int64_t> video;
  };
  struct Video {
    std::string name;
    std::optional<double> frame_rate_hz;
    std::vector<LabelledPicture> pictures;
  };

  void categories() {
    for (const JsonObject& category : json_.objects("categories")) {
      const std::string name = category.text("name");
      categories_[category.whole("id")] = name;
      // It is anything in files of others, who use it for nothing.
      const bool has_above =
          category.has("supercategory") && category.value("supercategory").is_string();
      const std::string above = has_above ? category.text("supercategory") : "";
      if (const auto stated = annotation::class_of_category(above))
        in_.classes.emplace(name, *stated);
    }
    if (!json_.has("videos")) return;
    for (const JsonObject& video : json_.objects("videos")) {
      Video& about = videos_[video.whole("id")];
      about.name = video.has("name") ? video.text("name") : video.text("file_name");
      about.frame_rate_hz = label_file::rate_of(video.maybe_number("frame_rate_hz"));
    }
  }

  void images() {
    // The folders near the annotations in which the pictures may lie: the annotations' own folder,
    // as Roboflow writes them, and images in it; images/PART as this program and CVAT write them;
    // PART and images as COCO is published.
    const std::string stem = file_.stem().string();
    const std::string part = stem.substr(stem.rfind('_') + 1);
    const fs::path own = file_.parent_path(), root = own.parent_path();
    const std::vector<fs::path> folders = {
        own, own / "images", root / "images" / part, root / "images", root / part, root};
    for (const JsonObject& json : json_.objects("images")) {
      Image image;
      LabelledPicture& picture = image.picture;
      picture.image_id = json.whole("id");
      picture.name = json.text("file_name");
      picture.folder = folder_of_picture(folders, picture.name, {file_.string()});
      picture.width = side_of(json.number("width"));
      picture.height = side_of(json.number("height"));
      picture.time_s = json.maybe_number("time_s");
      picture.number = json.maybe_integer("frame_id");
      image.video = json.maybe_integer("video_id");
      if (image.video && !videos_.contains(*image.video)) json.fail("video_id names no video");
      if (!images_.emplace(*picture.image_id, std::move(image)).second)
        json.fail("id is " + std::to_string(json.whole("id")) + ", as an earlier image's");
    }
  }

  // The track of an annotation; CVAT writes it as an attribute.
  static std::int64_t track_of(const JsonObject& annotation) {
    for (const char* key : {"track_id", "instance_id"})
      if (const auto track = annotation.maybe_integer(key)) return *track;
    if (!annotation.has("attributes")) return kNoTrack;
    return annotation.object("attributes").maybe_integer("track_id").value_or(kNoTrack);
  }

  void annotations() {
    std::set<std::pair<std::int64_t, std::int64_t>> tracks_of_images;
    for (const JsonObject& annotation : json_.objects("annotations")) {
      const std::int64_t image = annotation.whole("image_id");
      const auto found = images_.find(image);
      if (found == images_.end()) {
        left_out_.add("annotations of images that are not listed", annotation.place());
        continue;
      }
      LabelledPicture& picture = found->second.picture;
      std::optional<Label> label = label_of(annotation, picture);
      if (!label) continue;
      label->track = track_of(annotation);
      // Regions in which detections count neither way may share a track.
      if (label->track >= 0 && label->object_class != label_file::kIgnore &&
          stated_class(label->category, in_.options) != label_file::kIgnore &&
          !tracks_of_images.emplace(image, label->track).second)
        annotation.fail(
            fmt::format("has the track {} a second time in image {}", label->track, image));
      label_file::get_known(annotation, *label, "visibility");
      if (annotation.has("attributes") && !label->occluded)
        label->occluded = annotation.object("attributes").maybe_truth("occluded");
      picture.labels.push_back(*std::move(label));
    }
    bool are_counted = false;
    for (auto& [id, image] : images_)
      if (number_tracks(image.picture.labels)) are_counted = true;
    if (are_counted) warn(in_.warn, file_.string() + kTracksCounted);
  }

  // Category and box of an annotation; empty if it is left out.
  std::optional<Label> label_of(const JsonObject& annotation, const LabelledPicture& picture) {
    Label label;
    if (annotation.maybe_truth("iscrowd").value_or(false)) label.object_class = label_file::kIgnore;
    const auto category = categories_.find(annotation.whole("category_id"));
    if (category == categories_.end()) annotation.fail("category_id names no category");
    label.category = category->second;
    const auto box = box_of(annotation);
    if (!box) {
      left_out_.add("annotations with neither bbox nor polygons", annotation.place());
      return std::nullopt;
    }
    label.box_px = *box;
    // Where the object's pixels are unknown, writers put the area of the box.
    const auto area_px = annotation.maybe_number("area");
    if (area_px && *area_px != box->area()) label.area_px = area_px;
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

  fs::path file_;
  const Reading& in_;
  JsonDocument json_;
  LeftOut left_out_;  // of this file
  std::map<std::int64_t, std::string> categories_;
  std::map<std::int64_t, Image> images_;
  std::map<std::int64_t, Video> videos_;
};

// The annotation files of a folder: those in annotations/, of which the published sets hold further
// kinds, of the same pictures, beside the boxes (captions, key points, panoptic, and the bare
// pictures of the test part); or one in the folder or in each part's, as Roboflow writes them.
std::vector<fs::path> annotation_files(const fs::path& folder, const Warn& warn) {
  std::vector<fs::path> files = files_with(folder / "annotations", ".json");
  const auto others = std::stable_partition(files.begin(), files.end(), [](const fs::path& file) {
    return file.filename().string().starts_with("instances");
  });
  if (others != files.begin()) {
    if (others != files.end())
      airtruth::warn(
          warn,
          fmt::format("{}: {} files beside instances_*.json are not read (the first: {})",
                      others->parent_path().string(),
                      files.end() - others,
                      others->filename().string()));
    return {files.begin(), others};
  }
  if (files.empty()) files = files_with(folder, ".json");
  for (const fs::path& part : entries(folder))
    if (const fs::path file = part / "_annotations.coco.json"; is_there(file))
      files.push_back(file);
  return files;
}

}  // namespace

Clips read_coco(const Reading& in) {
  Clips clips;
  for (const fs::path& file :
       files_of(in.source, annotation_files(in.source, in.warn), "annotation file (*.json)"))
    append(clips, CocoReader(file, in).read());
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
// Frames and categories have the numbers and names of label_file::CocoNumbers where the clips and
// the options hold them.

namespace {

using Json = nlohmann::ordered_json;

// The lists of one part, which grow clip by clip and become a JSON file at the end.
struct Lists {
  explicit Lists(const fs::path& file)
      : images(file.string() + ".images"), annotations(file.string() + ".annotations") {}

  PartFile images, annotations;  // never finished: they are removed at the end
  Json videos = Json::array();
  std::int64_t images_written = 0;
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
  explicit CocoWriter(const Writing& to) : FolderWriter(to) {
    fs::create_directories(folder());
    for (const std::string& part : options_.parts) parts_.try_emplace(part, whole(part));
  }

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
    expect_written(lists);
  }

  void finish() override {
    for (auto& [part, lists] : parts_) {
      lists.images.out().close();
      lists.annotations.out().close();
      expect_written(lists);
      write(part, lists);
    }
    parts_.clear();
  }

 private:
  fs::path image(const Clip& clip, const std::string& part, std::size_t i) const override {
    return fs::path("images") / part / file_name(clip, i);
  }

  fs::path folder() const { return root_ / "annotations"; }
  fs::path whole(const std::string& part) const {
    return folder() / ("instances_" + part + ".json");
  }
  void expect_written(Lists& lists) const {
    if (!lists.images.out() || !lists.annotations.out())
      throw Error("cannot be written: is the disk full?", {folder().string()});
  }
  std::string file_name(const Clip& clip, std::size_t i) const {
    const std::string stem = fs::path(clip.frames[i].picture).stem().string();
    return clip.name + "/" + (stem.empty() ? fmt::format("{:06}", i) : stem) +
           options_.image_extension;
  }
  std::int64_t category_id(const std::string& category) const {
    const auto found = options_.category_ids.find(category);
    if (found != options_.category_ids.end()) return found->second;
    return static_cast<std::int64_t>(class_of(category)) + 1;
  }
  void add_frame(const Clip& clip, std::size_t i, std::int64_t video, Lists& lists) {
    const LabelledFrame& frame = clip.frames[i];
    const std::int64_t id = frame.image_id.value_or(lists.images_written + 1);
    ++lists.images_written;
    Json image = {{"id", id},
                  {"file_name", file_name(clip, i)},
                  {"width", clip.width},
                  {"height", clip.height},
                  {"video_id", video},
                  {"frame_id", i}};
    put(image, "time_s", frame.time_s);
    lists.images.out() << (lists.images_written > 1 ? ",\n" : "") << image.dump();
    for (const Label& label : frame.labels) {
      const Box& b = label.box_px;
      const std::int64_t number = lists.next_annotation++;
      lists.masks += label.mask ? 1 : 0;
      if (label.object_class != label_file::kIgnore)
        classes_.emplace(label.category, label.object_class);
      Json json = {
          {"id", number},
          {"image_id", id},
          {"video_id", video},
          {"category_id", category_id(label.category)},
          {"track_id", label.track},
          {"bbox", {b.x, b.y, b.width, b.height}},
          {"area", label.area_px.value_or(label.mask ? double(label.mask->area_px) : b.area())},
          {"segmentation", segmentation_of(label)},
          {"iscrowd", label.object_class == label_file::kIgnore ? 1 : 0}};
      label_file::each_known(
          label, "visibility", [&](const char* key, const auto& value) { put(json, key, value); });
      lists.annotations.out() << (number > 1 ? ",\n" : "") << json.dump();
    }
  }

  void write(const std::string& part, const Lists& lists) const {
    Json categories = Json::array();
    for (const std::string& category : options_.categories)
      categories.push_back({{"id", category_id(category)},
                            {"name", category},
                            {"supercategory", supercategory_of(category)}});
    PartFile file(whole(part));
    std::ofstream& out = file.out();
    out << "{\"info\":{\"description\":\"made by airtruth; segmentations are "
        << segmentations(lists)
        << "\"},"
           "\n\"licenses\":[],\n\"categories\":"
        << categories.dump() << ",\n\"videos\":" << lists.videos.dump() << ",\n\"images\":[";
    append(out, lists.images);
    out << "],\n\"annotations\":[";
    append(out, lists.annotations);
    out << "]}\n";
    file.finish();
  }

  // The class of the category's objects; of a category without one, what its name states.
  std::string supercategory_of(const std::string& category) const {
    if (const auto found = classes_.find(category); found != classes_.end()) return found->second;
    return std::string(annotation::class_of_category(category).value_or(annotation::kAircraft));
  }

  static const char* segmentations(const Lists& lists) {
    return lists.masks == 0 ? "the boxes as polygons"
           : lists.masks + 1 == lists.next_annotation
               ? "run lengths of the objects' pixels"
               : "run lengths of the objects' pixels where they "
                 "are known, else the boxes as polygons";
  }

  static void append(std::ofstream& out, const PartFile& file) {
    std::ifstream in(file.part(), std::ios::binary);
    if (in.peek() != std::ifstream::traits_type::eof()) out << in.rdbuf();
  }

  std::map<std::string, Lists> parts_;
  // By category, the class of its first object that counts.
  std::map<std::string, std::string> classes_;
};

}  // namespace

std::unique_ptr<Writer> coco_writer(const Writing& to) { return std::make_unique<CocoWriter>(to); }

}  // namespace airtruth::exchange
