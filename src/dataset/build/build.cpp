// SPDX-License-Identifier: Apache-2.0
#include "dataset/build/build.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <exception>
#include <iterator>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <airtruth/version.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "dataset/build/inputs.h"
#include "dataset/catalogue/encounter_rule.h"
#include "dataset/catalogue/folder.h"
#include "foundation/base/error.h"
#include "foundation/base/file_state.h"
#include "foundation/base/files.h"
#include "foundation/base/in_parallel.h"
#include "foundation/base/names.h"
#include "foundation/base/stopwatch.h"
#include "foundation/json/json_object.h"
#include "foundation/json/or_null.h"
#include "sequence/pipeline/render.h"
#include "sequence/pipeline/resolved_scene.h"
#include "sequence/replay/recorded_inputs.h"
#include "sequence/setup/shared_inputs.h"

namespace airtruth::build {
namespace {

using Json = nlohmann::ordered_json;

// Sequences that are put in the order of their aircraft at a time: enough for dozens of each of a
// hundred types, in bounded memory.
constexpr std::size_t kMaxOrdered = 4096;

// Warnings that are remembered, in bounded memory.
constexpr std::size_t kMaxSaid = 4096;

// Every message about a file that cannot be written has the system's words for the reason. These
// reasons are the same for the next sequence.
bool is_of_a_full_disk(const std::exception& error) {
  const std::string_view what = error.what();
  return std::ranges::any_of(std::array{ENOSPC, EDQUOT, EROFS}, [&](int reason) {
    return what.find(std::generic_category().message(reason)) != std::string_view::npos;
  });
}

// Of a sequence of [[encounter_model]] the aircraft that it most likely has.
std::string first_aircraft(const catalogue::Item& item) {
  if (item.encounter_rule != nullptr)
    return likely_aircraft(*item.encounter_rule, item.index_in_rule);
  return item.scene.intruders.empty() ? "" : item.scene.intruders.front().aircraft;
}

// One build: it makes its share of the catalogue on several threads.
class Work {
 public:
  Work(const catalogue::Catalogue& catalogue,
       const catalogue::Folder& folder,
       const BuildOptions& options)
      : catalogue_(catalogue), folder_(folder), options_(options), expansion_(catalogue) {
    jobs_ = options.jobs > 0 ? options.jobs : usable_processors();
  }

  BuildSummary run() {
    count();
    jobs_ = static_cast<int>(std::clamp<std::int64_t>(std::ssize(missing_), 1, jobs_));
    prepare_backgrounds();
    make_missing();
    if (repeated_ > 0)
      warn(options_.warn,
           fmt::format("{} more warnings say the same of other sequences over the same backgrounds",
                       repeated_));
    std::ranges::sort(summary_.failures, {}, &Failure::name);
    return summary_;
  }

 private:
  // Collects the work, the backgrounds that it needs, and how many of their frames. Of kMaxOrdered
  // sequences those with the same aircraft follow one another, so that it is loaded once for them.
  void count() {
    needed_.assign(catalogue_.backgrounds.size(), std::nullopt);
    is_used_.assign(catalogue_.backgrounds.size(), false);
    kept_.resize(catalogue_.backgrounds.size());
    std::vector<std::pair<std::string, std::int64_t>> ordered;
    const auto put_in_order = [&] {
      std::ranges::sort(ordered);
      for (const auto& [aircraft, index] : ordered) missing_.push_back(index);
      ordered.clear();
    };
    for (std::int64_t i = options_.share; i < expansion_.size(); i += options_.shares) {
      const catalogue::Item item = expansion_.at(i);
      if (!matches(options_.only, item.name)) continue;
      ++total_;
      if (folder_.holds(item)) {
        ++summary_.kept;
        auto& kept = kept_[item.background];
        if (kept.empty()) kept = folder_.sequence(item);
        continue;
      }
      ordered.emplace_back(first_aircraft(item), i);
      if (ordered.size() == kMaxOrdered) put_in_order();
      is_used_[item.background] = true;
      // A clip that begins at a random frame is measured from its own first frame, when it is made.
      if (item.has_random_start()) continue;
      auto& needed = needed_[item.background];
      needed =
          item.frame_count == 0 || needed == 0 ? 0 : std::max(needed.value_or(1), item.frame_count);
    }
    put_in_order();
    if (total_ == 0 && options_.only != "*")
      throw Error("no sequence of the catalogue fits '" + options_.only + "'");
  }

