// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

// The classes of what a scene puts into a video: an aircraft, or a distractor, which a detector may
// take for one. A distractor is no tracking target.
namespace airtruth::annotation {

inline constexpr std::string_view kAircraft = "aircraft";
// In the air: each has a place in the world, a range and a path.
inline constexpr std::array<std::string_view, 3> kInTheAir = {"bird", "multirotor", "balloon"};
// On the lens: each has a place in the picture alone.
inline constexpr std::array<std::string_view, 3> kOnTheLens = {"glint", "dirt", "insect"};

constexpr bool is_aircraft(std::string_view object_class) { return object_class == kAircraft; }

constexpr bool is_on_lens(std::string_view object_class) {
  return std::ranges::find(kOnTheLens, object_class) != kOnTheLens.end();
}

constexpr bool is_object_class(std::string_view word) {
  return is_aircraft(word) || is_on_lens(word) ||
         std::ranges::find(kInTheAir, word) != kInTheAir.end();
}

// The class of a category of somebody's labels: "Airplane", "helicopter" and the like are aircraft,
// "Flock" is a bird, "UAV" and "Drone" are multirotors, "Ignored regions" is "ignore". Letter case,
// a plural's s, and signs between words do not matter. Empty for any other word.
std::optional<std::string_view> class_of_category(std::string_view category);

}  // namespace airtruth::annotation
