// SPDX-License-Identifier: Apache-2.0
#include "runners/runs/detector_run.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <set>
#include <span>

#include <airtruth/version.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "camera/lens/calibration_file.h"
#include "dataset/labelled/labelled_set.h"
#include "dataset/sequences/layout.h"
#include "foundation/base/error.h"
#include "foundation/base/file_state.h"
#include "foundation/base/files.h"
#include "foundation/base/in_parallel.h"
#include "foundation/base/names.h"
#include "foundation/base/stopwatch.h"
#include "foundation/json/settings_record.h"
#include "foundation/lazy_library/lazy_library.h"
#include "picture/video/reader.h"
#include "runners/classical/classical.h"
#include "runners/detector/detector.h"
#include "runners/network/model_description.h"
#include "runners/network/network_detector.h"
#include "runners/results/detections.h"
#include "runners/results/results_folder.h"
#include "runners/runs/clips.h"
#include "sequence/replay/recorded_inputs.h"
#include "sequence/setup/motion_source.h"
#include "sequence/setup/shared_inputs.h"

namespace airtruth::runs {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kExec = "exec:";
constexpr std::string_view kNetwork = "onnx:";
constexpr const char* kShippedModel = "network-detector/aircraft.onnx";

// "exec" for exec:COMMAND: two of them need names. "aircraft" for onnx:models/aircraft.onnx.
std::string usual_name(const std::string& command) {
  const std::string scheme = command.substr(0, command.find(':'));
  if (!command.starts_with(kNetwork)) return scheme;
  const std::string stem = fs::path(command.substr(kNetwork.size())).stem().string();
  return stem.empty() ? scheme : stem;
}

struct DetectorName {
  std::string name;  // a plain file name
  std::string command;
};

// Throws Error for a name that is no file name.
DetectorName named_detector(const std::string& text) {
  const std::size_t equals = text.find('=');
  const std::size_t colon = text.find(':');
  const bool is_named =
      equals != std::string::npos && (colon == std::string::npos || equals < colon);
  const std::string command = is_named ? text.substr(equals + 1) : text;
  const std::string name = is_named ? text.substr(0, equals) : usual_name(command);
  if (!results::is_results_name(name))
    throw Error("'" + name.substr(0, 80) +
                "' is no name for a detector's results; expected letters, digits, - _ .");
  return {name, command};
}

fs::path shipped_model() {
  std::error_code ignored;
  for (const fs::path& place : lazy_library::data_places_of(kShippedModel))
    if (fs::is_regular_file(place, ignored)) return place;
  throw Error(
      fmt::format("the network that ships, {}, is not there; install airtruth whole, or "
                  "name another: onnx:MODEL.onnx",
                  kShippedModel));
}

// Of a network, empty for other detectors.
std::optional<fs::path> model_of(std::string_view command) {
  if (command == kShippedDetector) return shipped_model();
  if (!command.starts_with(kNetwork)) return std::nullopt;
  return command.substr(kNetwork.size());
}

// The files beside the command that decide a detector's answers: a network and its description.
std::vector<fs::path> files_of(std::string_view command) {
  const auto model = model_of(command);
  if (!model) return {};
  return {*model, network::description_path(*model)};
}

// The one place where kinds of detectors plug in. Throws Error for what is no detector; it offers
// the nearest.
std::unique_ptr<detector::Detector> make_detector(std::string_view command,
                                                  const process::Limits& limits,
                                                  int threads_of_a_network) {
  if (command.starts_with(kExec)) {
    const std::string program(command.substr(kExec.size()));
    if (program.find_first_not_of(' ') == std::string::npos)
      throw Error("'" + std::string(command) + "' names no command");
    return detector::make_external(program, limits);
  }
  if (auto classical = classical::make_classical(command)) return classical;
  if (const auto model = model_of(command)) {
    if (model->empty()) throw Error("'onnx:' names no file; expected onnx:MODEL.onnx");
    return network::make_network_detector(*model, {threads_of_a_network, limits.stop});
  }
  const std::string scheme(command.substr(0, command.find(':')));
  const bool has_scheme = scheme.size() < command.size();
  throw Error(fmt::format(
      "there is no detector '{}'{}",
      command.substr(0, 80),
      did_you_mean(has_scheme ? scheme + ":" : scheme,
                   has_scheme ? std::vector<std::string>{"onnx:", "exec:"} : detector_names(),
                   fmt::format("; expected {}, onnx:MODEL.onnx or exec:COMMAND",
                               fmt::join(detector_names(), ", ")))));
}

constexpr const char* kRecord = "detector.json";

Json settings_of(const association::AssociationOptions& association) {
  const auto& score = association.confident_score;
  return {{"declare", fmt::format("{}/{}", association.declare_m, association.declare_n)},
          {"confident_score", score ? Json(*score) : Json()}};
}

// The command without the folder of its files, which are known by their content.
std::string recorded(const std::string& command) {
  const std::vector<fs::path> files = files_of(command);
  if (files.empty() || command == kShippedDetector) return command;
  return command.substr(0, command.find(':') + 1) + files.front().filename().string();
}

// What decides the bytes of the results.
Json settings_of(const DetectorName& detector, const DetectOptions& options) {
  Json settings = {{"detector", recorded(detector.command)},
                   {"max_per_frame", options.max_per_frame}};
  settings["min_score"] = options.min_score ? Json(*options.min_score) : Json();
  settings["lens"] = options.lens ? Json(sha256_of_file(*options.lens)) : Json();
  settings["mask"] = options.mask && options.masks ? Json(sha256_of_file(*options.mask)) : Json();
  settings["masks"] = options.masks;
  settings["mask_results"] = options.mask_results;
  settings["association"] = options.association ? settings_of(*options.association) : Json();
  settings["files"] = Json::object();
  for (const fs::path& file : files_of(detector.command)) {
    settings["files"][file.filename().string()] = sha256_of_file(file);
  }
  return settings;
}

// The folder of the results of backgrounds, in a detector's folder.
constexpr const char* kBackgrounds = "backgrounds";

// The results of one detector in its folder: what is there, what is added. Thread-safe. `part` is
// "" for the sequences of a set, or kBackgrounds.
class DetectorResults {
 public:
  // Throws Error where the folder holds results of other settings.
  DetectorResults(const DetectorName& detector, const fs::path& out, const DetectOptions& options)
      : detector_(detector), options_(options), settings_(settings_of(detector, options)) {
    summary_.name = detector.name;
    summary_.folder = out / detector.name;
    is_open();
  }

