// SPDX-License-Identifier: Apache-2.0
//
// One grid in a .nvdb file: a segment of its own.
#pragma once

#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/io/volume/BloscChunks.h"
#include "tetvdb/io/volume/NvdbLayout.h"

#include <cstddef>
#include <cstdint>
#include <string>

namespace tetvdb {

class NvdbSegment {
public:
  /// Appends the segment's header. `head`: the grid's buffer up to its root node; `name`: of the
  /// grid. The file must outlive it. Throws Error(Write).
  NvdbSegment(AtomicFile& file, const unsigned char* head, const std::string& name);
  /// The grid's buffer, from its beginning on. Throws Error(Write).
  void write(const void* data, std::size_t size) { chunks_.write(data, size); }
  /// After all of it. Throws Error(Write).
  void finish();

private:
  AtomicFile& file_;
  NvdbEntry entry_;
  std::uint64_t entryAt_;
  BloscChunks chunks_;
};

} // namespace tetvdb
