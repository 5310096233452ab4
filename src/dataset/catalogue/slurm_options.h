// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "foundation/base/error.h"
#include "world/scene/table_reader.h"

// Options of Slurm's sbatch that a user states: the table [slurm] of a catalogue, and --sbatch of
// `airtruth dataset submit`. Each becomes one line "#SBATCH --name=value" of a job script.
namespace airtruth::dataset {

// The option as "--name=value" or "--name". Takes "--name=value", "--name value" and "--name"; the
// value is one word. Throws Error at `where` for what is not of that form, for a character that
// sbatch or a shell gives a meaning of its own (quotes, backslash, $, `, #, ;, white space, control
// characters), and for options that the scripts set themselves (--array, --output, --dependency,
// ...).
std::string sbatch_option(const std::string& given, const Where& where = {});

// The table [slurm] inside `root`: time, memory, partition, account, qos, cpus and `sbatch`, an
// array of further options; in the order in which they are listed here. Empty where there is no
// table. Throws Error at the key.
std::vector<std::string> slurm_in(const scene::TableReader& root);

// The value of "#SBATCH --output=": a file in `folder` whose name may hold Slurm's patterns ("%a").
// It stands in double quotes, in which sbatch takes all but a quote as it is; a % of the folder is
// doubled. Throws Error for a folder that holds a control character, or a backslash, which ends the
// replacement of patterns.
std::string sbatch_log(const std::string& folder, std::string_view pattern);

}  // namespace airtruth::dataset
