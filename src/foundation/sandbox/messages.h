// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "foundation/base/error.h"

// Messages over the socket between the program and a child that reads untrusted files. A message
// has a kind, a length and bytes; each child program has an enumeration of its kinds. The bytes
// hold numbers and texts. Both ends are the same build on the same machine, so numbers keep their
// form in memory. The receiver checks all that it reads, because a hostile file may have taken over
// the sender.
namespace airtruth::sandbox {

// Either end of the socket.
class Channel {
 public:
  virtual ~Channel() = default;
  struct Received {
    std::uint8_t kind = 0;
    std::string bytes;
    bool closed = false;  // whether the other end has closed the connection

    template <typename Kind>
    Kind as() const {
      return static_cast<Kind>(kind);
    }
    template <typename Kind>
    bool is(Kind wanted) const {
      return as<Kind>() == wanted;
    }
  };
  // Throws Error for a message longer than `most`.
  Received receive(std::size_t most);
  // Returns false where the other end has closed the connection.
  template <typename Kind>
  bool send(Kind kind, std::string_view bytes) {
    return send_kind(static_cast<std::uint8_t>(kind), bytes);
  }

 protected:
  // Reads at least one byte. Returns 0 where the other end has closed the connection.
  virtual std::size_t read_some(char* data, std::size_t size) = 0;
  virtual std::size_t write_some(const char* data, std::size_t size) = 0;

 private:
  bool send_kind(std::uint8_t kind, std::string_view bytes);
  bool read_all(char* data, std::size_t size);
  bool write_all(const char* data, std::size_t size);
};

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

}  // namespace airtruth::sandbox
