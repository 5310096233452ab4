// SPDX-License-Identifier: Apache-2.0
// airtruth-network-runner runs one ONNX network for the program that started it and returns plain
// numbers. Its standard input is a socket, through which it receives the network's bytes and its
// inputs. Its arguments are the number of its parent and the number of threads.
#include <algorithm>
#include <array>
#include <cstdlib>
#include <functional>
#include <new>
#include <optional>
#include <span>
#include <string>

#include <unistd.h>

#include "foundation/base/error.h"
#include "foundation/base/in_parallel.h"
#include "foundation/base/text.h"
#include "foundation/sandbox/child.h"
#include "foundation/sandbox/confine.h"
#include "foundation/sandbox/messages.h"
#include "runners/network/external_data.h"
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
