// SPDX-License-Identifier: Apache-2.0
// Any bytes are a catalogue or an Error. Each sequence of a catalogue has a name, is the same
// whenever it is asked for, and is a scene that reads back from its own text once it has its video.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include "dataset/catalogue/expand.h"
#include "foundation/base/error.h"

namespace {

using namespace airtruth;

// The scene of a sequence over a video of 300 frames.
std::string scene_of(const catalogue::Catalogue& catalogue, catalogue::Item item) {
  catalogue::place(item, catalogue, {"/fuzz/clip.mkv", {}, 640, 480, 30, 300});
  return scene::toml_from_scene(item.scene);
}

void check(const catalogue::Catalogue& catalogue,
           const catalogue::Expansion& sequences,
           std::int64_t index) {
  const catalogue::Item item = sequences.at(index);
  if (item.index != index || item.name.empty() || item.frame_count < 0 ||
      item.background >= catalogue.backgrounds.size())
    std::abort();
  const std::string text = scene_of(catalogue, item);
  if (sequences.at(index).name != item.name || scene_of(catalogue, sequences.at(index)) != text)
    std::abort();
  if (item.scene.intruders.empty()) return;
  scene::Scene again;
  try {
    again = scene::parse_scene(text, "/fuzz/again.toml");
  } catch (const Error& error) {
    std::fputs(error.what(), stderr);
    std::abort();
  }
  if (toml_from_scene(again) != text) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  try {
    const catalogue::Catalogue catalogue = catalogue::parse_catalogue(text, "/fuzz/catalogue.toml");
    const catalogue::Expansion sequences(catalogue);
    if (sequences.size() < 1) std::abort();
    for (const std::int64_t index : {std::int64_t{0}, sequences.size() / 2, sequences.size() - 1})
      check(catalogue, sequences, index);
  } catch (const Error&) {
  }
  return 0;
}
