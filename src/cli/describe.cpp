// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <string>

#include "cli/commands.h"
#include "cli/manual.h"
#include "foundation/base/files.h"

namespace airtruth::cli {

// This command is hidden from --help: the build calls it to make the files that a package installs
// beside the program.
void add_describe(CLI::App& app, Context&) {
  auto* command = app.add_subcommand(
      "describe", "Write manual pages and bash completion, made from the program's own help");
  command->group("");
  auto out = std::make_shared<std::string>();
  command->add_option("DIR", *out, "Where man1/ and airtruth.bash go")->required();
  command->callback([out, &app] {
    const std::filesystem::path folder = *out;
    std::filesystem::create_directories(folder / "man1");
    for (const auto& [name, text] : manual_pages(app)) write_file(folder / "man1" / name, text);
    write_file(folder / "airtruth.bash", bash_completion(app));
  });
}

}  // namespace airtruth::cli
