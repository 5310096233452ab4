// SPDX-License-Identifier: Apache-2.0
#pragma once

// Confines a helper program, which reads untrusted files, to what the reading needs (seccomp). Its
// main() calls end_with_parent() and confine() before it reads the first byte of them.
namespace airtruth::helper {

struct Limits {
  // The limit of address space. It is not set with AddressSanitizer, which reserves terabytes.
  unsigned long memory_bytes = 3ul << 30;
  // The limit of processor time, in seconds; 0: none.
  unsigned long processor_s = 20;
};

// Ends this process when the process `parent`, whose child it is, ends.
void end_with_parent(int parent);

// After this call the process can read and write its standard input (a socket to its parent),
// allocate and free memory, let its threads wait for one another, and end. All other system calls
// fail: the process can open no file, start no process or thread and reach no network, even with
// administrator's rights. The limits hold for all threads that the process has. Throws Error where
// the kernel lacks a part of this.
void confine(const Limits& limits);

}  // namespace airtruth::helper
