// SPDX-License-Identifier: Apache-2.0
// Manual pages and shell completion, made from the same source as --help, so that the three agree.
#include <algorithm>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include <airtruth/version.h>
#include <fmt/format.h>

#include "cli/commands.h"
#include "foundation/base/files.h"
#include "foundation/base/text.h"

namespace airtruth::cli {
namespace {

// Escapes text for roff, so that none of it is a command or an escape. Text in backticks becomes
// bold.
std::string roff(const std::string& text) {
  static const std::map<char, const char*> escapes = {{'\\', "\\e"},
                                                      {'-', "\\-"},
                                                      {'\'', "\\(aq"},
                                                      {'"', "\\(dq"},
                                                      {'~', "\\(ti"},
                                                      {'^', "\\(ha"},
                                                      {'\n', " "}};
  std::string result;
  bool is_bold = false;
  for (const char c : text) {
    if (c == '`') {
      result += is_bold ? "\\fR" : "\\fB";
      is_bold = !is_bold;
    } else if (const auto escape = escapes.find(c); escape != escapes.end()) {
      result += escape->second;
    } else {
      result += c;
    }
  }
  if (is_bold) result += "\\fR";
  // roff takes a line that begins with a dot as a request.
  return result.starts_with('.') ? "\\&" + result : result;
}

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* command) { return !command->get_group().empty(); });
}

std::vector<const CLI::Option*> options_of(const CLI::App& app, bool positional) {
  return app.get_options([positional](const CLI::Option* option) {
    return !option->get_group().empty() && option->get_positional() == positional;
  });
}

// Describes the value of an option. CLI11 writes "INT:INT in [1 - 64]", "TEXT:{a,b}" or "TEXT".
struct Value {
  std::string name;                  // INT; empty for a flag
  std::string limits;                // "1 - 64", "positive"
  std::vector<std::string> choices;  // a, b
};

Value value_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  if (option.get_items_expected_max() == 0) return {};
  const std::size_t colon = type.find(':');
  Value value{type.substr(0, colon), "", {}};
  if (colon == std::string::npos) return value;
  const std::string rest = type.substr(colon + 1);
  if (rest.starts_with('{') && rest.ends_with('}')) {
    std::istringstream words(rest.substr(1, rest.size() - 2));
    for (std::string word; std::getline(words, word, ',');) value.choices.push_back(word);
  } else if (const std::size_t open = rest.find('['); open != std::string::npos) {
    value.limits = rest.substr(open + 1, rest.find(']') - open - 1);
  } else {
    value.limits = rest == "POSITIVE" ? "more than 0" : rest;
  }
  return value;
}

std::vector<std::string> spellings(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames()) names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  return names;
}

// "Sequences at a time (default: 1). One of a, b. Range: 1 - 64."
std::string explained(const CLI::Option& option, const Value& value) {
  std::string text = option.get_description();
  if (!option.get_default_str().empty())
    text += fmt::format(" (default: {})", option.get_default_str());
  if (!text.empty() && text.back() != '.') text += '.';
  if (!value.choices.empty()) text += fmt::format(" One of {}.", fmt::join(value.choices, ", "));
  if (!value.limits.empty()) text += fmt::format(" Range: {}.", value.limits);
  if (option.get_required()) text += " Required.";
  return text;
}

std::string entry(const CLI::Option& option) {
  const Value value = value_of(option);
  std::string heading;
  if (option.get_positional()) {
    heading = "\\fI" + roff(option.get_name(true)) + "\\fR";
  } else {
    for (const std::string& name : spellings(option))
      heading += (heading.empty() ? "\\fB" : ", \\fB") + roff(name) + "\\fR";
    if (!value.name.empty()) heading += " \\fI" + roff(value.name) + "\\fR";
    if (option.get_items_expected_max() > 1) heading += " ...";
  }
  return ".TP\n" + heading + "\n" + roff(explained(option, value)) + "\n";
}

std::string section(const std::string& title, const std::vector<const CLI::Option*>& options) {
  if (options.empty()) return "";
  std::string text = ".SH " + title + "\n";
  for (const CLI::Option* option : options) text += entry(*option);
  return text;
}

// The command and all below it.
void add_commands(const CLI::App& app, std::vector<const CLI::App*>& commands) {
  commands.push_back(&app);
  for (const CLI::App* command : commands_of(app)) add_commands(*command, commands);
}

