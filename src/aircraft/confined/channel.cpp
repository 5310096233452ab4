// SPDX-License-Identifier: Apache-2.0
#include "aircraft/confined/channel.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "aircraft/confined/model_wire.h"

namespace airtruth::aircraft {
namespace {

constexpr std::size_t kMaxWords = 65536;
constexpr std::size_t kPieceBytes = std::size_t{1} << 20;

// The text on one line without control characters, since the name or content of a file may hold
// any.
std::string one_line(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < ' ' || c == '\x7f') c = '?';
  return text;
}

}  // namespace

std::string bytes_of(const ReaderJob& job) {
  WireWriter out;
  out.put_text(job.file);
  out.put_text(job.shown_folder);
  out.put_text(job.in_data_root);
  out.put(job.options.airspeed_kt);
  out.put(job.options.altitude_agl_ft);
  out.put(static_cast<std::uint8_t>(job.options.axes.has_value()));
  const ModelAxes axes = job.options.axes.value_or(ModelAxes{});
  out.put_text(axes.forward);
  out.put_text(axes.up);
  out.put(axes.scale);
  return out.take();
}

ReaderJob job_from_bytes(std::string_view bytes) {
  WireReader in(bytes);
  ReaderJob job;
  job.file = in.get_text(kMaxWords);
  job.shown_folder = in.get_text(kMaxWords);
  job.in_data_root = in.get_text(kMaxWords);
  job.options.airspeed_kt = in.get<double>();
  job.options.altitude_agl_ft = in.get<double>();
  const bool has_axes = in.get<std::uint8_t>() != 0;
  ModelAxes axes;
  axes.forward = in.get_text(kMaxWords);
  axes.up = in.get_text(kMaxWords);
  axes.scale = in.get<double>();
  if (has_axes) job.options.axes = axes;
  in.expect_end();
  return job;
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
  received.message = static_cast<Message>(head[0]);
  std::uint64_t size = 0;
  std::memcpy(&size, &head[1], sizeof(size));
  if (size > most) throw Error("the model's reader handed back a message that is too long");
  // Memory grows with the bytes that arrive, not with the size that the message states.
  while (received.bytes.size() < size && !received.closed) {
    const std::size_t at = received.bytes.size();
    received.bytes.resize(std::min<std::size_t>(size, std::max(2 * at, kPieceBytes)));
    received.closed = !read_all(received.bytes.data() + at, received.bytes.size() - at);
  }
  return received;
}

bool Channel::send(Message message, std::string_view bytes) {
  std::array<char, 9> head{};
  head[0] = static_cast<char>(message);
  const std::uint64_t size = bytes.size();
  std::memcpy(&head[1], &size, sizeof(size));
  return write_all(head.data(), head.size()) && write_all(bytes.data(), bytes.size());
}

}  // namespace airtruth::aircraft
