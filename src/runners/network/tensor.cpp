// SPDX-License-Identifier: Apache-2.0
#include "runners/network/tensor.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "foundation/base/error.h"
#include "foundation/sandbox/messages.h"

namespace airtruth::network {
namespace {

constexpr std::size_t kMostTensors = 16;
constexpr std::size_t kMostDimensions = 8;
constexpr std::size_t kMostValues = std::size_t{1} << 28;  // of a tensor: 1 GiB

}  // namespace

Samples make_samples(int width, int height, int channels) {
  Samples samples{width, height, channels, {}};
  samples.values.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
                        static_cast<std::size_t>(channels));
  return samples;
}

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

}  // namespace airtruth::network
