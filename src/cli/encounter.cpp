// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "cli/commands.h"
#include "encounter/encounter_model/sampler.h"
#include "encounter/sets/sets.h"
#include "encounter/track/track.h"
#include "encounter/tracks_file/tracks_file.h"
#include "foundation/base/error.h"
#include "foundation/run_files/run_files.h"

namespace airtruth::cli {
namespace {

// Largest number of encounters: a choice.
constexpr std::int64_t kMaxCount = 100'000'000;

// The option of a member of SampleRequest: "cpa_time_s" is --cpa-time, "hmd_m" --hmd-m.
std::string option_of(std::string member) {
  if (member.ends_with("_s")) member.resize(member.size() - 2);
  std::replace(member.begin(), member.end(), '_', '-');
  return "--" + member;
}

struct Sample : sets::SampleRequest {
  Sample() { name_of = option_of; }
  std::string out;
  bool overwrite = false;
};

std::string words_of(const Sample& arguments, const sets::SetSummary& summary, double share) {
  std::string words = fmt::format("{}: {} {}, seed {}",
                                  arguments.out,
                                  summary.encounters,
                                  arguments.own.empty() ? "tracks" : "encounters",
                                  arguments.seed);
  if (arguments.is_geometric()) {
    if (summary.draws > summary.encounters)
      words += fmt::format("; {:.3f} draws an encounter",
                           double(summary.draws) / double(summary.encounters));
    return words;
  }
  if (share < 1)
    words += fmt::format("; the cut holds {:.3g} % of the model's traffic", 100 * share);
  words +=
      fmt::format("; {:.3f} draws a track", double(summary.draws) / double(summary.encounters));
  if (!arguments.own.empty())
    words += fmt::format("; weights sum to {:.6g} and tell as much as {:.0f} equal ones",
                         summary.weight_sum,
                         summary.effective_count());
  return words;
}

// Of weights that are not all 1. Files of waypoints hold no velocities either.
void warn_of_weights(tracks_file::TracksFormat format, const std::string& out, Console& console) {
  if (format != tracks_file::TracksFormat::kCsv)
    console.warning(out + ": a file of this format holds no weights; .csv does");
}

void sample(Sample arguments, Context& context) {
  RunFiles files;
  if (!arguments.is_geometric()) files.reads(arguments.model);
  files.reads(arguments.own).writes(arguments.out, arguments.overwrite);
  files.begin();
  const tracks_file::TracksFormat format = tracks_file::tracks_format_of(arguments.out);
  Console& console = context.console();
  const sets::SampledSet set = sets::sampled_set(arguments);
  follow(arguments, context, "drawing", "encounters");
  sets::SetSummary summary;
  files.write(arguments.out, [&](const std::filesystem::path& at) {
    summary = sets::write_set(at, set.draw, arguments);
  });
  files.commit();
  if (!arguments.own.empty() && !arguments.is_geometric())
    warn_of_weights(format, arguments.out, console);
  console.result(words_of(arguments, summary, set.share));
}

void add_cut_options(CLI::App& command, Sample& arguments) {
  command.add_option("--domain", arguments.domain, "Geographic domains of the model, from 1")
      ->expected(1, 100);
  command.add_option("--airspace", arguments.airspace, "Airspace classes of the model, from 1")
      ->expected(1, 100);
  command.add_option("--altitude-ft", arguments.altitude_ft)
      ->description("Lowest and highest altitude at the start")
      ->expected(2);
}

// Options of encounters. Each takes one value, or the edges of bins.
void add_pairing_options(CLI::App& command, Sample& arguments) {
  // Largest number of edges of bins: a choice.
  constexpr int kMaxEdges = 100;
  const auto edges = [&](const char* name, std::vector<double>& values, const char* text) {
    command.add_option(name, values, text)->expected(1, kMaxEdges);
  };
  command.add_option(
      "--own", arguments.own, "Pair each track with the first aircraft of this file of encounters");
  command.add_option("--cpa-time",
                     arguments.cpa_time_s,
                     "Time of the closest approach on the own track's clock, in s (default: its "
                     "middle)");
  edges("--hmd-m",
        arguments.hmd_m,
        "Horizontal miss distance: edges of bins (default: -500 500); negative on the left of a "
        "head-on encounter");
  edges(
      "--hmd-shares", arguments.hmd_shares, "Share of each of those bins (default: their widths)");
  edges("--vmd-m",
        arguments.vmd_m,
        "Vertical miss distance: edges of bins (default: -150 150); positive above");
  edges(
      "--vmd-shares", arguments.vmd_shares, "Share of each of those bins (default: their widths)");
  edges(
      "--course-deg",
      arguments.course_deg,
      "Of geometric: course relative to the own one, 180 head-on, 90 from the left (default: -180 "
      "180)");
  edges("--speed-mps", arguments.speed_mps, "Of geometric: horizontal speed (default: 30 80)");
  edges("--climb-mps", arguments.climb_mps, "Of geometric: climb (default: 0)");
  edges("--turn-rate-dps",
        arguments.turn_rate_dps,
        "Of geometric: turn to the right in degrees a second (default: 0)");
}

void add_sample(CLI::App& group, Context& context) {
  auto [command, arguments] = add_command(group, context, "sample", sample);
  command->description(
      "Draw tracks from an encounter model, alone or paired with an own track to encounters");
  command->add_option("MODEL", arguments->model)
      ->description(
          "Encounter model of MIT-LL (.txt), or the word geometric: steady flight from "
          "stated ranges, each covered evenly")
      ->required();
  command->add_option("-o,--out", arguments->out, "File to write: .csv, .daa, .txt or .dat")
      ->required();
  command->add_option("--count,-n", arguments->count, "Tracks or encounters (default: 100)")
      ->check(CLI::Range(std::int64_t{1}, kMaxCount));
  command->add_option("--seed", arguments->seed, "The same seed gives the same file (default: 1)");
  command->add_option("--duration", arguments->duration_s)
      ->description("Length of a track in s (default: that of the own track, else 60)")
      ->check(CLI::Range(1, encounter_model::kMaxDuration_s));
  add_cut_options(*command, *arguments);
  add_pairing_options(*command, *arguments);
  add_jobs(*command, arguments->jobs, "Threads (default: one per core)");
  command->add_flag("--overwrite", arguments->overwrite, "Replace the file if it exists");
}

struct Convert {
  std::string in;
  std::string out;
  std::size_t number = 0;  // 0: all
  bool overwrite = false;
};

void convert(const Convert& arguments, Context& context) {
  RunFiles files;
  files.reads(arguments.in).writes(arguments.out, arguments.overwrite);
  files.begin();
  const tracks_file::TracksFormat format = tracks_file::tracks_format_of(arguments.out);
  Console& console = context.console();
  std::vector<track::Encounter> encounters = tracks_file::read_encounters(arguments.in);
  if (arguments.number > encounters.size())
    throw Error(fmt::format("holds {} encounters; expected --encounter of 1 to {}",
                            encounters.size(),
                            encounters.size()),
                {arguments.in});
  if (arguments.number > 0) encounters = {encounters[arguments.number - 1]};
  if (context.stop.stop_requested()) throw Interrupted();
  const std::size_t count = encounters.size();
  encounters = tracks_file::fitted(std::move(encounters), format, arguments.out);
  if (std::ranges::any_of(encounters, [](const auto& each) { return each.weight != 1; }))
    warn_of_weights(format, arguments.out, console);
  files.write(arguments.out, [&](const std::filesystem::path& at) {
    tracks_file::write_encounters(at, encounters);
  });
  files.commit();
  console.result(
      fmt::format("{}: {} {}", arguments.out, count, count == 1 ? "encounter" : "encounters"));
}

void add_convert(CLI::App& group, Context& context) {
  auto [command, arguments] = add_command(group, context, "convert", convert);
  command->description("Write encounters in another format, which the extension of the file names");
  command->add_option("IN", arguments->in)
      ->description("Encounters: .csv (airtruth, MIT-LL's track), .daa, .txt or .dat")
      ->required();
  command->add_option("OUT", arguments->out)
      ->description(
          "File to write: .csv (airtruth), .daa (DAIDALUS), .txt (MIT-LL's table), .dat "
          "(MIT-LL's waypoints)")
      ->required();
  command->add_option("--encounter", arguments->number)
      ->description("Take this encounter alone, counted from 1; .daa and .txt hold one")
      ->check(above_0());
  command->add_flag("--overwrite", arguments->overwrite, "Replace the file if it exists");
}

}  // namespace

void add_encounter(CLI::App& app, Context& context) {
  auto* group = app.add_subcommand("encounter", "Encounters of aircraft, without pictures");
  group->require_subcommand(1);
  add_sample(*group, context);
  add_convert(*group, context);
}

}  // namespace airtruth::cli
