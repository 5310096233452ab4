// SPDX-License-Identifier: Apache-2.0
#include "dataset/labelled/export.h"

#include <algorithm>
#include <iterator>
#include <mutex>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "dataset/labelled/truth_table.h"
#include "foundation/base/error.h"
#include "foundation/base/file_state.h"
#include "foundation/base/files.h"
#include "foundation/base/in_parallel.h"
#include "foundation/json/json_object.h"
#include "foundation/json/parse_json.h"
#include "labels/annotation/object_class.h"
#include "labels/label_file/coco_numbers.h"
#include "labels/label_file/label_file.h"
#include "picture/video/reader.h"
#include "picture/video/still.h"

namespace airtruth::labelled {
namespace {

using Json = nlohmann::ordered_json;

const char* extension_of(Images images) { return images == Images::kPng ? ".png" : ".jpg"; }

// Returns the kind of pictures to write. Throws Error where the format's reader does not open that
// kind.
Images images_of(const ExportOptions& options) {
  const exchange::Pictures wanted = exchange::pictures_of(options.format);
  if (wanted == exchange::Pictures::kNone) {
    if (options.images.value_or(Images::kNone) != Images::kNone)
      throw Error(std::string("images is ") + enum_name(*options.images) + ", and " +
                  exchange::name(options.format) + " holds no pictures; expected none");
    return Images::kNone;
  }
  if (!options.images) return wanted == exchange::Pictures::kPngAlone ? Images::kPng : Images::kJpg;
  if (wanted == exchange::Pictures::kPngAlone && *options.images == Images::kJpg)
    throw Error(std::string("images is jpg, and the readers of ") + exchange::name(options.format) +
                " open names that end in .png alone; expected png or none");
  if (wanted == exchange::Pictures::kJpgExpected && *options.images == Images::kPng)
    warn(options.warn,
         std::string("the got10k toolkit reads *.jpg alone of ") + exchange::name(options.format) +
             " sequences, and the pictures are png");
  return *options.images;
}

// Changes with what a set holds: of one that was built and holds all that its catalogue states, its
// record; else those of the sequences that are there.
std::string sha256_of_set(const fs::path& set, const LabelledSet& labelled) {
  if (const fs::path record = set / "dataset.json"; labelled.missing() == 0 && fs::exists(record))
    return sha256_of_file(record);
  std::string all;
  for (const std::string& name : labelled.names())
    all += name + ' ' + labelled.sha256_of(name) + '\n';
  return sha256_of(all);
}

// The options that determine every byte of an export.
Json options_json(const fs::path& set, const LabelledSet& labelled, const ExportOptions& options) {
  Json json = {{"set", absolute_path(set).string()},
               {"set_sha256", sha256_of_set(set, labelled)},
               {"format", exchange::name(options.format)},
               {"images", enum_name(*options.images)},
               {"every", options.every},
               {"split", enum_name(options.split)},
               {"shares", options.shares},
               {"seed", options.seed},
               {"boxes", enum_name(options.boxes)},
               {"one_class", options.one_class}};
  if (options.mot_classes) json["mot_classes"] = true;
  if (options.shard_mb) json["shard_mb"] = *options.shard_mb;
  if (options.min_contrast > 0) json["min_contrast"] = options.min_contrast;
  if (options.min_size_px > 0) json["min_size_px"] = options.min_size_px;
  if (options.drop_faint) json["drop_faint"] = true;
  return json;
}

std::string boxes_text(dataset::Boxes boxes) {
  switch (boxes) {
    case dataset::Boxes::kCovered:
      return "Boxes are the covered ones (`covered_box_px` of truth.jsonl): bounds of the pixels "
             "that the aircraft covers with an alpha of 0.08 or more. An aircraft that covers no "
             "pixel "
             "so far has no box.\n";
    case dataset::Boxes::kExact:
      return "Boxes are the exact ones (`exact_box_px` of truth.jsonl), cut by the frame: bounds "
             "of the projected shape, in fractions of a pixel.\n";
    case dataset::Boxes::kVisible:
      break;
  }
  return "Boxes are the visible ones (`visible_box_px` of truth.jsonl): bounds of the pixels that "
         "changed, with what blur, sharpening, noise and the codec's quantiser add around the "
         "aircraft.\n";
}

// The export's own folder in its place while the export is under way.
constexpr const char* kOwnFolder = ".export";

// The folder of an export while the export is under way. It is made by begin().
class Place {
 public:
  Place(fs::path root, const Json& options) : root_(std::move(root)), options_(options) {
    examine();
  }

