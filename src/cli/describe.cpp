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
  std::vector<const CLI::App*> commands;
  for (const CLI::App* command : app.get_subcommands({}))
    if (!command->get_group().empty()) commands.push_back(command);
  return commands;
}

std::vector<const CLI::Option*> options_of(const CLI::App& app, bool positional) {
  std::vector<const CLI::Option*> options;
  for (const CLI::Option* option : app.get_options())
    if (!option->get_group().empty() && option->get_positional() == positional)
      options.push_back(option);
  return options;
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

struct Page {
  const CLI::App* app = nullptr;
  std::vector<std::string> path;  // airtruth, dataset, build
};

// Adds the command and all its subcommands.
void add_pages(const Page& page, std::vector<Page>& pages) {
  pages.push_back(page);
  for (const CLI::App* command : commands_of(*page.app)) {
    Page below{command, page.path};
    below.path.push_back(command->get_name());
    add_pages(below, pages);
  }
}

std::string joined(const std::vector<std::string>& words, const char* separator) {
  return fmt::format("{}", fmt::join(words, separator));
}

std::string page_name(const std::vector<std::string>& path) { return joined(path, "-"); }

std::string synopsis(const Page& page) {
  std::string text =
      ".SH SYNOPSIS\n\\fB" + roff(joined(page.path, " ")) + "\\fR [\\fIOPTION\\fR]...";
  if (!commands_of(*page.app).empty()) text += " \\fICOMMAND\\fR ...";
  for (const CLI::Option* option : options_of(*page.app, true))
    text += " \\fI" + roff(option->get_name(true)) + "\\fR" +
            (option->get_items_expected_max() > 1 ? "..." : "");
  return text + "\n";
}

std::string commands_section(const Page& page) {
  const auto commands = commands_of(*page.app);
  if (commands.empty()) return "";
  std::string text = ".SH COMMANDS\n";
  for (const CLI::App* command : commands)
    text += ".TP\n\\fB" + roff(page_name(page.path) + "-" + command->get_name()) + "\\fR(1)\n" +
            roff(command->get_description()) + "\n";
  return text;
}

std::string title_and_name(const Page& page, bool is_root) {
  const std::string name = page_name(page.path);
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
      is_root ? "3D aircraft in real onboard video, with the exact truth of every frame"
              : roff(page.app->get_description()));
}

// The options that every command has, but those that each page explains itself.
std::string common_options(const CLI::App& root) {
  std::vector<const CLI::Option*> common = options_of(root, false);
  std::erase_if(common, [](const CLI::Option* option) {
    const auto names = spellings(*option);
    return std::any_of(names.begin(), names.end(), [](const std::string& n) {
      return n == "--help" || n == "--version";
    });
  });
  return section("COMMON OPTIONS", common);
}

std::string see_also(const Page& page, bool is_root) {
  std::vector<std::string> others;
  if (!is_root) others.push_back("airtruth");
  if (page.path.size() > 2) others.push_back(page_name({page.path.begin(), page.path.end() - 1}));
  if (others.empty()) return "";
  std::string text = ".SH SEE ALSO\n";
  for (std::size_t i = 0; i < others.size(); ++i)
    text += fmt::format(".BR {} (1){}\n", roff(others[i]), i + 1 < others.size() ? " ," : "");
  return text;
}

std::string manual_page(const CLI::App& root, const Page& page) {
  const std::string about = page.app->get_description();
  const bool is_root = page.app == &root;
  std::string text = title_and_name(page, is_root);
  text += synopsis(page);
  text += ".SH DESCRIPTION\n" + roff(about) + (about.ends_with('.') ? "\n" : ".\n");
  text += commands_section(page);
  text += section("ARGUMENTS", options_of(*page.app, true));
  text += section("OPTIONS", options_of(*page.app, false));
  if (!is_root) text += common_options(root);
  text +=
      ".SH EXIT STATUS\n.TP\n0\nDone.\n.TP\n1\nA fault of airtruth, or work that has something to "
      "complain of.\n.TP\n2\nWhat was given is wrong: one line says what, where and what was "
      "expected.\n.TP\n130\nInterrupted; nothing half\\-made is left behind.\n";
  text +=
      ".SH FILES\n.TP\n.I /usr/share/doc/airtruth/\nThe documents: scene files, catalogues, "
      "truth, measures.\n.TP\n.I /usr/share/airtruth/\nExamples, catalogues, schemas and "
      "clients.\n";
  return text + see_also(page, is_root);
}

// The cases of the three functions of the script.
struct Cases {
  std::string words;
  std::string values;
  std::string groups;
};

void add_cases(const CLI::App& root, const Page& page, Cases& cases) {
  std::vector<const CLI::Option*> options = options_of(*page.app, false);
  if (page.app != &root)
    for (const CLI::Option* option : options_of(root, false))
      if (option->check_lname("quiet") || option->check_lname("json-log"))
        options.push_back(option);
  const std::string name = joined(page.path, " ");
  std::vector<std::string> commands;
  for (const CLI::App* command : commands_of(*page.app)) commands.push_back(command->get_name());
  if (!commands.empty())
    cases.groups += fmt::format(
        "    {}) commands={} ;;\n", shell_word(name), shell_word(joined(commands, " ")));
  std::vector<std::string> all;
  for (const CLI::Option* option : options) {
    const Value value = value_of(*option);
    for (const std::string& spelling : spellings(*option)) {
      all.push_back(spelling);
      if (value.name.empty()) continue;
      cases.values += fmt::format("    {}) takes_value=1 choices={} ;;\n",
                                  shell_word(name + " " + spelling),
                                  shell_word(joined(value.choices, " ")));
    }
  }
  cases.words +=
      fmt::format("    {}) options={} ;;\n", shell_word(name), shell_word(joined(all, " ")));
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
    std::vector<Page> pages;
    add_pages({&app, {app.get_name()}}, pages);
    Cases cases;
    for (const Page& page : pages) {
      write_file(folder / "man1" / (page_name(page.path) + ".1"), manual_page(app, page));
      add_cases(app, page, cases);
    }
    write_file(folder / "airtruth.bash",
               fmt::format(kScript,
                           fmt::arg("words", cases.words),
                           fmt::arg("groups", cases.groups),
                           fmt::arg("values", cases.values)));
  });
}

}  // namespace airtruth::cli
