// SPDX-License-Identifier: Apache-2.0
//
// What a child process that reads a damaged file may still do. Internal to IsolatedRead.
#pragma once

namespace tetvdb {

/// Bounds this process for good: it dies with its parent, gains no privileges, starts no processes,
/// writes no core and no files, and of the system's calls only those remain that a reader needs:
/// memory, and files for reading (seccomp; others fail with EPERM). Descriptors that are open stay
/// writable. Where the kernel has no seccomp the other bounds hold alone. For a process with one
/// thread, right after fork(). Sources: seccomp(2), prctl(2).
void enterSandbox() noexcept;

} // namespace tetvdb
