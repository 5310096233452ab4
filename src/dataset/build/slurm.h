// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "dataset/catalogue/folder.h"
#include "dataset/catalogue/slurm_options.h"
#include "foundation/base/files.h"

namespace airtruth::build {

struct SlurmOptions {
  // Where the number of tasks is not stated it is one per sequence, at most 1,000. What is stated
  // here takes precedence over an --array among the options below.
  catalogue::TaskArray array;
  // As BuildOptions::max_in_a_folder.
  std::int64_t max_in_a_folder = sequences::kMaxSequencesInAFolder;
  std::string partition;
  // Options as --sbatch states them ("--time=2:00:00"). They take precedence over the options of
  // the catalogue's [slurm].
  std::vector<std::string> sbatch;
  // Maps a background's name to the video that replaces the catalogue's.
  std::map<std::string, fs::path> videos;
  // The airtruth program that the tasks run.
  fs::path program;
  // True: write the scripts and report what would be submitted, without submitting it.
  bool dry_run = false;
};

struct Submitted {
  fs::path work_script;
  fs::path verify_script;
  // Slurm's job numbers; empty on a dry run.
  std::string work_job;
  std::string verify_job;
};

// Writes two scripts and submits both with sbatch. <out>/slurm/work.sh is a job array; each of its
// tasks makes its share. verify.sh runs after all tasks have ended, writes the manifest and
// verifies the set. A task that is requeued continues where it stopped. Throws Error where a job
// script cannot hold an option or a path (dataset/catalogue/slurm_options.h), and where sbatch is
// missing, refuses or states no job. Where the second job fails the array is cancelled, and the
// error says where that fails, too; a job whose number sbatch did not state may be left.
Submitted submit(const catalogue::Catalogue& catalogue,
                 const fs::path& out,
                 const SlurmOptions& options);

}  // namespace airtruth::build
