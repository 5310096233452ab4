// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "scene/scene/scene.h"
#include "sequence/sequence/outputs.h"
#include "sequence/setup/world.h"

namespace airtruth::sequence {

// Every file that a run reads, with its SHA-256, for sequence.json: video, mask, camera file, lens
// file, path files, and the files of the aircraft's models by name. `scene` is the one the user
// gave. `video_sha256` is empty for a pattern of numbered images, which is then left out. `shared`
// knows the SHA-256 of other runs' files; nullptr: none.
std::vector<Checksum> input_files(const scene::Scene& scene,
                                  const World& world,
                                  const std::string& video_sha256,
                                  SharedInputs* shared);

}  // namespace airtruth::sequence