  // Creates the folder. `coco_name` is the file of the COCO results.
  void open(const std::string& coco_name) {
    coco_file_ = summary_.folder / coco_name;
    make_folders(summary_.folder);
    lock_.emplace(summary_.folder, summary_.folder, options_.warn);
    is_open();
  }

  // Counts a sequence that is there. Throws Error where it was made of something else.
  bool keeps(const std::string& part, const results::SequenceDetections& begun) {
    const fs::path folder = summary_.folder / part;
    if (!results::has_sequence(folder, begun.name)) return false;
    results::expect_made_of(folder, begun);
    const std::lock_guard lock(mutex_);
    ++summary_.kept;
    return true;
  }

  void add(const std::string& part,
           const results::SequenceDetections& detections,
           const std::string& log) {
    const fs::path folder = summary_.folder / part;
    write_record();
    fs::create_directories(folder);
    results::write_log(summary_.folder, detections.name, log);
    // COCO results that are there are of fewer sequences.
    if (part.empty()) fs::remove(coco_file_);
    results::write_sequence(folder, detections);
    const std::lock_guard lock(mutex_);
    ++summary_.made;
    summary_.frames += std::ssize(detections.frames);
    for (const auto& frame : detections.frames) summary_.detections += std::ssize(frame);
    for (const double s : detections.seconds) summary_.seconds += s;
  }

  void add_broken(const std::string& sequence, const std::string& fault, const std::string& log) {
    write_record();
    results::write_log(summary_.folder, sequence, log + "airtruth: the detector " + fault + "\n");
    const std::lock_guard lock(mutex_);
    ++summary_.broken;
    airtruth::warn(options_.warn,
                   fmt::format("{} on {}: the detector {}", detector_.name, sequence, fault));
  }

  // Writes the COCO results of a set of which every sequence is there.
  void finish(std::span<const results::ExpectedSequence> set) const {
    const bool is_whole = std::ranges::all_of(set, [&](const results::ExpectedSequence& one) {
      return results::has_sequence(summary_.folder, one.name);
    });
    if (!is_whole || fs::exists(coco_file_)) return;
    results::write_coco_results(coco_file_, summary_.folder, set);
  }

