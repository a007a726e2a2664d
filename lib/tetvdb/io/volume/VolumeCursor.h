// SPDX-License-Identifier: Apache-2.0
//
// A bounds-checked cursor over the bytes of a .vdb or .nvdb file. Internal to their readers.
#pragma once

#include "tetvdb/core/Error.h"
#include "tetvdb/io/source/Source.h"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>

namespace tetvdb {

/// Methods throw Error(Invalid) with the byte at which the file is damaged.
class VolumeCursor {
public:
  /// `file` must outlive it. What has been passed is given back to the system now and then, and
  /// read from the file again where it is used.
  explicit VolumeCursor(const Source& file, std::size_t position = 0)
      : file_(file), position_(position), released_(position) {}

  bool atEnd() const { return position_ == size(); }
  std::size_t position() const { return position_; }
  std::size_t size() const { return file_.bytes.size(); }
  std::size_t left() const { return size() - position_; }
  /// At most size().
  void moveTo(std::uint64_t position) { position_ = static_cast<std::size_t>(position); }

  const char* take(std::uint64_t bytes, const char* what) {
    if (bytes > left())
      fail(std::string("ends within ") + what);
    const char* at = file_.bytes.data() + position_;
    position_ += static_cast<std::size_t>(bytes);
    if (position_ - released_ > kRelease) {
      file_.release();
      released_ = position_;
    }
    return at;
  }
  template <class T>
  T value(const char* what) {
    T result;
    std::memcpy(&result, take(sizeof result, what), sizeof result);
    return result;
  }

  [[noreturn]] static void failAt(const std::string& path, std::size_t position,
                                  const std::string& what) {
    throw Error(Status::Invalid, path, what + " (byte " + std::to_string(position) + ")",
                "the file is cut or damaged; write it again");
  }
  [[noreturn]] void fail(const std::string& what) const { failAt(file_.path, position_, what); }

private:
  static constexpr std::size_t kRelease = std::size_t(8) << 20; ///< bytes in memory at a time

  const Source& file_;
  std::size_t position_, released_;
};

} // namespace tetvdb
