// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include <nlohmann/json_fwd.hpp>

namespace airtruth {

// A folder of results has a record, a JSON file, of the settings that decide its content, so that
// only a run with the same settings goes on in it.
//
// Returns false where there is no such file, or one of other settings beside which there are no
// results but logs. Throws Error where its folder holds others without it, where the file is no
// record, and where it holds another value than `settings` for one of its keys; further keys of the
// file do not matter.
bool is_record_of(const std::filesystem::path& file, const nlohmann::ordered_json& settings);

// Throws Error where the file, the record of one of the results in its folder, holds another value
// than `settings` for a key that both have, or is no record. Without the file there is none.
void refuse_other(const std::filesystem::path& file, const nlohmann::ordered_json& settings);

// Throws Error where the file is there and is no record.
void check_record(const std::filesystem::path& file);

}  // namespace airtruth
