// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <charconv>
#include <map>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "detection/detections/results_files.h"
#include "foundation/base/files.h"
#include "foundation/base/line_of.h"
#include "foundation/base/suggest.h"
#include "foundation/json/json_object.h"
#include "truth/exchange/text.h"

// COCO's results format (cocodataset.org, "Results format"): a list of {image_id, category_id,
// bbox, score}; bbox is [x, y, width, height] with the first pixel at 0.
namespace airtruth::detection {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxBytes = std::size_t{4} << 30;

// One element of a JSON list, with the line at which it begins.
struct Element {
  std::string_view text;
  int line = 0;
};

// The elements of a list, found by its brackets alone: each is parsed by itself, so that a large
// file is never a tree of values as a whole, and a fault has its line.
class Elements {
 public:
  Elements(std::string_view text, const fs::path& file) : text_(text), file_(file) {
    skip_blanks();
    if (at_ == text_.size() || text_[at_] != '[') fail("is no list of detections");
    ++at_;
  }

  std::optional<Element> next() {
    skip_blanks();
    if (at_ < text_.size() && text_[at_] == ',' && !is_first_) {
      ++at_;
      skip_blanks();
    } else if (at_ < text_.size() && text_[at_] == ']') {
      ++at_;
      skip_blanks();
      if (at_ != text_.size()) fail("goes on after the list of detections");
      return std::nullopt;
    } else if (!is_first_) {
      fail("the list of detections does not end; expected ',' or ']'");
    }
    is_first_ = false;
    const std::size_t begin = at_;
    const Element element{{}, line_};
    skip_value();
    return Element{text_.substr(begin, at_ - begin), element.line};
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(what, {file_.string(), line_});
  }

  void skip_blanks() {
    while (at_ < text_.size() && std::string_view(" \t\r\n").find(text_[at_]) != text_.npos)
      line_ += text_[at_++] == '\n' ? 1 : 0;
  }

  // To the comma or bracket after the value.
  void skip_value() {
    int depth = 0;
    bool in_text = false;
    for (; at_ < text_.size(); ++at_) {
      const char c = text_[at_];
      line_ += c == '\n' ? 1 : 0;
      if (in_text) {
        if (c == '\\')
          ++at_;
        else
          in_text = c != '"';
      } else if (c == '"') {
        in_text = true;
      } else if (c == '[' || c == '{') {
        ++depth;
      } else if ((c == ']' || c == '}') && depth > 0) {
        --depth;
      } else if (depth == 0 && (c == ',' || c == ']')) {
        return;
      }
    }
    fail("ends within a detection: the file is not whole");
  }

  std::string_view text_;
  const fs::path& file_;
  std::size_t at_ = 0;
  int line_ = 1;
  bool is_first_ = true;
};

struct Image {
  std::size_t sequence = 0;
  std::int64_t frame = 0;
};

// Images of a set by their number and by their name.
class Images {
 public:
  explicit Images(std::span<const ExpectedSequence> set) : set_(set) {
    std::int64_t first = 1;
    for (std::size_t i = 0; i < set.size(); ++i) {
      first_ids_.push_back(first);
      first += set[i].frames;
      names_.emplace(set[i].name, i);
    }
    end_ = first;
  }

  Image by_id(std::int64_t id, const Where& where) const {
    if (id < 1 || id >= end_)
      throw Error(fmt::format("image_id is {}; the set has the images 1 to {}", id, end_ - 1),
                  where);
    const auto after = std::upper_bound(first_ids_.begin(), first_ids_.end(), id);
    const auto i = static_cast<std::size_t>(after - first_ids_.begin()) - 1;
    return {i, id - first_ids_[i]};
  }

  // "images/all/NAME/000012.jpg" and "NAME/000012" alike.
  Image by_name(const std::string& text, const Where& where) const {
    fs::path path(text);
    const std::string stem = path.stem().string();
    std::int64_t frame = -1;
    const auto [end, failed] = std::from_chars(stem.data(), stem.data() + stem.size(), frame);
    const std::string name = path.parent_path().filename().string();
    const auto found = names_.find(name);
    const bool is_number = failed == std::errc() && end == stem.data() + stem.size() && frame >= 0;
    if (found != names_.end() && is_number && frame < set_[found->second].frames)
      return {found->second, frame};
    std::string hint;
    if (found != names_.end()) {
      hint = fmt::format("; '{}' has the frames 0 to {}", name, set_[found->second].frames - 1);
    } else {
      std::vector<std::string> names;
      for (const ExpectedSequence& sequence : set_) names.push_back(sequence.name);
      if (const auto near = nearest_spelling(name, names))
        hint = "; did you mean the sequence '" + *near + "'?";
    }
    throw Error("the set has no image '" + text.substr(0, 200) +
                    "'; expected SEQUENCE/NUMBER.jpg, with frames from 0" + hint,
                where);
  }

