// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/console.h"
#include "foundation/base/error.h"
#include "foundation/base/text.h"

namespace airtruth::cli {

struct Context {
  ConsoleOptions options;
  std::stop_token stop;
  // Exit code of a command that finished its work and has faults to report.
  int exit_code = 0;
  std::optional<Console> opened = {};
  // Of options that need others, called before a command runs.
  std::vector<std::function<void()>> checks = {};

  // Creates the console after parsing, when --quiet and --json-log are known.
  Console& console() { return opened ? *opened : opened.emplace(options); }
};

// CLI11 takes "nan" and "inf" for numbers, and its ranges let NaN through. Throws Error for either
// in any option of a command.
inline void expect_finite_numbers(const CLI::App& command) {
  for (const CLI::Option* option : command.get_options()) {
    if (!option->get_type_name().starts_with("FLOAT")) continue;
    for (const std::string& text : option->results())
      if (double number = 0; CLI::detail::lexical_cast(text, number) && !std::isfinite(number))
        throw Error(fmt::format("{} is '{}'; expected a finite number", option->get_name(), text));
  }
}

// Declares a command that calls run(arguments, context) after its arguments are parsed. Returns the
// command, and the arguments that its options are to set.
template <typename Parameter>
auto add_command(CLI::App& group,
                 Context& context,
                 const char* name,
                 void (*run)(Parameter, Context&)) {
  CLI::App* command = group.add_subcommand(name);
  auto arguments = std::make_shared<std::remove_cvref_t<Parameter>>();
  command->callback([run, arguments, command, &context] {
    expect_finite_numbers(*command);
    for (const auto& check : context.checks) check();
    run(*arguments, context);
  });
  return std::pair(command, arguments.get());
}

// Each of these options that is given has an effect. Otherwise the command ends with an Error:
// "--every has no effect without --deep".
inline void expect_effect(Context& context,
                          const CLI::App& command,
                          const std::vector<std::string>& options,
                          const std::string& without,
                          const std::function<bool()>& has_effect) {
  for (const std::string& name : options)
    context.checks.push_back([option = command.get_option(name), without, has_effect] {
      if (option->count() > 0 && !has_effect())
        throw Error(fmt::format("{} has no effect {}; leave it out", option->get_name(), without));
    });
}

// Shows the warnings of a stage and its progress, and lets an interrupt stop it.
template <typename Options>
void follow(Options& options, Context& context, const char* stage, const char* unit = "frames") {
  Console& console = context.console();
  if constexpr (requires { options.warn; }) options.warn = console.warn();
  options.stop = context.stop;
  options.progress = [&console, stage, unit](std::int64_t done, std::int64_t total) {
    console.progress(stage, done, total, unit);
  };
}

// --jobs, of what works on several sequences or files at a time.
inline void add_jobs(CLI::App& command, int& jobs, const char* about) {
  command.add_option("--jobs,-j", jobs, about)->check(CLI::Range(1, 1024));
}

// The words of CLI11's own checks hold the largest number of a double.
inline CLI::Validator above_0() {
  return {[](std::string& text) {
            const auto number = number_from_text<double>(text);
            return number && *number > 0 ? std::string()
                                         : fmt::format("is '{}'; expected a number above 0", text);
          },
          "POSITIVE"};
}

// The rate of numbered pictures, which state none.
inline void add_frame_rate(CLI::App& command, std::optional<double>& rate_hz) {
  command.add_option("--frame-rate", rate_hz)
      ->description("Frames a second of numbered pictures, where nothing states it")
      ->check(above_0());
}

// A number from `low` to `high`, whose default the help states.
template <typename Number>
CLI::Option* add_number(
    CLI::App& command, const char* name, Number& number, Number low, Number high) {
  return command.add_option(name, number)->check(CLI::Range(low, high))->capture_default_str();
}

// Reads the width and height from "1280x960", the form of --size. Throws Error for any other form.
inline std::pair<int, int> size_from(std::string_view text) {
  constexpr int kLargestSide = 65536;  // pixels: no video is larger
  const std::size_t x = std::min(text.find('x'), text.size());
  const auto width = number_from_text<int>(text.substr(0, x));
  const auto height = number_from_text<int>(text.substr(std::min(x + 1, text.size())));
  const auto is_side = [](const std::optional<int>& side) {
    return side && *side >= 1 && *side <= kLargestSide;
  };
  if (is_side(width) && is_side(height)) return {*width, *height};
  throw Error(fmt::format("--size is '{}'; expected WIDTHxHEIGHT, as 1280x960", text));
}

// Declares a subcommand with its arguments, and what it does once they are parsed.
using Add = void(CLI::App& app, Context& context);
Add add_render, add_scene, add_preview, add_studio, add_motion, add_calibrate, add_lens, add_log,
    add_mask, add_aircraft, add_overlay, add_inspect, add_synth, add_evision, add_dataset,
    add_track, add_detect, add_evaluate, add_compare, add_encounter, add_demo, add_describe;

}  // namespace airtruth::cli
