// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

#include "aircraft/model/raw_model.h"
#include "foundation/base/error.h"

// A RawModel as bytes: between the program and its reader, and in the cache. Both ends are the same
// build on the same machine, so numbers stand as they are in memory; what comes in is checked.
namespace airtruth::aircraft {

// Puts plain numbers and strings one after another.
class WireWriter {
 public:
  template <typename Value>
  void put(const Value& value) {
    static_assert(std::is_arithmetic_v<Value>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(value));
  }
  void put_text(std::string_view text) {
    put(static_cast<std::uint64_t>(text.size()));
    bytes_.append(text);
  }
  void put_raw(const void* data, std::size_t size) {
    bytes_.append(static_cast<const char*>(data), size);
  }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

// Takes them out again. Throws Error where the bytes end early or a count is larger than stated.
class WireReader {
 public:
  explicit WireReader(std::string_view bytes) : bytes_(bytes) {}
  template <typename Value>
  Value get() {
    static_assert(std::is_arithmetic_v<Value> && !std::is_same_v<Value, bool>);
    Value value;
    get_raw(&value, sizeof(value));
    return value;
  }
  std::string get_text(std::size_t most);
  // A count of things that take `bytes_each`, of which there are `most` at most.
  std::size_t get_count(std::size_t most, std::size_t bytes_each);
  void get_raw(void* data, std::size_t size);
  void expect_end() const;
  std::string_view rest() const { return bytes_; }

 private:
  std::string_view bytes_;
};

std::string bytes_of(const RawModel& model);

// Throws Error for bytes that are not exactly those of a model that holds check_model.
RawModel model_from_bytes(std::string_view bytes);

}  // namespace airtruth::aircraft
