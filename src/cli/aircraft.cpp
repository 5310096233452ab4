// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "aircraft/fleet/fleet.h"
#include "aircraft/fleet/scale.h"
#include "cli/commands.h"
#include "foundation/base/error.h"
#include "foundation/run_files/run_files.h"
#include "picture/video/still.h"
#include "sequence/demo/aircraft_sheet.h"
#include "show/drawing/pictures.h"

namespace airtruth::cli {
namespace {

// The type's published size, without reading the model.
std::string published_words(const std::string& name) {
  const fleet::PublishedSize* size = fleet::published_size(name);
  if (size == nullptr) return "no published size is known: its scale is not checked";
  if (!size->is_known()) return size->type;
  return fmt::format(
      "{}: span {:.2f} m, length {:.2f} m", size->type, size->span_m, size->length_m);
}

struct ListArguments {
  std::string filter;
  std::string sheet;
  bool sizes = false;
  bool is_left_out = false;
  bool overwrite = false;
};

// Returns the folder of a name, which is the aircraft's type.
std::string type_of(const std::string& name) { return name.substr(0, name.find('/')); }

// Returns the first name in each type's folder.
std::vector<std::string> one_of_each_type(const std::vector<std::string>& names) {
  std::vector<std::string> first;
  for (const std::string& name : names)
    if (first.empty() || type_of(name) != type_of(first.back())) first.push_back(name);
  return first;
}

void draw_sheet(const ListArguments& arguments, Context& context) {
  video::check_still_output(arguments.sheet, arguments.overwrite);
  // Number of tiles side by side: a display choice.
  constexpr int kColumns = 10;
  model::LoadOptions load;
  load.stop = context.stop;
  std::vector<drawing::NamedPicture> tiles;
  const std::vector<std::string> names =
      one_of_each_type(fleet::expect_aircraft_named_like(arguments.filter));
  for (const std::string& name : names) {
    if (context.stop.stop_requested()) throw Interrupted();
    tiles.push_back({type_of(name), demo::aircraft_tile(fleet::load_aircraft(name, load, {}))});
  }
  video::write_still(arguments.sheet,
                     drawing::tiled(fmt::format("{} types", names.size()), tiles, kColumns));
  context.console().result(
      fmt::format("{}: one aircraft of each of {} types", arguments.sheet, names.size()));
}

void list(const ListArguments& arguments, Context& context) {
  Console& console = context.console();
  if (!arguments.sheet.empty()) return draw_sheet(arguments, context);
  if (arguments.is_left_out) {
    for (const auto& [name, reason] : fleet::expect_left_out_named_like(arguments.filter))
      console.print(fmt::format("{:<40} {}\n", name, reason));
    return;
  }
  for (const std::string& name : fleet::expect_aircraft_named_like(arguments.filter))
    console.print(arguments.sizes ? fmt::format("{:<40} {}\n", name, published_words(name))
                                  : name + "\n");
}

struct ShowArguments {
  std::string name;
  std::string out;
  std::string forward;
  std::string up;
  double scale = 0;
  bool overwrite = false;
};

void show(const ShowArguments& arguments, Context& context) {
  video::check_still_output(arguments.out, arguments.overwrite);
  Console& console = context.console();
  model::LoadOptions options;
  options.stop = context.stop;
  options.axes = model::stated_axes(arguments.forward, arguments.up, arguments.scale);
  const fleet::Aircraft loaded = fleet::load_aircraft(arguments.name, options, console.warn());
  RunFiles files;
  for (const auto& source : loaded.sources) files.reads(source);
  files.writes(arguments.out, arguments.overwrite).check();
  const model::Extents size = model::extents(loaded.mesh);
  const auto liveries = fleet::liveries(arguments.name);
  console.result(fmt::format(
      "{}\n  length {:.2f} m, span {:.2f} m, height {:.2f} m\n  {} triangles, {} textures, {}",
      loaded.name,
      size.length_m(),
      size.span_m(),
      size.height_m(),
      loaded.mesh.triangle_count(),
      loaded.mesh.textures.size(),
      loaded.file.empty() ? "made in code" : loaded.file.string()));
  if (loaded.file != arguments.name)
    console.result("  " + fleet::size_words(
                              size, loaded.catalogue_scale, fleet::published_size(arguments.name)));
  if (!liveries.empty()) console.result(fmt::format("  {} other liveries:", liveries.size()));
  for (const std::string& livery : liveries) console.result("    " + livery);
  if (arguments.out.empty()) return;
  video::write_still(arguments.out, demo::aircraft_sheet(loaded));
  console.result("  " + arguments.out);
}

void add_list(CLI::App& group, Context& context) {
  auto [command, arguments] = add_command(group, context, "list", list);
  command->description("Print the name of every aircraft, a line each");
  command->add_option("FILTER",
                      arguments->filter,
                      "Show only names that contain this, or that it fits with * and ?; "
                      "letter case does not matter");
  CLI::Option* sizes = command->add_flag(
      "--sizes", arguments->sizes, "Also the type of each and its published size");
  CLI::Option* left_out =
      command->add_flag("--left-out", arguments->is_left_out)
          ->description("In their place: the names of the package that are not offered, and why");
  left_out->excludes(sizes);
  command->add_option("--sheet", arguments->sheet)
      ->description("In their place: draw one aircraft of each type here (.png or .jpg)")
      ->excludes(sizes)
      ->excludes(left_out);
  command->add_flag("--overwrite", arguments->overwrite, "Replace the picture if it exists");
}

void add_show(CLI::App& group, Context& context) {
  auto [command, arguments] = add_command(group, context, "show", show);
  command->description("Size and liveries of one aircraft, and a contact sheet of pictures");
  command->add_option("NAME", arguments->name)
      ->description(
          "A name of `aircraft list`, or a model file (.ac .obj .3ds .stl .ply .dae .gltf .glb "
          ".fbx, FlightGear's .xml)")
      ->required();
  command->add_option("-o,--out", arguments->out, "Draw a contact sheet here (.png or .jpg)");
  command->add_flag("--overwrite", arguments->overwrite, "Replace the picture if it exists");
  command->add_option(
      "--forward", arguments->forward, "Model file: its axis that is the nose (x, -y, ...)");
  command->add_option("--up", arguments->up, "Model file: its axis that is up");
  command->add_option("--scale", arguments->scale, "Model file: metres per unit")->check(above_0());
}

}  // namespace

void add_aircraft(CLI::App& app, Context& context) {
  auto* group = app.add_subcommand("aircraft", "The aircraft that can be flown");
  group->require_subcommand(1);
  add_list(*group, context);
  add_show(*group, context);
}

}  // namespace airtruth::cli