std::string joined(const std::vector<std::string>& words) {
  return fmt::format("{}", fmt::join(words, " "));
}

// "airtruth dataset build", or with another separator.
std::string path_of(const CLI::App& command, const char* separator = " ") {
  const CLI::App* group = command.get_parent();
  return (group != nullptr ? path_of(*group, separator) + separator : "") + command.get_name();
}

std::string page_name(const CLI::App& command) { return path_of(command, "-"); }

std::string synopsis(const CLI::App& command) {
  std::string text = ".SH SYNOPSIS\n\\fB" + roff(path_of(command)) + "\\fR [\\fIOPTION\\fR]...";
  if (!commands_of(command).empty()) text += " \\fICOMMAND\\fR ...";
  for (const CLI::Option* option : options_of(command, true))
    text += " \\fI" + roff(option->get_name(true)) + "\\fR" +
            (option->get_items_expected_max() > 1 ? "..." : "");
  return text + "\n";
}

std::string commands_section(const CLI::App& group) {
  const auto commands = commands_of(group);
  if (commands.empty()) return "";
  std::string text = ".SH COMMANDS\n";
  for (const CLI::App* command : commands)
    text += ".TP\n\\fB" + roff(page_name(*command)) + "\\fR(1)\n" +
            roff(command->get_description()) + "\n";
  return text;
}

std::string title_and_name(const CLI::App& command) {
  const std::string name = page_name(command);
  std::string upper = name;
  std::transform(upper.begin(), upper.end(), upper.begin(), [](char c) {
    return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  });
  return fmt::format(
      ".\\\" Made by `airtruth describe` from the program's own help.\n"
      ".TH {} 1 \"\" \"airtruth {}\" \"airtruth\"\n.SH NAME\n{} \\- {}\n",
      roff(upper),
      kVersion,
      roff(name),
      command.get_parent() == nullptr
          ? "3D aircraft in real onboard video, with the exact truth of every frame"
          : roff(command.get_description()));
}

// The options that every command has, but those that each page explains itself.
std::vector<const CLI::Option*> common_options(const CLI::App& root) {
  std::vector<const CLI::Option*> common = options_of(root, false);
  std::erase_if(common, [](const CLI::Option* option) {
    return option->check_lname("help") || option->check_lname("version");
  });
  return common;
}

std::string see_also(const CLI::App& command) {
  const CLI::App* group = command.get_parent();
  if (group == nullptr) return "";
  std::string text = ".SH SEE ALSO\n.BR airtruth (1)";
  if (group->get_parent() != nullptr)
    text += fmt::format(" ,\n.BR {} (1)", roff(page_name(*group)));
  return text + "\n";
}

std::string manual_page(const CLI::App& root, const CLI::App& command) {
  const std::string about = command.get_description();
  std::string text = title_and_name(command);
  text += synopsis(command);
  text += ".SH DESCRIPTION\n" + roff(about) + (about.ends_with('.') ? "\n" : ".\n");
  text += commands_section(command);
  text += section("ARGUMENTS", options_of(command, true));
  text += section("OPTIONS", options_of(command, false));
  if (&command != &root) text += section("COMMON OPTIONS", common_options(root));
  text +=
      ".SH EXIT STATUS\n.TP\n0\nDone.\n.TP\n1\nA fault of airtruth, or work that has something to "
      "complain of.\n.TP\n2\nWhat was given is wrong: one line says what, where and what was "
      "expected.\n.TP\n130\nInterrupted; nothing half\\-made is left behind.\n";
  text +=
      ".SH FILES\n.TP\n.I /usr/share/doc/airtruth/\nThe documents: scene files, catalogues, "
      "truth, measures.\n.TP\n.I /usr/share/airtruth/\nExamples, catalogues, schemas and "
      "clients.\n";
  return text + see_also(command);
}

// The cases of the three functions of the script.
struct Cases {
  std::string words;
  std::string values;
  std::string groups;
};

