// SPDX-License-Identifier: Apache-2.0
//
// A shared object for LD_PRELOAD that makes calls of the C library fail, from main() on.
//
//   FAIL_CALLS="alloc 120 1"   the 120th allocation fails
//   FAIL_CALLS="write 3 0 28"  from the third on, all writes into regular files fail, errno 28
//   FAIL_CALLS="count FILE"    no call fails; the numbers of calls of each kind go into FILE
//
// Calls that the C library makes of its own (fwrite, the memory of malloc) are not among them, nor
// allocations of Blosc, which uses them unchecked (1.21: serial_blosc).
#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <dlfcn.h>
#include <fcntl.h>
#include <link.h>
#include <pthread.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace {

enum Kind { kAlloc, kWrite, kSync, kRename, kRead, kMap, kOpen, kThread, kKinds };
const std::array<const char*, kKinds> kNames = {"alloc", "write", "sync", "rename",
                                                "read",  "map",   "open", "thread"};

std::array<std::atomic<std::uint64_t>, kKinds> calls{};
std::atomic<bool> running{false};
int failing = -1;                    ///< the kind whose calls fail
std::uint64_t first = 0, number = 0; ///< of them; number 0: all that follow
int error = 0;
std::array<char, 4096> countsPath{};
pid_t counted = 0; ///< the process whose calls are counted

std::uintptr_t bloscBegin = 0, bloscEnd = 0; ///< the library's code

int findBlosc(dl_phdr_info* library, std::size_t, void*) {
  if (std::strstr(library->dlpi_name, "libblosc.so") == nullptr)
    return 0;
  for (int i = 0; i < library->dlpi_phnum; ++i)
    if (const auto& part = library->dlpi_phdr[i]; part.p_type == PT_LOAD && (part.p_flags & PF_X)) {
      bloscBegin = library->dlpi_addr + part.p_vaddr;
      bloscEnd = bloscBegin + part.p_memsz;
    }
  return 1;
}

void writeCounts() {
  if (countsPath[0] == 0 || ::getpid() != counted)
    return;
  running = false;
  if (std::FILE* file = std::fopen(countsPath.data(), "w")) {
    for (int kind = 0; kind < kKinds; ++kind)
      std::fprintf(file, "%s %llu\n", kNames[std::size_t(kind)],
                   static_cast<unsigned long long>(calls[std::size_t(kind)].load()));
    std::fclose(file);
  }
}

void readSettings() {
  const char* text = std::getenv("FAIL_CALLS");
  if (text == nullptr)
    return;
  if (std::sscanf(text, "count %4095s", countsPath.data()) == 1) {
    counted = ::getpid();
    return;
  }
  std::array<char, 16> name{};
  unsigned long long from = 0, length = 0;
  if (std::sscanf(text, "%15s %llu %llu %d", name.data(), &from, &length, &error) < 3)
    std::abort();
  first = from;
  number = length;
  for (int kind = 0; kind < kKinds; ++kind)
    if (std::strcmp(name.data(), kNames[std::size_t(kind)]) == 0)
      failing = kind;
  if (failing < 0)
    std::abort();
}

/// Counts a call; whether it must fail, with errno set.
bool fails(Kind kind, int usual) {
  if (!running.load(std::memory_order_relaxed))
    return false;
  const std::uint64_t call = calls[std::size_t(kind)].fetch_add(1) + 1;
  if (kind != failing || call < first || (number != 0 && call >= first + number))
    return false;
  errno = error != 0 ? error : usual;
  return true;
}

/// fails() of an allocation that the code at `caller` asks for.
bool failsAllocation(const void* caller) {
  const auto at = reinterpret_cast<std::uintptr_t>(caller);
  return (at < bloscBegin || at >= bloscEnd) && fails(kAlloc, ENOMEM);
}

bool isRegular(int descriptor) {
  struct stat info {};
  return ::fstat(descriptor, &info) == 0 && S_ISREG(info.st_mode);
}

using Main = int (*)(int, char**, char**);
Main programMain = nullptr;

int runMain(int count, char** words, char** environment) {
  readSettings();
  ::dl_iterate_phdr(findBlosc, nullptr);
  running = true;
  const int status = programMain(count, words, environment);
  writeCounts();
  running = false;
  return status;
}

} // namespace

