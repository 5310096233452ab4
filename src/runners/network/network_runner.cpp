// SPDX-License-Identifier: Apache-2.0
// airtruth-network-runner runs one ONNX network for the program that started it and returns plain
// numbers. Its standard input is a socket, through which it receives the network's bytes and its
// inputs. Its arguments are the number of its parent and the number of threads.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <unistd.h>

#include "foundation/base/error.h"
#include "foundation/base/in_parallel.h"
#include "foundation/base/text.h"
#include "foundation/sandbox/child.h"
#include "foundation/sandbox/confine.h"
#include "foundation/sandbox/messages.h"
#include "runners/network/inference.h"
#include "runners/network/network_child.h"

namespace {

using namespace airtruth;  // the program's own top level
using namespace airtruth::network;

// Bound of a message from the parent; the largest is a model (network_detector.cpp).
constexpr std::size_t kMaxMessageBytes = std::size_t{1} << 30;
// No more threads are started than there are processors.
const int kMostThreads = usable_processors();
// Bound of the memory of a stranger's network, beside that of its threads.
constexpr unsigned long kMemoryBytes = 4ul << 30;
// A thread reserves addresses for its stack (8 MiB) and its heap (128 MiB).
constexpr unsigned long kThreadBytes = 160ul << 20;
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

// The name of the file beside an ONNX network in which its weights lie (external data, onnx.proto's
// TensorProto.external_data), or nothing where the network holds all of them. Bytes that are no
// Protocol Buffers message give nothing.
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

// What stands between the messages and the network: samples become numbers, channel by channel.
class Network {
 public:
  Network(Inference& inference, const NetworkJob& job)
      : inference_(inference), channels_(job.channels), mean_(job.mean), scale_(job.scale) {
    if (const auto other = external_data_of(job.onnx)) {
      std::string name = other->substr(0, 100);
      std::ranges::replace_if(name, is_control, '?');
      throw Error("its weights lie in a second file, '" + name +
                  "'; expected one file, as Python's onnx.save(onnx.load(\"MODEL.onnx\"), "
                  "\"MODEL.onnx\") makes of both");
    }
    inference_.load(job.onnx, job.outputs);
  }

  std::vector<Tensor> run(std::string_view bytes) {
    sandbox::WireReader in(bytes);
    const auto width = in.get<std::int32_t>();
    const auto height = in.get<std::int32_t>();
    return inference_.run(input_of(in.rest(), width, height));
  }

 private:
  // 1 x channels x height x width.
  Tensor input_of(std::string_view samples, int width, int height) const {
    const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    const auto channels = static_cast<std::size_t>(channels_);
    if (width < 1 || height < 1 || samples.size() != pixels * channels)
      throw Error("the input has the wrong size");
    Tensor input{{1, channels_, height, width}, std::vector<float>(samples.size())};
    auto to = input.values.begin();
    for (std::size_t channel = 0; channel < channels; ++channel)
      for (std::size_t i = channel; i < samples.size(); i += channels)
        *to++ = (static_cast<float>(static_cast<std::uint8_t>(samples[i])) - mean_[channel]) *
                scale_[channel];
    return input;
  }

  Inference& inference_;
  int channels_;
  std::array<float, 3> mean_, scale_;
};

bool told(sandbox::Channel& parent, const std::function<void()>& work) {
  constexpr sandbox::Faults kFaults{static_cast<std::uint8_t>(NetworkMessage::kError),
                                    "it needs more memory than a network may take",
                                    ""};
  return sandbox::told(parent, kFaults, work);
}

void serve(sandbox::Channel& parent, int threads) {
  std::optional<Inference> inference;
  std::optional<Network> network;
  const bool loaded = told(parent, [&] {
    inference.emplace(threads);
    sandbox::confine(
        {.memory_bytes = kMemoryBytes + static_cast<unsigned long>(threads) * kThreadBytes,
         .processor_s = 0});
    const sandbox::Channel::Received received = parent.receive(kMaxMessageBytes);
    if (received.closed || !received.is(NetworkMessage::kLoad)) ::_exit(0);
    network.emplace(*inference, job_from_bytes(received.bytes));
    parent.send(NetworkMessage::kLoaded, {});
  });
  if (!loaded) return;
  for (;;) {
    const sandbox::Channel::Received received = parent.receive(kMaxMessageBytes);
    if (received.closed || !received.is(NetworkMessage::kRun)) return;
    told(parent,
         [&] { parent.send(NetworkMessage::kOutputs, bytes_of(network->run(received.bytes))); });
  }
}

}  // namespace

int main(int argc, char** argv) {
  return sandbox::child_main(
      argc, argv, 1, [](sandbox::Channel& parent, std::span<char*> arguments) {
        serve(parent, std::clamp(std::atoi(arguments[0]), 1, kMostThreads));
      });
}
