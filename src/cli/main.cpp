// SPDX-License-Identifier: Apache-2.0
#include <exception>
#include <filesystem>
#include <memory>
#include <new>
#include <sstream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <airtruth/version.h>
#include <malloc.h>

#include "cli/commands.h"
#include "foundation/base/error.h"
#include "foundation/base/names.h"
#include "foundation/disk_cache/disk_cache.h"

namespace {

using namespace airtruth;  // the program's own top level

// Exit codes (docs/reference/commands.md).
constexpr int kOurFailure = 1;
constexpr int kBadInput = 2;

constexpr const char* kAbout =
    "Puts 3D aircraft into real onboard video, as that camera would have seen them, and writes the "
    "exact truth of\n"
    "every frame. Start with `airtruth demo`, then `airtruth render SCENE.toml --out DIR`.";

// CLI11 2.1 (Debian 12) writes an option's default value as "INT=3", 2.4 (Debian 13) as "INT [3] ".
// Help has the first form on both.
class HelpFormat : public CLI::Formatter {
 public:
  std::string make_option_opts(const CLI::Option* option) const override {
    std::string text = CLI::Formatter::make_option_opts(option);
    const std::string value = option->get_default_str();
    const std::string bracketed = " [" + value + "] ";
    if (const std::size_t at = text.find(bracketed); !value.empty() && at != std::string::npos)
      text.replace(at, bracketed.size(), "=" + value);
    return text;
  }
};

// Frames are allocated and released continually. The allocator keeps their memory, so that the
// kernel need not supply and clear it again.
void keep_memory() {
  mallopt(M_MMAP_THRESHOLD, 64 << 20);
  mallopt(M_TRIM_THRESHOLD, 512 << 20);
}

// The command that the words of the command line name, as far as they are commands.
const CLI::App& named_command(const CLI::App& app) {
  const std::vector<CLI::App*> parsed = app.get_subcommands();
  return parsed.empty() ? app : named_command(*parsed.front());
}

std::vector<std::string> option_names(const CLI::App& app, const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::App* one : {&app, &command})
    for (const CLI::Option* option : one->get_options())
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

// The first word that is neither a command nor an option, in a message; empty where there is none.
// CLI11 names a missing argument first, and answers an unknown command that has --help.
std::string unknown_word(const CLI::App& app) {
  std::vector<std::string> unknown = app.remaining(true);
  std::erase(unknown, "--");
  if (unknown.empty()) return "";
  const std::string word = unknown.front().substr(0, unknown.front().find('='));
  const CLI::App& command = named_command(app);
  if (word.starts_with("-"))
    return "there is no option '" + word + "'" + did_you_mean(word, option_names(app, command));
  std::vector<std::string> names;
  for (const CLI::App* one : command.get_subcommands({})) names.push_back(one->get_name());
  return names.empty() ? "" : "there is no command '" + word + "'" + did_you_mean(word, names);
}

// Parses the words and runs the command. --help and --version come as a ParseError.
int parse(CLI::App& app, int argc, char** argv, cli::Context& context) {
  try {
    app.parse(argc, argv);
    return context.exit_code;
  } catch (const CLI::ParseError& error) {
    const std::string unknown = unknown_word(app);
    if (error.get_exit_code() != 0 || !unknown.empty()) {
      context.console().error((unknown.empty() ? error.what() : unknown) + " (see --help)");
      return kBadInput;
    }
    std::ostringstream text;
    app.exit(error, text, text);
    context.console().print(text.str());
    return 0;
  }
}

int run(CLI::App& app, int argc, char** argv, cli::Context& context) {
  try {
    return parse(app, argc, argv, context);
  } catch (const Interrupted&) {
    context.console().interrupted();
    return cli::kInterrupted;
  } catch (const Error& error) {
    context.console().error(error.what());
    return kBadInput;
  } catch (const std::filesystem::filesystem_error& error) {
    context.console().error(Error(error.code().message(), {error.path1().string()}).what());
    return kBadInput;
  } catch (const std::bad_alloc&) {
    context.console().error(
        "out of memory; the input asks for more than the machine, or its limit (ulimit -v), has");
    return kOurFailure;
  } catch (const std::exception& error) {
    context.console().error(std::string(error.what()) +
                            " (this is a fault of airtruth; please report it with what you ran)");
    return kOurFailure;
  }
}

// In the order of --help.
constexpr cli::Add* kCommands[] = {
    cli::add_demo,
#ifndef AIRTRUTH_DEMO_ALONE  // of the program airtruth-demo, which is built in half the time
    cli::add_render,   cli::add_scene,    cli::add_preview,   cli::add_studio,    cli::add_overlay,
    cli::add_inspect,  cli::add_motion,   cli::add_calibrate, cli::add_mask,      cli::add_lens,
    cli::add_log,      cli::add_aircraft, cli::add_synth,     cli::add_encounter, cli::add_dataset,
    cli::add_track,    cli::add_detect,   cli::add_evaluate,  cli::add_compare,   cli::add_evision,
    cli::add_describe,
#endif
};

}  // namespace

int main(int argc, char** argv) {
  cli::open_standard_streams();
  keep_memory();
  const cli::StopOnSignal signals;
  CLI::App app(kAbout, "airtruth");
  app.formatter(std::make_shared<HelpFormat>());
  app.set_version_flag("--version", std::string("airtruth ") + kVersion);
  app.require_subcommand(1);
  app.fallthrough();
  app.failure_message(CLI::FailureMessage::simple);
  cli::Context context{.options = {}, .stop = signals.token()};
  app.add_flag("--quiet", context.options.quiet, "Print warnings and errors alone");
  app.add_flag(
      "--json-log", context.options.json_log, "Log as JSON, an object a line, on standard error");
  for (cli::Add* add : kCommands) add(app, context);
  const int code = run(app, argc, argv, context);
  if (const std::filesystem::path folder = disk_cache::refused_folder(); !folder.empty())
    context.console().warning(folder.string() +
                              ": nothing is kept there; expected a folder of the user's own that "
                              "nobody else may write (chmod go-w)");
  return code;
}
