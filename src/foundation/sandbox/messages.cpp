// SPDX-License-Identifier: Apache-2.0
#include "foundation/sandbox/messages.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "foundation/base/text.h"

namespace airtruth::sandbox {
namespace {

constexpr std::size_t kPieceBytes = std::size_t{1} << 20;  // of memory for a message that arrives
constexpr std::size_t kMaxWords = 65536;                   // bytes of an error's message

// The text on one line without control characters, since the name or content of a file may hold
// any.
std::string one_line(std::string text) {
  for (char& c : text)
    if (is_control(c)) c = '?';
  return text;
}

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

void WireReader::get_raw(void* data, std::size_t size) {
  if (size > bytes_.size()) throw Error("the file's reader handed back too few bytes");
  if (size > 0) std::memcpy(data, bytes_.data(), size);
  bytes_.remove_prefix(size);
}

std::size_t WireReader::get_count(std::size_t most, std::size_t bytes_each) {
  const auto count = get<std::uint64_t>();
  if (count > most || count > bytes_.size() / bytes_each)
    throw Error("the file's reader handed back a count that is too large");
  return static_cast<std::size_t>(count);
}

std::string WireReader::get_text(std::size_t most) {
  std::string text(get_count(most, 1), '\0');
  get_raw(text.data(), text.size());
  return text;
}

void WireReader::expect_end() const {
  if (!bytes_.empty()) throw Error("the file's reader handed back too many bytes");
}

std::string bytes_of(const Error& error) {
  WireWriter out;
  out.put_text(std::string_view(error.message()).substr(0, kMaxWords));
  out.put_text(std::string_view(error.where().file).substr(0, kMaxWords));
  out.put(static_cast<std::int32_t>(error.where().line));
  return out.take();
}

Error error_from_bytes(std::string_view bytes) {
  WireReader in(bytes);
  const std::string message = one_line(in.get_text(kMaxWords));
  const std::string file = one_line(in.get_text(kMaxWords));
  const auto line = in.get<std::int32_t>();
  in.expect_end();
  return Error(message, {file, std::max(0, static_cast<int>(line))});
}

}  // namespace airtruth::sandbox
