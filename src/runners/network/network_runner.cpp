// SPDX-License-Identifier: Apache-2.0
// airtruth-network-runner runs one ONNX network for the program that started it and returns plain
// numbers. Its standard input is a socket, through which it receives the network's bytes and its
// inputs. Its arguments are the number of its parent and the number of threads.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <new>
#include <span>
#include <string>
#include <thread>

#include <opencv2/core.hpp>
#include <opencv2/dnn.hpp>
#include <unistd.h>

#include "foundation/base/error.h"
#include "foundation/sandbox/child.h"
#include "foundation/sandbox/confine.h"
#include "foundation/sandbox/messages.h"
#include "runners/network/network_child.h"

namespace {

using namespace airtruth;  // the program's own top level
using namespace airtruth::network;

constexpr std::size_t kMaxMessageBytes = std::size_t{1} << 30;
// OpenCV starts no more threads than there are processors.
const int kMostThreads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
constexpr unsigned long kMemoryBytes = 4ul << 30;
// A thread reserves addresses for its stack (8 MiB) and its heap (128 MiB).
constexpr unsigned long kThreadBytes = 160ul << 20;
// On a machine that is busy with other work threads begin late.
constexpr auto kThreadsAreThere = std::chrono::seconds(10);

// Has OpenCV start its threads: a confined process can start none. Each waits until all are there.
void start_threads(int count) {
  cv::setNumThreads(count);
  std::atomic<int> there = 0;
  const auto latest = std::chrono::steady_clock::now() + kThreadsAreThere;
  cv::parallel_for_(
      cv::Range(0, count),
      [&](const cv::Range& range) {
        there += range.size();
        while (there < count && std::chrono::steady_clock::now() < latest)
          std::this_thread::yield();
      },
      count);
}

// A cv::Exception has its place in the code before the words that help.
std::string words_of(const cv::Exception& error) {
  std::string words = error.err.empty() ? error.what() : error.err;
  if (words.starts_with("> ")) words.erase(0, 2);  // of a message with several parts
  return words.substr(0, words.find('\n')).substr(0, 300);
}

class Network {
 public:
  explicit Network(NetworkJob job) : job_(std::move(job)) {
    read();
    if (net_.empty()) throw Error("it holds no network");
    net_.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
    net_.setPreferableTarget(cv::dnn::DNN_TARGET_CPU);
    const std::vector<std::string> layers = net_.getLayerNames();
    for (const std::string& name : job_.outputs) {
      if (std::ranges::find(layers, name) == layers.end()) {
        throw Error("it has no output '" + name + "'; it ends with " + ends());
      }
    }
    job_.onnx.clear();
  }

  std::vector<Tensor> run(std::string_view bytes) {
    sandbox::WireReader in(bytes);
    const auto width = in.get<std::int32_t>();
    const auto height = in.get<std::int32_t>();
    net_.setInput(blob_of(in.rest(), width, height));
    std::vector<cv::Mat> outputs;
    net_.forward(outputs, std::vector<cv::String>(job_.outputs.begin(), job_.outputs.end()));
    std::vector<Tensor> tensors;
    for (const cv::Mat& output : outputs) tensors.push_back(tensor_of(output));
    return tensors;
  }

 private:
  void read() {
    try {
      net_ = cv::dnn::readNetFromONNX(job_.onnx.data(), job_.onnx.size());
    } catch (const cv::Exception& error) {
      if (error.code == cv::Error::StsNoMem) throw;
      const std::string words = words_of(error);
      throw Error(
          words.starts_with("Failed to parse")
              ? "it is no ONNX file, or its end is missing"
              : "OpenCV says: " + words +
                    " (it reads networks of opset 12 and less, with a batch of 1 and fixed sizes)");
    }
  }

  std::string ends() const {
    std::string names;
    for (const std::string& name : net_.getUnconnectedOutLayersNames()) {
      names += (names.empty() ? "'" : ", '") + name.substr(0, 60) + "'";
    }
    return names.substr(0, 300);
  }

  // 1 x channels x height x width.
  cv::Mat blob_of(std::string_view samples, int width, int height) const {
    const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    const auto channels = static_cast<std::size_t>(job_.channels);
    if (width < 1 || height < 1 || samples.size() != pixels * channels) {
      throw Error("the input has the wrong size");
    }
    cv::Mat blob({1, job_.channels, height, width}, CV_32F);
    float* to = blob.ptr<float>();
    for (std::size_t channel = 0; channel < channels; ++channel) {
      const float mean = job_.mean[channel];
      const float scale = job_.scale[channel];
      const char* from = samples.data() + channel;
      for (std::size_t i = 0; i < pixels; ++i, from += channels) {
        *to++ = (static_cast<float>(static_cast<std::uint8_t>(*from)) - mean) * scale;
      }
    }
    return blob;
  }

  static Tensor tensor_of(const cv::Mat& output) {
    if (output.type() != CV_32F) throw Error("an output is not of 32-bit numbers");
    const cv::Mat whole = output.isContinuous() ? output : output.clone();
    Tensor tensor;
    for (int i = 0; i < whole.dims; ++i) tensor.shape.push_back(whole.size[i]);
    tensor.values.assign(whole.ptr<float>(), whole.ptr<float>() + whole.total());
    return tensor;
  }

  NetworkJob job_;
  cv::dnn::Net net_;
};

// Has OpenCV's exceptions say what a user can act on.
template <typename Work>
void in_words(const Work& work) {
  try {
    work();
  } catch (const cv::Exception& error) {
    if (error.code == cv::Error::StsNoMem) throw std::bad_alloc();
    throw Error("OpenCV says: " + words_of(error));
  }
}

bool told(sandbox::Channel& parent, const std::function<void()>& work) {
  constexpr sandbox::Faults kFaults{static_cast<std::uint8_t>(NetworkMessage::kError),
                                    "it needs more memory than a network may take",
                                    ""};
  return sandbox::told(parent, kFaults, [&] { in_words(work); });
}

void serve(sandbox::Channel& parent, int threads) {
  std::optional<Network> network;
  const bool loaded = told(parent, [&] {
    start_threads(threads);
    sandbox::confine(
        {.memory_bytes = kMemoryBytes + static_cast<unsigned long>(threads) * kThreadBytes,
         .processor_s = 0});
    const sandbox::Channel::Received received = parent.receive(kMaxMessageBytes);
    if (received.closed || !received.is(NetworkMessage::kLoad)) ::_exit(0);
    network.emplace(job_from_bytes(received.bytes));
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
