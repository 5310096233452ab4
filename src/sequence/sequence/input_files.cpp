// SPDX-License-Identifier: Apache-2.0
#include "sequence/sequence/input_files.h"

#include <algorithm>

#include "sequence/setup/shared_inputs.h"

namespace airtruth::sequence {
namespace {

std::vector<fs::path> model_files(const World& world) {
  std::vector<fs::path> models;
  for (const Actor& actor : world.actors)
    models.insert(models.end(), actor.type->sources.begin(), actor.type->sources.end());
  std::sort(models.begin(), models.end());
  models.erase(std::unique(models.begin(), models.end()), models.end());
  return models;
}

}  // namespace

std::vector<Checksum> input_files(const scene::Scene& scene,
                                  const World& world,
                                  const std::string& video_sha256,
                                  SharedInputs* shared) {
  std::vector<Checksum> result;
  if (!video_sha256.empty()) result.push_back({scene.background.video.string(), video_sha256});
  const auto add = [&](const fs::path& file) {
    result.push_back({file.string(), shared_sha256(file, shared)});
  };
  if (scene.background.mask) add(*scene.background.mask);
  if (scene.realism.file) add(*scene.realism.file);
  if (scene.lens.file) add(*scene.lens.file);
  if (scene.camera.path_file) add(*scene.camera.path_file);
  if (scene.camera.log) add(*scene.camera.log);
  for (const scene::Intruder& intruder : scene.intruders)
    if (intruder.path_file) add(*intruder.path_file);
  for (const fs::path& model : model_files(world)) add(model);
  return result;
}

}  // namespace airtruth::sequence
