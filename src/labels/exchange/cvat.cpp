// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include <fmt/format.h>

#include "foundation/base/files.h"
#include "foundation/geometry/box.h"
#include "labels/exchange/parts.h"
#include "labels/exchange/pictures.h"
#include "labels/exchange/text.h"
#include "labels/exchange/xml_file.h"

// "CVAT for video 1.1" (docs.cvat.ai, "XML annotation format"): one file for each clip, with one
// <track> for each object. A track has a <box> in every frame that shows the object, and one with
// outside="1" after it has left. Frames count from 0, corners from (0, 0). Where there are
// pictures, one <image> for each frame names its file: CVAT's and datumaro's readers
// (dataset_manager/formats/cvat.py; plugins/data_formats/cvat/base.py) take images/frame_000000.png
// for a frame without one, and datumaro's refuses a name whose file is not there.
namespace airtruth::exchange {
namespace {

constexpr const char* kNoBox = "shapes that bound no area (points, cuboids, skeletons and tags)";
constexpr const char* kAttributes[] = {
    "visible", "truncated", "range_m", "above_horizon", "contrast_to_noise"};

class CvatWriter : public FolderWriter {
 public:
  using FolderWriter::FolderWriter;

  void add(const Clip& clip, const std::string& part) override {
    pugi::xml_document document;
    pugi::xml_node declaration = document.append_child(pugi::node_declaration);
    declaration.append_attribute("version") = "1.0";
    declaration.append_attribute("encoding") = "utf-8";
    pugi::xml_node top = document.append_child("annotations");
    add_text(top, "version", "1.1");
    add_task(top.append_child("meta").append_child("task"), clip);
    if (options_.with_images) add_images(top, clip);
    // The ids are those of the tracks less 1; where one would be none of the format's, their
    // places.
    const std::vector<std::int64_t> tracks = tracks_of(clip);
    const bool are_ids = tracks.empty() || (tracks.front() >= 1 && tracks.back() <= kMaxTracks + 1);
    for (std::size_t i = 0; i < tracks.size(); ++i)
      add_track(top, clip, tracks[i], are_ids ? tracks[i] - 1 : static_cast<std::int64_t>(i));
    fs::create_directories(root_ / part / clip.name);
    write_file(root_ / part / clip.name / "annotations.xml", text_of(document));
  }

 private:
  fs::path image(const Clip& clip, const std::string& part, std::size_t i) const override {
    return fs::path(part) / clip.name / "images" / file_name(i);
  }
  std::string file_name(std::size_t i) const {
    return fmt::format("frame_{:06}{}", i, options_.image_extension);
  }

  void add_images(pugi::xml_node top, const Clip& clip) const {
    for (std::size_t i = 0; i < clip.frames.size(); ++i) {
      pugi::xml_node image = top.append_child("image");
      image.append_attribute("id") = static_cast<unsigned long long>(i);
      image.append_attribute("name") = file_name(i).c_str();
      if (clip.width <= 0 || clip.height <= 0) continue;
      image.append_attribute("width") = clip.width;
      image.append_attribute("height") = clip.height;
    }
  }

  void add_task(pugi::xml_node task, const Clip& clip) const {
    const std::size_t last = clip.frames.empty() ? 0 : clip.frames.size() - 1;
    add_text(task, "name", clip.name);
    add_text(task, "size", std::to_string(clip.frames.size()));
    add_text(task, "mode", "interpolation");
    add_text(task, "overlap", "0");
    add_text(task, "start_frame", "0");
    add_text(task, "stop_frame", std::to_string(last));
    add_text(task, "frame_filter", "");
    pugi::xml_node labels = task.append_child("labels");
    for (const std::string& category : options_.categories) {
      pugi::xml_node label = labels.append_child("label");
      add_text(label, "name", category);
      add_text(label, "type", "any");
      pugi::xml_node attributes = label.append_child("attributes");
      for (const char* name : kAttributes) {
        pugi::xml_node attribute = attributes.append_child("attribute");
        add_text(attribute, "name", name);
        add_text(attribute, "mutable", "True");
        add_text(attribute, "input_type", "text");
        add_text(attribute, "default_value", "");
        add_text(attribute, "values", "");
      }
    }
    pugi::xml_node size = task.append_child("original_size");
    add_text(size, "width", std::to_string(clip.width));
    add_text(size, "height", std::to_string(clip.height));
  }

  static void add_track(pugi::xml_node top,
                        const Clip& clip,
                        std::int64_t number,
                        std::int64_t id) {
    pugi::xml_node track;
    const Label* last = nullptr;
    for (std::size_t i = 0; i < clip.frames.size(); ++i) {
      const auto& labels = clip.frames[i].labels;
      const auto found = std::ranges::find(labels, number, &Label::track);
      const bool shown = found != labels.end();
      if (shown && !track) {
        track = top.append_child("track");
        track.append_attribute("id") = static_cast<long long>(id);
        track.append_attribute("label") = found->category.c_str();
        track.append_attribute("source") = "file";
      }
      if (shown)
        add_box(track, *found, i, false);
      else if (last != nullptr)
        add_box(track, *last, i, true);
      last = shown ? &*found : nullptr;
    }
  }

