// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "dataset/catalogue/folder.h"

namespace airtruth::dataset {

struct SlurmOptions {
  int array_size = 0;  // tasks; 0: one per sequence, at most 1,000
  std::string partition;
  // As --sbatch states them ("--time=2:00:00"); they count before those of the catalogue's [slurm].
  std::vector<std::string> sbatch;
  std::map<std::string, fs::path> videos;  // in place of the catalogue's backgrounds
  fs::path program;                        // the airtruth that the tasks run
  bool dry_run = false;                    // write the scripts and say what would be submitted
};

struct Submitted {
  fs::path work_script;
  fs::path verify_script;
  std::string work_job;  // Slurm's numbers; empty on a dry run
  std::string verify_job;
};

// Writes <out>/slurm/work.sh, a job array each task of which makes its share, and verify.sh, which
// runs once all of them have ended, writes the manifest and verifies; and submits both (sbatch). A
// task that is requeued goes on where it was. Error where an option or a path cannot stand in a job
// script (dataset/catalogue/slurm_options.h), and where sbatch is missing or refuses; nothing is
// then left running.
Submitted submit(const Catalogue& catalogue, const fs::path& out, const SlurmOptions& options);

}  // namespace airtruth::dataset