#define REAL(name)                                                                                 \
  static const auto real = reinterpret_cast<decltype(&name)>(::dlsym(RTLD_NEXT, #name))

extern "C" {

void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);

int __libc_start_main(Main main, int count, char** words, void (*init)(), void (*fini)(),
                      void (*linkerFini)(), void* stackEnd) {
  programMain = main;
  using Start = int (*)(Main, int, char**, void (*)(), void (*)(), void (*)(), void*);
  const auto real = reinterpret_cast<Start>(::dlsym(RTLD_NEXT, "__libc_start_main"));
  return real(runMain, count, words, init, fini, linkerFini, stackEnd);
}

void* malloc(std::size_t size) {
  return failsAllocation(__builtin_return_address(0)) ? nullptr : __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  return failsAllocation(__builtin_return_address(0)) ? nullptr : __libc_calloc(count, size);
}
void* realloc(void* block, std::size_t size) {
  return failsAllocation(__builtin_return_address(0)) ? nullptr : __libc_realloc(block, size);
}
void* memalign(std::size_t alignment, std::size_t size) {
  return failsAllocation(__builtin_return_address(0)) ? nullptr : __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  return failsAllocation(__builtin_return_address(0)) ? nullptr : __libc_memalign(alignment, size);
}
int posix_memalign(void** block, std::size_t alignment, std::size_t size) {
  void* const made =
      failsAllocation(__builtin_return_address(0)) ? nullptr : __libc_memalign(alignment, size);
  if (made == nullptr)
    return ENOMEM;
  *block = made;
  return 0;
}

ssize_t write(int descriptor, const void* data, std::size_t size) {
  REAL(write);
  return isRegular(descriptor) && fails(kWrite, ENOSPC) ? -1 : real(descriptor, data, size);
}
ssize_t pwrite(int descriptor, const void* data, std::size_t size, off_t at) {
  REAL(pwrite);
  return fails(kWrite, ENOSPC) ? -1 : real(descriptor, data, size, at);
}
ssize_t pwrite64(int descriptor, const void* data, std::size_t size, off64_t at) {
  REAL(pwrite64);
  return fails(kWrite, ENOSPC) ? -1 : real(descriptor, data, size, at);
}
int fsync(int descriptor) {
  REAL(fsync);
  return fails(kSync, EIO) ? -1 : real(descriptor);
}
int rename(const char* from, const char* to) {
  REAL(rename);
  return fails(kRename, EIO) ? -1 : real(from, to);
}
int renameat2(int fromFolder, const char* from, int toFolder, const char* to, unsigned flags) {
  REAL(renameat2);
  return fails(kRename, EIO) ? -1 : real(fromFolder, from, toFolder, to, flags);
}
int linkat(int fromFolder, const char* from, int toFolder, const char* to, int flags) {
  REAL(linkat);
  return fails(kRename, EIO) ? -1 : real(fromFolder, from, toFolder, to, flags);
}

ssize_t read(int descriptor, void* data, std::size_t size) {
  REAL(read);
  return isRegular(descriptor) && fails(kRead, EIO) ? -1 : real(descriptor, data, size);
}
ssize_t pread(int descriptor, void* data, std::size_t size, off_t at) {
  REAL(pread);
  return fails(kRead, EIO) ? -1 : real(descriptor, data, size, at);
}
ssize_t pread64(int descriptor, void* data, std::size_t size, off64_t at) {
  REAL(pread64);
  return fails(kRead, EIO) ? -1 : real(descriptor, data, size, at);
}

void* mmap(void* at, std::size_t size, int protection, int flags, int descriptor, off_t offset) {
  REAL(mmap);
  return fails(kMap, ENOMEM) ? MAP_FAILED : real(at, size, protection, flags, descriptor, offset);
}
void* mmap64(void* at, std::size_t size, int protection, int flags, int descriptor,
             off64_t offset) {
  REAL(mmap64);
  return fails(kMap, ENOMEM) ? MAP_FAILED : real(at, size, protection, flags, descriptor, offset);
}

int open(const char* path, int flags, ...) {
  using Open = int (*)(const char*, int, mode_t);
  static const auto real = reinterpret_cast<Open>(::dlsym(RTLD_NEXT, "open"));
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(rest, mode_t) : 0;
  va_end(rest);
  return fails(kOpen, EMFILE) ? -1 : real(path, flags, mode);
}
int open64(const char* path, int flags, ...) {
  using Open = int (*)(const char*, int, mode_t);
  static const auto real = reinterpret_cast<Open>(::dlsym(RTLD_NEXT, "open64"));
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(rest, mode_t) : 0;
  va_end(rest);
  return fails(kOpen, EMFILE) ? -1 : real(path, flags, mode);
}

int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*start)(void*),
                   void* data) {
  REAL(pthread_create);
  return fails(kThread, EAGAIN) ? EAGAIN : real(thread, attributes, start, data);
}
}