  void prepare_backgrounds() {
    files_.resize(catalogue_.backgrounds.size());
    for (std::size_t i = 0; i < files_.size(); ++i) {
      if (!is_used_[i]) {
        check_inputs(i);
        continue;
      }
      if (options_.stop.stop_requested()) throw Interrupted();
      const WaitingLock lock(
          folder_.backgrounds() / ("." + catalogue_.backgrounds[i].name + ".lock"), options_.stop);
      files_[i] = prepare(catalogue_.backgrounds[i], folder_, options_);
      check_inputs(i);
      measure(i);
    }
  }

  // A sequence that was made of other files than are there now and those that follow would be a
  // mixed set. Of a record, the first input is its background, which may have another name by now;
  // the files of a flight lie in the set's own folder, wherever that was when they were made.
  void check_inputs(std::size_t i) const {
    const fs::path& kept = kept_[i];
    if (kept.empty()) return;
    const catalogue::Background& background = catalogue_.backgrounds[i];
    const auto* given = std::get_if<fs::path>(&background.source);
    const catalogue::BackgroundFiles flown = files_of_flight(background, folder_);
    const fs::path& video = given != nullptr ? *given : flown.video;
    const JsonDocument record(kept / "sequence.json");
    const auto made = scene::parse_scene(record.text("scene_toml"), kept / "sequence.json");
    bool is_background = true;
    for (const JsonObject& input : record.objects("inputs")) {
      fs::path file = input.text("name");
      if (given == nullptr && made.background.mask == file) file = *flown.mask;
      if (std::exchange(is_background, false)) file = video;
      if (replay::is_another(file, input.text("sha256"), *shared_))
        throw Error(fmt::format("is another file than the one that '{}', which is kept, was made "
                                "of (its SHA-256 differs); expected that file, or another folder "
                                "for the set",
                                kept.filename().string()),
                    {file.string()});
    }
    // --background leaves masks out. A flight brings its own.
    const bool has_mask = given == nullptr || background.mask;
    if (made.background.mask.has_value() != has_mask ||
        made.occluders.size() != background.occluders.size())
      throw Error(
          fmt::format("has not the masks with which '{}', which is kept, was made; expected "
                      "--background for all sequences of the set or for none, or another "
                      "folder for it",
                      kept.filename().string()),
          {video.string()});
  }

  pipeline::Options run_options() const {
    return {
        .cache = folder_.cache(), .shared = shared_, .warn = options_.warn, .stop = options_.stop};
  }

  // Measures the motion and the camera of a background once for all the sequences over it.
  void measure(std::size_t i) {
    scene::Scene scene = catalogue::scene_over(catalogue_, i);
    scene.background.video = files_[i].video;
    scene.background.mask = files_[i].mask;
    scene.background.first_frame = catalogue_.backgrounds[i].first_frame;
    auto& frames = scene.background.frame_count;
    frames = catalogue_.backgrounds[i].frame_count;
    if (needed_[i].value_or(0) > 0) frames = std::min(*needed_[i], frames.value_or(*needed_[i]));
    pipeline::Options how = run_options();
    const std::string& name = catalogue_.backgrounds[i].name;
    std::string stage = "measuring the motion of " + name;
    how.progress = [&](const pipeline::Progress& p) {
      report({p.frames_done, p.frames_total, stage});
    };
    if (needed_[i]) pipeline::measure_ahead(scene, how);
    stage = "measuring the camera of " + name;
    try {
      if (pipeline::needs_calibration(scene)) pipeline::calibration_of(scene, how);
      // Each sequence over this background reports the error; the others are made.
    } catch (const Error&) {
    }
  }

