// SPDX-License-Identifier: Apache-2.0
#include "exchange/json_file.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>

#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/files.h"

namespace airtruth::exchange {
namespace {

using Json = nlohmann::ordered_json;

constexpr auto kLargestInteger =
    static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }

// Outside of strings NaN, Infinity and -Infinity become null.
std::string without_python_words(const std::string& text) {
  std::string result;
  result.reserve(text.size());
  for (std::size_t i = 0; i < text.size();) {
    if (text[i] == '"') {
      std::size_t end = i + 1;
      while (end < text.size() && text[end] != '"') end += text[end] == '\\' ? 2 : 1;
      end = std::min(end + 1, text.size());
      result.append(text, i, end - i);
      i = end;
      continue;
    }
    const std::size_t word = i + (text[i] == '-' || text[i] == '+' ? 1 : 0);
    std::size_t end = word;
    std::string lower;
    while (end < text.size() && is_letter(text[end]) && lower.size() < 9)
      lower += static_cast<char>(std::tolower(static_cast<unsigned char>(text[end++])));
    if (lower == "nan" || lower == "inf" || lower == "infinity") {
      result += "null";
      i = end;
    } else {
      end = std::max(end, i + 1);
      result.append(text, i, end - i);
      i = end;
    }
  }
  return result;
}

std::shared_ptr<const Json> parsed(const std::filesystem::path& file) {
  const std::string text = without_python_words(read_file(file, std::size_t{8} << 30));
  try {
    return std::make_shared<const Json>(Json::parse(text));
  } catch (const Json::parse_error& error) {
    const auto end = static_cast<std::ptrdiff_t>(std::min(error.byte, text.size()));
    const auto line = std::count(text.begin(), text.begin() + end, '\n') + 1;
    throw Error("is not JSON", {file.string(), static_cast<int>(line)});
  }
}

}  // namespace

JsonObject::JsonObject(const Json& json, std::string file, std::string place)
    : json_(&json), file_(std::move(file)), place_(std::move(place)) {
  if (!json.is_object()) fail("is no object");
}

void JsonObject::fail(const std::string& what) const {
  throw Error((place_.empty() ? "" : place_ + ": ") + what, {file_});
}

const Json& JsonObject::at(const char* key) const {
  const auto found = json_->find(key);
  if (found == json_->end()) fail(std::string("has no ") + key);
  return *found;
}

bool JsonObject::has(const char* key) const {
  const auto found = json_->find(key);
  return found != json_->end() && !found->is_null();
}

std::string JsonObject::text(const char* key) const {
  const Json& value = at(key);
  if (!value.is_string()) fail(std::string(key) + " is not a string");
  return value.get<std::string>();
}

double JsonObject::number(const char* key) const {
  const Json& value = at(key);
  if (!value.is_number()) fail(std::string(key) + " is not a number");
  return value.get<double>();
}

std::int64_t JsonObject::whole(const char* key) const {
  const double value = number(key);
  if (value != std::floor(value) || std::abs(value) > 9e15)
    fail(std::string(key) + " is not a whole number");
  return static_cast<std::int64_t>(value);
}

std::optional<double> JsonObject::maybe_number(const char* key) const {
  if (!has(key)) return std::nullopt;
  return number(key);
}

std::optional<std::int64_t> JsonObject::maybe_integer(const char* key) const {
  if (!has(key)) return std::nullopt;
  const Json& value = at(key);
  if (value.is_number_unsigned() && value.get<std::uint64_t>() > kLargestInteger)
    fail(std::string(key) + " is too large");
  if (value.is_number_integer()) return value.get<std::int64_t>();
  const double rounded = std::round(number(key));
  if (!(std::abs(rounded) < 9e18)) fail(std::string(key) + " is too large");
  return static_cast<std::int64_t>(rounded);
}

std::optional<bool> JsonObject::maybe_truth(const char* key) const {
  if (!has(key)) return std::nullopt;
  const Json& value = at(key);
  if (value.is_boolean()) return value.get<bool>();
  return number(key) != 0;
}

std::vector<double> JsonObject::numbers(const char* key) const {
  const Json& list = at(key);
  if (!list.is_array()) fail(std::string(key) + " is not a list of numbers");
  std::vector<double> numbers;
  for (const Json& value : list) {
    if (!value.is_number()) fail(std::string(key) + " is not a list of numbers");
    numbers.push_back(value.get<double>());
  }
  return numbers;
}

std::vector<std::vector<double>> JsonObject::lists_of_numbers(const char* key) const {
  std::vector<std::vector<double>> lists;
  if (!has(key) || !at(key).is_array()) return lists;
  for (const Json& list : at(key)) {
    if (!list.is_array()) return {};
    lists.emplace_back();
    for (const Json& value : list)
      if (value.is_number()) lists.back().push_back(value.get<double>());
  }
  return lists;
}

JsonObject JsonObject::object(const char* key) const {
  return {at(key), file_, place_.empty() ? key : place_ + "." + key};
}

std::vector<JsonObject> JsonObject::objects(const char* key) const {
  const Json& list = at(key);
  if (!list.is_array()) fail(std::string(key) + " is not a list");
  const std::string base = (place_.empty() ? "" : place_ + ".") + key;
  std::vector<JsonObject> objects;
  for (const Json& value : list)
    objects.emplace_back(value, file_, base + "[" + std::to_string(objects.size()) + "]");
  return objects;
}

std::vector<std::string> JsonObject::keys() const {
  std::vector<std::string> keys;
  for (const auto& [key, value] : json_->items()) keys.push_back(key);
  return keys;
}

JsonFile::JsonFile(const std::filesystem::path& file) : JsonFile(parsed(file), file) {}

JsonFile::JsonFile(std::shared_ptr<const Json> json, const std::filesystem::path& file)
    : JsonObject(*json, file.string(), ""), whole_(std::move(json)) {}

}  // namespace airtruth::exchange
