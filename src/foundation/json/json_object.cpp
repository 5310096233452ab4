// SPDX-License-Identifier: Apache-2.0
#include "foundation/json/json_object.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "foundation/base/files.h"
#include "foundation/base/names.h"
#include "foundation/base/text.h"
#include "foundation/json/parse_json.h"

namespace airtruth {
namespace {

using Json = nlohmann::ordered_json;

// The largest number of a signed integer of 64 bits.
constexpr auto kLargestInteger =
    static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
// A message repeats at most this many bytes of a value. Chosen: it keeps a message on one line.
constexpr std::size_t kMaxShownBytes = 40;

// A list or an object is not written out. Writing is recursive, and the file sets the depth, so a
// hostile file could exhaust the stack.
std::string shown(const Json& value) {
  if (value.is_array()) return "a list";
  if (value.is_object()) return "an object";
  if (!value.is_string()) return value.dump();
  const std::string start = value.get_ref<const std::string&>().substr(0, kMaxShownBytes);
  return Json(start).dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string element(const std::string& key, std::size_t index) {
  return fmt::format("{}[{}]", key, index);
}

std::string whole_number(std::int64_t least, std::int64_t most) {
  return fmt::format("a whole number from {} to {}", least, most);
}

std::shared_ptr<const Json> parsed(std::string_view text, const Where& where) {
  if (is_nested_too_deep(text))
    throw Error(fmt::format("is nested deeper than {} levels", kMostNesting), where);
  try {
    return std::make_shared<const Json>(Json::parse(text));
  } catch (const Json::parse_error& error) {
    const auto offset = static_cast<std::ptrdiff_t>(std::min(error.byte, text.size()));
    throw Error("is not JSON", {where.file, std::max(where.line, 1) - 1 + line_of(text, offset)});
  } catch (const Json::exception&) {
    throw Error("holds a number that is too large for 64 bits", where);
  }
}

}  // namespace

JsonObject::JsonObject(const Json& json, Where where, std::string place)
    : json_(&json), where_(std::move(where)), place_(std::move(place)) {
  if (json.is_object()) return;
  throw Error((place_.empty() ? "" : place_ + " ") + "is " + shown(json) + "; expected an object",
              where_);
}

bool JsonObject::has(const std::string& key) const {
  const auto found = json_->find(key);
  return found != json_->end() && !found->is_null();
}

bool JsonObject::is_empty(const std::string& key) const { return value(key).empty(); }

const Json& JsonObject::value(const std::string& key) const { return required(key, ""); }

const Json& JsonObject::required(const std::string& key, const std::string& expected) const {
  const auto found = json_->find(key);
  if (found != json_->end()) return *found;
  throw Error((place_.empty() ? "" : place_ + " ") + "has no " + key +
                  (expected.empty() ? "" : "; expected " + expected),
              where_);
}

const Json& JsonObject::list(const std::string& key, const std::string& expected) const {
  const Json& found = required(key, expected);
  if (!found.is_array()) fail(found, key, expected);
  return found;
}

std::string JsonObject::path_of(const std::string& key) const {
  return place_.empty() ? key : place_ + "." + key;
}

Where JsonObject::where_of(const std::string& key) const {
  Where where = where_;
  const std::size_t offset = text_.find('"' + key.substr(0, key.find('[')) + '"');
  if (offset != std::string_view::npos)
    where.line = line_of(text_, static_cast<std::ptrdiff_t>(offset));
  return where;
}

void JsonObject::fail(const std::string& what) const {
  throw Error((place_.empty() ? "" : place_ + ": ") + what, where_);
}

void JsonObject::fail(const Json& value,
                      const std::string& key,
                      const std::string& expected) const {
  throw Error(fmt::format("{} is {}; expected {}", path_of(key), shown(value), expected),
              where_of(key));
}

void JsonObject::fail(const std::string& key, const std::string& expected) const {
  fail(value(key), key, expected);
}

std::string JsonObject::text(const std::string& key) const {
  const Json& found = required(key, "a string");
  if (!found.is_string()) fail(found, key, "a string");
  return found.get<std::string>();
}

std::optional<std::string> JsonObject::maybe_text(const std::string& key) const {
  return has(key) ? std::optional(text(key)) : std::nullopt;
}

bool JsonObject::truth(const std::string& key) const {
  const Json& found = required(key, "true or false");
  if (found.is_boolean()) return found.get<bool>();
  if (!found.is_number()) fail(found, key, "true or false");
  return found.get<double>() != 0;
}

std::optional<bool> JsonObject::maybe_truth(const std::string& key) const {
  return has(key) ? std::optional(truth(key)) : std::nullopt;
}

double JsonObject::number(const Json& value, const std::string& key) const {
  if (!value.is_number()) fail(value, key, "a number");
  return value.get<double>();
}

double JsonObject::number(const std::string& key) const {
  return number(required(key, "a number"), key);
}

std::optional<double> JsonObject::maybe_number(const std::string& key) const {
  return has(key) ? std::optional(number(key)) : std::nullopt;
}

// The range is checked before the cast: get<std::int64_t>() of a larger number is another number.
std::int64_t JsonObject::whole(const Json& value,
                               const std::string& key,
                               std::int64_t least,
                               std::int64_t most) const {
  const double number = value.is_number() ? value.get<double>() : NAN;
  if (!(number >= static_cast<double>(least) && number <= static_cast<double>(most)) ||
      number != std::floor(number))
    fail(value, key, whole_number(least, most));
  return static_cast<std::int64_t>(number);
}

std::int64_t JsonObject::whole(const std::string& key,
                               std::int64_t least,
                               std::int64_t most) const {
  const bool is_any = least == -kLargestWhole && most == kLargestWhole;
  const std::string expected = is_any ? "a whole number" : whole_number(least, most);
  return whole(required(key, expected), key, least, most);
}

std::optional<std::int64_t> JsonObject::maybe_integer(const std::string& key) const {
  if (!has(key)) return std::nullopt;
  const Json& found = value(key);
  const bool too_large = found.is_number_unsigned() && found.get<std::uint64_t>() > kLargestInteger;
  if (found.is_number_integer() && !too_large) return found.get<std::int64_t>();
  const double rounded = std::round(number(found, key));
  if (!(std::abs(rounded) < 9e18)) fail(found, key, "a whole number of 64 bits");
  return static_cast<std::int64_t>(rounded);
}

std::vector<double> JsonObject::numbers(const std::string& key) const {
  std::vector<double> result;
  for (const Json& value : list(key, "a list of numbers"))
    result.push_back(number(value, element(key, result.size())));
  return result;
}

std::vector<double> JsonObject::numbers(const std::string& key, std::size_t size) const {
  std::vector<double> result = numbers(key);
  if (result.size() != size) fail(key, fmt::format("a list of {} numbers", size));
  return result;
}

std::vector<std::int64_t> JsonObject::wholes(const std::string& key,
                                             std::size_t size,
                                             std::int64_t least,
                                             std::int64_t most) const {
  const std::string expected = fmt::format("a list of {} whole numbers", size);
  const Json& values = list(key, expected);
  if (values.size() != size) fail(values, key, expected);
  std::vector<std::int64_t> result;
  for (const Json& value : values)
    result.push_back(whole(value, element(key, result.size()), least, most));
  return result;
}

std::vector<double> JsonObject::matrix(const std::string& key,
                                       std::size_t rows,
                                       std::size_t columns) const {
  const std::string expected = fmt::format("{} lists of {} numbers", rows, columns);
  const Json& values = list(key, expected);
  if (values.size() != rows) fail(values, key, expected);
  std::vector<double> result;
  for (std::size_t i = 0; i < rows; ++i) {
    if (!values[i].is_array() || values[i].size() != columns) fail(values, key, expected);
    for (const Json& value : values[i]) result.push_back(number(value, element(key, i)));
  }
  return result;
}

std::vector<std::vector<double>> JsonObject::lists_of_numbers(const std::string& key) const {
  std::vector<std::vector<double>> lists;
  if (!has(key) || !value(key).is_array()) return lists;
  for (const Json& list : value(key)) {
    if (!list.is_array()) return {};
    lists.emplace_back();
    for (const Json& value : list)
      if (value.is_number()) lists.back().push_back(value.get<double>());
  }
  return lists;
}

std::vector<std::string> JsonObject::texts(const std::string& key) const {
  std::vector<std::string> result;
  for (const Json& value : list(key, "a list of strings")) {
    if (!value.is_string()) fail(value, element(key, result.size()), "a string");
    result.push_back(value.get<std::string>());
  }
  return result;
}

JsonObject JsonObject::object(const std::string& key) const {
  JsonObject result(
      required(key, "an object"), text_.empty() ? where_ : where_of(key), path_of(key));
  result.text_ = text_;
  return result;
}

std::vector<JsonObject> JsonObject::objects(const std::string& key) const {
  std::vector<JsonObject> result;
  for (const Json& value : list(key, "a list"))
    result.emplace_back(value, where_, path_of(element(key, result.size())));
  return result;
}

void JsonObject::expect_keys_among(const std::vector<std::string>& known) const {
  for (const std::string& key : keys()) {
    if (std::ranges::find(known, key) != known.end()) continue;
    const auto near = nearest_spelling(key.substr(0, kMaxShownBytes), known);
    throw Error(fmt::format("{}unknown key {}; {}",
                            place_.empty() ? "" : place_ + ": ",
                            shown(Json(key)),
                            near ? fmt::format("did you mean \"{}\"?", *near)
                                 : fmt::format("expected one of {}", fmt::join(known, ", "))),
                where_of(key));
  }
}

std::vector<std::string> JsonObject::keys() const {
  std::vector<std::string> keys;
  for (const auto& [key, value] : json_->items()) keys.push_back(key);
  return keys;
}

JsonObject JsonObject::with_lines_of(std::string_view text) const {
  JsonObject result = *this;
  result.text_ = text;
  return result;
}

JsonDocument::JsonDocument(const std::filesystem::path& file, std::size_t most_bytes)
    : JsonDocument(read_file(file, most_bytes), Where{file.string()}) {}

JsonDocument::JsonDocument(std::string_view text, const Where& where)
    : JsonDocument(parsed(text, where), where) {}

JsonDocument::JsonDocument(std::shared_ptr<const Json> json, const Where& where)
    : JsonObject(*json, where), whole_(std::move(json)) {}

}  // namespace airtruth
