// SPDX-License-Identifier: Apache-2.0
#include "studio/messages/request.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "foundation/base/error.h"
#include "foundation/base/text.h"
#include "foundation/json/json_object.h"
#include "foundation/json/parse_json.h"
#include "scene/scene/limits.h"

namespace airtruth::messages {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::int64_t kMostChanges = 200;
constexpr std::int64_t kMostFrames = 100'000'000;
constexpr std::int64_t kMostTables = 1'000'000;
constexpr std::size_t kMostWord = 200;

Json parsed(std::string_view text) {
  if (text.size() > kMostRequestBytes)
    throw Error(fmt::format("the message has {} bytes; expected at most 16 MiB", text.size()));
  if (is_nested_too_deep(text)) throw Error("the message is nested too deep");
  Json json = parse_json(text);
  if (!json.is_object())
    throw Error("the message is no JSON object; expected {\"id\": 7, \"do\": \"open\"}");
  return json;
}

std::string word(const JsonObject& message, const std::string& key) {
  std::string text = message.maybe_text(key).value_or("");
  if (text.size() > kMostWord)
    throw Error(fmt::format("{} has {} bytes; expected at most {}", key, text.size(), kMostWord));
  return text;
}

std::vector<document::Change> changes_in(const Json& json) {
  if (!json.contains("changes") || !json["changes"].is_array())
    throw Error("edit has no \"changes\"; expected an array");
  const Json& list = json["changes"];
  if (list.size() > kMostChanges)
    throw Error(fmt::format("edit has {} changes; expected at most {}", list.size(), kMostChanges));
  std::vector<document::Change> changes;
  for (std::size_t i = 0; i < list.size(); ++i)
    changes.push_back(document::change_from(list[i], fmt::format("changes[{}]", i)));
  return changes;
}

void take_frame(Request& request, const JsonObject& message) {
  request.frame = message.whole("frame", 0, kMostFrames);
  request.aircraft = message.maybe_truth("aircraft").value_or(true);
  request.scale = message.maybe_number("scale").value_or(1);
  if (!(request.scale >= 0.05 && request.scale <= 1)) message.fail("scale", "0.05 to 1");
  request.crops_to_change = message.has("crop");
  if (request.crops_to_change && message.value("crop") != "change")
    message.fail("crop", "\"change\" or null");
}

NearMiss near_miss_in(const JsonObject& message) {
  NearMiss wanted;
  wanted.intruder = static_cast<std::size_t>(message.whole("intruder", 0, kMostTables));
  wanted.frame = message.whole("frame", 0, kMostFrames);
  wanted.miss_m = message.number("miss_m");
  if (!(wanted.miss_m >= 0 && wanted.miss_m <= scene::kMiss.high))
    message.fail("miss_m", "metres from 0 to 1e5");
  wanted.is_right = message.truth("right");
  wanted.speed_mps = message.number("speed_mps");
  if (!(wanted.speed_mps >= scene::kSpeed.low && wanted.speed_mps <= scene::kSpeed.high))
    message.fail("speed_mps", std::string(scene::kSpeed.expected));
  wanted.above_m = message.maybe_number("above_m");
  if (wanted.above_m && !(std::abs(*wanted.above_m) <= scene::kMiss.high))
    message.fail("above_m", std::string(scene::kMiss.expected));
  return wanted;
}

std::vector<std::string> keys_of(Act act) {
  switch (act) {
    case Act::kEdit:
      return {"id", "do", "changes", "merge", "upon"};
    case Act::kFrame:
      return {"id", "do", "frame", "aircraft", "crop", "scale"};
    case Act::kNearMiss:
      return {"id", "do", "intruder", "frame", "miss_m", "right", "speed_mps", "above_m"};
    case Act::kAircraft:
      return {"id", "do", "search"};
    default:
      return {"id", "do"};
  }
}

constexpr std::size_t kMostTargetBytes = 2048;

std::optional<std::string> unescaped(std::string_view text) {
  std::string with_blanks(text);
  std::ranges::replace(with_blanks, '+', ' ');
  return percent_decoded(with_blanks);
}

}  // namespace

std::optional<std::int64_t> id_of(std::string_view text) {
  if (text.size() > kMostRequestBytes) return std::nullopt;
  const Json json = parse_json(text);
  if (!json.is_object() || !json.contains("id") || !json["id"].is_number_integer())
    return std::nullopt;
  return json["id"].get<std::int64_t>();
}

Request request_from(std::string_view text) {
  const Json json = parsed(text);
  const JsonObject message(json, {});
  Request request;
  request.id = message.whole("id");
  const std::string what = message.text("do");
  const auto act = enum_named<Act>(what);
  if (!act) message.fail("do", fmt::format("one of {}", fmt::join(all_enum_names<Act>(), ", ")));
  request.act = *act;
  message.expect_keys_among(keys_of(*act));
  if (*act == Act::kEdit) {
    request.changes = changes_in(json);
    request.merge = word(message, "merge");
    request.upon = word(message, "upon");
  }
  if (*act == Act::kFrame) take_frame(request, message);
  if (*act == Act::kNearMiss) request.near_miss = near_miss_in(message);
  if (*act == Act::kAircraft) request.search = word(message, "search");
  return request;
}

std::string Target::value(const std::string& key) const {
  const auto found = query.find(key);
  return found == query.end() ? "" : found->second;
}

std::optional<std::int64_t> Target::whole(const std::string& key,
                                          std::int64_t least,
                                          std::int64_t most) const {
  const auto number = number_from_text<std::int64_t>(value(key));
  return number && *number >= least && *number <= most ? number : std::nullopt;
}

std::optional<Target> target_from(std::string_view text) {
  if (text.empty() || text.size() > kMostTargetBytes || text[0] != '/') return std::nullopt;
  const std::size_t mark = std::min(text.find('?'), text.size());
  Target target{std::string(text.substr(0, mark)), {}};
  for (std::size_t begin = mark + 1; begin < text.size();) {
    const std::size_t end = std::min(text.find('&', begin), text.size());
    const std::size_t equals = std::min(text.find('=', begin), end);
    const auto key = unescaped(text.substr(begin, equals - begin));
    const std::size_t value_begin = std::min(equals + 1, end);
    const auto value = unescaped(text.substr(value_begin, end - value_begin));
    if (!key || !value) return std::nullopt;
    target.query[*key] = *value;
    begin = end + 1;
  }
  return target;
}

std::optional<ByteRange> range_from(std::string_view header,
                                    std::uint64_t size,
                                    std::uint64_t most) {
  constexpr std::string_view kUnit = "bytes=";
  if (!header.starts_with(kUnit) || size == 0) return std::nullopt;
  const std::size_t dash = header.find('-');
  if (dash == std::string_view::npos) return std::nullopt;
  const auto first =
      number_from_text<std::uint64_t>(header.substr(kUnit.size(), dash - kUnit.size()));
  const auto last = number_from_text<std::uint64_t>(header.substr(dash + 1));
  if (!first && dash > kUnit.size()) return std::nullopt;
  if (!last && dash + 1 < header.size()) return std::nullopt;
  if (!first && !last) return std::nullopt;
  ByteRange range;
  // "-500": the last 500.
  range.first = first ? *first : size - std::min(size, *last);
  range.last = std::min(first && last ? *last : size - 1, size - 1);
  if (range.first > range.last) return std::nullopt;
  range.last = std::min(range.last, range.first + most - 1);
  return range;
}

}  // namespace airtruth::messages
