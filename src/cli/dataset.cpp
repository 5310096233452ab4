// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include <fmt/format.h>

#include "base/error.h"
#include "cli/commands.h"
#include "dataset/build.h"
#include "dataset/check.h"
#include "dataset/slurm.h"
#include "dataset/verify.h"
#include "synthetic/flight.h"

namespace airtruth::cli {
namespace {

struct DatasetArguments {
  std::string catalogue;
  std::string folder;
  std::vector<std::string> backgrounds;  // NAME=VIDEO
  dataset::BuildOptions build;
  dataset::SlurmOptions slurm;
  bool on_slurm = false;
  bool finish = false;
  bool deep = false;
  std::int64_t deep_every = 30;
};

std::map<std::string, dataset::fs::path> videos_of(const std::vector<std::string>& backgrounds) {
  std::map<std::string, dataset::fs::path> videos;
  for (const std::string& given : backgrounds) {
    const auto equals = given.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == given.size())
      throw Error("--background is '" + given + "'; expected NAME=VIDEO");
    videos[given.substr(0, equals)] = dataset::fs::absolute(given.substr(equals + 1));
  }
  return videos;
}

std::string time_of(double seconds) {
  const auto s = static_cast<std::int64_t>(seconds + 0.5);
  if (s < 60) return fmt::format("{} s", s);
  if (s < 2 * 3600) return fmt::format("{}:{:02} min", s / 60, s % 60);
  return s < 4 * 86400 ? fmt::format("{} hours", (s + 1800) / 3600)
                       : fmt::format("{} days", (s + 43200) / 86400);
}

void build(DatasetArguments arguments, Context& context) {
  const dataset::Catalogue catalogue = dataset::read_catalogue(arguments.catalogue);
  Console& console = context.console();
  dataset::BuildOptions& options = arguments.build;
  options.videos = videos_of(arguments.backgrounds);
  options.warn = console.warn();
  options.stop = context.stop;
  options.progress = [&console](const dataset::BuildProgress& p) {
    console.progress(p.stage, p.done, p.total, p.stage == "building" ? "sequences" : "frames");
  };
  const dataset::BuildSummary summary = dataset::build(catalogue, arguments.folder, options);
  console.result(fmt::format("{}: {} sequences made ({} frames, {}), {} were there, {} failed{}",
                             arguments.folder,
                             summary.made,
                             summary.frames,
                             time_of(summary.seconds),
                             summary.kept,
                             summary.failures.size(),
                             summary.complete ? "; complete" : ""));
  for (const dataset::Failure& failure : summary.failures)
    console.error(failure.name + ": " + failure.reason);
  if (!summary.failures.empty()) context.exit_code = 1;
}

// What a frame of 1280x960 costs (docs/scaling.md); others by their pixels.
constexpr double kCoreSecondsPerFrame = 0.034;
constexpr double kCoreSecondsPerFlownFrame = 0.16;
constexpr double kBytesPerFrame = 15'000;
constexpr double kBytesPerSequence = 580'000;  // preview.jpg

// Frames and bytes in round numbers: what a sequence costs is known only once it is made.
void plan(const DatasetArguments& arguments, Context& context) {
  const dataset::Catalogue catalogue = dataset::read_catalogue(arguments.catalogue);
  dataset::check_sources(catalogue, {});
  const dataset::Expansion expansion(catalogue);
  constexpr std::int64_t kMostListed = 50;
  std::vector<double> size_of;  // of each background's frame, in frames of 1280x960
  double core_s = 0;
  for (const dataset::Background& background : catalogue.backgrounds) {
    const auto* flight = std::get_if<synthetic::FlightOptions>(&background.source);
    size_of.push_back(flight != nullptr ? flight->width * flight->height / (1280.0 * 960.0) : 1);
    if (flight != nullptr)
      core_s += flight->frame_count * size_of.back() * kCoreSecondsPerFlownFrame;
  }
  std::int64_t frames = 0;
  std::int64_t open_ended = 0;
  double bytes = 0;
  Console& console = context.console();
  for (std::int64_t i = 0; i < expansion.size(); ++i) {
    if (context.stop.stop_requested()) throw Interrupted();
    const dataset::Item item = expansion.at(i);
    const double size = static_cast<double>(item.frame_count) * size_of[item.background];
    frames += item.frame_count;
    core_s += size * kCoreSecondsPerFrame;
    bytes += size * kBytesPerFrame + kBytesPerSequence * size_of[item.background];
    open_ended += item.frame_count == 0 ? 1 : 0;
    if (i >= kMostListed) continue;
    console.result(fmt::format("{:<28} {:>6}  {:<12} {}",
                               item.name,
                               item.frame_count > 0 ? std::to_string(item.frame_count) : "all",
                               catalogue.backgrounds[item.background].name,
                               item.scene.intruders[0].aircraft));
  }
  if (expansion.size() > kMostListed)
    console.result(fmt::format("... and {} more", expansion.size() - kMostListed));
  console.result(
      fmt::format("{} sequences, {} frames{}: about {} of one core, {}",
                  expansion.size(),
                  frames,
                  open_ended > 0 ? fmt::format(" and {} videos to their end", open_ended) : "",
                  time_of(core_s),
                  bytes < 1e9    ? fmt::format("{:.0f} MB", bytes / 1e6)
                  : bytes < 1e12 ? fmt::format("{:.1f} GB", bytes / 1e9)
                                 : fmt::format("{:.1f} TB", bytes / 1e12)));
}

void status(const DatasetArguments& arguments, Context& context) {
  const dataset::Status status = dataset::status(arguments.folder);
  Console& console = context.console();
  console.result(fmt::format("{}: {} of {} sequences are there{}{}{}",
                             status.name,
                             status.whole,
                             status.sequences,
                             status.half > 0 ? fmt::format(", {} begun", status.half) : "",
                             status.at_work ? ", a build is at work" : "",
                             status.complete ? "; complete" : ""));
  for (const std::string& name : status.missing) console.result("  missing: " + name);
}

void submit(DatasetArguments arguments, Context& context) {
  if (!arguments.on_slurm) throw Error("no engine is named; expected --slurm");
  const dataset::Catalogue catalogue = dataset::read_catalogue(arguments.catalogue);
  dataset::SlurmOptions& options = arguments.slurm;
  options.videos = videos_of(arguments.backgrounds);
  options.program = dataset::fs::read_symlink("/proc/self/exe");
  const dataset::Submitted submitted = dataset::submit(catalogue, arguments.folder, options);
  if (options.dry_run)
    context.console().result("not submitted: sbatch " + submitted.work_script.string() + ", then " +
                             submitted.verify_script.string());
  else
    context.console().result("submitted as " + submitted.work_job + ", verified by " +
                             submitted.verify_job);
}

void verify(const DatasetArguments& arguments, Context& context) {
  Console& console = context.console();
  if (arguments.finish && !dataset::finish(arguments.folder))
    console.warning("sequences are missing; no manifest is written");
  dataset::VerifyOptions options;
  options.stop = context.stop;
  options.progress = [&console](std::int64_t done, std::int64_t total) {
    console.progress("verifying", done, total, "sequences");
  };
  if (arguments.deep) options.deep_every = arguments.deep_every;
  const dataset::VerifyResult result = dataset::verify(arguments.folder, options);
  for (const std::string& fault : result.faults) console.error(fault);
  console.result(fmt::format(
      "{}: {} sequences, {} frames, an intruder in view by geometry {} times ({} without "
      "a box){}, {} faults",
      arguments.folder,
      result.sequences,
      result.frames,
      result.in_view,
      result.in_view_without_box,
      arguments.deep ? fmt::format(", {} drawn anew", result.recomposed) : "",
      result.faults.size()));
  if (!result.faults.empty()) context.exit_code = 1;
}

void add_build_options(CLI::App& command, DatasetArguments& arguments) {
  command.add_option("CATALOGUE", arguments.catalogue, "Catalogue file (.toml); see catalogues/")
      ->required();
  command
      .add_option("--out,-o",
                  arguments.folder,
                  "The data set's folder; a build that was stopped goes on in it")
      ->required();
  command
      .add_option("--jobs,-j", arguments.build.jobs, "Sequences at a time (default: one per core)")
      ->check(CLI::Range(1, 1024));
  command.add_option("--background",
                     arguments.backgrounds,
                     "NAME=VIDEO: a video in place of a background of the catalogue");
}

}  // namespace