  static void add_box(pugi::xml_node track, const Label& label, std::size_t i, bool outside) {
    pugi::xml_node box = track.append_child("box");
    const Box& b = label.box_px;
    box.append_attribute("frame") = static_cast<unsigned long long>(i);
    box.append_attribute("outside") = outside ? 1 : 0;
    box.append_attribute("occluded") = label.occluded.value_or(false) ? 1 : 0;
    box.append_attribute("keyframe") = 1;
    box.append_attribute("xtl") = number(b.x).c_str();
    box.append_attribute("ytl") = number(b.y).c_str();
    box.append_attribute("xbr") = number(b.right()).c_str();
    box.append_attribute("ybr") = number(b.bottom()).c_str();
    box.append_attribute("z_order") = 0;
    const auto attribute = [&](const char* name, const std::string& value) {
      add_text(box, "attribute", value).append_attribute("name") = name;
    };
    if (label.visible) attribute("visible", number(*label.visible));
    if (label.truncated) attribute("truncated", *label.truncated ? "true" : "false");
    if (label.range_m) attribute("range_m", number(*label.range_m));
    if (label.contrast_to_noise) attribute("contrast_to_noise", number(*label.contrast_to_noise));
    if (label.above_horizon) attribute("above_horizon", *label.above_horizon ? "true" : "false");
  }
};

// "x,y;x,y;..."
BoxBounds bounds_of_points(const XmlFile& xml, const pugi::xml_node& shape) {
  BoxBounds bounds;
  const std::string text = shape.attribute("points").value();
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(';', at), text.size());
    const std::string point = text.substr(at, end - at);
    const std::size_t comma = std::min(point.find(','), point.size());
    const auto x = number_in(point.substr(0, comma));
    const auto y = comma < point.size() ? number_in(point.substr(comma + 1)) : std::nullopt;
    if (!x || !y) xml.fail(shape, "has points that are no x,y;x,y;...");
    bounds.add({*x, *y});
    at = end + 1;
  }
  return bounds;
}

Box box_about(double x, double y, double half_width, double half_height) {
  return {x - half_width, y - half_height, 2 * half_width, 2 * half_height};
}

// The bounds of a shape; empty for one that encloses nothing (points, tag) and for those of further
// dimensions (cuboid, skeleton).
std::optional<Box> box_of(const XmlFile& xml, const pugi::xml_node& shape) {
  const std::string kind = shape.name();
  const double degrees = number_in(shape.attribute("rotation").value()).value_or(0);
  const double cosine = std::abs(std::cos(degrees * std::numbers::pi / 180));
  const double sine = std::abs(std::sin(degrees * std::numbers::pi / 180));
  if (kind == "box") {
    const double x = xml.attribute(shape, "xtl");
    const double y = xml.attribute(shape, "ytl");
    const double width = xml.attribute(shape, "xbr") - x;
    const double height = xml.attribute(shape, "ybr") - y;
    if (degrees == 0) return Box{x, y, width, height};
    return box_about(x + width / 2,
                     y + height / 2,
                     (width * cosine + height * sine) / 2,
                     (width * sine + height * cosine) / 2);
  }
  if (kind == "ellipse") {
    const double rx = xml.attribute(shape, "rx");
    const double ry = xml.attribute(shape, "ry");
    return box_about(xml.attribute(shape, "cx"),
                     xml.attribute(shape, "cy"),
                     std::hypot(rx * cosine, ry * sine),
                     std::hypot(rx * sine, ry * cosine));
  }
  if (kind == "mask")
    return Box{xml.attribute(shape, "left"),
               xml.attribute(shape, "top"),
               xml.attribute(shape, "width"),
               xml.attribute(shape, "height")};
  if (kind == "polygon" || kind == "polyline") return bounds_of_points(xml, shape).box();
  return std::nullopt;
}

// A label without its box.
Label label_of(const XmlFile& xml,
               const pugi::xml_node& shape,
               const std::string& category,
               std::int64_t track) {
  Label label;
  label.track = track;
  label.category = category;
  if (shape.attribute("occluded")) label.occluded = xml.attribute(shape, "occluded") != 0;
  for (const pugi::xml_node& attribute : shape.children("attribute")) {
    const std::string name = attribute.attribute("name").value();
    const std::string value = attribute.child_value();
    if (name == "visible") label.visible = number_in(value);
    if (name == "range_m") label.range_m = number_in(value);
    if (name == "contrast_to_noise") label.contrast_to_noise = number_in(value);
    if (name == "track_id")
      if (const auto id = whole_in(number_in(value).value_or(-1), 0, kMaxTracks)) label.track = *id;
    if (value != "true" && value != "false") continue;
    if (name == "truncated") label.truncated = value == "true";
    if (name == "above_horizon") label.above_horizon = value == "true";
  }
  return label;
}