  // Another run may have come first since the folder was examined.
  void begin(const Warn& to) {
    make_folders(root_);
    lock_.emplace(root_, root_, to);
    examine();
    if (complete_) throw Error("was written by another run meanwhile", {root_.string()});
    make_folders(done_folder(), root_);
    write_file(begun_file(), options_.dump());
  }

  bool is_complete() const { return complete_; }
  const fs::path& root() const { return root_; }
  bool has_images_of(const std::string& name) const { return fs::exists(done_folder() / name); }
  void mark_images_of(const std::string& name) const {
    flush_files(root_);
    write_file(done_folder() / name, "");
  }
  void finish(const Json& summary) const {
    flush_files(root_);
    write_file(record(), Json{{"options", options_}, {"summary", summary}}.dump(2) + "\n");
    fs::remove_all(root_ / kOwnFolder);
  }
  fs::path record() const { return root_ / "export.json"; }

 private:
  void examine() {
    if (fs::exists(record())) {
      const Json found = parse_json(read_file(record()));
      if (!found.is_object() || found.value("options", Json()) != options_)
        throw Error(
            "holds an export of another set, or made with other options; expected a new folder",
            {root_.string()});
      complete_ = true;
      // A run that ended between its last two steps leaves this folder.
      fs::remove_all(root_ / kOwnFolder);
      return;
    }
    const bool begun = fs::exists(begun_file());
    if (begun && parse_json(read_file(begun_file())) != options_)
      throw Error(
          "holds an unfinished export of another set, or with other options; expected the same, "
          "or a new folder",
          {root_.string()});
    if (!begun && fs::exists(root_) && !holds_only_own_folder())
      throw Error("exists and is not empty; expected a new folder", {root_.string()});
  }

  // A run that is killed between its first two steps leaves its own folder without the options in
  // it. Nothing is exported by then.
  bool holds_only_own_folder() const {
    return fs::is_directory(root_) &&
           std::all_of(fs::directory_iterator(root_), fs::directory_iterator(), [](auto& entry) {
             return entry.path().filename() == kOwnFolder;
           });
  }
  fs::path begun_file() const { return root_ / kOwnFolder / "options.json"; }
  fs::path done_folder() const { return root_ / kOwnFolder / "done"; }

  fs::path root_;
  Json options_;
  bool complete_ = false;
  std::optional<RunLock> lock_;
};

class Export {
 public:
  Export(const LabelledSet& set, Place& place, const ExportOptions& options)
      : set_(set), place_(place), options_(options) {}

  // Every check of the set comes before the folder is made.
  ExportSummary run() {
    survey();
    expect_held();
    if (exchange::is_single_object(options_.format)) expect_distinct();
    place_.begin(options_.warn);
    writer_ = exchange::make_writer(options_.format, place_.root(), write_);
    if (*options_.images != Images::kNone) write_images();
    write_labels();
    write_file(place_.root() / "LOSS.md", exchange::loss(options_.format) + about_boxes());
    place_.finish({{"sequences", summary_.sequences},
                   {"frames", summary_.frames},
                   {"frames_of_part", summary_.frames_of_part},
                   {"faint", summary_.faint}});
    return summary_;
  }

