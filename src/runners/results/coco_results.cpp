// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "foundation/base/files.h"
#include "foundation/base/names.h"
#include "foundation/base/text.h"
#include "foundation/json/json_object.h"
#include "labels/annotation/object_class.h"
#include "labels/label_file/coco_numbers.h"
#include "runners/results/results_folder.h"

namespace airtruth::results {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxBytes = std::size_t{4} << 30;  // of a file: some 40 million detections
constexpr const char* kExpected =
    "expected COCO results, [{\"image_id\": ..., \"category_id\": ..., \"bbox\": [x, y, width, "
    "height], \"score\": ...}, ...], or a COCO file whose annotations each have a score";

// JSON texts are too large to be a tree of values as a whole: the parts of lists and objects are
// found by their brackets alone. Each part is parsed by itself, and a fault has its line.

// One value, with the line at which it begins.
struct JsonPart {
  std::string_view text;
  int line = 1;
};

// A place in the text of a file, with its line. The file's name and the text must outlive it.
struct Cursor {
  std::string_view text;
  const fs::path& file;
  int line = 1;
  std::size_t at = 0;

  [[noreturn]] void fail(const std::string& fault) const {
    throw Error(fault, {file.string(), line});
  }
  bool is_at_end() const { return at >= text.size(); }
  char here() const { return is_at_end() ? '\0' : text[at]; }
  void step() { line += text[at++] == '\n' ? 1 : 0; }
  void skip_blanks() {
    while (!is_at_end() && std::string_view(" \t\r\n").find(here()) != std::string_view::npos)
      step();
  }
  // Passes a bracket or a colon, with the blanks around it.
  void take(char wanted, const std::string& fault) {
    skip_blanks();
    if (here() != wanted) fail(fault);
    step();
    skip_blanks();
  }
  // Passes the bracket here, behind which nothing but blanks may be.
  void take_last(const std::string& fault) {
    step();
    skip_blanks();
    if (!is_at_end()) fail(fault);
  }
  // From the quote on to after the one that closes; false where none does.
  bool skip_string() {
    step();
    while (!is_at_end() && here() != '"') {
      if (here() == '\\') step();
      if (!is_at_end()) step();
    }
    if (is_at_end()) return false;
    step();
    return true;
  }
  // To the comma or bracket after the value; false where there is none.
  bool skip_value() {
    int depth = 0;
    while (!is_at_end()) {
      const char c = here();
      if (c == '"') {
        if (!skip_string()) return false;
        continue;
      }
      const bool closes = c == ']' || c == '}';
      if (depth == 0 && (c == ',' || closes)) return true;
      if (c == '[' || c == '{') ++depth;
      if (closes) --depth;
      step();
    }
    return false;
  }
  // The value from here on; empty where it does not end.
  std::optional<JsonPart> value() {
    const std::size_t begin = at;
    const int first = line;
    if (!skip_value()) return std::nullopt;
    return JsonPart{text.substr(begin, at - begin), first};
  }
};

[[noreturn]] void not_whole(const fs::path& file, int line) {
  throw Error("the object does not end: the file is not whole", {file.string(), line});
}

// The elements of a list.
class JsonElements {
 public:
  // `what` is what it holds, for messages: "detections".
  JsonElements(const JsonPart& whole, const fs::path& file, std::string what)
      : cursor_{whole.text, file, whole.line}, what_(std::move(what)) {
    cursor_.take('[', "is no list of " + what_);
  }
  // Empty after the last one. Throws Error for a list that does not end, or goes on after its end.
  std::optional<JsonPart> next() {
    cursor_.skip_blanks();
    if (cursor_.here() == ',' && !is_first_) {
      cursor_.step();
      cursor_.skip_blanks();
    } else if (cursor_.here() == ']') {
      cursor_.take_last("goes on after the list of " + what_);
      return std::nullopt;
    } else if (!is_first_) {
      cursor_.fail("the list of " + what_ + " does not end; expected ',' or ']'");
    }
    is_first_ = false;
    const auto part = cursor_.value();
    if (!part) cursor_.fail("ends within the list of " + what_ + ": the file is not whole");
    return part;
  }

