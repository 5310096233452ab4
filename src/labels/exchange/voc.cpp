// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/geometry/box.h"
#include "labels/exchange/parts.h"
#include "labels/exchange/text.h"
#include "labels/exchange/xml_file.h"

// Pascal VOC (Everingham et al. 2010; VOC2012 development kit, section 4): Annotations/NAME.xml,
// JPEGImages/NAME.jpg, ImageSets/Main/PART.txt. Pixels count from 1 and both corners belong to the
// box: xmin = x + 1, xmax = x + width. Corners are whole numbers, of the pixels that the box
// touches within the picture. The development kit's VOCreadrecxml.m requires folder, filename,
// source.database, size and segmented, and finds the picture at FOLDER/JPEGImages/FILENAME; its XML
// reader (VOCxml2struct.m) supports only elements, tabs and line ends. Python's readers apply int()
// to the corners, of truncated and of difficult. Therefore truncated, occluded and difficult are
// always present: 0 where they are unknown; <unknown> then names them.
namespace airtruth::exchange {
namespace {

void add_number(pugi::xml_node node, const char* name, double value) {
  add_text(node, name, fmt::format("{}", value));
}

class VocWriter : public FolderWriter {
 public:
  VocWriter(const fs::path& root, const WriteOptions& options) : FolderWriter(root, options) {
    fs::create_directories(root_ / "Annotations");
    fs::create_directories(root_ / "ImageSets" / "Main");
  }

  void add(const Clip& clip, const std::string& part) override {
    for (std::size_t i = 0; i < clip.frames.size(); ++i) {
      write_file(root_ / "Annotations" / (numbered_stem(clip, i) + ".xml"),
                 annotation(clip, i),
                 Flush::kLater);
      lists_[part] += numbered_stem(clip, i) + "\n";
    }
  }

  void finish() override {
    for (const std::string& part : options_.parts)
      write_file(root_ / "ImageSets" / "Main" / (part + ".txt"), lists_[part]);
  }

 private:
  fs::path image(const Clip& clip, const std::string&, std::size_t i) const override {
    return fs::path("JPEGImages") / (numbered_stem(clip, i) + options_.image_extension);
  }

  std::string annotation(const Clip& clip, std::size_t i) const {
    pugi::xml_document document;
    pugi::xml_node top = document.append_child("annotation");
    add_text(top, "folder", fs::absolute(root_).lexically_normal().filename().string());
    add_text(top, "filename", numbered_stem(clip, i) + options_.image_extension);
    pugi::xml_node source = top.append_child("source");
    add_text(source, "database", "airtruth");
    add_text(source, "annotation", "airtruth");
    add_text(source, "image", clip.name);
    pugi::xml_node size = top.append_child("size");
    add_number(size, "width", clip.width);
    add_number(size, "height", clip.height);
    add_number(size, "depth", 3);
    add_number(top, "segmented", 0);
    for (const Label& label : clip.frames[i].labels) add_object(top, label, clip);
    return bare_text_of(document);
  }

  static void add_object(pugi::xml_node top, const Label& label, const Clip& clip) {
    const auto cut = clipped(label.box_px, clip.width, clip.height);
    if (!cut) return;
    pugi::xml_node object = top.append_child("object");
    add_text(object, "name", label.category);
    add_text(object, "pose", "Unspecified");
    add_number(object, "truncated", label.truncated.value_or(false) ? 1 : 0);
    add_number(object, "occluded", label.occluded.value_or(false) ? 1 : 0);
    add_number(object, "difficult", 0);
    std::string unknown = label.truncated ? "" : "truncated";
    if (!label.occluded) unknown += unknown.empty() ? "occluded" : " occluded";
    if (!unknown.empty()) add_text(object, "unknown", unknown);
    pugi::xml_node box = object.append_child("bndbox");
    const PixelBox pixels = pixels_of(*cut);
    add_number(box, "xmin", pixels.x + 1);
    add_number(box, "ymin", pixels.y + 1);
    add_number(box, "xmax", pixels.right());
    add_number(box, "ymax", pixels.bottom());
  }
};

std::optional<bool> flag(const pugi::xml_node& object, const char* name) {
  const std::string unknown = std::string(" ") + object.child_value("unknown") + " ";
  if (unknown.find(std::string(" ") + name + " ") != std::string::npos) return std::nullopt;
  const auto value = number_in(object.child_value(name));
  return value ? std::optional(*value != 0) : std::nullopt;
}

void read_picture(const fs::path& file, Clip& clip, LeftOut& left_out) {
  const XmlFile xml(file);
  const pugi::xml_node top = xml.top("annotation");
  const pugi::xml_node size = xml.child(top, "size");
  clip.width = side_of(xml.number(size, "width"));
  clip.height = side_of(xml.number(size, "height"));
  const auto [name, number] = name_and_number(file.stem().string());
  LabelledFrame frame;
  frame.frame = number.value_or(static_cast<std::int64_t>(clip.frames.size()));
  for (const pugi::xml_node& object : top.children("object")) {
    Label label;
    label.track = static_cast<std::int64_t>(frame.labels.size()) + 1;
    label.category = xml.child(object, "name").child_value();
    label.truncated = flag(object, "truncated");
    label.occluded = flag(object, "occluded");
    const pugi::xml_node box = xml.child(object, "bndbox");
    const double x = xml.number(box, "xmin") - 1;
    const double y = xml.number(box, "ymin") - 1;
    label.box_px = {x, y, xml.number(box, "xmax") - x, xml.number(box, "ymax") - y};
    add_label(frame, label, clip, left_out, file.string());
  }
  clip.frames.push_back(std::move(frame));
}

}  // namespace

std::unique_ptr<Writer> voc_writer(Format, const fs::path& root, const WriteOptions& options) {
  return std::make_unique<VocWriter>(root, options);
}

Clips read_voc(const Reading& in) {
  const fs::path annotations = in.source / "Annotations";
  std::map<std::string, Clip> clips;
  for (const fs::path& file :
       files_with(fs::is_directory(annotations) ? annotations : in.source, ".xml")) {
    const std::string name = name_and_number(file.stem().string()).first;
    Clip& clip = clips[name];
    clip.name = name.empty() ? "images" : name;
    clip.media = numbered_media(in.source / "JPEGImages", name);
    read_picture(file, clip, in.left_out);
  }
  if (clips.empty()) throw Error("holds no Annotations/*.xml", {in.source.string()});
  Clips result;
  for (auto& [name, clip] : clips) {
    sort_frames(clip);
    result.push_back(std::move(clip));
  }
  return result;
}

}  // namespace airtruth::exchange