 private:
  void survey() {
    std::vector<ClipFacts> facts;
    std::set<std::string> categories, aircraft;
    for (const std::string& name : set_.names()) {
      facts.push_back(set_.facts(name));
      std::ranges::set_difference(facts.back().categories,
                                  facts.back().distractors,
                                  std::inserter(aircraft, aircraft.end()));
      if (is_coco() && set_.is_imported(name))
        numbers_.add(set_.clip(name));
      else
        numbers_.add(facts.back().frames, {}, {}, {});
      const auto& named = options_.one_class ? facts.back().distractors : facts.back().categories;
      categories.insert(named.begin(), named.end());
    }
    if (options_.one_class) categories.insert("aircraft");
    parts_ = parted(facts, options_.split, options_.shares, options_.seed, options_.warn);
    // GOT-10k's toolkit asserts that a subset is train, val or test, and scores val by its truth.
    // torchvision asserts that an image set of VOC is train, val or trainval.
    const char* whole = options_.format == exchange::Format::kGot10k ? "val"
                        : options_.format == exchange::Format::kVoc  ? "trainval"
                                                                     : "all";
    for (auto& [name, part] : parts_)
      if (part == "all") part = whole;
    write_.categories = {categories.begin(), categories.end()};
    write_.category_ids = numbers_.category_ids(categories, aircraft);
    write_.image_extension = extension_of(*options_.images);
    write_.with_images = *options_.images != Images::kNone;
    write_.mot_classes = options_.mot_classes;
    write_.staging = fs::path(kOwnFolder) / "pictures";
    if (options_.shard_mb) write_.shard_bytes = *options_.shard_mb * 1'000'000;
    if (is_table()) {
      write_.columns = truth_columns();
      write_.cells = [this](std::int64_t frame, const exchange::Label& label) {
        return cells_of(frame, label);
      };
    }
    write_.parts = {"train", "val", "test", "trainval", "all"};
    std::erase_if(write_.parts, [this](const std::string& part) {
      return std::ranges::none_of(parts_, [&](const auto& one) { return one.second == part; });
    });
  }

  // A rendered sequence has its video and its size.
  void expect_held() const {
    for (const std::string& name : set_.names()) {
      if (options_.min_contrast > 0) expect_contrast(name);
      if (!set_.is_imported(name)) continue;
      const exchange::Clip clip = clip_of(name);
      exchange::expect_held(options_.format, clip);
      if (*options_.images != Images::kNone && !place_.has_images_of(name))
        check_has_video(name, clip);
    }
  }

  void expect_distinct() const {
    std::map<std::string, exchange::ArrangedNames> names_of_part;
    for (const std::string& name : set_.names()) {
      exchange::Clip clip = clip_of(name);
      sift(clip);
      exchange::add_names(names_of_part[parts_.at(name)], name, arranged(clip));
    }
  }

  void expect_contrast(const std::string& name) const {
    std::int64_t known = 0, boxes = 0;
    for (const exchange::LabelledFrame& frame : set_.clip(name, options_.boxes).frames)
      for (const exchange::Label& label : frame.labels) {
        ++boxes;
        known += label.contrast_to_noise ? 1 : 0;
      }
    if (boxes > 0 && known == 0)
      throw Error(
          "states no contrast to noise of its boxes; expected a sequence that this version "
          "rendered, or no --min-contrast",
          {set_.folder(name).string()});
  }

  bool is_faint(const exchange::Label& label) const {
    return label.contrast_to_noise.value_or(options_.min_contrast) < options_.min_contrast ||
           std::max(label.box_px.width, label.box_px.height) < options_.min_size_px;
  }

  bool marks_faint() const {
    return !options_.drop_faint && exchange::has_ignore_mark(options_.format);
  }

  // Marks or drops what is too faint or too small; returns how many boxes.
  std::int64_t sift(exchange::Clip& clip) const {
    std::int64_t faint = 0;
    for (exchange::LabelledFrame& frame : clip.frames) {
      for (exchange::Label& label : frame.labels) {
        if (!is_faint(label)) continue;
        ++faint;
        label.object_class = label_file::kIgnore;
      }
      if (!marks_faint())
        std::erase_if(frame.labels, [this](const auto& label) { return is_faint(label); });
    }
    return faint;
  }

  exchange::Clip clip_of(const std::string& name, bool with_masks = false) const {
    exchange::Clip clip = set_.clip(name, options_.boxes, with_masks);
    if (is_coco())
      numbers_.number(clip,
                      static_cast<std::size_t>(std::ranges::lower_bound(set_.names(), name) -
                                               set_.names().begin()));
    std::erase_if(clip.frames, [&](const exchange::LabelledFrame& frame) {
      return frame.frame % options_.every != 0;
    });
    if (clip.frame_rate_hz)
      *clip.frame_rate_hz /=
          static_cast<double>(exchange::frame_step(clip).value_or(options_.every));
    if (options_.one_class)
      for (exchange::LabelledFrame& frame : clip.frames)
        for (exchange::Label& label : frame.labels)
          if (annotation::is_aircraft(label.object_class)) label.category = "aircraft";
    return clip;
  }

  void write_images() {
    in_parallel(
        set_.names().size(), options_, [this](std::size_t i) { write_images_of(set_.names()[i]); });
  }

