// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "runners/detector/detector.h"
#include "runners/process/child.h"

// A detector by its name: the one place where kinds of detectors plug in.
namespace airtruth::runs {

// The limits are for external programs.
struct DetectorOptions : process::Limits {
  int threads = 1;  // of a network
};

// The network that ships in data/network-detector.
inline constexpr const char* kShippedDetector = "network";

// The names of the built-in detectors.
std::vector<std::string> detector_names();
// The forms of the others, with what they are, for --help and errors.
std::vector<std::string> detector_forms();

// "mine=exec:./mine --fast" is the command "exec:./mine --fast" whose results are named "mine";
// without a name they are named as the command up to its colon, and those of onnx:DIR/aircraft.onnx
// "aircraft".
struct DetectorName {
  std::string name;  // a plain file name
  std::string command;
};
// Throws Error for a name that is no file name, and for an unknown detector; it offers the nearest.
DetectorName named_detector(const std::string& text);

// The files beside the command that decide a detector's answers: a network and its description.
// Throws Error where the network that ships is not there.
std::vector<std::filesystem::path> files_of(std::string_view command);

// Throws Error for what is no detector.
std::unique_ptr<detector::Detector> make_detector(std::string_view command,
                                                  const DetectorOptions& options);

}  // namespace airtruth::runs
