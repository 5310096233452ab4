// SPDX-License-Identifier: Apache-2.0
#include "foundation/helper/channel.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include <unistd.h>

#include "foundation/base/error.h"

namespace airtruth::helper {
namespace {

constexpr std::size_t kPieceBytes = std::size_t{1} << 20;

}  // namespace

bool Channel::read_all(char* data, std::size_t size) {
  while (size > 0) {
    const std::size_t got = read_some(data, size);
    if (got == 0) return false;
    data += got;
    size -= got;
  }
  return true;
}

bool Channel::write_all(const char* data, std::size_t size) {
  while (size > 0) {
    const std::size_t put = write_some(data, size);
    if (put == 0) return false;
    data += put;
    size -= put;
  }
  return true;
}

Channel::Received Channel::receive(std::size_t most) {
  std::array<char, 9> head{};
  Received received;
  received.closed = !read_all(head.data(), head.size());
  if (received.closed) return received;
  received.kind = static_cast<std::uint8_t>(head[0]);
  std::uint64_t size = 0;
  std::memcpy(&size, &head[1], sizeof(size));
  if (size > most) throw Error("the file's reader handed back a message that is too long");
  // Memory grows with the bytes that arrive, not with the size that the message states.
  while (received.bytes.size() < size && !received.closed) {
    const std::size_t at = received.bytes.size();
    received.bytes.resize(std::min<std::size_t>(size, std::max(2 * at, kPieceBytes)));
    received.closed = !read_all(received.bytes.data() + at, received.bytes.size() - at);
  }
  return received;
}

bool Channel::send_kind(std::uint8_t kind, std::string_view bytes) {
  std::array<char, 9> head{};
  head[0] = static_cast<char>(kind);
  const std::uint64_t size = bytes.size();
  std::memcpy(&head[1], &size, sizeof(size));
  return write_all(head.data(), head.size()) && write_all(bytes.data(), bytes.size());
}

std::size_t ToParent::read_some(char* data, std::size_t size) {
  for (;;) {
    const ssize_t got = ::read(0, data, size);
    if (got >= 0) return static_cast<std::size_t>(got);
    if (errno != EINTR) return 0;
  }
}

std::size_t ToParent::write_some(const char* data, std::size_t size) {
  for (;;) {
    const ssize_t put = ::write(0, data, size);
    if (put >= 0) return static_cast<std::size_t>(put);
    if (errno != EINTR) return 0;
  }
}

}  // namespace airtruth::helper