  static void check_has_video(const std::string& name, const exchange::Clip& clip) {
    if (clip.media.empty())
      throw Error(name + " has no video to take pictures from; expected --images none");
    if (!fs::exists(clip.media))
      throw Error("the video of " + name + " is not there; expected it, or --images none",
                  {clip.media.string()});
  }

  void write_images_of(const std::string& name) {
    if (place_.has_images_of(name)) return;
    exchange::Clip clip = clip_of(name);
    sift(clip);
    const std::string& part = parts_.at(name);
    const std::map<std::int64_t, std::vector<fs::path>> wanted = places_of(clip, part);
    video::Reader reader(clip.media, {.threads = 1});
    std::int64_t written = 0;
    std::size_t left = wanted.size();
    while (left > 0) {
      const auto frame = reader.next();
      if (!frame) break;
      if (options_.stop.stop_requested()) throw Interrupted();
      const auto found = wanted.find(frame->index);
      if (found == wanted.end()) continue;
      --left;
      for (const fs::path& file : found->second) {
        fs::create_directories(file.parent_path());
        video::write_still(file, frame->picture, Flush::kLater);
        ++written;
      }
    }
    if (left > 0)
      throw Error("ends before the labels of " + name + " do: " + std::to_string(left) +
                      " labelled frames are not in it",
                  {clip.media.string()});
    place_.mark_images_of(name);
    const std::lock_guard lock(mutex_);
    summary_.images += written;
  }

  // The clips that the format makes from one clip. Single-object toolkits refuse a sequence of one
  // frame: they read its truth as four numbers and not as a table.
  std::vector<exchange::Clip> arranged(const exchange::Clip& clip) const {
    std::vector<exchange::Clip> clips = exchange::arranged(options_.format, clip);
    if (exchange::is_single_object(options_.format))
      std::erase_if(clips, [](const exchange::Clip& one) { return one.frames.size() < 2; });
    return clips;
  }

  // Decides which pictures are made from which frame.
  std::map<std::int64_t, std::vector<fs::path>> places_of(const exchange::Clip& clip,
                                                          const std::string& part) const {
    std::map<std::int64_t, std::vector<fs::path>> places;
    for (const exchange::Clip& one : arranged(clip)) {
      const std::vector<fs::path> files = writer_->images(one, part);
      for (std::size_t i = 0; i < one.frames.size(); ++i)
        places[one.frames[i].frame].push_back(place_.root() / files[i]);
    }
    return places;
  }

  bool is_table() const { return options_.format == exchange::Format::kTable; }
  bool is_coco() const { return options_.format == exchange::Format::kCoco; }

  // The truth of the sequence whose labels are being written, for the table.
  void read_truth(const std::string& name) {
    truth_.clear();
    if (set_.is_imported(name)) return;
    const replay::Finished finished = replay::open_finished(set_.folder(name));
    encounters_ += encounter_lines(finished, parts_.at(name));
    for (const annotation::Frame& frame : finished.truth.frames)
      truth_[frame.frame] = frame.intruders;
  }

  // The track of a label is the place of its intruder, from 1.
  std::vector<std::string> cells_of(std::int64_t frame, const exchange::Label& label) const {
    const auto found = truth_.find(frame);
    if (found == truth_.end()) return std::vector<std::string>(write_.columns.size());
    return truth_cells(found->second.at(static_cast<std::size_t>(label.track) - 1));
  }

  void write_labels() {
    for (const std::string& name : set_.names()) {
      if (options_.stop.stop_requested()) throw Interrupted();
      exchange::Clip clip = clip_of(name, is_coco());
      summary_.faint += sift(clip);
      if (clip.frames.empty())
        warn(options_.warn,
             fmt::format("{} has no frame whose number is a multiple of {}", name, options_.every));
      const std::string& part = parts_.at(name);
      if (is_table()) read_truth(name);
      const auto clips = arranged(clip);
      if (!clips.empty()) count_boxes(clip, set_.is_imported(name));
      std::int64_t& frames_of_part = summary_.frames_of_part[part];
      const std::size_t tracks = exchange::tracks_of(exchange::aircraft_alone(clip)).size();
      if (exchange::is_single_object(options_.format) && (clips.size() < tracks || tracks == 0))
        warn(
            options_.warn,
            name +
                (tracks == 0 ? " never shows an aircraft" : " shows an object in one frame alone") +
                ", and " + exchange::name(options_.format) +
                " has no place for such a sequence: it is left out");
      for (const exchange::Clip& one : clips) {
        writer_->add(one, part);
        ++summary_.sequences;
        summary_.frames += std::ssize(one.frames);
        frames_of_part += std::ssize(one.frames);
      }
    }
    writer_->finish();
    if (is_table()) write_file(place_.root() / "encounters.csv", encounters_header() + encounters_);
  }

