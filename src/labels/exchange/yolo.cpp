// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/geometry/box.h"
#include "labels/exchange/parts.h"
#include "labels/exchange/text.h"

// YOLO as Ultralytics reads it (docs.ultralytics.com, "Detection dataset format"):
// images/PART/*.jpg and labels/PART/*.txt of the same name, one line "class x y width height" for
// each object, class from 0, the box's centre and size as shares of the picture. A picture without
// an object has an empty file. Its loader (ultralytics/data/utils.py) refuses a picture with a
// coordinate outside of 0..1: boxes are clipped at the picture's edge. `path` in data.yaml is
// absolute, since a relative one counts from the user's own folder of data sets.
namespace airtruth::exchange {
namespace {

class YoloWriter : public IndexedWriter {
 public:
  YoloWriter(fs::path root, const WriteOptions& options)
      : root_(std::move(root)), options_(options) {
    for (const std::string& part : options.parts) {
      fs::create_directories(root_ / "labels" / part);
      // The loader looks for this folder.
      fs::create_directories(root_ / "images" / part);
    }
  }

  void add(const Clip& clip, const std::string& part) override {
    if (clip.width <= 0 || clip.height <= 0)
      throw Error(clip.name + " has no known size, of which YOLO's boxes are shares");
    for (std::size_t i = 0; i < clip.frames.size(); ++i) {
      std::string text;
      for (const Label& label : clip.frames[i].labels) text += line_of(label, clip);
      write_file(root_ / "labels" / part / (stem(clip, i) + ".txt"), text, Flush::kLater);
    }
  }

  void finish() override {
    const auto has = [&](const char* part) {
      return std::find(options_.parts.begin(), options_.parts.end(), part) != options_.parts.end();
    };
    const std::string train = has("train") ? "train" : options_.parts.front();
    std::string text = "# Change `path` when the folder is moved.\npath: " +
                       quoted(fs::absolute(root_).lexically_normal().string()) + "\n";
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
    return fs::path("images") / part / (stem(clip, i) + options_.image_extension);
  }

  // YAML's double-quoted strings include JSON's strings.
  static std::string quoted(const std::string& text) {
    return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  }
  static std::string stem(const Clip& clip, std::size_t i) {
    return clip.name + "_" + padded(static_cast<std::int64_t>(i), 6);
  }

  std::string line_of(const Label& label, const Clip& clip) const {
    const auto& all = options_.categories;
    const auto category = std::find(all.begin(), all.end(), label.category) - all.begin();
    const auto b = clipped(label.box_px, clip.width, clip.height);
    if (!b) return {};
    return fmt::format("{} {} {} {} {}\n",
                       category,
                       (b->x + b->width / 2) / clip.width,
                       (b->y + b->height / 2) / clip.height,
                       b->width / clip.width,
                       b->height / clip.height);
  }

  fs::path root_;
  WriteOptions options_;
};

// A YAML scalar without blanks around it and without its quotes.
std::string bare(const std::string& text) {
  const std::size_t first = text.find_first_not_of(' ');
  if (first == std::string::npos) return {};
  std::string word = text.substr(first, text.find_last_not_of(' ') - first + 1);
  const char quote = word.front();
  if (word.size() < 2 || (quote != '"' && quote != '\'') || word.back() != quote) return word;
  // YAML's double quotes accept JSON's strings and a few more.
  if (quote == '"') {
    const auto string = nlohmann::json::parse(word, nullptr, false);
    if (string.is_string()) return string.get<std::string>();
  }
  return word.substr(1, word.size() - 2);
}

// The names of a list in brackets on one line; empty if the line has no such list.
std::optional<std::vector<std::string>> names_in_brackets(const std::string& line) {
  const std::size_t open = line.find('[');
  const std::size_t close = line.rfind(']');
  if (open == std::string::npos || close == std::string::npos || close < open) return std::nullopt;
  std::vector<std::string> names;
  const std::string list = line.substr(open + 1, close - open - 1) + ",";
  for (std::size_t at = 0, comma; (comma = list.find(',', at)) != std::string::npos; at = comma + 1)
    if (const std::string word = bare(list.substr(at, comma - at)); !word.empty())
      names.push_back(word);
  return names;
}

// The name on a line "- name" or "0: name"; empty if the line is neither.
std::optional<std::string> listed_name(const std::string& line) {
  if (line.starts_with("- ")) return bare(line.substr(2));
  const std::size_t colon = line.find(':');
  const bool is_numbered =
      colon != std::string::npos && colon > 0 && line.find_first_not_of("0123456789") == colon;
  if (!is_numbered) return std::nullopt;
  return bare(line.substr(colon + 1));
}

// Reads the names of data.yaml: "  0: name", "- name" or "names: [a, b]".
std::vector<std::string> names_of(const fs::path& file) {
  std::vector<std::string> names;
  if (!fs::exists(file)) return names;
  bool is_inside = false;
  for (const Line& line : lines_of(file)) {
    if (line.text.starts_with("names:")) {
      const auto list = names_in_brackets(line.text);
      is_inside = !list;
      if (list) names.insert(names.end(), list->begin(), list->end());
    } else if (is_inside) {
      const auto name = listed_name(line.text);
      if (!name) break;
      names.push_back(*name);
    }
  }
  return names;
}

class YoloReader {
 public:
  YoloReader(fs::path root, const ReadOptions& options, const Warn& warn)
      : root_(std::move(root)),
        options_(options),
        names_(names_of(root_ / "data.yaml")),
        left_out_(warn) {}

