// SPDX-License-Identifier: Apache-2.0
#include "labels/exchange/python_json.h"

#include <cctype>
#include <string>

#include <nlohmann/json.hpp>

#include "foundation/base/files.h"
#include "foundation/json/or_null.h"
#include "labels/annotation/object_class.h"
#include "labels/exchange/exchange.h"

namespace airtruth::exchange {
namespace {

constexpr std::size_t kLargestFile_bytes = std::size_t{8} << 30;

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

}  // namespace

JsonDocument python_json(const std::filesystem::path& file) {
  return {without_python_words(read_file(file, kLargestFile_bytes)), Where{file.string()}};
}

namespace {

void get(const JsonObject& json, const char* key, std::optional<double>& value) {
  value = json.maybe_number(key);
}
void get(const JsonObject& json, const char* key, std::optional<bool>& value) {
  value = json.maybe_truth(key);
}

}  // namespace

void get_known(const JsonObject& json, Label& label, const char* visible_key) {
  each_known(label, visible_key, [&](const char* key, auto& value) { get(json, key, value); });
}

nlohmann::ordered_json json_of_label(const Label& label) {
  const Box& b = label.box_px;
  nlohmann::ordered_json json = {{"track", label.track},
                                 {"category", label.category},
                                 {"box_px", {b.x, b.y, b.width, b.height}}};
  if (!annotation::is_aircraft(label.object_class)) json["class"] = label.object_class;
  each_known(
      label, "visible", [&](const char* key, const auto& value) { json[key] = or_null(value); });
  json["area_px"] = or_null(label.area_px);
  return json;
}

Label label_of_json(const JsonObject& json) {
  Label label;
  label.track = json.whole("track");
  label.category = json.text("category");
  const auto box = json.numbers("box_px", 4);
  label.box_px = {box[0], box[1], box[2], box[3]};
  label.object_class = json.maybe_text("class").value_or(label.object_class);
  if (!annotation::is_object_class(label.object_class) && label.object_class != kIgnore)
    json.fail("class", "aircraft, bird, multirotor, balloon, glint, dirt, insect or ignore");
  get_known(json, label, "visible");
  label.area_px = json.maybe_number("area_px");
  return label;
}

}  // namespace airtruth::exchange