  void count_boxes(const exchange::Clip& clip, bool is_imported) {
    (is_imported ? imported_ : rendered_) += 1;
    for (const exchange::LabelledFrame& frame : clip.frames)
      for (const exchange::Label& label : frame.labels) {
        ++boxes_;
        summary_.masks += label.mask ? 1 : 0;
      }
  }

  // Describes the boxes and the masks of this export.
  std::string about_boxes() const {
    std::string text = "\n";
    if (rendered_ > 0) text += boxes_text(options_.boxes);
    if (imported_ > 0) text += "Boxes of imported clips are as they were imported.\n";
    if (options_.min_contrast > 0 || options_.min_size_px > 0)
      text += fmt::format(
          "\n{} boxes with a contrast to noise below {} or a longer side below {} px are {}.\n",
          summary_.faint,
          options_.min_contrast,
          options_.min_size_px,
          marks_faint() ? "marked as counting neither way" : "dropped");
    if (!is_coco()) return text;
    text +=
        summary_.masks > 0
            ? fmt::format(
                  "\n`segmentation` of {} of {} boxes holds the run lengths of the pixels with an "
                  "alpha of 0.08 or more; any other is its box.\n",
                  summary_.masks,
                  boxes_)
            : "\n`segmentation` is the box as a polygon, no outline: the set has no masks "
              "([output] masks = true makes them).\n";
    text +=
        "`area` is the number of those pixels where the truth states it, else that of the box.\n";
    return text;
  }

  const LabelledSet& set_;
  Place& place_;
  const ExportOptions& options_;
  exchange::WriteOptions write_;
  std::unique_ptr<exchange::Writer> writer_;
  std::map<std::string, std::string> parts_;
  label_file::CocoNumbers numbers_;
  // For the table: the intruders by frame, and the lines of encounters so far.
  std::map<std::int64_t, std::vector<annotation::Intruder>> truth_;
  std::string encounters_;
  std::mutex mutex_;
  std::int64_t rendered_ = 0, imported_ = 0, boxes_ = 0;
  ExportSummary summary_;
};

}  // namespace

ExportSummary export_set(const fs::path& set, const fs::path& out, const ExportOptions& wanted) {
  exchange::expect_written(wanted.format);
  ExportOptions options = wanted;
  options.images = images_of(wanted);
  if (options.mot_classes && options.format != exchange::Format::kMot)
    throw Error(std::string("numbered classes are asked for, and ") +
                exchange::name(options.format) + " holds its classes anyway; expected format mot");
  if (options.shard_mb && options.format != exchange::Format::kWebdataset)
    throw Error(std::string("a size of shards is asked for, and ") +
                exchange::name(options.format) + " has none; expected format webdataset");
  const LabelledSet labelled(set);
  // The labels hold folder names in XML, JSON and YAML.
  require_utf8(fs::absolute(set));
  require_utf8(fs::absolute(out));
  for (const std::string& name : labelled.names()) require_utf8(labelled.folder(name));
  Place place(out, options_json(set, labelled, options));
  if (place.is_complete()) {
    ExportSummary summary;
    const JsonDocument file(place.record());
    const JsonObject record = file.object("summary");
    summary.sequences = record.count("sequences");
    summary.frames = record.count("frames");
    summary.faint = record.count("faint");
    const JsonObject parts = record.object("frames_of_part");
    for (const std::string& part : parts.keys()) summary.frames_of_part[part] = parts.count(part);
    summary.was_there = true;
    return summary;
  }
  if (labelled.missing() > 0)
    warn(options.warn,
         set.string() + ": " + std::to_string(labelled.missing()) +
             " sequences of the catalogue are not there yet; the export is of the others");
  return Export(labelled, place, options).run();
}

}  // namespace airtruth::labelled