  const std::string& command() const { return detector_.command; }
  const DetectSummary& summary() const { return summary_; }

 private:
  bool is_open() const { return is_record_of(summary_.folder / kRecord, settings_); }

  // Before the first result: a run that makes none must not refuse the next for its settings.
  void write_record() {
    const std::lock_guard lock(mutex_);
    if (is_open()) return;
    Json record = settings_;
    record["name"] = detector_.name;
    record["format"] = "airtruth detections 1";
    record["version"] = kVersion;
    write_file(summary_.folder / kRecord, record.dump(1) + "\n");
  }

  DetectorName detector_;
  const DetectOptions& options_;
  Json settings_;
  std::mutex mutex_;
  DetectSummary summary_;
  fs::path coco_file_;
  std::optional<RunLock> lock_;
};

// The share of a box's pixels, those with their centre in it, that the own aircraft hides.
double hidden_share(const Box& box, const image::Mask& own_aircraft) {
  const auto from = [](double edge) {
    return std::max(0, static_cast<int>(std::ceil(edge - 0.5)));
  };
  const int right = std::min(own_aircraft.width, from(box.right()));
  const int bottom = std::min(own_aircraft.height, from(box.bottom()));
  int hidden = 0, all = 0;
  for (int y = from(box.y); y < bottom; ++y)
    for (int x = from(box.x); x < right; ++x, ++all) hidden += own_aircraft.is_free(x, y) ? 0 : 1;
  return all > 0 ? double(hidden) / all : 0;
}

// One detector within one sequence.
class Following {
 public:
  // `begun` is what is known of the detections before there are any.
  Following(DetectorResults& results,
            std::string part,
            results::SequenceDetections begun,
            const DetectOptions& run,
            int threads)
      : results_(&results),
        part_(std::move(part)),
        run_(&run),
        detector_(make_detector(results.command(), run, threads)),
        found_(std::move(begun)) {}

  bool needs_motion() const { return run_->association || detector_->needs_motion(); }
  bool is_broken() const { return !detector_; }

  void begin(const detector::SequenceInput& sequence) {
    found_.width = sequence.width;
    found_.height = sequence.height;
    guarded([&] {
      detector_->begin(sequence);
      if (run_->mask_results && !detector_->leaves_out_own_aircraft())
        own_aircraft_ = sequence.own_aircraft;
      if (!run_->association) return;
      association::AssociationOptions association = *run_->association;
      if (!association.confident_score) association.confident_score = detector_->confident_score();
      associator_.emplace(association);
      associator_->begin(sequence);
    });
  }

  void detect(const detector::FrameInput& frame) {
    guarded([&] {
      const Stopwatch watch;
      std::vector<results::Detection> detections = detector_->detect(frame);
      const double took_s = watch.seconds();
      for (results::Detection& detection : detections) {
        // What is judged is what is written: rounding can carry a box over the picture's edge.
        detection.box_px = results::as_written(detection.box_px);
        if (const auto fault = results::fault_of(detection, found_.width, found_.height))
          throw process::Failure(
              fmt::format("answered what is no detection for frame {}: {}", frame.index, *fault));
      }
      results::sort_by_score(detections);
      if (own_aircraft_)
        std::erase_if(detections, [&](const results::Detection& d) {
          return hidden_share(d.box_px, *own_aircraft_) > 0.5;
        });
      if (run_->min_score)
        std::erase_if(detections,
                      [&](const results::Detection& d) { return d.score < *run_->min_score; });
      if (std::ssize(detections) > run_->max_per_frame)
        detections.resize(static_cast<std::size_t>(run_->max_per_frame));
      if (associator_) detections = associator_->step(frame, std::move(detections));
      found_.frames.push_back(std::move(detections));
      found_.seconds.push_back(took_s);
    });
  }

  void finish() {
    if (!is_broken()) results_->add(part_, found_, detector_->log());
  }

 private:
  void guarded(const auto& work) {
    if (is_broken()) return;
    try {
      work();
    } catch (const process::Failure& error) {
      const std::string log = detector_->log();
      detector_.reset();
      results_->add_broken(found_.name, error.what(), log);
    }
  }

