// SPDX-License-Identifier: Apache-2.0
#include "truth/exchange/json_file.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>

#include <nlohmann/json.hpp>

#include "foundation/base/error.h"
#include "foundation/base/files.h"

namespace airtruth::exchange {
namespace {

using Json = nlohmann::ordered_json;

constexpr auto kLargestInteger =
    static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());

// The letters from `at` on, in lower case. No word of the accepted JSON is longer than Infinity.
std::string word_at(const std::string& text, std::size_t at) {
  std::string word;
  while (at < text.size() && word.size() < 9 &&
         std::isalpha(static_cast<unsigned char>(text[at])) != 0)
    word += static_cast<char>(std::tolower(static_cast<unsigned char>(text[at++])));
  return word;
}

// Outside of strings NaN, Infinity and -Infinity are replaced by null.
std::string without_python_words(std::string text) {
  std::string result;
  std::size_t copied = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '"') {
      ++i;
      while (i < text.size() && text[i] != '"') i += text[i] == '\\' ? 2 : 1;
      continue;
    }
    if (text[i] != 'n' && text[i] != 'N' && text[i] != 'i' && text[i] != 'I') continue;
    const std::string word = word_at(text, i);
    if (word == "nan" || word == "inf" || word == "infinity") {
      const bool has_sign = i > copied && (text[i - 1] == '-' || text[i - 1] == '+');
      result.append(text, copied, i - copied - (has_sign ? 1 : 0)).append("null");
      copied = i + word.size();
    }
    i += word.size() - 1;
  }
  if (copied == 0) return text;
  return result.append(text, copied);
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
