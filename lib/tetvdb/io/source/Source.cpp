// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/source/Source.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/Letters.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace tetvdb {
namespace {

[[noreturn]] void fail(const std::string& path, const std::string& what, const char* advice = "") {
  throw Error(Status::Invalid, path, what, advice);
}

/// Closes a file descriptor at the end of its scope.
struct Descriptor {
  int number;
  ~Descriptor() {
    if (number >= 0)
      ::close(number);
  }
};

// By its folder such a file says which OpenFOAM case is meant; ParaView's are empty.
bool mayBeEmpty(const std::string& path) {
  const std::string ending = lowerCase(std::filesystem::path(path).extension().string());
  return ending == ".foam" || ending == ".openfoam";
}

} // namespace

void failToOpen(const std::string& path, int error) {
  fail(path, std::string("cannot open the file: ") + std::strerror(error),
       error == ENOENT ? "check the path" : "");
}

// The mapping begins and ends at page boundaries; its pages are clean, so that nothing is lost.
void Source::release() const noexcept {
  if (isMapped)
    ::madvise(const_cast<char*>(bytes.data()), bytes.size(), MADV_DONTNEED);
}

MappedFile::MappedFile(const std::string& path) : path_(path) {
  const Descriptor file{::open(path.c_str(), O_RDONLY | O_CLOEXEC)};
  if (file.number < 0)
    failToOpen(path, errno);
  struct stat info {};
  if (::fstat(file.number, &info) != 0)
    fail(path, std::string("cannot read: ") + std::strerror(errno));
  if (S_ISDIR(info.st_mode))
    fail(path, "is a directory", "name a file in it");
  if (S_ISBLK(info.st_mode) || (S_ISCHR(info.st_mode) && ::isatty(file.number) == 0))
    fail(path, "is a device, not a file");
  if (S_ISREG(info.st_mode)) {
    size_ = static_cast<std::size_t>(info.st_size);
    if (size_ == 0 && mayBeEmpty(path))
      return;
    if (size_ == 0)
      fail(path, "the file is empty", "export it again");
    void* mapped = ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, file.number, 0);
    if (mapped != MAP_FAILED) {
      ::madvise(mapped, size_, MADV_SEQUENTIAL);
      data_ = static_cast<const char*>(mapped);
      // In place of the file, where Git LFS has not fetched it (its specification, version 1).
      constexpr std::string_view kPointer = "version https://git-lfs.github.com/spec/";
      if (bytes().substr(0, kPointer.size()) == kPointer) {
        ::munmap(mapped, size_);
        fail(path, "is a pointer of Git LFS to the file, not the file", "run git lfs pull");
      }
      return;
    }
  }
  char block[65536];
  for (;;) {
    const ssize_t got = ::read(file.number, block, sizeof block);
    if (got < 0 && errno == EINTR)
      continue;
    if (got < 0)
      fail(path, std::string("cannot read: ") + std::strerror(errno));
    if (got == 0)
      break;
    copy_.append(block, static_cast<std::size_t>(got));
  }
  if (copy_.empty())
    fail(path, "the file is empty", "export it again");
  data_ = copy_.data();
  size_ = copy_.size();
}

MappedFile::~MappedFile() {
  if (data_ != nullptr && copy_.empty())
    ::munmap(const_cast<char*>(data_), size_);
}

} // namespace tetvdb