 private:
  Cursor cursor_;
  std::string what_;
  bool is_first_ = true;
};

// The members of an object with these keys, in the order of `keys`; empty where the object has no
// such key. Throws Error for a text that is no object, and for a key that is there twice.
std::vector<std::optional<JsonPart>> json_members(std::string_view text,
                                                  const fs::path& file,
                                                  const std::vector<std::string>& keys) {
  std::vector<std::optional<JsonPart>> members(keys.size());
  Cursor cursor{text, file};
  cursor.take('{', "is no JSON object");
  for (bool is_first = true;; is_first = false) {
    cursor.skip_blanks();
    if (cursor.here() == '}') break;
    if (cursor.here() == ',' && !is_first) {
      cursor.step();
      cursor.skip_blanks();
    }
    if (cursor.here() != '"') cursor.fail("has no key here; expected a key, ',' or '}'");
    const std::size_t begin = cursor.at + 1;
    const int line = cursor.line;
    if (!cursor.skip_string()) not_whole(file, line);
    const std::string_view key = text.substr(begin, cursor.at - 1 - begin);
    cursor.take(':', "has no value of a key; expected ':'");
    const auto value = cursor.value();
    if (!value) not_whole(file, line);
    const auto found = std::find(keys.begin(), keys.end(), key);
    if (found == keys.end()) continue;
    auto& member = members[static_cast<std::size_t>(found - keys.begin())];
    if (member) throw Error("has '" + *found + "' twice", {file.string(), line});
    member = value;
  }
  cursor.take_last("goes on after the object");
  return members;
}

using NamesById = std::map<std::int64_t, std::string>;

// The list of detections in a file, and what a whole COCO file says about the numbers in it.
struct Found {
  JsonPart list;
  bool is_whole = false;
  NamesById image_files = {};
  NamesById categories = {};

  const char* what() const { return is_whole ? "annotations" : "detections"; }
};

struct SetImage {
  std::size_t sequence = 0;  // index in the set
  std::int64_t frame = 0;
  bool operator==(const SetImage&) const = default;
};

// What the numbers of a file are: those that the set's source states, those that are counted over
// the set, or those that pictures are named. And what its texts are: the set's own names, or
// SEQUENCE/NUMBER with frames from 0.
enum class Ids { kStated, kCounted, kInNames };
enum class Texts { kNames, kPlaces };

const char* words(Ids ids) {
  return ids == Ids::kStated    ? "the ids that the set states"
         : ids == Ids::kCounted ? "ids that are counted over the set"
                                : "the numbers in the names of its pictures";
}
const char* words(Texts texts) {
  return texts == Texts::kNames ? "the names of the set's pictures" : "places in its sequences";
}

// The images of a set by their number and by their name (read_detections states both).
class SetImages {
 public:
  using Images = std::vector<SetImage>;

  // `set` must outlive the object.
  explicit SetImages(std::span<const ExpectedSequence> set) : set_(set) {
    for (std::size_t i = 0; i < set.size(); ++i) {
      names_.emplace(set[i].name, i);
      numbers_.add(set[i].frames, set[i].pictures, set[i].image_ids, set[i].category_ids);
      const std::size_t named = std::max(set[i].pictures.size(), set[i].image_ids.size());
      for (std::size_t frame = 0; frame < named; ++frame) add(i, frame);
    }
  }

  // What numbers and texts may be, the likeliest first.
  std::vector<Texts> text_readings() const {
    if (numbers_.states_names()) return {Texts::kNames, Texts::kPlaces};
    return {Texts::kPlaces, Texts::kNames};
  }
  std::vector<Ids> readings() const {
    if (ids_.empty()) return {Ids::kCounted, Ids::kInNames};
    if (numbers_.states_image_ids()) return {Ids::kStated, Ids::kInNames};
    return {Ids::kStated, Ids::kCounted, Ids::kInNames};
  }
  // The images of that number, or of that name: none, one, or several.
  Images find(std::int64_t id, Ids ids) const {
    if (ids == Ids::kCounted) return counted(id);
    const auto& numbers = ids == Ids::kStated ? ids_ : in_names_;
    const auto found = numbers.find(id);
    return found == numbers.end() ? Images() : found->second;
  }
  Images find(const std::string& text, Texts texts) const {
    if (texts == Texts::kPlaces) return placed(text);
    const fs::path path(text);
    const std::string stem = path.stem().string();
    for (const auto& [name, pictures] :
         {std::pair{text, &pictures_},
          std::pair{(path.parent_path() / stem).string(), &pictures_},
          std::pair{(path.parent_path().filename() / stem).string(), &in_sequences_},
          std::pair{path.filename().string(), &pictures_},
          std::pair{stem, &pictures_}})
      if (const auto found = pictures->find(name); found != pictures->end()) return found->second;
    Images there = placed(text);
    std::erase_if(there, [&](const SetImage& image) { return !picture_of(image).empty(); });
    return there;
  }

