// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "foundation/sandbox/messages.h"

// The child's side of a sandbox: what the main programs of airtruth-model-reader and
// airtruth-network-runner have in common. Their standard input is the socket to the parent.
namespace airtruth::sandbox {

// All of main() for a child with `count` arguments behind its parent's number: calls `work` with
// the socket and these arguments, and ends the process. The process ends with its parent, too. An
// exception that leaves `work` is exit code 1, and a person who starts the program is told that
// airtruth alone does. `work` calls confine() before it reads the first untrusted byte.
int child_main(int argc,
               char** argv,
               int count,
               const std::function<void(Channel& parent, std::span<char*> arguments)>& work);

// Calls `work`. Where it throws, the parent receives an Error in a message of that kind. Returns
// whether it has not.
struct Faults {
  std::uint8_t kind;
  const char* no_memory;  // the message for std::bad_alloc
  const char* other;      // before the words of an exception that is no Error
};
bool told(Channel& parent, const Faults& faults, const std::function<void()>& work);

}  // namespace airtruth::sandbox