void add_cases(const CLI::App& root, const CLI::App& app, Cases& cases) {
  std::vector<const CLI::Option*> options = options_of(app, false);
  if (&app != &root)
    for (const CLI::Option* option : common_options(root)) options.push_back(option);
  const std::string name = path_of(app);
  std::vector<std::string> commands;
  for (const CLI::App* command : commands_of(app)) commands.push_back(command->get_name());
  if (!commands.empty())
    cases.groups +=
        fmt::format("    {}) commands={} ;;\n", shell_word(name), shell_word(joined(commands)));
  std::vector<std::string> all;
  for (const CLI::Option* option : options) {
    const Value value = value_of(*option);
    for (const std::string& spelling : spellings(*option)) {
      all.push_back(spelling);
      if (value.name.empty()) continue;
      cases.values += fmt::format("    {}) takes_value=1 choices={} ;;\n",
                                  shell_word(name + " " + spelling),
                                  shell_word(joined(value.choices)));
    }
  }
  cases.words += fmt::format("    {}) options={} ;;\n", shell_word(name), shell_word(joined(all)));
}

constexpr const char* kScript =
    R"(# bash completion for airtruth. Made by `airtruth describe` from the program's own help.

_airtruth_options() {{ # options=... of the command $1
  case "$1" in
{words}  esac
}}

_airtruth_commands() {{ # commands=... of the group $1
  case "$1" in
{groups}  esac
}}

_airtruth_value() {{ # takes_value=1 and choices=... where "COMMAND OPTION" takes a value
  case "$1" in
{values}  esac
}}

_airtruth() {{
  local cur=${{COMP_WORDS[COMP_CWORD]}} path=airtruth word i
  local options='' commands='' choices='' takes_value='' command_is_open=1
  for ((i = 1; i < COMP_CWORD; ++i)); do
    word=${{COMP_WORDS[i]}}
    commands=''
    _airtruth_commands "$path"
    case " $commands " in
      *" $word "*) path="$path $word" ;;
    esac
  done
  commands=''
  _airtruth_commands "$path"
  [ -n "$commands" ] || command_is_open=''
  if [ "$COMP_CWORD" -gt 1 ]; then
    _airtruth_value "$path ${{COMP_WORDS[COMP_CWORD - 1]}}"
    [ -n "$takes_value" ] || _airtruth_value "airtruth ${{COMP_WORDS[COMP_CWORD - 1]}}"
  fi
  COMPREPLY=()
  if [ -n "$takes_value" ] && [ -n "$choices" ]; then
    mapfile -t COMPREPLY < <(compgen -W "$choices" -- "$cur")
  elif [ -n "$takes_value" ]; then
    mapfile -t COMPREPLY < <(compgen -f -- "$cur")
  elif [[ "$cur" == -* ]]; then
    _airtruth_options "$path"
    mapfile -t COMPREPLY < <(compgen -W "$options" -- "$cur")
  elif [ -n "$command_is_open" ]; then
    mapfile -t COMPREPLY < <(compgen -W "$commands" -- "$cur")
  else
    mapfile -t COMPREPLY < <(compgen -f -- "$cur")
  fi
}}
complete -o filenames -F _airtruth airtruth
)";

}  // namespace

// This command is hidden from --help: the build calls it to make the files that a package installs
// beside the program. They are section 1 of the manual in roff (airtruth.1, and airtruth-COMMAND.1
// or airtruth-GROUP-COMMAND.1 for each command), and a bash script that completes commands,
// options, the values of options that have a list of choices, and otherwise file names. The same
// program gives the same bytes.
void add_describe(CLI::App& app, Context&) {
  auto* command = app.add_subcommand(
      "describe", "Write manual pages and bash completion, made from the program's own help");
  command->group("");
  auto out = std::make_shared<std::string>();
  command->add_option("DIR", *out, "Where man1/ and airtruth.bash go")->required();
  command->callback([out, &app] {
    const std::filesystem::path folder = *out;
    std::filesystem::create_directories(folder / "man1");
    std::vector<const CLI::App*> commands;
    add_commands(app, commands);
    Cases cases;
    for (const CLI::App* command : commands) {
      write_file(folder / "man1" / (page_name(*command) + ".1"), manual_page(app, *command));
      add_cases(app, *command, cases);
    }
    write_file(folder / "airtruth.bash",
               fmt::format(kScript,
                           fmt::arg("words", cases.words),
                           fmt::arg("groups", cases.groups),
                           fmt::arg("values", cases.values)));
  });
}

}  // namespace airtruth::cli