// Between two key frames CVAT interpolates the box.
Label between(const Label& from, const Label& to, double share) {
  Label label = from;
  const auto mix = [&](double a, double b) { return a + share * (b - a); };
  label.box_px = {mix(from.box_px.x, to.box_px.x),
                  mix(from.box_px.y, to.box_px.y),
                  mix(from.box_px.width, to.box_px.width),
                  mix(from.box_px.height, to.box_px.height)};
  return label;
}

// A file of "CVAT for video": frames, and tracks that are shown in them.
class TrackReader {
 public:
  TrackReader(const fs::path& file, const XmlFile& xml, const Reading& in)
      : file_(file), xml_(xml), in_(in) {}

  Clip read(const pugi::xml_node& top, const pugi::xml_node& task, const std::string& name) {
    clip_.name = name;
    const pugi::xml_node size = task.child("original_size");
    clip_.width = side_of(number_in(size.child_value("width")));
    clip_.height = side_of(number_in(size.child_value("height")));
    frames(top, task);
    for (const pugi::xml_node& track : top.children("track")) add(track);
    for (LabelledFrame& frame : clip_.frames)
      std::ranges::stable_sort(frame.labels, {}, &Label::track);
    join(top);
    return clip_;
  }

 private:
  std::int64_t frame_of(const pugi::xml_node& node, const char* attribute) const {
    const auto number = whole_in(xml_.attribute(node, attribute), 0, kMaxFrames);
    if (!number) xml_.fail(node, std::string("has ") + attribute + " that is no frame, from 0 on");
    return *number;
  }

  // The frames of the task: every step-th of the video from its start on, by their numbers in the
  // video. Where a label has another number, frames are counted within the task.
  void frames(const pugi::xml_node& top, const pugi::xml_node& task) {
    const auto stated = [&](const char* name) {
      return whole_in(number_in(task.child_value(name)).value_or(0), 0, kMaxFrames);
    };
    const auto size = stated("size");
    if (!size) xml_.fail(task, "has a size that is no number of frames");
    first_ = stated("start_frame").value_or(0);
    const std::string filter = task.child_value("frame_filter");
    if (filter.starts_with("step="))
      step_ = whole_in(number_in(filter.substr(5)).value_or(0), 1, kMaxFrames).value_or(1);
    std::int64_t last = first_ + (std::max<std::int64_t>(*size, 1) - 1) * step_;
    bool are_of_video = true;
    const auto see = [&](std::int64_t number) {
      are_of_video = are_of_video && number >= first_ && (number - first_) % step_ == 0;
      last = std::max(last, number);
    };
    for (const pugi::xml_node& image : top.children("image")) see(frame_of(image, "id"));
    for (const pugi::xml_node& track : top.children("track"))
      for (const pugi::xml_node& shape : track.children()) see(frame_of(shape, "frame"));
    if (!are_of_video) {
      last = std::max<std::int64_t>(*size, 1) - 1;
      for (const pugi::xml_node& track : top.children("track"))
        for (const pugi::xml_node& shape : track.children())
          last = std::max(last, frame_of(shape, "frame"));
      first_ = 0;
      step_ = 1;
    }
    if (*size == 0 && !top.child("image") && !top.child("track")) return;
    in_.fill(static_cast<std::size_t>((last - first_) / step_ + 1), clip_.name);
    for (std::int64_t number = first_; number <= last; number += step_)
      clip_.frames.push_back({number, std::nullopt, {}});
  }

  std::size_t place_of(std::int64_t number) const {
    return static_cast<std::size_t>((number - first_) / step_);
  }

  void add(const pugi::xml_node& track) {
    const auto id = whole_in(xml_.attribute(track, "id"), 0, kMaxTracks);
    if (!id) xml_.fail(track, "has an id that is no whole number");
    std::optional<Label> last;
    std::size_t last_place = 0;
    for (const pugi::xml_node& shape : track.children()) {
      const std::size_t place = place_of(frame_of(shape, "frame"));
      const auto box = box_of(xml_, shape);
      if (!box) {
        in_.left_out.add(kNoBox, file_.string() + ", <" + shape.name() + ">");
        continue;
      }
      Label label = label_of(xml_, shape, track.attribute("label").value(), *id + 1);
      label.box_px = *box;
      const bool gone = shape.attribute("outside") && xml_.attribute(shape, "outside") != 0;
      if (last)
        for (std::size_t i = last_place + 1; i < place; ++i)
          put(gone ? *last
                   : between(*last,
                             label,
                             static_cast<double>(i - last_place) /
                                 static_cast<double>(place - last_place)),
              i);
      last.reset();
      if (gone) continue;
      put(label, place);
      last = label;
      last_place = place;
    }
    // The last box stays to the end.
    if (last)
      for (std::size_t i = last_place + 1; i < clip_.frames.size(); ++i) put(*last, i);
  }

