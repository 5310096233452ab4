// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <optional>

#include "foundation/base/error.h"
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
      add_attributes(annotation, *label);
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
      left_out_.add("boxes that are empty or outside their image", annotation.place());
      return std::nullopt;
    }
    return label;
  }

  static void add_attributes(const JsonObject& annotation, Label& label) {
    label.visible = annotation.maybe_number("visibility");
    label.occluded = annotation.maybe_truth("occluded");
    label.truncated = annotation.maybe_truth("truncated");
    label.range_m = annotation.maybe_number("range_m");
    label.above_horizon = annotation.maybe_truth("above_horizon");
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

Clips read_coco(const fs::path& source, const ReadOptions&, const Warn& warn) {
  std::vector<fs::path> files = {source};
  if (fs::is_directory(source)) {
    files = files_with(source / "annotations", ".json");
    if (files.empty()) files = files_with(source, ".json");
  }
  if (files.empty()) throw Error("holds no annotation file (*.json)", {source.string()});
  Clips clips;
  for (const fs::path& file : files) {
    Clips more = CocoReader(file, warn).read();
    std::move(more.begin(), more.end(), std::back_inserter(clips));
  }
  return clips;
}

}  // namespace airtruth::exchange
