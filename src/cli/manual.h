// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include <CLI/CLI.hpp>

// Manual pages and shell completion, made from the same source as --help, so that the three agree.
namespace airtruth::cli {

// Section 1 of the manual in roff, by file name: airtruth.1, and airtruth-COMMAND.1 or
// airtruth-GROUP-COMMAND.1 for each command. The same program gives the same bytes.
std::map<std::string, std::string> manual_pages(const CLI::App& app);

// A bash script that completes commands, options, the values of options that have a list of
// choices, and otherwise file names.
std::string bash_completion(const CLI::App& app);

}  // namespace airtruth::cli
