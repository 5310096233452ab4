// SPDX-License-Identifier: Apache-2.0
#include "dataset/build/manifest.h"

#include <airtruth/version.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/json/json_object.h"
#include "foundation/json/or_null.h"

namespace airtruth::build {
namespace {

using Json = nlohmann::ordered_json;

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

}  // namespace

void write_failures(const fs::path& file, const std::vector<Failure>& failures) {
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
  return true;
}

}  // namespace airtruth::build
