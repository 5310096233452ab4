// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

// Reads JSON from users' files. Every fault is one Error that names the file and the place in it
// ("annotations[12]: has no image_id"). The words that Python's json adds to JSON, NaN and Infinity
// in any case and with a sign, are read as null.
namespace airtruth::exchange {

class JsonObject {
 public:
  JsonObject(const nlohmann::ordered_json& json, std::string file, std::string place);

  // True where the key exists and is not null.
  bool has(const char* key) const;
  std::string text(const char* key) const;
  double number(const char* key) const;
  std::int64_t whole(const char* key) const;
  std::optional<double> maybe_number(const char* key) const;
  // An exact integer: a double would round times in nanoseconds since 1970. A number with a
  // fraction is rounded.
  std::optional<std::int64_t> maybe_integer(const char* key) const;
  // Accepts true, false, 0 and 1.
  std::optional<bool> maybe_truth(const char* key) const;
  std::vector<double> numbers(const char* key) const;
  // Empty where the key is missing or has any other type, for example COCO's run lengths.
  std::vector<std::vector<double>> lists_of_numbers(const char* key) const;
  JsonObject object(const char* key) const;
  std::vector<JsonObject> objects(const char* key) const;
  std::vector<std::string> keys() const;

  const std::string& place() const { return place_; }
  [[noreturn]] void fail(const std::string& what) const;

 private:
  const nlohmann::ordered_json& at(const char* key) const;

  const nlohmann::ordered_json* json_;
  std::string file_;
  std::string place_;
};

// A whole file whose top element is an object.
class JsonFile : public JsonObject {
 public:
  explicit JsonFile(const std::filesystem::path& file);

 private:
  JsonFile(std::shared_ptr<const nlohmann::ordered_json> json, const std::filesystem::path& file);
  std::shared_ptr<const nlohmann::ordered_json> whole_;
};

}  // namespace airtruth::exchange
