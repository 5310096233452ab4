// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <optional>
#include <tuple>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <yaml-cpp/yaml.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/geometry/box.h"
#include "labels/exchange/parts.h"
#include "labels/exchange/pictures.h"
#include "labels/exchange/text.h"

// YOLO as Ultralytics reads it (docs.ultralytics.com, "Detection dataset format"):
// images/PART/*.jpg and labels/PART/*.txt of the same name, one line "class x y width height" for
// each object, class from 0, the box's centre and size as shares of the picture. A picture without
// an object has an empty file. Its loader (ultralytics/data/utils.py) refuses a picture with a
// coordinate outside of 0..1: boxes are clipped at the picture's edge. `path` in data.yaml is
// absolute, since a relative one counts from the user's own folder of data sets.
namespace airtruth::exchange {
namespace {

class YoloWriter : public FolderWriter {
 public:
  explicit YoloWriter(const Writing& to) : FolderWriter(to) {
    for (const std::string& part : options_.parts) {
      fs::create_directories(root_ / "labels" / part);
      // The loader looks for this folder.
      fs::create_directories(root_ / "images" / part);
    }
  }

  void add(const Clip& clip, const std::string& part) override {
    expect_held(Format::kYolo, clip);
    for (std::size_t i = 0; i < clip.frames.size(); ++i) {
      std::string text;
      for (const Label& label : clip.frames[i].labels)
        if (const auto b = clipped(label.box_px, clip.width, clip.height))
          text += fmt::format("{} {} {} {} {}\n",
                              class_of(label.category),
                              (b->x + b->width / 2) / clip.width,
                              (b->y + b->height / 2) / clip.height,
                              b->width / clip.width,
                              b->height / clip.height);
      write_file(root_ / "labels" / part / (numbered_stem(clip, i) + ".txt"), text, Flush::kLater);
    }
  }

  void finish() override {
    const auto has = [&](const char* part) {
      return std::ranges::find(options_.parts, part) != options_.parts.end();
    };
    const std::string train = has("train") ? "train" : options_.parts.front();
    std::string text = "# Change `path` when the folder is moved.\npath: " +
                       quoted(absolute_path(root_).string()) + "\n";
    text += "train: images/" + train + "\n";
    text += "val: images/" + (has("val") ? std::string("val") : train) + "\n";
    if (has("test")) text += "test: images/test\n";
    text += "names:\n";
    for (std::size_t i = 0; i < options_.categories.size(); ++i)
      text += fmt::format("  {}: {}\n", i, quoted(options_.categories[i]));
    write_file(root_ / "data.yaml", text);
  }

 private:
  fs::path image(const Clip& clip, const std::string& part, std::size_t i) const override {
    return fs::path("images") / part / (numbered_stem(clip, i) + options_.image_extension);
  }

  // YAML's double-quoted strings include JSON's strings.
  static std::string quoted(const std::string& text) {
    return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  }
};

// A hundred times that of a set of 365 classes; yaml-cpp takes some seconds for the worst text of
// it.
constexpr std::size_t kMaxYamlBytes = std::size_t{1} << 20;

constexpr const char* kClassList = "classes.txt";

// What a folder states of its labels.
struct Stated {
  std::map<std::size_t, std::string> names;
  // Of the key points behind a box; 0: there are none.
  std::size_t numbers_of_points = 0;
};

// The names of the classes: in data.yaml a list, or a map from the number to the name; in
// darknet's obj.names or LabelImg's classes.txt one on each line. kpt_shape in data.yaml is the
// number of key points and that of the numbers of each.
Stated stated_in(const fs::path& root) {
  Stated stated;
  auto& names = stated.names;
  for (const char* list : {"obj.names", kClassList})
    if (is_there(root / list) && names.empty())
      for (const Line& line : lines_of(root / list)) names[names.size()] = line.text;
  const fs::path file = root / "data.yaml";
  if (!is_there(file)) return stated;
  names.clear();
  try {
    YAML::Node top = YAML::Load(read_file(file, kMaxYamlBytes));
    const YAML::Node listed = top["names"];
    if (listed.IsSequence())
      for (const auto& name : listed) names[names.size()] = name.as<std::string>();
    else if (listed.IsMap())
      for (const auto& entry : listed)
        names[entry.first.as<std::size_t>()] = entry.second.as<std::string>();
    if (const YAML::Node shape = top["kpt_shape"]; shape.IsSequence() && shape.size() == 2)
      stated.numbers_of_points = shape[0].as<std::size_t>() * shape[1].as<std::size_t>();
  } catch (const YAML::Exception& error) {
    throw Error("cannot be read as YAML: " + error.msg, {file.string(), error.mark.line + 1});
  }
  return stated;
}

// How many key points "x y visibility" stand behind the box of a line that is no polygon for sure:
// each third number is 0, 1 or 2, and one is 2, which no share of a picture is. 0: it may be one.
std::size_t seen_points_in(const std::vector<double>& numbers) {
  if (numbers.size() < 8 || (numbers.size() - 5) % 3 != 0) return 0;
  bool has_seen = false;
  for (std::size_t i = 7; i < numbers.size(); i += 3) {
    if (numbers[i] != 0 && numbers[i] != 1 && numbers[i] != 2) return 0;
    has_seen = has_seen || numbers[i] == 2;
  }
  return has_seen ? (numbers.size() - 5) / 3 : 0;
}

struct Folders {
  fs::path labels;
  fs::path pictures;
};

// The layouts that people have: labels/[PART/] beside images/[PART/] (Ultralytics); PART/labels/
// beside PART/images/ (Roboflow); obj_train_data/ and the like, which hold both (CVAT's "YOLO 1.1"
// and darknet).
std::vector<Folders> folders_of(const fs::path& root) {
  std::vector<Folders> all;
  if (fs::is_directory(root / "labels")) {
    all.push_back({root / "labels", root / "images"});
    for (const fs::path& part : entries(root / "labels"))
      if (fs::is_directory(part)) all.push_back({part, root / "images" / part.filename()});
    return all;
  }
  for (const fs::path& part : entries(root)) {
    if (fs::is_directory(part / "labels")) all.push_back({part / "labels", part / "images"});
    const std::string name = part.filename().string();
    if (name.starts_with("obj_") && name.ends_with("_data") && fs::is_directory(part))
      all.push_back({part, part});
  }
  return all;
}

class YoloReader {
 public:
  explicit YoloReader(const Reading& in) : in_(in) {}

