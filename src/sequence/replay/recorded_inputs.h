// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "foundation/base/files.h"
#include "scene/scene/scene.h"
#include "sequence/replay/finished.h"
#include "sequence/setup/shared_inputs.h"

// The files that a sequence was made of, as its record names them: by path and SHA-256. `inputs`
// reads each file once.
namespace airtruth::replay {

// Whether an input, a file or a series of pictures, is another one now than the one with this
// recorded SHA-256. False where it is missing.
bool is_another(const fs::path& input, const std::string& sha256, setup::SharedInputs& inputs);

// Where the recorded input of this name is now: in its place, or, of a set that was moved or
// copied, under its file name in backgrounds/ of the set in which the sequence's folder lies. The
// name itself where the input is missing, and where the record states no SHA-256 of it. Empty where
// another file has its place.
std::optional<fs::path> find_input(const fs::path& name,
                                   const fs::path& sequence,
                                   setup::SharedInputs& inputs);

// The scene of a rendered sequence with its background and mask where find_input() finds them.
// Throws Error where a file that the sequence was made of is another one now.
scene::Scene scene_as_made(const Finished& sequence, setup::SharedInputs& inputs);

}  // namespace airtruth::replay
