// SPDX-License-Identifier: Apache-2.0
#include "runners/network/external_data.h"

#include <cstdint>
#include <functional>
#include <span>

namespace airtruth::network {
namespace {

// Reads the fields of one message in Protocol Buffers' encoding. What is damaged ends the message.
class FieldReader {
 public:
  explicit FieldReader(std::string_view bytes) : rest_(bytes) {}

  struct Field {
    std::uint64_t number = 0;
    std::string_view bytes;  // of a field with a length; else empty
  };

  std::optional<Field> next() {
    const auto tag = varint();
    if (!tag) return std::nullopt;
    switch (*tag & 7) {
      case 0:
        return varint() ? std::optional(Field{*tag >> 3, {}}) : std::nullopt;
      case 1:
        return skipped(*tag, 8);
      case 2: {
        const auto length = varint();
        return length ? skipped(*tag, *length) : std::nullopt;
      }
      case 5:
        return skipped(*tag, 4);
      default:
        return std::nullopt;
    }
  }

 private:
  std::optional<std::uint64_t> varint() {
    std::uint64_t value = 0;
    for (unsigned shift = 0; shift < 64 && !rest_.empty(); shift += 7) {
      const auto byte = static_cast<std::uint8_t>(rest_.front());
      rest_.remove_prefix(1);
      value |= static_cast<std::uint64_t>(byte & 0x7f) << shift;
      if (byte < 0x80) return value;
    }
    return std::nullopt;
  }

  std::optional<Field> skipped(std::uint64_t tag, std::uint64_t length) {
    if (length > rest_.size()) return std::nullopt;
    const Field field{tag >> 3, rest_.substr(0, length)};
    rest_.remove_prefix(length);
    return field;
  }

  std::string_view rest_;
};

// Calls `visit` with the messages that lie in `message` under these field numbers.
void each_under(std::string_view message,
                std::span<const std::uint64_t> path,
                const std::function<void(std::string_view)>& visit) {
  if (path.empty()) return visit(message);
  FieldReader reader(message);
  while (const auto field = reader.next()) {
    if (field->number == path[0]) each_under(field->bytes, path.subspan(1), visit);
  }
}

// onnx.proto: ModelProto.graph, GraphProto.initializer, TensorProto.external_data; and the same of
// a tensor in an attribute of a node. An entry has a key (1) and a value (2).
constexpr std::uint64_t kOfInitializers[] = {7, 5, 13};
constexpr std::uint64_t kOfAttributes[] = {7, 1, 5, 5, 13};

}  // namespace

std::optional<std::string> external_data_of(std::string_view onnx) {
  std::optional<std::string> location;
  const auto take = [&](std::string_view entry) {
    std::string_view key;
    std::string_view value;
    FieldReader reader(entry);
    while (const auto field = reader.next()) {
      if (field->number == 1) key = field->bytes;
      if (field->number == 2) value = field->bytes;
    }
    if (key == "location" && !location) location = value;
  };
  each_under(onnx, kOfInitializers, take);
  each_under(onnx, kOfAttributes, take);
  return location;
}

}  // namespace airtruth::network
