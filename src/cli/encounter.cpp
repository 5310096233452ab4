// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "cli/commands.h"
#include "encounter/sets/write_set.h"
#include "encounter/tracks_file/tracks_file.h"
#include "foundation/base/error.h"
#include "foundation/run_files/run_files.h"

namespace airtruth::cli {
namespace {

constexpr const char* kGeometric = "geometric";
// Largest number of encounters: a choice.
constexpr std::int64_t kMaxCount = 100'000'000;
// The length of a track where nothing states it.
constexpr int kDuration_s = 60;

struct Sample {
  std::string model;
  std::string out;
  std::string own;
  std::int64_t count = 100;
  std::uint64_t seed = 1;
  int duration_s = 0;  // 0: not stated
  int jobs = 0;
  bool overwrite = false;
  std::vector<std::size_t> domains, airspaces;
  std::vector<double> altitude_ft;
  std::optional<double> cpa_time_s;
  std::vector<double> hmd_m{-500, 500}, hmd_shares, vmd_m{-150, 150}, vmd_shares;
  std::vector<double> course_deg{-180, 180}, speed_mps{30, 80}, climb_mps{0}, turn_rate_dps{0};

  bool is_geometric() const { return model == kGeometric; }
};

track::Track own_track(const std::string& file) {
  track::Track own = tracks_file::read_encounters(file).front().aircraft.front();
  if (own.size() < 2)
    throw Error("the own aircraft has one sample; expected a track of two or more", {file});
  return own;
}

// Whole seconds that the intruder flies: stated, or those of the own track.
int duration_of(const Sample& arguments, const std::optional<track::Track>& own) {
  if (arguments.duration_s > 0) return arguments.duration_s;
  if (!own) return kDuration_s;
  const double length_s = std::ceil(own->times_s.back() - own->times_s.front());
  if (length_s > encounter_model::kMaxDuration_s)
    throw Error(fmt::format("the own track is {} s long; expected up to {} s, or --duration",
                            length_s,
                            encounter_model::kMaxDuration_s),
                {arguments.own});
  return static_cast<int>(length_s);
}

double cpa_time_of(const Sample& arguments, const track::Track& own) {
  return arguments.cpa_time_s.value_or((own.times_s.front() + own.times_s.back()) / 2);
}

sets::DrawEncounter geometric(const Sample& arguments, const track::Track& own) {
  const pairing::GeometricOptions options{
      .course_deg = pairing::Distribution(arguments.course_deg, {}, "--course-deg"),
      .speed_mps = pairing::Distribution(arguments.speed_mps, {}, "--speed-mps"),
      .hmd_m = pairing::Distribution(arguments.hmd_m, arguments.hmd_shares, "--hmd-m"),
      .vmd_m = pairing::Distribution(arguments.vmd_m, arguments.vmd_shares, "--vmd-m"),
      .climb_mps = pairing::Distribution(arguments.climb_mps, {}, "--climb-mps"),
      .turn_rate_dps = pairing::Distribution(arguments.turn_rate_dps, {}, "--turn-rate-dps"),
      .cpa_time_s = pairing::Distribution({cpa_time_of(arguments, own)}, {}, "--cpa-time")};
  return sets::geometric_pairs(
      pairing::GeometricSampler(
          options, arguments.seed, static_cast<std::uint64_t>(arguments.count)),
      own);
}

std::shared_ptr<const encounter_model::Sampler> sampler_of(const Sample& arguments,
                                                           const std::optional<track::Track>& own) {
  encounter_model::SampleOptions options{
      arguments.seed, duration_of(arguments, own), {arguments.domains, arguments.airspaces, {}}};
  if (!arguments.altitude_ft.empty())
    options.cut.altitude_ft = {arguments.altitude_ft[0], arguments.altitude_ft[1]};
  return std::make_shared<const encounter_model::Sampler>(
      encounter_model::read_model(arguments.model), options);
}

pairing::PairingOptions pairing_of(const Sample& arguments, const track::Track& own) {
  pairing::PairingOptions options;
  options.cpa_time_s = cpa_time_of(arguments, own);
  options.hmd_m = pairing::Distribution(arguments.hmd_m, arguments.hmd_shares, "--hmd-m");
  options.vmd_m = pairing::Distribution(arguments.vmd_m, arguments.vmd_shares, "--vmd-m");
  return options;
}

// An option that has no effect is refused, so that nobody relies on it.
void refuse_unused(const CLI::App& command, const Sample& arguments) {
  const auto refuse = [&](std::initializer_list<const char*> options, const char* why) {
    for (const char* option : options)
      if (command.count(option) > 0) throw Error(fmt::format("{} {}", option, why));
  };
  if (arguments.is_geometric())
    refuse({"--duration", "--domain", "--airspace", "--altitude-ft"},
           "belongs to an encounter model; MODEL is geometric");
  else
    refuse({"--course-deg", "--speed-mps", "--climb-mps", "--turn-rate-dps"},
           "belongs to geometric encounters; MODEL is a file");
  if (arguments.own.empty())
    refuse({"--cpa-time", "--hmd-m", "--hmd-shares", "--vmd-m", "--vmd-shares"},
           "belongs to encounters; expected --own, the track to pair with");
}

std::string words_of(const Sample& arguments, const sets::SetSummary& summary, double share) {
  std::string words = fmt::format("{}: {} {}, seed {}",
                                  arguments.out,
                                  summary.encounters,
                                  arguments.own.empty() ? "tracks" : "encounters",
                                  arguments.seed);
  if (arguments.is_geometric()) return words;
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

void sample(const Sample& arguments, Context& context) {
  RunFiles files;
  if (!arguments.is_geometric()) files.reads(arguments.model);
  files.reads(arguments.own).writes(arguments.out, arguments.overwrite);
  files.begin();
  const tracks_file::TracksFormat format = tracks_file::tracks_format_of(arguments.out);
  if (arguments.is_geometric() && arguments.own.empty())
    throw Error("--own is missing; geometric encounters are placed about an own track");
  Console& console = context.console();
  std::optional<track::Track> own;
  if (!arguments.own.empty()) own = own_track(arguments.own);
  sets::DrawEncounter draw;
  double share = 1;
  if (arguments.is_geometric()) {
    draw = geometric(arguments, *own);
  } else {
    const auto sampler = sampler_of(arguments, own);
    share = sampler->share();
    draw = own ? sets::model_pairs(sampler, *own, pairing_of(arguments, *own), arguments.seed)
               : sets::model_tracks(sampler);
  }
  sets::SetOptions options;
  options.count = static_cast<std::uint64_t>(arguments.count);
  options.jobs = arguments.jobs;
  follow(options, context, "drawing", "encounters");
  sets::SetSummary summary;
  files.write(arguments.out, [&](const std::filesystem::path& at) {
    summary = sets::write_set(at, draw, options);
  });
  files.commit();
  if (own && !arguments.is_geometric() && format != tracks_file::TracksFormat::kCsv)
    console.warning(arguments.out + ": a file of this format holds no weights; .csv does");
  console.result(words_of(arguments, summary, share));
}

void add_cut_options(CLI::App& command, Sample& arguments) {
  command.add_option("--domain", arguments.domains, "Geographic domains of the model, from 1")
      ->expected(1, 100);
  command.add_option("--airspace", arguments.airspaces, "Airspace classes of the model, from 1")
      ->expected(1, 100);
  command
      .add_option(
          "--altitude-ft", arguments.altitude_ft, "Lowest and highest altitude at the start")
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
  auto arguments = std::make_shared<Sample>();
  auto* command = group.add_subcommand(
      "sample",
      "Draw tracks from an encounter model, alone or paired with an own track to encounters");
  command
      ->add_option("MODEL",
                   arguments->model,
                   "Encounter model of MIT-LL (.txt), or the word geometric: steady flight from "
                   "stated ranges, each covered evenly")
      ->required();
  command->add_option("-o,--out", arguments->out, "File to write: .csv, .daa, .txt or .dat")
      ->required();
  command->add_option("--count,-n", arguments->count, "Tracks or encounters (default: 100)")
      ->check(CLI::Range(std::int64_t{1}, kMaxCount));
  command->add_option("--seed", arguments->seed, "The same seed gives the same file (default: 1)");
  command
      ->add_option("--duration",
                   arguments->duration_s,
                   "Length of a track in s (default: that of the own track, else 60)")
      ->check(CLI::Range(1, encounter_model::kMaxDuration_s));
  add_cut_options(*command, *arguments);
  add_pairing_options(*command, *arguments);
  add_jobs(*command, arguments->jobs, "Threads (default: one per core)");
  command->add_flag("--overwrite", arguments->overwrite, "Replace the file if it exists");
  command->callback([arguments, command, &context] {
    refuse_unused(*command, *arguments);
    sample(*arguments, context);
  });
}

struct Convert {
  std::string in;
  std::string out;
  std::size_t number = 0;  // 0: all
  bool overwrite = false;
};

// Files of waypoints hold neither weights nor velocities; other formats than CSV no weights.
void warn_of_losses(const std::vector<track::Encounter>& encounters,
                    tracks_file::TracksFormat format,
                    const std::string& out,
                    Console& console) {
  if (format == tracks_file::TracksFormat::kCsv) return;
  for (const track::Encounter& each : encounters)
    if (each.weight != 1) {
      console.warning(out + ": a file of this format holds no weights; .csv does");
      return;
    }
}

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
  warn_of_losses(encounters, format, arguments.out, console);
  files.write(arguments.out, [&](const std::filesystem::path& at) {
    tracks_file::write_encounters(at, encounters);
  });
  files.commit();
  console.result(
      fmt::format("{}: {} {}", arguments.out, count, count == 1 ? "encounter" : "encounters"));
}

void add_convert(CLI::App& group, Context& context) {
  auto [command, arguments] =
      add_command(group,
                  context,
                  "convert",
                  "Write encounters in another format, which the extension of the file names",
                  convert);
  command
      ->add_option(
          "IN", arguments->in, "Encounters: .csv (airtruth, MIT-LL's track), .daa, .txt or .dat")
      ->required();
  command
      ->add_option("OUT",
                   arguments->out,
                   "File to write: .csv (airtruth), .daa (DAIDALUS), .txt (MIT-LL's table), .dat "
                   "(MIT-LL's waypoints)")
      ->required();
  command
      ->add_option("--encounter",
                   arguments->number,
                   "Take this encounter alone, counted from 1; .daa and .txt hold one")
      ->check(CLI::PositiveNumber);
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
