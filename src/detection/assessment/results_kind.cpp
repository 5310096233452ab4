// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <fstream>
#include <string>
#include <vector>

#include "detection/assessment/assess.h"

namespace airtruth::detection {
namespace {

bool has_ending(const fs::path& file, const char* ending) {
  return file.extension() == ending && fs::is_regular_file(file);
}

// MOTChallenge's lines have an id as their second cell of seven or more; a detection without a
// track has the id -1.
bool is_mot(const fs::path& file, bool with_tracks) {
  std::ifstream text(file);
  std::string line;
  while (std::getline(text, line)) {
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    if (std::count(line.begin(), line.end(), ',') < 6) return false;
    const std::size_t first = line.find(',') + 1;
    const std::size_t begin = line.find_first_not_of(" \t", first);
    return with_tracks || (begin != std::string::npos && line.compare(begin, 2, "-1") == 0);
  }
  return false;
}

}  // namespace

bool holds_detections(const fs::path& results, bool is_mot_of_detector) {
  std::error_code failed;
  if (has_ending(results, ".json")) return true;
  if (!fs::is_directory(results, failed) || fs::exists(results / "tracker.json")) return false;
  if (fs::exists(results / "detector.json")) return true;
  std::size_t json = 0;
  bool has_det = false;
  bool has_folder = false;
  std::vector<fs::path> texts;
  for (const fs::path& folder : {results, results / "data"})
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, failed)) {
      json += has_ending(entry.path(), ".json") ? 1 : 0;
      if (has_ending(entry.path(), ".txt")) texts.push_back(entry.path());
      has_det = has_det || fs::exists(entry.path() / "det" / "det.txt", failed);
      has_folder = has_folder || entry.is_directory(failed);
    }
  if (has_det || (json == 1 && texts.empty() && !has_folder)) return true;
  std::sort(texts.begin(), texts.end());
  return std::any_of(texts.begin(), texts.end(), [&](const fs::path& file) {
    return !file.stem().string().ends_with("_time") && is_mot(file, is_mot_of_detector);
  });
}

}  // namespace airtruth::detection
