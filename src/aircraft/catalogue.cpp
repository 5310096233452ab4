// SPDX-License-Identifier: Apache-2.0
#include "aircraft/catalogue.h"

#include <algorithm>
#include <cstdlib>
#include <sstream>

#include "base/error.h"
#include "base/files.h"
#include "base/suggest.h"

namespace airtruth::aircraft {
namespace {

constexpr const char* kDebianFolder = "/usr/share/games/flightgear/AI/Aircraft";

std::vector<fs::path> folders() {
  const char* stated = std::getenv("AIRTRUTH_AIRCRAFT_PATH");
  std::vector<fs::path> result;
  std::istringstream list(stated != nullptr && *stated != '\0' ? stated : kDebianFolder);
  for (std::string folder; std::getline(list, folder, ':');)
    if (!folder.empty() && fs::is_directory(folder)) result.emplace_back(folder);
  if (result.empty())
    throw Error(
        "no aircraft are installed: install the package flightgear-data-ai, or set "
        "AIRTRUTH_AIRCRAFT_PATH");
  return result;
}

// A wrapper that names a model, itself or through what it includes, and not one of its parts
// (Models/Engines/...).
bool is_aircraft(const fs::path& file) {
  const std::string name = file.filename().string();
  if (name.find("-set.xml") != std::string::npos || name == "fallback_models.xml") return false;
  const std::string text = read_file(file);
  if (text.find("<PropertyList") == std::string::npos) return false;
  return text.find("include=\"") != std::string::npos || text.find("<path>") != std::string::npos;
}

void list_folder(const fs::path& root, std::vector<Entry>& entries) {
  for (const auto& aircraft : fs::directory_iterator(root)) {
    if (!aircraft.is_directory()) continue;
    for (const auto& file : fs::directory_iterator(aircraft.path())) {
      if (file.path().extension() != ".xml" || !is_aircraft(file.path())) continue;
      const std::string name =
          aircraft.path().filename().string() + "/" + file.path().stem().string();
      entries.push_back({name, file.path()});
    }
  }
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

}  // namespace

std::vector<Entry> list_aircraft() {
  std::vector<Entry> entries;
  for (const fs::path& folder : folders()) list_folder(folder, entries);
  std::stable_sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
    return a.name < b.name;
  });
  entries.erase(std::unique(entries.begin(),
                            entries.end(),
                            [](const Entry& a, const Entry& b) { return a.name == b.name; }),
                entries.end());
  return entries;
}

Entry find_aircraft(const std::string& name) {
  for (const fs::path& folder : folders()) {
    const fs::path file = folder / (name + ".xml");
    std::error_code ignored;
    const bool plain = !name.empty() && name.find("..") == std::string::npos && name.front() != '/';
    if (plain && fs::is_regular_file(file, ignored)) return {name, file};
  }
  std::vector<std::string> names;
  for (const Entry& entry : list_aircraft()) names.push_back(entry.name);
  throw Error("unknown aircraft '" + name + "'; the nearest names are " +
              joined(nearest_spellings(name, names, 3)) + " (`airtruth aircraft list` shows all)");
}

std::vector<std::string> liveries(const std::string& name) {
  const auto slash = name.find('/');
  if (slash == std::string::npos) return {};
  std::vector<std::string> result;
  for (const Entry& entry : list_aircraft())
    if (entry.name != name && entry.name.rfind(name.substr(0, slash + 1), 0) == 0)
      result.push_back(entry.name);
  return result;
}

}  // namespace airtruth::aircraft