 private:
  std::span<const ExpectedSequence> set_;
  std::vector<std::int64_t> first_ids_;
  std::int64_t end_ = 1;
  std::map<std::string, std::size_t> names_;
};

JsonDocument parsed(const Element& element, const fs::path& file) {
  for (const char* word : {"NaN", "Infinity"})
    if (element.text.find(word) != std::string_view::npos &&
        !Json::accept(element.text.begin(), element.text.end()))
      throw Error(std::string("holds ") + word + "; expected finite numbers",
                  {file.string(), element.line});
  return JsonDocument(element.text, {file.string(), element.line});
}

Image image_of(const JsonObject& object, const Images& images, const Where& where) {
  if (object.has("image_id")) {
    if (object.value("image_id").is_string()) return images.by_name(object.text("image_id"), where);
    return images.by_id(object.whole("image_id"), where);
  }
  for (const char* key : {"image_name", "file_name"})
    if (const auto name = object.maybe_text(key)) return images.by_name(*name, where);
  throw Error("has no image_id", where);
}

Detection detection_of(const JsonObject& object) {
  Detection detection;
  const std::vector<double> box = object.numbers("bbox", 4);
  detection.box_px = {box[0], box[1], box[2], box[3]};
  detection.score = object.number("score");
  if (const auto category = object.maybe_text("category_name"))
    detection.category = *category;
  else if (object.has("category_id"))
    if (const std::int64_t id = object.whole("category_id"); id != 1)
      detection.category = fmt::format("{}", id);
  if (const auto track = object.maybe_integer("track_id"); track && *track >= 0)
    detection.track = *track;
  return detection;
}

}  // namespace

std::vector<SequenceDetections> read_coco_results(const fs::path& file,
                                                  std::span<const ExpectedSequence> set) {
  const std::string text = read_file(file, kMaxBytes);
  const Images images(set);
  std::vector<FrameList> lists;
  for (const ExpectedSequence& sequence : set)
    lists.emplace_back(sequence.name, sequence.width, sequence.height, sequence.frames);
  Elements elements(text, file);
  while (const auto element = elements.next()) {
    const Where where{file.string(), element->line};
    const JsonDocument object = parsed(*element, file);
    const Image image = image_of(object, images, where);
    lists[image.sequence].add(image.frame, detection_of(object), where);
  }
  std::vector<SequenceDetections> all;
  for (FrameList& list : lists) all.push_back(list.take());
  return all;
}

void write_coco_results(const fs::path& file,
                        const fs::path& folder,
                        std::span<const ExpectedSequence> set) {
  std::set<std::string> categories;
  for (const ExpectedSequence& sequence : set)
    if (has_sequence(folder, sequence.name))
      for (const auto& frame : read_sequence(folder, sequence.name).frames)
        for (const Detection& d : frame) categories.insert(d.category);
  std::string text = "[";
  std::int64_t first = 1;
  for (const ExpectedSequence& sequence : set) {
    if (has_sequence(folder, sequence.name)) {
      const SequenceDetections read = read_sequence(folder, sequence.name);
      for (std::size_t i = 0; i < read.frames.size(); ++i)
        for (const Detection& d : read.frames[i]) {
          Json json = {
              {"image_id", first + static_cast<std::int64_t>(i)},
              {"category_id", 1 + std::distance(categories.begin(), categories.find(d.category))},
              {"bbox", {d.box_px.x, d.box_px.y, d.box_px.width, d.box_px.height}},
              {"score", d.score}};
          if (d.track) json["track_id"] = *d.track;
          if (categories.size() > 1 || d.category != "aircraft") json["category_name"] = d.category;
          text += (text.size() > 1 ? ",\n" : "") + json.dump();
        }
    }
    first += sequence.frames;
  }
  write_file(file, text + "]\n");
}

}  // namespace airtruth::detection
