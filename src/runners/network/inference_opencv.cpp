// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <atomic>
#include <chrono>
#include <new>
#include <thread>

#include <opencv2/core.hpp>
#include <opencv2/dnn.hpp>

#include "foundation/base/error.h"
#include "runners/network/inference.h"

namespace airtruth::network {
namespace {

// On a machine that is busy with other work threads begin late.
constexpr auto kThreadsAreThere = std::chrono::seconds(10);

// Has OpenCV start its threads. Each waits until all are there.
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

// Calls `work`; what OpenCV throws becomes an Error with these words after OpenCV's own.
auto guarded(const auto& work, const std::string& hint = kOtherLibraries) {
  try {
    return work();
  } catch (const cv::Exception& error) {
    if (error.code == cv::Error::StsNoMem) throw std::bad_alloc();
    const std::string words = words_of(error);
    if (words.starts_with("Failed to parse"))
      throw Error("it is no ONNX file, or its end is missing");
    throw Error("OpenCV says: " + words + hint);
  }
}

Tensor tensor_of(const cv::Mat& output) {
  if (output.type() != CV_32F) throw Error("an output is not of 32-bit numbers");
  const cv::Mat whole = output.isContinuous() ? output : output.clone();
  Tensor tensor;
  for (int i = 0; i < whole.dims; ++i) tensor.shape.push_back(whole.size[i]);
  tensor.values.assign(whole.ptr<float>(), whole.ptr<float>() + whole.total());
  return tensor;
}

}  // namespace

struct Inference::Library {
  cv::dnn::Net net;
  std::vector<cv::String> outputs;

  std::string ends() const {
    std::string names;
    for (const std::string& name : net.getUnconnectedOutLayersNames())
      names += (names.empty() ? "'" : ", '") + name.substr(0, 60) + "'";
    return names.substr(0, 300);
  }
};

Inference::Inference(int threads) : library_(std::make_unique<Library>()) {
  start_threads(threads);
}

Inference::~Inference() = default;

void Inference::load(const std::string& onnx, std::vector<std::string> outputs) {
  cv::dnn::Net& net = library_->net;
  net = guarded([&] { return cv::dnn::readNetFromONNX(onnx.data(), onnx.size()); },
                std::string(" (it reads networks of opset 12 and less, with a batch of 1 and fixed "
                            "sizes)") +
                    kOtherLibraries);
  if (net.empty()) throw Error("it holds no network");
  guarded([&] {
    net.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
    net.setPreferableTarget(cv::dnn::DNN_TARGET_CPU);
    const std::vector<std::string> layers = net.getLayerNames();
    for (const std::string& name : outputs)
      if (std::ranges::find(layers, name) == layers.end())
        throw Error("it has no output '" + name + "'; it ends with " + library_->ends());
  });
  library_->outputs = std::move(outputs);
}

std::vector<Tensor> Inference::run(Tensor input) {
  std::vector<cv::Mat> outputs;
  guarded([&] {
    library_->net.setInput(cv::Mat(input.shape, CV_32F, input.values.data()));
    library_->net.forward(outputs, library_->outputs);
  });
  std::vector<Tensor> tensors;
  for (const cv::Mat& output : outputs) tensors.push_back(tensor_of(output));
  return tensors;
}

}  // namespace airtruth::network
