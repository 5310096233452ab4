// SPDX-License-Identifier: Apache-2.0
#pragma once

// Confines the process that reads untrusted models to what the reading needs (seccomp; x86-64
// Linux). main.cpp calls end_with_parent() and confine() before it reads the first byte of a model.
namespace airtruth::model_reader {

struct Limits {
  // The limit of address space. It is not set with AddressSanitizer, which reserves terabytes.
  unsigned long memory_bytes = 3ul << 30;
  // The limit of processor time, in seconds.
  unsigned long processor_s = 20;
};

// Ends this process when the process `parent`, whose child it is, ends.
void end_with_parent(int parent);

// After this call the process can read and write its standard input (a socket to its parent),
// allocate and free memory, and end. All other system calls fail: the process can open no file,
// start no process and reach no network, even with administrator's rights. Throws Error where the
// kernel lacks a part of this.
void confine(const Limits& limits);

}  // namespace airtruth::model_reader