  void make_missing() {
    in_parallel(
        missing_.size(),
        jobs_,
        [&](std::size_t i) { make(expansion_.at(missing_[i])); },
        {},
        options_.stop);
  }

  void make(catalogue::Item item) {
    pipeline::Options how = run_options();
    how.threads = std::max(1, usable_processors() / jobs_);
    how.warn = [&](const std::string& message) {
      const std::lock_guard lock(mutex_);
      if (is_said(item.background, message))
        ++repeated_;
      else
        warn(options_.warn, item.name + ": " + message);
    };
    try {
      catalogue::place(item, catalogue_, files_[item.background], shared_.get());
      // A numbered folder is made here and not by the run, which removes an empty one on failure.
      const fs::path place = folder_.sequence(item).parent_path();
      fs::create_directories(place);
      const pipeline::Summary done = pipeline::render(item.scene, place, how);
      const std::lock_guard lock(mutex_);
      ++summary_.made;
      summary_.frames += done.frames;
    } catch (const Interrupted&) {
      return;
    } catch (const std::exception& error) {
      if (is_of_a_full_disk(error)) throw;
      const std::lock_guard lock(mutex_);
      summary_.failures.push_back({item.name, error.what()});
    }
    const std::lock_guard lock(mutex_);
    const auto failed = static_cast<std::int64_t>(summary_.failures.size());
    if (options_.progress)
      options_.progress({summary_.made + summary_.kept + failed, total_, "building"});
  }

  // What a background's camera does not tell is the same for each sequence over it, and said once.
  bool is_said(std::size_t background, const std::string& message) {
    const auto said = std::pair(background, message);
    if (said_.contains(said)) return true;
    if (said_.size() < kMaxSaid) said_.insert(said);
    return false;
  }

  void report(const BuildProgress& progress) {
    const std::lock_guard lock(mutex_);
    if (options_.progress) options_.progress(progress);
  }

