// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <stop_token>
#include <string>

#include "runners/detector/detector.h"

// Detectors that are programs of their own (docs/detector-protocol.md).
namespace airtruth::detector {

struct ExternalOptions {
  // A shell command.
  std::string command;
  // From the process's start to its hello.
  double start_s = 30;
  // From a frame's first byte to its answer.
  double answer_s = 30;
  std::stop_token stop;
};

// begin() starts a process for the sequence, and ends one that it started before. A process that
// ends, answers too late, too early or out of order, or sends what the protocol does not know, is a
// process::Failure that says so; it is ended, with all that it started.
std::unique_ptr<Detector> make_external(ExternalOptions options);

}  // namespace airtruth::detector
