// SPDX-License-Identifier: Apache-2.0
#include "runners/results/results_folder.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "foundation/base/error.h"
#include "foundation/base/names.h"
#include "foundation/json/settings_record.h"
#include "foundation/run_files/run_files.h"
#include "labels/exchange/text.h"

namespace airtruth::results {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "airtruth detections 1";
constexpr const char* kAircraft = "aircraft";
constexpr int kMaxSide = 65'536;  // px, of a picture
// 46 hours at 30 frames/s.
constexpr std::int64_t kMaxFramesOfRun = 5'000'000;

double rounded_px(double coordinate_px) { return std::round(coordinate_px * 1000) / 1000; }

constexpr std::int64_t kMaxTrack = 1'000'000'000'000;  // an id; a double holds it exactly

void read_mot_text(const fs::path& file, FrameList& frames) {
  for (const exchange::Line& line : exchange::lines_of(file)) {
    const Where where{file.string(), line.number};
    const std::vector<double> n = exchange::numbers_of(line, file);
    if (n.size() < 7 || n.size() > 10)
      throw Error(
          fmt::format("has {} columns; expected frame,id,left,top,width,height,score", n.size()),
          where);
    const auto frame = exchange::whole_in(n[0], 1, std::int64_t{1} << 40);
    if (!frame) throw Error("the frame is no whole number from 1 on", where);
    const auto track = exchange::whole_in(n[1], -1, kMaxTrack);
    if (!track) throw Error("the id is no whole number from -1 on", where);
    Detection detection;
    detection.box_px = {n[2] - 1, n[3] - 1, n[4], n[5]};
    detection.score = n[6];
    if (*track >= 0) detection.track = *track;
    frames.add(*frame - 1, std::move(detection), where);
  }
}

std::string mot_text_of(const SequenceDetections& detections) {
  std::string text;
  for (std::size_t i = 0; i < detections.frames.size(); ++i)
    for (const Detection& d : detections.frames[i]) {
      const Box box = as_written(d.box_px);
      fmt::format_to(std::back_inserter(text),
                     "{},{},{},{},{},{},{:.9g},-1,-1,-1\n",
                     i + 1,
                     d.track.value_or(-1),
                     rounded_px(box.x + 1),
                     rounded_px(box.y + 1),
                     box.width,
                     box.height,
                     d.score);
    }
  return text;
}

fs::path text_file(const fs::path& folder, const std::string& name) {
  return folder / (name + ".txt");
}
fs::path facts_file(const fs::path& folder, const std::string& name) {
  return folder / (name + ".json");
}

Json origin_of(const SequenceDetections& detections) {
  Json origin = Json::object();
  if (!detections.source.empty()) origin["source"] = detections.source;
  if (!detections.source_sha256.empty()) origin[kSourceSha256] = detections.source_sha256;
  if (detections.stated_rate_hz) origin["frame_rate_hz"] = *detections.stated_rate_hz;
  return origin;
}

Json facts_of(const SequenceDetections& detections) {
  Json facts = {{"format", kFormat},
                {"sequence", detections.name},
                {"width", detections.width},
                {"height", detections.height},
                {"frames", detections.frames.size()}};
  facts.update(origin_of(detections));
  Json categories = Json::array();
  bool are_all_aircraft = true;
  for (const auto& frame : detections.frames)
    for (const Detection& detection : frame) {
      categories.push_back(detection.category);
      are_all_aircraft = are_all_aircraft && detection.category == kAircraft;
    }
  if (!are_all_aircraft) facts["categories"] = std::move(categories);
  if (!detections.seconds.empty()) {
    Json seconds = Json::array();
    for (const double s : detections.seconds) seconds.push_back(std::round(s * 1e6) / 1e6);
    facts["seconds"] = std::move(seconds);
  }
  return facts;
}

// The categories, in the order of the text's lines.
void name_categories(SequenceDetections& read, const JsonObject& facts) {
  if (!facts.has("categories")) return;
  const std::vector<std::string> categories = facts.texts("categories");
  std::size_t next = 0;
  for (auto& frame : read.frames)
    for (Detection& detection : frame) {
      if (next < categories.size()) detection.category = categories[next];
      ++next;
    }
  if (next != categories.size())
    facts.fail(fmt::format("names {} categories; the text has {} lines", categories.size(), next));
}

// The file of a sequence in a folder of MOTChallenge results; empty: none. Error where there are
// two.
fs::path mot_file(const fs::path& folder, const std::string& name) {
  fs::path found;
  for (const fs::path& file : {folder / (name + ".txt"),
                               folder / "data" / (name + ".txt"),
                               folder / name / "det" / "det.txt"}) {
    if (!fs::is_regular_file(file)) continue;
    if (!found.empty())
      throw Error("holds '" + name + "' twice: " + found.string() + " and " + file.string(),
                  {folder.string()});
    found = file;
  }
  return found;
}

std::vector<std::string> mot_names(const fs::path& folder) {
  std::vector<std::string> names;
  for (const fs::path& place : {folder, folder / "data"})
    for (const fs::path& path : entries(place))
      if (fs::is_regular_file(path) && path.extension() == ".txt")
        names.push_back(path.stem().string());
      else if (fs::is_regular_file(path / "det" / "det.txt"))
        names.push_back(path.filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

void expect_known(const std::vector<std::string>& names,
                  std::span<const ExpectedSequence> set,
                  const fs::path& folder) {
  std::vector<std::string> known;
  for (const ExpectedSequence& sequence : set) known.push_back(sequence.name);
  for (const std::string& name : names) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    throw Error("holds results of '" + name + "', and the set has no sequence of that name" +
                    did_you_mean(name, known),
                {folder.string()});
  }
}

void expect_same(const SequenceDetections& read,
                 const ExpectedSequence& expected,
                 const fs::path& file) {
  const auto differs = [](std::int64_t known, std::int64_t found) {
    return known > 0 && found > 0 && known != found;
  };
  if (differs(expected.frames, std::ssize(read.frames)))
    throw Error(
        fmt::format(
            "is of {} frames; '{}' has {}", read.frames.size(), expected.name, expected.frames),
        {file.string()});
  if (differs(expected.width, read.width) || differs(expected.height, read.height))
    throw Error(fmt::format("is of pictures of {}x{}; those of '{}' are {}x{}",
                            read.width,
                            read.height,
                            expected.name,
                            expected.width,
                            expected.height),
                {file.string()});
}

// A folder that `airtruth detect` made, or one of MOTChallenge results.
std::vector<SequenceDetections> read_folder(const fs::path& folder,
                                            bool is_own,
                                            const std::vector<std::string>& names,
                                            std::span<const ExpectedSequence> set) {
  expect_known(names, set, folder);
  std::vector<SequenceDetections> all;
  for (const ExpectedSequence& expected : set) {
    if (is_own) {
      if (!has_sequence(folder, expected.name)) continue;
      all.push_back(read_sequence(folder, expected.name));
      expect_same(all.back(), expected, facts_file(folder, expected.name));
    } else if (const fs::path file = mot_file(folder, expected.name); !file.empty()) {
      FrameList frames(expected.name, expected.width, expected.height, expected.frames);
      read_mot_text(file, frames);
      all.push_back(frames.take());
    }
  }
  return all;
}

}  // namespace

bool is_of_results_name(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_' || c == '.';
}

bool is_results_name(std::string_view name) {
  return !name.empty() && name.size() <= 80 && name.front() != '.' &&
         std::all_of(name.begin(), name.end(), is_of_results_name);
}

Box as_written(const Box& box) {
  const auto side = [](double length) {
    return length > 0 ? std::max(kWrittenStep_px, rounded_px(length)) : length;
  };
  return {rounded_px(box.x + 1) - 1, rounded_px(box.y + 1) - 1, side(box.width), side(box.height)};
}

void write_log(const fs::path& folder, const std::string& run, const std::string& text) {
  const fs::path file = folder / "logs" / (run + ".log");
  if (text.empty()) {
    fs::remove(file);
    return;
  }
  fs::create_directories(file.parent_path());
  write_file(file, text);
}

void write_sequence(const fs::path& folder, const SequenceDetections& detections) {
  const fs::path text = text_file(folder, detections.name);
  const fs::path facts = facts_file(folder, detections.name);
  RunFiles files;
  files.writes(text, true).writes(facts, true);
  files.begin();
  files.write(text, [&](const fs::path& at) { write_file(at, mot_text_of(detections)); });
  files.write(facts,
              [&](const fs::path& at) { write_file(at, facts_of(detections).dump() + "\n"); });
  files.commit();
}

bool has_sequence(const fs::path& folder, const std::string& name) {
  return fs::exists(facts_file(folder, name)) && fs::exists(text_file(folder, name));
}

std::string sha256_of_sequence(const JsonObject& record) {
  return record.has("source") ? "" : record.maybe_text(kSourceSha256).value_or("");
}

void expect_made_of(const fs::path& folder, const SequenceDetections& detections) {
  refuse_other(facts_file(folder, detections.name), origin_of(detections));
}

SequenceDetections read_sequence(const fs::path& folder, const std::string& name) {
  const JsonDocument facts(facts_file(folder, name));
  const std::string format = std::string("\"") + kFormat + "\"";
  if (!facts.has("format")) facts.fail("has no format; expected " + format);
  if (facts.text("format") != kFormat) facts.fail("format", format);
  FrameList frames(name,
                   static_cast<int>(facts.whole("width", 1, kMaxSide)),
                   static_cast<int>(facts.whole("height", 1, kMaxSide)),
                   facts.whole("frames", 1, kMaxFramesOfRun));
  read_mot_text(text_file(folder, name), frames);
  SequenceDetections read = frames.take();
  name_categories(read, facts);
  read.source_sha256 = sha256_of_sequence(facts);
  if (facts.has("seconds")) read.seconds = facts.numbers("seconds", read.frames.size());
  return read;
}

std::vector<SequenceDetections> read_detections(const fs::path& source,
                                                std::span<const ExpectedSequence> set,
                                                const Warn& warn) {
  if (!fs::exists(source)) throw Error("does not exist", {source.string()});
  if (!fs::is_directory(source)) return read_coco_results(source, set, warn);
  const std::vector<std::string> names = mot_names(source);
  const bool is_own = fs::exists(source / "detector.json");
  if (is_own || !names.empty()) return read_folder(source, is_own, names, set);
  if (const std::vector<fs::path> files = files_with(source, ".json"); files.size() == 1)
    return read_coco_results(files.front(), set, warn);
  throw Error(
      "holds no results; expected what `airtruth detect` made, MOTChallenge text (SEQUENCE.txt) or "
      "one COCO results file",
      {source.string()});
}

}  // namespace airtruth::results
