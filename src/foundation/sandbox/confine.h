// SPDX-License-Identifier: Apache-2.0
#pragma once

// Confines a child program, which reads untrusted files, to what the reading needs (seccomp).
namespace airtruth::sandbox {

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
