// SPDX-License-Identifier: Apache-2.0
#include "studio/document/change.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "foundation/base/error.h"
#include "foundation/base/text.h"

namespace airtruth::document {
namespace {

using Json = nlohmann::ordered_json;

// A path of the scene file has four steps; a table that is inserted holds arrays of arrays.
constexpr std::size_t kMostSteps = 16;
constexpr int kMostDepth = 16;

[[noreturn]] void refuse(const std::string& place, const std::string& what) {
  throw Error(place + ": " + what);
}

Path path_from(const Json& json, const std::string& place) {
  if (!json.is_array() || json.empty() || json.size() > kMostSteps)
    refuse(place, "is no path; expected an array of keys and places such as [\"intruder\", 0]");
  Path path;
  for (const Json& step : json) {
    if (step.is_string())
      path.emplace_back(step.get<std::string>());
    else if (step.is_number_unsigned())
      path.emplace_back(step.get<std::size_t>());
    else
      refuse(place, "has the step " + step.dump() + "; expected a key or a place from 0 on");
  }
  if (!std::holds_alternative<std::string>(path.front()))
    refuse(place, "begins with a place; expected the key of a table");
  return path;
}

void check_value(const Json& value, const std::string& place, int depth = 0) {
  if (depth > kMostDepth) refuse(place, "is nested too deep");
  if (value.is_null()) refuse(place, "holds null, which TOML has not");
  if (value.is_number_float() && !std::isfinite(value.get<double>()))
    refuse(place, "holds a number that is not finite");
  if (value.is_structured())
    for (const Json& part : value) check_value(part, place, depth + 1);
}

// 613.2, 288, 0.000012: as a person writes it.
std::string number(double value) {
  // Below it, six decimals would leave fewer than three digits.
  constexpr double kSmall = 1e-3;
  if (value == 0) return "0";
  if (std::abs(value) < kSmall || std::abs(value) >= 1e15) return fmt::format("{:.6g}", value);
  std::string text = fmt::format("{:.6f}", value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

template <typename Parts, typename Write>
std::string joined(const Parts& parts, const Write& write) {
  std::string text;
  for (auto it = parts.begin(); it != parts.end(); ++it)
    text += (text.empty() ? "" : ", ") + write(it);
  return text;
}

}  // namespace

Change change_from(const Json& json, const std::string& place) {
  const JsonObject object(json, {}, place);
  Change change;
  if (json.contains("set")) {
    object.expect_keys_among({"set", "to"});
    change.path = path_from(json["set"], place + ".set");
    if (!json.contains("to")) refuse(place, "has no \"to\"; expected the value to set");
    change.value = json["to"];
    check_value(change.value, place + ".to");
  } else if (json.contains("remove")) {
    object.expect_keys_among({"remove"});
    change.kind = Change::Kind::kRemove;
    change.path = path_from(json["remove"], place + ".remove");
  } else if (json.contains("insert")) {
    object.expect_keys_among({"insert", "at", "table"});
    change.kind = Change::Kind::kInsert;
    change.path = path_from(json["insert"], place + ".insert");
    if (object.has("at")) change.at = static_cast<std::size_t>(object.count("at"));
    if (!json.contains("table") || !json["table"].is_object())
      refuse(place, "has no \"table\"; expected an object with the keys of the new table");
    change.value = json["table"];
    check_value(change.value, place + ".table");
  } else {
    refuse(place, "is no change; expected an object with \"set\", \"remove\" or \"insert\"");
  }
  return change;
}

std::string words_of(const Path& path) {
  std::string words;
  for (const Step& step : path) {
    if (const auto* key = std::get_if<std::string>(&step))
      words += (words.empty() ? "" : ".") + *key;
    else
      words += fmt::format("[{}]", std::get<std::size_t>(step));
  }
  return words;
}

std::string toml_key(const std::string& key) {
  const auto is_bare = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-';
  };
  return !key.empty() && std::ranges::all_of(key, is_bare) ? key : toml_string(key);
}

std::string toml_of(const Json& value) {
  if (value.is_string()) return toml_string(value.get_ref<const std::string&>());
  if (value.is_boolean()) return value.get<bool>() ? "true" : "false";
  if (value.is_number_integer()) return value.dump();
  if (value.is_number()) return number(value.get<double>());
  if (value.is_array())
    return "[" + joined(value, [](const auto& part) { return toml_of(*part); }) + "]";
  check(value.is_object(), "a value of a scene is no null");
  if (value.empty()) return "{}";
  return "{ " +
         joined(value,
                [](const auto& part) { return toml_key(part.key()) + " = " + toml_of(*part); }) +
         " }";
}

}  // namespace airtruth::document
