// SPDX-License-Identifier: Apache-2.0
//
// The container of a .nvdb file: which grids it has, and their bytes. Everything is checked against
// the file's size.
#pragma once

#include "tetvdb/io/source/Source.h"
#include "tetvdb/io/volume/NvdbLayout.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace tetvdb {

class NvdbFile {
public:
  struct Grid {
    std::string name; ///< of the list of grids
    std::uint64_t size = 0;
    NvdbCodec codec = NvdbCodec::None;
    std::size_t at = 0; ///< in the file
  };

  /// Reads what comes before and between the grids. Throws Error(Invalid).
  explicit NvdbFile(const std::string& path);
  const std::string& path() const { return path_; }
  const std::vector<Grid>& grids() const { return grids_; }

  /// Calls take(bytes, size) for all bytes of a grid in order. Chunks of Blosc are unpacked block
  /// by block, in parallel. Memory: 64 MB, or as much as the file has blocks of another size.
  /// Throws Error(Invalid) and what take() does.
  void unpack(const Grid& grid,
              const std::function<void(const unsigned char*, std::size_t)>& take) const;

  /// Throws Error(Invalid).
  [[noreturn]] void fail(const Grid& grid, const std::string& what) const;

private:
  MappedFile file_;
  std::string path_;
  std::vector<Grid> grids_;
};

} // namespace tetvdb