  const catalogue::Catalogue& catalogue_;
  const catalogue::Folder& folder_;
  const BuildOptions& options_;
  catalogue::Expansion expansion_;
  int jobs_ = 1;
  std::int64_t total_ = 0;
  std::vector<std::int64_t> missing_;  // numbers of sequences, in the order of the work
  std::vector<bool> is_used_;          // by background
  std::vector<fs::path> kept_;         // by background: its first whole sequence, if any
  // By background: the frames whose motion is measured ahead; 0 means all, empty means none.
  std::vector<std::optional<std::int64_t>> needed_;
  std::vector<catalogue::BackgroundFiles> files_;
  // Aircraft are the same in every set: their ambient occlusion is kept where `render` keeps it.
  std::shared_ptr<setup::SharedInputs> shared_ = pipeline::inputs_of({});
  std::mutex mutex_;
  std::set<std::pair<std::size_t, std::string>> said_;  // warnings, by background
  std::int64_t repeated_ = 0;                           // warnings that were said before
  BuildSummary summary_;
};

// The failures that a file lists of sequences that a build of those that fit `only` does not look
// at.
std::vector<Failure> others_of(const fs::path& file, const std::string& only) {
  std::vector<Failure> others;
  std::error_code ignored;
  std::istringstream lines(fs::exists(file, ignored) ? read_file(file) : "");
  for (std::string line; std::getline(lines, line);) {
    const Json failure = Json::parse(line, nullptr, false);
    if (failure.is_object() && !matches(only, failure.value("name", "")))
      others.push_back({failure.value("name", ""), failure.value("reason", "")});
  }
  return others;
}

// Writes one line per failure. The file is removed where nothing failed.
void write_failures(const fs::path& file, const std::string& only, std::vector<Failure> failures) {
  std::ranges::move(others_of(file, only), std::back_inserter(failures));
  std::ranges::sort(failures, {}, &Failure::name);
  std::error_code ignored;
  if (failures.empty()) {
    fs::remove(file, ignored);
    return;
  }
  std::string text;
  for (const Failure& failure : failures)
    text += Json{{"name", failure.name}, {"reason", failure.reason}}.dump(
                -1, ' ', false, Json::error_handler_t::replace) +
            "\n";
  write_file(file, text);
}

constexpr std::int64_t kLinesInAFile = 10'000;  // chosen

Json manifest_line(const catalogue::Folder& folder, const catalogue::Item& item) {
  const JsonDocument record(folder.sequence(item) / "sequence.json");
  const JsonObject summary = record.object("summary");
  Json line = {
      {"index", item.index},
      {"name", item.name},
      {"folder", fs::relative(folder.sequence(item), folder.root).string()},
      {"frames", summary.count("frames")},
      {"frames_with_an_intruder_visible", summary.count("frames_with_an_intruder_visible")}};
  if (record.has("weather")) line["weather"] = record.value("weather");
  line["weight"] = or_null(record.maybe_number("weight"));
  line["outputs"] = record.value("outputs");
  return line;
}

// Writes manifest/*.jsonl and, last, dataset.json. Returns false and writes neither where a
// sequence of the catalogue is missing. Memory does not grow with the number of sequences. The
// bytes do not depend on the number of workers.
bool write_manifest(const catalogue::Catalogue& catalogue, const catalogue::Folder& folder) {
  const catalogue::Expansion expansion(catalogue);
  for (std::int64_t i = 0; i < expansion.size(); ++i)
    if (!folder.holds(expansion.at(i))) return false;
  fs::create_directories(folder.manifest());
  Json files = Json::array();
  std::int64_t frames = 0;
  for (std::int64_t first = 0; first < expansion.size(); first += kLinesInAFile) {
    std::string text;
    for (std::int64_t i = first; i < std::min(expansion.size(), first + kLinesInAFile); ++i) {
      const Json line = manifest_line(folder, expansion.at(i));
      frames += line.at("frames").get<std::int64_t>();
      text += line.dump() + "\n";
    }
    const fs::path file = folder.manifest() / fmt::format("{:05}.jsonl", first / kLinesInAFile);
    write_file(file, text);
    files.push_back(
        {{"name", fs::relative(file, folder.root).string()}, {"sha256", sha256_of(text)}});
  }
  const Json record = {{"format", "airtruth dataset 1"},
                       {"version", kVersion},
                       {"name", catalogue.name},
                       {"seed", catalogue.seed},
                       {"catalogue_sha256", sha256_of(catalogue.text)},
                       {"sequences", expansion.size()},
                       {"frames", frames},
                       {"manifest", files}};
  write_file(folder.record(), record.dump(2) + "\n");
  // What workers and earlier builds could not make is there by now.
  for (const fs::path& file : entries(folder.root))
    if (matches("failed*.jsonl", file.filename().string())) fs::remove(file);
  return true;
}

}  // namespace

BuildSummary build_set(const catalogue::Catalogue& given,
                       const fs::path& out,
                       const BuildOptions& options) {
  check(options.share >= 0 && options.share < options.shares, "a share is one of the shares");
  const Stopwatch watch;
  // Sequence records hold full background paths, because virtual flights lie in the data set.
  require_utf8(fs::absolute(out));
  for (const auto& [name, video] : options.videos) require_utf8(fs::absolute(video));
  const catalogue::Catalogue catalogue = with_videos(given, options.videos);
  check_sources(catalogue);
  const catalogue::Folder folder = catalogue::open_folder(catalogue, out, options.max_in_a_folder);
  const RunLock lock = catalogue::lock_of(
      folder, options.shares > 1 ? Sharing::kShared : Sharing::kAlone, options.warn);
  BuildSummary summary = Work(catalogue, folder, options).run();
  write_failures(folder.failed(options.share, options.shares), options.only, summary.failures);
  // With several workers none can know that it is the last, so `finish` writes their manifest.
  if (options.shares == 1) summary.complete = write_manifest(catalogue, folder);
  summary.seconds = watch.seconds();
  return summary;
}

bool finish(const fs::path& root) {
  const catalogue::Folder folder{root};
  const catalogue::Catalogue catalogue = catalogue::catalogue_of(folder);
  const RunLock lock = catalogue::lock_of(folder, Sharing::kAlone);
  return write_manifest(catalogue, folder);
}

}  // namespace airtruth::build
