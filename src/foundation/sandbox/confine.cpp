// SPDX-License-Identifier: Apache-2.0
#include "foundation/sandbox/confine.h"

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "foundation/base/error.h"

namespace airtruth::sandbox {
namespace {

#if defined(__x86_64__)
constexpr std::uint32_t kMachine = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
constexpr std::uint32_t kMachine = AUDIT_ARCH_AARCH64;
#elif defined(__riscv) && __riscv_xlen == 64
constexpr std::uint32_t kMachine = AUDIT_ARCH_RISCV64;
#else
#error "state this machine's AUDIT_ARCH, so that a child's system calls can be filtered"
#endif

// System calls that reach nothing outside the process, whatever their arguments are.
constexpr int kFreeCalls[] = {__NR_brk,
                              __NR_munmap,
                              __NR_mremap,
                              __NR_madvise,
                              __NR_exit,
                              __NR_exit_group,
                              __NR_futex,
                              __NR_sched_yield,
                              __NR_clock_gettime,
                              __NR_rt_sigreturn,
                              __NR_sigaltstack,
                              __NR_rt_sigprocmask,
                              __NR_gettid,
                              // A thread that was started before the filter begins with these two.
                              __NR_rseq,
                              __NR_set_robust_list};

using FilterCode = std::vector<sock_filter>;

void add_statement(FilterCode& program, std::uint16_t code, std::uint32_t value) {
  program.push_back({code, 0, 0, value});
}

void add_jump(FilterCode& program,
              std::uint16_t code,
              std::uint32_t value,
              std::uint8_t if_so,
              std::uint8_t if_not) {
  program.push_back({code, if_so, if_not, value});
}

// The filter's answer to a call that is not allowed: the call fails with EPERM.
constexpr std::uint32_t kDeny = SECCOMP_RET_ERRNO | EPERM;

constexpr std::uint32_t argument(std::uint32_t index) {  // its lower half; little-endian machines
  return static_cast<std::uint32_t>(offsetof(seccomp_data, args)) + 8 * index;
}

void load_word(FilterCode& program, std::uint32_t offset) {
  add_statement(program, BPF_LD | BPF_W | BPF_ABS, offset);
}

void give_answer(FilterCode& program, std::uint32_t answer) {
  add_statement(program, BPF_RET | BPF_K, answer);
}

// `call` is allowed where its argument, masked, has the value.
void allow_where(FilterCode& program,
                 int call,
                 std::uint32_t argument_index,
                 std::uint32_t mask,
                 std::uint32_t value) {
  add_jump(program, BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint32_t>(call), 0, 5);
  load_word(program, argument(argument_index));
  add_statement(program, BPF_ALU | BPF_AND | BPF_K, mask);
  add_jump(program, BPF_JMP | BPF_JEQ | BPF_K, value, 0, 1);
  give_answer(program, SECCOMP_RET_ALLOW);
  give_answer(program, kDeny);
}

// mmap is allowed for anonymous private memory that is not executable.
void allow_own_memory(FilterCode& program) {
  add_jump(program, BPF_JMP | BPF_JEQ | BPF_K, __NR_mmap, 0, 7);
  load_word(program, argument(2));
  add_jump(program, BPF_JMP | BPF_JSET | BPF_K, PROT_EXEC, 4, 0);
  load_word(program, argument(3));
  add_jump(program, BPF_JMP | BPF_JSET | BPF_K, MAP_ANONYMOUS, 0, 2);
  add_jump(program, BPF_JMP | BPF_JSET | BPF_K, MAP_SHARED, 1, 0);
  give_answer(program, SECCOMP_RET_ALLOW);
  give_answer(program, kDeny);
}

FilterCode filter() {
  FilterCode program;
  load_word(program, offsetof(seccomp_data, arch));
  add_jump(program, BPF_JMP | BPF_JEQ | BPF_K, kMachine, 1, 0);
  give_answer(program, SECCOMP_RET_KILL_PROCESS);
  load_word(program, offsetof(seccomp_data, nr));
  for (const int call : kFreeCalls) {
    add_jump(program, BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint32_t>(call), 0, 1);
    give_answer(program, SECCOMP_RET_ALLOW);
  }
  constexpr std::uint32_t kAll = 0xffffffff;
  allow_where(program, __NR_read, 0, kAll, 0);   // from standard input only
  allow_where(program, __NR_write, 0, kAll, 0);  // to the same descriptor, which is a socket
  allow_where(program, __NR_mprotect, 2, PROT_EXEC, 0);
  allow_own_memory(program);
  give_answer(program, kDeny);
  return program;
}

// Lowers a limit; one that is lower already stays, since no plain user may raise it.
void limit(int what, unsigned long value) {
  const auto resource = static_cast<__rlimit_resource_t>(what);
  rlimit now{};
  if (::getrlimit(resource, &now) != 0) now = {RLIM_INFINITY, RLIM_INFINITY};
  const rlimit lowered{std::min<rlim_t>(now.rlim_cur, value),
                       std::min<rlim_t>(now.rlim_max, value)};
  if (::setrlimit(resource, &lowered) != 0)
    throw Error(std::string("the reader of untrusted files cannot be limited: ") +
                std::strerror(errno));
}

}  // namespace

void confine(const Limits& limits) {
#if !defined(__SANITIZE_ADDRESS__) && !defined(AIRTRUTH_SANITIZED)
  limit(RLIMIT_AS, limits.memory_bytes);
#endif
  if (limits.processor_s > 0) limit(RLIMIT_CPU, limits.processor_s);
  limit(RLIMIT_FSIZE, 0);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_NOFILE, 1);
  ::prctl(PR_SET_DUMPABLE, 0);
  FilterCode program = filter();
  const sock_fprog code{static_cast<unsigned short>(program.size()), program.data()};
  if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 ||
      ::syscall(__NR_seccomp, SECCOMP_SET_MODE_FILTER, SECCOMP_FILTER_FLAG_TSYNC, &code) != 0)
    throw Error(std::string("untrusted files cannot be read here: this kernel does not confine "
                            "their reader (seccomp): ") +
                std::strerror(errno));
}

}  // namespace airtruth::sandbox
