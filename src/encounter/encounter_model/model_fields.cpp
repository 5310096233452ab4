// SPDX-License-Identifier: Apache-2.0
#include "encounter/encounter_model/model_fields.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "foundation/base/names.h"
#include "foundation/base/text.h"

namespace airtruth::encounter_model {
namespace {

const std::vector<std::string> kFields = words_in(
    "labels_initial G_initial r_initial N_initial labels_transition G_transition r_transition "
    "N_transition boundaries resample_rates");
constexpr std::string_view kBlanks = " \t\r";

// Takes the first word of `rest` away from it; empty where there is none.
std::string_view next_word(std::string_view& rest) {
  const std::size_t first = rest.find_first_not_of(kBlanks);
  if (first == rest.npos) return rest = {};
  const std::size_t end = std::min(rest.find_first_of(kBlanks, first), rest.size());
  const std::string_view word = rest.substr(first, end - first);
  rest.remove_prefix(end);
  return word;
}

double number_of(std::string_view word, const std::string& name, const Where& where) {
  const auto value = number_from_text<double>(word);
  if (!value || !std::isfinite(*value))
    throw Error(fmt::format("{} holds '{}'; expected finite numbers", name, word.substr(0, 40)),
                where);
  return *value;
}

}  // namespace

ModelFields::ModelFields(std::string_view text, const std::filesystem::path& file)
    : file_(file.string()) {
  Field* field = nullptr;
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t end = text.find('\n');
    const std::string_view line = trimmed(text.substr(0, end));
    text = end == text.npos ? std::string_view() : text.substr(end + 1);
    if (line.empty()) continue;
    if (line.front() != '#') {
      if (field == nullptr)
        throw Error(
            fmt::format("begins with '{}'; expected '# labels_initial'", line.substr(0, 40)),
            {file_, number});
      field->lines.push_back({line, number});
      continue;
    }
    const std::string name(trimmed(line.substr(1)));
    if (std::find(kFields.begin(), kFields.end(), name) == kFields.end())
      throw Error(
          fmt::format(
              "unknown field '{}'{}",
              name.substr(0, 40),
              did_you_mean(name, kFields, fmt::format("; expected {}", fmt::join(kFields, ", ")))),
          {file_, number});
    if (fields_.contains(name))
      throw Error(
          fmt::format("field {} is twice there; first in line {}", name, fields_[name].line),
          {file_, number});
    field = &fields_[name];
    field->line = number;
  }
}

const std::vector<FieldLine>& ModelFields::lines_of(const std::string& name) const {
  const auto found = fields_.find(name);
  if (found == fields_.end())
    throw Error(fmt::format("has no field '# {}'; expected it in every model", name), {file_});
  return found->second.lines;
}

Where ModelFields::where(const std::string& name) const {
  const auto& lines = lines_of(name);
  return {file_, lines.empty() ? fields_.at(name).line : lines.front().line};
}

const std::vector<FieldLine>& ModelFields::lines(const std::string& name, std::size_t count) const {
  const auto& lines = lines_of(name);
  if (lines.size() != count)
    throw Error(fmt::format("{} has {} lines; expected {}", name, lines.size(), count),
                {file_, lines.empty() ? fields_.at(name).line : lines.back().line});
  return lines;
}

std::vector<std::string> ModelFields::labels(const std::string& name) const {
  const FieldLine& line = lines(name, 1).front();
  std::vector<std::string> labels;
  std::string_view rest = line.text;
  for (bool more = true; more;) {
    const std::size_t comma = rest.find(',');
    std::string_view label = trimmed(rest.substr(0, comma));
    if (label.size() >= 2 && label.front() == '"' && label.back() == '"')
      label = trimmed(label.substr(1, label.size() - 2));
    if (label.empty())
      throw Error(
          fmt::format("{} holds an empty label; expected quoted names with commas between", name),
          {file_, line.line});
    if (std::find(labels.begin(), labels.end(), label) != labels.end())
      throw Error(
          fmt::format("{} holds '{}' twice; expected different names", name, label.substr(0, 40)),
          {file_, line.line});
    labels.emplace_back(label);
    more = comma != rest.npos;
    if (more) rest.remove_prefix(comma + 1);
  }
  return labels;
}

std::vector<double> ModelFields::numbers_of(const FieldLine& line, const std::string& name) const {
  std::vector<double> numbers;
  std::string_view rest = line.text;
  for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest))
    numbers.push_back(number_of(word, name, {file_, line.line}));
  return numbers;
}

std::vector<double> ModelFields::numbers(const std::string& name,
                                         std::size_t count,
                                         double low,
                                         double high) const {
  std::vector<double> numbers;
  Where place = {file_, where(name).line};
  for (const FieldLine& line : lines_of(name)) {
    place.line = line.line;
    std::string_view rest = line.text;
    for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest)) {
      const double value = number_of(word, name, place);
      if (value < low || value > high)
        throw Error(
            fmt::format("{} holds {}; expected numbers from {} to {}", name, word, low, high),
            place);
      if (numbers.size() == count)
        throw Error(fmt::format("{} holds more than {} numbers; expected {}", name, count, count),
                    place);
      numbers.push_back(value);
    }
  }
  if (numbers.size() != count)
    throw Error(fmt::format("{} holds {} numbers; expected {}", name, numbers.size(), count),
                place);
  return numbers;
}

}  // namespace airtruth::encounter_model
