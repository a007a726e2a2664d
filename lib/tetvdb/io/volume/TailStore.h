// SPDX-License-Identifier: Apache-2.0
//
// Many small blocks of bytes that are written to a file later: kept in memory up to a limit, and
// beyond it in an unnamed temporary file.
//
//   tetvdb::TailStore store("out", 32 << 20);
//   const std::uint64_t at = store.add(bytes, size);   // from any thread
//   ...
//   store.read(at, bytes, size);                       // when all are added
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace tetvdb {

class TailStore {
public:
  /// The temporary file is made in `folder` when more than `inMemory` bytes are stored; it has no
  /// name, so that it is removed however the program ends.
  TailStore(std::string folder, std::size_t inMemory);
  ~TailStore();
  TailStore(const TailStore&) = delete;
  TailStore& operator=(const TailStore&) = delete;

  /// Stores `size` bytes, at most kChunk, and returns their place. Thread-safe. Throws
  /// Error(Write).
  std::uint64_t add(const char* data, std::size_t size);
  /// Reads the bytes stored at `at`. Thread-safe, except with add(). Throws Error(Write).
  void read(std::uint64_t at, char* out, std::size_t size) const;

  /// Gives back the room of what was added before `end`, which is not read again; of the file's
  /// where the file system can.
  void release(std::uint64_t end);

  static constexpr std::size_t kChunk = std::size_t(1) << 20;

private:
  void open();
  void spill();
  [[noreturn]] void fail(const char* what, int error) const;

  std::string folder_;
  std::size_t maxChunks_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<char[]>> chunks_; ///< null: in the file, at its place
  std::size_t used_ = kChunk;                   ///< of the last chunk
  std::size_t kept_ = 0;                        ///< chunks in memory, but for the last
  std::uint64_t released_ = 0;                  ///< up to here, a multiple of kChunk
  int descriptor_ = -1;
};

} // namespace tetvdb
