// SPDX-License-Identifier: Apache-2.0
#include "dataset/build/slurm.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>
#include <sstream>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/wait.h>

#include "dataset/build/inputs.h"
#include "dataset/catalogue/expand.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/text.h"

namespace airtruth::build {
namespace {

constexpr std::int64_t kMaxTasks = 1000;  // Slurm's MaxArraySize is 1,001 by default

// The options of the catalogue, then those of the command line. Where two have the same name, the
// later one counts.
std::vector<std::string> options_of(const catalogue::Catalogue& catalogue,
                                    const SlurmOptions& options) {
  std::vector<std::string> result = catalogue.slurm;
  if (!options.partition.empty()) result.push_back("--partition=" + options.partition);
  for (const std::string& given : options.sbatch) {
    try {
      result.push_back(catalogue::sbatch_option(given));
    } catch (const Error& error) {
      throw Error("--sbatch: " + error.message());
    }
  }
  return result;
}

constexpr std::string_view kArray = "--array=";

// Takes the arrays out of `given`, because only one of the two scripts is an array. What `stated`
// leaves open is as the last of them has it.
catalogue::TaskArray taken_array(std::vector<std::string>& given, catalogue::TaskArray stated) {
  catalogue::TaskArray array;
  for (const std::string& option : given) {
    if (!option.starts_with(kArray)) continue;
    const auto one = catalogue::task_array_of(std::string_view(option).substr(kArray.size()));
    if (one.tasks > 0) array.tasks = one.tasks;
    if (one.at_once > 0) array.at_once = one.at_once;
  }
  std::erase_if(given, [](const std::string& option) { return option.starts_with(kArray); });
  if (stated.tasks > 0) array.tasks = stated.tasks;
  if (stated.at_once > 0) array.at_once = stated.at_once;
  return array;
}

std::string head(const std::string& name,
                 const std::string& log,
                 const std::vector<std::string>& options) {
  std::string text = "#!/bin/sh\n#SBATCH --job-name=" + name + "\n#SBATCH --output=" + log +
                     "\n#SBATCH --open-mode=append\n";
  for (const std::string& option : options) text += "#SBATCH " + option + "\n";
  return text;
}

std::string work_script(const catalogue::Catalogue& catalogue,
                        const fs::path& out,
                        const SlurmOptions& options,
                        const std::vector<std::string>& given,
                        const catalogue::TaskArray& array) {
  std::string text =
      head("airtruth", catalogue::sbatch_log((out / "slurm").string(), "work-%a.log"), given);
  text += fmt::format("#SBATCH --array=0-{}{}\n#SBATCH --requeue\n",
                      array.tasks - 1,
                      array.at_once > 0 ? fmt::format("%{}", array.at_once) : "");
  text += fmt::format(
      "exec {} dataset work {} --out {} --index \"$SLURM_ARRAY_TASK_ID\" --of {} --jobs "
      "\"${{SLURM_CPUS_ON_NODE:-1}}\"",
      shell_word(options.program.string()),
      shell_word(fs::absolute(catalogue.file).string()),
      shell_word(out.string()),
      array.tasks);
  for (const auto& [name, video] : options.videos)
    text += " --background " + shell_word(name + "=" + video.string());
  return text + "\n";
}

std::string verify_script(const fs::path& out,
                          const SlurmOptions& options,
                          const std::vector<std::string>& given) {
  return head("airtruth-verify",
              catalogue::sbatch_log((out / "slurm").string(), "verify.log"),
              given) +
         fmt::format("exec {} dataset verify {} --finish --jobs \"${{SLURM_CPUS_ON_NODE:-1}}\"\n",
                     shell_word(options.program.string()),
                     shell_word(out.string()));
}

struct Ran {
  bool is_done = false;
  std::vector<std::string> lines;  // of both outputs, but for empty ones
};
Ran run_in_shell(const std::string& command) {
  FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
  check(pipe != nullptr, "a process can be started");
  std::string output;
  std::array<char, 4096> buffer;
  while (const std::size_t got = std::fread(buffer.data(), 1, buffer.size(), pipe))
    output.append(buffer.data(), got);
  const int status = ::pclose(pipe);
  Ran ran{status != -1 && WIFEXITED(status) && WEXITSTATUS(status) == 0, {}};
  std::istringstream lines(output);
  for (std::string line; std::getline(lines, line);)
    if (!line.empty()) ran.lines.push_back(line);
  return ran;
}

// A job as `sbatch --parsable` prints it: its number and, on a cluster that was asked for by name,
// ";" and that name.
struct Job {
  std::string number;
  std::string cluster;
};

// Plugins of a cluster print notes around the line of the job. Throws Error where there is none.
Job submitted_job(const std::string& arguments) {
  const Ran ran = run_in_shell("sbatch --parsable " + arguments);
  const std::string said =
      ran.lines.empty() ? "no word why" : fmt::format("{}", fmt::join(ran.lines, "; "));
  if (!ran.is_done)
    throw Error(
        fmt::format("sbatch failed: {}; expected Slurm's client tools, a running cluster and "
                    "options that it takes",
                    said));
  for (const std::string& line : ran.lines) {
    const std::size_t end = std::min(line.find_first_not_of("0123456789"), line.size());
    if (end == line.size()) return {line, {}};
    if (end > 0 && line[end] == ';') return {line.substr(0, end), line.substr(end + 1)};
  }
  throw Error("sbatch states no job: " + said + "; expected its number");
}

}  // namespace

Submitted submit(const catalogue::Catalogue& catalogue,
                 const fs::path& out,
                 const SlurmOptions& options) {
  const fs::path root = absolute_path(out);
  require_utf8(root);
  const auto odd = [](char c) {
    return !std::isalnum(static_cast<unsigned char>(c)) &&
           std::string_view("_-.,").find(c) == std::string_view::npos;
  };
  if (std::any_of(options.partition.begin(), options.partition.end(), odd))
    throw Error("'" + options.partition + "' is no name of a Slurm partition");
  check_sources(with_videos(catalogue, options.videos));
  const std::int64_t sequences = catalogue::Expansion(catalogue).size();
  std::vector<std::string> given = options_of(catalogue, options);
  catalogue::TaskArray array = taken_array(given, options.array);
  array.tasks = static_cast<int>(
      std::min<std::int64_t>(array.tasks > 0 ? array.tasks : kMaxTasks, sequences));
  // All checks come before the folder is made.
  const std::string work = work_script(catalogue, root, options, given, array);
  const std::string verify = verify_script(root, options, given);
  catalogue::open_folder(catalogue, root, options.max_in_a_folder);
  fs::create_directories(root / "slurm");
  Submitted submitted{root / "slurm" / "work.sh", root / "slurm" / "verify.sh", {}, {}};
  write_file(submitted.work_script, work);
  write_file(submitted.verify_script, verify);
  if (options.dry_run) return submitted;
  const Job array_job = submitted_job(shell_word(submitted.work_script.string()));
  submitted.work_job = array_job.number;
  try {
    submitted.verify_job = submitted_job("--dependency=afterany:" + array_job.number + " " +
                                         shell_word(submitted.verify_script.string()))
                               .number;
  } catch (const Error& error) {
    const std::string where =
        array_job.cluster.empty() ? "" : "--clusters=" + shell_word(array_job.cluster) + " ";
    if (run_in_shell("scancel " + where + array_job.number).is_done) throw;
    throw Error(error.message() + "; the array is left: scancel " + where + array_job.number);
  }
  return submitted;
}

}  // namespace airtruth::build
