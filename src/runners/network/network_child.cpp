// SPDX-License-Identifier: Apache-2.0
#include "runners/network/network_child.h"

#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "foundation/base/error.h"
#include "foundation/base/stopwatch.h"
#include "foundation/sandbox/messages.h"

namespace airtruth::network {
namespace {

constexpr sandbox::Program kRunner{
    "airtruth-network-runner", "AIRTRUTH_NETWORK_RUNNER", "which runs detectors' networks"};
// Bounds for what a stranger's network makes the child say, far above what detectors have.
constexpr std::size_t kMostAnswerBytes = std::size_t{1} << 30;
constexpr std::size_t kMostNameBytes = 1024;
constexpr std::size_t kMostOutputs = 16;

// Bounds for what the child hands back: numbers of tensors, dimensions and values.
constexpr std::size_t kMostTensors = 16;
constexpr std::size_t kMostDimensions = 8;
constexpr std::size_t kMostValues = std::size_t{1} << 28;  // of a tensor: 1 GiB

}  // namespace

std::string in_words(const std::vector<int>& shape) {
  return fmt::format("{}", fmt::join(shape, " x "));
}

std::string bytes_of(const std::vector<Tensor>& tensors) {
  sandbox::WireWriter out;
  out.put(static_cast<std::uint64_t>(tensors.size()));
  for (const Tensor& tensor : tensors) {
    out.put(static_cast<std::uint64_t>(tensor.shape.size()));
    for (const int length : tensor.shape) out.put(static_cast<std::int32_t>(length));
    out.put(static_cast<std::uint64_t>(tensor.values.size()));
    out.put_raw(tensor.values.data(), tensor.values.size() * sizeof(float));
  }
  return out.take();
}

std::vector<Tensor> tensors_from_bytes(std::string_view bytes) {
  sandbox::WireReader in(bytes);
  std::vector<Tensor> tensors(in.get_count(kMostTensors, 2 * sizeof(std::uint64_t)));
  for (Tensor& tensor : tensors) {
    tensor.shape.resize(in.get_count(kMostDimensions, sizeof(std::int32_t)));
    std::size_t expected = 1;
    for (int& length : tensor.shape) {
      length = in.get<std::int32_t>();
      if (length < 0 || length > static_cast<int>(kMostValues)) {
        throw Error("gives an output of an impossible shape");
      }
      expected *= static_cast<std::size_t>(length);
      if (expected > kMostValues) throw Error("gives an output that is too large");
    }
    tensor.values.resize(in.get_count(kMostValues, sizeof(float)));
    if (tensor.values.size() != expected) throw Error("gives an output unlike its shape");
    in.get_raw(tensor.values.data(), tensor.values.size() * sizeof(float));
  }
  in.expect_end();
  return tensors;
}

std::string bytes_of(const NetworkJob& job) {
  sandbox::WireWriter out;
  out.put(static_cast<std::int32_t>(job.channels));
  for (const float mean : job.mean) out.put(mean);
  for (const float scale : job.scale) out.put(scale);
  out.put(static_cast<std::uint64_t>(job.outputs.size()));
  for (const std::string& name : job.outputs) out.put_text(name);
  out.put_text(job.onnx);
  return out.take();
}

NetworkJob job_from_bytes(std::string_view bytes) {
  sandbox::WireReader in(bytes);
  NetworkJob job;
  job.channels = in.get<std::int32_t>();
  for (float& mean : job.mean) mean = in.get<float>();
  for (float& scale : job.scale) scale = in.get<float>();
  job.outputs.resize(in.get_count(kMostOutputs, sizeof(std::uint64_t)));
  for (std::string& name : job.outputs) name = in.get_text(kMostNameBytes);
  job.onnx = in.get_text(bytes.size());
  in.expect_end();
  return job;
}

NetworkChild::NetworkChild(const NetworkJob& job, int threads, std::stop_token stop)
    : process_(kRunner, std::move(stop), {std::to_string(threads)}) {
  process_.set_deadline(kLoadSeconds,
                        fmt::format("is not loaded as a network within {:g} s", kLoadSeconds));
  process_.send(NetworkMessage::kLoad, bytes_of(job));
  answer(NetworkMessage::kLoaded, "cannot be loaded as an ONNX network");
}

std::vector<Tensor> NetworkChild::run(int width,
                                      int height,
                                      std::span<const std::uint8_t> samples) {
  sandbox::WireWriter out;
  out.put(static_cast<std::int32_t>(width));
  out.put(static_cast<std::int32_t>(height));
  out.put_raw(samples.data(), samples.size());
  const double left_s =
      kRunSeconds * (kFreeRuns + static_cast<double>(++runs_) / kRunsPerLimit) - spent_s_;
  if (!(left_s > 0))
    throw Error(fmt::format("has taken {:.0f} s for {} inputs; expected {:g} s each in the mean",
                            spent_s_,
                            runs_ - 1,
                            kRunSeconds / kRunsPerLimit));
  const Stopwatch watch;
  process_.set_deadline(
      kRunSeconds,
      fmt::format(
          "gives no answer for an input of {} x {} px within {:g} s", width, height, kRunSeconds));
  process_.send(NetworkMessage::kRun, out.take());
  const std::string bytes =
      answer(NetworkMessage::kOutputs,
             fmt::format("cannot be run on an input of {} x {} px", width, height));
  spent_s_ += watch.seconds();
  return tensors_from_bytes(bytes);
}

std::string NetworkChild::answer(NetworkMessage wanted, const std::string& did_not) {
  sandbox::Channel::Received received = process_.receive(kMostAnswerBytes);
  if (received.closed) {
    throw Error(did_not + ": " + sandbox::end_in_words(process_.end()) + kOtherLibraries);
  }
  if (received.is(NetworkMessage::kError)) {
    throw Error(did_not + ": " + sandbox::error_from_bytes(received.bytes).message());
  }
  if (!received.is(wanted)) throw Error("makes its reader say what it should not");
  return std::move(received.bytes);
}

}  // namespace airtruth::network
