// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "foundation/base/error.h"

// The fields of a model file as text: a line "# name", followed by lines of data.
namespace airtruth::encounter_model {

struct FieldLine {
  std::string_view text;
  int line = 0;
};

class ModelFields {
 public:
  // Throws Error where text precedes the first field, or a field is unknown or twice there. The
  // text must outlive the object.
  ModelFields(std::string_view text, const std::filesystem::path& file);

  // The place of a field; its first line of data where there is one.
  Where where(const std::string& name) const;
  // The labels of the field's line without quotes; throws where one is empty or twice there.
  std::vector<std::string> labels(const std::string& name) const;
  // All numbers of the field, line by line. Throws where a word is not a finite number from `low`
  // to `high`, or where the field does not hold `count` numbers.
  std::vector<double> numbers(const std::string& name,
                              std::size_t count,
                              double low,
                              double high) const;
  // The lines of the field, of which there must be `count`.
  const std::vector<FieldLine>& lines(const std::string& name, std::size_t count) const;
  // The finite numbers of one line.
  std::vector<double> numbers_of(const FieldLine& line, const std::string& name) const;

 private:
  const std::vector<FieldLine>& lines_of(const std::string& name) const;

  std::string file_;
  struct Field {
    int line = 0;
    std::vector<FieldLine> lines;
  };
  std::map<std::string, Field> fields_;
};

}  // namespace airtruth::encounter_model
