// SPDX-License-Identifier: Apache-2.0
// Any bytes are a message of the studio's page or an Error, and an edit is made in place or is an
// Error: changed() reads the text again and would end the program where another value had changed.
// The first byte chooses: a message for a scene, a TOML text with a change behind a zero byte, the
// target of a request, a range.
#include <cstdint>
#include <string>
#include <string_view>

#include "foundation/base/error.h"
#include "studio/document/splice.h"
#include "studio/messages/request.h"

namespace {

using namespace airtruth;

constexpr std::string_view kScene =
    "# mine\nname = \"x\" # y\n[lens] # z\nlens.a = 1\nvertical_fov_deg = 60.5\n"
    "pixel = [1, # one\n 2]\nt = { a = 1, b.c = [1, 2] }\n[[intruder]]\nid = 'a'\n"
    "[[intruder.seen]]\ntime_s = 1\n[[intruder.seen]]\ntime_s = 2\n[[intruder]]\n"
    "seen = [{ a = 1 }, { a = 2 }]";

void take_message(std::string_view text) {
  messages::id_of(text);
  std::string scene(kScene);
  for (const document::Change& change : messages::request_from(text).changes)
    scene = document::changed(scene, change, "/fuzz/scene.toml");
}

void take_change(std::string_view text) {
  const std::size_t end = text.find('\0');
  if (end == std::string_view::npos) return;
  const std::string message =
      "{\"id\":1,\"do\":\"edit\",\"changes\":[" + std::string(text.substr(end + 1)) + "]}";
  for (const document::Change& change : messages::request_from(message).changes)
    document::changed(text.substr(0, end), change, "/fuzz/scene.toml");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);
  try {
    switch (data[0] % 4) {
      case 0:
        take_message(text);
        break;
      case 1:
        take_change(text);
        break;
      case 2:
        messages::target_from(text);
        break;
      default:
        messages::range_from(text, 1000, 300);
    }
  } catch (const Error&) {
  }
  return 0;
}
