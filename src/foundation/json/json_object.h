// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "foundation/base/error.h"

// Reads JSON that users or other programs wrote. Each fault is one Error, which states the file,
// the line where it is known, the key with its path from the top, the value, and what was expected.
//
// Example: a.json holds {"images": [{"width": "x"}]}. Then
//   JsonDocument(path).objects("images")[0].whole("width", 1, 65536)
// throws an Error with the text
//   a.json: images[0].width is "x"; expected a whole number from 1 to 65536
namespace airtruth {

// The largest whole number up to which a double holds every whole number exactly.
inline constexpr std::int64_t kLargestWhole = std::int64_t{1} << 53;

class JsonObject {
 public:
  // `json` must outlive the object. `place` is the path from the top of the text, "" at the top.
  // Throws Error where `json` is not an object.
  JsonObject(const nlohmann::ordered_json& json, Where where, std::string place = "");

  // True where the key exists and its value is not null.
  bool has(const std::string& key) const;

  // True for a list, an object or a null with nothing in it.
  bool is_empty(const std::string& key) const;

  // The functions below throw Error where the key is missing or its value is not as described.
  // Those whose names begin with maybe_ return nothing where has() is false.
  std::string text(const std::string& key) const;
  std::optional<std::string> maybe_text(const std::string& key) const;
  // Accepts true, false and numbers: 0 means false.
  bool truth(const std::string& key) const;
  std::optional<bool> maybe_truth(const std::string& key) const;
  // A finite number.
  double number(const std::string& key) const;
  std::optional<double> maybe_number(const std::string& key) const;
  // A number without a fraction, from `least` to `most`. Both lie within 2^53.
  std::int64_t whole(const std::string& key,
                     std::int64_t least = -kLargestWhole,
                     std::int64_t most = kLargestWhole) const;
  // A number of things: a whole number from 0 to 2^53.
  std::int64_t count(const std::string& key) const { return whole(key, 0); }
  // Any number of 64 bits, exact where it has no fraction (a time in nanoseconds since 1970 is
  // beyond 2^53). A number with a fraction is rounded.
  std::optional<std::int64_t> maybe_integer(const std::string& key) const;

  std::vector<double> numbers(const std::string& key) const;
  // A list of exactly `size` numbers.
  std::vector<double> numbers(const std::string& key, std::size_t size) const;
  // A list of exactly `size` whole numbers, each from `least` to `most`.
  std::vector<std::int64_t> wholes(const std::string& key,
                                   std::size_t size,
                                   std::int64_t least,
                                   std::int64_t most) const;
  // A list of `rows` lists of `columns` numbers each, row after row.
  std::vector<double> matrix(const std::string& key, std::size_t rows, std::size_t columns) const;
  // Empty where the key is missing or is no list of lists (COCO's run lengths). Skips what is not a
  // number within a list.
  std::vector<std::vector<double>> lists_of_numbers(const std::string& key) const;
  std::vector<std::string> texts(const std::string& key) const;

  JsonObject object(const std::string& key) const;
  std::vector<JsonObject> objects(const std::string& key) const;
  // In the order of the text.
  std::vector<std::string> keys() const;

  // Throws Error where a key is none of `known`; it names the nearest one, or all where none is
  // near.
  void expect_keys_among(const std::vector<std::string>& known) const;

  // The value as it is, for a copy or a comparison. Throws Error where the key is missing.
  const nlohmann::ordered_json& value(const std::string& key) const;

  // The same object; its errors, and those of the objects in it, state the line at which `text`
  // mentions the key first. For files in which a key has one meaning. `text` must outlive the
  // object.
  JsonObject with_lines_of(std::string_view text) const;

  // The path from the top: "" or, for example, "annotations[12]".
  const std::string& place() const { return place_; }

  // "annotations[12]: what"
  [[noreturn]] void fail(const std::string& what) const;
  // "annotations[12].key is VALUE; expected `expected`", with the value of the key.
  [[noreturn]] void fail(const std::string& key, const std::string& expected) const;

 private:
  // The value of a key that must be there; `expected` is for the message where it is not, or "".
  const nlohmann::ordered_json& required(const std::string& key, const std::string& expected) const;
  const nlohmann::ordered_json& list(const std::string& key, const std::string& expected) const;
  std::string path_of(const std::string& key) const;
  Where where_of(const std::string& key) const;
  double number(const nlohmann::ordered_json& value, const std::string& key) const;
  std::int64_t whole(const nlohmann::ordered_json& value,
                     const std::string& key,
                     std::int64_t least,
                     std::int64_t most) const;
  [[noreturn]] void fail(const nlohmann::ordered_json& value,
                         const std::string& key,
                         const std::string& expected) const;

  const nlohmann::ordered_json* json_;
  Where where_;
  std::string place_;
  std::string_view text_;
};

// A whole text whose top element is an object. Copies share the parsed text.
class JsonDocument : public JsonObject {
 public:
  // Throws Error for a file that cannot be read, is larger than `most_bytes`, or is not JSON.
  explicit JsonDocument(const std::filesystem::path& file,
                        std::size_t most_bytes = std::size_t{1} << 30);
  // One text. where.line is the line of the file at which the text begins; 0 and 1 mean its first.
  JsonDocument(std::string_view text, const Where& where);

 private:
  JsonDocument(std::shared_ptr<const nlohmann::ordered_json> json, const Where& where);
  std::shared_ptr<const nlohmann::ordered_json> whole_;
};

}  // namespace airtruth
