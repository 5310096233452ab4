// SPDX-License-Identifier: Apache-2.0
#pragma once

// Takes from this process all that reading a model does not need.
namespace airtruth::model_reader {

struct Limits {
  unsigned long memory_bytes = 3ul << 30;  // of address space; not with AddressSanitizer, which
                                           // reserves terabytes
  unsigned long processor_s = 20;
};

// The process ends with its parent, `parent`, whose child it is.
void end_with_parent(int parent);

// From here on the process can read and write its standard input (a socket to its parent), take and
// give back memory, and end. All other system calls fail: it opens no file, makes no process, and
// reaches no network. Not even an administrator's rights lift this. Throws Error where the kernel
// cannot do so.
void confine(const Limits& limits);

}  // namespace airtruth::model_reader
