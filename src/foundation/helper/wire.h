// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>

#include "foundation/base/error.h"

// Numbers and texts as bytes, for the socket between the program and a helper. Both ends are the
// same build on the same machine, so numbers keep their form in memory. The receiver checks all
// that it reads, because a hostile file may have taken over the sender.
namespace airtruth::helper {

// Appends plain numbers and strings to a byte string. A string is preceded by its length.
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

// Reads them back. Throws Error where the bytes end early or a count exceeds its stated limit.
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
  // A count of at most `most` items, each of which takes `bytes_each` of the remaining bytes.
  std::size_t get_count(std::size_t most, std::size_t bytes_each);
  void get_raw(void* data, std::size_t size);
  void expect_end() const;
  std::string_view rest() const { return bytes_; }

 private:
  std::string_view bytes_;
};

std::string bytes_of(const Error& error);
Error error_from_bytes(std::string_view bytes);

}  // namespace airtruth::helper
