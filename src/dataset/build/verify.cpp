// SPDX-License-Identifier: Apache-2.0
#include "dataset/build/verify.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <airtruth/labels.h>
#include <fcntl.h>
#include <fmt/format.h>

#include "camera/lens/lens.h"
#include "dataset/catalogue/expand.h"
#include "dataset/sequences/layout.h"
#include "foundation/base/descriptor.h"
#include "foundation/base/error.h"
#include "foundation/base/file_state.h"
#include "foundation/base/files.h"
#include "foundation/base/in_parallel.h"
#include "foundation/base/median.h"
#include "foundation/image/contrast_to_noise.h"
#include "foundation/json/json_object.h"
#include "labels/annotation/truth.h"
#include "labels/exchange/text.h"
#include "picture/composite/cover.h"
#include "picture/video/reader.h"
#include "picture/video/writer.h"
#include "sequence/insertion/masks.h"
#include "sequence/pipeline/encounter_record.h"
#include "sequence/replay/finished.h"
#include "sequence/replay/recorded_inputs.h"
#include "sequence/setup/shared_inputs.h"

namespace airtruth::build {
namespace {

// Of the missing sequences: what a terminal shows, and what stands beside other faults.
constexpr std::int64_t kMaxNamed = 100;
constexpr std::int64_t kMaxMissingFaults = 10;
// Results that wait for their place in the order, so that memory does not grow with the set.
constexpr std::int64_t kMaxHeldResults = 4096;

// Contrasts below this are mostly noise, which a codec changes; fewer frames have no sure median;
// and what no quality reaches: 2.65 is the median of a clip of 40 frames at quality 44.
constexpr double kSureContrast = 3;
constexpr std::ptrdiff_t kMostlySeen = 5;
constexpr double kCodecFactor = 10;

// Of the lock of a set that cannot be written here nothing but another's hold on it is of interest.
bool is_at_work(const catalogue::Folder& folder) {
  const fs::path file = folder.lock();
  Descriptor lock(::open(file.c_str(), O_RDWR | O_CLOEXEC));  // NFS locks what is open for writing
  if (!lock.is_open()) lock.reset(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
  try {
    return lock.is_open() && try_lock(lock.get(), file) == Lock::kBusy;
  } catch (const Error&) {
    return false;
  }
}

// A record may name only files below its own folder, whatever links lie between.
bool is_below(const fs::path& folder, const fs::path& name) {
  const fs::path relative =
      fs::weakly_canonical(folder / name).lexically_relative(fs::weakly_canonical(folder));
  return !relative.empty() && *relative.begin() != "..";
}

// A sequence and where it lies.
struct Place {
  std::string name;
  fs::path folder;
};

// Verifies one sequence of a data set.
class Check {
 public:
  Check(Place place, const VerifyOptions& options, setup::SharedInputs& inputs)
      : name_(std::move(place.name)),
        folder_(std::move(place.folder)),
        options_(options),
        inputs_(inputs) {}

  VerifyResult run() {
    ++result_.sequences;
    if (fs::exists(folder_ / "sequence.json")) {
      whole();
    } else {
      ++result_.not_there;
      fault("is not there");
    }
    return std::move(result_);
  }

 private:
  void whole() {
    try {
      const JsonDocument record(folder_ / "sequence.json");
      if (fs::exists(folder_ / sequences::kLabels)) return labelled(record);
      files(record);
      replay::Finished finished = replay::open_finished(folder_);
      truth(finished);
      if (options_.deep_every == 0 || !has_its_inputs()) return;
      finished.scene = replay::scene_as_made(finished, inputs_);
      deep(finished);
    } catch (const Error& error) {
      fault(error.what());
    }
  }

  void fault(const std::string& what) { result_.faults.push_back(name_ + ": " + what); }

  void files(const JsonObject& record) {
    for (const JsonObject& input : record.objects("inputs"))
      result_.inputs[input.text("name")] = {input.text("sha256"), name_};
    std::set<std::string> known = {"sequence.json"};
    for (const JsonObject& output : record.objects("outputs")) {
      const std::string name = output.text("name");
      known.insert(name);
      const fs::path file = folder_ / name;
      if (!is_below(folder_, name))
        fault("'" + name.substr(0, 80) + "' is outside of this sequence");
      else if (!fs::exists(file))
        fault(name + " is missing");
      else if (sha256_of_file(file) != output.text("sha256"))
        fault(name + " is not as it was written (its SHA-256 differs)");
    }
    for (const auto& entry : fs::recursive_directory_iterator(folder_))
      if (entry.is_regular_file() && !known.contains(fs::relative(entry.path(), folder_).string()))
        fault(entry.path().filename().string() + " is not of this sequence");
  }

  // Of a clip that was labelled elsewhere and imported, its pictures and its labels are all that is
  // known.
  void labelled(const JsonObject& record) {
    const exchange::Clip clip = exchange::read_labels(folder_ / sequences::kLabels);
    std::int64_t labels = 0;
    for (const exchange::LabelledFrame& frame : clip.frames)
      for (const exchange::Label& label : frame.labels) {
        ++labels;
        if (!exchange::is_in_picture(label.box_px, clip.width, clip.height))
          fault(fmt::format("frame {}, track {}: its box is empty or outside of the picture",
                            frame.frame,
                            label.track));
      }
    const std::int64_t frames = std::ssize(clip.frames);
    const std::int64_t stated_frames = record.count("frames");
    const std::int64_t stated_labels = record.count("labels");
    if (frames != stated_frames || labels != stated_labels)
      fault(fmt::format(
          "labels.jsonl has {} frames and {} labels, and sequence.json states {} and {}",
          frames,
          labels,
          stated_frames,
          stated_labels));
    result_.frames += frames;
    if (!clip.media.empty()) pictures(clip);
  }

  void pictures(const exchange::Clip& clip) {
    video::Reader reader(clip.media, {.threads = 1});
    const int width = reader.info().width;
    const int height = reader.info().height;
    const std::string media = clip.media.string();
    if (clip.width > 0 && (width != clip.width || height != clip.height))
      fault(fmt::format("{} is of {}x{}, and labels.jsonl of {}x{}",
                        media,
                        width,
                        height,
                        clip.width,
                        clip.height));
    std::int64_t frames = 0;
    while (reader.next()) {
      if (options_.stop.stop_requested()) throw Interrupted();
      ++frames;
    }
    if (!clip.frames.empty() && clip.frames.back().frame >= frames)
      fault(fmt::format("{} has {} frames, and labels.jsonl goes on to frame {}",
                        media,
                        frames,
                        clip.frames.back().frame));
  }

  void truth(const replay::Finished& finished) {
    video::Reader reader(finished.video, {.threads = 1});
    const int width = reader.info().width;
    const int height = reader.info().height;
    std::size_t frames = 0;
    while (const auto frame = reader.next()) {
      if (options_.stop.stop_requested()) throw Interrupted();
      if (frames < finished.truth.frames.size())
        contrast(finished, finished.truth.frames[frames], frame->picture);
      ++frames;
    }
    if (frames != finished.truth.frames.size())
      fault("the video has " + std::to_string(frames) + " frames and truth.jsonl " +
            std::to_string(finished.truth.frames.size()));
    contrast_of_all();
    const lens::Lens lens = lens::lens_of(finished.truth.lens);
    for (const annotation::Frame& frame : finished.truth.frames)
      for (const annotation::Intruder& intruder : frame.intruders) {
        box(frame, intruder, width, height);
        view(frame, intruder, lens);
        if (finished.scene->output.masks) mask(finished, frame, intruder);
      }
    result_.frames += static_cast<std::int64_t>(finished.truth.frames.size());
  }

  // Of other inputs another truth follows, which says nothing of the sequence. What is missing is
  // an error of opening it.
  bool has_its_inputs() {
    bool has = true;
    for (const auto& [name, input] : result_.inputs) {
      if (replay::find_input(name, folder_, inputs_)) continue;
      has = false;
      fault("was made of another " + name +
            " than is there now (its SHA-256 differs); it is not drawn anew");
    }
    return has;
  }

  void deep(const replay::Finished& finished) {
    const auto recomposed = replay::recompose(finished, options_.deep_every, options_.stop);
    result_.recomposed += recomposed.compared;
    for (const std::string& what : recomposed.faults) fault(what);
  }

  static std::string words_of(const annotation::Frame& frame,
                              const annotation::Intruder& intruder) {
    return fmt::format("frame {}, {}: ", frame.frame, intruder.id);
  }

  void view(const annotation::Frame& frame,
            const annotation::Intruder& intruder,
            const lens::Lens& lens) {
    result_.in_view += annotation::is_in_view(frame, intruder, lens) ? 1 : 0;
    if (!annotation::lacks_box(frame, intruder, lens)) return;
    ++result_.in_view_without_box;
    fault(words_of(frame, intruder) + "in view by its position, and without a box");
  }

  void box(const annotation::Frame& frame,
           const annotation::Intruder& intruder,
           int width,
           int height) {
    for (const auto& [what, box] : {std::pair("visible", intruder.visible_box_px),
                                    std::pair("covered", intruder.covered_box_px)})
      if (box && intersection({0, 0, width, height}, *box) != *box)
        fault(words_of(frame, intruder) + "its " + what + " box reaches out of the frame");
  }

  // The stated contrast to noise is of the picture before it is encoded; that of the video is
  // measured here. A codec with loss takes noise away and adds its own: there the median decides.
  void contrast(const replay::Finished& finished,
                const annotation::Frame& frame,
                const image::Picture& picture) {
    const bool is_lossless = finished.scene->output.video == video::Format::kMkv;
    for (const annotation::Intruder& intruder : frame.intruders) {
      const auto box = annotation::box_to_show(intruder);
      if (!box || !intruder.contrast_to_noise) continue;
      const auto measured = image::contrast_to_noise(picture, *box);
      if (!measured ||
          (is_lossless && !(std::abs(*measured - *intruder.contrast_to_noise) <= 1e-9 * *measured)))
        fault(words_of(frame, intruder) +
              fmt::format("a contrast to noise of {:.3g}, and the video shows {:.3g}",
                          *intruder.contrast_to_noise,
                          measured.value_or(0)));
      else if (*intruder.contrast_to_noise >= kSureContrast && *measured > 0)
        contrast_ratios_.push_back(*intruder.contrast_to_noise / *measured);
    }
  }

  void contrast_of_all() {
    if (std::ssize(contrast_ratios_) < kMostlySeen) return;
    const double ratio = median(contrast_ratios_);
    if (ratio > kCodecFactor || ratio < 1 / kCodecFactor)
      fault(fmt::format("its contrasts to noise are {:.3g} times those of the video, in the median",
                        ratio));
  }

  // Every visible intruder has a mask, no other mask exists, and the mask's pixels are those of the
  // covered box.
  void mask(const replay::Finished& finished,
            const annotation::Frame& frame,
            const annotation::Intruder& intruder) {
    const std::string where = words_of(frame, intruder);
    const auto mask =
        insertion::read_alpha_mask(finished.folder, finished.truth.lens, intruder.id, frame.frame);
    if (mask && intruder.state != annotation::State::kVisible)
      return fault(where + "a mask, and not visible");
    const auto covered = mask ? composite::covered(*mask) : std::nullopt;
    const auto bounds = covered ? std::optional(covered->box) : std::nullopt;
    const bool is_of_area =
        !intruder.covered_area_px || !covered || *intruder.covered_area_px == covered->area_px;
    if (bounds != intruder.covered_box_px || !is_of_area)
      fault(where + (mask ? "its mask is not of its covered box" : "a covered box without a mask"));
  }

  std::string name_;
  fs::path folder_;
  const VerifyOptions& options_;
  setup::SharedInputs& inputs_;
  VerifyResult result_;
  std::vector<double> contrast_ratios_;  // stated to measured
};

void add(const VerifyResult& one, VerifyResult& all) {
  all.sequences += one.sequences;
  all.frames += one.frames;
  all.not_there += one.not_there;
  all.recomposed += one.recomposed;
  all.in_view += one.in_view;
  all.in_view_without_box += one.in_view_without_box;
  for (const auto& [name, input] : one.inputs) {
    const auto& first = all.inputs.try_emplace(name, input).first->second;
    if (first.sha256 != input.sha256)
      all.faults.push_back(fmt::format(
          "{}: was made of another {} than {} (its SHA-256 differs)", input.of, name, first.of));
  }
  if (one.not_there > 0 && all.not_there > kMaxMissingFaults) return;
  all.faults.insert(all.faults.end(), one.faults.begin(), one.faults.end());
}

void check_manifest(const catalogue::Folder& folder, VerifyResult& result) {
  if (!fs::exists(folder.record())) {
    result.faults.emplace_back("dataset.json is not there: the data set is not complete");
    return;
  }
  try {
    const JsonDocument record(folder.record());
    if (record.text("catalogue_sha256") != sha256_of_file(folder.catalogue()))
      result.faults.emplace_back("dataset.json was written for another catalogue");
    for (const JsonObject& file : record.objects("manifest")) {
      const std::string name = file.text("name");
      const fs::path path = folder.root / name;
      if (!is_below(folder.root, name))
        result.faults.push_back("'" + name.substr(0, 80) + "' of dataset.json is outside of it");
      else if (!fs::exists(path) || sha256_of_file(path) != file.text("sha256"))
        result.faults.push_back(path.filename().string() + " is not as it was written");
    }
  } catch (const Error& error) {
    result.faults.emplace_back(error.what());
  }
}

void count_violations(const fs::path& sequence, Status& status) {
  std::set<std::string> violated;
  for (const pipeline::EncounterRecord& record :
       pipeline::read_encounter_records(JsonDocument(sequence / "sequence.json")))
    for (const pipeline::NamedInterval& violation : record.violations)
      violated.insert(violation.volume);
  for (const std::string& name : violated) ++status.violated[name];
}

}  // namespace

Status status(const fs::path& root) {
  const catalogue::Folder folder{root};
  const catalogue::Catalogue catalogue = catalogue::catalogue_of(folder);
  const catalogue::Expansion expansion(catalogue);
  Status status;
  status.name = catalogue.name;
  status.sequences = expansion.size();
  for (const std::string& name : catalogue.truth.volumes) status.violated[name] = 0;
  for (const scene::TruthVolume& volume : catalogue.truth.own_volumes)
    status.violated[volume.name] = 0;
  const bool has_volumes = !status.violated.empty();
  for (std::int64_t i = 0; i < expansion.size(); ++i) {
    const catalogue::Item item = expansion.at(i);
    const fs::path place = folder.sequence(item);
    if (folder.holds(item)) {
      ++status.whole;
      if (has_volumes) count_violations(place, status);
    } else if (++status.not_there <= kMaxNamed)
      status.missing.push_back(item.name);
    if (fs::exists(place.parent_path() / ("." + item.name + ".part"))) ++status.half;
  }
  status.at_work = is_at_work(folder);
  status.complete = status.not_there == 0 && fs::exists(folder.record());
  return status;
}

namespace {

// The sequences that are verified, in their order.
struct Places {
  std::int64_t size = 0;
  std::function<Place(std::int64_t)> at;
};

Places places_of(const catalogue::Folder& folder) {
  const auto catalogue =
      std::make_shared<const catalogue::Catalogue>(catalogue::catalogue_of(folder));
  const auto expansion = std::make_shared<const catalogue::Expansion>(*catalogue);
  return {expansion->size(), [catalogue, expansion, folder](std::int64_t i) {
            const catalogue::Item item = expansion->at(i);
            return Place{item.name, folder.sequence(item)};
          }};
}

// Of an imported set, and of what `render` has made, which have no catalogue: those that are there.
Places places_there(const fs::path& root) {
  const sequences::SequenceFolders folders = sequences::sequence_folders(root);
  if (folders.names.empty()) throw sequences::no_sequence_in(root);
  return {std::ssize(folders.names), [folders](std::int64_t i) {
            const std::string& name = folders.names[static_cast<std::size_t>(i)];
            return Place{name, folders.folder(name)};
          }};
}

// The results of `count` sequences from number `first` on, in their order.
std::vector<VerifyResult> results_of(const Places& places,
                                     std::int64_t first,
                                     std::int64_t count,
                                     const VerifyOptions& options,
                                     setup::SharedInputs& inputs) {
  std::vector<VerifyResult> results(static_cast<std::size_t>(count));
  in_parallel(
      results.size(),
      options.jobs,
      [&](std::size_t i) {
        Place place = places.at(first + static_cast<std::int64_t>(i));
        results[i] = Check(std::move(place), options, inputs).run();
      },
      [&](std::int64_t done, std::int64_t) {
        if (options.progress) options.progress(first + done, places.size);
      },
      options.stop);
  return results;
}

}  // namespace

VerifyResult verify(const fs::path& root, const VerifyOptions& options) {
  const catalogue::Folder folder{root};
  // The record of a set that was built is there even where its catalogue is lost.
  const bool is_built = fs::exists(folder.catalogue()) || fs::exists(folder.record());
  const Places places = is_built ? places_of(folder) : places_there(root);
  VerifyResult result;
  setup::SharedInputs inputs;
  for (std::int64_t first = 0; first < places.size; first += kMaxHeldResults) {
    const std::int64_t count = std::min(kMaxHeldResults, places.size - first);
    for (const VerifyResult& one : results_of(places, first, count, options, inputs))
      add(one, result);
  }
  if (result.not_there > kMaxMissingFaults)
    result.faults.push_back(fmt::format(
        "{} more sequences of the catalogue are not there; `airtruth dataset build` makes "
        "what is missing",
        result.not_there - kMaxMissingFaults));
  if (is_built) check_manifest(folder, result);
  return result;
}

}  // namespace airtruth::build