  Clips read() {
    const fs::path labels = root_ / "labels";
    if (!fs::is_directory(labels)) throw Error("holds no labels/", {root_.string()});
    folder(labels, "");
    for (const fs::path& part : entries(labels))
      if (fs::is_directory(part)) folder(part, part.filename());
    Clips clips;
    for (auto& [key, clip] : clips_) {
      sort_frames(clip);
      clips.push_back(std::move(clip));
    }
    return clips;
  }

 private:
  void folder(const fs::path& where, const fs::path& part) {
    const std::vector<fs::path> files = files_with(where, ".txt");
    if (files.empty()) return;
    const fs::path pictures = root_ / "images" / part;
    auto size = options_.size;
    if (!size) size = size_of_pictures(pictures, options_);
    if (!size)
      throw Error("holds no pictures, of whose size YOLO's boxes are shares; expected --size WxH",
                  {pictures.string()});
    for (const fs::path& file : files) {
      const auto [name, number] = name_and_number(file.stem().string());
      Clip& clip = clips_[part.string() + "/" + name];
      clip.name = name.empty() ? "images" : name;
      clip.width = size->first;
      clip.height = size->second;
      if (clip.frames.empty()) clip.media = media_of(pictures, name);
      LabelledFrame frame;
      frame.frame = number.value_or(static_cast<std::int64_t>(clip.frames.size()));
      for (const Line& line : lines_of(file)) add(line, file, *size, frame);
      clip.frames.push_back(std::move(frame));
    }
  }

  static fs::path media_of(const fs::path& pictures, const std::string& name) {
    for (const char* extension : {".jpg", ".png"})
      if (fs::exists(pictures / (name + "_000000" + extension)))
        return pictures / (name + "_%06d" + extension);
    return fs::is_directory(pictures) ? pictures : fs::path();
  }

  void add(const Line& line,
           const fs::path& file,
           const std::pair<int, int>& size,
           LabelledFrame& frame) {
    const std::vector<double> n = numbers_of(line, file);
    const auto whole = n.size() < 5 ? std::nullopt : whole_in(n[0], 0, 1'000'000);
    // With more numbers after the box the line is a polygon, as in segmentation: "class x y x y x
    // y".
    const bool is_polygon = n.size() > 6;
    if (!whole || (is_polygon && n.size() % 2 == 0))
      throw Error("is no 'class x y width height' and no 'class' with a polygon",
                  {file.string(), line.number});
    const auto category = static_cast<std::size_t>(*whole);
    Label label;
    label.track = static_cast<std::int64_t>(frame.labels.size()) + 1;
    label.category = category < names_.size() ? names_[category] : std::to_string(category);
    if (is_polygon) {
      BoxBounds bounds;
      for (std::size_t i = 1; i < n.size(); i += 2)
        bounds.add({n[i] * size.first, n[i + 1] * size.second});
      label.box_px = *bounds.box();
    } else {
      label.box_px = {(n[1] - n[3] / 2) * size.first,
                      (n[2] - n[4] / 2) * size.second,
                      n[3] * size.first,
                      n[4] * size.second};
    }
    if (!is_in_picture(label.box_px, size.first, size.second))
      return left_out_.add("boxes that are empty or outside their image",
                           file.string() + ":" + std::to_string(line.number));
    frame.labels.push_back(label);
  }

  fs::path root_;
  const ReadOptions& options_;
  std::vector<std::string> names_;
  LeftOut left_out_;
  std::map<std::string, Clip> clips_;
};

}  // namespace

std::unique_ptr<Writer> yolo_writer(const fs::path& root, const WriteOptions& options) {
  return std::make_unique<YoloWriter>(root, options);
}

Clips read_yolo(const fs::path& source, const ReadOptions& options, const Warn& warn) {
  return YoloReader(source, options, warn).read();
}

}  // namespace airtruth::exchange