  DetectorResults* results_;
  std::string part_;
  const DetectOptions* run_;
  std::unique_ptr<detector::Detector> detector_;
  std::shared_ptr<const image::Mask> own_aircraft_;
  std::optional<association::Associator> associator_;
  results::SequenceDetections found_;
};

class DetectorRun {
 public:
  DetectorRun(const fs::path& out, const DetectOptions& options)
      : options_(options), threads_(std::max(1, usable_processors() / options.jobs)) {
    if (options.association) association::validate(*options.association);
    if (options.min_score && !std::isfinite(*options.min_score))
      throw Error(fmt::format("--min-score is {}; expected a finite number", *options.min_score));
    std::set<std::string> names;
    for (const std::string& text : options.detectors) {
      require_utf8(text);
      const DetectorName named = named_detector(text);
      if (!names.insert(named.name).second)
        throw Error("two detectors are named '" + named.name +
                    "'; expected NAME=DETECTOR with a name for each");
      // An Error for what is no detector, before anything is made.
      const auto detector = make_detector(named.command, options, threads_);
      sees_own_aircraft_ |= !detector->leaves_out_own_aircraft();
      results_.push_back(std::make_unique<DetectorResults>(named, out, options));
    }
    if (options.mask_results && !sees_own_aircraft_)
      throw Error("--mask-results has no effect without a network or a program; leave it out");
  }

  std::vector<DetectSummary> over(const labelled::LabelledSet& set) {
    std::vector<std::string> names;
    for (const std::string& name : set.names())
      if (matches(options_.only, name)) names.push_back(name);
    if (names.empty()) throw Error("no sequence fits '" + options_.only + "'");
    expect_effects(set);
    open("detections.json", names);
    std::vector<DetectionClip> backgrounds;
    if (options_.backgrounds) backgrounds = backgrounds_of(set, names, inputs_, options_.warn);
    in_parallel(names.size() + backgrounds.size(), options_, [&](std::size_t i) {
      if (i < names.size())
        return over("", names[i], set.sha256_of(names[i]), [&] { return clip_of(set, names[i]); });
      const DetectionClip& background = backgrounds[i - names.size()];
      over(kBackgrounds, background.name, sha256_of(background), [&] { return background; });
    });
    return summaries(sequences_of(set));
  }

  std::vector<DetectSummary> over(const fs::path& video) {
    source_ = absolute_path(video).string();
    require_utf8(source_);
    const DetectionClip clip = clip_of(video);
    expect_mask(options_.mask.has_value());
    // Errors come before anything is made.
    video::expect_rate(
        video, ClipFrames(with_facts(clip), false, options_.warn).info(), options_.frame_rate_hz);
    open(clip.name + ".detections.json", {clip.name});
    over(
        "", clip.name, sha256_of(clip), [&] { return clip; }, options_.progress);
    return summaries(std::vector<results::ExpectedSequence>{{clip.name, 0, 0, 0}});
  }

 private:
  using Progress = std::function<void(std::int64_t, std::int64_t)>;

  void open(const std::string& coco_name, const std::vector<std::string>& names) const {
    for (const std::string& name : names)
      if (const std::string file = name + ".json"; file == kRecord || file == coco_name)
        throw Error(
            fmt::format("the results of '{}' and of all sequences have one file, {}; "
                        "expected another name of the sequence or the video",
                        name,
                        file));
    for (const auto& results : results_) results->open(coco_name);
  }

  void expect_mask(bool has_mask) const {
    if (options_.mask_results && !has_mask)
      throw Error("--mask-results has no effect without a mask; leave it out");
  }

  // Throws Error for a fact that every sequence of the whole set states itself, of which --only may
  // take a few at a time: the results would be recorded as of it.
  void expect_effects(const labelled::LabelledSet& set) const {
    const auto has = [&](const auto& fits) {
      return std::ranges::any_of(set.names(),
                                 [&](const std::string& name) { return fits(clip_of(set, name)); });
    };
    const auto has_no_lens = [](const DetectionClip& clip) { return !clip.lens; };
    const auto has_no_rate = [](const DetectionClip& clip) {
      return !clip.reading.picture_rate_hz &&
             video::Reader(clip.media, {.threads = 1}).info().is_of_pictures;
    };
    const auto has_mask = [](const DetectionClip& clip) { return clip.own_aircraft.has_value(); };
    if (options_.lens && !has(has_no_lens))
      throw Error("--lens has no effect over sequences that state their lens; leave it out");
    if (options_.frame_rate_hz && !has(has_no_rate))
      throw Error("--frame-rate has no effect over sequences that state their rate; leave it out");
    if (options_.mask_results) expect_mask(options_.mask || has(has_mask));
  }

