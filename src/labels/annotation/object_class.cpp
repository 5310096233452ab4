// SPDX-License-Identifier: Apache-2.0
#include "labels/annotation/object_class.h"

#include <cctype>
#include <string>

namespace airtruth::annotation {
namespace {

struct ClassWords {
  std::string_view object_class;
  std::string_view words;  // with ", " between
};

// Categories of public sets (AOT, COCO, VisDrone, Anti-UAV, DUT, NPS, FL-Drones) and of this
// program, and words of the same kinds.
constexpr auto kWords = std::to_array<ClassWords>(
    {{"aircraft",
      "aircraft, airplane, aeroplane, plane, fixed wing, helicopter, rotorcraft, jet, airliner, "
      "glider, sailplane, ultralight"},
     {"bird", "bird, flock, flock of bird"},
     {"multirotor",
      "drone, uav, uas, multirotor, multicopter, quadcopter, quadrotor, hexacopter, octocopter"},
     {"balloon", "balloon, hot air balloon"},
     {"glint", "glint"},
     {"dirt", "dirt"},
     {"insect", "insect"},
     {"ignore", "ignore, ignored, ignored region"}});

// "Hot-air_Balloons" as "hot air balloon".
std::string plain(std::string_view category) {
  std::string text;
  for (const char c : category) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) != 0)
      text += static_cast<char>(std::tolower(byte));
    else if (!text.empty() && text.back() != ' ')
      text += ' ';
  }
  while (text.ends_with(' ')) text.pop_back();
  return text;
}

}  // namespace

std::optional<std::string_view> class_of_category(std::string_view category) {
  std::string text = plain(category);
  for (int attempt = 0; attempt < 2; ++attempt) {
    for (const auto& [object_class, words] : kWords)
      for (std::string_view rest = words; !rest.empty();) {
        const auto end = rest.find(", ");
        if (rest.substr(0, end) == text) return object_class;
        rest = end == std::string_view::npos ? "" : rest.substr(end + 2);
      }
    if (!text.ends_with('s')) break;
    text.pop_back();
  }
  return std::nullopt;
}

}  // namespace airtruth::annotation
