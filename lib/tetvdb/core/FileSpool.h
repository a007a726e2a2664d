// SPDX-License-Identifier: Apache-2.0
//
// Numbers that are too many for memory: appended to a temporary file without a name, then read
// back through a map of it.
//
//   tetvdb::FileSpool spool("out");
//   spool.append(values.data(), values.size() * sizeof(double));
//   spool.finish();
//   const double* all = spool.as<double>();   // pages come from the system's cache
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace tetvdb {

/// For one thread until finish(), for any number from then on.
class FileSpool {
public:
  /// The file is made in `folder` by the first append().
  explicit FileSpool(std::string folder);
  ~FileSpool();
  FileSpool(const FileSpool&) = delete;
  FileSpool& operator=(const FileSpool&) = delete;

  /// Throws Error(Write).
  void append(const void* data, std::size_t size);
  template <typename T>
  void append(const std::vector<T>& values) {
    append(values.data(), values.size() * sizeof(T));
  }
  /// Replaces bytes that were appended before. Throws Error(Write).
  void overwrite(std::uint64_t at, const void* data, std::size_t size);
  /// Forgets what was appended; not after finish().
  void clear();
  /// Ends the appending and maps the file. Throws Error(Write).
  void finish();

  void swap(FileSpool& other) noexcept;

  std::uint64_t size() const { return size_; }
  /// After finish(); null where nothing was appended.
  template <typename T>
  const T* as() const {
    return reinterpret_cast<const T*>(map_);
  }
  template <typename T>
  std::size_t count() const {
    return static_cast<std::size_t>(size_ / sizeof(T));
  }
  /// Gives mapped pages back to the system; those read again come from its cache.
  void release() const noexcept;

private:
  void open();
  void flush();
  void writeAt(std::uint64_t at, const char* data, std::size_t size);
  [[noreturn]] void fail(const char* what, int error) const;

  std::string folder_;
  std::string buffer_;
  std::uint64_t size_ = 0;
  int descriptor_ = -1;
  void* map_ = nullptr;
};

} // namespace tetvdb
