// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "foundation/base/error.h"
#include "scene/scene/table_reader.h"

// The user's options for Slurm's sbatch: the table [slurm] of a catalogue, and --sbatch of
// `airtruth dataset submit`. Each option becomes one line "#SBATCH --name=value" of a job script.
namespace airtruth::catalogue {

// Returns the option as "--name=value" or "--name". Accepts "--name=value", "--name value" and
// "--name"; the value is one word. Throws Error at `where` for any other form; for a character with
// a special meaning to sbatch or a shell (quotes, backslash, $, `, #, ;, white space, control
// characters); and for an option that the scripts set themselves (--output, --dependency, ...). Of
// --array it accepts what task_array_of() reads.
std::string sbatch_option(const std::string& given, const Where& where = {});

// How a job array divides the work.
struct TaskArray {
  int tasks = 0;    // 0: as many as the set asks for
  int at_once = 0;  // the most that run at a time; 0: all
};

// Reads "N", "N%M" or "%M" of --array-size: N tasks, M of them at a time. Throws Error for anything
// else.
TaskArray array_size_of(std::string_view text);

// Reads the value of sbatch's --array: "0-L", "0-L%M" or "%M", where L is the last task's number.
// Other numbers throw Error: a task's number says which share of the set is its own.
TaskArray task_array_of(std::string_view text);

// Returns the options of the table [slurm] in `root`: time, memory, partition, account, qos, cpus
// and the array `sbatch` of further options, in this order. Returns an empty list where there is no
// table. Throws Error at the key.
std::vector<std::string> slurm_in(const scene::TableReader& root);

// Returns the value of "#SBATCH --output=": a file in `folder` whose name may hold Slurm's patterns
// ("%a"). The value stands in double quotes, within which sbatch takes every character but a quote
// literally; each % of the folder is doubled. Throws Error for a folder with a control character or
// with a backslash, because a backslash switches off the replacement of patterns.
std::string sbatch_log(const std::string& folder, std::string_view pattern);

}  // namespace airtruth::catalogue
