// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <stop_token>
#include <string>

#include <nlohmann/json.hpp>

namespace airtruth::session {

// The aircraft that can be put into a scene, and pictures of them and of distractors. Of one
// thread.
class Gallery {
 public:
  // {"groups": [{"name", "type", "class", "length_m", "span_m", "liveries": [...]}]}: the types
  // whose name, published type or class of flight limits contains the word; letter case does not
  // matter.
  nlohmann::ordered_json groups(const std::string& word);

  // A picture of 150 x 150 px as JPEG. `name`: a livery, or a kind of distractor. Empty where the
  // gallery has none of that name.
  std::optional<std::string> picture(const std::string& name, const std::stop_token& stop);

 private:
  std::map<std::string, std::string> pictures_;
};

}  // namespace airtruth::session
