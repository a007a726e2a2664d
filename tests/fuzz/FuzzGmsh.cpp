// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/Error.h"
#include "tetvdb/io/GmshReader.h"
#include "tetvdb/mesh/SplitCells.h"

#include <cstddef>
#include <cstdint>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    tetvdb::Report report;
    tetvdb::Progress progress;
    const tetvdb::Source source{{reinterpret_cast<const char*>(data), size}, "fuzz"};
    tetvdb::splitCells(tetvdb::readGmsh(source, {}, report, progress), {}, report, progress);
  } catch (const tetvdb::Error&) {
  }
  return 0;
}
