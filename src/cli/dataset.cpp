// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "cli/commands.h"
#include "dataset/build/build.h"
#include "dataset/build/inputs.h"
#include "dataset/build/plan.h"
#include "dataset/build/slurm.h"
#include "dataset/build/verify.h"
#include "dataset/labelled/export.h"
#include "dataset/labelled/import.h"
#include "dataset/set_report/report.h"
#include "foundation/base/error.h"
#include "foundation/base/median.h"
#include "foundation/base/text.h"
#include "foundation/run_files/run_files.h"

namespace airtruth::cli {
namespace {

struct Export {
  std::string set;
  std::string out;
  std::string format;
  std::string images;
  std::string split = "by-background";
  std::string boxes = "covered";
  std::vector<double> shares = {0.8, 0.1, 0.1};
  labelled::ExportOptions options;
};

// The value that an option names.
template <typename Enum>
Enum value_of(const char* option, const std::string& name, const char* expected) {
  if (const auto value = enum_named<Enum>(name)) return *value;
  throw Error(fmt::format("{} is '{}'; expected {}", option, name, expected));
}

void run_export(Export arguments, Context& context) {
  Console& console = context.console();
  labelled::ExportOptions& options = arguments.options;
  options.format = exchange::format_from_name(arguments.format);
  if (!arguments.images.empty())
    options.images = value_of<labelled::Images>("--images", arguments.images, "jpg, png or none");
  options.split =
      value_of<labelled::Split>("--split", arguments.split, "none, by-background or by-sequence");
  options.boxes = value_of<dataset::Boxes>("--boxes", arguments.boxes, "covered, exact or visible");
  double sum = 0;
  for (std::size_t i = 0; i < 3; ++i) sum += options.shares[i] = arguments.shares[i];
  if (!(sum > 0)) throw Error("--shares are all 0; expected a share for one part at least");
  for (double& share : options.shares) share /= sum;
  follow(options, context, "exporting", "sequences");
  const labelled::ExportSummary summary =
      labelled::export_set(arguments.set, arguments.out, options);
  std::string parts;
  for (const auto& [part, frames] : summary.frames_of_part)
    parts += fmt::format("{}{} {}", parts.empty() ? "" : ", ", part, frames);
  console.result(fmt::format("{}: {} sequences, {} frames ({}){}",
                             arguments.out,
                             summary.sequences,
                             summary.frames,
                             parts,
                             summary.was_there
                                 ? "; was there already"
                                 : fmt::format(", {} pictures written", summary.images)));
}

struct Import {
  std::string source;
  std::string out;
  std::string format;
  std::string size;
  std::vector<std::string> videos;
  std::vector<std::string> classes;
  std::vector<std::string> classes_of_categories;
  std::vector<std::string> start_frames;
  labelled::ImportOptions options;
};

// "[CLIP=]N".
std::pair<std::string, std::int64_t> start_frame_from(const std::string& text) {
  const std::size_t equals = text.rfind('=');
  const std::size_t digits = equals == std::string::npos ? 0 : equals + 1;
  const auto number = number_from_text<std::int64_t>(std::string_view(text).substr(digits));
  if (!number || *number < 0)
    throw Error("--start-frame is '" + text + "'; expected N or CLIP=N, a picture's number");
  return {digits == 0 ? std::string() : text.substr(0, equals), *number};
}

void run_import(Import arguments, Context& context) {
  Console& console = context.console();
  labelled::ImportOptions& options = arguments.options;
  options.format = exchange::format_from_name(arguments.format);
  if (!arguments.size.empty()) options.read.size = size_from(arguments.size);
  for (const std::string& given : arguments.videos) {
    const auto equals = given.find('=');
    if (equals == std::string::npos)
      options.videos[""] = given;
    else
      options.videos[given.substr(0, equals)] = given.substr(equals + 1);
  }
  for (const std::string& given : arguments.start_frames)
    options.read.start_frames.insert(start_frame_from(given));
  if (!arguments.start_frames.empty() && !exchange::is_single_object(options.format))
    throw Error("--start-frame is for otb, got10k and vot");
  for (const std::string& given : arguments.classes)
    options.classes.push_back(labelled::object_class_from(given));
  for (const std::string& given : arguments.classes_of_categories)
    options.read.class_of.insert(labelled::class_of_category_from(given));
  options.warn = console.warn();
  const labelled::ImportSummary summary =
      labelled::import_set(arguments.source, arguments.out, options);
  console.result(fmt::format("{}: {} clips, {} frames, {} boxes",
                             arguments.out,
                             summary.clips,
                             summary.frames,
                             summary.labels));
}

struct Report {
  std::string set;
  std::string out = "report.html";
  set_report::ReportOptions options;
};

void run_report(Report arguments, Context& context) {
  Console& console = context.console();
  RunFiles()
      .reads(arguments.set)
      .writes(arguments.out, arguments.options.overwrite, {".html", ".htm"})
      .check();
  follow(arguments.options, context, "looking", "sequences");
  set_report::write_report(arguments.set, arguments.out, arguments.options);
  console.result(arguments.out);
}

constexpr const char* kBothWays = "coco, yolo, mot, voc, cvat, aot, otb, got10k, vot";

void add_faintness(CLI::App& command, labelled::ExportOptions& options, Context& context) {
  command.add_option("--min-contrast", options.min_contrast)
      ->description(
          "Boxes with a lower contrast to noise count neither way: COCO's iscrowd, VOC's "
          "difficult and MOT's seventh column say so; others leave them out (default: 0)")
      ->check(CLI::Range(0.0, 1e6));
  command.add_option("--min-size", options.min_size_px)
      ->description("The same for boxes whose longer side has fewer pixels (default: 0)")
      ->check(CLI::Range(0.0, 1e6));
  command.add_flag("--drop-faint", options.drop_faint)
      ->description("Leave out what --min-contrast and --min-size refuse, in every format");
  const auto refuses = [&options] { return options.min_contrast > 0 || options.min_size_px > 0; };
  expect_effect(
      context, command, {"--drop-faint"}, "without --min-contrast or --min-size", refuses);
}

void add_export(CLI::App& group, Context& context) {
  auto [command, out] = add_command(group, context, "export", run_export);
  command->description("Write a data set in a format of others");
  command->add_option("DIR", out->set, "A data set, or a folder that `render` made")->required();
  command->add_option("--format,-f", out->format)
      ->description(std::string(kBothWays) + ", webdataset or table (CSV)")
      ->required();
  command
      ->add_option("--out,-o", out->out, "A new folder; an export that was stopped goes on in it")
      ->required();
  command->add_option("--images",
                      out->images,
                      "jpg (default; for aot, whose readers open no jpg: png), png or none (as a "
                      "table is)");
  command->add_option(
      "--boxes",
      out->boxes,
      "covered (default): the pixels that the aircraft covers, to train on; exact: its projected "
      "shape; visible: the pixels that changed, codec's ripple included");
  command->add_option("--every", out->options.every, "Take every n-th frame (default: 1)")
      ->check(above_0());
  command->add_option("--split",
                      out->split,
                      "by-background (default): a video is in one part alone; by-sequence; "
                      "none");
  command->add_option("--shares", out->shares, "Of train, val and test (default: 0.8 0.1 0.1)")
      ->expected(3)
      ->check(CLI::Range(0.0, 1e6));
  command->add_option("--seed", out->options.seed, "Of the split (default: 1)");
  const std::string& split = out->split;
  expect_effect(context, *command, {"--shares", "--seed"}, "with --split none", [&split] {
    return split != "none";
  });
  command->add_flag(
      "--one-class", out->options.one_class, "One class, `aircraft`, in place of the types");
  command->add_flag("--mot-classes",
                    out->options.mot_classes,
                    "Of mot: number the classes from 1 (default: 1 for every aircraft, the "
                    "one class that MOT17's evaluation counts)");
  add_faintness(*command, out->options, context);
  command->add_option("--shard-mb", out->options.shard_mb)
      ->description(
          "Of webdataset: a shard ends with the sample that makes it this large, in 10^6 "
          "bytes (default: 500)")
      ->check(CLI::Range(std::int64_t{1}, std::int64_t{1'000'000}));
  add_jobs(*command, out->options.jobs, "Sequences at a time (default: one per core)");
}

void add_report(CLI::App& group, Context& context) {
  auto [command, page] = add_command(group, context, "report", run_report);
  command->description("A page on a data set: what is in it, and each sequence");
  command->add_option("DIR", page->set, "A data set, or a folder that `render` made")->required();
  command->add_option("--out,-o", page->out, "The page (default: report.html)");
  command->add_flag("--overwrite", page->options.overwrite, "Replace the page if it is there");
  add_jobs(*command, page->options.jobs, "Sequences at a time (default: one per core)");
}

void add_import(CLI::App& group, Context& context) {
  auto [command, in] = add_command(group, context, "import", run_import);
  command->description("Import labelled video of others, to look at and to evaluate on");
  command->add_option("SOURCE", in->source, "Its folder, or its annotation file")->required();
  command->add_option("--format,-f", in->format)
      ->description(std::string(kBothWays) +
                    "; webdataset (labels alone), evision or csv (frame,x,y,w,h)")
      ->required();
  command->add_option("--out,-o", in->out, "A new folder")->required();
  command->add_option(
      "--video", in->videos, "CLIP=VIDEO, or VIDEO where there is one clip: where it is not found");
  command->add_option("--start-frame",
                      in->start_frames,
                      "[CLIP=]N, of otb, got10k and vot: the number of the first box's picture, "
                      "where there are more pictures than boxes");
  command->add_option("--size", in->size, "WxH of the pictures, where nothing says it");
  command->add_option("--origin", in->options.read.origin_px)
      ->description("Of csv: what the first pixel is called, 0 (default) or 1 (MATLAB)")
      ->check(CLI::Range(0, 1));
  const std::string& format = in->format;
  expect_effect(context, *command, {"--origin"}, "without --format csv", [&format] {
    return format == "csv";
  });
  command->add_option(
      "--category", in->options.read.category, "Where the labels name none (default: aircraft)");
  add_frame_rate(*command, in->options.frame_rate_hz);
  command->add_option("--class-of", in->classes_of_categories)
      ->description("CATEGORY=CLASS, for a category whose word states no class or another one");
  command->add_option("--class", in->classes)
      ->description(
          "What the objects are, where they are no aircraft: bird, multirotor, balloon, "
          "glint, dirt, insect, or ignore for regions that count neither way; "
          "CLIP=CLASS for clips whose name fits (* and ?). Boxes that the labels mark as counting "
          "neither way stay so");
}

struct DatasetArguments {
  std::string catalogue;
  std::string folder;
  std::vector<std::string> backgrounds;  // NAME=VIDEO
  build::BuildOptions build;
  build::SlurmOptions slurm;
  std::string array_size;
  bool on_slurm = false;
  bool finish = false;
  bool deep = false;
  std::int64_t deep_every = 30;
  int verify_jobs = 0;
};

std::map<std::string, std::filesystem::path> videos_of(
    const std::vector<std::string>& backgrounds) {
  std::map<std::string, std::filesystem::path> videos;
  for (const std::string& given : backgrounds) {
    const auto equals = given.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == given.size())
      throw Error("--background is '" + given + "'; expected NAME=VIDEO");
    videos[given.substr(0, equals)] = std::filesystem::absolute(given.substr(equals + 1));
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
  const catalogue::Catalogue catalogue = catalogue::read_catalogue(arguments.catalogue);
  Console& console = context.console();
  build::BuildOptions& options = arguments.build;
  options.videos = videos_of(arguments.backgrounds);
  options.warn = console.warn();
  options.stop = context.stop;
  options.progress = [&console](const build::BuildProgress& p) {
    console.progress(p.stage, p.done, p.total, p.stage == "building" ? "sequences" : "frames");
  };
  const build::BuildSummary summary = build::build_set(catalogue, arguments.folder, options);
  console.result(fmt::format("{}: {} sequences made ({} frames, {}), {} were there, {} failed{}",
                             arguments.folder,
                             summary.made,
                             summary.frames,
                             time_of(summary.seconds),
                             summary.kept,
                             summary.failures.size(),
                             summary.complete ? "; complete" : ""));
  for (const build::Failure& failure : summary.failures)
    console.error(failure.name + ": " + failure.reason);
  if (!summary.failures.empty()) context.exit_code = 1;
}

// "; bird 12, dirt 1"; empty where there is none.
std::string distractors_of(const scene::Scene& scene) {
  std::map<std::string, std::int64_t> counts;
  for (const scene::Intruder& intruder : scene.intruders)
    if (!is_aircraft(intruder)) ++counts[intruder.aircraft];
  for (const scene::LensMark& mark : scene.lens_marks) ++counts[enum_name(mark.kind)];
  std::string text;
  for (const auto& [kind, count] : counts)
    text += fmt::format("{} {} {}", text.empty() ? ";" : ",", kind, count);
  return text;
}

// "r000012   90  day   c172/news at 31 px"
std::string plan_line(const catalogue::Catalogue& catalogue, const catalogue::Item& item) {
  std::string aircraft;
  for (std::size_t k = 0; k < item.scene.intruders.size(); ++k) {
    if (!is_aircraft(item.scene.intruders[k])) continue;
    aircraft += (k > 0 ? ", " : "") + item.scene.intruders[k].aircraft;
    if (k >= item.drawn.encounters.size()) continue;
    const catalogue::Encounter& encounter = item.drawn.encounters[k];
    if (encounter.approach)
      aircraft += fmt::format(" nearest at {:.1f} s, on course {:.0f}",
                              item.scene.intruders[k].encounter->cpa_time_s,
                              encounter.approach->course_deg);
    else if (!encounter.seen.empty())
      aircraft += fmt::format(" seen at {} moments", encounter.seen.size());
    else
      aircraft += encounter.size_px ? fmt::format(" at {:.0f} px", *encounter.size_px)
                                    : fmt::format(" at {:.0f} m", *encounter.range_m);
  }
  return fmt::format("{:<28} {:>6}  {:<12} {}",
                     item.name,
                     item.frame_count > 0 ? std::to_string(item.frame_count) : "all",
                     catalogue.backgrounds[item.background].name,
                     (aircraft.empty() ? "no intruder" : aircraft) + distractors_of(item.scene));
}

// "8 to 120 px, half of them below 31 px"
std::string spread_words(const std::vector<double>& values, const char* unit) {
  const auto [low, high] = std::ranges::minmax(values);
  return fmt::format(
      "{:.0f} to {:.0f} {}, half of them below {:.0f} {}", low, high, unit, median(values), unit);
}

void say_what_is_drawn(const build::Plan& plan, Console& console) {
  std::string types;
  std::size_t liveries = 0;
  for (const auto& [type, by_livery] : plan.aircraft) {
    std::int64_t count = 0;
    for (const auto& [livery, of_livery] : by_livery) count += of_livery;
    liveries += by_livery.size();
    types += fmt::format("{}{} {}", types.empty() ? "" : ", ", type, count);
  }
  console.result(fmt::format("intruders: {} in {} sequences; {} sequences without one",
                             plan.intruders,
                             plan.sequences - plan.negatives,
                             plan.negatives));
  std::string distractors;
  for (const auto& [kind, count] : plan.distractors)
    distractors += fmt::format("{}{} {}", distractors.empty() ? "" : ", ", kind, count);
  if (!distractors.empty()) console.result("distractors: " + distractors);
  if (!types.empty())
    console.result(
        fmt::format("types: {} ({} types, {} liveries)", types, plan.aircraft.size(), liveries));
  if (!plan.sizes_px.empty()) console.result("sizes: " + spread_words(plan.sizes_px, "px"));
  if (!plan.ranges_m.empty()) console.result("ranges: " + spread_words(plan.ranges_m, "m"));
  if (plan.draws > 0)
    console.result(fmt::format("in view: {} draws for the intruders of encounter models; {} never",
                               plan.draws,
                               plan.never_in_view));
  if (plan.not_flyable == 0) return;
  for (const std::string& words : plan.not_flyable_words) console.warning(words);
  console.warning(fmt::format("{} of {} intruders have a path that their type cannot fly",
                              plan.not_flyable,
                              plan.intruders));
}

// Frames and bytes are rounded, because the cost of a sequence is known only after it is made.
void plan(const DatasetArguments& arguments, Context& context) {
  const catalogue::Catalogue catalogue = build::with_videos(
      catalogue::read_catalogue(arguments.catalogue), videos_of(arguments.backgrounds));
  build::check_sources(catalogue);
  // Number of sequences that are listed: a display choice.
  constexpr std::int64_t kMaxListed = 50;
  Console& console = context.console();
  const auto list = [&](const catalogue::Item& item) {
    if (item.index < kMaxListed) console.result(plan_line(catalogue, item));
  };
  const build::Plan plan = build::plan_of(catalogue, list, context.stop);
  if (plan.sequences > kMaxListed)
    console.result(fmt::format("... and {} more", plan.sequences - kMaxListed));
  say_what_is_drawn(plan, console);
  const std::string measuring =
      plan.calibration_s > 0
          ? fmt::format(", {} of them to measure cameras", time_of(plan.calibration_s))
          : "";
  console.result(fmt::format(
      "{} sequences, {} frames{}: about {} of one core{}, {}",
      plan.sequences,
      plan.frames,
      plan.open_ended > 0 ? fmt::format(" and {} videos to their end", plan.open_ended) : "",
      time_of(plan.core_s),
      measuring,
      plan.bytes < 1e9    ? fmt::format("{:.0f} MB", plan.bytes / 1e6)
      : plan.bytes < 1e12 ? fmt::format("{:.1f} GB", plan.bytes / 1e9)
                          : fmt::format("{:.1f} TB", plan.bytes / 1e12)));
}

void status(const DatasetArguments& arguments, Context& context) {
  const build::Status status = build::status(arguments.folder);
  Console& console = context.console();
  console.result(fmt::format("{}: {} of {} sequences are there{}{}{}",
                             status.name,
                             status.whole,
                             status.sequences,
                             status.half > 0 ? fmt::format(", {} begun", status.half) : "",
                             status.at_work ? ", a build is at work" : "",
                             status.complete ? "; complete" : ""));
  std::string violated;
  for (const auto& [name, sequences] : status.violated)
    violated += fmt::format("{}{} in {}", violated.empty() ? "" : ", ", name, sequences);
  if (!violated.empty()) console.result("  volumes violated, in sequences: " + violated);
  for (const std::string& name : status.missing) console.result("  missing: " + name);
  const auto named = static_cast<std::int64_t>(status.missing.size());
  if (status.not_there > named)
    console.result(fmt::format("  ... and {} more", status.not_there - named));
}

void submit(DatasetArguments arguments, Context& context) {
  if (!arguments.on_slurm) throw Error("no engine is named; expected --slurm");
  const catalogue::Catalogue catalogue = catalogue::read_catalogue(arguments.catalogue);
  build::SlurmOptions& options = arguments.slurm;
  if (!arguments.array_size.empty()) try {
      options.array = catalogue::array_size_of(arguments.array_size);
    } catch (const Error& error) {
      throw Error("--array-size: " + error.message());
    }
  options.videos = videos_of(arguments.backgrounds);
  options.program = std::filesystem::read_symlink("/proc/self/exe");
  const build::Submitted submitted = build::submit(catalogue, arguments.folder, options);
  if (options.dry_run)
    context.console().result("not submitted: sbatch " + submitted.work_script.string() + ", then " +
                             submitted.verify_script.string());
  else
    context.console().result("submitted as " + submitted.work_job + ", verified by " +
                             submitted.verify_job);
}

void verify(const DatasetArguments& arguments, Context& context) {
  Console& console = context.console();
  if (arguments.finish && !build::finish(arguments.folder))
    console.warning("sequences are missing; no manifest is written");
  build::VerifyOptions options;
  follow(options, context, "verifying", "sequences");
  options.jobs = arguments.verify_jobs;
  if (arguments.deep) options.deep_every = arguments.deep_every;
  const build::VerifyResult result = build::verify(arguments.folder, options);
  for (const std::string& fault : result.faults) console.error(fault);
  console.result(fmt::format(
      "{}: {} sequences{}, {} frames, intruders and distractors in view by geometry {} times "
      "({} without a box){}, {} faults",
      arguments.folder,
      result.sequences,
      result.not_there > 0 ? fmt::format(", {} of them not there", result.not_there) : "",
      result.frames,
      result.in_view,
      result.in_view_without_box,
      arguments.deep ? fmt::format(", {} drawn anew", result.recomposed) : "",
      result.faults.size()));
  if (!result.faults.empty()) context.exit_code = 1;
}

void add_folder_size(CLI::App& command, std::int64_t& max_in_a_folder) {
  command.add_option("--folder-size", max_in_a_folder)
      ->description(
          "A set of more sequences has them in numbered folders with as many each; decided "
          "when the set is begun (default: 4,000)")
      ->check(CLI::Range(1, 1'000'000));
}

void add_backgrounds(CLI::App& command, std::vector<std::string>& backgrounds) {
  command.add_option(
      "--background", backgrounds, "NAME=VIDEO: a video in place of a background of the catalogue");
}

void add_build_options(CLI::App& command, DatasetArguments& arguments) {
  command.add_option("CATALOGUE", arguments.catalogue, "Catalogue file (.toml); see catalogues/")
      ->required();
  command.add_option("--out,-o", arguments.folder)
      ->description("The data set's folder; a build that was stopped goes on in it")
      ->required();
  add_jobs(command, arguments.build.jobs, "Sequences at a time (default: one per core)");
  add_backgrounds(command, arguments.backgrounds);
  add_folder_size(command, arguments.build.max_in_a_folder);
}

void add_build(CLI::App& group, Context& context) {
  auto [command, arguments] = add_command(group, context, "build", build);
  command->description("Make every sequence of a catalogue that is not there yet");
  add_build_options(*command, *arguments);
  command->add_option(
      "--only", arguments->build.only, "Only sequences whose name fits this pattern (* and ?)");
}

void work(const DatasetArguments& arguments, Context& context) {
  const build::BuildOptions& options = arguments.build;
  if (options.share >= options.shares)
    throw Error(fmt::format("--index is {} of {}; expected 0 to {}",
                            options.share,
                            options.shares,
                            options.shares - 1));
  build(arguments, context);
}

void add_work(CLI::App& group, Context& context) {
  auto [command, arguments] = add_command(group, context, "work", work);
  command->description("One worker's share of a build, for job arrays");
  add_build_options(*command, *arguments);
  command->add_option("--index", arguments->build.share, "This worker's number, from 0")
      ->required()
      ->check(CLI::Range(0, 1'000'000'000));
  command->add_option("--of", arguments->build.shares, "How many workers there are")
      ->required()
      ->check(above_0());
}

void add_plan(CLI::App& group, Context& context) {
  auto [command, arguments] = add_command(group, context, "plan", plan);
  command->description("Say what a catalogue would make, how long and how large");
  command->add_option("CATALOGUE", arguments->catalogue, "Catalogue file (.toml)")->required();
  add_backgrounds(*command, arguments->backgrounds);
}

void add_status(CLI::App& group, Context& context) {
  auto [command, arguments] = add_command(group, context, "status", status);
  command->description("Say how far a data set is");
  command->add_option("DIR", arguments->folder, "The data set's folder")->required();
}

void add_verify(CLI::App& group, Context& context) {
  auto [command, arguments] = add_command(group, context, "verify", verify);
  command->description("Check every file, label and frame count of a data set");
  command->add_option("DIR", arguments->folder, "The data set's folder")->required();
  command->add_flag("--finish", arguments->finish)
      ->description("First write the manifest, where several workers made the sequences");
  command->add_flag(
      "--deep", arguments->deep, "Also draw sampled frames anew and compare them with the videos");
  command->add_option("--every", arguments->deep_every)
      ->description("With --deep: every n-th frame (default: 30)")
      ->check(above_0());
  const bool& is_deep = arguments->deep;
  expect_effect(context, *command, {"--every"}, "without --deep", [&is_deep] { return is_deep; });
  add_jobs(*command, arguments->verify_jobs, "Sequences at a time (default: one per core)");
}

void add_submit(CLI::App& group, Context& context) {
  auto [command, arguments] = add_command(group, context, "submit", submit);
  command->description("Have a cluster make a data set");
  command->add_option("CATALOGUE", arguments->catalogue, "Catalogue file (.toml)")->required();
  command->add_option("--out,-o", arguments->folder)
      ->description("The data set's folder, on a file system that all nodes see")
      ->required();
  command->add_flag(
      "--slurm", arguments->on_slurm, "As a Slurm job array, with a job after it that verifies");
  command->add_option("--array-size", arguments->array_size)
      ->description(
          "Tasks N (default: one per sequence, at most 1,000), and how many of them run "
          "at a time: N, N%M or %M");
  add_folder_size(*command, arguments->slurm.max_in_a_folder);
  command->add_option("--partition", arguments->slurm.partition, "Slurm partition");
  command->add_option("--sbatch", arguments->slurm.sbatch)
      ->description(
          "An option for sbatch, as \"--time=2:00:00\", \"--mem=4G\" or "
          "\"--account=NAME\"; give it again for more. It counts before [slurm] of the "
          "catalogue")
      ->allow_extra_args(false)
      ->take_all();
  add_backgrounds(*command, arguments->backgrounds);
  command->add_flag("--dry-run", arguments->slurm.dry_run, "Write the scripts and submit nothing");
}

}  // namespace

void add_dataset(CLI::App& app, Context& context) {
  auto* group = app.add_subcommand("dataset", "Make, maintain and check whole data sets");
  group->require_subcommand(1);
  add_build(*group, context);
  add_work(*group, context);
  add_plan(*group, context);
  add_status(*group, context);
  add_verify(*group, context);
  add_export(*group, context);
  add_report(*group, context);
  add_import(*group, context);
  add_submit(*group, context);
}

}  // namespace airtruth::cli