  Clips read() {
    const std::vector<Folders> folders = folders_of(in_.source);
    if (folders.empty())
      throw Error("holds no labels/, no PART/labels/ and no obj_train_data/",
                  {in_.source.string()});
    Clips clips;
    const Stated of_root = stated_in(in_.source);
    for (const Folders& one : folders) {
      stated_ = of_root;
      // LabelImg writes the names beside the labels.
      for (const fs::path& folder : {one.labels, one.labels.parent_path()})
        if (stated_.names.empty()) stated_.names = stated_in(folder).names;
      append(clips, clips_of_pictures(pictures(one), "", one.labels, in_.warn));
    }
    if (clips.empty()) throw Error("holds no labels", {folders.front().labels.string()});
    return clips;
  }

 private:
  // The pictures of a folder, and the labels of each. A picture without a file is background.
  std::vector<LabelledPicture> pictures(const Folders& folders) {
    std::map<std::string, LabelledPicture> by_stem;
    for (const std::string& name : pictures_in(folders.pictures)) {
      LabelledPicture& picture = by_stem[fs::path(name).stem().string()];
      if (!picture.name.empty())
        throw Error("holds " + picture.name + " and " + name +
                        ", which one file of labels would describe; expected one of them",
                    {folders.pictures.string()});
      picture.name = name;
      picture.folder = folders.pictures;
    }
    for (const fs::path& file : files_with(folders.labels, ".txt")) {
      if (file.filename() == kClassList && !by_stem.contains(file.stem().string())) continue;
      LabelledPicture& picture = by_stem[file.stem().string()];
      // The name of a picture that is not there has no ending.
      if (picture.name.empty()) picture.name = file.stem().string();
    }
    std::vector<LabelledPicture> pictures;
    for (auto& [stem, picture] : by_stem) {
      measure(picture, folders.pictures);
      const fs::path file = folders.labels / (stem + ".txt");
      if (is_there(file))
        for (const Line& line : lines_of(file)) add(line, file, picture);
      pictures.push_back(std::move(picture));
    }
    return pictures;
  }

  void measure(LabelledPicture& picture, const fs::path& folder) const {
    if (in_.options.size)
      std::tie(picture.width, picture.height) = *in_.options.size;
    else if (!picture.folder.empty() && in_.options.size_of_picture)
      std::tie(picture.width, picture.height) =
          in_.options.size_of_picture(picture.folder / picture.name);
    else
      throw Error("holds no picture " + picture.name +
                      ", of whose size YOLO's boxes are shares; expected it, or --size WxH",
                  {folder.string()});
  }

  void add(const Line& line, const fs::path& file, LabelledPicture& picture) {
    const Where where{file.string(), line.number};
    const std::vector<double> n = numbers_of(line, file);
    const auto whole = n.size() < 5 ? std::nullopt : whole_in(n[0], 0, 1'000'000);
    // Key points stand behind the box. With more numbers after it the line is a polygon, as in
    // segmentation: "class x y x y x y".
    const std::size_t points = stated_.numbers_of_points;
    if (const std::size_t seen = points > 0 ? 0 : seen_points_in(n); seen > 0)
      throw Error(fmt::format("has {0} key points 'x y visibility' behind a box; expected "
                              "kpt_shape: [{0}, 3] in data.yaml",
                              seen),
                  where);
    const bool is_polygon = (n.size() < 5 + points ? n.size() : n.size() - points) > 6;
    if (is_polygon && points > 0)
      throw Error(
          fmt::format("has {} numbers; expected 'class x y width height' and the {} numbers "
                      "of the key points, by kpt_shape in data.yaml",
                      n.size(),
                      points),
          where);
    if (!whole || (is_polygon && n.size() % 2 == 0))
      throw Error("is no 'class x y width height' and no 'class' with a polygon", where);
    const auto category = static_cast<std::size_t>(*whole);
    Label label;
    label.track = std::ssize(picture.labels) + 1;
    const auto named = stated_.names.find(category);
    label.category = named != stated_.names.end() ? named->second : std::to_string(category);
    if (is_polygon) {
      BoxBounds bounds;
      for (std::size_t i = 1; i < n.size(); i += 2)
        bounds.add({n[i] * picture.width, n[i + 1] * picture.height});
      label.box_px = *bounds.box();
    } else {
      label.box_px = {(n[1] - n[3] / 2) * picture.width,
                      (n[2] - n[4] / 2) * picture.height,
                      n[3] * picture.width,
                      n[4] * picture.height};
    }
    add_label(picture.labels, std::move(label), picture, in_.left_out, to_string(where));
  }

  const Reading& in_;
  Stated stated_;  // of the folder that is read
};

}  // namespace

std::unique_ptr<Writer> yolo_writer(const Writing& to) { return std::make_unique<YoloWriter>(to); }

Clips read_yolo(const Reading& in) { return YoloReader(in).read(); }

}  // namespace airtruth::exchange
