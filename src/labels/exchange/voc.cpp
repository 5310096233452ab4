// SPDX-License-Identifier: Apache-2.0
#include <map>
#include <span>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/geometry/box.h"
#include "labels/exchange/parts.h"
#include "labels/exchange/pictures.h"
#include "labels/exchange/text.h"
#include "labels/exchange/xml_file.h"
#include "labels/label_file/label_file.h"

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
  explicit VocWriter(const Writing& to) : FolderWriter(to) {
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
    add_text(top, "folder", absolute_path(root_).filename().string());
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
    return text_of(document, "\t", pugi::format_default | pugi::format_no_declaration);
  }

  static void add_object(pugi::xml_node top, const Label& label, const Clip& clip) {
    const auto cut = clipped(label.box_px, clip.width, clip.height);
    if (!cut) return;
    pugi::xml_node object = top.append_child("object");
    add_text(object, "name", label.category);
    add_text(object, "pose", "Unspecified");
    add_number(object, "truncated", label.truncated.value_or(false) ? 1 : 0);
    add_number(object, "occluded", label.occluded.value_or(false) ? 1 : 0);
    // The development kit's evaluation passes over what is difficult.
    add_number(object, "difficult", label.object_class == label_file::kIgnore ? 1 : 0);
    if (label.contrast_to_noise)
      add_text(object, "contrast_to_noise", number(*label.contrast_to_noise));
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

// The pictures of the folders by their names without ending: the folder and the name.
using ByStem = std::map<std::string, std::pair<fs::path, std::string>>;

LabelledPicture read_picture(const fs::path& file,
                             std::span<const fs::path> folders,
                             const ByStem& stems,
                             const Reading& in) {
  const XmlFile xml(file);
  const pugi::xml_node top = xml.top("annotation");
  // <filename>, or else the picture with the annotation's own name.
  LabelledPicture picture;
  picture.name = top.child_value("filename");
  if (!picture.name.empty())
    picture.folder = folder_of_picture(folders, picture.name, {file.string()});
  const auto found = stems.find(file.stem().string());
  if (picture.folder.empty() && found != stems.end())
    std::tie(picture.folder, picture.name) = found->second;
  if (picture.name.empty()) picture.name = file.stem().string();
  if (const pugi::xml_node size = top.child("size")) {
    picture.width = side_of(xml.number(size, "width"));
    picture.height = side_of(xml.number(size, "height"));
  }
  if (picture.width == 0 && !picture.folder.empty() && in.options.size_of_picture)
    std::tie(picture.width, picture.height) =
        in.options.size_of_picture(picture.folder / picture.name);
  for (const pugi::xml_node& object : top.children("object")) {
    Label label;
    label.track = std::ssize(picture.labels) + 1;
    label.category = xml.child(object, "name").child_value();
    label.truncated = flag(object, "truncated");
    label.occluded = flag(object, "occluded");
    if (flag(object, "difficult").value_or(false)) label.object_class = label_file::kIgnore;
    label.contrast_to_noise = number_in(object.child("contrast_to_noise").child_value());
    const pugi::xml_node box = xml.child(object, "bndbox");
    const double x = xml.number(box, "xmin") - 1;
    const double y = xml.number(box, "ymin") - 1;
    label.box_px = {x, y, xml.number(box, "xmax") - x, xml.number(box, "ymax") - y};
    add_label(picture.labels, std::move(label), picture, in.left_out, file.string());
  }
  return picture;
}

// Annotations/ beside JPEGImages/; or a folder with both, or one for each part, as Roboflow writes
// them.
std::vector<fs::path> folders_of_annotations(const fs::path& source) {
  if (fs::is_directory(source / "Annotations")) return {source / "Annotations"};
  if (!files_with(source, ".xml").empty()) return {source};
  std::vector<fs::path> parts;
  for (const fs::path& part : entries(source))
    if (!files_with(part, ".xml").empty()) parts.push_back(part);
  return parts;
}

}  // namespace

std::unique_ptr<Writer> voc_writer(const Writing& to) { return std::make_unique<VocWriter>(to); }

Clips read_voc(const Reading& in) {
  Clips clips;
  for (const fs::path& annotations : folders_of_annotations(in.source)) {
    const std::vector<fs::path> folders = {annotations.parent_path() / "JPEGImages", annotations};
    ByStem stems;
    for (const fs::path& folder : folders)
      for (const std::string& name : pictures_in(folder))
        stems.emplace(fs::path(name).stem().string(), std::pair(folder, name));
    std::vector<LabelledPicture> pictures;
    for (const fs::path& file : files_with(annotations, ".xml"))
      pictures.push_back(read_picture(file, folders, stems, in));
    append(clips, clips_of_pictures(std::move(pictures), "", annotations, in.warn));
  }
  if (clips.empty()) throw Error("holds no Annotations/*.xml", {in.source.string()});
  return clips;
}

}  // namespace airtruth::exchange
