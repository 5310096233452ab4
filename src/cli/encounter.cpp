// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "cli/commands.h"
#include "encounter/tracks_file/tracks_file.h"
#include "foundation/base/error.h"
#include "foundation/base/file_state.h"

namespace airtruth::cli {
namespace {

struct Convert {
  std::string in;
  std::string out;
  std::size_t number = 0;  // 0: all
  bool overwrite = false;
};

// Files of waypoints hold neither weights nor velocities; other formats than CSV no weights.
void warn_of_losses(const std::vector<encounter::Encounter>& encounters,
                    encounter::TracksFormat format,
                    const std::string& out,
                    Console& console) {
  if (format == encounter::TracksFormat::kCsv) return;
  for (const encounter::Encounter& each : encounters)
    if (each.weight != 1) {
      console.warning(out + ": a file of this format holds no weights; .csv does");
      return;
    }
}

void convert(const Convert& arguments, Context& context) {
  check_output_file(arguments.out, arguments.overwrite);
  const encounter::TracksFormat format = encounter::tracks_format_of(arguments.out);
  Console& console = context.console();
  std::vector<encounter::Encounter> encounters = encounter::read_encounters(arguments.in);
  if (arguments.number > encounters.size())
    throw Error(fmt::format("holds {} encounters; expected --encounter of 1 to {}",
                            encounters.size(),
                            encounters.size()),
                {arguments.in});
  if (arguments.number > 0) encounters = {encounters[arguments.number - 1]};
  if (context.stop.stop_requested()) throw Interrupted();
  const std::size_t count = encounters.size();
  encounters = encounter::fitted(std::move(encounters), format, arguments.out);
  warn_of_losses(encounters, format, arguments.out, console);
  encounter::write_encounters(arguments.out, encounters);
  console.result(
      fmt::format("{}: {} {}", arguments.out, count, count == 1 ? "encounter" : "encounters"));
}

void add_convert(CLI::App& group, Context& context) {
  auto arguments = std::make_shared<Convert>();
  auto* command = group.add_subcommand(
      "convert", "Write encounters in another format, which the extension of the file names");
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
  command->callback([arguments, &context] { convert(*arguments, context); });
}

}  // namespace

void add_encounter(CLI::App& app, Context& context) {
  auto* group = app.add_subcommand("encounter", "Encounters of aircraft, without pictures");
  group->require_subcommand(1);
  add_encounter_sample(*group, context);
  add_convert(*group, context);
}

}  // namespace airtruth::cli