  // Both throw Error at `where` for an image that the set does not have, and for one that it has
  // twice.
  SetImage by_id(std::int64_t id, Ids ids, const Where& where) const {
    const Images found = find(id, ids);
    const bool are_stated = ids == Ids::kStated;
    if (found.empty())
      throw Error(fmt::format("image_id is {}; the set has {} images with ids from {} to {}",
                              id,
                              are_stated ? std::ssize(ids_) : numbers_.frames(),
                              are_stated ? ids_.begin()->first : 1,
                              are_stated ? ids_.rbegin()->first : numbers_.frames()),
                  where);
    return only(found, fmt::format("image_id {}", id), where);
  }
  SetImage by_name(const std::string& text, Texts texts, const Where& where) const {
    const Images images = find(text, texts);
    if (!images.empty()) return only(images, "'" + text.substr(0, 200) + "'", where);
    const std::string name = fs::path(text).parent_path().filename().string();
    const auto found = names_.find(name);
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
                    "'; expected a picture's file name, or SEQUENCE/NUMBER.jpg with frames from "
                    "0, the same for all" +
                    hint,
                where);
  }

 private:
  void add(std::size_t sequence, std::size_t frame) {
    const ExpectedSequence& of = set_[sequence];
    const SetImage image{sequence, static_cast<std::int64_t>(frame)};
    if (frame < of.image_ids.size() && of.image_ids[frame])
      ids_[*of.image_ids[frame]].push_back(image);
    if (frame >= of.pictures.size() || of.pictures[frame].empty()) return;
    const fs::path picture = of.pictures[frame];
    const std::string stem = picture.stem().string();
    for (const std::string& name : std::set<std::string>{picture.string(),
                                                         (picture.parent_path() / stem).string(),
                                                         picture.filename().string(),
                                                         stem})
      pictures_[name].push_back(image);
    in_sequences_[of.name + "/" + stem].push_back(image);
    if (const auto number = number_from_text<std::int64_t>(stem); number && *number >= 0)
      in_names_[*number].push_back(image);
  }

  std::string picture_of(const SetImage& image) const {
    const std::vector<std::string>& pictures = set_[image.sequence].pictures;
    const auto frame = static_cast<std::size_t>(image.frame);
    return frame < pictures.size() ? pictures[frame] : "";
  }

  Images counted(std::int64_t id) const {
    if (id < 1 || id > numbers_.frames()) return {};
    const auto [sequence, frame] = numbers_.counted(id);
    return {{sequence, frame}};
  }

  Images placed(const std::string& text) const {
    const fs::path path(text);
    const auto found = names_.find(path.parent_path().filename().string());
    const auto frame = number_from_text<std::int64_t>(path.stem().string());
    if (found == names_.end() || !frame || *frame < 0 || *frame >= set_[found->second].frames)
      return {};
    return {{found->second, *frame}};
  }

  SetImage only(const Images& found, const std::string& what, const Where& where) const {
    if (found.size() == 1) return found.front();
    throw Error(
        fmt::format("{} is an image of '{}' and of '{}'; expected results that name pictures "
                    "by their folder and file",
                    what,
                    set_[found[0].sequence].name,
                    set_[found[1].sequence].name),
        where);
  }

  std::span<const ExpectedSequence> set_;
  label_file::CocoNumbers numbers_;
  std::map<std::int64_t, Images> ids_;
  std::map<std::int64_t, Images> in_names_;
  // By the whole name, by the file name, and by either without its ending.
  std::map<std::string, Images> pictures_;
  // By SEQUENCE/STEM, as the export names them.
  std::map<std::string, Images> in_sequences_;
  std::map<std::string, std::size_t> names_;
};

