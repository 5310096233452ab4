// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include <fmt/format.h>

#include "cli/commands.h"
#include "cli/picture_size.h"
#include "dataset/labelled/export.h"
#include "dataset/labelled/import.h"
#include "dataset/set_report/report.h"
#include "foundation/base/error.h"

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
  options.warn = console.warn();
  options.stop = context.stop;
  options.progress = [&console](std::int64_t done, std::int64_t total) {
    console.progress("exporting", done, total, "sequences");
  };
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
  labelled::ImportOptions options;
};

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
  for (const std::string& given : arguments.classes)
    options.classes.push_back(labelled::object_class_from(given));
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
  arguments.options.stop = context.stop;
  arguments.options.progress = [&console](std::int64_t done, std::int64_t total) {
    console.progress("looking", done, total, "sequences");
  };
  set_report::write_report(arguments.set, arguments.out, arguments.options);
  console.result(arguments.out);
}

constexpr const char* kWritten = "coco, yolo, mot, voc, cvat, aot, otb, got10k or vot";

void add_export(CLI::App& group, Context& context) {
  auto out = std::make_shared<Export>();
  auto* command = group.add_subcommand("export", "Write a data set in a format of others");
  command->add_option("DIR", out->set, "A data set, or a folder that `render` made")->required();
  command->add_option("--format,-f", out->format, kWritten)->required();
  command
      ->add_option("--out,-o", out->out, "A new folder; an export that was stopped goes on in it")
      ->required();
  command->add_option("--images",
                      out->images,
                      "jpg (default; for aot, whose readers open no jpg: png), png or none");
  command->add_option(
      "--boxes",
      out->boxes,
      "covered (default): the pixels that the aircraft covers, to train on; exact: its projected "
      "shape; visible: the pixels that changed, codec's ripple included");
  command->add_option("--every", out->options.every, "Take every n-th frame (default: 1)")
      ->check(CLI::PositiveNumber);
  command->add_option("--split",
                      out->split,
                      "by-background (default): a video is in one part alone; by-sequence; "
                      "none");
  command->add_option("--shares", out->shares, "Of train, val and test (default: 0.8 0.1 0.1)")
      ->expected(3)
      ->check(CLI::NonNegativeNumber);
  command->add_option("--seed", out->options.seed, "Of the split (default: 1)");
  command->add_flag(
      "--one-class", out->options.one_class, "One class, `aircraft`, in place of the types");
  command->add_flag("--mot-classes",
                    out->options.mot_classes,
                    "Of mot: number the classes from 1 (default: 1 for every aircraft, the "
                    "one class that MOT17's evaluation counts)");
  command->add_option("--jobs,-j", out->options.jobs, "Sequences at a time (default: one per core)")
      ->check(CLI::Range(1, 1024));
  command->callback([out, &context] { run_export(*out, context); });
}

void add_report(CLI::App& group, Context& context) {
  auto page = std::make_shared<Report>();
  auto* command =
      group.add_subcommand("report", "A page on a data set: what is in it, and each sequence");
  command->add_option("DIR", page->set, "A data set, or a folder that `render` made")->required();
  command->add_option("--out,-o", page->out, "The page (default: report.html)");
  command->add_flag("--overwrite", page->options.overwrite, "Replace the page if it is there");
  command
      ->add_option("--jobs,-j", page->options.jobs, "Sequences at a time (default: one per core)")
      ->check(CLI::Range(1, 1024));
  command->callback([page, &context] { run_report(*page, context); });
}

void add_import(CLI::App& group, Context& context) {
  auto in = std::make_shared<Import>();
  auto* command = group.add_subcommand(
      "import", "Import labelled video of others, to look at and to evaluate on");
  command->add_option("SOURCE", in->source, "Its folder, or its annotation file")->required();
  command
      ->add_option(
          "--format,-f", in->format, std::string(kWritten) + "; evision or csv (frame,x,y,w,h)")
      ->required();
  command->add_option("--out,-o", in->out, "A new folder")->required();
  command->add_option(
      "--video", in->videos, "CLIP=VIDEO, or VIDEO where there is one clip: where it is not found");
  command->add_option("--size", in->size, "WxH of the pictures, where nothing says it");
  command
      ->add_option("--origin",
                   in->options.read.origin_px,
                   "Of csv: what the first pixel is called, 0 (default) or 1 (MATLAB)")
      ->check(CLI::Range(0, 1));
  command->add_option(
      "--category", in->options.read.category, "Where the labels name none (default: aircraft)");
  command->add_option(
      "--class",
      in->classes,
      "What the objects are, where they are no aircraft: bird, multirotor, balloon, "
      "glint, dirt, insect, or ignore for regions that count neither way; "
      "CLIP=CLASS for clips whose name fits (* and ?)");
  command->callback([in, &context] { run_import(*in, context); });
}

}  // namespace

void add_dataset_exchange(CLI::App& group, Context& context) {
  add_export(group, context);
  add_report(group, context);
  add_import(group, context);
}

}  // namespace airtruth::cli
