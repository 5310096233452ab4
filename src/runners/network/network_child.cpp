// SPDX-License-Identifier: Apache-2.0
#include "runners/network/network_child.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "foundation/base/error.h"
#include "foundation/sandbox/messages.h"

namespace airtruth::network {
namespace {

constexpr sandbox::Program kRunner{
    "airtruth-network-runner", "AIRTRUTH_NETWORK_RUNNER", "which runs detectors' networks"};
constexpr std::size_t kMostAnswerBytes = std::size_t{1} << 30;
constexpr std::size_t kMostNameBytes = 1024;
constexpr std::size_t kMostOutputs = 16;

}  // namespace

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

std::vector<Tensor> NetworkChild::run(const Samples& samples) {
  sandbox::WireWriter out;
  out.put(static_cast<std::int32_t>(samples.width));
  out.put(static_cast<std::int32_t>(samples.height));
  out.put_raw(samples.values.data(), samples.values.size());
  process_.set_deadline(kRunSeconds,
                        fmt::format("gives no answer for an input of {} x {} px within {:g} s",
                                    samples.width,
                                    samples.height,
                                    kRunSeconds));
  process_.send(NetworkMessage::kRun, out.take());
  return tensors_from_bytes(answer(
      NetworkMessage::kOutputs,
      fmt::format("cannot be run on an input of {} x {} px", samples.width, samples.height)));
}

std::string NetworkChild::answer(NetworkMessage wanted, const std::string& did_not) {
  sandbox::Channel::Received received = process_.receive(kMostAnswerBytes);
  if (received.closed) throw Error(did_not + ": " + sandbox::end_in_words(process_.end()));
  if (received.is(NetworkMessage::kError)) {
    throw Error(did_not + ": " + sandbox::error_from_bytes(received.bytes).message());
  }
  if (!received.is(wanted)) throw Error("makes its reader say what it should not");
  return std::move(received.bytes);
}

}  // namespace airtruth::network
