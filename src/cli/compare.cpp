// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include <fmt/format.h>

#include "base/error.h"
#include "base/files.h"
#include "cli/commands.h"
#include "comparison/comparison.h"

namespace airtruth::cli {
namespace {

struct CompareArguments {
  std::string real;
  std::string boxes;
  std::string scene;
  std::string out;
  double origin_px = 0;
  int pairs = 6;
  std::int64_t frames = 0;
  bool overwrite = false;
};

void compare(const CompareArguments& arguments, Context& context) {
  Console& console = context.console();
  comparison::Options options;
  options.overwrite = arguments.overwrite;
  options.pairs = arguments.pairs;
  options.most_frames = arguments.frames;
  options.warn = console.warn();
  options.stop = context.stop;
  options.progress = [&](std::int64_t done, std::int64_t total) {
    console.progress("comparing", done, total);
  };
  const auto found =
      comparison::compare(arguments.real,
                          comparison::read_boxes(arguments.boxes, arguments.origin_px),
                          scene::read_scene(arguments.scene),
                          arguments.out,
                          options);
  console.end_progress();
  std::string text = fmt::format("{}: {} frames", found.folder.string(), found.frames);
  for (const comparison::Pair& p : found.pairs)
    text += fmt::format("\n  {:<44} real {:8.3g}   inserted {:8.3g}", p.name, p.real, p.made);
  console.result(text);
}

struct JudgeArguments {
  std::vector<std::string> comparisons;
  std::uint64_t seed = 1;
};

void judge(const JudgeArguments& arguments, Context& context) {
  const comparison::Verdict verdict = comparison::judge(
      {arguments.comparisons.begin(), arguments.comparisons.end()}, arguments.seed);
  std::string text = fmt::format("area under the curve {:.3f} ({:.3f} to {:.3f}); 0.5 is chance",
                                 verdict.auc,
                                 verdict.low,
                                 verdict.high);
  for (const auto& [name, area] : verdict.by_clip)
    text += fmt::format("\n  {:<32} {:.3f}", name, area);
  text += "\nwhat alone tells most:";
  for (std::size_t i = 0; i < std::min<std::size_t>(5, verdict.telling.size()); ++i)
    text += fmt::format("\n  {:<32} {:.3f}", verdict.telling[i].first, verdict.telling[i].second);
  context.console().result(text);
}

}  // namespace

void add_compare(CLI::App& app, Context& context) {
  auto* command = app.add_subcommand(
      "compare", "Put an aircraft beside a real one in its own clip, and measure how both look");
  auto arguments = std::make_shared<CompareArguments>();
  command->add_option("--real", arguments->real, "Video with a real aircraft in it")->required();
  command->add_option("--boxes", arguments->boxes, "Its boxes: frame,x,y,width,height (.csv)")
      ->required();
  command
      ->add_option("--scene",
                   arguments->scene,
                   "Scene that says which aircraft, light, lens and camera model; its video and "
                   "path are not used")
      ->required();
  command->add_option("-o,--out", arguments->out, "Folder to make")->required();
  command
      ->add_option(
          "--origin", arguments->origin_px, "What the boxes' first pixel is called (MATLAB: 1)")
      ->capture_default_str();
  command->add_option("--pairs", arguments->pairs, "Pairs in the figure")
      ->check(CLI::Range(1, 40))
      ->capture_default_str();
  command->add_option("--frames", arguments->frames, "At most so many frames from the first box on")
      ->check(CLI::PositiveNumber);
  command->add_flag("--overwrite", arguments->overwrite, "Replace the folder if it exists");
  command->callback([arguments, &context] { compare(*arguments, context); });
}

void add_judge(CLI::App& app, Context& context) {
  auto* command = app.add_subcommand(
      "judge", "Can a classifier tell the real aircraft of comparisons from the inserted ones?");
  auto arguments = std::make_shared<JudgeArguments>();
  command
      ->add_option("COMPARISON", arguments->comparisons, "Folders that `compare` made, one a clip")
      ->required()
      ->expected(1, 1000);
  command->add_option("--seed", arguments->seed, "Of the interval's resampling")
      ->capture_default_str();
  command->callback([arguments, &context] { judge(*arguments, context); });
}

}  // namespace airtruth::cli
