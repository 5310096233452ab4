// SPDX-License-Identifier: Apache-2.0
#include "dataset/catalogue/slurm_options.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "foundation/base/text.h"

namespace airtruth::catalogue {
namespace {

// Options that a job script of airtruth sets itself, or that would make sbatch do something other
// than submit that script (sbatch(1) of Slurm 22.05).
const std::vector<std::string> kOwnOptions = words_in(
    "output open-mode requeue no-requeue dependency parsable wrap wait test-only help usage "
    "version chdir input batch");

// What may stand in a value: letters, digits, and the marks of lists, node ranges, sizes, times,
// addresses, constraints and file names. None of them means anything to sbatch's reader of #SBATCH
// lines.
constexpr std::string_view kValueMarks = "_-.,:=/+@%[]()*&|~^";

bool consists_of(std::string_view text, std::string_view characters) {
  return !text.empty() && text.find_first_not_of(characters) == std::string_view::npos;
}

bool is_digits(std::string_view text) { return consists_of(text, "0123456789"); }

bool is_option_name(std::string_view name) {
  return consists_of(name, "abcdefghijklmnopqrstuvwxyz0123456789-") && name.front() >= 'a';
}

bool is_value(std::string_view value) {
  const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789";
  return consists_of(value, letters + std::string(kValueMarks));
}

// "minutes", "minutes:seconds", "hours:minutes:seconds", "days-hours", "days-hours:minutes" and
// "days-hours:minutes:seconds" (sbatch(1), --time).
bool is_time(std::string_view text) {
  if (const auto dash = text.find('-'); dash != std::string_view::npos) {
    if (!is_digits(text.substr(0, dash))) return false;
    text.remove_prefix(dash + 1);
  }
  for (int parts = 0; parts < 3; ++parts) {
    const auto colon = text.find(':');
    if (!is_digits(text.substr(0, colon))) return false;
    if (colon == std::string_view::npos) return true;
    text.remove_prefix(colon + 1);
  }
  return false;
}

// A whole number, in megabytes unless a suffix says otherwise (sbatch(1), --mem).
bool is_memory(std::string_view text) {
  if (!text.empty() && std::string_view("KMGT").find(text.back()) != std::string_view::npos)
    text.remove_suffix(1);
  return is_digits(text);
}

constexpr int kMostTasks = 100'000;

// A whole number from 1 to kMostTasks.
std::optional<int> count_of(std::string_view text) {
  const auto count = number_from_text<int>(text);
  return count && is_digits(text) && *count >= 1 && *count <= kMostTasks ? count : std::nullopt;
}

// "TASKS", "TASKS%M" or "%M"; `tasks_of` reads the first.
std::optional<TaskArray> array_of(std::string_view text,
                                  std::optional<int> (*tasks_of)(std::string_view)) {
  const auto percent = text.find('%');
  TaskArray array;
  if (percent != 0) {
    const auto tasks = tasks_of(text.substr(0, percent));
    if (!tasks) return std::nullopt;
    array.tasks = *tasks;
  }
  if (percent != std::string_view::npos) {
    const auto at_once = count_of(text.substr(percent + 1));
    if (!at_once) return std::nullopt;
    array.at_once = *at_once;
  }
  return array;
}

using ValueRule = bool (*)(std::string_view);

struct SlurmKey {
  std::string_view key;
  std::string_view option;
  ValueRule holds;
  std::string_view expected;
};

constexpr std::array<SlurmKey, 5> kSlurmKeys = {{
    {"time",
     "--time",
     is_time,
     "minutes, [hours:]minutes:seconds or days-hours[:minutes[:seconds]]"},
    {"memory", "--mem", is_memory, "a whole number with K, M, G or T, as \"4G\""},
    {"partition", "--partition", is_value, "the name of a partition"},
    {"account", "--account", is_value, "the name of an account"},
    {"qos", "--qos", is_value, "the name of a quality of service"},
}};

}  // namespace

TaskArray array_size_of(std::string_view text) {
  if (const auto array = array_of(text, count_of)) return *array;
  throw Error(
      fmt::format("{} is no number of tasks; expected N, N%M or %M, for N tasks of which M "
                  "run at a time, each from 1 to {}",
                  scene::in_quotes(text),
                  kMostTasks));
}

TaskArray task_array_of(std::string_view text) {
  const auto array = array_of(text, [](std::string_view range) -> std::optional<int> {
    if (range == "0" || range == "0-0") return 1;
    if (!range.starts_with("0-")) return std::nullopt;
    const auto last = count_of(range.substr(2));
    return last ? std::optional(*last + 1) : std::nullopt;
  });
  if (array) return *array;
  throw Error(
      fmt::format("{} is no array of a set's tasks; expected 0-L, 0-L%M or %M, for tasks 0 "
                  "to L of which M run at a time",
                  scene::in_quotes(text)));
}

std::string sbatch_option(const std::string& given, const Where& where) {
  const auto refuse = [&](const std::string& why) {
    throw Error(scene::in_quotes(given) + " is no option for sbatch: " + why, where);
  };
  const auto break_at = given.find_first_of("= ");
  const std::string name = given.substr(0, break_at);
  if (name.size() < 3 || name.compare(0, 2, "--") != 0 || !is_option_name(name.substr(2)))
    refuse("expected --name=value");
  const auto own = std::find(kOwnOptions.begin(), kOwnOptions.end(), name.substr(2));
  if (own != kOwnOptions.end())
    refuse("--" + std::string(*own) + " is set by airtruth's own job scripts");
  if (name == "--array" && break_at == std::string::npos) refuse("it has no value");
  if (break_at == std::string::npos) return name;
  const std::string value = given.substr(break_at + 1);
  if (!is_value(value))
    refuse("its value is not one word of letters, digits and " + std::string(kValueMarks));
  if (name == "--array") try {
      task_array_of(value);
    } catch (const Error& error) {
      refuse(error.message());
    }
  return name + "=" + value;
}

std::vector<std::string> slurm_in(const scene::TableReader& root) {
  const scene::TableReader table =
      root.table("slurm", {"time", "memory", "partition", "account", "qos", "cpus", "sbatch"});
  std::vector<std::string> result;
  for (const SlurmKey& key : kSlurmKeys) {
    const auto value = table.text(key.key);
    if (!value) continue;
    if (!key.holds(*value))
      table.fail(
          key.key,
          fmt::format("{} is {}; expected {}", key.key, scene::in_quotes(*value), key.expected));
    result.push_back(fmt::format("{}={}", key.option, *value));
  }
  if (const auto cpus = table.whole("cpus", 1, 4096))
    result.push_back(fmt::format("--cpus-per-task={}", *cpus));
  const auto more = table.texts("sbatch").value_or(std::vector<std::string>{});
  for (std::size_t i = 0; i < more.size(); ++i)
    result.push_back(sbatch_option(more[i], table.where("sbatch", i)));
  return result;
}

std::string sbatch_log(const std::string& folder, std::string_view pattern) {
  if (std::any_of(folder.begin(), folder.end(), is_control))
    throw Error("has a control character in its name, which no line of a job script can hold",
                {scene::in_quotes(folder)});
  if (folder.find('\\') != std::string::npos)
    throw Error("has a backslash in its name, which Slurm does not take in the name of a log",
                {folder});
  std::string result = "\"";
  for (const char c : folder) {
    if (c == '"') result += '\\';
    result += c;
    if (c == '%') result += '%';
  }
  return result + "/" + std::string(pattern) + "\"";
}

}  // namespace airtruth::catalogue