  // The lens and the mask that the user states, for a clip that states none.
  DetectionClip with_facts(DetectionClip clip) {
    if (!options_.masks) clip.own_aircraft.reset();
    if (clip.own_aircraft) {
      const auto found = replay::find_input(*clip.own_aircraft, clip.sequence, inputs_);
      if (!found || !fs::exists(*found)) {
        const std::string why = found ? "not there" : "another file now (its SHA-256 differs)";
        airtruth::warn(options_.warn,
                       clip.own_aircraft->string() + ": the mask of '" + clip.name + "' is " + why +
                           "; the own aircraft is looked at as well");
      }
      clip.own_aircraft = found && fs::exists(*found) ? found : std::nullopt;
    }
    if (!clip.own_aircraft && options_.masks) clip.own_aircraft = options_.mask;
    if (!clip.reading.picture_rate_hz) clip.reading.picture_rate_hz = options_.frame_rate_hz;
    if (clip.lens || !options_.lens) return clip;
    const video::StreamInfo info = video::Reader(clip.media, {.threads = 1}).info();
    clip.lens = lens::read_calibration(*options_.lens, {info.width, info.height}, options_.warn);
    return clip;
  }

  std::string sha256_of(const DetectionClip& clip) {
    return setup::sha256_of_video(clip.media, inputs_);
  }

  // All detectors that have not done so yet, over one clip.
  void over(const std::string& part,
            const std::string& name,
            const std::string& sha256,
            const auto& make_clip,
            const Progress& progress = {}) {
    results::SequenceDetections begun;
    begun.name = name;
    begun.source = source_;
    begun.stated_rate_hz = options_.frame_rate_hz;
    begun.source_sha256 = sha256;
    std::vector<Following> detectors;
    for (const auto& results : results_)
      if (!results->keeps(part, begun))
        detectors.emplace_back(*results, part, begun, options_, threads_);
    if (detectors.empty()) return;
    const DetectionClip clip = with_facts(make_clip());
    const bool with_motion = std::ranges::any_of(detectors, &Following::needs_motion);
    ClipFrames frames(clip, with_motion, options_.warn);
    for (Following& detector : detectors) detector.begin(frames.sequence());
    while (const auto frame = frames.next()) {
      if (options_.stop.stop_requested()) throw Interrupted();
      for (Following& detector : detectors) detector.detect(*frame);
      if (std::ranges::all_of(detectors, &Following::is_broken)) break;
      if (progress) progress(frame->index + 1, std::max(frame->index + 1, frames.count_estimate()));
    }
    for (Following& detector : detectors) detector.finish();
  }

  std::vector<DetectSummary> summaries(std::span<const results::ExpectedSequence> set) const {
    std::vector<DetectSummary> all;
    for (const auto& results : results_) {
      results->finish(set);
      all.push_back(results->summary());
    }
    return all;
  }

  const DetectOptions& options_;
  int threads_;                     // of a network
  bool sees_own_aircraft_ = false;  // one of the detectors at least
  std::string source_;              // of a video; "" for a set
  setup::SharedInputs inputs_;
  std::vector<std::unique_ptr<DetectorResults>> results_;
};

}  // namespace

std::vector<std::string> detector_names() {
  std::vector<std::string> names = classical::classical_names();
  names.insert(names.begin(), kShippedDetector);
  return names;
}

std::vector<std::string> detector_forms() {
  return {"onnx:MODEL.onnx for a network (docs/formats/detector-model.md)",
          "exec:COMMAND for a program that speaks docs/detector-protocol.md"};
}

bool is_program(const std::string& detector) {
  return named_detector(detector).command.starts_with(kExec);
}

bool is_set(const fs::path& source) {
  if (!fs::exists(source) && source.string().find('%') == std::string::npos)
    throw Error("does not exist", {source.string()});
  return fs::is_directory(source) &&
         (fs::exists(source / "dataset.json") || fs::exists(source / "sequences") ||
          !sequences::sequence_folders(source).names.empty());
}

std::vector<DetectSummary> detect(const fs::path& source,
                                  const fs::path& out,
                                  const DetectOptions& options) {
  DetectorRun running(out, options);
  if (is_set(source)) return running.over(labelled::LabelledSet(source));
  return running.over(source);
}

}  // namespace airtruth::runs
