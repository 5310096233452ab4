// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "foundation/sandbox/sandbox.h"
#include "runners/network/model_description.h"

// A network in a child process, airtruth-network-runner, which can only return numbers: OpenCV's
// reader of ONNX files was not written for files of strangers (docs/decisions/0035).
namespace airtruth::network {

// An output of the network: the last dimension varies fastest.
struct Tensor {
  std::vector<int> shape;
  std::vector<float> values;
};

// "1 x 2 x 120 x 160"
std::string in_words(const std::vector<int>& shape);

std::string bytes_of(const std::vector<Tensor>& tensors);
// Throws Error where the bytes are not exactly such tensors.
std::vector<Tensor> tensors_from_bytes(std::string_view bytes);

// The protocol.
enum class NetworkMessage : std::uint8_t {
  kLoad = 1,  // to the child: bytes_of(NetworkJob)
  kLoaded,    // from the child
  kRun,       // to the child: width and height as 32-bit numbers, and the samples
  kOutputs,   // from the child: bytes_of(tensors)
  kError,     // from the child: an Error
};

// Goes on after what a library cannot load or run: another one may.
constexpr const char* kOtherLibraries =
    "; a program of yours with another library can run it: exec:COMMAND";

// The preparation of samples and the network itself.
struct NetworkJob {
  int channels = 1;
  std::array<float, 3> mean{};
  std::array<float, 3> scale{1, 1, 1};
  std::vector<std::string> outputs;  // names
  std::string onnx;                  // the file's bytes
};

std::string bytes_of(const NetworkJob& job);
NetworkJob job_from_bytes(std::string_view bytes);

// The longest time in seconds to load a network, and to run it on one input. Chosen: a network of
// 100 million parameters loads in a few seconds, and runs in a few.
constexpr double kLoadSeconds = 60;
constexpr double kRunSeconds = 60;
// All runs of one child together: this many times the longest run, and a sixth of it for each
// input, 600 s and 10 s an input. A network may be slow at first, and not for days.
constexpr double kFreeRuns = 10;
constexpr double kRunsPerLimit = 6;

class NetworkChild {
 public:
  // Starts the child with this number of threads and has it load the network. Throws Error, with a
  // text that goes on after the model's name, where the network cannot be loaded, and Interrupted.
  NetworkChild(const NetworkJob& job, int threads, std::stop_token stop);

  // The outputs for one input: samples of 8 bits, row after row, the channels of a pixel beside one
  // another. Throws Error likewise. After an Error the child may have ended: make another.
  std::vector<Tensor> run(int width, int height, std::span<const std::uint8_t> samples);

 private:
  std::string answer(NetworkMessage wanted, const std::string& did_not);

  sandbox::Process process_;
  // Of all runs: how many, and how long they took.
  std::int64_t runs_ = 0;
  double spent_s_ = 0;
};

}  // namespace airtruth::network
