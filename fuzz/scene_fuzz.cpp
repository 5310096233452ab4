// SPDX-License-Identifier: Apache-2.0
// Any bytes are a scene or an Error; a scene reads back from its own text.
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "foundation/base/error.h"
#include "scene/scene/scene.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  airtruth::scene::Scene scene;
  try {
    scene = airtruth::scene::parse_scene(text, "/fuzz/scene.toml");
  } catch (const airtruth::Error&) {
    return 0;
  }
  const std::string effective = airtruth::scene::toml_from_scene(scene);
  if (toml_from_scene(airtruth::scene::parse_scene(effective, "/other/again.toml")) != effective)
    std::abort();
  return 0;
}
