// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

// Messages over one socket between the program and a helper that reads untrusted files. A message
// has a kind, a length and bytes; each helper has an enumeration of its kinds.
namespace airtruth::helper {

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

// The helper's end: its standard input, which is the socket.
class ToParent : public Channel {
 protected:
  std::size_t read_some(char* data, std::size_t size) override;
  std::size_t write_some(const char* data, std::size_t size) override;
};

}  // namespace airtruth::helper
