// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "aircraft/model/raw_model.h"
#include "foundation/sandbox/messages.h"

// A RawModel as bytes, for the socket between the program and its reader and for the cache.
namespace airtruth::aircraft {

using sandbox::WireReader;
using sandbox::WireWriter;

std::string bytes_of(const RawModel& model);

// Throws Error where the bytes are not exactly one model that passes check_model.
RawModel model_from_bytes(std::string_view bytes);

}  // namespace airtruth::aircraft
