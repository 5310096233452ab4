// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <fmt/format.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "labels/exchange/parts.h"
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

constexpr const char* kAttributes[] = {"visible", "truncated", "range_m", "above_horizon"};

std::string number(double value) { return fmt::format("{}", value); }

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
    for (const std::int64_t track : tracks_of(clip)) add_track(top, clip, track);
    fs::create_directories(root_ / part / clip.name);
    write_file(root_ / part / clip.name / "annotations.xml", text_of(document));
  }

 private:
  fs::path image(const Clip& clip, const std::string& part, std::size_t i) const override {
    return fs::path(part) / clip.name / "images" / file_name(i);
  }
  std::string file_name(std::size_t i) const {
    return "frame_" + padded(static_cast<std::int64_t>(i), 6) + options_.image_extension;
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

  static void add_track(pugi::xml_node top, const Clip& clip, std::int64_t id) {
    pugi::xml_node track;
    const Label* last = nullptr;
    for (std::size_t i = 0; i < clip.frames.size(); ++i) {
      const auto& labels = clip.frames[i].labels;
      const auto found = std::find_if(
          labels.begin(), labels.end(), [&](const Label& label) { return label.track == id; });
      const bool shown = found != labels.end();
      if (shown && !track) {
        track = top.append_child("track");
        track.append_attribute("id") = static_cast<long long>(id - 1);
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
    if (label.above_horizon) attribute("above_horizon", *label.above_horizon ? "true" : "false");
  }
};

Label label_of(const XmlFile& xml,
               const pugi::xml_node& box,
               const std::string& category,
               std::int64_t track) {
  Label label;
  label.track = track;
  label.category = category;
  const double x = xml.attribute(box, "xtl");
  const double y = xml.attribute(box, "ytl");
  label.box_px = {x, y, xml.attribute(box, "xbr") - x, xml.attribute(box, "ybr") - y};
  label.occluded = xml.attribute(box, "occluded") != 0;
  for (const pugi::xml_node& attribute : box.children("attribute")) {
    const std::string name = attribute.attribute("name").value();
    const std::string value = attribute.child_value();
    if (name == "visible") label.visible = number_in(value);
    if (name == "range_m") label.range_m = number_in(value);
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

class CvatReader {
 public:
  CvatReader(const fs::path& file, LeftOut& left_out)
      : file_(file), xml_(file), left_out_(left_out) {}

  Clip read() {
    const pugi::xml_node top = xml_.top("annotations");
    about(top.child("meta"));
    for (const pugi::xml_node& image : top.children("image")) add_image(image);
    for (const pugi::xml_node& track : top.children("track")) add(track);
    for (LabelledFrame& frame : clip_.frames)
      std::stable_sort(frame.labels.begin(),
                       frame.labels.end(),
                       [](const Label& a, const Label& b) { return a.track < b.track; });
    return clip_;
  }

 private:
  // The element is <task>, or <job> in files of newer servers.
  void about(const pugi::xml_node& meta) {
    pugi::xml_node task = meta.child("task");
    if (!task) task = meta.child("job");
    clip_.name = task.child_value("name");
    if (clip_.name.empty() || clip_.name.find('/') != std::string::npos)
      clip_.name = file_.parent_path().filename().string();
    const auto frames = whole_in(number_in(task.child_value("size")).value_or(0), 0, kMaxFrames);
    if (!frames) xml_.fail(task, "has a size that is no number of frames");
    if (*frames > 0) frame_at(clip_, static_cast<std::size_t>(*frames) - 1);
    const pugi::xml_node size = task.child("original_size");
    clip_.width = side_of(number_in(size.child_value("width")));
    clip_.height = side_of(number_in(size.child_value("height")));
    if (const fs::path images = file_.parent_path() / "images"; !entries(images).empty())
      clip_.media = images;
  }

  // In "CVAT for images 1.1" these elements contain the boxes. In a file of tracks they only name
  // the pictures.
  void add_image(const pugi::xml_node& image) {
    const auto number = whole_in(xml_.attribute(image, "id"), 0, kMaxFrames);
    if (!number) xml_.fail(image, "has an id that is no whole number from 0 on");
    const auto frame = static_cast<std::size_t>(*number);
    frame_at(clip_, frame);
    if (clip_.width == 0) {
      clip_.width = side_of(number_in(image.attribute("width").value()));
      clip_.height = side_of(number_in(image.attribute("height").value()));
    }
    std::int64_t track = 0;
    for (const pugi::xml_node& box : image.children("box"))
      put(label_of(xml_, box, box.attribute("label").value(), ++track), frame);
  }

  void add(const pugi::xml_node& track) {
    const auto id = whole_in(xml_.attribute(track, "id"), 0, 1'000'000'000);
    if (!id) xml_.fail(track, "has an id that is no whole number");
    std::optional<Label> last;
    std::size_t last_frame = 0;
    for (const pugi::xml_node& box : track.children("box")) {
      const auto number = whole_in(xml_.attribute(box, "frame"), 0, kMaxFrames);
      if (!number) xml_.fail(box, "has a frame that is no whole number from 0 on");
      const auto frame = static_cast<std::size_t>(*number);
      const Label label = label_of(xml_, box, track.attribute("label").value(), *id + 1);
      if (last) {
        const bool gone = xml_.attribute(box, "outside") != 0;
        for (std::size_t i = last_frame + 1; i < frame; ++i)
          put(gone ? *last
                   : between(*last,
                             label,
                             static_cast<double>(i - last_frame) /
                                 static_cast<double>(frame - last_frame)),
              i);
      }
      last.reset();
      if (xml_.attribute(box, "outside") != 0) continue;
      put(label, frame);
      last = label;
      last_frame = frame;
    }
    // The last box stays to the end.
    if (last)
      for (std::size_t i = last_frame + 1; i < clip_.frames.size(); ++i) put(*last, i);
  }

  void put(const Label& label, std::size_t frame) {
    add_label(frame_at(clip_, frame), label, clip_, left_out_, file_.string());
  }

  fs::path file_;
  XmlFile xml_;
  LeftOut& left_out_;
  Clip clip_;
};

}  // namespace

std::unique_ptr<Writer> cvat_writer(Format, const fs::path& root, const WriteOptions& options) {
  return std::make_unique<CvatWriter>(root, options);
}

Clips read_cvat(const Reading& in) {
  std::vector<fs::path> files;
  if (fs::is_directory(in.source)) {
    files = files_with(in.source, ".xml");
    for (const fs::path& folder : entries(in.source)) {
      for (const fs::path& file : files_with(folder, ".xml")) files.push_back(file);
      for (const fs::path& inner : entries(folder))
        if (fs::exists(inner / "annotations.xml")) files.push_back(inner / "annotations.xml");
    }
  } else {
    files = {in.source};
  }
  if (files.empty()) throw Error("holds no annotations.xml", {in.source.string()});
  Clips clips;
  for (const fs::path& file : files) clips.push_back(CvatReader(file, in.left_out).read());
  return clips;
}

}  // namespace airtruth::exchange
