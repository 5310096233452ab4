// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "runners/detector/detector.h"

// Detectors that are programs of their own (docs/detector-protocol.md).
namespace airtruth::detector {

// `command` is one of a shell. The limits are from the process's start to its hello, and from a
// frame's first byte to its answer. begin() starts a process for the sequence, and ends one that it
// started before. A process that ends, answers too late, too early or out of order, or sends what
// the protocol does not know, is a process::Failure that says so; it is ended, with all that it
// started.
std::unique_ptr<Detector> make_external(std::string command, const process::Limits& limits);

}  // namespace airtruth::detector