  void put(const Label& label, std::size_t place) {
    in_.fill(1, clip_.name);
    add_label(clip_.frames.at(place).labels, label, clip_, in_.left_out, file_.string());
  }

  // Pictures belong to frames by the <image> that names them, or else by the number in their names.
  void join(const pugi::xml_node& top) {
    const fs::path images = file_.parent_path() / "images";
    if (pictures_in(images).empty()) return;
    if (!top.child("image")) return join_by_number(clip_, images, 0, in_.warn);
    for (const pugi::xml_node& image : top.children("image")) {
      const std::string name = image.attribute("name").value();
      expect_inside(name, {file_.string()});
      const std::size_t place = place_of(frame_of(image, "id"));
      if (place >= clip_.frames.size())
        xml_.fail(image,
                  fmt::format("has the id {}, and the boxes' frames count from 0; expected an id "
                              "below {}",
                              place,
                              clip_.frames.size()));
      clip_.frames[place].picture = name;
    }
    join_by_name(clip_, images, in_.warn);
  }

  fs::path file_;
  const XmlFile& xml_;
  const Reading& in_;
  std::int64_t first_ = 0;
  std::int64_t step_ = 1;
  Clip clip_;
};

// A file of "CVAT for images": pictures by name, each with its shapes.
Clips read_images(const fs::path& file,
                  const XmlFile& xml,
                  const pugi::xml_node& top,
                  const std::string& name,
                  const Reading& in) {
  const fs::path root = file.parent_path();
  std::map<std::string, std::vector<LabelledPicture>> subsets;
  for (const pugi::xml_node& image : top.children("image")) {
    const std::string subset = image.attribute("subset").value();
    const std::vector<fs::path> folders = {
        root / "images" / subset, root / "images", root / subset, root};
    LabelledPicture picture;
    picture.name = image.attribute("name").value();
    if (picture.name.empty()) xml.fail(image, "has no name");
    picture.folder = folder_of_picture(folders, picture.name, {file.string()});
    picture.width = side_of(number_in(image.attribute("width").value()));
    picture.height = side_of(number_in(image.attribute("height").value()));
    for (const pugi::xml_node& shape : image.children()) {
      const auto box = box_of(xml, shape);
      if (!box) {
        in.left_out.add(kNoBox, file.string() + ", <" + shape.name() + ">");
        continue;
      }
      Label label = label_of(xml, shape, shape.attribute("label").value(), kNoTrack);
      label.box_px = *box;
      add_label(picture.labels, std::move(label), picture, in.left_out, file.string());
    }
    number_tracks(picture.labels);
    subsets[subset].push_back(std::move(picture));
  }
  Clips clips;
  for (auto& [subset, pictures] : subsets)
    append(clips,
           clips_of_pictures(std::move(pictures), subset.empty() ? name : subset, file, in.warn));
  return clips;
}

Clips clips_of_file(const fs::path& file, const Reading& in) {
  const XmlFile xml(file);
  const pugi::xml_node top = xml.top("annotations");
  const pugi::xml_node meta = top.child("meta");
  // The element is <task>, or <job> in files of newer servers; a <project> holds several tasks.
  pugi::xml_node task = meta.child("task");
  if (!task) task = meta.child("job");
  const pugi::xml_node project = meta.child("project");
  std::string name = (task ? task : project).child_value("name");
  if (name.empty() || name.find('/') != std::string::npos)
    name = file.parent_path().filename().string();
  if (!top.child("track") && top.child("image")) return read_images(file, xml, top, name, in);
  if (project) xml.fail(project, "holds tracks of several tasks; expected an export of one task");
  return {TrackReader(file, xml, in).read(top, task, name)};
}

}  // namespace

std::unique_ptr<Writer> cvat_writer(const Writing& to) { return std::make_unique<CvatWriter>(to); }

Clips read_cvat(const Reading& in) {
  std::vector<fs::path> found = files_with(in.source, ".xml");
  for (const fs::path& folder : entries(in.source)) {
    for (const fs::path& file : files_with(folder, ".xml")) found.push_back(file);
    for (const fs::path& inner : entries(folder))
      if (is_there(inner / "annotations.xml")) found.push_back(inner / "annotations.xml");
  }
  Clips clips;
  for (const fs::path& file : files_of(in.source, found, "annotations.xml"))
    append(clips, clips_of_file(file, in));
  return clips;
}

}  // namespace airtruth::exchange
