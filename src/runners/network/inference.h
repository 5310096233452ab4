// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "runners/network/network_child.h"

namespace airtruth::network {

// The library that reads an ONNX network and runs it on the processor: onnxruntime where the system
// has it (Debian 13, inference_onnxruntime.cpp), else OpenCV's dnn (inference_opencv.cpp). Only
// airtruth-network-runner uses it.
//
// All functions throw Error, with a text that says what the network lacks, and std::bad_alloc where
// it needs more memory than there is.
class Inference {
 public:
  // Starts the library's threads, this one among them: a confined process can start none.
  explicit Inference(int threads);
  ~Inference();
  Inference(const Inference&) = delete;
  Inference& operator=(const Inference&) = delete;

  // Reads a network from the bytes of its file. It must have these outputs.
  void load(const std::string& onnx, std::vector<std::string> outputs);
  // Returns the outputs, in the order of load(), for one input.
  std::vector<Tensor> run(Tensor input);

 private:
  struct Library;
  std::unique_ptr<Library> library_;
};

}  // namespace airtruth::network
