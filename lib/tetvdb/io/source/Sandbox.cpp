// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/source/Sandbox.h"

#include <array>
#include <csignal>
#include <cstddef>
#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <vector>

namespace tetvdb {
namespace {

#if defined(__x86_64__)
constexpr unsigned kArchitecture = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
constexpr unsigned kArchitecture = AUDIT_ARCH_AARCH64;
#else
constexpr unsigned kArchitecture = 0;
#endif

/// Calls that are allowed whatever their arguments.
constexpr int kAllowed[] = {
    SYS_read,         SYS_readv,           SYS_pread64,       SYS_preadv,
    SYS_write,        SYS_writev,          SYS_close,         SYS_lseek,
    SYS_fstat,        SYS_newfstatat,      SYS_statx,         SYS_fstatfs,
    SYS_statfs,       SYS_faccessat,       SYS_readlinkat,    SYS_getdents64,
    SYS_fcntl,        SYS_flock,           SYS_fadvise64,     SYS_dup,
    SYS_getcwd,       SYS_ioctl,           SYS_mmap,          SYS_munmap,
    SYS_mprotect,     SYS_mremap,          SYS_madvise,       SYS_brk,
    SYS_futex,        SYS_getrandom,       SYS_clock_gettime, SYS_gettimeofday,
    SYS_nanosleep,    SYS_clock_nanosleep, SYS_sched_yield,   SYS_sched_getaffinity,
    SYS_getpid,       SYS_gettid,          SYS_getppid,       SYS_getuid,
    SYS_geteuid,      SYS_getgid,          SYS_getegid,       SYS_tgkill,
    SYS_rt_sigaction, SYS_rt_sigprocmask,  SYS_rt_sigreturn,  SYS_sigaltstack,
    SYS_getrlimit,    SYS_getrusage,       SYS_sysinfo,       SYS_uname,
    SYS_times,        SYS_restart_syscall, SYS_exit,          SYS_exit_group,
#ifdef TETVDB_SANITIZED
    SYS_pipe2, // with it the sanitizer finds out whether an address can be read
#endif
#ifdef SYS_faccessat2
    SYS_faccessat2,
#endif
#ifdef SYS_stat // the older calls, which newer architectures do not have
    SYS_stat,         SYS_lstat,           SYS_access,        SYS_readlink,
    SYS_time,
#endif
};

/// A file is opened for reading alone where none of these is asked for.
constexpr unsigned kWriting = O_ACCMODE | O_CREAT | O_TRUNC | O_APPEND;

constexpr sock_filter statement(unsigned short code, unsigned value) {
  return {code, 0, 0, value};
}
constexpr sock_filter jumpIfEqual(unsigned value, unsigned char yes, unsigned char no) {
  return {BPF_JMP | BPF_JEQ | BPF_K, yes, no, value};
}
constexpr sock_filter load(std::size_t offset) {
  return statement(BPF_LD | BPF_W | BPF_ABS, static_cast<unsigned>(offset));
}

constexpr auto kAllow = statement(BPF_RET | BPF_K, SECCOMP_RET_ALLOW);
constexpr auto kRefuse = statement(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | 1 /* EPERM */);

/// A call that opens a file, whose flags are its argument `flags`.
void addOpening(std::vector<sock_filter>& filter, int call, std::size_t flags) {
  const std::array<sock_filter, 6> rule{
      jumpIfEqual(static_cast<unsigned>(call), 0, 5),
      load(offsetof(seccomp_data, args) + flags * sizeof(unsigned long long)), // the low half
      statement(BPF_ALU | BPF_AND | BPF_K, kWriting),
      jumpIfEqual(0, 0, 1),
      kAllow,
      kRefuse};
  filter.insert(filter.end(), rule.begin(), rule.end());
}

std::vector<sock_filter> makeFilter() {
  std::vector<sock_filter> filter{load(offsetof(seccomp_data, arch)),
                                  jumpIfEqual(kArchitecture, 1, 0), kRefuse,
                                  load(offsetof(seccomp_data, nr))};
  addOpening(filter, SYS_openat, 2);
#ifdef SYS_open
  addOpening(filter, SYS_open, 1);
#endif
  for (const int call : kAllowed) {
    filter.push_back(jumpIfEqual(static_cast<unsigned>(call), 0, 1));
    filter.push_back(kAllow);
  }
  filter.push_back(kRefuse);
  return filter;
}

} // namespace

void enterSandbox() noexcept {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
  const rlimit none{0, 0};
  for (const auto resource : {RLIMIT_CORE, RLIMIT_FSIZE, RLIMIT_NPROC})
    ::setrlimit(resource, &none);
  if (kArchitecture == 0)
    return;
  try {
    std::vector<sock_filter> filter = makeFilter();
    const sock_fprog program{static_cast<unsigned short>(filter.size()), filter.data()};
    ::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program, 0, 0);
  } catch (...) { // no memory: the other bounds hold
  }
}

} // namespace tetvdb
