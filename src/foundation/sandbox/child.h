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

// What the process, which reads untrusted files, is confined to (seccomp): what the reading needs.

struct Limits {
  // The limit of address space. It is not set with AddressSanitizer, which reserves terabytes.
  unsigned long memory_bytes = 3ul << 30;
  // The limit of processor time, in seconds; 0: none.
  unsigned long processor_s = 20;
};

// After this call the process can read and write its standard input (a socket to its parent),
// allocate and free memory, let its threads wait for one another, and end. All other system calls
// fail: the process can open no file, start no process or thread and reach no network, even with
// administrator's rights. The limits hold for all threads that the process has. Throws Error where
// the kernel lacks a part of this.
void confine(const Limits& limits);

}  // namespace airtruth::sandbox
