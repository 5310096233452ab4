// SPDX-License-Identifier: Apache-2.0
#include "sequence/replay/recorded_inputs.h"

#include <exception>
#include <map>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/json/json_object.h"
#include "sequence/setup/motion_source.h"

namespace airtruth::replay {
namespace {

// The SHA-256 of each input, by its name.
std::map<fs::path, std::string> inputs_in_record(const fs::path& sequence) {
  std::map<fs::path, std::string> recorded;
  const JsonDocument record(sequence / "sequence.json");
  if (record.has("inputs"))
    for (const JsonObject& input : record.objects("inputs"))
      recorded[input.text("name")] = input.text("sha256");
  return recorded;
}

std::optional<fs::path> find_recorded(const fs::path& name,
                                      const std::string& sha256,
                                      const fs::path& sequence,
                                      setup::SharedInputs& inputs) {
  std::error_code none;
  const bool is_changed = is_another(name, sha256, inputs);
  if (!is_changed && fs::exists(name, none)) return name;
  // The sequence lies in sequences/NAME, or in a numbered folder: sequences/0001/NAME.
  fs::path above = absolute_path(sequence / "sequence.json").parent_path();
  above = above.parent_path();
  for (int i = 0; i < 2; ++i) {
    above = above.parent_path();
    const fs::path own = above / "backgrounds" / name.filename();
    if (fs::is_regular_file(own, none) && inputs.sha256_of_file(own) == sha256) return own;
  }
  return is_changed ? std::nullopt : std::optional(name);
}

}  // namespace

bool is_another(const fs::path& input, const std::string& sha256, setup::SharedInputs& inputs) {
  std::error_code ignored;
  if (fs::is_regular_file(input, ignored) && inputs.sha256_of_file(input) == sha256) return false;
  try {
    const std::string now = setup::sha256_of_video(input, inputs);
    return !now.empty() && now != sha256;
  } catch (const std::exception&) {
    // It is a text that is no list of pictures, a series without any, or another user's folder.
    return fs::exists(input, ignored);
  }
}

std::optional<fs::path> find_input(const fs::path& name,
                                   const fs::path& sequence,
                                   setup::SharedInputs& inputs) {
  const auto recorded = inputs_in_record(sequence);
  const auto input = recorded.find(name.lexically_normal());
  if (input == recorded.end()) return name;
  return find_recorded(name, input->second, sequence, inputs);
}

scene::Scene scene_as_made(const Finished& sequence, setup::SharedInputs& inputs) {
  scene::Scene scene = *sequence.scene;
  std::map<fs::path, fs::path> found;
  for (const auto& [name, sha256] : inputs_in_record(sequence.folder)) {
    const auto file = find_recorded(name, sha256, sequence.folder, inputs);
    if (!file)
      throw Error("is another file than the one that '" + sequence.name +
                      "' was made of (its SHA-256 differs); expected that file",
                  {name.string()});
    found[name] = *file;
  }
  const auto place = [&](fs::path& file) {
    const auto input = found.find(file.lexically_normal());
    if (input != found.end()) file = input->second;
  };
  place(scene.background.video);
  if (scene.background.mask) place(*scene.background.mask);
  return scene;
}

}  // namespace airtruth::replay
