// SPDX-License-Identifier: Apache-2.0
#include "foundation/helper/wire.h"

#include <algorithm>
#include <cstring>

namespace airtruth::helper {
namespace {

constexpr std::size_t kMaxWords = 65536;

// The text on one line without control characters, since the name or content of a file may hold
// any.
std::string one_line(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < ' ' || c == '\x7f') c = '?';
  return text;
}

}  // namespace

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

}  // namespace airtruth::helper