JsonDocument parsed(const JsonPart& part, const fs::path& file) {
  for (const char* word : {"NaN", "Infinity"})
    if (part.text.find(word) != std::string_view::npos &&
        !Json::accept(part.text.begin(), part.text.end()))
      throw Error(std::string("holds ") + word + "; expected finite numbers",
                  {file.string(), part.line});
  return JsonDocument(part.text, {file.string(), part.line});
}

// The texts of a key by the ids of the objects in a list.
NamesById texts_by_id(const std::optional<JsonPart>& list,
                      const fs::path& file,
                      const std::string& what,
                      const std::string& key) {
  NamesById texts;
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

// By which numbers and texts a whole file names images and categories.
struct Keys {
  std::set<std::int64_t> ids;
  std::set<std::string> texts;
  std::set<std::int64_t> categories;
};

// How a file's keys are read.
struct Readings {
  Ids ids = Ids::kStated;
  Texts texts = Texts::kNames;
  NamesById categories;  // where a sequence states no such id
};

// The name of an image in a result; empty where it has a number.
std::optional<std::string> name_in(const JsonObject& object) {
  for (const char* key : {"file_name", "image_name"})
    if (auto name = object.maybe_text(key)) return name;
  if (object.has("image_id") && object.value("image_id").is_string())
    return object.text("image_id");
  return std::nullopt;
}

SetImage image_of(const JsonObject& object,
                  const Found& found,
                  const SetImages& images,
                  const Readings& readings,
                  const Where& where) {
  if (const auto name = name_in(object)) return images.by_name(*name, readings.texts, where);
  if (!object.has("image_id")) throw Error(std::string("has no image_id; ") + kExpected, where);
  const std::int64_t id = object.whole("image_id");
  if (found.image_files.empty()) return images.by_id(id, readings.ids, where);
  const auto named = found.image_files.find(id);
  if (named == found.image_files.end())
    throw Error(fmt::format("image_id is {}, which the file's images do not have", id), where);
  return images.by_name(named->second, readings.texts, where);
}

// Looks through a list of detections. A whole COCO file names all its images, with or without
// detections.
Keys keys_in(const Found& found, const fs::path& file) {
  Keys keys;
  for (const auto& [id, name] : found.image_files) keys.texts.insert(name);
  JsonElements elements(found.list, file, found.what());
  while (const auto element = elements.next()) {
    const JsonDocument object = parsed(*element, file);
    const auto is_number = [&](const char* key) {
      return object.has(key) && object.value(key).is_number();
    };
    if (auto name = name_in(object))
      keys.texts.insert(*std::move(name));
    else if (is_number("image_id") && found.image_files.empty())
      keys.ids.insert(object.whole("image_id"));
    if (is_number("category_id") && !object.has("category_name") && found.categories.empty())
      keys.categories.insert(object.whole("category_id"));
  }
  return keys;
}

// The first of `readings` by which the set has all images that it has by any, and else the first.
// Warns where another one finds all as well, and not the same.
template <typename Key, typename Reading>
Reading reading_of(const std::set<Key>& keys,
                   const std::vector<Reading>& readings,
                   const SetImages& images,
                   const fs::path& file,
                   const Warn& warn) {
  const auto is_known = [&](const Key& key) {
    return std::ranges::any_of(readings,
                               [&](Reading reading) { return !images.find(key, reading).empty(); });
  };
  std::vector<Reading> fitting;
  for (const Reading reading : readings)
    if (std::ranges::all_of(keys, [&](const Key& key) {
          return !images.find(key, reading).empty() || !is_known(key);
        }))
      fitting.push_back(reading);
  if (fitting.empty()) return readings.front();
  for (const Reading other : fitting) {
    if (other == fitting.front()) continue;
    bool is_one_each = true;
    bool is_same = true;
    for (const Key& key : keys) {
      const auto first = images.find(key, fitting.front());
      const auto found = images.find(key, other);
      is_one_each = is_one_each && found.size() <= 1 && first.size() <= 1;
      is_same = is_same && found == first;
    }
    if (is_one_each && !is_same)
      airtruth::warn(warn,
                     fmt::format("{}: names its images by {} or by {}, and is read by the first",
                                 file.string(),
                                 words(fitting.front()),
                                 words(other)));
  }
  return fitting.front();
}

NamesById counted_from_1(const std::set<std::string>& names) {
  NamesById categories;
  for (const std::string& name : names) categories.emplace(std::ssize(categories) + 1, name);
  return categories;
}

// What the ids of categories mean that the file does not name: those that the set states, or of an
// export of it, with or without --one-class, in which they are all there and one is an aircraft's.
// Throws Error where both exports fit and differ in what is an aircraft; warns where nothing fits.
// Category 1 alone is every detector's aircraft, unless the set states it.
NamesById categories_of(const std::set<std::int64_t>& ids,
                        std::span<const ExpectedSequence> set,
                        const fs::path& file,
                        const Warn& warn) {
  NamesById stated;
  std::set<std::string> all;
  std::set<std::string> distractors;
  for (const ExpectedSequence& sequence : set) {
    stated.insert(sequence.category_ids.begin(), sequence.category_ids.end());
    all.insert(sequence.categories.begin(), sequence.categories.end());
    distractors.insert(sequence.distractors.begin(), sequence.distractors.end());
  }
  if (ids.empty() || (stated.empty() && ids == std::set<std::int64_t>{1})) return {};
  std::set<std::string> of_one_class = distractors;
  of_one_class.insert(Detection{}.category);
  const NamesById whole = stated.empty() ? counted_from_1(all) : stated;
  const NamesById one_class = stated.empty() ? counted_from_1(of_one_class) : stated;
  const auto is_aircraft = [&](const NamesById& categories, std::int64_t id) {
    if (!categories.contains(id) || distractors.contains(categories.at(id))) return false;
    const auto of_class = annotation::class_of_category(categories.at(id));
    return !of_class || annotation::is_aircraft(*of_class);
  };
  const auto fits = [&](const NamesById& categories) {
    return std::ranges::all_of(ids, [&](auto id) { return categories.contains(id); }) &&
           std::ranges::any_of(ids, [&](auto id) { return is_aircraft(categories, id); });
  };
  if (fits(whole) && fits(one_class))
    for (const std::int64_t id : ids)
      if (is_aircraft(whole, id) != is_aircraft(one_class, id))
        throw Error(fmt::format("names no categories, and category_id {} is '{}' in an export of "
                                "the set and '{}' in one with --one-class; expected category_name "
                                "in each line",
                                id,
                                whole.at(id),
                                one_class.at(id)),
                    {file.string()});
  if (fits(whole)) return whole;
  if (fits(one_class)) return one_class;
  const auto odd = std::ranges::find_if(ids, [&](auto id) { return !whole.contains(id); });
  const auto named = stated.find(*ids.begin());
  airtruth::warn(
      warn,
      odd == ids.end() && named != stated.end()
          ? fmt::format("{}: names no categories, and category_id {} is '{}' in the set; no other "
                        "is an aircraft's",
                        file.string(),
                        named->first,
                        named->second)
          : fmt::format("{}: category_id {} is none of the set's, and counts as an aircraft",
                        file.string(),
                        odd == ids.end() ? *ids.begin() : *odd));
  return {};
}

// Category 1 is "aircraft" where nothing names it.
std::string category_of(const JsonObject& object,
                        const Found& found,
                        const ExpectedSequence& sequence,
                        const Readings& readings,
                        const Where& where) {
  if (const auto category = object.maybe_text("category_name")) return *category;
  if (!object.has("category_id")) return Detection{}.category;
  const std::int64_t id = object.whole("category_id");
  if (!found.categories.empty()) {
    const auto named = found.categories.find(id);
    if (named == found.categories.end())
      throw Error(fmt::format("category_id is {}, which the file's categories do not have", id),
                  where);
    return named->second;
  }
  const auto in_set = sequence.category_ids.find(id);
  if (in_set != sequence.category_ids.end()) return in_set->second;
  const auto counted = readings.categories.find(id);
  if (counted != readings.categories.end()) return counted->second;
  return id == 1 ? Detection{}.category : fmt::format("{}", id);
}

Detection detection_of(const JsonObject& object,
                       const Found& found,
                       const ExpectedSequence& sequence,
                       const Readings& readings,
                       const Where& where) {
  Detection detection;
  const std::vector<double> box = object.numbers("bbox", 4);
  detection.box_px = {box[0], box[1], box[2], box[3]};
  if (found.is_whole && !object.has("score"))
    throw Error(std::string("is an annotation without a score; ") + kExpected, where);
  detection.score = object.number("score");
  detection.category = category_of(object, found, sequence, readings, where);
  if (const auto track = object.maybe_integer("track_id"); track && *track >= 0)
    detection.track = *track;
  return detection;
}

Found found_in(std::string_view text, const fs::path& file) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first != std::string_view::npos && text[first] == '[') return {{text}};
  if (first == std::string_view::npos || text[first] != '{')
    throw Error(std::string("is no list of detections; ") + kExpected, {file.string()});
  const auto members = json_members(text, file, {"annotations", "images", "categories"});
  if (!members[0]) throw Error(std::string("has no annotations; ") + kExpected, {file.string()});
  return {*members[0],
          true,
          texts_by_id(members[1], file, "images", "file_name"),
          texts_by_id(members[2], file, "categories", "name")};
}

}  // namespace

