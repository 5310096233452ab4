// SPDX-License-Identifier: Apache-2.0
#include "labels/annotation/object_class.h"

#include <cctype>
#include <string>
#include <utility>

namespace airtruth::annotation {
namespace {

using Word = std::pair<std::string_view, std::string_view>;

// Categories of public sets (AOT, COCO, VisDrone, Anti-UAV, DUT, NPS, FL-Drones) and of this
// program, and words of the same kinds, by class.
constexpr auto kWords = std::to_array<Word>({
    {"aircraft", "aircraft"},
    {"airplane", "aircraft"},
    {"aeroplane", "aircraft"},
    {"plane", "aircraft"},
    {"fixed wing", "aircraft"},
    {"helicopter", "aircraft"},
    {"rotorcraft", "aircraft"},
    {"jet", "aircraft"},
    {"airliner", "aircraft"},
    {"glider", "aircraft"},
    {"sailplane", "aircraft"},
    {"ultralight", "aircraft"},
    {"bird", "bird"},
    {"flock", "bird"},
    {"flock of bird", "bird"},
    {"drone", "multirotor"},
    {"uav", "multirotor"},
    {"uas", "multirotor"},
    {"multirotor", "multirotor"},
    {"multicopter", "multirotor"},
    {"quadcopter", "multirotor"},
    {"quadrotor", "multirotor"},
    {"hexacopter", "multirotor"},
    {"octocopter", "multirotor"},
    {"balloon", "balloon"},
    {"hot air balloon", "balloon"},
    {"glint", "glint"},
    {"dirt", "dirt"},
    {"insect", "insect"},
    {"ignore", "ignore"},
    {"ignored", "ignore"},
    {"ignored region", "ignore"},
});

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
    for (const auto& [word, object_class] : kWords)
      if (text == word) return object_class;
    if (!text.ends_with('s')) break;
    text.pop_back();
  }
  return std::nullopt;
}

}  // namespace airtruth::annotation
