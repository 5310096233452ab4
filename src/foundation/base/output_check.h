// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

// What can be known of an output before the work that makes it, so that hours of work do not end
// in a message about a file name.
namespace airtruth {

// Error where write_file() would fail for a reason that is there already: the path exists and may
// not be replaced, is a folder, or lies in a folder that is missing or may not be written to. An
// empty path is no output and no error.
void check_output_file(const std::filesystem::path& path, bool overwrite);

// The same for a folder that is made where it is missing, with the folders above it: Error where
// the path is a file, or where the nearest folder that exists may not be written to.
void check_output_folder(const std::filesystem::path& path);

}  // namespace airtruth