void add_dataset(CLI::App& app, Context& context) {
  auto* group = app.add_subcommand("dataset", "Make, look after and check whole data sets");
  group->require_subcommand(1);
  auto arguments = std::make_shared<DatasetArguments>();
  auto* build_command =
      group->add_subcommand("build", "Make every sequence of a catalogue that is not there yet");
  add_build_options(*build_command, *arguments);
  build_command->add_option(
      "--only", arguments->build.only, "Only sequences whose name fits this pattern (* and ?)");
  build_command->callback([arguments, &context] { build(*arguments, context); });
  auto* work_command =
      group->add_subcommand("work", "One worker's share of a build, for job arrays");
  add_build_options(*work_command, *arguments);
  work_command->add_option("--index", arguments->build.share, "This worker's number, from 0")
      ->required()
      ->check(CLI::NonNegativeNumber);
  work_command->add_option("--of", arguments->build.shares, "How many workers there are")
      ->required()
      ->check(CLI::PositiveNumber);
  work_command->callback([arguments, &context] {
    if (arguments->build.share >= arguments->build.shares)
      throw Error(fmt::format("--index is {} of {}; expected 0 to {}",
                              arguments->build.share,
                              arguments->build.shares,
                              arguments->build.shares - 1));
    build(*arguments, context);
  });
  auto* plan_command =
      group->add_subcommand("plan", "Say what a catalogue would make, how long and how large");
  plan_command->add_option("CATALOGUE", arguments->catalogue, "Catalogue file (.toml)")->required();
  plan_command->callback([arguments, &context] { plan(*arguments, context); });
  auto* status_command = group->add_subcommand("status", "Say how far a data set is");
  status_command->add_option("DIR", arguments->folder, "The data set's folder")->required();
  status_command->callback([arguments, &context] { status(*arguments, context); });
  auto* verify_command =
      group->add_subcommand("verify", "Check every file, label and frame count of a data set");
  verify_command->add_option("DIR", arguments->folder, "The data set's folder")->required();
  verify_command->add_flag("--finish",
                           arguments->finish,
                           "First write the manifest, where several workers made the sequences");
  verify_command->add_flag(
      "--deep", arguments->deep, "Also draw sampled frames anew and compare them with the videos");
  verify_command
      ->add_option("--every", arguments->deep_every, "With --deep: every n-th frame (default: 30)")
      ->check(CLI::PositiveNumber);
  verify_command->callback([arguments, &context] { verify(*arguments, context); });
  add_dataset_exchange(*group, context);
  auto* submit_command = group->add_subcommand("submit", "Have a cluster make a data set");
  submit_command->add_option("CATALOGUE", arguments->catalogue, "Catalogue file (.toml)")
      ->required();
  submit_command
      ->add_option("--out,-o",
                   arguments->folder,
                   "The data set's folder, on a file system that all nodes see")
      ->required();
  submit_command->add_flag(
      "--slurm", arguments->on_slurm, "As a Slurm job array, with a job after it that verifies");
  submit_command
      ->add_option("--array-size",
                   arguments->slurm.array_size,
                   "Tasks (default: one per sequence, at most 1,000)")
      ->check(CLI::Range(1, 100000));
  submit_command->add_option("--partition", arguments->slurm.partition, "Slurm partition");
  submit_command
      ->add_option("--sbatch",
                   arguments->slurm.sbatch,
                   "An option for sbatch, as \"--time=2:00:00\", \"--mem=4G\" or "
                   "\"--account=NAME\"; give it again for more. It counts before [slurm] of the "
                   "catalogue")
      ->allow_extra_args(false)
      ->take_all();
  submit_command->add_option("--background",
                             arguments->backgrounds,
                             "NAME=VIDEO: a video in place of a background of the catalogue");
  submit_command->add_flag(
      "--dry-run", arguments->slurm.dry_run, "Write the scripts and submit nothing");
  submit_command->callback([arguments, &context] { submit(*arguments, context); });
}

}  // namespace airtruth::cli
