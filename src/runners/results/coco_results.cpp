// SPDX-License-Identifier: Apache-2.0
#include "runners/results/coco_results.h"

#include <algorithm>
#include <charconv>
#include <map>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "foundation/base/files.h"
#include "foundation/base/names.h"
#include "foundation/json/json_object.h"
#include "runners/results/json_list.h"

namespace airtruth::results {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxBytes = std::size_t{4} << 30;  // of a file: some 40 million detections
constexpr const char* kExpected =
    "expected COCO results, [{\"image_id\": ..., \"category_id\": ..., \"bbox\": [x, y, width, "
    "height], \"score\": ...}, ...], or a COCO file whose annotations each have a score";

// What a whole COCO file says about the numbers in its annotations.
struct Names {
  std::map<std::int64_t, std::string> image_files;
  std::map<std::int64_t, std::string> categories;
};

struct SetImage {
  std::size_t sequence = 0;  // index in the set
  std::int64_t frame = 0;
};

// The images of a set by their number and by their name (ExpectedSequence states both).
class SetImages {
 public:
  // `set` must outlive the object.
  explicit SetImages(std::span<const ExpectedSequence> set);
  // Both throw Error at `where` for an image that the set does not have.
  SetImage by_id(std::int64_t id, const Where& where) const;
  // "images/all/NAME/000012.jpg" and "NAME/000012" alike.
  SetImage by_name(const std::string& text, const Where& where) const;

 private:
  std::span<const ExpectedSequence> set_;
  std::vector<std::int64_t> first_ids_;
  std::int64_t end_ = 1;
  std::map<std::string, std::size_t> names_;
};

SetImages::SetImages(std::span<const ExpectedSequence> set) : set_(set) {
  std::int64_t first = 1;
  for (std::size_t i = 0; i < set.size(); ++i) {
    first_ids_.push_back(first);
    first += set[i].frames;
    names_.emplace(set[i].name, i);
  }
  end_ = first;
}

SetImage SetImages::by_id(std::int64_t id, const Where& where) const {
  if (id < 1 || id >= end_)
    throw Error(fmt::format("image_id is {}; the set has the images 1 to {}", id, end_ - 1), where);
  const auto after = std::upper_bound(first_ids_.begin(), first_ids_.end(), id);
  const auto i = static_cast<std::size_t>(after - first_ids_.begin()) - 1;
  return {i, id - first_ids_[i]};
}

SetImage SetImages::by_name(const std::string& text, const Where& where) const {
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

JsonDocument parsed(const JsonPart& part, const fs::path& file) {
  for (const char* word : {"NaN", "Infinity"})
    if (part.text.find(word) != std::string_view::npos &&
        !Json::accept(part.text.begin(), part.text.end()))
      throw Error(std::string("holds ") + word + "; expected finite numbers",
                  {file.string(), part.line});
  return JsonDocument(part.text, {file.string(), part.line});
}

// The texts of a key by the ids of the objects in a list.
std::map<std::int64_t, std::string> texts_by_id(const std::optional<JsonPart>& list,
                                                const fs::path& file,
                                                const std::string& what,
                                                const std::string& key) {
  std::map<std::int64_t, std::string> texts;
  if (!list) return texts;
  JsonElements elements(*list, file, what);
  while (const auto element = elements.next()) {
    const JsonDocument object = parsed(*element, file);
    const std::int64_t id = object.whole("id");
    if (!texts.emplace(id, object.text(key)).second)
      throw Error(fmt::format("the id {} is there twice among the {}", id, what),
                  {file.string(), element->line});
  }
  return texts;
}

SetImage image_of(const JsonObject& object,
                  const std::optional<Names>& names,
                  const SetImages& images,
                  const Where& where) {
  if (object.has("image_id")) {
    if (object.value("image_id").is_string()) return images.by_name(object.text("image_id"), where);
    const std::int64_t id = object.whole("image_id");
    if (!names || names->image_files.empty()) return images.by_id(id, where);
    const auto named = names->image_files.find(id);
    if (named == names->image_files.end())
      throw Error(fmt::format("image_id is {}, which the file's images do not have", id), where);
    return images.by_name(named->second, where);
  }
  for (const char* key : {"image_name", "file_name"})
    if (const auto name = object.maybe_text(key)) return images.by_name(*name, where);
  throw Error(std::string("has no image_id; ") + kExpected, where);
}

// Category 1 is "aircraft" where nothing names it.
std::string category_of(const JsonObject& object,
                        const std::optional<Names>& names,
                        const Where& where) {
  if (const auto category = object.maybe_text("category_name")) return *category;
  if (!object.has("category_id")) return Detection{}.category;
  const std::int64_t id = object.whole("category_id");
  if (names && !names->categories.empty()) {
    const auto named = names->categories.find(id);
    if (named == names->categories.end())
      throw Error(fmt::format("category_id is {}, which the file's categories do not have", id),
                  where);
    return named->second;
  }
  return id == 1 ? Detection{}.category : fmt::format("{}", id);
}

Detection detection_of(const JsonObject& object,
                       const std::optional<Names>& names,
                       const Where& where) {
  Detection detection;
  const std::vector<double> box = object.numbers("bbox", 4);
  detection.box_px = {box[0], box[1], box[2], box[3]};
  if (names && !object.has("score"))
    throw Error(std::string("is an annotation without a score; ") + kExpected, where);
  detection.score = object.number("score");
  detection.category = category_of(object, names, where);
  if (const auto track = object.maybe_integer("track_id"); track && *track >= 0)
    detection.track = *track;
  return detection;
}

// The list of detections in a file, and what a whole COCO file says beside it.
struct Found {
  JsonPart list;
  std::optional<Names> names;
};

Found found_in(std::string_view text, const fs::path& file) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first != std::string_view::npos && text[first] == '[') return {{text, 1}, {}};
  if (first == std::string_view::npos || text[first] != '{')
    throw Error(std::string("is no list of detections; ") + kExpected, {file.string()});
  const auto members = json_members(text, file, {"annotations", "images", "categories"});
  if (!members[0]) throw Error(std::string("has no annotations; ") + kExpected, {file.string()});
  return {*members[0],
          Names{texts_by_id(members[1], file, "images", "file_name"),
                texts_by_id(members[2], file, "categories", "name")}};
}

}  // namespace

std::vector<SequenceDetections> read_coco_results(const fs::path& file,
                                                  std::span<const ExpectedSequence> set) {
  const std::string text = read_file(file, kMaxBytes);
  const SetImages images(set);
  std::vector<FrameList> lists;
  for (const ExpectedSequence& sequence : set)
    lists.emplace_back(sequence.name, sequence.width, sequence.height, sequence.frames);
  const Found found = found_in(text, file);
  JsonElements elements(found.list, file, found.names ? "annotations" : "detections");
  while (const auto element = elements.next()) {
    const Where where{file.string(), element->line};
    const JsonDocument object = parsed(*element, file);
    const SetImage image = image_of(object, found.names, images, where);
    lists[image.sequence].add(image.frame, detection_of(object, found.names, where), where);
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

}  // namespace airtruth::results
