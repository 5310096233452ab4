// SPDX-License-Identifier: Apache-2.0
#include "dataset/build/slurm.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>
#include <string_view>
#include <vector>

#include <fmt/format.h>
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

// Returns the first line that a command prints. Throws Error where the command fails.
std::string first_line(const std::string& command) {
  FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
  check(pipe != nullptr, "a process can be started");
  std::string output;
  std::array<char, 4096> buffer;
  while (const std::size_t got = std::fread(buffer.data(), 1, buffer.size(), pipe))
    output.append(buffer.data(), got);
  const int status = ::pclose(pipe);
  const std::string line = output.substr(0, output.find('\n'));
  if (status == -1 || !WIFEXITED(status) || WEXITSTATUS(status) != 0)
    throw Error("sbatch failed: " + (line.empty() ? "no word why" : line) +
                "; expected Slurm's client tools and a running cluster");
  return line;
}

}  // namespace

Submitted submit(const catalogue::Catalogue& catalogue,
                 const fs::path& out,
                 const SlurmOptions& options) {
  const fs::path root = fs::absolute(out).lexically_normal();
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
  submitted.work_job =
      first_line("sbatch --parsable " + shell_word(submitted.work_script.string()));
  submitted.work_job = submitted.work_job.substr(0, submitted.work_job.find(';'));
  submitted.verify_job =
      first_line("sbatch --parsable --dependency=afterany:" + submitted.work_job + " " +
                 shell_word(submitted.verify_script.string()));
  submitted.verify_job = submitted.verify_job.substr(0, submitted.verify_job.find(';'));
  return submitted;
}

}  // namespace airtruth::build
