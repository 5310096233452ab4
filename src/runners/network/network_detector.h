// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <stop_token>

#include "runners/detector/detector.h"

// The detector "onnx:MODEL.onnx": a network in the ONNX format and the JSON file beside it, which
// says how its input and output are to be read (docs/formats/detector-model.md).
namespace airtruth::network {

struct NetworkOptions {
  int threads = 1;  // of the network; no more than there are processors are started
  std::stop_token stop;
};

// Reads both files, loads the network and runs it once. Throws Error where that fails or its
// outputs are not as described. The detector's begin() and detect() throw process::Failure where
// the network fails later; begin() then starts it anew.
std::unique_ptr<detector::Detector> make_network_detector(const std::filesystem::path& model,
                                                          const NetworkOptions& options = {});

}  // namespace airtruth::network
