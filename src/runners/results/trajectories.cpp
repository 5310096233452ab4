// SPDX-License-Identifier: Apache-2.0
#include "runners/results/trajectories.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "evaluation/matching/boxes.h"
#include "foundation/base/error.h"
#include "labels/exchange/text.h"
#include "runners/results/detections.h"
#include "runners/results/results_folder.h"
#include "runners/results/vot_regions.h"

namespace airtruth::results {
namespace {

using evaluation::Mark;
using evaluation::Trajectory;
using evaluation::VotFrame;

// The folders of runs with restarts, with several starts, and of both as VOT's toolkit has them.
constexpr std::array kVotPlaces = {
    enum_name(Protocol::kRestart), enum_name(Protocol::kMultiStart), "baseline"};
constexpr const char* kBinary = ".bin";
constexpr std::size_t kAnchorDigits = 8;  // of a file's name, as VOT's toolkit writes it
constexpr std::size_t kMotColumns = 6;    // at least: frame, id, x, y, w, h

// Takes down what the record beside a run says that it was made of.
void add_source(const fs::path& run, TrackerResults& results) {
  const fs::path record = run_record(run);
  if (!fs::exists(record)) return;
  if (const std::string sha256 = sha256_of_sequence(JsonDocument(record)); !sha256.empty())
    results.sources_sha256.insert(sha256);
}

// Takes down a box with a side below 0.
void add_negative(const Where& where, TrackerResults& results) {
  if (results.negative_boxes++ == 0) results.first_negative = where;
}

Trajectory read_trajectory(const fs::path& file, int origin_px, TrackerResults& results) {
  Trajectory trajectory;
  const auto add = [&](const Region& region, int line) {
    trajectory.push_back(region.frame);
    if (region.has_negative_side) add_negative({file.string(), line}, results);
  };
  if (file.extension() == kBinary)
    for (const Region& region : read_binary_regions(file, origin_px)) add(region, 0);
  else
    for (const exchange::Line& line : exchange::lines_of(file))
      add(region_of(line, file, origin_px), line.number);
  return trajectory;
}

// 0 where there is no file, and for a blank line, which VOT's toolkit writes for a frame without a
// time. GOT-10k's repetitions have a column each.
std::vector<double> read_times(const fs::path& file, std::size_t frames, std::size_t column = 0) {
  std::vector<double> seconds(frames, 0);
  if (!fs::exists(file)) return seconds;
  const std::vector<exchange::Line> filled = exchange::lines_of(file);
  const std::string text = read_file(file);
  const auto ends = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
  const std::size_t lines = ends + (text.empty() || text.back() == '\n' ? 0 : 1);
  const bool has_blanks = filled.size() != frames;
  if (has_blanks && lines != frames)
    throw Error(fmt::format("has {} lines; its results have {}", lines, frames), {file.string()});
  for (std::size_t i = 0; i < filled.size(); ++i) {
    const std::vector<double> numbers = exchange::numbers_of(filled[i], file);
    const std::size_t at = has_blanks ? static_cast<std::size_t>(filled[i].number - 1) : i;
    if (column < numbers.size()) seconds[at] = numbers[column];
  }
  return seconds;
}

using Tracks = std::map<std::int64_t, std::map<std::int64_t, Box>>;  // [frame][id]

// The track with the greatest overlap with the truth in the first frame where any track overlaps
// it.
std::optional<std::int64_t> overlapping_track(const Tracks& tracks, const exchange::Clip& clip) {
  for (const exchange::LabelledFrame& frame : clip.frames) {
    const auto truth = box_of(frame);
    const auto here = tracks.find(frame.frame);
    if (!truth || here == tracks.end()) continue;
    double best = 0;
    std::optional<std::int64_t> found;
    for (const auto& [id, box] : here->second)
      if (const double shared = evaluation::overlap(box, *truth); shared > best) {
        best = shared;
        found = id;
      }
    if (found) return found;
  }
  return std::nullopt;
}

using FrameAndId = std::pair<std::int64_t, std::int64_t>;

// The frame, from 1, and the id with which a line of MOTChallenge begins; empty for other lines.
std::optional<FrameAndId> frame_and_id(const std::vector<double>& n) {
  if (n.size() < kMotColumns) return std::nullopt;
  const auto frame = exchange::whole_in(n[0], 1, exchange::kMaxFrames);
  const auto id = exchange::whole_in(n[1], -1, std::int64_t{1} << 52);
  return frame && id ? std::optional(FrameAndId(*frame, *id)) : std::nullopt;
}

// "frame,id,x,y,w,h,confidence,..." with frames from 1; `clip` has theirs from 0.
Trajectory read_mot(const fs::path& file, const exchange::Clip& clip, TrackerResults& results) {
  Tracks tracks;
  for (const exchange::Line& line : exchange::lines_of(file)) {
    const std::vector<double> n = exchange::numbers_of(line, file);
    const auto at = frame_and_id(n);
    if (!at)
      throw Error("is no line of MOTChallenge; expected frame,id,x,y,width,height,...",
                  {file.string(), line.number});
    const Box box{n[2] - 1, n[3] - 1, n[4], n[5]};
    if (is_sound(box))
      tracks[at->first - 1][at->second] = box;
    else if (box.width < 0 || box.height < 0)
      add_negative({file.string(), line.number}, results);
  }
  const auto mine = overlapping_track(tracks, clip);
  Trajectory trajectory;
  for (const exchange::LabelledFrame& frame : clip.frames) {
    VotFrame result{Mark::kAnswer, {}};
    if (mine)
      if (const auto found = tracks[frame.frame].find(*mine); found != tracks[frame.frame].end())
        result.box = found->second;
    trajectory.push_back(result);
  }
  return trajectory;
}

// MOTChallenge's lines are sorted by frame, or by id and within it by frame, and a track has one
// box in a frame.
bool are_of_tracks(std::vector<FrameAndId> lines) {
  const bool by_frame = std::ranges::is_sorted(lines, {}, &FrameAndId::first);
  const bool by_id = std::ranges::is_sorted(
      lines, {}, [](const FrameAndId& line) { return FrameAndId(line.second, line.first); });
  std::ranges::sort(lines);
  const auto twice = std::ranges::adjacent_find(
      lines, [](const FrameAndId& a, const FrameAndId& b) { return a == b && a.second >= 0; });
  return (by_frame || by_id) && twice == lines.end();
}

// MOTChallenge's lines have seven or more columns here. An even number of numbers is also that of a
// polygon: there the whole file decides. Where it fits both, with a line for each frame of the
// clip, it is MOTChallenge's if the clip has its frames, and `results` say so.
bool is_mot(const fs::path& file, const exchange::Clip& clip, TrackerResults& results) {
  std::vector<FrameAndId> lines;
  for (const exchange::Line& line : exchange::lines_of(file)) {
    if (line.text.starts_with('m')) return false;
    const std::vector<double> n = exchange::numbers_of(line, file);
    if (n.size() <= kMotColumns) return false;
    if (n.size() % 2 == 1) return true;
    const auto at = frame_and_id(n);
    if (!at) return false;
    lines.push_back(*at);
  }
  if (lines.empty() || !are_of_tracks(lines)) return false;
  if (lines.size() != clip.frames.size()) return true;
  const auto is_at = [](const FrameAndId& line, const exchange::LabelledFrame& frame) {
    return line.first == frame.frame + 1;
  };
  if (std::ranges::equal(lines, clip.frames, is_at)) return true;
  const bool are_in_clip = std::ranges::all_of(lines, [&](const FrameAndId& line) {
    return line.first > clip.frames.front().frame && line.first <= clip.frames.back().frame + 1;
  });
  results.doubt = fmt::format("{}: fits MOTChallenge and polygons alike, and is read as {}",
                              file.string(),
                              are_in_clip ? "MOTChallenge" : "polygons");
  return are_in_clip;
}

void expect_length(const Trajectory& trajectory, const exchange::Clip& clip, const fs::path& file) {
  if (trajectory.size() != clip.frames.size())
    throw Error(fmt::format("has {} lines; {} has {} frames from the first that shows its object "
                            "to the last",
                            trajectory.size(),
                            clip.name,
                            clip.frames.size()),
                {file.string()});
}

Trajectory one_pass_run(const fs::path& file,
                        exchange::Clip clip,
                        int origin_px,
                        std::int64_t first_place,
                        TrackerResults& results) {
  // Whoever answers has the pictures in turn, and not their numbers in a video.
  for (exchange::LabelledFrame& frame : clip.frames) frame.frame = first_place++;
  Trajectory run = is_mot(file, clip, results) ? read_mot(file, clip, results)
                                               : read_trajectory(file, origin_px, results);
  // VOT's unsupervised runs mark their start.
  for (VotFrame& frame : run)
    if (frame.mark != Mark::kAnswer) frame = {Mark::kAnswer, {}};
  expect_length(run, clip, file);
  return run;
}

std::optional<std::int64_t> number_of(const fs::path& file, const std::string& sequence) {
  const std::string stem = file.stem().string();
  if (!stem.starts_with(sequence + "_")) return std::nullopt;
  const std::string digits = stem.substr(sequence.size() + 1);
  if (digits.empty() || digits.size() > kAnchorDigits ||
      digits.find_first_not_of("0123456789") != std::string::npos)
    return std::nullopt;
  return std::stoll(digits);
}

bool is_anchor_name(const fs::path& file, const std::string& sequence) {
  return file.stem().string().size() == sequence.size() + 1 + kAnchorDigits;
}

// SEQUENCE.txt, or else GOT-10k's repetitions.
std::vector<fs::path> one_pass_files(const fs::path& folder, const std::string& sequence) {
  const fs::path own = folder / (sequence + ".txt");
  if (fs::exists(own)) return {own};
  if (!fs::is_directory(folder / sequence)) return {};
  std::vector<fs::path> files = files_with(folder / sequence, ".txt");
  std::erase_if(files, [&](const fs::path& file) {
    return !number_of(file, sequence) || is_anchor_name(file, sequence);
  });
  return files;
}

// Where a run has both files, the text file is read, as in the toolkit.
std::vector<fs::path> vot_files(const fs::path& folder) {
  std::vector<fs::path> files = files_with(folder, ".txt");
  for (const fs::path& file : files_with(folder, kBinary))
    if (!fs::exists(fs::path(file).replace_extension(".txt"))) files.push_back(file);
  std::sort(files.begin(), files.end());
  return files;
}

void add_vot_runs(const fs::path& folder,
                  const exchange::Clip& clip,
                  int origin_px,
                  TrackerResults& results) {
  if (!fs::is_directory(folder)) return;
  const std::int64_t length = std::ssize(clip.frames);
  for (const fs::path& file : vot_files(folder)) {
    const auto number = number_of(file, clip.name);
    if (!number) continue;
    Trajectory run = read_trajectory(file, origin_px, results);
    add_source(file, results);
    // No measure has the times of these runs; they are checked alone.
    read_times(times_file(file, Protocol::kRestart), run.size());
    if (run.empty() || run.front().mark != Mark::kBegun)
      throw Error("does not begin with 1; expected a run of VOT", {file.string(), 1});
    if (is_anchor_name(file, clip.name)) {
      if (*number >= length)
        throw Error(fmt::format("begins at frame {}; {} has {} frames", *number, clip.name, length),
                    {file.string()});
      const std::int64_t lines = std::ssize(run);
      const bool goes_forward = lines == length - *number;
      const bool goes_backward = lines == *number + 1;
      if (!goes_forward && !goes_backward)
        throw Error(fmt::format("has {} lines; from frame {} {} has {} to its end and {} to its "
                                "beginning",
                                lines,
                                *number,
                                clip.name,
                                length - *number,
                                *number + 1),
                    {file.string()});
      // An anchor in the exact middle is equally far from both ends; it runs forward, as in
      // anchors_of().
      const bool is_backward = goes_backward && (!goes_forward || *number >= (length + 1) / 2);
      results.multistart.push_back({*number, is_backward, std::move(run)});
    } else {
      expect_length(run, clip, file);
      results.restart.push_back(std::move(run));
    }
  }
}

}  // namespace

Protocol protocol_from_name(std::string_view name) {
  if (const auto known = enum_named<Protocol>(name)) return *known;
  throw Error(
      "unknown protocol '" + std::string(name) + "'" +
      did_you_mean(name, all_enum_names<Protocol>(), "; expected ope, restart or multistart"));
}

fs::path trajectory_file(const fs::path& folder,
                         Protocol protocol,
                         const std::string& sequence,
                         std::int64_t number) {
  if (protocol == Protocol::kOnePass) return folder / (sequence + ".txt");
  const std::string file = protocol == Protocol::kRestart
                               ? fmt::format("{}_{:03d}.txt", sequence, number)
                               : fmt::format("{}_{:08d}.txt", sequence, number);
  return folder / enum_name(protocol) / sequence / file;
}

fs::path times_file(const fs::path& trajectory, Protocol protocol) {
  return trajectory.parent_path() /
         (trajectory.stem().string() +
          (protocol == Protocol::kOnePass ? "_time.txt" : "_time.value"));
}

fs::path run_record(fs::path trajectory) { return trajectory.replace_extension(".run.json"); }

void expect_own_files(const exchange::ArrangedNames& sequences) {
  for (const auto& [name, clip] : sequences)
    if (const auto other = sequences.find(name + "_time"); other != sequences.end())
      throw Error(
          fmt::format("the seconds of '{}' and the results of '{}' have one file, {}.txt; "
                      "expected another name of one of them",
                      clip,
                      other->second,
                      other->first));
}

std::string text_of(const Trajectory& trajectory) {
  std::string text;
  for (const VotFrame& frame : trajectory) {
    if (frame.mark != Mark::kAnswer)
      text += fmt::format("{}\n", static_cast<int>(frame.mark));
    else if (frame.box)
      text += fmt::format(
          "{},{},{},{}\n", frame.box->x, frame.box->y, frame.box->width, frame.box->height);
    else
      text += "nan,nan,nan,nan\n";
  }
  return text;
}

std::string text_of(const std::vector<double>& seconds) {
  std::string text;
  for (const double s : seconds) text += fmt::format("{:.9f}\n", s);
  return text;
}

TrackerResults read_results(const fs::path& folder,
                            const exchange::Clip& clip,
                            int origin_px,
                            std::int64_t first_place) {
  TrackerResults results;
  std::vector<TrackerResults::OnePass> passes;
  for (const fs::path& file : one_pass_files(folder, clip.name)) {
    const fs::path times = file.parent_path() / (clip.name + "_time.txt");
    passes.push_back({one_pass_run(file, clip, origin_px, first_place, results),
                      read_times(times, clip.frames.size(), passes.size())});
    add_source(file, results);
  }
  if (!passes.empty()) {
    results.one_pass = std::move(passes.front());
    results.further_passes.assign(std::next(passes.begin()), passes.end());
  }
  for (const char* place : kVotPlaces)
    add_vot_runs(folder / place / clip.name, clip, origin_px, results);
  return results;
}

std::optional<Box> box_of(const exchange::LabelledFrame& frame) {
  return frame.labels.empty() ? std::nullopt : std::optional(frame.labels.front().box_px);
}

evaluation::VotTruth vot_truth(const exchange::Clip& clip) {
  evaluation::VotTruth truth{{}, clip.width, clip.height};
  for (const exchange::LabelledFrame& frame : clip.frames) truth.boxes.push_back(box_of(frame));
  return truth;
}

std::vector<std::string> tracked_sequences_in(const fs::path& folder) {
  std::set<std::string> names;
  for (const fs::path& file : files_with(folder, ".txt"))
    if (const std::string name = file.stem().string(); !name.ends_with("_time")) names.insert(name);
  const auto add_folders = [&](const fs::path& place) {
    if (!fs::is_directory(place)) return;
    for (const auto& entry : fs::directory_iterator(place)) {
      const std::string name = entry.path().filename().string();
      if (!entry.is_directory()) continue;
      for (const fs::path& file : vot_files(entry.path()))
        if (number_of(file, name)) names.insert(name);
    }
  };
  add_folders(folder);
  for (const char* place : kVotPlaces) add_folders(folder / place);
  return {names.begin(), names.end()};
}

std::vector<std::string> broken_runs_in(const fs::path& folder) {
  std::vector<std::string> runs;
  const fs::path logs = folder / "logs";
  if (!fs::is_directory(logs)) return runs;
  for (const fs::path& file : files_with(logs, ".log"))
    if (read_file(file).find(kBrokenOff) != std::string::npos) runs.push_back(file.stem().string());
  return runs;
}

}  // namespace airtruth::results
