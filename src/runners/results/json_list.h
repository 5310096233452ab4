// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

// JSON texts that are too large to be a tree of values as a whole: lists and objects whose parts
// are found by their brackets alone. Each part is parsed by itself, and a fault has its line.
namespace airtruth::results {

// One value, with the line at which it begins.
struct JsonPart {
  std::string_view text;
  int line = 1;
};

// The elements of a list.
class JsonElements {
 public:
  // `whole` begins with '['. `what` is what it holds, for messages: "detections". The file's name
  // and the text must outlive the object.
  JsonElements(const JsonPart& whole, const std::filesystem::path& file, std::string what);
  // Empty after the last one. Throws Error for a list that does not end, or goes on after its end.
  std::optional<JsonPart> next();

 private:
  [[noreturn]] void fail(const std::string& fault) const;

  std::string_view text_;
  const std::filesystem::path& file_;
  std::string what_;
  std::size_t at_ = 0;
  int line_ = 1;
  bool is_first_ = true;
};

// The members of an object with these keys, in the order of `keys`; empty where the object has no
// such key. Throws Error for a text that is no object, and for a key that is there twice.
std::vector<std::optional<JsonPart>> json_members(std::string_view text,
                                                  const std::filesystem::path& file,
                                                  const std::vector<std::string>& keys);

}  // namespace airtruth::results