std::vector<SequenceDetections> read_coco_results(const fs::path& file,
                                                  std::span<const ExpectedSequence> set,
                                                  const Warn& warn) {
  const std::string text = read_file(file, kMaxBytes);
  const SetImages images(set);
  std::vector<FrameList> lists;
  for (const ExpectedSequence& sequence : set)
    lists.emplace_back(sequence.name, sequence.width, sequence.height, sequence.frames);
  const Found found = found_in(text, file);
  const Keys keys = keys_in(found, file);
  const Readings readings = {reading_of(keys.ids, images.readings(), images, file, warn),
                             reading_of(keys.texts, images.text_readings(), images, file, warn),
                             categories_of(keys.categories, set, file, warn)};
  JsonElements elements(found.list, file, found.what());
  while (const auto element = elements.next()) {
    const Where where{file.string(), element->line};
    const JsonDocument object = parsed(*element, file);
    const SetImage image = image_of(object, found, images, readings, where);
    Detection detection = detection_of(object, found, set[image.sequence], readings, where);
    lists[image.sequence].add(image.frame, std::move(detection), where);
  }
  std::vector<SequenceDetections> all;
  for (FrameList& list : lists) all.push_back(list.take());
  return all;
}

void write_coco_results(const fs::path& file,
                        const fs::path& folder,
                        std::span<const ExpectedSequence> set) {
  std::set<std::string> categories, aircraft;
  label_file::CocoNumbers numbers;
  for (const ExpectedSequence& sequence : set) {
    numbers.add(sequence.frames, sequence.pictures, sequence.image_ids, sequence.category_ids);
    std::ranges::set_difference(
        sequence.categories, sequence.distractors, std::inserter(aircraft, aircraft.end()));
    if (has_sequence(folder, sequence.name))
      for (const auto& frame : read_sequence(folder, sequence.name).frames)
        for (const Detection& d : frame) categories.insert(d.category);
  }
  const auto ids = numbers.category_ids(categories, aircraft);
  std::string text = "[";
  for (std::size_t k = 0; k < set.size(); ++k) {
    const ExpectedSequence& sequence = set[k];
    if (!has_sequence(folder, sequence.name)) continue;
    const SequenceDetections read = read_sequence(folder, sequence.name);
    for (std::size_t i = 0; i < read.frames.size(); ++i) {
      const auto stated = i < sequence.image_ids.size() ? sequence.image_ids[i] : std::nullopt;
      for (const Detection& d : read.frames[i]) {
        const std::int64_t category = ids.at(d.category);
        Json json = {{"image_id", numbers.image_id(k, i, stated)},
                     {"category_id", category},
                     {"bbox", {d.box_px.x, d.box_px.y, d.box_px.width, d.box_px.height}},
                     {"score", d.score}};
        if (d.track) json["track_id"] = *d.track;
        // The clip's own source may state that id of another category.
        const auto in_clip = sequence.category_ids.find(category);
        if (categories.size() > 1 || d.category != "aircraft" || category != 1 ||
            (in_clip != sequence.category_ids.end() && in_clip->second != d.category))
          json["category_name"] = d.category;
        // Beside an id that the set states otherwise, or twice.
        if (stated && !numbers.states_image_ids() && i < sequence.pictures.size())
          json["file_name"] =
              sequence.name + "/" + fs::path(sequence.pictures[i]).filename().string();
        text += (text.size() > 1 ? ",\n" : "") + json.dump();
      }
    }
  }
  write_file(file, text + "]\n");
}

}  // namespace airtruth::results
