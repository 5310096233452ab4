// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

// Checks of an output path before the work begins, so that hours of work do not end with an error
// about a file name.
namespace airtruth {

// Throws Error where write_file() would fail for a reason that exists already: the path exists and
// may not be replaced, is a folder, or lies in a folder that is missing or not writable. An empty
// path means that there is no output, and passes.
void check_output_file(const std::filesystem::path& path, bool overwrite);

// The same for a folder that is created, with its parents, where it is missing. Throws Error where
// the path is a file, or where the nearest existing folder is not writable.
void check_output_folder(const std::filesystem::path& path);

}  // namespace airtruth
